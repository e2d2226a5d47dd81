/// write.c: notes as MusicXML 4.0 for notation programs, in bars of 4/4.
///
/// Time counts in TICKS of a quarter note. Notes that overlap stand in several voices; a note lasts
/// up to the next one of its voice or to the bar's end, a roll as long as it is, tied over bars.
/// Dynamics are steps: a mark where the step changes, a hairpin for a roll that moves by one at
/// least. An accent is read back a step louder (shape.c), so it is written a step softer. A gliss
/// is words with a line. Words and marks of a bar are written first, then each voice, each back
/// from the bar's end.
#include "musicxml/export.h"

#include "base/format.h"
#include "midi/part.h"
#include "musicxml/music.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TICKS 960 // of a quarter note; chosen: 0.5 ms at 120 beats a minute
#define BAR ((int)MUSIC_BAR * TICKS)
#define VOICES 4

/// A note of a part.
typedef struct item {
    const midi_note *note;
    long begin, end; ///< (ticks)
    int voice;
} item;

/// A beginning of a note, or an end of its hairpin.
typedef struct mark {
    long tick;
    bool ends;
    const item *item;
} mark;

typedef struct writer {
    himc_text_lines *out;
    const midi_file *file;
    midi_choice choice;
    item *items;
    mark *marks;    ///< scratch: two for each note
    himc_spot spot; ///< the last that was written
    int count;
    int step;   ///< the last dynamic that was marked, 0 .. 7; -1: none
    bool first; ///< of the parts: it has the tempi
    long end;   ///< of all parts (ticks)
} writer;

#define PUT(w, ...) himc_text_print((w)->out, __VA_ARGS__)

static long ticks_of(double beat)
{
    return lround(beat * TICKS);
}

// an accent is read a step louder
static bool is_louder(const midi_way *way)
{
    return way->nuance == HIMC_ACCENT && way->length <= 0;
}

static int step_of(const midi_way *way, double dynamic)
{
    int step = (int)lround(7 * dynamic) - is_louder(way);
    return step < 0 ? 0 : step;
}

// a type for a length of notation, with dots; else only its duration
static void put_type(const writer *w, long length)
{
    static const char *const types[] = {"whole", "half", "quarter", "eighth", "16th", "32nd"};
    for (int i = 0; i < 6; i++) {
        long plain = (4 * TICKS) >> i;
        if (length == plain || 2 * length == 3 * plain)
            PUT(w, "<type>%s</type>%s", types[i], length == plain ? "" : "<dot/>");
    }
}

static void put_pitch(const writer *w, int key)
{
    static const char *const steps[] = {"C", "C", "D", "E", "E", "F", "F", "G", "A", "A", "B", "B"};
    static const int alter[] = {0, 1, 0, -1, 0, 0, 1, 0, -1, 0, -1, 0};
    if (w->choice == MIDI_DRUMS)
        PUT(w, "<unpitched><display-step>C</display-step><display-octave>5</display-octave>"
               "</unpitched>");
    else if (alter[key % 12])
        PUT(w, "<pitch><step>%s</step><alter>%d</alter><octave>%d</octave></pitch>",
            steps[key % 12], alter[key % 12], key / 12 - 1);
    else
        PUT(w, "<pitch><step>%s</step><octave>%d</octave></pitch>", steps[key % 12], key / 12 - 1);
}

// which drum of a kit, or which timpano
static void put_instrument(const writer *w, const midi_note *n)
{
    if (w->choice == MIDI_DRUMS || (w->choice == MIDI_TIMPANI && n->way.drum > 0))
        PUT(w, "<instrument id=\"I%d\"/>", w->choice == MIDI_DRUMS ? n->key : n->way.drum);
}

static void put_graces(const writer *w, const item *i)
{
    // in the order of the ornaments: 0 to 3, a ruff with three, as a drag has two
    int count = i->note->way.ornament;
    for (int k = 0; k < count; k++) {
        PUT(w, "<note><grace/>");
        put_pitch(w, i->note->key);
        put_instrument(w, i->note);
        PUT(w, "<voice>%d</voice>", i->voice + 1);
        PUT(w, "<type>16th</type></note>\n");
    }
}

