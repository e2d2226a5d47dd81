/// recording.h: what the simulated body does, kept and written as a take.
///
/// A recording has the body's joints, both sticks' tips ("LeftStick_end", "RightStick_end") and the
/// ends of head and toes under the names that motion capture software uses, so that it plays here
/// and reads elsewhere. In a file of markers (.c3d, .trc) each segment also has one 0.05 m beside
/// its joint, along the segment's y ("LeftArm_side"), so that rotations can be had from it.
#ifndef HIMC_RECORDING_H
#define HIMC_RECORDING_H

#include "himc/pose.h"
#include "himc/take.h"

typedef struct himc_recording himc_recording;

/// Makes room for `longest` seconds of the body `skeleton` (copied) at `rate` (Hz, 20 .. 10000).
/// `path` ends in .bvh, .c3d or .trc and must be writable. NULL with the reason.
himc_recording *himc_recording_new(const char *path, const himc_skeleton *skeleton, double rate,
                                   double longest, himc_error *error);
/// Frees it; what has not been written is lost.
void himc_recording_free(himc_recording *recording);

/// Keeps one frame; false when there is no more room.
HIMC_RT bool himc_recording_add(himc_recording *recording, const himc_body_state *state);
/// Frames kept.
HIMC_RT int himc_recording_frames(const himc_recording *recording);
const char *himc_recording_path(const himc_recording *recording);

/// The take so far, to be freed by the caller; NULL if there are no frames or no memory.
himc_take *himc_recording_take(const himc_recording *recording, himc_error *error);
/// Writes the file. The recording may go on.
bool himc_recording_write(const himc_recording *recording, himc_error *error);

#endif
