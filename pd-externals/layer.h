/* layer.h: a second head of the same make, for the force inlet of a drum that a performer plays.

The performer steps head and sticks in one pass, and may have done so before the inlet's force for
those samples is known. A membrane is linear, so what that force adds can be played on a head of its
own and summed; only the sticks do not feel it. It follows the drum's head and pickup whenever they
change, and costs nothing before the first force. */
#ifndef LAYER_H
#define LAYER_H

#include "himc/membrane.h"

#define LAYER_CHUNK 64 /* samples at a time, on the stack of the perform routine */

typedef struct t_layer {
    himc_membrane *l_membrane;
    bool l_sounds; /* it has felt a force */
} t_layer;

/* Whether it is made and heard as the drum's head is. */
static inline bool layer_fits(const t_layer *layer, const himc_membrane *drum)
{
    return himc_membrane_alike(drum, layer->l_membrane);
}

/* Makes it so. May allocate. */
static inline bool layer_fit(t_layer *layer, const himc_membrane *drum, himc_error *error)
{
    return layer_fits(layer, drum) || himc_membrane_follow(layer->l_membrane, drum, error);
}

/* Adds to sound and displacement, out[0] and out[1], what the force in[0] at in[1], in[2] makes. */
static inline void layer_play(t_layer *layer, int n, double in[3][LAYER_CHUNK],
                              double out[2][LAYER_CHUNK])
{
    double heard[LAYER_CHUNK], seen[LAYER_CHUNK];
    for (int i = 0; i < n && !layer->l_sounds; i++)
        layer->l_sounds = in[0][i] != 0;
    if (!layer->l_sounds)
        return;
    for (int i = 0, run; i < n; i += run) {
        /* one pass as far as there is no force and the spot stays */
        for (run = 1; i + run < n && in[0][i + run] == 0; run++)
            if (in[1][i + run] != in[1][i] || in[2][i + run] != in[2][i])
                break;
        himc_membrane_watch(layer->l_membrane, in[1][i], in[2][i]);
        if (in[0][i] != 0)
            himc_membrane_push(layer->l_membrane, in[1][i], in[2][i], in[0][i]);
        himc_membrane_run(layer->l_membrane, run, heard + i, seen + i);
    }
    for (int i = 0; i < n; i++) {
        out[0][i] += heard[i];
        out[1][i] += seen[i];
    }
}

#endif
