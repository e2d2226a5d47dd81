/// import.h: a score made of a MIDI file, or of notes that another reader has made.
#ifndef HIMC_MIDI_IMPORT_H
#define HIMC_MIDI_IMPORT_H

#include "midi/smf.h"

typedef struct midi_options {
    midi_choice choice;
    double range; ///< dynamic range of velocities by a square law (dB), 1 .. 80; 0: as notation
                  ///< programs write dynamics
    const char
        *setup; ///< of drums: a set-up's name or file, whose instruments play; NULL: as needed
    int track, channel; ///< whose notes alone are taken, from 1; 0: all
    bool all;           ///< with MIDI_ANY: of all players and kinds, for one player
    midi_choice as;     ///< what they are taken for; MIDI_ANY: as the file says
    int as_key;         ///< of drums: all are this key; 0: as the file says
} midi_options;

/// "timpani" and so on; "" of MIDI_ANY. Borrowed, static.
const char *himc_midi_choice_name(midi_choice choice);

/// The dynamic (0 .. 1) of a velocity (0 .. 127); `range` as in midi_options.
double himc_midi_dynamic(double velocity, double range);
/// Its inverse for range 0, also beyond 127.
double himc_midi_velocity(double dynamic);
/// The velocity of a stroke that MIDI has no nuance for: as loud as it is played.
double himc_midi_played_velocity(himc_nuance nuance, double dynamic);

#define HIMC_MIDI_BYTES_MAX \
    ((size_t)4 << 20) ///< of a MIDI file; chosen: a hundred times a long piece

/// What has been made; both texts end with 0, and are freed with himc_midi_score_free.
typedef struct midi_score {
    char *text;   ///< the score; its comments say what the report says
    char *report; ///< what is played, and for each reason what is not; lines that end with \n
    int left_out; ///< notes of the part that are not played, tracks cut short
} midi_score;

/// Makes a score of a MIDI file's bytes. `name` of the file is for its first comment; NULL options
/// are MIDI_ANY and 0. False with one line if the file cannot be read, or nothing in it is for
/// drums.
bool himc_midi_import(midi_score *made, const void *bytes, size_t size, const char *name,
                      const midi_options *options, himc_error *error);
/// The same of notes; a reader of another kind of files has made them. `file` is freed.
bool himc_midi_make(midi_score *made, midi_file *file, const char *name,
                    const midi_options *options, himc_error *error);
void himc_midi_score_free(midi_score *made);

#endif
