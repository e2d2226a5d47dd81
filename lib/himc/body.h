/// body.h: the performer's body: skeleton, pose, joint limits, inverse kinematics of an arm, and
/// inverse and forward dynamics (second tier; himc.h does not need it).
///
/// The body is a constant table of 20 rigid segments in a tree of 19 ball joints (57 degrees of
/// freedom) with masses, centres of mass and inertias; drumsticks are segments like any other
/// (2012 paper, section 3.1). Joint j connects segment j + 1 to its parent, and parents stand
/// before their children, so one loop over the table visits the tree.
///
/// Each segment's frame has its origin in the joint to its parent. In the zero pose the body
/// stands, arms and sticks hang, and all frames are parallel to the world's: x forward, y left,
/// z up. The pelvis is fixed to the world.
///
///     skeleton  constant: what the body is          himc_skeleton
///     pose      what the joints are                 himc_pose, himc_body_state
///     limits    how far the joints may turn         himc_limits
///     ik        tip displacement -> joint rotations himc_arm_jacobian
///     dynamics  accelerations <-> joint torques     himc_articulation
///
/// All types are plain values; nothing here owns memory. Functions marked HIMC_RT neither allocate
/// nor wait. Vectors of limbs, joints and tips are in the world frame unless a comment says
/// otherwise.
#ifndef HIMC_BODY_H
#define HIMC_BODY_H

#include "himc/vec.h"

HIMC_BEGIN

// Skeleton: the constant table

/// The segments; of a pair the left one is even, the right one follows.
typedef enum himc_segment_id {
    HIMC_PELVIS,          ///< fixed to the world, the root of the tree
    HIMC_TRUNK,           ///< abdomen and chest, from the joint waist
    HIMC_NECK,            ///< from the joint neck
    HIMC_HEAD,            ///< from the joint head
    HIMC_LEFT_UPPER_ARM,  ///< from the left shoulder
    HIMC_RIGHT_UPPER_ARM, ///< from the right shoulder
    HIMC_LEFT_FOREARM,    ///< from the left elbow
    HIMC_RIGHT_FOREARM,   ///< from the right elbow
    HIMC_LEFT_HAND,       ///< from the left wrist
    HIMC_RIGHT_HAND,      ///< from the right wrist
    HIMC_LEFT_STICK,      ///< from the left grip
    HIMC_RIGHT_STICK,     ///< from the right grip
    HIMC_LEFT_UPPER_LEG,  ///< from the left hip
    HIMC_RIGHT_UPPER_LEG, ///< from the right hip
    HIMC_LEFT_LOWER_LEG,  ///< from the left knee
    HIMC_RIGHT_LOWER_LEG, ///< from the right knee
    HIMC_LEFT_FOOT,       ///< from the left ankle
    HIMC_RIGHT_FOOT,      ///< from the right ankle
    HIMC_LEFT_TOES,       ///< from the joint left-toes
    HIMC_RIGHT_TOES       ///< from the joint right-toes
} himc_segment_id;

/// Degrees of freedom: three for each ball joint.
#define HIMC_DOF (3 * HIMC_JOINTS)

/// The joints of an arm, from the body outwards: shoulder, elbow, wrist, grip.
#define HIMC_ARM_JOINTS 4

/// Source of the segments' masses.
typedef enum himc_anthropometry {
    HIMC_DE_LEVA, ///< de Leva 1996, table 4, from height and mass
    HIMC_TABLE_1  ///< 2012 paper, table 1: a row of limbs is both of a pair
} himc_anthropometry;

