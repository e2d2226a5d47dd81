/// smf.c: the reader of MIDI files.
///
/// A file is chunks: a header, then tracks of events, each after a delta time in ticks. The tracks
/// are read one by one into one list of the events that matter (notes, programs, tempi), sorted by
/// tick; then one pass turns ticks into seconds and note-ons with their note-offs into notes. Each
/// byte is taken through `next_byte`, which knows the end of its chunk; a chunk longer than the
/// file is cut to it. Seconds: t += ticks * us / (1e6 ppqn), in the order of the merged tempo map.
/// Invariant: nothing before `bytes` or from `end` on is read, whatever the lengths in the file
/// say.
#include "midi/smf.h"

#include "base/argument.h"
#include "base/array.h"

#include <ctype.h>
#include <string.h>

#define USUAL_TEMPO 500000 // of a file that says nothing (microseconds per quarter note)

typedef enum event_kind { NOTE_OFF, NOTE_ON, PROGRAM, TEMPO } event_kind;

typedef struct event {
    int64_t tick;
    uint32_t order; ///< among those of one tick
    uint32_t tempo; ///< (microseconds per quarter note)
    uint16_t track;
    uint8_t kind, channel, first, second; ///< data bytes
} event;

typedef struct reader {
    const uint8_t *at, *end; ///< of the present chunk
    bool cut;                ///< a byte was wanted after the end
    int track, format;
    double per_second;  ///< ticks, of SMPTE; 0: they are parts of a quarter note
    double quarter;     ///< ticks
    int64_t tick, from; ///< now; where the track begins
    int64_t cut_at;     ///< where the shortest cut track ends
    uint8_t status;     ///< of the last channel message, 0 for none
    bool over;          ///< the end-of-track event has come
    event *events;
    int count, room;
    bool *timpani; ///< (tracks) of the names
    himc_error *error;
} reader;

bool himc_midi_is_file(const void *bytes, size_t size)
{
    return size >= 4 && memcmp(bytes, "MThd", 4) == 0;
}

static uint8_t next_byte(reader *r)
{
    if (r->at < r->end)
        return *r->at++;
    r->cut = true;
    return 0;
}

// big-endian; `bytes` are there
static uint32_t number_of(const uint8_t *bytes, int count)
{
    uint32_t number = 0;
    for (int i = 0; i < count; i++)
        number = number << 8 | bytes[i];
    return number;
}

static bool wrong(reader *r, const char *what)
{
    return himc_error_set(r->error, "track %d: %s", r->track + 1, what);
}

// seven bits a byte, the last one below 0x80; four bytes at most
static bool next_length(reader *r, uint32_t *length)
{
    *length = 0;
    for (int i = 0; i < 4; i++) {
        uint8_t byte = next_byte(r);
        *length = *length << 7 | (byte & 0x7f);
        if (byte < 0x80)
            return true;
    }
    return wrong(r, "a number of more than 4 bytes");
}

static bool add_event(reader *r, const event *e)
{
    if (!himc_array_grow(&r->events, r->count, &r->room, sizeof *e, NULL))
        return himc_error_set(r->error, "out of memory for %d events", 2 * r->room);
    r->events[r->count] = *e;
    r->events[r->count].tick = r->tick;
    r->events[r->count].track = (uint16_t)r->track;
    r->events[r->count].order = (uint32_t)r->count;
    r->count++;
    return true;
}

// "Timpani", "Pauken", "kettledrums", "timbales"
static bool names_timpani(const uint8_t *text, size_t size)
{
    static const char *const word[] = {"timp", "pauk", "kettle", "timbal"};
    for (size_t at = 0; at < size; at++)
        for (size_t w = 0; w < sizeof word / sizeof *word; w++) {
            size_t i = 0;
            while (word[w][i] && at + i < size && tolower(text[at + i]) == word[w][i])
                i++;
            if (!word[w][i])
                return true;
        }
    return false;
}

// a message to a channel, of one data byte or two; `first` has been read
static bool read_message(reader *r, uint8_t first)
{
    enum { OFF = 0x8, ON = 0x9, SET_PROGRAM = 0xc, PRESSURE = 0xd };
    int word = r->status >> 4;
    bool two = word != SET_PROGRAM && word != PRESSURE;
    uint8_t second = two ? next_byte(r) : 0;
    if (r->cut)
        return true;
    if (first > 127 || second > 127)
        return wrong(r, "a data byte above 127");
    event e = {.channel = r->status & 0xf, .first = first, .second = second};
    if (word != OFF && word != ON && word != SET_PROGRAM)
        return true;
    e.kind = word == SET_PROGRAM ? PROGRAM : word == ON && second > 0 ? NOTE_ON : NOTE_OFF;
    return add_event(r, &e);
}

