/// body.h: the performer's body as a constant table: 20 rigid segments in a tree of 19 ball
/// joints (57 degrees of freedom), with masses, centres and inertias; sticks are segments like
/// any other (2012 paper, section 3.1).
///
/// Each segment's frame has its origin in the joint to its parent. In the zero pose the body
/// stands, arms and sticks hanging, and all frames are parallel to the world's: x forward, y
/// left, z up. Joint j joins segment j + 1 to its parent.
#ifndef HIMC_BODY_H
#define HIMC_BODY_H

#include "himc/vec.h"

typedef enum himc_segment_id {
    HIMC_PELVIS,
    HIMC_TRUNK,
    HIMC_NECK,
    HIMC_HEAD,
    HIMC_LEFT_UPPER_ARM, // the arms: left is even, right is the next
    HIMC_RIGHT_UPPER_ARM,
    HIMC_LEFT_FOREARM,
    HIMC_RIGHT_FOREARM,
    HIMC_LEFT_HAND,
    HIMC_RIGHT_HAND,
    HIMC_LEFT_STICK,
    HIMC_RIGHT_STICK,
    HIMC_LEFT_UPPER_LEG,
    HIMC_RIGHT_UPPER_LEG,
    HIMC_LEFT_LOWER_LEG,
    HIMC_RIGHT_LOWER_LEG,
    HIMC_LEFT_FOOT,
    HIMC_RIGHT_FOOT,
    HIMC_LEFT_TOES,
    HIMC_RIGHT_TOES
} himc_segment_id;

#define HIMC_DOF (3 * HIMC_JOINTS)

/// The joints of an arm, from the body outwards: shoulder, elbow, wrist, grip.
#define HIMC_ARM_JOINTS 4

typedef enum himc_anthropometry {
    HIMC_DE_LEVA, ///< de Leva 1996, from height and mass
    HIMC_TABLE_1  ///< 2012 paper, table 1: each row once per body, scaled to sum to one
} himc_anthropometry;

typedef struct himc_skeleton_config {
    double height; ///< 1.19 .. 2.21 (m), default 1.75
    double mass;   ///< 30 .. 200 (kg), default 75, sticks not counted
    himc_anthropometry anthropometry;
    double stick_length;  ///< 0.2 .. 0.6 (m), default 0.36
    double shaft_mass;    ///< 0.005 .. 0.2 (kg), default 0.025
    double mallet_mass;   ///< 0.005 .. 0.2 (kg), default 0.020
    double mallet_radius; ///< 0.005 .. 0.05 (m), default 0.0175
    double grip;          ///< from the butt to where it is held (m), default 0.10
    double seat;          ///< height of the hip joints, on a stool (m); 0 takes 0.42 of the height
    double shoulders; ///< between the shoulder joints, 0.2 .. 0.6 (m); 0 takes it from the height
    double length[HIMC_SEGMENTS]; ///< measured lengths (m); 0 takes them from the height
} himc_skeleton_config;

himc_skeleton_config himc_skeleton_default(void);

/// Height of the hip joints above the floor (m).
double himc_skeleton_seat(const himc_skeleton_config *config);

typedef struct himc_segment {
    int parent;        ///< -1 for the pelvis
    double mass;       ///< (kg)
    double length;     ///< (m)
    double radius;     ///< of its capsule (m)
    himc_vec3 origin;  ///< its joint, in the parent's frame (m)
    himc_vec3 axis;    ///< unit vector from the joint towards the far end
    himc_vec3 center;  ///< of mass (m)
    himc_vec3 inertia; ///< about the centre of mass, about x, y, z (kg m^2)
} himc_segment;

typedef struct himc_skeleton {
    himc_segment segment[HIMC_SEGMENTS];
    himc_vec3 root;       ///< between the hip joints: where the held pelvis sits in the world (m)
    himc_vec3 tip;        ///< of the stick (centre of the mallet) in the stick's frame (m)
    double mallet_radius; ///< (m)
    double height, mass;  ///< (m, kg)
} himc_skeleton;

/// Builds the table; false if a field is out of its range.
bool himc_skeleton_init(himc_skeleton *skeleton, const himc_skeleton_config *config,
                        himc_error *error);

/// "pelvis", "trunk", ..., "left-stick".
const char *himc_segment_name(int segment);
/// "waist", "neck", "head", "left-shoulder", ..., "right-grip", ..., "right-toes".
const char *himc_joint_name(int joint);
/// Index of a joint by name, or -1.
int himc_joint_find(const char *name);

/// Joint `k` (0 shoulder .. 3 grip) of an arm.
static inline int himc_arm_joint(himc_hand hand, int k)
{
    return HIMC_LEFT_UPPER_ARM - 1 + 2 * k + (int)hand;
}

