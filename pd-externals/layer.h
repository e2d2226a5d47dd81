/* layer.h: a second, equal head, for the force inlet of a drum that a performer plays.

The performer steps head and sticks in one pass, perhaps before the inlet's force for those samples
is known. A membrane is linear, so the response to that force can be computed on a head of its own
and added; only the sticks do not feel it. This head follows the drum's head and pickups when they
change, and costs nothing before the first force. */
#ifndef LAYER_H
#define LAYER_H

#include "himc/membrane.h"

#define LAYER_CHUNK 64 /* samples at a time, on the stack of the perform routine */
#define LAYER_OUTS (HIMC_PICKUPS + 1)
#define LAYER_DECLICK 0.010 /* as the drum's own sound, when the technique changes (s) */

typedef struct t_layer {
    himc_membrane *l_membrane;
    bool l_sounds;  /* it has felt a force */
    bool l_silent;  /* another technique sounds */
    double l_level; /* of its sound, 0 .. 1 */
} t_layer;

/* True if it equals the drum's head and pickups. */
static inline bool layer_fits(const t_layer *layer, const himc_membrane *drum)
{
    return himc_membrane_alike(drum, layer->l_membrane);
}

/* Makes it equal to the drum's head. May allocate. */
static inline bool layer_fit(t_layer *layer, const himc_membrane *drum, himc_error *error)
{
    return layer_fits(layer, drum) || himc_membrane_follow(layer->l_membrane, drum, error);
}

static inline double layer_declick(t_layer *layer)
{
    double goal = !layer->l_silent,
           step = 1 / (LAYER_DECLICK * himc_membrane_rate(layer->l_membrane));
    if (layer->l_level != goal)
        layer->l_level += fmin(fmax(goal - layer->l_level, -step), step);
    return layer->l_level;
}

/* Adds the response to the force in[0] at in[1], in[2] to the sound of `channels` pickups and to
the displacement, which comes after them. */
static inline void layer_play(t_layer *layer, int channels, int n, double in[3][LAYER_CHUNK],
                              double out[LAYER_OUTS][LAYER_CHUNK])
{
    double heard[HIMC_PICKUPS][LAYER_CHUNK] = {{0}}, seen[LAYER_CHUNK];
    double *rest[HIMC_PICKUPS];
    for (int i = 0; i < n && !layer->l_sounds; i++)
        layer->l_sounds = in[0][i] != 0;
    if (!layer->l_sounds)
        return;
    for (int i = 0, run; i < n; i += run) {
        /* one pass while there is no force and the spot stays */
        for (run = 1; i + run < n && in[0][i + run] == 0; run++)
            if (in[1][i + run] != in[1][i] || in[2][i + run] != in[2][i])
                break;
        himc_membrane_watch(layer->l_membrane, in[1][i], in[2][i]);
        if (in[0][i] != 0)
            himc_membrane_push(layer->l_membrane, in[1][i], in[2][i], in[0][i]);
        for (int k = 0; k < HIMC_PICKUPS; k++)
            rest[k] = heard[k] + i;
        himc_membrane_run(layer->l_membrane, run, rest, seen + i);
    }
    for (int i = 0; i < n; i++) {
        double level = layer_declick(layer);
        for (int k = 0; k < channels; k++)
            out[k][i] += level * heard[k][i];
        out[channels][i] += seen[i];
    }
}

#endif
