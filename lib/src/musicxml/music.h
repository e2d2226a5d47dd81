/// music.h: a score as it is written: bars, notes and signs of all parts.
#ifndef HIMC_MUSICXML_MUSIC_H
#define HIMC_MUSICXML_MUSIC_H

#include "base/text.h"
#include "midi/part.h"
#include "musicxml/names.h"

#define MUSIC_BARS_MAX 20000               ///< of a part; chosen: no piece has as many
#define MUSIC_MADE_MAX 400000              ///< notes, signs, with repeats; more than a score has
#define MUSIC_UNSAID (-1.0)                ///< a dynamic
#define MUSIC_LINES_MAX 9                  ///< of pedals that run at once, by their numbers 1 .. 9
#define MUSIC_ATTACK_TIME 0.2              ///< (s) of an accent on a roll; chosen: two strokes
#define MUSIC_GRACE_TIME 0.04              ///< (s) between strokes of a ruff in MIDI; chosen
#define MUSIC_BYTES_MAX ((size_t)64 << 20) ///< of a file, also unpacked; chosen: a long symphony

typedef struct music_bar {
    double length;   ///< (beats); a pickup is shorter
    bool sounds;     ///< a part has a note in it
    int beats, unit; ///< of the metre
    char number[12]; ///< as printed
    bool forward, backward, segno, coda, to_coda, fine, da_capo, dal_segno;
    int times;    ///< of `backward`, 2 by default
    double hold;  ///< length of its last note, which a fermata over the barline holds; 0: none
    double split; ///< beat of a repeat in it (beats); 0: none
    bool split_back, split_on; ///< one ends there, begins there
    int said;                  ///< the same as words say it, in the bar or before; 0: none do
    unsigned endings;          ///< bit k: it is played the k-th time, from 1; 0: always
} music_bar;

typedef enum music_tremolo {
    MUSIC_NO_TREMOLO,
    MUSIC_MARKS,      ///< strokes through the stem: measured or a roll
    MUSIC_ROLL,       ///< unmeasured, or a trill
    MUSIC_PAIR_BEGIN, ///< two notes in turn
    MUSIC_PAIR_END
} music_tremolo;

/// Where a note or a sign stands.
typedef struct music_place {
    double beat;          ///< in its bar; after himc_music_order from the beginning
    int bar, part, order; ///< `order` among all of its kind
} music_place;

/// A note of a part that is played; a chord is several.
typedef struct music_note {
    music_place at;
    double length; ///< (beats); 0: a grace note, below 0: played with another one
    double rolled; ///< of a tremolo with ties (beats)
    int voice;
    int lane; ///< 100 staff + voice; 0 for one that is not written
    midi_choice choice;
    int key;
    bool concert; ///< a bass drum's name says that it is no kick
    bool grace, tied_on, tied_back, accent, marcato, staccato, tenuto;
    bool pulled;         ///< the nuance staccato, as `himc export` writes it
    bool held;           ///< under a fermata
    bool hidden;         ///< not printed, for the sound alone
    bool attacked;       ///< sf, sfz
    bool ghost;          ///< softer: a notehead in parentheses
    bool glides, glided; ///< a line of a glissando begins, ends here
    himc_spot spot;      ///< of its notehead
    int ring;            ///< 1, -1, or 0: not written
    int hand;            ///< 1 + himc_hand, or 0
    int drum;            ///< of timpani: 1 low .. 4 high; 0: not written
    double dynamic;      ///< of its own, or MUSIC_UNSAID
    bool goes_on;        ///< a roll of another voice does, from this stroke on ...
    double struck;       ///< ... of so much more
    music_tremolo tremolo;
    himc_ornament kind; ///< of a roll, as `himc export` writes it; HIMC_PLAIN: as usual
    bool pressed;       ///< of a snare drum: a z on the stem
    int upper;          ///< of a trill: semitones to its upper note, else 0
    int marks, flags;   ///< strokes through the stem; flags of the note
    double ratio;       ///< of a tuplet: written length over sounding
} music_note;

/// A sign or a word.
typedef struct music_sign {
    music_place at;
    music_meaning meaning;
    double value;
    int lane; ///< of dynamics: the notes they are beside, as theirs
    int line; ///< of MUSIC_GLISS and its end: 1 + the number of its line; 0: none
} music_sign;

/// What is left out of the score: the reason, and bars.
typedef struct music_omission {
    const char *one, *many; ///< "cue note is left out", "cue notes are left out"
    int count;
    char bars[48];
} music_omission;

enum {
    MUSIC_CUES,
    MUSIC_HIDDEN,
    MUSIC_BAD_NOTES,
    MUSIC_GRACES,
    MUSIC_ATTACKS,
    MUSIC_UNKNOWN,
    MUSIC_PEDALS,
    MUSIC_SLASHES,
    MUSIC_OMISSIONS
};

typedef struct music {
    music_bar *bars;
    int bar_count, bar_room;
    music_note *notes;
    int note_count, note_room;
    music_sign *signs;
    int sign_count, sign_room;
    music_omission omitted[MUSIC_OMISSIONS];
    char unknown[200]; ///< names of instruments that are not played
} music;

/// read.c: all of a document; false with one line if it is no score.
bool himc_music_read(music *music, const void *bytes, size_t size, himc_error *error);
void himc_music_free(music *music);

/// order.c: puts notes and signs in the order in which they are played, with repeats, on beats from
/// the beginning. `bars` of the file get their beats.
bool himc_music_order(music *music, midi_file *file, himc_error *error);
/// The first note at or after a beat, then.
int himc_music_first(const music *music, double beat);

/// swing.c: moves notes and signs between beats as words ask for.
bool himc_music_swing(music *music, const midi_file *file, himc_error *error);

/// tempo.c: makes the file's tempi of the signs.
bool himc_music_tempo(const music *music, midi_file *file, himc_error *error);

/// How loud a part is: a line through points, up or down at once where two have one beat.
typedef struct music_level {
    double beat, dynamic; ///< 0 .. 1
} music_level;

/// level.c: the points of a part's signs (`count`), of all or of a lane, owned by the caller; NULL
/// without memory.
music_level *himc_music_levels(const music *music, int part, int lane, double second, int *count);
#define MUSIC_ALL_LANES (-1)
/// True if a lane's signs are its own: somewhere another one has another dynamic at the same time.
bool himc_music_apart(const music *music, int part, int lane);
double himc_music_level(const music_level *levels, int count, double beat);

/// shape.c: makes the file's notes and orders of it.
bool himc_music_shape(music *music, midi_file *file, himc_error *error);

/// How a roll is played that does not say it. `pressed`: a z is on its stem.
static inline himc_ornament himc_music_usual_roll(midi_choice choice, int key, bool pressed)
{
    return choice != MIDI_DRUMS || !himc_midi_is_snare(key) ? HIMC_ROLL_SINGLE
           : pressed                                        ? HIMC_ROLL_PRESS
                                                            : HIMC_ROLL_DOUBLE;
}
/// The word of a kind of roll.
static inline const char *himc_music_roll(himc_ornament kind)
{
    return kind == HIMC_ROLL_PRESS ? "press" : kind == HIMC_ROLL_DOUBLE ? "double" : "single";
}

void himc_music_omit(music *music, int which, int bar);

#endif
