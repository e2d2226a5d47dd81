/// controller.c: two stages. Tracking errors (tracking_error.c): for each joint the missing angle
/// and rate, and the acceleration fed forward. Law: the torque for them.
///
/// `printed` is tau = ks dq - kd q', `feedforward` tau = g(q) + ks dq + kd (q'_t - q'),
/// `computed-torque` alpha = q''_t + 2 w (q'_t - q') + w^2 dq through inverse dynamics. While a
/// stick touches the head all three give it the hand's acceleration along the normal (grip.h), none
/// in a stroke: the physics makes the rebound.
/// Joint limits have priority over all of this (limit_torque.c).
///
/// The engine moves with the velocity at a step's end, so its velocities are those of half a step
/// before their positions: computed torque wants q'_t - h/2 q''_t. Without it a tip lags by
/// h a / w, 0.01 mm in a roll.
///
/// A servo that reads the state at the step's beginning is unstable as soon as kd h exceeds twice
/// the inertia, and the inertia about a joint's long axis is small. So servos act on the state at
/// the end of the step (Tan, Liu & Turk's stable PD, 2011): with D = h kd + h^2 ks at each joint,
///     (M + D) q'' = tau_known - C,   tau = tau_known - D q'',
/// which holds at any gain and, as h goes to 0, is equation 2.
#include "control/controller.h"

#include "base/rotations.h"
#include "body/dynamics.h"
#include "control/ik.h"
#include "control/limit_torque.h"
#include "control/still_legs.h"
#include "control/strength.h"
#include "control/tracking_error.h"

#define PD_STIFFNESS 3.0           // chosen: the PD laws' frequencies over servo_frequency's table
#define USUAL_PHYSICS_RATE 10000.0 // of himc_performance_default (Hz)

static void release(himc_vec3 *all, himc_hand hand, const himc_arm_jacobian *jacobian,
                    himc_vec3 normal, double remain)
{
    himc_vec3 arm[HIMC_ARM_JOINTS];
    himc_arm_gather(all, hand, arm);
    himc_ik_release(jacobian, normal, remain, arm);
    himc_arm_scatter(arm, hand, all);
}

// in contact the tip has the hand's acceleration along the normal, for any gains of the joints
static void release_acceleration(const himc_skeleton *skeleton, const himc_body_state *s,
                                 const himc_reference *reference, const himc_arm_jacobian *jacobian,
                                 himc_vec3 wanted[HIMC_JOINTS])
{
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        if (reference->released[hand]) {
            himc_vec3 n = reference->normal[hand], a = himc_vec3_scale(n, reference->yield[hand]);
            himc_vec3 left = himc_acceleration_left(skeleton, s, (himc_hand)hand, wanted, a);
            release(wanted, (himc_hand)hand, &jacobian[hand], n, himc_vec3_dot(n, left));
        }
}

// Equation 2 with the state at the end of the step, q+ = q + h q' + h^2 q'' and q'+ = q' + h q'',
// instead of that at its beginning: the known part. The rest, -(h kd + h^2 ks) q'', is the joint's
// resistance.
static himc_vec3 servo_known(const himc_controller *c, const himc_body_state *s,
                             const tracking_error *e, himc_vec3 spin, int j)
{
    double h = c->step;
    himc_vec3 angle = himc_vec3_madd(e->angle[j], h, e->rate[j]);
    himc_vec3 rate = himc_vec3_scale(spin, -1);
    if (c->config.law != HIMC_LAW_PRINTED) { // the error of velocity, and the target's motion
        rate = himc_vec3_madd(e->rate[j], h, e->acceleration[j]);
        angle = himc_vec3_madd(angle, h * h, e->acceleration[j]);
    }
    const himc_mat3 *r = &s->rotation[j + 1];
    return himc_vec3_add(himc_mat3_scale_along(r, c->gain[j].stiffness, angle),
                         himc_mat3_scale_along(r, c->gain[j].damping, rate));
}

// the forces at released tips that give them the hand's acceleration along the normal: m a, with
// the mass of an arm with servos at its joints
static void release_forces(const himc_skeleton *skeleton, const himc_body_state *s,
                           const himc_reference *reference, const himc_articulation *art,
                           const himc_vec3 *known, himc_vec3 force[HIMC_HANDS])
{
    himc_vec3 relative[HIMC_JOINTS];
    for (int i = 0; i < HIMC_HANDS; i++) {
        himc_hand hand = (himc_hand)i;
        himc_vec3 n = reference->normal[i], without = force[i];
        double a[2];
        for (int unit = 0; reference->released[i] && unit < 2; unit++) {
            force[i] = himc_vec3_madd(without, unit, n);
            himc_forward_dynamics(skeleton, s, art, known, force, relative);
            a[unit] = himc_vec3_dot(n, himc_tip_acceleration(skeleton, s, hand, relative));
        }
        if (reference->released[i])
            force[i] = himc_vec3_madd(without, (reference->yield[i] - a[0]) / (a[1] - a[0]), n);
    }
}

