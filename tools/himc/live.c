/// live.c: a performance from its source, and what is heard of it; for all calls that play.
#include "cli.h"

#include <math.h>

#define REST_SECONDS 2.5 // after the last contact, until the sticks are at rest; chosen
#define SILENCE 1e-4     // of the peak: 80 dB, ...
#define FAINT 1e-3       // ... and 60, enough of what still rings ...
#define LONG 8.0         // ... after so long (s), as only metal does; chosen

static bool load(himc_performance *p, const char *source, double rate, const char *listener,
                 himc_error *error)
{
    bool take = source && cli_is_take(source);
    himc_score *score = source && !take ? himc_score_load(source, error) : NULL;
    bool good = score || !source || take, drums = score && cli_first_drum(score);
    himc_score_free(score);
    return good && (drums || cli_add_drum(p, rate, error)) &&
           (!listener || cli_tell(p, listener, NULL, error)) &&
           (!source || cli_tell(p, take ? "take" : "score", source, error));
}

himc_performance *cli_load(const char *source, double rate, const char *listener, himc_error *error)
{
    himc_performance_config config = himc_performance_default();
    config.sample_rate = rate;
    config.physics_rate = fmin(config.physics_rate, rate);
    himc_performance *performance = himc_performance_new(&config, error);
    if (!performance)
        return NULL;
    himc_performance_make_drums(performance, true);
    if (load(performance, source, rate, listener, error)) {
        cli_unwatch(performance);
        return performance;
    }
    himc_performance_free(performance);
    return NULL;
}

void cli_unwatch(himc_performance *performance)
{
    himc_drum *drum;
    for (int d = 0; (drum = himc_performance_drum(performance, d)); d++)
        himc_drum_watch(drum, false);
}

bool cli_is_over(cli_ending *e, int rate)
{
    e->peak = fmax(e->peak, e->cell_peak);
    double level = e->cell_peak;
    e->cell_peak = 0;
    if (!e->done)
        return false;
    if (!e->done_at)
        e->done_at = e->samples;
    double since = (double)(e->samples - e->done_at) / rate;
    bool silent = level <= (since < LONG ? SILENCE : FAINT) * e->peak;
    return (silent && since >= REST_SECONDS) || since >= CLI_TAIL;
}
