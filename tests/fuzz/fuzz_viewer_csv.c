/// fuzz_viewer_csv.c: the motion that the viewer plays back. What is accepted is read again by
/// other means, as the page does: rows of as many finite numbers as there are names, times growing.
#include "fuzz.h"
#include "motion.h"

#include <math.h>

// one more cell of a row; false at the end of the row
static bool next_cell(char **at, char **cell)
{
    *cell = *at ? strsep(at, ",") : NULL;
    return *cell != NULL;
}

static int check_row(char *row, double *time)
{
    int count = 0;
    for (char *cell, *end; next_cell(&row, &cell); count++) {
        double value = strtod(cell, &end);
        require(end > cell && (!*end || !strcmp(end, "\r")) && isfinite(value),
                "a cell is a number");
        require(count > 0 || value > *time, "time grows");
        *time = count > 0 ? *time : value;
    }
    return count;
}

static void check_motion(char *text)
{
    int columns = 0, rows = 0;
    double time = -INFINITY;
    char *names = strsep(&text, "\n");
    require(strncmp(names, "time_s,", 7) == 0, "the first column is time");
    for (char *cell; next_cell(&names, &cell);)
        columns++;
    for (char *row; (row = strsep(&text, "\n"));)
        if (row[0] && strcmp(row, "\r") != 0) {
            require(check_row(row, &time) == columns, "a row has all columns");
            rows++;
        }
    require(rows >= 2, "a motion has rows");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    himc_error error = {""};
    char *text = fuzz_text(data, size);
    if (!motion_check(text, size, "fuzz.csv", &error))
        require_line(&error);
    else {
        require(strlen(text) == size, "a motion is text");
        check_motion(text);
    }
    free(text);
    return 0;
}
