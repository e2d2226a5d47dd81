/// argument.c: the atoms of the vocabulary and their physical ranges, in one table.
///
/// A row of the command table names its atoms in capitals; here each name gets its kind, its range
/// and its unit. The same name may mean different things after different words, so a row with a
/// context comes before one without. The ranges are wide but physical: what lies outside cannot be
/// a drum, a person or a room.
#include "base/argument.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const himc_argument arguments[] = {
    {"BEAT", NULL, HIMC_ARGUMENT_NUMBER, 0, 1e6, "", NULL},
    {"HAND", NULL, HIMC_ARGUMENT_WORD, 0, 0, "", "left right"},
    {"NUANCE", NULL, HIMC_ARGUMENT_WORD, 0, 0, "", "legato tenuto accent vertical-accent staccato"},
    {"DYNAMIC", NULL, HIMC_ARGUMENT_NUMBER, 0, 1, "", "ppp pp p mp mf f ff fff"},
    {"SPOT", NULL, HIMC_ARGUMENT_WORD, 0, 0, "", "center normal rim"},
    {"DRUM", NULL, HIMC_ARGUMENT_NAME, 0, 0, "", NULL},
    {"NAME", NULL, HIMC_ARGUMENT_NAME, 0, 0, "", NULL},
    {"BPM", NULL, HIMC_ARGUMENT_NUMBER, 1, 1000, "beats per minute", NULL},
    {"SWITCH", NULL, HIMC_ARGUMENT_COUNT, 0, 1, "", NULL},
    {"FILE", NULL, HIMC_ARGUMENT_TEXT, 1, HIMC_PATH_SIZE - 1, "", NULL},
    {"JOINT", NULL, HIMC_ARGUMENT_TEXT, 1, 63, "", NULL},
    {"FACTOR", NULL, HIMC_ARGUMENT_NUMBER, 0.05, 20, "", NULL},
    {"KS", NULL, HIMC_ARGUMENT_NUMBER, 0, 1e6, "N m/rad", NULL},
    {"KD", NULL, HIMC_ARGUMENT_NUMBER, 0, 1e5, "N m s/rad", NULL},
    {"TORQUE", NULL, HIMC_ARGUMENT_NUMBER, 0.01, 10000, "N m", NULL},
    {"SEGMENT", NULL, HIMC_ARGUMENT_TEXT, 1, 63, "", NULL},
    {"FX", NULL, HIMC_ARGUMENT_NUMBER, -1000, 1000, "N", NULL},
    {"FY", NULL, HIMC_ARGUMENT_NUMBER, -1000, 1000, "N", NULL},
    {"FZ", NULL, HIMC_ARGUMENT_NUMBER, -1000, 1000, "N", NULL},
    {"SECONDS", NULL, HIMC_ARGUMENT_NUMBER, 0, 10, "s", NULL},
    {"X", "target", HIMC_ARGUMENT_NUMBER, -3, 3, "m", NULL},
    {"Y", "target", HIMC_ARGUMENT_NUMBER, -3, 3, "m", NULL},
    {"X", "place", HIMC_ARGUMENT_NUMBER, -5, 5, "m", NULL},
    {"Y", "place", HIMC_ARGUMENT_NUMBER, -5, 5, "m", NULL},
    {"X", NULL, HIMC_ARGUMENT_NUMBER, -1, 1, "m", NULL},
    {"Y", NULL, HIMC_ARGUMENT_NUMBER, -1, 1, "m", NULL},
    {"Z", NULL, HIMC_ARGUMENT_NUMBER, 0, 3, "m", NULL},
    {"TILT", NULL, HIMC_ARGUMENT_NUMBER, -0.8, 0.8, "rad", NULL},
    {"LAMBDA", NULL, HIMC_ARGUMENT_NUMBER, 1e-4, 1, "m", NULL},
    {"SHOULDER", NULL, HIMC_ARGUMENT_NUMBER, 1e-3, 1e3, "", NULL},
    {"ELBOW", NULL, HIMC_ARGUMENT_NUMBER, 1e-3, 1e3, "", NULL},
    {"WRIST", NULL, HIMC_ARGUMENT_NUMBER, 1e-3, 1e3, "", NULL},
    {"GRIP", NULL, HIMC_ARGUMENT_NUMBER, 1e-3, 1e3, "", NULL},
    {"HZ", "physics", HIMC_ARGUMENT_NUMBER, 500, 48000, "Hz", NULL},
    {"HZ", "task", HIMC_ARGUMENT_NUMBER, 50, 2000, "Hz", NULL},
    {"HZ", "tune", HIMC_ARGUMENT_NUMBER, 20, 2000, "Hz", NULL},
    {"HZ", NULL, HIMC_ARGUMENT_NUMBER, 1, 250, "Hz", NULL},
    {"HOST", NULL, HIMC_ARGUMENT_TEXT, 1, 255, "", NULL},
    {"PORT", "listen", HIMC_ARGUMENT_COUNT, 0, 65535, "", NULL},
    {"PORT", NULL, HIMC_ARGUMENT_COUNT, 1, 65535, "", NULL},
    {"NOTE", NULL, HIMC_ARGUMENT_NOTE, 20, 2000, "Hz", NULL},
    {"HEIGHT", NULL, HIMC_ARGUMENT_NUMBER, 1.2, 2.2, "m", NULL},
    {"MASS", "player", HIMC_ARGUMENT_NUMBER, 30, 200, "kg", NULL},
    {"MASS", NULL, HIMC_ARGUMENT_NUMBER, 0.001, 1, "kg", NULL},
    {"INCHES", NULL, HIMC_ARGUMENT_NUMBER, 12, 60, "inches", NULL},
    {"RADIUS", NULL, HIMC_ARGUMENT_NUMBER, 0.05, 1, "m", NULL},
    {"TENSION", NULL, HIMC_ARGUMENT_NUMBER, 10, 1e5, "N/m", NULL},
    {"DENSITY", NULL, HIMC_ARGUMENT_NUMBER, 0.01, 10, "kg/m^2", NULL},
    {"COUNT", NULL, HIMC_ARGUMENT_COUNT, 1, 2000, "", NULL},
    {"T60", NULL, HIMC_ARGUMENT_NUMBER, 0.01, 100, "s", NULL},
    {"SIGMA0", NULL, HIMC_ARGUMENT_NUMBER, 0, 1000, "1/s", NULL},
    {"SIGMA1", NULL, HIMC_ARGUMENT_NUMBER, 0, 1, "s", NULL},
    {"K", NULL, HIMC_ARGUMENT_NUMBER, 1e3, 1e13, "N/m^alpha", NULL},
    {"ALPHA", NULL, HIMC_ARGUMENT_NUMBER, 1, 4, "", NULL},
    {"VOLUME", NULL, HIMC_ARGUMENT_NUMBER, 1e-4, 10, "m^3", NULL},
    {"AMOUNT", NULL, HIMC_ARGUMENT_NUMBER, 0, 1, "", NULL},
    {"SWITCH", NULL, HIMC_ARGUMENT_COUNT, 0, 1, "", NULL},
    {"LENGTH", NULL, HIMC_ARGUMENT_NUMBER, 0.05, 1.4, "m", NULL},
    {"WIDTH", NULL, HIMC_ARGUMENT_NUMBER, 0.05, 1.4, "m", NULL},
    {"CHANNELS", NULL, HIMC_ARGUMENT_COUNT, 1, 8, "", NULL},
    {"CHANNEL", NULL, HIMC_ARGUMENT_COUNT, 1, 8, "", NULL},
    {"AZIMUTH", NULL, HIMC_ARGUMENT_NUMBER, -6.2832, 6.2832, "rad", NULL},
    {"ELEVATION", NULL, HIMC_ARGUMENT_NUMBER, 0, 1.5708, "rad", NULL},
    {"DISTANCE", NULL, HIMC_ARGUMENT_NUMBER, 0.3, 100, "m", NULL},
    {"VELOCITY", NULL, HIMC_ARGUMENT_NUMBER, 0, 30, "m/s", NULL},
};