/// The measures of a body and its sticks.
typedef struct himc_skeleton_config {
    double height;                    ///< 1.19 .. 2.21 (m), default 1.75
    double mass;                      ///< 30 .. 200 (kg), default 75, without the sticks
    himc_anthropometry anthropometry; ///< default HIMC_DE_LEVA
    double stick_length;              ///< 0.2 .. 0.6 (m), default 0.36
    double shaft_mass;                ///< 0.005 .. 0.2 (kg), default 0.025
    double mallet_mass;               ///< 0.005 .. 0.2 (kg), default 0.020
    double mallet_radius;             ///< 0.005 .. 0.05 (m), default 0.0175
    double grip;      ///< from the stick's butt, 0.02 .. half the stick (m), default 0.10
    double seat;      ///< height of the hip joints, 0.3 .. 1.3 (m); 0: 0.42 of the height
    double shoulders; ///< between the shoulder joints, 0.2 .. 0.6 (m); 0: from the height
    double length[HIMC_SEGMENTS]; ///< measured segment lengths, 0.02 .. 1 (m); 0: from the height
} himc_skeleton_config;

/// The default measures: 1.75 m, 75 kg, de Leva's table, a stick of 0.36 m held 0.10 m from its
/// butt; all else from the height.
himc_skeleton_config himc_skeleton_default(void);

/// Height of the hip joints above the floor for this config (m).
double himc_skeleton_seat(const himc_skeleton_config *config);

/// The freedoms of a segment on its parent.
typedef enum himc_joint_kind {
    HIMC_JOINT_FIXED, ///< none; the root, from the world to the pelvis
    HIMC_JOINT_BALL,  ///< three rotational freedoms; all other joints
    HIMC_JOINT_FREE   ///< six; the root of a body that sits
} himc_joint_kind;

/// A rigid segment. Vectors are in its own frame unless stated.
typedef struct himc_segment {
    int parent;            ///< index of the parent segment, -1 for the pelvis: the world
    himc_joint_kind joint; ///< to the parent; the pelvis's is the root
    double mass;           ///< (kg)
    double length;         ///< (m)
    double radius;         ///< of its capsule (m)
    himc_vec3 origin;  ///< its joint, in the parent's frame (m); the root's is the midpoint of the
                       ///< hip joints
    himc_vec3 axis;    ///< unit vector from the joint towards the far end
    himc_vec3 center;  ///< centre of mass (m)
    himc_vec3 inertia; ///< about the centre of mass, about x, y, z (kg m^2)
} himc_segment;

/// The body: constant after himc_skeleton_init.
typedef struct himc_skeleton {
    himc_segment segment[HIMC_SEGMENTS]; ///< by himc_segment_id
    himc_vec3 tip;        ///< tip of the stick (centre of the mallet) in the stick's frame (m)
    double mallet_radius; ///< (m)
    double height;        ///< (m)
    double mass;          ///< without the sticks (kg)
} himc_skeleton;

/// Builds the table from the measures. False, and `skeleton` unchanged, with an error that names
/// the field, if one is out of its range.
bool himc_skeleton_init(himc_skeleton *skeleton, const himc_skeleton_config *config,
                        himc_error *error);

/// Name of segment 0 .. HIMC_SEGMENTS - 1: "pelvis", "trunk", ..., "left-stick", ...
const char *himc_segment_name(int segment);
/// Name of joint 0 .. HIMC_JOINTS - 1: "waist", "neck", "head", "left-shoulder", ...,
/// "right-grip", ..., "right-toes".
const char *himc_joint_name(int joint);
/// Index of the joint with this name, -1 if there is none.
int himc_joint_find(const char *name);

/// Index of joint `k` (0 shoulder, 1 elbow, 2 wrist, 3 grip) of an arm.
static inline int himc_arm_joint(himc_hand hand, int k)
{
    return HIMC_LEFT_UPPER_ARM - 1 + 2 * k + (int)hand;
}

/// The waist above a root that is fixed (m).
static inline himc_vec3 himc_skeleton_waist(const himc_skeleton *skeleton)
{
    return himc_vec3_add(skeleton->segment[HIMC_PELVIS].origin,
                         skeleton->segment[HIMC_TRUNK].origin);
}

/// Index of the stick segment of a hand.
static inline int himc_stick_segment(himc_hand hand)
{
    return HIMC_LEFT_STICK + (int)hand;
}

// Pose: joint rotations, and the moving body in the world (2012 paper, equation 1: K)

