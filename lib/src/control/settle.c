/// settle.c: the body knows what its arms give.
///
/// Inverse dynamics has trunk and legs carry what the arms are asked for. Arms that are too weak,
/// or hold in a contact (muscle.c), give less: then a trunk that braces against what does not come
/// is thrown about, a shoulder's 450 N m for a blow, and takes the tips and a seated pelvis along.
/// So the arms' accelerations under their true torques are found, by the sweeps of fwdyn.c over an
/// arm whose shoulder moves as wanted, and inverse dynamics is asked again with them. What the
/// pelvis then does changes the arms' torques a little: two rounds leave a fiftieth of that.
///
/// Torques that are cut joint by joint do not fit together: they whirl an arm that is nearly
/// straight, and it throws the player off his feet. So an arm that is too weak first leaves out of
/// its posture what it cannot do, the part that does not move the tip, and then does the same
/// slower: all accelerations wanted of its joints get one share. What is too much even then is cut
/// (strength.c).
#include "control/settle.h"

#include "body/dynamics.h"
#include "control/balance.h"
#include "control/ik.h"
#include "control/strength.h"
#include "control/tracking_error.h"

#include <string.h>

#define ROUNDS 2
// of what is wanted; chosen: with less, one joint that is fast and has no strength left stops all
#define LEAST_SHARE 0.3
enum { ARMS = HIMC_LEFT_UPPER_ARM - 1, ARMS_END = HIMC_LEFT_UPPER_LEG - 1 };

void himc_invert(const himc_controller *c, const himc_skeleton *skeleton, const himc_body_state *s,
                 const himc_vec3 wanted[HIMC_JOINTS], himc_vec3 torque[HIMC_JOINTS])
{
    if (c->balance)
        himc_balance_torques(c, skeleton, s, wanted, torque);
    else if (himc_joints_computed(c) < HIMC_JOINTS)
        himc_inverse_dynamics_upper(skeleton, s, c->articulation, wanted, torque);
    else
        himc_inverse_dynamics_of(skeleton, s, c->articulation, wanted, NULL, torque, NULL);
}

// the largest share of the way from a to b that is no longer than `most`, 0 .. 1
static double share_within(himc_vec3 a, himc_vec3 b, double most)
{
    himc_vec3 way = himc_vec3_sub(b, a);
    double square = himc_vec3_dot(way, way), along = himc_vec3_dot(a, way);
    double left = most * most - himc_vec3_dot(a, a);
    if (himc_vec3_length(b) <= most)
        return 1;
    return left > 0 ? (sqrt(along * along + square * left) - along) / square : 0;
}

// the largest share of the way from a to b that all joints of a hand's arm have the strength for
static double share_of_arm(himc_hand hand, const himc_vec3 a[HIMC_JOINTS],
                           const himc_vec3 b[HIMC_JOINTS], const double most[HIMC_JOINTS])
{
    double share = 1;
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        int j = himc_arm_joint(hand, k);
        share = fmin(share, share_within(a[j], b[j], most[j]));
    }
    return share;
}

// leaves out of the accelerations wanted of weak arms as much as needed of what does not move a tip
static void yield_posture(const himc_controller *c, const himc_skeleton *skeleton,
                          const himc_body_state *s, const double most[HIMC_JOINTS],
                          himc_vec3 wanted[HIMC_JOINTS], himc_vec3 asked[HIMC_JOINTS])
{
    himc_vec3 bare[HIMC_JOINTS], needed[HIMC_JOINTS], arm[HIMC_ARM_JOINTS];
    memcpy(bare, wanted, sizeof bare);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_vec3 null[HIMC_ARM_JOINTS] = {{0, 0, 0}};
        himc_arm_jacobian jacobian;
        himc_arm_jacobian_weighted(s, (himc_hand)hand, c->config.weight, &jacobian);
        himc_arm_gather(wanted, (himc_hand)hand, arm);
        himc_ik_add_null(&jacobian, arm, null);
        for (int k = 0; k < HIMC_ARM_JOINTS; k++)
            arm[k] = himc_vec3_sub(arm[k], null[k]);
        himc_arm_scatter(arm, (himc_hand)hand, bare);
    }
    himc_invert(c, skeleton, s, bare, needed);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        double share = fmax(share_of_arm((himc_hand)hand, needed, asked, most), LEAST_SHARE);
        for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
            int j = himc_arm_joint((himc_hand)hand, k);
            wanted[j] = himc_vec3_madd(bare[j], share, himc_vec3_sub(wanted[j], bare[j]));
        }
    }
    himc_invert(c, skeleton, s, wanted, asked);
}

