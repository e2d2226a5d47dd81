/// database.c: distance of the sticks from the captured ones without any disturbance: all 45
/// sequences of the motion database, without tracker noise, with the masses known exactly.
///
/// Prints a CSV table, a row for each nuance with `himc`, by computed torque at its own rate and by
/// feedforward at 2 strokes a second with each hand, and one for all nuances: law, nuance, RMS
/// error outside contact and with impacts (% of amplitude), smallest and largest range of the
/// elbow's height over the captured one, RMS angle of shoulder, elbow and wrist to the captured
/// joints (degrees), strokes landed, all strokes.
#include "tools/himc/pool.h"
#include "tools/himc/trial.h"
#include "control/controller.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define LAWS 2
#define ROWS (LAWS * HIMC_NUANCES)
#define RATE 2.0 // (1/s)

static const himc_law laws[LAWS] = {HIMC_LAW_COMPUTED_TORQUE, HIMC_LAW_FEEDFORWARD};

static trial_config config_of(int item)
{
    int row = item / TRIAL_SEQUENCES;
    trial_kind kind = {(himc_nuance)(row % HIMC_NUANCES), HIMC_PIPELINE_HIMC,
                       laws[row / HIMC_NUANCES]};
    trial_config config = trial_default(&kind, 1 + item % TRIAL_SEQUENCES);
    config.noise = 0;
    config.mass_error = config.length_error = 0;
    if (kind.law == HIMC_LAW_FEEDFORWARD)
        config.pace = RATE / trial_own_rate(&config);
    return config;
}

static bool work(void *user, int item, void *result, himc_error *error)
{
    (void)user;
    trial_config config = config_of(item);
    return trial_run(&config, result, error);
}

static bool done(void *user, int item, const void *result, himc_error *error)
{
    (void)error;
    memcpy((trial_result *)user + item, result, sizeof(trial_result));
    return true;
}

static double square(double x)
{
    return x * x;
}

// errors are RMS over the sequences, each in percent of its own amplitude
static void print_row(const trial_result *result, int count, const char *law, const char *nuance)
{
    double outside = 0, rms = 0, angle[3] = {0}, least = INFINITY, most = 0;
    double strokes = 0, played = 0, degrees = 180 / HIMC_PI;
    for (int i = 0; i < count; i++) {
        const trial_result *r = &result[i];
        outside += square(100 * r->outside / r->amplitude) / count;
        rms += square(100 * r->rms / r->amplitude) / count;
        angle[0] += square(degrees * r->shoulder_error) / count;
        angle[1] += square(degrees * r->elbow_error) / count;
        angle[2] += square(degrees * r->wrist_error) / count;
        least = fmin(least, r->elbow);
        most = fmax(most, r->elbow);
        strokes += r->strokes;
        played += r->played;
    }
    printf("%s,%s,%.4f,%.3f,%.3f,%.3f,%.2f,%.2f,%.2f,%.0f,%.0f\n", law, nuance, sqrt(outside),
           sqrt(rms), least, most, sqrt(angle[0]), sqrt(angle[1]), sqrt(angle[2]), played, strokes);
}

int main(void)
{
    static trial_result result[ROWS * TRIAL_SEQUENCES];
    himc_error error;
    pool spread = {ROWS * TRIAL_SEQUENCES, pool_cores(), sizeof(trial_result), work, done, result};
    if (!pool_run(&spread, &error)) {
        fprintf(stderr, "database: %s\n", error.text);
        return 1;
    }
    puts("law,nuance,outside_percent,percent,elbow_least,elbow_most,shoulder_deg,elbow_deg,"
         "wrist_deg,landed,strokes");
    for (int l = 0; l < LAWS; l++) {
        trial_kind kind = {HIMC_LEGATO, HIMC_PIPELINE_HIMC, laws[l]};
        const trial_result *own = &result[l * HIMC_NUANCES * TRIAL_SEQUENCES];
        for (int n = 0; n < HIMC_NUANCES; n++)
            print_row(&own[n * TRIAL_SEQUENCES], TRIAL_SEQUENCES, trial_law_name(&kind).text,
                      himc_nuance_name((himc_nuance)n));
        print_row(own, HIMC_NUANCES * TRIAL_SEQUENCES, trial_law_name(&kind).text, "all");
    }
    return 0;
}
