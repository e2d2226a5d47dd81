/// planner.h: from strokes to the trajectories of the two drumstick tips.
///
/// Each hand's trajectory is a spline of quintics in space, continuous in position, velocity and
/// acceleration (C2). The planner knows nothing of bodies or sound; it is told the places of the
/// drums, the reach of the hands and, at separation, the measured state of the tip. A stroke that a
/// player could not play is made smaller or later, reassigned to the other hand or given up, and a
/// note says so.
#ifndef HIMC_PLANNER_H
#define HIMC_PLANNER_H

#include "body/avoidance.h"
#include "body/source.h"
#include "himc/score.h"
#include "capture/units.h"
#include "plan/human.h"
#include "plan/score.h"

/// The body that is to follow the plan, as it is now. Its owner writes it, the planner only reads.
typedef struct himc_planned_body {
    himc_posture posture; ///< makes natural postures for the tips
    himc_grip grip;
    himc_shells shells;      ///< the drums
    himc_trunk_posture from; ///< course of the trunk: from here ...
    himc_trunk_posture goal; ///< ... to here
    double time;             ///< of `from` (s)
    himc_avoidance avoidance;
    double avoided; ///< time of its last update (s)
} himc_planned_body;

typedef struct himc_planner_config {
    double mallet_radius;       ///< the tip is the mallet's centre: it touches at this height (m)
    himc_vec3 rest[HIMC_HANDS]; ///< where a tip rests while no drum in its reach is known (m)
    const himc_planned_body *body; ///< borrowed; NULL: all is in reach, the hands never meet
} himc_planner_config;

himc_planner_config himc_planner_default(void);

typedef struct himc_planner himc_planner;
extern const himc_source himc_planner_source; ///< of a himc_planner

/// A stroke that is asked for while it happens.
typedef struct himc_hit {
    const himc_stroke *stroke; ///< its beat is ignored; borrowed
    int drum;
    double at;  ///< time of touch (s)
    bool alone; ///< no other hand takes it
} himc_hit;

/// A line for the user.
typedef struct himc_planner_note {
    char text[192];
    bool minor; ///< all strokes are played
} himc_planner_note;

/// A stroke that is given up.
typedef struct himc_planner_miss {
    himc_stroke stroke;
    int drum;
    bool hit;     ///< of no score: it has no beat
    double time;  ///< at which it should have touched (s)
    char why[48]; ///< in a few words
} himc_planner_miss;

himc_planner *himc_planner_new(const himc_planner_config *config, himc_error *error);
void himc_planner_free(himc_planner *planner);

/// Drum `index` (0 .. HIMC_DRUMS-1) is at `place` from now on; strokes that have not begun go
/// there, and a hand rests 85 mm over the head of its last stroke, at first over that of the first
/// one to come, else over drum 0. False, and nothing changed, if one of the values is not allowed.
HIMC_RT bool himc_planner_set_drum(himc_planner *planner, int index, const himc_head_frame *place);

#define HIMC_UNITS 256 ///< chosen: five nuances, two hands, and 25 strokes of each

/// True if `more` units can be added to `count`; else the reason.
bool himc_planner_check_units(int count, int more, himc_error *error);
/// How many have been added since they were cleared.
int himc_planner_units(const himc_planner *planner);
/// Adds motion units (copied), to be played in place of the built-in strokes of their nuance and
/// hand. False, and nothing added, if there would be more than HIMC_UNITS.
bool himc_planner_add_units(himc_planner *planner, const himc_unit *units, int count,
                            himc_error *error);
/// The body has changed: the hands rest where it reaches.
HIMC_RT void himc_planner_set_body(himc_planner *planner);

HIMC_RT void himc_planner_clear_units(himc_planner *planner);
/// Units of this grip (himc_grip) are preferred.
HIMC_RT void himc_planner_set_grip(himc_planner *planner, int grip);

/// Strokes bounce that shall, or have one contact each (servo).
HIMC_RT void himc_planner_set_servo(himc_planner *planner, bool servo);

/// Strokes that can still be changed vary so from now on; hits are counted from 0 again.
HIMC_RT void himc_planner_set_human(himc_planner *planner, himc_human human);

