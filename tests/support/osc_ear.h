/// osc_ear.h: shared by the tests of OSC: a performance with its himc_osc, and an ear: a socket
/// that receives packets, takes bundles apart, and sends to the himc_osc as a stranger.
///
/// Time is simulated: one block of 4 ms moves the clock of the himc_osc by 4 ms, and its network is
/// served by the test itself, so that each test gives the same on any machine. Only the system's
/// loopback is waited for, by counting packets, at most a minute. With OSC_REAL_TIME (for
/// tests/realtime) the himc_osc has its thread, and a block lasts 4 ms of the wall clock.
#ifndef HIMC_TESTS_OSC_EAR_H
#define HIMC_TESTS_OSC_EAR_H

#define _GNU_SOURCE
#include "himc/osc.h"
#include "osc/stepped.h"

#include <arpa/inet.h>
#include <endian.h>
#include <lo/lo.h>
#include <math.h>
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
#define PATIENCE 60 // for an event that is sure to come (s)
#define EPOCH 1.7e9 // of the simulated wall clock (s since 1970)

#ifdef OSC_REAL_TIME
static const bool real_time = true;
#else
static const bool real_time = false;
#endif

// a message as it was received
typedef struct seen {
    char path[64];
    lo_message message;
    uint64_t time_tag; // of its bundle, 0 without
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
static long said, heard_packets; // since the himc_osc was made
static bool others_hear;         // the himc_osc sends to others than the ear
static double simulated;         // monotonic clock (s)
static double clock_step;        // by which each look moves it (s)

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

static inline void hear_element(char *data, size_t size, uint64_t time_tag)
{
    if (memcmp(data, "#bundle", 8) != 0) {
        lo_message m = lo_message_deserialise(data, size, NULL);
        TEST_ASSERT_NOT_NULL(m);
        if (heard_count == SEEN)
            forget();
        seen *s = &heard[heard_count++];
        snprintf(s->path, sizeof s->path, "%.63s", data);
        s->message = m;
        s->time_tag = time_tag;
        return;
    }
    memcpy(&time_tag, data + 8, 8);
    time_tag = be64toh(time_tag);
    for (size_t at = 16; at < size;) {
        uint32_t n;
        memcpy(&n, data + at, 4);
        n = ntohl(n);
        hear_element(data + at + 4, n, time_tag);
        at += 4 + n;
    }
}

// all packets that are there; how many
static inline long hear(int fd)
{
    _Alignas(8) char data[65536];
    ssize_t size;
    long packets = 0;
    for (; (size = recv(fd, data, sizeof data, 0)) >= 0; packets++)
        hear_element(data, (size_t)size, 0);
    heard_packets += fd == ear ? packets : 0;
    return packets;
}

// the same, but waits for the first
static inline long wait_and_hear(int fd)
{
    struct pollfd at = {fd, POLLIN, 0};
    TEST_ASSERT_EQUAL_INT_MESSAGE(1, poll(&at, 1, 1000 * PATIENCE), "no packet comes");
    return hear(fd);
}

static inline void rest(double seconds)
{
    nanosleep(&(struct timespec){(time_t)seconds, (long)(1e9 * (seconds - (time_t)seconds))}, NULL);
}

static inline double system_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static inline double simulated_monotonic(void *user)
{
    (void)user;
    return simulated += clock_step;
}

static inline double simulated_wall(void *user)
{
    (void)user;
    return EPOCH + simulated;
}

/// Serves the network until CONDITION, or for PATIENCE; the simulated clock stands still.
#define AWAIT(condition)                                                                       \
    for (double begun = system_seconds(); !(condition);) {                                     \
        TEST_ASSERT_TRUE_MESSAGE(system_seconds() - begun < PATIENCE, "in vain: " #condition); \
        serve();                                                                               \
        rest(1e-4);                                                                            \
    }

static inline void serve(void)
{
    if (!real_time)
        himc_osc_step(osc);
    hear(ear);
}

static inline long taken(void)
{
    himc_osc_counts c = himc_osc_count(osc);
    return c.packets + c.overrun;
}

/// All that was said has arrived, and all that was sent to the ear.
static inline void settle(void)
{
    AWAIT(taken() >= said);
    AWAIT(others_hear || heard_packets >= himc_osc_count(osc).sent);
}

static inline void play_block(void)
{
    himc_event event;
    simulated += 0.004;
    himc_osc_receive(osc, performance, 64);
    himc_performance_process(performance, 192, (double *[HIMC_HANDS]){NULL, NULL});
    while (himc_performance_event(performance, &event))
        himc_osc_event(osc, &event);
    himc_osc_publish(osc, performance, 1e-4);
}

static inline void play(double seconds)
{
    double begun = system_seconds();
    if (!real_time)
        settle();
    for (int i = 0; i < seconds * 250; i++) {
        play_block();
        if (real_time)
            rest(fmax(0, begun + 0.004 * (i + 1) - system_seconds()));
        serve();
    }
    if (!real_time)
        settle();
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

// when it was, on the wall clock (s since 1970)
static inline double wall_of(const seen *s)
{
    return (double)(s->time_tag >> 32) - 2208988800.0 +
           (double)(uint32_t)s->time_tag / 4294967296.0;
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
    said += sendto(ear, data, size, 0, (struct sockaddr *)&to, sizeof to) >= 0;
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
    osc_clock clock = {simulated_monotonic, simulated_wall, NULL};
    himc_performance_config settings = himc_performance_default();
    performance = himc_performance_new(&settings, &error);
    himc_drum *drum = himc_drum_new("kettle", 23, 48000, &error);
    TEST_ASSERT_TRUE(himc_performance_add_drum(performance, drum, &error));
    himc_drum_release(drum);
    said = heard_packets = 0;
    others_hear = false;
    clock_step = 0;
    osc = real_time ? himc_osc_new(config, &error) : himc_osc_new_stepped(config, &clock, &error);
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

// lines that say that a receiver vanished
static inline int lines_of_vanished(void)
{
    char line[HIMC_OSC_LINE];
    int lines = 0;
    while (himc_osc_line(osc, line))
        lines += strstr(line, "forgotten after 60 s") != NULL;
    return lines;
}

#endif
