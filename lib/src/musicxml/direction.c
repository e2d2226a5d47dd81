/// direction.c: words, dynamics, hairpins, tempi and jumps of a document as signs of the music.
///
/// Words that follow each other in one direction are one text. Tempi, fermatas and jumps are taken
/// of all parts, all else of parts that are played.
#include "musicxml/phrases.h"
#include "musicxml/reader.h"

#include "base/array.h"
#include "base/format.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

void himc_music_sign(music_reader *r, double beat, music_meaning meaning, double value)
{
    music *m = r->music;
    if (!himc_array_grow(&m->signs, m->sign_count, &m->sign_room, sizeof *m->signs, r->error)) {
        r->failed = true;
        return;
    }
    m->signs[m->sign_count] =
        (music_sign){{beat, r->bar, r->part, m->sign_count}, meaning, value, r->lane, 0};
    m->sign_count++;
}

int himc_music_lane(const xml_node *node)
{
    return 100 * himc_music_staff(node) + abs(himc_xml_whole(node, "voice", 0)) % 100;
}

static void add_swing(music_reader *r, double beat, double first, double second, double unit)
{
    if (first > 0 && second > 0)
        himc_music_sign(r, beat, MUSIC_SWING, first / (first + second) + (unit < 0.5));
}

void himc_music_sound(music_reader *r, const xml_node *sound, double beat, bool dynamic_too)
{
    const xml_node *change = himc_xml_child(sound, "instrument-change");
    for (; change; change = himc_xml_next(change))
        himc_music_instruments_sound(&r->instruments, r->lane / 100, change);
    music_bar *bar = &r->music->bars[r->bar];
    const char *tempo = himc_xml_attribute(sound, "tempo"),
               *level = himc_xml_attribute(sound, "dynamics");
    if (strtod(tempo, NULL) > 0)
        himc_music_sign(r, beat, MUSIC_TEMPO, strtod(tempo, NULL));
    if (dynamic_too && level[0]) // percent of a velocity of 90
        himc_music_sign(r, beat, MUSIC_DYNAMIC, himc_midi_dynamic(0.9 * strtod(level, NULL), 0));
    for (const xml_node *w = himc_xml_child(sound, "swing"); w; w = himc_xml_next(w)) {
        bool straight = himc_xml_child(w, "straight");
        add_swing(r, beat, straight ? 1 : himc_xml_number(w, "first", 2),
                  straight ? 1 : himc_xml_number(w, "second", 1),
                  strcmp(himc_xml_text(w, "swing-type"), "16th") == 0 ? 0.25 : 0.5);
    }
    bar->da_capo |= himc_music_yes(sound, "dacapo");
    bar->dal_segno |= himc_xml_attribute(sound, "dalsegno")[0] != '\0';
    bar->segno |= himc_xml_attribute(sound, "segno")[0] != '\0';
    bar->coda |= himc_xml_attribute(sound, "coda")[0] != '\0';
    bar->to_coda |= himc_xml_attribute(sound, "tocoda")[0] != '\0';
    bar->fine |= himc_xml_attribute(sound, "fine")[0] != '\0';
}

// of all parts, wherever they are written
static bool is_tempo(music_meaning meaning)
{
    return meaning >= MUSIC_TEMPO && meaning <= MUSIC_FERMATA;
}

// "Coda" alone, where it begins
static bool is_coda(const char *text)
{
    while (isspace((unsigned char)*text))
        text++;
    return tolower((unsigned char)*text) == 'c' && strncmp(text + 1, "oda", 3) == 0 &&
           text[4 + strspn(text + 4, " .:\n")] == '\0';
}

/// A direction.
typedef struct directed {
    double beat;
    bool own;         ///< the part is played
    bool jumps;       ///< a `sound` says where it jumps
    bool sound_tempo; ///< ... and how fast it is
    bool tempo;       ///< it has a number for the tempo
    bool bold;        ///< words of it are, as those of tempo are printed
    bool dynamic;     ///< one is found
    int first;        ///< sign of it
    char words[512];  ///< just before ...
    const char *name; ///< ... and the first of them, as the document has it
} directed;