static void put_notations(const writer *w, const item *i, bool begins, bool ties_on)
{
    static const char *const marks[] = {[HIMC_TENUTO] = "tenuto",
                                        [HIMC_ACCENT] = "accent",
                                        [HIMC_VERTICAL_ACCENT] = "strong-accent",
                                        [HIMC_STACCATO] = "staccato"};
    // of a dot alone the stroke is damped
    static const char pulled[] = "<other-articulation>pulled off</other-articulation>";
    const midi_way *way = &i->note->way;
    bool roll = way->length > 0;
    PUT(w, "<notations>");
    if (!begins)
        PUT(w, "<tied type=\"stop\"/>");
    if (ties_on)
        PUT(w, "<tied type=\"start\"/>");
    if (roll) // three strokes where nobody could take them for 32nds
        PUT(w, "<ornaments><tremolo type=\"single\">%d</tremolo></ornaments>",
            himc_midi_bpm(w->file->tempi, w->file->tempo_count, i->note->beat) > 61 ? 3 : 4);
    if (begins && way->hand > 0 && !roll)
        PUT(w, "<technical><fingering>%s</fingering></technical>",
            way->hand == 1 + HIMC_LEFT ? "L" : "R");
    if (begins && way->nuance != HIMC_LEGATO && !roll)
        PUT(w, "<articulations><%s/>%s</articulations>", marks[way->nuance],
            way->nuance == HIMC_STACCATO ? pulled : "");
    PUT(w, "</notations>");
}

// its end is written: of a roll, and of a note that a hand ends
static bool is_held(const midi_note *n)
{
    return n->way.length > 0 || n->way.ring < 0;
}

static void put_note(const writer *w, const item *i, long from, long to)
{
    bool begins = from == i->begin, ties_on = is_held(i->note) && to < i->end;
    if (begins)
        put_graces(w, i);
    const char *notehead = himc_music_notehead(i->note->way.spot);
    double level = i->note->way.dynamic - (is_louder(&i->note->way) ? 1 / 7.0 : 0);
    // the exact dynamic, in percent of a velocity of 90
    PUT(w, "<note dynamics=\"%.6g\">", himc_midi_velocity(fmax(level, 0)) / 0.9);
    put_pitch(w, i->note->key);
    PUT(w, "<duration>%ld</duration>", to - from);
    if (!begins)
        PUT(w, "<tie type=\"stop\"/>");
    if (ties_on)
        PUT(w, "<tie type=\"start\"/>");
    put_instrument(w, i->note);
    PUT(w, "<voice>%d</voice>", i->voice + 1);
    put_type(w, to - from);
    if (notehead[0])
        PUT(w, "<notehead>%s</notehead>", notehead);
    put_notations(w, i, begins, ties_on);
    PUT(w, "</note>\n");
}

// directions

static void move(const writer *w, long *at, long to)
{
    if (to > *at)
        PUT(w, "<forward><duration>%ld</duration></forward>", to - *at);
    else if (to < *at)
        PUT(w, "<backup><duration>%ld</duration></backup>", *at - to);
    *at = to;
}

static void put_words(const writer *w, long *at, long to, const char *words)
{
    move(w, at, to);
    PUT(w, "<direction><direction-type><words>%s</words></direction-type></direction>\n", words);
}

// where the pedal of an order comes to rest
static long end_of(const writer *w, const midi_order *o)
{
    const midi_file *f = w->file;
    double end = himc_score_beat(f->tempi, f->tempo_count, o->seconds + o->length);
    long tick = ticks_of(o->beat), last = ticks_of(end);
    return o->glides && last <= tick ? tick + 1 : last;
}

static void put_gliss(const writer *w, long *at, long to, int line, const char *words)
{
    move(w, at, to);
    PUT(w, "<direction>");
    if (words[0])
        PUT(w, "<direction-type><words>gliss. %s</words></direction-type>", words);
    PUT(w, "<direction-type><dashes type=\"%s\" number=\"%d\"/></direction-type></direction>\n",
        words[0] ? "start" : "stop", 1 + line % MUSIC_LINES_MAX);
}

