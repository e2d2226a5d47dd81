/// law_computed_torque.c: the law `computed-torque`: alpha = q''_t + 2 w (q'_t - q') + w^2 dq,
/// torques by inverse dynamics.
///
/// The engine moves with the velocity at a step's end, so its velocities are those of half a step
/// before their positions: computed torque wants q'_t - h/2 q''_t. Without it a tip lags by
/// h a / w, 0.01 mm in a roll.
#include "base/rotations.h"
#include "body/dynamics.h"
#include "control/balance.h"

#include <string.h>
#include "control/ik.h"
#include "control/law.h"
#include "control/limit_torque.h"

// stiffness and damping over inertia of one axis, as far as an implicit step lets them act
static void implicit_rates(double ks, double kd, double step, double rate[2])
{
    double all = 1 + step * kd + step * step * ks;
    rate[0] = ks / all;
    rate[1] = (kd + step * ks) / all;
}

void himc_law_computed_torque(const law_input *in, himc_vec3 wanted[HIMC_JOINTS])
{
    const himc_controller *c = in->controller;
    tracking_error *e = in->error;
    himc_vec3 arm[HIMC_ARM_JOINTS], soft[HIMC_JOINTS];
    // q''_t + 2 w (q'_t - h/2 q''_t - q') + w^2 dq; w^2 and 2 w are those of the bandwidth or,
    // where the user has set gains, those over the inertia
    for (int j = 0; j < himc_joints_computed(c); j++) {
        double w = 2 * HIMC_PI * c->config.bandwidth, x[2], y[2], z[2];
        e->rate[j] = himc_vec3_madd(e->rate[j], -0.5 * c->step, e->acceleration[j]);
        himc_vec3 angle = himc_vec3_scale(e->angle[j], w * w);
        himc_vec3 feedback = himc_vec3_madd(angle, 2 * w, e->rate[j]);
        // the bandwidth is always slow beside the step, gains need not be
        if (c->config.gain_set[j]) {
            himc_vec3 i = c->inertia[j], ks = c->gain[j].stiffness, kd = c->gain[j].damping;
            const himc_mat3 *r = &in->state->rotation[j + 1];
            implicit_rates(ks.x / i.x, kd.x / i.x, c->step, x);
            implicit_rates(ks.y / i.y, kd.y / i.y, c->step, y);
            implicit_rates(ks.z / i.z, kd.z / i.z, c->step, z);
            angle = himc_mat3_scale_along(r, himc_vec3_make(x[0], y[0], z[0]), e->angle[j]);
            himc_vec3 damping = himc_vec3_make(x[1], y[1], z[1]);
            feedback = himc_vec3_add(angle, himc_mat3_scale_along(r, damping, e->rate[j]));
        }
        wanted[j] = himc_vec3_add(e->acceleration[j], feedback);
    }
    // a seated player's legs are relaxed where the user has set no gains
    if (c->balance) {
        memcpy(soft, wanted, sizeof soft);
        himc_balance_legs(c->balance, in->state, e, c->step, soft);
        for (int j = 0; j < HIMC_JOINTS; j++)
            wanted[j] = c->config.gain_set[j] ? wanted[j] : soft[j];
    }
    // in contact the tip has the hand's acceleration along the normal, for any gains of the joints
    for (int i = 0; i < HIMC_HANDS; i++) {
        himc_hand hand = (himc_hand)i;
        if (!in->reference->released[hand])
            continue;
        himc_vec3 n = in->reference->normal[hand];
        himc_vec3 a = himc_vec3_scale(n, in->reference->yield[hand]);
        himc_vec3 left = himc_vec3_sub(a, himc_tip_carried(in->skeleton, in->state, hand, wanted,
                                                           himc_pelvis_acceleration(c)));
        himc_arm_gather(wanted, hand, arm);
        himc_ik_release(&in->jacobian[hand], n, himc_vec3_dot(n, left), arm);
        himc_arm_scatter(arm, hand, wanted);
    }
    himc_limits_compliance(c, in->skeleton, in->state, in->jacobian, wanted);
}