/// The rotation of each joint: its child segment in the parent's frame. The zero pose is all
/// identity.
typedef struct himc_pose {
    himc_quat joint[HIMC_JOINTS]; ///< unit quaternions
} himc_pose;

/// The moving body in the world frame. Entry 0 is the pelvis, at the skeleton's root unless that is
/// free.
typedef struct himc_body_state {
    himc_quat orientation[HIMC_SEGMENTS]; ///< of the segment's frame, unit quaternions
    himc_mat3 rotation[HIMC_SEGMENTS];    ///< the orientations as matrices
    himc_vec3 origin[HIMC_SEGMENTS];      ///< joint to the parent (m)
    himc_vec3 spin[HIMC_SEGMENTS];        ///< angular velocity (rad/s)
    himc_vec3 velocity;                   ///< of origin[0] (m/s)
    himc_vec3 tip[HIMC_HANDS];            ///< drumstick tips (m)
    himc_vec3 tip_velocity[HIMC_HANDS];   ///< of the drumstick tips (m/s)
} himc_body_state;

/// The zero pose.
HIMC_RT himc_pose himc_pose_zero(void);

/// Forward kinematics: the state of a body in `pose`. `rate` is the angular velocity of each
/// joint in its parent's frame (rad/s) (HIMC_JOINTS); NULL for a body at rest.
HIMC_RT void himc_pose_to_state(const himc_skeleton *skeleton, const himc_pose *pose,
                                const himc_vec3 *rate, himc_body_state *state);

/// The pose of a state: the inverse of himc_pose_to_state.
HIMC_RT himc_pose himc_pose_from_state(const himc_skeleton *skeleton, const himc_body_state *state);

/// Computes rotation matrices, origins, tips and tip velocities from the orientations and spins in
/// `state`, the pelvis being at its place.
HIMC_RT void himc_body_state_complete(const himc_skeleton *skeleton, himc_body_state *state);

/// True if every number of the state is finite.
HIMC_RT bool himc_body_state_finite(const himc_body_state *state);

// Joint limits: bounds learned from captured motion, and the nearest rotation within them (2012
// paper, section 3.1, algorithm 1 and table 1)

/// Shape of the bounds. In the order of the words of `limits`.
typedef enum himc_limits_kind {
    HIMC_LIMITS_OFF,       ///< all joints turn freely
    HIMC_LIMITS_ELLIPSOID, ///< around the mean, in its tangent space (algorithm 1)
    HIMC_LIMITS_EULER      ///< lower and upper Euler angles about x, y, z
} himc_limits_kind;

/// Bounds of one joint: the child in the parent's frame.
typedef struct himc_limit {
    bool bound;       ///< false: the joint turns freely
    himc_quat mean;   ///< of the captured rotations (Markley et al. 2007)
    himc_mat3 axes;   ///< columns: the ellipsoid's axes in the tangent space of the mean
    himc_vec3 radius; ///< its semi-axes, as rotation vectors (rad); values below 1e-3 act as 1e-3
    himc_vec3 lower;  ///< Euler angles, child = mean Rz Ry Rx (rad)
    himc_vec3 upper;  ///< (rad); an interval narrower than 2e-3 acts as 2e-3
} himc_limit;

/// Bounds of all joints.
typedef struct himc_limits {
    himc_limits_kind kind;         ///< decides which fields of himc_limit count
    himc_limit joint[HIMC_JOINTS]; ///< by joint
} himc_limits;

/// Table 1 of the 2012 paper (neck, shoulders, elbows, wrists) around a mean pose; the other
/// joints turn freely. The table's eigenvalues are read as half angles in degrees, its axes in the
/// frames of the paper's captures: y up, z forward, arms held sideways, the left arm's.
HIMC_RT himc_limits himc_limits_table_1(const himc_pose *mean);

