/// score.h: a score file: a Pure Data text file whose lines are commands, `;` ends a line.
///
/// Strokes and tempo changes have beats; all other lines act once, in order, when the score is
/// loaded. A line that begins with a drum's name is for that drum. `tempo BPM [BEAT]` holds from
/// that beat on (0 when not given); `at BEAT DRUM COMMAND ...` changes a drum's head at that beat,
/// `at BEAT push ...` pushes the performer (commands marked HIMC_AT_BEAT). At most 200000 strokes,
/// 10000 other lines, 64 MiB; strokes of one hand at least 40 ms apart; a score cannot load a
/// score.
#ifndef HIMC_SCORE_H
#define HIMC_SCORE_H

#include "himc/command.h"
#include "himc/ranges.h"

HIMC_BEGIN

#define HIMC_TEMPO 100 ///< default (beats per minute); chosen: a walking pace

/// A tempo and the beat at which it begins; the tempo is constant up to the next change.
typedef struct himc_tempo_change {
    double beat; ///< first beat of this tempo (beats), 0 or more
    double bpm;  ///< HIMC_BPM_MIN .. HIMC_BPM_MAX; the nuances are made for 40 .. 200
} himc_tempo_change;

/// A line that is neither stroke nor tempo, or what a score has at a beat: a change of a head, a
/// push.
typedef struct himc_score_line {
    char drum[HIMC_NAME_SIZE]; ///< the drum it is for; "" for the performer
    himc_command command;      ///< of that drum, or of the performer
    int line;                  ///< in the file, from 1
    double beat;               ///< of `at` (beats), 0 or more; of other lines 0
} himc_score_line;

/// From where on bars follow each other, as a comment says: `comment bars of 3/4 from beat 2;`.
typedef struct himc_bars {
    double beat; ///< of the first of them (beats), 0 or more
    int beats;   ///< of its metre, above: 1 .. 255 ...
    int unit;    ///< ... of a whole note's part: 1 2 4 .. 64, a quarter 4
} himc_bars;

/// A score with its arrays, which it owns. Strokes are sorted by beat (stable).
typedef struct himc_score {
    himc_stroke *strokes;     ///< of both hands (stroke_count), owned
    int stroke_count;         ///< 0 .. 200000
    int *stroke_lines;        ///< in the file (stroke_count), owned
    himc_tempo_change *tempi; ///< sorted by beat (tempo_count), owned; the first at beat 0
    int tempo_count;          ///< 1 or more
    himc_score_line *lines;   ///< as in the file (line_count), owned; NULL if there are none
    int line_count;           ///< 0 .. 10000
    himc_score_line *changes; ///< `at` lines by beat (change_count), owned
    int change_count;         ///< 0 .. 10000, with the lines
    int *order;   ///< strokes and changes as in the file (stroke_count + change_count), owned: i of
                  ///< strokes, or -1 - i of changes; NULL if there are none
    char *report; ///< of MIDI, MusicXML: what is played and what not; of a text: commands that
                  ///< stand inside a comment; lines that end with \n, owned; NULL if there are none
    int left_out; ///< of MIDI, MusicXML: notes of the part that are not played, tracks that are
                  ///< missing; of a text: commands that stand inside a comment
    himc_bars *bars; ///< by beat (bar_count), owned; NULL: it does not say
    int bar_count;
} himc_score;

/// Reads the file, a score, a Standard MIDI File or MusicXML (told by its first bytes), whose parts
/// of timpani, else of drums, become a score. NULL with "file:line: ..." if anything in it is
/// wrong. Free with himc_score_free.
himc_score *himc_score_load(const char *path, himc_error *error);

/// Frees the score and its arrays. NULL is allowed.
void himc_score_free(himc_score *score);

/// Time from beat 0 to `beat` (s) through `count` (1 or more) tempo changes, sorted by beat.
HIMC_RT double himc_score_seconds(const himc_tempo_change *tempi, int count, double beat);

/// The beat at `seconds` after beat 0: the inverse of himc_score_seconds.
HIMC_RT double himc_score_beat(const himc_tempo_change *tempi, int count, double seconds);

HIMC_END

#endif
