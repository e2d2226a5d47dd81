/// read.c: from the tree of a MusicXML document (W3C 2021, score-partwise 3.1 and 4.0) to bars,
/// notes and signs.
///
/// A part is a row of measures. In a measure a cursor goes on with each note, and back and forth by
/// `backup` and `forward`; durations count in the part's divisions of a quarter note. Notes are
/// taken of parts that are played; tempi, fermatas, repeats and jumps of all parts, as programs
/// write them into one part only. Invariant: each note of such a part is taken or counted.
#include "musicxml/reader.h"

#include "base/array.h"
#include "base/format.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RIDE = 51, RIDE_BELL = 53 }; // keys of General MIDI

#define SAME 1e-6            // (beats)
#define LEAST_OWN (-1.0 / 7) // dynamic of a note, whose accent adds a step

void himc_music_omit(music *m, int which, int bar)
{
    music_omission *o = &m->omitted[which];
    himc_text_list(o->bars, sizeof o->bars, m->bars[bar].number);
    o->count++;
}

// the name of an instrument that is not played, once
static void add_unknown(music *m, const char *name)
{
    char word[48];
    size_t length = strlen(name) < 40 ? strlen(name) : 40;
    while (length > 0 && ((unsigned char)name[length] & 0xC0) == 0x80) // of one letter
        length--;
    snprintf(word, sizeof word, "%.*s", (int)length, name);
    for (char *c = word; *c; c++)
        *c = iscntrl((unsigned char)*c) || strchr(";,\\", *c) ? ' ' : *c;
    for (const char *at = m->unknown; at; at = strstr(at, ", ") ? strstr(at, ", ") + 2 : NULL)
        if (strncmp(at, word, strlen(word)) == 0 && (!at[strlen(word)] || at[strlen(word)] == ','))
            return;
    size_t used = strlen(m->unknown), left = sizeof m->unknown - used;
    if (left > strlen(word) + sizeof ", ...")
        snprintf(m->unknown + used, left, "%s%s", used ? ", " : "", word);
    else if (!strstr(m->unknown, "..."))
        snprintf(m->unknown + used, left, ", ...");
}

// a fermata over a barline holds what ends there
static void hold_tail(music_reader *r)
{
    music *m = r->music;
    double *hold = &m->bars[r->bar].hold, length = r->tail_end - r->tail;
    *hold = *hold > 0 ? fmin(*hold, length) : length;
    for (int i = m->note_count - 1; i >= 0; i--) {
        music_note *n = &m->notes[i];
        if (n->at.part != r->part || n->at.bar != r->bar)
            return;
        n->held |= n->at.beat + n->length > r->tail_end - SAME;
    }
}

static void read_barline(music_reader *r, const xml_node *barline)
{
    music_bar *bar = &r->music->bars[r->bar];
    const xml_node *repeat = himc_xml_child(barline, "repeat"),
                   *ending = himc_xml_child(barline, "ending");
    if (himc_xml_child(barline, "fermata") && r->tail_end > 0)
        hold_tail(r);
    if (repeat && himc_xml_has(barline, "location", "middle") && r->at > 0) {
        bar->split = r->at;
        bar->split_on |= himc_xml_has(repeat, "direction", "forward");
        bar->split_back |= himc_xml_has(repeat, "direction", "backward");
        return;
    }
    if (himc_xml_has(repeat, "direction", "forward"))
        bar->forward = true;
    if (himc_xml_has(repeat, "direction", "backward")) {
        bar->backward = true;
        int times = atoi(himc_xml_attribute(repeat, "times"));
        bar->times = times > 2 && times < 32 ? times : 2;
    }
    if (himc_xml_child(barline, "segno"))
        bar->segno = true;
    if (himc_xml_child(barline, "coda"))
        bar->coda = true;
    // an ending goes on up to the bar where it stops: order.c
    for (const char *n = himc_xml_attribute(ending, "number");
         *n && himc_xml_has(ending, "type", "start");) {
        int number = atoi(n);
        if (number > 0 && number < 31)
            bar->endings |= 1u << number;
        n += strspn(n, "0123456789");
        n += strcspn(n, "0123456789");
    }
    if (ending && !himc_xml_has(ending, "type", "start"))
        bar->endings |= 1u; // bit 0: it stops here
}

