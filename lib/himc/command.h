/// command.h: the commands: a name and its atoms, the same from Pure Data, OSC and a score file.
///
/// There is one table (command_rows.h) and one parser. A command that does not fit is refused in
/// one line of text and changes nothing.
#ifndef HIMC_COMMAND_H
#define HIMC_COMMAND_H

#include "himc/base.h"

HIMC_BEGIN

/// Kind of an atom.
typedef enum himc_atom_kind {
    HIMC_ATOM_NUMBER, ///< Pd's float, OSC's numbers
    HIMC_ATOM_SYMBOL  ///< Pd's symbol, OSC's strings
} himc_atom_kind;

/// A number or a word, as Pd and OSC send them.
typedef struct himc_atom {
    himc_atom_kind kind; ///< which of the two below counts
    double number;       ///< in the unit of the command's argument
    const char *symbol;  ///< borrowed
} himc_atom;

/// How a stroke is played (2012 paper, section 3), with the mallet's speed at f. In the order of
/// the argument NUANCE.
typedef enum himc_nuance {
    HIMC_LEGATO,          ///< 4.3 m/s, free rebound
    HIMC_TENUTO,          ///< 4.2 m/s, weak rebound
    HIMC_ACCENT,          ///< 4.5 m/s, from the largest height
    HIMC_VERTICAL_ACCENT, ///< 7.5 m/s
    HIMC_STACCATO,        ///< 2.8 m/s, pulled off the head
    HIMC_NUANCES          ///< number of nuances
} himc_nuance;

/// The nuance's word in commands; "none" for another number. Borrowed, static.
const char *himc_nuance_name(himc_nuance nuance);

/// Where on the head a stroke lands. In the order of the argument SPOT.
typedef enum himc_spot {
    HIMC_SPOT_CENTER,     ///< the centre
    HIMC_SPOT_NORMAL,     ///< of a timpano 0.75 of the radius towards the performer, of drums with
                          ///< two heads 0.3; other instruments have their own
    HIMC_SPOT_RIM,        ///< 0.92 of the radius towards the performer
    HIMC_SPOT_CROSSSTICK, ///< the shaft on the hoop, the tip lies on the head
    HIMC_SPOT_RIMSHOT,    ///< the tip on the head and the shaft on the hoop at once
    HIMC_SPOT_CLICK,      ///< on the other stick, which lies there
    HIMC_SPOT_SHELL,      ///< on the drum's shell
    HIMC_SPOT_XY          ///< given by two numbers
} himc_spot;

/// The spot's word in commands; "" for HIMC_SPOT_XY. Borrowed, static.
const char *himc_spot_name(himc_spot spot);

#define HIMC_PART_SIZE 8  ///< of the name of an instrument's part, with its final 0 (bytes)
#define HIMC_NAME_SIZE 32 ///< of a drum's or a nuance's name, with its final 0 (bytes)

/// What a stroke of a score stands for besides itself. The rolls are in the order of the words of
/// `roll`.
typedef enum himc_ornament {
    HIMC_PLAIN,       ///< itself alone
    HIMC_FLAM,        ///< a grace note by the other hand
    HIMC_DRAG,        ///< two by the other hand, which bounces
    HIMC_RUFF,        ///< the same, more open
    HIMC_ROLL_SINGLE, ///< both hands in turn
    HIMC_ROLL_DOUBLE, ///< so that each stroke bounces once
    HIMC_ROLL_PRESS   ///< so that each stroke bounces on until the next
} himc_ornament;

#define HIMC_BUZZ (-1)              ///< bounces of a stroke: as many as fit
#define HIMC_DYNAMIC_FOLLOWS (-1.0) ///< dynamic of a stroke: as `cresc` says there, else mf
#define HIMC_DEAD (-2)              ///< no bounce: the fingers keep the mallet on the head

