/// evaluate.c: `himc evaluate`: the published comparison of the controllers (Bouënard, Gibet &
/// Wanderley 2012, section 3.3.2, figure 6b).
///
/// A row is a nuance under one controller and law. Its trials are numbered, and a trial's
/// disturbance depends on its number only. So trials can run in any order, on any core or machine,
/// and a log of trials (--log) can be continued: trials in the log are not repeated.
#define _POSIX_C_SOURCE 200809L
#include "cli.h"
#include "evaluate_log.h"
#include "evaluate_take.h"
#include "pool.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TRIALS, RANGE, ONLY, CSV, LOG, JOBS, OWN, JSON, FIGURE, TAKE };

static const cli_option options[] = {
    {"trials", 0, "N", "trials for each nuance and controller, 1 .. 10000 (100)"},
    {"range", 0, "A-B", "only these of them, to spread over machines"},
    {"only", 0, "WORD[,WORD]", "only rows of this nuance, this controller, this law"},
    {"csv", 0, "F.csv", "writes the table to this file (standard output)"},
    {"log", 0, "F.csv", "stores each trial when it ends; continues a log of this program"},
    {"jobs", 0, "N", "parallel trials, 1 .. 256 (the number of cores)"},
    {"take", 0, "FILE...", "own captures instead, each under every controller and law"},
    {"json", 0, NULL, "with --take: the rows as one JSON array of objects"},
    {"figure", 0, "F.svg", "with --take: the errors as bars"},
    CLI_TAKE_OPTIONS,
    {0},
};

/// The requested trials and the state of their execution.
typedef struct evaluation {
    int first, last, jobs;
    bool wanted[TRIAL_KINDS];
    trial_table table;
    evaluate_log log;
    int *todo; ///< indices into the table
    int todo_count, done;
    double start; ///< (s)
} evaluation;

static bool read_range(const char *text, evaluation *e, himc_error *error)
{
    int used = 0;
    if (!text)
        return true;
    if (sscanf(text, "%d-%d%n", &e->first, &e->last, &used) == 2 && !text[used] && e->first >= 1 &&
        e->first <= e->last && e->last <= e->table.trials)
        return true;
    return himc_error_set(error, "--range: %s, expected A-B within 1-%d", text, e->table.trials);
}

/// Keeps the rows that contain this word; false if the word is unknown.
static bool keep_rows(evaluation *e, const char *word)
{
    bool known = false;
    for (int kind = 0; kind < TRIAL_KINDS; kind++) {
        trial_kind k = trial_kind_of(&e->table, trial_index(&e->table, kind, 1));
        bool has = !strcmp(word, himc_nuance_name(k.nuance)) ||
                   !strcmp(word, trial_controller_name(k.controller).text) ||
                   !strcmp(word, trial_law_name(&k).text);
        known = known || has;
        e->wanted[kind] = e->wanted[kind] && has;
    }
    return known;
}

static bool read_only(const char *text, evaluation *e, himc_error *error)
{
    char words[256], *rest = NULL;
    for (int kind = 0; kind < TRIAL_KINDS; kind++)
        e->wanted[kind] = true;
    if (text && strspn(text, ",") == strlen(text))
        return himc_error_set(error, "--only: no word, expected words of one row");
    snprintf(words, sizeof words, "%s", text ? text : "");
    for (char *word = strtok_r(words, ",", &rest); word; word = strtok_r(NULL, ",", &rest))
        if (!keep_rows(e, word))
            return himc_error_set(error,
                                  "--only: %s, expected a nuance (legato ...), a controller (%s), "
                                  "a law (none|%s)",
                                  word, himc_command_table(HIMC_COMMAND_MODE)->atoms,
                                  himc_command_table(HIMC_COMMAND_LAW)->atoms);
    for (int kind = 0; kind < TRIAL_KINDS; kind++)
        if (e->wanted[kind])
            return true;
    return himc_error_set(
        error, "--only: %s: no row has all of these words, expected words of one row", text);
}

static bool read_arguments(const cli_arguments *arguments, evaluation *e, himc_error *error)
{
    const char *const *value = arguments->value;
    int trials = 100;
    e->jobs = pool_cores();
    if (!cli_count("--trials", value[TRIALS], 1, TRIALS_MAX, "", &trials, error) ||
        !cli_count("--jobs", value[JOBS], 1, 256, "", &e->jobs, error))
        return false;
    if (!cli_apart(value[LOG], &value[CSV], 1, error))
        return false;
    e->first = 1;
    e->last = trials;
    return trial_table_make(&e->table, trials, error) && read_range(value[RANGE], e, error) &&
           read_only(value[ONLY], e, error);
}

/// Lists the requested trials that are not in the log, in the order of their numbers, so an
/// interrupted run has some trials of every row.
static bool list_todo(evaluation *e, himc_error *error)
{
    int count = (e->last - e->first + 1) * TRIAL_KINDS;
    e->todo = malloc((size_t)count * sizeof *e->todo);
    if (!e->todo)
        return himc_error_set(error, "out of memory");
    for (int number = e->first; number <= e->last; number++)
        for (int kind = 0; kind < TRIAL_KINDS; kind++) {
            int index = trial_index(&e->table, kind, number);
            if (e->wanted[kind] && !e->table.known[index])
                e->todo[e->todo_count++] = index;
        }
    return true;
}

static void show_progress(const evaluation *e)
{
    char bar[31] = "";
    if (!cli_shows_progress())
        return;
    int full = 30 * e->done / e->todo_count;
    for (int i = 0; i < 30; i++)
        bar[i] = i < full ? '#' : '.';
    double elapsed = cli_now() - e->start, left = elapsed / e->done * (e->todo_count - e->done);
    fprintf(stderr, "\r[%s] %d of %d trials, %.0f s left \033[K", bar, e->done, e->todo_count,
            left);
    if (e->done == e->todo_count)
        fputs("\r\033[K", stderr);
}

