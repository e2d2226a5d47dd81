/// instruments.h: the instruments of a part, and which of them a written note is for.
#ifndef HIMC_MUSICXML_INSTRUMENTS_H
#define HIMC_MUSICXML_INSTRUMENTS_H

#include "musicxml/music.h"
#include "musicxml/xml.h"

#define MUSIC_INSTRUMENTS_MAX 64 ///< of a part; chosen
#define MUSIC_NAMES_MAX 6        ///< in the name of an instrument; chosen
#define MUSIC_STAVES 10          ///< of a part; 0: of a note that does not say which

typedef struct music_instrument {
    const char *id, *name; ///< borrowed from the document; "": none
    midi_choice choice;
    int key;
    int drum;                ///< of timpani: 1 low .. 4 high; 0: not said
    bool concert;            ///< its name says a concert bass drum
    bool sort;               ///< of drums of one sort, whose notes say which
    int names;               ///< "Snare Drum & Bass Drum": so many drums, of which a note is one
    int of[MUSIC_NAMES_MAX]; ///< ... from high to low
    uint64_t at[2];          ///< of both: where they are written, a bit for each pitch
} music_instrument;

/// Those of a part, and what holds where the reader is.
typedef struct music_instruments {
    music_instrument row[MUSIC_INSTRUMENTS_MAX];
    int count, declared;       ///< rows, first those of the part-list
    int part_key;              ///< what the part's name says: a drum, MUSIC_NO_KEY, MUSIC_ANY_KEY
    int current[MUSIC_STAVES]; ///< the row that words have changed to; -1: none
    int lines[MUSIC_STAVES];   ///< 5 or 1; 0: not said
    char clef[MUSIC_STAVES];   ///< its letter; '\0': not said
    bool staves;               ///< several: words are of one of them
} music_instruments;

/// Of a part's entry in the part-list; where drums of one sort are written is found in its notes.
void himc_music_instruments_read(music_instruments *of, const xml_node *list, const xml_node *part);
/// Clefs and lines.
void himc_music_instruments_attributes(music_instruments *of, const xml_node *attributes);
/// From here on notes of that staff which do not say it are of the instrument that words tell.
/// `instructs`: they tell something else, too.
void himc_music_instruments_change(music_instruments *of, int staff, const char *words,
                                   bool instructs);
/// The same by an `instrument-change`.
void himc_music_instruments_sound(music_instruments *of, int staff, const xml_node *change);
/// By the note's id, if there are several, by words, by the clef.
const music_instrument *himc_music_instrument_of(const music_instruments *of, const xml_node *note);
/// The key of the drum that is written at that pitch; MIDI_NO_SOUND: none that is known.
int himc_music_drum_of(const music_instruments *of, const xml_node *note,
                       const music_instrument *instrument, int written);
/// Of the part's notes, from the `first` on: where no other drum of a kit is, a bass drum is a
/// concert one by its name or by a roll.
void himc_music_choose_bass_drum(const music_instruments *of, music *music, int first);

/// Where a drum of a kit is written (Weinberg 1998): a pitch in treble clef. `metal`: with an x.
int himc_music_place(int key, bool *metal);
/// Where all used ones are written: other drums (true in `others`) on what is left of the staff.
void himc_music_places(const bool used[MIDI_KEY_COUNT], int place[MIDI_KEY_COUNT],
                       bool others[MIDI_KEY_COUNT]);
/// A note's pitch, or where it is written (MIDI key); -1: neither.
int himc_music_pitch(const xml_node *note);
/// Of a note or a direction.
int himc_music_staff(const xml_node *node);

#endif