// Mallets in the name of an instrument ("wood block"), which are no change of them. `instructs`: the
// name, not what is in brackets behind it, asks for something else, too.
static int count_mallets(const char *text, bool *instructs)
{
    char part[64];
    music_meaning meaning[8];
    double unused[8];
    int mallets = 0;
    size_t begin, length = himc_music_named(text, &begin);
    himc_format(part, sizeof part, "%.*s", (int)length, text + begin);
    int found = himc_music_words(part, 8, meaning, unused);
    for (int i = 0; i < found; i++)
        mallets += meaning[i] == MUSIC_MALLET;
    *instructs = found > mallets;
    return mallets;
}

// true if it has a dynamic
static bool read_words(music_reader *r, const directed *by)
{
    const char *text = by->words;
    music_bar *bar = &r->music->bars[r->bar];
    music_meaning meaning[8];
    double value[8];
    const double beat = by->beat;
    const bool own = by->own, sound = by->jumps;
    bool dynamic = false;
    char small[32];
    int hands = own ? himc_music_hands(text, sizeof r->hands, r->hands) : 0;
    if (hands > 0) {
        r->hand = 0;
        r->hand_count = hands;
        return false;
    }
    for (size_t i = 0; i == 0 || small[i - 1]; i++)
        small[i] = (char)(i + 1 < sizeof small ? tolower((unsigned char)text[i]) : 0);
    int times = himc_music_times(small);
    bar->said = times ? times : bar->said;
    int count = himc_music_words(text, 8, meaning, value), key;
    bool bare = false, instructs = count > 0;
    bool name = himc_music_change(text, &key, &bare) != MIDI_ANY && bare;
    int mallets = name ? count_mallets(text, &instructs) : 0;
    bar->coda |= is_coda(text) && !sound;
    if (count == 0 && by->bold && !name) // a ritardando ends at words of tempo that are unknown
        himc_music_sign(r, beat, MUSIC_TEMPO_SHARE, 1);
    for (int i = 0; i < count; i++) {
        // a `sound` beside it says where it jumps
        bar->da_capo |= meaning[i] == MUSIC_DA_CAPO && !sound;
        bar->dal_segno |= meaning[i] == MUSIC_DAL_SEGNO && !sound;
        bar->to_coda |= meaning[i] == MUSIC_TO_CODA && !sound;
        bar->fine |= meaning[i] == MUSIC_FINE && !sound;
        bool tunes = r->music->note_count > r->first || meaning[i] != MUSIC_TUNING ||
                     value[i] >= 1200; // "G - C" before the first note says how drums are tuned
        if (!tunes || (meaning[i] == MUSIC_MALLET && mallets-- > 0) ||
            (by->tempo && meaning[i] == MUSIC_TEMPO))
            continue;
        if (meaning[i] < MUSIC_DA_CAPO && (own || is_tempo(meaning[i])))
            himc_music_sign(r, beat, meaning[i], value[i]);
        dynamic |= meaning[i] == MUSIC_DYNAMIC;
        r->hand_count = meaning[i] == MUSIC_HAND ? r->hand : r->hand_count;
    }
    const int rows = r->instruments.count;
    if (own)
        himc_music_instruments_change(&r->instruments, r->lane / 100, text, instructs);
    if (r->instruments.count > rows) // the text ends with the direction
        r->instruments.row[rows].name = by->name;
    return dynamic;
}

static double beats_of(const char *unit)
{
    static const struct {
        const char *unit;
        double beats;
    } units[] = {{"whole", 4},  {"half", 2},  {"quarter", 1}, {"eighth", .5},
                 {"16th", .25}, {"breve", 8}, {"32nd", .125}};
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (strcmp(unit, units[i].unit) == 0)
            return units[i].beats;
    return 0;
}

