/// claim.c: what the published claim depends on: that HIMC misses less than joint space control,
/// by "about 2% of motion amplitude" (Bouënard, Gibet & Wanderley 2012, section 3.3.2), for
/// claim.gp and evaluation.gp: `claim rates TRIALS` and `claim nuances TRIALS`.
///
/// `rates` plays legato at 1 to 3 strokes a second with each hand, under the printed law, with
/// three gains, joint limits on and off: a block for each gain and limits, rows of rate (1/s), mean
/// RMS of `id` and of `himc` (% of amplitude), mean and standard deviation over the trials of their
/// difference. `nuances` plays each nuance at its own pace with the softest gain and limits on:
/// rows of nuance, `id`, `himc` or `less` (their difference), law, mean (% of amplitude), standard
/// deviation of all trials, and of those of the same sequence. Trials are spread over the cores.
#include "../pool.h"
#include "../trial.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TRIALS_MOST 100
#define CONTROLS 2 // id, himc
#define GAINS 3
#define RATES 5

static const double gains[GAINS] = {1.0 / 3, 2.0 / 3, 1};
static const double rates[RATES] = {1, 1.5, 2, 2.5, 3};
static const himc_pipeline controls[CONTROLS] = {HIMC_PIPELINE_ID, HIMC_PIPELINE_HIMC};

/// All trials of a table: rows, each of both controls.
typedef struct claim {
    bool by_nuance;
    int rows, trials;
    double *percent; ///< RMS over amplitude (rows, trials, CONTROLS)
} claim;

// rows of `rates`: the rate runs fastest, then limits, then the gain
static trial_config config_of(const claim *c, int item)
{
    int row = item / CONTROLS / c->trials, number = 1 + item / CONTROLS % c->trials;
    trial_kind kind = {c->by_nuance ? (himc_nuance)row : HIMC_LEGATO, controls[item % CONTROLS],
                       HIMC_LAW_PRINTED};
    trial_config config = trial_default(&kind, number);
    config.gain = gains[0];
    if (c->by_nuance)
        return config;
    config.gain = gains[row / RATES / 2];
    config.limits = row / RATES % 2 == 0;
    config.pace = rates[row % RATES] / trial_own_rate(&config);
    return config;
}

static bool work(void *user, int item, void *result, himc_error *error)
{
    trial_result r;
    trial_config config = config_of(user, item);
    if (!trial_run(&config, &r, error))
        return false;
    double percent = 100 * r.rms / r.amplitude;
    memcpy(result, &percent, sizeof percent);
    return true;
}

static bool done(void *user, int item, const void *result, himc_error *error)
{
    (void)error;
    claim *c = user;
    memcpy(&c->percent[item], result, sizeof *c->percent);
    return true;
}

/// Of a row's trials, `id` times a plus `himc` times b.
typedef struct spread {
    double mean, deviation; ///< of all trials
    double disturbance;     ///< deviation of trials of the same sequence; NaN if there are no two
} spread;

static spread spread_of(const claim *c, int row, double a, double b)
{
    const double *percent = &c->percent[row * c->trials * CONTROLS];
    double sum = 0, squares = 0, disturbed = 0, own[TRIAL_SEQUENCES] = {0};
    int n = c->trials, sequences = n < TRIAL_SEQUENCES ? n : TRIAL_SEQUENCES;
    for (int i = 0; i < n; i++)
        sum += a * percent[CONTROLS * i] + b * percent[CONTROLS * i + 1];
    for (int i = 0; i < n; i++) {
        double off = a * percent[CONTROLS * i] + b * percent[CONTROLS * i + 1] - sum / n;
        squares += off * off;
        disturbed += off * off;
        own[i % TRIAL_SEQUENCES] += off;
    }
    for (int k = 0; k < sequences; k++)
        disturbed -= own[k] * own[k] / ((n - 1 - k) / TRIAL_SEQUENCES + 1);
    return (spread){sum / n, n > 1 ? sqrt(squares / (n - 1)) : 0,
                    n > sequences ? sqrt(disturbed / (n - sequences)) : NAN};
}

static void print_nuance(int nuance, const char *control, spread s)
{
    printf("%s %s printed %.4f %.4f %.4f\n", himc_nuance_name((himc_nuance)nuance), control, s.mean,
           s.deviation, s.disturbance);
}

static void print_row(const claim *c, int row)
{
    spread id = spread_of(c, row, 1, 0), himc = spread_of(c, row, 0, 1);
    spread less = spread_of(c, row, 1, -1);
    if (c->by_nuance) {
        print_nuance(row, "id", id);
        print_nuance(row, "himc", himc);
        print_nuance(row, "less", less);
        return;
    }
    if (row % RATES == 0)
        printf("\n\n# gain %.4f, limits %s\n", gains[row / RATES / 2],
               row / RATES % 2 ? "off" : "on");
    printf("%.2f %.4f %.4f %.4f %.4f\n", rates[row % RATES], id.mean, himc.mean, less.mean,
           less.deviation);
}

static bool measure(claim *c, himc_error *error)
{
    c->rows = c->by_nuance ? HIMC_NUANCES : GAINS * 2 * RATES;
    int items = c->rows * c->trials * CONTROLS;
    c->percent = calloc((size_t)items, sizeof *c->percent);
    if (!c->percent)
        return himc_error_set(error, "out of memory");
    pool spread_out = {items, pool_cores(), sizeof(double), work, done, c};
    return pool_run(&spread_out, error);
}

int main(int count, char **word)
{
    himc_error error;
    claim c = {.by_nuance = count == 3 && !strcmp(word[1], "nuances"),
               .trials = count == 3 ? atoi(word[2]) : 0};
    if (c.trials < 1 || c.trials > TRIALS_MOST || (!c.by_nuance && strcmp(word[1], "rates"))) {
        fprintf(stderr, "claim: wanted is rates|nuances TRIALS, 1 .. %d\n", TRIALS_MOST);
        return 1;
    }
    bool good = measure(&c, &error);
    for (int row = 0; good && row < c.rows; row++)
        print_row(&c, row);
    if (!good)
        fprintf(stderr, "claim: %s\n", error.text);
    free(c.percent);
    return !good;
}
