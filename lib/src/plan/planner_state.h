/// planner_state.h: what the planner's files share.
#ifndef HIMC_PLANNER_STATE_H
#define HIMC_PLANNER_STATE_H

#include "plan/hand.h"

#include "plan/planner.h"

#define PLANNER_HITS 4
#define PLANNER_TOUCHES 16
#define PLANNER_NOTES 32
/// Planned beyond the last advance at least (s).
#define PLANNER_HORIZON 0.15
/// Within this time of its touch a stroke is no longer changed (s).
#define PLANNER_COMMIT 0.08
/// Calls that carry no time change the plan from this long after the last advance (s).
#define PLANNER_AHEAD 0.03

typedef struct planner_stroke {
    himc_stroke stroke;
    int drum;
    long settled; ///< where it was lent or given up, as himc_planner_turn_name says; 0: nowhere
} planner_stroke;

/// A stroke that is planned; `goal.gesture` is how it will be played.
typedef struct planner_touch {
    himc_stroke stroke;
    int drum;
    int index;   ///< in the hand's score, -1 for a hit
    int round;   ///< of the loop
    bool lent;   ///< a stroke of the other hand's score: it waits among the hits
    bool parted; ///< the tip has left the head again
    bool small;  ///< much smaller than written
    himc_goal goal;
} planner_touch;

/// Live targets as they come in.
typedef struct planner_stream {
    double time;   ///< of the last one (s)
    double period; ///< between them (s), 0 before the second
    bool moving;   ///< `v` has been seen
    himc_vec3 x, v;
    himc_vec3 before[2];  ///< targets before x, the latest first
    int heard;            ///< how many of them there are
    double noise;         ///< of each coordinate, one standard deviation (m)
    double memory;        ///< of the filter (s)
    himc_target filtered; ///< where the last target really was
} planner_stream;

typedef struct planner_hand {
    planner_stroke *list; ///< owned, sorted by beat
    int count, room;
    int next;  ///< first of the list that is not planned
    int round; ///< of the loop that it belongs to
    planner_touch hit[PLANNER_HITS];
    int hits; ///< that wait, sorted by time
    planner_touch touch[PLANNER_TOUCHES];
    int touches; ///< planned, and the last one past
    planner_stream stream;
    himc_hand_plan plan;
} planner_hand;

/// What is said once only.
typedef enum planner_kind {
    PLANNER_SMALLER,
    PLANNER_GIVEN_UP,
    PLANNER_LENT,
    PLANNER_LATE,
    PLANNER_CROWDED,
    PLANNER_OUTSIDE,
    PLANNER_KINDS
} planner_kind;

struct himc_planner {
    himc_planner_config config;
    himc_head_frame place[HIMC_DRUMS];
    planner_hand hand[HIMC_HANDS];
    himc_tempo_change *tempi; ///< owned
    int tempo_count;
    bool playing;
    double origin; ///< time of beat 0 while playing (s)
    double beat;   ///< where play begins or began
    bool loop;
    int rounds; ///< without loop: the last one to be played
    double now; ///< of the last advance (s)
    himc_unit unit[HIMC_UNITS];
    int unit_count, grip;
    himc_planner_note note[PLANNER_NOTES];
    int note_first, note_count, note_lost;
    int said[PLANNER_KINDS]; ///< times that each kind was to be said
    int given_up;            ///< strokes of the score, not asked for yet
    int smaller, lent, left; ///< strokes since play; `left` out
    int beginning;           ///< of the transport: how many there were
    bool lending;            ///< a stroke is being given to the other hand
};

/// A note for the user, unless one of its kind has been given.
HIMC_RT void himc_planner_say(himc_planner *planner, planner_kind kind, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/// Another beginning: each kind may be said again.
HIMC_RT void himc_planner_forget_said(himc_planner *planner);

/// The stroke a hand comes to next, in which round, and when; NULL if there is none.
HIMC_RT const planner_stroke *himc_planner_next(const himc_planner *planner, const planner_hand *h,
                                                int ahead, int *index, int *round, double *t);
HIMC_RT double himc_planner_time_of(const himc_planner *planner, double beat);
/// How long a round of the loop takes (s).
HIMC_RT double himc_planner_turn(const himc_planner *planner);
/// Makes the round of the loop at `t` the first, before its length changes.
HIMC_RT void himc_planner_rebase(himc_planner *planner, double t);
HIMC_RT double himc_planner_beat_at(const himc_planner *planner, double t);
HIMC_RT himc_goal himc_planner_goal(himc_planner *planner, const himc_stroke *stroke, int drum,
                                    double t);
/// Whether a stroke is out of its hand's reach: then the other one takes it, or it is given up.
HIMC_RT bool himc_planner_too_far(himc_planner *planner, const planner_touch *touch);
/// The other hand takes a stroke that its own cannot prepare, or it is given up.
HIMC_RT void himc_planner_no_time(himc_planner *planner, const planner_touch *touch);
/// A round of the loop, counted through all beginnings of the transport; never 0.
static inline long himc_planner_turn_name(const himc_planner *planner, int round)
{
    return 1 + round + (planner->beginning & 0xffffL) * 0x100000000L;
}

/// Plans both hands anew from t on; what is committed stays.
HIMC_RT void himc_planner_replan(himc_planner *planner, double t);
/// Takes back what is planned after t, unless committed; the plan then ends at t or soon after.
HIMC_RT void himc_planner_cut(himc_planner *planner, himc_hand hand, double t);
/// Plans a hand to `until` (s) at least.
HIMC_RT void himc_planner_extend(himc_planner *planner, himc_hand hand, double until);

#endif
