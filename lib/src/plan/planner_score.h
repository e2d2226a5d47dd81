/// planner_score.h: the strokes of both hands, the tempo map and the position in them: which stroke
/// is due when. Knows nothing of motion.
#ifndef HIMC_PLANNER_SCORE_H
#define HIMC_PLANNER_SCORE_H

#include "base/head_frame.h"
#include "himc/score.h"

#define BEAT_ROUNDING 1e-9 ///< of a time in seconds, in beats
/// Times of beats that differ by less are equal (s). Chosen: up to beat 1e10 at 1 beat a minute.
#define TIME_ROUNDING 1e-4

typedef struct planner_stroke {
    himc_stroke stroke;
    int drum;
    long settled; ///< names the round in which it was reassigned or given up last; 0: none
} planner_stroke;

/// A roll: its strokes are made when they are asked for (planner_roll.h).
typedef struct planner_roll {
    himc_stroke stroke; ///< its kind, first beat, length and dynamics
    int drum;
    double rate; ///< strokes of both hands (1/s)
} planner_roll;

/// A stroke of the score.
typedef struct planner_place {
    int roll;   ///< -1: it is of its hand's list
    int number; ///< in the roll or the list; in no place of the score: -1
    int round;  ///< of the loop
} planner_place;

/// From here on the strokes of a roll have been counted anew.
typedef struct planner_anchor {
    bool any;
    himc_hand lead;          ///< hand of the roll's first stroke
    int roll, round, number; ///< the last stroke that stays ...
    double time;             ///< ... so long after the beginning of its round (s) ...
    double kept;             ///< ... and at this time, whatever the tempo (s)
} planner_anchor;

/// A stroke of a roll that was reassigned or given up.
typedef struct planner_mark {
    long name; ///< of its round; 0: none
    int roll, number;
} planner_mark;

#define PLANNER_MARKS 32 ///< chosen: twice the strokes that can be planned

/// The strokes of one hand.
typedef struct planner_part {
    planner_stroke *list; ///< owned, sorted by beat
    int count, room;
    planner_place listed; ///< first of the list that is not planned
    int looked;           ///< so many of the list have been looked at out of turn, since play began
    planner_place rolls;  ///< first stroke of the rolls that is not planned
    planner_mark mark[PLANNER_MARKS]; ///< a ring ...
    int marks;                        ///< ... and its next place
} planner_part;

typedef struct planner_score {
    planner_part part[HIMC_HANDS];
    planner_roll *roll; ///< owned, sorted by beat
    int roll_count, roll_room;
    planner_anchor anchor;
    himc_tempo_change *tempi; ///< owned
    int tempo_count;
    bool playing;
    bool over;     ///< played to its end: its beats go on, and play begins at the top
    bool goes_on;  ///< it plays after its end, what was added; play begins at the top
    double origin; ///< time of beat 0 while playing or over (s)
    double beat;   ///< where play begins or began
    bool loop;
    bool empties;    ///< the loop turns without strokes: with the first ones it begins again
    double count;    ///< then, until it begins: time of beat 0 of the beats before; else NaN (s)
    double from, to; ///< beats that the loop repeats; `to` infinite: all
    int rounds;      ///< without loop: the last round to be played
    int starts;      ///< of the transport, so far
    int past;        ///< rounds of the loop played before round 0
    double until;    ///< last beat of what the score has beside strokes, -1: none
    const himc_head_frame *drum; ///< places of all drums; borrowed; NULL: all in one place
} planner_score;

/// A stroke of the score with its place in it.
typedef struct planner_due {
    himc_stroke stroke;
    int drum;
    planner_place place;
    double time; ///< (s)
} planner_due;

/// A beat on which one hand or both strike.
typedef struct planner_onset {
    double beat; ///< through all rounds, as himc_planner_score_total_beat
    bool strikes[HIMC_HANDS];
} planner_onset;

/// A walk back through the strokes of both hands.
typedef struct planner_walk {
    int at[HIMC_HANDS]; ///< strokes of the round that are still to come
    int round;
    double before; ///< beats of the rounds before it
    planner_place rolls;
} planner_walk;

/// False without memory.
bool himc_planner_score_init(planner_score *score);
void himc_planner_score_free(planner_score *score);

bool himc_planner_score_has_room(const planner_score *score, const himc_stroke *strokes, int count,
                                 himc_error *error);
/// Checks a stroke and makes room for it: its index in its hand's list, or -1 with the reason.
int himc_planner_score_place(planner_score *score, const himc_stroke *stroke, int drum,
                             himc_error *error);
void himc_planner_score_insert(planner_score *score, int index, const himc_stroke *stroke,
                               int drum);
/// Number of strokes with which both lists begin.
int himc_planner_score_common(const planner_part *a, const planner_part *b);
/// Drum of the first stroke from a beat on; `none` without one.
HIMC_RT int himc_planner_score_first_drum(const planner_score *score, himc_hand hand, double beat,
                                          int none);
/// Exchanges the lists of strokes, and nothing else; what has been reassigned or given up of the
/// strokes that are the same is so in both.
void himc_planner_score_exchange(planner_part *a, planner_part *b);
/// Drops the strokes of a hand, and all rolls.
void himc_planner_score_clear(planner_score *score, himc_hand hand);

/// A checked copy of a tempo map, or NULL with the reason.
himc_tempo_change *himc_planner_score_copy_tempi(const himc_tempo_change *tempi, int count,
                                                 himc_error *error);
