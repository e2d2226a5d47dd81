/// smf.c: the reader of MIDI files.
///
/// A file is chunks: a header, then tracks of events, each after a delta time in ticks. The tracks
/// are read one by one into one list of the events that matter, sorted by tick; then one pass turns
/// ticks into seconds and note-ons with their note-offs into notes, whose level follows volume,
/// expression and pressure. A held note of timpani that swells is a roll. Each
/// byte is taken through `next_byte`, which knows the end of its chunk; a chunk longer than the
/// file is cut to it. Seconds: t += ticks * us / (1e6 ppqn), in the order of the merged tempo map.
/// Invariant: nothing before `bytes` or from `end` on is read, whatever the lengths in the file
/// say.
#include "midi/smf.h"

#include "base/argument.h"
#include "base/array.h"
#include "base/format.h"
#include "midi/part.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define TIMPANI_PROGRAM 47 // "48 Timpani" of General MIDI, which counts from 1
#define USUAL_TEMPO 500000 // of a file that says nothing (microseconds per quarter note)

typedef enum event_kind {
    NOTE_OFF,
    NOTE_ON,
    PROGRAM,
    CONTROL,
    PRESSURE,
    KEY_PRESSURE,
    TEMPO,
    METER,
    SAID
} event_kind;

enum { VOLUME = 7, EXPRESSION = 11, SUSTAIN = 64 }; // controllers that count

typedef struct event {
    int64_t tick;
    double said;    ///< a dynamic
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
    bool *timpani;      ///< (tracks) of the names
    uint8_t *concert;   ///< (tracks) the key that the name says: what General MIDI lacks; or 0
    uint32_t *player;   ///< (tracks) "Player 2: Xylophone": 1 + that number; or 0
    uint16_t *channels; ///< (tracks) that have notes, a bit each
    himc_error *error;
} reader;

double himc_midi_bpm(const himc_tempo_change *tempi, int count, double beat)
{
    const double same = 1e-6; // (beats)
    while (count > 1 && tempi[1].beat <= beat + same)
        tempi++, count--;
    return tempi[0].bpm;
}

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

// "Player 1: Timpani", "Player 1: Tam-tam": tracks of one player's instruments, as `himc export`
// writes them
static void read_name(reader *r, const uint8_t *text, size_t size)
{
    static const char begin[] = "Player ";
    const size_t most = 4; // digits
    size_t at = sizeof begin - 1, first = at;
    uint32_t number = 0;
    r->timpani[r->track] |= names_timpani(text, size);
    if (size <= at || memcmp(text, begin, at) != 0)
        return;
    for (; at < size && isdigit(text[at]) && at - first < most; at++)
        number = 10 * number + (uint32_t)(text[at] - '0');
    if (at == first || at == size || text[at] != ':')
        return;
    r->player[r->track] = 1 + number;
    r->concert[r->track] = (uint8_t)himc_midi_concert_key((const char *)text, size);
}

// a text that says the nuance and dynamic of the next note of a key
static bool read_said(reader *r, const uint8_t *data, size_t size)
{
    char text[64], word[32], more;
    event e = {.kind = SAID};
    int key;
    if (size >= sizeof text)
        return true;
    memcpy(text, data, size);
    text[size] = '\0';
    if (sscanf(text, "himc %d %31s %lf%c", &key, word, &e.said, &more) != 3 || key < 0 ||
        key > 127 || !(e.said >= 0 && e.said <= 1))
        return true;
    for (e.first = (uint8_t)key; e.second < HIMC_NUANCES; e.second++)
        if (strcmp(word, himc_nuance_name((himc_nuance)e.second)) == 0)
            return add_event(r, &e);
    return true;
}

