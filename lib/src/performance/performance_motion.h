/// performance_motion.h: the targets of a performance's body: planner and take, the postures for
/// the tips, and the setpoints of the task ticks.
#ifndef HIMC_PERFORMANCE_MOTION_H
#define HIMC_PERFORMANCE_MOTION_H

#include "body/pedal.h"
#include "plan/damping.h"
#include "control/posture_crossfade.h"
#include "control/posture_regression.h"
#include "control/setpoint.h"
#include "performance/performance_drums.h"
#include "performance/performance_feet.h"
#include "performance/performance_settings.h"
#include "track/track.h"

/// The last live target of a hand.
typedef struct live_target {
    himc_vec3 x; ///< (m)
    double time; ///< (s)
    bool eased;  ///< it comes down to a head more slowly than asked
} live_target;

/// What moves a hand now.
typedef struct hand_source {
    const himc_source *kind;
    void *of; ///< borrowed
} hand_source;

/// The pedal of a drum, as it was last seen.
typedef struct seen_pedal {
    bool known;
    double octaves; ///< himc_drum_pedal
    double until;   ///< a foot is wanted on it (s)
} seen_pedal;

typedef struct performance_motion {
    himc_planner *planner; ///< owned
    performance_feet feet;
    himc_track *track;              ///< owned; of the take that is loaded, NULL: none
    hand_source piece;              ///< what is played: the track, or else the planner
    hand_source source[HIMC_HANDS]; ///< the planner, or the track while it plays that hand
    bool has_learned;
    himc_limits learned;    ///< joint limits of the take's player
    himc_planned_body body; ///< its posture, and the course towards that for the next strokes
    bool has_regression;
    bool regression_of_take; ///< dropped with the take
    himc_posture_regression
        regression;                  ///< null-space target; replaces the natural posture in `himc`
    himc_hand_path path[HIMC_HANDS]; ///< since the last tick
    himc_hand_style style[HIMC_HANDS]; ///< of the present stroke ...
    double level[HIMC_HANDS];          ///< ... and the tip's height in its contact (m)
    himc_damping damping;
    himc_pedal_foot foot;
    int pedalled; ///< the drum on whose pedal that is, or was
    seen_pedal pedal[HIMC_DRUMS];
    bool crossfade_due; ///< joint targets change their source at the next tick
    himc_posture_crossfade crossfade;
    himc_setpoint from, to;            ///< of the ticks before and after
    himc_setpoint_course between;      ///< these ticks
    himc_reference reference;          ///< now
    himc_head_frame under[HIMC_HANDS]; ///< head on which deeper targets press; radius 0: none
    bool replan;                       ///< `from` is read again, too
    live_target live[HIMC_HANDS];
    bool out_of_reach[HIMC_HANDS]; ///< the last live target was refused or out of reach
    double answered[HIMC_HANDS];   ///< planned time of the last stroke struck or given up (s)
    bool playing;
    bool over;                   ///< played to its end: its time goes on until `play` or `stop`
    long last_beat, last_round;  ///< that have been reported, the beat in its parts
    double subdivide;            ///< so many parts of a beat are reported
    double prepared[HIMC_HANDS]; ///< time of the last stroke whose gesture was reported (s)
    bool counted;                ///< the last one was before a cleared loop begins again
    double calm;                 ///< no beat begins and no end comes before, if nothing changes (s)
} performance_motion;

/// Motion from time 0 without a body: himc_motion_build gives it one. NULL without memory.
performance_motion *himc_motion_new(himc_error *error);
void himc_motion_free(performance_motion *motion);

/// Sets another body: its resting posture, and its first targets at `t` (s).
void himc_motion_build(performance_motion *motion, const himc_skeleton *skeleton,
                       const performance_settings *settings, double t);
/// The natural posture of a body, with the captured joints of its player.
HIMC_RT void himc_motion_init_posture(himc_posture *posture, const himc_skeleton *skeleton,
                                      const captured_player *captured, double level,
                                      himc_stance stance);
