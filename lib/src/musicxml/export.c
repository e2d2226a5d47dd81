/// export.c: from a score's strokes to notes, the way back of midi/import.c.
///
/// A timpano's note is the pitch that its pedal has on the stroke's beat, rounded to a semitone; a
/// pedal that moves becomes an order, heard if it is a gliss. Bars have their pitch, all other
/// instruments the key of their name in the kit, else of their kind. Invariant: each stroke of the
/// score is a note or counted.
#include "musicxml/export.h"

#include "base/array.h"
#include "base/format.h"
#include "base/head_frame.h"
#include "midi/part.h"
#include "musicxml/names.h"
#include "plan/score.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define USUAL_INCHES 26.0 // of a timpano, which then sounds ...
#define USUAL_KEY 50      // ... D3
#define PEDAL_HAT 44      // General MIDI's key of hats that a foot closes

/// A drum of the score.
typedef struct head {
    const char *name, *kind;
    midi_choice choice;
    int key;      ///< of timpani as it is now, of drums always
    bool open;    ///< a hi-hat
    int written;  ///< of timpani: at the last stroke ...
    double moved; ///< ... and the beat at which its pedal began to move since then
} head;

typedef struct exporter {
    midi_file *file;
    head head[HIMC_DRUMS];
    int heads, note_room, order_room, lost;
    int spots; ///< of drums, without a key or a notehead
    bool midi;
    himc_error *error;
} exporter;

static int key_of(double hz)
{
    double key = 69 + 12 * log2(hz / 440);
    return key >= 12 && key < 127 ? (int)lround(key) : USUAL_KEY;
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
    head *h = x->heads < HIMC_DRUMS ? &x->head[x->heads++] : NULL;
    int key = MUSIC_NO_KEY;
    if (!h)
        return;
    *h = (head){.name = name, .kind = kind, .choice = MIDI_TIMPANI, .key = USUAL_KEY};
    if (strcmp(kind, "timpano") != 0) {
        bool timbale = strcmp(kind, "timbale") == 0; // alone the French timpani
        h->choice = himc_music_instrument(timbale ? "drum timbale" : kind, &key);
        h->key = himc_midi_key_of(name, HIMC_SPOT_NORMAL, false);
        h->key = h->key < 0 ? key : h->key;
        if (h->choice == MIDI_ANY && h->key >= 0)
            h->choice = MIDI_DRUMS;
    } else if (size > 0) {
        h->key = USUAL_KEY - (int)lround(12 * log2(size / USUAL_INCHES));
    }
    h->written = h->key;
}

// what a line does to a drum
static void follow_line(exporter *x, const himc_score_line *line)
{
    const himc_command *c = &line->command;
    head *h = find_head(x, line->drum);
    if (himc_score_makes_drum(line)) {
        bool drum = c->id == HIMC_COMMAND_MAKE_DRUM;
        double size = c->count > 1 && c->atom[1].kind == HIMC_ATOM_NUMBER ? c->atom[1].number : 0;
        add_head(x, c->atom[0].symbol, drum ? "timpano" : c->atom[1].symbol, drum ? size : 0);
    } else if (h && (c->id == HIMC_COMMAND_TUNE || c->id == HIMC_COMMAND_GLISS)) {
        h->key = h->choice == MIDI_TIMPANI ? key_of(c->atom[0].number) : h->key;
    } else if (h && c->id == HIMC_COMMAND_PEDAL) {
        h->open = c->atom[0].number < 0.5;
    }
}

static bool add_order(exporter *x, midi_order order)
{
    midi_file *f = x->file;
    if (!himc_array_grow(&f->orders, f->order_count, &x->order_room, sizeof *f->orders, x->error))
        return false;
    order.seconds = himc_score_seconds(f->tempi, f->tempo_count, order.beat);
    f->orders[f->order_count++] = order;
    return true;
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
                                     .from = from % 12,
                                     .value = key % 12});
}

