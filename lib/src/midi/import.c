/// import.c: from a MIDI file to the text of a score.
///
/// The notes of one part get instruments (timpani.c, kit.c, keyboard.c) and hands (sticking.c);
/// here velocities become dynamics, and all becomes text. Beats are the file's quarter notes and
/// its tempo map is written as it is, so both can be edited; nothing is quantised. A piece that
/// begins sooner than a player can raise the sticks is preceded by whole beats. Invariant: each
/// note of the file is either a stroke of the score, or counted in the report with the reason.
#include "midi/import.h"

#include "base/format.h"
#include "base/head_frame.h"
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
#define LONGEST_GLISS 10.0  // (s) as the command `gliss` takes

// as notation programs write them: ppp 16, then 33 49 64 80 96 112 up to ff, in equal steps
double himc_midi_velocity(double dynamic)
{
    return 16 + 112 * dynamic;
}

double himc_midi_dynamic(double velocity, double range)
{
    if (range == 0)
        return fmax(0, fmin((velocity - 16) / 112.0, 1));
    // Dannenberg 2006: amplitude = (m v + b)^2, 1 at 127, and `range` less at 1
    double root = sqrt(pow(10, range / 20)), b = 127 / (126 * root) - 1.0 / 126, m = (1 - b) / 127;
    double amplitude = pow(m * velocity + b, 2);
    // it grows with the power 1.1 of the mallet's speed, which at fff is 1.39 times that at f
    return himc_gesture_dynamic(pow(amplitude, 1 / 1.1) * 1.39);
}

// of a stroke of one nuance: the dynamic at which one of another is as fast
static double same_speed(himc_nuance from, himc_nuance to, double dynamic)
{
    return from == to ? dynamic : himc_gesture_dynamic_at(to, himc_gesture_of(from, dynamic).speed);
}

double himc_midi_played_velocity(himc_nuance nuance, double dynamic)
{
    double velocity = himc_midi_velocity(same_speed(nuance, HIMC_LEGATO, dynamic));
    return fmin(fmax(velocity, 1), 127);
}

// of a note of MIDI, whose file may say how it was meant: so if its velocity is still that
static double dynamic_of(const midi_note *note, double range)
{
    const midi_way *way = &note->way;
    double said = himc_midi_played_velocity(way->nuance, way->said);
    if (way->said >= 0 && range == 0 && lround(said) == note->velocity)
        return way->said;
    return fmax(same_speed(HIMC_LEGATO, way->nuance, himc_midi_dynamic(note->level, range)), 0);
}

// which notes

static const char *const names[MIDI_CHOICES] = {
    "", "timpani", "drums", "marimba", "xylophone", "vibraphone", "glockenspiel", "tubular-bell"};

const char *himc_midi_choice_name(midi_choice choice)
{
    return names[choice];
}

static midi_choice choice_of(const midi_note *note)
{
    if (note->choice != MIDI_ANY)
        return note->choice;
    if (note->channel == MIDI_DRUM_CHANNEL)
        return MIDI_DRUMS;
    return himc_midi_program_choice(note->program);
}

// MIDI_ANY of a note that is not asked for, too
static midi_choice asked_choice(const midi_note *note, const midi_options *options)
{
    bool asked = (options->track == 0 || options->track == note->track + 1) &&
                 (options->channel == 0 || options->channel == note->channel + 1);
    return !asked ? MIDI_ANY : options->as != MIDI_ANY ? options->as : choice_of(note);
}

#define KIND(choice) (1u << (choice))

/// Who plays which kinds.
typedef struct cast {
    uint8_t *kinds; ///< a bit each, by player; owned
    midi_choice first;
    int leader; ///< the first player of that kind
} cast;

