/// performance_clock.h: the part of a performance that counts samples and physics steps.
///
/// Step k of the physics covers the samples from floor(k fs / F_S) to floor((k + 1) fs / F_S),
/// counted from the last change of the rates: 4 or 5 samples of 48 kHz at 10 kHz, 24 in every 5
/// steps. A task tick comes every round(F_S / F_T) steps.
#ifndef HIMC_PERFORMANCE_CLOCK_H
#define HIMC_PERFORMANCE_CLOCK_H

#include "himc/base.h"

#include <math.h>

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
static inline double himc_clock_time(const performance_clock *c)
{
    return (double)c->made / c->sample_rate;
}

/// Samples that are simulated and not yet played.
static inline int himc_clock_ahead(const performance_clock *c)
{
    return (int)(c->made - c->played);
}

/// Sets the rates of physics and tasks; step 0 begins now.
static inline void himc_clock_set_rates(performance_clock *c, double physics, double task)
{
    c->physics_rate = fmin(physics, c->sample_rate);
    c->task_rate = task;
    c->step_origin = c->made;
    c->step = 0;
}

/// Sets the sample rate. Time in seconds and the samples played since the last realign continue.
static inline void himc_clock_set_sample_rate(performance_clock *c, double sample_rate)
{
    double t = himc_clock_time(c);
    int64_t ahead = c->made - c->played, since = c->played - c->aligned;
    c->sample_rate = sample_rate;
    c->made = (int64_t)ceil(t * sample_rate);
    c->played = c->made - ahead;
    c->aligned = c->played - since;
}

/// Sets time 0 to now; the count of samples played since the last realign continues.
static inline void himc_clock_restart(performance_clock *c)
{
    c->played -= c->made;
    c->aligned -= c->made;
    c->made = c->step_origin = c->step = 0;
}

static inline int64_t himc_clock_step_begin(const performance_clock *c, int64_t step)
{
    return c->step_origin + (int64_t)floor((double)step * c->sample_rate / c->physics_rate);
}

/// Steps from one task tick to the next, at least one.
static inline int64_t himc_clock_steps_per_tick(const performance_clock *c)
{
    double ratio = round(c->physics_rate / c->task_rate);
    return ratio < 1 ? 1 : (int64_t)ratio;
}

static inline bool himc_clock_is_tick(const performance_clock *c)
{
    return c->step % himc_clock_steps_per_tick(c) == 0;
}

/// Time of the first task tick after the next step's beginning (s).
static inline double himc_clock_next_tick(const performance_clock *c)
{
    int64_t period = himc_clock_steps_per_tick(c), next = (c->step / period + 1) * period;
    return (double)himc_clock_step_begin(c, next) / c->sample_rate;
}

static inline int himc_clock_step_samples(const performance_clock *c)
{
    return (int)(himc_clock_step_begin(c, c->step + 1) - c->made);
}

#endif
