/// posture.h: the natural posture of a percussionist for given positions of the two drumstick tips;
/// private. It is the null-space target of mode `himc`, and the joint target of modes `id` and `ik`
/// when only the tips are known.
#ifndef HIMC_POSTURE_H
#define HIMC_POSTURE_H

#include "base/quintic.h"
#include "body/capsules.h"
#include "body/hand_path.h"
#include "himc/body.h"

/// A pose and its motion, joint by joint, in the parent's frame.
typedef struct himc_posture_motion {
    himc_quat joint[HIMC_JOINTS];
    himc_vec3 rate[HIMC_JOINTS];         ///< angular velocity (rad/s)
    himc_vec3 acceleration[HIMC_JOINTS]; ///< its derivative (rad/s^2)
} himc_posture_motion;

/// A joint of the motion `dt` (s) later, at constant acceleration.
HIMC_RT himc_quat himc_posture_joint_after(const himc_posture_motion *motion, int joint, double dt);

/// The motion of the joints first .. end - 1 at the middle of three poses that are `step` (s)
/// apart, by central differences of rotation vectors.
HIMC_RT void himc_posture_differentiate(const himc_pose pose[3], double step, int first, int end,
                                        himc_posture_motion *motion);

/// Usual step (s). Chosen: the error of second order (0.3 % for motion at 20 Hz) and that of
/// rounding are both far below a joint's noise.
#define HIMC_DIFFERENCE_STEP 1e-3

/// The joints of an arm and its tip.
typedef struct himc_arm_levers {
    himc_quat frame[HIMC_ARM_JOINTS + 1]; ///< of the trunk and of the arm's segments
    himc_vec3 at[HIMC_ARM_JOINTS + 1];    ///< the joints and the tip (m)
    himc_vec3 lever[HIMC_ARM_JOINTS];     ///< from each joint to the tip (m)
} himc_arm_levers;

/// Those of the arm of a pose with the waist at `waist` (m) and the trunk in the orientation
/// `trunk`: `joint` are the joints in their parents' frames, `stick` is the tip in the stick's (m).
HIMC_RT himc_arm_levers himc_arm_levers_at(himc_vec3 waist, himc_quat trunk,
                                           const himc_vec3 joint[HIMC_ARM_JOINTS], himc_vec3 stick,
                                           const himc_pose *pose, himc_hand hand);
/// The same with the pose's trunk and the joints of a skeleton.
HIMC_RT himc_arm_levers himc_arm_levers_of(const himc_skeleton *skeleton, himc_vec3 waist,
                                           const himc_pose *pose, himc_hand hand);

/// The grip of the sticks. German: palms down, the wrist bends. French: thumbs up, the fingers
/// move the stick. In the order of the words of `grip`.
typedef enum himc_grip { HIMC_GRIP_GERMAN, HIMC_GRIP_FRENCH } himc_grip;

/// The slowly changing parts of the posture: all that the tips do not decide.
typedef enum himc_trunk_posture_part {
    HIMC_TRUNK_POSTURE_TURN,        ///< rotation of the trunk to the left (rad)
    HIMC_TRUNK_POSTURE_LEAN,        ///< rotation of the trunk forward (rad)
    HIMC_TRUNK_POSTURE_FRENCH_GRIP, ///< 0 German grip .. 1 French grip
    HIMC_TRUNK_POSTURE_ELBOW, ///< of each hand: elbow further outwards about the line from shoulder
                              ///< to wrist (rad)
    HIMC_TRUNK_POSTURE_WRIST = HIMC_TRUNK_POSTURE_ELBOW + HIMC_HANDS,
    ///< of each hand: hand and stick turned down about the tip, so that the wrist is higher (rad)
    HIMC_TRUNK_POSTURE_ASIDE = HIMC_TRUNK_POSTURE_WRIST + HIMC_HANDS,
    ///< of each hand: hand and stick turned about the vertical through the tip, the wrist outwards
    ///< (rad)
    HIMC_TRUNK_POSTURE_EASED = HIMC_TRUNK_POSTURE_ASIDE + HIMC_HANDS,
    ///< of each hand: so much less is the wrist raised at a touch (rad)
    HIMC_TRUNK_POSTURE_SIDE = HIMC_TRUNK_POSTURE_EASED + HIMC_HANDS, ///< trunk to the right (rad)
    HIMC_TRUNK_POSTURE_LOOK_LEFT, ///< rotation of the head to the left, in the trunk's frame (rad)
    HIMC_TRUNK_POSTURE_LOOK_DOWN, ///< and down, beyond its resting pose (rad)
    HIMC_TRUNK_POSTURE_PARTS
} himc_trunk_posture_part;

/// The trunk posture and its motion.
typedef struct himc_trunk_posture {
    double value[HIMC_TRUNK_POSTURE_PARTS];
    double rate[HIMC_TRUNK_POSTURE_PARTS];         ///< (1/s)
    double acceleration[HIMC_TRUNK_POSTURE_PARTS]; ///< (1/s^2)
} himc_trunk_posture;

/// The model: everything a posture depends on, apart from the tips.
typedef struct himc_posture {
    himc_skeleton skeleton;
    himc_pose rest;                   ///< constant pose of neck, head and legs
    himc_trunk_posture trunk_posture; ///< updated by the caller whenever it moves
    double leans_beyond;              ///< the trunk leans to strike points farther off (m) ...
    double leans_beside;              ///< ... from so far beside its middle, on the hand's side (m)
    double level;                     ///< tip height at impact, where the sticks are horizontal (m)
    himc_hand_path hand[HIMC_HANDS];  ///< of hands that move; others rest as the tip has them
} himc_posture;

