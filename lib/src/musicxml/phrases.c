/// phrases.c: metronome marks, hands, numbers of times and split words in a text.
///
/// A note of a metronome mark is a sign of Unicode, whole or in pieces (head, stem, flag), one of
/// SMuFL's private signs, or the letter that has its place in a music font (w h q e x). Of a range
/// of tempi the middle holds.
#include "musicxml/phrases.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#define LEAST_BPM 10 // a smaller number is no tempo; chosen
#define MOST_BPM 600
#define MOST_RANGE 1.6 // of a second number over the first; chosen
#define MOST_TIMES 31  // as a repeat's attribute

// U+1D15x, U+E1Dx, U+ECAx
static const struct {
    const char *sign;
    double beats;
} notes[] = {{"♩", 1},
             {"♪", 0.5},
             {"\xF0\x9D\x85\x9D", 4},
             {"\xF0\x9D\x85\x9E", 2},
             {"\xF0\x9D\x85\x97\xF0\x9D\x85\xA5", 2},
             {"\xF0\x9D\x85\x9F", 1},
             {"\xF0\x9D\x85\x98\xF0\x9D\x85\xA5\xF0\x9D\x85\xAE", 0.5},
             {"\xF0\x9D\x85\x98\xF0\x9D\x85\xA5", 1},
             {"\xF0\x9D\x85\xA0", 0.5},
             {"\xF0\x9D\x85\xA1", 0.25},
             {"\xEE\x87\x93", 2},
             {"\xEE\x87\x95", 1},
             {"\xEE\x87\x97", 0.5},
             {"\xEE\xB2\xA3", 2},
             {"\xEE\xB2\xA5", 1},
             {"\xEE\xB2\xA7", 0.5},
             {"\xEE\xB2\xA9", 0.25},
             {"w", 4},
             {"h", 2},
             {"q", 1},
             {"e", 0.5},
             {"x", 0.25}};

static bool skip(const char **at, const char *word)
{
    size_t length = strlen(word);
    bool is = strncmp(*at, word, length) == 0;
    *at += is ? length : 0;
    return is;
}

static void skip_spaces(const char **at)
{
    *at += strspn(*at, " ");
}

// the beats of a note at `*at`, which moves behind it and its dot; 0: none
static double read_note(const char **at)
{
    static const char *const dots[] = {".", "·", "\xF0\x9D\x85\xAD", "\xEE\x87\xA7",
                                       "\xEE\xB2\xB7"};
    for (size_t i = 0; i < sizeof notes / sizeof *notes; i++) {
        const char *p = *at;
        bool letter = isalpha((unsigned char)*notes[i].sign), dotted = false;
        if (!skip(&p, notes[i].sign))
            continue;
        const char *behind = p;
        skip_spaces(&behind);
        for (size_t d = 0; d < sizeof dots / sizeof *dots && !dotted; d++)
            dotted = skip(&behind, dots[d]);
        p = dotted ? behind : p;
        if (letter && *p && !strchr(" =)", *p))
            continue;
        *at = p;
        return notes[i].beats * (dotted ? 1.5 : 1);
    }
    return 0;
}

// "72", "ca. 72", "72 76"; 0: none
static double read_number(const char *at)
{
    static const char *const about[] = {"circa",   "ca.",  "ca",   "c.", "about",
                                        "approx.", "etwa", "env.", "≈",  "~"};
    skip_spaces(&at);
    for (size_t i = 0; i < sizeof about / sizeof *about; i++)
        if (skip(&at, about[i]))
            break;
    skip_spaces(&at);
    if (!isdigit((unsigned char)*at))
        return 0;
    char *end;
    double number = strtod(at, &end);
    at = end;
    skip_spaces(&at);
    skip(&at, "–");
    double more = strtod(at, NULL);
    number = more > number && more < MOST_RANGE * number ? (number + more) / 2 : number;
    return number >= LEAST_BPM && number <= MOST_BPM ? number : 0;
}

