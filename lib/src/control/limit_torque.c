/// limit_torque.c: joints beyond their bounds are brought back towards the nearest orientation
/// within (2012 paper, section 3.1): by accelerations in computed torque, by torques in the PD
/// laws. Limits have priority over tips, tips over posture.
///
/// Computed torque: the orientation that a joint would have after a time T is kept within bounds,
///     q_T = exp(omega T + alpha T^2 / 2) q,     alpha += 2 / T^2 log(q_T^-1 q_lim(q_T)),
/// from outside e'' = -2 / T^2 e - 2 / T e', a spring damped by .71 of critical. A motion that
/// returns by itself is not changed; a motion along the limit is free. The arm's other degrees of
/// freedom compensate the loss at the tips: d = P W J' (J P W J' + lambda^2)^-1 lost, P without the
/// directions of the corrections.
///
/// Servos: tau = I (w^2 e - 2 w (omega - omega_lim)), e = log(q^-1 q_lim) and omega_lim the motion
/// of that orientation, so that nothing damps the way along the limit; implicit over the step like
/// the servos themselves, which drive no joint further out. It is a spring and a damper: omega_lim
/// has no more energy than omega, omega' I omega_lim <= omega' I omega, so it pumps none.
#include "control/limit_torque.h"

#include "body/dynamics.h"
#include "body/limits.h"

#include <string.h>

// chosen: firm beside strokes of up to 10 Hz and soft beside the physics rate
#define HORIZON 0.0056        // T: a spring of 40 Hz (s)
#define LIMIT_SPRING 60.0     // beside a servo (Hz)
#define RETURN_SPEED 3.0      // of the way back from far beyond (rad/s)
#define LARGEST_BEYOND 0.02   // beyond this the pull does not grow (rad)
#define LOST_DAMPING 0.05     // lambda, of the compensation at the tips (m)
#define COMPENSATION_PASSES 3 // each may move another joint out of its bounds
// chosen: of bounds, for the count of hits
#define HIT_MEASURE 0.95  // a joint this near its bounds has hit them ...
#define FREE_MEASURE 0.85 // ... and can hit them again after a return to here
// chosen: above rounding, below anything visible
#define LEAST_BEYOND 1e-9     // a joint beyond by less is within (rad)
#define LEAST_CORRECTION 0.01 // (rad/s^2)
#define LEAST_AGAIN 10.0 // after a compensation: 1.6e-4 rad beyond, left to the next step (rad/s^2)
#define SLIDE_STEP 1e-4  // over which motion along a limit is measured (s)

/// A joint in its parent's frame.
typedef struct joint_place {
    himc_quat q;
    himc_vec3 spin; // (rad/s)
    double beyond;  // its bounds (rad)
    // the last orientation whose place in the bounds was computed: rotated by this from q
    himc_vec3 rotate; // (rad)
    double measure;
    himc_vec3 back; // from there to the nearest orientation within (rad)
} joint_place;

/// Corrections of joints, each along one direction.
typedef struct limit_stops {
    int count;
    int joint[HIMC_JOINTS];
    himc_vec3 inward[HIMC_JOINTS]; // unit vectors of the world
    double more[HIMC_JOINTS];      // acceleration along them (rad/s^2)
} limit_stops;

// places the joint where it would be after the rotation; rotations from there by less than its room
// need no look at the bounds
static void place_joint(const himc_limits *limits, int j, himc_vec3 rotate, joint_place *at)
{
    himc_quat then = himc_quat_mul(himc_quat_exp(rotate), at->q), near;
    at->rotate = rotate;
    at->measure = himc_limit_nearest(limits, j, then, &near);
    at->back = himc_vec3_make(0, 0, 0);
    if (at->measure > 1)
        at->back = himc_quat_log(himc_quat_mul(near, himc_quat_conj(then)));
}

static void find_places(const himc_controller *c, const himc_skeleton *skeleton,
                        const himc_body_state *s, joint_place at[HIMC_JOINTS])
{
    for (int j = 0; j < HIMC_JOINTS; j++) {
        int p = skeleton->segment[j + 1].parent;
        himc_saturation_counts *counts = c->saturation;
        at[j] = (joint_place){.measure = 0};
        if (c->limits->joint[j].bound) {
            himc_vec3 spin = himc_vec3_sub(s->spin[j + 1], s->spin[p]);
            at[j].q = himc_quat_mul(himc_quat_conj(s->orientation[p]), s->orientation[j + 1]);
            at[j].spin = himc_mat3_apply_transposed(&s->rotation[p], spin);
            place_joint(c->limits, j, at[j].rotate, &at[j]);
            at[j].beyond = himc_vec3_length(at[j].back);
        }
        if (!counts)
            continue;
        counts->measure[j] = at[j].measure;
        if (counts->farthest[j] < at[j].beyond)
            counts->farthest[j] = at[j].beyond;
        counts->held[j] = counts->held[j] && at[j].measure > FREE_MEASURE;
    }
}