void himc_slow_weak_arms(const himc_controller *c, const himc_skeleton *skeleton,
                         const himc_body_state *s, const double reserve[HIMC_HANDS],
                         himc_vec3 wanted[HIMC_JOINTS], himc_vec3 asked[HIMC_JOINTS])
{
    himc_vec3 steady[HIMC_JOINTS], keeps[HIMC_JOINTS];
    double most[HIMC_JOINTS];
    bool weak = false;
    memcpy(steady, wanted, sizeof steady);
    for (int j = ARMS; j < ARMS_END; j++) {
        most[j] = himc_strength_most(c, skeleton, s, j, reserve, asked[j]);
        weak |= himc_vec3_length(asked[j]) > most[j];
        steady[j] = himc_vec3_make(0, 0, 0);
    }
    if (!weak)
        return;
    if (c->config.mode == HIMC_PIPELINE_HIMC) { // else the posture is the task
        yield_posture(c, skeleton, s, most, wanted, asked);
        for (int j = ARMS; j < ARMS_END; j++)
            most[j] = himc_strength_most(c, skeleton, s, j, reserve, asked[j]);
    }
    himc_invert(c, skeleton, s, steady, keeps);
    for (int i = 0; i < HIMC_HANDS; i++) {
        double share = fmax(share_of_arm((himc_hand)i, keeps, asked, most), LEAST_SHARE);
        for (int j = ARMS + i; j < ARMS_END; j += HIMC_HANDS)
            wanted[j] = himc_vec3_scale(wanted[j], share);
    }
    himc_invert(c, skeleton, s, wanted, asked);
}

// adds what these torques at an arm's joints, and none elsewhere, make of its relative
// accelerations while the shoulder has none
static void accelerate_arm(const himc_articulation *art, himc_hand hand,
                           const himc_vec3 more[HIMC_JOINTS], himc_vec3 relative[HIMC_JOINTS])
{
    himc_vec3 needed[HIMC_ARM_JOINTS], force = {0, 0, 0}, moment = {0, 0, 0};
    for (int k = HIMC_ARM_JOINTS - 1; k >= 0; k--) {
        int j = himc_arm_joint(hand, k), i = j + 1;
        needed[k] = himc_vec3_sub(moment, more[j]);
        force = himc_vec3_sub(force, himc_mat3_apply_transposed(&art->response[i], needed[k]));
        moment = himc_vec3_add(more[j], himc_vec3_cross(art->lever[i], force));
    }
    himc_vec3 alpha = {0, 0, 0}, a = {0, 0, 0};
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        int j = himc_arm_joint(hand, k), i = j + 1;
        himc_vec3 parent = alpha;
        a = himc_vec3_add(a, himc_vec3_cross(parent, art->lever[i]));
        alpha = himc_vec3_add(himc_symmetric_apply(&art->inverse[i], needed[k]),
                              himc_mat3_apply(&art->response[i], a));
        alpha = himc_vec3_scale(alpha, -1);
        relative[j] = himc_vec3_add(relative[j], himc_vec3_sub(alpha, parent));
    }
}

void himc_settle(const himc_controller *c, const himc_skeleton *skeleton, const himc_body_state *s,
                 const double reserve[HIMC_HANDS], himc_vec3 wanted[HIMC_JOINTS],
                 const himc_vec3 asked[HIMC_JOINTS], himc_vec3 given[HIMC_JOINTS])
{
    himc_articulation own;
    himc_vec3 more[HIMC_JOINTS], now[HIMC_JOINTS];
    double missing = 0;
    for (int j = ARMS; j < ARMS_END; j++) {
        himc_vec3 less = himc_vec3_sub(asked[j], given[j]);
        missing += himc_vec3_dot(less, less);
    }
    if (missing == 0)
        return;
    const himc_articulation *art = himc_strength_articulation(c, skeleton, s, &own);
    memcpy(now, asked, sizeof now);
    for (int round = 0; round < ROUNDS; round++) {
        for (int j = ARMS; j < ARMS_END; j++)
            more[j] = himc_vec3_sub(given[j], now[j]);
        accelerate_arm(art, HIMC_LEFT, more, wanted);
        accelerate_arm(art, HIMC_RIGHT, more, wanted);
        himc_invert(c, skeleton, s, wanted, now);
    }
    for (int j = 0; j < HIMC_JOINTS; j++)
        if (j < ARMS || j >= ARMS_END) {
            given[j] = now[j];
            himc_strength_bound(c, skeleton, s, j, reserve, &given[j]);
        }
}
