/// import.c: from a MIDI file to the text of a score.
///
/// The notes of one part, timpani or drums, get heads (timpani.c, kit.c) and hands (sticking.c);
/// here velocities become dynamics, and all becomes text. Beats are the file's quarter notes and
/// its tempo map is written as it is, so both can be edited; nothing is quantised. A piece that
/// begins sooner than a player can raise the sticks is preceded by whole beats. Invariant: each
/// note of the file is either a stroke of the score, or counted in the report with the reason.
#include "midi/import.h"

#include "base/format.h"
#include "midi/part.h"
#include "plan/gesture.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#define MOST_STROKES 100000 // chosen: more than two hours of rolls
#define LEAST_RING 0.15     // from a stroke to the hand that damps it (s); chosen
#define DAMPING_HAND \
    0.25 // lies on the head so long (s); chosen: twice the decay time of a damped head
#define MOST_CHANGES 9900  // lines of a score besides strokes are 10000
#define PEDAL_STEPS 4      // of a pedal that moves, at most; chosen: heard as a slide
#define LEAD_IN 1.0        // before the first stroke (s); chosen: sticks rise and fall twice
#define TIMPANI_PROGRAM 47 // "48 Timpani" of General MIDI, which counts from 1

// velocities as notation programs write them: ppp 16, then 33 49 64 80 96 112 up to ff, in equal
// steps
#define SOFTEST 16
#define LOUDEST 128

#define LOUDNESS_EXPONENT 1.1 // amplitude grows so with the mallet's speed ...
#define FFF_SPEED 1.39        // ... which at fff is so many times that at f

// text

typedef struct text {
    char *bytes; ///< owned; NULL after memory ran out
    size_t size, room;
    bool lost;
} text;

