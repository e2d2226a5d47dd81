/// ik.h: inverse kinematics of an arm, the parts that only the controller uses: the forward map,
/// the elbow as a second task, the release of the contact normal; private.
#ifndef HIMC_IK_H
#define HIMC_IK_H

#include "himc/body.h"

/// Added to J W J' (m^2). Chosen: (1 um)^2, six orders below the smallest useful damping, only
/// keeps the inverse finite.
#define HIMC_NULL_FLOOR 1e-12

/// J x: the displacement of the tip (m) by these joint rotations (rad), or its velocity (m/s) by
/// their rates (rad/s).
HIMC_RT himc_vec3 himc_ik_forward(const himc_arm_jacobian *jacobian,
                                  const himc_vec3 rotation[HIMC_ARM_JOINTS]);

/// W J' f: the joint rotations (world frame) for a vector f at the tip.
HIMC_RT void himc_ik_apply_transposed(const himc_arm_jacobian *jacobian, himc_vec3 f,
                                      himc_vec3 rotation[HIMC_ARM_JOINTS]);

/// The elbow as a task of second priority: moved by the shoulder alone, in the null space of the
/// tip, with J_e N W J_e' damped (Siciliano & Slotine 1991).
typedef struct himc_elbow_task {
    himc_vec3 lever;   ///< from the shoulder to the elbow (m)
    himc_mat3 inverse; ///< of J_e N W J_e' + lambda^2 (1/m^2)
} himc_elbow_task;

/// Prepares the elbow task for this Jacobian, `lever` from the shoulder to the elbow (m),
/// `damping` lambda (m).
HIMC_RT void himc_elbow_task_init(himc_elbow_task *task, const himc_arm_jacobian *jacobian,
                                  himc_vec3 lever, double damping);

/// Adds to `rotation`, which already contains the tip's and the pose's parts, the shoulder motion
/// that changes the elbow's displacement to `demand` (m) without moving the tip. The order of
/// priority is then tip, elbow, pose.
HIMC_RT void himc_ik_add_elbow(const himc_arm_jacobian *jacobian, const himc_elbow_task *task,
                               himc_vec3 demand, himc_vec3 rotation[HIMC_ARM_JOINTS]);

/// Reduces the part of `rotation` that moves the tip along the unit vector `direction` to `remain`
/// (m): the release of the normal in contact.
HIMC_RT void himc_ik_release(const himc_arm_jacobian *jacobian, himc_vec3 direction, double remain,
                             himc_vec3 rotation[HIMC_ARM_JOINTS]);

#endif
