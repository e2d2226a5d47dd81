/// random_commands.h: commands at random, made from the table of all commands and its grammar, so
/// that a new command is among them; and the ways to spoil one.
#ifndef HIMC_TESTS_RANDOM_COMMANDS_H
#define HIMC_TESTS_RANDOM_COMMANDS_H

#include "base/argument.h"
#include "himc/body.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define SPOKEN_ATOMS 48

/// A command as it is said, before the parser sees it.
typedef struct spoken {
    himc_receiver receiver;
    const char *name;
    himc_atom atom[SPOKEN_ATOMS]; // symbols are static, or in `file`
    int count;
    char storage[SPOKEN_ATOMS][64];
} spoken;

/// Ways to spoil a command.
typedef enum spoiling {
    SPOIL_NAN,
    SPOIL_INFINITE,
    SPOIL_HUGE,     ///< 1e308, infinite in single precision
    SPOIL_FAR,      ///< 1e30
    SPOIL_DENORMAL, ///< in range where 0 is
    SPOIL_KIND,     ///< a number for a word, or the other way round
    SPOIL_EMPTY,    ///< the empty word
    SPOIL_LONG,     ///< a word of 2000 characters
    SPOIL_CONTROL,  ///< line ends and escape sequences
    SPOIL_MISSING,  ///< the last atom
    SPOIL_MORE,     ///< one atom too many
    SPOIL_MANY,     ///< 40 atoms too many
    SPOIL_NAME,     ///< no command
    SPOIL_RECEIVER, ///< a command for the other receiver
    SPOILINGS
} spoiling;

static const char *const spoiling_name[SPOILINGS] = {
    "nan",  "infinite", "1e308",   "1e30",         "denormal",    "other kind", "empty word",
    "long", "control",  "missing", "one too many", "40 too many", "no command", "other receiver"};

typedef unsigned long long random_seed;

/// 0 .. 1 from a seed (Knuth's MMIX generator).
static inline double any(random_seed *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) / 9007199254740992.0;
}

static inline int any_of(random_seed *seed, int count)
{
    return (int)(any(seed) * count);
}

/// Files for the argument FILE, set by the test; NULL after the last.
static const char *const *random_files;

static inline double random_number(const himc_argument *a, random_seed *seed)
{
    double low = a->low, high = a->high, x = any(seed);
    switch (any_of(seed, 12)) {
    case 0: return low;
    case 1: return high;
    default: break;
    }
    if (strcmp(a->names, "BEAT") == 0 && x < 0.9)
        return 8 * any(seed);
    double value = low > 0 && high > 50 * low ? low * pow(high / low, x) : low + (high - low) * x;
    return a->kind == HIMC_ARGUMENT_COUNT ? floor(value) : value;
}

static inline void random_text(const char *name, char text[64], random_seed *seed)
{
    int files = 0;
    while (random_files[files])
        files++;
    if (strcmp(name, "FILE") == 0)
        snprintf(text, 64, "%s", random_files[any_of(seed, files)]);
    else if (strcmp(name, "JOINT") == 0)
        snprintf(text, 64, "%s", himc_joint_name(any_of(seed, HIMC_JOINTS)));
    else if (strcmp(name, "SEGMENT") == 0)
        snprintf(text, 64, "%s", himc_segment_name(any_of(seed, HIMC_SEGMENTS)));
    else if (strcmp(name, "NOTE") == 0)
        snprintf(text, 64, "%c%s%d", 'a' + any_of(seed, 7), any(seed) < 0.3 ? "#" : "",
                 1 + any_of(seed, 4));
    else if (strcmp(name, "NAME") == 0 || strcmp(name, "DRUM") == 0)
        snprintf(text, 64, "%s", any(seed) < 0.5 ? "kettle" : any(seed) < 0.7 ? "tom" : "tam");
    else
        snprintf(text, 64, "localhost");
}

static inline void add_number(spoken *s, double number)
{
    s->atom[s->count++] = (himc_atom){HIMC_ATOM_NUMBER, number, NULL};
}

static inline void add_word(spoken *s, const char *word, size_t length)
{
    char *text = s->storage[s->count];
    snprintf(text, 64, "%.*s", (int)length, word);
    s->atom[s->count++] = (himc_atom){HIMC_ATOM_SYMBOL, 0, text};
}

static inline void add_argument(spoken *s, const char *name, const char *context, random_seed *seed)
{
    const himc_argument *a = himc_argument_find(name, context);
    int words = 0;
    char text[64];
    while (a->words && a->words[words])
        words++;
    bool number = a->kind == HIMC_ARGUMENT_NUMBER || a->kind == HIMC_ARGUMENT_COUNT;
    if (words > 0 && (!number || any(seed) < 0.5)) {
        const char *word = a->words[any_of(seed, words)];
        add_word(s, word, strlen(word));
    } else if (number) {
        add_number(s, random_number(a, seed));
    } else {
        random_text(name, text, seed);
        add_word(s, text, strlen(text));
    }
}

