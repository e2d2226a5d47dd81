/// performance_drums.c: the drums of a performance: found by name, made, replaced, and where they
/// stand.
///
/// Strokes name their drum by its slot, so a slot is never given up. A drum that nobody has placed
/// stands on the arc around the player on which the first one stands, at the angle nearest to
/// straight ahead at which its rim is clear of the others', to the right before to the left: not
/// where another drum is, which no stick could tell apart.
#include "performance/performance_state.h"

#include <string.h>

#define CLEAR 0.02      // between two rims (m)
#define STEP 0.02       // in which the arc is tried (rad)
#define FARTHEST 1.9    // a player turns no further (rad)
#define OUTWARDS 0.1    // to the next arc (m)
#define LARGEST_ARC 2.0 // (m)

static int find_drum(const himc_performance *p, const char *name)
{
    for (int i = 0; i < p->drums; i++)
        if (strcmp(himc_drum_name(p->drum[i].drum), name) == 0)
            return i;
    return -1;
}

static bool is_clear(const himc_performance *p, int index, himc_vec3 center)
{
    double radius = himc_drum_head_frame(p->drum[index].drum)->radius;
    for (int i = 0; i < p->drums; i++) {
        const himc_head_frame *other = himc_drum_head_frame(p->drum[i].drum);
        double apart = hypot(center.x - other->center.x, center.y - other->center.y);
        if (i != index && apart < radius + other->radius + CLEAR)
            return false;
    }
    return true;
}

// a drum that nobody has placed goes where none is yet
static void find_room(himc_performance *p, int index)
{
    himc_drum *drum = p->drum[index].drum;
    himc_vec3 first = himc_drum_head_frame(drum)->center;
    for (double arc = first.x; !himc_drum_is_placed(drum) && arc < LARGEST_ARC; arc += OUTWARDS)
        for (double angle = 0; angle < FARTHEST; angle += STEP)
            for (int side = -1; side <= 1; side += 2) {
                himc_vec3 center = {arc * cos(angle), side * arc * sin(angle), first.z};
                if (!is_clear(p, index, center))
                    continue;
                himc_drum_stand(drum, center);
                p->drum[index].beside = angle > 0;
                return;
            }
}

void himc_performance_tell_places(himc_performance *p)
{
    for (int i = 0; i < p->drums; i++) {
        himc_vec3 at = himc_drum_head_frame(p->drum[i].drum)->center;
        if (p->drum[i].beside && !himc_drum_is_placed(p->drum[i].drum))
            himc_performance_note(p, "drum %s stands at %.2f %.2f %.2f: `place` says where",
                                  himc_drum_name(p->drum[i].drum), at.x, at.y, at.z);
        p->drum[i].beside = false;
    }
}

static bool put_drum(himc_performance *p, himc_drum *drum, bool silent, int *index,
                     himc_error *error)
{
    int i = find_drum(p, himc_drum_name(drum));
    if (i < 0 && p->drums == HIMC_DRUMS)
        return himc_error_set(error, "drum %s: a performer plays on %d drums at most",
                              himc_drum_name(drum), HIMC_DRUMS);
    if (i < 0)
        i = p->drums++;
    else
        himc_drum_release(p->drum[i].drum);
    p->drum[i] = (slot){.drum = drum, .silent = silent, .revision = himc_drum_revision(drum) - 1};
    find_room(p, i);
    himc_performance_notice_drums(p);
    *index = i;
    return true;
}

static bool make_drum(himc_performance *p, const char *name, double inches, bool silent, int *index,
                      himc_error *error)
{
    himc_drum *drum = himc_drum_new(name, inches, p->config.sample_rate, error);
    if (!drum)
        return false;
    if (put_drum(p, drum, silent, index, error))
        return true;
    himc_drum_release(drum);
    return false;
}

bool himc_performance_ensure_drum(himc_performance *p, const char *name, int *index,
                                  himc_error *error)
{
    *index = name[0] ? find_drum(p, name) : 0;
    if (*index >= 0 && *index < p->drums)
        return true;
    if (!make_drum(p, name[0] ? name : "drum", 23, true, index, error))
        return false;
    himc_performance_note(p, "no drum %s: playing on a silent one",
                          himc_drum_name(p->drum[*index].drum));
    return true;
}

bool himc_performance_add_drum(himc_performance *p, himc_drum *drum, himc_error *error)
{
    int index;
    if (put_drum(p, himc_drum_retain(drum), false, &index, error))
        return true;
    himc_drum_release(drum);
    return false;
}

himc_drum *himc_performance_drum(himc_performance *p, int index)
{
    return index >= 0 && index < p->drums ? p->drum[index].drum : NULL;
}

bool himc_performance_do_drum(himc_performance *p, const himc_command *c, himc_error *error)
{
    int index;
    if (!p->make_drums || find_drum(p, c->atom[0].symbol) >= 0)
        return true; // in Pd each [membrane~ NAME] is one
    return make_drum(p, c->atom[0].symbol, c->count > 1 ? c->atom[1].number : 23, false, &index,
                     error);
}