// notes

// of a roll; HIMC_PLAIN: none
static himc_ornament kind_of(const char *text)
{
    himc_ornament kind = HIMC_ROLL_PRESS;
    while (kind >= HIMC_ROLL_SINGLE && strcmp(text, himc_music_roll(kind)) != 0)
        kind--;
    return kind >= HIMC_ROLL_SINGLE ? kind : HIMC_PLAIN;
}

static void read_ornaments(music_reader *r, music_note *n, const xml_node *ornaments)
{
    for (const xml_node *o = ornaments ? ornaments->child : NULL; o; o = o->next) {
        if (himc_xml_is(o, "trill-mark") || himc_xml_is(o, "wavy-line")) {
            n->tremolo = MUSIC_ROLL;
            if (himc_xml_has(o, "type", "start"))
                r->wavy = 1 + n->voice;
            else if (himc_xml_has(o, "type", "stop"))
                r->wavy = 0;
        } else if (himc_xml_is(o, "other-ornament") && kind_of(o->text)) {
            n->kind = kind_of(o->text);
        } else if (!himc_xml_is(o, "tremolo")) {
            if (!himc_xml_is(o, "accidental-mark"))
                himc_music_omit(r->music, MUSIC_UNKNOWN, r->bar);
        } else {
            int marks = atoi(o->text);
            n->marks = marks < 0 ? 0 : marks > 8 ? 8 : marks;
            const char *sign = himc_xml_attribute(o, "smufl"); // without it a z
            n->pressed = himc_xml_has(o, "type", "unmeasured") &&
                         (!sign[0] || strcmp(sign, "buzzRoll") == 0);
            n->tremolo = himc_xml_has(o, "type", "start")                         ? MUSIC_PAIR_BEGIN
                         : himc_xml_has(o, "type", "stop")                        ? MUSIC_PAIR_END
                         : himc_xml_has(o, "type", "unmeasured") || n->marks == 0 ? MUSIC_ROLL
                                                                                  : MUSIC_MARKS;
        }
    }
}

// programs write the marks of a chord at its first note
static void share_marks(music_note *n, const music_note *head)
{
    if (n->tremolo == MUSIC_NO_TREMOLO) {
        n->tremolo = head->tremolo;
        n->marks = head->marks;
        n->kind = head->kind;
        n->pressed = head->pressed;
    }
    n->accent |= head->accent;
    n->marcato |= head->marcato;
    n->tenuto |= head->tenuto;
    n->staccato |= head->staccato;
    n->pulled |= head->pulled;
    n->held |= head->held;
}

static int hand_of(const char *text)
{
    if (strlen(text) != 1 || !strchr("RLrldgDG", *text))
        return 0;
    return 1 + (strchr("RrdD", *text) ? HIMC_RIGHT : HIMC_LEFT);
}

static void read_articulations(music_reader *r, music_note *n, const xml_node *articulations)
{
    for (const xml_node *a = articulations ? articulations->child : NULL; a; a = a->next) {
        bool other = himc_xml_is(a, "other-articulation");
        if (himc_xml_is(a, "accent"))
            n->accent = true;
        else if (himc_xml_is(a, "strong-accent"))
            n->marcato = true;
        else if (himc_xml_is(a, "tenuto") || himc_xml_is(a, "detached-legato") ||
                 himc_xml_is(a, "soft-accent") || himc_xml_is(a, "stress"))
            n->tenuto = true;
        else if (himc_xml_is(a, "staccato") || himc_xml_is(a, "staccatissimo") ||
                 himc_xml_is(a, "spiccato"))
            n->staccato = true;
        else if (himc_xml_is(a, "unstress"))
            n->ghost = true;
        else if (other && strcmp(a->text, "pulled off") == 0)
            n->pulled = true;
        else if (other && strcmp(a->text, "louder") == 0)
            n->accent = false; // `himc export` prints how much its dynamic is above the others
        else if (other && strcmp(a->text, "choke") == 0)
            n->ring = -1;
        else
            himc_music_omit(r->music, MUSIC_UNKNOWN, r->bar);
    }
}

