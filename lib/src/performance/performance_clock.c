/// performance_clock.c: samples, physics steps and task ticks.
///
/// Step k of the physics covers the samples from floor(k fs / F_S) to floor((k + 1) fs / F_S),
/// counted from the last change of the rates: 4 or 5 samples of 48 kHz at 10 kHz, 24 in every 5
/// steps. A task tick comes every round(F_S / F_T) steps.
#include "performance/performance_clock.h"

#include <math.h>

void himc_clock_init(performance_clock *c, double sample_rate)
{
    *c = (performance_clock){.sample_rate = sample_rate};
}

void himc_clock_set_rates(performance_clock *c, double physics, double task)
{
    c->physics_rate = fmin(physics, c->sample_rate);
    c->task_rate = task;
    c->step_origin = c->made;
    c->step = 0;
}

void himc_clock_set_sample_rate(performance_clock *c, double sample_rate)
{
    double t = himc_clock_time(c);
    int64_t ahead = c->made - c->played, since = c->played - c->aligned;
    c->sample_rate = sample_rate;
    c->made = (int64_t)ceil(t * sample_rate);
    c->played = c->made - ahead;
    c->aligned = c->played - since;
}

void himc_clock_restart(performance_clock *c)
{
    c->played -= c->made;
    c->aligned -= c->made;
    c->made = c->step_origin = c->step = 0;
}

void himc_clock_realign(performance_clock *c)
{
    c->aligned = c->played;
}

static int64_t step_begin(const performance_clock *c, int64_t step)
{
    return c->step_origin + (int64_t)floor((double)step * c->sample_rate / c->physics_rate);
}

// steps from one task tick to the next, at least one
static int64_t steps_per_tick(const performance_clock *c)
{
    double ratio = round(c->physics_rate / c->task_rate);
    return ratio < 1 ? 1 : (int64_t)ratio;
}

bool himc_clock_is_tick(const performance_clock *c)
{
    return c->step % steps_per_tick(c) == 0;
}

double himc_clock_next_tick(const performance_clock *c)
{
    int64_t period = steps_per_tick(c), next = (c->step / period + 1) * period;
    return (double)step_begin(c, next) / c->sample_rate;
}

int himc_clock_step_samples(const performance_clock *c)
{
    return (int)(step_begin(c, c->step + 1) - c->made);
}

void himc_clock_step(performance_clock *c, int n)
{
    c->made += n;
    c->step++;
}

void himc_clock_play(performance_clock *c, int n)
{
    c->played += n;
}
