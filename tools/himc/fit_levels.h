/// fit_levels.h: how loud a sound is: at frequencies in successive windows, and as a whole.
#ifndef FIT_LEVELS_H
#define FIT_LEVELS_H

#include "partials.h"

#define FIT_WINDOWS 5
extern const double fit_windows[FIT_WINDOWS][2]; ///< from .. to (s) after the onset
#define FIT_END FIT_WINDOWS                      ///< what is left at the end of a long recording
#define FIT_SILENT (-200.0)                      ///< (dB) nothing

/// Level (dB re an amplitude of 1) at each of `count` frequencies (Hz) in each window, and at the
/// end; NAN where the sound is shorter. False without memory.
bool fit_levels(const partials_sound *sound, const double *frequency, int count,
                double (*level)[FIT_WINDOWS + 1]);

/// Loudness of the loudest .4 s (LUFS, ITU-R BS.1770-4) of stereo samples.
double fit_loudness(const float *stereo, size_t frames, double rate);

#endif