// equation 2, implicit over the step, with or without feedforward of target velocity and gravity
static void servo_torques(const himc_controller *c, const himc_skeleton *skeleton,
                          const himc_body_state *s, const himc_reference *reference,
                          const tracking_error *e, himc_vec3 torque[HIMC_JOINTS])
{
    himc_articulation art;
    himc_vec3 resistance[HIMC_JOINTS], relative[HIMC_JOINTS], force[HIMC_HANDS] = {{0, 0, 0}};
    for (int j = 0; j < HIMC_JOINTS; j++)
        torque[j] = himc_vec3_make(0, 0, 0);
    if (c->config.law == HIMC_LAW_FEEDFORWARD)
        himc_inverse_dynamics(skeleton, s, NULL, true, torque);
    for (int j = 0; j < HIMC_JOINTS; j++) {
        himc_vec3 known = servo_known(c, s, e, himc_relative_spin(skeleton, s, j), j);
        torque[j] = himc_vec3_add(torque[j], known);
        resistance[j] = himc_vec3_madd(himc_vec3_scale(c->gain[j].damping, c->step),
                                       c->step * c->step, c->gain[j].stiffness);
    }
    himc_limits_resist(c, skeleton, s, torque, resistance);
    himc_articulate_resisting(skeleton, s, resistance, &art);
    release_forces(skeleton, s, reference, &art, torque, force);
    himc_forward_dynamics(skeleton, s, &art, torque, force, relative);
    for (int j = 0; j < HIMC_JOINTS; j++)
        torque[j] = himc_vec3_sub(
            torque[j], himc_mat3_scale_along(&s->rotation[j + 1], resistance[j], relative[j]));
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        if (reference->released[hand])
            himc_add_force(skeleton, s, himc_stick_segment((himc_hand)hand), s->tip[hand],
                           force[hand], torque);
}

// stiffness and damping over inertia of one axis, as far as an implicit step lets them act
static void implicit_rates(double ks, double kd, double step, double rate[2])
{
    double all = 1 + step * kd + step * step * ks;
    rate[0] = ks / all;
    rate[1] = (kd + step * ks) / all;
}

// w^2 and 2 w of a joint, from the bandwidth or, where the user has set gains, from those over
// the inertia; the bandwidth is always slow compared with the step, gains need not be
static himc_vec3 feedback(const himc_controller *c, const himc_body_state *s, int j,
                          const tracking_error *e)
{
    double w = 2 * HIMC_PI * c->config.bandwidth, x[2], y[2], z[2];
    if (!c->config.gain_set[j])
        return himc_vec3_madd(himc_vec3_scale(e->angle[j], w * w), 2 * w, e->rate[j]);
    himc_vec3 i = c->inertia[j], ks = c->gain[j].stiffness, kd = c->gain[j].damping;
    const himc_mat3 *r = &s->rotation[j + 1];
    implicit_rates(ks.x / i.x, kd.x / i.x, c->step, x);
    implicit_rates(ks.y / i.y, kd.y / i.y, c->step, y);
    implicit_rates(ks.z / i.z, kd.z / i.z, c->step, z);
    return himc_vec3_add(himc_mat3_scale_along(r, himc_vec3_make(x[0], y[0], z[0]), e->angle[j]),
                         himc_mat3_scale_along(r, himc_vec3_make(x[1], y[1], z[1]), e->rate[j]));
}

// the accelerations of computed torque: q''_t + 2 w (q'_t - h/2 q''_t - q') + w^2 dq
static void wanted_accelerations(const himc_controller *c, const himc_body_state *s,
                                 tracking_error *e, himc_vec3 wanted[HIMC_JOINTS])
{
    for (int j = 0; j < HIMC_JOINTS; j++) {
        e->rate[j] = himc_vec3_madd(e->rate[j], -0.5 * c->step, e->acceleration[j]);
        wanted[j] = himc_vec3_add(e->acceleration[j], feedback(c, s, j, e));
    }
}

// of all joints; of legs at rest from the step before
static void joint_errors(const himc_controller *c, const himc_skeleton *skeleton,
                         const himc_body_state *s, const himc_posture_motion *target,
                         tracking_error *e)
{
    himc_tracking_error_joints(skeleton, s, target, 0, c->legs ? HIMC_LEGS - 1 : HIMC_JOINTS, e);
    if (c->legs)
        himc_still_legs_errors(c->legs, skeleton, s, target, e);
}

