/// player_fit.c: captured limbs stretch by a centimetre or two, since centres of joints are guessed
/// from outside; a body's do not. So an arm's posture, as the directions of its limbs have it, is
/// turned by the least that brings its own elbow, wrist and grip nearest to the captured centres
/// and its tip onto the captured one (global optimisation, Lu & O'Connor 1999):
///     min sum_p w_p |x_p + J_p theta - c_p|^2 + s |theta|^2
/// with theta the rotations at the four joints, by Gauss-Newton. The tip weighs most, being what
/// is played. Invariant: a take of this library's own body comes back as it was.
#include "capture/player_pose.h"

#include <lapacke.h>

#define ANGLES (3 * HIMC_ARM_JOINTS)
#define STEPS 5     // of Gauss-Newton: quadratic, from some centimetres
#define TIP 1e4     // weight of the tip, those of the centres being 1
#define STILL 1e-4  // what a rotation costs (m^2): centimetres go first
#define LARGEST 0.1 // miss that one step looks at (m)

typedef struct arm {
    himc_quat parent[HIMC_ARM_JOINTS];     // of what a joint hangs on
    himc_vec3 at[HIMC_ARM_JOINTS + 1];     // the joints and the tip (m)
    himc_vec3 center[HIMC_ARM_JOINTS + 1]; // where they were captured (m)
} arm;

static void place_arm(const himc_skeleton *skeleton, const himc_pose *pose, himc_vec3 waist,
                      himc_hand hand, arm *a)
{
    himc_quat q = pose->joint[HIMC_TRUNK - 1];
    himc_vec3 at = waist;
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        int j = himc_arm_joint(hand, k);
        a->at[k] = at = himc_vec3_add(at, himc_quat_rotate(q, skeleton->segment[j + 1].origin));
        a->parent[k] = q;
        q = himc_quat_mul(q, pose->joint[j]);
    }
    a->at[HIMC_ARM_JOINTS] = himc_vec3_add(at, himc_quat_rotate(q, skeleton->tip));
}

// adds w J'J and w J'e of one point, which hangs on the first `joints` joints
static void add_point(const arm *a, int joints, double weight, double *matrix, double *right)
{
    himc_vec3 e = himc_vec3_sub(a->center[joints], a->at[joints]);
    double far = himc_vec3_length(e);
    e = himc_vec3_scale(e, far > LARGEST ? LARGEST / far : 1);
    for (int k = 0; k < joints; k++) {
        himc_vec3 r = himc_vec3_sub(a->at[joints], a->at[k]), turn = himc_vec3_cross(r, e);
        double f[3] = {turn.x, turn.y, turn.z};
        for (int i = 0; i < 3; i++)
            right[3 * k + i] += weight * f[i];
        for (int l = 0; l < joints; l++) { // (theta x s)' (theta x r): s.r 1 - r s'
            himc_vec3 s = himc_vec3_sub(a->at[joints], a->at[l]);
            double rr[3] = {r.x, r.y, r.z}, ss[3] = {s.x, s.y, s.z}, dot = himc_vec3_dot(r, s);
            for (int i = 0; i < 3; i++)
                for (int n = 0; n < 3; n++)
                    matrix[ANGLES * (3 * k + i) + 3 * l + n] +=
                        weight * ((i == n ? dot : 0) - ss[i] * rr[n]);
        }
    }
}

static void turn_arm(const arm *a, himc_hand hand, const double *theta, himc_pose *pose)
{
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        himc_quat *q = &pose->joint[himc_arm_joint(hand, k)];
        himc_vec3 turn = himc_vec3_make(theta[3 * k], theta[3 * k + 1], theta[3 * k + 2]);
        turn = himc_quat_rotate(himc_quat_conj(a->parent[k]), turn);
        *q = himc_quat_unit(himc_quat_mul(himc_quat_exp(turn), *q));
    }
}

static void fit_arm(const himc_skeleton *skeleton, himc_vec3 waist, himc_hand hand,
                    const himc_vec3 center[HIMC_ARM_JOINTS + 1], himc_pose *pose)
{
    arm a;
    for (int k = 0; k <= HIMC_ARM_JOINTS; k++)
        a.center[k] = center[k];
    for (int step = 0; step < STEPS; step++) {
        double matrix[ANGLES * ANGLES] = {0}, theta[ANGLES] = {0};
        place_arm(skeleton, pose, waist, hand, &a);
        for (int joints = 1; joints <= HIMC_ARM_JOINTS; joints++)
            add_point(&a, joints, joints < HIMC_ARM_JOINTS ? 1 : TIP, matrix, theta);
        for (int i = 0; i < ANGLES; i++)
            matrix[ANGLES * i + i] += STILL;
        if (LAPACKE_dposv(LAPACK_ROW_MAJOR, 'U', ANGLES, 1, matrix, ANGLES, theta, 1) != 0)
            return;
        turn_arm(&a, hand, theta, pose);
    }
}

void himc_player_fit_arms(himc_player *player, const player_points *points,
                          const himc_skeleton *skeleton)
{
    himc_vec3 waist = himc_vec3_add(player->hips, skeleton->segment[HIMC_TRUNK].origin);
    for (int i = 0; i < HIMC_HANDS && player->placed && !player->walks; i++) {
        himc_hand hand = (himc_hand)i;
        bool shown = true;
        for (int k = 0; k < HIMC_ARM_JOINTS; k++)
            shown = shown && player->known[himc_arm_joint(hand, k)];
        for (int frame = 0; shown && frame < points->frames; frame++) {
            himc_vec3 center[HIMC_ARM_JOINTS + 1];
            for (int k = 0; k <= HIMC_ARM_JOINTS; k++)
                center[k] = points->x[POINT_SHOULDER + HIMC_HANDS * k + i][frame];
            fit_arm(skeleton, waist, hand, center, &player->pose[frame]);
        }
    }
}
