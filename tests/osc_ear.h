/// osc_ear.h: what tests of OSC share: a performance with its himc_osc, an ear (a socket that hears
/// what is sent to it, bundles taken apart) and a mouth (the same socket, sending as a stranger).
#ifndef HIMC_TESTS_OSC_EAR_H
#define HIMC_TESTS_OSC_EAR_H

#define _GNU_SOURCE
#include "himc/osc.h"
#include "osc/osc_state.h"

#include <arpa/inet.h>
#include <lo/lo.h>
#include <netinet/in.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unity.h>
#include <unistd.h>

#define SEEN 4096

// a message as it was received
typedef struct seen {
    char path[64];
    lo_message message;
    size_t packet; // bytes of the packet it came in
} seen;

// liblo's arguments lie at multiples of 4 bytes, whatever its union says
static inline const char *word(const lo_arg *arg)
{
    return (const char *)arg;
}

static inline float number(const lo_arg *arg)
{
    float value;
    memcpy(&value, arg, sizeof value);
    return value;
}

static inline int whole(const lo_arg *arg)
{
    int value;
    memcpy(&value, arg, sizeof value);
    return value;
}

static himc_osc *osc;
static himc_performance *performance;
static int ear, ear_port;
static seen heard[SEEN];
static int heard_count;

static inline void forget(void)
{
    while (heard_count > 0)
        lo_message_free(heard[--heard_count].message);
}

// at *port, or any free one if that is 0
static inline int open_ear(int *port)
{
    struct sockaddr_in at = {.sin_family = AF_INET,
                             .sin_addr.s_addr = htonl(INADDR_LOOPBACK),
                             .sin_port = htons((uint16_t)*port)};
    socklen_t size = sizeof at;
    int fd = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0), large = 1 << 20;
    setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &large, sizeof large);
    TEST_ASSERT_EQUAL_INT(0, bind(fd, (struct sockaddr *)&at, sizeof at));
    getsockname(fd, (struct sockaddr *)&at, &size);
    *port = ntohs(at.sin_port);
    return fd;
}

static inline void hear_element(char *data, size_t size, size_t packet)
{
    if (memcmp(data, "#bundle", 8) != 0) {
        lo_message m = lo_message_deserialise(data, size, NULL);
        TEST_ASSERT_NOT_NULL(m);
        if (heard_count == SEEN)
            forget();
        seen *s = &heard[heard_count++];
        snprintf(s->path, sizeof s->path, "%.63s", data);
        s->message = m;
        s->packet = packet;
        return;
    }
    for (size_t at = 16; at < size;) {
        uint32_t n;
        memcpy(&n, data + at, 4);
        n = ntohl(n);
        hear_element(data + at + 4, n, packet);
        at += 4 + n;
    }
}

static inline void hear(int fd)
{
    char data[65536];
    ssize_t size;
    while ((size = recv(fd, data, sizeof data, 0)) >= 0)
        hear_element(data, (size_t)size, (size_t)size);
}

static inline void rest(double seconds)
{
    nanosleep(&(struct timespec){(time_t)seconds, (long)(1e9 * (seconds - (time_t)seconds))}, NULL);
}

// plays in real time, listening
static inline void play(double seconds)
{
    himc_event event;
    for (int i = 0; i < seconds * 250; i++) {
        himc_osc_receive(osc, performance, 64);
        himc_performance_process(performance, 192, (double *[HIMC_HANDS]){NULL, NULL});
        while (himc_performance_event(performance, &event))
            himc_osc_event(osc, &event);
        himc_osc_publish(osc, performance, 1e-4);
        rest(0.003);
        hear(ear);
    }
}

static inline int count(const char *path)
{
    int n = 0;
    for (int i = 0; i < heard_count; i++)
        n += strcmp(heard[i].path, path) == 0;
    return n;
}

static inline const seen *last(const char *path)
{
    for (int i = heard_count - 1; i >= 0; i--)
        if (strcmp(heard[i].path, path) == 0)
            return &heard[i];
    return NULL;
}

static inline const char *last_error(void)
{
    const seen *s = last("/himc/error");
    return s ? word(lo_message_get_argv(s->message)[0]) : "";
}

static inline double status(const char *name)
{
    const seen *s = last("/himc/status");
    for (int i = 0; s && i + 1 < lo_message_get_argc(s->message); i += 2)
        if (strcmp(word(lo_message_get_argv(s->message)[i]), name) == 0)
            return number(lo_message_get_argv(s->message)[i + 1]);
    return -1;
}

// from the ear's own socket to the server
static inline void send_bytes(const void *data, size_t size)
{
    struct sockaddr_in to = {.sin_family = AF_INET,
                             .sin_addr.s_addr = htonl(INADDR_LOOPBACK),
                             .sin_port = htons((uint16_t)himc_osc_port(osc))};
    sendto(ear, data, size, 0, (struct sockaddr *)&to, sizeof to);
}

// "path types atom ..."
static inline void say(const char *path, const char *atoms)
{
    char words[512], data[2048], *state, *atom;
    size_t size = sizeof data;
    lo_message m = lo_message_new();
    snprintf(words, sizeof words, "%s", atoms);
    for (atom = strtok_r(words, " ", &state); atom; atom = strtok_r(NULL, " ", &state)) {
        char *end;
        double value = strtod(atom, &end);
        if (*end)
            lo_message_add_string(m, atom);
        else
            lo_message_add_float(m, (float)value);
    }
    lo_message_serialise(m, path, data, &size);
    send_bytes(data, size);
    lo_message_free(m);
}

static inline void subscribe(const char *what)
{
    char atoms[64];
    snprintf(atoms, sizeof atoms, "127.0.0.1 %d %s", ear_port, what);
    say("/himc/subscribe", atoms);
}

static inline void start(const himc_osc_config *config)
{
    himc_error error;
    himc_performance_config settings = himc_performance_default();
    performance = himc_performance_new(&settings, &error);
    himc_drum *drum = himc_drum_new("kettle", 23, 48000, &error);
    TEST_ASSERT_TRUE(himc_performance_add_drum(performance, drum, &error));
    himc_drum_release(drum);
    osc = himc_osc_new(config, &error);
    if (!osc)
        TEST_FAIL_MESSAGE(error.text);
    himc_performance_on_tick(performance, himc_osc_tick, osc);
}

void setUp(void)
{
    ear_port = 0;
    ear = open_ear(&ear_port);
    start(&(himc_osc_config){.port = 0});
}

void tearDown(void)
{
    himc_osc_free(osc);
    himc_performance_free(performance);
    close(ear);
    forget();
}

static inline void restart(const himc_osc_config *config)
{
    himc_osc_free(osc);
    himc_performance_free(performance);
    start(config);
}

#endif
