/// ranges.h: what joints a person can turn how far, and tips that some posture within that reaches.
#ifndef HIMC_TESTS_RANGES_H
#define HIMC_TESTS_RANGES_H

#include "himc/posture.h"
#include "himc/reach.h"

#include "bodies.h"

#define RANGE_DEGREE (HIMC_PI / 180)
#define REACH_JOINTS (1 + HIMC_HANDS * HIMC_ARM_JOINTS)

/// Waist, then each arm's joints.
static inline int reach_joint(int i)
{
    return i == 0
               ? HIMC_TRUNK - 1
               : himc_arm_joint((himc_hand)((i - 1) / HIMC_ARM_JOINTS), (i - 1) % HIMC_ARM_JOINTS);
}

/// The natural posture of a player at rest over the head.
static inline himc_pose rest_pose(void)
{
    himc_posture posture;
    himc_pose pose;
    const himc_vec3 tip[HIMC_HANDS] = {{0.48, 0.10, 1.0}, {0.48, -0.10, 1.0}};
    himc_posture_init(&posture, &skeleton, 0.8675);
    himc_posture_at(&posture, tip, &pose);
    return pose;
}

static inline void set_range(himc_limits *limits, int joint, himc_quat mean, himc_vec3 half)
{
    himc_limit *l = &limits->joint[joint];
    *l = (himc_limit){.bound = true, .mean = mean, .axes = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
    l->radius = himc_vec3_scale(half, RANGE_DEGREE);
    l->upper = l->radius;
    l->lower = himc_vec3_scale(half, -RANGE_DEGREE);
}

/// The ranges of motion of the American Academy of Orthopaedic Surgeons (Greene & Heckman 1994), as
/// ellipsoids or boxes about their middles: half of flexion 180 + extension 60 and abduction 180 at
/// the shoulder, 150 at the elbow with pronation 160, flexion 80 + 70 and deviation 50 at the
/// wrist; the trunk's 80 + 25 forward, 70 to the sides, 90 in turning; of a stick in the hand a
/// guess.
static inline himc_limits wide_ranges(himc_limits_kind kind)
{
    himc_limits limits = {.kind = kind};
    himc_quat forward[HIMC_ARM_JOINTS];
    static const double flexion[HIMC_ARM_JOINTS] = {60, 75, 5, 0};
    static const himc_vec3 half[HIMC_ARM_JOINTS] = {
        {90, 89, 80}, {2, 75, 80}, {25, 75, 2}, {30, 45, 30}};
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        forward[k] = himc_quat_exp(himc_vec3_make(0, -flexion[k] * RANGE_DEGREE, 0));
    set_range(&limits, HIMC_TRUNK - 1, himc_quat_exp(himc_vec3_make(0, 27 * RANGE_DEGREE, 0)),
              himc_vec3_make(35, 52, 45));
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        for (int k = 0; k < HIMC_ARM_JOINTS; k++)
            set_range(&limits, himc_arm_joint((himc_hand)hand, k), forward[k], half[k]);
    return limits;
}

static inline double range_unit(void)
{
    return 2.0 * rand() / RAND_MAX - 1;
}

/// A rotation within the limits, all of them as likely; of free joints within half a radian of
/// `rest`.
static inline himc_quat random_within(const himc_limits *limits, int joint, himc_quat rest)
{
    const himc_limit *l = &limits->joint[joint];
    himc_vec3 u = {range_unit(), range_unit(), range_unit()};
    if (!l->bound)
        return himc_quat_mul(rest, himc_quat_exp(himc_vec3_scale(u, 0.5)));
    while (limits->kind == HIMC_LIMITS_ELLIPSOID && himc_vec3_dot(u, u) > 1)
        u = himc_vec3_make(range_unit(), range_unit(), range_unit());
    if (limits->kind == HIMC_LIMITS_ELLIPSOID) {
        u = himc_vec3_make(u.x * l->radius.x, u.y * l->radius.y, u.z * l->radius.z);
        return himc_quat_mul(l->mean, himc_quat_exp(himc_mat3_apply(&l->axes, u)));
    }
    himc_vec3 middle = himc_vec3_scale(himc_vec3_add(l->lower, l->upper), 0.5),
              half = himc_vec3_scale(himc_vec3_sub(l->upper, l->lower), 0.5);
    himc_quat x = himc_quat_exp(himc_vec3_make(middle.x + half.x * u.x, 0, 0)),
              y = himc_quat_exp(himc_vec3_make(0, middle.y + half.y * u.y, 0)),
              z = himc_quat_exp(himc_vec3_make(0, 0, middle.z + half.z * u.z));
    return himc_quat_mul(l->mean, himc_quat_mul(z, himc_quat_mul(y, x)));
}

/// Tips of a posture at random within the limits.
static inline himc_reach_goal random_goal(const himc_limits *limits, const himc_pose *rest)
{
    himc_reach_goal goal = himc_reach_default();
    himc_body_state s;
    himc_pose pose = *rest;
    for (int i = 0; i < REACH_JOINTS; i++) {
        int j = reach_joint(i);
        pose.joint[j] = random_within(limits, j, rest->joint[j]);
    }
    himc_pose_to_state(&skeleton, &pose, NULL, &s);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        goal.tip[hand] = s.tip[hand];
    return goal;
}

#endif
