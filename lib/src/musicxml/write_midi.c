/// write_midi.c: notes as a Standard MIDI File of format 1, a track for each part.
///
/// A roll is the strokes that a player would about play, as MIDI has no tremolo; grace notes stand
/// before their note; hands and places are lost. Velocities are those of notation programs
/// (midi/import.c) for a stroke as loud as it is played; a text before it says its nuance. A
/// timpano's note lasts until a hand damps it, else up to the next. Events are sorted by tick, ends
/// before beginnings.
#include "musicxml/export.h"

#include "base/format.h"
#include "midi/part.h"
#include "musicxml/music.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BASS_DRUM 36        // for concert instruments that General MIDI has no key for
#define TICKS 960           // of a quarter note
#define ROLL_RATE 11.0      // strokes of a roll (1/s); chosen: of a middle drum (plan/ornament.c)
#define SHORT 0.03          // of a stroke's note (s); shorter than from grace to grace
#define LONGEST 0x0fffffffL // between two events (ticks), by the standard

typedef struct event {
    long tick;
    uint8_t bytes[3];
    const midi_way *way; ///< what a text says, or NULL
} event;

typedef struct writer {
    const midi_file *file;
    event *events;
    int count, room;
    bool failed;
} writer;

static void add(writer *w, double beat, uint8_t status, uint8_t key, double velocity)
{
    if (w->count >= w->room) {
        int room = 2 * w->room + 256;
        event *more = realloc(w->events, (size_t)room * sizeof *more);
        w->failed |= !more;
        if (!more)
            return;
        w->events = more;
        w->room = room;
    }
    velocity = fmin(fmax(velocity, 1), 127);
    w->events[w->count++] =
        (event){lround(fmax(beat, 0) * TICKS), {status, key, (uint8_t)lround(velocity)}, NULL};
}

static void add_stroke(writer *w, const midi_note *n, double seconds, double length,
                       double velocity)
{
    static const uint8_t channel[] = {
        [MIDI_TIMPANI] = 0,     [MIDI_DRUMS] = 9,      [MIDI_MARIMBA] = 1,
        [MIDI_XYLOPHONE] = 2,   [MIDI_VIBRAPHONE] = 3, [MIDI_GLOCKENSPIEL] = 4,
        [MIDI_TUBULAR_BELL] = 5};
    const midi_file *f = w->file;
    uint8_t on = 0x90 | channel[n->choice], key = n->key < 128 ? n->key : BASS_DRUM;
    double end = himc_score_beat(f->tempi, f->tempo_count, seconds + fmax(length, SHORT));
    add(w, himc_score_beat(f->tempi, f->tempo_count, seconds), on, key, velocity);
    add(w, end, on & 0x8f, key, 64);
}

static void add_note(writer *w, const midi_note *n)
{
    const midi_way *way = &n->way;
    double seconds = n->off - n->seconds;
    int strokes = way->length > 0 ? (int)fmax(lround(seconds * ROLL_RATE), 4) : 1;
    for (int g = himc_midi_graces(way); g > 0; g--)
        if (n->seconds - g * MUSIC_GRACE_TIME >= 0)
            add_stroke(w, n, n->seconds - g * MUSIC_GRACE_TIME, 0,
                       himc_midi_velocity(0.6 * way->dynamic));
    for (int i = 0; i < strokes && way->length > 0; i++)
        add_stroke(
            w, n, n->seconds + seconds * i / strokes, 0,
            himc_midi_velocity(way->dynamic + (way->last_dynamic - way->dynamic) * i / strokes));
    if (way->length > 0)
        return;
    int first = w->count;
    add_stroke(w, n, n->seconds, n->choice == MIDI_TIMPANI ? seconds : 0,
               himc_midi_played_velocity(way->nuance, way->dynamic));
    if (way->nuance != HIMC_LEGATO && !w->failed)
        w->events[first].way = way;
}

static int by_tick(const void *a, const void *b)
{
    const event *x = a, *y = b;
    if (x->tick != y->tick)
        return x->tick < y->tick ? -1 : 1;
    // ends first
    return (x->bytes[0] & 0x10) != (y->bytes[0] & 0x10)
               ? (x->bytes[0] & 0x10) - (y->bytes[0] & 0x10)
               : x->bytes[1] - y->bytes[1];
}

static void put(himc_text_lines *out, const void *bytes, size_t size)
{
    if (!himc_text_reserve(out, size)) {
        out->failed = true;
        return;
    }
    memcpy(out->bytes + out->size, bytes, size);
    out->size += size;
}

static void put_number(himc_text_lines *out, unsigned long number, int bytes)
{
    for (int i = bytes - 1; i >= 0; i--)
        put(out, &(uint8_t){(uint8_t)(number >> (8 * i))}, 1);
}

// a time up to the next event; a longer one than four bytes hold has empty texts on its way
static void put_length(himc_text_lines *out, long number)
{
    for (; number > LONGEST; number -= LONGEST)
        put(out, "\xff\xff\xff\x7f\xff\1\0", 7);
    for (int shift = 21; shift > 0; shift -= 7)
        if (number >> shift)
            put(out, &(uint8_t){(uint8_t)(0x80 | (number >> shift & 0x7f))}, 1);
    put(out, &(uint8_t){(uint8_t)(number & 0x7f)}, 1);
}

// a chunk whose length is known at its end
static size_t begin_track(himc_text_lines *out)
{
    put(out, "MTrk\0\0\0\0", 8);
    return out->size;
}