static void wanted_torques(const himc_controller *c, const himc_skeleton *skeleton,
                           const himc_body_state *s, const himc_vec3 *wanted,
                           himc_vec3 torque[HIMC_JOINTS])
{
    himc_inverse_dynamics_of(skeleton, s, c->legs ? c->articulation : NULL, wanted, 1,
                             c->legs ? HIMC_LEGS : HIMC_SEGMENTS, torque);
    if (c->legs)
        himc_still_legs_torques(c->legs, skeleton, s, wanted, torque);
}

void himc_controller_torques(const himc_controller *c, const himc_skeleton *skeleton,
                             const himc_body_state *s, const himc_reference *reference,
                             himc_vec3 torque[HIMC_JOINTS])
{
    tracking_error e;
    himc_arm_jacobian jacobian[HIMC_HANDS];
    joint_errors(c, skeleton, s, &reference->posture, &e);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_arm_jacobian_weighted(s, (himc_hand)hand, c->config.weight, &jacobian[hand]);
        if (c->config.mode == HIMC_PIPELINE_HIMC)
            himc_tracking_error_tip(c, skeleton, s, &reference->tip[hand], (himc_hand)hand,
                                    &jacobian[hand], &e);
    }
    himc_limits_bound_errors(c, &e);
    if (c->config.law == HIMC_LAW_COMPUTED_TORQUE) {
        himc_vec3 wanted[HIMC_JOINTS];
        wanted_accelerations(c, s, &e, wanted);
        release_acceleration(skeleton, s, reference, jacobian, wanted);
        himc_limits_compliance(c, skeleton, s, jacobian, wanted);
        wanted_torques(c, skeleton, s, wanted, torque);
    } else {
        servo_torques(c, skeleton, s, reference, &e, torque);
    }
    himc_strength_apply(c, skeleton, s, torque);
}

// inertia of all segments moved by a joint, about the child's axes
static himc_vec3 hanging_inertia(const himc_skeleton *skeleton, const himc_body_state *s, int joint)
{
    double sum[3] = {0, 0, 0};
    const himc_mat3 *axes = &s->rotation[joint + 1];
    for (int i = joint + 1; i < HIMC_SEGMENTS; i++) {
        int up = i;
        while (up > joint + 1)
            up = skeleton->segment[up].parent;
        if (up != joint + 1)
            continue;
        const himc_segment *segment = &skeleton->segment[i];
        himc_vec3 c =
            himc_vec3_add(s->origin[i], himc_mat3_apply(&s->rotation[i], segment->center));
        himc_vec3 r = himc_vec3_sub(c, s->origin[joint + 1]);
        for (int k = 0; k < 3; k++) {
            himc_vec3 axis = {axes->m[0][k], axes->m[1][k], axes->m[2][k]};
            himc_vec3 own = himc_mat3_apply_transposed(&s->rotation[i], axis);
            himc_vec3 arm = himc_vec3_cross(axis, r);
            sum[k] += segment->mass * himc_vec3_dot(arm, arm) + segment->inertia.x * own.x * own.x +
                      segment->inertia.y * own.y * own.y + segment->inertia.z * own.z * own.z;
        }
    }
    return himc_vec3_make(sum[0], sum[1], sum[2]);
}

// natural frequency of a joint's servo (Hz); chosen: the lighter the part, the faster
static double servo_frequency(int joint)
{
    static const double arm[HIMC_ARM_JOINTS] = {8, 10, 14, 18}, others = 5;
    int k = (joint - (HIMC_LEFT_UPPER_ARM - 1)) / 2;
    bool is_arm = joint >= HIMC_LEFT_UPPER_ARM - 1 && k < HIMC_ARM_JOINTS;
    return PD_STIFFNESS * (is_arm ? arm[k] : others);
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
        .bandwidth = 20, // chosen: above the fastest strokes, far below the physics rate
    };
}

himc_gain himc_controller_usual_gain(const himc_controller *c, int joint)
{
    himc_vec3 i = c->inertia[joint];
    double w = 2 * HIMC_PI * servo_frequency(joint);
    return (himc_gain){himc_vec3_scale(i, w * w), himc_vec3_scale(i, 2 * w)};
}

void himc_controller_configure(himc_controller *c, const himc_controller_config *config)
{
    c->config = *config;
    for (int j = 0; j < HIMC_JOINTS; j++)
        c->gain[j] = config->gain_set[j] ? config->gain[j] : himc_controller_usual_gain(c, j);
}

void himc_controller_init(himc_controller *c, const himc_controller_config *config,
                          const himc_skeleton *skeleton, const himc_body_state *posture)
{
    *c = (himc_controller){.step = 1 / USUAL_PHYSICS_RATE};
    for (int j = 0; j < HIMC_JOINTS; j++)
        c->inertia[j] = hanging_inertia(skeleton, posture, j);
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