/// The pose for making controllers: sticks at rest.
void himc_motion_resting_pose(const performance_motion *motion, himc_pose *pose);
/// Mean of a stroke's postures at the planned places, from the first head up.
HIMC_RT himc_pose himc_motion_mean_pose(const performance_motion *motion, double t);

/// Reads the setpoints again at the next step.
HIMC_RT void himc_motion_replan(performance_motion *motion);
/// The stool has this height (m); himc_motion_build then gives it to the postures.
HIMC_RT void himc_motion_seat(performance_motion *motion, double height);
/// True if the hands of the planner rest elsewhere at the start than the last setpoints say.
HIMC_RT bool himc_motion_rests_elsewhere(const performance_motion *motion);
/// A drum has this place; with `first` it is the first one of the hands, which rest at its height.
HIMC_RT void himc_motion_set_drum(performance_motion *motion, int index,
                                  const himc_head_frame *frame, bool first);
/// Read task: the targets at the tick after `t`, and at this one if the plan has changed.
HIMC_RT void himc_motion_read_task(performance_motion *motion, const performance_settings *settings,
                                   const performance_drums *drums, double t, double next);
HIMC_RT bool himc_motion_is_finite(const performance_motion *motion);
/// Makes the setpoints finite again at `t`, if they are not: a hand whose plan is not sound rests,
/// a take that is not finite ends, and trunk and cross-fade begin again.
HIMC_RT void himc_motion_recover(performance_motion *motion, const performance_settings *settings,
                                 double t);
/// Lets the planner rehearse its plan, for a step of `h` (s), less if a stick is `busy` with a
/// head.
HIMC_RT void himc_motion_think(performance_motion *motion, double h, bool busy);
/// The reference at `t` between the ticks.
HIMC_RT void himc_motion_interpolate(performance_motion *motion, double t);

HIMC_RT himc_target himc_motion_planned(const performance_motion *motion, himc_hand hand, double t);
/// The hand's contact at `t` or after it, but for one that is answered.
HIMC_RT himc_source_contact himc_motion_next(const performance_motion *motion,
                                             const performance_drums *drums, himc_hand hand,
                                             double t);
HIMC_RT himc_source_stroke himc_motion_stroke(const performance_motion *motion,
                                              const performance_drums *drums, himc_hand hand,
                                              double t);
/// Ends the stroke planned for that time: struck or given up.
HIMC_RT void himc_motion_answer(performance_motion *motion, himc_hand hand, double planned_time);
/// Corrects the last milliseconds of a hit from that state of the tip. Only control that feeds the
/// acceleration forward can follow so short a plan.
HIMC_RT void himc_motion_correct(performance_motion *motion, const performance_settings *settings,
                                 himc_hand hand, double t, const himc_target *measured);
/// Continues the plan from that state of the tip, which has left the head.
HIMC_RT void himc_motion_go_on_from(performance_motion *motion, himc_hand hand, double t,
                                    const himc_target *measured);
/// Sets whether control releases the normal of a head, and the acceleration that the hand gives the
/// stick there (m/s^2).
HIMC_RT void himc_motion_release(performance_motion *motion, himc_hand hand, bool released,
                                 double yield);
/// The head on which targets of the hand press from the next tick on, not deeper; NULL: none.
HIMC_RT void himc_motion_set_under(performance_motion *motion, himc_hand hand,
                                   const himc_head_frame *head);
/// True if the tip rests on a head of that level after the stroke at `time`, as a take can have it.
HIMC_RT bool himc_motion_rests_after(const performance_motion *motion, himc_hand hand, double time,
                                     const himc_head_frame *head);
HIMC_RT void himc_motion_set_normal(performance_motion *motion, himc_hand hand, himc_vec3 normal);
/// In `ik`: sets the tip's target to that state, and the posture accordingly.
HIMC_RT void himc_motion_move_tip(performance_motion *motion, const performance_settings *settings,
                                  himc_hand hand, const himc_target *tip, double t);