/// Replaces the tempo map by one on the heap, which it then owns.
void himc_planner_score_take_tempi(planner_score *score, himc_tempo_change *tempi, int count);
/// One tempo up to the first change after `beat`; in a loop that plays, only in place of the one
/// valid at `beat`: the others are for later rounds.
HIMC_RT void himc_planner_score_set_tempo(planner_score *score, double beat, double bpm);
HIMC_RT double himc_planner_score_bpm(const planner_score *score, double beat);
/// True if that would change nothing while playing.
HIMC_RT bool himc_planner_score_has_tempo(const planner_score *score, double beat, double bpm);
/// Moves the origin so that `beat` is at `t`.
HIMC_RT void himc_planner_score_hold(planner_score *score, double t, double beat);

/// Before the tempo changes: of a roll that has begun, the strokes that are not planned yet will be
/// counted anew, from its last planned stroke on; all of them come after `t`.
HIMC_RT void himc_planner_score_anchor(planner_score *score, double t);
/// After the change: that last planned stroke keeps its time.
HIMC_RT void himc_planner_score_keep(planner_score *score);
/// Begins to play at score->beat at `t`.
HIMC_RT void himc_planner_score_start(planner_score *score, double t);
HIMC_RT void himc_planner_score_stop(planner_score *score, double beat);
/// Makes the round of the loop at `t` round 0, before its length changes; returns its number so
/// far.
HIMC_RT int himc_planner_score_rebase(planner_score *score, double t);
/// The next stroke of a hand, of its list or of the rolls, is the one at that place.
HIMC_RT void himc_planner_score_go(planner_score *score, himc_hand hand, planner_place place);
/// The stroke `ahead` strokes after the next of a hand; false if there is none.
HIMC_RT bool himc_planner_score_next(const planner_score *score, himc_hand hand, int ahead,
                                     planner_due *due);

/// The stroke has been reassigned or given up in that round: it is not planned again in it.
HIMC_RT void himc_planner_score_settle(planner_score *score, himc_hand hand,
                                       const planner_place *place);
HIMC_RT bool himc_planner_score_is_settled(const planner_score *score, himc_hand hand,
                                           const planner_place *place);

/// That round of a loop of some beats is the last: the hands will play what follows them.
HIMC_RT void himc_planner_score_leave_loop(planner_score *score, int last);

/// Last beat of the score, -1 if it is empty.
HIMC_RT double himc_planner_score_last_beat(const planner_score *score);
/// The round of the loop at `t`, 0 before it begins.
HIMC_RT int himc_planner_score_round_at(const planner_score *score, double t);
/// A beat of a round, counted through all rounds since play began; a change of tempo in a loop
/// leaves it as it is.
HIMC_RT double himc_planner_score_total_beat(const planner_score *score, int round, double beat);
/// Time of the beat before `beat` (s).
HIMC_RT double himc_planner_score_period(const planner_score *score, double beat);
/// Time between a beat of a round and the hand's nearest stroke on another beat, as in a loop (s);
/// infinite without strokes.
HIMC_RT double himc_planner_score_gap(const planner_score *score, himc_hand hand, int round,
                                      double beat);
/// Time since the last stroke of either hand before a beat (s), or since the beginning of a roll
/// that ends there; infinite without one.
HIMC_RT double himc_planner_score_since(const planner_score *score, double beat);
/// A walk that begins at a beat of a round ...
HIMC_RT planner_walk himc_planner_score_walk(const planner_score *score, int round, double beat);
/// ... and gives the onsets at and before it, the last one first; false when there is none left.
HIMC_RT bool himc_planner_score_back(const planner_score *score, planner_walk *walk,
                                     planner_onset *onset);
/// Time of a stroke in a round (s).
HIMC_RT double himc_planner_score_touch(const planner_score *score, int round,
                                        const himc_stroke *stroke);
/// Time of a beat in a round (s).
HIMC_RT double himc_planner_score_time(const planner_score *score, int round, double beat);
/// Beat at `t`, in its round.
HIMC_RT double himc_planner_score_beat_at(const planner_score *score, double t);

// planner_part.c: a hand's strokes, sorted

/// Time of a beat from beat 0 of its round (s).
HIMC_RT double himc_planner_score_seconds(const planner_score *score, double beat);
/// The first stroke after `beat`, or with `from` the first at it or after it.
HIMC_RT int himc_planner_part_after(const planner_part *part, double beat, bool from);
/// The first stroke of a hand that a loop repeats.
HIMC_RT int himc_planner_loop_first(const planner_score *score, const planner_part *part);
/// True if a round plays what is at that beat: a loop repeats only some beats.
HIMC_RT bool himc_planner_loop_has(const planner_score *score, int round, double beat);
/// Where a stroke comes in its hand's list: grace notes before the stroke on their beat.
HIMC_RT int himc_planner_part_place(const planner_part *part, const himc_stroke *stroke);
/// Time from a stroke to the nearest one of its hand (s); infinite without one.
HIMC_RT double himc_planner_score_room(const planner_score *score, const himc_stroke *stroke);
bool himc_planner_score_same(const himc_stroke *a, const himc_stroke *b);

// planner_roll.c: on these the rolls of a loop depend

/// The whole beat after the last stroke, or at or after all else that the score has.
HIMC_RT double himc_planner_score_length(const planner_score *score);
/// The beat at which a loop begins again.
HIMC_RT double himc_planner_loop_end(const planner_score *score);
/// Length of a round of the loop (s).
HIMC_RT double himc_planner_score_round_length(const planner_score *score);

#endif
