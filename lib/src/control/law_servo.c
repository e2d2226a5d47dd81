/// law_servo.c: the laws `printed`, tau = ks dq - kd q' (2012 paper, equation 2), and
/// `feedforward`, tau = g(q) + ks dq + kd (q'_t - q').
///
/// A servo that reads the state at the step's beginning is unstable as soon as kd h exceeds twice
/// the inertia, and the inertia about a joint's long axis is small. So servos act on the state at
/// the end of the step (Tan, Liu & Turk's stable PD, 2011): with D = h kd + h^2 ks at each joint,
///     (M + D) q'' = tau_known - C,   tau = tau_known - D q'',
/// which holds at any gain and, as h goes to 0, is equation 2.
#include "base/rotations.h"
#include "body/dynamics.h"
#include "control/balance.h"
#include "control/law.h"
#include "control/limit_torque.h"

// the forces at released tips that give them the hand's acceleration along the normal: m a, with
// the mass of an arm with servos at its joints
static void release_forces(const law_input *in, const himc_articulation *art,
                           const himc_vec3 *known, himc_vec3 force[HIMC_HANDS])
{
    const himc_reference *reference = in->reference;
    himc_vec3 relative[HIMC_JOINTS];
    for (int i = 0; i < HIMC_HANDS; i++) {
        himc_hand hand = (himc_hand)i;
        himc_vec3 n = reference->normal[i], without = force[i];
        double a[2];
        for (int unit = 0; reference->released[i] && unit < 2; unit++) {
            force[i] = himc_vec3_madd(without, unit, n);
            himc_spatial root = himc_balance_accelerate(in->controller->balance, in->skeleton,
                                                        in->state, art, known, force, relative);
            a[unit] = himc_vec3_dot(
                n, himc_tip_acceleration(in->skeleton, in->state, hand, relative, &root));
        }
        if (reference->released[i])
            force[i] = himc_vec3_madd(without, (reference->yield[i] - a[0]) / (a[1] - a[0]), n);
    }
}

// Equation 2 with the state at the end of the step, q+ = q + h q' + h^2 q'' and q'+ = q' + h q'',
// instead of that at its beginning: a known part, and the joint's resistance -(h kd + h^2 ks) q''.
// `follows`: with feedforward of target velocity and gravity.
static void servo(const law_input *in, bool follows, himc_vec3 torque[HIMC_JOINTS])
{
    const himc_controller *c = in->controller;
    const himc_skeleton *skeleton = in->skeleton;
    const himc_body_state *s = in->state;
    const tracking_error *e = in->error;
    double h = c->step;
    himc_articulation art;
    himc_vec3 resistance[HIMC_JOINTS], relative[HIMC_JOINTS], force[HIMC_HANDS] = {{0, 0, 0}};
    for (int j = 0; j < HIMC_JOINTS; j++)
        torque[j] = himc_vec3_make(0, 0, 0);
    if (follows)
        himc_inverse_dynamics(skeleton, s, NULL, true, torque);
    for (int j = 0; j < HIMC_JOINTS; j++) {
        const himc_mat3 *r = &s->rotation[j + 1];
        himc_vec3 ks = c->gain[j].stiffness, kd = c->gain[j].damping;
        himc_vec3 angle = himc_vec3_madd(e->angle[j], h, e->rate[j]);
        himc_vec3 rate = himc_vec3_scale(himc_relative_spin(skeleton, s, j), -1);
        if (follows) { // the error of velocity, and the target's motion
            rate = himc_vec3_madd(e->rate[j], h, e->acceleration[j]);
            angle = himc_vec3_madd(angle, h * h, e->acceleration[j]);
        }
        himc_vec3 known =
            himc_vec3_add(himc_mat3_scale_along(r, ks, angle), himc_mat3_scale_along(r, kd, rate));
        torque[j] = himc_vec3_add(torque[j], known);
        resistance[j] = himc_vec3_madd(himc_vec3_scale(kd, h), h * h, ks);
    }
    himc_limits_resist(c, skeleton, s, torque, resistance);
    himc_articulate_resisting(skeleton, s, resistance, &art);
    release_forces(in, &art, torque, force);
    himc_balance_accelerate(c->balance, skeleton, s, &art, torque, force, relative);
    for (int j = 0; j < HIMC_JOINTS; j++)
        torque[j] = himc_vec3_sub(
            torque[j], himc_mat3_scale_along(&s->rotation[j + 1], resistance[j], relative[j]));
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        if (in->reference->released[hand])
            himc_add_force(skeleton, s, himc_stick_segment((himc_hand)hand), s->tip[hand],
                           force[hand], torque);
}

void himc_law_printed(const law_input *in, himc_vec3 torque[HIMC_JOINTS])
{
    servo(in, false, torque);
}

void himc_law_feedforward(const law_input *in, himc_vec3 torque[HIMC_JOINTS])
{
    servo(in, true, torque);
}
