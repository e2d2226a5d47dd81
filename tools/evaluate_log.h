/// evaluate_log.h: the results of all trials, and the file that keeps them as they come.
#ifndef EVALUATE_LOG_H
#define EVALUATE_LOG_H

#include "trial.h"

#include <stdio.h>

#define TRIALS_MAX 10000
#define TRIAL_CONTROLS (1 + 2 * TRIAL_LAWS) ///< `ik`, then `id` and `himc` under each law
#define TRIAL_KINDS (HIMC_NUANCES * TRIAL_CONTROLS)

/// Trials 1 .. `trials` of every kind.
typedef struct trial_table {
    int trials;
    trial_result *result; ///< (TRIAL_KINDS * trials)
    bool *known;          ///< (TRIAL_KINDS * trials)
} trial_table;

bool trial_table_make(trial_table *table, int trials, himc_error *error);
void trial_table_free(trial_table *table);
int trial_index(const trial_table *table, int kind, int number);
trial_kind trial_kind_of(const trial_table *table, int index);
int trial_number_of(const trial_table *table, int index);
/// One row for each kind that has trials: their mean, the RMS's standard deviation, their range.
void trial_table_print(const trial_table *table, FILE *stream);

/// A table of trials on disk, one row each. Rows may come in any order, headers between them, so
/// that logs are joined by `cat`.
typedef struct evaluate_log {
    char path[4096];
    FILE *stream; ///< NULL when none is kept
} evaluate_log;

/// Reads what is there into `table` (trials above its number are left out) and opens it to go on;
/// a last row that was cut off by an interruption is dropped. Does nothing if `path` is NULL.
/// False with file:line.
bool evaluate_log_open(evaluate_log *log, const char *path, trial_table *table, himc_error *error);
/// Adds a row, at once on disk.
bool evaluate_log_add(evaluate_log *log, const trial_table *table, int index, himc_error *error);
void evaluate_log_close(evaluate_log *log);

#endif