/// True if a stroke that was added after the end has the score play on: the next `play` begins at
/// the top all the same.
HIMC_RT bool himc_planner_goes_on(const himc_planner *planner);
/// Checks a stroke as himc_planner_add does, and allocates for it, so that it can be added.
bool himc_planner_accepts(himc_planner *planner, const himc_stroke *stroke, int drum,
                          himc_error *error);
/// Adds a stroke of the score at its beat, for drum `index`; may allocate. Strokes may come in any
/// order; two strokes of one hand closer than 40 ms are refused. After the end, whose beats go on,
/// the score plays on for it if its beat is to come.
bool himc_planner_add(himc_planner *planner, const himc_stroke *stroke, int drum,
                      himc_error *error);
/// Adds a roll of so many strokes a second; `roll` has its kind, first beat, length and dynamics.
/// Returns how many of its strokes are left out, too near to others (0 if it is given up, which a
/// note says); -1 with the reason.
int himc_planner_add_roll(himc_planner *planner, const himc_stroke *roll, int drum, double rate,
                          himc_error *error);
/// True if so many strokes can be added behind those of the score, as far as they are no rolls;
/// else the reason.
bool himc_planner_has_room(const himc_planner *planner, const himc_stroke *strokes, int count,
                           himc_error *error);
/// Replaces the tempo map (copied); beats must rise. While playing, the current beat stays where it
/// is.
bool himc_planner_set_tempi(himc_planner *planner, const himc_tempo_change *tempi, int count,
                            himc_error *error);
/// Exchanges the strokes with those of `other`, which does not play. The plan so far stays, and
/// goes on as it would if these strokes had been there from the start. False, and nothing changed,
/// if a stroke differs on which the plan so far may rest, if the tempo maps differ, while looping,
/// or after the end.
/// Before `play` the plan rests on none.
bool himc_planner_exchange(himc_planner *planner, himc_planner *other);
/// A hand's strokes before this time (s of the score) can no longer be exchanged; later ones can,
/// if their beats and places stay. Infinite after the end.
double himc_planner_rests_to(himc_planner *planner, himc_hand hand);
/// Drops all strokes; moving sticks come to rest. Stops and goes to beat 0, but a loop that plays
/// turns on, and begins again on a whole beat when strokes are added.
void himc_planner_clear(himc_planner *planner);

/// Beside its strokes the score has something up to that beat, -1: nothing. It ends after it.
HIMC_RT void himc_planner_last_until(himc_planner *planner, double beat);
HIMC_RT double himc_planner_until(const himc_planner *planner);
/// The last beat of its strokes, -1 without any.
HIMC_RT double himc_planner_last_beat(const himc_planner *planner);
/// Starts the transport at time `t` (s) from the current beat, or from beat 0 if all has been
/// played; does nothing while strokes are still to come. The first beat waits until the first
/// stroke can be prepared.
HIMC_RT void himc_planner_play(himc_planner *planner, double t);
/// Stops. A stroke less than 80 ms away is still played, waiting hits are dropped. `play` goes on
/// from this beat.
HIMC_RT void himc_planner_stop(himc_planner *planner, double t);
/// Goes to a beat, playing or not. If it plays, and the first stroke there cannot be prepared in
/// time, a note says by how much all beats are late.
HIMC_RT void himc_planner_seek(himc_planner *planner, double t, double beat);
/// If `on`, the score and its tempo map begin again at its length. If not, the round under way is
/// the last.
HIMC_RT void himc_planner_loop(himc_planner *planner, double t, bool on);
/// The same of the beats from one up to another (infinite: all). Beyond them it goes to the first.
HIMC_RT void himc_planner_loop_beats(himc_planner *planner, double t, double from, double to);
/// The whole beat after the last stroke, or at or after himc_planner_last_until, or else the one
/// that is asked for, at which a loop begins again; 0 if the score is empty.
HIMC_RT double himc_planner_length(const himc_planner *planner);
/// The beat with which a loop begins again.
HIMC_RT double himc_planner_loop_begin(const himc_planner *planner);
/// First beat for another score that shall follow this one: its length, or a later beat if that is
/// past, too near to prepare for at `t`, or so near to the last stroke that it could not be one.
HIMC_RT double himc_planner_next_start(const himc_planner *planner, double t);
/// The tempo map (*count), borrowed.
HIMC_RT const himc_tempo_change *himc_planner_tempi(const himc_planner *planner, int *count);
HIMC_RT bool himc_planner_is_looped(const himc_planner *planner);
/// True if it repeats some beats alone.
HIMC_RT bool himc_planner_loops_beats(const himc_planner *planner);
/// Adds a ramp or a change to the tempo map, or replaces that on its beats; as
/// himc_planner_set_tempi.
bool himc_planner_add_tempo(himc_planner *planner, const himc_tempo_ramp *ramp, himc_error *error);
/// Appends a tempo map (copied) that holds from `beat` on; later changes of the old one are
/// dropped.
bool himc_planner_append_tempi(himc_planner *planner, const himc_tempo_change *tempi, int count,
                               double beat, himc_error *error);