// missing acceleration of a joint, in its parent's frame (rad/s^2)
static himc_vec3 correction(const himc_limits *limits, int j, joint_place *at, himc_vec3 alpha)
{
    himc_vec3 rotate =
        himc_vec3_madd(himc_vec3_scale(at->spin, HORIZON), 0.5 * HORIZON * HORIZON, alpha);
    double moved = himc_vec3_length(himc_vec3_sub(rotate, at->rotate));
    if (moved > 0 && moved >= himc_limit_room(limits, j, at->measure))
        place_joint(limits, j, rotate, at);
    double angle = himc_vec3_length(at->back), late = at->beyond - RETURN_SPEED * HORIZON;
    late = late > 0 ? late : 0;
    if (angle <= late)
        return himc_vec3_make(0, 0, 0);
    return himc_vec3_scale(at->back, (1 - late / angle) * 2 / (HORIZON * HORIZON));
}

// the joints that these accelerations would move out of their bounds
static void find_stops(const himc_controller *c, const himc_skeleton *skeleton,
                       const himc_body_state *s, joint_place at[HIMC_JOINTS],
                       const himc_vec3 *relative, double least, limit_stops *found)
{
    found->count = 0;
    for (int j = 0; j < HIMC_JOINTS; j++) {
        if (!c->limits->joint[j].bound)
            continue;
        int p = skeleton->segment[j + 1].parent;
        // relative to the rotating parent
        himc_vec3 spin = himc_vec3_sub(s->spin[j + 1], s->spin[p]);
        himc_vec3 alpha = himc_vec3_sub(relative[j], himc_vec3_cross(s->spin[p], spin));
        alpha = himc_mat3_apply_transposed(&s->rotation[p], alpha);
        himc_vec3 more = himc_mat3_apply(&s->rotation[p], correction(c->limits, j, &at[j], alpha));
        double size = himc_vec3_length(more);
        if (size < least)
            continue;
        found->joint[found->count] = j;
        found->inward[found->count] = himc_vec3_scale(more, 1 / size);
        found->more[found->count++] = size;
    }
}

static void count_hit(himc_saturation_counts *saturation, int j)
{
    if (!saturation || saturation->measure[j] < HIT_MEASURE)
        return;
    saturation->hits[j] += !saturation->held[j];
    saturation->held[j] = true;
}

// accelerations of the arm that move its tip so, none along the directions of the corrections
static void give_back(const limit_stops *stop, const himc_arm_jacobian *jacobian, himc_hand hand,
                      himc_vec3 lost, himc_vec3 wanted[HIMC_JOINTS])
{
    himc_vec3 way[HIMC_ARM_JOINTS] = {{0, 0, 0}};
    himc_mat3 gram = jacobian->gram;
    for (int h = 0; h < stop->count; h++)
        for (int k = 0; k < HIMC_ARM_JOINTS; k++)
            if (stop->joint[h] == himc_arm_joint(hand, k))
                way[k] = stop->inward[h];
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        himc_vec3 v = himc_vec3_cross(way[k], jacobian->lever[k]);
        const double b[3] = {v.x, v.y, v.z};
        for (int i = 0; i < 9; i++)
            gram.m[i / 3][i % 3] -= jacobian->weight[k] * b[i / 3] * b[i % 3];
    }
    for (int i = 0; i < 3; i++)
        gram.m[i][i] += LOST_DAMPING * LOST_DAMPING;
    himc_mat3 inverse = himc_mat3_inverse_symmetric(&gram);
    himc_vec3 f = himc_mat3_apply(&inverse, lost);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        himc_vec3 d = himc_vec3_scale(himc_vec3_cross(jacobian->lever[k], f), jacobian->weight[k]),
                  *to = &wanted[himc_arm_joint(hand, k)];
        *to = himc_vec3_add(*to, himc_vec3_madd(d, -himc_vec3_dot(d, way[k]), way[k]));
    }
}

// acceleration of a tip that is missing beside that of other accelerations
static himc_vec3 lost_at_tip(const himc_skeleton *skeleton, const himc_body_state *s,
                             himc_hand hand, const himc_vec3 *before, const himc_vec3 *now)
{
    himc_vec3 lost = {0, 0, 0};
    for (int i = himc_stick_segment(hand); i > 0; i = skeleton->segment[i].parent) {
        himc_vec3 less = himc_vec3_sub(before[i - 1], now[i - 1]);
        himc_vec3 lever = himc_vec3_sub(s->tip[hand], s->origin[i]);
        lost = himc_vec3_add(lost, himc_vec3_cross(less, lever));
    }
    return lost;
}

