/// packets.c: a performance heard through a bad network, for test_distributed.sh: the packets that
/// `himc serve` would send, and the times at which they arrive, all by the samples' clock.
///
///     packets SCORE JITTER LOSS LOG
///
/// Plays SCORE. Each strike and, once a second, the status is a packet that arrives 0 to JITTER ms
/// after it was sent, each by its own delay, so that packets overtake each other; a share LOSS of
/// the strikes is lost. Writes lines for [qlist], `DELAY himc-packets BYTE ...`, and into LOG for
/// each strike `NUMBER TIME through|lost`.
#include "himc/himc.h"
#include "osc/encode.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BLOCK 96 // as of `himc serve`
#define RATE 48000
#define PACKETS_MOST 4096

typedef struct packet {
    double due; // (ms)
    size_t size;
    unsigned char data[SMALL_PACKET];
} packet;

static packet waiting[PACKETS_MOST];
static int count;

static double draw(uint64_t *state) // 0 .. 1
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) / 9007199254740992.0;
}

static void send_packet(const osc_packets *p, double due)
{
    if (count == PACKETS_MOST)
        exit(3);
    waiting[count].due = due;
    waiting[count].size = p->size[0];
    memcpy(waiting[count++].data, p->data[0], p->size[0]);
}

static int by_due(const void *a, const void *b)
{
    double x = ((const packet *)a)->due, y = ((const packet *)b)->due;
    return (x > y) - (x < y);
}

static void print_packets(void)
{
    double at = 0;
    qsort(waiting, (size_t)count, sizeof *waiting, by_due);
    for (packet *p = waiting; p < waiting + count; at = p++->due) {
        printf("%.4f himc-packets", p->due - at);
        for (size_t i = 0; i < p->size; i++)
            printf(" %d", p->data[i]);
        printf(";\n");
    }
    printf("1000 pd quit;\n");
}

static himc_performance *play(const char *path)
{
    himc_error error;
    himc_command command;
    himc_atom atom = {HIMC_ATOM_SYMBOL, 0, path};
    himc_performance_config config = himc_performance_default();
    himc_performance *p = himc_performance_new(&config, &error);
    himc_drum *drum = p ? himc_drum_new("kettle", 23, RATE, &error) : NULL;
    if (!drum || !himc_performance_add_drum(p, drum, &error) ||
        !himc_command_parse(&command, HIMC_PERFORMER, "score", &atom, 1, &error) ||
        !himc_performance_command(p, &command, 0, &error) ||
        !himc_command_parse_text(&command, HIMC_PERFORMER, "play", &error) ||
        !himc_performance_command(p, &command, 0, &error)) {
        fprintf(stderr, "%s\n", error.text);
        exit(2);
    }
    himc_drum_release(drum);
    return p;
}

typedef struct network {
    double jitter, loss; // (ms; share)
    uint64_t losses, delays;
    long strikes;
    FILE *log;
} network;

static void send_strike(network *n, const himc_strike *strike, double ms)
{
    osc_packets packets;
    bool lost = draw(&n->losses) < n->loss;
    fprintf(n->log, "%ld %.7f %s\n", ++n->strikes, strike->time, lost ? "lost" : "through");
    himc_osc_encode_begin(&packets, SMALL_PACKET, true, strike->time);
    himc_osc_encode_strike(&packets, &(osc_strike){*strike, n->strikes});
    if (!lost)
        send_packet(&packets, ms + n->jitter * draw(&n->delays));
}

static void send_status(network *n, himc_performance *p, double ms)
{
    osc_packets packets;
    osc_status status = {himc_performance_measure(p), 0, n->strikes};
    himc_osc_encode_begin(&packets, SMALL_PACKET, true, ms / 1000);
    himc_osc_encode_status(&packets, &status, &(himc_osc_counts){0});
    send_packet(&packets, ms + n->jitter * draw(&n->delays));
}

int main(int argc, char **argv)
{
    if (argc != 5)
        return 2;
    // seeds by which the last strike is among the lost
    network n = {atof(argv[2]), atof(argv[3]), 27, 11, 0, fopen(argv[4], "w")};
    if (!n.log)
        return 2;
    himc_performance *p = play(argv[1]);
    himc_event event;
    // two more seconds after the end, with the last status
    double end = INFINITY;
    for (long block = 1; (double)block * 1e3 * BLOCK / RATE < end; block++) {
        double ms = (double)block * 1e3 * BLOCK / RATE;
        himc_performance_process(p, BLOCK, (double *[HIMC_HANDS]){NULL, NULL});
        while (himc_performance_event(p, &event)) {
            if (event.kind == HIMC_EVENT_STRIKE)
                send_strike(&n, &event.strike, ms);
            else if (event.kind == HIMC_EVENT_DONE)
                end = ms + 2000;
        }
        if (block % (RATE / BLOCK) == 0)
            send_status(&n, p, ms);
    }
    print_packets();
    himc_performance_free(p);
    fclose(n.log);
    return 0;
}
