/// coordinate.c: from strokes to joints over time: the share of each joint and its timing.
///
/// With s_k the share of joint k, 0 at impact and 1 at the apex, the tip's height changes by
/// dz/dt = sum_k dz/ds_k s_k'. Shoulder and elbow arrive with one rate, the grip with another, the
/// wrist with their mean; these two follow from two speeds that are measured, the mallet's and
/// that of a point behind it on the stick. The same holds for the rebound. The mallet comes
/// straight to the head; felt and head give way, and it leaves them CONTACT later, having been some
/// 0.3 v CONTACT deeper. Meanwhile the rest of the arm goes on, and the grip's rates compensate for
/// that. Invariant: at the touch the mallet is where it was aimed: each stroke's grip is shifted by
/// the error that the arm's motion leaves (a degree at most).
#include "motion.h"
#include "himc/body.h"

#define READY 0.45     // chosen: share of the first apex at which the hands wait
#define GRIP 3         // index of the arm's joint
#define LEAVE 0.12     // chosen: time at which they leave (s)
#define CONTACT 0.0075 // of a felt mallet with the simulated head (s)
#define SMALL 1e-4     // difference of a share for numerical slopes
#define LEVEL_ROUNDS 4 // chosen: of the shift of the grip, which converges

// chosen: times before and after the impact in which a joint reverses from falling to rising: the
// stick within its contact, the heavier parts slower and later (s)
static const double reversals[HIMC_ARM_JOINTS][2] = {
    {0.025, 0.035}, {0.020, 0.030}, {0.008, 0.014}, {0, CONTACT}};
// chosen: share of the grip's rate in the joint's; the rest is the elbow's
static const double distal[HIMC_ARM_JOINTS] = {0, 0, 0.15, 1};

// an arm's joints for given shares of the stroke between impact and apex
static void joints_at(const mocap_arm *arm, const mocap_stroke *stroke,
                      const double share[HIMC_ARM_JOINTS], himc_quat joint[HIMC_ARM_JOINTS])
{
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        himc_vec3 stroke_k = himc_vec3_sub(stroke->apex[k], stroke->impact[k]);
        himc_vec3 y = himc_vec3_madd(stroke->impact[k], share[k], stroke_k);
        joint[k] = himc_quat_mul(arm->mean[k], himc_quat_exp(y));
    }
}

// change of height of a stick's point per share of each joint, at impact (m)
static void slopes(const himc_mocap *m, himc_hand hand, const mocap_stroke *stroke, double back,
                   double slope[HIMC_ARM_JOINTS])
{
    himc_quat trunk = himc_mocap_trunk(m, stroke->touch), joint[HIMC_ARM_JOINTS];
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        double z[2];
        for (int i = 0; i < 2; i++) {
            double share[HIMC_ARM_JOINTS] = {0, 0, 0, 0};
            share[k] = i ? SMALL : -SMALL;
            joints_at(&m->arm[hand], stroke, share, joint);
            z[i] = himc_mocap_stick_point(&m->skeleton, trunk, hand, joint, back).z;
        }
        slope[k] = (z[1] - z[0]) / (2 * SMALL);
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

static void share_stroke(const himc_mocap *m, const mocap_stroke *s,
                         double slope[2][HIMC_ARM_JOINTS], mocap_share share[HIMC_ARM_JOINTS])
{
    const mocap_gesture *g = &s->gesture;
    double arrive[2], rebound[2];
    solve_rates(slope[0], slope[1], (speeds){g->down, g->impact}, arrive);
    solve_rates(slope[0], slope[1], (speeds){g->up, g->rebound}, rebound);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        double lead = m->player->lead[k];
        share[k] = (mocap_share){.touch = s->touch,
                                 .arrive = joint_rate(arrive, k),
                                 .rebound = joint_rate(rebound, k),
                                 .reversal = {reversals[k][0], reversals[k][1]},
                                 .fall = g->fall + lead,
                                 .lift = g->lift - lead,
                                 .top = 1};
    }
}

// the grip's share and its rate that put the mallet at height z with speed v at `t` from the touch,
// given the rest of the arm
static mocap_knot grip_at(const mocap_arm *arm, const double mallet[HIMC_ARM_JOINTS],
                          const mocap_share *share, double t, double z, double v)
{
    double now = share[GRIP].touch + t;
    for (int k = 0; k < GRIP; k++) {
        z -= mallet[k] * himc_mocap_curve_at(&arm->share[k], now);
        v -= mallet[k] * himc_mocap_reversal_rate(&share[k], t);
    }
    return (mocap_knot){now, z / mallet[GRIP], v / mallet[GRIP], 0};
}

