/// planner_state.h: the state of the planner, what is read off it, and the functions that plan
/// motion from it.
///
/// Calls go up this list: planner_goal.c, from strokes to goals; planner_motion.c, from goals to
/// the plans of the hands, and the clock; planner_clear.c, rehearsals of the plans and the search
/// for ways past each other; planner_hits.c, what is asked for while it happens; planner.c, the
/// settings. The score and the notes have files of their own, planner_score.c and planner_notes.c.
#ifndef HIMC_PLANNER_STATE_H
#define HIMC_PLANNER_STATE_H

#include "plan/follow.h"
#include "plan/planner_notes.h"

/// Strokes that wait for a hand; chosen: as many as can be planned, so that all can be put back.
#define PLANNER_WAITING 16
#define PLANNER_PLANNED 16 ///< strokes planned ahead; chosen: never reached at 40 ms a stroke
/// Motion is planned so far beyond the last advance at least (s); chosen: a full stroke.
#define PLANNER_HORIZON 0.45
/// Calls that carry no time change the plan from this long after the last advance (s); chosen: more
/// than the longest period of advance, 10 ms.
#define PLANNER_AHEAD 0.03

/// A stroke is the current one until so much after its time (s); chosen: strokes are rarely less
/// than 0.1 s apart.
#define PLANNER_CURRENT 0.05

/// A stroke with so much of the speed asked for is as strong. Chosen: 0.5 dB, the spread that equal
/// strokes may have.
#define PLANNER_AS_STRONG 0.944
#define PLANNER_UNREACHED 0.01 ///< a goal so far out of reach is not tried (m); chosen

/// A stroke with its time and gesture, waiting to be planned or planned.
typedef struct timed_stroke {
    himc_stroke stroke;
    int drum;
    planner_place place; ///< in the hand's part of the score; of a hit or a reassigned stroke none
    bool gives_way;      ///< it is softer for the stroke after it
    bool reassigned;     ///< it is from the other hand's part of the score
    bool separated;      ///< the tip has left the head again
    double asked;        ///< speed of impact that was asked for (m/s)
    bool varied;         ///< the goal is not as written
    double yields;       ///< its spot is moved by so much, as the hands would have met (m)
    bool exact;          ///< a hit with a time, still to be corrected before its touch
    double latency;      ///< time that a hit with a time has, since its message (s), else 0
    himc_variation variation; ///< of a hit since it came, of another stroke since it was varied
    himc_goal written;
    himc_goal goal; ///< varied; once planned, with the gesture as it will be played
} timed_stroke;

/// What is tried with a stroke when its hand cannot be lifted past the other one.
typedef struct planner_way {
    himc_hand hand;
    double touch;  ///< written time of that stroke (s); of another stroke this does not hold
    double aside;  ///< its spot is moved to the left by so much, in the head's frame (m)
    bool straight; ///< its way does not bow out round the body
    bool waits;    ///< the hand first waits over its last spot
    bool other;    ///< the other hand plays it
    bool leaves;   ///< it is left out
    int tried;     ///< so many ways
} planner_way;

/// A hand is moved by `way` (m) from `from` to `to` (s), not at all before `begin` and after `end`;
/// no lift if `end` is 0.
typedef struct planner_lift {
    himc_hand hand;
    double begin, from, to, end;
    double touch; ///< the next one of the hand (s)
    himc_vec3 way;
} planner_lift;

typedef struct planner_hand {
    timed_stroke waiting[PLANNER_WAITING]; ///< hits and reassigned strokes, sorted by time
    int waiting_count;
    timed_stroke planned[PLANNER_PLANNED]; ///< and the last one that is past
    int planned_count;
    int drum;      ///< of its last stroke
    int added;     ///< 1 + index of a stroke that a loop has just got; 0: none
    bool struck;   ///< has had a stroke since the score was cleared
    bool targeted; ///< it rests at its last live target, not over a drum
    himc_stream stream;
    himc_hand_plan plan;
    double checked;    ///< the plan is sound to here (s)
    planner_way way;   ///< found for one of its strokes
    planner_lift lift; ///< found for one of its strokes
} planner_hand;