static void read_technical(music_reader *r, music_note *n, const xml_node *technical)
{
    for (const xml_node *t = technical ? technical->child : NULL; t; t = t->next) {
        bool open = himc_xml_is(t, "open") || himc_xml_is(t, "open-string");
        if (hand_of(t->text))
            n->hand = hand_of(t->text);
        else if (n->choice == MIDI_DRUMS && open &&
                 (n->key == MIDI_CLOSED_HATS || n->key == MIDI_OPEN_HATS))
            n->key = MIDI_OPEN_HATS;
        else if (!himc_xml_is(t, "fingering") && !himc_xml_is(t, "stopped")) // of mallets, of hats
            himc_music_omit(r->music, MUSIC_UNKNOWN, r->bar);
    }
}

// semitones from a note to the upper note of its trill, by the key or a sign above it
static int find_upper(const music_reader *r, const xml_node *note, const xml_node *ornaments)
{
    static const char letters[] = "CDEFGAB", sharps[] = "FCGDAEB";
    static const int steps[] = {2, 2, 1, 2, 2, 2, 1};
    const xml_node *pitch = himc_xml_child(note, "pitch");
    const char *letter = strchr(letters, himc_xml_text(pitch, "step")[0]),
               *mark = himc_xml_text(ornaments, "accidental-mark");
    if (!pitch || !letter || !*letter || !himc_xml_child(ornaments, "trill-mark"))
        return 0;
    int next = (int)(letter - letters + 1) % 7;
    int order = (int)(strchr(sharps, letters[next]) - sharps);
    int alter = order < r->fifths ? 1 : 6 - order < -r->fifths ? -1 : 0;
    alter = strcmp(mark, "sharp") == 0     ? 1
            : strcmp(mark, "flat") == 0    ? -1
            : strcmp(mark, "natural") == 0 ? 0
                                           : alter;
    int up = steps[letter - letters] + alter - himc_xml_whole(pitch, "alter", 0);
    return up < 1 ? 1 : up;
}

static void read_notations(music_reader *r, music_note *n, const xml_node *note,
                           const xml_node *notations)
{
    n->upper += find_upper(r, note, himc_xml_child(notations, "ornaments"));
    read_ornaments(r, n, himc_xml_child(notations, "ornaments"));
    read_articulations(r, n, himc_xml_child(notations, "articulations"));
    read_technical(r, n, himc_xml_child(notations, "technical"));
    for (const xml_node *t = himc_xml_child(notations, "tied"); t; t = himc_xml_next(t))
        n->ring |= himc_xml_has(t, "type", "let-ring");
    n->held |= himc_xml_child(notations, "fermata") != NULL;
    for (const xml_node *g = notations->child; g; g = g->next)
        if (himc_xml_is(g, "glissando") || himc_xml_is(g, "slide")) {
            n->glides |= himc_xml_has(g, "type", "start");
            n->glided |= himc_xml_has(g, "type", "stop");
        }
    const xml_node *dynamics = himc_xml_child(notations, "dynamics");
    r->lane = n->lane;
    if (dynamics)
        himc_music_dynamics(r, dynamics, n->at.beat, "");
    r->lane = 0;
}

static bool read_key(music_reader *r, const xml_node *note, music_note *n)
{
    const music_instrument *of = himc_music_instrument_of(&r->instruments, note);
    const xml_node *pitch = himc_xml_child(note, "pitch");
    int written = himc_music_pitch(note);
    n->choice = of->choice;
    n->concert = of->concert;
    n->drum = of->drum;
    n->key = written + (pitch ? r->transpose : 0);
    if (of->choice == MIDI_ANY) { // unpitched
        n->choice = MIDI_DRUMS;
        n->key = MIDI_NO_SOUND;
    } else if (of->choice == MIDI_DRUMS) {
        const char *head = himc_xml_text(note, "notehead");
        n->key = himc_music_drum_of(&r->instruments, note, of, written);
        if (n->key == MIDI_CLOSED_HATS && strcmp(head, "circle-x") == 0)
            n->key = MIDI_OPEN_HATS;
        else if (n->key == RIDE && strcmp(head, "diamond") == 0)
            n->key = RIDE_BELL;
    }
    return (pitch || himc_xml_child(note, "unpitched")) && n->key >= 0 && n->key < 256 &&
           (written >= 0 || of->key >= 0) && (n->choice == MIDI_DRUMS || n->key < 128);
}

