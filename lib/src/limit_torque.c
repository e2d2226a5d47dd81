/// limit_torque.c: a joint beyond its bounds comes back at least as fast as a critically damped
/// spring would bring it (2012 paper, section 3.1: the torque towards the nearest orientation
/// within):
///
///     n . alpha >= w^2 e - 2 w n . omega,     e n = log(q^-1 q_lim),  e the angle it is beyond
///
/// and only along n, the way back, so that it slides along its limit freely. A spring beside the
/// servo would share the error with it; an inequality wins.
///
/// Where accelerations are asked for (computed torque) they are corrected, and the arm's other
/// freedoms give the tips back what that takes: d = P J' (J P J' + lambda^2)^-1 lost, P without
/// the directions n. Where there are torques, each joint gets its own torque x n, x >= 0, such that
/// A x + a_free >= a, A_kl = n_k M^-1 n_l: a linear complementarity problem, by projected
/// Gauss-Seidel (Catto 2005). A torque that only acts inward takes energy from a joint going out.
#include "limit_torque.h"

#define BANDWIDTH 40.0  // of the way back (Hz)
#define FARTHEST 0.02   // what is beyond by more comes back no faster (rad)
#define NEGLIGIBLE 1e-9 // beyond by less is within (rad)
#define INSIDE 0.95     // a joint has to come back this far before it can hit its limit again
#define DAMPING 0.01    // lambda, of what the tips get back (m)
#define PASSES 3        // over joints that hold
#define SWEEPS 12       // of Gauss-Seidel

static void count_measure(himc_strain *strain, int j, double measure, double angle)
{
    if (!strain)
        return;
    strain->measure[j] = measure;
    strain->farthest[j] = fmax(strain->farthest[j], angle);
    if (angle > 0 && !strain->beyond[j])
        strain->hits[j]++;
    strain->beyond[j] = angle > 0 || (strain->beyond[j] && measure > INSIDE);
}

void himc_limits_meet(const himc_controller *c, const himc_skeleton *skeleton,
                      const himc_body_state *s, himc_limit_hits *hits)
{
    const double w = 2 * HIMC_PI * BANDWIDTH;
    hits->count = 0;
    for (int j = 0; c->limits && j < HIMC_JOINTS; j++) {
        int p = skeleton->segment[j + 1].parent;
        himc_quat q = himc_quat_mul(himc_quat_conj(s->orientation[p]), s->orientation[j + 1]);
        double measure = himc_limit_measure(c->limits, j, q), angle = 0;
        himc_vec3 back = {0, 0, 0};
        if (measure > 1) {
            himc_quat near = himc_limit_closest(c->limits, j, q);
            back = himc_quat_log(himc_quat_mul(near, himc_quat_conj(q)));
            angle = himc_vec3_length(back);
        }
        if (angle < NEGLIGIBLE)
            angle = 0;
        count_measure(c->strain, j, measure, angle);
        if (angle == 0)
            continue;
        himc_vec3 n = himc_mat3_apply(&s->rotation[p], himc_vec3_scale(back, 1 / angle));
        double rate = himc_vec3_dot(n, himc_vec3_sub(s->spin[j + 1], s->spin[p]));
        hits->joint[hits->count] = j;
        hits->inward[hits->count] = n;
        hits->least[hits->count++] = w * w * fmin(angle, FARTHEST) - 2 * w * rate;
    }
}

/// The joints hit, and which of them must be turned back.
typedef struct holding {
    const himc_limit_hits *hits;
    bool held[HIMC_JOINTS]; // (hits->count)
} holding;

// accelerations of the arm that move its tip so and turn no held joint along its way back
static void give_back(const holding *holding, const himc_arm_jacobian *jacobian, himc_hand hand,
                      himc_vec3 lost, himc_vec3 wanted[HIMC_JOINTS])
{
    himc_vec3 way[HIMC_ARM_JOINTS] = {{0, 0, 0}};
    himc_mat3 gram = jacobian->gram;
    for (int h = 0; h < holding->hits->count; h++)
        for (int k = 0; k < HIMC_ARM_JOINTS; k++)
            if (holding->held[h] && holding->hits->joint[h] == himc_arm_joint(hand, k))
                way[k] = holding->hits->inward[h];
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        himc_vec3 v = himc_vec3_cross(way[k], jacobian->lever[k]);
        const double b[3] = {v.x, v.y, v.z};
        for (int i = 0; i < 9; i++)
            gram.m[i / 3][i % 3] -= b[i / 3] * b[i % 3];
    }
    for (int i = 0; i < 3; i++)
        gram.m[i][i] += DAMPING * DAMPING;
    himc_mat3 inverse = himc_mat3_inverse_symmetric(&gram);
    himc_vec3 f = himc_mat3_apply(&inverse, lost);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        himc_vec3 d = himc_vec3_cross(jacobian->lever[k], f);
        d = himc_vec3_madd(d, -himc_vec3_dot(d, way[k]), way[k]);
        int j = himc_arm_joint(hand, k);
        wanted[j] = himc_vec3_add(wanted[j], d);
    }
}

