/// posture_crossfade.c: exp(d) q, with q the new source's joint target and d a quintic from the
/// difference of the two sources (angle, rate, acceleration) to zero: C2 for any two sources.
/// Rates are added as if d turned about one axis, which is exact at both ends.
#include "control/posture_crossfade.h"

#include "himc/vec.h"

#define CROSSFADE_TIME 0.6 // chosen: invisible in the torques, over before a stroke (s)

void himc_posture_crossfade_begin(himc_posture_crossfade *c, double t,
                                  const himc_posture_motion *before, const himc_posture_motion *now)
{
    const himc_target rest = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    c->since = t;
    for (int j = 0; j < HIMC_JOINTS; j++) {
        himc_target d = {
            himc_quat_log(himc_quat_mul(before->joint[j], himc_quat_conj(now->joint[j]))),
            himc_vec3_sub(before->rate[j], now->rate[j]),
            himc_vec3_sub(before->acceleration[j], now->acceleration[j])};
        c->offset[j] = himc_quintic_make(&d, &rest, CROSSFADE_TIME);
    }
}

void himc_posture_crossfade_cancel(himc_posture_crossfade *c)
{
    c->since = -INFINITY;
}

void himc_posture_crossfade_apply(const himc_posture_crossfade *c, double t, himc_posture_motion *m)
{
    if (t >= c->since + CROSSFADE_TIME)
        return;
    for (int j = 0; j < HIMC_JOINTS; j++) {
        himc_target d = himc_quintic_at(&c->offset[j], t - c->since);
        m->joint[j] = himc_quat_mul(himc_quat_exp(d.x), m->joint[j]);
        m->rate[j] = himc_vec3_add(m->rate[j], d.v);
        m->acceleration[j] = himc_vec3_add(m->acceleration[j], d.a);
    }
}