/// One stroke, as written in a score.
typedef struct himc_stroke {
    double beat;               ///< (beats), 0 or more; ignored by `hit`
    himc_hand hand;            ///< the hand that strikes
    himc_nuance nuance;        ///< way of playing
    double dynamic;            ///< 0 (ppp) .. 1 (fff), the eight names are k/7; or the next
    himc_spot spot;            ///< default HIMC_SPOT_NORMAL
    double x;                  ///< of HIMC_SPOT_XY: from the centre away from the performer (m)
    double y;                  ///< and to the left (m)
    char drum[HIMC_NAME_SIZE]; ///< "" is the performer's first drum
    char part[HIMC_PART_SIZE]; ///< of its surface: a bar's pitch, a block's name; "": all of it
    double early;              ///< of a grace note: so much before the beat (s), 0 .. 1
    int bounces;        ///< contacts after the first without the arm: 0, 1, HIMC_BUZZ or HIMC_DEAD
    double bounce_time; ///< from the first contact to the bounce, to the last, or to the end of a
                        ///< dead stroke (s), 0.01 .. 0.5
    himc_ornament ornament; ///< what himc_performance_add_stroke makes of it
    double length;          ///< of a roll (beats)
    double last_dynamic;    ///< of a roll, at its end, 0 .. 1
} himc_stroke;

/// (x, y) on the head of a named spot: center (0), normal (0.75 of the radius towards the
/// performer), rim (0.92), each hand 1.5 cm to its own side; a stroke with HIMC_SPOT_XY gives its
/// own x, y.
HIMC_RT void himc_stroke_spot(const himc_stroke *stroke, double radius, double *x, double *y);

/// The object that a command is for. Names of commands are unique for each receiver.
typedef enum himc_receiver {
    HIMC_PERFORMER, ///< himc_performance_command
    HIMC_DRUM       ///< himc_drum_command
} himc_receiver;

/// When a command acts, and who carries it out.
typedef enum himc_command_when {
    HIMC_WHEN_NOW,       ///< when it arrives; may allocate, read files, or be refused
    HIMC_WHEN_AT_SAMPLE, ///< on its sample, in the audio callback
    HIMC_WHEN_HOST,      ///< the program around the library answers it
    HIMC_WHEN_NETWORK    ///< the OSC server carries it out (osc.h)
} himc_command_when;

/// What else holds for a command.
typedef enum himc_command_marks {
    HIMC_AFTER_STROKES = 1, ///< in a score it acts after the strokes are there, others before
    HIMC_NOT_IN_SCORE = 2,  ///< a score cannot hold it
    HIMC_WRITES_FILE = 4,   ///< its FILE is written; without this mark it is read
    HIMC_IN_FOLDER = 8,     ///< from the network it may read a FILE in the shared folder (osc.h)
    HIMC_CHANGES_HEAD = 16, ///< of a drum: its head is computed anew, mode by mode
    HIMC_AT_BEAT = 32,      ///< a score may have it at a beat
    HIMC_MAKES_DRUM = 64    ///< it makes a drum, named by its first atom
} himc_command_marks;

/// One id for each row of command_rows.h: HIMC_COMMAND_STROKE, HIMC_COMMAND_HIT, ...
typedef enum himc_command_id {
/// \cond
#define HIMC_COMMAND_ROW(ID, word, receiver, when, marks, atoms, does) HIMC_COMMAND_##ID,
#include "himc/command_rows.h"
    /// \endcond
    HIMC_COMMANDS ///< number of commands
} himc_command_id;

/// What himc_drum_describe and himc_performance_describe tell.
typedef enum himc_description {
    HIMC_DESCRIBE_INFO, ///< a few lines for a person: `info`
    HIMC_DESCRIBE_STATE ///< all settings, each line a command: `dump`. Carried out in their order
                        ///< by a new object they make the same state, bit by bit
} himc_description;

#define HIMC_COMMAND_ATOMS 8 ///< most atoms of a command
#define HIMC_PATH_SIZE 1024  ///< of a file's name, with its final 0 (bytes)

