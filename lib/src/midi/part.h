/// part.h: a percussionist's part made of a MIDI file: heads, strokes, pedals, hands.
///
/// himc_midi_join fills it with the notes to be played, himc_midi_tune and himc_midi_kit give each
/// its head, himc_midi_stick its hand. A note that is not played keeps the reason.
#ifndef HIMC_MIDI_PART_H
#define HIMC_MIDI_PART_H

#include "base/argument.h"
#include "midi/import.h"
#include "midi/smf.h"

#define MIDI_HEADS HIMC_DRUMS ///< most of a part
#define MIDI_UNTUNED (-2)     ///< of midi_head.key: it is used as it is made

/// Keys of drums that General MIDI does not have.
enum {
    MIDI_BASS_DRUM = 128,
    MIDI_TAM_TAM,
    MIDI_TEMPLE_BLOCKS,
    MIDI_LOW_TEMPLE_BLOCK, ///< and four more, up to the high one
    MIDI_MIDDLE_BLOCK = MIDI_LOW_TEMPLE_BLOCK + 5,
    MIDI_LOW_COWBELL,
    MIDI_HIGH_COWBELL,
    MIDI_NO_SOUND,
    MIDI_KEY_COUNT
};

enum { MIDI_CLOSED_HATS = 42, MIDI_PEDAL_HATS = 44, MIDI_OPEN_HATS = 46 }; ///< General MIDI's

/// A snare drum's, whose rolls are double or pressed.
static inline bool himc_midi_is_snare(int key)
{
    return key == 38 || key == 40;
}

/// What became of a note.
typedef enum midi_fate {
    MIDI_PLAYED,
    MIDI_OTHER_INSTRUMENT, ///< no percussion
    MIDI_OTHER_PART,       ///< of percussion that is not asked for
    MIDI_NO_INSTRUMENT,    ///< of the drum channel: what no stick strikes
    MIDI_FOOT_ROLL,        ///< a foot plays no roll
    MIDI_TOGETHER,         ///< with another one on the same head: they are one stroke
    MIDI_NO_DRUM,          ///< no drum could be tuned in time
    MIDI_NO_HAND,          ///< both hands are busy
    MIDI_LOST_STROKE,      ///< one of these two, of a stroke of a note that has others
    MIDI_FATES
} midi_fate;

/// Where a head stands, and its pitch.
typedef struct midi_head {
    const char *name;   ///< static
    char made[40];      ///< the words of `instrument` after its name; "": a drum ...
    double inches;      ///< ... of this diameter
    double x, y, z;     ///< of its centre (m)
    double tilt;        ///< (rad)
    double radius;      ///< (m)
    double side, depth; ///< of a row: from its middle to its ends; of bars: to its edges (m)
    int key;            ///< tuned so at first (MIDI key), MIDI_UNTUNED; -1: the head is not used
    midi_choice choice; ///< its kind
} midi_head;

/// A roll that a stroke begins.
typedef struct midi_roll {
    double length;       ///< (beats); 0: none
    double last_dynamic; ///< 0 .. 1
    double end;          ///< (s)
} midi_roll;

/// What a pedal does before a stroke.
typedef enum midi_opening { MIDI_AS_IT_IS, MIDI_CLOSE, MIDI_OPEN } midi_opening;

/// A stroke of the part.
typedef struct midi_stroke {
    const midi_note *note; ///< borrowed from the file
    int order, orders;     ///< of the file, since the stroke before: the first, how many
    midi_choice choice;    ///< of its instrument
    int key;               ///< of the note, of timpani moved by octaves into their range
    midi_fate fate;
    int head; ///< its index
    himc_spot spot;
    char part[HIMC_PART_SIZE]; ///< of the instrument; "": all of it
    double x, y;               ///< of that part, from the instrument's centre (m)
    midi_opening pedal;
    bool foot; ///< a foot plays it
    himc_hand hand;
    double dynamic; ///< 0 .. 1
    double end;     ///< of the note; a hand is back on the head after 0.15 s at the earliest (s)
    bool damped;    ///< at the end of its note
    bool in_roll;   ///< another stroke's roll plays it
    midi_roll roll;
} midi_stroke;

/// A pedal that moves.
typedef struct midi_pedal {
    double seconds;     ///< when it begins (s)
    double length;      ///< (s)
    int head, from, to; ///< (MIDI keys)
    bool heard;         ///< the drum rings meanwhile
} midi_pedal;