/// Learns bounds from poses (frames, at least 1) by algorithm 1. Ellipsoids and Euler intervals
/// contain all of the poses and are widened by `margin` (0 .. 1, share of their size). A joint
/// that stays within 1e-3 rad of its mean was not captured and turns freely. False, and `limits`
/// unchanged, if a value is out of range, a quaternion is not of unit length, or memory is short.
bool himc_limits_learn(himc_limits *limits, const himc_pose *pose, int frames, double margin,
                       himc_error *error);

/// Position of a rotation within the joint's bounds: 0 at the centre, 1 on the bounds, above 1
/// outside; 0 if the joint turns freely.
HIMC_RT double himc_limit_measure(const himc_limits *limits, int joint, himc_quat rotation);

/// The nearest rotation within the joint's bounds: in the tangent space of the mean (ellipsoid) or
/// angle by angle (Euler). A rotation within the bounds is returned unchanged.
HIMC_RT himc_quat himc_limit_closest(const himc_limits *limits, int joint, himc_quat rotation);

// Inverse kinematics of one arm: from a displacement of the tip to small rotations of shoulder,
// elbow, wrist and grip
//
// A ball joint at p_j moves the tip by d(theta_j) x (tip - p_j). So with the levers r_j = tip - p_j
// the transposed Jacobian is J' f = r_j x f, and J J' = sum of |r_j|^2 1 - r_j r_j' is a 3 x 3
// matrix, independent of the number of joints.

/// How the inverse of the Jacobian J is approximated. In the order of the words of `solver`.
typedef enum himc_solver {
    HIMC_SOLVER_DLS,       ///< damped least squares (Wampler 1986): J' (J J' + lambda^2)^-1 e
    HIMC_SOLVER_PINV,      ///< pseudo-inverse, small singular values truncated
    HIMC_SOLVER_TRANSPOSE, ///< J' e times <e, JJ'e> / <JJ'e, JJ'e> (Buss 2004)
    HIMC_SOLVER_NAKAMURA,  ///< damped near singular poses only (Nakamura & Hanafusa 1986)
    HIMC_SOLVER_SDLS,      ///< each singular direction damped separately (Buss & Kim 2005)
    HIMC_SOLVERS           ///< number of solvers
} himc_solver;

/// Jacobian of a drumstick tip (2012 paper, algorithm 2, ComputeJacobian) with weighted joints: all
/// solutions are the smallest in the norm x' W^-1 x.
typedef struct himc_arm_jacobian {
    himc_vec3 lever[HIMC_ARM_JOINTS]; ///< from each joint to the tip (m)
    double weight[HIMC_ARM_JOINTS];   ///< joint weights, the diagonal of W; default 1
    himc_mat3 gram;                   ///< J W J' (m^2)
    himc_mat3 inverse;                ///< of the gram matrix, slightly regularised (1/m^2)
} himc_arm_jacobian;

/// The Jacobian of the tip of `hand` at a state, all joints of equal weight.
HIMC_RT void himc_arm_jacobian_at(const himc_body_state *state, himc_hand hand,
                                  himc_arm_jacobian *jacobian);
/// The same with weights of shoulder, elbow, wrist and grip (above 0): a joint of larger weight
/// turns more. The variance of each joint in captured motion is such a weight.
HIMC_RT void himc_arm_jacobian_weighted(const himc_body_state *state, himc_hand hand,
                                        const double weight[HIMC_ARM_JOINTS],
                                        himc_arm_jacobian *jacobian);

/// Rotations of the arm's joints (world frame, rad) that move the tip by `error` (m). `damping` is
/// lambda (m, above 0) of HIMC_SOLVER_DLS and the largest one of HIMC_SOLVER_NAKAMURA; the other
/// solvers ignore it. Linear in `error` except for TRANSPOSE and SDLS.
HIMC_RT void himc_ik_solve(const himc_arm_jacobian *jacobian, himc_solver solver, double damping,
                           himc_vec3 error, himc_vec3 rotation[HIMC_ARM_JOINTS]);

