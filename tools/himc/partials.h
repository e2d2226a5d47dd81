/// partials.h: the partials of struck sounds: damped sinusoids, found in recordings of one
/// instrument.
#ifndef PARTIALS_H
#define PARTIALS_H

#include "himc/base.h"

#include <stddef.h>

#define PARTIALS_MOST 400
#define PARTIALS_TRACKS 32 ///< channels of all recordings together

/// One damped sinusoid. Errors are standard deviations, as far as it was found alike in windows
/// that begin at different times.
typedef struct partial {
    double frequency;       ///< (Hz)
    double frequency_error; ///< (Hz)
    double t60;             ///< (s)
    double t60_error;       ///< (s)
    double level;           ///< at the onset, of all channels (dB re the sound's peak)
    double energy;          ///< 10 lg of what it has over all time (dB)
    double clear; ///< by which that, or its level after 1 s, stands out of its neighbours' (dB)
    bool line;    ///< it falls evenly: partials_lines
} partial;

/// What was heard, each channel of each stroke from its onset on.
typedef struct partials_sound {
    double *track[PARTIALS_TRACKS]; ///< (length), their peak over the channels of a stroke is 1
    size_t length[PARTIALS_TRACKS];
    int tracks;
    double rate;                ///< (Hz), of all
    double noise;               ///< before the onset (dB re the first .5 s), of the worst
    struct partials_sound *low; ///< the same at a lower rate, up to PARTIALS_LOW
} partials_sound;
#define PARTIALS_LOW 1300.0 ///< (Hz) of a drum's partials

typedef struct partials_list {
    partial row[PARTIALS_MOST]; ///< rising in frequency
    int count;
    double room; ///< T60 of what sounds between the partials, the middle one (s)
} partials_list;

/// Adds the stroke of a sound file. False with the reason: no sound file, silence, clipped, too
/// short, too noisy, two strokes, another sample rate.
bool partials_read(partials_sound *sound, const char *path, himc_error *error);
/// Adds the channels of a stroke, taken over by copy: `samples` of each, `channels` in turn. What
/// is not `recorded` may end at once.
bool partials_add(partials_sound *sound, const float *samples, size_t frames, int channels,
                  double rate, const char *name, bool recorded, himc_error *error);
void partials_sound_free(partials_sound *sound);

/// All partials up to `highest` (Hz). False with the reason, without memory.
bool partials_find(const partials_sound *sound, double highest, partials_list *out,
                   himc_error *error);

/// Level (dB) at `count` frequencies (Hz) from `from` to `to` (s), of all channels together, in
/// Hann's window, from the onset on in its second half; of `sound->low` up to PARTIALS_LOW, sooner.
/// False without memory.
bool partials_levels(const partials_sound *sound, double from, double to, const double *frequency,
                     int count, double *level);

#define PARTIALS_LINES 1200.0 ///< (Hz) up to which lines are found
/// Puts lines that fall evenly in the place of the poles about them, and drops the hall's.
void partials_lines(const partials_sound *sound, partials_list *list);

/// Which part of a sound is compared: while a room only echoes the onset, once it has answered, and
/// when its answer is soft.
typedef enum partials_part { PARTIALS_EARLY, PARTIALS_LATE, PARTIALS_LAST } partials_part;

/// How likely pairs of partials about `frequency`, `apart` from each other, that decay alike, are:
/// ln of it, for each of `shifts` (Hz) and `decays` (1/s), to out[shift * decays + decay]; by the
/// energy that least squares leave in a narrow band, in a `room` of that T60 (s; 0: none). False
/// with the reason, without memory.
bool partials_likely(const partials_sound *sound, partials_part part, double room, double frequency,
                     double apart, const double *shift, int shifts, const double *decay, int decays,
                     double *out, himc_error *error);

#endif
