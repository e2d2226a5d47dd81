/// bank.h: damped oscillators, each stepped exactly; a force is constant over a step.
///
/// m q'' + 2 m d q' + m w^2 q = f. Frequency and decay are exact at any sample rate: the only
/// assumption is the shape of the force between two samples. The sample rate and the oscillators'
/// constants may change while the bank sounds. A film may couple all of them: a spring on the sum
/// of their squares.
#ifndef HIMC_BANK_H
#define HIMC_BANK_H

#include "himc/base.h"

#include "bank/bank_kernel.h"

typedef struct himc_oscillator {
    double omega; ///< w, undamped (rad/s)
    double decay; ///< d (1/s), 0 <= d < w
    double mass;  ///< m (kg)
} himc_oscillator;

typedef struct himc_bank himc_bank;

/// Room for `capacity` oscillators, none of them in use yet. NULL without memory.
himc_bank *himc_bank_new(int capacity, himc_error *error);
void himc_bank_free(himc_bank *bank);

/// Length of every array marked (padded) below: the capacity rounded up to a multiple of 8. The
/// caller aligns these arrays to 64 bytes; entries past the last oscillator are 0.
HIMC_RT int himc_bank_padded(const himc_bank *bank);
/// Replaces the loops that the bank was made with, the fastest of this machine. All give the same
/// bits; for tests.
void himc_bank_use(himc_bank *bank, const himc_bank_kernel *kernel);

/// Sets these `count` oscillators (in order of frequency, at most the capacity) at `rate` (Hz).
/// Oscillators that were in use keep their phase and energy. From the first one at or above 0.49
/// rate on, oscillators are silent: they would sound at a wrong pitch.
HIMC_RT void himc_bank_set(himc_bank *bank, const himc_oscillator *oscillators, int count,
                           double rate);

/// Film and the first `count` oscillators, if `from` has them, too, begin with its phase and
/// energy, as if they had been in use here with its constants before the last himc_bank_set; all
/// others at rest. Nothing remains of what `bank` did before.
HIMC_RT void himc_bank_continue(himc_bank *bank, himc_bank *from, int count);

/// Gives a bank at rest, of the same capacity, the constants of `from`.
HIMC_RT void himc_bank_copy(himc_bank *bank, const himc_bank *from);

/// The bank has coefficients for two lengths of step.
typedef enum himc_step_length {
    HIMC_STEP_SAMPLE,  ///< a whole sample
    HIMC_STEP_SUBSTEP, ///< one of the equal parts of a sample
    HIMC_STEP_LENGTHS
} himc_step_length;

/// From the next himc_bank_set on, a sample consists of `count` substeps.
HIMC_RT void himc_bank_set_substeps(himc_bank *bank, int count);
/// Length of a step in all functions below that run, push or give a response.
HIMC_RT void himc_bank_set_step(himc_bank *bank, himc_step_length step);
/// Number of oscillators that are not silent.
HIMC_RT int himc_bank_count(const himc_bank *bank);

/// A linear readout of the state, sum_i (weight on q_i) q_i + (weight on q_i') q_i', in the bank's
/// own coordinates (bank.c). Valid until the next himc_bank_set or himc_bank_set_film.
typedef struct himc_readout {
    double *p, *s;                ///< owned by the caller (padded)
    double *film;                 ///< what the film adds, owned by the caller (padded); or NULL
    bool direct;                  ///< `film` is of its forces themselves, not of what they move
    uint64_t pass, part;          ///< to which `ahead` belongs; the caller begins with 0
    double ahead[HIMC_BANK_PASS]; ///< its values in the samples of that pass
    uint64_t read_pass;           ///< the pass at whose start it was read last; ...
    double value;                 ///< ... its value then
    struct himc_alike *alike;     ///< it is one of these, borrowed; or NULL
} himc_readout;

/// Readouts that see each oscillator in the same phase, louder or softer: the weights of a form, of
/// each times its gains. What the film does not hold is computed once for all of them.
typedef struct himc_alike {
    himc_readout form;                      ///< its weights alone
    double *gain[HIMC_BANK_ALIKE];          ///< owned by the caller (padded)
    himc_readout *readout[HIMC_BANK_ALIKE]; ///< borrowed
} himc_alike;

/// Fills `readout` from weights on displacements, on velocities and on the film's forces (each may
/// be NULL).
HIMC_RT void himc_bank_readout(const himc_bank *bank, const double *on_q, const double *on_v,
                               const double *on_force, himc_readout *readout);
HIMC_RT double himc_bank_read(himc_bank *bank, himc_readout *readout);
/// Value of the readout one step later if no force acts.
HIMC_RT double himc_bank_peek(const himc_bank *bank, const himc_readout *readout);

