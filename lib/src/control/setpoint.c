/// setpoint.c: every channel of the targets moves on a quintic from tick to tick, with one set of
/// powers of the time for all joints (interpolate.c). What stays the same between two ticks is
/// computed once. Legs keep their posture; those that work a pedal come to the second tick with its
/// rate and acceleration.
#include "control/setpoint.h"

static joint_state state_of(const himc_posture_motion *m, int j)
{
    return (joint_state){m->joint[j], m->rate[j], m->acceleration[j]};
}

bool himc_setpoint_finite(const himc_setpoint *tick)
{
    // doubles only; x - x is NaN if x is not finite, and so is the sum
    const double *number = (const double *)tick;
    double sum = 0;
    for (size_t i = 0; i < sizeof *tick / sizeof *number; i++)
        sum += number[i] - number[i];
    return sum == 0;
}

void himc_setpoint_course_make(himc_setpoint_course *course, const himc_setpoint *from,
                               const himc_setpoint *to)
{
    double length = to->time - from->time;
    course->from = from->time;
    course->to = to->time;
    course->posture = to->posture;
    course->legs = false;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        course->tip[hand] = himc_quintic_make(&from->tip[hand], &to->tip[hand], length);
    for (int lane = 0; lane < HIMC_JOINT_LANES; lane++) {
        int j = lane < HIMC_MOVING_JOINTS ? lane : 0;
        joint_state p = state_of(&from->posture, j), q = state_of(&to->posture, j);
        himc_joint_course(&p, &q, length, &course->joints, lane);
    }
}

void himc_setpoint_at(const himc_setpoint_course *course, double time, himc_reference *reference)
{
    double t = time - course->from;
    himc_powers powers = himc_powers_at(t);
    himc_posture_motion *out = &reference->posture;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        reference->tip[hand] = himc_quintic_at(&course->tip[hand], t);
    for (int j = HIMC_MOVING_JOINTS; j < HIMC_JOINTS; j++) {
        const himc_posture_motion *p = &course->posture;
        double late = time - course->to;
        out->joint[j] = course->legs ? himc_posture_joint_after(p, j, late) : p->joint[j];
        out->rate[j] =
            course->legs ? himc_vec3_madd(p->rate[j], late, p->acceleration[j]) : p->rate[j];
        out->acceleration[j] = p->acceleration[j];
    }
    joint_states now;
    himc_joint_courses_at(&course->joints, &powers, &now);
    for (int j = 0; j < HIMC_MOVING_JOINTS; j++) {
        out->joint[j] = (himc_quat){now.q[0][j], now.q[1][j], now.q[2][j], now.q[3][j]};
        out->rate[j] = himc_vec3_make(now.rate[0][j], now.rate[1][j], now.rate[2][j]);
        out->acceleration[j] =
            himc_vec3_make(now.acceleration[0][j], now.acceleration[1][j], now.acceleration[2][j]);
    }
}
