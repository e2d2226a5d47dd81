/// part.h: a percussionist's part made of a MIDI file: heads, strokes, pedals, hands.
///
/// himc_midi_join fills it with the notes to be played, himc_midi_tune and himc_midi_kit give each
/// its head, himc_midi_stick its hand. A note that is not played keeps the reason.
#ifndef HIMC_MIDI_PART_H
#define HIMC_MIDI_PART_H

#include "midi/smf.h"

#define MIDI_HEADS 5 ///< most of a part

/// What became of a note.
typedef enum midi_fate {
    MIDI_PLAYED,
    MIDI_OTHER_INSTRUMENT, ///< neither timpani nor drums
    MIDI_OTHER_PART,       ///< of the drums, while the timpani are played, or the other way round
    MIDI_NOT_A_HEAD,       ///< of the drum channel: cymbals, shakers, metal
    MIDI_TOGETHER,         ///< with another one on the same head: they are one stroke
    MIDI_NO_DRUM,          ///< no drum could be tuned in time
    MIDI_NO_HAND,          ///< both hands are busy
    MIDI_FATES
} midi_fate;

/// Where a head stands, and its pitch.
typedef struct midi_head {
    const char *name; ///< static
    double inches;    ///< diameter
    double x, y, z;   ///< of its centre (m)
    double radius;    ///< (m)
    int key;          ///< tuned so at first (MIDI key); -1: the head is not used
} midi_head;

/// A roll that a stroke begins.
typedef struct midi_roll {
    double length;       ///< (beats); 0: none
    double last_dynamic; ///< 0 .. 1
} midi_roll;

/// A stroke of the part.
typedef struct midi_stroke {
    const midi_note *note; ///< borrowed from the file
    int key;               ///< of the note, of timpani moved by octaves into their range
    midi_fate fate;
    int head; ///< its index
    himc_spot spot;
    himc_hand hand;
    double dynamic; ///< 0 .. 1
    double end;     ///< of the note: a hand is not back on the head sooner than 0.15 s (s)
    bool damped;    ///< at the end of its note
    bool in_roll;   ///< another stroke's roll plays it
    midi_roll roll;
} midi_stroke;

/// A pedal that moves.
typedef struct midi_pedal {
    double seconds;     ///< when it begins (s)
    double length;      ///< (s)
    int head, from, to; ///< (MIDI keys)
} midi_pedal;

typedef struct midi_part {
    bool timpani; ///< else the drum channel
    midi_head head[MIDI_HEADS];
    int heads;
    midi_stroke *stroke; ///< in the order of time (count), owned
    int count;
    midi_pedal *pedal; ///< in the order of time (pedals), owned
    int pedals;
    int fate[MIDI_FATES]; ///< notes of the file
    int moved;            ///< by octaves
    int damped;           ///< strokes
    int rolls, rolled;    ///< rolls, and the strokes in them
} midi_part;

/// Of two strokes on one head (of timpani: of one pitch) at the same time one is played, the
/// louder.
void himc_midi_join(midi_part *part);

#define MIDI_KEYS 4 ///< of a state; as many as timpani

/// A state of a search after a stroke; what its parts mean is the search's own.
typedef struct midi_state {
    double cost;
    int32_t key[MIDI_KEYS];  ///< states with equal ones are one, the cheapest of them
    double ready[MIDI_KEYS]; ///< of timpani: a drum may be retuned from then on ...
    double foot;             ///< ... and the foot is free (s)
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

/// kit.c: gives each stroke of the drum channel its head.
void himc_midi_kit(midi_part *part);

/// sticking.c: gives each stroke a hand. False without memory.
bool himc_midi_stick(midi_part *part, himc_error *error);

/// rolls.c: finds the rolls among the strokes that are played.
void himc_midi_find_rolls(midi_part *part);

#endif
