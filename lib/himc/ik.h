/// ik.h: inverse kinematics of one arm: from the tip's error to small rotations of shoulder,
/// elbow, wrist and grip.
///
/// A ball joint at p_j turns the tip by d(theta_j) x (tip - p_j), so with the levers r_j = tip -
/// p_j J' f = r_j x f and J J' = sum of |r_j|^2 1 - r_j r_j': a 3 x 3 matrix, whatever the number
/// of joints.
#ifndef HIMC_IK_H
#define HIMC_IK_H

#include "himc/pose.h"

typedef enum himc_solver {
    HIMC_SOLVER_DLS,      ///< damped least squares (Wampler 1986): J' (J J' + lambda^2)^-1 e
    HIMC_SOLVER_PINV,     ///< pseudo-inverse, small singular values truncated
    HIMC_SOLVER_TRANSPOSE ///< J' e times <e, JJ'e> / <JJ'e, JJ'e> (Buss 2004)
} himc_solver;

/// Jacobian of a drumstick tip (2012 paper, algorithm 2, ComputeJacobian).
typedef struct himc_arm_jacobian {
    himc_vec3 lever[HIMC_ARM_JOINTS]; ///< from each joint to the tip (m)
    himc_mat3 gram;                   ///< J J' (m^2)
    himc_mat3 inverse;                ///< of the gram, slightly regularised: for the null space
} himc_arm_jacobian;

HIMC_RT void himc_arm_jacobian_at(const himc_body_state *state, himc_hand hand,
                                  himc_arm_jacobian *jacobian);

/// Rotations (world frame, rad) that bring the tip nearer by `error` (m). Linear in `error` but
/// for TRANSPOSE.
HIMC_RT void himc_ik_solve(const himc_arm_jacobian *jacobian, himc_solver solver, double damping,
                           himc_vec3 error, himc_vec3 rotation[HIMC_ARM_JOINTS]);

/// J x: what the rotations (or rates) do to the tip.
HIMC_RT himc_vec3 himc_ik_forward(const himc_arm_jacobian *jacobian,
                                  const himc_vec3 rotation[HIMC_ARM_JOINTS]);

/// Adds to `rotation` the part of `wish` that leaves the tip where it is: (1 - J# J) wish.
HIMC_RT void himc_ik_add_null(const himc_arm_jacobian *jacobian,
                              const himc_vec3 wish[HIMC_ARM_JOINTS],
                              himc_vec3 rotation[HIMC_ARM_JOINTS]);

/// Takes out of `rotation` what moves the tip along the unit vector `direction`, leaving `remain`
/// (m) of it: the release of the normal in contact.
HIMC_RT void himc_ik_release(const himc_arm_jacobian *jacobian, himc_vec3 direction, double remain,
                             himc_vec3 rotation[HIMC_ARM_JOINTS]);

#endif
