/// export.c: from a score's strokes to notes, the way back of midi/import.c.
///
/// A timpano's note is the pitch that its pedal has on the stroke's beat, rounded to a semitone; a
/// pedal that moves becomes an order, heard if it is a gliss. Bars have their pitch, all other
/// instruments the key of their name in the kit, else of their kind. Invariant: each stroke and
/// each line of the score is written, or counted once with the bar of the first of its kind.
#include "musicxml/export.h"

#include "base/array.h"
#include "base/format.h"
#include "base/head_frame.h"
#include "midi/part.h"
#include "musicxml/music.h"
#include "plan/score.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define USUAL_INCHES 26.0 // of a timpano, which then sounds ...
#define USUAL_KEY 50      // ... D3
#define ROUNDED 2.0       // of a pitch between semitones that is told (cents); chosen

/// A drum of the score.
typedef struct head {
    const char *name, *kind;
    const char *like; ///< of drums: the instrument of the kit that it is written as
    midi_choice choice;
    int key;      ///< of timpani as it is now, of drums always
    bool open;    ///< a hi-hat
    int written;  ///< of timpani: at the last stroke ...
    double moved; ///< ... and the beat at which its pedal began to move since then
    int last;     ///< 1 + the index of its last note
} head;

/// What notation does not have.
typedef enum loss {
    STROKES,
    SPOTS,
    PLACES,
    DEAD,
    DOUBLES,
    PRESSES,
    NUANCES,
    TUNINGS,
    COMMANDS, ///< and on: a command at a beat, by its id
    LINES = COMMANDS + HIMC_COMMANDS,
    LOSSES = LINES + HIMC_COMMANDS
} loss;

typedef struct exporter {
    midi_file *file;
    head head[HIMC_DRUMS];
    int heads, note_room, order_room;
    int lost[LOSSES];     ///< how many ...
    double first[LOSSES]; ///< ... and the beat of the first
    double end;           ///< of notes and pedals (beats)
    bool midi, makes;     ///< `makes`: the score makes its drums
    himc_error *error;
} exporter;

#define NEAR 1e-6 // (beats)

static void lose(exporter *x, int what, double beat)
{
    if (x->lost[what]++ == 0 || beat < x->first[what])
        x->first[what] = beat;
}

static int key_of(double hz)
{
    double key = 69 + 12 * log2(hz / 440);
    return key >= 12 && key < 127 ? (int)lround(key) : USUAL_KEY;
}

static double hz_of(int key)
{
    return 440 * exp2((key - 69) / 12.0);
}

// notation says on or off
static bool is_switch(const himc_command *c)
{
    return c->atom[0].number == 0 || c->atom[0].number == 1;
}

static head *find_head(exporter *x, const char *name)
{
    for (int i = 0; i < x->heads; i++)
        if (strcmp(x->head[i].name, name) == 0)
            return &x->head[i];
    return NULL;
}

static void add_head(exporter *x, const char *name, const char *kind, double size)
{
    const char *used[HIMC_DRUMS + 1] = {NULL};
    if (x->heads == HIMC_DRUMS)
        return;
    for (int i = 0; i < x->heads; i++)
        used[i] = x->head[i].like;
    head *h = &x->head[x->heads++];
    *h = (head){.name = name, .kind = kind, .like = "", .choice = MIDI_TIMPANI, .key = USUAL_KEY};
    if (strcmp(kind, "timpano") != 0) {
        bool concert = strcmp(kind, "concert-tom") == 0;
        h->choice = himc_music_instrument(kind, &h->key);
        h->like = himc_midi_instrument_like(name, concert ? "tom" : kind, size, used);
        if (h->like[0] && h->choice <= MIDI_DRUMS) {
            h->choice = MIDI_DRUMS;
            h->key = himc_midi_key_of(h->like, "", HIMC_SPOT_NORMAL, false);
        }
    } else if (size > 0) {
        h->key = USUAL_KEY - (int)lround(12 * log2(size / USUAL_INCHES));
    }
    h->written = h->key;
}