const himc_argument *himc_argument_find(const char *name, const char *context)
{
    for (size_t i = 0; i < sizeof arguments / sizeof *arguments; i++) {
        const himc_argument *a = &arguments[i];
        if (strcmp(a->name, name) == 0 && (!a->context || strcmp(a->context, context) == 0))
            return a;
    }
    return NULL;
}

int himc_word_index(const char *words, const char *word)
{
    size_t length = strlen(word);
    int index = 0;
    while (words && *words) {
        size_t n = strcspn(words, " |");
        if (n == length && strncmp(words, word, n) == 0)
            return index;
        words += n + (words[n] != '\0');
        index++;
    }
    return -1;
}

bool himc_note_frequency(const char *note, double *hz)
{
    static const int semitone[] = {9, 11, 0, 2, 4, 5, 7}; // a .. g above c
    int letter = tolower((unsigned char)*note);
    if (letter < 'a' || letter > 'g')
        return false;
    int key = semitone[letter - 'a'];
    const char *s = note + 1;
    for (; *s == '#' || *s == 'b'; s++)
        key += *s == '#' ? 1 : -1;
    if (s - note > 3 || !isdigit((unsigned char)s[0]) || s[1])
        return false;
    *hz = 440 * pow(2, (key - 9) / 12.0 + (s[0] - '4'));
    return true;
}

