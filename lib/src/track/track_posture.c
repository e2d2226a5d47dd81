/// track_posture.c: the joints of a take as targets that go with the tips.
///
/// Around each frame k the rotations q_i, as vectors log(q_i q_k^-1), are fitted like the tips
/// (track_fit.c), so joints and tips lose the same noise; quintics join the frames. The frames of
/// an arm around its own strikes are left out, as its tip's are, and bridged. There the tip's path
/// is known and the arm's is not: the path is carried on to the head before a blow and starts from
/// the measured state after it. So the arm is bent to the tip, by the rotations of least effort
///     min sum |theta_k|^2 / w_k  with  sum theta_k x r_k = e:   theta_k = w_k r_k x l,
///     (sum w_k (|r_k|^2 1 - r_k r_k')) l = e,
/// r_k the levers from the joints to the tip, w_k larger towards the stick, as a hand corrects;
/// repeated, since it is the linear part of the way. Rates come from differences of that map. In
/// the mode that follows joints as published, joints are neither cut nor bent: a second fit, of all
/// frames. An arm whose tip is the end of a finger holds no stick: bent to the tip it would be out
/// of shape, so it has the natural posture instead.
#include "track/track_state.h"
#include "track/track_time.h"

#include "base/noise.h"
#include "body/stretch.h"

#include <stdlib.h>

// bending an arm to its tip, by Gauss-Newton steps; chosen: convergence is quadratic, five steps go
// from 5 cm to rounding
#define BENDS 5              // steps ...
#define MOST_BENDS 40        // ... and more, if the tip is still ...
#define BENT_WITHIN 1e-8     // ... farther from its place (m)
#define LARGEST_BEND 0.1     // of the tip, in one step (m): the linear part of the way
#define BEND_DAMPING 1e-8    // of a straight arm (m^2): below a tenth of a millimetre
#define BEND_DIFFERENCE 5e-4 // step of the differences (s): an error of 1 mm/s at a blow

// an arm without a stick; chosen: half a stick's length
#define NO_STICK 0.15      // median distance of an arm's end from its tip (m)
#define SAMPLED_FRAMES 201 // of the take, for that median

#define LARGEST_WINDOW 512 // frames of one fit: 50 ms at 10 kHz

static int hand_of(int joint)
{
    return (joint - (HIMC_LEFT_UPPER_ARM - 1)) % 2;
}

static bool is_arm(int joint)
{
    return joint >= HIMC_LEFT_UPPER_ARM - 1;
}

// fits frames lo .. hi without any others
static void fit_stretch(const himc_track *track, const himc_pose *pose, int j, int lo, int hi,
                        joint_state *joint)
{
    fit_series series = {track->frames, track->edge, track->rate};
    himc_vec3 turned[LARGEST_WINDOW];
    for (int k = lo; k <= hi; k++) {
        fit_window w = himc_fit_window(k, lo, hi, &series);
        himc_quat middle = pose[k].joint[j], back = himc_quat_conj(middle);
        for (int i = w.first; i <= w.last; i++)
            turned[i - w.first] = himc_quat_log(himc_quat_mul(pose[i].joint[j], back));
        fit_window shifted = {0, k - w.first, w.last - w.first, w.order, w.reach};
        himc_target s = himc_fit(turned, shifted, 1 / track->rate);
        // the angular velocity is the rotation vector's rate but for half its turn,
        // w = v + r x v / 2
        himc_vec3 half = himc_vec3_scale(s.x, 0.5);
        joint[k] = (joint_state){himc_quat_unit(himc_quat_mul(himc_quat_exp(s.x), middle)),
                                 himc_vec3_add(s.v, himc_vec3_cross(half, s.v)),
                                 himc_vec3_add(s.a, himc_vec3_cross(half, s.a))};
    }
}

