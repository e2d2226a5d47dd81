/// write.c: a sequence as a file: its frames at 250 Hz.
#include "mocap.h"

#include "himc/recording.h"

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