/// Sets the tempo (1 .. 1000 beats per minute) from `t` (s) to the next change of the tempo map; in
/// a loop in place of the one valid at `t`, in later rounds too.
/// The motion stays C2; a stroke less than 80 ms away keeps its time.
HIMC_RT void himc_planner_tempo(himc_planner *planner, double t, double bpm);

/// A stroke as soon as the gesture allows, at least 0.12 s from any other of that hand. Returns the
/// time of its touch (s); infinity if it is given up, because four wait already or there is no gap.
/// HIMC_HAND_ANY: the nearer and better rested hand plays it.
HIMC_RT double himc_planner_hit(himc_planner *planner, double t, const himc_stroke *stroke,
                                int drum);
/// A hit that touches at its time, as strong as the time until then allows: in a hurry it is
/// softer, and a soft one that must fall far is louder. The hand asked for plays it; the other one
/// if that has less than 60 ms for it or cannot get there; of HIMC_HAND_ANY the nearer and better
/// rested. Returns the time, varied as by himc_planner_set_human; infinity if no hand can play it:
/// it is given up, and a note counts it.
HIMC_RT double himc_planner_hit_at(himc_planner *planner, double t, const himc_hit *hit);
/// The tip is in this state at t. A himc_planner_hit_at that is to touch within 10 ms is planned
/// anew from there, once, so that what has drifted is not late. True if the plan has changed.
HIMC_RT bool himc_planner_correct(himc_planner *planner, himc_hand hand, double t,
                                  const himc_target *measured);
/// A live target: the tip goes there smoothly and stays until the next target or stroke. Targets
/// within 0.3 s of each other are a stream (10 Hz .. 1 kHz): the tip follows one period late and
/// comes to rest when the stream ends. A stroke less than 0.6 s away is played first.
HIMC_RT void himc_planner_reach(himc_planner *planner, double t, himc_hand hand, himc_vec3 x);

/// The hand lays itself down: its tip goes to x, comes to rest there at `at` (s) or as soon as it
/// can, and stays until its next stroke or target. False, and nothing changed, if a stroke is near,
/// the place is out of reach, or the hands would meet there.
HIMC_RT bool himc_planner_lay(himc_planner *planner, double t, himc_hand hand, himc_vec3 x,
                              double at);
/// The hand goes from there to where it rests; false if a stroke takes it away anyway.
HIMC_RT bool himc_planner_lift(himc_planner *planner, double t, himc_hand hand);

/// The next step of a ramp of tempo in a loop, if it is due; call it before each advance.
HIMC_RT void himc_planner_follow_ramp(himc_planner *planner);
/// Drops past strokes and plans at least 30 ms (in practice whole strokes) beyond `t` (s, never
/// backwards). Call at least every task period.
HIMC_RT void himc_planner_advance(himc_planner *planner, double t);