// of a drum with a hoop (kit.c)
static himc_spot spot_of(const char *notehead)
{
    himc_spot spot = HIMC_SPOT_CROSSSTICK;
    for (; spot < HIMC_SPOT_XY; spot++)
        if (strcmp(notehead, himc_music_notehead(spot)) == 0)
            return spot;
    return HIMC_SPOT_NORMAL;
}

static double read_ratio(const xml_node *tuplet)
{
    double actual = himc_xml_number(tuplet, "actual-notes", 1),
           normal = himc_xml_number(tuplet, "normal-notes", 1);
    return actual >= 1 && normal >= 1 && actual < 100 && normal < 100 ? actual / normal : 1;
}

// of a row of hands that words have, 0: none is left; only notes of one lane are beside it
static int next_hand(music_reader *r, int lane)
{
    if (r->hand == r->hand_count || (r->hand > 0 && r->hand_lane != lane))
        return 0;
    r->hand_lane = lane;
    return r->hands[r->hand++];
}

static void read_ties(music_note *n, const xml_node *note)
{
    for (const xml_node *t = himc_xml_child(note, "tie"); t; t = himc_xml_next(t)) {
        n->tied_on |= himc_xml_has(t, "type", "start");
        n->tied_back |= himc_xml_has(t, "type", "stop");
        n->ring |= himc_xml_has(t, "type", "let-ring");
    }
}

static void add_note(music_reader *r, const xml_node *note, double beat, double length)
{
    static const char *const types[] = {"eighth", "16th", "32nd", "64th", "128th"};
    music *m = r->music;
    music_note n = {.at = {beat, r->bar, r->part, m->note_count},
                    .length = length,
                    .voice = atoi(himc_xml_text(note, "voice")),
                    .lane = himc_music_lane(note),
                    .grace = himc_xml_child(note, "grace") != NULL,
                    .hidden = himc_xml_has(note, "print-object", "no"),
                    .spot = spot_of(himc_xml_text(note, "notehead")),
                    .ghost = himc_music_yes(himc_xml_child(note, "notehead"), "parentheses"),
                    .ratio = 1};
    bool chord = himc_xml_child(note, "chord");
    r->head = chord ? r->head : -1;
    const music_instrument *of = himc_music_instrument_of(&r->instruments, note);
    if (himc_xml_child(note, "rest") ||
        (of->choice == MIDI_ANY && (!himc_xml_child(note, "unpitched") || !of->name[0])))
        return;
    if (strcmp(himc_xml_text(note, "notehead"), "slash") == 0) {
        himc_music_omit(m, MUSIC_SLASHES, r->bar);
        return;
    }
    if (himc_xml_child(note, "cue")) { // silent; one that is small alone is not, by the standard
        himc_music_omit(m, MUSIC_CUES, r->bar);
        return;
    }
    // percent of a velocity of 90
    const char *level = himc_xml_attribute(note, "dynamics");
    double own = (0.9 * strtod(level, NULL) - himc_midi_velocity(0)) / himc_midi_velocity(0) / 7;
    n.dynamic = level[0] ? fmin(fmax(own, LEAST_OWN), 1) : MUSIC_UNSAID;
    if (!read_key(r, note, &n) || (!n.grace && length <= 0)) {
        himc_music_omit(m, MUSIC_BAD_NOTES, r->bar);
        return;
    }
    if (n.key == MIDI_NO_SOUND)
        add_unknown(m, of->key >= 0 || of->choice == MIDI_ANY ? of->name : "other percussion");
    for (int i = 0; i < 5; i++)
        if (strcmp(himc_xml_text(note, "type"), types[i]) == 0)
            n.flags = i + 1;
    n.ratio = read_ratio(himc_xml_child(note, "time-modification"));
    read_ties(&n, note);
    n.hand = chord || n.grace || n.tied_back ? 0 : next_hand(r, n.lane);
    for (const xml_node *l = himc_xml_child(note, "lyric"); l; l = himc_xml_next(l))
        n.hand = hand_of(himc_xml_text(l, "text")) ? hand_of(himc_xml_text(l, "text")) : n.hand;
    for (const xml_node *t = himc_xml_child(note, "notations"); t; t = himc_xml_next(t))
        read_notations(r, &n, note, t);
    if (n.tremolo >= MUSIC_PAIR_BEGIN && n.ratio >= 2) // each is written as long as both sound
        n.ratio /= 2;
    if (chord && r->head >= 0)
        share_marks(&n, &m->notes[r->head]);
    else if (!chord)
        r->head = m->note_count;
    // a tied note in the middle of a trill's line has no sign of its own
    if (r->wavy == 1 + n.voice && n.tremolo == MUSIC_NO_TREMOLO) {
        n.tremolo = n.tied_back ? MUSIC_ROLL : n.tremolo;
        r->wavy = n.tied_back ? r->wavy : 0;
    }
    if (!himc_array_grow(&m->notes, m->note_count, &m->note_room, sizeof *m->notes, r->error))
        r->failed = true;
    else
        m->notes[m->note_count++] = n;
}