// a message to a channel, of one data byte or two; `first` has been read
static bool read_message(reader *r, uint8_t first)
{
    enum { OFF = 0x8, ON, KEY_PRESS, CHANGE, SET_PROGRAM, PRESS };
    static const event_kind kinds[] = {
        [OFF] = NOTE_OFF,   [ON] = NOTE_ON,          [KEY_PRESS] = KEY_PRESSURE,
        [CHANGE] = CONTROL, [SET_PROGRAM] = PROGRAM, [PRESS] = PRESSURE};
    int word = r->status >> 4;
    bool two = word != SET_PROGRAM && word != PRESS;
    uint8_t second = two ? next_byte(r) : 0;
    if (r->cut)
        return true;
    if (first > 127 || second > 127)
        return wrong(r, "a data byte above 127");
    event e = {.channel = r->status & 0xf, .first = first, .second = second};
    bool unused = word == CHANGE && first != VOLUME && first != EXPRESSION && first != SUSTAIN;
    if (word > PRESS || unused)
        return true;
    if (word == ON)
        r->channels[r->track] |= (uint16_t)(1 << e.channel);
    e.kind = (uint8_t)(word == ON && second == 0 ? NOTE_OFF : kinds[word]);
    return add_event(r, &e);
}

static bool read_event(reader *r)
{
    enum { EXCLUSIVE = 0xf0, ESCAPE = 0xf7, META = 0xff };
    enum {
        TEXT = 0x01,
        NAME = 0x03,
        END = 0x2f,
        SET_TEMPO = 0x51,
        SET_METER = 0x58
    }; // types of META
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
    if (type == TEXT)
        return read_said(r, data, length);
    if (type == NAME)
        read_name(r, data, length);
    if (type == SET_TEMPO && length >= 3)
        return add_event(r, &(event){.kind = TEMPO, .tempo = number_of(data, 3)});
    if (type == SET_METER && length >= 2 && data[0] > 0 && data[1] < 8)
        return add_event(r, &(event){.kind = METER, .first = data[0], .second = data[1]});
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

// how loud a channel is besides its velocities

typedef struct channel {
    uint8_t program, pressure, key_pressure[128];
    uint8_t control[2], most[2]; ///< volume and expression: now, and the largest in the file
    bool sustain;
    midi_note *sounding[128];
} channel;

/// What a note's level has become.
typedef struct sample {
    int note; ///< its index
    double beat, seconds, level;
} sample;

typedef struct collection {
    channel channel[16];
    sample *samples;
    int count, room;
} collection;

// volume and expression in shares of the channel's largest, as levels are for the mixing desk; a
// key that is pressed goes from its velocity towards the loudest
static double level_of(const channel *c, int key, int velocity)
{
    double level = velocity;
    for (int i = 0; i < 2; i++)
        level *= c->most[i] > 0 ? (double)c->control[i] / c->most[i] : 1;
    int press = c->pressure > c->key_pressure[key] ? c->pressure : c->key_pressure[key];
    return level + (127 - level) * press / 127.0;
}

static void begin_channels(collection *c, const reader *r)
{
    static const uint8_t usual[2] = {100, 127}; // of General MIDI
    for (int k = 0; k < 16; k++)
        memcpy(c->channel[k].control, usual, sizeof usual);
    for (const event *e = r->events; e < r->events + r->count; e++) {
        bool counts = e->kind == CONTROL && e->first != SUSTAIN;
        channel *of = &c->channel[e->channel];
        uint8_t *most = &of->most[e->first == EXPRESSION];
        // what holds before a first change counts, unless that comes at the beginning
        if (counts && *most == 0 && e->tick > 0)
            *most = usual[e->first == EXPRESSION];
        if (counts && e->second > *most)
            *most = e->second;
    }
}

// a controller or a pressure moves: what sounds gets another level
static bool follow_control(collection *c, const midi_file *file, const event *e, double beat,
                           double seconds, himc_error *error)
{
    const int most = 200000; // chosen: as many as a score has strokes
    channel *of = &c->channel[e->channel];
    if (e->kind == CONTROL && e->first == SUSTAIN)
        of->sustain = e->second >= 64;
    else if (e->kind == CONTROL)
        of->control[e->first == EXPRESSION] = e->second;
    else if (e->kind == PRESSURE)
        of->pressure = e->first;
    else
        of->key_pressure[e->first] = e->second;
    if (e->kind == CONTROL && e->first == SUSTAIN)
        return true;
    for (int key = 0; key < 128 && c->count < most; key++) {
        const midi_note *n = of->sounding[key];
        if (!n)
            continue;
        if (!himc_array_grow(&c->samples, c->count, &c->room, sizeof *c->samples, error))
            return false;
        c->samples[c->count++] =
            (sample){(int)(n - file->notes), beat, seconds, level_of(of, key, n->velocity)};
    }
    return true;
}

static void begin_note(midi_file *file, const reader *r, channel *c, const event *e, double beat,
                       double seconds, const event *said)
{
    // a track's name says more than the drum channel, unless it has other channels, too
    bool timpani = r->timpani[e->track] &&
                   (e->channel != MIDI_DRUM_CHANNEL || r->channels[e->track] == 1 << e->channel);
    bool drum = e->channel == MIDI_DRUM_CHANNEL;
    midi_note *note = c->sounding[e->first] = &file->notes[file->note_count++];
    *note =
        (midi_note){.beat = beat,
                    .seconds = seconds,
                    .off = -1,
                    .track = e->track,
                    .player = r->player[e->track] > 0 ? 16 * UINT16_MAX + (int)r->player[e->track]
                                                      : 16 * e->track + e->channel,
                    .channel = e->channel,
                    .key = drum && r->concert[e->track] ? r->concert[e->track] : e->first,
                    .velocity = e->second,
                    .program = c->program,
                    .level = level_of(c, e->first, e->second),
                    .choice = timpani ? MIDI_TIMPANI : MIDI_ANY,
                    .way = {.dynamic = -1, .said = -1, .spot = HIMC_SPOT_NORMAL}};
    if (said && said->tick == e->tick && said->track == e->track) {
        note->way.nuance = (himc_nuance)said->second;
        note->way.said = said->said;
    }
}

static bool add_tempo(midi_file *file, double beat, uint32_t tempo)
{
    double bpm = 60e6 / (tempo ? tempo : 1);
    bool again = file->tempi[file->tempo_count - 1].beat == beat;
    // a score has lines for 10000 changes
    bool good = bpm >= HIMC_BPM_MIN && bpm <= HIMC_BPM_MAX && file->tempo_count <= 10000;
    file->tempo_count += !again;
    file->tempi[file->tempo_count - 1] = (himc_tempo_change){beat, bpm};
    return good;
}

// from events to notes and tempi
static bool collect(midi_file *file, reader *r, collection *c)
{
    file->notes = calloc((size_t)r->count + 1, sizeof *file->notes);
    file->tempi = calloc((size_t)r->count + 1, sizeof *file->tempi);
    if (!file->notes || !file->tempi)
        return himc_error_set(r->error, "out of memory for %d events", r->count);
    if (r->count > 0)
        qsort(r->events, (size_t)r->count, sizeof *r->events, by_tick);
    begin_channels(c, r);
    file->tempi[file->tempo_count++] = (himc_tempo_change){0, 60e6 / USUAL_TEMPO};
    const event *said[128] = {NULL};
    int64_t tick = 0;                                         // where the present tempo began ...
    double beat, seconds = 0, since = 0, tempo = USUAL_TEMPO; // ... and when (s)
    for (const event *e = r->events; e < r->events + r->count; e++) {
        channel *of = &c->channel[e->channel];
        beat = (double)e->tick / r->quarter;
        seconds = r->per_second > 0 ? (double)e->tick / r->per_second
                                    : since + (double)(e->tick - tick) * tempo / (1e6 * r->quarter);
        midi_note **note = &of->sounding[e->first & 127];
        if (e->kind == PROGRAM)
            of->program = e->first;
        if ((e->kind == NOTE_ON || e->kind == NOTE_OFF) && *note) {
            (*note)->off = seconds;
            (*note)->way.ring = of->sustain;
            *note = NULL;
        }
        if (e->kind == NOTE_ON)
            begin_note(file, r, of, e, beat, seconds, said[e->first]);
        if (e->kind == SAID)
            said[e->first] = e;
        if (e->kind >= CONTROL && e->kind <= KEY_PRESSURE &&
            !follow_control(c, file, e, beat, seconds, r->error))
            return false;
        if (e->kind == TEMPO && r->per_second == 0) {
            since = seconds;
            tick = e->tick;
            tempo = e->tempo;
            file->converted |= !add_tempo(file, beat, e->tempo);
        }
    }
    for (int i = 0; i < file->note_count; i++)
        if (file->notes[i].off < 0)
            file->notes[i].off = seconds;
    return true;
}

// swells

static int by_note(const void *a, const void *b)
{
    const sample *x = a, *y = b;
    int later = (x->seconds > y->seconds) - (x->seconds < y->seconds);
    return x->note != y->note ? x->note - y->note : later;
}

static int by_time(const void *a, const void *b)
{
    const midi_note *x = a, *y = b;
    return (x->seconds > y->seconds) - (x->seconds < y->seconds);
}

// the sample that is farthest from the line between the first and the last; 0: all are near it
static int farthest(const sample *s, int count)
{
    double most = 4; // of a velocity; chosen: a quarter of a step
    int found = 0;
    double time = s[count - 1].seconds - s[0].seconds, rise = s[count - 1].level - s[0].level;
    for (int i = 1; i + 1 < count; i++) {
        double share = time > 0 ? (s[i].seconds - s[0].seconds) / time : 0;
        double off = fabs(s[i].level - s[0].level - share * rise);
        found = off > most ? i : found;
        most = fmax(off, most);
    }
    return found;
}

// a roll for each line that the samples lie on; the first is the note itself
static bool add_rolls(midi_file *file, int *room, const sample *s, int count, himc_error *error)
{
    const int most = 64; // of a note; chosen, bounds the time
    const double shortest = himc_argument_find("LENGTH", "roll")->low;
    for (int first = 0, last, bend, made = 0; first + 1 < count; first = last, made++) {
        last = count - 1;
        while (made < most && (bend = farthest(s + first, last - first + 1)) > 0)
            last = first + bend;
        if (s[last].beat - s[first].beat < shortest && (made > 0 || last + 1 < count)) {
            made--; // a jump
            continue;
        }
        if (!himc_array_grow(&file->notes, file->note_count, room, sizeof *file->notes, error))
            return false;
        midi_note n = file->notes[s->note];
        n.way.length = s[last].beat - s[first].beat;
        n.beat = s[first].beat;
        n.seconds = s[first].seconds;
        n.off = s[last].seconds;
        n.level = s[first].level;
        n.last_level = s[last].level;
        n.way.extra = made > 0;
        file->notes[made > 0 ? file->note_count : s->note] = n;
        file->note_count += made > 0;
    }
    return true;
}

static bool is_timpani(const midi_note *n)
{
    return n->choice == MIDI_TIMPANI ||
           (n->channel != MIDI_DRUM_CHANNEL && n->program == TIMPANI_PROGRAM);
}

// a note of timpani that is held while its level rises is a roll: a single stroke cannot swell
static bool find_swells(midi_file *file, const reader *r, collection *c)
{
    const double least = 0.25, longest = 60; // (s) chosen: a score's limit is 180 s
    const double rise = 8;                   // of a velocity; chosen: half a step
    int notes = file->note_count, room = r->count + 1;
    sample *line = malloc(((size_t)c->count + 2) * sizeof *line);
    if (!line)
        return himc_error_set(r->error, "out of memory for %d events", c->count);
    if (c->count > 0)
        qsort(c->samples, (size_t)c->count, sizeof *c->samples, by_note);
    bool good = true;
    for (int i = 0, end; i < c->count && good; i = end) {
        int index = c->samples[i].note, count = 0;
        midi_note n = file->notes[index];
        double low = n.level, up = 0;
        line[count++] = (sample){index, n.beat, n.seconds, n.level};
        for (end = i; end < c->count && c->samples[end].note == index; end++) {
            // one at the beginning is the beginning
            count -= count == 1 && c->samples[end].seconds == n.seconds;
            line[count++] = c->samples[end];
            low = count == 1 ? line[0].level : low;
            low = fmin(low, c->samples[end].level);
            up = fmax(up, c->samples[end].level - low);
        }
        double time = n.off - n.seconds;
        if (!is_timpani(&n) || time < least || time > longest || up < rise)
            continue;
        double off = r->per_second > 0 ? n.off * r->per_second / r->quarter
                                       : himc_score_beat(file->tempi, file->tempo_count, n.off);
        line[count] = (sample){index, off, n.off, line[count - 1].level};
        good = add_rolls(file, &room, line, count + 1, r->error);
    }
    if (file->note_count > notes)
        qsort(file->notes, (size_t)file->note_count, sizeof *file->notes, by_time);
    free(line);
    return good;
}

// bars

static bool place_bars(midi_file *file, const reader *r)
{
    const int most = 60000; // chosen: a day of music
    double last = file->note_count > 0 ? file->notes[file->note_count - 1].beat : 0;
    midi_bar bar = {.beats = 4, .unit = 4};
    double length = 4;
    int room = 0;
    for (const event *e = r->events; bar.beat <= last && file->bar_count < most;) {
        // a meter that changes within a bar begins another one
        midi_bar after = bar;
        after.beat += length;
        for (; e < r->events + r->count && (double)e->tick / r->quarter < after.beat - 1e-6; e++)
            if (e->kind == METER) {
                double at = (double)e->tick / r->quarter;
                bool inside = at > bar.beat + 1e-6;
                length = 4.0 * e->first / (1 << e->second);
                after = (midi_bar){inside ? at : bar.beat + length, e->first, 1 << e->second, ""};
                bar = inside ? bar : (midi_bar){bar.beat, after.beats, after.unit, ""};
            }
        if (!himc_array_grow(&file->bars, file->bar_count, &room, sizeof *file->bars, r->error))
            return false;
        himc_format(bar.number, sizeof bar.number, "%d", file->bar_count + 1);
        file->bars[file->bar_count++] = bar;
        bar = after;
    }
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
        for (int i = 0; i < file->note_count; i++) {
            midi_note *n = &file->notes[i];
            n->beat = n->seconds * bpm / 60;
            n->way.length = n->way.length > 0 ? (n->off - n->seconds) * bpm / 60 : 0;
        }
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
    r.channels = calloc(UINT16_MAX, sizeof *r.channels);
    r.concert = calloc(UINT16_MAX, sizeof *r.concert);
    r.player = calloc(UINT16_MAX, sizeof *r.player);
    collection *c = calloc(1, sizeof *c);
    // a file without events has an address of them, too
    bool good = (himc_array_grow(&r.events, 0, &r.room, sizeof *r.events, NULL) && r.timpani &&
                 r.channels && r.concert && r.player && c) ||
                himc_error_set(error, "out of memory");
    good = good && read_tracks(&r, file, at + 8 + header, at + size) && collect(file, &r, c) &&
           find_swells(file, &r, c) && settle_beats(file, &r) &&
           (file->converted || place_bars(file, &r));
    int promised = (int)number_of(at + 10, 2);
    file->missing = promised > file->tracks ? promised - file->tracks : 0;
    if (c)
        free(c->samples);
    free(c);
    free(r.timpani);
    free(r.channels);
    free(r.concert);
    free(r.player);
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
