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

/// The notes of a kind.
typedef struct staff {
    midi_choice choice;
    item *items; ///< borrowed (count)
    int count, first;
    himc_spot spot; ///< the last that was written
    int step;       ///< the last dynamic that was marked, 0 .. 7; -1: none
} staff;

typedef struct writer {
    himc_text_lines *out;
    const midi_file *file;
    item *items; ///< of all staves
    mark *marks; ///< scratch: two for each note
    staff staves[MIDI_CHOICES], *now;
    int staff_count;
    long end; ///< (ticks)
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
    if (w->now->choice == MIDI_DRUMS)
        PUT(w, "<unpitched><display-step>C</display-step><display-octave>5</display-octave>"
               "</unpitched>");
    else if (alter[key % 12])
        PUT(w, "<pitch><step>%s</step><alter>%d</alter><octave>%d</octave></pitch>",
            steps[key % 12], alter[key % 12], key / 12 - 1);
    else
        PUT(w, "<pitch><step>%s</step><octave>%d</octave></pitch>", steps[key % 12], key / 12 - 1);
}

// of several kinds each has its staff
static void put_staff(const writer *w)
{
    if (w->staff_count > 1)
        PUT(w, "<staff>%d</staff>", 1 + (int)(w->now - w->staves));
}

static void put_voice_number(const writer *w, int voice)
{
    PUT(w, "<voice>%d</voice>", 1 + voice + VOICES * (int)(w->now - w->staves));
}

// of a note: the number of a keyboard is below those of drums, above those of timpani
static int instrument_of(const midi_note *n)
{
    return n->choice == MIDI_DRUMS     ? n->key
           : n->choice == MIDI_TIMPANI ? n->way.drum
                                       : 10 + (int)n->choice;
}

// which drum of a kit, which timpano, or which kind
static void put_instrument(const writer *w, const midi_note *n)
{
    if (w->staff_count > 1 || n->choice == MIDI_DRUMS || n->way.drum > 0)
        PUT(w, "<instrument id=\"I%d\"/>", instrument_of(n));
}