// the mallet goes straight to the head and, after the contact, straight away: while the arm
// reverses, the fingers compensate
static void add_grip(mocap_arm *arm, const mocap_gesture *g, const double mallet[HIMC_ARM_JOINTS],
                     const mocap_share *share)
{
    const mocap_share *own = &share[GRIP];
    mocap_curve *curve = &arm->share[GRIP];
    double begin = -reversals[0][0], end = reversals[0][1];
    mocap_knot knot[4] = {
        grip_at(arm, mallet, share, begin, -begin * g->impact, -g->impact),
        grip_at(arm, mallet, share, 0, 0, -g->impact),
        grip_at(arm, mallet, share, CONTACT, 0, g->rebound),
        grip_at(arm, mallet, share, end, (end - CONTACT) * g->rebound, g->rebound)};
    double fall = own->fall + begin, lift = own->lift - end;
    knot[0].a = himc_mocap_soften(own->arrive, &fall);
    knot[3].a = himc_mocap_soften(own->rebound, &lift);
    himc_mocap_curve_add(curve, (mocap_knot){knot[0].t - fall, 1, 0, 0});
    for (int i = 0; i < 4; i++)
        himc_mocap_curve_add(curve, knot[i]);
    himc_mocap_curve_add(curve, (mocap_knot){knot[3].t + lift, own->top, 0, 0});
}

static void add_stroke(himc_mocap *m, himc_hand hand, int i)
{
    mocap_arm *arm = &m->arm[hand];
    const mocap_stroke *s = &arm->stroke[i];
    double slope[2][HIMC_ARM_JOINTS];
    mocap_share share[HIMC_ARM_JOINTS];
    slopes(m, hand, s, MOCAP_POINT, slope[0]);
    slopes(m, hand, s, 0, slope[1]);
    share_stroke(m, s, slope, share);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        share[k].top = i + 1 < arm->count ? 1 : READY;
    for (int k = 0; k < GRIP; k++)
        himc_mocap_curve_stroke(&arm->share[k], &share[k]);
    add_grip(arm, &s->gesture, slope[1], share);
    himc_mocap_curve_add(&arm->loop, (mocap_knot){s->touch, 0, 0, 0});
    himc_mocap_curve_add(&arm->loop, (mocap_knot){s->touch + 0.5 * s->gesture.lift, 1, 0, 0});
    himc_mocap_curve_add(&arm->loop, (mocap_knot){s->touch + s->gesture.lift, 0, 0, 0});
}

// depth of the mallet below its aim at the touch (m)
static double sinking(const himc_mocap *m, himc_hand hand, const mocap_stroke *s)
{
    himc_quat joint[HIMC_ARM_JOINTS];
    himc_mocap_arm_at(m, hand, s->touch, joint);
    himc_quat trunk = himc_mocap_trunk(m, s->touch);
    return s->aim.z - himc_mocap_stick_point(&m->skeleton, trunk, hand, joint, 0).z;
}

// shifts the grip in each contact so that the mallet touches on the head
static void level_touches(himc_mocap *m, himc_hand hand)
{
    mocap_arm *arm = &m->arm[hand];
    for (int i = 0; i < arm->count; i++) {
        mocap_stroke *s = &arm->stroke[i];
        mocap_knot *grip = &arm->share[GRIP].knot[1 + MOCAP_GRIP_KNOTS * i];
        double slope[HIMC_ARM_JOINTS];
        slopes(m, hand, s, 0, slope);
        for (int round = 0; round < LEVEL_ROUNDS; round++) {
            double more = sinking(m, hand, s) / slope[GRIP];
            for (int k = 1; k < MOCAP_GRIP_KNOTS - 1; k++)
                grip[k].x += more;
        }
    }
}

void himc_mocap_coordinate(himc_mocap *m)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        mocap_arm *arm = &m->arm[hand];
        for (int k = 0; k < HIMC_ARM_JOINTS; k++)
            himc_mocap_curve_add(&arm->share[k], (mocap_knot){LEAVE, READY, 0, 0});
        for (int i = 0; i < arm->count; i++)
            add_stroke(m, (himc_hand)hand, i);
        level_touches(m, (himc_hand)hand);
    }
}