/// True if the piece is the planner's score, with its beats and rounds; false for any other source
/// of motion. What is so for a take of recorded motion alone asks for `track`.
HIMC_RT bool himc_motion_plays_score(const performance_motion *motion);
HIMC_RT bool himc_motion_tracks(const performance_motion *motion, himc_hand hand);
/// Time since the first frame of the take that moves hands at `t` (s); -infinity if none does.
HIMC_RT double himc_motion_take_time(const performance_motion *motion, double t);
/// True for a hand without a task: not in the take, or on its way to the take's first frame.
HIMC_RT bool himc_motion_is_idle(const performance_motion *motion, himc_hand hand, double t);
/// Place of that hand's tip in the take that moves it; false if none does.
HIMC_RT bool himc_motion_captured(const performance_motion *motion, himc_hand hand, double t,
                                  himc_vec3 *x);
/// The joints in the take that plays, their targets where it shows none; false without a take that
/// has joints.
HIMC_RT bool himc_motion_captured_joints(const performance_motion *motion, double t,
                                         himc_posture_motion *joints);
/// Gives the hand to the planner if its take is over; false while the take plays.
HIMC_RT bool himc_motion_free_hand(performance_motion *motion, himc_hand hand, double t);
/// Replaces the take (NULL: none) and the limits of its player (NULL: none). Returns the one
/// before, which the caller frees.
HIMC_RT himc_track *himc_motion_set_track(performance_motion *motion, himc_track *track,
                                          const himc_limits *learned, double t);
/// Sets the null-space target; NULL: the natural posture. `of_take`: dropped with the take.
HIMC_RT void himc_motion_set_regression(performance_motion *motion,
                                        const performance_settings *settings,
                                        const himc_posture_regression *regression, bool of_take);

/// A stroke was added: after the end the score may play on for it.
HIMC_RT void himc_motion_go_on(performance_motion *motion, double t);
HIMC_RT void himc_motion_play(performance_motion *motion, double t);
HIMC_RT void himc_motion_stop(performance_motion *motion, double t);
/// Takes note if a live target is followed: `good` is false if it is refused or out of reach. True
/// for the first one of a stream that is not.
HIMC_RT bool himc_motion_note_target(performance_motion *motion, himc_hand hand, bool good);
/// Takes note of a live target at `t`, in that head (NULL: in none). One that has jumped into a
/// head comes down to it slowly: returns where it is meanwhile.
HIMC_RT himc_vec3 himc_motion_ease_down(performance_motion *motion, himc_hand hand, double t,
                                        himc_vec3 target, const himc_head_frame *head);
/// From the nearest place in reach of either hand to the usual strike point of a head (m); 0 if
/// that is in reach.
HIMC_RT himc_vec3 himc_motion_beyond(const performance_motion *motion, const himc_head_frame *head);

/// True if no beat begins and no end comes at `t`: himc_motion_foresee has found it so, and nothing
/// has changed.
HIMC_RT bool himc_motion_is_calm(const performance_motion *motion, double t);
/// Finds out if a beat or the end comes before the time `next` (s).
HIMC_RT void himc_motion_foresee(performance_motion *motion, double next);
/// The beat at `t`, of a take the time since its first frame (s), going on past the end; negative
/// if nothing has been played since the last `stop`.
HIMC_RT double himc_motion_score_beat(const performance_motion *motion, double t);
/// Something may have changed: nothing is foreseen.
HIMC_RT void himc_motion_stir(performance_motion *motion);
/// The beat, or the part of one, that has begun at `t` since the last call, or -1.
HIMC_RT double himc_motion_beat(performance_motion *motion, double t);
/// From `t` on so many parts of a beat are reported; the one that runs has been.
HIMC_RT void himc_motion_subdivide(performance_motion *motion, double parts, double t);
/// True once everything has been played at `t`.
HIMC_RT bool himc_motion_done(performance_motion *motion, double t);

#endif
