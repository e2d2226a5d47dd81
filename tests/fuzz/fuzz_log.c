/// fuzz_log.c: logs of `himc evaluate`. What is accepted is finite; what is refused stays as it
/// was; a log that was continued is accepted again.
#include "tools/himc/evaluate_log.h"
#include "fuzz.h"

#include <math.h>

#define TRIALS 3
#define NUMBER 100

static bool open_log(evaluate_log *log, const char *path, himc_error *error)
{
    trial_table table;
    *log = (evaluate_log){.stream = NULL};
    require(trial_table_make(&table, TRIALS, error), "memory for a table");
    bool good = evaluate_log_open(log, path, &table, error);
    for (int i = 0; good && i < TRIALS * TRIAL_KINDS; i++)
        require(!table.known[i] || isfinite(table.result[i].rms), "a result is finite");
    if (good)
        good = evaluate_log_add(log, &table, 0, error);
    evaluate_log_close(log);
    trial_table_free(&table);
    return good;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static uint8_t now[1 << 16];
    himc_error error = {""};
    evaluate_log log;
    const char *path = fuzz_file(NUMBER, data, size);
    if (open_log(&log, path, &error)) {
        require(open_log(&log, path, &error), error.text);
        return 0;
    }
    require_line(&error);
    require(size > sizeof now || (pread(NUMBER, now, sizeof now, 0) == (ssize_t)size &&
                                  memcmp(now, data, size) == 0),
            "what is no log stays as it is");
    return 0;
}
