/// write.c: notes as MusicXML 4.0 for notation programs.
///
/// Time counts in ticks of a quarter note. What is struck at once is a chord; what overlaps else,
/// and the feet of a kit, stand in voices of their own. A note lasts up to the next one of its
/// voice or for a beat, a roll as long as it is; spell.c gives them values. Words and marks of a
/// bar (marks.c) are written first, then each voice, each back from the bar's end. Each note also
/// has its exact dynamic, and the reader (shape.c) makes an accent a step louder, so it is written
/// a step softer there.
#include "musicxml/export.h"

#include "base/format.h"
#include "midi/part.h"
#include "musicxml/instruments.h"
#include "musicxml/marks.h"
#include "musicxml/spell.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TICKS MUSIC_TICKS
#define VOICES 4
#define FOOT 1   // the voice of feet
#define GHOST -2 // steps below the others of its bar: a ghost note; chosen

/// The notes of a kind.
typedef struct staff {
    midi_choice choice;
    music_item *items; ///< borrowed (count)
    music_mark *marks; ///< the same, in the order of time (mark_count)
    int count, mark_count;
    int first, mark; ///< the next of them
    himc_spot spot;  ///< the last that was written
    int step;        ///< the last dynamic that was marked, 0 .. 7; -1: none
    bool feet;       ///< of a kit: they have a voice of their own
} staff;

typedef struct writer {
    himc_text_lines *out;
    const midi_file *file;
    music_segment *segments; ///< scratch of a bar
    music_piece *pieces;
    staff staves[MIDI_CHOICES], *now;
    int staff_count;
    int place[MIDI_KEY_COUNT]; ///< of drums: where they are written
    bool name[MIDI_KEY_COUNT]; ///< ... and whether their name is yet to be, at their first note
    const midi_bar *bar;       ///< the present one, ...
    long begin, end;           ///< ... (ticks)
} writer;

#define PUT(w, ...) himc_text_print((w)->out, __VA_ARGS__)

static long ticks_of(double beat)
{
    return lround(beat * TICKS);
}

static void put_value(const writer *w, const music_piece *piece)
{
    static const char *const types[] = {"whole", "half", "quarter", "eighth",
                                        "16th",  "32nd", "64th",    "128th"};
    PUT(w, "<type>%s</type>%s", types[piece->type], piece->dot ? "<dot/>" : "");
    if (piece->actual > 0)
        PUT(w,
            "<time-modification><actual-notes>%d</actual-notes><normal-notes>%d</normal-notes>"
            "</time-modification>",
            piece->actual, piece->normal);
}