/// One token of a grammar; `context` becomes the last literal word.
static inline void add_token(spoken *s, const char *token, size_t length, char context[64],
                             random_seed *seed)
{
    char name[64];
    if (token[0] == '[') { // optional
        if (any(seed) < 0.4)
            return;
        token++;
        length -= 2;
    }
    snprintf(name, sizeof name, "%.*s", (int)length, token);
    if (isupper((unsigned char)name[0])) {
        if (strcmp(name, "SPOT") == 0 && any(seed) < 0.3) {
            add_number(s, any(seed) * 0.4 - 0.2);
            add_number(s, any(seed) * 0.4 - 0.2);
            return;
        }
        add_argument(s, name, context, seed);
        return;
    }
    int choices = 1;
    for (const char *c = name; *c; c++)
        choices += *c == '|';
    const char *word = name;
    for (int skip = any_of(seed, choices); skip > 0; skip--)
        word = strchr(word, '|') + 1;
    add_word(s, word, strcspn(word, "|"));
    snprintf(context, 64, "%s", s->storage[s->count - 1]);
}

/// Adds the atoms of a command of that row, in one of its forms.
static inline void add_form(spoken *s, const himc_command_row *row, random_seed *seed)
{
    const char *grammar = row->atoms;
    char context[64];
    int forms = 1;
    for (const char *c = grammar; (c = strstr(c, " | ")); c += 3)
        forms++;
    for (int skip = any_of(seed, forms); skip > 0; skip--)
        grammar = strstr(grammar, " | ") + 3;
    snprintf(context, sizeof context, "%s", row->name);
    while (*grammar && *grammar != '|') {
        size_t length = strcspn(grammar, " ");
        add_token(s, grammar, length, context, seed);
        grammar += length + strspn(grammar + length, " ");
    }
}

/// A command that may stand at a beat, for a drum or for the performer.
static inline void add_timed(spoken *s, random_seed *seed)
{
    const himc_command_row *row;
    char drum[64];
    do
        row = himc_command_table(any_of(seed, HIMC_COMMANDS));
    while (!(row->marks & HIMC_AT_BEAT));
    add_number(s, random_number(himc_argument_find("BEAT", "at"), seed));
    random_text("DRUM", drum, seed);
    if (row->receiver == HIMC_DRUM)
        add_word(s, drum, strlen(drum));
    add_word(s, row->name, strlen(row->name));
    add_form(s, row, seed);
}

/// A command of that row that the parser accepts.
static inline void random_command(spoken *s, const himc_command_row *row, random_seed *seed)
{
    s->receiver = row->receiver;
    s->name = row->name;
    s->count = 0;
    if (row->id == HIMC_COMMAND_AT)
        add_timed(s, seed);
    else
        add_form(s, row, seed);
}

/// The atom that a command is spoilt with.
static inline himc_atom hostile_atom(spoiling how, himc_atom was)
{
    static char longest[2001];
    memset(longest, 'a', sizeof longest - 1);
    switch (how) {
    case SPOIL_NAN: return (himc_atom){HIMC_ATOM_NUMBER, NAN, NULL};
    case SPOIL_INFINITE: return (himc_atom){HIMC_ATOM_NUMBER, -INFINITY, NULL};
    case SPOIL_HUGE: return (himc_atom){HIMC_ATOM_NUMBER, 1e308, NULL};
    case SPOIL_FAR: return (himc_atom){HIMC_ATOM_NUMBER, 1e30, NULL};
    case SPOIL_DENORMAL: return (himc_atom){HIMC_ATOM_NUMBER, 4e-324, NULL};
    case SPOIL_EMPTY: return (himc_atom){HIMC_ATOM_SYMBOL, 0, ""};
    case SPOIL_LONG: return (himc_atom){HIMC_ATOM_SYMBOL, 0, longest};
    case SPOIL_CONTROL: return (himc_atom){HIMC_ATOM_SYMBOL, 0, "\x1b[31mred\r\n\a\x7f\xc2\x9b;"};
    default:
        return was.kind == HIMC_ATOM_NUMBER ? (himc_atom){HIMC_ATOM_SYMBOL, 0, "zzz"}
                                            : (himc_atom){HIMC_ATOM_NUMBER, 7, NULL};
    }
}

/// Spoils a command. True if it must be refused now; else it may still be one that is allowed.
static inline bool spoil(spoken *s, spoiling how, random_seed *seed)
{
    int at = any_of(seed, s->count > 0 ? s->count : 1);
    himc_atom was = s->count > 0 ? s->atom[at] : (himc_atom){HIMC_ATOM_NUMBER, 0, NULL};
    switch (how) {
    case SPOIL_MISSING: s->count -= s->count > 0; return false;
    case SPOIL_MORE: s->atom[s->count++] = was; return false;
    case SPOIL_MANY:
        while (s->count < 40)
            s->atom[s->count++] = was;
        return true;
    case SPOIL_NAME: s->name = any(seed) < 0.5 ? "zzz" : "\x1b[2J\nplay"; return true;
    case SPOIL_RECEIVER:
        s->receiver = s->receiver == HIMC_DRUM ? HIMC_PERFORMER : HIMC_DRUM;
        return !himc_command_find(s->receiver, s->name);
    default: break;
    }
    s->atom[at] = hostile_atom(how, was);
    s->count += s->count == 0;
    return how != SPOIL_DENORMAL && how != SPOIL_KIND;
}

#endif
