/// performance_habit.c: a player's habit in place of the natural posture, eased in and out.
///
/// Between natural posture N and habit H lies exp(s d) N, d = log(H N^-1), with a share s that goes
/// from 0 to 1 along a quintic: so the null space is never asked to jump. Its rates are taken as if
/// d turned about one axis, which it does but for the arms' motion in that second.
#include "performance/performance_state.h"
#include "performance/research.h"

#define EASE 0.6 // from one to the other (s)

// 0 before the habit is asked for, 1 when it has taken over; with its derivatives
static himc_target share_at(const himc_performance *p, double t)
{
    himc_target from = {.x = {p->has_regression ? 0 : 1, 0, 0}},
                to = {.x = {p->has_regression, 0, 0}};
    if (t >= p->regression_since + EASE)
        return to;
    himc_quintic q = himc_quintic_make(&from, &to, EASE);
    return himc_quintic_at(&q, fmax(t - p->regression_since, 0));
}

static void blend(const himc_posture_motion *natural, himc_target share, int j,
                  himc_posture_motion *m)
{
    double s = share.x.x, ds = share.v.x, dds = share.a.x;
    himc_vec3 d = himc_quat_log(himc_quat_mul(m->joint[j], himc_quat_conj(natural->joint[j])));
    himc_vec3 faster = himc_vec3_sub(m->rate[j], natural->rate[j]);
    himc_vec3 harder = himc_vec3_sub(m->acceleration[j], natural->acceleration[j]);
    m->joint[j] = himc_quat_mul(himc_quat_exp(himc_vec3_scale(d, s)), natural->joint[j]);
    m->rate[j] = himc_vec3_madd(himc_vec3_madd(natural->rate[j], s, faster), ds, d);
    m->acceleration[j] =
        himc_vec3_madd(himc_vec3_madd(natural->acceleration[j], s, harder), 2 * ds, faster);
    m->acceleration[j] = himc_vec3_madd(m->acceleration[j], dds, d);
}

void himc_performance_follow_posture_regression(const himc_performance *p, himc_setpoint *tick)
{
    himc_target tip[HIMC_REGRESSION_OFFSETS][HIMC_HANDS], share = share_at(p, tick->time);
    if (p->controller.mode != HIMC_PIPELINE_HIMC || share.x.x <= 0)
        return;
    for (int k = 0; k < HIMC_REGRESSION_OFFSETS; k++)
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            tip[k][hand] = himc_performance_planned(p, (himc_hand)hand,
                                                    tick->time + k * HIMC_REGRESSION_OFFSET_STEP);
    himc_posture_motion natural = tick->posture;
    himc_posture_regression_moving(&p->regression, (const himc_target(*)[HIMC_HANDS])tip,
                                   &tick->posture);
    if (share.x.x < 1)
        for (int j = 0; j < HIMC_JOINTS; j++)
            blend(&natural, share, j, &tick->posture);
}

void himc_performance_fit_posture_regression(himc_performance *p)
{
    himc_pose pose;
    himc_posture held = p->posture;
    const himc_vec3 tip[HIMC_HANDS] = {p->from.tip[HIMC_LEFT].x, p->from.tip[HIMC_RIGHT].x};
    if (!p->has_regression || !p->track || !p->captured_rest_known[HIMC_TRUNK - 1])
        return;
    held.trunk_posture = p->trunk_posture;
    himc_posture_at(&held, tip, &pose);
    p->regression.player.natural_trunk = pose.joint[HIMC_TRUNK - 1];
}

void himc_performance_set_posture_regression(himc_performance *p,
                                             const himc_posture_regression *regression)
{
    double t = step_time(p);
    p->regression_of_take = false;
    if (regression)
        p->regression = *regression;
    if (p->has_regression != (regression != NULL)) {
        p->has_regression = regression != NULL;
        p->regression_since = t;
        p->replan = true;
    }
    himc_performance_fit_posture_regression(p);
}