/// A drum's name must survive in a score line, an OSC address and a stroke's last atom.
static bool is_name(const char *word)
{
    if (!word[0] || strlen(word) >= HIMC_NAME_SIZE || strpbrk(word, " \t/#*?,;:[]{}\\\"$"))
        return false;
    for (const char *s = word; *s; s++)
        if (iscntrl((unsigned char)*s))
            return false;
    if (himc_word_index("comment center normal rim", word) >= 0)
        return false;
    for (int i = 0; himc_command_table(i); i++)
        if (himc_command_table(i)->receiver == HIMC_PERFORMER &&
            strcmp(himc_command_table(i)->name, word) == 0)
            return false;
    return true;
}

static bool accepts_word(const himc_argument *argument, const char *word)
{
    double hz;
    switch (argument->kind) {
    case HIMC_ARGUMENT_NAME: return is_name(word);
    case HIMC_ARGUMENT_TEXT: return strlen(word) >= argument->low && strlen(word) <= argument->high;
    case HIMC_ARGUMENT_NOTE:
        return himc_note_frequency(word, &hz) && hz >= argument->low && hz <= argument->high;
    default: return himc_word_index(argument->words, word) >= 0;
    }
}

bool himc_argument_accepts(const himc_argument *argument, const himc_atom *atom)
{
    if (atom->kind == HIMC_ATOM_SYMBOL)
        return accepts_word(argument, atom->symbol);
    if (argument->kind != HIMC_ARGUMENT_NUMBER && argument->kind != HIMC_ARGUMENT_COUNT)
        return false;
    double value = atom->number;
    if (argument->kind == HIMC_ARGUMENT_COUNT && value != floor(value))
        return false;
    return isfinite(value) && (float)value >= (float)argument->low &&
           (float)value <= (float)argument->high;
}

double himc_argument_number(const himc_argument *argument, double number)
{
    if ((float)number == (float)argument->low)
        return argument->low;
    return (float)number == (float)argument->high ? argument->high : (float)number;
}

void himc_argument_describe(const himc_argument *argument, char *text, size_t size)
{
    const char *space = argument->unit[0] ? " " : "";
    switch (argument->kind) {
    case HIMC_ARGUMENT_WORD: snprintf(text, size, "%s", argument->words); break;
    case HIMC_ARGUMENT_NAME:
        snprintf(text, size,
                 "a drum's name: up to %d letters and digits, none of the performer's commands",
                 HIMC_NAME_SIZE - 1);
        break;
    case HIMC_ARGUMENT_TEXT:
        snprintf(text, size, "a word of up to %g characters", argument->high);
        break;
    case HIMC_ARGUMENT_NOTE: snprintf(text, size, "a note from E0 to B6 such as A2 or f#3"); break;
    default:
        snprintf(text, size, "%s%s%g .. %g%s%s%s", argument->words ? argument->words : "",
                 argument->words ? " or " : "", argument->low, argument->high, space,
                 argument->unit, argument->kind == HIMC_ARGUMENT_COUNT ? ", whole" : "");
    }
}
