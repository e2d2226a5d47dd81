/// import.c: from a MIDI file to the text of a score.
///
/// The notes of one part get instruments (timpani.c, kit.c, keyboard.c) and hands (sticking.c);
/// here velocities become dynamics, and all becomes text. Beats are the file's quarter notes and
/// its tempo map is written as it is, so both can be edited; nothing is quantised. A piece that
/// begins sooner than a player can raise the sticks is preceded by whole beats. Invariant: each
/// note of the file is either a stroke of the score, or counted in the report with the reason.
#include "midi/import.h"

#include "base/format.h"
#include "base/text.h"
#include "midi/part.h"
#include "plan/gesture.h"
#include "plan/score.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MOST_STROKES 100000 // chosen: more than two hours of rolls
#define MOST_CHANGES 9900   // lines of a score besides strokes are 10000
#define GAIN (-2.5)         // (dB) chosen: zarathustra.mid has -23 LUFS, as broadcast
#define PEDAL_STEPS 4       // of a pedal that moves, at most; chosen: heard as a slide

static void put(himc_text_lines *text, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

static void put(himc_text_lines *text, const char *format, ...)
{
    char line[256];
    va_list args;
    va_start(args, format);
    size_t length = himc_format_list(line, sizeof line, format, args);
    va_end(args);
    if (!himc_text_reserve(text, length)) {
        text->failed = true;
        return;
    }
    memcpy(text->bytes + text->size, line, length + 1);
    text->size += length;
}

double himc_midi_dynamic(int velocity, double range)
{
    // as notation programs write them: ppp 16, then 33 49 64 80 96 112 up to ff, in equal steps
    if (range == 0)
        return fmax(0, fmin((velocity - 16) / 112.0, 1));
    // Dannenberg 2006: amplitude = (m v + b)^2, 1 at 127, and `range` less at 1
    double root = sqrt(pow(10, range / 20)), b = 127 / (126 * root) - 1.0 / 126, m = (1 - b) / 127;
    double amplitude = pow(m * velocity + b, 2);
    // it grows with the power 1.1 of the mallet's speed, which at fff is 1.39 times that at f
    return himc_gesture_dynamic(pow(amplitude, 1 / 1.1) * 1.39);
}

// which notes

static const char *const names[MIDI_CHOICES] = {"",          "timpani",    "drums",       "marimba",
                                                "xylophone", "vibraphone", "glockenspiel"};

const char *himc_midi_choice_name(midi_choice choice)
{
    return names[choice];
}

static midi_choice choice_of(const midi_note *note)
{
    const int program = 47; // "48 Timpani" of General MIDI, which counts from 1
    if (note->channel == MIDI_DRUM_CHANNEL)
        return MIDI_DRUMS;
    if (note->program == program || note->timpani)
        return MIDI_TIMPANI;
    for (int i = 0; i < MIDI_CHOICES; i++)
        if (himc_midi_is_keyboard((midi_choice)i, note->program))
            return (midi_choice)i;
    return MIDI_ANY;
}

static midi_choice first_choice(const midi_file *file)
{
    midi_choice first = MIDI_CHOICES;
    for (int i = 0; i < file->note_count; i++) {
        midi_choice c = choice_of(&file->notes[i]);
        first = c != MIDI_ANY && c < first ? c : first;
    }
    return first == MIDI_CHOICES ? MIDI_DRUMS : first;
}

static bool give_instruments(midi_part *part, himc_error *error)
{
    if (part->choice == MIDI_TIMPANI)
        return himc_midi_tune(part, error);
    if (part->choice == MIDI_DRUMS)
        himc_midi_kit(part);
    else if (part->count > 0)
        himc_midi_keyboard(part);
    return true;
}

// the notes of the part as strokes with heads and hands
static bool make_part(midi_part *part, const midi_file *file, const midi_options *options,
                      himc_error *error)
{
    part->choice = options->choice == MIDI_ANY ? first_choice(file) : options->choice;
    part->stroke = calloc((size_t)file->note_count + 1, sizeof *part->stroke);
    if (!part->stroke)
        return himc_error_set(error, "out of memory for %d notes", file->note_count);
    for (int i = 0; i < file->note_count; i++) {
        const midi_note *note = &file->notes[i];
        midi_choice choice = choice_of(note);
        double damped = note->seconds + 0.15; // by a hand at the earliest (s); chosen
        if (choice == part->choice)
            part->stroke[part->count++] =
                (midi_stroke){.note = note,
                              .key = note->key,
                              .spot = HIMC_SPOT_NORMAL,
                              .dynamic = himc_midi_dynamic(note->velocity, options->range),
                              .end = fmax(note->off, damped)};
        else
            part->fate[choice != MIDI_ANY ? MIDI_OTHER_PART : MIDI_OTHER_INSTRUMENT]++;
    }
    if (part->setup && part->choice != MIDI_DRUMS)
        return himc_error_set(error,
                              "a set-up is for drums, expected none: %s has instruments of "
                              "its own",
                              himc_midi_choice_name(part->choice));
    if (part->count > MOST_STROKES)
        return himc_error_set(error, "%d notes for drums, expected %d", part->count, MOST_STROKES);
    if (!give_instruments(part, error) || !himc_midi_stick(part, error))
        return false;
    // a score has lines for so many damped strokes
    int most_damped = (MOST_CHANGES - PEDAL_STEPS * part->pedals) / 2;
    for (int i = 0; i < part->count; i++) {
        midi_stroke *s = &part->stroke[i];
        part->fate[s->fate]++;
        s->damped = s->damped && s->fate == MIDI_PLAYED && part->damped < most_damped;
        part->damped += s->damped;
    }
    if (part->choice == MIDI_TIMPANI)
        himc_midi_find_rolls(part);
    return true;
}

// the report

static void report_kind(himc_text_lines *t, int count, const char *one, const char *many)
{
    if (count > 0)
        put(t, "%d %s\n", count, count == 1 ? one : many);
}

static void report(himc_text_lines *t, const midi_file *file, const midi_part *part)
{
    static const char *const why[MIDI_FATES][2] = {
        [MIDI_TOGETHER] = {"note is one stroke with another at the same time on its head",
                           "notes are one stroke with another at the same time on their head"},
        [MIDI_NO_DRUM] = {"note is not played: no drum could be tuned to it in time",
                          "notes are not played: no drum could be tuned to them in time"},
        [MIDI_NO_HAND] = {"note is not played: both hands are busy",
                          "notes are not played: both hands are busy"},
        [MIDI_NO_INSTRUMENT] = {"note is not played: there is no instrument for it",
                                "notes are not played: there is no instrument for them"},
        [MIDI_OTHER_INSTRUMENT] = {"note is of another instrument",
                                   "notes are of other instruments"},
    };
    put(t, "%d of %d notes for %s are played\n", part->fate[MIDI_PLAYED], part->count,
        himc_midi_choice_name(part->choice));
    if (file->cut > 0)
        put(t, "the file is cut short: %d of its tracks can be read up to %.3g s only\n", file->cut,
            file->cut_at);
    report_kind(t, file->missing, "track is missing: the file is cut short or its header is wrong",
                "tracks are missing: the file is cut short or its header is wrong");
    for (int i = 0; i < MIDI_FATES; i++)
        if (why[i][0])
            report_kind(t, part->fate[i], why[i][0], why[i][1]);
    report_kind(t, part->fate[MIDI_OTHER_PART], "note for other percussion is not asked for",
                "notes for other percussion are not asked for");
    char line[100];
    for (int key = 0; key < 128 && part->choice == MIDI_DRUMS; key++)
        if (himc_midi_tell_key(part, key, line, sizeof line) > 0 && line[0])
            put(t, "%s\n", line);
    report_kind(t, part->moved, "note is moved by octaves to what is built",
                "notes are moved by octaves to what is built");
    report_kind(t, part->pedals, "change of pitch by pedal", "changes of pitch by pedal");
    if (part->rolls > 0)
        put(t, "%d notes are played as %d roll%s\n", part->rolled, part->rolls,
            part->rolls == 1 ? "" : "s");
    report_kind(t, part->damped, "note is damped at its end", "notes are damped at their end");
    if (file->converted)
        put(t, "the tempo map is not kept: beats are half seconds\n");
}

// the score

static double frequency(int key)
{
    return 440 * pow(2, (key - 69) / 12.0);
}

/// A line of a drum's head.
typedef struct change {
    double seconds;
    int head;
    int key;          ///< tuned to it; -1: the command
    const char *does; ///< command and number
} change;

static int by_time(const void *a, const void *b)
{
    const change *x = a, *y = b;
    return (x->seconds > y->seconds) - (x->seconds < y->seconds);
}

static bool put_changes(himc_text_lines *t, const midi_file *file, const midi_part *part,
                        double lead)
{
    change *list = malloc(MOST_CHANGES * sizeof *list);
    if (!list)
        return false;
    int count = 0, pedal = 0;
    // a damping hand lies on the head for 0.25 s (chosen: twice the decay time of a damped head),
    // and is off before the head's next stroke and before its pedal moves
    for (int i = 0; i < part->count; i++) {
        const midi_stroke *s = &part->stroke[i];
        if (!s->damped)
            continue;
        double until = s->end + 0.25;
        for (int k = i + 1; k < part->count && part->stroke[k].note->seconds < until; k++)
            if (part->stroke[k].fate == MIDI_PLAYED && part->stroke[k].head == s->head)
                until = part->stroke[k].note->seconds;
        while (pedal < part->pedals && part->pedal[pedal].seconds < s->note->seconds)
            pedal++;
        for (int k = pedal; k < part->pedals && part->pedal[k].seconds < until; k++)
            if (part->pedal[k].head == s->head && part->pedal[k].seconds > s->end)
                until = part->pedal[k].seconds;
        list[count++] = (change){s->end, s->head, -1, "damp 1"};
        list[count++] = (change){until, s->head, -1, "damp 0"};
    }
    // a pedal goes through semitones between, as an undamped drum lets hear
    for (int k = 0; k < part->pedals; k++) {
        const midi_pedal *p = &part->pedal[k];
        int way = p->to - p->from, steps = abs(way) < PEDAL_STEPS ? abs(way) : PEDAL_STEPS;
        for (int i = 1; i <= steps; i++)
            list[count++] = (change){p->seconds + p->length * i / steps, p->head,
                                     p->from + way * i / steps, NULL};
    }
    // a hi-hat's foot moves just before the stroke (s), chosen
    midi_opening last = MIDI_AS_IT_IS;
    for (int i = 0; i < part->count && count < MOST_CHANGES; i++) {
        const midi_stroke *s = &part->stroke[i];
        if (s->fate != MIDI_PLAYED || s->pedal == MIDI_AS_IT_IS || s->pedal == last)
            continue;
        last = s->pedal;
        list[count++] = (change){fmax(s->note->seconds - 0.03, 0), s->head, -1,
                                 last == MIDI_OPEN ? "pedal 0" : "pedal 1"};
    }
    qsort(list, (size_t)count, sizeof *list, by_time);
    for (int i = 0; i < count; i++) {
        const change *c = &list[i];
        double beat = himc_score_beat(file->tempi, file->tempo_count, c->seconds) + lead;
        const char *name = part->head[c->head].name;
        if (c->key < 0)
            put(t, "at %.9g %s %s;\n", beat, name, c->does);
        else
            put(t, "at %.9g %s tune %.6g;\n", beat, name, frequency(c->key));
    }
    free(list);
    return true;
}

// the instruments: those of a set-up, or each that is used
static void put_instruments(himc_text_lines *score, const midi_part *part, const char *setup)
{
    if (setup)
        put(score, "setup %s;\n", setup);
    for (int i = 0; i < part->heads && !setup; i++) {
        const midi_head *h = &part->head[i];
        if (h->key == -1)
            continue;
        if (h->made[0])
            put(score, "instrument %s %s;\n", h->name, h->made);
        else
            put(score, "drum %s %g;\n", h->name, h->inches);
        put(score, "%s place %g %g %g %g;\n", h->name, h->x, h->y, h->z, h->tilt);
        if (h->key >= 0)
            put(score, "%s tune %.6g;\n", h->name, frequency(h->key));
    }
}

static bool write_score(midi_score *made, const midi_file *file, const midi_part *part,
                        const char *name, const char *setup, himc_error *error)
{
    himc_text_lines score = {0}, said = {0};
    // whole beats before the file's first, so that the first stroke comes 1 s later at the earliest
    // (chosen: sticks rise and fall twice)
    int first = 0;
    while (part->stroke[first].fate != MIDI_PLAYED)
        first++;
    double wait = fmax(0, 1.0 - part->stroke[first].note->seconds);
    double lead = ceil(wait * file->tempi[0].bpm / 60);
    double last = part->stroke[part->count - 1].note->beat;
    report(&said, file, part);
    // the file's name as a word: what ends a word or a line in Pure Data becomes _
    const char *slash = strrchr(name, '/');
    char shown[64];
    snprintf(shown, sizeof shown, "%s", slash ? slash + 1 : name);
    for (char *s = shown; *s; s++)
        *s = isalnum((unsigned char)*s) || strchr("-_.", *s) ? *s : '_';
    put(&score, "comment made of %s by himc import;\n", shown);
    const char *line = said.failed ? "" : said.bytes;
    for (const char *end; (end = strchr(line, '\n')); line = end + 1)
        put(&score, "comment %.*s;\n", (int)(end - line), line);
    put(&score, "comment beat 0 of the file is beat %g here;\n\n", lead);
    put_instruments(&score, part, setup);
    put(&score, "gain %g;\n", GAIN);
    for (int i = 0; i < file->tempo_count && file->tempi[i].beat <= last; i++) {
        double beat = file->tempi[i].beat;
        put(&score, "tempo %.9g %.9g;\n", file->tempi[i].bpm, beat > 0 ? beat + lead : 0);
    }
    for (int i = 0; i < part->count; i++) {
        const midi_stroke *s = &part->stroke[i];
        if (s->fate != MIDI_PLAYED || s->in_roll)
            continue;
        const char *drum = part->head[s->head].name, *spot = himc_spot_name(s->spot);
        double beat = s->note->beat + lead;
        if (s->roll.length > 0)
            put(&score, "roll %.9g %.9g single %.3g %.3g %s %s;\n", beat, s->roll.length,
                s->dynamic, s->roll.last_dynamic, spot, drum);
        else
            put(&score, "stroke %.9g %s legato %.3g %s %s%s%s;\n", beat, himc_hand_name(s->hand),
                s->dynamic, spot, s->part, s->part[0] ? " " : "", drum);
    }
    score.failed |= !put_changes(&score, file, part, lead);
    *made = (midi_score){score.bytes, said.bytes,
                         part->count - part->fate[MIDI_PLAYED] - part->fate[MIDI_TOGETHER] +
                             file->cut + file->missing};
    if (!score.failed && !said.failed)
        return true;
    himc_midi_score_free(made);
    return himc_error_set(error, "out of memory for the score");
}

// the instruments of a set-up that is asked for; true without one
static bool read_setup(midi_part *part, const midi_options *options, himc_error *error)
{
    himc_command setup;
    himc_atom atom = {HIMC_ATOM_SYMBOL, 0, options->setup};
    if (!options->setup)
        return true;
    if (strpbrk(options->setup, " \t\n;,\\"))
        return himc_error_set(error, "setup: %s: a score cannot name it, expected no space ; , \\",
                              options->setup);
    if (!himc_command_parse(&setup, HIMC_PERFORMER, "setup", &atom, 1, error))
        return false;
    part->setup = himc_score_of_setup(&setup, error);
    return part->setup;
}

bool himc_midi_import(midi_score *made, const void *bytes, size_t size, const char *name,
                      const midi_options *options, himc_error *error)
{
    static const midi_options usual = {MIDI_ANY, 0, NULL};
    midi_file file;
    midi_part part = {0};
    *made = (midi_score){0};
    options = options ? options : &usual;
    if (!himc_midi_file_read(&file, bytes, size, error))
        return false;
    bool good = read_setup(&part, options, error) && make_part(&part, &file, options, error);
    if (good && part.fate[MIDI_PLAYED] == 0)
        good = himc_error_set(error, "nothing to play: %d note%s, none %s", file.note_count,
                              file.note_count == 1 ? "" : "s",
                              part.choice == MIDI_TIMPANI
                                  ? "of timpani (program 48 or a track of that name)"
                              : part.choice == MIDI_DRUMS ? "of a drum (channel 10)"
                                                          : "of that keyboard");
    good = good && write_score(made, &file, &part, name, options->setup, error);
    himc_score_free(part.setup);
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
