/// performance_push.c: hands that push the performer: `push SEGMENT FX FY FZ SECONDS`.
///
/// A push is a constant force on a segment's centre of mass. Control knows nothing of it: what it
/// does to the motion, and how soon the motion recovers, is what one pushes for. The pelvis is
/// held, and in `ik` there is no body to push.
#include "performance/performance_state.h"

#include <stdio.h>
#include <string.h>

static int find_segment(const char *name)
{
    for (int i = HIMC_PELVIS + 1; i < HIMC_SEGMENTS; i++)
        if (strcmp(name, himc_segment_name(i)) == 0)
            return i;
    return -1;
}

static bool unknown_segment(const char *name, himc_error *error)
{
    himc_error_set(error, "push: SEGMENT: %s, allowed", name);
    size_t used = error ? strlen(error->text) : 0;
    for (int i = HIMC_PELVIS + 1; error && i < HIMC_SEGMENTS; i++)
        used += (size_t)snprintf(error->text + used, sizeof error->text - used, " %s",
                                 himc_segment_name(i));
    return false;
}

bool himc_performance_do_push(himc_performance *p, const himc_command *c, himc_error *error)
{
    int i = find_segment(c->atom[0].symbol);
    if (i < 0)
        return unknown_segment(c->atom[0].symbol, error);
    p->push[i].force = himc_vec3_make(c->atom[1].number, c->atom[2].number, c->atom[3].number);
    p->push[i].until = step_time(p) + c->atom[4].number;
    p->push_end = fmax(p->push_end, p->push[i].until);
    return true;
}

void himc_performance_push_body(himc_performance *p, double t)
{
    for (int i = 0; t < p->push_end && i < HIMC_SEGMENTS; i++)
        if (t < p->push[i].until)
            himc_character_push(p->character, i, p->push[i].force);
}
