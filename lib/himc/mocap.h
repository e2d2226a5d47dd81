/// mocap.h: a motion capture: named points over time in the library's frame, from BVH, C3D or TRC.
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
#ifndef HIMC_MOCAP_H
#define HIMC_MOCAP_H

#include "himc/body.h"

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

// player.h: the player of a take: how large, how heavy, in what posture in every frame, and seated
// where; from any full-body take, skeleton or markers, as far as it shows them.
//
// Joint centres are found by the names that motion capture software and laboratories use, a centre
// between two markers as their middle. A segment lies along the line between its joint centres;
// its turn about that line comes from the skeleton's frames, else from a marker beside it, else
// from the plane of the bent elbow or knee, and for forearm, hand and stick from the vertical
// plane of the stroke. An arm that is shown to its tip is then bent a little, so that its tip is
// where it was captured and its joints as near as can be, for captured limbs stretch. The
// simulated pelvis is held, so the trunk's and the thighs' rotations are those in the world.

typedef struct himc_player {
    himc_skeleton_config config; ///< the measures: the given ones where the take shows none
    int lengths;                 ///< segments measured
    char height_from[64];        ///< "legs and trunk", or "" if the height is the given one
    bool mass_said;              ///< by the file; else by the given body's mass index
    bool known[HIMC_JOINTS];     ///< joints the take shows
    himc_pose mean;              ///< default posture: means of the known, the natural ones else
    int frames;                  ///< of the take
    himc_pose *pose;    ///< (frames), owned; NULL if no joint is known. Joints not known as in mean
    bool walks;         ///< too far for a held pelvis: postures are those about the moving hips
    himc_vec3 *walk;    ///< (frames), owned: the hips from their mean (m), if they walk; NULL once
                        ///< himc_player_sit has taken it out of the take
    bool placed;        ///< the take shows where the player is: hips or shoulders
    himc_vec3 hips;     ///< between the hip joints, in the take (m); mean, or by himc_player_sit
    bool seated;        ///< himc_player_sit has put the player where config.seat and offset say
    himc_vec3 offset;   ///< to be added to the take's coordinates to make ours (m)
    char notes[8][192]; ///< what is missing or was repaired
    int note_count;
} himc_player;

/// From a take that was read with these options; `given` (its ranges checked) stands in for what
/// the take does not show. Gaps of markers up to options->longest_gap are bridged, a joint with a
/// longer one is not known and a note says where. NULL with the reason: no memory, or a player of
/// no human size.
himc_player *himc_player_new(himc_take *take, const himc_take_options *options,
                             const himc_skeleton_config *given, himc_error *error);
void himc_player_free(himc_player *player);

/// How many of an arm's joints the take shows: HIMC_ARM_JOINTS with its stick, 0 without the arm.
HIMC_RT static inline int himc_player_known_arm(const himc_player *player, himc_hand hand)
{
    int known = 0;
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        known += player->known[himc_arm_joint(hand, k)];
    return known;
}

/// Puts the player over the world's origin. One that the take places has the seat raised or lowered
/// so that the take's strikes meet a head at the drum's height; `drum` is moved under the strikes
/// where they would miss the head, or where no seat (0.3 .. 1.3 m) would do. One that it does not
/// place sits where the strikes fall on the drum's usual spot. Without strikes the one has the seat
/// that the take shows, the other sits where all of it is in reach, if there is such a place, and
/// `drum` is lowered out of the way. If the player walks, the hips' way is taken out of the take.
/// False, and nothing else changed, if the take has no tips, or a gap in them.
bool himc_player_sit(himc_player *player, himc_take *take, const himc_take_options *options,
                     himc_head_frame *drum);

/// One line per fact, for `himc info`; with `drum` (NULL if the player is not seated) where it
/// stands. A line is at most 255 characters.
void himc_player_describe(const himc_player *player, const himc_head_frame *drum,
                          void (*line)(void *, const char *), void *user);

// recording.h: what the simulated body does, kept and written as a take.
//
// A recording has the body's joints, both sticks' tips ("LeftStick_end", "RightStick_end") and the
// ends of head and toes under the names that motion capture software uses, so that it plays here
// and reads elsewhere. In a file of markers (.c3d, .trc) each segment also has one 0.05 m beside
// its joint, along the segment's y ("LeftArm_side"), so that rotations can be had from it.

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

// Playing a take that is in memory.

typedef struct himc_performance himc_performance;

/// Options for the `take` command (tips' names, up axis). Strings are borrowed until the next call.
void himc_performance_take_options(himc_performance *performance, const himc_take_options *options);

/// What the `take` command does, with a take that is in memory (borrowed); `name` begins notes and
/// errors.
bool himc_performance_play_take(himc_performance *performance, himc_take *take, const char *name,
                                himc_error *error);
/// The same with a body that the take does not show: `player`, made from the take by
/// himc_player_new, its measures since changed (within the ranges of himc_skeleton_config), is
/// seated and played; its joints' rotations stay as captured. Borrowed.
bool himc_performance_play_player(himc_performance *performance, himc_take *take,
                                  himc_player *player, const char *name, himc_error *error);
/// Added to the coordinates of the take being played to make ours (m).
himc_vec3 himc_performance_take_offset(const himc_performance *performance);

#endif
