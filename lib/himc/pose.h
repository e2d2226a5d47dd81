/// pose.h: the kinematic layer: postures, and the moving body as seen in the world (2012 paper,
/// equation 1: K).
#ifndef HIMC_POSE_H
#define HIMC_POSE_H

#include "himc/skeleton.h"

/// A posture: the rotation of each segment in its parent's frame; the zero pose is all identity.
typedef struct himc_pose {
    himc_quat joint[HIMC_JOINTS];
} himc_pose;

/// The moving body in the world; entry 0 (the pelvis) is held still at the skeleton's root.
typedef struct himc_body_state {
    himc_quat orientation[HIMC_SEGMENTS];
    himc_mat3 rotation[HIMC_SEGMENTS];  ///< the same as matrices
    himc_vec3 origin[HIMC_SEGMENTS];    ///< joint to the parent (m)
    himc_vec3 spin[HIMC_SEGMENTS];      ///< angular velocity (rad/s)
    himc_vec3 tip[HIMC_HANDS];          ///< drumstick tips (m)
    himc_vec3 tip_velocity[HIMC_HANDS]; ///< (m/s)
} himc_body_state;

/// The zero pose.
HIMC_RT himc_pose himc_pose_zero(void);

/// Forward kinematics of a posture at rest. Of a posture in motion when `rate` gives each joint's
/// angular velocity in its parent's frame (rad/s); `rate` may be NULL.
HIMC_RT void himc_pose_to_state(const himc_skeleton *skeleton, const himc_pose *pose,
                                const himc_vec3 rate[HIMC_JOINTS], himc_body_state *state);

/// The posture of a state.
HIMC_RT himc_pose himc_pose_from_state(const himc_skeleton *skeleton, const himc_body_state *state);

/// Fills origins, rotation matrices, tips and their velocities from orientations and spins.
HIMC_RT void himc_body_state_complete(const himc_skeleton *skeleton, himc_body_state *state);

/// True if every number of the state is finite.
HIMC_RT bool himc_body_state_finite(const himc_body_state *state);

#endif