static bool list_cast(cast *c, const midi_file *file, const midi_options *options)
{
    int players = 0;
    for (int i = 0; i < file->note_count; i++)
        players = file->notes[i].player >= players ? file->notes[i].player + 1 : players;
    *c = (cast){.kinds = calloc((size_t)players + 1, 1), .first = MIDI_CHOICES};
    for (int i = 0; i < file->note_count && c->kinds; i++) {
        const midi_note *note = &file->notes[i];
        midi_choice choice = asked_choice(note, options);
        if (choice == MIDI_ANY)
            continue;
        c->kinds[note->player] |= KIND(choice);
        if (choice < c->first || (choice == c->first && note->player < c->leader))
            c->leader = note->player;
        c->first = choice < c->first ? choice : c->first;
    }
    c->first = c->first == MIDI_CHOICES ? MIDI_DRUMS : c->first;
    return c->kinds;
}

// all of one player, and of others who play that kind alone
static bool is_taken(const cast *c, const midi_note *note, midi_choice choice,
                     const midi_options *options)
{
    if (choice == MIDI_ANY || options->choice != MIDI_ANY)
        return choice != MIDI_ANY && choice == options->choice;
    return options->all || note->player == c->leader || c->kinds[note->player] == KIND(c->first);
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

static void take_note(midi_part *part, const midi_note *note, const midi_options *options)
{
    const midi_way *way = &note->way;
    bool written = way->dynamic >= 0;
    double damped = note->seconds + 0.15; // by a hand at the earliest (s); chosen
    part->notes += !way->extra;
    bool beyond = part->choice != MIDI_DRUMS && himc_spot_is_beyond(way->spot);
    part->hoopless += beyond;
    part->stroke[part->count++] = (midi_stroke){
        .note = note,
        .choice = part->choice,
        .key = options->as_key > 0 ? options->as_key : note->key,
        .spot = beyond ? HIMC_SPOT_NORMAL : way->spot,
        .dynamic = written ? way->dynamic : dynamic_of(note, options->range),
        .end = fmax(note->off, damped),
        .roll = {way->length,
                 written ? way->last_dynamic : himc_midi_dynamic(note->last_level, options->range),
                 himc_score_seconds(part->file->tempi, part->file->tempo_count,
                                    note->beat + way->length)}};
}

// counts what is not for the part
static void list_notes(midi_part *part, const cast *c, const midi_options *options)
{
    for (int i = 0; i < part->file->note_count; i++) {
        const midi_note *note = &part->file->notes[i];
        midi_choice choice = asked_choice(note, options), drum = choice_of(note);
        bool taken = is_taken(c, note, choice, options);
        part->kinds |= taken ? KIND(choice) : 0;
        part->others |= !taken && drum != MIDI_ANY ? KIND(drum) : 0;
        if (!taken)
            part->fate[drum != MIDI_ANY ? MIDI_OTHER_PART : MIDI_OTHER_INSTRUMENT] +=
                !note->way.extra;
    }
}

// the last bar that begins at or before a beat; NULL: none
static const midi_bar *bar_at(const midi_file *file, double beat)
{
    int low = 0, high = file->bar_count;
    while (low < high) {
        int middle = (low + high) / 2;
        if (file->bars[middle].beat <= beat + 1e-6)
            low = middle + 1;
        else
            high = middle;
    }
    return low > 0 ? &file->bars[low - 1] : NULL;
}

// a part of a roll without the part before it is left out, too, and so are the strokes in it
static void drop_rests(midi_part *part)
{
    // of the last part of a roll of each key
    midi_fate fates[MIDI_CHOICES][MIDI_KEY_COUNT] = {{MIDI_PLAYED}};
    for (int i = 0; i < part->count; i++) {
        midi_stroke *s = &part->stroke[i];
        midi_fate *fate = &fates[s->choice][s->key];
        if (s->roll.length <= 0 && !s->in_roll)
            continue;
        if ((s->note->way.extra || s->in_roll) && *fate != MIDI_PLAYED)
            s->fate = *fate;
        *fate = s->fate;
    }
}

// a score has lines for so many damped strokes
static void count_fates(midi_part *part)
{
    int most_damped = (MOST_CHANGES - part->pedals) / 2;
    for (int i = 0; i < part->count; i++) {
        midi_stroke *s = &part->stroke[i];
        const midi_bar *bar = bar_at(part->file, s->note->beat);
        bool extra = s->note->way.extra;
        bool lost = extra && (s->fate == MIDI_NO_HAND || s->fate == MIDI_NO_DRUM);
        midi_fate fate = lost ? MIDI_LOST_STROKE : s->fate;
        part->fate[fate] += !extra || lost;
        if (bar && (!extra || lost))
            himc_text_list(part->bars[fate], sizeof part->bars[0], bar->number);
        s->damped = s->damped && s->fate == MIDI_PLAYED && part->damped < most_damped;
        part->damped += s->damped;
        bool played = s->fate == MIDI_PLAYED, roll = s->roll.length > 0 && played;
        part->rolls += roll;
        part->rolled += (roll || (played && (s->in_roll || s->note->way.begins_roll))) && !extra;
    }
}

// instruments of one kind, with their strokes and pedals, join those of others
static void join_kind(midi_part *whole, const midi_part *own)
{
    int at[MIDI_HEADS] = {0};
    for (int i = 0; i < own->heads; i++) {
        at[i] = whole->heads;
        if (own->head[i].key == -1)
            continue;
        whole->head[whole->heads] = own->head[i];
        whole->head[whole->heads++].choice = own->choice;
    }
    for (int i = 0; i < own->count; i++)
        own->stroke[i].head = own->stroke[i].head < 0 ? -1 : at[own->stroke[i].head];
    for (int i = 0; i < own->pedals; i++)
        own->pedal[i].head = at[own->pedal[i].head];
    whole->pedals += own->pedals;
    whole->count += own->count;
    whole->notes += own->notes;
    whole->moved += own->moved;
    whole->octaves[own->choice] = own->octaves[own->choice];
    whole->untuned += own->untuned;
    whole->hoopless += own->hoopless;
}

// the strokes of one kind
static bool add_kind(midi_part *whole, midi_choice kind, const cast *c, const midi_options *options,
                     himc_error *error)
{
    const midi_file *file = whole->file;
    midi_part own = {.file = file,
                     .choice = kind,
                     .setup = whole->setup,
                     .taken = whole->heads,
                     .stroke = whole->stroke + whole->count};
    for (int i = 0; i < file->note_count; i++) {
        midi_choice choice = asked_choice(&file->notes[i], options);
        if (choice == kind && is_taken(c, &file->notes[i], choice, options))
            take_note(&own, &file->notes[i], options);
    }
    int count = whole->count + own.count;
    if (count > MOST_STROKES)
        return himc_error_set(error, "%d notes for drums, expected %d", count, MOST_STROKES);
    bool good = give_instruments(&own, error);
    if (own.pedal)
        whole->pedal = own.pedal;
    if (good && kind == MIDI_TIMPANI && !file->said)
        himc_midi_find_rolls(&own);
    for (int i = 0; i < own.count && kind != MIDI_TIMPANI; i++)
        own.stroke[i].damped = own.stroke[i].note->way.ring < 0;
    if (good)
        join_kind(whole, &own);
    return good;
}

static int by_note(const void *a, const void *b)
{
    const midi_stroke *x = a, *y = b;
    return (x->note > y->note) - (x->note < y->note);
}

// a drum set stands as usual; other instruments are put around the player
static bool is_spread(const midi_part *part)
{
    bool kick = false, hats = false;
    for (int i = 0; i < part->heads; i++) {
        kick |= strcmp(part->head[i].name, "kick") == 0;
        hats |= strcmp(part->head[i].name, "hats") == 0;
    }
    bool several = part->kinds != KIND(part->choice),
         drums = part->choice == MIDI_DRUMS && !part->setup && part->heads > 1;
    return several || (drums && !(kick && hats));
}

// the notes of the part as strokes with heads and hands
static bool make_part(midi_part *part, const midi_file *file, const midi_options *options,
                      himc_error *error)
{
    cast c;
    bool good = list_cast(&c, file, options);
    part->file = file;
    part->choice = options->choice == MIDI_ANY ? c.first : options->choice;
    part->stroke = calloc((size_t)file->note_count + 1, sizeof *part->stroke);
    good = good && part->stroke;
    if (!good)
        himc_error_set(error, "out of memory for %d notes", file->note_count);
    else
        list_notes(part, &c, options);
    for (int i = 1; i < MIDI_CHOICES && good && part->setup; i++)
        if (i != MIDI_DRUMS && (part->kinds | KIND(part->choice)) & KIND(i))
            good = himc_error_set(
                error, "a set-up is for drums, expected none: %s has instruments of its own",
                names[i]);
    // drums come last: they take what room there is
    for (int i = 1; i < MIDI_CHOICES && good; i++) {
        midi_choice kind = (midi_choice)(i == 1 ? 1 : i < MIDI_CHOICES - 1 ? i + 1 : MIDI_DRUMS);
        good = !(part->kinds & KIND(kind)) || add_kind(part, kind, &c, options, error);
    }
    free(c.kinds);
    if (good && part->count > 0 && is_spread(part)) {
        qsort(part->stroke, (size_t)part->count, sizeof *part->stroke, by_note);
        himc_midi_lay_out(part);
    }
    if (!good || !himc_midi_stick(part, error))
        return false;
    drop_rests(part);
    count_fates(part);
    return true;
}

// true of words that are for a kind of the part
static bool is_mine(const midi_part *part, const midi_order *o)
{
    return o->choice == MIDI_ANY || (part->kinds & KIND(o->choice));
}

static bool has_wires(const midi_head *head)
{
    return strncmp(head->made[0] ? head->made : head->name, "snare", 5) == 0;
}

// words about snare wires that no drum of the part has
static int count_wireless(const midi_part *part)
{
    int count = 0;
    for (int h = 0; h < part->heads; h++)
        if (has_wires(&part->head[h]))
            return 0;
    for (int i = 0; i < part->file->order_count; i++) {
        const midi_order *o = &part->file->orders[i];
        count += o->kind == MIDI_WIRES && is_mine(part, o);
    }
    return count;
}

// the report

static void report_kind(himc_text_lines *t, int count, const char *one, const char *many)
{
    if (count > 0)
        himc_text_print(t, "%d %s\n", count, count == 1 ? one : many);
}

static void report_fate(himc_text_lines *t, const midi_part *part, midi_fate fate,
                        const char *const why[2])
{
    int count = part->fate[fate];
    const char *bars = part->bars[fate], *text = why[count != 1];
    if (count > 0 && bars[0])
        himc_text_print(t, "%d %s (bar%s %s)\n", count, text, strchr(bars, ' ') ? "s" : "", bars);
    else
        report_kind(t, count, text, text);
}

// names of kinds, a bit each
static const char *list_names(char *line, size_t size, unsigned kinds)
{
    *line = '\0';
    for (int i = 1; i < MIDI_CHOICES; i++)
        if (kinds & KIND(i))
            himc_text_list(line, size, names[i]);
    return line;
}

static void report_octaves(himc_text_lines *t, const midi_part *part)
{
    for (int i = 1; i < MIDI_CHOICES; i++)
        if (part->octaves[i])
            himc_text_print(t, "all notes for %s are moved %s by %d octave%s to what is built\n",
                            names[i], part->octaves[i] > 0 ? "up" : "down", abs(part->octaves[i]),
                            abs(part->octaves[i]) == 1 ? "" : "s");
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
        [MIDI_LOST_STROKE] = {"stroke of a tremolo, roll or grace is not played: no hand or drum "
                              "is free",
                              "strokes of tremolos, rolls and graces are not played: no hand or "
                              "drum is free"},
        [MIDI_NO_INSTRUMENT] = {"note is not played: there is no instrument for it",
                                "notes are not played: there is no instrument for them"},
        [MIDI_FOOT_ROLL] = {"roll is not played: a foot plays none",
                            "rolls are not played: a foot plays none"},
        [MIDI_OTHER_INSTRUMENT] = {"note is of another instrument",
                                   "notes are of other instruments"},
    };
    char line[100];
    himc_text_print(t, "%d of %d notes for %s are played\n", part->fate[MIDI_PLAYED], part->notes,
                    list_names(line, sizeof line, part->kinds));
    report_kind(t, file->missing, "track is missing: the file is cut short or its header is wrong",
                "tracks are missing: the file is cut short or its header is wrong");
    for (int i = 0; i < MIDI_FATES; i++)
        if (why[i][0])
            report_fate(t, part, (midi_fate)i, why[i]);
    if (file->said)
        himc_text_print(t, "%s", file->said);
    if (part->fate[MIDI_OTHER_PART] > 0)
        himc_text_print(t, "%d note%s not asked for: %s\n", part->fate[MIDI_OTHER_PART],
                        part->fate[MIDI_OTHER_PART] == 1 ? " for other percussion is"
                                                         : "s for other percussion are",
                        list_names(line, sizeof line, part->others));
    for (int key = 0; key < MIDI_KEY_COUNT; key++)
        if (himc_midi_tell_key(part, key, line, sizeof line) > 0 && line[0])
            himc_text_print(t, "%s\n", line);
    report_octaves(t, part);
    report_kind(t, part->moved, "note is moved by octaves to what is built",
                "notes are moved by octaves to what is built");
    report_kind(t, part->pedals, "change of pitch by pedal", "changes of pitch by pedal");
    if (part->rolls > 0)
        himc_text_print(t, "%d note%s played as %d roll%s\n", part->rolled,
                        part->rolled == 1 ? " is" : "s are", part->rolls,
                        part->rolls == 1 ? "" : "s");
    report_kind(t, part->untuned,
                "word about tuning is not followed: no drum has that pitch and time",
                "words about tuning are not followed: no drum has that pitch and time");
    report_kind(t, part->mallets, "change of mallets is not played: a score has one pair",
                "changes of mallets are not played: a score has one pair");
    report_kind(t, part->hoopless,
                "stroke is played at its usual place: the instrument has no hoop or shell",
                "strokes are played at their usual place: the instrument has no hoop or shell");
    report_kind(t, count_wireless(part),
                "word about snares is not followed: no drum of the part has any",
                "words about snares are not followed: no drum of the part has any");
    report_kind(t, part->damped, "note is damped at its end", "notes are damped at their end");
    if (file->converted)
        himc_text_print(t, "the tempo map is not kept: beats are half seconds\n");
}

