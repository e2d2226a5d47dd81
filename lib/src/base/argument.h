/// argument.h: the arguments in the grammar of a command row: the allowed BEAT, HAND, DRUM ...
#ifndef HIMC_ARGUMENT_H
#define HIMC_ARGUMENT_H

#include "himc/command.h"

typedef enum himc_argument_kind {
    HIMC_ARGUMENT_NUMBER, ///< in low .. high, or one of `words`
    HIMC_ARGUMENT_COUNT,  ///< the same, a whole number
    HIMC_ARGUMENT_WORD,   ///< one of `words`
    HIMC_ARGUMENT_NAME,   ///< of a drum
    HIMC_ARGUMENT_TEXT,   ///< any word of low .. high characters
    HIMC_ARGUMENT_NOTE    ///< A2, f#3
} himc_argument_kind;

typedef struct himc_argument {
    const char *names;    ///< as written in the grammar: "BEAT", "X|Y"
    const char *contexts; ///< the commands or literal words before it, NULL for any
    himc_argument_kind kind;
    double low, high;
    const char *unit;
    const char *const *words; ///< allowed words, NULL after the last; or NULL
} himc_argument;

/// The words of a dynamic, in sevenths from ppp to fff; NULL after the last.
extern const char *const himc_dynamic_words[9];

/// The argument of that name in that context. Borrowed, static; NULL if there is none.
const himc_argument *himc_argument_find(const char *name, const char *context);

/// True if the atom fits.
bool himc_argument_accepts(const himc_argument *argument, const himc_atom *atom);

/// The hand that a checked word names.
himc_hand himc_argument_hand(const himc_atom *atom);
/// Whether a word is that of a hand of `stroke`.
bool himc_is_hand(const char *word);

/// Index of the atom among the argument's words, or -1.
int himc_argument_choice(const himc_argument *argument, const himc_atom *atom);

/// The number of an accepted atom in single precision, as all hosts have it. The ends of the range
/// stay exactly as in the table: Pd's 2.2 is a little more than 2.2.
double himc_argument_number(const himc_argument *argument, double number);

/// The number in single precision. It goes through memory: GCC 12 leaves the rounding out where it
/// packs two numbers into one vector (-O3).
static inline double himc_argument_single(double number)
{
    volatile float single = (float)number;
    return single;
}

/// A number that in single precision is the usual one is that, as it is in double precision: so a
/// state that was sent as single numbers comes back as it was.
static inline double himc_argument_usual(double number, double usual)
{
    return himc_argument_single(number) == himc_argument_single(usual) ? usual : number;
}

/// What would fit, for a person: "0 .. 1 m", "left right".
void himc_argument_describe(const himc_argument *argument, char *text, size_t size);

/// For a refused command of a drum that may not exist: its name before the reason, and behind it
/// `drum` if the name may mean that. Returns false.
bool himc_command_doubt_drum(const char *name, himc_error *error);

/// Frequency of a note name: letter, any # or b, octave; A4 is 440 Hz (so A2 is 110).
bool himc_note_frequency(const char *note, double *hz);
#define HIMC_NOTE_SIZE 8 ///< chosen: room for G#9 and its 0, and more
/// The note of exactly that frequency, with # and not b; false if there is none.
bool himc_note_name(double hz, char name[HIMC_NOTE_SIZE]);

#endif