static bool follow_change(exporter *x, const himc_score_line *line)
{
    const himc_command *c = &line->command;
    head *h = find_head(x, line->drum);
    int before = h ? h->key : 0;
    if (h && h->key == h->written)
        h->moved = line->beat;
    follow_line(x, line);
    if (h && c->id == HIMC_COMMAND_GLISS && h->key != before) {
        if (!add_tuning(x, h, before))
            return false;
        h->written = h->key;
        return add_order(x, (midi_order){.beat = line->beat,
                                         .kind = MIDI_TUNING,
                                         .choice = h->choice,
                                         .from = before % 12,
                                         .value = h->key % 12,
                                         .glides = true,
                                         .length = c->atom[1].number});
    }
    return !h || c->id != HIMC_COMMAND_MUFFLE ||
           add_order(x, (midi_order){.beat = line->beat,
                                     .kind = MIDI_MUFFLE,
                                     .choice = h->choice,
                                     .value = c->atom[0].number > 0.5});
}

static int part_key(const char *part)
{
    double hz;
    return himc_note_frequency(part, &hz) ? key_of(hz) : -1;
}

// a timpano with the name that the import gives it
static int drum_of(const head *h)
{
    char name[HIMC_NAME_SIZE + 10];
    himc_format(name, sizeof name, "%s timpano", h->name);
    return h->choice == MIDI_TIMPANI ? himc_music_drum(name) : 0;
}

static bool add_note(exporter *x, const himc_stroke *s)
{
    midi_file *f = x->file;
    head *h = s->drum[0] ? find_head(x, s->drum) : x->heads > 0 ? &x->head[0] : NULL;
    if (!h) { // no drum is made: the performer's own
        add_head(x, s->drum[0] ? s->drum : "drum", "timpano", USUAL_INCHES);
        h = &x->head[x->heads - 1];
    }
    bool told = himc_spot_is_beyond(s->spot) && !x->midi; // by its notehead
    himc_spot struck = told ? HIMC_SPOT_NORMAL : s->spot;
    int key = h->choice == MIDI_DRUMS ? himc_midi_key_of(h->name, struck, h->open) : h->key;
    if (s->hand == HIMC_FOOT && strcmp(h->kind, "hi-hat") == 0)
        key = PEDAL_HAT;
    key = key < 0 ? h->key : key;
    x->spots += h->choice == MIDI_DRUMS && s->hand != HIMC_FOOT && struck != HIMC_SPOT_NORMAL &&
                himc_midi_key_spot(key) != struck;
    himc_spot spot = s->spot;
    if (spot == HIMC_SPOT_XY || (h->choice == MIDI_TIMPANI && spot > HIMC_SPOT_RIM))
        spot = HIMC_SPOT_NORMAL;
    x->spots += spot != s->spot && s->spot != HIMC_SPOT_XY;
    if (h->choice > MIDI_DRUMS)
        key = part_key(s->part);
    if (key < 0 || h->choice == MIDI_ANY) {
        x->lost++;
        return true;
    }
    if (!add_tuning(x, h, h->key))
        return false;
    if (!himc_array_grow(&f->notes, f->note_count, &x->note_room, sizeof *f->notes, x->error))
        return false;
    double end = s->beat + (s->ornament >= HIMC_ROLL_SINGLE ? s->length : 0);
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
                .nuance = s->nuance,
                .ornament = s->ornament < HIMC_ROLL_SINGLE ? s->ornament : HIMC_PLAIN,
                .spot = spot,
                .hand = s->hand < HIMC_HANDS ? 1 + (int)s->hand : 0},
    };
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
    for (int i = 0; good && i < score->line_count; i++)
        follow_line(x, &score->lines[i]);
    for (int i = 0; i < (x ? x->heads : 0); i++)
        x->head[i].written = x->head[i].key;
    int change = 0;
    for (int i = 0; good && i < score->stroke_count; i++)
        good = follow_changes(x, score, &change, score->strokes[i].beat) &&
               add_note(x, &score->strokes[i]);
    good = good && follow_changes(x, score, &change, INFINITY);
    for (int i = 0; good && i < x->heads; i++)
        good = add_tuning(x, &x->head[i], x->head[i].key);
    if (good && file->note_count == 0)
        good = himc_error_set(error, "no stroke that notation has, expected a score with strokes");
    himc_text_lines said = {0};
    if (good && x->lost > 0)
        himc_text_print(&said, "%d stroke%s not written: notation has no such instrument\n",
                        x->lost, x->lost == 1 ? " is" : "s are");
    if (good && x->spots > 0)
        himc_text_print(&said, "%d spot%s not written: the instrument has no key for it\n",
                        x->spots, x->spots == 1 ? " is" : "s are");
    file->said = said.bytes;
    free(x);
    if (!good)
        himc_midi_file_free(file);
    return good;
}
