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
    double *omega, *decay, *mass, *damped;              ///< w, d, m, w_d
    double *q_per_p;                                    ///< 1/w_d
    double *table, *twice, *fall;                       ///< of himc_bank_waves
    _Alignas(HIMC_ALIGNMENT) double a[BLOCK], b[BLOCK]; ///< of himc_bank_waves
};

/// From now on only the oscillators at the top that are at rest count as such.
void himc_bank_wake(himc_bank *bank);
/// Brings state and film to the present sample, before a change.
void himc_bank_settle(himc_bank *bank);

static inline int bank_round_up(int n)
{
    return (n + LANES - 1) / LANES * LANES;
}

#endif
