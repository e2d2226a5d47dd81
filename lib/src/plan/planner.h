/// planner.h: from strokes to the trajectories of the two drumstick tips.
///
/// Each hand's trajectory is made of quintics in space joined with equal position, velocity and
/// acceleration (C2). The planner knows nothing of bodies or sound: it is told where the drums
/// stand, how far a hand reaches and, at separation, how the tip really moves. What a player would
/// not do is made smaller or later, left to the other hand or given up, and a note says so.
#ifndef HIMC_PLANNER_H
#define HIMC_PLANNER_H

#include "base/quintic.h"
#include "himc/score.h"
#include "capture/units.h"
#include "capture/units.h"
#include "capture/units.h"

typedef struct himc_planner_config {
    double mallet_radius;       ///< the tip is the mallet's centre: it touches at this height (m)
    himc_vec3 rest[HIMC_HANDS]; ///< where a tip waits when there is nothing to play (m)
    /// How far beyond that hand's reach a place is (m), 0 within it; HIMC_RT. NULL: all is in
    /// reach.
    double (*beyond)(const void *body, himc_hand hand, himc_vec3 place);
    const void *body; ///< given to `beyond`; borrowed
} himc_planner_config;

himc_planner_config himc_planner_default(void);

typedef struct himc_planner himc_planner;

/// What the planner wants said to the user; each is one line.
typedef struct himc_planner_note {
    char text[160];
} himc_planner_note;

himc_planner *himc_planner_new(const himc_planner_config *config, himc_error *error);
void himc_planner_free(himc_planner *planner);

/// Drum `index` (0 .. HIMC_DRUMS-1) stands there from now on; strokes planned but not begun go to
/// the new place.
HIMC_RT bool himc_planner_set_drum(himc_planner *planner, int index, const himc_head_frame *place);

#define HIMC_UNITS 256

/// Motion units to be played in place of the built-in strokes of their nuance and hand (copied,
/// added to those there are). False, and nothing added, if there are more than HIMC_UNITS.
bool himc_planner_add_units(himc_planner *planner, const himc_unit *units, int count,
                            himc_error *error);
/// Back to the built-in strokes.
HIMC_RT void himc_planner_clear_units(himc_planner *planner);
/// Units of this grip (himc_grip) are preferred.
HIMC_RT void himc_planner_set_grip(himc_planner *planner, int grip);

/// Adds a stroke of the score at its beat, for drum `index`; may allocate. Strokes may come in any
/// order; two strokes of one hand closer than 40 ms are refused.
bool himc_planner_add(himc_planner *planner, const himc_stroke *stroke, int drum,
                      himc_error *error);
/// Replaces the tempo map (copied); beats must rise. While playing, the current beat stays where it
/// is.
bool himc_planner_set_tempi(himc_planner *planner, const himc_tempo_change *tempi, int count,
                            himc_error *error);
/// Stops, forgets all strokes and goes to beat 0; sticks under way come to rest.
void himc_planner_clear(himc_planner *planner);

/// Starts the transport at time `t` (s) from the current beat, or from beat 0 if all has been
/// played; does nothing while something is still to come. If the first stroke could not be prepared
/// in time, all beats are moved later by as much as it needs, and a note says so.
HIMC_RT void himc_planner_play(himc_planner *planner, double t);
/// Stops; a stroke less than 80 ms away is still played, waiting hits are not. `play` goes on from
/// this beat.
HIMC_RT void himc_planner_stop(himc_planner *planner, double t);
/// Goes to a beat, playing or not.
HIMC_RT void himc_planner_seek(himc_planner *planner, double t, double beat);
/// Whether the score begins again at the whole beat after its last stroke, until told otherwise.
/// The tempo map begins again too; a score that is switched off plays to its end.
HIMC_RT void himc_planner_loop(himc_planner *planner, double t, bool on);
/// The whole beat after the last stroke: where a loop turns round; 0 without strokes.
HIMC_RT double himc_planner_length(const himc_planner *planner);
/// What another score must begin at to follow this one: its length, or later if that is past or too
/// near to prepare for at `t`.
HIMC_RT double himc_planner_next_start(const himc_planner *planner, double t);
/// Appends a tempo map (copied) that holds from `beat` on; what the old one says after that is
/// dropped.
bool himc_planner_append_tempi(himc_planner *planner, const himc_tempo_change *tempi, int count,
                               double beat, himc_error *error);
/// At this tempo (1 .. 1000 beats per minute) from `t` (s) to the next change the tempo map has.
/// The motion under way is bent, C2, never jumped; a stroke less than 80 ms away keeps its time.
HIMC_RT void himc_planner_tempo(himc_planner *planner, double t, double bpm);

/// A stroke as soon as the gesture allows and no other of that hand is within 0.12 s. Returns the
/// time at which it will touch (s); infinity if it is given up, because four wait already or there
/// is no gap.
HIMC_RT double himc_planner_hit(himc_planner *planner, double t, const himc_stroke *stroke,
                                int drum);
/// A live target: the tip goes there, smoothly, and stays until the next one or the next stroke.
/// Targets that come within 0.3 s of each other are a stream (10 Hz .. 1 kHz): the tip follows it
/// one period late and comes to rest when it ends. A stroke less than 0.6 s away is played first.
HIMC_RT void himc_planner_reach(himc_planner *planner, double t, himc_hand hand, himc_vec3 x);

/// Brings plans up to time `t` (s, never backwards): drops what is past, plans at least 30 ms (in
/// practice whole strokes) ahead. Call at least every task period.
HIMC_RT void himc_planner_advance(himc_planner *planner, double t);
/// The planned state of a tip at `t` (s), between the last advance and 30 ms after it. Pure.
HIMC_RT himc_target himc_planner_target(const himc_planner *planner, himc_hand hand, double t);
/// The tip left the head at `t` in this measured state: the plan goes on from there, C2. Any stroke
/// planned up to 30 ms later counts as struck. Without this call the plan follows a predicted
/// rebound, 7 ms after the touch. A state that is not finite is ignored.
HIMC_RT void himc_planner_separated(himc_planner *planner, himc_hand hand, double t,
                                    const himc_target *measured);

/// The tip is in this state at `t`, wherever the plan had it: the plan goes on from there, C2. What
/// was planned is planned anew. A state that is not finite is ignored.
HIMC_RT void himc_planner_resume(himc_planner *planner, double t, himc_hand hand,
                                 const himc_target *state);

/// The stroke that hand is on or about to play at `t`: its drum, spot and planned time of contact.
/// A stroke is the current one until 50 ms after its time, or half way to the next. False if none.
HIMC_RT bool himc_planner_current(const himc_planner *planner, himc_hand hand, double t,
                                  himc_stroke *stroke, int *drum, double *contact_time);

/// Beat at time `t`, or a negative number when stopped. Before the first beat it is that beat; in a
/// loop it begins again.
HIMC_RT double himc_planner_beat(const himc_planner *planner, double t);
/// Time after which nothing is left to play (s): the last stroke and its coming to rest. Infinite
/// while stopped.
HIMC_RT double himc_planner_end(const himc_planner *planner);
/// Strokes of the score given up since the last call.
HIMC_RT int himc_planner_given_up(himc_planner *planner);
/// A note of how many strokes since the last `play` were not played as written, if more than one.
HIMC_RT void himc_planner_sum_up(himc_planner *planner);
/// Takes the oldest note; false if there is none. At most 32 are kept; what is lost is counted in
/// the last.
HIMC_RT bool himc_planner_note_next(himc_planner *planner, himc_planner_note *note);

#endif
