/// receive.c: packets, bundles, messages.
///
/// The viewer has its own socket, because a lo_server binds to all addresses. So bundles are split
/// here (OSC 1.0: "#bundle", a time tag, then size and element in turn) and liblo decodes the
/// messages. Messages act when they arrive; time tags are ignored. Invariant: the time for a packet
/// is at most proportional to its length, whatever it contains.
#define _POSIX_C_SOURCE 200809L
#include "receive.h"
#include "addresses.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <lo/lo.h>
#include <netdb.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum {
    BUFFER = 65536,    // largest UDP packet (bytes)
    DEEPEST = 8,       // bundle in a bundle; chosen: well-formed senders nest one or two
    BACKLOG = 1 << 20, // socket queue (bytes); chosen: a second of 16 performers
};

double wall_clock(void)
{
    struct timespec t;
    clock_gettime(CLOCK_REALTIME, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int fail(int fd, const char *address, int port, char error[256])
{
    if (errno == EADDRINUSE)
        snprintf(error, 256,
                 "port %d (UDP, for OSC) is taken: perhaps by another viewer; "
                 "choose one with --osc PORT",
                 port);
    else
        snprintf(error, 256, "cannot listen to OSC on %s port %d: %s", address, port,
                 strerror(errno));
    if (fd >= 0)
        close(fd);
    return -1;
}

int receive_open(const char *address, int port, char error[256])
{
    char service[16];
    struct addrinfo hints = {.ai_socktype = SOCK_DGRAM, .ai_flags = AI_NUMERICHOST | AI_PASSIVE},
                    *found;
    snprintf(service, sizeof service, "%d", port);
    if (getaddrinfo(address, service, &hints, &found) != 0) {
        snprintf(error, 256,
                 "--bind %s: not an address; allowed is a numeric one such as 127.0.0.1 or 0.0.0.0",
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

static void receive_message(scene *s, const char *key, const char *data, size_t size, double now)
{
    int trouble = 0;
    lo_message message = lo_message_deserialise((void *)data, size, &trouble);
    s->count.messages++;
    if (!message) {
        s->count.malformed++;
        return;
    }
    // the data begins with the address; lo_message_deserialise has checked that it ends
    address_dispatch(s, key, data, message, now);
    lo_message_free(message);
}

static void receive_element(scene *s, const char *key, const char *data, size_t size, double now,
                            int depth)
{
    if (size < 16 || memcmp(data, "#bundle", 8) != 0) {
        receive_message(s, key, data, size, now);
        return;
    }
    for (size_t at = 16; at < size;) {
        uint32_t length = 0;
        if (size - at >= 4)
            length = (uint32_t)(uint8_t)data[at] << 24 | (uint32_t)(uint8_t)data[at + 1] << 16 |
                     (uint32_t)(uint8_t)data[at + 2] << 8 | (uint8_t)data[at + 3];
        at += 4;
        if (length == 0 || length % 4 || at > size || length > size - at || depth == DEEPEST) {
            s->count.malformed++;
            return;
        }
        receive_element(s, key, data + at, length, now, depth + 1);
        at += length;
    }
}

void receive_packet(scene *s, const char *key, const void *packet, size_t size, double now)
{
    s->count.packets++;
    s->count.bytes += size;
    if (size < 8 || size % 4) {
        s->count.malformed++;
        return;
    }
    receive_element(s, key, packet, size, now, 0);
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
    uint64_t events = s->events, drums = drum_versions(s);
    double now = wall_clock();
    for (int i = 0; i < most; i++) {
        struct sockaddr_storage from;
        socklen_t from_size = sizeof from;
        char key[SCENE_KEY];
        ssize_t size = recvfrom(fd, packet, sizeof packet, 0, (struct sockaddr *)&from, &from_size);
        if (size < 0)
            break;
        name_sender((struct sockaddr *)&from, from_size, key);
        receive_packet(s, key, packet, (size_t)size, now);
    }
    bool complete = scene_complete_poses(s, now);
    return complete || s->events != events || drum_versions(s) != drums;
}
