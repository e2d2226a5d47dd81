/// controller.c: three stages. Tracking errors (tracking_error.c): for each joint the missing angle
/// and rate, and the acceleration fed forward. Law (law.h): the torque for them. Joint limits have
/// priority over both (limit_torque.c). Body: what strength and muscles give of it, and what trunk
/// and legs then do (settle.c).
#include "control/controller.h"

#include "base/rotations.h"
#include "body/dynamics.h"
#include "control/law.h"
#include "control/limit_torque.h"
#include "control/muscle.h"
#include "control/settle.h"
#include "control/strength.h"
#include "control/tracking_error.h"

#include <string.h>

#define PD_STIFFNESS 3.0           // chosen: the PD laws' frequencies over the table of servos
#define USUAL_PHYSICS_RATE 10000.0 // of himc_performance_default (Hz)

#define LAW(ID, name, word, accelerates) {himc_law_##name, accelerates},
const himc_law_row himc_laws[HIMC_LAW_COUNT] = {HIMC_LAWS(LAW)};

// bit by bit; memcmp takes a byte at a time in a page
static bool same(const void *a, const void *b, size_t size)
{
    uint64_t differs = 0, x[2];
    for (size_t i = 0; i < size; i += sizeof *x) {
        memcpy(&x[0], (const char *)a + i, sizeof *x);
        memcpy(&x[1], (const char *)b + i, sizeof *x);
        differs |= x[0] ^ x[1];
    }
    return differs == 0;
}

// whether the legs have the same targets
static bool same_legs(const himc_posture_motion *a, const himc_posture_motion *b)
{
    enum { FIRST = HIMC_LEGS - 1, COUNT = HIMC_JOINTS - FIRST };
    return same(a->joint + FIRST, b->joint + FIRST, COUNT * sizeof *a->joint) &&
           same(a->rate + FIRST, b->rate + FIRST, COUNT * sizeof *a->rate) &&
           same(a->acceleration + FIRST, b->acceleration + FIRST, COUNT * sizeof *a->acceleration);
}

// what the legs are asked for, if they sleep and it is known
static const himc_leg_torques *known_legs(const himc_controller *c,
                                          const himc_posture_motion *targets)
{
    for (int i = 0; c->articulation && c->articulation->end == HIMC_LEGS && i < 2; i++)
        if (c->legs->known[i].step == c->step && same_legs(&c->legs->known[i].targets, targets))
            return &c->legs->known[i];
    return NULL;
}

static void know_legs(const himc_controller *c, const himc_posture_motion *targets,
                      const himc_vec3 torque[HIMC_JOINTS])
{
    himc_leg_torques *known = c->legs->known;
    if (!c->articulation || c->articulation->end > HIMC_LEGS || c->limits ||
        c->config.law != HIMC_LAW_COMPUTED_TORQUE) {
        known[0].step = known[1].step = 0;
        return;
    }
    known += known[0].step > 0 && known[0].step != c->step;
    *known = (himc_leg_torques){.step = c->step, .targets = *targets};
    memcpy(known->torque, torque, sizeof known->torque);
}

void himc_controller_torques(const himc_controller *c, const himc_skeleton *skeleton,
                             const himc_body_state *s, const himc_reference *reference,
                             himc_vec3 torque[HIMC_JOINTS])
{
    tracking_error e;
    himc_arm_jacobian jacobian[HIMC_HANDS];
    double reserve[HIMC_HANDS] = {1, 1};
    himc_articulation own;
    if (c->legs)
        c->legs->asked = known_legs(c, &reference->posture);
    himc_tracking_error_joints(skeleton, s, &reference->posture, himc_joints_computed(c), &e);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_arm_jacobian_weighted(s, (himc_hand)hand, c->config.weight, &jacobian[hand]);
        if (c->config.mode == HIMC_PIPELINE_HIMC)
            himc_tracking_error_tip(c, skeleton, s, &reference->tip[hand], (himc_hand)hand,
                                    &jacobian[hand], &e);
    }
    himc_limits_bound_errors(c, &e);
    law_input in = {c, skeleton, s, reference, jacobian, &e};
    const himc_law_row *law = &himc_laws[c->config.law];
    himc_vec3 wanted[HIMC_JOINTS], asked[HIMC_JOINTS];
    if (himc_joints_computed(c) < HIMC_JOINTS)
        memcpy(asked, c->legs->asked->torque, sizeof asked);
    law->find(&in, law->accelerates ? wanted : asked);
    if (law->accelerates)
        himc_invert(c, skeleton, s, wanted, asked);
    if (c->legs && !c->legs->asked)
        know_legs(c, &reference->posture, asked);
    for (int hand = 0; c->config.human_strength && hand < HIMC_HANDS; hand++)
        reserve[hand] = himc_strength_reserve(c, reference, s, (himc_hand)hand);
    if (law->accelerates && c->config.human_strength)
        himc_slow_weak_arms(c, skeleton, s, reserve, wanted, asked);
    memcpy(torque, asked, sizeof asked);
    himc_strength_apply(c, skeleton, s, reserve, torque);
    if (c->muscles && c->config.human_strength)
        himc_muscles_act(
            c->muscles,
            &(himc_muscle_input){reference->struck, reserve, c->config.strength, e.rate,
                                 himc_strength_articulation(c, skeleton, s, &own), c->step},
            torque);
    if (law->accelerates)
        himc_settle(c, skeleton, s, reserve, wanted, asked, torque);
}

