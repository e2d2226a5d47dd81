/// storm.c: packets for test_storm.sh: valid, malformed and random ones in turn, at a steady rate.
///
///     storm PORT SECONDS RATE
///
/// to 127.0.0.1, from two sockets. Valid are commands of all costs to performer and drum, in range,
/// also such as make a head of 200 modes anew; malformed are such packets with some bytes changed
/// or cut short; random are bytes. Prints how many of each the system took. The same every time.
#define _GNU_SOURCE // sendmmsg
#include <arpa/inet.h>
#include <lo/lo.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>

#define SIZE 256
#define BURST 100
#define COMMANDS ((int)(sizeof commands / sizeof *commands))

typedef struct packet {
    size_t size;
    char data[SIZE];
} packet;

static const struct {
    const char *path, *atoms;
} commands[] = {{"/himc/tempo", "120"},
                {"/himc/tempo", "97.5"},
                {"/himc/play", ""},
                {"/himc/hit", "left accent f"},
                {"/himc/hit", "right legato 0.3 0.1 0.05"},
                {"/himc/stroke", "2 right accent f -0.2 0"},
                {"/himc/seek", "1"},
                {"/himc/mode", "id"},
                {"/himc/mode", "himc"},
                {"/himc/solver", "pinv"},
                {"/himc/solver", "dls"},
                {"/himc/target", "left 0.45 0.1 1.0"},
                {"/himc/player", "1.8 80"},
                {"/himc/rate", "task 400"},
                {"/himc/rate", "task 250"},
                {"/himc/info", ""},
                {"/himc/loop", "1"},
                {"/membrane/kettle/tune", "110"},
                {"/membrane/kettle/tune", "146.8"},
                {"/membrane/kettle/modes", "200"},
                {"/membrane/kettle/modes", "50"},
                {"/membrane/kettle/radius", "0.33"},
                {"/membrane/kettle/radius", "0.2921"},
                {"/membrane/kettle/decay", "2"},
                {"/membrane/kettle/mallet", "hard"},
                {"/membrane/kettle/air", "1"},
                {"/membrane/kettle/air", "0"},
                {"/membrane/kettle/strike", "0.1 0 3"},
                {"/membrane/nobody/tune", "110"},
                {"/himc/subscribe", "192.0.2.1 9 pose"},
                {"/himc/score", "/etc/passwd"},
                {"/elsewhere", "1 2 3"}};

static uint32_t seed = 1;

static uint32_t chance(uint32_t below)
{
    seed = seed * 1664525 + 1013904223;
    return (uint32_t)((uint64_t)(seed >> 8) * below >> 24);
}

static packet command(int index)
{
    char words[64], *state = NULL, *word;
    packet p = {.size = SIZE};
    lo_message m = lo_message_new();
    snprintf(words, sizeof words, "%s", commands[index].atoms);
    for (word = strtok_r(words, " ", &state); word; word = strtok_r(NULL, " ", &state)) {
        char *end;
        float value = strtof(word, &end);
        if (*end)
            lo_message_add_string(m, word);
        else
            lo_message_add_float(m, value);
    }
    lo_message_serialise(m, commands[index].path, p.data, &p.size);
    lo_message_free(m);
    return p;
}

static packet spoilt(packet p)
{
    // cut where no message can end
    if (chance(4) == 0) {
        p.size -= 1 + chance(3);
        return p;
    }
    for (uint32_t i = 0; i < 1 + chance(4); i++)
        p.data[chance((uint32_t)p.size)] = (char)chance(256);
    return p;
}

static packet noise(void)
{
    packet p = {.size = chance(SIZE)};
    for (size_t i = 0; i < p.size; i++)
        p.data[i] = (char)chance(256);
    if (chance(2) == 0 && p.size > 24)
        memcpy(p.data, "#bundle", 8);
    return p;
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static long send_burst(int fd, packet *burst, int count)
{
    struct mmsghdr message[BURST];
    struct iovec part[BURST];
    memset(message, 0, sizeof message);
    for (int i = 0; i < count; i++) {
        part[i] = (struct iovec){burst[i].data, burst[i].size};
        message[i].msg_hdr = (struct msghdr){.msg_iov = &part[i], .msg_iovlen = 1};
    }
    int sent = sendmmsg(fd, message, (unsigned)count, 0);
    return sent > 0 ? sent : 0;
}

int main(int argc, char **argv)
{
    static packet valid[COMMANDS], burst[BURST];
    int fd[2];
    long sent = 0, kind = 0;
    if (argc != 4)
        return 2;
    struct sockaddr_in to = {.sin_family = AF_INET,
                             .sin_addr.s_addr = htonl(INADDR_LOOPBACK),
                             .sin_port = htons((uint16_t)atoi(argv[1]))};
    for (int i = 0; i < COMMANDS; i++)
        valid[i] = command(i);
    for (int i = 0; i < 2; i++) {
        fd[i] = socket(AF_INET, SOCK_DGRAM, 0);
        if (connect(fd[i], (struct sockaddr *)&to, sizeof to) != 0)
            return 2;
    }
    double seconds = atof(argv[2]), rate = atof(argv[3]), begin = now(), next = begin;
    for (long n = 0; next < begin + seconds; n++) {
        for (int i = 0; i < BURST; i++, kind++) {
            int index = (int)chance(COMMANDS);
            burst[i] = kind % 3 == 0   ? valid[index]
                       : kind % 3 == 1 ? spoilt(valid[index])
                                       : noise();
        }
        sent += send_burst(fd[n % 2], burst, BURST);
        next += BURST / rate;
        double early = next - now();
        if (early > 0)
            nanosleep(&(struct timespec){0, (long)(1e9 * early)}, NULL);
    }
    printf("%ld %.0f\n", sent + 1, (double)sent / (now() - begin));
    // what the system lost is told with the next packet that it takes
    nanosleep(&(struct timespec){0, 300000000}, NULL);
    send_burst(fd[0], &valid[0], 1);
    return 0;
}
