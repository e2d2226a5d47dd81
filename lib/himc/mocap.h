/// mocap.h: motion capture. Second tier.
///
/// A take is a capture that was read from a file (BVH, C3D, TRC): named points over time. A player
/// is the person in a take: measures, poses, seat. A recording keeps the motion of the simulated
/// body and writes it as a take. Last come the functions that play a take by a performance.
///
/// All functions are setup except those marked HIMC_RT. Objects made by a _new or _load function
/// are freed by their _free function, which accepts NULL. A take may be read from any thread.
#ifndef HIMC_MOCAP_H
#define HIMC_MOCAP_H

#include "himc/body.h"

HIMC_BEGIN

/// Time (s) from the sticks' place at `play` to the first frame of a take.
#define HIMC_APPROACH 1.0

// Takes.
//
// The points are in metres, z up, and rotated so that the performer faces along x; the origin stays
// where the file has it. Up axis: HIMC_UP_* if given, else as the file states (C3D X_SCREEN,
// Y_SCREEN), else heads above hips in the data, else as usual in the format (BVH and TRC y up, C3D
// z up). Up y becomes (x, -z, y). Heading: the body's left side to +y if hips, else shoulders, are
// named in pairs; else, by quarter turns, the left tip left of the right one, or the tip in front
// of the shoulder; else as in the file. himc_take_describe says which.
//
// A BVH's joints and end sites ("NAME_end") are points too, by forward kinematics; the skeleton can
// be read beside them. Gaps are NaN; only the tips are filled.

/// Up axis of a file.
typedef enum himc_up {
    HIMC_UP_AUTO, ///< as the file states, else found in the data, else as usual in the format
    HIMC_UP_Y,    ///< y up: (x, y, z) of the file becomes (x, -z, y)
    HIMC_UP_Z     ///< z up
} himc_up;

/// How a file is read.
typedef struct himc_take_options {
    himc_up up;            ///< default HIMC_UP_AUTO
    const char *left_tip;  ///< name of the point at the left stick's tip, or NULL to look for it
    const char *right_tip; ///< the same, right
    const char *subject;   ///< of several in a file: "Ida" of "Ida:RTIP", a root of a BVH; or NULL
    double longest_gap;    ///< longer gaps of the tips are errors (s) 0 .. 10, default 0.2
    double unit; ///< length unit of the file (m) 1e-6 .. 10; 0 (default): as stated, or guessed
} himc_take_options;

/// Up axis and unit as the file states, tips by their usual names, gaps of the tips up to 0.2 s.
himc_take_options himc_take_default(void);

/// A capture: points over time, and of a BVH a skeleton. Opaque.
typedef struct himc_take himc_take;

/// Reads a file by its suffix (.bvh .c3d .trc .csv .tsv). `options` may be NULL. NULL with the error "file:
/// what, value, what is allowed". Limits: rates of 20 .. 10000 Hz, 1000000 frames, 30000000 frames
/// x points.
himc_take *himc_take_load(const char *path, const himc_take_options *options, himc_error *error);
/// Frees the take and all that it owns.
void himc_take_free(himc_take *take);
/// Writes a file by its suffix: .bvh needs a skeleton with fixed offsets; .c3d and .trc get the
/// points. False with the reason, and no file, if it cannot be written completely.
bool himc_take_save(const himc_take *take, const char *path, himc_error *error);

double himc_take_rate(const himc_take *take);     ///< frames per second (Hz)
int himc_take_frames(const himc_take *take);      ///< number of frames, at least 1
int himc_take_first_frame(const himc_take *take); ///< number of the first frame in the file
int himc_take_points(const himc_take *take);      ///< number of points, at least 1
/// Name of point 0 .. points - 1, owned by the take.
const char *himc_take_point_name(const himc_take *take, int point);
/// Index of a point by its name, or -1. An exact match is preferred; else the first name that is
/// equal without case, punctuation and prefix ("Daphnee:").
int himc_take_find(const himc_take *take, const char *name);
/// Position in frame 0 .. frames - 1 (m); NaN in a gap.
himc_vec3 himc_take_point(const himc_take *take, int frame, int point);

/// True for a BVH: its points are the nodes of a skeleton, parents before children.
bool himc_take_has_skeleton(const himc_take *take);
/// Index of the parent; -1 for a root, and without skeleton.
int himc_take_parent(const himc_take *take, int point);
/// Offset from the parent in the zero pose (m); 0 for a root.
himc_vec3 himc_take_offset(const himc_take *take, int point);
/// Rotation of a joint in its parent's frame (root: in the world); identity for end sites. In the
/// zero pose, which faces along x, the joints' frames coincide with the library's. So world
/// rotations are products along the chain, and point = parent's point + parent's world rotation of
/// the offset (unless the file moves the joint itself).
himc_quat himc_take_rotation(const himc_take *take, int frame, int point);

