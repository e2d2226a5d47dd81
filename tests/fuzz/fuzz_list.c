/// fuzz_list.c: a list of modes. An accepted one has modes in order, with positive masses,
/// and is somewhere that can be struck.
#include "head/idiophone.h"
#include "fuzz.h"

#include <math.h>

#define LIST 100

const long fuzz_runs = 3000;

static void check_body(const himc_idiophone *body)
{
    require(body->parts > 0 && body->modes > 0, "an instrument has parts and modes");
    require(isfinite(body->radius) && body->radius > 0, "an instrument has a size");
    require(isfinite(body->principal) && body->principal > 0, "an instrument has a pitch");
    for (int i = 0; i < body->modes; i++) {
        const himc_partial *m = &body->mode[i];
        require(m->frequency > 0 && m->mass > 0 && m->loss > 0 && m->pressure > 0,
                "a mode has a frequency, a mass, a loss and a sound");
        require(i == 0 || m->frequency >= m[-1].frequency, "modes are in order");
        require(m->part >= 0 && m->part < body->parts, "a mode is of a part");
        require(m->first >= 0 && m->points > 0 && m->first + m->points <= body->points,
                "a mode has its shape");
    }
    for (int i = 0; i < body->points; i++)
        require(isfinite(body->shape[i]), "a shape is finite");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    himc_error error = {""};
    fuzz_file(LIST, data, size);
    himc_idiophone *body = himc_list_load("/proc/self/fd/100", &error);
    if (body)
        check_body(body);
    else
        require_line(&error);
    himc_shape_release(&(himc_shape){.body = body});
    return 0;
}
