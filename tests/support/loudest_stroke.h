/// loudest_stroke.h: how loud a drum is when it is struck as hard as a player can: fff, vertical
/// accent, near the centre and at the usual spot.
#ifndef HIMC_TESTS_LOUDEST_STROKE_H
#define HIMC_TESTS_LOUDEST_STROKE_H

#include "drum/drum_state.h"
#include "plan/gesture.h"
#include "sound_scale.h"

#include <math.h>

#define LOUDEST_HEARD 0.1 // after each stroke (s): all modes have swung, air and ears have it

/// Largest sample of each channel of a copy of the drum, at rest before, at its gain or the louder
/// `level` that it has had, and the most energy (J) in its head; false without memory.
static inline bool loudest_stroke(const himc_drum *drum, double level, double peak[HIMC_PICKUPS],
                                  double *energy)
{
    static const double place[] = {-0.3, -0.75}; // of the radius: loudest, usual
    double sound[256], speed = himc_gesture_of(HIMC_VERTICAL_ACCENT, 1).speed;
    himc_error error;
    himc_drum_settings settings = himc_drum_settings_of(drum);
    himc_drum *copy = himc_drum_new_of(&settings, &error);
    himc_drum_settings_free(&settings);
    for (int k = 0; k < HIMC_PICKUPS; k++)
        peak[k] = 0;
    *energy = 0;
    if (!copy)
        return false;
    if (drum->listener.on && himc_drum_open_ears(copy, &error)) {
        himc_drum_enclose(copy, &drum->walls);
        himc_drum_listen(copy, &drum->listener);
    }
    bool sounds = drum->set.technique == HIMC_TECHNIQUE_MODAL && !drum->set.mute;
    copy->set.gain = fmax(sounds ? drum->set.gain * drum->fader : 0, fmax(drum->level, level));
    copy->fader = 1; // it is in the gain
    copy->set.technique = HIMC_TECHNIQUE_MODAL;
    copy->set.mute = false;
    for (int i = 0; i < 2; i++) {
        himc_drum_strike_at(copy, 0, place[i] * copy->set.place.radius, 0, speed, &error);
        for (int n = 0; n < LOUDEST_HEARD * copy->rate; n += 256) {
            himc_drum_advance(copy, 256, NULL, NULL, NULL);
            *energy = fmax(*energy, drum_energy(copy));
            for (int k = 0; k < HIMC_PICKUPS; k++) {
                himc_drum_read_channel(copy, k, himc_drum_time(copy) - 256, 256, sound);
                for (int s = 0; s < 256; s++)
                    peak[k] = fmax(peak[k], fabs(sound[s]));
            }
        }
    }
    himc_drum_release(copy);
    return true;
}

#endif
