/// storm.c: packets for test_storm.sh: valid, malformed and random ones in turn, at a steady rate.
///
///     storm PORT COUNT RATE BEFORE
///     storm burn SECONDS SHARE
///
/// to 127.0.0.1, from two sockets. Valid are commands of all costs to performer and drum, in range,
/// also such as make a head of 200 modes anew; malformed are such packets with some bytes changed
/// or cut short; random are bytes. The same every time.
///
/// A third socket subscribes, so that it gets /himc/status. The storm begins when the first status
/// has come. The program ends when the counters in a status know every packet: those of this storm
/// and the BEFORE ones sent to the port earlier; each is taken, lost at the socket (overrun), or
/// lost in the system's queue of packets. Prints one line, NAME VALUE ...: `sent`, `pace`
/// (packets/s), `share` (of one core that sending took, the system's work for it included),
/// `dropped` (in the system's queue), and the counters. Status 1 after a minute.
///
/// `burn` sends nothing and takes that share of a core for so long, in the same steps of time: what
/// is late beside it is late for lack of a core, not because of the packets.
#define _GNU_SOURCE // sendmmsg
#include <arpa/inet.h>
#include <lo/lo.h>
#include <math.h>
#include <poll.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#define SIZE 256
#define BURST 100
#define BURN_RATE 1e5 // packets that are not sent (1/s)
#define PATIENCE 60   // (s)
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

static double read_clock(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double now(void)
{
    return read_clock(CLOCK_MONOTONIC);
}

static void sleep_until(double t)
{
    double early = t - now();
    if (early > 0)
        nanosleep(&(struct timespec){(time_t)early, (long)(1e9 * (early - floor(early)))}, NULL);
}

// seconds that all cores have spent on packets outside of processes
static double interrupts(void)
{
    unsigned long ticks = 0;
    FILE *file = fopen("/proc/stat", "r");
    if (file && fscanf(file, "cpu %*u %*u %*u %*u %*u %*u %lu", &ticks) != 1)
        ticks = 0;
    if (file)
        fclose(file);
    return (double)ticks / (double)sysconf(_SC_CLK_TCK);
}

static void burn(double seconds, double share)
{
    double begun = now(), used = read_clock(CLOCK_PROCESS_CPUTIME_ID);
    for (double t = BURST / BURN_RATE; t < seconds; t += BURST / BURN_RATE) {
        while (read_clock(CLOCK_PROCESS_CPUTIME_ID) - used < share * t && now() - begun < seconds)
            ;
        sleep_until(begun + t);
    }
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

static long queue_dropped(void)
{
    unsigned long sum = 0, dropped;
    char line[256];
    FILE *file = fopen("/proc/net/softnet_stat", "r");
    while (file && fgets(line, sizeof line, file))
        if (sscanf(line, "%*x %lx", &dropped) == 1)
            sum += dropped;
    if (file)
        fclose(file);
    return (long)sum;
}

static long send_storm(const int fd[2], const packet valid[COMMANDS], long count, double rate)
{
    static packet burst[BURST];
    long sent = 0, kind = 0;
    double next = now();
    for (long n = 0; n < count / BURST; n++) {
        for (int i = 0; i < BURST; i++, kind++) {
            int index = (int)chance(COMMANDS);
            burst[i] = kind % 3 == 0   ? valid[index]
                       : kind % 3 == 1 ? spoilt(valid[index])
                                       : noise();
        }
        sent += send_burst(fd[n % 2], burst, BURST);
        next += BURST / rate;
        sleep_until(next);
    }
    return sent;
}

// the next status, if one comes within `ms`
static lo_message hear_status(int ear, int ms)
{
    _Alignas(8) char data[8192];
    struct pollfd at = {ear, POLLIN, 0};
    while (poll(&at, 1, ms) > 0) {
        ssize_t size = recv(ear, data, sizeof data, 0);
        // a bundle of one message
        if (size > 40 && strcmp(data + 20, "/himc/status") == 0)
            return lo_message_deserialise(data + 20, (size_t)size - 20, NULL);
    }
    return NULL;
}

static double value(lo_message status, const char *name)
{
    lo_arg **a = lo_message_get_argv(status);
    float value = -1;
    for (int i = 0; i + 1 < lo_message_get_argc(status); i += 2)
        if (strcmp(&a[i]->s, name) == 0)
            memcpy(&value, a[i + 1], sizeof value);
    return value;
}

static long subscribe(int ear)
{
    struct sockaddr_in at;
    socklen_t length = sizeof at;
    packet p = {.size = SIZE};
    lo_message m = lo_message_new();
    getsockname(ear, (struct sockaddr *)&at, &length);
    lo_message_add(m, "sis", "127.0.0.1", ntohs(at.sin_port), "strikes");
    lo_message_serialise(m, "/himc/subscribe", p.data, &p.size);
    lo_message_free(m);
    return send_burst(ear, &p, 1);
}

static void report(lo_message status, long sent, double pace, double share, long dropped)
{
    static const char *const counters[] = {"packets", "overrun",  "malformed", "foreign",
                                           "refused", "frequent", "commands"};
    printf("sent %ld pace %.0f share %.3f dropped %ld", sent, pace, share, dropped);
    for (size_t i = 0; i < sizeof counters / sizeof *counters; i++)
        printf(" %s %.0f", counters[i], value(status, counters[i]));
    printf("\n");
}

int main(int argc, char **argv)
{
    static packet valid[COMMANDS];
    int fd[3]; // the last one hears
    if (argc == 4 && strcmp(argv[1], "burn") == 0) {
        burn(atof(argv[2]), atof(argv[3]));
        return 0;
    }
    if (argc != 5)
        return 2;
    struct sockaddr_in to = {.sin_family = AF_INET,
                             .sin_addr.s_addr = htonl(INADDR_LOOPBACK),
                             .sin_port = htons((uint16_t)atoi(argv[1]))};
    for (int i = 0; i < COMMANDS; i++)
        valid[i] = command(i);
    for (int i = 0; i < 3; i++) {
        fd[i] = socket(AF_INET, SOCK_DGRAM, 0);
        if (connect(fd[i], (struct sockaddr *)&to, sizeof to) != 0)
            return 2;
    }
    lo_message status = NULL;
    long sent = 0, before = atol(argv[4]), dropped = queue_dropped();
    for (int i = 0; !status && i < PATIENCE; i++) {
        sent += subscribe(fd[2]);
        status = hear_status(fd[2], 1000);
    }
    if (!status)
        return 1;
    double begun = now(), used = read_clock(CLOCK_PROCESS_CPUTIME_ID) + interrupts();
    long storm = send_storm(fd, valid, atol(argv[2]), atof(argv[3]));
    double took = now() - begun, pace = (double)storm / took;
    double share = (read_clock(CLOCK_PROCESS_CPUTIME_ID) + interrupts() - used) / took;
    bool all = false;
    sent += storm;
    for (begun = now(); !all && now() - begun < PATIENCE;) {
        // the system reports its losses with the next packet that it takes
        sent += send_burst(fd[0], &valid[0], 1);
        lo_message newer = hear_status(fd[2], 1000);
        if (!newer)
            continue;
        lo_message_free(status);
        status = newer;
        long arrived = before + sent - (queue_dropped() - dropped);
        all = value(status, "packets") + value(status, "overrun") >= (double)arrived;
    }
    report(status, sent, pace, share, queue_dropped() - dropped);
    return !all;
}
