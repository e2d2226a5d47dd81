/// drum_gliss.c: a pedal on its way, evenly in pitch, while the head sounds.
///
/// The model of the head at the end is made aside. Every GLISS_STEP the model that sounds goes its
/// share of the rest of the way, each mode's frequency by an equal ratio (himc_model_approach), so
/// the principal mode rises by equal intervals; the last step puts the other in its place. Steps
/// are counted in the drum's samples: no block, and no thread, changes a bit. Invariant: who asks
/// for the drum's state hears of the head at the end (himc_drum_head_config).
#include "drum/drum_state.h"

#include <math.h>

#define GLISS_STEP 0.004 // (s) chosen: a whole tone in a tenth of a second in steps of 8 cents

bool himc_drum_glides(const himc_drum *drum)
{
    return drum->gliss.left > 0;
}

himc_membrane_config himc_drum_head_config(const himc_drum *drum)
{
    himc_membrane_config config = *himc_membrane_config_of(drum->membrane);
    if (himc_drum_glides(drum))
        config.head.tension = drum->gliss.tension;
    return config;
}

double himc_drum_pedal(const himc_drum *drum, double *octaves)
{
    const drum_gliss *g = &drum->gliss;
    double tension =
        himc_drum_glides(drum) ? g->tension : himc_membrane_config_of(drum->membrane)->head.tension;
    *octaves = 0.5 * log2(tension / drum->set.usual.tension);
    return himc_drum_gliss_rest(drum);
}

static int samples_of_step(const himc_drum *drum)
{
    return (int)fmax(1, round(GLISS_STEP * drum->rate));
}

double himc_drum_gliss_rest(const himc_drum *drum)
{
    return drum->gliss.left * GLISS_STEP;
}

// begins; the drum's goal becomes *made, and *made what the drum had
static bool begin(himc_drum *drum, const himc_membrane_config *to, double seconds,
                  himc_model **made, himc_error *error)
{
    drum_gliss *g = &drum->gliss;
    if (made && *made) {
        himc_model *had = g->goal;
        g->goal = *made;
        *made = had;
    } else if (!g->goal || !himc_model_has_room(g->goal, to)) {
        himc_model *goal = himc_model_new(to, drum->membrane->model, error);
        if (!goal)
            return false;
        himc_model_free(g->goal);
        g->goal = goal;
    }
    g->tension = to->head.tension;
    g->left = (int)fmax(1, round(seconds / GLISS_STEP));
    g->next = drum->time + (uint64_t)samples_of_step(drum);
    return true;
}

bool himc_drum_take_head(himc_drum *drum, const himc_membrane_config *to, double seconds,
                         himc_model **made, himc_error *error)
{
    drum_gliss *g = &drum->gliss;
    const himc_membrane_config *now = himc_membrane_config_of(drum->membrane);
    himc_membrane_config here = *to;
    bool room = himc_model_has_room(drum->membrane->model, to);
    bool goes_on = seconds < 0 && himc_drum_glides(drum) && to->head.tension == g->tension && room;
    if (goes_on || (seconds > 0 && room)) {
        here.head.tension = now->head.tension;
        return (himc_membrane_config_equal(now, &here) ||
                himc_membrane_become(drum->membrane, &here, error)) &&
               (goes_on || begin(drum, to, seconds, made, error));
    }
    g->left = 0;
    if (!made || !*made)
        return himc_membrane_become(drum->membrane, to, error);
    *made = himc_membrane_exchange(drum->membrane, *made);
    return true;
}

int himc_drum_until_gliss(const himc_drum *drum, int most)
{
    const drum_gliss *g = &drum->gliss;
    return himc_drum_glides(drum) && g->next < drum->time + (uint64_t)most
               ? (int)(g->next - drum->time)
               : most;
}

void himc_drum_go_gliss(himc_drum *drum)
{
    drum_gliss *g = &drum->gliss;
    if (!himc_drum_glides(drum) || g->next > drum->time)
        return;
    // commands may have changed what else the head is
    himc_membrane_config goal = himc_drum_head_config(drum);
    if (!himc_membrane_config_equal(&g->goal->config, &goal))
        himc_model_make(g->goal, &goal);
    if (g->left > 1)
        himc_membrane_approach(drum->membrane, g->goal, 1.0 / g->left);
    else
        g->goal = himc_membrane_exchange(drum->membrane, g->goal);
    g->left--;
    g->next += (uint64_t)samples_of_step(drum);
}
