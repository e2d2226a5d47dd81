/// perform.c: plays a score live, as `himc serve` does, up to a time at which it stays: poses,
/// strikes and heads over OSC. The score begins with the first sample, as in `himc render`, so that
/// both give the same motion.
///
///     perform PORT SCORE SECONDS
///
/// Prints the time of the pose that stays (s), then sends it until it is killed.
#define _POSIX_C_SOURCE 200809L
#include "himc/body.h"
#include "himc/osc.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { BLOCK = 96, RATE = 48000 };

typedef struct last_tick {
    himc_osc *osc;
    himc_body_state body;
    himc_support_forces support;
    himc_tick tick;
} last_tick;

static void die(const himc_error *error)
{
    fprintf(stderr, "perform: %s\n", error->text);
    exit(1);
}

static void on_tick(void *user, const himc_tick *tick)
{
    last_tick *last = user;
    last->body = *tick->body;
    last->tick = *tick;
    last->tick.body = &last->body;
    if (tick->support) {
        last->support = *tick->support;
        last->tick.support = &last->support;
    }
    himc_osc_tick(last->osc, tick);
}

static void wait_ms(long ms)
{
    nanosleep(&(struct timespec){0, 1000000 * ms}, NULL);
}

static void tell(himc_performance *p, const char *text)
{
    himc_command command;
    himc_error error;
    if (!himc_command_parse_text(&command, HIMC_PERFORMER, text, &error) ||
        !himc_performance_command(p, &command, 0, &error))
        die(&error);
}

static void subscribe(himc_osc *osc, const char *port, const char *what)
{
    char text[80];
    himc_command command;
    himc_error error;
    snprintf(text, sizeof text, "subscribe 127.0.0.1 %s %s", port, what);
    if (!himc_command_parse_text(&command, HIMC_PERFORMER, text, &error) ||
        !himc_osc_command(osc, &command, &error))
        die(&error);
}

static void play(himc_performance *p, himc_osc *osc, double seconds)
{
    himc_event event;
    for (long done = 0; done < (long)(seconds * RATE); done += BLOCK) {
        himc_performance_process(p, BLOCK, NULL);
        while (himc_performance_event(p, &event))
            himc_osc_event(osc, &event);
        himc_osc_publish(osc, p, 0);
        wait_ms(1); // faster than real time, and slow enough for every socket
    }
}

int main(int argc, char **argv)
{
    himc_error error = {""};
    himc_performance_config config = himc_performance_default();
    himc_osc_config network = himc_osc_default();
    network.port = -1;
    last_tick last = {0};
    himc_performance *p = argc == 4 ? himc_performance_new(&config, &error) : NULL;
    last.osc = p ? himc_osc_new(&network, &error) : NULL;
    if (!last.osc)
        die(&error);
    himc_performance_make_drums(p, true);
    for (int i = 0; i < 3; i++)
        subscribe(last.osc, argv[1], (const char *[]){"pose 250", "strikes", "head"}[i]);
    wait_ms(100); // the subscriptions act in the network's thread
    char score[4096];
    snprintf(score, sizeof score, "score %s", argv[2]);
    tell(p, score);
    tell(p, "play");
    himc_performance_on_tick(p, on_tick, &last);
    play(p, last.osc, atof(argv[3]));
    printf("%.6f\n", last.tick.time);
    fflush(stdout);
    for (;; last.tick.time += 0.02, wait_ms(20))
        himc_osc_tick(last.osc, &last.tick);
}
