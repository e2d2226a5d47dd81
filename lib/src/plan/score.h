/// score.h: the reader of a score's text; private.
#ifndef HIMC_PLAN_SCORE_H
#define HIMC_PLAN_SCORE_H

#include "himc/score.h"

#define HIMC_SCORE_STROKES 200000 ///< of a file, and of a hand; chosen: more than a day of drumming

/// From one stroke of a hand to its next, at least (s). Chosen: 25 a second, faster than players.
#define HIMC_CLOSEST_STROKES 0.04

/// The score in a string, as himc_score_load reads it from a file; `name` stands for the file in
/// errors. A FILE of `setup` is read in `folder` (NULL: anywhere). Free with himc_score_free.
himc_score *himc_score_parse(const char *text, const char *name, const char *folder,
                             himc_error *error);
/// The lines that a checked `setup` stands for, as a score without strokes; NULL with the reason.
himc_score *himc_score_of_setup(const himc_command *setup, himc_error *error);

/// A tempo that moves evenly over the beats.
typedef struct himc_tempo_ramp {
    double beat;     ///< where it begins; below 0: now
    double from, to; ///< (beats per minute)
    double length;   ///< (beats); 0: it is one tempo
} himc_tempo_ramp;

/// What a checked `tempo` asks for.
himc_tempo_ramp himc_score_read_tempo(const himc_command *command);
HIMC_RT int himc_score_ramp_steps(const himc_tempo_ramp *ramp);
/// The tempo of a step (beats per minute): it takes as long as the even motion does.
HIMC_RT double himc_score_ramp_bpm(const himc_tempo_ramp *ramp, int step);
/// Puts a ramp into a tempo map of *count, which has room for its steps and one more.
void himc_score_insert_ramp(himc_tempo_change *tempi, int *count, const himc_tempo_ramp *ramp);

/// The dynamics of strokes that have none of their own; free `cresc`.
typedef struct himc_dynamics {
    struct himc_cresc {
        double beat, length; ///< (beats)
        double from, to;     ///< 0 .. 1
    } * cresc;
    int count, room;
    double from; ///< 1 + the last beat for which a stroke has got its dynamic; 0: none
} himc_dynamics;

/// As before any stroke, the memory kept.
static inline void himc_dynamics_clear(himc_dynamics *dynamics)
{
    dynamics->count = 0;
    dynamics->from = 0;
}

/// The command `cresc`; false with the reason.
bool himc_dynamics_add(himc_dynamics *dynamics, const himc_command *cresc, himc_error *error);
/// Gives a stroke or a roll its dynamic at its beat.
void himc_dynamics_give(const himc_dynamics *dynamics, himc_stroke *stroke);

/// Puts a change into a tempo map of *count that has room for it, or in place of that on its beat.
void himc_score_insert_tempo(himc_tempo_change *tempi, int *count, himc_tempo_change change);

/// The change of a drum, or the push, that the checked atoms of `at` ask for.
bool himc_score_read_change(const himc_atom *atom, int count, himc_score_line *out,
                            himc_error *error);

/// True if a roll is not longer than is allowed, with that tempo map; else the reason.
bool himc_score_accepts_roll(const himc_tempo_change *tempi, int count, const himc_stroke *roll,
                             himc_error *error);

/// True if the line makes a drum: `drum`, `instrument`.
static inline bool himc_score_makes_drum(const himc_score_line *line)
{
    return !line->drum[0] && himc_command_table((int)line->command.id)->marks & HIMC_MAKES_DRUM;
}

#endif
