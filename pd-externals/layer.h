/* layer.h: a second, equal drum, for the force inlet of a drum that a performer plays.

The performer steps head and sticks in one pass, perhaps before the inlet's force for those samples
is known. A membrane is linear, so the response to that force can be computed on a head of its own
and added; only the sticks do not feel it. This head follows the drum's head, pickups and listener
when they change, and costs nothing before the first force. */
#ifndef LAYER_H
#define LAYER_H

#include "himc/drum.h"
#include "himc/membrane.h"

#define LAYER_CHUNK 64 /* samples at a time, on the stack of the perform routine */
#define LAYER_OUTS (HIMC_PICKUPS + 1)
/* (ms) after the last change of the drum, before the first force; chosen: more than between two
steps of a pedal. A force that comes earlier has a block of the old head. */
#define LAYER_PATIENCE 100
#define LAYER_DECLICK 0.010 /* as the drum's own sound, when the technique changes (s) */

typedef struct t_layer {
    himc_drum *l_drum;
    bool l_sounds;  /* it has felt a force */
    bool l_silent;  /* another technique sounds */
    double l_level; /* of its sound, 0 .. 1 */
} t_layer;

static inline double layer_declick(t_layer *layer)
{
    double goal = !layer->l_silent, step = 1 / (LAYER_DECLICK * himc_drum_rate(layer->l_drum));
    if (layer->l_level != goal)
        layer->l_level += fmin(fmax(goal - layer->l_level, -step), step);
    return layer->l_level;
}

/* Reads a drum from sample `start` on: its sound, in one channel of what both ears hear or one for
each of several, and after them the displacement. */
static inline void layer_read(const himc_drum *drum, int channels, uint64_t start, int n,
                              double out[LAYER_OUTS][LAYER_CHUNK])
{
    himc_drum_read(drum, start, n, out[0], out[channels]);
    for (int k = 0; k < channels && channels > 1; k++)
        himc_drum_read_channel(drum, k, start, n, out[k]);
}

/* Adds the response to the force in[0] at in[1], in[2] to the sound of `channels` channels and to
the displacement, which comes after them. */
static inline void layer_play(t_layer *layer, int channels, int n, double in[3][LAYER_CHUNK],
                              double out[LAYER_OUTS][LAYER_CHUNK])
{
    double heard[LAYER_OUTS][LAYER_CHUNK];
    for (int i = 0; i < n && !layer->l_sounds; i++)
        layer->l_sounds = in[0][i] != 0;
    if (!layer->l_sounds)
        return;
    uint64_t start = himc_drum_time(layer->l_drum);
    himc_drum_advance(layer->l_drum, n, in[0], in[1], in[2]);
    layer_read(layer->l_drum, channels, start, n, heard);
    for (int i = 0; i < n; i++) {
        double level = layer_declick(layer);
        for (int k = 0; k < channels; k++)
            out[k][i] += level * heard[k][i];
        out[channels][i] += heard[channels][i];
    }
}

#endif