/// The model of a timpanist on a stool who leans a little forward and looks at the drumhead.
HIMC_RT void himc_posture_init(himc_posture *posture, const himc_skeleton *skeleton, double level);

/// The height of the stool (m) for a body with impacts between these two levels (m): the usual one,
/// or as much higher or lower as its arms need; also the usual one if `lowest` is above `highest`.
HIMC_RT double himc_posture_seat(const himc_skeleton_config *body, double lowest, double highest);

/// The height of the hip joints of this body (m) when it stands and its lowest impact is there (m).
HIMC_RT double himc_posture_standing(const himc_skeleton_config *body, double lowest);

/// Legs and lean of one who stands, the hips where the skeleton has them.
HIMC_RT void himc_posture_stand(himc_posture *posture);

/// Depth of the seat below the hip joints, of the body's height; chosen, as it is drawn.
#define HIMC_SEAT_DEPTH (0.086 / 1.75)
#define HIMC_ANKLE_HEIGHT 0.075 ///< of the ankle over the floor (m)

/// Angle between the sides `a` and `b` of a triangle, `c` the third.
HIMC_RT static inline double himc_corner(double a, double b, double c)
{
    return acos(fmin(fmax((a * a + b * b - c * c) / (2 * a * b), -1), 1));
}

/// Height of the stool's seat (m).
static inline double himc_posture_stool(const himc_skeleton *body)
{
    return body->segment[HIMC_PELVIS].origin.z - HIMC_SEAT_DEPTH * body->height;
}

/// The trunk posture for strokes at these points (m), one for each hand: turned towards their
/// middle, leaning forward as far as the farther one requires. At rest.
HIMC_RT himc_trunk_posture himc_posture_trunk(const himc_posture *posture,
                                              const himc_vec3 strike[HIMC_HANDS], himc_grip grip);

/// The trunk posture `dt` seconds (up to 0.02) after `now` on its way to `goal`: critically damped
/// motion of third order, so the acceleration has no jumps. It takes half a second from one drum
/// to another.
HIMC_RT himc_trunk_posture himc_trunk_posture_approach(const himc_trunk_posture *now,
                                                       const himc_trunk_posture *goal, double dt);

/// Where the trunk will be in that motion after `time` (s, may be infinite); elbows and wrists are
/// at the goal.
HIMC_RT himc_trunk_posture himc_trunk_posture_foreseen(const himc_trunk_posture *now,
                                                       const himc_trunk_posture *goal, double time);

/// The pose of the whole body with both tips at `tip` (m), a smooth function of the tips. Towards a
/// tip out of reach the arm is stretched. Returns the larger of the two remaining distances (m), 0
/// if both tips are reached.
HIMC_RT double himc_posture_at(const himc_posture *posture, const himc_vec3 tip[HIMC_HANDS],
                               himc_pose *pose);

/// The same with velocities and accelerations of the joints, for moving tips and trunk posture, by
/// central differences.
HIMC_RT void himc_posture_moving(const himc_posture *posture, const himc_target tip[HIMC_HANDS],
                                 himc_posture_motion *motion);

/// Lets the elbow of a hand that moves, its tip at `tip` (m), swing to where it would hang with the
/// tip at `soon` (m), where that is at HIMC_HAND_PATH_SWINGS from now.
HIMC_RT void himc_posture_swing(const himc_posture *posture, himc_hand hand, himc_vec3 tip,
                                himc_vec3 soon, himc_hand_path *path);

/// The capsules of arms, sticks, trunk, head and thighs in that posture; the others are left alone.
/// Returns the larger distance of a tip out of reach (m).
HIMC_RT double himc_posture_capsules(const himc_posture *posture, const himc_vec3 tip[HIMC_HANDS],
                                     himc_capsule capsule[HIMC_SEGMENTS]);

/// Shoulder, elbow, wrist, grip and tip of an arm.
#define HIMC_ARM_POINTS (HIMC_ARM_JOINTS + 1)
/// The angles that move an arm while its tip stays: elbow, wrist and aside of the trunk posture.
#define HIMC_ARM_ANGLES 3

/// How the points of an arm move with those angles.
typedef struct himc_arm_moves {
    himc_vec3 by[HIMC_ARM_ANGLES][HIMC_ARM_POINTS]; ///< (m/rad)
    double beyond;                                  ///< distance of the tip out of reach (m) ...
    double missing[HIMC_ARM_ANGLES];                ///< ... and how it grows (m/rad)
    double touches; ///< 1 at a touch .. 0 with the stick up: the share of what is eased
} himc_arm_moves;

/// The moves of one arm, by differences.
HIMC_RT himc_arm_moves himc_posture_arm_moves(const himc_posture *posture, himc_hand hand,
                                              himc_vec3 tip);

/// A point near `tip` (m) that the arm of `hand` reaches when the trunk is turned towards it: `tip`
/// itself if it is in reach, else the farthest reachable point on the line to it.
HIMC_RT himc_vec3 himc_posture_reachable(const himc_posture *posture, himc_hand hand,
                                         himc_vec3 tip);

/// The place of the tip (m) with which the natural posture holds the stick at `grip` (m).
HIMC_RT himc_vec3 himc_posture_tip_of_grip(const himc_posture *posture, himc_hand hand,
                                           himc_vec3 grip);

#endif
