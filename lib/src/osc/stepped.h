/// stepped.h: a himc_osc with clock and network thread controlled by its caller, so that
/// rates, limits and time-outs can be tested exactly and without waiting.
#ifndef HIMC_OSC_STEPPED_H
#define HIMC_OSC_STEPPED_H

#include "himc/osc.h"

/// All times that a himc_osc knows come from these two functions; himc_osc_new takes those of the
/// system (CLOCK_MONOTONIC and CLOCK_REALTIME).
typedef struct osc_clock {
    double (*monotonic)(void *user); ///< (s)
    double (*wall)(void *user);      ///< (s since 1970)
    void *user;
} osc_clock;

/// As himc_osc_new, but without a thread: the network is served by himc_osc_step alone. A himc_osc
/// made of this one by himc_osc_reopen has the same clock and no thread either.
himc_osc *himc_osc_new_stepped(const himc_osc_config *config, const osc_clock *clock,
                               himc_error *error);

/// One pass of the network thread, without waiting: packets in, states out. True if more packets
/// arrive than are accepted, so that a pause is due.
bool himc_osc_step(himc_osc *osc);

#endif