// the score

/// A line of a drum's head.
typedef struct change {
    double seconds;
    int head;
    const char *does;        ///< command and number; NULL: a gliss
    const midi_pedal *pedal; ///< of a gliss
} change;

static int by_time(const void *a, const void *b)
{
    const change *x = a, *y = b;
    return (x->seconds > y->seconds) - (x->seconds < y->seconds);
}

// a damping hand lies on the head for 0.25 s (chosen: twice the decay time of a damped head), and
// is off before the head's next stroke and before its pedal moves
static int list_damps(const midi_part *part, change *list)
{
    int count = 0, pedal = 0;
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
        // a dry note that the next one follows at once is damped before that
        double from = s->end, least = fmax(s->note->seconds + 0.15, himc_midi_stroke_end(s));
        if (s->note->way.ring < 0 && until - from < 0.1)
            from = fmax(least, until - 0.25);
        if (s->note->way.ring < 0 && until - from < 0.05)
            continue;
        list[count++] = (change){from, s->head, "damp 1", NULL};
        list[count++] = (change){until, s->head, "damp 0", NULL};
    }
    return count;
}

// a vibraphone's dampers lie on its bars for a moment, up to the next stroke; times (s) chosen
static int add_dampers(const midi_part *part, int head, double at, change *list)
{
    double next = HUGE_VAL;
    for (int i = 0; i < part->count && next == HUGE_VAL; i++)
        if (part->stroke[i].head == head && part->stroke[i].note->seconds > at - 1e-3)
            next = part->stroke[i].note->seconds;
    double from = fmax(fmin(at, next - 0.2), 0), until = fmin(from + 0.3, next - 0.02);
    list[0] = (change){from, head, "pedal 0", NULL};
    list[1] = (change){until, head, "pedal 1", NULL};
    return until > from ? 2 : 0;
}

