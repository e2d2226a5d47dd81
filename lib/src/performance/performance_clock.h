/// performance_clock.h: the part of a performance that counts samples and physics steps.
#ifndef HIMC_PERFORMANCE_CLOCK_H
#define HIMC_PERFORMANCE_CLOCK_H

#include "himc/base.h"

#include <stdint.h>

/// All counts are in samples from time 0: the moment at which the performance was made or reset.
typedef struct performance_clock {
    double sample_rate;  ///< (Hz)
    double physics_rate; ///< in force: never above the sample rate (Hz)
    double task_rate;    ///< (Hz)
    int64_t played;      ///< taken by the host; below 0 while samples from before a reset remain
    int64_t aligned;     ///< zero of himc_performance_time
    int64_t made;        ///< simulated: the next step begins here
    int64_t step_origin; ///< where step 0 began
    int64_t step;        ///< steps since then
} performance_clock;

/// Time of the next step (s).
static inline double himc_clock_time(const performance_clock *clock)
{
    return (double)clock->made / clock->sample_rate;
}

/// Samples that are simulated and not yet played.
static inline int himc_clock_ahead(const performance_clock *clock)
{
    return (int)(clock->made - clock->played);
}

/// Starts at time 0 with that sample rate; call himc_clock_set_rates next.
void himc_clock_init(performance_clock *clock, double sample_rate);
/// Sets the rates of physics and tasks; step 0 begins now.
HIMC_RT void himc_clock_set_rates(performance_clock *clock, double physics, double task);
/// Sets the sample rate. Time in seconds and the samples played since the last realign continue.
HIMC_RT void himc_clock_set_sample_rate(performance_clock *clock, double sample_rate);
/// Sets time 0 to now; the count of samples played since the last realign continues.
HIMC_RT void himc_clock_restart(performance_clock *clock);
/// Counts the samples played from 0 again.
HIMC_RT void himc_clock_realign(performance_clock *clock);

/// Whether a task tick falls on the next step.
HIMC_RT bool himc_clock_is_tick(const performance_clock *clock);
/// Time of the first task tick after the next step's beginning (s).
HIMC_RT double himc_clock_next_tick(const performance_clock *clock);
/// Samples of the next step.
HIMC_RT int himc_clock_step_samples(const performance_clock *clock);
/// A step of `n` samples has been simulated.
HIMC_RT void himc_clock_step(performance_clock *clock, int n);
/// The host has taken `n` samples.
HIMC_RT void himc_clock_play(performance_clock *clock, int n);

#endif
