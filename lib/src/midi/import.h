/// import.h: a score made of a MIDI file.
#ifndef HIMC_MIDI_IMPORT_H
#define HIMC_MIDI_IMPORT_H

#include "himc/score.h"

/// Whose notes are played.
typedef enum midi_choice {
    MIDI_ANY,          ///< the first of these of which there are any
    MIDI_TIMPANI,      ///< program 48 of General MIDI, or a track of that name
    MIDI_DRUMS,        ///< channel 10
    MIDI_MARIMBA,      ///< program 13
    MIDI_XYLOPHONE,    ///< program 14
    MIDI_VIBRAPHONE,   ///< program 12
    MIDI_GLOCKENSPIEL, ///< program 10
    MIDI_CHOICES
} midi_choice;

typedef struct midi_options {
    midi_choice choice;
    double range; ///< dynamic range of velocities by a square law (dB), 1 .. 80; 0: as notation
                  ///< programs write dynamics
    const char
        *setup; ///< of drums: a set-up's name or file, whose instruments play; NULL: as needed
} midi_options;

/// "timpani" and so on; "" of MIDI_ANY. Borrowed, static.
const char *himc_midi_choice_name(midi_choice choice);

/// The dynamic (0 .. 1) of a velocity (1 .. 127); `range` as in midi_options.
double himc_midi_dynamic(int velocity, double range);

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
void himc_midi_score_free(midi_score *made);

#endif