// turns back those that would not turn back enough; true if one of them was not held yet
static bool hold(holding *holding, himc_vec3 wanted[HIMC_JOINTS])
{
    const himc_limit_hits *hits = holding->hits;
    bool more = false;
    for (int h = 0; h < hits->count; h++) {
        himc_vec3 *a = &wanted[hits->joint[h]], n = hits->inward[h];
        double missing = hits->least[h] - himc_vec3_dot(n, *a);
        if (missing <= 0)
            continue;
        *a = himc_vec3_madd(*a, missing, n);
        more = more || !holding->held[h];
        holding->held[h] = true;
    }
    return more;
}

void himc_limits_yield(const himc_limit_hits *hits, const himc_skeleton *skeleton,
                       const himc_body_state *s, const himc_arm_jacobian jacobian[HIMC_HANDS],
                       himc_vec3 wanted[HIMC_JOINTS])
{
    holding holding = {.hits = hits};
    himc_vec3 before[HIMC_HANDS];
    for (int hand = 0; hits->count > 0 && hand < HIMC_HANDS; hand++)
        before[hand] = himc_tip_acceleration(skeleton, s, (himc_hand)hand, wanted);
    // what is given back may turn out another joint
    for (int pass = 0; hold(&holding, wanted) && pass < PASSES; pass++)
        for (int i = 0; i < HIMC_HANDS; i++) {
            himc_hand hand = (himc_hand)i;
            himc_vec3 now = himc_tip_acceleration(skeleton, s, hand, wanted);
            himc_vec3 lost = himc_vec3_sub(before[i], now);
            give_back(&holding, &jacobian[i], hand, lost, wanted);
        }
}

/// Relative accelerations of the hit joints, each along its way back.
typedef struct response {
    double free[HIMC_JOINTS];              // under the torques as they are
    double unit[HIMC_JOINTS][HIMC_JOINTS]; // [k][l]: of k for 1 N m at l
} response;

static void probe(const himc_limit_hits *hits, const himc_skeleton *skeleton,
                  const himc_body_state *s, const himc_vec3 *torque, response *r)
{
    himc_articulation art;
    himc_vec3 relative[HIMC_JOINTS] = {{0, 0, 0}}, pushed[HIMC_JOINTS];
    himc_articulate(skeleton, s, &art);
    himc_forward_dynamics(skeleton, s, &art, torque, NULL, relative);
    for (int k = 0; k < hits->count; k++)
        r->free[k] = himc_vec3_dot(hits->inward[k], relative[hits->joint[k]]);
    for (int l = 0; l < hits->count; l++) {
        himc_vec3 *at = &pushed[hits->joint[l]];
        for (int j = 0; j < HIMC_JOINTS; j++)
            pushed[j] = torque[j];
        *at = himc_vec3_add(*at, hits->inward[l]);
        himc_forward_dynamics(skeleton, s, &art, pushed, NULL, relative);
        for (int k = 0; k < hits->count; k++)
            r->unit[k][l] = himc_vec3_dot(hits->inward[k], relative[hits->joint[k]]) - r->free[k];
    }
}

void himc_limits_resist(const himc_limit_hits *hits, const himc_skeleton *skeleton,
                        const himc_body_state *s, himc_vec3 torque[HIMC_JOINTS])
{
    response r;
    double x[HIMC_JOINTS] = {0};
    if (hits->count == 0)
        return;
    probe(hits, skeleton, s, torque, &r);
    for (int sweep = 0; sweep < SWEEPS; sweep++)
        for (int k = 0; k < hits->count; k++) {
            double missing = hits->least[k] - r.free[k];
            for (int l = 0; l < hits->count; l++)
                missing -= r.unit[k][l] * x[l];
            if (r.unit[k][k] > 0)
                x[k] = fmax(x[k] + missing / r.unit[k][k], 0);
        }
    for (int k = 0; k < hits->count; k++) {
        himc_vec3 *at = &torque[hits->joint[k]];
        *at = himc_vec3_madd(*at, x[k], hits->inward[k]);
    }
}