// a note and its number, or, by either element, a note that becomes another; two that become two
// others, which a tuplet may hold, are a swing
static void read_metronome(music_reader *r, const xml_node *metronome, double beat)
{
    const char *text = himc_xml_text(metronome, "per-minute");
    double beats[4] = {0}, more = 0; // the last is the first
    int notes = 0;
    for (const xml_node *d = metronome->child; d; d = d->next) {
        bool note = himc_xml_is(d, "metronome-note");
        const xml_node *dot = note ? himc_xml_child(d, "metronome-dot") : NULL;
        if (note || himc_xml_is(d, "beat-unit")) {
            memmove(beats + 1, beats, 3 * sizeof *beats);
            beats[0] = beats_of(note ? himc_xml_text(d, "metronome-type") : d->text);
            more = beats[0] / 2;
            notes++;
        }
        if (himc_xml_is(d, "beat-unit-dot") || dot) {
            beats[0] += more;
            more /= 2;
        }
    }
    double number = strtod(text + strcspn(text, "0123456789"), NULL); // "ca. 96"
    if (notes == 2 && beats[1] > 0 && beats[0] > 0)
        himc_music_sign(r, beat, MUSIC_TEMPO_SHARE, beats[0] / beats[1]);
    else if (notes == 1 && beats[0] * number > 0)
        himc_music_sign(r, beat, MUSIC_TEMPO, beats[0] * number);
    else if (notes == 4 && beats[3] == beats[2])
        add_swing(r, beat, beats[1], beats[0], beats[3]);
}

static void read_wedge(music_reader *r, const xml_node *wedge, double beat)
{
    double way = himc_xml_has(wedge, "type", "crescendo")    ? 1
                 : himc_xml_has(wedge, "type", "diminuendo") ? -1
                                                             : 0;
    bool circle = himc_music_yes(wedge, "niente");
    // the circle of a diminuendo stands at its stop, or at its beginning, as some programs write
    if (way > 0 ? circle : himc_xml_has(wedge, "type", "stop") && (circle || r->niente))
        himc_music_sign(r, beat, MUSIC_DYNAMIC, 0);
    if (!himc_xml_has(wedge, "type", "continue")) {
        himc_music_sign(r, beat, MUSIC_WEDGE, way);
        r->niente = way < 0 && circle;
    }
}

// a line behind words about tuning is a pedal's, behind those of a ritardando it says how long
static void read_line(music_reader *r, const xml_node *dashes, double beat, int first)
{
    const music *m = r->music;
    const char *number = himc_xml_attribute(dashes, "number");
    int line = number[0] ? number[0] - '0' : 1;
    if (line < 1 || line > MUSIC_LINES_MAX)
        return;
    if (himc_xml_has(dashes, "type", "stop") && r->line[line - 1]) {
        himc_music_sign(r, beat, MUSIC_GLISS_END, 0);
        m->signs[m->sign_count - 1].line = line;
        r->line[line - 1] = false;
    }
    if (himc_xml_has(dashes, "type", "stop") && r->ramp[line - 1])
        himc_music_sign(r, beat, MUSIC_TEMPO_SHARE, 1);
    r->ramp[line - 1] = false;
    for (int i = first; i < m->sign_count && himc_xml_has(dashes, "type", "start"); i++) {
        r->ramp[line - 1] |= m->signs[i].meaning == MUSIC_TEMPO_RAMP;
        if (m->signs[i].meaning == MUSIC_TUNING || m->signs[i].meaning == MUSIC_GLISS) {
            m->signs[i].meaning = MUSIC_GLISS;
            m->signs[i].line = line;
            r->line[line - 1] = true;
        }
    }
}

// a picture of mallets
static void read_percussion(music_reader *r, const xml_node *percussion, double beat)
{
    static const char *const materials[] = {"soft", "medium", "hard", "wood"};
    const xml_node *stick = himc_xml_child(percussion, "stick");
    for (int i = 0; i < 4; i++)
        if (strcmp(himc_xml_text(stick, "stick-material"), materials[i]) == 0)
            himc_music_sign(r, beat, MUSIC_MALLET, i);
}

