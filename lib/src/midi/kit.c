/// kit.c: the drum channel of General MIDI on five heads: what is a drum there, and which.
///
/// A kit stands so that its two usual drums are each before a hand. The sizes are those of usual
/// drums; places, tuning and the sharing of the keys are chosen: low toms on one head, high ones on
/// another, bongos, congas and timbales on the smallest.
#include "midi/part.h"

#include <math.h>
#include <string.h>

enum { BASS = 1, FLOOR, TOM, SNARE, BONGO }; // 0: no head

static const midi_head heads[MIDI_HEADS] = {
    [BASS - 1] = {"bass", 28, .70, .36, .85, .356, 38},
    [FLOOR - 1] = {"floor", 22, .30, -.66, .85, .279, 45},
    [TOM - 1] = {"tom", 16, .86, -.40, .85, .203, 52},
    [SNARE - 1] = {"snare", 14, .52, -.16, .85, .178, 57},
    [BONGO - 1] = {"bongo", 12, .30, .78, .85, .152, 64},
};

void himc_midi_join(midi_part *part)
{
    int last[128];
    memset(last, -1, sizeof last);
    for (int i = 0; i < part->count; i++) {
        midi_stroke *s = &part->stroke[i];
        int *before = &last[part->timpani || s->head < 0 ? s->key : s->head];
        if (s->fate != MIDI_PLAYED)
            continue;
        midi_stroke *first = *before >= 0 ? &part->stroke[*before] : NULL;
        // two notes within 0.01 s are one stroke; chosen: no flam is as close
        if (first && s->note->seconds - first->note->seconds < 0.01) {
            first->dynamic = fmax(first->dynamic, s->dynamic);
            s->fate = MIDI_TOGETHER;
        } else {
            *before = i;
        }
    }
}

void himc_midi_kit(midi_part *part)
{
    enum { SIDE_STICK = 37 };
    // of the keys of General MIDI's percussion map
    static const int8_t head[] = {
        [35] = BASS,  [36] = BASS,  [37] = SNARE, [38] = SNARE, [40] = SNARE, [41] = FLOOR,
        [43] = FLOOR, [45] = FLOOR, [47] = TOM,   [48] = TOM,   [50] = TOM,   [60] = BONGO,
        [61] = BONGO, [62] = BONGO, [63] = BONGO, [64] = BONGO, [65] = BONGO, [66] = BONGO};
    for (part->heads = 0; part->heads < MIDI_HEADS; part->heads++) {
        part->head[part->heads] = heads[part->heads];
        part->head[part->heads].key = -1;
    }
    for (int i = 0; i < part->count; i++) {
        midi_stroke *s = &part->stroke[i];
        s->head = s->key < (int)sizeof head ? head[s->key] - 1 : -1;
        s->spot = s->key == SIDE_STICK ? HIMC_SPOT_RIM : HIMC_SPOT_NORMAL;
        if (s->head < 0)
            s->fate = MIDI_NOT_A_HEAD;
        else
            part->head[s->head].key = heads[s->head].key;
    }
    himc_midi_join(part);
}