static bool add_order(exporter *x, midi_order order)
{
    midi_file *f = x->file;
    if (!himc_array_grow(&f->orders, f->order_count, &x->order_room, sizeof *f->orders, x->error))
        return false;
    order.seconds = himc_score_seconds(f->tempi, f->tempo_count, order.beat);
    f->orders[f->order_count++] = order;
    x->end = fmax(x->end, himc_score_beat(f->tempi, f->tempo_count, order.seconds + order.length));
    return true;
}

// a hand on the head ends its last note; off it again, it is there for the next. Behind a roll it
// is an order. False if there is no note
static bool damp(exporter *x, const head *h, double beat, bool on)
{
    midi_note *n = h->last > 0 ? &x->file->notes[h->last - 1] : NULL;
    if (!on || !n || n->way.ring != 0)
        return !on || n;
    bool roll = n->way.length > 0, late = roll && beat > n->beat + n->way.length + 0.01 && !x->midi;
    n->way.ring = late ? 1 : -1;
    n->off = roll ? n->off : himc_score_seconds(x->file->tempi, x->file->tempo_count, beat);
    x->end = fmax(x->end, roll ? 0 : beat);
    return !late ||
           add_order(x, (midi_order){
                            .beat = beat, .kind = MIDI_DAMP, .choice = h->choice, .value = n->key});
}

// what a line does to a drum; `kind`: its loss if notation does not have it
static void follow_line(exporter *x, const himc_score_line *line, loss kind)
{
    const himc_command *c = &line->command;
    head *h = find_head(x, line->drum);
    bool timpano = h && h->choice == MIDI_TIMPANI, written = false;
    if (himc_score_makes_drum(line)) {
        bool drum = c->id == HIMC_COMMAND_MAKE_DRUM;
        int of = drum ? 1 : 2;
        double size =
            c->count > of && c->atom[of].kind == HIMC_ATOM_NUMBER ? c->atom[of].number : 0;
        const char *made = drum ? "timpano" : c->atom[1].symbol;
        add_head(x, c->atom[0].symbol, made, drum || strcmp(made, "timpano") != 0 ? size : 0);
        written = true;
    } else if (timpano && (c->id == HIMC_COMMAND_TUNE || c->id == HIMC_COMMAND_GLISS)) {
        h->key = key_of(c->atom[0].number);
        if (fabs(1200 * log2(c->atom[0].number / hz_of(h->key))) > ROUNDED)
            lose(x, TUNINGS, line->beat);
        written = c->id == HIMC_COMMAND_TUNE || !x->midi;
    } else if (h && c->id == HIMC_COMMAND_PEDAL) {
        h->open = c->atom[0].number < 0.5;
        written = strcmp(h->kind, "hi-hat") == 0 && is_switch(c);
    } else if (c->id == HIMC_COMMAND_MUFFLE) {
        written = timpano && !x->midi && is_switch(c);
    }
    if (h && (timpano || !x->midi) && c->id == HIMC_COMMAND_DAMP && is_switch(c))
        written = damp(x, h, line->beat, c->atom[0].number > 0);
    if (!written)
        lose(x, (int)kind + (int)c->id, line->beat);
}

// a timpano with the name that the import gives it
static int drum_of(const head *h)
{
    char name[HIMC_NAME_SIZE + 10];
    himc_format(name, sizeof name, "%s timpano", h->name);
    return h->choice == MIDI_TIMPANI ? himc_music_drum(name) : 0;
}

// the drum where another one has its pitch
static int named_drum(const exporter *x, const head *h, int key)
{
    for (const head *other = x->head; other < x->head + x->heads; other++)
        if (other != h && other->choice == MIDI_TIMPANI && other->key == key)
            return drum_of(h);
    return 0;
}

// what a pedal has done since the last order
static bool add_tuning(exporter *x, head *h, int key)
{
    int from = h->written;
    h->written = key;
    return h->choice != MIDI_TIMPANI || from == key ||
           add_order(x, (midi_order){.beat = h->moved,
                                     .kind = MIDI_TUNING,
                                     .choice = h->choice,
                                     .from = from + 128 * named_drum(x, h, from),
                                     .value = key});
}