// cloths, pedals, hi-hats; returns how many changes there are then
static int list_orders(const midi_part *part, change *list, int count)
{
    int most = MOST_CHANGES - part->pedals;
    for (int i = 0; i < part->file->order_count; i++) {
        const midi_order *o = &part->file->orders[i];
        for (int h = 0; is_mine(part, o) && h < part->heads && count < most; h++)
            if (o->choice != MIDI_ANY && o->choice != part->head[h].choice)
                continue;
            else if (o->kind == MIDI_MUFFLE)
                list[count++] = (change){o->seconds, h, o->value ? "muffle 1" : "muffle 0", NULL};
            else if (o->kind == MIDI_WIRES && has_wires(&part->head[h]))
                list[count++] = (change){o->seconds, h, o->value ? "wires 1" : "wires 0", NULL};
            else if (o->kind == MIDI_PEDAL && count + 2 <= most)
                count += add_dampers(part, h, o->seconds, list + count);
    }
    for (int k = 0; k < part->pedals; k++)
        list[count++] =
            (change){part->pedal[k].seconds, part->pedal[k].head, NULL, &part->pedal[k]};
    // a hi-hat's foot moves just before the stroke (s), chosen
    midi_opening last = MIDI_AS_IT_IS;
    for (int i = 0; i < part->count && count < MOST_CHANGES; i++) {
        const midi_stroke *s = &part->stroke[i];
        if (s->fate != MIDI_PLAYED || s->pedal == MIDI_AS_IT_IS || s->pedal == last)
            continue;
        last = s->pedal;
        list[count++] = (change){s->note->seconds - 0.03, s->head,
                                 last == MIDI_OPEN ? "pedal 0" : "pedal 1", NULL};
    }
    return count;
}

