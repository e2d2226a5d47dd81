/// smf.h: a Standard MIDI File (MIDI 1.0 Detailed Specification, 1996), read from memory: its notes
/// with their times, and its tempo map.
#ifndef HIMC_MIDI_SMF_H
#define HIMC_MIDI_SMF_H

#include "himc/score.h"

#define MIDI_DRUM_CHANNEL 9 ///< "channel 10", of General MIDI's drums

/// Whose notes are played.
typedef enum midi_choice {
    MIDI_ANY,          ///< the player of the first of these of which there are any
    MIDI_TIMPANI,      ///< program 48 of General MIDI, or a track of that name
    MIDI_DRUMS,        ///< channel 10
    MIDI_MARIMBA,      ///< program 13
    MIDI_XYLOPHONE,    ///< program 14
    MIDI_VIBRAPHONE,   ///< program 12
    MIDI_GLOCKENSPIEL, ///< program 10
    MIDI_TUBULAR_BELL, ///< program 15
    MIDI_CHOICES
} midi_choice;

/// How a note is played, as far as the file says so.
typedef struct midi_way {
    double dynamic;      ///< 0 .. 1; below 0: by the velocity
    double length;       ///< of a roll (beats); 0: none
    double last_dynamic; ///< of a roll
    himc_nuance nuance;
    double said;            ///< the dynamic that `himc export` says of it in MIDI; below 0: none
    himc_ornament ornament; ///< flam, drag, ruff or none; of a roll its kind, or none: single
    himc_spot spot;
    int hand;         ///< 1 + himc_hand; 0: any
    int drum;         ///< of timpani: 1 low .. 4 high; 0: any
    int ring;         ///< 1: it rings on, -1: it is damped at its end, 0: as usual
    bool extra;       ///< a stroke of a note that has others: a grace, a part of a tremolo
    bool begins_roll; ///< a roll that is an extra of it follows at once
} midi_way;

/// Grace notes that are played before it.
static inline int himc_midi_graces(const midi_way *way)
{
    return way->length > 0 ? 0 : way->ornament < HIMC_RUFF ? (int)way->ornament : 2;
}

/// A note of any track, from its note-on to its note-off.
typedef struct midi_note {
    double beat;        ///< of the note-on (quarter notes from the beginning), see midi_file
    double seconds;     ///< of the note-on, through the tempo map (s)
    double off;         ///< of the note-off (s); the end of the file if there is none
    int track;          ///< from 0
    int player;         ///< of several, by number from 0: a part of MusicXML, a channel of a track
    uint8_t channel;    ///< 0 .. 15
    uint8_t key;        ///< 0 .. 127; 60 is C4. From 128: drums that General MIDI lacks (part.h)
    uint8_t velocity;   ///< 1 .. 127
    uint8_t program;    ///< of its channel then, 0 .. 127
    double level;       ///< the velocity with volume, expression and pressure, 0 .. 127
    double last_level;  ///< of a roll (way.length): at its end
    midi_choice choice; ///< of its track's name; MIDI_ANY: its channel or program says it
    midi_way way;
} midi_note;

/// The beginning of a bar.
typedef struct midi_bar {
    double beat;
    int beats, unit; ///< of its metre, "3/4"; it may be shorter
    char number[12];
} midi_bar;

typedef enum midi_order_kind {
    MIDI_TUNING,
    MIDI_MUFFLE,
    MIDI_MALLET,
    MIDI_WIRES,
    MIDI_PEDAL, ///< of a vibraphone: it is up for a moment
    MIDI_DAMP   ///< of `himc export`; value: the note's key
} midi_order_kind;

/// What the player is told between notes, by MusicXML.
typedef struct midi_order {
    double beat, seconds;
    midi_order_kind kind;
    midi_choice choice; ///< whose part says it
    int from, value; ///< tuning: MIDI keys, below 24 classes of pitch, 0 C .. 11; `from`: 12 of any
                     ///< drum, 128 more for the low one by name, 256 the second, ..; 0 or 1; a
                     ///< mallet, 0 soft .. 3 wood
    bool glides;     ///< tuning: the drum is heard meanwhile, and goes on after a stroke here
    double length;   ///< ... its time (s); 0: as usual
    int line;        ///< ... as music_sign
} midi_order;

/// A file. Beats are quarter notes and the tempo map is the file's, unless `converted`.
typedef struct midi_file {
    midi_note *notes; ///< in the order of time (note_count), owned
    int note_count;
    himc_tempo_change *tempi; ///< as in a score, the first at beat 0 (tempo_count), owned
    int tempo_count;
    midi_bar *bars; ///< in the order of beats (bar_count), owned; NULL: not known
    int bar_count;
    midi_order *orders; ///< in the order of beats (order_count), owned
    int order_count;
    char *said;     ///< lines of the report that the reader makes, owned, or NULL
    int omitted;    ///< notes that the reader leaves out
    int tracks;     ///< read
    int cut;        ///< tracks that end in the middle of an event or go on behind the file's end
    int missing;    ///< tracks that the header promises and the file does not have
    double cut_at;  ///< how far the shortest of the cut tracks was read (s)
    bool converted; ///< beats are half seconds: the file has no beats (SMPTE), or a tempo that
                    ///< scores do not have
} midi_file;

/// The tempo (beats per minute) of a map at a beat.
double himc_midi_bpm(const himc_tempo_change *tempi, int count, double beat);

bool himc_midi_is_file(const void *bytes, size_t size);

/// In front of a note of `himc export`: what a velocity cannot say of a key, in a text.
#define MIDI_SAID "himc %d %s %.9g"

/// Reads a file of format 0, 1 or 2 (whose tracks follow each other). A track that ends in the
/// middle of an event is kept up to there. False with one line if the bytes are no MIDI file, or
/// hold what no event begins with. Free with himc_midi_file_free.
bool himc_midi_file_read(midi_file *file, const void *bytes, size_t size, himc_error *error);
void himc_midi_file_free(midi_file *file);

#endif
