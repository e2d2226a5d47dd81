/// argument.c: the arguments of the commands with their physical ranges, in one table.
///
/// A command row names its arguments in capitals; here each name gets its kind, its range, its unit
/// and its words. A name may mean different things after different words, so a row with a context
/// comes before the row without one. Ranges that a struct's check shares are in himc/ranges.h.
#include "base/argument.h"

#include "base/line.h"
#include "himc/command_rows.h"
#include "himc/ranges.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

// in the order of himc_hand, himc_nuance, himc_spot
static const char *const hands[] = {"left", "right", NULL};
static const char *const stroke_hands[] = {"left", "right", "foot", NULL};
static const char *const hit_hands[] = {"left", "right", "any", "foot", NULL};
static const char *const nuances[] = {"legato",          "tenuto",   "accent",
                                      "vertical-accent", "staccato", NULL};
static const char *const spots[] = {"center",  "normal", "rim",   "crossstick",
                                    "rimshot", "click",  "shell", NULL};
const char *const himc_dynamic_words[] = {"ppp", "pp", "p", "mp", "mf", "f", "ff", "fff", NULL};
// the last: as the command `cresc` says
static const char *const stroke_dynamics[] = {"ppp", "pp", "p",   "mp", "mf",
                                              "f",   "ff", "fff", "-",  NULL};

#define WORD(word) word,
static const char *const listed[] = {HIMC_LISTS(WORD) NULL};
static const char *const setups[] = {HIMC_SETUPS(WORD) NULL};
static const char *const bars[] = {HIMC_BARS(WORD) NULL};
static const char *const shells[] = {HIMC_SHELLS(WORD) NULL};
static const char *const plates[] = {HIMC_PLATES(WORD) NULL};
static const char *const instruments[] = {HIMC_INSTRUMENTS(WORD) NULL};