static bool follow_muffle(exporter *x, const himc_score_line *line)
{
    const head *h = find_head(x, line->drum);
    return !h || line->command.id != HIMC_COMMAND_MUFFLE ||
           add_order(x, (midi_order){.beat = line->beat,
                                     .kind = MIDI_MUFFLE,
                                     .choice = h->choice,
                                     .value = line->command.atom[0].number > 0.5});
}

static bool follow_change(exporter *x, const himc_score_line *line)
{
    const himc_command *c = &line->command;
    head *h = find_head(x, line->drum);
    int before = h ? h->key : 0;
    if (h && h->key == h->written)
        h->moved = line->beat;
    follow_line(x, line, COMMANDS);
    if (h && c->id == HIMC_COMMAND_GLISS && h->key != before) {
        if (!add_tuning(x, h, before))
            return false;
        h->written = h->key;
        return add_order(x, (midi_order){.beat = line->beat,
                                         .kind = MIDI_TUNING,
                                         .choice = h->choice,
                                         .from = before + 128 * named_drum(x, h, before),
                                         .value = h->key,
                                         .glides = true,
                                         .length = c->atom[1].number});
    }
    return follow_muffle(x, line);
}

static int part_key(const char *part)
{
    double hz;
    return himc_note_frequency(part, &hz) ? key_of(hz) : -1;
}

// where a stroke lands, on a plate also by the name of a part
static himc_spot spot_of(const himc_stroke *s)
{
    return strcmp(s->part, "bell") == 0   ? HIMC_SPOT_CENTER
           : strcmp(s->part, "edge") == 0 ? HIMC_SPOT_RIM
                                          : s->spot;
}

// MIDI has no other sign for what rings: a note lasts up to the drum's next, which is the last one,
// or to the graces of that
static void end_last(exporter *x, head *h)
{
    const midi_note *last = &x->file->notes[x->file->note_count - 1];
    midi_note *old = h->last > 0 && x->midi ? &x->file->notes[h->last - 1] : NULL;
    if (old && old->way.ring == 0 && old->way.length <= 0)
        old->off = last->seconds - himc_midi_graces(&last->way) * MUSIC_GRACE_TIME;
    h->last = x->file->note_count;
}