// true if one more note stands before a place: "♪♪ = ♩♪" is a swing
static bool is_behind_note(const char *text, const char *at)
{
    while (at > text && at[-1] == ' ')
        at--;
    return at > text && (unsigned char)at[-1] >= 0x80;
}

bool himc_music_metronome(const char *text, music_meaning *meaning, double *value)
{
    static const char *const about[] = {"m.m.", "mm", "ca.", "c.", "circa"};
    *meaning = MUSIC_TEMPO;
    for (const char *at = text; *at; at++) {
        bool begins = at == text || !isalnum((unsigned char)at[-1]);
        const char *p = at;
        double beats = begins ? read_note(&p) : 0;
        bool letter = isalpha((unsigned char)*at);
        skip_spaces(&p);
        bool equal = beats > 0 && (skip(&p, "=") || skip(&p, "≈"));
        skip_spaces(&p);
        if (equal || (beats > 0 && !letter)) {
            double number = read_number(p), other = 0;
            if (equal && number == 0 && !is_behind_note(text, at))
                other = read_note(&p);
            *meaning = other > 0 ? MUSIC_TEMPO_SHARE : MUSIC_TEMPO;
            *value = other > 0 ? other / beats : beats * number;
            if (*value > 0)
                return true;
        }
        for (size_t i = 0; i < sizeof about / sizeof *about && begins; i++) {
            p = at;
            if (!skip(&p, about[i]))
                continue;
            skip_spaces(&p);
            skip(&p, "=");
            *value = read_number(p);
            p += strcspn(p, "0123456789");
            p += strspn(p, "0123456789. –");
            if (*value > 0 && (!*p || *p == ')'))
                return true;
        }
    }
    return false;
}

int himc_music_syllables(const char *text)
{
    static const struct {
        const char *word;
        size_t least;
        int way;
    } words[] = {{"crescendo", 3, 1}, {"decrescendo", 2, -1}, {"diminuendo", 2, -1}};
    char letters[16];
    size_t count = 0;
    for (const char *c = text; *c; c++) {
        if (strchr(" -._", *c))
            continue;
        if (!islower((unsigned char)*c) || count == sizeof letters)
            return 0;
        letters[count++] = *c;
    }
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (count >= words[i].least && count <= strlen(words[i].word) &&
            strncmp(letters, words[i].word, count) == 0)
            return words[i].way;
    return 0;
}

int himc_music_times(const char *text)
{
    static const char *const before[] = {"play ", "repeat ", "x"};
    static const char *const units[] = {"times", "x", "volte",   "fois", "mal",
                                        "veces", "×", "\xC3\xB7"}; // × in small letters
    bool unit = false;
    text += strspn(text, " ([");
    for (size_t i = 0; i < sizeof before / sizeof *before; i++)
        if (skip(&text, before[i]))
            unit = i == 2;
    char *end;
    long times = strtol(text, &end, 10);
    const char *at = end;
    skip_spaces(&at);
    for (size_t i = 0; i < sizeof units / sizeof *units && !unit; i++)
        unit = skip(&at, units[i]);
    at += strspn(at, " .)]");
    return unit && end > text && !*at && times >= 2 && times <= MOST_TIMES ? (int)times : 0;
}

int himc_music_hands(const char *words, int most, char *hands)
{
    bool capitals = strpbrk(words, "RL") != NULL;
    int count = 0;
    for (; *words; words++) {
        if (strchr("RL", *words) || (!capitals && strchr("rl", *words))) {
            if (count == most)
                return 0;
            hands[count++] =
                (char)(1 + (toupper((unsigned char)*words) == 'R' ? HIMC_RIGHT : HIMC_LEFT));
        } else if (!strchr("rl", *words) && !isspace((unsigned char)*words) &&
                   !strchr("-,.", *words)) {
            return 0;
        }
    }
    return count > 1 ? count : 0;
}