void himc_limits_compliance(const himc_controller *c, const himc_skeleton *skeleton,
                            const himc_body_state *s, const himc_arm_jacobian jacobian[HIMC_HANDS],
                            himc_vec3 wanted[HIMC_JOINTS])
{
    joint_place at[HIMC_JOINTS];
    limit_stops stop = {.count = 0};
    himc_vec3 before[HIMC_JOINTS];
    if (!c->limits || c->limits->kind == HIMC_LIMITS_OFF)
        return;
    find_places(c, skeleton, s, at);
    memcpy(before, wanted, sizeof before);
    for (int pass = 0; pass <= COMPENSATION_PASSES; pass++) {
        double least = pass == 0 ? LEAST_CORRECTION : LEAST_AGAIN;
        find_stops(c, skeleton, s, at, wanted, least, &stop);
        if (stop.count == 0)
            break;
        for (int h = 0; h < stop.count; h++) {
            count_hit(c->saturation, stop.joint[h]);
            himc_vec3 *a = &wanted[stop.joint[h]];
            *a = himc_vec3_madd(*a, stop.more[h], stop.inward[h]);
        }
        for (int hand = 0; pass < COMPENSATION_PASSES && hand < HIMC_HANDS; hand++) {
            himc_vec3 lost = lost_at_tip(skeleton, s, (himc_hand)hand, before, wanted);
            give_back(&stop, &jacobian[hand], (himc_hand)hand, lost, wanted);
        }
    }
}

// twice the energy of a rotation in the parent's frame
static double energy(const joint_place *at, himc_vec3 inertia, himc_vec3 spin)
{
    himc_vec3 v = himc_quat_rotate(himc_quat_conj(at->q), spin);
    return inertia.x * v.x * v.x + inertia.y * v.y * v.y + inertia.z * v.z * v.z;
}

// the rotation to the nearest orientation within, and its rate, in the parent's frame
static void find_way(const himc_limits *limits, int j, const joint_place *at, himc_vec3 inertia,
                     himc_vec3 *way, himc_vec3 *rate)
{
    himc_quat near = himc_limit_closest(limits, j, at->q);
    himc_quat next = himc_quat_mul(himc_quat_exp(himc_vec3_scale(at->spin, SLIDE_STEP)), at->q);
    himc_quat moved = himc_quat_mul(himc_limit_closest(limits, j, next), himc_quat_conj(near));
    *way = himc_quat_log(himc_quat_mul(near, himc_quat_conj(at->q)));
    *way = himc_vec3_scale(*way, fmin(1, LARGEST_BEYOND / himc_vec3_length(*way)));
    // far outside, the nearest orientation may run away or jump to the other side
    himc_vec3 along = himc_vec3_scale(himc_quat_log(moved), 1 / SLIDE_STEP);
    double most = energy(at, inertia, at->spin), has = energy(at, inertia, along);
    *rate = himc_vec3_madd(at->spin, has > most ? -sqrt(most / has) : -1, along);
}

void himc_limits_resist(const himc_controller *c, const himc_skeleton *skeleton,
                        const himc_body_state *s, himc_vec3 torque[HIMC_JOINTS],
                        himc_vec3 resistance[HIMC_JOINTS])
{
    const double w = 2 * HIMC_PI * LIMIT_SPRING, h = c->step;
    joint_place at[HIMC_JOINTS];
    if (!c->limits || c->limits->kind == HIMC_LIMITS_OFF)
        return;
    find_places(c, skeleton, s, at);
    for (int j = 0; j < HIMC_JOINTS; j++) {
        himc_vec3 way, rate;
        if (at[j].beyond < LEAST_BEYOND)
            continue;
        count_hit(c->saturation, j);
        find_way(c->limits, j, &at[j], c->inertia[j], &way, &rate);
        const himc_mat3 *parent = &s->rotation[skeleton->segment[j + 1].parent];
        const himc_mat3 *child = &s->rotation[j + 1];
        himc_vec3 i = c->inertia[j], light = himc_vec3_make(1 / i.x, 1 / i.y, 1 / i.z);
        himc_vec3 a = himc_vec3_madd(himc_vec3_scale(way, w * w), -(h * w * w + 2 * w), rate);
        himc_vec3 n = himc_mat3_apply(parent, himc_vec3_unit(way));
        // the servo's torque must not move the joint further out
        double outward = fmin(himc_vec3_dot(n, himc_mat3_scale_along(child, light, torque[j])), 0);
        a = himc_vec3_madd(himc_mat3_apply(parent, a), -outward, n);
        torque[j] = himc_vec3_add(torque[j], himc_mat3_scale_along(child, i, a));
        resistance[j] = himc_vec3_madd(resistance[j], h * w * (2 + h * w), i);
    }
}
