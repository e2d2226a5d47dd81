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
///
/// An arm that its limits hold off its target is asked for more and more: 1e5 rad/s^2 at a tip 0.2
/// m off, as if all joints could turn. What its limits leave of that threw it about at 50 to 100
/// m/s, and once in eight hours apart. So errors of angle pull no harder than LARGEST_ERROR, which
/// brings a joint to w LARGEST_ERROR/2 against its damping, and no joint is asked for more than
/// HARDEST_DEMAND: all joints of an arm for as much less, so that it still moves towards its
/// target.
#include "control/limit_torque.h"

#include "base/rotations.h"
#include "body/dynamics.h"
#include "body/limits.h"
#include "control/tracking_error.h"

#include <string.h>

// chosen: firm beside strokes of up to 10 Hz and soft beside the physics rate
#define HORIZON 0.0056                        // T: a spring of 40 Hz (s)
#define HALF_SQUARE (0.5 * HORIZON * HORIZON) // (s^2)
#define LIMIT_SPRING 60.0                     // beside a servo (Hz)
#define RETURN_SPEED 3.0                      // of the way back from far beyond (rad/s)
#define LARGEST_BEYOND 0.02                   // beyond this the pull does not grow (rad)
#define LOST_DAMPING 0.05                     // lambda, of the compensation at the tips (m)
#define COMPENSATION_PASSES 3                 // each may move another joint out of its bounds
// chosen: of bounds, for the count of hits
#define HIT_MEASURE 0.95  // a joint this near its bounds has hit them ...
#define FREE_MEASURE 0.85 // ... and can hit them again after a return to here
// chosen: above rounding, below anything visible
#define LEAST_BEYOND 1e-9                     // a joint beyond by less is within (rad)
#define LEAST_CORRECTION (0.01 * HALF_SQUARE) // that of 0.01 rad/s^2 (rad)
#define LEAST_AGAIN (10 * HALF_SQUARE) // after a compensation: the rest is for the next step (rad)
#define SLIDE_STEP 1e-4                // over which motion along a limit is measured (s)
// chosen: more than strokes within a player's own limits need, see above
#define LARGEST_ERROR 0.4  // of a joint of an arm: beyond this it does not pull harder (rad)
#define HARDEST_DEMAND 8e3 // on a joint of an arm (rad/s^2)

/// A joint and its bounds; rotations in the world's frame.
typedef struct joint_place {
    himc_quat q; // in the parent's frame
    const himc_mat3 *parent;
    double beyond;   // its bounds (rad)
    himc_vec3 coast; // its rotation within the horizon without acceleration (rad)
    // the last orientation that was placed in the bounds: rotated by this from q; infinite: none
    himc_vec3 rotate; // (rad)
    double room;      // no rotation from there by less leaves the bounds (rad)
    himc_vec3 back;   // from there to the nearest orientation within (rad)
} joint_place;

/// Corrections of joints, each along one direction.
typedef struct limit_stops {
    int count;
    int joint[HIMC_JOINTS];
    himc_vec3 inward[HIMC_JOINTS]; // unit vectors of the world
    double more[HIMC_JOINTS];      // acceleration along them (rad/s^2)
} limit_stops;

// places the joint where it would be after the rotation; no way back that is shorter than `least`
// (rad) need be found
static void place_joint(const himc_limits *limits, int j, himc_vec3 rotate, double least,
                        joint_place *at)
{
    himc_quat turn = himc_quat_exp(himc_mat3_apply_transposed(at->parent, rotate));
    himc_vec3 back = himc_limit_back(limits, j, himc_quat_mul(turn, at->q), least, &at->room);
    at->rotate = rotate;
    at->back = himc_mat3_apply(at->parent, back);
}

// Places the joints in their bounds as they are now. The angle beyond is computed where it may be
// more than `least` (rad) or than before, else it is of no use.
static void find_places(const himc_controller *c, const himc_skeleton *skeleton,
                        const himc_body_state *s, double least, joint_place at[HIMC_JOINTS])
{
    himc_saturation_counts *counts = c->saturation;
    for (int j = 0; j < HIMC_JOINTS; j++) {
        if (!c->limits->joint[j].bound)
            continue;
        int p = skeleton->segment[j + 1].parent;
        himc_vec3 spin = himc_relative_spin(skeleton, s, j);
        himc_vec3 carried = himc_vec3_cross(s->spin[p], spin); // by the rotating parent
        // member by member: a struct built aside and then copied makes a step 2 % longer
        at[j].q = himc_quat_mul(himc_quat_conj(s->orientation[p]), s->orientation[j + 1]);
        himc_limit_place place = himc_limit_locate(c->limits, j, at[j].q);
        at[j].parent = &s->rotation[p];
        at[j].beyond = 0;
        at[j].coast = himc_vec3_madd(himc_vec3_scale(spin, HORIZON), -HALF_SQUARE, carried);
        at[j].rotate = himc_vec3_make(place.measure > 1 ? INFINITY : 0, 0, 0);
        at[j].room = place.room;
        at[j].back = himc_vec3_make(0, 0, 0);
        if (place.most_beyond > least || (counts && place.most_beyond > counts->farthest[j])) {
            place_joint(c->limits, j, himc_vec3_make(0, 0, 0), 0, &at[j]);
            at[j].beyond = himc_vec3_length(at[j].back);
        }
        if (!counts)
            continue;
        counts->measure[j] = place.measure;
        if (counts->farthest[j] < at[j].beyond)
            counts->farthest[j] = at[j].beyond;
        counts->held[j] = counts->held[j] && place.measure > FREE_MEASURE;
    }
}

