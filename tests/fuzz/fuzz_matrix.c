/// fuzz_matrix.c: a head's file and the tables that it names. An accepted head has modes in order,
/// finite and with positive masses.
///
/// An input is the head's file and up to three tables, separated by '@'. They lie beside each other
/// as the files 100, 101, 102 and 103.
#include "head/grid.h"
#include "fuzz.h"

#include <math.h>

#define HEAD 100
#define TABLES 3

const long fuzz_runs = 1500;

static void check_grid(const himc_grid *g)
{
    require(g->places > 0 && g->modes > 0 && g->modes <= g->places && g->all >= g->places,
            "a grid has places and modes");
    require(isfinite(g->radius) && g->radius > 0, "a grid has a radius");
    for (int k = 0; k < g->modes; k++) {
        require(isfinite(g->zero[k]) && g->zero[k] > 0, "a mode has a frequency");
        require(k == 0 || g->zero[k] >= g->zero[k - 1], "modes are in order");
        require(isfinite(g->norm[k]) && g->norm[k] > 0, "a mode has a mass");
    }
    for (size_t i = 0; i < (size_t)g->modes * (size_t)g->places; i++)
        require(fabs(g->shape[i]) <= 1 + 1e-9, "a mode's shape is at most 1");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    himc_error error = {""};
    const uint8_t *end = data + size;
    for (int i = 0; i <= TABLES; i++) {
        const uint8_t *mark = data < end ? memchr(data, '@', (size_t)(end - data)) : NULL;
        fuzz_file(HEAD + i, data, (size_t)((mark ? mark : end) - data));
        data = mark ? mark + 1 : end;
    }
    himc_grid *grid = himc_grid_load("/proc/self/fd/100", &error);
    if (grid)
        check_grid(grid);
    else
        require_line(&error);
    himc_grid_release(grid);
    return 0;
}
