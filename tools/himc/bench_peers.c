/// bench_peers.c: runs the scripts of tests/bench/peers. A script prints `WHAT VALUE LABEL` for
/// each figure, or exits with 77 where its program is not installed.
#define _POSIX_C_SOURCE 200809L
#include "bench_peers.h"

#ifdef _WIN32

bool bench_print_peers(const double ours[BENCH_PEER_ROWS], himc_error *error)
{
    (void)ours;
    return himc_error_set(error, "--peers: not on Windows, whose shell does not run the scripts");
}

#else

#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

#define SCRIPTS "tests/bench/peers/*.sh"
#define MISSING 77 // exit status of a script whose program is not installed

static const struct {
    const char *what, *unit;
} row_name[BENCH_PEER_ROWS] = {
    [BENCH_STEP] = {"step_us", "us a step"},
    [BENCH_CMU] = {"cmu_step_us", "us a step"},
    [BENCH_MODES] = {"modes_per_core", "modes a core"},
    [BENCH_DRUM] = {"drum_ms_per_s", "ms a second"},
};

static bool print_figure(const char *line, const double ours[BENCH_PEER_ROWS])
{
    char what[32], label[96];
    double value;
    if (sscanf(line, "%31s %lf %95[^\n]", what, &value, label) != 3)
        return false;
    for (int i = 0; i < BENCH_PEER_ROWS; i++)
        if (!strcmp(what, row_name[i].what)) {
            printf("%-62s %10.2f %-12s  ours %10.2f  ours / theirs %8.3f\n", label, value,
                   row_name[i].unit, ours[i], ours[i] / value);
            fflush(stdout);
            return true;
        }
    return false;
}

static bool run_script(const char *path, const double ours[BENCH_PEER_ROWS], himc_error *error)
{
    char line[256];
    bool good = true;
    FILE *script = popen(path, "r");
    if (!script)
        return himc_error_set(error, "%s: cannot be started", path);
    while (fgets(line, sizeof line, script))
        good = print_figure(line, ours) && good;
    int status = pclose(script);
    if (!good || !WIFEXITED(status) || (WEXITSTATUS(status) && WEXITSTATUS(status) != MISSING))
        return himc_error_set(error, "%s: has failed", path);
    return true;
}

bool bench_print_peers(const double ours[BENCH_PEER_ROWS], himc_error *error)
{
    glob_t found;
    bool good = true;
    if (glob(SCRIPTS, 0, NULL, &found) != 0)
        return himc_error_set(error, SCRIPTS ": not found, run this in the source folder");
    for (size_t i = 0; i < found.gl_pathc; i++)
        good = run_script(found.gl_pathv[i], ours, error) && good;
    globfree(&found);
    return good;
}

#endif