/// Makes what changes the state between two samples and is due now. A caller that compares readouts
/// before and after a step calls it first.
HIMC_RT void himc_bank_ready(himc_bank *bank);
/// Runs `n` samples (or one substep) without force: out[k][i] is the value of readouts[k] after
/// sample i. What is not wanted (out[k] is NULL) is not computed.
HIMC_RT void himc_bank_run(himc_bank *bank, int n, himc_readout *const *readouts, int count,
                           double *const *out);

#define HIMC_BANK_MOST 2.0 ///< largest entry of the weights of himc_bank_bounds_of

/// How far (m) and how fast (m/s) a place moves at most.
typedef struct himc_bank_bounds {
    double swing, speed;
} himc_bank_bounds;

/// Upper bounds of |sum_i shape_i q_i| and |sum_i shape_i q_i'| for all shapes with |shape_i| <=
/// most_i (padded), until the next force, excitation or setting: oscillators only lose. The film
/// lends and takes back.
HIMC_RT himc_bank_bounds himc_bank_bounds_of(himc_bank *bank, const double *most);

/// The film: a spring of energy s^2/2, s = sum_i a_i q_i^2/2, on all oscillators together. Sets the
/// a_i (count), or NULL for none. It comes on with a force or himc_bank_find_film, and goes off,
/// its energy lost, when the oscillators together have less than `least` (J).
HIMC_RT void himc_bank_set_film(himc_bank *bank, const double *on_square, double least);
/// Finds s from the displacements.
HIMC_RT void himc_bank_find_film(himc_bank *bank);
/// s now (J^1/2), 0 while it is off.
HIMC_RT double himc_bank_film(const himc_bank *bank);

/// An exchange of energy between the modes of a plate (bank_cascade.c).
typedef struct himc_cascade {
    double rate;   ///< kappa (1/s)
    int span;      ///< of the pairs (modes)
    double energy; ///< E_0 of all oscillators, at which half of that rate is reached (J)
} himc_cascade;

/// After himc_bank_set: has the oscillators, which are of one mass, exchange energy after each
/// pass, or NULL: not.
HIMC_RT void himc_bank_set_cascade(himc_bank *bank, const himc_cascade *cascade);

/// After a step was run: adds the effect of `force` (N) during that step, spread over the
/// oscillators by the weights `shape` (padded).
HIMC_RT void himc_bank_push(himc_bank *bank, const double *shape, double force);
/// HIMC_BANK_ROWS points together, a row of weights (padded) for each, one row behind the other:
/// their displacements now, and pushes of them all, as by himc_bank_push.
HIMC_RT void himc_bank_read_rows(himc_bank *bank, const double *rows, double *displacement);
HIMC_RT void himc_bank_push_rows(himc_bank *bank, const double *rows, const double *force);
/// Length of a pass that no force ends: 8, 16, 32 or HIMC_BANK_PASS samples, as at first. Kicks in
/// such intervals cost least.
HIMC_RT void himc_bank_set_pass(himc_bank *bank, int samples);
/// Between two samples: adds `change` (m/s) to the velocity of one oscillator; no effect on a
/// silent one.
HIMC_RT void himc_bank_kick(himc_bank *bank, int index, double change);
/// Between two samples: takes that part, 0 .. 1, of each oscillator's velocity.
HIMC_RT void himc_bank_slow(himc_bank *bank, double part);
/// Value of `readout` at the end of a step per newton through `shape` (padded) during it. For a
/// readout of the displacement at a and the shape at b this is the compliance sum phi_a phi_b b1
/// (m/N).
HIMC_RT double himc_bank_response(const himc_bank *bank, const double *shape,
                                  const himc_readout *readout);

/// The same prepared once for any shape: response = himc_bank_sum(bank, shape, response array),
/// all arrays (padded).
HIMC_RT void himc_bank_step_response(const himc_bank *bank, const himc_readout *readout,
                                     double *response);
/// sum_i shape_i response_i.
HIMC_RT double himc_bank_sum(const himc_bank *bank, const double *shape, const double *response);

/// Kinetic and potential energy of the oscillators (J), without the film's s^2/2.
HIMC_RT double himc_bank_energy(const himc_bank *bank);
/// Displacement and velocity of one oscillator (m, m/s); 0 if it is silent.
HIMC_RT void himc_bank_state(const himc_bank *bank, int index, double *q, double *v);
/// Sets them; no effect on a silent one.
HIMC_RT void himc_bank_excite(himc_bank *bank, int index, double q, double v);
HIMC_RT bool himc_bank_at_rest(const himc_bank *bank);
HIMC_RT void himc_bank_rest(himc_bank *bank);

#endif