/// A checked command: right name, right number and kind of atoms, all finite and in range. Made by
/// the parser and copied by himc_command_copy only.
typedef struct himc_command {
    himc_command_id id;                 ///< its row
    int form;                           ///< of the row's forms, separated by ` | `, from 0
    himc_stroke stroke;                 ///< of `stroke`, `hit`, `roll`, `flam`, `drag` and `ruff`
    int count;                          ///< atoms after the name
    himc_atom atom[HIMC_COMMAND_ATOMS]; ///< symbols point into `storage`
    int choice[HIMC_COMMAND_ATOMS]; ///< index of the atom among its allowed words; -1 for a number
                                    ///< and a free word
    char drum[HIMC_NAME_SIZE]; ///< of DRUM COMMAND ..., a drum's: which of the performer's; else ""
    const char *folder; ///< NULL, or of a command from the network the only folder that its FILE
                        ///< is read in; points into `storage`
    char storage[HIMC_PATH_SIZE + 256]; ///< the text of all symbols and of `folder`
} himc_command;

/// One row of command_rows.h.
typedef struct himc_command_row {
    himc_command_id id;     ///< the row's index
    himc_receiver receiver; ///< performer or drum
    himc_command_when when; ///< when it acts
    unsigned marks;         ///< of himc_command_marks, joined by |
    const char *name;       ///< "stroke"
    const char *atoms;      ///< the grammar, explained in command_rows.h
    const char *does;       ///< one sentence for the manual
} himc_command_row;

/// Row `index` of the table, or NULL past its end. Row i is the command with id i. Borrowed,
/// static.
HIMC_RT const himc_command_row *himc_command_table(int index);

/// The row of that name, or NULL. Borrowed, static.
HIMC_RT const himc_command_row *himc_command_find(himc_receiver receiver, const char *name);

/// Checks `name` and its atoms against the table; false, and `out` untouched, if they do not fit.
/// Numbers are rounded to single precision, as Pure Data and OSC send them, so that the same
/// command gives the same bits from everywhere; a note name becomes its frequency (Hz). For the
/// performer also DRUM COMMAND ..., a command to one of its drums: then `out->drum` is its name.
bool himc_command_parse(himc_command *out, himc_receiver receiver, const char *name,
                        const himc_atom *atoms, int count, himc_error *error);

/// The same from text: "stroke 2 right accent f rim". Words split at white space, `\ ` keeps a
/// space as in Pd's text files. A word that is a decimal number as a whole is a number ("nan" and
/// "inf" are words).
bool himc_command_parse_text(himc_command *out, himc_receiver receiver, const char *text,
                             himc_error *error);

/// Checks a command that was put together without the parser: its id, count and atoms are
/// believed, form, choices and stroke are found again. Numbers are kept as they are.
bool himc_command_check(himc_command *out, himc_receiver receiver, const himc_command *in,
                        himc_error *error);

/// Deep copy (the symbols of `out` point into its own storage).
HIMC_RT void himc_command_copy(himc_command *out, const himc_command *in);

/// A word, by value.
typedef struct himc_word {
    char text[HIMC_NAME_SIZE]; ///< "": none
} himc_word;

/// Word `choice` of atom `atom` (from 0) in the first form of a command: (HIMC_COMMAND_LAW, 0, 1)
/// is "feedforward". "" if there is none, and for arguments. Keep the struct, not its `text` alone.
HIMC_RT himc_word himc_command_word(himc_command_id id, int atom, int choice);

/// Use of a command's FILE.
typedef enum himc_file_use {
    HIMC_FILE_NONE, ///< the command, or this form of it, names no file
    HIMC_FILE_READ, ///< the file must exist
    HIMC_FILE_WRITE ///< the file is made or replaced
} himc_file_use;

/// Use of the file that a checked command names; `*atom` becomes the index of the file's name, and
/// has no meaning for HIMC_FILE_NONE.
HIMC_RT himc_file_use himc_command_file(const himc_command *command, int *atom);

HIMC_END

#endif
