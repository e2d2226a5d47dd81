/// claim.c: conditions of the published claim: HIMC has a smaller error of the tip than joint
/// space control, by "about 2% of motion amplitude" (Bouënard, Gibet & Wanderley 2012, section
/// 3.3.2). `claim rates|nuances|measures TRIALS` prints a CSV table; errors in percent of
/// amplitude, `gain` over the stiffness of a player (the default gain is 3), difference is ID minus
/// HIMC.
///
/// `rates`: legato at 1 to 3 strokes a second with each hand under the printed law, three gains,
/// joint limits on and off (claim.gp). `measures`: legato at its own rate, limits on, limbs
/// measured with errors of 0 to 2 %, the printed law with the softest gain and each law with the
/// default one (measures.gp). `nuances`: each nuance at its own rate under the printed law with the
/// softest gain, limits on (evaluation.gp, the same columns as spread.awk). Trials run on all
/// cores.
#include "tools/himc/pool.h"
#include "tools/himc/trial.h"
#include "control/controller.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MOST_TRIALS 100 // as many as the evaluation has by default
#define PLAYER 3.0      // default gain over a player's stiffness (docs/results/evaluation.md)
#define CONTROLS 2      // id, himc
#define GAINS 3
#define RATES 5
#define LAWS 4
#define ERRORS 5

static const double gains[GAINS] = {1 / PLAYER, 2 / PLAYER, 1};
static const double rates[RATES] = {1, 1.5, 2, 2.5, 3};
static const himc_pipeline controls[CONTROLS] = {HIMC_PIPELINE_ID, HIMC_PIPELINE_HIMC};
static const himc_law laws[LAWS] = {HIMC_LAW_PRINTED, HIMC_LAW_PRINTED, HIMC_LAW_FEEDFORWARD,
                                    HIMC_LAW_COMPUTED_TORQUE};
static const double errors[ERRORS] = {0, 0.005, 0.01, 0.015, 0.02};

typedef struct claim claim;

typedef struct table {
    const char *name, *columns;
    int rows;
    void (*set)(trial_config *config, int row); ///< from a printed legato trial with limits
    void (*print)(const claim *c, int row);
} table;

/// All trials of a table: rows, each of both controls.
struct claim {
    const table *table;
    int trials;
    double *percent; ///< RMS over amplitude (rows, trials, CONTROLS)
};

// the rate runs fastest, then limits, then the gain
static void set_rate(trial_config *config, int row)
{
    config->gain = gains[row / RATES / 2];
    config->limits = row / RATES % 2 == 0;
    config->pace = rates[row % RATES] / trial_own_rate(config);
}

static void set_nuance(trial_config *config, int row)
{
    config->kind.nuance = (himc_nuance)row;
    config->gain = gains[0];
}

// the error runs fastest, then the law
static void set_measures(trial_config *config, int row)
{
    config->kind.law = laws[row / ERRORS];
    config->gain = row / ERRORS == 0 ? gains[0] : 1;
    config->length_error = errors[row % ERRORS];
}

static trial_config config_of(const claim *c, int item)
{
    trial_kind kind = {HIMC_LEGATO, controls[item % CONTROLS], HIMC_LAW_PRINTED};
    trial_config config = trial_default(&kind, 1 + item / CONTROLS % c->trials);
    c->table->set(&config, item / CONTROLS / c->trials);
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

/// Statistics of a * id + b * himc over the trials of a row (% of amplitude).
typedef struct spread {
    double mean, deviation; ///< of all trials
    double disturbance;     ///< deviation within the same sequence; NaN if no two trials share one
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

static void print_spread(const claim *c, int nuance, const char *control, spread s)
{
    printf("%g,%s,%s,printed,%d,%.4f,%.4f,%.4f\n", PLAYER * gains[0],
           himc_nuance_name((himc_nuance)nuance), control, c->trials, s.mean, s.deviation,
           s.disturbance);
}

static void print_nuance(const claim *c, int row)
{
    print_spread(c, row, "id", spread_of(c, row, 1, 0));
    print_spread(c, row, "himc", spread_of(c, row, 0, 1));
}

// the rest of a row: x, trials, errors
static void print_point(const claim *c, int row, double x)
{
    spread id = spread_of(c, row, 1, 0), himc = spread_of(c, row, 0, 1);
    spread difference = spread_of(c, row, 1, -1);
    printf("%g,%d,%.4f,%.4f,%.4f,%.4f\n", x, c->trials, id.mean, himc.mean, difference.mean,
           difference.deviation);
}

static void print_rate(const claim *c, int row)
{
    printf("%g,%s,", PLAYER * gains[row / RATES / 2], row / RATES % 2 ? "off" : "on");
    print_point(c, row, rates[row % RATES]);
}

static void print_measures(const claim *c, int row)
{
    trial_kind kind = {.law = laws[row / ERRORS]};
    printf("%g,%s,", PLAYER * (row / ERRORS == 0 ? gains[0] : 1), trial_law_name(&kind).text);
    print_point(c, row, 100 * errors[row % ERRORS]);
}

#define ERROR_COLUMNS "trials,id_percent,himc_percent,difference,difference_sd"
static const table tables[] = {
    {"rates", "gain,limits,strokes_per_s," ERROR_COLUMNS, GAINS * 2 * RATES, set_rate, print_rate},
    {"nuances", "gain,nuance,controller,law,trials,mean_percent,sd,sequence_sd", HIMC_NUANCES,
     set_nuance, print_nuance},
    {"measures", "gain,law,error_percent," ERROR_COLUMNS, LAWS *ERRORS, set_measures,
     print_measures},
};

static const table *find_table(const char *name)
{
    for (size_t i = 0; i < sizeof tables / sizeof *tables; i++)
        if (!strcmp(tables[i].name, name))
            return &tables[i];
    return NULL;
}

static bool measure(claim *c, himc_error *error)
{
    int items = c->table->rows * c->trials * CONTROLS;
    c->percent = calloc((size_t)items, sizeof *c->percent);
    if (!c->percent)
        return himc_error_set(error, "out of memory");
    pool spread_out = {items, pool_cores(), sizeof(double), work, done, c};
    return pool_run(&spread_out, error);
}

int main(int count, char **word)
{
    himc_error error;
    claim c = {.table = count == 3 ? find_table(word[1]) : NULL,
               .trials = count == 3 ? atoi(word[2]) : 0};
    if (!c.table || c.trials < 1 || c.trials > MOST_TRIALS) {
        fprintf(stderr, "usage: claim rates|nuances|measures TRIALS (1 .. %d)\n", MOST_TRIALS);
        return 1;
    }
    bool good = measure(&c, &error);
    if (good)
        puts(c.table->columns);
    for (int row = 0; good && row < c.table->rows; row++)
        c.table->print(&c, row);
    if (!good)
        fprintf(stderr, "claim: %s\n", error.text);
    free(c.percent);
    return !good;
}