static void read_note(music_reader *r, const xml_node *note)
{
    bool grace = himc_xml_child(note, "grace"), chord = himc_xml_child(note, "chord");
    double length = grace ? 0 : himc_xml_number(note, "duration", 0) / r->divisions;
    length = length >= 0 && length < 1000 ? length : 0;
    double beat = chord ? r->last : r->at;
    r->slashes |= r->slashed;
    if (!r->slashed)
        add_note(r, note, beat, length);
    for (const xml_node *t = himc_xml_child(note, "notations"); t; t = himc_xml_next(t))
        if (himc_xml_child(t, "fermata") && length > 0)
            himc_music_sign(r, beat, MUSIC_FERMATA, length);
    if (!chord)
        r->last = r->at;
    if (beat + length > r->tail_end - SAME && length > 0) {
        r->tail = fabs(beat + length - r->tail_end) < SAME ? fmax(r->tail, beat) : beat;
        r->tail_end = beat + length;
    }
    if (!chord && !grace)
        r->at += length;
}

static void read_attributes(music_reader *r, const xml_node *attributes)
{
    double divisions = himc_xml_number(attributes, "divisions", r->divisions);
    r->divisions = divisions > 0 && divisions < 1e6 ? divisions : r->divisions;
    r->fifths = himc_xml_whole(himc_xml_child(attributes, "key"), "fifths", r->fifths);
    const xml_node *transpose = himc_xml_child(attributes, "transpose");
    if (transpose) {
        double by = himc_xml_number(transpose, "chromatic", 0) +
                    12 * himc_xml_number(transpose, "octave-change", 0);
        r->transpose = fabs(by) < 128 ? (int)by : 0;
    }
    const xml_node *style = himc_xml_child(attributes, "measure-style");
    for (; style; style = himc_xml_next(style)) {
        const xml_node *s = style->child;
        bool start = himc_xml_has(s, "type", "start");
        if (himc_xml_is(s, "measure-repeat"))
            r->repeated = start ? atoi(s->text) : 0;
        else if (himc_xml_is(s, "slash") || himc_xml_is(s, "beat-repeat"))
            r->slashed = start;
    }
    himc_music_instruments_attributes(&r->instruments, attributes);
    const xml_node *time = himc_xml_child(attributes, "time");
    double beats = 0, length = 0, unit = 1;
    for (const xml_node *t = time ? time->child : NULL; t; t = t->next) { // 3/8 + 2/4, "3+2"
        for (const char *n = himc_xml_is(t, "beats") ? t->text : NULL; n && *n;) {
            beats += strtod(n, NULL);
            n = strchr(n, '+');
            n = n ? n + 1 : NULL;
        }
        if (!himc_xml_is(t, "beat-type"))
            continue;
        double type = strtod(t->text, NULL);
        if (!(beats > 0 && beats < 1000 && type >= 1 && type <= 64))
            return;
        length += 4 * beats / type;
        unit = fmax(unit, type);
        beats = 0;
    }
    if (!(length > 0))
        return;
    r->time = length;
    r->beats = (int)lround(length * unit / 4);
    r->unit = (int)lround(unit);
}

