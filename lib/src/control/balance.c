/// balance.c: a player whose pelvis is free, on a stool or on his feet (stand.c).
///
/// The joints' relative accelerations are wanted; that of the pelvis is not in anyone's hand. With
/// W0 the wrench that they need while the pelvis does not accelerate and F the wrench of seat and
/// floor now, the six equations of the whole body,
///     F = W0 + I a,   I: inertia of the body as if rigid,
/// give the pelvis' acceleration a, and inverse dynamics with a gives torques: so arms and tips
/// move as wanted however the pelvis sways. The supports' torques at the joints, J' f, are taken
/// off.
///
/// So seat and floor carry what they can, within their friction, and no solver asks them for more:
/// what they do not carry, the pelvis sways by. The legs' joints have soft servos.
#include "control/balance.h"

#include <string.h>

#define LEG_BANDWIDTH 3.0 // (Hz); chosen: a relaxed leg

void himc_balance_feel(himc_balance *b, const himc_support *support, const himc_skeleton *skeleton,
                       const himc_body_state *s)
{
    himc_spatial *all = &b->carried;
    memset(b->felt, 0, sizeof b->felt);
    *all = (himc_spatial){{0, 0, 0}, {0, 0, 0}};
    for (int i = 0; i < HIMC_SUPPORTS; i++) {
        const himc_support_point *p = &support->point[i];
        if (!p->touching)
            continue;
        himc_add_force(skeleton, s, p->segment, himc_vec3_add(s->origin[0], p->lever), p->force,
                       b->felt);
        all->linear = himc_vec3_add(all->linear, p->force);
        all->angular = himc_vec3_add(all->angular, himc_vec3_cross(p->lever, p->force));
    }
    himc_stand_feel(&b->stand, support, skeleton, s);
}

himc_spatial himc_balance_accelerate(const himc_balance *b, const himc_skeleton *skeleton,
                                     const himc_body_state *s, const himc_articulation *art,
                                     const himc_vec3 torque[HIMC_JOINTS],
                                     const himc_vec3 *tip_force, himc_vec3 relative[HIMC_JOINTS])
{
    himc_vec3 all[HIMC_JOINTS];
    himc_spatial root;
    for (int j = 0; b && j < HIMC_JOINTS; j++)
        all[j] = himc_vec3_add(torque[j], b->felt[j]);
    himc_forward_dynamics_of(skeleton, s, art, b ? all : torque, tip_force, b ? &b->carried : NULL,
                             relative, &root);
    return root;
}

void himc_balance_legs(himc_balance *b, const himc_body_state *s, const tracking_error *e,
                       double step, himc_vec3 wanted[HIMC_JOINTS])
{
    double w = 2 * HIMC_PI * LEG_BANDWIDTH;
    for (int j = HIMC_LEFT_UPPER_LEG - 1; j < HIMC_LEFT_TOES - 1; j++)
        wanted[j] = himc_vec3_madd(himc_vec3_madd(e->acceleration[j], w * w, e->angle[j]), 2 * w,
                                   e->rate[j]);
    if (b->stand.standing)
        himc_stand_legs(&b->stand, s, b->acceleration.angular, step, wanted);
}

/// The whole body as if rigid, about the pelvis' origin.
typedef struct whole_body {
    double mass;            // (kg)
    himc_vec3 center;       // (m)
    himc_symmetric inertia; // about the centre (kg m^2)
} whole_body;

static void add_point(himc_symmetric *t, double mass, himc_vec3 r)
{
    double square = mass * himc_vec3_dot(r, r);
    t->xx += square;
    t->yy += square;
    t->zz += square;
    himc_add_square(t, -mass, r);
}

static whole_body whole(const himc_skeleton *skeleton, const himc_body_state *s,
                        const himc_articulation *art)
{
    whole_body w = {.mass = 0};
    for (int i = 0; i < HIMC_SEGMENTS; i++) {
        const himc_segment *segment = &skeleton->segment[i];
        himc_vec3 c = art ? art->center[i] : himc_mat3_apply(&s->rotation[i], segment->center);
        himc_symmetric t =
            art ? art->inertia[i] : himc_world_tensor(&s->rotation[i], segment->inertia);
        himc_vec3 r = himc_vec3_add(himc_vec3_sub(s->origin[i], s->origin[0]), c);
        add_point(&t, segment->mass, r);
        w.mass += segment->mass;
        w.center = himc_vec3_madd(w.center, segment->mass, r);
        w.inertia = (himc_symmetric){w.inertia.xx + t.xx, w.inertia.xy + t.xy, w.inertia.xz + t.xz,
                                     w.inertia.yy + t.yy, w.inertia.yz + t.yz, w.inertia.zz + t.zz};
    }
    w.center = himc_vec3_scale(w.center, 1 / w.mass);
    add_point(&w.inertia, -w.mass, w.center);
    return w;
}

// I^-1 f
static himc_spatial yield_to(const whole_body *w, const himc_spatial *f)
{
    himc_symmetric inverse = himc_symmetric_inverse(&w->inertia);
    himc_vec3 moment = himc_vec3_sub(f->angular, himc_vec3_cross(w->center, f->linear));
    himc_vec3 angular = himc_symmetric_apply(&inverse, moment);
    return (himc_spatial){angular, himc_vec3_sub(himc_vec3_scale(f->linear, 1 / w->mass),
                                                 himc_vec3_cross(angular, w->center))};
}

void himc_balance_torques(const himc_controller *c, const himc_skeleton *skeleton,
                          const himc_body_state *s, const himc_vec3 wanted[HIMC_JOINTS],
                          himc_vec3 torque[HIMC_JOINTS])
{
    himc_balance *b = c->balance;
    himc_spatial needed;
    himc_inverse_dynamics_of(skeleton, s, c->articulation, wanted, NULL, torque, &needed);
    whole_body w = whole(skeleton, s, c->articulation);
    needed.linear = himc_vec3_sub(b->carried.linear, needed.linear);
    needed.angular = himc_vec3_sub(b->carried.angular, needed.angular);
    b->acceleration = yield_to(&w, &needed);
    himc_inverse_dynamics_of(skeleton, s, c->articulation, wanted, &b->acceleration, torque, NULL);
    for (int j = 0; j < HIMC_JOINTS; j++)
        torque[j] = himc_vec3_sub(torque[j], b->felt[j]);
}
