/// take.h: a motion capture: named points over time in the library's frame, from BVH, C3D or TRC.
///
/// A take comes in metres, z up, and turned so that the performer looks along x; its origin stays
/// where the file has it.
/// Up: HIMC_UP_* if given, else what the file says (C3D X_SCREEN, Y_SCREEN), else heads above hips
/// in the data, else the format's habit (BVH and TRC y up, C3D z up). Up y becomes (x, -z, y).
/// Heading: the body's left side to +y where hips, else shoulders, are named in pairs; else, by
/// quarter turns, the left tip left of the right one, or the tip in front of the shoulder; else as
/// it is. himc_take_describe says which.
/// A BVH's joints and end sites ("NAME_end") are points too, by forward kinematics; its skeleton
/// stays readable. Gaps are NaN; only the tips are filled. All functions are setup; a loaded take
/// may be read from any thread.
#ifndef HIMC_TAKE_H
#define HIMC_TAKE_H

#include "himc/vec.h"

typedef enum himc_up { HIMC_UP_AUTO, HIMC_UP_Y, HIMC_UP_Z } himc_up;

typedef struct himc_take_options {
    himc_up up;            ///< of the file's axes; AUTO asks the file, else guesses from the data
    const char *left_tip;  ///< name of the left stick tip's point, or NULL to look for it
    const char *right_tip; ///< the same, right
    double longest_gap;    ///< gaps of the tips up to this are filled (s) 0 .. 10, default 0.2
    double unit; ///< the file's (m) 1e-6 .. 10, or 0 (default): as the file says, or guessed
} himc_take_options;

himc_take_options himc_take_default(void);

typedef struct himc_take_event {
    char label[32]; ///< "Right Foot Strike": context and label
    double time;    ///< from the first frame (s)
} himc_take_event;

typedef struct himc_take himc_take;

/// Reads by suffix (.bvh .c3d .trc). NULL with "file: what, where, what is allowed". `options` may
/// be NULL. Rates of 20 .. 10000 Hz, up to 1000000 frames, 30000000 frames x points.
himc_take *himc_take_load(const char *path, const himc_take_options *options, himc_error *error);
/// The same from memory; `name` gives the suffix and begins the error line. The bytes are not kept.
himc_take *himc_take_read(const void *bytes, size_t size, const char *name,
                          const himc_take_options *options, himc_error *error);
void himc_take_free(himc_take *take);
/// Writes by suffix: .bvh needs a skeleton whose joints keep their offsets; .c3d and .trc have the
/// points. False with the reason, and no file, if it cannot be written completely.
bool himc_take_save(const himc_take *take, const char *path, himc_error *error);
/// Whether the suffix is one of those; the error says which are.
bool himc_take_is_writable(const char *path, himc_error *error);

double himc_take_rate(const himc_take *take);     ///< frames per second (Hz)
int himc_take_frames(const himc_take *take);      ///< at least 1
int himc_take_first_frame(const himc_take *take); ///< number the file gives its first frame
int himc_take_points(const himc_take *take);      ///< at least 1
const char *himc_take_point_name(const himc_take *take, int point);
/// Index of a point, or -1. Exact; else letters' case, punctuation and prefixes ("Daphnee:") aside,
/// the first that fits.
int himc_take_find(const himc_take *take, const char *name);
himc_vec3 himc_take_point(const himc_take *take, int frame, int point); ///< (m); NaN in a gap
int himc_take_missing(const himc_take *take, int point); ///< frames in which it is not seen
int himc_take_events(const himc_take *take);
const himc_take_event *himc_take_event_at(const himc_take *take, int index);

/// True for a BVH: its points are the nodes of a skeleton, parents before children.
bool himc_take_has_skeleton(const himc_take *take);
int himc_take_parent(const himc_take *take,
                     int point); ///< -1 for a root, and where there is no skeleton
himc_vec3 himc_take_offset(const himc_take *take,
                           int point); ///< from the parent in the zero pose (m); root: 0
/// Rotation of a joint in its parent's frame (root: in the world's), end sites: identity. Frames of
/// the joints coincide with the library's in the zero pose, which looks along x, so that world
/// rotations are products down the chain and point = parent's point + parent's world rotation of
/// the offset (unless the file moves the joint itself).
himc_quat himc_take_rotation(const himc_take *take, int frame, int point);

/// Adds white noise of this standard deviation (m) to every coordinate of the points, as a tracker
/// has; the same for the same seed. A skeleton's rotations stay as they are.
void himc_take_add_noise(himc_take *take, double deviation, uint64_t seed);

/// A hand's stick tip, gaps filled. `present` false if the take has none for that hand.
typedef struct himc_take_tip {
    bool present;
    char name[64];
    int filled; ///< frames that were interpolated, or held at the ends
    int point;  ///< of the take, which knows what it has seen of it
    himc_vec3
        *x; ///< (frames) (m), owned by the take until the next himc_take_tips or himc_take_free
} himc_take_tip;

/// Finds the stick tips by the options' names, else by theirs (RTIP, STICK_L, RightStick_end, bead,
/// ...); one hand will do, and a tip without a side is the right one. Gaps inside are bridged by
/// cubics that keep the speed at both edges, at the ends the position is held. False with the
/// reason: no tip, no point of that name, or the marker, frames and length (s) of a gap longer than
/// `longest_gap`.
bool himc_take_tips(himc_take *take, const himc_take_options *options,
                    himc_take_tip tips[HIMC_HANDS], himc_error *error);

/// A strike seen in a tip's trajectory: a fast fall that ends abruptly.
typedef struct himc_take_strike {
    himc_hand hand;
    int frame;       ///< of the lowest position, counted from 0
    double time;     ///< of the touch, between frames, from the first frame (s)
    himc_vec3 x;     ///< where (m)
    double velocity; ///< downward, just before (m/s)
    double rebound;  ///< upward, just after (m/s); 0 where the capture is too blunted to tell
} himc_take_strike;

/// Finds strikes in the tips, in order of time; writes at most `capacity`, returns how many there
/// are.
int himc_take_strikes(const himc_take *take, const himc_take_tip tips[HIMC_HANDS],
                      himc_take_strike *strikes, int capacity);
/// All of them, owned by the caller (free); NULL with a count of 0 without memory.
himc_take_strike *himc_take_find_strikes(const himc_take *take,
                                         const himc_take_tip tips[HIMC_HANDS], int *count);

/// Where a tip touches the drumhead that belongs under these strikes: the middle of both hands'
/// median places (m). Where a fall and its rebound meet is below that: on the simulated head a
/// mallet stays some 7 ms, and the head is put so high that such a contact joins the two.
/// False without strikes.
bool himc_take_strike_place(const himc_take_strike *strikes, int count, himc_vec3 *place);

/// One line per fact about the take (rate, length, points, units, axes, gaps, events, tips,
/// strikes, where the head goes), for `himc info`. A line is at most 255 characters.
void himc_take_describe(himc_take *take, const himc_take_options *options,
                        void (*line)(void *, const char *), void *user);

#endif