static bool put_changes(himc_text_lines *t, const midi_file *file, const midi_part *part,
                        double lead)
{
    change *list = malloc(MOST_CHANGES * sizeof *list);
    if (!list)
        return false;
    int count = list_orders(part, list, list_damps(part, list));
    qsort(list, (size_t)count, sizeof *list, by_time);
    for (int i = 0; i < count; i++) {
        const change *c = &list[i];
        double beat = himc_score_beat(file->tempi, file->tempo_count, c->seconds) + lead;
        const char *name = part->head[c->head].name;
        char pitch[HIMC_NOTE_SIZE];
        if (c->pedal)
            himc_midi_key_name(pitch, c->pedal->to);
        if (c->pedal)
            himc_text_print(t, "at %.9g %s gliss %s %.4g;\n", beat, name, pitch,
                            fmin(c->pedal->length, LONGEST_GLISS));
        else
            himc_text_print(t, "at %.9g %s %s;\n", beat, name, c->does);
    }
    free(list);
    return true;
}

// a dynamic as its word, where it is one within a hundredth
static const char *dynamic_word(char word[16], double dynamic)
{
    int step = (int)lround(7 * dynamic);
    if (fabs(dynamic - step / 7.0) < 0.01)
        return himc_dynamic_words[step];
    himc_format(word, 16, "%.3g", dynamic);
    return word;
}

