/// performance_hands.c: whose the hands are: the take's while it plays, else the planner's.
///
/// They are handed over where they are: the planner goes on from the tips' state, C2, and joint
/// targets ease from the old source to the new: exp(d) q, with d a quintic from what they differ by
/// (angle, rate and acceleration) to nothing.
#include "performance/performance_state.h"

#define EASE 0.6 // from one source of joint targets to the other (s)

bool himc_performance_tracks(const himc_performance *p, himc_hand hand)
{
    return p->track && isfinite(p->track_start) && himc_track_present(p->track, hand);
}

static bool is_over(const himc_performance *p)
{
    return step_time(p) >= p->track_start + himc_track_length(p->track);
}

void himc_performance_take_hands_back(himc_performance *p)
{
    bool tracked = false;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        if (himc_performance_tracks(p, (himc_hand)hand)) {
            himc_planner_resume(p->planner, step_time(p), (himc_hand)hand, &p->reference.tip[hand]);
            tracked = true;
        }
    p->track_start = INFINITY;
    p->ease.due = p->ease.due || tracked;
    p->replan = true;
}

bool himc_performance_lend_hand(himc_performance *p, himc_hand hand)
{
    if (himc_performance_tracks(p, hand) && is_over(p))
        himc_performance_take_hands_back(p);
    return !himc_performance_tracks(p, hand);
}

void himc_performance_forget_ease(himc_performance *p)
{
    p->ease.due = false;
    p->ease.since = -INFINITY;
}

// how the joints targets so far differ from the new ones at `t`
static void begin_ease(himc_performance *p, double t, const himc_posture_motion *now)
{
    const himc_posture_motion *before = &p->reference.posture;
    const himc_target rest = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    p->ease.due = false;
    p->ease.since = t;
    for (int j = 0; j < HIMC_JOINTS; j++) {
        himc_target d = {
            himc_quat_log(himc_quat_mul(before->joint[j], himc_quat_conj(now->joint[j]))),
            himc_vec3_sub(before->rate[j], now->rate[j]),
            himc_vec3_sub(before->acceleration[j], now->acceleration[j])};
        p->ease.off[j] = himc_quintic_make(&d, &rest, EASE);
    }
}

void himc_performance_ease(himc_performance *p, himc_setpoint *tick)
{
    himc_posture_motion *m = &tick->posture;
    if (p->ease.due && tick == &p->from)
        begin_ease(p, tick->time, m);
    if (p->ease.due || tick->time >= p->ease.since + EASE)
        return;
    for (int j = 0; j < HIMC_JOINTS; j++) {
        himc_target d = himc_quintic_at(&p->ease.off[j], tick->time - p->ease.since);
        m->joint[j] = himc_quat_mul(himc_quat_exp(d.x), m->joint[j]);
        m->rate[j] = himc_vec3_add(m->rate[j], d.v);
        m->acceleration[j] = himc_vec3_add(m->acceleration[j], d.a);
    }
}