static bool add_note(exporter *x, const himc_stroke *s)
{
    midi_file *f = x->file;
    head *h = s->drum[0] ? find_head(x, s->drum) : x->heads > 0 ? &x->head[0] : NULL;
    if (!h && x->makes)
        return himc_error_set(x->error, "stroke at beat %g: no drum %s, expected one that is made",
                              s->beat, s->drum);
    if (!h) { // no drum is made: the performer's own
        add_head(x, s->drum[0] ? s->drum : "drum", "timpano", USUAL_INCHES);
        h = &x->head[x->heads - 1];
    }
    bool told = himc_spot_is_beyond(s->spot) && !x->midi; // by its notehead
    himc_spot struck = told ? HIMC_SPOT_NORMAL : spot_of(s);
    int key =
        h->choice == MIDI_DRUMS ? himc_midi_key_of(h->like, s->part, struck, h->open) : h->key;
    if (s->hand == HIMC_FOOT && strcmp(h->kind, "hi-hat") == 0)
        key = MIDI_PEDAL_HATS;
    key = key < 0 ? h->key : key;
    if (h->choice > MIDI_DRUMS)
        key = part_key(s->part);
    if (key < 0 || h->choice == MIDI_ANY) {
        lose(x, STROKES, s->beat);
        return true;
    }
    himc_spot spot = s->spot;
    bool words = h->choice == MIDI_TIMPANI && !x->midi; // "near rim"
    if (spot == HIMC_SPOT_XY || (spot > HIMC_SPOT_RIM && h->choice != MIDI_DRUMS))
        spot = HIMC_SPOT_NORMAL;
    bool lost = h->choice == MIDI_DRUMS ? s->hand != HIMC_FOOT && himc_midi_key_spot(key) != struck
                                        : spot != s->spot || (spot != HIMC_SPOT_NORMAL && !words);
    if (s->spot == HIMC_SPOT_XY)
        lose(x, PLACES, s->beat);
    else if (lost)
        lose(x, SPOTS, s->beat);
    if (s->bounces == HIMC_DEAD)
        lose(x, DEAD, s->beat);
    if (x->midi && s->ornament > HIMC_ROLL_SINGLE)
        lose(x, s->ornament == HIMC_ROLL_PRESS ? PRESSES : DOUBLES, s->beat);
    if (x->midi && s->nuance != HIMC_LEGATO && s->ornament < HIMC_ROLL_SINGLE)
        lose(x, NUANCES, s->beat);
    if (!add_tuning(x, h, h->key) ||
        !himc_array_grow(&f->notes, f->note_count, &x->note_room, sizeof *f->notes, x->error))
        return false;
    double end = s->beat + (s->ornament >= HIMC_ROLL_SINGLE ? s->length : 0);
    x->end = fmax(x->end, fmax(end, s->beat + 1e-3)); // a bar's first beat is in it
    f->notes[f->note_count++] = (midi_note){
        .beat = s->beat,
        .seconds = himc_score_seconds(f->tempi, f->tempo_count, s->beat),
        .off = himc_score_seconds(f->tempi, f->tempo_count, end),
        .key = (uint8_t)key,
        .choice = h->choice,
        .way = {.dynamic = s->dynamic,
                .drum = drum_of(h),
                .length = end - s->beat,
                .last_dynamic = s->last_dynamic,
                .nuance = s->ornament < HIMC_ROLL_SINGLE ? s->nuance : HIMC_LEGATO,
                .ornament = s->ornament,
                .spot = spot,
                .hand = s->hand < HIMC_HANDS ? 1 + (int)s->hand : 0},
    };
    end_last(x, h);
    return true;
}

// changes up to a beat; a gliss there begins after the stroke
static bool follow_changes(exporter *x, const himc_score *score, int *change, double beat)
{
    for (; *change < score->change_count; ++*change) {
        const himc_score_line *line = &score->changes[*change];
        if (line->beat > beat || (line->beat == beat && line->command.id == HIMC_COMMAND_GLISS))
            break;
        if (!follow_change(x, line))
            return false;
    }
    return true;
}

// true if the import cuts such a beginning from a roll with that accent
static bool is_accent(const midi_file *f, const midi_note *n, const midi_note *rest, double steps)
{
    const midi_way *a = &n->way, *b = &rest->way;
    double second = himc_midi_bpm(f->tempi, f->tempo_count, n->beat) / 60;
    return a->length > 0 && b->length > a->length && n->key == rest->key &&
           n->choice == rest->choice && a->ornament == b->ornament && a->spot == b->spot &&
           fabs(a->length - fmax(MUSIC_ATTACK_TIME * second, 0.1)) < 1e-3 &&
           fabs(n->beat + a->length - rest->beat) < 1e-3 &&
           fabs(a->dynamic - b->dynamic - steps / 7) < 0.01 &&
           fabs(a->last_dynamic - b->dynamic) < 0.01 && fabs(b->last_dynamic - b->dynamic) < 0.01 &&
           fabs(7 * b->dynamic - lround(7 * b->dynamic)) < 0.05;
}

// a roll with a louder beginning is one with an accent
static void join_accents(midi_file *f)
{
    int count = 0;
    for (int i = 0; i < f->note_count; i++) {
        midi_note *n = &f->notes[i], *before = NULL;
        for (int k = count - 1; k >= 0 && !before && n->beat - f->notes[k].beat < 2; k--)
            if (f->notes[k].key == n->key && f->notes[k].choice == n->choice)
                before = &f->notes[k];
        bool accent = before && is_accent(f, before, n, 1),
             vertical = before && is_accent(f, before, n, 2);
        if (!accent && !vertical) {
            f->notes[count++] = *n;
            continue;
        }
        before->off = n->off;
        before->way.nuance = accent ? HIMC_ACCENT : HIMC_VERTICAL_ACCENT;
        before->way.length += n->way.length;
        before->way.dynamic = n->way.dynamic;
        before->way.last_dynamic = n->way.last_dynamic;
        before->way.ring = n->way.ring;
    }
    f->note_count = count;
}

