/// command.h: the one vocabulary: a name and its atoms, whoever carries it (Pd, OSC, a score file).
///
/// There is one table and one parser; an error leaves everything as it was and is one line of text.
#ifndef HIMC_COMMAND_H
#define HIMC_COMMAND_H

#include "himc/base.h"

typedef enum himc_atom_kind { HIMC_ATOM_NUMBER, HIMC_ATOM_SYMBOL } himc_atom_kind;

/// A number or a word, as Pd and OSC send them. `symbol` is borrowed.
typedef struct himc_atom {
    himc_atom_kind kind;
    double number;
    const char *symbol;
} himc_atom;

/// How a stroke is played (2012 paper, section 3).
typedef enum himc_nuance {
    HIMC_LEGATO,
    HIMC_TENUTO,
    HIMC_ACCENT,
    HIMC_VERTICAL_ACCENT,
    HIMC_STACCATO,
    HIMC_NUANCES
} himc_nuance;

/// "legato", "tenuto", "accent", "vertical-accent", "staccato".
const char *himc_nuance_name(himc_nuance nuance);

typedef enum himc_spot {
    HIMC_SPOT_CENTER,
    HIMC_SPOT_NORMAL,
    HIMC_SPOT_RIM,
    HIMC_SPOT_XY
} himc_spot;

#define HIMC_NAME_SIZE 32

/// One stroke, as written in a score.
typedef struct himc_stroke {
    double beat; ///< (beats); ignored by `hit`
    himc_hand hand;
    himc_nuance nuance;
    double dynamic;            ///< 0 (ppp) .. 1 (fff); the eight names are k/7
    himc_spot spot;            ///< default HIMC_SPOT_NORMAL
    double x, y;               ///< place on the head when spot is HIMC_SPOT_XY (m, from its centre)
    char drum[HIMC_NAME_SIZE]; ///< "" is the performer's first drum
} himc_stroke;

/// (x, y) on the head of a named spot: center (0), normal (0.75 of the radius towards the
/// performer), rim (0.92), each hand 1.5 cm to its own side; a stroke with HIMC_SPOT_XY gives its
/// own x, y.
HIMC_RT void himc_stroke_spot(const himc_stroke *stroke, double radius, double *x, double *y);

/// Who a command is for.
typedef enum himc_receiver { HIMC_PERFORMER, HIMC_DRUM } himc_receiver;

typedef enum himc_command_id {
    // to the performer
    HIMC_COMMAND_STROKE,
    HIMC_COMMAND_HIT,
    HIMC_COMMAND_TEMPO,
    HIMC_COMMAND_GRIP,
    HIMC_COMMAND_LOOP,
    HIMC_COMMAND_CLEAR,
    HIMC_COMMAND_PLAY,
    HIMC_COMMAND_STOP,
    HIMC_COMMAND_SEEK,
    HIMC_COMMAND_SCORE,
    HIMC_COMMAND_TAKE,
    HIMC_COMMAND_UNITS,
    HIMC_COMMAND_TARGET,
    HIMC_COMMAND_MODE,
    HIMC_COMMAND_SOLVER,
    HIMC_COMMAND_DAMPING,
    HIMC_COMMAND_POSTURE,
    HIMC_COMMAND_BEND,
    HIMC_COMMAND_ELBOW,
    HIMC_COMMAND_WEIGHTS,
    HIMC_COMMAND_LAW,
    HIMC_COMMAND_GAIN,
    HIMC_COMMAND_LIMITS,
    HIMC_COMMAND_STRENGTH,
    HIMC_COMMAND_RATE,
    HIMC_COMMAND_COUPLING,
    HIMC_COMMAND_PLAYER,
    HIMC_COMMAND_PUSH,
    HIMC_COMMAND_RECORD,
    HIMC_COMMAND_INFO,
    HIMC_COMMAND_RESET,
    HIMC_COMMAND_MAKE_DRUM, ///< `drum NAME [INCHES]`
    HIMC_COMMAND_SUBSCRIBE, // the next three are for osc.h
    HIMC_COMMAND_UNSUBSCRIBE,
    HIMC_COMMAND_LISTEN,
    // to a drum
    HIMC_COMMAND_RADIUS,
    HIMC_COMMAND_TENSION,
    HIMC_COMMAND_DENSITY,
    HIMC_COMMAND_TUNE,
    HIMC_COMMAND_MODES,
    HIMC_COMMAND_DECAY,
    HIMC_COMMAND_AIR,
    HIMC_COMMAND_KETTLE,
    HIMC_COMMAND_GLIDE,
    HIMC_COMMAND_DAMP,
    HIMC_COMMAND_SHAPE,
    HIMC_COMMAND_MALLET,
    HIMC_COMMAND_PLACE,
    HIMC_COMMAND_PICKUP,
    HIMC_COMMAND_PICKUPS,
    HIMC_COMMAND_CHANNEL,
    HIMC_COMMAND_TECHNIQUE,
    HIMC_COMMAND_STRIKE,
    HIMC_COMMANDS
} himc_command_id;

#define HIMC_COMMAND_ATOMS 8
#define HIMC_PATH_SIZE 1024

/// A checked command: right name, right number and kind of atoms, all finite and in range.
typedef struct himc_command {
    himc_command_id id;
    himc_stroke stroke;                 ///< of `stroke` and `hit`
    int count;                          ///< atoms after the name
    himc_atom atom[HIMC_COMMAND_ATOMS]; ///< symbols point into `storage`
    char storage[HIMC_PATH_SIZE + 256]; ///< so a command is copied with himc_command_copy only
} himc_command;

/// One row of the vocabulary; the manual's table is made of these.
typedef struct himc_command_row {
    himc_command_id id;
    himc_receiver receiver;
    const char *name;  ///< "stroke"
    const char *atoms; ///< the grammar: "BEAT HAND NUANCE DYNAMIC [SPOT] [DRUM]", "X Y | air ..."
    const char *does;  ///< one sentence
} himc_command_row;

/// Row `index` of the table, or NULL past its end. Borrowed, static.
const himc_command_row *himc_command_table(int index);

/// Checks `name` and its atoms against the table; false, and `out` untouched, if they do not fit.
/// Numbers are rounded to single precision, as Pure Data and OSC send them, so that all carriers
/// give the same bits; a note name becomes its frequency (Hz).
bool himc_command_parse(himc_command *out, himc_receiver receiver, const char *name,
                        const himc_atom *atoms, int count, himc_error *error);

/// The same from text: "stroke 2 right accent f rim". Words split at white space, `\ ` keeps a
/// space as in Pd's text files; what reads wholly as a decimal number is a number ("nan" and "inf"
/// are words).
bool himc_command_parse_text(himc_command *out, himc_receiver receiver, const char *text,
                             himc_error *error);

/// Deep copy (the symbols of `out` point into its own storage).
void himc_command_copy(himc_command *out, const himc_command *in);

#endif