static bool play(const evaluation *e, int index, trial_result *result, himc_error *error)
{
    trial_kind kind = trial_kind_of(&e->table, index);
    trial_config config = trial_default(&kind, trial_number_of(&e->table, index));
    return trial_run(&config, result, error);
}

static bool work(void *user, int item, void *result, himc_error *error)
{
    const evaluation *e = user;
    return play(e, e->todo[item], result, error);
}

static bool done(void *user, int item, const void *result, himc_error *error)
{
    evaluation *e = user;
    int index = e->todo[item];
    memcpy(&e->table.result[index], result, sizeof(trial_result));
    e->table.known[index] = true;
    e->done++;
    show_progress(e);
    return evaluate_log_add(&e->log, &e->table, index, error);
}

static bool work_sample(void *user, int item, void *result, himc_error *error)
{
    const evaluation *e = user;
    return play(e, e->log.sample[item].index, result, error);
}

static bool done_sample(void *user, int item, const void *result, himc_error *error)
{
    const evaluation *e = user;
    return evaluate_log_check(&e->log, item, result, error);
}

/// Plays a trial of each part of the log again: means over two programs would be of neither.
static bool check_log(evaluation *e, himc_error *error)
{
    pool workers = {e->log.samples, e->jobs, sizeof(trial_result), work_sample, done_sample, e};
    return pool_run(&workers, error);
}

static bool evaluate(evaluation *e, const char *log, himc_error *error)
{
    if (!evaluate_log_open(&e->log, log, &e->table, error) || !check_log(e, error) ||
        !list_todo(e, error))
        return false;
    pool workers = {e->todo_count, e->jobs, sizeof(trial_result), work, done, e};
    e->start = cli_now();
    return pool_run(&workers, error);
}

static bool write_table(const evaluation *e, cli_file *file, himc_error *error)
{
    trial_table_print(&e->table, file->stream ? file->stream : stdout);
    return cli_file_close(file, error) && cli_file_keep(file, error);
}

static bool run_own(const cli_arguments *arguments, cli_file *csv, cli_file *figure,
                    himc_error *error)
{
    himc_take_options take_options;
    int jobs = pool_cores();
    const char *const *written[] = {&arguments->value[CSV], &arguments->value[FIGURE]};
    for (int i = 0; i < 2; i++)
        if (!cli_apart(*written[i], arguments->repeated, arguments->repeats, error) ||
            (i > 0 && !cli_apart(*written[i], written[0], 1, error)))
            return false;
    return cli_count("--jobs", arguments->value[JOBS], 1, 256, "", &jobs, error) &&
           cli_take_options(arguments->repeated[0], arguments->value + TAKE, &take_options,
                            error) &&
           cli_file_open(csv, arguments->value[CSV], error) &&
           cli_file_open(figure, arguments->value[FIGURE], error) &&
           evaluate_takes(arguments->repeated, arguments->repeats, &take_options, jobs,
                          arguments->value[JSON], csv->stream ? csv->stream : stdout,
                          figure->stream, error) &&
           cli_file_close(csv, error) && cli_file_close(figure, error) &&
           cli_file_keep(csv, error) && cli_file_keep(figure, error);
}

// an option of the other kind of trials would be ignored
static bool check_options(const cli_arguments *arguments, himc_error *error)
{
    bool own = arguments->repeats > 0;
    for (int i = 0; options[i].name; i++) {
        bool published = i == TRIALS || i == RANGE || i == ONLY || i == LOG;
        bool captured = i == JSON || i == FIGURE || i >= TAKE;
        if (arguments->value[i] && (own ? published : captured))
            return himc_error_set(error, "--%s: not allowed %s --take FILE", options[i].name,
                                  own ? "with" : "without");
    }
    return true;
}

static int run(const cli_arguments *arguments)
{
    himc_error error;
    if (!check_options(arguments, &error))
        return cli_fail(&cli_evaluate, "%s", error.text);
    if (arguments->repeats) {
        cli_file own = {0}, figure = {0};
        bool played = run_own(arguments, &own, &figure, &error);
        cli_file_drop(&own);
        cli_file_drop(&figure);
        return played ? cli_finish(&cli_evaluate) : cli_fail(&cli_evaluate, "%s", error.text);
    }
    evaluation e = {0};
    cli_file csv = {0};
    bool good = read_arguments(arguments, &e, &error) &&
                cli_file_open(&csv, arguments->value[CSV], &error) && // before hours of trials
                evaluate(&e, arguments->value[LOG], &error) && write_table(&e, &csv, &error);
    cli_file_drop(&csv);
    evaluate_log_close(&e.log);
    trial_table_free(&e.table);
    free(e.todo);
    return good ? cli_finish(&cli_evaluate) : cli_fail(&cli_evaluate, "%s", error.text);
}

const cli_call cli_evaluate = {
    "evaluate",
    "[--take FILE...]",
    "",
    "compares ik, id and himc over many trials, as published",
    "Each row plays disturbed takes of the motion database: nuance,controller,law,trials,rms_mm,\n"
    "rms_sd_mm,amplitude_mm,rms_percent,elbow_range_ratio. RMS is the distance of captured and\n"
    "simulated tips, impacts included, SD its deviation over the trials (nan of one). Of a log one\n"
    "trial is played again: a log of another program is refused. docs/results/evaluation.md: how to run it on\n"
    "several machines. With --take the captures are one's own: take,controller,law,strokes,played,\n"
    "rms_mm,max_mm,amplitude_mm,rms_percent,elbow_range_ratio; --left-tip A,B names alternatives,\n"
    "of which each take has one.",
    options,
    run,
};