static void put_stroke(himc_text_lines *t, const midi_part *part, const midi_stroke *s, double beat)
{
    static const char *const ornaments[] = {"stroke", "flam",   "drag", "ruff",
                                            "single", "double", "press"};
    const midi_way *way = &s->note->way;
    const char *drum = part->head[s->head].name, *spot = himc_spot_name(s->spot);
    const char *space = s->part[0] ? " " : "";
    char first[16], last[16];
    if (s->roll.length > 0)
        himc_text_print(t, "roll %.9g %.9g %s %s %s %s %s%s%s;\n", beat, s->roll.length,
                        way->ornament > HIMC_ROLL_SINGLE ? ornaments[way->ornament] : "single",
                        dynamic_word(first, s->dynamic), dynamic_word(last, s->roll.last_dynamic),
                        spot, s->part, space, drum);
    else
        himc_text_print(t, "%s %.9g %s %s %s %s %s%s%s;\n",
                        ornaments[way->length > 0 ? HIMC_PLAIN : way->ornament], beat,
                        himc_hand_name(s->hand), himc_nuance_name(way->nuance),
                        dynamic_word(first, s->dynamic), spot, s->part, space, drum);
}

// the first mallets that a word names before the first stroke of a kind; others cannot be played
static void find_mallets(midi_part *part, const char *found[MIDI_CHOICES])
{
    static const char *const mallets[] = {"soft", "medium", "hard", "wood"};
    double first[MIDI_CHOICES] = {0}; // beats
    for (int i = part->count - 1; i >= 0; i--)
        if (part->stroke[i].fate == MIDI_PLAYED)
            first[part->stroke[i].choice] = first[MIDI_ANY] = part->stroke[i].note->beat;
    for (int i = 0; i < part->file->order_count; i++) {
        const midi_order *o = &part->file->orders[i];
        if (o->kind != MIDI_MALLET || !is_mine(part, o))
            continue;
        part->mallets += o->beat > first[o->choice] + 1e-6;
        for (int kind = 1; kind < MIDI_CHOICES && o->beat <= first[o->choice] + 1e-6; kind++)
            if (o->choice == MIDI_ANY || (int)o->choice == kind)
                found[kind] = mallets[o->value & 3];
    }
}

