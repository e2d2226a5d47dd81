/// track_state.h: the parts of a track: tips (track.c) and joints (track_posture.c).
#ifndef HIMC_TRACK_STATE_H
#define HIMC_TRACK_STATE_H

#include "track/track.h"

#include "base/interpolate.h"
#include "track/track_fit.h"

/// From a stop to rest (s). Chosen: a stick at 5 m/s halts with less than 5 g.
#define HIMC_TRACK_HALT 0.4
/// Way that a halt goes on, as a share of HIMC_TRACK_HALT at the speed before. Chosen: a quintic
/// that neither overshoots nor turns back.
#define HIMC_TRACK_HALT_WAY 0.3

/// The joints a take can move: from the waist to the grips.
#define TRACK_JOINTS (HIMC_LEFT_UPPER_LEG - 1)

/// The motion in place of a stretch of the capture around a strike.
typedef struct bridge {
    int last, next;           ///< frames between which the capture is cut out
    double contact, from, to; ///< time of contact; replaces the capture in [from, to) (s)
    himc_vec3 spot;           ///< of the contact, in the head's frame (m)
    double speed;             ///< of the captured strike, as `himc info` has it (m/s)
    himc_quintic approach;    ///< from `from` to `contact`
    himc_quintic path;        ///< from `contact`, or once struck from `restart`, to `to`
    double restart;           ///< when the tip left the head (s); `from` until then
} bridge;

/// Written by track.c alone.
typedef struct hand_track {
    bool present;
    himc_vec3 *captured;     ///< as the take has it, moved to the head (frames) (m)
    himc_target *frame;      ///< (frames)
    bridge *bridges, *built; ///< as they are played, as they were built
    int bridge_count;
    himc_quintic approach, settle; ///< before the first frame; after a stop
    double approach_time;          ///< length of the approach (s), 0 if there is none
} hand_track;

/// Written by track_posture.c alone.
typedef struct joint_track {
    bool known[TRACK_JOINTS];         ///< joints the take moves
    joint_state *joint[TRACK_JOINTS]; ///< (frames), owned; NULL where not known
    joint_state *uncut[TRACK_JOINTS]; ///< of an arm, its strikes included (frames), owned
    joint_state before[TRACK_JOINTS]; ///< where the approach begins
    bool empty[HIMC_HANDS];           ///< the take's arm holds no stick that ends at its tip
} joint_track;

struct himc_track {
    double rate;
    int edge; ///< frames of a fit beside a strike, more for a noisy capture
    int frames;
    himc_vec3 offset;
    himc_head_frame head;
    double start; ///< of its first frame in the performance (s)
    double stop;  ///< time at which the take is left (s); infinite if it is not
    hand_track hand[HIMC_HANDS];
    himc_nudge nudge[HIMC_NUDGES];
    int nudges;
    joint_track joints;
};

static inline double himc_track_take_length(const himc_track *track) // (s)
{
    return (track->frames - 1) / track->rate;
}

/// Fits and keeps the postures; false without memory.
bool himc_track_fit_postures(himc_track *track, const himc_player *player);
void himc_track_free_postures(himc_track *track);

#endif