static const himc_argument arguments[] = {
    {"BEAT|TO", NULL, HIMC_ARGUMENT_NUMBER, 0, 1e6, "", NULL},
    {"FROM", NULL, HIMC_ARGUMENT_NUMBER, 0, 999999, "", NULL}, // before TO
    {"HAND", "hit", HIMC_ARGUMENT_WORD, 0, 0, "", hit_hands},
    {"HAND", "stroke", HIMC_ARGUMENT_WORD, 0, 0, "", stroke_hands},
    {"HAND", NULL, HIMC_ARGUMENT_WORD, 0, 0, "", hands},
    {"NUANCE", NULL, HIMC_ARGUMENT_WORD, 0, 0, "", nuances},
    {"DYNAMIC", "cresc", HIMC_ARGUMENT_NUMBER, 0, 1, "", himc_dynamic_words},
    {"DYNAMIC", NULL, HIMC_ARGUMENT_NUMBER, 0, 1, "", stroke_dynamics},
    {"INSTRUMENT", NULL, HIMC_ARGUMENT_WORD, 0, 0, "", instruments},
    {"SETUP", NULL, HIMC_ARGUMENT_WORD, 0, 0, "", setups},
    {"BAR", NULL, HIMC_ARGUMENT_WORD, 0, 0, "", bars},
    {"SHELL", NULL, HIMC_ARGUMENT_WORD, 0, 0, "", shells},
    {"PLATE", NULL, HIMC_ARGUMENT_WORD, 0, 0, "", plates},
    {"LISTED", NULL, HIMC_ARGUMENT_WORD, 0, 0, "", listed},
    {"SPOT", NULL, HIMC_ARGUMENT_WORD, 0, 0, "", spots},
    {"NAME", "preset", HIMC_ARGUMENT_NAME, 0, 0, "", NULL},
    {"DRUM|NAME", NULL, HIMC_ARGUMENT_NAME, 0, 0, "", NULL},
    {"COMMAND", NULL, HIMC_ARGUMENT_TEXT, 1, HIMC_NAME_SIZE - 1, "", NULL},
    {"MS", NULL, HIMC_ARGUMENT_NUMBER, 0, HIMC_LATENCY_MAX, "ms", NULL},
    {"BPM", NULL, HIMC_ARGUMENT_NUMBER, HIMC_BPM_MIN, HIMC_BPM_MAX, "beats per minute", NULL},
    {"SWITCH", NULL, HIMC_ARGUMENT_COUNT, 0, 1, "", NULL},
    {"PART", NULL, HIMC_ARGUMENT_TEXT, 1, HIMC_PART_SIZE - 1, "", NULL},
    {"FILE", NULL, HIMC_ARGUMENT_TEXT, 1, HIMC_PATH_SIZE - 1, "", NULL},
    {"JOINT|SEGMENT", NULL, HIMC_ARGUMENT_TEXT, 1, 63, "", NULL},
    {"FACTOR", NULL, HIMC_ARGUMENT_NUMBER, 0.05, 20, "", NULL},
    {"KS", NULL, HIMC_ARGUMENT_NUMBER, 0, 1e6, "N m/rad", NULL},
    {"KD", NULL, HIMC_ARGUMENT_NUMBER, 0, 1e5, "N m s/rad", NULL},
    {"TORQUE", NULL, HIMC_ARGUMENT_NUMBER, 0.01, 10000, "N m", NULL},
    {"FX|FY|FZ", NULL, HIMC_ARGUMENT_NUMBER, -1000, 1000, "N", NULL},
    {"SECONDS", NULL, HIMC_ARGUMENT_NUMBER, 0, 10, "s", NULL},
    {"ALONG", NULL, HIMC_ARGUMENT_NUMBER, 0, 1, "m", NULL},
    {"X|Y", "target", HIMC_ARGUMENT_NUMBER, -3, 3, "m", NULL},
    {"X|Y|Z", "nudge", HIMC_ARGUMENT_NUMBER, -0.5, 0.5, "m", NULL},
    {"TIME", "nudge", HIMC_ARGUMENT_NUMBER, 0, 1e5, "s", NULL},
    {"SPAN", "nudge", HIMC_ARGUMENT_NUMBER, 0.05, 10, "s", NULL},
    {"X|Y", "place", HIMC_ARGUMENT_NUMBER, -5, 5, "m", NULL},
    // chosen: the far end of a recital's room
    {"X|Y", "listener", HIMC_ARGUMENT_NUMBER, -15, 15, "m", NULL},
    {"X|Y", NULL, HIMC_ARGUMENT_NUMBER, -1, 1, "m", NULL},
    {"Z", NULL, HIMC_ARGUMENT_NUMBER, 0, 3, "m", NULL},
    {"YAW|AZIMUTH", NULL, HIMC_ARGUMENT_NUMBER, -6.2832, 6.2832, "rad", NULL},
    {"TILT", NULL, HIMC_ARGUMENT_NUMBER, -0.8, 0.8, "rad", NULL},
    {"LAMBDA", NULL, HIMC_ARGUMENT_NUMBER, 1e-4, 1, "m", NULL},
    {"SHOULDER|ELBOW|WRIST|GRIP", NULL, HIMC_ARGUMENT_NUMBER, 1e-3, 1e3, "", NULL},
    {"HZ", "physics", HIMC_ARGUMENT_NUMBER, HIMC_PHYSICS_RATE_MIN, HIMC_PHYSICS_RATE_MAX, "Hz",
     NULL},
    {"HZ", "task", HIMC_ARGUMENT_NUMBER, HIMC_TASK_RATE_MIN, HIMC_TASK_RATE_MAX, "Hz", NULL},
    // principal mode; chosen: wider than any head's range, which find_tune tells
    {"HZ", "tune|gliss|bar", HIMC_ARGUMENT_NUMBER, 1, 20000, "Hz", NULL},
    {"HZ", "motor", HIMC_ARGUMENT_NUMBER, 0, HIMC_MOTOR_MAX, "Hz", NULL},
    {"HZ", NULL, HIMC_ARGUMENT_NUMBER, 1, 250, "Hz", NULL},
    {"HOST", NULL, HIMC_ARGUMENT_TEXT, 1, 255, "", NULL},
    {"PORT", "listen", HIMC_ARGUMENT_COUNT, 0, 65535, "", NULL},
    {"PORT", NULL, HIMC_ARGUMENT_COUNT, 1, 65535, "", NULL},
    {"NOTE", NULL, HIMC_ARGUMENT_NOTE, 1, 20000, "Hz", NULL},
    {"HEIGHT", NULL, HIMC_ARGUMENT_NUMBER, 1.2, 2.2, "m", NULL},
    {"MASS", "player", HIMC_ARGUMENT_NUMBER, HIMC_BODY_MASS_MIN, HIMC_BODY_MASS_MAX, "kg", NULL},
    {"MASS", NULL, HIMC_ARGUMENT_NUMBER, 0.001, 1, "kg", NULL},
    // of shells and plates; chosen: from the smallest bongo and splash, and the thinnest foil
    {"INCHES", "shell|plate", HIMC_ARGUMENT_NUMBER, HIMC_RADIUS_MIN * 2 / 0.0254, HIMC_INCHES_MAX,
     "inches", NULL},
    {"MM", NULL, HIMC_ARGUMENT_NUMBER, 0.3, 10, "mm", NULL},
    {"INCHES", NULL, HIMC_ARGUMENT_NUMBER, HIMC_INCHES_MIN, HIMC_INCHES_MAX, "inches", NULL},
    {"SIZE", NULL, HIMC_ARGUMENT_NUMBER, 0.3, 20000,
     "inches of a head or a cymbal, mm of its thickness, Hz of others", NULL},
    {"RADIUS", NULL, HIMC_ARGUMENT_NUMBER, HIMC_RADIUS_MIN, HIMC_RADIUS_MAX, "m", NULL},
    {"TENSION", NULL, HIMC_ARGUMENT_NUMBER, HIMC_TENSION_MIN, HIMC_TENSION_MAX, "N/m", NULL},
    {"DENSITY", NULL, HIMC_ARGUMENT_NUMBER, 0.01, HIMC_DENSITY_MAX, "kg/m^2", NULL},
    {"PHASE", NULL, HIMC_ARGUMENT_NUMBER, 0, 1, "", NULL},
    {"PARTS", NULL, HIMC_ARGUMENT_COUNT, 1, 24, "", NULL},
    {"WHAT", NULL, HIMC_ARGUMENT_TEXT, 1, HIMC_NAME_SIZE - 1, "", NULL},
    {"COUNT", NULL, HIMC_ARGUMENT_COUNT, 1, 2000, "", NULL},
    {"T60", NULL, HIMC_ARGUMENT_NUMBER, 0.01, 100, "s", NULL},
    {"SIGMA0", NULL, HIMC_ARGUMENT_NUMBER, 0, HIMC_SIGMA0_MAX, "1/s", NULL},
    {"SIGMA1", NULL, HIMC_ARGUMENT_NUMBER, 0, HIMC_SIGMA1_MAX, "s", NULL},
    {"K", NULL, HIMC_ARGUMENT_NUMBER, 1e3, 1e13, "N/m^alpha", NULL},
    {"ALPHA", NULL, HIMC_ARGUMENT_NUMBER, 1, 4, "", NULL},
    {"VOLUME", "room", HIMC_ARGUMENT_NUMBER, 20, 1e5, "m^3", NULL},
    // chosen: wider than any head's range, half to twice its usual volume (himc_air_check)
    {"VOLUME", NULL, HIMC_ARGUMENT_NUMBER, 1e-4, 10,
     "m^3, half to twice the usual one of the head's size", NULL},
    // chosen: from a loose strainer, 50, to five times a tight one
    {"PULL", NULL, HIMC_ARGUMENT_NUMBER, 0, HIMC_WIRES_MAX, "m/s^2", NULL},
    {"AMOUNT", NULL, HIMC_ARGUMENT_NUMBER, 0, 1, "", NULL},
    {"DB", NULL, HIMC_ARGUMENT_NUMBER, -60, 24, "dB", NULL},
    {"SEED", NULL, HIMC_ARGUMENT_COUNT, 0, HIMC_SEED_MAX, "", NULL},
    {"LENGTH", "roll|tempo|cresc|gliss", HIMC_ARGUMENT_NUMBER, 0.05, 1000, "beats", NULL},
    {"LENGTH|WIDTH", NULL, HIMC_ARGUMENT_NUMBER, 0.05, 1.4, "m", NULL},
    {"CHANNELS|CHANNEL", NULL, HIMC_ARGUMENT_COUNT, 1, HIMC_PICKUPS, "", NULL},
    {"ELEVATION", NULL, HIMC_ARGUMENT_NUMBER, 0, HIMC_ELEVATION_MAX, "rad", NULL},
    {"DISTANCE", NULL, HIMC_ARGUMENT_NUMBER, HIMC_PICKUP_DISTANCE_MIN, HIMC_PICKUP_DISTANCE_MAX,
     "m", NULL},
    {"PITCH|VELOCITY", "note", HIMC_ARGUMENT_NUMBER, 0, 127, "", NULL},
    {"VELOCITY", NULL, HIMC_ARGUMENT_NUMBER, HIMC_STRIKE_VELOCITY_MIN, HIMC_STRIKE_VELOCITY_MAX,
     "m/s", NULL},
};