static void put_graces(const writer *w, const item *i)
{
    // in the order of the ornaments: 0 to 3, a ruff with three, as a drag has two
    int count = i->note->way.ornament;
    for (int k = 0; k < count; k++) {
        PUT(w, "<note><grace/>");
        put_pitch(w, i->note->key);
        put_instrument(w, i->note);
        put_voice_number(w, i->voice);
        PUT(w, "<type>16th</type>");
        put_staff(w);
        PUT(w, "</note>\n");
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
    put_voice_number(w, i->voice);
    put_type(w, to - from);
    if (notehead[0])
        PUT(w, "<notehead>%s</notehead>", notehead);
    put_staff(w);
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

static void end_direction(const writer *w)
{
    put_staff(w);
    PUT(w, "</direction>\n");
}

static void put_words(const writer *w, long *at, long to, const char *words)
{
    move(w, at, to);
    PUT(w, "<direction><direction-type><words>%s</words></direction-type>", words);
    end_direction(w);
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
    PUT(w, "<direction-type><dashes type=\"%s\" number=\"%d\"/></direction-type>",
        words[0] ? "start" : "stop", 1 + line % MUSIC_LINES_MAX);
    end_direction(w);
}

static void put_tempi(const writer *w, long begin, long *at)
{
    for (int i = 0; i < w->file->tempo_count && w->now == w->staves; i++) {
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
        if (o->choice != w->now->choice)
            continue;
        himc_format(words, sizeof words, o->glides ? "%s%s%d to %s%d" : "%s%s%d muta in %s%d",
                    drums[o->from / 128], pitch[o->from % 128 % 12], o->from % 128 / 12 - 1,
                    pitch[o->value % 12], o->value / 12 - 1);
        if (here && o->glides)
            put_gliss(w, at, tick, i, words);
        else if (here)
            put_words(w, at, tick,
                      o->kind == MIDI_TUNING ? words
                      : o->value             ? "coperto"
                                             : "scoperto");
        if (o->glides && end > begin && end <= begin + BAR)
            put_gliss(w, at, end, i, "");
    }
}

static void put_dynamic(writer *w, long *at, long to, int step)
{
    move(w, at, to);
    PUT(w, "<direction><direction-type><dynamics><%s/></dynamics></direction-type>",
        himc_dynamic_words[step]);
    end_direction(w);
    w->now->step = step;
}

static void put_wedge(const writer *w, long *at, long to, const char *type)
{
    move(w, at, to);
    PUT(w, "<direction><direction-type><wedge type=\"%s\"/></direction-type>", type);
    end_direction(w);
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
    for (int k = first; k < w->now->count && w->now->items[k].begin < begin + BAR; k++) {
        const item *i = &w->now->items[k];
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
        if (from != w->now->step)
            put_dynamic(w, at, m->tick, from);
        if (way->spot != w->now->spot && w->now->choice == MIDI_TIMPANI) {
            put_words(w, at, m->tick, spots[way->spot]);
            w->now->spot = way->spot;
        }
        if (way->ring < 0)
            put_words(w, at, m->tick, "secco");
        if (has_wedge(m->item))
            put_wedge(w, at, m->tick, to > from ? "crescendo" : "diminuendo");
    }
}

// bars and parts

static void put_rest(const writer *w, long length)
{
    PUT(w, "<note><rest/><duration>%ld</duration>", length);
    put_voice_number(w, 0);
    put_type(w, length);
    put_staff(w);
    PUT(w, "</note>\n");
}

static void put_voice(const writer *w, int voice, int first, long begin)
{
    long at = begin;
    for (int k = first; k < w->now->count && w->now->items[k].begin < begin + BAR; k++) {
        const item *i = &w->now->items[k];
        if (i->voice != voice || i->end <= begin)
            continue;
        long from = i->begin > begin ? i->begin : begin;
        long to = i->end < begin + BAR ? i->end : begin + BAR;
        if (from > at && voice == 0) {
            put_rest(w, from - at);
            at = from;
        }
        move(w, &at, from);
        put_note(w, i, from, to);
        at = to;
    }
    if (voice == 0 && at < begin + BAR)
        put_rest(w, begin + BAR - at);
    else
        move(w, &at, begin + BAR);
    PUT(w, "<backup><duration>%d</duration></backup>\n", BAR);
}

static void put_attributes(writer *w)
{
    char number[20] = "";
    PUT(w,
        "<attributes><divisions>%d</divisions><time><beats>4</beats><beat-type>4</beat-type>"
        "</time>",
        TICKS);
    if (w->staff_count > 1)
        PUT(w, "<staves>%d</staves>", w->staff_count);
    for (int i = 0; i < w->staff_count; i++) {
        midi_choice choice = w->staves[i].choice;
        if (w->staff_count > 1)
            himc_format(number, sizeof number, " number=\"%d\"", i + 1);
        PUT(w, "<clef%s><sign>%s</sign></clef>", number,
            choice == MIDI_DRUMS     ? "percussion"
            : choice == MIDI_TIMPANI ? "F"
                                     : "G");
    }
    PUT(w, "</attributes>\n");
}

// a bar of a staff, and back to its beginning
static void put_bar(writer *w, long begin)
{
    long at = begin;
    staff *now = w->now;
    if (begin == 0 && now->choice == MIDI_TIMPANI) // what is short is not damped
        put_words(w, &at, begin, "sempre l.v.");
    put_tempi(w, begin, &at);
    put_orders(w, begin, &at);
    put_dynamics(w, now->first, begin, &at);
    move(w, &at, begin);
    for (int voice = 0; voice < VOICES; voice++) {
        bool used = voice == 0;
        for (int k = now->first; k < now->count && now->items[k].begin < begin + BAR; k++)
            used |= now->items[k].voice == voice && now->items[k].end > begin;
        if (used)
            put_voice(w, voice, now->first, begin);
    }
    while (now->first < now->count && now->items[now->first].end <= begin + BAR)
        now->first++;
}

static void put_bars(writer *w)
{
    for (long begin = 0, bar = 1; begin < w->end; begin += BAR, bar++) {
        PUT(w, "<measure number=\"%ld\">", bar);
        if (bar == 1)
            put_attributes(w);
        for (w->now = w->staves; w->now < w->staves + w->staff_count; w->now++)
            put_bar(w, begin);
        PUT(w, "<forward><duration>%d</duration></forward></measure>\n", BAR);
    }
}

// the notes of a choice in voices; returns how many. A voice is free where its note has ended
static int take_items(writer *w)
{
    long last[VOICES] = {0};
    int before[VOICES] = {-1, -1, -1, -1};
    w->now->count = 0;
    for (int i = 0; i < w->file->note_count; i++) {
        const midi_note *n = &w->file->notes[i];
        if (n->choice != w->now->choice)
            continue;
        item *to = &w->now->items[w->now->count];
        double end = n->way.length > 0
                         ? n->beat + n->way.length
                         : himc_score_beat(w->file->tempi, w->file->tempo_count, n->off);
        *to = (item){n, ticks_of(n->beat), ticks_of(fmax(end, n->beat + 1.0 / TICKS)), 0};
        while (to->voice + 1 < VOICES && last[to->voice] > to->begin)
            to->voice++;
        int k = before[to->voice];
        long bar_end = (to->begin / BAR + 1) * BAR;
        if (k >= 0 && !is_held(w->now->items[k].note) && w->now->items[k].end > to->begin)
            w->now->items[k].end = to->begin;
        if (!is_held(n))
            to->end = bar_end < to->begin + TICKS ? bar_end : to->begin + TICKS;
        last[to->voice] = is_held(n) ? to->end : to->begin + 1;
        before[to->voice] = w->now->count++;
    }
    return w->now->count;
}

static const char *const names[] = {"",          "Timpani",    "Percussion",   "Marimba",
                                    "Xylophone", "Vibraphone", "Glockenspiel", "Tubular Bells"};

static void put_name(const writer *w, const midi_note *n)
{
    static const char *const drums[] = {"", "low timpano", "second timpano", "third timpano",
                                        "high timpano"};
    static const char *const sounds[MIDI_CHOICES] = {
        [MIDI_TIMPANI] = "drum.timpani",
        [MIDI_MARIMBA] = "pitched-percussion.marimba",
        [MIDI_XYLOPHONE] = "pitched-percussion.xylophone",
        [MIDI_VIBRAPHONE] = "pitched-percussion.vibraphone",
        [MIDI_GLOCKENSPIEL] = "pitched-percussion.glockenspiel",
        [MIDI_TUBULAR_BELL] = "pitched-percussion.tubular-bells"};
    PUT(w, "<score-instrument id=\"I%d\"><instrument-name>%s</instrument-name>", instrument_of(n),
        n->choice == MIDI_DRUMS ? himc_midi_key_sound(n->key)
        : n->way.drum > 0       ? drums[n->way.drum]
                                : names[n->choice]);
    if (w->staff_count > 1 && sounds[n->choice])
        PUT(w, "<instrument-sound>%s</instrument-sound>", sounds[n->choice]);
    PUT(w, "</score-instrument>\n");
}

static void put_part_list(const writer *w)
{
    const midi_note *used[MIDI_KEY_COUNT] = {NULL}; // by the instrument's number
    bool several = w->staff_count > 1;
    midi_choice choice = w->staves[0].choice;
    PUT(w, "<score-part id=\"P%d\"><part-name>%s</part-name>\n", several ? 1 : (int)choice,
        names[several ? MIDI_DRUMS : choice]);
    for (int i = 0; i < w->file->note_count; i++) {
        const midi_note *n = &w->file->notes[i];
        if (several || n->choice == MIDI_DRUMS || n->way.drum > 0)
            used[instrument_of(n)] = n;
    }
    for (int i = 0; i < MIDI_KEY_COUNT; i++)
        if (used[i])
            put_name(w, used[i]);
    for (int key = 0; key < MIDI_BASS_DRUM; key++)
        if (used[key] && used[key]->choice == MIDI_DRUMS)
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
    item *free_items = w.items;
    for (int choice = MIDI_TIMPANI; choice < MIDI_CHOICES; choice++) {
        w.now = &w.staves[w.staff_count];
        *w.now = (staff){.choice = (midi_choice)choice,
                         .items = free_items,
                         .spot = HIMC_SPOT_NORMAL,
                         .step = -1};
        w.staff_count += take_items(&w) > 0;
        free_items += w.now->count;
        for (int i = 0; i < w.now->count; i++)
            w.end = w.now->items[i].end > w.end ? w.now->items[i].end : w.end;
    }
    for (int i = 0; i < file->order_count; i++)
        w.end = end_of(&w, &file->orders[i]) > w.end ? end_of(&w, &file->orders[i]) : w.end;
    put_part_list(&w);
    PUT(&w, "</part-list>\n<part id=\"P%d\">\n", w.staff_count > 1 ? 1 : (int)w.staves[0].choice);
    put_bars(&w);
    PUT(&w, "</part>\n</score-partwise>\n");
    free(w.items);
    free(w.marks);
    return !out->failed;
}