// the joints that these accelerations would move out of their bounds by `least` (rad) and more
static void find_stops(const himc_limits *limits, joint_place at[HIMC_JOINTS],
                       const himc_vec3 *relative, double least, limit_stops *found)
{
    found->count = 0;
    for (int j = 0; j < HIMC_JOINTS; j++) {
        if (!limits->joint[j].bound)
            continue;
        himc_vec3 rotate = himc_vec3_madd(at[j].coast, HALF_SQUARE, relative[j]);
        himc_vec3 moved = himc_vec3_sub(rotate, at[j].rotate);
        double square = himc_vec3_dot(moved, moved);
        if (square > 0 && square >= at[j].room * at[j].room)
            place_joint(limits, j, rotate, least, &at[j]);
        double angle = himc_vec3_length(at[j].back), late = at[j].beyond - RETURN_SPEED * HORIZON;
        double now = late > 0 ? angle - late : angle;
        if (now < least)
            continue;
        found->joint[found->count] = j;
        found->inward[found->count] = himc_vec3_scale(at[j].back, 1 / angle);
        found->more[found->count++] = now / HALF_SQUARE;
    }
}

static himc_vec3 reciprocal(himc_vec3 v)
{
    return himc_vec3_make(1 / v.x, 1 / v.y, 1 / v.z);
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
    himc_vec3 way[HIMC_ARM_JOINTS];
    himc_mat3 gram = jacobian->gram;
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        way[k] = himc_vec3_make(0, 0, 0);
        for (int h = 0; h < stop->count; h++)
            if (stop->joint[h] == himc_arm_joint(hand, k))
                way[k] = stop->inward[h];
        himc_vec3 v = himc_vec3_cross(way[k], jacobian->lever[k]);
        const double b[3] = {v.x, v.y, v.z};
        for (int i = 0; i < 3; i++)
            for (int n = 0; n < 3; n++)
                gram.m[i][n] -= jacobian->weight[k] * b[i] * b[n];
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

// Shortens an arm's vectors, in the same proportions, so that none is longer than `most`. Torques
// are measured by the accelerations that they make: `inertia` and the state; else both are NULL.
static void bound_arm(himc_hand hand, double most, const himc_vec3 *inertia,
                      const himc_body_state *s, himc_vec3 all[HIMC_JOINTS])
{
    double longest = 0;
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        int j = himc_arm_joint(hand, k);
        himc_vec3 v = all[j];
        if (inertia)
            v = himc_mat3_scale_along(&s->rotation[j + 1], reciprocal(inertia[j]), v);
        longest = fmax(longest, himc_vec3_length(v));
    }
    for (int k = 0; k < HIMC_ARM_JOINTS && longest > most; k++) {
        himc_vec3 *v = &all[himc_arm_joint(hand, k)];
        *v = himc_vec3_scale(*v, most / longest);
    }
}

void himc_limits_bound_errors(const himc_controller *c, tracking_error *e)
{
    if (!c->limits || c->limits->kind == HIMC_LIMITS_OFF)
        return;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        bound_arm((himc_hand)hand, LARGEST_ERROR, NULL, NULL, e->angle);
}

