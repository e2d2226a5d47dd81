/// strike_point.h: the points where sticks meet a membrane; what contact.c needs of
/// membrane_step.c.
///
/// A sample with contact is: himc_membrane_ready, find the strike points and read their
/// displacement, himc_membrane_free_step, read again (the head without contact), solve, and
/// himc_strike_point_apply for each force. With a stiff contact, a sample is divided into substeps
/// and each of them is such a sequence (himc_membrane_set_substep).
#ifndef HIMC_STRIKE_POINT_H
#define HIMC_STRIKE_POINT_H

#include "bank/bank.h"
#include "drum/patch.h"

typedef struct strike_point strike_point;

/// The strike point at (x, y) with a patch of radius b (m), 0 for a point; the patch ends at the
/// rim of a round head, and a grid's places have none. Borrowed; valid until 23 others have been
/// asked for, or the head changes.
HIMC_RT strike_point *himc_membrane_strike_point(himc_membrane *membrane, double x, double y,
                                                 double b);
/// Mean displacement of the patch now (m, up positive), without the residual's.
HIMC_RT double himc_strike_point_displacement(const himc_membrane *membrane, strike_point *s);
/// Number of substeps of a sample with a stiff contact at a rate (Hz): each lasts 5.2 microseconds
/// or less.
HIMC_RT int himc_membrane_substeps(double rate);
/// The next step is substep `index` (0 .. count - 1) of `count` in a sample. Substep 0 of 1 is a
/// whole sample: the state at the beginning, and to return to.
HIMC_RT void himc_membrane_set_substep(himc_membrane *membrane, int index, int count);
/// What gives way there beside the head's modes: on a round head, under a patch.
HIMC_RT himc_residual himc_strike_point_residual(const strike_point *s);
/// Displacement at `a` at the end of a step per newton at `b` during it (m/N).
HIMC_RT double himc_strike_point_compliance(himc_membrane *membrane, strike_point *a,
                                            strike_point *b);
/// The head moves nowhere farther or faster until a force acts; INFINITY if that is not known.
HIMC_RT himc_bank_bounds himc_membrane_bounds(himc_membrane *membrane);
/// Before a step's displacements are read: makes what changes the head between two steps.
HIMC_RT void himc_membrane_ready(himc_membrane *membrane);
/// True if the head is at rest, and silent until a force acts.
HIMC_RT bool himc_membrane_at_rest(const himc_membrane *membrane);
/// Runs one step with the pushed forces only (himc_membrane_push).
HIMC_RT void himc_membrane_free_step(himc_membrane *membrane);
/// Adds the effect of `force` (N, up positive) at the strike point during this step.
HIMC_RT void himc_strike_point_apply(himc_membrane *membrane, strike_point *s, double force);

#endif
