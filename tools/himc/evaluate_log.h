/// evaluate_log.h: the results of all trials, and the log file that stores each one at once.
#ifndef EVALUATE_LOG_H
#define EVALUATE_LOG_H

#include "trial.h"

#include <stdio.h>

#define TRIALS_MAX 10000
#define TRIAL_CONTROLS (1 + 2 * HIMC_LAW_COUNT) ///< `ik`, then `id` and `himc` under each law
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
/// Writes one row for each kind that has trials: means, standard deviation of the RMS (nan of one
/// trial), elbow range.
void trial_table_print(const trial_table *table, FILE *stream);

/// A row of a log that stands for its part.
typedef struct evaluate_sample {
    int line, index;     ///< in the log; in the table, where another part may have its own row
    trial_result result; ///< as the log has it
} evaluate_sample;

/// A table of trials on disk, one row each. Rows may come in any order with headers between them,
/// so logs can be joined by `cat`. Each part between two headers was written by one program: its
/// last row, if possible one with forces, is a sample to play again.
typedef struct evaluate_log {
    char path[4096];
    FILE *stream;            ///< NULL without a log
    evaluate_sample *sample; ///< (samples)
    int samples;
} evaluate_log;

/// Reads the existing rows into `table` (trials above its number are skipped) and opens the file
/// for appending. An incomplete last row, from an interruption, is removed. Does nothing if `path`
/// is NULL. False with file:line.
bool evaluate_log_open(evaluate_log *log, const char *path, trial_table *table, himc_error *error);
/// False with file:line if a sample has other results than this program, which has `now`.
bool evaluate_log_check(const evaluate_log *log, int sample, const trial_result *now,
                        himc_error *error);
/// Appends a row and flushes it. False with the reason.
bool evaluate_log_add(evaluate_log *log, const trial_table *table, int index, himc_error *error);
void evaluate_log_close(evaluate_log *log);

#endif
