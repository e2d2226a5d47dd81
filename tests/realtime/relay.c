/// relay.c: a bad network between `himc serve` and who hears it, for test_distributed.sh.
///
///     relay FROM PORT SERVER-PORT TO-PORT JITTER LOSS
///
/// Subscribes for itself, at FROM, an address of this machine, and hands every packet on to
/// 127.0.0.1 TO-PORT after 0 to JITTER ms, each after a time of its own (so that they overtake each
/// other), but for a share LOSS of them. Says what it did with each strike, on a line:
/// `NUMBER TIME through|lost`. Plays at SERVER (127.0.0.2) once it hears it; ends with the input.
#define _GNU_SOURCE
#include <arpa/inet.h>
#include <lo/lo.h>
#include <poll.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define WAITING 256
#define PACKET 2048

typedef struct packet {
    double due; // 0: none
    size_t size;
    char data[PACKET];
} packet;

typedef struct chance {
    uint64_t state;
} chance;

static double draw(chance *c) // 0 .. 1
{
    c->state = c->state * 6364136223846793005u + 1442695040888963407u;
    return (double)(c->state >> 11) / 9007199254740992.0;
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static struct sockaddr_in address(const char *host, int port)
{
    struct sockaddr_in a = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)};
    inet_pton(AF_INET, host, &a.sin_addr);
    return a;
}

static void say(int fd, struct sockaddr_in to, const char *path, lo_message message)
{
    char data[PACKET];
    size_t size = sizeof data;
    lo_message_serialise(message, path, data, &size);
    sendto(fd, data, size, 0, (struct sockaddr *)&to, sizeof to);
    lo_message_free(message);
}

static float number(lo_message message, int i)
{
    float value;
    memcpy(&value, lo_message_get_argv(message)[i], sizeof value);
    return value;
}

static int whole(lo_message message, int i)
{
    int value;
    memcpy(&value, lo_message_get_argv(message)[i], sizeof value);
    return value;
}

/// Whether the packet, a bundle of one message, is a strike; says what becomes of it.
static bool strike(packet *p, chance *luck, double loss, bool *lost)
{
    if (p->size < 40 || strcmp(p->data + 20, "/himc/strike") != 0)
        return false;
    lo_message m = lo_message_deserialise(p->data + 20, p->size - 20, NULL);
    if (!m || strcmp(lo_message_get_types(m), "fssfffffsiif") != 0)
        exit(2);
    *lost = draw(luck) < loss;
    printf("%d %.7f %s\n", whole(m, 9), whole(m, 10) + (double)number(m, 11),
           *lost ? "lost" : "through");
    fflush(stdout);
    lo_message_free(m);
    return true;
}

static void begin(int fd, struct sockaddr_in server, const char *from, int port)
{
    lo_message m = lo_message_new();
    lo_message_add(m, "sis", from, port, "strikes");
    say(fd, server, "/himc/subscribe", m);
}

int main(int argc, char **argv)
{
    static packet waiting[WAITING];
    chance strikes = {27}, others = {11}; // of 60 strikes four are lost, the last one too
    if (argc != 7)
        return 2;
    double jitter = 0.001 * atof(argv[5]), loss = atof(argv[6]), asked = 0;
    struct sockaddr_in at = address(argv[1], atoi(argv[2]));
    struct sockaddr_in server = address("127.0.0.2", atoi(argv[3]));
    struct sockaddr_in to = address("127.0.0.1", atoi(argv[4]));
    int fd = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0);
    if (bind(fd, (struct sockaddr *)&at, sizeof at) != 0)
        return 2;
    bool heard = false;
    for (;;) {
        struct pollfd wait[] = {{fd, POLLIN, 0}, {STDIN_FILENO, POLLIN, 0}};
        ppoll(wait, 2, &(struct timespec){0, 500000}, NULL);
        if (wait[1].revents)
            return 0;
        if (!heard && now() > asked + 0.2) {
            begin(fd, server, argv[1], atoi(argv[2]));
            asked = now();
        }
        packet p;
        ssize_t size;
        while ((size = recv(fd, p.data, sizeof p.data, 0)) > 0) {
            bool lost;
            p.size = (size_t)size;
            p.due = now() + jitter * draw(&others);
            if (!strike(&p, &strikes, loss, &lost))
                lost = draw(&others) < loss;
            if (!heard)
                say(fd, server, "/himc/play", lo_message_new());
            heard = true;
            packet *place = waiting;
            while (!lost && place < waiting + WAITING && place->due > 0)
                place++;
            if (place == waiting + WAITING)
                return 3;
            if (!lost)
                *place = p;
        }
        for (packet *w = waiting; w < waiting + WAITING; w++)
            if (w->due > 0 && w->due <= now()) {
                sendto(fd, w->data, w->size, 0, (struct sockaddr *)&to, sizeof to);
                w->due = 0;
            }
    }
}
