/// sequence.c: a sequence at any time, and its file: the frames at 250 Hz.
///
/// Each stroke has a posture of its impact and one of its apex, y_i and y_a, rotation vectors
/// about the arm's mean posture; joint k is at exp(y_i + s_k (y_a - y_i) + loop + drift), where
/// its share s_k of the stroke runs from 1 to 0 and back in its own time. From one stroke to the
/// next both postures pass smoothly over, while the arm rises. Invariant: at an impact all shares
/// are 0 and nothing is added, so the tip is where the stroke was aimed, on the head.
#include "motion.h"

#include "himc/mocap.h"

// all chosen (README.md)
#define BLEND 0.04        // time after the impact at which the next stroke's postures begin (s)
#define LEAN_MORE 1.3     // lean of the trunk towards strike places beyond the usual one (rad/m)
#define JOINT_DRIFT 0.003 // of a joint between impacts (rad)
#define TRUNK_DRIFT 0.003 // (rad)

static himc_quat trunk_rotation(double turn, double lean)
{
    return himc_quat_mul(himc_quat_exp(himc_vec3_make(0, 0, turn)),
                         himc_quat_exp(himc_vec3_make(0, lean, 0)));
}

static double mean_lean(const himc_mocap *m)
{
    double usual = himc_mocap_spot(HIMC_SPOT_NORMAL);
    return m->player->lean + LEAN_MORE * (himc_mocap_spot(m->config.spot) - usual);
}

himc_quat himc_mocap_trunk_mean(const himc_mocap *m)
{
    return trunk_rotation(0, mean_lean(m));
}

himc_quat himc_mocap_trunk(const himc_mocap *m, double t)
{
    double sway = m->player->sway, loose = TRUNK_DRIFT * m->player->looseness;
    double left = 0.5, right = 0.5;
    if (m->arm[HIMC_LEFT].effort.count && m->arm[HIMC_RIGHT].effort.count) {
        left = himc_mocap_curve_at(&m->arm[HIMC_LEFT].effort, t);
        right = himc_mocap_curve_at(&m->arm[HIMC_RIGHT].effort, t);
    }
    return trunk_rotation(sway * (left - right) + loose * himc_mocap_wander_at(&m->turn, t),
                          mean_lean(m) - 0.5 * sway * (left + right - 1) +
                              0.5 * loose * himc_mocap_wander_at(&m->lean, t));
}

// the stroke before `t`, and how far its postures have passed over to the next one's
static int stroke_at(const mocap_arm *arm, double t, double *passed)
{
    int i = 0;
    while (i + 1 < arm->count && arm->stroke[i + 1].touch <= t)
        i++;
    *passed = 0;
    if (i + 1 < arm->count && t > arm->stroke[i].touch) {
        double from = arm->stroke[i].touch + BLEND;
        double to = arm->stroke[i + 1].touch - arm->stroke[i + 1].gesture.fall;
        double u = fmin(fmax((t - from) / (to - from), 0), 1);
        *passed = u * u * u * (10 + u * (6 * u - 15));
    }
    return i;
}

void himc_mocap_arm_at(const himc_mocap *m, himc_hand hand, double t,
                       himc_quat joint[HIMC_ARM_JOINTS])
{
    const mocap_arm *arm = &m->arm[hand];
    double passed, loop = himc_mocap_curve_at(&arm->loop, t);
    int i = stroke_at(arm, t, &passed);
    const mocap_stroke *a = &arm->stroke[i], *b = &arm->stroke[i + (i + 1 < arm->count)];
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        double s = himc_mocap_curve_at(&arm->share[k], t),
               w = JOINT_DRIFT * m->player->looseness * s;
        himc_vec3 low =
            himc_vec3_madd(himc_vec3_scale(a->impact[k], 1 - passed), passed, b->impact[k]);
        himc_vec3 high =
            himc_vec3_madd(himc_vec3_scale(a->apex[k], 1 - passed), passed, b->apex[k]);
        himc_vec3 y = himc_vec3_madd(low, s, himc_vec3_sub(high, low));
        const mocap_wander *n = arm->wander[k];
        y = himc_vec3_madd(y, loop, a->loop[k]);
        y = himc_vec3_add(y, himc_vec3_make(w * himc_mocap_wander_at(&n[0], t),
                                            w * himc_mocap_wander_at(&n[1], t),
                                            w * himc_mocap_wander_at(&n[2], t)));
        joint[k] = himc_quat_mul(arm->mean[k], himc_quat_exp(y));
    }
}

himc_pose himc_mocap_pose(const himc_mocap *m, double t)
{
    himc_pose pose = m->rest;
    himc_quat joint[HIMC_ARM_JOINTS];
    t = fmin(fmax(t * m->config.pace, 0), m->length);
    pose.joint[HIMC_TRUNK - 1] = himc_mocap_trunk(m, t);
    himc_quat nod =
        himc_quat_exp(himc_vec3_make(0, 2 * TRUNK_DRIFT * himc_mocap_wander_at(&m->nod, t), 0));
    pose.joint[HIMC_NECK - 1] = himc_quat_mul(pose.joint[HIMC_NECK - 1], nod);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_mocap_arm_at(m, (himc_hand)hand, t, joint);
        for (int k = 0; k < HIMC_ARM_JOINTS; k++)
            pose.joint[himc_arm_joint((himc_hand)hand, k)] = joint[k];
    }
    return pose;
}

const char *himc_mocap_player_name(int player)
{
    return himc_mocap_player[player].name;
}

const himc_skeleton *himc_mocap_skeleton(const himc_mocap *m)
{
    return &m->skeleton;
}

himc_vec3 himc_mocap_drum(const himc_mocap *m)
{
    return himc_vec3_make(m->player->edge + himc_mocap_spot(HIMC_SPOT_CENTER), 0, HIMC_MOCAP_HEAD);
}

double himc_mocap_length(const himc_mocap *m)
{
    return m->length / m->config.pace;
}

int himc_mocap_frames(const himc_mocap *m)
{
    return 1 + (int)floor(himc_mocap_length(m) * HIMC_MOCAP_RATE);
}

int himc_mocap_touches(const himc_mocap *m)
{
    return m->config.strokes;
}

himc_mocap_touch himc_mocap_touch_at(const himc_mocap *m, int index)
{
    himc_hand hand = index % 2 ? HIMC_LEFT : HIMC_RIGHT;
    double t = m->arm[hand].stroke[index / 2].touch;
    himc_quat joint[HIMC_ARM_JOINTS];
    himc_mocap_arm_at(m, hand, t, joint);
    himc_quat trunk = himc_mocap_trunk(m, t);
    himc_vec3 x = himc_mocap_stick_point(&m->skeleton, trunk, hand, joint, 0);
    return (himc_mocap_touch){hand, t / m->config.pace, x};
}

bool himc_mocap_write(const himc_mocap *mocap, const char *path, himc_error *error)
{
    int frames = himc_mocap_frames(mocap);
    const himc_skeleton *skeleton = himc_mocap_skeleton(mocap);
    double longest = (frames + 1) / HIMC_MOCAP_RATE;
    himc_recording *r = himc_recording_new(path, skeleton, HIMC_MOCAP_RATE, longest, error);
    for (int i = 0; r && i < frames; i++) {
        himc_pose pose = himc_mocap_pose(mocap, i / HIMC_MOCAP_RATE);
        himc_body_state state;
        himc_pose_to_state(skeleton, &pose, NULL, &state);
        himc_recording_add(r, &state);
    }
    bool ok = r && himc_recording_write(r, error);
    himc_recording_free(r);
    return ok;
}
