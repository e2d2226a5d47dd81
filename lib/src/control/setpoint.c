/// setpoint.c: every channel of the targets moves on a quintic from tick to tick, with one set of
/// basis values for all (interpolate.c). What stays the same between two ticks is computed once.
/// Legs keep their posture: only the joints of trunk, neck, head and arms move.
#include "control/setpoint.h"

static joint_state state_of(const himc_posture_motion *m, int j)
{
    return (joint_state){m->joint[j], m->rate[j], m->acceleration[j]};
}

void himc_setpoint_complete(himc_setpoint *tick, const himc_posture *posture)
{
    himc_posture_moving(posture, tick->tip, &tick->posture);
}

void himc_setpoint_course_make(himc_setpoint_course *course, const himc_setpoint *from,
                               const himc_setpoint *to)
{
    course->from = from->time;
    course->length = to->time - from->time;
    course->posture = to->posture;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        course->tip[hand][0] = from->tip[hand];
        course->tip[hand][1] = to->tip[hand];
    }
    for (int j = 0; j < HIMC_MOVING_JOINTS; j++) {
        joint_state p = state_of(&from->posture, j), q = state_of(&to->posture, j);
        himc_interpolate_knots(&p, &q, course->knot[j]);
    }
}

void himc_setpoint_at(const himc_setpoint_course *course, double time, himc_reference *reference)
{
    himc_interpolation b = himc_interpolate_make(time - course->from, course->length);
    himc_posture_motion *out = &reference->posture;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        reference->tip[hand] =
            himc_interpolate_points(&b, &course->tip[hand][0], &course->tip[hand][1]);
    *out = course->posture;
    for (int j = 0; j < HIMC_MOVING_JOINTS; j++) {
        joint_state s = himc_interpolate_joint(&b, course->knot[j]);
        out->joint[j] = s.q;
        out->rate[j] = s.rate;
        out->acceleration[j] = s.acceleration;
    }
}
