/// bank.h: damped oscillators, each stepped exactly; a force is constant over a sample.
///
/// m q'' + 2 m d q' + m w^2 q = f. No approximation of frequency or decay at any sample rate:
/// between two samples nothing but the shape of the force is assumed. Sample rates and parameters
/// may change while it sounds.
#ifndef HIMC_BANK_H
#define HIMC_BANK_H

#include "himc/base.h"
#include "himc/osc.h"

typedef struct himc_oscillator {
    double omega; ///< w, undamped (rad/s)
    double decay; ///< d (1/s), 0 <= d < w
    double mass;  ///< m (kg)
} himc_oscillator;

typedef struct himc_bank himc_bank;

/// Room for `capacity` oscillators, none of them there yet.
himc_bank *himc_bank_new(int capacity, himc_error *error);
void himc_bank_free(himc_bank *bank);

/// Length of every array of weights below: the capacity rounded up to a multiple of 4. They are
/// aligned to 16 bytes, and what lies past the oscillators is 0.
HIMC_RT int himc_bank_padded(const himc_bank *bank);

/// From now on these `count` oscillators (in order of frequency, at most the capacity) at `rate`
/// (Hz). Those that were there keep their phase and energy. Those from the first above 0.49 rate on
/// are silent: they would be heard at a wrong pitch.
HIMC_RT void himc_bank_set(himc_bank *bank, const himc_oscillator *oscillators, int count,
                           double rate);
/// From the next himc_bank_set on, a sample can also be stepped through in so many parts.
HIMC_RT void himc_bank_divide(himc_bank *bank, int parts);
/// What a step is in all functions below that step, push or answer: gear 0 a whole sample, 1 a
/// part.
#define HIMC_BANK_SUBSTEPS 2
HIMC_RT void himc_bank_set_substep(himc_bank *bank, int gear);
/// Those that swing (not silent).
HIMC_RT int himc_bank_count(const himc_bank *bank);

/// A linear reading of the state, sum_i (weight on q_i) q_i + (weight on q_i') q_i', in the bank's
/// own coordinates. It holds until the next himc_bank_set.
typedef struct himc_readout {
    double *p, *s; ///< owned by the caller (padded)
} himc_readout;

/// Makes the tap of weights on displacements and on velocities (either may be NULL).
HIMC_RT void himc_bank_readout(const himc_bank *bank, const double *on_q, const double *on_v,
                               himc_readout *tap);
HIMC_RT double himc_bank_read(const himc_bank *bank, const himc_readout *tap);

/// What it would read one sample later, if no force acts.
HIMC_RT double himc_bank_peek(const himc_bank *bank, const himc_readout *tap);
/// himc_bank_read for a tap on displacements alone.
HIMC_RT double himc_bank_displacement(const himc_bank *bank, const himc_readout *tap);

/// `n` samples without force: read[k][i] is what taps[k] (1 .. HIMC_BANK_READOUTS) reads after sample
/// i.
#define HIMC_BANK_READOUTS 10
HIMC_RT void himc_bank_run(himc_bank *bank, int n, const himc_readout *const *taps, int count,
                           double *const *read);

/// What a spring on the sum of squares Q = sum_i a_i q_i^2/2 meets in a sample.
typedef struct himc_tension_coupling {
    double *shape;     ///< g_i, the mean of dQ/dq_i before and after (padded); owned by the caller
    double climb;      ///< g . (q after - q before), which is the change of Q exactly
    double compliance; ///< what g . q moves per unit of force through g (sum g_i^2 b1_i)
} himc_tension_coupling;

/// The weights (padded) that himc_bank_run_coupled takes for these a_i; until the next
/// himc_bank_set.
HIMC_RT void himc_bank_weigh(const himc_bank *bank, const double *on_square, double *weight);
/// One sample without force, and its `pull`.
HIMC_RT void himc_bank_run_coupled(himc_bank *bank, const double *weight,
                                   himc_tension_coupling *pull);

/// After a sample was run: what `force` (N) during it has added, spread by the weights `shape`
/// (padded).
HIMC_RT void himc_bank_push(himc_bank *bank, const double *shape, double force);
/// What `tap` reads at the end of a sample per newton through `shape` (padded) during it; of a tap
/// on displacements at one place and a shape of another, the compliance sum phi_a phi_b b1 (m/N).
HIMC_RT double himc_bank_response(const himc_bank *bank, const double *shape,
                                  const himc_readout *tap);

/// The same once for any shape: response = sum_i shape_i answer_i, `answer` and the sum (padded).
HIMC_RT void himc_bank_step_response(const himc_bank *bank, const himc_readout *tap,
                                     double *answer);
HIMC_RT double himc_bank_sum(const himc_bank *bank, const double *shape, const double *answer);

/// Kinetic and potential energy (J).
HIMC_RT double himc_bank_energy(const himc_bank *bank);
/// Displacement and velocity of one oscillator; 0 if it is silent.
HIMC_RT void himc_bank_state(const himc_bank *bank, int index, double *q, double *v);
/// Sets them (m, m/s); nothing for a silent one.
HIMC_RT void himc_bank_excite(himc_bank *bank, int index, double q, double v);
/// Brings all to rest.
HIMC_RT void himc_bank_rest(himc_bank *bank);

#endif
