/// solvers.h: the table of the solvers of inverse kinematics; private.
#ifndef HIMC_SOLVERS_H
#define HIMC_SOLVERS_H

#include "control/ik.h"

/// The approximation of (J W J')^-1 for a tip error (m); HIMC_RT. The joint rotations for a demand
/// d (an error, a velocity or an acceleration of the tip) are W J' inverse d. `damping` is that of
/// himc_ik_solve.
typedef himc_mat3 himc_solver_inverse(const himc_arm_jacobian *jacobian, double damping,
                                      himc_vec3 error);

typedef struct himc_solver_row {
    const char *word; ///< of the command `solver`
    himc_solver_inverse *inverse;
    bool own_step; ///< its step length depends on the demand: an inverse is for one demand only
} himc_solver_row;

/// In the order of himc_solver.
extern const himc_solver_row himc_solvers[HIMC_SOLVERS];

#endif