// the file's name as a word: what ends a word or a line in Pure Data becomes _
static void put_name(himc_text_lines *t, const char *name)
{
    const char *slash = strrchr(name, '/');
    char shown[64];
    snprintf(shown, sizeof shown, "%s", slash ? slash + 1 : name);
    for (char *s = shown; *s; s++)
        *s = isalnum((unsigned char)*s) || strchr("-_.", *s) ? *s : '_';
    himc_text_print(t, "comment made of %s by himc import;\n", shown);
}

static void put_heads(himc_text_lines *t, const midi_part *part,
                      const char *const mallets[MIDI_CHOICES], const char *setup)
{
    if (setup)
        himc_text_print(t, "setup %s;\n", setup);
    for (int i = 0; i < part->heads && !setup; i++) {
        const midi_head *h = &part->head[i];
        if (h->made[0])
            himc_text_print(t, "instrument %s %s;\n", h->name, h->made);
        else
            himc_text_print(t, "drum %s %g;\n", h->name, h->inches);
        himc_text_print(t, "%s place %g %g %g %g;\n", h->name, h->x, h->y, h->z, h->tilt);
        char pitch[HIMC_NOTE_SIZE];
        if (h->key != MIDI_UNTUNED) {
            himc_midi_key_name(pitch, h->key);
            himc_text_print(t, "%s tune %s;\n", h->name, pitch);
        }
        if (mallets[h->choice])
            himc_text_print(t, "%s mallet %s;\n", h->name, mallets[h->choice]);
    }
    himc_text_print(t, "gain %g;\n", GAIN);
}

static void put_tempi(himc_text_lines *t, const midi_file *file, double last, double lead)
{
    for (int i = 0; i < file->tempo_count && file->tempi[i].beat <= last; i++) {
        double beat = file->tempi[i].beat;
        himc_text_print(t, "tempo %.9g %.9g;\n", file->tempi[i].bpm, beat > 0 ? beat + lead : 0);
    }
}

// where bars begin, if not after as many beats as before
static void put_bars(himc_text_lines *t, const midi_file *file, double last, double lead)
{
    const midi_bar *from = NULL;
    for (int i = 0; i < file->bar_count && file->bars[i].beat <= last; i++) {
        const midi_bar *b = &file->bars[i];
        if (from && from->beats == b->beats && from->unit == b->unit &&
            fabs(remainder(b->beat - from->beat, 4.0 * b->beats / b->unit)) < 1e-6)
            continue;
        himc_text_print(t, "comment bars of %d/%d from beat %.9g;\n", b->beats, b->unit,
                        b->beat + lead);
        from = b;
    }
}

static void put_strokes(himc_text_lines *t, const midi_part *part, double lead)
{
    const midi_bar *now = NULL;
    for (int i = 0; i < part->count; i++) {
        const midi_stroke *s = &part->stroke[i];
        if (s->fate != MIDI_PLAYED || s->in_roll)
            continue;
        const midi_bar *bar = bar_at(part->file, s->note->beat);
        if (bar && bar != now)
            himc_text_print(t, "comment bar %s;\n", bar->number);
        now = bar;
        put_stroke(t, part, s, s->note->beat + lead);
    }
}