// as it is printed, a word of a comment
static void read_number(music_bar *bar, const xml_node *measure)
{
    if (!bar->number[0])
        snprintf(bar->number, sizeof bar->number, "%.11s", himc_xml_attribute(measure, "number"));
    for (char *c = bar->number; *c; c++)
        *c = isalnum((unsigned char)*c) || strchr("-+.", *c) ? *c : '_';
}

// the notes of the bar that a sign repeats, if this one has none of its own
static void repeat_bar(music_reader *r)
{
    music *m = r->music;
    const int bar = r->bar - r->repeated, end = m->note_count;
    int first = end; // notes are in the order of parts and bars
    while (first > 0 && m->notes[first - 1].at.part == r->part && m->notes[first - 1].at.bar >= bar)
        first--;
    if (first < end && m->notes[end - 1].at.bar == r->bar)
        return;
    for (int i = first; i < end && !r->failed && m->notes[i].at.bar == bar; i++) {
        music_note n = m->notes[i];
        n.at.bar = r->bar;
        n.at.order = m->note_count;
        r->failed =
            m->note_count >= MUSIC_MADE_MAX
                ? !himc_error_set(r->error, "more than %d notes with repeated bars", MUSIC_MADE_MAX)
                : !himc_array_grow(&m->notes, m->note_count, &m->note_room, sizeof *m->notes,
                                   r->error);
        if (!r->failed)
            m->notes[m->note_count++] = n;
    }
}

static void read_measure(music_reader *r, const xml_node *measure)
{
    music_bar *bar = &r->music->bars[r->bar];
    read_number(bar, measure);
    bool own = false;
    for (int i = 0; i < r->instruments.count; i++)
        own |= r->instruments.row[i].choice != MIDI_ANY;
    bool sounds = false;
    r->at = r->last = r->end = r->tail = r->tail_end = 0;
    r->slashes = false;
    for (const xml_node *n = measure->child; n; n = n->next) {
        double duration = himc_xml_number(n, "duration", 0) / r->divisions;
        sounds |= himc_xml_child(n, "pitch") || himc_xml_child(n, "unpitched");
        if (himc_xml_is(n, "note"))
            read_note(r, n);
        else if (himc_xml_is(n, "backup"))
            r->at = duration > 0 ? fmax(r->at - duration, 0) : r->at;
        else if (himc_xml_is(n, "forward"))
            r->at = duration > 0 && duration < 1000 ? r->at + duration : r->at;
        else if (himc_xml_is(n, "attributes"))
            read_attributes(r, n);
        else if (himc_xml_is(n, "direction"))
            himc_music_direction(r, n, own);
        else if (himc_xml_is(n, "sound"))
            himc_music_sound(r, n, r->at, own);
        else if (himc_xml_is(n, "barline"))
            read_barline(r, n);
        r->end = fmax(r->end, r->at);
    }
    if (r->slashes && own)
        himc_music_omit(r->music, MUSIC_SLASHES, r->bar);
    if (r->repeated > 0)
        repeat_bar(r);
    if (bar->length == 0 && r->end == 0)
        r->end = r->time;
    // a rest may fill a whole bar where the bar of others is a pickup
    if (sounds == bar->sounds)
        bar->length = fmax(bar->length, r->end);
    else if (sounds)
        bar->length = r->end;
    bar->sounds |= sounds;
    bar->beats = r->beats;
    bar->unit = r->unit;
}