/// Adds white noise to every coordinate of the points, like that of a tracker: standard deviation
/// `deviation` (m), the same noise for the same seed. A skeleton's rotations stay as they are.
void himc_take_add_noise(himc_take *take, double deviation, uint64_t seed);

/// One line per fact about the take (rate, length, points, units, axes, gaps, events, tips,
/// strikes, place of the drum), for `himc info`. A line is at most 255 characters; `line` gets
/// `user` and the line.
void himc_take_describe(himc_take *take, const himc_take_options *options,
                        void (*line)(void *, const char *), void *user);

// Stick tips, and the strikes seen in them.

/// A hand's stick tip.
typedef struct himc_take_tip {
    bool present;  ///< false if the take has no tip for this hand; then the rest is 0
    char name[64]; ///< of the point
    int filled;    ///< frames in gaps that were interpolated, or held at the ends
    int point;     ///< index of the point in the take, whose gaps stay
    /// (frames) (m), gaps filled; owned by the take, valid until the next himc_take_tips or
    /// himc_take_free
    himc_vec3 *x;
} himc_take_tip;

/// Finds the stick tips by the names in the options (may be NULL), else by usual names (RTIP,
/// STICK_L, RightStick_end, bead, ...). One hand is enough, and a tip without a side is the right
/// one. Gaps inside the take are bridged by cubics that keep the velocity at both edges; at the
/// ends the position is held. False with the reason: no tip, no point of that name, or a gap longer
/// than `longest_gap` with its frames and length (s).
bool himc_take_tips(himc_take *take, const himc_take_options *options,
                    himc_take_tip tips[HIMC_HANDS], himc_error *error);

/// A strike seen in a tip's trajectory: a fall that ends abruptly on a drumhead. A head is a plane
/// on which the fast strikes of the take agree; a take of several drums has several.
typedef struct himc_take_strike {
    himc_hand hand;  ///< the hand that struck
    int frame;       ///< of the lowest position, counted from 0
    int clear;       ///< the last frame in which the fall is undisturbed by the head
    int head;        ///< of the drumheads of the take, 0 the most struck
    double time;     ///< of the touch, between frames, from the first frame (s)
    himc_vec3 x;     ///< position of the tip at the touch (m)
    double velocity; ///< downward, just before (m/s)
    double rebound;  ///< upward, just after (m/s); 0 if the capture is too blunted to tell
} himc_take_strike;

/// Finds the strikes of both tips, in order of time. Owned by the caller (free); NULL with a count
/// of 0 without memory.
himc_take_strike *himc_take_find_strikes(const himc_take *take,
                                         const himc_take_tip tips[HIMC_HANDS], int *count);

// The player of a take: size, mass, pose in every frame, and seat, from any full-body take,
// skeleton or markers, as far as the take shows them.
//
// Joint centres are found by the names that motion capture software and laboratories use; a centre
// between two markers is their mean. A segment lies along the line between its joint centres; its
// rotation about that line comes from the skeleton's frames, else from a marker beside it, else
// from the plane of the bent elbow or knee, and for forearm, hand and stick from the vertical plane
// of the stroke. An arm that is shown up to the tip is then adjusted, so that its tip is where it
// was captured and its joints are as near as possible, because captured limbs stretch. The
// simulated pelvis is held, so the rotations of trunk and thighs are those in the world.

/// The person in a take, as far as the take shows it.
typedef struct himc_player {
    himc_skeleton_config config; ///< the measures; given ones where the take shows none
    int lengths;                 ///< number of measured segments
    char height_from[64];        ///< source of the height: "legs and trunk", or "" if it is given
    bool mass_stated;            ///< by the file; else from the given body mass index
    bool known[HIMC_JOINTS];     ///< joints that the take shows
    himc_pose mean;              ///< mean of the known joints, natural pose of the others
    int frames;                  ///< of the take
    himc_pose *pose;    ///< (frames), owned; NULL if no joint is known. Unknown joints as in mean
    bool walks;         ///< too far for a held pelvis; poses are relative to the moving hips
    himc_vec3 *walk;    ///< (frames), owned: hips relative to their mean (m) if walks; NULL after
                        ///< himc_player_sit has removed this motion from the take
    bool placed;        ///< the take shows the position of the player: hips or shoulders
    himc_vec3 hips;     ///< centre between the hip joints in the take (m): mean, or after sitting
    bool seated;        ///< himc_player_sit has set config.seat and offset
    himc_vec3 offset;   ///< from the take's coordinates to the world's (m)
    char notes[8][192]; ///< missing parts and repairs
    int note_count;     ///< 0 .. 8
} himc_player;