himc_controller_config himc_controller_config_default(void)
{
    return (himc_controller_config){
        .mode = HIMC_PIPELINE_HIMC,
        .law = HIMC_LAW_COMPUTED_TORQUE,
        .solver = HIMC_SOLVER_DLS,
        .damping =
            0.01, // chosen: far below an arm's levers of 0.3 m, so it acts near singularities
        .weight = {1, 1, 1, 1},
        .posture = true,
        .bandwidth = 20, // chosen: above the fastest strokes, far below the physics rate
    };
}

himc_gain himc_controller_usual_gain(const himc_controller *c, int joint)
{
    // natural frequencies of the servos (Hz); chosen: the lighter the part, the faster
    static const double arm[HIMC_ARM_JOINTS] = {8, 10, 14, 18}, others = 5;
    int k = (joint - (HIMC_LEFT_UPPER_ARM - 1)) / 2;
    bool is_arm = joint >= HIMC_LEFT_UPPER_ARM - 1 && k < HIMC_ARM_JOINTS;
    double w = 2 * HIMC_PI * (PD_STIFFNESS * (is_arm ? arm[k] : others));
    himc_vec3 i = c->inertia[joint];
    return (himc_gain){himc_vec3_scale(i, w * w), himc_vec3_scale(i, 2 * w)};
}

void himc_controller_configure(himc_controller *c, const himc_controller_config *config)
{
    c->config = *config;
    if (c->legs)
        c->legs->known[0].step = c->legs->known[1].step = 0;
    for (int j = 0; j < HIMC_JOINTS; j++)
        c->gain[j] = config->gain_set[j] ? config->gain[j] : himc_controller_usual_gain(c, j);
}

void himc_controller_init(himc_controller *c, const himc_controller_config *config,
                          const himc_skeleton *skeleton, const himc_body_state *posture)
{
    *c = (himc_controller){.step = 1 / USUAL_PHYSICS_RATE};
    // inertia of all segments moved by a joint, about the child's axes
    for (int j = 0; j < HIMC_JOINTS; j++) {
        double sum[3] = {0, 0, 0};
        const himc_mat3 *axes = &posture->rotation[j + 1];
        for (int i = j + 1; i < HIMC_SEGMENTS; i++) {
            int up = i;
            while (up > j + 1)
                up = skeleton->segment[up].parent;
            if (up != j + 1) // the joint does not move it
                continue;
            const himc_segment *segment = &skeleton->segment[i];
            himc_vec3 center = himc_segment_center(skeleton, posture, i);
            himc_vec3 r = himc_vec3_sub(center, posture->origin[j + 1]), inertia = segment->inertia;
            for (int k = 0; k < 3; k++) {
                himc_vec3 axis = {axes->m[0][k], axes->m[1][k], axes->m[2][k]};
                himc_vec3 own = himc_mat3_apply_transposed(&posture->rotation[i], axis);
                himc_vec3 arm = himc_vec3_cross(axis, r);
                sum[k] += segment->mass * himc_vec3_dot(arm, arm) + inertia.x * own.x * own.x +
                          inertia.y * own.y * own.y + inertia.z * own.z * own.z;
            }
        }
        c->inertia[j] = himc_vec3_make(sum[0], sum[1], sum[2]);
    }
    himc_controller_configure(c, config);
}

himc_gain himc_controller_gain(const himc_controller *c, int joint, double stiffness,
                               double damping)
{
    himc_vec3 i = c->inertia[joint];
    double flexion = i.y;
    return (himc_gain){himc_vec3_scale(i, stiffness / flexion),
                       himc_vec3_scale(i, damping / flexion)};
}