static bool read_event(reader *r)
{
    enum { EXCLUSIVE = 0xf0, ESCAPE = 0xf7, META = 0xff };
    enum { NAME = 0x03, END = 0x2f, SET_TEMPO = 0x51 }; // types of META
    uint32_t delta, length;
    if (!next_length(r, &delta))
        return false;
    r->tick += delta;
    uint8_t byte = next_byte(r);
    if (r->cut)
        return true;
    if (byte < 0x80)
        return r->status ? read_message(r, byte) : wrong(r, "data without a status byte");
    r->status = byte < 0xf0 ? byte : 0;
    if (byte < 0xf0)
        return read_message(r, next_byte(r));
    if (byte != META && byte != EXCLUSIVE && byte != ESCAPE)
        return wrong(r, "a status byte that files do not have");
    uint8_t type = byte == META ? next_byte(r) : 0;
    if (!next_length(r, &length))
        return false;
    r->cut |= length > (size_t)(r->end - r->at);
    if (r->cut)
        return true;
    const uint8_t *data = r->at;
    r->at += length;
    r->over = type == END;
    if (type == NAME)
        r->timpani[r->track] |= names_timpani(data, length);
    if (type == SET_TEMPO && length >= 3)
        return add_event(r, &(event){.kind = TEMPO, .tempo = number_of(data, 3)});
    return true;
}

// all chunks after the header; those that are no tracks are skipped
static bool read_tracks(reader *r, midi_file *file, const uint8_t *at, const uint8_t *end)
{
    while (end - at >= 8 && file->tracks < UINT16_MAX) {
        size_t left = (size_t)(end - at) - 8, length = number_of(at + 4, 4);
        bool longer = length > left;
        length = longer ? left : length;
        r->at = at + 8;
        r->end = r->at + length;
        bool track = memcmp(at, "MTrk", 4) == 0;
        at = r->end;
        if (!track)
            continue;
        r->track = file->tracks++;
        r->tick = r->from;
        r->status = 0;
        r->cut = r->over = false;
        while (r->at < r->end && !r->over && !r->cut)
            if (!read_event(r))
                return false;
        // the tracks of format 2 follow each other
        r->from = r->format == 2 ? r->tick : 0;
        bool cut = r->cut || (longer && !r->over);
        if (cut && (file->cut++ == 0 || r->tick < r->cut_at))
            r->cut_at = r->tick;
    }
    return file->tracks > 0 || himc_error_set(r->error, "a MIDI file without a track");
}

static int by_tick(const void *a, const void *b)
{
    const event *x = a, *y = b;
    return x->tick != y->tick ? (x->tick > y->tick) - (x->tick < y->tick)
                              : (x->order > y->order) - (x->order < y->order);
}