static bool read_part(music_reader *r, const xml_node *part)
{
    music *m = r->music;
    r->list = himc_xml_child(himc_xml_child(r->root, "part-list"), "score-part");
    while (r->list && !himc_xml_has(r->list, "id", himc_xml_attribute(part, "id")))
        r->list = himc_xml_next(r->list);
    r->first = m->note_count;
    himc_music_instruments_read(&r->instruments, r->list, part);
    r->divisions = 1;
    r->transpose = r->wavy = r->repeated = r->hand = r->hand_count = 0;
    r->slashed = false;
    r->time = r->beats = r->unit = 4;
    r->bar = 0;
    r->head = -1;
    const xml_node *measure = himc_xml_child(part, "measure");
    for (; measure && !r->failed; measure = himc_xml_next(measure), r->bar++) {
        if (r->bar == MUSIC_BARS_MAX)
            return himc_error_set(r->error, "line %d: bar %d, expected up to %d bars",
                                  measure->line, r->bar + 1, MUSIC_BARS_MAX);
        if (r->bar == m->bar_count) {
            if (!himc_array_grow(&m->bars, m->bar_count, &m->bar_room, sizeof *m->bars, r->error))
                return false;
            m->bars[m->bar_count++] = (music_bar){.times = 2};
        }
        read_measure(r, measure);
    }
    himc_music_choose_bass_drum(&r->instruments, m, r->first);
    return !r->failed;
}

static bool read_root(music_reader *r, const xml_node *root)
{
    if (himc_xml_is(root, "score-timewise"))
        return himc_error_set(r->error, "MusicXML by time: export it as score-partwise");
    if (!himc_xml_is(root, "score-partwise"))
        return himc_error_set(r->error, "XML of the kind %.40s, expected score-partwise",
                              root->name);
    r->root = root;
    for (const xml_node *p = himc_xml_child(root, "part"); p; p = himc_xml_next(p), r->part++)
        if (!read_part(r, p))
            return false;
    r->lane = 0;
    r->part = 0; // a tempo is of all
    for (r->bar = 0; r->bar < r->music->bar_count; r->bar++) {
        const music_bar *bar = &r->music->bars[r->bar];
        if (bar->hold > 0)
            himc_music_sign(r, fmax(bar->length - bar->hold, 0), MUSIC_FERMATA, bar->hold);
    }
    if (r->failed)
        return false;
    return r->music->bar_count > 0 || himc_error_set(r->error, "a score without a bar");
}

bool himc_music_read(music *m, const void *bytes, size_t size, himc_error *error)
{
    // what is only printed
    static const char *const unused[] = {"identification", "defaults", "credit",     "print",
                                         "stem",           "beam",     "accidental", "harmony",
                                         "figured-bass",   "slur",     NULL};
    xml_document document;
    *m = (music){
        .omitted = {
            [MUSIC_CUES] = {"cue note is left out", "cue notes are left out", 0, ""},
            [MUSIC_HIDDEN] = {"hidden note is left out: a roll is played there",
                              "hidden notes are left out: rolls are played there", 0, ""},
            [MUSIC_BAD_NOTES] = {"note is not played: it has no pitch or no length",
                                 "notes are not played: they have no pitch or no length", 0, ""},
            [MUSIC_GRACES] =
                {"grace note is not played: no note follows, or there are more than 8",
                 "grace notes are not played: no note follows, or there are more than 8", 0, ""},
            [MUSIC_ATTACKS] = {"accent is not played: no stroke begins there",
                               "accents are not played: no stroke begins there", 0, ""},
            [MUSIC_UNKNOWN] = {"sign of a note is not played: strokes have no way for it",
                               "signs of notes are not played: strokes have no way for them", 0,
                               ""},
            [MUSIC_PEDALS] = {"pedal is not played: the instrument has none",
                              "pedals are not played: the instrument has none", 0, ""},
            [MUSIC_SLASHES] = {"slash that stands for notes is not played",
                               "slashes that stand for notes are not played", 0, ""}}};
    if (!himc_xml_read(&document, bytes, size, unused, error))
        return false;
    music_reader r = {.music = m, .error = error};
    bool good = read_root(&r, document.root);
    himc_xml_free(&document);
    if (!good)
        himc_music_free(m);
    return good;
}

void himc_music_free(music *m)
{
    free(m->bars);
    free(m->notes);
    free(m->signs);
    *m = (music){0};
}
