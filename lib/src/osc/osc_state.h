/// osc_state.h: what a himc_osc has, and which of its two sides owns what.
///
/// osc_host.c is the host's side and alone writes `host`; osc.c is the network's, and begins and
/// ends both. Between them are the rings and the counters, and nothing else.
#ifndef HIMC_OSC_STATE_H
#define HIMC_OSC_STATE_H

#include "osc/decode.h"
#include "system/ring.h"
#include "osc/stepped.h"
#include "osc/subscribe.h"
#include "performance/describe.h"

#include <pthread.h>

#define OSC_CUT "the answer is cut after %d lines: "

/// A line of an answer.
typedef struct osc_line {
    osc_address to;
    bool error;   ///< else an information
    bool further; ///< than the first line of its answer; an error: the answer ends here, cut
    char text[HIMC_OSC_LINE];
} osc_line;

/// From host to network.
typedef struct osc_record {
    enum { RECORD_STATE, RECORD_LINE, RECORD_CHANGE } kind;
    union {
        osc_state state;
        osc_line line;
        osc_change change;
    };
} osc_record;

/// From network to host.
typedef struct osc_order {
    osc_address from;
    himc_command command;
} osc_order;

/// The sender of a command, for the lines of an answer.
typedef struct osc_sender {
    himc_osc *osc;
    const osc_address *address;
    bool error;
    int lines; ///< of this answer, so far
    bool cut;  ///< takes no further lines
} osc_sender;

/// An answer to `dump`, which is told in parts: all of it may take 10 ms.
typedef struct osc_dump {
    bool tells;
    himc_describe_place place;
    osc_address to;
    osc_sender from;
} osc_dump;

/// Owned by the host's thread.
typedef struct osc_host {
    double time;                 ///< t, of the last block (s)
    double offset;               ///< W - t (s)
    double next_pose, next_head; ///< (s, of the performance)
    double next_status;          ///< (s, wall clock)
    double published;            ///< wall clock of the last block (s)
    double busy;                 ///< computing since the last status (s)
    bool status_sent;
    uint64_t heard;                    ///< samples whose sound has been taken
    long strikes;                      ///< so far
    osc_bucket work;                   ///< time of commands (s)
    himc_loader *loader;               ///< borrowed, or NULL
    bool loading;                      ///< a command waits in the loader ...
    osc_address loading_for;           ///< ... for this sender
    char loading_drum[HIMC_NAME_SIZE]; ///< and this drum, or ""
    osc_dump dump;
    unsigned revision[HIMC_DRUMS]; ///< of the drums, as last sent
} osc_host;

#define OSC_REFUSALS 64 ///< kinds of refusals that the user is told; chosen: a page of a terminal

struct himc_osc {
    osc_clock clock;
    system_ring records, orders, lines;
    osc_counters counts;
    osc_host host;

    // owned by the network thread
    pthread_t thread;
    bool stepped, running;
    _Atomic bool stop;
    osc_network network;
    osc_subscriptions subscriptions;
    osc_bucket packets, points, answers;
    osc_packets line;               ///< the answer being sent ...
    int answered;                   ///< ... its lines that were sent ...
    bool cut;                       ///< ... and no further line is sent
    uint32_t refusal[OSC_REFUSALS]; ///< of lines that the user has been told
    int refusals;
    char *files; ///< real path, or NULL
};

static inline double himc_osc_now(const himc_osc *osc)
{
    return osc->clock.monotonic(osc->clock.user);
}

#endif
