/// osc.h: a performance on the network: commands in, poses, strikes and states out, as OSC over
/// UDP.
///
/// A himc_osc has a thread of its own. Between it and the host (an audio callback, Pd's scheduler)
/// are two wait-free rings of fixed size: the host never waits for the network, and what does not
/// fit is dropped and counted. The host calls, from one thread:
///
///     himc_performance_on_tick(performance, himc_osc_tick, osc);       once
///     himc_osc_receive(osc, performance, most);                        before a block
///     himc_performance_process(performance, n, force);
///     while (himc_performance_event(performance, &event))
///         himc_osc_event(osc, &event);
///     himc_osc_publish(osc, performance, seconds_spent);               after it
///     while (himc_osc_line(osc, line)) ...                             for the user
#ifndef HIMC_OSC_H
#define HIMC_OSC_H

#include "himc/performance.h"

#define HIMC_OSC_PORT 9000  ///< where `himc serve` listens unless told otherwise
#define HIMC_VMC_PORT 39539 ///< where programs that show avatars listen
#define HIMC_OSC_LINE 512   ///< longest line (bytes)

typedef struct himc_osc_config {
    const char *bind;  ///< numeric address to listen at; NULL is 127.0.0.1
    int port;          ///< 0 .. 65535, 0 any free one; -1 does not listen
    const char *files; ///< folder that `score` and `take` are confined to; NULL allows no file
    const char *allow; ///< hosts, separated by commas, that anyone may subscribe for; NULL none
} himc_osc_config;

/// 127.0.0.1, HIMC_OSC_PORT, no files, nobody else.
himc_osc_config himc_osc_default(void);

typedef struct himc_osc himc_osc;

/// Opens the socket and starts the thread; NULL with one line if the port is taken, the address
/// not one of this machine, a host of `allow` unknown, `files` no folder.
himc_osc *himc_osc_new(const himc_osc_config *config, himc_error *error);
/// The same instead of `old`, which may be NULL: its subscriptions go on and it is freed. On error
/// NULL, and `old` is as it was.
himc_osc *himc_osc_reopen(himc_osc *old, const himc_osc_config *config, himc_error *error);
void himc_osc_free(himc_osc *osc);
/// The port it listens at, or 0.
int himc_osc_port(const himc_osc *osc);

/// `subscribe` or `unsubscribe` by the user of this machine, who may name any host. What comes of
/// it is told by himc_osc_line. False if too many wait.
HIMC_RT bool himc_osc_command(himc_osc *osc, const himc_command *command, himc_error *error);

/// Carries out at most `most` commands that came by OSC, no more than take a tenth of the time and
/// only one at a time that takes long; their errors go back to who sent them.
/// Setup: a command may read a file.
void himc_osc_receive(himc_osc *osc, himc_performance *performance, int most);

/// Takes a pose for those who subscribed; for himc_performance_on_tick. `osc` is a himc_osc.
HIMC_RT void himc_osc_tick(void *osc, const himc_tick *tick);
/// Takes a strike or a beat.
HIMC_RT void himc_osc_event(himc_osc *osc, const himc_event *event);
/// After a block that took `busy` seconds to compute: drumheads, rates and counters, and how the
/// samples' time lies on the wall clock, for time tags.
HIMC_RT void himc_osc_publish(himc_osc *osc, himc_performance *performance, double busy);

/// A line for the user: a receiver that vanished, a host that is not known. False if none waits.
HIMC_RT bool himc_osc_line(himc_osc *osc, char line[HIMC_OSC_LINE]);

/// What came and went since the start.
typedef struct himc_osc_counts {
    long packets;      ///< taken from the network
    long commands;     ///< handed on
    long malformed;    ///< not OSC, or an atom that is neither number nor word
    long foreign;      ///< an address that is none of ours
    long refused;      ///< a command with an error, a file or host that is not allowed
    long frequent;     ///< beyond what is taken of any second
    long overrun;      ///< lost in the system before we saw them
    long sent, unsent; ///< packets out; those the system did not take
    long lost;         ///< records that found a ring full
    int subscriptions;
} himc_osc_counts;

HIMC_RT himc_osc_counts himc_osc_count(const himc_osc *osc);

#endif