bool himc_track_fit_postures(himc_track *track, const himc_player *player)
{
    for (int j = 0; j < TRACK_JOINTS; j++) {
        const hand_track *h = is_arm(j) ? &track->hand[hand_of(j)] : NULL;
        if (!player->pose || !player->known[j] || (h && !h->present))
            continue;
        size_t size = (size_t)track->frames * sizeof(joint_state);
        joint_state *joint = track->joints.joint[j] = malloc(size);
        joint_state *uncut = track->joints.uncut[j] = h ? malloc(size) : NULL;
        if (!joint || (h && !uncut))
            return false;
        track->joints.known[j] = true;
        // an arm stretch by stretch, as its tip is cut; other joints in one
        int lo = 0, last = track->frames - 1;
        for (int i = 0; h && i < h->bridge_count; i++) {
            fit_stretch(track, player->pose, j, lo, h->built[i].last, joint);
            lo = h->built[i].next;
        }
        fit_stretch(track, player->pose, j, lo, last, joint);
        if (uncut)
            fit_stretch(track, player->pose, j, 0, last, uncut);
        track->joints.before[j] = (joint_state){.q = joint[0].q};
    }
    himc_skeleton skeleton;
    if (!player->pose || !himc_skeleton_init(&skeleton, &player->config, NULL))
        return !player->pose;
    // an arm that is not all known is empty if it ends elsewhere than its tip in most frames
    for (int i = 0; i < HIMC_HANDS; i++) {
        himc_hand hand = (himc_hand)i;
        int known = himc_player_known_arm(player, hand);
        double off[SAMPLED_FRAMES];
        if (!track->hand[hand].present || known == 0 || known == HIMC_ARM_JOINTS)
            continue;
        for (int k = 0; k < SAMPLED_FRAMES; k++) {
            int f = (int)((double)(track->frames - 1) * k / (SAMPLED_FRAMES - 1));
            himc_arm_levers arm = himc_arm_levers_of(&skeleton, himc_skeleton_waist(&skeleton),
                                                     &player->pose[f], hand);
            himc_vec3 tip = track->hand[hand].frame[f].x;
            off[k] = himc_vec3_length(himc_vec3_sub(arm.at[HIMC_ARM_JOINTS], tip));
        }
        track->joints.empty[hand] = himc_median(off, SAMPLED_FRAMES) > NO_STICK;
    }
    return true;
}

void himc_track_free_postures(himc_track *track)
{
    for (int j = 0; j < TRACK_JOINTS; j++) {
        free(track->joints.joint[j]);
        free(track->joints.uncut[j]);
    }
}

bool himc_track_has_posture(const himc_track *track)
{
    for (int j = 0; j < TRACK_JOINTS; j++)
        if (track->joints.known[j])
            return true;
    return false;
}

// at `t` of the take itself; the gap that does not end before it is found by bisection
static joint_state captured_joint(const himc_track *track, int j, double t, bool cut)
{
    const joint_state *joint = is_arm(j) && !cut ? track->joints.uncut[j] : track->joints.joint[j];
    double u = fmin(fmax(t * track->rate, 0), track->frames - 1);
    int from = u < track->frames - 2 ? (int)u : track->frames - 2, to = from + 1;
    const hand_track *h = is_arm(j) && cut ? &track->hand[hand_of(j)] : NULL;
    int lo = 0, hi = h ? h->bridge_count : 0;
    while (lo < hi) {
        int mid = (lo + hi) / 2;
        if (h->built[mid].next > u)
            hi = mid;
        else
            lo = mid + 1;
    }
    if (h && lo < h->bridge_count && h->built[lo].last <= u) {
        from = h->built[lo].last;
        to = h->built[lo].next;
    }
    return himc_interpolate_joints((u - from) / track->rate, (to - from) / track->rate,
                                   &joint[from], &joint[to]);
}

// with the approach before the first frame, and the halt after a stop
static joint_state played_joint(const himc_track *track, int j, double t, bool cut)
{
    double approach =
        fmax(track->hand[HIMC_LEFT].approach_time, track->hand[HIMC_RIGHT].approach_time);
    double taken = fmin(t, track->stop), since = taken + 0.5 * HIMC_TRACK_RAMP + approach, at[3];
    joint_state s;
    if (taken < -0.5 * HIMC_TRACK_RAMP && approach > 0) {
        joint_state first = {.q = track->joints.joint[j][0].q};
        s = himc_interpolate_joints(fmax(since, 0), approach, &track->joints.before[j], &first);
    } else {
        himc_track_warp(himc_track_take_length(track), taken, at);
        s = captured_joint(track, j, at[0], cut);
        s.acceleration =
            himc_vec3_madd(himc_vec3_scale(s.acceleration, at[1] * at[1]), at[2], s.rate);
        s.rate = himc_vec3_scale(s.rate, at[1]);
    }
    if (t < track->stop)
        return s;
    himc_vec3 way = himc_vec3_scale(s.rate, HIMC_TRACK_HALT_WAY * HIMC_TRACK_HALT);
    joint_state rest = {.q = himc_quat_mul(himc_quat_exp(way), s.q)};
    return himc_interpolate_joints(fmin(t - track->stop, HIMC_TRACK_HALT), HIMC_TRACK_HALT, &s,
                                   &rest);
}

