/// sequence.c: read access to a sequence, and its file: the frames at 250 Hz.
#include "motion.h"

#include "himc/mocap.h"

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
