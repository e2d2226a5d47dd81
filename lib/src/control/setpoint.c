/// setpoint.c: every channel of the targets moves on a quintic from tick to tick, with one set of basis
/// values for all (interpolate.c). Legs keep their posture: only joints above the waist move.
#include "control/setpoint.h"

#include "base/interpolate.h"

static joint_state state_of(const himc_posture_motion *m, int j)
{
    return (joint_state){m->joint[j], m->rate[j], m->acceleration[j]};
}

static void interpolate_joint(const himc_interpolation *b, const himc_posture_motion *from,
                              const himc_posture_motion *to, int j, himc_posture_motion *out)
{
    joint_state p = state_of(from, j), q = state_of(to, j), s = himc_interpolate_joints(b, &p, &q);
    out->joint[j] = s.q;
    out->rate[j] = s.rate;
    out->acceleration[j] = s.acceleration;
}

void himc_setpoint_complete(himc_setpoint *tick, const himc_posture *posture)
{
    himc_posture_moving(posture, tick->tip, &tick->posture);
}

void himc_setpoint_interpolate(const himc_setpoint *from, const himc_setpoint *to, double time,
                               himc_reference *reference)
{
    himc_interpolation b = himc_interpolate_make(time - from->time, to->time - from->time);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        reference->tip[hand] = himc_interpolate_points(&b, &from->tip[hand], &to->tip[hand]);
    reference->posture = to->posture;
    for (int j = HIMC_TRUNK - 1; j < HIMC_LEFT_UPPER_LEG - 1; j++)
        interpolate_joint(&b, &from->posture, &to->posture, j, &reference->posture);
}