typedef struct midi_part {
    const midi_file *file;  ///< borrowed
    midi_choice choice;     ///< not MIDI_ANY; of several the first
    unsigned kinds, others; ///< a bit each: that are played, and that are not asked for
    himc_score *setup;      ///< owned; its instruments are all that there are; or NULL
    midi_head head[MIDI_HEADS];
    int heads, taken;    ///< how many, and by other kinds of the part
    midi_stroke *stroke; ///< in the order of time (count), owned
    int count;
    midi_pedal *pedal; ///< in the order of time (pedals), owned
    int pedals;
    int fate[MIDI_FATES];      ///< notes of the file
    int notes;                 ///< of the part, as written
    char bars[MIDI_FATES][48]; ///< of notes that are not played
    int octaves[MIDI_CHOICES]; ///< by which all notes of a keyboard are moved
    int moved;                 ///< notes by octaves alone
    int damped;                ///< strokes
    int untuned;               ///< orders to tune that no drum can follow
    int mallets;               ///< changes of mallets that are not played
    int hoopless;              ///< strokes beyond a head that has no hoop or shell
    int rolls, rolled;         ///< rolls, and the notes in them
} midi_part;

/// When the hands leave a stroke's head: of a roll its end (s).
static inline double himc_midi_stroke_end(const midi_stroke *stroke)
{
    return stroke->roll.length > 0 ? stroke->roll.end : stroke->note->seconds;
}

/// Of two strokes on one head (but for drums: of one pitch) at the same time one is played, the
/// louder.
void himc_midi_join(midi_part *part);

#define MIDI_KEYS 4 ///< of a state; as many as timpani

/// A state of a search after a stroke; what its parts mean is the search's own.
typedef struct midi_state {
    double cost;
    int32_t key[MIDI_KEYS];   ///< states with equal ones are one, the cheapest of them
    double ready[MIDI_KEYS];  ///< of timpani: a drum may be retuned from then on ...
    double sounds[MIDI_KEYS]; ///< ... rather after that: its note is written so long (s)
    double foot;              ///< ... and the foot is free (s)
    int glides;               ///< the drum of the last gliss, 0 at first, which ...
    double arrives;           ///< ... ends then (s); 0: there was none
} midi_state;

/// The state after a stroke for which that was chosen; false if it cannot be.
typedef bool midi_choose(const midi_part *part, int stroke, int choice, midi_state *state);

/// beam.c: finds for each stroke that is to be played one of the `choices` (`chosen`: count), so
/// that all together cost least. The last choice must always be possible. False without memory.
bool himc_midi_search(const midi_part *part, const midi_state *first, int choices,
                      midi_choose *choose, int8_t *chosen);

/// timpani.c: gives each stroke one of four timpani, with pedals that move between notes. False
/// without memory.
bool himc_midi_tune(midi_part *part, himc_error *error);

/// kit.c: gives each stroke of the drum channel its instrument.
void himc_midi_kit(midi_part *part);
/// Cuts "tom 14" to "tom" and returns 14 (inches); 0 without a size.
double himc_midi_split_size(char *made);
/// What the report says of a key of the drum channel, "" if it is played as written; returns its
/// notes.
int himc_midi_tell_key(const midi_part *part, int key, char *line, size_t size);

/// The key of an instrument of the kit, struck at that spot of that part ("": any); of a hi-hat
/// open or closed; -1: none.
int himc_midi_key_of(const char *instrument, const char *part, himc_spot spot, bool open);
/// The instrument of the kit with that name, else of that kind the one nearest in size, of those
/// not among `used` (names, NULL after the last) while there are any; "" without. Borrowed, static.
const char *himc_midi_instrument_like(const char *name, const char *kind, double size,
                                      const char *const *used);
/// The concert instrument that a text ends with: its key from 128; else 0.
int himc_midi_concert_key(const char *text, size_t size);
/// Where the instrument of that key of the kit is struck.
himc_spot himc_midi_key_spot(int key);
/// What General MIDI calls a key; "" if it has none.
const char *himc_midi_key_sound(int key);

/// keyboard.c: the timpani or keyboard of a program of General MIDI (0 .. 127), else MIDI_ANY.
midi_choice himc_midi_program_choice(int program);
/// "C#3".
void himc_midi_key_name(char name[HIMC_NOTE_SIZE], int key);
/// Gives each stroke its bar.
void himc_midi_keyboard(midi_part *part);

/// layout.c: puts instruments of several kinds, or drums that are no set, around one player.
void himc_midi_lay_out(midi_part *part);

/// sticking.c: gives each stroke a hand. False without memory.
bool himc_midi_stick(midi_part *part, himc_error *error);

/// rolls.c: finds the rolls among the strokes that have heads.
void himc_midi_find_rolls(midi_part *part);

#endif
