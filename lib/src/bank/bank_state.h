/// bank_state.h: what a bank holds, for the files of this folder.
#ifndef HIMC_BANK_STATE_H
#define HIMC_BANK_STATE_H

#include "bank/bank.h"
#include "system/aligned.h"

#define LANES HIMC_BANK_LANES
#define PASS HIMC_BANK_PASS
#define LEVELS 4  ///< of the film's strength
#define POWERS 7  ///< coefficients are kept for 1, 2, 4, .. 64 samples
#define BLOCK 128 ///< oscillators whose waves are in the cache together; chosen

/// Coefficients for a number of samples, or for a substep
typedef struct bank_rotation {
    double *c, *s; ///< C, S
} bank_rotation;

/// Effect of a force during one step
typedef struct bank_effect {
    double *p, *s; ///< added to p and s by 1 N
} bank_effect;

/// Lengths of the film's steps (samples)
static const int bank_steps[LEVELS] = {1, 4, 8, 16};

/// The film: see the head of bank.c for the letters.
typedef struct bank_film {
    bool set, on;
    double s;                       ///< (J^1/2)
    double mean;                    ///< s + u/2 of the last exchange
    bool moved;                     ///< a force has acted since s was last anchored
    double power;                   ///< g . v, the rate of s, at the last exchange
    double lead;                    ///< samples that the film is ahead of the oscillators
    double least;                   ///< (J) it goes off below this energy of the oscillators
    double most[LEVELS];            ///< s up to which the steps may be so long
    int reach[LEVELS];              ///< oscillators on which it acts (a multiple of LANES)
    int level;                      ///< of the last exchange
    double *on_p, *per_mass, *damp; ///< a/w_d, 1/m, d/w_d
    double *kick;                   ///< g/m at the last exchange
    double due;                     ///< integral of s since the others were turned (J^1/2 s)
    double *rate;                   ///< a/(2 m w): their rise of w per s
    double *tight, *slack;          ///< w/w_d, w_d/w
} bank_film;

#define TURNS 16 ///< distances of pairs, one after the other; chosen

/// The cascade: see the head of bank_cascade.c.
typedef struct bank_cascade {
    himc_cascade set; ///< rate 0: none
    double *root;     ///< (f/1 kHz)^1/2
    double *sign;     ///< 1 or -1, twice as many: the second half as the first
    int turn;         ///< of the next exchange
    double since;     ///< samples since the last one
    bool acts;        ///< that changed something: no oscillator is at rest for long
} bank_cascade;

struct himc_bank {
    const himc_bank_kernel *loops;
    int capacity;   ///< a multiple of LANES
    int count;      ///< oscillators that are not silent
    int live;       ///< of these, the first `live` (a multiple of LANES) are not at rest
    int age;        ///< samples since the last search for quiet oscillators
    uint64_t pass;  ///< number of the present pass
    int at;         ///< samples that have passed in it
    int length;     ///< of the present pass; 0 before it begins
    int whole_pass; ///< length of a pass that no force ends
    uint64_t part;  ///< number of the film's present step
    int low;        ///< the first `low` oscillators make the film's steps, the others the pass
    int step_at;    ///< samples that have passed in the film's step
    int step;       ///< its length
    bool forced;    ///< a force has acted: the next step is a single sample
    double *memory;
    double *p, *s;               ///< state at the start of the pass
    bank_rotation power[POWERS]; ///< of 2^k samples
    bank_rotation sub;           ///< of a substep
    bank_effect whole, parted;   ///< in a sample, in a substep
    bank_rotation present;       ///< of a step of the present length
    bank_effect push;            ///< in it
    himc_step_length kind;
    int substeps;            ///< of a sample
    double h;                ///< a sample (s)
    himc_bank_bounds bounds; ///< without the film's part, found ...
    int bounds_left;         ///< ... so that they hold for this number of samples
    bank_film film;
    bank_cascade cascade;
    double *omega, *decay, *mass, *damped;              ///< w, d, m, w_d
    double *q_per_p;                                    ///< 1/w_d
    double *table, *twice, *fall;                       ///< of himc_bank_waves
    _Alignas(HIMC_ALIGNMENT) double a[BLOCK], b[BLOCK]; ///< of himc_bank_waves
};

// the state (bank.c)

/// From now on only the oscillators at the top that are at rest count as such.
void himc_bank_wake(himc_bank *bank);

// the film (bank_film.c)

/// Its exchange with the velocities, after which it is `lead` samples ahead.
void himc_bank_exchange(himc_bank *bank, double lead);
/// Brings state and film to the present sample, before a change.
void himc_bank_settle(himc_bank *bank);
/// It is off, and its energy lost.
void himc_bank_slacken(himc_bank *bank);
/// Chooses its steps, sets s to what the state makes of it, and scales the velocities so that the
/// energy stays. Ends it when the oscillators' energy has become small.
void himc_bank_anchor(himc_bank *bank);
/// Turns the oscillators on which it does not act by what its pull has been.
void himc_bank_turn(himc_bank *bank);
/// s as a readout hears it: at most twice the pull of the last exchange, which a film stiffer than
/// the modes themselves has not had in full.
double himc_bank_audible(const bank_film *film);
/// What it adds to a readout between exchanges, per sample of its lead, `sum` being the readout's
/// weights `film` on the state. The rate of s counts at most so that s doubles in a step.
double himc_bank_film_slope(const himc_bank *bank, const himc_readout *readout, double sum);

// the cascade (bank_cascade.c)

/// It is time for an exchange.
bool himc_bank_cascade_due(const himc_bank *bank);
/// Makes it, in the present sample, which begins another pass.
void himc_bank_scatter(himc_bank *bank);

// readouts (bank_read.c)

/// The n samples after `at` of the present pass.
void himc_bank_read_ahead(himc_bank *bank, himc_readout *readout, int n, double *out);
/// The value after a step of its own.
double himc_bank_read_single(himc_bank *bank, himc_readout *readout);

static inline int bank_round_up(int n)
{
    return (n + LANES - 1) / LANES * LANES;
}

/// Number of oscillators on which the film acts.
static inline int bank_coupled(const himc_bank *bank)
{
    int count = bank->film.reach[bank->film.level];
    return count < bank->live ? count : bank->live;
}

/// Turns the oscillators from `first` to `end` by n samples.
static inline void bank_rotate(himc_bank *bank, int first, int end, int n)
{
    for (int k = POWERS - 1; k >= 0 && end > first; k--)
        if (n >> k & 1)
            bank->loops->rotate(bank->p + first, bank->s + first, bank->power[k].c + first,
                                bank->power[k].s + first, end - first);
}

/// Brings the state to the present sample, which ends the pass.
static inline void bank_arrive(himc_bank *bank)
{
    bank_rotate(bank, 0, bank->low, bank->step_at);
    bank_rotate(bank, bank->low, bank->live, bank->at);
    bank->film.lead -= bank->step_at;
    bank->film.due += bank->film.s * bank->at * bank->h;
    bank->at = bank->length = bank->low = bank->step_at = 0;
    bank->pass++;
}

/// p and s of one oscillator at the present sample: the same numbers as by bank_arrive.
static inline void bank_present(const himc_bank *bank, int i, double *p, double *s)
{
    *p = bank->p[i];
    *s = bank->s[i];
    int n = i < bank->low ? bank->step_at : bank->at;
    for (int k = POWERS - 1; k >= 0; k--) {
        if (!(n >> k & 1))
            continue;
        double c = bank->power[k].c[i], w = bank->power[k].s[i], before = *p;
        *p = c * before + w * *s;
        *s = c * *s - w * before;
    }
}

#endif
