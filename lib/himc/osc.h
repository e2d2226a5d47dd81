/// osc.h: a performance on the network, as OSC over UDP: commands in; poses, strikes, states out.
///
/// A himc_osc has a thread of its own. Between it and the host (an audio callback, Pd's scheduler)
/// are wait-free rings of fixed size: the host never waits for the network, and records that do not
/// fit are dropped and counted. The host calls, from one thread:
///
///     himc_performance_on_tick(performance, himc_osc_tick, osc);       once
///     himc_loader_run(loader);                                         before a block, if any
///     himc_osc_receive(osc, performance, most);
///     himc_performance_process(performance, n, force);
///     while (himc_performance_event(performance, &event))
///         himc_osc_event(osc, &event);
///     himc_osc_publish(osc, performance, seconds_spent);               after it
///     while (himc_osc_line(osc, line)) ...                             for the user
#ifndef HIMC_OSC_H
#define HIMC_OSC_H

#include "himc/loader.h"
#include "himc/performance.h"

HIMC_BEGIN

#define HIMC_OSC_PORT 9000  ///< default port of `himc serve`; chosen
#define HIMC_VMC_PORT 39539 ///< default port of programs that show avatars (protocol.vmc.info)
#define HIMC_OSC_LINE 512   ///< longest line (bytes)

/// Where a himc_osc listens, and what others may do. Strings are borrowed for the call.
typedef struct himc_osc_config {
    const char *bind;  ///< numeric address to listen at; NULL is 127.0.0.1
    int port;          ///< 0 .. 65535, 0 any free one; -1 does not listen
    const char *files; ///< the only folder whose files `score` and `take` may read, also those in a
                       ///< score that came over the network; NULL allows no file
    const char *allow; ///< hosts, separated by commas, that anyone may subscribe; NULL none
    himc_loader *loader; ///< carries out the commands; borrowed, must outlive it. NULL: all at once
} himc_osc_config;

/// 127.0.0.1, HIMC_OSC_PORT, no files, no other hosts.
himc_osc_config himc_osc_default(void);

/// A socket, its thread and its subscriptions. Opaque.
typedef struct himc_osc himc_osc;

/// Opens the socket and starts the thread. NULL with one line if the port is taken, the address is
/// not one of this machine, a host of `allow` is unknown or `files` is no folder.
himc_osc *himc_osc_new(const himc_osc_config *config, himc_error *error);
/// The same in place of `old`, which may be NULL: its subscriptions continue and it is freed. On
/// error NULL, and `old` is unchanged.
himc_osc *himc_osc_reopen(himc_osc *old, const himc_osc_config *config, himc_error *error);
/// Ends the thread and closes the socket. NULL is allowed.
void himc_osc_free(himc_osc *osc);
/// The port that it listens at, 0 if it does not listen.
int himc_osc_port(const himc_osc *osc);

/// `subscribe` or `unsubscribe` by the user of this machine, who may name any host. himc_osc_line
/// gives the result if it fails later. False if too many are waiting.
HIMC_RT bool himc_osc_command(himc_osc *osc, const himc_command *command, himc_error *error);

/// Carries out at most `most` commands that came by OSC. They may take a tenth of the time on
/// average, and a call ends after one that takes long. With a loader the call ends at a command
/// that waits there, and the next ones begin when it is carried out; without one, this call reads
/// its file. Errors go back to the sender.
void himc_osc_receive(himc_osc *osc, himc_performance *performance, int most);

/// Takes a pose for the subscribers; for himc_performance_on_tick. `osc` is a himc_osc.
HIMC_RT void himc_osc_tick(void *osc, const himc_tick *tick);
/// Takes a strike or a beat.
HIMC_RT void himc_osc_event(himc_osc *osc, const himc_event *event);
/// After a block that took `busy` to compute (s): takes drumheads, rates and counters, and compares
/// the samples' time with the wall clock, for time tags.
HIMC_RT void himc_osc_publish(himc_osc *osc, himc_performance *performance, double busy);

/// A line for the user: a receiver vanished, a host is unknown. False if there is none.
HIMC_RT bool himc_osc_line(himc_osc *osc, char line[HIMC_OSC_LINE]);

/// Counters since himc_osc_new or himc_osc_reopen.
typedef struct himc_osc_counts {
    long packets;      ///< received
    long commands;     ///< accepted
    long malformed;    ///< not OSC, or an atom that is neither number nor word
    long foreign;      ///< an OSC address that is none of ours
    long refused;      ///< a command with an error, a file or a host that is not allowed
    long frequent;     ///< commands beyond the limits of a second, or waiting too long
    long overrun;      ///< packets dropped by the system, not read in time
    long sent;         ///< packets out
    long unsent;       ///< packets that the system refused to send
    long capped;       ///< packets dropped because their host had its bytes of the second
    long lost;         ///< records dropped because a ring was full
    int subscriptions; ///< now in force
} himc_osc_counts;

/// The counters now.
HIMC_RT himc_osc_counts himc_osc_count(const himc_osc *osc);

HIMC_END

#endif