/// Reads the player from a take that was read with these options (NULL: default). `given`, with its
/// ranges checked, replaces what the take does not show. Gaps of markers up to options->longest_gap
/// are bridged; a joint with a longer gap is not known and a note says where. NULL with the reason:
/// no memory, or a player not of human size.
himc_player *himc_player_new(himc_take *take, const himc_take_options *options,
                             const himc_skeleton_config *given, himc_error *error);
/// Frees the player and its arrays.
void himc_player_free(himc_player *player);

/// Number of an arm's joints that the take shows: HIMC_ARM_JOINTS with its stick, 0 without the
/// arm.
HIMC_RT static inline int himc_player_known_arm(const himc_player *player, himc_hand hand)
{
    int known = 0;
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        known += player->known[himc_arm_joint(hand, k)];
    return known;
}

/// Puts the player over the world's origin. If the take places the player, the seat is raised or
/// lowered so that the strikes meet a head at the drum's height; `drum` is moved under the strikes
/// only if they would miss the head, or if no seat (0.3 .. 1.3 m) would do. Else the player sits
/// where the strikes fall on the drum's usual strike place. Without strikes the seat is as the take
/// shows it, or where all of the take is in reach, if there is such a place, and `drum` is lowered
/// out of the way. If the player walks, the motion of the hips is removed from the take. False with
/// the reason, and nothing else changed, if the take has no tips, a gap in them is too long, or
/// there is no memory.
bool himc_player_sit(himc_player *player, himc_take *take, const himc_take_options *options,
                     himc_head_frame *drum, himc_error *error);

/// One line per fact about the player, for `himc info`; with `drum` (NULL if the player is not
/// seated) also its place. A line is at most 255 characters; `line` gets `user` and the line.
void himc_player_describe(const himc_player *player, const himc_head_frame *drum,
                          void (*line)(void *, const char *), void *user);

// Recordings: the motion of the simulated body, kept in memory and written as a take.
//
// A recording has the body's joints, the tips of both sticks ("LeftStick_end", "RightStick_end")
// and the ends of head and toes, under the names that motion capture software uses, so that it
// plays here and can be read elsewhere. In a file of markers (.c3d, .trc) each segment also has a
// marker 0.05 m beside its joint, along the segment's y ("LeftArm_side"), which determines its
// rotation.

/// Frames of the simulated body and the path of their file. Opaque.
typedef struct himc_recording himc_recording;

/// Reserves memory for `longest` seconds of the body `skeleton` (copied) at `rate` (20 .. 10000
/// Hz). `path` (copied) ends in .bvh, .c3d or .trc and must be writable. NULL with the reason.
himc_recording *himc_recording_new(const char *path, const himc_skeleton *skeleton, double rate,
                                   double longest, himc_error *error);
/// Frees it; frames that have not been written are lost.
void himc_recording_free(himc_recording *recording);

/// Keeps one frame; false if there is no room left.
HIMC_RT bool himc_recording_add(himc_recording *recording, const himc_body_state *state);
/// Number of frames kept.
HIMC_RT int himc_recording_frames(const himc_recording *recording);
/// Writes the file; the recording can continue. False with the reason.
bool himc_recording_write(const himc_recording *recording, himc_error *error);

// Playing a take by a performance.

typedef struct himc_performance himc_performance; ///< performance.h

/// Options for the `take` command (tips' names, up axis). Strings are borrowed until the next call.
void himc_performance_take_options(himc_performance *performance, const himc_take_options *options);

/// Plays a take from memory, like the `take` command, by a player made from it with
/// himc_player_new. The measures of `player` may have been changed since (within the ranges of
/// himc_skeleton_config); joint rotations stay as captured. The player is seated. `name` begins
/// notes and errors. Take and player are borrowed for this call. False with the reason, and
/// if `player` is NULL; `error` then keeps that of himc_player_new.
bool himc_performance_play_player(himc_performance *performance, himc_take *take,
                                  himc_player *player, const char *name, himc_error *error);
/// Offset from the coordinates of the take being played to the world's (m).
himc_vec3 himc_performance_take_offset(const himc_performance *performance);

HIMC_END

#endif
