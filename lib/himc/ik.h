/// ik.h: inverse kinematics of one arm: from the tip's error to small rotations of shoulder,
/// elbow, wrist and grip.
///
/// A ball joint at p_j turns the tip by d(theta_j) x (tip - p_j), so with the levers r_j = tip -
/// p_j J' f = r_j x f and J J' = sum of |r_j|^2 1 - r_j r_j': a 3 x 3 matrix, whatever the number
/// of joints. Weights, null space and the elbow's task stay in three numbers likewise. Finding a
/// posture for tips at a distance, limits and trunk included, is reach.h's.
#ifndef HIMC_IK_H
#define HIMC_IK_H

#include "himc/pose.h"

typedef enum himc_solver {
    HIMC_SOLVER_DLS,       ///< damped least squares (Wampler 1986): J' (J J' + lambda^2)^-1 e
    HIMC_SOLVER_PINV,      ///< pseudo-inverse, small singular values truncated
    HIMC_SOLVER_TRANSPOSE, ///< J' e times <e, JJ'e> / <JJ'e, JJ'e> (Buss 2004)
    HIMC_SOLVER_NAKAMURA,  ///< damped near singular postures only (Nakamura & Hanafusa 1986)
    HIMC_SOLVER_SDLS,      ///< each singular direction damped on its own (Buss & Kim 2005)
    HIMC_SOLVERS
} himc_solver;

/// Jacobian of a drumstick tip (2012 paper, algorithm 2, ComputeJacobian), its joints weighted: all
/// solutions below are the smallest in the norm x' W^-1 x.
typedef struct himc_arm_jacobian {
    himc_vec3 lever[HIMC_ARM_JOINTS]; ///< from each joint to the tip (m)
    double weight[HIMC_ARM_JOINTS];   ///< W: how willingly each joint turns, 1 by default
    himc_mat3 gram;                   ///< J W J' (m^2)
    himc_mat3 inverse;                ///< of the gram, slightly regularised: for the null space
} himc_arm_jacobian;

HIMC_RT void himc_arm_jacobian_at(const himc_body_state *state, himc_hand hand,
                                  himc_arm_jacobian *jacobian);
/// The same with weights of shoulder, elbow, wrist and grip (above 0), such as the variance that
/// each has in captured motion.
HIMC_RT void himc_arm_jacobian_weighted(const himc_body_state *state, himc_hand hand,
                                        const double weight[HIMC_ARM_JOINTS],
                                        himc_arm_jacobian *jacobian);

/// The solver's (J W J')^-1 at a tip's error (m): rotations for a demand d, be it an error, a rate
/// or an acceleration, are W J' inverse d. Near the tip's place TRANSPOSE and SDLS are less than
/// the true inverse, as their steps are shorter.
HIMC_RT himc_mat3 himc_ik_inverse(const himc_arm_jacobian *jacobian, himc_solver solver,
                                  double damping, himc_vec3 error);
/// W J' f: the rotations (world frame, rad) that a force at the tip would make.
HIMC_RT void himc_ik_through(const himc_arm_jacobian *jacobian, himc_vec3 force,
                             himc_vec3 rotation[HIMC_ARM_JOINTS]);
/// Rotations that bring the tip nearer by `error` (m): the two in one. Linear in `error` but for
/// TRANSPOSE and SDLS.
HIMC_RT void himc_ik_solve(const himc_arm_jacobian *jacobian, himc_solver solver, double damping,
                           himc_vec3 error, himc_vec3 rotation[HIMC_ARM_JOINTS]);

/// J x: what the rotations (or rates) do to the tip.
HIMC_RT himc_vec3 himc_ik_forward(const himc_arm_jacobian *jacobian,
                                  const himc_vec3 rotation[HIMC_ARM_JOINTS]);

/// Adds to `rotation` the part of `wish` that leaves the tip where it is: N wish, N = 1 - J# J, J#
/// = W J' (J W J')^-1.
HIMC_RT void himc_ik_add_null(const himc_arm_jacobian *jacobian,
                              const himc_vec3 wish[HIMC_ARM_JOINTS],
                              himc_vec3 rotation[HIMC_ARM_JOINTS]);

/// The elbow as a task of second priority: moved by the shoulder alone, in the null space of the
/// tip, J_e N W J_e' damped (Siciliano & Slotine 1991).
typedef struct himc_elbow_task {
    himc_vec3 lever;   ///< from the shoulder to the elbow (m)
    himc_mat3 inverse; ///< of J_e N W J_e' + lambda^2 (1/m^2)
} himc_elbow_task;

HIMC_RT void himc_elbow_task_at(const himc_arm_jacobian *jacobian, himc_vec3 lever, double damping,
                                himc_elbow_task *task);
/// Adds to `rotation`, tip and posture being in it already, what makes the elbow move by `demand`
/// (m) instead of what it would: so the order is tip, elbow, posture.
HIMC_RT void himc_ik_add_elbow(const himc_arm_jacobian *jacobian, const himc_elbow_task *task,
                               himc_vec3 demand, himc_vec3 rotation[HIMC_ARM_JOINTS]);

/// Takes out of `rotation` what moves the tip along the unit vector `direction`, leaving `remain`
/// (m) of it: the release of the normal in contact.
HIMC_RT void himc_ik_release(const himc_arm_jacobian *jacobian, himc_vec3 direction, double remain,
                             himc_vec3 rotation[HIMC_ARM_JOINTS]);

#endif
