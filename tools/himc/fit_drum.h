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
    double distance;         ///< of its blow's spectrum from the sound's (RMS dB) ...
    double next;             ///< ... and of the next mallet's
    int of[2 * FIT_ORDERS];  ///< place of the partial that a member of the pair (m,1) is, from
                             ///< 2 (m - 1) on, cosine and sine; -1: none found
    double score;
    double cents; ///< RMS of the partials beside its own
} fit_drum;

/// A mode of it.
typedef struct fit_mode {
    int m, n;
    bool sine;
    double frequency, t60;
} fit_mode;
#define FIT_MODES 80

/// Its modes (m, n), rising in frequency; how many, or 0 with the reason.
int fit_drum_modes(const fit_drum *drum, fit_mode modes[FIT_MODES], himc_error *error);

typedef struct himc_drum himc_drum;

/// It, at `rate` (Hz), with that mallet; owned. NULL with the reason.
himc_drum *fit_drum_make(const fit_drum *drum, int mallet, double rate, himc_error *error);

/// Strikes a drum at `x` (m) at that speed (m/s) and adds what its pickup has of it, for `seconds`,
/// without a room.
bool fit_hear(himc_drum *drum, double x, double speed, double seconds, partials_sound *out,
              himc_error *error);

#define FIT_CHOICES 10
/// The drums that may have these partials, but for their mallets, the likeliest first; how many, or
/// 0 with the reason.
int fit_drum_find(const partials_list *partials, fit_drum choice[FIT_CHOICES], himc_error *error);

/// Which of them it is, and the mallet and the dynamic whose blow has the spectrum of the sound's.
bool fit_drum_strike(const partials_sound *sound, const fit_drum *choice, int count, fit_drum *out,
                     himc_error *error);

#define FIT_PLACE 0.75            ///< of a blow from the centre, per radius: the usual one
extern const double fit_speeds[]; ///< (m/s) of `dynamic`
/// Names of `mallet` and `dynamic`, ended by NULL.
extern const char *const fit_mallets[], *const fit_dynamics[];

#endif
