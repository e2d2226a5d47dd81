/// recording.c: poses in memory, converted to a take when they are written.
///
/// A frame is the rotation of each joint in its parent's frame, in single precision: 1e-7 rad over
/// an arm is a tenth of a micrometre. All memory is reserved in advance, so that keeping a frame is
/// only a copy. Invariant: a take's points are the skeleton's segments in their order, then the two
/// tips, then the ends of head and toes, without which a BVH would not contain their rotations. A
/// file of markers has no rotations; there each segment has another marker beside its joint, which
/// with the one at its far end determines the rotation.
#define _POSIX_C_SOURCE 200809L

#include "base/file.h"
#include "base/array.h"
#include "capture/take.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#define ENDS 3
#define POINTS (HIMC_SEGMENTS + HIMC_HANDS + ENDS)
#define MARKERS (POINTS + HIMC_SEGMENTS)
#define BESIDE 0.05 // chosen: of a marker beside its joint, along the segment's y (m)

typedef struct frame {
    float q[HIMC_JOINTS][4];
} frame;

struct himc_recording {
    char *path; ///< owned
    himc_skeleton skeleton;
    double rate;
    int count, room; ///< frames kept, and most
    frame *frames;   ///< owned (room)
};

// clang-format off
static const char *const names[POINTS] = {
    "Hips", "Spine", "Neck", "Head", "LeftArm", "RightArm", "LeftForeArm", "RightForeArm",
    "LeftHand", "RightHand", "LeftStick", "RightStick", "LeftUpLeg", "RightUpLeg", "LeftLeg",
    "RightLeg", "LeftFoot", "RightFoot", "LeftToeBase", "RightToeBase", "LeftStick_end",
    "RightStick_end", "Head_end", "LeftToeBase_end", "RightToeBase_end",
};
// clang-format on

// segments without a child segment, except the sticks
static const int ends[ENDS] = {HIMC_HEAD, HIMC_LEFT_TOES, HIMC_RIGHT_TOES};

// the far end of a segment, in its frame
static himc_vec3 far_end(const himc_skeleton *skeleton, int segment)
{
    return himc_vec3_scale(skeleton->segment[segment].axis, skeleton->segment[segment].length);
}

bool himc_recording_may_replace(const char *path, himc_error *error)
{
    if (access(path, F_OK) != 0)
        return true;
    himc_take *there = himc_take_load(path, NULL, NULL);
    bool good = there && there->points == (there->parents ? POINTS : MARKERS);
    for (int i = 0; good && i < POINTS; i++)
        good = himc_take_find(there, names[i]) >= 0;
    himc_take_free(there);
    return good || himc_error_set(error,
                                  "%s: not a recording, and a score overwrites no other file; "
                                  "expected another name",
                                  path);
}

himc_recording *himc_recording_new(const char *path, const himc_skeleton *skeleton, double rate,
                                   double longest, himc_error *error)
{
    himc_file_draft draft;
    if (!himc_check_range("rate", rate, 20, 10000, "Hz", error) ||
        !himc_take_can_save(path, error) || !himc_file_draft_open(&draft, path, error))
        return NULL;
    himc_file_draft_drop(&draft); // the contents of an existing file stay until it is written
    himc_recording *r = calloc(1, sizeof *r);
    if (r) {
        r->skeleton = *skeleton;
        r->rate = rate;
        r->room = (int)fmin(longest * rate, TAKE_MOST_FRAMES);
        r->path = strdup(path);
        r->frames = calloc((size_t)r->room, sizeof *r->frames);
    }
    if (r && r->path && r->frames)
        return r;
    himc_recording_free(r);
    himc_error_set(error, "%s: no memory for %g s", path, longest);
    return NULL;
}

void himc_recording_free(himc_recording *r)
{
    if (!r)
        return;
    free(r->path);
    free(r->frames);
    free(r);
}