/// A time in which the hands come near.
typedef struct near_time {
    double lack;     ///< what gaps lack, over the time (m s)
    double gap;      ///< least of all (m)
    double from, to; ///< first and last time of a lack (s)
    int order;       ///< of the arms then: 1 the left one is above, -1 below, 0 not crossed
} near_time;

/// A walk through both plans.
typedef struct planner_rehearsal {
    double t;     ///< the next moment (s) ...
    double after; ///< ... after the last one (s), negative: it is the first
    bool met;     ///< the body has met itself since the first moment: no plan parts it
    near_time near;
    himc_trunk_posture trunk, goal; ///< the body's at the last moment ...
    himc_avoidance avoidance;
    double since; ///< ... so long after the last update of the avoidance (s)
} planner_rehearsal;

/// The search.
typedef struct planner_clear {
    double credit;             ///< work that has been paid for
    long work;                 ///< done so far
    planner_rehearsal walk;    ///< of the plans
    planner_rehearsal kept[2]; ///< earlier moments of it, the later one first
    double searched;           ///< ways past what is near before this have been tried (s)
    bool searching;
    int candidate;          ///< number of the one that is tried
    near_time plain, least; ///< without a change, and of the best one so far
    bool trying;            ///< ... walks
    planner_rehearsal trial_walk;
    planner_lift lift, best_lift;
    planner_way way, best_way;         ///< touch -infinity: none
    bool planning;                     ///< the planner's hands are those of a trial ...
    planner_hand own[HIMC_HANDS];      ///< ... and these are its own
    planner_hand with_way[HIMC_HANDS]; ///< as planned with `way`
} planner_clear;

struct himc_planner {
    himc_planner_config config;
    himc_head_frame drum[HIMC_DRUMS];
    bool known[HIMC_DRUMS]; ///< drums that have been set
    himc_unit unit[HIMC_UNITS];
    int unit_count, grip;
    bool servo; ///< no stroke bounces
    himc_human human;
    planner_score score;
    planner_notes notes;
    planner_hand hand[HIMC_HANDS];
    planner_clear clear;
    himc_tempo_ramp ramp; ///< under way in a loop, whose rounds are shorter; `beat` of all rounds
    int ramp_steps;       ///< of it that have begun
    int hits;             ///< since the last `clear` or change of `human`
    double changed;       ///< plans are others from here on than when last rehearsed (s)
    double now;           ///< of the last advance (s)
    double hastened;      ///< strokes up to here may have lost their time to a new tempo (s)
    bool begun;           ///< it has been advanced: the tips cannot be put elsewhere any more
};

// planner_goal.c
/// How far out of a hand's reach a place is (m).
HIMC_RT double himc_planner_beyond(const himc_planner *planner, himc_hand hand, himc_vec3 place);
HIMC_RT bool himc_planner_reaches(const himc_planner *planner, himc_hand hand, himc_vec3 place);
/// A stroke's spot moved to the left on its head, not over the rim (m).
HIMC_RT himc_vec3 himc_planner_aside(const himc_planner *planner, const timed_stroke *stroke,
                                     double by);
/// Where and how a tip plays a stroke on a drum at t, as written.
HIMC_RT himc_goal himc_planner_goal(himc_planner *planner, const himc_stroke *stroke, int drum,
                                    double t);
/// Time that bounces from t on take at most before the hand's next stroke (s): they leave to one
/// that is written the time that it needs.
HIMC_RT double himc_planner_bounce_most(himc_planner *planner, int bounces, double t,
                                        const planner_due *after);
/// Speed of impact that a stroke has with all the time that its bounces need (m/s).
HIMC_RT double himc_planner_asked(const himc_planner *planner, const timed_stroke *stroke);
/// Lets the goal differ from the written one as a player's would.
HIMC_RT void himc_planner_vary(const himc_planner *planner, timed_stroke *stroke);
/// Where a hand rests (m): over its drum or, out of its reach, over the first one
/// in reach.
HIMC_RT himc_vec3 himc_planner_rest_place(const himc_planner *planner, himc_hand hand);