// whether the word is in "A|B"
static bool is_among(const char *word, const char *list)
{
    size_t n = strlen(word);
    const char *at = strstr(list, word);
    while (at && ((at > list && at[-1] != '|') || (at[n] && at[n] != '|')))
        at = strstr(at + 1, word);
    return at;
}

const himc_argument *himc_argument_find(const char *name, const char *context)
{
    for (size_t i = 0; i < sizeof arguments / sizeof *arguments; i++) {
        const himc_argument *a = &arguments[i];
        if (is_among(name, a->names) && (!a->contexts || is_among(context, a->contexts)))
            return a;
    }
    return NULL;
}

static int find_word(const char *const *words, const char *word)
{
    if (strcmp(word, "centre") == 0) // as British writers do
        word = "center";
    for (int i = 0; words && words[i]; i++)
        if (strcmp(words[i], word) == 0)
            return i;
    return -1;
}

int himc_argument_choice(const himc_argument *argument, const himc_atom *atom)
{
    return atom->kind == HIMC_ATOM_SYMBOL ? find_word(argument->words, atom->symbol) : -1;
}

const char *himc_hand_name(himc_hand hand)
{
    return hand == HIMC_FOOT ? "foot" : hands[hand == HIMC_LEFT ? HIMC_LEFT : HIMC_RIGHT];
}

