/// arm.c: an arm's posture from the quantities that a player controls, and the stick's position.
///
/// The stick points from the grip to the tip at the given elevation, in the vertical plane through
/// the tip and a place a little outside and behind the shoulder; the hand is in the same plane at
/// its own elevation. With wrist and shoulder fixed the elbow can be on a circle; it is at the
/// angle `out` from the lowest place. A french grip rolls forearm, hand and stick about their
/// lengths so that the thumbs are up. Frames are those of body.h: z points back to the joint, y is
/// the axis of flexion.
#include "parts.h"
#include "base/limb_frame.h"
#include "himc/body.h"

#define THUMBS_UP 1.25 // chosen: roll of a french grip (rad)
#define BEHIND 0.08    // chosen: the stick's plane begins behind the shoulder (m) ...
#define BESIDE 0.05    // ... and outside it (m)
#define FARTHEST 0.995 // chosen: share of a straight arm that is in reach
#define NEAREST 0.02   // chosen: more than the difference of both lengths (m)

static himc_vec3 shoulder_of(const himc_skeleton *skeleton, himc_quat trunk, himc_hand hand)
{
    himc_vec3 waist = himc_skeleton_waist(skeleton);
    himc_vec3 away =
        himc_quat_rotate(trunk, skeleton->segment[HIMC_LEFT_UPPER_ARM + (int)hand].origin);
    return himc_vec3_add(waist, away);
}

// the elbow from the positions of shoulder and wrist; false if the wrist is out of reach
static bool hang_elbow(const double length[2], himc_vec3 shoulder, himc_vec3 wrist, double angle,
                       himc_vec3 *elbow)
{
    himc_vec3 d = himc_vec3_sub(wrist, shoulder);
    double apart = himc_vec3_length(d), upper = length[0], lower = length[1];
    if (apart > FARTHEST * (upper + lower) || apart < fabs(upper - lower) + NEAREST)
        return false;
    himc_vec3 u = himc_vec3_scale(d, 1 / apart);
    double along = (apart * apart + upper * upper - lower * lower) / (2 * apart);
    double away = sqrt(upper * upper - along * along);
    himc_vec3 down = himc_vec3_unit(himc_vec3_madd(himc_vec3_make(0, 0, -1), u.z, u));
    himc_vec3 out = himc_vec3_cross(down, u);
    *elbow = himc_vec3_madd(shoulder, along, u);
    *elbow = himc_vec3_madd(*elbow, away * cos(angle), down);
    *elbow = himc_vec3_madd(*elbow, away * sin(angle), out);
    return true;
}

bool himc_mocap_arm(const himc_skeleton *skeleton, himc_quat trunk, himc_hand hand,
                    const mocap_key *key, himc_quat joint[HIMC_ARM_JOINTS])
{
    const himc_segment *s = skeleton->segment;
    double side = hand == HIMC_LEFT ? 1 : -1;
    himc_vec3 shoulder = shoulder_of(skeleton, trunk, hand);
    himc_vec3 start =
        himc_vec3_add(shoulder, himc_quat_rotate(trunk, himc_vec3_make(-BEHIND, side * BESIDE, 0)));
    double azimuth = atan2(key->tip.y - start.y, key->tip.x - start.x);
    himc_vec3 stick = himc_vec3_elevated(azimuth, key->stick),
              palm = himc_vec3_elevated(azimuth, key->hand);
    himc_vec3 flexion = himc_vec3_make(-sin(azimuth), cos(azimuth), 0);
    double reach[3] = {himc_vec3_length(s[HIMC_LEFT_FOREARM].origin),
                       himc_vec3_length(s[HIMC_LEFT_HAND].origin),
                       himc_vec3_length(s[HIMC_LEFT_STICK].origin)};
    himc_vec3 grip = himc_vec3_madd(key->tip, -himc_vec3_length(skeleton->tip), stick), elbow;
    himc_vec3 wrist = himc_vec3_madd(grip, -reach[2], palm);
    if (!hang_elbow(reach, shoulder, wrist, -side * key->out, &elbow))
        return false;
    himc_vec3 upper = himc_vec3_unit(himc_vec3_sub(elbow, shoulder));
    himc_vec3 lower = himc_vec3_unit(himc_vec3_sub(wrist, elbow));
    himc_quat roll = himc_quat_exp(himc_vec3_make(0, 0, side * THUMBS_UP * key->french));
    himc_quat frame[HIMC_ARM_JOINTS + 1] = {
        trunk, himc_quat_from_limb(upper, himc_vec3_cross(lower, upper)),
        himc_quat_mul(himc_quat_from_limb(lower, flexion), roll),
        himc_quat_mul(himc_quat_from_limb(palm, flexion), roll),
        himc_quat_mul(himc_quat_from_limb(stick, flexion), roll)};
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        joint[k] = himc_quat_mul(himc_quat_conj(frame[k]), frame[k + 1]);
    return true;
}

void himc_mocap_flexion(himc_quat trunk, const himc_quat joint[HIMC_ARM_JOINTS],
                        himc_vec3 axis[HIMC_ARM_JOINTS])
{
    himc_quat q = trunk;
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        q = himc_quat_mul(q, joint[k]);
    himc_vec3 along = himc_quat_rotate(q, himc_vec3_make(0, 0, -1));
    himc_vec3 side = himc_vec3_unit(himc_vec3_make(along.y, -along.x, 0));
    q = trunk;
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        q = himc_quat_mul(q, joint[k]);
        axis[k] = himc_quat_rotate(himc_quat_conj(q), side);
    }
}

himc_vec3 himc_mocap_stick_point(const himc_skeleton *skeleton, himc_quat trunk, himc_hand hand,
                                 const himc_quat joint[HIMC_ARM_JOINTS], double back)
{
    himc_vec3 x = himc_skeleton_waist(skeleton);
    himc_quat q = trunk;
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        int segment = himc_arm_joint(hand, k) + 1;
        x = himc_vec3_add(x, himc_quat_rotate(q, skeleton->segment[segment].origin));
        q = himc_quat_mul(q, joint[k]);
    }
    double length = himc_vec3_length(skeleton->tip);
    himc_vec3 along = himc_vec3_scale(skeleton->tip, (length - back) / length);
    return himc_vec3_add(x, himc_quat_rotate(q, along));
}