bool himc_recording_add(himc_recording *r, const himc_body_state *state)
{
    if (r->count == r->room)
        return false;
    himc_pose pose = himc_pose_from_state(&r->skeleton, state);
    frame *f = &r->frames[r->count++];
    for (int j = 0; j < HIMC_JOINTS; j++) {
        himc_quat q = pose.joint[j];
        memcpy(f->q[j], (float[4]){(float)q.w, (float)q.x, (float)q.y, (float)q.z}, sizeof f->q[j]);
    }
    return true;
}

int himc_recording_frames(const himc_recording *r)
{
    return r->count;
}

const char *himc_recording_path(const himc_recording *r)
{
    return r->path;
}

static himc_vec3 on_segment(const himc_body_state *state, int i, himc_vec3 x)
{
    return himc_vec3_add(state->origin[i], himc_mat3_apply(&state->rotation[i], x));
}

himc_take *himc_recording_take(const himc_recording *r, himc_error *error)
{
    himc_take *take = himc_new(sizeof *take, r->path, error);
    if (!take)
        return NULL;
    snprintf(take->file, sizeof take->file, "%.180s", r->path);
    snprintf(take->format, sizeof take->format, "recording");
    const char *dot = strrchr(r->path, '.');
    bool has_skeleton = dot && strcasecmp(dot, ".bvh") == 0;
    int points = has_skeleton ? POINTS : MARKERS;
    if (!himc_take_allocate(take, r->rate, r->count, points, has_skeleton, error)) {
        himc_take_free(take);
        return NULL;
    }
    for (int i = 0; i < points; i++) {
        char name[32];
        int side = i - POINTS, tip = i - HIMC_SEGMENTS, end = tip - HIMC_HANDS;
        int n = snprintf(name, sizeof name, "%s%s", names[side >= 0 ? side : i],
                         side >= 0 ? "_side" : "");
        himc_take_set_name(take, i, name, (size_t)n);
        if (!has_skeleton)
            continue;
        take->parents[i] = end >= 0   ? ends[end]
                           : tip >= 0 ? HIMC_LEFT_STICK + tip
                                      : r->skeleton.segment[i].parent;
        take->offsets[i] = i == 0     ? himc_vec3_make(0, 0, 0)
                           : end >= 0 ? far_end(&r->skeleton, ends[end])
                           : tip >= 0 ? r->skeleton.tip
                                      : r->skeleton.segment[i].origin;
    }
    for (int index = 0; index < r->count; index++) {
        himc_pose pose;
        himc_body_state state;
        for (int j = 0; j < HIMC_JOINTS; j++) {
            const float *q = r->frames[index].q[j];
            pose.joint[j] = himc_quat_unit((himc_quat){q[0], q[1], q[2], q[3]});
        }
        himc_pose_to_state(&r->skeleton, &pose, NULL, &state);
        himc_vec3 *x = himc_take_at(take, index, 0);
        memcpy(x, state.origin, sizeof state.origin);
        memcpy(x + HIMC_SEGMENTS, state.tip, sizeof state.tip);
        for (int i = 0; i < ENDS; i++)
            x[POINTS - ENDS + i] = on_segment(&state, ends[i], far_end(&r->skeleton, ends[i]));
        for (int i = 0; i < HIMC_SEGMENTS && !has_skeleton; i++)
            x[POINTS + i] = on_segment(&state, i, himc_vec3_make(0, BESIDE, 0));
        himc_quat *rotation = has_skeleton ? take->rotations + (size_t)index * POINTS : NULL;
        for (int i = 0; i < POINTS && has_skeleton; i++)
            rotation[i] = i > 0 && i < HIMC_SEGMENTS ? pose.joint[i - 1] : himc_quat_identity();
    }
    return take;
}

bool himc_recording_write(const himc_recording *r, himc_error *error)
{
    himc_take *take = himc_recording_take(r, error);
    bool written = take && himc_take_save(take, r->path, error);
    himc_take_free(take);
    return written;
}
