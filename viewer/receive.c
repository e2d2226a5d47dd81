/// receive.c: the viewer has its own socket, because a lo_server binds to all addresses.
#define _POSIX_C_SOURCE 200809L
#include "receive.h"
#include "packets.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netdb.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum {
    BUFFER = 65536,    // largest UDP packet (bytes)
    BACKLOG = 1 << 20, // socket queue (bytes); chosen: a second of 16 performers
    SOUNDS_AT_ONCE = 2 // packets of sound; chosen: 10 ms, since each waking of a page costs
};

double wall_clock(void)
{
    struct timespec t;
    clock_gettime(CLOCK_REALTIME, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int fail(int fd, const char *address, int port, himc_error *error)
{
    if (errno == EADDRINUSE)
        himc_error_set(error,
                       "port %d (UDP, for OSC) is taken: perhaps by another viewer; "
                       "choose one with --osc PORT",
                       port);
    else
        himc_error_set(error, "cannot listen to OSC on %s port %d: %s", address, port,
                       strerror(errno));
    if (fd >= 0)
        close(fd);
    return -1;
}

int receive_open(const char *address, int port, himc_error *error)
{
    char service[16];
    struct addrinfo hints = {.ai_socktype = SOCK_DGRAM, .ai_flags = AI_NUMERICHOST | AI_PASSIVE},
                    *found;
    snprintf(service, sizeof service, "%d", port);
    if (getaddrinfo(address, service, &hints, &found) != 0) {
        himc_error_set(
            error, "--bind %s: not an address; expected a numeric one such as 127.0.0.1 or 0.0.0.0",
            address);
        return -1;
    }
    int backlog = BACKLOG;
    int fd = socket(found->ai_family, SOCK_DGRAM, 0);
    bool bound = fd >= 0 && bind(fd, found->ai_addr, found->ai_addrlen) == 0 &&
                 fcntl(fd, F_SETFL, O_NONBLOCK) == 0;
    freeaddrinfo(found);
    if (!bound)
        return fail(fd, address, port, error);
    setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &backlog,
               sizeof backlog); // optional: works with less
    return fd;
}

int receive_port(int fd)
{
    struct sockaddr_storage name;
    socklen_t size = sizeof name;
    char port[16] = "0";
    if (getsockname(fd, (struct sockaddr *)&name, &size) == 0)
        getnameinfo((struct sockaddr *)&name, size, NULL, 0, port, sizeof port, NI_NUMERICSERV);
    int number = 0;
    sscanf(port, "%d", &number);
    return number;
}

// "127.0.0.1:9000"
static void name_sender(const struct sockaddr *from, socklen_t size, char key[SCENE_KEY])
{
    char host[SCENE_KEY - 40], port[8];
    if (getnameinfo(from, size, host, sizeof host, port, sizeof port,
                    NI_NUMERICHOST | NI_NUMERICSERV) != 0)
        snprintf(key, SCENE_KEY, "?");
    else
        snprintf(key, SCENE_KEY, "%s:%s", host, port);
}

static uint64_t drum_versions(const scene *s)
{
    uint64_t sum = 0;
    for (int i = 0; i < SCENE_DRUMS; i++)
        sum += s->drum[i].version;
    return sum;
}

bool receive_waiting(int fd, scene *s, int most)
{
    static char packet[BUFFER];
    uint64_t events = s->events, sounds = s->sounds, drums = drum_versions(s);
    double now = wall_clock();
    for (int i = 0; i < most; i++) {
        struct sockaddr_storage from;
        socklen_t from_size = sizeof from;
        char key[SCENE_KEY];
        ssize_t size = recvfrom(fd, packet, sizeof packet, 0, (struct sockaddr *)&from, &from_size);
        if (size < 0)
            break;
        name_sender((struct sockaddr *)&from, from_size, key);
        packets_store(s, key, packet, (size_t)size, now);
    }
    bool complete = scene_complete_poses(s, now);
    return complete || s->events != events ||
           s->sounds / SOUNDS_AT_ONCE != sounds / SOUNDS_AT_ONCE || drum_versions(s) != drums;
}
