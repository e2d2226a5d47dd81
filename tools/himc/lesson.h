/// lesson.h: shared by the files of `himc lesson`: a take compared with a score.
///
///     score → asked ┐
///     take → played ┴→ match → judge → page, CSV, JSON
#ifndef LESSON_H
#define LESSON_H

#include "himc/mocap.h"
#include "himc/performance.h"

#include <stdio.h>

#define LESSON_FAULTS 32     ///< chosen: most that are kept; three are named
#define LESSON_NAMED 3       ///< faults that are named first
#define LESSON_ROLLS 1024    ///< most rolls and runs; half of them written
#define LESSON_JND_LEVEL 1.0 ///< threshold of loudness (dB)
#define LESSON_PLACE 0.02    ///< threshold of places (m)
#define LESSON_LIMBS 4       ///< shares of shoulder, elbow, wrist with grip, trunk
#define LESSON_MOST 20000    ///< strokes of a lesson; chosen: an hour
#define LESSON_RATE 8000     ///< of the model's samples (Hz); chosen: its sound is heard by no one
#define LESSON_BLOCK 512

/// A stroke of the score, as the model plays it.
typedef struct lesson_asked {
    double beat, time; ///< in the score (beats); of the model's stroke (s)
    double in_bar; ///< beat of its bar, from 1; of four beats from beat 1 on if no metre is known
    int metre;     ///< beats of that bar
    himc_hand hand;
    char nuance[HIMC_NAME_SIZE], drum[HIMC_NAME_SIZE];
    himc_vec3 x;  ///< in the world (m)
    double speed; ///< of the model's impact (m/s)
    int by;       ///< index of the played stroke; -1: missing
    bool skipped; ///< missing with a whole phrase
    bool unseen;  ///< missing where the take has a gap
} lesson_asked;

/// A strike of the take. Figures that need an asked stroke are NaN without one.
typedef struct lesson_played {
    himc_take_strike strike;
    int of;                 ///< index of the asked stroke; -1: none
    int roll;               ///< of the score, or -1
    double off;             ///< time after the beat of the player's own tempo (s)
    double steady;          ///< time after the beat of a metronome in the take's mean tempo (s)
    double level;           ///< 20 log10 of the speed over the asked one, less the take's mean (dB)
    himc_vec3 aside;        ///< place less the asked one, less the take's median (m)
    double u_time, u_level; ///< standard uncertainty by the frame rate (s, dB)
    int top;                ///< frame of the tip's highest place before the stroke
    double height, path;    ///< of the tip before the stroke; length of the fall's path (m)
    double share[LESSON_LIMBS]; ///< of the fall, by each joint; NaN without a full arm
    double torque[3];           ///< largest, of shoulder, elbow, wrist (N m); NaN likewise
    double raised;              ///< upper arm at the stroke, from hanging (degrees); NaN likewise
    bool named;                 ///< a fault is this very stroke
} lesson_played;

/// A roll of the score, or a run of equal fast strokes, and its evenness in the take.
typedef struct lesson_roll {
    double from, to;         ///< asked (s)
    double beat;             ///< of its first stroke
    bool written;            ///< a `roll`: its number of strokes is free
    int strokes;             ///< played
    double rate;             ///< (strokes a second)
    double uneven, u;        ///< standard deviation about even strokes, its uncertainty (s)
    double gallop, u_gallop; ///< every second stroke late by this (s)
    double spread;           ///< standard deviation of level (dB)
} lesson_roll;

/// A mean, or any estimate, with its standard uncertainty.
typedef struct lesson_figure {
    double mean, u;
} lesson_figure;

/// Frames of a stick that the take does not show (s).
typedef struct lesson_gap {
    himc_hand hand;
    double from, to;
} lesson_gap;

/// Something worth practising.
typedef struct lesson_fault {
    char kind[16];  ///< time level spot tempo wait skip roll missing extra hand even elbow
    char what[224]; ///< in plain words
    char how[128];  ///< of which strokes
    double effect, u, spread, threshold; ///< in `unit`; u is a standard uncertainty
    const char *unit, *source;           ///< source of the threshold
    double excess; ///< (|effect| less its 99 % bound) over the threshold; 1 and more is named
} lesson_fault;

typedef struct lesson {
    const char *score, *take, *scene; ///< names; NULL: no scene
    lesson_asked *asked;
    int asked_count, missing, unseen;
    lesson_gap *gap;
    int gaps;
    int due; ///< asked of the hands that the take shows
    lesson_played *played;
    int count, matched, extra;
    lesson_roll roll[LESSON_ROLLS];
    int rolls;
    double rate;             ///< of the take (Hz)
    bool seen[HIMC_HANDS];   ///< the take shows this hand
    lesson_figure tempo;     ///< played over asked
    double bpm;              ///< of the score at its first stroke
    double level;            ///< mean of all, against the score's dynamics (dB)
    double lead[HIMC_HANDS]; ///< of a hand named for its time; rolls are judged without it (s)
    double length;           ///< of the played strokes (s)
    double jnd;              ///< threshold of times at this tempo (s)
    int turn;                ///< places are read with the take turned by this (degrees) ...
    bool turn_sure;          ///< ... which fits much better than another right angle
    bool apart;              ///< the drums stand otherwise than the score's: each is judged alone
    bool body, torques;      ///< shares and torques are known
    double bent[HIMC_HANDS]; ///< share of the time with the wrist beyond 15 degrees
    double work[HIMC_HANDS]; ///< of an arm's joints, a stroke (J)
    lesson_fault fault[LESSON_FAULTS];
    int faults;
} lesson;

/// Gives each asked stroke its played one. False: nothing matches.
bool lesson_match(lesson *l, himc_error *error);
/// Time, level and place of each stroke, rolls, and the faults, the largest first. False: no
/// memory.
bool lesson_judge(lesson *l, himc_error *error);
/// A fault, if it is beyond its threshold by more than `bound` u; its text is empty. Else NULL.
lesson_fault *lesson_fault_add(lesson *l, const char *kind, double effect, double u, double bound,
                               double threshold);
void lesson_fault_explain(lesson_fault *f, double spread, const char *unit, const char *source);
/// A list of strokes for a fault's words.
typedef struct lesson_list {
    char text[144];
    int count, listed;
} lesson_list;

/// One more, if there is room; it is counted all the same.
void lesson_list_add(lesson_list *list, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/// The text, with " and 7 more" if there was no room.
const char *lesson_list_text(lesson_list *list);
/// How far strokes are off the beat of the player's own tempo, and off the asked level, RMS.
void lesson_scatter(const lesson *l, double *seconds, double *decibels);
/// Shares of the joints, wrist and torques, of takes that show whole arms.
void lesson_body(lesson *l, himc_take *take, const himc_take_options *options);

/// A scene of the take, and as its ghost the model, which plays the score in the player's body on
/// the player's beat.
bool lesson_scene(const lesson *l, const himc_take_options *how, FILE *out, himc_error *error);

/// `l` is a lesson.
void lesson_page(const void *l, FILE *out);
void lesson_csv(const void *l, FILE *out);
void lesson_json(const lesson *l, FILE *out);

#endif