// planner_motion.c
/// Drums, reach or first strokes have changed: the hands rest elsewhere.
HIMC_RT void himc_planner_rest_again(himc_planner *planner);
/// The plan of a hand is another one from t (s) on, to be checked and rehearsed.
HIMC_RT void himc_planner_changed(himc_planner *planner, double t);
/// The planned stroke that is the current one at t, as himc_planner_current has it, or NULL.
HIMC_RT const timed_stroke *himc_planner_current_planned(const planner_hand *hand, double t);
/// Index of the hand's first planned stroke after t; the count if there is none.
HIMC_RT int himc_planner_next_planned(const planner_hand *hand, double t);
/// Time of the hand's next planned touch after t (s).
HIMC_RT double himc_planner_touch_after(const planner_hand *hand, double t);
/// The least time in which a hand can be lifted so (s).
HIMC_RT double himc_planner_lift_time(const planner_lift *lift);
/// Lifts a hand, a little later than found if it cannot begin before t (s); false if it is too
/// late.
HIMC_RT bool himc_planner_lift_from(planner_hand *hand, const planner_lift *lift, double t);
/// Time of a waiting stroke (s): a reassigned one keeps its beat, a hit its time.
HIMC_RT double himc_planner_waiting_time(const himc_planner *planner, const timed_stroke *stroke);
/// Lets a stroke wait for its hand, in the order of time; there must be room.
HIMC_RT void himc_planner_queue(himc_planner *planner, const timed_stroke *stroke);
/// A hit is not played: told, and counted at t (s).
HIMC_RT void himc_planner_give_up_hit(himc_planner *planner, const timed_stroke *hit, double t);
/// Moves a time behind any stroke of the hand that is too near; false if there is no gap.
HIMC_RT bool himc_planner_find_gap(const himc_planner *planner, himc_hand hand, double *t);
/// Takes back all strokes more than `margin` after t, without their motion.
HIMC_RT void himc_planner_unplan(himc_planner *planner, himc_hand hand, double t, double margin);
/// Takes back the strokes planned after t that can still be changed; the plan then ends at t or
/// soon after.
HIMC_RT void himc_planner_cut(himc_planner *planner, himc_hand hand, double t);
/// Plans a hand to `until` (s) at least.
HIMC_RT void himc_planner_extend(himc_planner *planner, himc_hand hand, double until);
/// Cuts both hands at t ...
HIMC_RT void himc_planner_cut_both(himc_planner *planner, double t);
/// ... and plans them again from there.
HIMC_RT void himc_planner_replan(himc_planner *planner, double t);
/// A line: this stroke of a loop is left out of the round under way.
HIMC_RT void himc_planner_tell_next_round(himc_planner *planner, const himc_stroke *stroke);
/// A hand's plan so far rests on no stroke of its part after this time (s), and on none of those
/// from *index on. On the one that it plans next it rests as himc_planner_may_be_next says.
HIMC_RT double himc_planner_looked_to(const himc_planner *planner, himc_hand hand, int *index);
/// True if a hand's plan so far is the same with either of two strokes (on `drum`) as the one that
/// it plans next: they differ in strength, and leave the one before them as it is.
bool himc_planner_may_be_next(himc_planner *planner, const himc_stroke *a, const himc_stroke *b,
                              int drum);
/// How much too late the hands would be for their next strokes (s); 0 if they are not.
HIMC_RT double himc_planner_lateness(himc_planner *planner);

// planner_clear.c
/// Takes from rehearsed gaps what real ones may be less, with sticks that pass each other at a
/// speed (m/s); returns the least (m).
HIMC_RT double himc_planner_least_gap(himc_clearance *clear, double speed_past);
/// True if the trunk, from where it is at t, bends far enough for a hand's stroke until then.
HIMC_RT bool himc_planner_bends_to(const himc_planner *planner, himc_hand hand, double t,
                                   const himc_goal *goal);
/// True if the sticks meet with the tip of that hand at x.
HIMC_RT bool himc_planner_meets_at(const himc_planner *planner, double t, himc_hand hand,
                                   himc_vec3 x);

// planner_notes.c
/// "stroke at beat 3 left kettle", as a line for the user names it; in a loop with
/// its round, unless that is below 0. Returns `text`.
HIMC_RT const char *himc_planner_name(const himc_planner *planner, const timed_stroke *stroke,
                                      char text[HIMC_PLANNER_NAME]);

#endif
