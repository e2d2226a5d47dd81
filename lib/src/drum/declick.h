/// fade.h: how a sound goes on smoothly when what makes it has changed; a private part of
/// membrane.c.
///
/// When head, ear or rate change, the sound would jump by a step and its slope by another. The
/// difference between what would have been heard and what is now heard is added back as the cubic
/// that starts with both and ends with value and slope zero: no click, and no filter in the sound's
/// way at any other time.
#ifndef HIMC_DECLICK_H
#define HIMC_DECLICK_H

#define FADE 0.005 // (s)

typedef struct fade {
    double step, slope; // at its start: in units of sound, and per sample
    int at, length;     // (samples)
} fade;

// what is added to sample `at`, which may lie just before the start
static inline double fade_at(const fade *f, int at)
{
    if (f->length == 0 || at >= f->length)
        return 0;
    double t = (double)at / f->length, u = 1 - t;
    return u * u * ((1 + 2 * t) * f->step + t * f->length * f->slope);
}

// the last sample and the coming one without forces
typedef struct sound {
    double now, next;
} sound;

// makes up for a sound that was going to go on as `before` and goes on as `after`
static inline fade fade_between(sound before, sound after, double rate)
{
    double step = before.next - after.next;
    return (fade){
        .step = step, .slope = step - (before.now - after.now), .length = (int)(FADE * rate) + 1};
}

#endif
