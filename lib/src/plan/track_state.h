/// track_state.h: what a track holds, of track.c (tips) and track_posture.c (joints); private.
#ifndef HIMC_TRACK_STATE_H
#define HIMC_TRACK_STATE_H

#include "plan/track.h"

#include "base/interpolate.h"
#include "plan/track_fit.h"

#define SETTLE 0.4 ///< from a stop to rest (s)
#define EASE 0.1   ///< at both ends of the take time starts and stops so slowly (s)

/// The joints a take can move: from the waist to the grips.
#define TRACK_JOINTS (HIMC_LEFT_UPPER_LEG - 1)

typedef struct bridge {
    int last, next;           ///< frames between which the capture is cut out
    double contact, from, to; ///< time of contact; replaces the capture in [from, to) (s)
    himc_vec3 place;          ///< of the contact (m)
    himc_quintic approach;    ///< from `from` to `contact`
    himc_quintic path;        ///< from `contact`, or once struck from `restart`, to `to`
    double restart;           ///< when the tip left the head (s); `from` until then
} bridge;

typedef struct hand_track {
    bool present;
    himc_target *frame;        ///< (frames)
    bridge *bridges, *planned; ///< as they are played, as they were built
    int bridge_count;
    himc_quintic approach, settle; ///< before the first frame; after a stop
    double approach_time;          ///< length of the approach (s), 0 if there is none
} hand_track;

struct himc_track {
    double rate;
    int edge; ///< frames that fits beside a strike take, more for a noisy capture
    int frames;
    himc_vec3 offset;
    himc_head_frame place;
    double stop; ///< where the take is left (s); infinite if it is not
    hand_track hand[HIMC_HANDS];
    bool known[TRACK_JOINTS];         ///< joints the take moves
    joint_state *joint[TRACK_JOINTS]; ///< (frames), owned; NULL where not known
    joint_state *uncut[TRACK_JOINTS]; ///< of an arm, its strikes included (frames), owned
    joint_state before[TRACK_JOINTS]; ///< where the approach begins
    bool empty[HIMC_HANDS];           ///< the take's arm holds no stick that ends at its tip
};

/// Fits and keeps the postures; false without memory.
bool himc_track_fit_postures(himc_track *track, const himc_player *player);
/// The first bridge of the list that is not over at `t`, by bisection; bridge_count if there is
/// none.
int himc_track_bridge_at(const bridge *list, int count, double t);
/// Takes begin and end in motion; time itself starts from a stand and comes to one, over EASE
/// around each end. `at` is the take's time when it is `t`, with its rate and second derivative.
void himc_track_warp(const himc_track *track, double t, double at[3]);

#endif