/// Adds to `rotation` the part of `desired` in the null space of the tip, N desired, which does not
/// move the tip: N = 1 - J# J, J# = W J' (J W J')^-1.
HIMC_RT void himc_ik_add_null(const himc_arm_jacobian *jacobian,
                              const himc_vec3 desired[HIMC_ARM_JOINTS],
                              himc_vec3 rotation[HIMC_ARM_JOINTS]);

// Dynamics: inverse (from accelerations to joint torques) and forward (its mirror)
//
// A joint's relative acceleration is the time derivative, in the world, of the difference of its
// two segments' angular velocities (rad/s^2).

#define HIMC_GRAVITY 9.80665 ///< standard gravity (m/s^2), along -z

/// Inverse dynamics by recursive Newton-Euler (Featherstone 2008, chapter 5): the torque of each
/// joint on its child (N m) that makes the accelerations `relative` (rad/s^2) (HIMC_JOINTS; NULL
/// for zero) at this state. With `still` the spins count as zero: gravity alone.
HIMC_RT void himc_inverse_dynamics(const himc_skeleton *skeleton, const himc_body_state *state,
                                   const himc_vec3 *relative, bool still,
                                   himc_vec3 torque[HIMC_JOINTS]);

/// A symmetric 3x3 matrix.
typedef struct himc_symmetric {
    double xx; ///< row x, column x
    double xy; ///< row x, column y, as row y, column x
    double xz; ///< row x, column z, as row z, column x
    double yy; ///< row y, column y
    double yz; ///< row y, column z, as row z, column y
    double zz; ///< row z, column z
} himc_symmetric;

/// The articulated inertias of the segments at a state: working memory of forward dynamics.
typedef struct himc_articulation {
    himc_vec3 lever[HIMC_SEGMENTS];        ///< from the parent's joint to the segment's (m)
    himc_vec3 center[HIMC_SEGMENTS];       ///< from the joint to the centre of mass (m)
    himc_symmetric inertia[HIMC_SEGMENTS]; ///< about the centre of mass, world frame (kg m^2)
    himc_symmetric
        inverse[HIMC_SEGMENTS];         ///< of the articulated rotational inertia about the joint
    himc_mat3 response[HIMC_SEGMENTS];  ///< minus the angular acceleration per acceleration of the
                                        ///< joint (1/m)
    himc_symmetric mass[HIMC_SEGMENTS]; ///< apparent mass for the parent at the joint (kg)
    himc_symmetric root;                ///< inverse of `mass` of the pelvis, if it is free (1/kg)
    int first, end; ///< segments first .. end - 1 take part: from 0 if the pelvis is free, else 1
    bool resists;   ///< joints resist their own acceleration; if so:
    himc_mat3 resistance[HIMC_SEGMENTS];      ///< D (kg m^2)
    himc_mat3 transfer[HIMC_SEGMENTS];        ///< D times `inverse`
    himc_mat3 parent_coupling[HIMC_SEGMENTS]; ///< moment on the parent per acceleration of joint
} himc_articulation;

/// Computes the articulated inertias (Featherstone 2008, chapter 7) of all segments.
HIMC_RT void himc_articulate(const himc_skeleton *skeleton, const himc_body_state *state,
                             himc_articulation *articulation);

/// Forward dynamics: the relative accelerations (rad/s^2) of the joints under `torque` (N m)
/// (HIMC_JOINTS), gravity and a force on each drumstick tip (N) (HIMC_HANDS; NULL for none).
/// Only the joints of the segments that the articulation has are written.
HIMC_RT void himc_forward_dynamics(const himc_skeleton *skeleton, const himc_body_state *state,
                                   const himc_articulation *articulation, const himc_vec3 *torque,
                                   const himc_vec3 *tip_force, himc_vec3 relative[HIMC_JOINTS]);

/// Effective mass (operational-space inertia) of a drumstick tip along a unit direction n:
/// 1 / (n' J M^-1 J' n) (kg).
HIMC_RT double himc_effective_mass(const himc_skeleton *skeleton, const himc_body_state *state,
                                   const himc_articulation *articulation, himc_hand hand,
                                   himc_vec3 direction);

HIMC_END

#endif