static void put_tempi(const writer *w, long begin, long *at)
{
    for (int i = 0; i < w->file->tempo_count && w->first; i++) {
        const himc_tempo_change *t = &w->file->tempi[i];
        long tick = ticks_of(t->beat);
        if (tick < begin || tick >= begin + BAR)
            continue;
        move(w, at, tick);
        PUT(w,
            "<direction><direction-type><metronome><beat-unit>quarter</beat-unit><per-minute>"
            "%.9g</per-minute></metronome></direction-type><sound tempo=\"%.9g\"/></direction>\n",
            t->bpm, t->bpm);
    }
}

static void put_orders(const writer *w, long begin, long *at)
{
    static const char *const drums[] = {"", "low ", "second ", "third ", "high "};
    static const char *const pitch[] = {"C",  "C#", "D",  "Eb", "E",  "F",
                                        "F#", "G",  "Ab", "A",  "Bb", "B"};
    for (int i = 0; i < w->file->order_count; i++) {
        const midi_order *o = &w->file->orders[i];
        long tick = ticks_of(o->beat), end = end_of(w, o);
        bool here = tick >= begin && tick < begin + BAR;
        char words[40];
        if (o->choice != w->choice)
            continue;
        if (o->kind == MIDI_DAMP)
            himc_format(words, sizeof words, "damp %s%d", pitch[o->value % 12], o->value / 12 - 1);
        else
            himc_format(words, sizeof words, o->glides ? "%s%s%d to %s%d" : "%s%s%d muta in %s%d",
                        drums[o->from / 128], pitch[o->from % 128 % 12], o->from % 128 / 12 - 1,
                        pitch[o->value % 12], o->value / 12 - 1);
        if (here && o->glides)
            put_gliss(w, at, tick, i, words);
        else if (here)
            put_words(w, at, tick,
                      o->kind != MIDI_MUFFLE ? words
                      : o->value             ? "coperto"
                                             : "scoperto");
        if (o->glides && end > begin && end <= begin + BAR)
            put_gliss(w, at, end, i, "");
    }
}

static void put_dynamic(writer *w, long *at, long to, int step)
{
    move(w, at, to);
    PUT(w, "<direction><direction-type><dynamics><%s/></dynamics></direction-type></direction>\n",
        himc_dynamic_words[step]);
    w->step = step;
}

static void put_wedge(const writer *w, long *at, long to, const char *type)
{
    move(w, at, to);
    PUT(w, "<direction><direction-type><wedge type=\"%s\"/></direction-type></direction>\n", type);
}

static int by_tick(const void *a, const void *b)
{
    const mark *x = a, *y = b;
    if (x->tick != y->tick)
        return x->tick < y->tick ? -1 : 1;
    return x->ends != y->ends ? y->ends - x->ends : (x->item > y->item) - (x->item < y->item);
}

static bool has_wedge(const item *i)
{
    const midi_way *way = &i->note->way;
    return way->length > 0 && step_of(way, way->dynamic) != step_of(way, way->last_dynamic);
}

// the beginnings of a bar's notes, and where hairpins end, in order
static int list_marks(writer *w, int first, long begin)
{
    int count = 0;
    for (int k = first; k < w->count && w->items[k].begin < begin + BAR; k++) {
        const item *i = &w->items[k];
        if (i->begin >= begin)
            w->marks[count++] = (mark){i->begin, false, i};
        if (has_wedge(i) && i->end > begin && i->end <= begin + BAR)
            w->marks[count++] = (mark){i->end, true, i};
    }
    qsort(w->marks, (size_t)count, sizeof *w->marks, by_tick);
    return count;
}