static bool write_score(midi_score *made, const midi_file *file, midi_part *part, const char *name,
                        const char *setup, himc_error *error)
{
    himc_text_lines score = {0}, said = {0};
    // whole beats before the file's first, so that the first stroke comes 1 s later at the earliest
    // (chosen: sticks rise and fall twice)
    int first = 0;
    while (part->stroke[first].fate != MIDI_PLAYED)
        first++;
    double wait = fmax(0, 1.0 - part->stroke[first].note->seconds);
    double lead = ceil(wait * file->tempi[0].bpm / 60);
    double off = 0; // tempi hold up to the end of the longest note
    for (int i = 0; i < part->count; i++)
        off = fmax(off, part->stroke[i].note->off);
    double last = himc_score_beat(file->tempi, file->tempo_count, off);
    const char *mallets[MIDI_CHOICES] = {NULL};
    find_mallets(part, mallets);
    report(&said, file, part);
    put_name(&score, name);
    const char *line = said.failed ? "" : said.bytes;
    for (const char *end; (end = strchr(line, '\n')); line = end + 1)
        himc_text_print(&score, "comment %.*s;\n", (int)(end - line), line);
    himc_text_print(&score, "comment beat 0 of the file is beat %g here;\n", lead);
    put_bars(&score, file, last, lead);
    himc_text_print(&score, "\n");
    put_heads(&score, part, mallets, setup);
    put_tempi(&score, file, last, lead);
    put_strokes(&score, part, lead);
    score.failed |= !put_changes(&score, file, part, lead);
    *made = (midi_score){score.bytes, said.bytes,
                         part->notes - part->fate[MIDI_PLAYED] - part->fate[MIDI_TOGETHER] +
                             file->omitted + file->missing};
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
    if (!himc_command_parse(&setup, HIMC_PERFORMER, "setup", &atom, 1, error))
        return false;
    part->setup = himc_score_of_setup(&setup, error);
    return part->setup;
}

bool himc_midi_make(midi_score *made, midi_file *file, const char *name,
                    const midi_options *options, himc_error *error)
{
    static const midi_options usual = {0};
    midi_part part = {0};
    *made = (midi_score){0};
    options = options ? options : &usual;
    bool good = read_setup(&part, options, error) && make_part(&part, file, options, error);
    if (good && part.fate[MIDI_PLAYED] == 0 && file->said && file->said[0])
        good = himc_error_set(error, "nothing to play: %.*s", (int)strcspn(file->said, "\n"),
                              file->said);
    else if (good && part.fate[MIDI_PLAYED] == 0)
        good = himc_error_set(error, "nothing to play: %d note%s, none %s", file->note_count,
                              file->note_count == 1 ? "" : "s",
                              part.choice == MIDI_TIMPANI
                                  ? "of timpani (program 48 or a track of that name)"
                              : part.choice == MIDI_DRUMS ? "of a drum (channel 10)"
                                                          : "of that keyboard");
    good = good && write_score(made, file, &part, name, options->setup, error);
    himc_score_free(part.setup);
    free(part.stroke);
    free(part.pedal);
    himc_midi_file_free(file);
    return good;
}

bool himc_midi_import(midi_score *made, const void *bytes, size_t size, const char *name,
                      const midi_options *options, himc_error *error)
{
    midi_file file;
    *made = (midi_score){0};
    if (size > HIMC_MIDI_BYTES_MAX)
        return himc_error_set(error, "too long, expected %zu MiB of MIDI",
                              HIMC_MIDI_BYTES_MAX >> 20);
    if (!himc_midi_file_read(&file, bytes, size, error))
        return false;
    if (file.cut > 0) {
        himc_error_set(error, "cut short: %d of its %d tracks can be read up to %.3g s only",
                       file.cut, file.tracks, file.cut_at);
        himc_midi_file_free(&file);
        return false;
    }
    return himc_midi_make(made, &file, name, options, error);
}

void himc_midi_score_free(midi_score *made)
{
    free(made->text);
    free(made->report);
    *made = (midi_score){0};
}