// from events to notes and tempi
static bool collect(midi_file *file, reader *r)
{
    uint8_t program[16] = {0};
    midi_note *sounding[16][128] = {{NULL}};
    file->notes = calloc((size_t)r->count + 1, sizeof *file->notes);
    file->tempi = calloc((size_t)r->count + 1, sizeof *file->tempi);
    if (!file->notes || !file->tempi)
        return himc_error_set(r->error, "out of memory for %d events", r->count);
    if (r->count > 0)
        qsort(r->events, (size_t)r->count, sizeof *r->events, by_tick);
    file->tempi[file->tempo_count++] = (himc_tempo_change){0, 60e6 / USUAL_TEMPO};
    int64_t tick = 0;                                         // where the present tempo began ...
    double beat, seconds = 0, since = 0, tempo = USUAL_TEMPO; // ... and when (s)
    for (const event *e = r->events; e < r->events + r->count; e++) {
        beat = (double)e->tick / r->quarter;
        seconds = r->per_second > 0 ? (double)e->tick / r->per_second
                                    : since + (double)(e->tick - tick) * tempo / (1e6 * r->quarter);
        midi_note **note = &sounding[e->channel][e->first];
        if (e->kind == PROGRAM)
            program[e->channel] = e->first;
        if ((e->kind == NOTE_ON || e->kind == NOTE_OFF) && *note) {
            (*note)->off = seconds;
            *note = NULL;
        }
        if (e->kind == NOTE_ON) {
            bool timpani = r->timpani[e->track] && e->channel != MIDI_DRUM_CHANNEL;
            *note = &file->notes[file->note_count++];
            **note = (midi_note){.beat = beat,
                                 .seconds = seconds,
                                 .off = -1,
                                 .track = e->track,
                                 .channel = e->channel,
                                 .key = e->first,
                                 .velocity = e->second,
                                 .program = program[e->channel],
                                 .choice = timpani ? MIDI_TIMPANI : MIDI_ANY,
                                 .way = {.dynamic = -1, .spot = HIMC_SPOT_NORMAL}};
        }
        if (e->kind == TEMPO && r->per_second == 0) {
            since = seconds;
            tick = e->tick;
            tempo = e->tempo;
            double bpm = 60e6 / (e->tempo ? e->tempo : 1);
            bool again = file->tempi[file->tempo_count - 1].beat == beat;
            // a score has lines for 10000 changes
            file->converted |=
                bpm < HIMC_BPM_MIN || bpm > HIMC_BPM_MAX || file->tempo_count > 10000;
            file->tempo_count += !again;
            file->tempi[file->tempo_count - 1] = (himc_tempo_change){beat, bpm};
        }
    }
    for (int i = 0; i < file->note_count; i++)
        if (file->notes[i].off < 0)
            file->notes[i].off = seconds;
    return true;
}

// beats that a score can have: half seconds where the file's are none
static bool settle_beats(midi_file *file, const reader *r)
{
    double beat = (double)r->cut_at / r->quarter;
    file->cut_at = r->per_second > 0 ? (double)r->cut_at / r->per_second
                                     : himc_score_seconds(file->tempi, file->tempo_count, beat);
    file->converted |= r->per_second > 0;
    if (file->converted) {
        const double bpm = 120;
        for (int i = 0; i < file->note_count; i++)
            file->notes[i].beat = file->notes[i].seconds * bpm / 60;
        file->tempi[0] = (himc_tempo_change){0, bpm};
        file->tempo_count = 1;
    }
    double last = file->note_count > 0 ? file->notes[file->note_count - 1].beat : 0;
    double most = himc_argument_find("BEAT", NULL)->high;
    return last <= most ||
           himc_error_set(r->error, "a note at beat %.9g, expected up to %g", last, most);
}

bool himc_midi_file_read(midi_file *file, const void *bytes, size_t size, himc_error *error)
{
    const uint8_t *at = bytes;
    *file = (midi_file){0};
    if (size < 14 || !himc_midi_is_file(bytes, size))
        return himc_error_set(error, "not a MIDI file: it does not begin with MThd and 6 bytes");
    size_t header = number_of(at + 4, 4);
    reader r = {.format = (int)number_of(at + 8, 2), .error = error};
    if (header < 6 || header > size - 8)
        return himc_error_set(error, "a header of %zu bytes, expected 6 .. %zu", header, size - 8);
    if (r.format > 2)
        return himc_error_set(error, "MIDI format %d, expected 0 .. 2", r.format);
    // the division: ticks per quarter note, or frames per second (as a negative byte) and ticks per
    // frame; 29 frames stand for 29.97
    const uint8_t *division = at + 12;
    bool frames = division[0] & 0x80;
    int rate = 256 - division[0], ticks = frames ? division[1] : (int)number_of(division, 2);
    if (ticks == 0)
        return himc_error_set(error, "a division of 0 ticks, expected 1 or more");
    r.quarter = ticks;
    if (frames)
        r.per_second = (rate == 29 ? 30000.0 / 1001 : rate) * ticks;
    r.timpani = calloc(UINT16_MAX, sizeof *r.timpani);
    bool good = r.timpani || himc_error_set(error, "out of memory");
    good = good && read_tracks(&r, file, at + 8 + header, at + size) && collect(file, &r) &&
           settle_beats(file, &r);
    int promised = (int)number_of(at + 10, 2);
    file->missing = promised > file->tracks ? promised - file->tracks : 0;
    free(r.timpani);
    free(r.events);
    if (!good)
        himc_midi_file_free(file);
    return good;
}

void himc_midi_file_free(midi_file *file)
{
    free(file->notes);
    free(file->tempi);
    free(file->bars);
    free(file->orders);
    free(file->said);
    *file = (midi_file){0};
}
