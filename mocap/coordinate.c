/// coordinate.c: from strokes to joints in time: who does how much, and when.
///
/// With s_k the share of joint k, 0 at impact and 1 at the apex, the tip's height changes by
/// dz/dt = sum_k dz/ds_k s_k'. Shoulder and elbow arrive with one rate, the grip with another, the
/// wrist with their mean; these two follow from two speeds that are measured, the mallet's and
/// that of a point behind it on the stick. So also the rebound. Invariant: the mallet is never
/// lower than where it touches: each stroke's grip is shifted by what the arm's motion during the
/// contact leaves over (a degree at most).
#include "motion.h"

#define POINT 0.15 // of the stick that is measured, behind the mallet (m)
#define READY 0.45 // share of the first apex in which the hands wait
#define WAIT 0.12  // from where they leave (s)

// time in which a joint turns from falling to rising: the stick within its contact, the heavier
// parts slower (s)
static const double turns[HIMC_ARM_JOINTS] = {0.060, 0.050, 0.022, 0.007};
// share of the grip's rate in the joint's, the rest is the elbow's
static const double distal[HIMC_ARM_JOINTS] = {0, 0, 0.15, 1};

void himc_mocap_share_out(const mocap_arm *arm, const mocap_stroke *stroke,
                          const double share[HIMC_ARM_JOINTS], himc_quat joint[HIMC_ARM_JOINTS])
{
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        himc_vec3 way = himc_vec3_sub(stroke->apex[k], stroke->impact[k]);
        himc_vec3 y = himc_vec3_madd(stroke->impact[k], share[k], way);
        joint[k] = himc_quat_mul(arm->mean[k], himc_quat_exp(y));
    }
}

// heights of a stick's point per share of each joint, at impact (m)
static void slopes(const himc_mocap *m, himc_hand hand, const mocap_stroke *stroke, double back,
                   double slope[HIMC_ARM_JOINTS])
{
    himc_quat trunk = himc_mocap_trunk(m, stroke->touch), joint[HIMC_ARM_JOINTS];
    const double small = 1e-4;
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        double z[2];
        for (int i = 0; i < 2; i++) {
            double share[HIMC_ARM_JOINTS] = {0, 0, 0, 0};
            share[k] = i ? small : -small;
            himc_mocap_share_out(&m->arm[hand], stroke, share, joint);
            z[i] = himc_mocap_stick_point(&m->skeleton, trunk, hand, joint, back).z;
        }
        slope[k] = (z[1] - z[0]) / (2 * small);
    }
}

typedef struct speeds {
    double point, mallet; // (m/s)
} speeds;

// rates of elbow and grip that give both speeds
static void solve_rates(const double point[], const double mallet[], speeds s, double rate[2])
{
    double a[2][2] = {{0, 0}, {0, 0}};
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        a[0][0] += (1 - distal[k]) * point[k];
        a[0][1] += distal[k] * point[k];
        a[1][0] += (1 - distal[k]) * mallet[k];
        a[1][1] += distal[k] * mallet[k];
    }
    double det = a[0][0] * a[1][1] - a[0][1] * a[1][0];
    rate[0] = (s.point * a[1][1] - s.mallet * a[0][1]) / det;
    rate[1] = (s.mallet * a[0][0] - s.point * a[1][0]) / det;
}

static double joint_rate(const double rate[2], int k)
{
    return rate[0] + distal[k] * (rate[1] - rate[0]);
}

static void add_stroke(himc_mocap *m, himc_hand hand, int i)
{
    mocap_arm *arm = &m->arm[hand];
    const mocap_stroke *s = &arm->stroke[i];
    const mocap_gesture *g = &s->gesture;
    double point[HIMC_ARM_JOINTS], mallet[HIMC_ARM_JOINTS], arrive[2], rebound[2];
    slopes(m, hand, s, POINT, point);
    slopes(m, hand, s, 0, mallet);
    solve_rates(point, mallet, (speeds){g->down, g->impact}, arrive);
    solve_rates(point, mallet, (speeds){g->up, g->rebound}, rebound);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        double lead = m->player->lead[k];
        mocap_share share = {.touch = s->touch,
                             .arrive = joint_rate(arrive, k),
                             .rebound = joint_rate(rebound, k),
                             .turn = turns[k],
                             .fall = g->fall + lead,
                             .lift = g->lift - lead,
                             .top = i + 1 < arm->count ? 1 : READY};
        himc_mocap_curve_stroke(&arm->share[k], &share);
    }
    himc_mocap_curve_add(&arm->loop, (mocap_knot){s->touch, 0, 0, 0});
    himc_mocap_curve_add(&arm->loop, (mocap_knot){s->touch + 0.5 * g->lift, 1, 0, 0});
    himc_mocap_curve_add(&arm->loop, (mocap_knot){s->touch + g->lift, 0, 0, 0});
}

// how far the mallet goes below the place of its touch (m)
static double sinking(const himc_mocap *m, himc_hand hand, const mocap_stroke *s)
{
    himc_quat joint[HIMC_ARM_JOINTS];
    double lowest = HUGE_VAL;
    for (int i = -50; i <= 50; i++) {
        double t = s->touch + 2e-4 * i;
        himc_mocap_arm_at(m, hand, t, joint);
        lowest = fmin(
            lowest, himc_mocap_stick_point(&m->skeleton, himc_mocap_trunk(m, t), hand, joint, 0).z);
    }
    return s->aim.z - lowest;
}

// shifts the grip in each contact so that the mallet's lowest place is on the head
static void level_touches(himc_mocap *m, himc_hand hand)
{
    mocap_arm *arm = &m->arm[hand];
    mocap_curve *grip = &arm->share[HIMC_ARM_JOINTS - 1];
    for (int i = 0; i < arm->count; i++) {
        double slope[HIMC_ARM_JOINTS];
        slopes(m, hand, &arm->stroke[i], 0, slope);
        for (int round = 0; round < 4; round++) {
            double more = sinking(m, hand, &arm->stroke[i]) / slope[HIMC_ARM_JOINTS - 1];
            grip->knot[1 + 4 * i + 1].x += more;
            grip->knot[1 + 4 * i + 2].x += more;
        }
    }
}

void himc_mocap_coordinate(himc_mocap *m)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        mocap_arm *arm = &m->arm[hand];
        for (int k = 0; k < HIMC_ARM_JOINTS; k++)
            himc_mocap_curve_add(&arm->share[k], (mocap_knot){WAIT, READY, 0, 0});
        for (int i = 0; i < arm->count; i++)
            add_stroke(m, (himc_hand)hand, i);
        level_touches(m, (himc_hand)hand);
    }
}
