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
    int other;               ///< that mallet
    int of[2 * FIT_ORDERS];  ///< place of the partial that a member of the pair (m,1) is, from
                             ///< 2 (m - 1) on, cosine and sine; -1: none found
    bool strange;            ///< tuned by (1,1) alone: its other partials are elsewhere
    bool hidden;             ///< by the room, which rings longer: losses are uncertain
    bool dry;                ///< nearer without our room
    double score;
    double comb; ///< (dB) by which its modes stand out of the spectrum, summed
} fit_drum;

/// A mode of it.
typedef struct fit_mode {
    int m, n;
    bool sine;
    double frequency, t60;
} fit_mode;
#define FIT_MODES 80

/// One with usual losses (himc_head_default).
#define FIT_USUAL_CONSTANT 0.3
#define FIT_USUAL_SQUARE 5e-8
fit_drum fit_drum_usual(double inches, double tune);

/// Its modes (m, n), rising in frequency; how many, or 0 with the reason.
int fit_drum_modes(const fit_drum *drum, fit_mode modes[FIT_MODES], himc_error *error);

typedef struct himc_drum himc_drum;

/// It, at `rate` (Hz), with that mallet; owned. NULL with the reason.
himc_drum *fit_drum_make(const fit_drum *drum, int mallet, double rate, himc_error *error);

/// Strikes a drum at `x` (m) at that speed (m/s) and adds what its pickup has of it, for `seconds`,
/// without a room.
bool fit_hear(himc_drum *drum, double x, double speed, double seconds, partials_sound *out,
              himc_error *error);

/// How far the first .7 s stand out of their neighbourhood (dB), from FIT_LOWEST on in steps of
/// FIT_FINE of the frequency.
#define FIT_LOWEST 45.0
#define FIT_FINE 0.0015
#define FIT_LINES 2200 ///< to 1220 Hz
typedef struct fit_spectrum {
    double level[FIT_LINES], mean;
} fit_spectrum;
/// False with the reason, without memory.
bool fit_spectrum_of(const partials_sound *sound, fit_spectrum *out, himc_error *error);

#define FIT_TUNINGS 2
/// The tunings of a timpano from `low` to `high` (Hz) whose modes stand out most, the best first.
/// False with the reason.
bool fit_comb(const fit_spectrum *spectrum, double inches, double low, double high,
              fit_drum best[FIT_TUNINGS], himc_error *error);

#define FIT_CHOICES 4
/// The drums that may have these partials, but for their mallets, the likeliest first; how many, or
/// 0 with the reason.
int fit_drum_find(const partials_sound *sound, const fit_spectrum *spectrum,
                  const partials_list *partials, fit_drum choice[FIT_CHOICES], himc_error *error);

/// Whether a second drum sounds beside this one, that is left when its modes are taken out of the
/// spectrum. False with the reason.
bool fit_drum_second(const fit_drum *drum, const fit_spectrum *spectrum, fit_drum *second,
                     bool *sounds, himc_error *error);

/// Which of them it is, and the mallet and the dynamic whose blow has the spectrum of the sound's.
bool fit_drum_strike(const partials_sound *sound, const fit_drum *choice, int count, fit_drum *out,
                     himc_error *error);

#define FIT_PLACE 0.75            ///< of a blow from the centre, per radius: the usual one
extern const double fit_speeds[]; ///< (m/s) of `dynamic`
/// Names of `mallet` and `dynamic`, ended by NULL.
extern const char *const fit_mallets[], *const fit_dynamics[];

#endif
