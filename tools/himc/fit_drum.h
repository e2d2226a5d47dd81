/// fit_drum.h: the timpano that has given partials.
#ifndef FIT_DRUM_H
#define FIT_DRUM_H

#include "partials.h"

#define FIT_ORDERS 6 ///< (1,1) .. (6,1), by which a timpano is known

/// A timpano as commands say it.
typedef struct fit_drum {
    double inches;
    double tune;             ///< (Hz)
    double constant, square; ///< losses S0 (1/s), S1 (s)
    int mallet;              ///< place in fit_mallets
    int dynamic;             ///< place in fit_dynamics
    double mallet_clear;     ///< distance of the next mallet over its own (dB)
    int of[2 * FIT_ORDERS];  ///< place of the partial that a member of the pair (m,1) is, from
                             ///< 2 (m - 1) on, cosine and sine; -1: none found
    double score;
    double cents; ///< RMS of the partials beside its own
} fit_drum;

extern const char *const fit_mallets[], *const fit_dynamics[];

/// A mode of it.
typedef struct fit_mode {
    int m, n;
    bool sine;
    double frequency, t60;
} fit_mode;
#define FIT_MODES 80

/// Its modes (m, n), rising in frequency; how many, or 0 with the reason.
int fit_drum_modes(const fit_drum *drum, fit_mode modes[FIT_MODES], himc_error *error);

/// The drum that has these partials, but for its mallet. False with the reason: no timpano has.
bool fit_drum_find(const partials_list *partials, fit_drum *out, himc_error *error);

/// Chooses the mallet whose blow has the spectrum of the sound's.
bool fit_drum_strike(const partials_sound *sound, fit_drum *drum, himc_error *error);

/// The score that makes and strikes it.
void fit_drum_score(const fit_drum *drum, const char *name, char *text, size_t size);

#endif