// the first bar that is written: that of the comments which has the first stroke
static double find_first(const himc_score *score)
{
    const himc_bars *b = score->bars;
    double first = b ? b->beat : 0;
    while (b && first > score->strokes[0].beat + NEAR)
        first -= 4.0 * b->beats / b->unit;
    return first;
}

static double later(double beat, double by)
{
    return fmax(beat - by, 0);
}

// the piece without the beats before its first bar
static void move(exporter *x, double first)
{
    midi_file *f = x->file;
    double seconds = first > 0 ? himc_score_seconds(f->tempi, f->tempo_count, first)
                               : first * 60 / f->tempi[0].bpm;
    for (int i = 0; i < f->note_count; i++) {
        f->notes[i].beat = later(f->notes[i].beat, first);
        f->notes[i].seconds = later(f->notes[i].seconds, seconds);
        f->notes[i].off = later(f->notes[i].off, seconds);
    }
    for (int i = 0; i < f->order_count; i++) {
        f->orders[i].beat = later(f->orders[i].beat, first);
        f->orders[i].seconds = later(f->orders[i].seconds, seconds);
    }
    int count = 0;
    for (int i = 0; i < f->tempo_count; i++) {
        f->tempi[i].beat = i > 0 ? later(f->tempi[i].beat, first) : 0;
        count -= count > 0 && f->tempi[i].beat == 0;
        f->tempi[count++] = f->tempi[i];
    }
    f->tempo_count = count;
    for (int i = 0; i < LOSSES; i++)
        x->first[i] = later(x->first[i], first);
    x->end -= first;
}

// bars as the comments say, else of 4/4; false without memory
static bool list_bars(exporter *x, const himc_score *score, double first)
{
    static const himc_bars usual = {0, 4, 4};
    const himc_bars *b = score->bars ? score->bars : &usual, *last = b + score->bar_count - 1;
    midi_file *f = x->file;
    int room = 0;
    double beat = 0, next;
    for (; (beat < x->end || f->bar_count == 0) && f->bar_count <= MUSIC_BARS_MAX; beat = next) {
        while (b < last && b[1].beat - first < beat + NEAR)
            b++;
        next = beat + 4.0 * b->beats / b->unit;
        next = b < last ? fmin(next, b[1].beat - first) : next;
        if (!himc_array_grow(&f->bars, f->bar_count + 1, &room, sizeof *f->bars, x->error))
            return false;
        f->bars[f->bar_count++] = (midi_bar){beat, b->beats, b->unit, ""};
        f->bars[f->bar_count] = (midi_bar){.beat = next};
    }
    // a short one is before the first
    int number = himc_music_is_short(f->bars) && f->bar_count > 1 ? 0 : 1;
    for (int i = 0; i < f->bar_count; i++)
        himc_format(f->bars[i].number, sizeof f->bars[i].number, "%d", number + i);
    return true;
}

// what a file of that kind can hold
static bool fits(const exporter *x)
{
    const double slowest = 60e6 / 0xffffff; // microseconds of a quarter note in three bytes
    const midi_file *f = x->file;
    for (int i = 0; i < f->tempo_count && x->midi; i++)
        if (f->tempi[i].bpm < slowest)
            return himc_error_set(x->error,
                                  "tempo %g at beat %g, expected %.4g beats per minute or more in "
                                  "MIDI",
                                  f->tempi[i].bpm, f->tempi[i].beat, slowest);
    const midi_bar *bar = f->bars + f->bar_count - 1;
    double bars = f->bar_count + fmax(0, ceil((x->end - bar[1].beat) * bar->unit / 4 / bar->beats));
    return x->midi || bars <= MUSIC_BARS_MAX ||
           himc_error_set(x->error, "it ends in bar %.0f, expected up to %d bars of MusicXML", bars,
                          MUSIC_BARS_MAX);
}