void himc_limits_compliance(const himc_controller *c, const himc_skeleton *skeleton,
                            const himc_body_state *s, const himc_arm_jacobian jacobian[HIMC_HANDS],
                            himc_vec3 wanted[HIMC_JOINTS])
{
    joint_place at[HIMC_JOINTS];
    limit_stops stop;
    himc_vec3 before[HIMC_JOINTS];
    if (!c->limits || c->limits->kind == HIMC_LIMITS_OFF)
        return;
    find_places(c, skeleton, s, RETURN_SPEED * HORIZON, at);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        bound_arm((himc_hand)hand, HARDEST_DEMAND, NULL, NULL, wanted);
    memcpy(before, wanted, sizeof before);
    for (int pass = 0; pass <= COMPENSATION_PASSES; pass++) {
        double least = pass == 0 ? LEAST_CORRECTION : LEAST_AGAIN;
        find_stops(c->limits, at, wanted, least, &stop);
        if (stop.count == 0)
            break;
        for (int h = 0; h < stop.count; h++) {
            count_hit(c->saturation, stop.joint[h]);
            himc_vec3 *a = &wanted[stop.joint[h]];
            *a = himc_vec3_madd(*a, stop.more[h], stop.inward[h]);
        }
        for (int h = 0; pass < COMPENSATION_PASSES && h < HIMC_HANDS; h++) {
            himc_hand hand = (himc_hand)h;
            himc_vec3 lost = {0, 0, 0}; // of the tip's acceleration
            for (int i = himc_stick_segment(hand); i > 0; i = skeleton->segment[i].parent) {
                himc_vec3 less = himc_vec3_sub(before[i - 1], wanted[i - 1]);
                himc_vec3 lever = himc_vec3_sub(s->tip[hand], s->origin[i]);
                lost = himc_vec3_add(lost, himc_vec3_cross(less, lever));
            }
            give_back(&stop, &jacobian[hand], hand, lost, wanted);
        }
    }
}

// twice the energy of a rotation in the parent's frame
static double energy(himc_quat q, himc_vec3 inertia, himc_vec3 spin)
{
    himc_vec3 v = himc_quat_rotate(himc_quat_conj(q), spin);
    return inertia.x * v.x * v.x + inertia.y * v.y * v.y + inertia.z * v.z * v.z;
}

void himc_limits_resist(const himc_controller *c, const himc_skeleton *skeleton,
                        const himc_body_state *s, himc_vec3 torque[HIMC_JOINTS],
                        himc_vec3 resistance[HIMC_JOINTS])
{
    const double w = 2 * HIMC_PI * LIMIT_SPRING, h = c->step;
    joint_place at[HIMC_JOINTS];
    if (!c->limits || c->limits->kind == HIMC_LIMITS_OFF)
        return;
    find_places(c, skeleton, s, 0, at);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        bool beyond = false;
        for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
            int j = himc_arm_joint((himc_hand)hand, k);
            beyond = beyond || (c->limits->joint[j].bound && at[j].beyond >= LEAST_BEYOND);
        }
        if (beyond)
            bound_arm((himc_hand)hand, HARDEST_DEMAND, c->inertia, s, torque);
    }
    for (int j = 0; j < HIMC_JOINTS; j++) {
        if (!c->limits->joint[j].bound || at[j].beyond < LEAST_BEYOND)
            continue;
        count_hit(c->saturation, j);
        const himc_mat3 *parent = at[j].parent, *child = &s->rotation[j + 1];
        himc_vec3 i = c->inertia[j], light = reciprocal(i);
        // the rotation to the nearest orientation within, and its rate, in the parent's frame
        himc_vec3 way = himc_mat3_apply_transposed(parent, at[j].back);
        himc_vec3 spin = himc_mat3_apply_transposed(parent, himc_relative_spin(skeleton, s, j));
        himc_quat q = at[j].q, near = himc_quat_mul(himc_quat_exp(way), q);
        himc_quat next = himc_quat_mul(himc_quat_exp(himc_vec3_scale(spin, SLIDE_STEP)), q);
        himc_quat closest = himc_limit_closest(c->limits, j, next);
        himc_vec3 moved = himc_quat_log(himc_quat_mul(closest, himc_quat_conj(near)));
        himc_vec3 along = himc_vec3_scale(moved, 1 / SLIDE_STEP);
        way = himc_vec3_scale(way, fmin(1, LARGEST_BEYOND / at[j].beyond));
        // far outside, the nearest orientation may run away or jump to the other side
        double most = energy(q, i, spin), has = energy(q, i, along);
        himc_vec3 rate = himc_vec3_madd(spin, has > most ? -sqrt(most / has) : -1, along);
        himc_vec3 a = himc_vec3_madd(himc_vec3_scale(way, w * w), -(h * w * w + 2 * w), rate);
        himc_vec3 n = himc_mat3_apply(parent, himc_vec3_unit(way));
        // the servo's torque must not move the joint further out
        double outward = fmin(himc_vec3_dot(n, himc_mat3_scale_along(child, light, torque[j])), 0);
        a = himc_vec3_madd(himc_mat3_apply(parent, a), -outward, n);
        torque[j] = himc_vec3_add(torque[j], himc_mat3_scale_along(child, i, a));
        resistance[j] = himc_vec3_madd(resistance[j], h * w * (2 + h * w), i);
    }
}
