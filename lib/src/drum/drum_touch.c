/// drum_touch.c: blows told as they begin, so that others than the head may sound them.
///
/// The 2009 papers let a blow be heard by any of three techniques: this modal one, signals, or
/// clips of recorded sound. The others need to know of a blow when it begins, not when it is over
/// and its force known; so what is told is where, how fast, and at what pitch the head is tuned.
/// Contact, head and body are the same whatever sounds; the head's own sound fades in 10 ms and is
/// there again, as far as it still rings, when its turn comes.
#include "drum/drum_state.h"

#include <math.h>

#define FADE 0.010 // (s)

himc_technique himc_drum_technique(const himc_drum *drum)
{
    return drum->technique;
}

void himc_drum_set_answered(himc_drum *drum, bool answered)
{
    drum->answered = answered;
}

bool himc_drum_is_answered(const himc_drum *drum)
{
    return drum->answered;
}

double himc_drum_loudness(himc_drum *drum)
{
    double goal = drum->technique == HIMC_TECHNIQUE_MODAL, step = 1 / (FADE * drum->rate);
    if (drum->level != goal)
        drum->level += fmin(fmax(goal - drum->level, -step), step);
    return drum->level;
}

void himc_drum_keep_touch(himc_drum *drum, const himc_stick *stick)
{
    if (!(stick->impact > 0))
        return; // a head raised into a resting stick is no blow
    if (drum->touch_count == DRUM_TOUCHES) {
        drum->touch_first = (drum->touch_first + 1) % DRUM_TOUCHES;
        drum->touch_count--;
    }
    const himc_head *head = himc_membrane_head(drum->membrane);
    drum->touches[(drum->touch_first + drum->touch_count++) % DRUM_TOUCHES] =
        (himc_touch){.at = (int64_t)drum->time,
                     .x = stick->x,
                     .y = stick->y,
                     .velocity = stick->impact,
                     .place = fmin(hypot(stick->x, stick->y) / head->radius, 1),
                     .pitch = himc_membrane_principal(drum->membrane, head)};
}

bool himc_drum_touch_next(himc_drum *drum, himc_touch *touch)
{
    if (drum->touch_count == 0)
        return false;
    *touch = drum->touches[drum->touch_first];
    touch->at -= (int64_t)drum->zero;
    drum->touch_first = (drum->touch_first + 1) % DRUM_TOUCHES;
    drum->touch_count--;
    return true;
}
