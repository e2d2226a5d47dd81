/// smf.h: a Standard MIDI File (MIDI 1.0 Detailed Specification, 1996), read from memory: its notes
/// with their times, and its tempo map.
#ifndef HIMC_MIDI_SMF_H
#define HIMC_MIDI_SMF_H

#include "himc/score.h"

#define MIDI_DRUM_CHANNEL 9 ///< "channel 10", of General MIDI's drums

/// A note of any track, from its note-on to its note-off.
typedef struct midi_note {
    double beat;      ///< of the note-on (quarter notes from the beginning), see midi_file
    double seconds;   ///< of the note-on, through the tempo map (s)
    double off;       ///< of the note-off (s); the end of the file if there is none
    int track;        ///< from 0
    uint8_t channel;  ///< 0 .. 15
    uint8_t key;      ///< 0 .. 127; 60 is C4
    uint8_t velocity; ///< 1 .. 127
    uint8_t program;  ///< of its channel then, 0 .. 127
    bool timpani;     ///< its track has a timpani's name
} midi_note;

/// A file. Beats are quarter notes and the tempo map is the file's, unless `converted`.
typedef struct midi_file {
    midi_note *notes; ///< in the order of time (note_count), owned
    int note_count;
    himc_tempo_change *tempi; ///< as in a score, the first at beat 0 (tempo_count), owned
    int tempo_count;
    int tracks;     ///< read
    int cut;        ///< tracks that end in the middle of an event or go on behind the file's end
    int missing;    ///< tracks that the header promises and the file does not have
    double cut_at;  ///< how far the shortest of the cut tracks was read (s)
    bool converted; ///< beats are half seconds: the file has no beats (SMPTE), or a tempo that
                    ///< scores do not have
} midi_file;

bool himc_midi_is_file(const void *bytes, size_t size);

/// Reads a file of format 0, 1 or 2 (whose tracks follow each other). A track that ends in the
/// middle of an event is kept up to there. False with one line if the bytes are no MIDI file, or
/// hold what no event begins with. Free with himc_midi_file_free.
bool himc_midi_file_read(midi_file *file, const void *bytes, size_t size, himc_error *error);
void himc_midi_file_free(midi_file *file);

#endif