static void put(text *t, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void put(text *t, const char *format, ...)
{
    char line[256];
    va_list args;
    va_start(args, format);
    size_t length = himc_format_list(line, sizeof line, format, args);
    va_end(args);
    if (t->size + length + 1 > t->room) {
        size_t room = 2 * t->room + sizeof line;
        char *bigger = t->lost ? NULL : realloc(t->bytes, room);
        t->lost |= !bigger;
        if (t->lost)
            return;
        t->bytes = bigger;
        t->room = room;
    }
    memcpy(t->bytes + t->size, line, length + 1);
    t->size += length;
}

// velocities

double himc_midi_dynamic(int velocity, double range)
{
    if (range == 0)
        return fmax(0, fmin((velocity - SOFTEST) / (double)(LOUDEST - SOFTEST), 1));
    // Dannenberg 2006: amplitude = (m v + b)^2, 1 at 127, and `range` less at 1
    double root = sqrt(pow(10, range / 20)), b = 127 / (126 * root) - 1.0 / 126, m = (1 - b) / 127;
    double amplitude = pow(m * velocity + b, 2);
    return himc_gesture_dynamic(pow(amplitude, 1 / LOUDNESS_EXPONENT) * FFF_SPEED);
}

// which notes

static bool is_drum(const midi_note *note)
{
    return note->channel == MIDI_DRUM_CHANNEL;
}

static bool is_timpani(const midi_note *note)
{
    return !is_drum(note) && (note->program == TIMPANI_PROGRAM || note->timpani);
}

static bool wants_timpani(const midi_file *file, midi_choice choice)
{
    if (choice != MIDI_ANY)
        return choice == MIDI_TIMPANI;
    for (int i = 0; i < file->note_count; i++)
        if (is_timpani(&file->notes[i]))
            return true;
    return false;
}

// the notes of the part as strokes
static bool collect(midi_part *part, const midi_file *file, const midi_options *options,
                    himc_error *error)
{
    part->timpani = wants_timpani(file, options->choice);
    part->stroke = calloc((size_t)file->note_count + 1, sizeof *part->stroke);
    if (!part->stroke)
        return himc_error_set(error, "out of memory for %d notes", file->note_count);
    for (int i = 0; i < file->note_count; i++) {
        const midi_note *note = &file->notes[i];
        bool timpani = is_timpani(note), drum = is_drum(note);
        if (part->timpani ? timpani : drum)
            part->stroke[part->count++] =
                (midi_stroke){.note = note,
                              .key = note->key,
                              .spot = HIMC_SPOT_NORMAL,
                              .dynamic = himc_midi_dynamic(note->velocity, options->range),
                              .end = fmax(note->off, note->seconds + LEAST_RING)};
        else
            part->fate[timpani || drum ? MIDI_OTHER_PART : MIDI_OTHER_INSTRUMENT]++;
    }
    return part->count <= MOST_STROKES ||
           himc_error_set(error, "%d notes for drums, expected %d", part->count, MOST_STROKES);
}

// strokes that are played and damped, as many as a score has lines for
static void count_damped(midi_part *part)
{
    int most = (MOST_CHANGES - PEDAL_STEPS * part->pedals) / 2;
    for (int i = 0; i < part->count; i++) {
        midi_stroke *s = &part->stroke[i];
        s->damped = s->damped && s->fate == MIDI_PLAYED && part->damped < most;
        part->damped += s->damped;
    }
}

static bool assign(midi_part *part, himc_error *error)
{
    if (part->timpani && !himc_midi_tune(part, error))
        return false;
    if (!part->timpani)
        himc_midi_kit(part);
    if (!himc_midi_stick(part, error))
        return false;
    for (int i = 0; i < part->count; i++)
        part->fate[part->stroke[i].fate]++;
    count_damped(part);
    if (part->timpani)
        himc_midi_find_rolls(part);
    return true;
}

// the report

static void report_kind(text *t, int count, const char *one, const char *many)
{
    if (count > 0)
        put(t, "%d %s\n", count, count == 1 ? one : many);
}

static void report(text *t, const midi_file *file, const midi_part *part)
{
    static const char *const why[MIDI_FATES][2] = {
        [MIDI_TOGETHER] = {"note is one stroke with another at the same time on its head",
                           "notes are one stroke with another at the same time on their head"},
        [MIDI_NO_DRUM] = {"note is not played: no drum could be tuned to it in time",
                          "notes are not played: no drum could be tuned to them in time"},
        [MIDI_NO_HAND] = {"note is not played: both hands are busy",
                          "notes are not played: both hands are busy"},
        [MIDI_NOT_A_HEAD] = {"note is not played: it is of a cymbal or of wood or metal",
                             "notes are not played: they are of cymbals or of wood or metal"},
        [MIDI_OTHER_INSTRUMENT] = {"note is of another instrument",
                                   "notes are of other instruments"},
    };
    put(t, "%d of %d notes for %s are played\n", part->fate[MIDI_PLAYED], part->count,
        part->timpani ? "timpani" : "drums");
    if (file->cut > 0)
        put(t, "the file is cut short: %d of its tracks can be read up to %.3g s only\n", file->cut,
            file->cut_at);
    report_kind(t, file->missing, "track is missing: the file is cut short or its header is wrong",
                "tracks are missing: the file is cut short or its header is wrong");
    for (int i = 0; i < MIDI_FATES; i++)
        if (why[i][0])
            report_kind(t, part->fate[i], why[i][0], why[i][1]);
    int other = part->fate[MIDI_OTHER_PART];
    if (other > 0)
        put(t, "%d note%s for %s not asked for\n", other, other == 1 ? "" : "s",
            part->timpani ? "drums" : "timpani");
    report_kind(t, part->moved, "note is moved by octaves to C2 .. B3",
                "notes are moved by octaves to C2 .. B3");
    report_kind(t, part->pedals, "change of pitch by pedal", "changes of pitch by pedal");
    if (part->rolls > 0)
        put(t, "%d notes are played as %d roll%s\n", part->rolled, part->rolls,
            part->rolls == 1 ? "" : "s");
    report_kind(t, part->damped, "note is damped at its end", "notes are damped at their end");
    if (file->converted)
        put(t, "the tempo map is not kept: beats are half seconds\n");
}

// the score

// a file's name as a comment's words; what ends a word or a line in Pure Data becomes _
static void put_name(text *t, const char *name)
{
    const char *slash = strrchr(name, '/');
    char shown[64];
    size_t n = 0;
    for (const char *s = slash ? slash + 1 : name; *s && n + 1 < sizeof shown; s++)
        shown[n++] = isalnum((unsigned char)*s) || strchr("-_.", *s) ? *s : '_';
    shown[n] = '\0';
    put(t, "comment made of %s by himc import;\n", shown);
}

static void put_comments(text *t, const char *lines)
{
    for (const char *end; (end = strchr(lines, '\n')); lines = end + 1)
        put(t, "comment %.*s;\n", (int)(end - lines), lines);
}

// whole beats before the file's first, so that there is time before the first stroke
static double lead_in(const midi_file *file, const midi_part *part)
{
    for (int i = 0; i < part->count; i++)
        if (part->stroke[i].fate == MIDI_PLAYED)
            return ceil(fmax(0, LEAD_IN - part->stroke[i].note->seconds) * file->tempi[0].bpm / 60);
    return 0;
}

static double frequency(int key)
{
    return 440 * pow(2, (key - 69) / 12.0);
}

static void put_drums(text *t, const midi_part *part)
{
    for (int i = 0; i < part->heads; i++) {
        const midi_head *head = &part->head[i];
        if (head->key < 0)
            continue;
        put(t, "drum %s %g;\n%s place %g %g %g;\n%s tune %.6g;\n", head->name, head->inches,
            head->name, head->x, head->y, head->z, head->name, frequency(head->key));
    }
}

static void put_tempi(text *t, const midi_file *file, double lead, double last)
{
    for (int i = 0; i < file->tempo_count && file->tempi[i].beat <= last; i++) {
        double beat = file->tempi[i].beat;
        put(t, "tempo %.9g %.9g;\n", file->tempi[i].bpm, beat > 0 ? beat + lead : 0);
    }
}

static void put_stroke(text *t, const midi_part *part, const midi_stroke *s, double lead)
{
    const char *drum = part->head[s->head].name, *spot = himc_spot_name(s->spot);
    double beat = s->note->beat + lead;
    if (s->roll.length > 0)
        put(t, "roll %.9g %.9g single %.3g %.3g %s %s;\n", beat, s->roll.length, s->dynamic,
            s->roll.last_dynamic, spot, drum);
    else
        put(t, "stroke %.9g %s legato %.3g %s %s;\n", beat, himc_hand_name(s->hand), s->dynamic,
            spot, drum);
}

static void put_strokes(text *t, const midi_part *part, double lead)
{
    for (int i = 0; i < part->count; i++)
        if (part->stroke[i].fate == MIDI_PLAYED && !part->stroke[i].in_roll)
            put_stroke(t, part, &part->stroke[i], lead);
}

/// A line of a drum's head.
typedef struct change {
    double seconds;
    int head;
    int key;  ///< tuned to it; -1: damped, or let go
    int damp; ///< 0 or 1
} change;

static int by_time(const void *a, const void *b)
{
    const change *x = a, *y = b;
    return (x->seconds > y->seconds) - (x->seconds < y->seconds);
}

// when the hand leaves the head: before its next stroke, and before its pedal moves; `pedal` is the
// first that begins after the stroke
static double let_go(const midi_part *part, int index, int pedal)
{
    const midi_stroke *s = &part->stroke[index];
    double until = s->end + DAMPING_HAND;
    for (int i = index + 1; i < part->count && part->stroke[i].note->seconds < until; i++)
        if (part->stroke[i].fate == MIDI_PLAYED && part->stroke[i].head == s->head)
            until = part->stroke[i].note->seconds;
    for (; pedal < part->pedals && part->pedal[pedal].seconds < until; pedal++)
        if (part->pedal[pedal].head == s->head && part->pedal[pedal].seconds > s->end)
            until = part->pedal[pedal].seconds;
    return until;
}

static int add_damping(change *list, const midi_part *part)
{
    int count = 0, pedal = 0;
    for (int i = 0; i < part->count; i++) {
        const midi_stroke *s = &part->stroke[i];
        if (!s->damped)
            continue;
        while (pedal < part->pedals && part->pedal[pedal].seconds < s->note->seconds)
            pedal++;
        list[count++] = (change){s->end, s->head, -1, 1};
        list[count++] = (change){let_go(part, i, pedal), s->head, -1, 0};
    }
    return count;
}

// a pedal goes through semitones between, as an undamped drum lets hear
static int add_pedals(change *list, const midi_part *part)
{
    int count = 0;
    for (int k = 0; k < part->pedals; k++) {
        const midi_pedal *p = &part->pedal[k];
        int way = p->to - p->from, steps = abs(way) < PEDAL_STEPS ? abs(way) : PEDAL_STEPS;
        for (int i = 1; i <= steps; i++)
            list[count++] =
                (change){p->seconds + p->length * i / steps, p->head, p->from + way * i / steps, 0};
    }
    return count;
}

static bool put_changes(text *t, const midi_file *file, const midi_part *part, double lead)
{
    change *list = malloc(MOST_CHANGES * sizeof *list);
    if (!list)
        return false;
    int count = add_damping(list, part);
    count += add_pedals(list + count, part);
    qsort(list, (size_t)count, sizeof *list, by_time);
    for (int i = 0; i < count; i++) {
        const change *c = &list[i];
        double beat = himc_score_beat(file->tempi, file->tempo_count, c->seconds) + lead;
        const char *name = part->head[c->head].name;
        if (c->key < 0)
            put(t, "at %.9g %s damp %d;\n", beat, name, c->damp);
        else
            put(t, "at %.9g %s tune %.6g;\n", beat, name, frequency(c->key));
    }
    free(list);
    return true;
}

static bool write_score(midi_score *made, const midi_file *file, const midi_part *part,
                        const char *name, himc_error *error)
{
    text score = {0}, said = {0};
    double lead = lead_in(file, part);
    report(&said, file, part);
    put_name(&score, name);
    if (!said.lost)
        put_comments(&score, said.bytes);
    put(&score, "comment beat 0 of the file is beat %g here;\n\n", lead);
    put_drums(&score, part);
    put_tempi(&score, file, lead, part->stroke[part->count - 1].note->beat);
    put_strokes(&score, part, lead);
    score.lost |= !put_changes(&score, file, part, lead);
    *made = (midi_score){score.bytes, said.bytes,
                         part->count - part->fate[MIDI_PLAYED] - part->fate[MIDI_TOGETHER] +
                             file->cut + file->missing};
    if (!score.lost && !said.lost)
        return true;
    himc_midi_score_free(made);
    return himc_error_set(error, "out of memory for the score");
}

bool himc_midi_import(midi_score *made, const void *bytes, size_t size, const char *name,
                      const midi_options *options, himc_error *error)
{
    static const midi_options usual = {MIDI_ANY, 0};
    midi_file file;
    midi_part part = {0};
    *made = (midi_score){0};
    options = options ? options : &usual;
    if (!himc_midi_file_read(&file, bytes, size, error))
        return false;
    bool good = collect(&part, &file, options, error) && assign(&part, error);
    if (good && part.fate[MIDI_PLAYED] == 0)
        good = himc_error_set(error, "nothing to play: %d note%s, none %s", file.note_count,
                              file.note_count == 1 ? "" : "s",
                              part.timpani ? "of timpani (program 48 or a track of that name)"
                                           : "of a drum (channel 10)");
    good = good && write_score(made, &file, &part, name, error);
    free(part.stroke);
    free(part.pedal);
    himc_midi_file_free(&file);
    return good;
}

void himc_midi_score_free(midi_score *made)
{
    free(made->text);
    free(made->report);
    *made = (midi_score){0};
}
