/// invdyn.h: inverse dynamics: from the accelerations wanted to the joint torques that make them;
/// and its mirror, forward dynamics, which a contact needs to know how a stick answers a force.
///
/// All vectors are in the world frame. A joint's relative acceleration is the time derivative, in
/// the world, of the difference of its two segments' angular velocities (rad/s^2). The pelvis is
/// held.
#ifndef HIMC_INVDYN_H
#define HIMC_INVDYN_H

#include "himc/pose.h"

#define HIMC_GRAVITY 9.80665 ///< (m/s^2), along -z

/// Recursive Newton-Euler (Featherstone 2008, chapter 5): torque of each joint on its child (N m)
/// for the accelerations `relative` (HIMC_JOINTS; NULL for none) at this state. With `still` the
/// spins are taken as zero: gravity alone.
HIMC_RT void himc_inverse_dynamics(const himc_skeleton *skeleton, const himc_body_state *state,
                                   const himc_vec3 *relative, bool still,
                                   himc_vec3 torque[HIMC_JOINTS]);

/// How the upper body answers forces at a state: the articulated inertias of its segments. Plain
/// working memory.
typedef struct himc_articulation {
    himc_mat3 inverse[HIMC_SEGMENTS]; ///< of the articulated rotational inertia about the joint
    himc_mat3 couple[HIMC_SEGMENTS];  ///< moment about the joint for a unit acceleration of it
    himc_mat3 mass[HIMC_SEGMENTS];    ///< felt by the parent at the joint (kg)
    int end;                          ///< segments 1 .. end - 1 take part
    bool resists;                     ///< joints resist their own acceleration:
    himc_mat3 resist[HIMC_SEGMENTS];  ///< ... by D (kg m^2)
    himc_mat3 share[HIMC_SEGMENTS];   ///< D times `inverse`
    himc_mat3 turn[HIMC_SEGMENTS];    ///< moment on the parent for a unit acceleration of the joint
} himc_articulation;

/// Articulated-body inertias (Featherstone 2008, chapter 7) of all segments but the legs'.
HIMC_RT void himc_articulate(const himc_skeleton *skeleton, const himc_body_state *state,
                             himc_articulation *articulation);

/// The same of all segments, when each joint beside its torque resists the relative acceleration
/// it gets by `resistance` about the child's axes (kg m^2): what a servo taken implicitly over a
/// step does, h Kd + h^2 Kp (Tan, Liu & Turk 2011).
HIMC_RT void himc_articulate_resisting(const himc_skeleton *skeleton, const himc_body_state *state,
                                       const himc_vec3 resistance[HIMC_JOINTS],
                                       himc_articulation *articulation);

/// Forward dynamics: the relative accelerations under `torque` (HIMC_JOINTS), gravity and a force
/// on each drumstick tip (N; NULL for none). Entries of the legs' joints are left alone unless
/// joints resist.
HIMC_RT void himc_forward_dynamics(const himc_skeleton *skeleton, const himc_body_state *state,
                                   const himc_articulation *articulation, const himc_vec3 *torque,
                                   const himc_vec3 *tip_force, himc_vec3 relative[HIMC_JOINTS]);

/// Acceleration of a drumstick tip under these relative accelerations (m/s^2).
HIMC_RT himc_vec3 himc_tip_acceleration(const himc_skeleton *skeleton, const himc_body_state *state,
                                        himc_hand hand, const himc_vec3 *relative);

/// Operational-space inertia of a tip along a unit direction: 1 / (n J M^-1 J' n) (kg); of joints
/// that do not resist.
HIMC_RT double himc_effective_mass(const himc_skeleton *skeleton, const himc_body_state *state,
                                   const himc_articulation *articulation, himc_hand hand,
                                   himc_vec3 direction);

#endif
