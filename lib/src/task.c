/// task.c: every channel of the targets moves on a quintic from tick to tick, with one set of basis
/// values for all (between.c). Legs are held as they are: only what is above the waist moves.
#include "himc/task.h"

#include "between.h"

static joint_state state_of(const himc_posture_motion *m, int j)
{
    return (joint_state){m->joint[j], m->rate[j], m->acceleration[j]};
}

static void joint_between(const between *b, const himc_posture_motion *from,
                          const himc_posture_motion *to, int j, himc_posture_motion *out)
{
    joint_state p = state_of(from, j), q = state_of(to, j), s = himc_between_joints(b, &p, &q);
    out->joint[j] = s.q;
    out->rate[j] = s.rate;
    out->acceleration[j] = s.acceleration;
}

void himc_task_tick_complete(himc_task_tick *tick, const himc_posture *posture)
{
    himc_posture_moving(posture, tick->tip, &tick->posture);
}

void himc_task_between(const himc_task_tick *from, const himc_task_tick *to, double time,
                       himc_reference *reference)
{
    between b = himc_between_make(time - from->time, to->time - from->time);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        reference->tip[hand] = himc_between_points(&b, &from->tip[hand], &to->tip[hand]);
    reference->posture = to->posture;
    for (int j = HIMC_TRUNK - 1; j < HIMC_LEFT_UPPER_LEG - 1; j++)
        joint_between(&b, &from->posture, &to->posture, j, &reference->posture);
}
