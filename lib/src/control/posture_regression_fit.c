/// habit_meet.c: what takes say of a player: the means about which a habit moves (rotations.h), and
/// the measures.
#include "control/posture_regression_terms.h"

#include "base/rotations.h"

#define LOW 0.02 // places that near the lowest are strikes (m)

int himc_posture_regression_known_frames(const himc_posture_regression_take *take)
{
    return take->frames - 1 - (int)ceil((TAPS - 1) * HIMC_REGRESSION_STEP * take->rate);
}

bool himc_posture_regression_check(const himc_posture_regression_take *take, himc_error *error)
{
    if (!himc_check_range("habit: rate of a take", take->rate, 20, 10000, "Hz", error))
        return false;
    if (himc_posture_regression_known_frames(take) < 2 * TERMS)
        return himc_error_set(error, "habit: a take of %d frames, allowed %d or more", take->frames,
                              take->frames - himc_posture_regression_known_frames(take) +
                                  2 * TERMS);
    for (int i = 0; i < take->frames; i++)
        for (int j = 0; j < HIMC_JOINTS; j++) {
            himc_quat q = take->pose[i].joint[j];
            if (!(fabs(himc_quat_dot(q, q) - 1) < 1e-3))
                return himc_error_set(error, "habit: %s in frame %d: not a rotation",
                                      himc_joint_name(j), i);
        }
    return true;
}

// all of the takes do
static bool show_arm(const himc_posture_regression_take *take, int count, int hand)
{
    bool all = true;
    for (int n = 0; n < count; n++)
        all = all && !take[n].hides[hand];
    return all;
}

static himc_quat mean_rotation(const himc_posture_regression_take *take, int count, int joint)
{
    himc_rotations all = {{0}};
    for (int n = 0; n < count; n++)
        for (int i = 0; i < take[n].frames; i++)
            himc_rotations_add(&all, take[n].pose[i].joint[joint]);
    return himc_rotations_mean(&all);
}

himc_vec3 himc_posture_regression_tip(const himc_skeleton *skeleton, const himc_pose *pose,
                                      himc_hand hand)
{
    himc_vec3 x = skeleton->tip;
    for (int i = himc_stick_segment(hand); i > 0; i = skeleton->segment[i].parent)
        x = himc_vec3_add(skeleton->segment[i].origin, himc_quat_rotate(pose->joint[i - 1], x));
    return himc_vec3_add(skeleton->root, x);
}

static void meet_hand(himc_posture_regression_player *player,
                      const himc_posture_regression_take *take, int count, himc_hand hand)
{
    const himc_skeleton *skeleton = take->skeleton;
    himc_vec3 sum = {0, 0, 0};
    double frames = 0;
    for (int n = 0; n < count; frames += take[n++].frames)
        for (int i = 0; i < take[n].frames; i++) {
            const himc_pose *pose = &take[n].pose[i];
            himc_vec3 x = himc_posture_regression_tip(skeleton, pose, hand);
            sum = himc_vec3_add(sum,
                                himc_posture_regression_seen(player->waist, pose->joint[TRUNK], x));
        }
    player->tip[hand] = himc_vec3_scale(sum, 1 / frames);
    player->reach[hand] = himc_vec3_length(skeleton->tip);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        player->joint[hand][k] = skeleton->segment[himc_arm_joint(hand, k) + 1].origin;
        if (k > 0)
            player->reach[hand] += himc_vec3_length(player->joint[hand][k]);
    }
}

// where a hand strikes: the mean of the lowest places its tip comes to (m)
static himc_vec3 lowest_places(const himc_posture_regression_take *take, int count, himc_hand hand)
{
    double low = INFINITY, weight = 0;
    himc_vec3 sum = {0, 0, 0};
    for (int pass = 0; pass < 2; pass++)
        for (int n = 0; n < count; n++)
            for (int i = 0; i < take[n].frames; i++) {
                himc_vec3 x = himc_posture_regression_tip(take->skeleton, &take[n].pose[i], hand);
                low = pass == 0 ? fmin(low, x.z) : low;
                if (pass == 1 && x.z < low + LOW) {
                    sum = himc_vec3_add(sum, x);
                    weight++;
                }
            }
    return himc_vec3_scale(sum, 1 / weight);
}

// the trunk as himc_posture_trunk has it for the places that a player strikes
static himc_quat usual_bearing(const himc_posture_regression_take *take, int count)
{
    himc_posture posture;
    himc_pose pose;
    himc_vec3 place[HIMC_HANDS];
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        place[hand] = lowest_places(take, count, (himc_hand)hand);
    himc_posture_init(&posture, take->skeleton, 0);
    posture.trunk_posture = himc_posture_trunk(place, HIMC_GRIP_GERMAN);
    himc_posture_at(&posture, place, &pose);
    return pose.joint[TRUNK];
}

bool himc_posture_regression_fit(himc_posture_regression_player *player,
                                 const himc_posture_regression_take *take, int count,
                                 himc_error *error)
{
    if (count < 1)
        return himc_error_set(error, "habit: no take of a player, allowed 1 or more");
    for (int n = 0; n < count; n++)
        if (!himc_posture_regression_check(&take[n], error))
            return false;
    for (int j = 0; j < HIMC_JOINTS; j++)
        player->mean.joint[j] = mean_rotation(take, count, j);
    player->waist = himc_vec3_add(take->skeleton->root, take->skeleton->segment[HIMC_TRUNK].origin);
    player->trunk = true;
    for (int n = 0; n < count; n++)
        player->trunk = player->trunk && !take[n].hides_trunk;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        player->arm[hand] = show_arm(take, count, hand);
        player->trunk = player->trunk && player->arm[hand];
        meet_hand(player, take, count, (himc_hand)hand);
    }
    player->stick = take->skeleton->tip;
    player->usual = usual_bearing(take, count);
    return true;
}