static void put_dynamics(writer *w, int first, long begin, long *at)
{
    static const char *const spots[] = {"center", "ord.", "near rim"};
    int count = list_marks(w, first, begin);
    for (const mark *m = w->marks; m < w->marks + count; m++) {
        const midi_way *way = &m->item->note->way;
        int from = step_of(way, way->dynamic), to = step_of(way, way->last_dynamic);
        if (m->ends) {
            put_wedge(w, at, m->tick, "stop");
            put_dynamic(w, at, m->tick, to);
            continue;
        }
        if (from != w->step)
            put_dynamic(w, at, m->tick, from);
        if (way->spot != w->spot && w->choice == MIDI_TIMPANI) {
            put_words(w, at, m->tick, spots[way->spot]);
            w->spot = way->spot;
        }
        if (way->ring < 0)
            put_words(w, at, m->tick, "secco");
        if (has_wedge(m->item))
            put_wedge(w, at, m->tick, to > from ? "crescendo" : "diminuendo");
    }
}

// bars and parts

static void put_voice(const writer *w, int voice, int first, long begin)
{
    long at = begin;
    for (int k = first; k < w->count && w->items[k].begin < begin + BAR; k++) {
        const item *i = &w->items[k];
        if (i->voice != voice || i->end <= begin)
            continue;
        long from = i->begin > begin ? i->begin : begin;
        long to = i->end < begin + BAR ? i->end : begin + BAR;
        if (from > at && voice == 0) {
            PUT(w, "<note><rest/><duration>%ld</duration><voice>1</voice>", from - at);
            put_type(w, from - at);
            PUT(w, "</note>\n");
            at = from;
        }
        move(w, &at, from);
        put_note(w, i, from, to);
        at = to;
    }
    if (voice == 0 && at < begin + BAR)
        PUT(w, "<note><rest/><duration>%ld</duration><voice>1</voice></note>\n", begin + BAR - at);
    else
        move(w, &at, begin + BAR);
    PUT(w, "<backup><duration>%d</duration></backup>\n", BAR);
}

static void put_bars(writer *w)
{
    int first = 0;
    for (long begin = 0, bar = 1; begin < w->end; begin += BAR, bar++) {
        long at = begin;
        PUT(w, "<measure number=\"%ld\">", bar);
        if (bar == 1)
            PUT(w,
                "<attributes><divisions>%d</divisions><time><beats>4</beats><beat-type>4"
                "</beat-type></time><clef><sign>%s</sign></clef></attributes>\n",
                TICKS,
                w->choice == MIDI_DRUMS     ? "percussion"
                : w->choice == MIDI_TIMPANI ? "F"
                                            : "G");
        if (bar == 1 && w->choice == MIDI_TIMPANI) // what is short is not damped
            put_words(w, &at, begin, "sempre l.v.");
        put_tempi(w, begin, &at);
        put_orders(w, begin, &at);
        put_dynamics(w, first, begin, &at);
        move(w, &at, begin);
        for (int voice = 0; voice < VOICES; voice++) {
            bool used = voice == 0;
            for (int k = first; k < w->count && w->items[k].begin < begin + BAR; k++)
                used |= w->items[k].voice == voice && w->items[k].end > begin;
            if (used)
                put_voice(w, voice, first, begin);
        }
        PUT(w, "<forward><duration>%d</duration></forward></measure>\n", BAR);
        while (first < w->count && w->items[first].end <= begin + BAR)
            first++;
    }
}

// the notes of a choice in voices; returns how many. A voice is free where its note has ended
static int take_items(writer *w)
{
    long last[VOICES] = {0};
    int before[VOICES] = {-1, -1, -1, -1};
    w->count = 0;
    for (int i = 0; i < w->file->note_count; i++) {
        const midi_note *n = &w->file->notes[i];
        if (n->choice != w->choice)
            continue;
        item *to = &w->items[w->count];
        double end = n->way.length > 0
                         ? n->beat + n->way.length
                         : himc_score_beat(w->file->tempi, w->file->tempo_count, n->off);
        *to = (item){n, ticks_of(n->beat), ticks_of(fmax(end, n->beat + 1.0 / TICKS)), 0};
        while (to->voice + 1 < VOICES && last[to->voice] > to->begin)
            to->voice++;
        int k = before[to->voice];
        long bar_end = (to->begin / BAR + 1) * BAR;
        if (k >= 0 && !is_held(w->items[k].note) && w->items[k].end > to->begin)
            w->items[k].end = to->begin;
        if (!is_held(n))
            to->end = bar_end < to->begin + TICKS ? bar_end : to->begin + TICKS;
        last[to->voice] = is_held(n) ? to->end : to->begin + 1;
        before[to->voice] = w->count++;
    }
    return w->count;
}