bool himc_music_dynamics(music_reader *r, const xml_node *dynamics, double beat, const char *before)
{
    bool found = false;
    music *m = r->music;
    for (const xml_node *d = dynamics->child; d; d = d->next) {
        music_meaning meaning;
        double value;
        const char *name = himc_xml_is(d, "other-dynamics") ? d->text : d->name;
        char both[80];
        himc_format(both, sizeof both, "%.40s %.30s", before, name);
        bool words = himc_music_words(before, 1, &meaning, &value) == 0 && // "più"
                     himc_music_words(both, 1, &meaning, &value) == 1 &&
                     (meaning == MUSIC_DYNAMIC || meaning == MUSIC_LOUDER);
        if (words || himc_music_dynamic(name, &meaning, &value)) {
            music_sign *last = found && !r->failed ? &m->signs[m->sign_count - 1] : NULL;
            bool attack = last && last->meaning == MUSIC_ATTACK,
                 falls = last && last->meaning == MUSIC_DYNAMIC && last->value > value;
            found = true;
            if (meaning != MUSIC_DYNAMIC || !(attack || falls)) {
                himc_music_sign(r, beat, meaning, value);
                continue;
            }
            last->meaning = MUSIC_FORTEPIANO; // f and p are an fp
            last->value = value + (falls ? 2 * round(7 * last->value) : 0);
        }
    }
    return found;
}

// one of a direction's signs; words that follow each other are one text
static void read_type(music_reader *r, const xml_node *d, const xml_node *next, directed *by)
{
    music_bar *bar = &r->music->bars[r->bar];
    const double beat = by->beat;
    const bool own = by->own;
    if (himc_xml_is(d, "words")) {
        size_t used = strlen(by->words);
        by->name = used ? by->name : d->text;
        himc_format(by->words + used, sizeof by->words - used, used ? " %s" : "%s", d->text);
        by->bold |= himc_xml_has(d, "font-weight", "bold");
        by->dynamic |= !himc_xml_is(next, "words") && read_words(r, by);
        return;
    }
    if (himc_xml_is(d, "metronome") && !by->sound_tempo)
        read_metronome(r, d, beat);
    else if (himc_xml_is(d, "segno") && !by->jumps)
        bar->segno = true;
    else if (himc_xml_is(d, "coda") && !by->jumps)
        bar->coda = true;
    else if (own && himc_xml_is(d, "dynamics"))
        by->dynamic |= himc_music_dynamics(r, d, beat, by->words);
    else if (own && himc_xml_is(d, "wedge"))
        read_wedge(r, d, beat);
    else if (own && himc_xml_is(d, "percussion"))
        read_percussion(r, d, beat);
    else if (himc_xml_is(d, "dashes") || himc_xml_is(d, "bracket"))
        read_line(r, d, beat, by->first);
    else if (own && (himc_xml_is(d, "damp") || himc_xml_is(d, "damp-all")))
        himc_music_sign(r, beat, MUSIC_DAMP, 0);
    else if (own && himc_xml_is(d, "pedal") &&
             (himc_xml_has(d, "type", "change") || himc_xml_has(d, "type", "stop")))
        himc_music_sign(r, beat, MUSIC_PEDAL, 0);
    by->words[0] = '\0';
}

void himc_music_direction(music_reader *r, const xml_node *direction, bool own)
{
    static const char *const jump[] = {"dacapo", "dalsegno", "tocoda", "fine", "coda", "segno"};
    const xml_node *offset = himc_xml_child(direction, "offset"); // it may be of the print alone
    double moved =
        himc_xml_has(offset, "sound", "no") ? 0 : himc_xml_number(direction, "offset", 0);
    const xml_node *sound = himc_xml_child(direction, "sound"),
                   *first = himc_xml_child(direction, "direction-type");
    directed by = {.beat = fmax(r->at + moved / r->divisions, 0),
                   .own = own,
                   .sound_tempo = himc_xml_attribute(sound, "tempo")[0] != '\0',
                   .first = r->music->sign_count};
    by.tempo = by.sound_tempo;
    for (int i = 0; i < 6; i++)
        by.jumps |= himc_xml_attribute(sound, jump[i])[0] != '\0';
    for (const xml_node *t = first; t; t = himc_xml_next(t))
        by.tempo |= himc_xml_child(t, "metronome") != NULL;
    r->lane = himc_music_lane(direction);
    for (const xml_node *t = first; t; t = himc_xml_next(t))
        for (const xml_node *d = t->child; d; d = d->next)
            read_type(r, d, d->next || !himc_xml_next(t) ? d->next : himc_xml_next(t)->child, &by);
    himc_music_sound(r, sound, by.beat, own && !by.dynamic);
    r->lane = 0;
}