static void end_track(himc_text_lines *out, size_t begin)
{
    put(out, "\0\xff\x2f\0", 4);
    size_t length = out->size - begin;
    for (int i = 0; i < 4 && !out->failed; i++)
        out->bytes[begin - 4 + (size_t)i] = (char)(uint8_t)(length >> (24 - 8 * i));
}

// its meter, where it is another one or begins early
static void put_meter(himc_text_lines *out, const midi_file *file, int i, long *now)
{
    const midi_bar *b = file->bars + i;
    if (i > 0 && b->beats == b[-1].beats && b->unit == b[-1].unit && !himc_music_is_short(b - 1))
        return;
    long tick = lround(b->beat * TICKS);
    uint8_t power = 0;
    while (1 << power < b->unit)
        power++;
    put_length(out, tick - *now);
    put(out, (uint8_t[]){0xff, 0x58, 4, (uint8_t)b->beats, power, 24, 8}, 7);
    *now = tick;
}

// tempi and meters
static void put_map(himc_text_lines *out, const midi_file *file)
{
    size_t begin = begin_track(out);
    long now = 0;
    for (int i = 0, bar = 0; i < file->tempo_count || bar < file->bar_count;) {
        double beat = i < file->tempo_count ? file->tempi[i].beat : HUGE_VAL;
        if (bar < file->bar_count && file->bars[bar].beat <= beat) {
            put_meter(out, file, bar++, &now);
            continue;
        }
        long tick = lround(beat * TICKS);
        put_length(out, tick - now);
        put(out, "\xff\x51\3", 3);
        put_number(out, (unsigned long)fmin(lround(60e6 / file->tempi[i++].bpm), 0xffffff), 3);
        now = tick;
    }
    end_track(out, begin);
}

// before a note at the same time
static void put_said(himc_text_lines *out, int key, const midi_way *way)
{
    char text[64];
    himc_format(text, sizeof text, MIDI_SAID, key, himc_nuance_name(way->nuance), way->dynamic);
    put(out, (uint8_t[]){0xff, 1, (uint8_t)strlen(text)}, 3);
    put(out, text, strlen(text));
    put(out, "", 1);
}

/// A track: a kind, or a concert instrument that General MIDI lacks, by its key from 128.
static bool is_of_track(const midi_note *n, int track)
{
    return (n->choice == MIDI_DRUMS && n->key >= MIDI_BASS_DRUM ? n->key : (int)n->choice) == track;
}

// tracks of one player share the name before the colon (smf.c)
static void put_part(himc_text_lines *out, writer *w, int track, bool several)
{
    static const struct {
        const char *name;
        uint8_t status, program;
    } part[] = {[MIDI_TIMPANI] = {"Timpani", 0xc0, 47},
                [MIDI_DRUMS] = {"Drums", 0xc9, 0},
                [MIDI_MARIMBA] = {"Marimba", 0xc1, 12},
                [MIDI_XYLOPHONE] = {"Xylophone", 0xc2, 13},
                [MIDI_VIBRAPHONE] = {"Vibraphone", 0xc3, 11},
                [MIDI_GLOCKENSPIEL] = {"Glockenspiel", 0xc4, 9},
                [MIDI_TUBULAR_BELL] = {"Tubular Bells", 0xc5, 14}};
    midi_choice choice = track < MIDI_CHOICES ? (midi_choice)track : MIDI_DRUMS;
    char name[64];
    himc_format(name, sizeof name, "%s%s", several ? "Player 1: " : "",
                track < MIDI_CHOICES ? part[choice].name : himc_midi_key_sound(track));
    long now = 0;
    w->count = 0;
    for (int i = 0; i < w->file->note_count; i++)
        if (is_of_track(&w->file->notes[i], track))
            add_note(w, &w->file->notes[i]);
    qsort(w->events, (size_t)w->count, sizeof *w->events, by_tick);
    size_t begin = begin_track(out);
    put(out, (uint8_t[]){0, 0xff, 3, (uint8_t)strlen(name)}, 4);
    put(out, name, strlen(name));
    put(out, (uint8_t[]){0, part[choice].status, part[choice].program}, 3);
    for (int i = 0; i < w->count; i++) {
        const midi_way *way = w->events[i].way;
        put_length(out, w->events[i].tick - now);
        if (way)
            put_said(out, w->events[i].bytes[1], way);
        put(out, w->events[i].bytes, 3);
        now = w->events[i].tick;
    }
    end_track(out, begin);
}

bool himc_music_write_midi(himc_text_lines *out, const midi_file *file)
{
    writer w = {.file = file};
    bool used[MIDI_KEY_COUNT] = {false};
    int tracks = 1;
    for (int c = MIDI_TIMPANI; c < MIDI_KEY_COUNT; c++)
        for (int i = 0; i < file->note_count && !used[c]; i++)
            tracks += used[c] = is_of_track(&file->notes[i], c);
    put(out, "MThd\0\0\0\6\0\1", 10);
    put_number(out, (unsigned long)tracks, 2);
    put_number(out, TICKS, 2);
    put_map(out, file);
    for (int c = MIDI_TIMPANI; c < MIDI_KEY_COUNT && !w.failed; c++)
        if (used[c])
            put_part(out, &w, c, tracks > 2);
    free(w.events);
    return !out->failed && !w.failed;
}