static void put_pitch(const writer *w, int key)
{
    static const char *const steps[] = {"C", "C", "D", "E", "E", "F", "F", "G", "A", "A", "B", "B"};
    static const int alter[] = {0, 1, 0, -1, 0, 0, 1, 0, -1, 0, -1, 0};
    int place = w->place[key];
    if (w->now->choice == MIDI_DRUMS)
        PUT(w,
            "<unpitched><display-step>%s</display-step><display-octave>%d</display-octave>"
            "</unpitched>",
            steps[place % 12], place / 12 - 1);
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

// a flam has a stroke through its note, a drag two beams, a ruff, which is slower, one; all are
// slurred to the main note
static void put_graces(const writer *w, const music_item *i)
{
    int count = himc_midi_graces(&i->note->way), beams = i->note->way.ornament == HIMC_DRAG ? 2 : 1;
    for (int k = 0; k < count; k++) {
        const char *beam = k == 0 ? "begin" : "end";
        PUT(w, count == 1 ? "<note><grace slash=\"yes\"/>" : "<note><grace/>");
        put_pitch(w, i->note->key);
        put_instrument(w, i->note);
        put_voice_number(w, i->voice);
        PUT(w, "<type>%s</type><stem>up</stem>", beams == 1 ? "eighth" : "16th");
        put_staff(w);
        for (int level = 1; level <= beams && count > 1; level++)
            PUT(w, "<beam number=\"%d\">%s</beam>", level, beam);
        if (k == 0)
            PUT(w, "<notations><slur type=\"start\" number=\"1\"/></notations>");
        PUT(w, "</note>\n");
    }
}

// three strokes where nobody could take them for 32nds, or a z; and its kind, if it is not usual
static void put_roll(const writer *w, const midi_note *n)
{
    bool press = n->way.ornament == HIMC_ROLL_PRESS;
    if (press)
        PUT(w, "<ornaments><tremolo type=\"unmeasured\">0</tremolo>");
    else
        PUT(w, "<ornaments><tremolo type=\"single\">%d</tremolo>",
            himc_midi_bpm(w->file->tempi, w->file->tempo_count, n->beat) > 61 ? 3 : 4);
    if (n->way.ornament != himc_music_usual_roll(n->choice, n->key, press))
        PUT(w, "<other-ornament>%s</other-ornament>", himc_music_roll(n->way.ornament));
    PUT(w, "</ornaments>");
}

// a circle over open hats, a cross over the first closed ones behind them
static const char *hats_sign(const writer *w, const music_item *i)
{
    const music_item *last = i;
    if (i->note->choice != MIDI_DRUMS ||
        (i->note->key != MIDI_OPEN_HATS && i->note->key != MIDI_CLOSED_HATS))
        return "";
    if (i->note->key == MIDI_OPEN_HATS)
        return "<open/>";
    while (last-- > w->now->items)
        if (last->note->key == MIDI_OPEN_HATS || last->note->key == MIDI_CLOSED_HATS ||
            last->note->key == MIDI_PEDAL_HATS)
            return last->note->key == MIDI_OPEN_HATS ? "<stopped/>" : "";
    return "";
}

static void put_notations(const writer *w, const music_item *i, const music_piece *piece,
                          bool ties_on)
{
    static const char *const marks[] = {[HIMC_TENUTO] = "tenuto",
                                        [HIMC_ACCENT] = "accent",
                                        [HIMC_VERTICAL_ACCENT] = "strong-accent",
                                        [HIMC_STACCATO] = "staccato"};
    // of a dot alone the stroke is damped
    static const char pulled[] = "<other-articulation>pulled off</other-articulation>",
                      louder[] = "<other-articulation>louder</other-articulation>";
    const midi_way *way = &i->note->way;
    bool roll = way->length > 0, begins = piece->from == i->begin;
    PUT(w, "<notations>");
    if (!begins)
        PUT(w, "<tied type=\"stop\"/>");
    if (ties_on)
        PUT(w, "<tied type=\"start\"/>");
    if (begins && himc_midi_graces(way) > 0)
        PUT(w, "<slur type=\"stop\" number=\"1\"/>");
    if (piece->first && !i->chord)
        PUT(w, "<tuplet type=\"start\" bracket=\"%s\"/>", piece->beam[0] ? "no" : "yes");
    if (piece->last && !i->chord)
        PUT(w, "<tuplet type=\"stop\"/>");
    if (roll)
        put_roll(w, i->note);
    const char *hats = begins ? hats_sign(w, i) : "";
    bool hand = begins && way->hand > 0 && !roll;
    if (hand || hats[0])
        PUT(w, "<technical>%s%s</technical>", hats,
            !hand                        ? ""
            : way->hand == 1 + HIMC_LEFT ? "<fingering>L</fingering>"
                                         : "<fingering>R</fingering>");
    bool above = i->beside > 0 && way->nuance == HIMC_LEGATO; // printed, but no way of playing
    if (begins && above)
        PUT(w, "<articulations><accent/>%s</articulations>", louder);
    else if (begins && way->nuance != HIMC_LEGATO)
        PUT(w, "<articulations><%s/>%s</articulations>", marks[way->nuance],
            way->nuance == HIMC_STACCATO ? pulled : "");
    PUT(w, "</notations>");
}

// its end is written: of a roll, and of a note that a hand ends
static bool is_held(const midi_note *n)
{
    return n->way.length > 0 || n->way.ring < 0;
}

static bool is_metal(const midi_note *n)
{
    bool metal = false;
    if (n->choice == MIDI_DRUMS)
        himc_music_place(n->key, &metal);
    return metal;
}

// of a drum in a bar of louder strokes
static bool is_ghost(const music_item *i)
{
    return i->beside <= GHOST && i->note->choice == MIDI_DRUMS && !is_metal(i->note);
}

static void put_note(const writer *w, const music_item *i, const music_piece *piece)
{
    bool begins = piece->from == i->begin, ties_on = is_held(i->note) && piece->to < i->end;
    if (begins)
        put_graces(w, i);
    const char *notehead = himc_music_notehead(i->note->way.spot);
    bool metal = is_metal(i->note);
    double level = i->note->way.dynamic - (himc_music_is_louder(&i->note->way) ? 1 / 7.0 : 0);
    // the exact dynamic, in percent of a velocity of 90
    PUT(w, "<note dynamics=\"%.6g\">%s", fmax(himc_midi_velocity(level), 0) / 0.9,
        i->chord ? "<chord/>" : "");
    put_pitch(w, i->note->key);
    PUT(w, "<duration>%ld</duration>", piece->to - piece->from);
    if (!begins)
        PUT(w, "<tie type=\"stop\"/>");
    if (ties_on)
        PUT(w, "<tie type=\"start\"/>");
    put_instrument(w, i->note);
    put_voice_number(w, i->voice);
    put_value(w, piece);
    if (w->now->feet)
        PUT(w, "<stem>%s</stem>", i->voice == FOOT ? "down" : "up");
    if (notehead[0] || metal || is_ghost(i))
        PUT(w, "<notehead%s>%s</notehead>", is_ghost(i) ? " parentheses=\"yes\"" : "",
            notehead[0] ? notehead
            : metal     ? "x"
                        : "normal");
    put_staff(w);
    for (int k = 0; k < 6 && piece->beam[k] && !i->chord; k++)
        PUT(w, "<beam number=\"%d\">%s</beam>", k + 1, piece->beam[k]);
    put_notations(w, i, piece, ties_on);
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
    PUT(w, "<direction placement=\"above\"><direction-type><words>%s</words></direction-type>",
        words);
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

// true if a tempo goes on its way to the next
static bool is_ramp(const writer *w, int i)
{
    const himc_tempo_change *t = w->file->tempi;
    return i > 0 && i + 1 < w->file->tempo_count && t[i + 1].beat - t[i].beat <= 1 &&
           (t[i + 1].bpm - t[i].bpm) * (t[i].bpm - t[i - 1].bpm) > 0;
}

// a number, or a word where it moves; each has its exact tempo
static void put_tempi(const writer *w, long *at)
{
    for (int i = 0; i < w->file->tempo_count && w->now == w->staves; i++) {
        const himc_tempo_change *t = &w->file->tempi[i];
        long tick = ticks_of(t->beat);
        if (tick < w->begin || tick >= w->end)
            continue;
        move(w, at, tick);
        bool moves = is_ramp(w, i);
        if (moves && is_ramp(w, i - 1)) {
            PUT(w, "<sound tempo=\"%.9g\"/>\n", t->bpm);
            continue;
        }
        PUT(w, "<direction placement=\"above\"><direction-type>");
        if (moves)
            PUT(w, "<words>%s</words>", t[1].bpm > t->bpm ? "accel." : "rit.");
        else
            PUT(w,
                "<metronome><beat-unit>quarter</beat-unit><per-minute>%.0f</per-minute>"
                "</metronome>",
                t->bpm);
        PUT(w, "</direction-type>");
        put_staff(w);
        PUT(w, "<sound tempo=\"%.9g\"/></direction>\n", t->bpm);
    }
}

static void put_orders(const writer *w, long *at)
{
    static const char *const drums[] = {"", "low ", "second ", "third ", "high "};
    static const char *const pitch[] = {"C",  "C#", "D",  "Eb", "E",  "F",
                                        "F#", "G",  "Ab", "A",  "Bb", "B"};
    for (int i = 0; i < w->file->order_count; i++) {
        const midi_order *o = &w->file->orders[i];
        long tick = ticks_of(o->beat), end = end_of(w, o);
        bool here = tick >= w->begin && tick < w->end;
        char words[40];
        if (o->choice != w->now->choice)
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
        if (o->glides && end > w->begin && end <= w->end)
            put_gliss(w, at, end, i, "");
    }
}

// of the end of a roll, where another dynamic begins: it is drawn before that
static void put_offset(const writer *w, const music_mark *m)
{
    const music_mark *end = w->now->marks + w->now->mark_count;
    int last = -1;
    for (const music_mark *k = m; m->ends && k < end && k->tick == m->tick; k++) {
        if (k->kind == MARK_DYNAMIC && !k->ends && last >= 0 && k->value != last) {
            PUT(w, "<offset sound=\"no\">%d</offset>", -TICKS / 2);
            return;
        }
        last = k->kind == MARK_DYNAMIC && k->ends ? k->value : last;
    }
}

// a mark of a bar; a dynamic that holds already only where a hairpin ends
static void put_mark(writer *w, long *at, const music_mark *m)
{
    static const char *const spots[] = {"center", "ord.", "near rim"};
    const char *wedge = m->kind == MARK_STOP ? "stop" : m->value > 0 ? "crescendo" : "diminuendo";
    const midi_way *way = m->way;
    if (m->kind == MARK_DYNAMIC && (m->ends || m->value != w->now->step)) {
        move(w, at, m->tick);
        PUT(w,
            "<direction placement=\"below\"><direction-type><dynamics%s><%s/></dynamics>"
            "</direction-type>",
            m->ends ? " relative-x=\"-10\"" : "", himc_dynamic_words[m->value]);
        put_offset(w, m);
        end_direction(w);
        w->now->step = m->value;
    } else if (m->kind == MARK_WEDGE || m->kind == MARK_STOP) {
        move(w, at, m->tick);
        PUT(w,
            "<direction placement=\"below\"><direction-type><wedge type=\"%s\"/>"
            "</direction-type>",
            wedge);
        put_offset(w, m);
        end_direction(w);
    } else if (m->kind == MARK_WAY) {
        if (way->spot != w->now->spot && w->now->choice == MIDI_TIMPANI) {
            put_words(w, at, m->tick, spots[way->spot]);
            w->now->spot = way->spot;
        }
        if (way->ring < 0)
            put_words(w, at, m->tick, "secco");
    }
}

static void put_marks(writer *w, long *at)
{
    for (; w->now->mark < w->now->mark_count && w->now->marks[w->now->mark].tick < w->end;
         w->now->mark++)
        put_mark(w, at, &w->now->marks[w->now->mark]);
    // what ends with the bar is its
    for (; w->now->mark < w->now->mark_count && w->now->marks[w->now->mark].tick == w->end &&
           w->now->marks[w->now->mark].ends;
         w->now->mark++)
        put_mark(w, at, &w->now->marks[w->now->mark]);
}

// bars and parts

// what a voice has in a bar; returns how many segments
static int list_segments(const writer *w, int voice, int first)
{
    long at = w->begin, end = w->end;
    int count = 0;
    for (int k = first; k < w->now->count && w->now->items[k].begin < end; k++) {
        const music_item *i = &w->now->items[k];
        if (i->voice != voice || i->end <= at || i->chord)
            continue;
        long from = i->begin > at ? i->begin : at, to = i->end < end ? i->end : end;
        if (from > at)
            w->segments[count++] = (music_segment){at, from, -1, false};
        w->segments[count++] = (music_segment){from, to, k, is_held(i->note)};
        at = to;
    }
    if (at < end)
        w->segments[count++] = (music_segment){at, end, -1, false};
    return count;
}

static void put_rest(const writer *w, const music_piece *piece, int voice)
{
    bool bar = piece->to - piece->from == w->end - w->begin;
    PUT(w, "<note><rest%s/><duration>%ld</duration>", bar ? " measure=\"yes\"" : "",
        piece->to - piece->from);
    put_voice_number(w, voice);
    if (!bar)
        put_value(w, piece);
    put_staff(w);
    if (piece->first || piece->last)
        PUT(w, "<notations><tuplet type=\"%s\"/></notations>", piece->first ? "start" : "stop");
    PUT(w, "</note>\n");
}

// rests are written where they have values in the first voice, and in tuplets
static void put_voice(const writer *w, int voice, int first)
{
    long at = w->begin;
    bool three = w->bar->unit > 4 && w->bar->beats % 3 == 0;
    long beat = three ? 12 * TICKS / w->bar->unit : TICKS;
    int count = himc_music_spell(w->segments, list_segments(w, voice, first), beat, w->pieces);
    for (const music_piece *p = w->pieces; p < w->pieces + count; p++) {
        if (p->note < 0 && (p->rough || voice > 0) && p->actual == 0)
            continue;
        move(w, &at, p->from);
        if (p->note < 0)
            put_rest(w, p, voice);
        else
            put_note(w, &w->now->items[p->note], p);
        for (int k = p->note + 1;
             p->note >= 0 && k < w->now->count && w->now->items[k].begin == p->from; k++)
            if (w->now->items[k].chord && w->now->items[k].voice == voice)
                put_note(w, &w->now->items[k], p);
        at = p->to;
    }
    move(w, &at, w->end);
    PUT(w, "<backup><duration>%ld</duration></backup>\n", w->end - w->begin);
}

static void put_attributes(writer *w)
{
    char number[20] = "";
    const midi_bar *b = w->bar;
    bool first = b == w->file->bars;
    if (!first && b->beats == b[-1].beats && b->unit == b[-1].unit)
        return;
    PUT(w, "<attributes>");
    if (first)
        PUT(w, "<divisions>%d</divisions>", TICKS);
    PUT(w, "<time><beats>%d</beats><beat-type>%d</beat-type></time>", b->beats, b->unit);
    if (first && w->staff_count > 1)
        PUT(w, "<staves>%d</staves>", w->staff_count);
    for (int i = 0; i < w->staff_count && first; i++) {
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

// drums whose place on the staff is not the usual one
static void put_names(writer *w, long *at)
{
    const staff *now = w->now;
    for (int k = now->first; k < now->count && now->items[k].begin < w->end; k++) {
        const midi_note *n = now->items[k].note;
        if (n->choice != MIDI_DRUMS || !w->name[n->key])
            continue;
        w->name[n->key] = false;
        put_words(w, at, now->items[k].begin, himc_midi_key_sound(n->key));
    }
}

// a bar of a staff, and back to its beginning
static void put_bar(writer *w)
{
    long at = w->begin;
    staff *now = w->now;
    if (at == 0 && now->choice == MIDI_TIMPANI) // what is short is not damped
        put_words(w, &at, at, "sempre l.v.");
    put_tempi(w, &at);
    put_orders(w, &at);
    put_marks(w, &at);
    put_names(w, &at);
    move(w, &at, w->begin);
    for (int voice = 0; voice < VOICES; voice++) {
        bool used = voice == 0;
        for (int k = now->first; k < now->count && now->items[k].begin < w->end; k++)
            used |= now->items[k].voice == voice && now->items[k].end > w->begin;
        if (used)
            put_voice(w, voice, now->first);
    }
    while (now->first < now->count && now->items[now->first].end <= w->end)
        now->first++;
}

static void put_bars(writer *w)
{
    const midi_file *f = w->file;
    for (w->bar = f->bars; w->bar < f->bars + f->bar_count; w->bar++) {
        w->begin = ticks_of(w->bar->beat);
        w->end = ticks_of(w->bar[1].beat);
        PUT(w, "<measure number=\"%s\"%s>", w->bar->number,
            himc_music_is_short(w->bar) ? " implicit=\"yes\"" : "");
        put_attributes(w);
        for (w->now = w->staves; w->now < w->staves + w->staff_count; w->now++)
            put_bar(w);
        PUT(w, "<forward><duration>%ld</duration></forward></measure>\n", w->end - w->begin);
    }
}

static bool is_foot(const midi_note *n)
{
    return n->way.hand == 0 && n->way.length <= 0;
}

// true if a stroke is one more note of a chord; the reader takes signs of the first for all
static bool joins(const music_item *head, const music_item *i)
{
    const midi_way *a = &head->note->way, *b = &i->note->way;
    return head->begin == i->begin && !is_held(head->note) && !is_held(i->note) &&
           a->nuance == b->nuance && b->ornament == HIMC_PLAIN && head->note->key != i->note->key;
}

// the notes of a choice in voices; returns how many. A voice is free where its note has ended
static int take_items(writer *w)
{
    long last[VOICES] = {0};
    int before[VOICES] = {-1, -1, -1, -1};
    bool hands = false, feet = false;
    w->now->count = 0;
    w->bar = w->file->bars;
    for (int i = 0; i < w->file->note_count; i++)
        if (w->file->notes[i].choice == MIDI_DRUMS && w->now->choice == MIDI_DRUMS) {
            hands |= w->file->notes[i].way.hand > 0;
            feet |= is_foot(&w->file->notes[i]);
        }
    w->now->feet = hands && feet;
    for (int i = 0; i < w->file->note_count; i++) {
        const midi_note *n = &w->file->notes[i];
        if (n->choice != w->now->choice)
            continue;
        music_item *to = &w->now->items[w->now->count];
        double end = n->way.length > 0
                         ? n->beat + n->way.length
                         : himc_score_beat(w->file->tempi, w->file->tempo_count, n->off);
        *to = (music_item){.note = n, .begin = himc_music_snap(ticks_of(n->beat))};
        to->end = himc_music_snap(ticks_of(end));
        to->end = to->end > to->begin ? to->end : to->begin + TICKS / 32;
        to->voice = w->now->feet && is_foot(n) ? FOOT : 0;
        int k = before[to->voice];
        to->chord = k >= 0 && joins(&w->now->items[k], to);
        while (!to->chord && to->voice + 1 < VOICES && last[to->voice] > to->begin)
            to->voice++;
        k = before[to->voice];
        long bar_end = himc_music_bar_end(w->file, &w->bar, to->begin);
        if (k >= 0 && !is_held(w->now->items[k].note) && w->now->items[k].end > to->begin &&
            !to->chord)
            w->now->items[k].end = to->begin;
        if (!is_held(n))
            to->end = bar_end < to->begin + TICKS ? bar_end : to->begin + TICKS;
        last[to->voice] = is_held(n) ? to->end : to->begin + 1;
        if (!to->chord)
            before[to->voice] = w->now->count;
        w->now->count++;
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

static void place_drums(writer *w)
{
    bool used[MIDI_KEY_COUNT] = {false};
    for (int i = 0; i < w->file->note_count; i++)
        if (w->file->notes[i].choice == MIDI_DRUMS)
            used[w->file->notes[i].key] = true;
    himc_music_places(used, w->place, w->name);
}

// borrows the room for items and marks
static void list_staves(writer *w, music_item *items, music_mark *marks)
{
    for (int choice = MIDI_TIMPANI; choice < MIDI_CHOICES; choice++) {
        w->now = &w->staves[w->staff_count];
        *w->now = (staff){.choice = (midi_choice)choice,
                          .items = items,
                          .marks = marks,
                          .spot = HIMC_SPOT_NORMAL,
                          .step = -1};
        w->staff_count += take_items(w) > 0;
        w->now->mark_count = himc_music_marks(items, w->now->count, w->file, marks);
        marks += w->now->mark_count;
        items += w->now->count;
    }
}

static void put_document(writer *w, const char *title)
{
    PUT(w, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!DOCTYPE score-partwise PUBLIC "
           "\"-//Recordare//DTD MusicXML 4.0 Partwise//EN\" "
           "\"http://www.musicxml.org/dtds/partwise.dtd\">\n");
    PUT(w, "<score-partwise version=\"4.0\"><movement-title>%s</movement-title><part-list>\n",
        title);
    put_part_list(w);
    PUT(w, "</part-list>\n<part id=\"P%d\">\n", w->staff_count > 1 ? 1 : (int)w->staves[0].choice);
    put_bars(w);
    PUT(w, "</part>\n</score-partwise>\n");
}

bool himc_music_write(himc_text_lines *out, const midi_file *file, const char *title)
{
    writer w = {.out = out, .file = file};
    const size_t count = (size_t)file->note_count + 1;
    double longest = 0;
    for (int i = 0; i < file->bar_count; i++)
        longest = fmax(longest, file->bars[i + 1].beat - file->bars[i].beat);
    music_item *items = malloc(count * sizeof *items);
    music_mark *marks = malloc(MUSIC_MARKS_OF(count) * sizeof *marks);
    w.segments = malloc(2 * count * sizeof *w.segments);
    w.pieces = malloc(MUSIC_PIECES_OF(2 * count, longest) * sizeof *w.pieces);
    bool good = items && marks && w.segments && w.pieces;
    if (good) {
        place_drums(&w);
        list_staves(&w, items, marks);
        put_document(&w, title);
    }
    free(items);
    free(marks);
    free(w.segments);
    free(w.pieces);
    return good && !out->failed;
}