static void put_part_list(const writer *w)
{
    static const char *const names[] = {"",          "Timpani",    "Percussion",   "Marimba",
                                        "Xylophone", "Vibraphone", "Glockenspiel", "Tubular Bells"};
    static const char *const drums[] = {"", "low", "second", "third", "high"};
    bool used[MIDI_KEY_COUNT] = {false};
    PUT(w, "<score-part id=\"P%d\"><part-name>%s</part-name>\n", (int)w->choice, names[w->choice]);
    for (int i = 0; i < w->count && w->choice == MIDI_DRUMS; i++)
        used[w->items[i].note->key] = true;
    for (int i = 0; i < w->count && w->choice == MIDI_TIMPANI; i++)
        used[w->items[i].note->way.drum] = true;
    for (int drum = 1; drum <= 4 && w->choice == MIDI_TIMPANI; drum++)
        if (used[drum])
            PUT(w,
                "<score-instrument id=\"I%d\"><instrument-name>%s timpano</instrument-name>"
                "</score-instrument>\n",
                drum, drums[drum]);
    for (int key = 0; key < MIDI_KEY_COUNT && w->choice == MIDI_DRUMS; key++)
        if (used[key])
            PUT(w,
                "<score-instrument id=\"I%d\"><instrument-name>%s</instrument-name>"
                "</score-instrument>\n",
                key, himc_midi_key_sound(key));
    for (int key = 0; key < MIDI_BASS_DRUM && w->choice == MIDI_DRUMS; key++)
        if (used[key])
            PUT(w,
                "<midi-instrument id=\"I%d\"><midi-channel>10</midi-channel><midi-unpitched>%d"
                "</midi-unpitched></midi-instrument>\n",
                key, key + 1);
    PUT(w, "</score-part>\n");
}

bool himc_music_write(himc_text_lines *out, const midi_file *file, const char *title)
{
    writer w = {.out = out, .file = file};
    w.items = malloc(((size_t)file->note_count + 1) * sizeof *w.items);
    w.marks = malloc((2 * (size_t)file->note_count + 1) * sizeof *w.marks);
    if (!w.items || !w.marks) {
        free(w.items);
        free(w.marks);
        return false;
    }
    PUT(&w, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!DOCTYPE score-partwise PUBLIC "
            "\"-//Recordare//DTD MusicXML 4.0 Partwise//EN\" "
            "\"http://www.musicxml.org/dtds/partwise.dtd\">\n");
    PUT(&w, "<score-partwise version=\"4.0\"><movement-title>%s</movement-title><part-list>\n",
        title);
    for (w.choice = MIDI_TIMPANI; w.choice < MIDI_CHOICES; w.choice++)
        if (take_items(&w) > 0) {
            put_part_list(&w);
            for (int i = 0; i < w.count; i++)
                w.end = w.items[i].end > w.end ? w.items[i].end : w.end;
        }
    for (int i = 0; i < file->order_count; i++)
        w.end = end_of(&w, &file->orders[i]) > w.end ? end_of(&w, &file->orders[i]) : w.end;
    PUT(&w, "</part-list>\n");
    w.first = true;
    for (w.choice = MIDI_TIMPANI; w.choice < MIDI_CHOICES; w.choice++)
        if (take_items(&w) > 0) {
            PUT(&w, "<part id=\"P%d\">\n", (int)w.choice);
            w.step = -1;
            w.spot = HIMC_SPOT_NORMAL;
            put_bars(&w);
            PUT(&w, "</part>\n");
            w.first = false;
        }
    PUT(&w, "</score-partwise>\n");
    free(w.items);
    free(w.marks);
    return !out->failed;
}