/// Checks all that is planned after `t` again (himc_hand_is_sound), and drops what a body could not
/// follow: its hand then rests.
HIMC_RT void himc_planner_recover(himc_planner *planner, double t);
/// Rehearses what is planned with the whole body, and lets the hands pass each other where they
/// would meet, for so much `work`, counted in postures of the body, and one moment more. What is
/// left is done at the next calls. Changes begin at least 12 ms after the last advance.
HIMC_RT void himc_planner_think(himc_planner *planner, double work);
HIMC_RT long himc_planner_work(const himc_planner *planner);
/// The planned state of a tip at `t` (s), between the last advance and 30 ms after it. Pure.
HIMC_RT himc_target himc_planner_target(const himc_planner *planner, himc_hand hand, double t);
/// The tip left the head at `t` in this measured state: the plan goes on from there, C2. A stroke
/// planned up to 30 ms later counts as played. Without this call the plan follows a predicted
/// rebound, 7 ms after the touch. A state that is not finite is ignored.
HIMC_RT void himc_planner_separated(himc_planner *planner, himc_hand hand, double t,
                                    const himc_target *measured);

/// The tip is in this state at `t`, not in the planned one: all is planned again from there, C2. A
/// state that is not finite is ignored.
HIMC_RT void himc_planner_resume(himc_planner *planner, double t, himc_hand hand,
                                 const himc_target *state);

/// The current stroke of a hand at `t`, its drum and the planned time of contact: the stroke to be
/// played next, until 50 ms after its time or half way to the one after it. The spot of a varied
/// stroke is where it will be played, the beat of a hit NaN; `stroke` may be NULL. False if there
/// is none.
HIMC_RT bool himc_planner_current(const himc_planner *planner, himc_hand hand, double t,
                                  himc_stroke *stroke, int *drum, double *contact_time);
#define HIMC_PLANNER_NAME 112 ///< of a stroke as a line names it, with its final 0 (bytes)
/// Names that stroke as a line for the user does; false if none is planned.
HIMC_RT bool himc_planner_name_current(const himc_planner *planner, himc_hand hand, double t,
                                       char text[HIMC_PLANNER_NAME]);
/// Its word for an ornament of grace notes.
HIMC_RT const char *himc_grace_name(himc_ornament ornament);
/// How far the spot of that stroke is moved aside, as the hands would have met (m); usually 0.
HIMC_RT double himc_planner_yields(const himc_planner *planner, himc_hand hand, double t);

/// Beat at time `t`; negative when stopped. Before the first beat it is that beat; in a loop it
/// begins again; when the score is over it goes on until `play`, `stop`, `seek` or `loop`.
HIMC_RT double himc_planner_beat(const himc_planner *planner, double t);
/// Tempo at time `t` (beats per minute).
HIMC_RT double himc_planner_bpm(const himc_planner *planner, double t);
/// Round of the loop at time `t` since it began to play, from 0.
HIMC_RT long himc_planner_round(const himc_planner *planner, double t);
/// True between `play` or `seek` and the first beat, while the first stroke is being prepared.
HIMC_RT bool himc_planner_is_preparing(const himc_planner *planner, double t);
/// Then, of a cleared loop that begins again: its beats before, which go on; else -1.
HIMC_RT double himc_planner_count(const himc_planner *planner, double t);
/// End of the last stroke's contact, as predicted, or of all else (s). Infinite while stopped or in
/// a loop.
HIMC_RT double himc_planner_end(const himc_planner *planner);
/// Strokes of the score given up since the last call.
HIMC_RT int himc_planner_given_up(himc_planner *planner);
/// Takes the oldest stroke of score or hit that is given up; false if there is none. It is told as
/// soon as it is known, before its time. The latest 256 are kept.
HIMC_RT bool himc_planner_miss_next(himc_planner *planner, himc_planner_miss *miss);
/// The score is over: the tips come to rest as planned, play begins at the top. Adds a note with
/// the count of strokes since the last `play` that were not played as written, if there is more
/// than one.
HIMC_RT void himc_planner_finish(himc_planner *planner);
/// Takes the oldest note; false if there is none. 32 are kept; the last one counts those that are
/// lost.
HIMC_RT bool himc_planner_note_next(himc_planner *planner, himc_planner_note *note);

#endif