himc_hand himc_argument_hand(const himc_atom *atom)
{
    static const himc_hand extra[] = {HIMC_LEFT, HIMC_RIGHT, HIMC_HAND_ANY, HIMC_FOOT};
    return extra[find_word(hit_hands, atom->symbol)];
}

bool himc_is_hand(const char *word)
{
    return find_word(stroke_hands, word) >= 0;
}

const char *himc_nuance_name(himc_nuance nuance)
{
    return nuance >= 0 && nuance < HIMC_NUANCES ? nuances[nuance] : "none";
}

const char *himc_spot_name(himc_spot spot)
{
    return spot >= 0 && spot < HIMC_SPOT_XY ? spots[spot] : "";
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

bool himc_note_name(double hz, char name[HIMC_NOTE_SIZE])
{
    static const char *const names[] = {"C",  "C#", "D",  "D#", "E",  "F",
                                        "F#", "G",  "G#", "A",  "A#", "B"};
    double its = 0, key = round(12 * log2(hz / 440)) + 57;
    if (!(key >= 0 && key < 12 * 10))
        return false;
    snprintf(name, HIMC_NOTE_SIZE, "%s%c", names[(int)key % 12], '0' + (int)key / 12);
    return himc_note_frequency(name, &its) && its == hz;
}

bool himc_argument_accepts(const himc_argument *argument, const himc_atom *atom)
{
    const char *word = atom->kind == HIMC_ATOM_SYMBOL ? atom->symbol : NULL;
    double value = atom->number;
    switch (argument->kind) {
    case HIMC_ARGUMENT_NAME:
        // it must stay itself in a score line, an OSC address and as a stroke's last atom
        return word && word[0] && strlen(word) < HIMC_NAME_SIZE &&
               !strpbrk(word, " \t/#*?,;:[]{}\\\"$") && himc_line_is_clean(word) &&
               strcmp(word, "comment") != 0 && strcmp(word, "dead") != 0 &&
               find_word(spots, word) < 0 && !himc_command_find(HIMC_PERFORMER, word);
    case HIMC_ARGUMENT_TEXT:
        return word && strlen(word) >= argument->low && strlen(word) <= argument->high;
    case HIMC_ARGUMENT_NOTE:
        return word && himc_note_frequency(word, &value) && value >= argument->low &&
               value <= argument->high;
    case HIMC_ARGUMENT_WORD: return word && find_word(argument->words, word) >= 0;
    default:
        if (word)
            return find_word(argument->words, word) >= 0;
        if (argument->kind == HIMC_ARGUMENT_COUNT && value != floor(value))
            return false;
        return isfinite(value) && (float)value >= (float)argument->low &&
               (float)value <= (float)argument->high;
    }
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
    char words[256] = "";
    size_t used = 0;
    for (int i = 0; argument->words && argument->words[i] && used < sizeof words; i++)
        used += (size_t)snprintf(words + used, sizeof words - used, "%s%s", i ? " " : "",
                                 argument->words[i]);
    switch (argument->kind) {
    case HIMC_ARGUMENT_WORD: snprintf(text, size, "%s", words); break;
    case HIMC_ARGUMENT_NAME:
        snprintf(text, size,
                 "%s: up to %d letters and digits, no number, no spot, not `dead` of strokes, "
                 "no command of the performer",
                 argument->contexts ? "a name, without a folder" : "a drum's name",
                 HIMC_NAME_SIZE - 1);
        break;
    case HIMC_ARGUMENT_TEXT:
        snprintf(text, size, "a word of up to %g characters", argument->high);
        break;
    case HIMC_ARGUMENT_NOTE: snprintf(text, size, "a note such as A2 or f#3"); break;
    default:
        snprintf(text, size, "%s%s%g .. %g%s%s%s", words, words[0] ? " or " : "", argument->low,
                 argument->high, space, argument->unit,
                 argument->kind == HIMC_ARGUMENT_COUNT ? ", whole" : "");
    }
}