/// The stick segment of a hand.
static inline int himc_stick_segment(himc_hand hand)
{
    return HIMC_LEFT_STICK + (int)hand;
}

// pose.h: the kinematic layer: postures, and the moving body as seen in the world (2012 paper,
// equation 1: K).

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

// limits.h: how far a percussionist's joints turn: bounds learned from captured motion, and the
// nearest rotation within them (2012 paper, section 3.1, algorithm 1 and table 1).

/// In the order of the words of `limits`.
typedef enum himc_limits_kind {
    HIMC_LIMITS_OFF,
    HIMC_LIMITS_ELLIPSOID, ///< around the mean, in its tangent space (algorithm 1)
    HIMC_LIMITS_EULER      ///< lower and upper angles about x, y, z
} himc_limits_kind;

/// Bounds of one joint, child in the parent's frame.
typedef struct himc_limit {
    bool bound;       ///< false: turns freely
    himc_quat mean;   ///< of the captured rotations (Markley et al. 2007)
    himc_mat3 axes;   ///< columns: the ellipsoid's axes in the tangent space of the mean
    himc_vec3 radius; ///< its semi-axes, as rotation vectors (rad); less than 1e-3 counts as that
    himc_vec3 lower;  ///< Euler angles, child = mean Rz Ry Rx (rad)
    himc_vec3 upper;  ///< (rad); an interval narrower than 2e-3 counts as that
} himc_limit;

typedef struct himc_limits {
    himc_limits_kind kind;
    himc_limit joint[HIMC_JOINTS];
} himc_limits;

/// Table 1 of the 2012 paper (neck, shoulders, elbows, wrists) around a mean posture; the joints
/// the table does not name turn freely. Its eigen values are read as degrees of half the angle, its
/// frames as the captures': y up, z forward, arms sideways at zero, the left one's.
HIMC_RT himc_limits himc_limits_table_1(const himc_pose *mean);

/// Algorithm 1 and the Euler statistics of each joint's rotations in `pose` (frames). Ellipsoid and
/// box contain all of them, widened by `margin` (0 .. 1, of their size). A joint that nowhere turns
/// more than 1e-3 rad from its mean was not captured: it turns freely. False with the reason.
bool himc_limits_learn(himc_limits *limits, const himc_pose *pose, int frames, double margin,
                       himc_error *error);

/// Widens all bounds that are narrower than `least` (rad, 0 .. 0.5) on either side of the mean to
/// that: a body that is controlled is never quite in a captured posture.
HIMC_RT void himc_limits_loosen(himc_limits *limits, double least);

/// The mean posture: of each joint the rotation nearest to all of its own (Markley et al. 2007).
/// `frames` at least 1; rotations of unit length.
HIMC_RT himc_pose himc_limits_mean(const himc_pose *pose, int frames);

/// How far a joint is within its bounds: at most 1 inside, 1 on them, 0 at the centre; 0 too when
/// it turns freely.
HIMC_RT double himc_limit_measure(const himc_limits *limits, int joint, himc_quat rotation);
/// The nearest rotation within the bounds, in the tangent space of the mean (of the box, angle by
/// angle); the rotation itself when it is within.
HIMC_RT himc_quat himc_limit_closest(const himc_limits *limits, int joint, himc_quat rotation);

/// Nearest point of the ellipsoid with these semi-axes (any order, at least 1e-3) to a point that
/// is not within (Eberly 2013).
HIMC_RT himc_vec3 himc_limit_closest_on_ellipsoid(himc_vec3 radius, himc_vec3 point);

// ik.h: inverse kinematics of one arm: from the tip's error to small rotations of shoulder,
// elbow, wrist and grip.
//
// A ball joint at p_j turns the tip by d(theta_j) x (tip - p_j), so with the levers r_j = tip -
// p_j J' f = r_j x f and J J' = sum of |r_j|^2 1 - r_j r_j': a 3 x 3 matrix, whatever the number
// of joints. Weights, null space and the elbow's task stay in three numbers likewise. Finding a
// posture for tips at a distance, limits and trunk included, is reach.h's.

/// In the order of the words of `solver`.
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

// invdyn.h: inverse dynamics: from the accelerations wanted to the joint torques that make them;
// and its mirror, forward dynamics, which a contact needs to know how a stick answers a force.
//
// All vectors are in the world frame. A joint's relative acceleration is the time derivative, in
// the world, of the difference of its two segments' angular velocities (rad/s^2). The pelvis is
// held.

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

// A simulated body that weighs otherwise than control believes.

typedef struct himc_performance himc_performance;

/// From now on the simulated segments weigh `factor` (HIMC_SEGMENTS, 0.2 .. 5; NULL for 1) times
/// what control believes, inertia included: what an uncertain body does to control. The body is
/// put anew where the targets have it.
bool himc_performance_set_weights(himc_performance *performance, const double *factor,
                                  himc_error *error);

#endif