// a line for each kind of loss
static char *tell(const exporter *x)
{
    static const char *const what[COMMANDS][3] = {
        [STROKES] = {"stroke", "strokes", "not written: notation has no such instrument"},
        [SPOTS] = {"spot", "spots", "not written: the instrument has no sign for it"},
        [PLACES] = {"place", "places", "written as the usual spot"},
        [DEAD] = {"dead stroke", "dead strokes", "written as usual"},
        [DOUBLES] = {"double roll", "double rolls", "written as single strokes"},
        [PRESSES] = {"press roll", "press rolls", "written as single strokes"},
        [NUANCES] = {"nuance", "nuances", "written as loudness, for other programs"},
        [TUNINGS] = {"tuning", "tunings", "written to the semitone"}};
    himc_text_lines said = {0};
    for (int i = 0; i < LINES; i++) {
        const char *verb = x->lost[i] == 1 ? "is" : "are";
        const midi_bar *bar = x->file->bars + x->file->bar_count - 1;
        while (bar > x->file->bars && bar->beat > x->first[i] + NEAR)
            bar--;
        if (x->lost[i] > 0 && i < COMMANDS)
            himc_text_print(&said, "%d %s (bar %s) %s %s\n", x->lost[i], what[i][x->lost[i] > 1],
                            bar->number, verb, what[i][2]);
        else if (x->lost[i] > 0)
            himc_text_print(&said, "%d change%s by %s (bar %s) %s not written\n", x->lost[i],
                            x->lost[i] == 1 ? "" : "s", himc_command_table(i - COMMANDS)->name,
                            bar->number, verb);
    }
    const char *before = "before the piece, not written: ";
    for (int i = LINES; i < LOSSES; i++)
        if (x->lost[i] > 0) {
            himc_text_print(&said, "%s%s %d", before, himc_command_table(i - LINES)->name,
                            x->lost[i]);
            before = ", ";
        }
    if (before[0] == ',')
        himc_text_print(&said, "\n");
    return said.bytes;
}

bool himc_music_notes(midi_file *file, const himc_score *score, bool midi, himc_error *error)
{
    exporter *x = calloc(1, sizeof *x);
    *file = (midi_file){0};
    size_t tempi = (size_t)score->tempo_count * sizeof *file->tempi;
    file->tempi = malloc(tempi);
    bool good = x && file->tempi;
    if (!good)
        himc_error_set(error, "out of memory for the notes");
    if (good) {
        *x = (exporter){.file = file, .midi = midi, .error = error};
        memcpy(file->tempi, score->tempi, tempi);
        file->tempo_count = score->tempo_count;
    }
    for (int i = 0; good && i < score->line_count; i++) {
        follow_line(x, &score->lines[i], LINES);
        good = follow_muffle(x, &score->lines[i]);
    }
    for (int i = 0; i < (x ? x->heads : 0); i++)
        x->head[i].written = x->head[i].key;
    if (good)
        x->makes = x->heads > 0;
    int change = 0;
    for (int i = 0; good && i < score->stroke_count; i++)
        good = follow_changes(x, score, &change, score->strokes[i].beat) &&
               add_note(x, &score->strokes[i]);
    good = good && follow_changes(x, score, &change, INFINITY);
    for (int i = 0; good && i < x->heads; i++)
        good = add_tuning(x, &x->head[i], x->head[i].key);
    if (good && file->note_count == 0)
        good = himc_error_set(error, "no stroke that notation has, expected a score with strokes");
    double first = good ? find_first(score) : 0;
    if (good)
        move(x, first);
    if (good && !midi)
        join_accents(file);
    good = good && list_bars(x, score, first) && fits(x);
    if (good)
        file->said = tell(x);
    free(x);
    if (!good)
        himc_midi_file_free(file);
    return good;
}