void himc_track_approach_posture(himc_track *track, const himc_posture_motion *now)
{
    for (int j = 0; j < TRACK_JOINTS; j++)
        track->joints.before[j] = (joint_state){now->joint[j], now->rate[j], now->acceleration[j]};
}

// one step; returns the tip's distance from its place before it (m)
static double bend_once(const himc_skeleton *skeleton, himc_hand hand, himc_vec3 tip,
                        himc_pose *pose)
{
    // chosen: a hand corrects a stick more than a shoulder does
    static const double share[HIMC_ARM_JOINTS] = {0.1, 0.2, 0.5, 1};
    himc_arm_levers a = himc_arm_levers_of(skeleton, himc_skeleton_waist(skeleton), pose, hand);
    himc_vec3 e = himc_vec3_sub(tip, a.at[HIMC_ARM_JOINTS]);
    double far = himc_vec3_length(e);
    if (far > LARGEST_BEND)
        e = himc_vec3_scale(e, LARGEST_BEND / far);
    himc_mat3 gram = {{{BEND_DAMPING, 0, 0}, {0, BEND_DAMPING, 0}, {0, 0, BEND_DAMPING}}};
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        double r[3] = {a.lever[k].x, a.lever[k].y, a.lever[k].z};
        double square = himc_vec3_dot(a.lever[k], a.lever[k]);
        for (int i = 0; i < 3; i++)
            for (int n = 0; n < 3; n++)
                gram.m[i][n] += share[k] * ((i == n ? square : 0) - r[i] * r[n]);
    }
    himc_mat3 inverse = himc_mat3_inverse_symmetric(&gram);
    himc_vec3 l = himc_mat3_apply(&inverse, e);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        himc_quat *q = &pose->joint[himc_arm_joint(hand, k)];
        himc_vec3 turn = himc_vec3_scale(himc_vec3_cross(a.lever[k], l), share[k]);
        turn = himc_quat_rotate(himc_quat_conj(a.frame[k]), turn);
        *q = himc_quat_unit(himc_quat_mul(himc_quat_exp(turn), *q));
    }
    return far;
}

void himc_track_posture(const himc_track *track, const himc_skeleton *skeleton, double t,
                        const himc_target tip[HIMC_HANDS], himc_posture_motion *motion)
{
    for (int j = 0; j < TRACK_JOINTS; j++) {
        if (!track->joints.known[j] || (tip && is_arm(j) && track->joints.empty[hand_of(j)]))
            continue;
        joint_state s = played_joint(track, j, t, tip != NULL);
        motion->joint[j] = s.q;
        motion->rate[j] = s.rate;
        motion->acceleration[j] = s.acceleration;
    }
    if (!tip)
        return;
    // the joints a little before, now and after at constant acceleration, the arms bent to the tips
    // of that time, or as near as they reach
    himc_pose bent[3];
    for (int i = 0; i < 3; i++) {
        himc_pose *pose = &bent[i];
        double dt = (i - 1) * BEND_DIFFERENCE;
        for (int j = 0; j < HIMC_JOINTS; j++)
            pose->joint[j] = himc_posture_joint_after(motion, j, dt);
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            himc_hand of = (himc_hand)hand;
            himc_vec3 shoulder = himc_shoulder(skeleton, pose->joint[HIMC_TRUNK - 1], of);
            himc_target asked = {.x = himc_target_after(&tip[hand], dt).x};
            himc_vec3 to = himc_stretch_towards(&asked, shoulder, himc_stretch(skeleton, of)).x;
            double far = INFINITY;
            for (int k = 0; k < BENDS || (k < MOST_BENDS && far > BENT_WITHIN); k++)
                far = bend_once(skeleton, of, to, pose);
        }
    }
    himc_posture_differentiate(bent, BEND_DIFFERENCE, HIMC_LEFT_UPPER_ARM - 1, TRACK_JOINTS,
                               motion);
}
