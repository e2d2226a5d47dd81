/// shape.c: from written notes to the notes of a player: ties, tremolos, graces, nuances.
///
/// Part by part: ties join notes, but a roll tied to a note without a tremolo ends with a stroke
/// there, and a stroke of another voice on a roll's drum is one of the roll; then each note takes
/// the dynamic of its beat (level.c), the words that hold there, and its own marks. One or two
/// strokes through the stem are measured, as many as written; three are a roll from FAST strokes a
/// second on, more are always one; a trill is one. A roll is cut where its dynamic bends, and where
/// another one begins or ends: two of one length at a time are played together, each hand on its
/// drum or bar (planner_roll.c), as are a trill on bars and two notes in turn that are too fast. A
/// stroke on another drum takes a hand from a roll, which goes on when it is back. One or two grace
/// notes on the drum of their note are its flam, drag or ruff; others, and those before a roll, are
/// strokes of their own before the beat. A chosen number has no published source. Invariant: each
/// note but a tied one makes at least one stroke, or is counted as omitted.
#include "musicxml/music.h"

#include "base/argument.h"
#include "base/array.h"
#include "midi/part.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SAME 1e-6      // (beats)
#define STEP (1.0 / 7) // of dynamics
#define FORTE (5 * STEP)
#define FAST 6.0       // (1/s) from here on a tremolo of three marks is a roll; chosen: an Adagio's
#define FASTEST 12.0   // strokes of two hands (1/s)
#define ALTERNATE 0.11 // between strokes on two drums, at least (s); chosen: of one hand .22
#define GRACE_TIME 0.07         // between strokes that are grace notes (s); chosen: an open ruff
#define GRACE_SOFTER 0.2        // than their note
#define GHOST_SOFTER (2 * STEP) // a note in parentheses
#define BACK_TIME 0.22          // of a hand from another drum to a roll (s); chosen: 1.4 m
#define LEAST_REST 0.3          // of a roll behind a bend of its dynamic (s); chosen
#define LONGEST 60.0            // roll (s); chosen: a score's limit is 180 s
#define MOST_GRACES 8
#define MOST_LANES 16       // that may have dynamics of their own; chosen: bounds the time
#define MOST_STROKES 100000 // as import.c
#define MOST_CANDIDATES 400 // notes of one beat that a tie is looked for in; chosen: bounds time

/// The dynamics of one lane.
typedef struct lane {
    int lane;
    music_level *levels;
    int count;
} lane;

/// What words say of one kind of instruments.
typedef struct saying {
    himc_spot spot, here; ///< `here` of this beat; HIMC_SPOT_NORMAL: as `spot`
    int always, measured; ///< from here on
    int ring, hand;       ///< of this beat
} saying;

typedef struct shaper {
    music *music;
    midi_file *file;
    himc_error *error;
    int note_room, order_room;
    int part, sign;                   ///< the next sign
    lane lanes[MOST_LANES + 1], *now; ///< the first of all others; the present note's
    int lane_count;
    double *cuts; ///< beats where rolls are cut
    int cut_count;
    const music_note **struck; ///< see list_struck (struck_count)
    int struck_count;
    double second; ///< beats in one second at the present note
    saying says[MIDI_CHOICES];
    unsigned kinds; ///< of the part, a bit each
    double held;    ///< a fermata ends (beats)
    music_note *grace[MOST_GRACES];
    int graces;
    bool failed;
} shaper;

// ties

typedef enum joint { BY_TIE, BY_TREMOLO, BY_GLISS } joint;

static music_note *find_next(music *m, const music_note *n, joint by)
{
    double end = n->at.beat + n->length;
    int first = himc_music_first(m, end);
    for (int i = first; i < m->note_count && i - first < MOST_CANDIDATES; i++) {
        music_note *to = &m->notes[i];
        if (to->at.beat > end + SAME)
            break;
        bool fits = by == BY_TIE ? to->key == n->key && to->choice == n->choice && to->tied_back
                    : to->voice != n->voice ? false
                    : by == BY_GLISS        ? to->glided
                                            : to->tremolo == MUSIC_PAIR_END;
        if (fits && to->at.part == n->at.part && to->length > 0 && !to->grace)
            return to;
    }
    return NULL;
}

// sf and sfz are of the notes that begin there
static void mark_attacks(music *m)
{
    for (int i = 0; i < m->sign_count; i++) {
        const music_place *at = &m->signs[i].at;
        if (m->signs[i].meaning != MUSIC_ATTACK)
            continue;
        int first = himc_music_first(m, at->beat);
        bool found = false;
        for (int k = first; k < m->note_count && k - first < MOST_CANDIDATES; k++) {
            music_note *n = &m->notes[k];
            if (n->at.beat > at->beat + SAME)
                break;
            if (n->at.part == at->part && !n->grace)
                n->attacked = found = true;
        }
        if (!found)
            himc_music_omit(m, MUSIC_ATTACKS, at->bar);
    }
}

// backwards, so that a row of tied notes becomes one
static void join_ties(music *m)
{
    for (int i = m->note_count - 1; i >= 0; i--) {
        music_note *n = &m->notes[i], *to = n->tied_on ? find_next(m, n, BY_TIE) : NULL;
        n->rolled = n->tremolo == MUSIC_NO_TREMOLO ? 0 : n->length;
        if (n->tied_on && !to)
            n->ring = 1; // into the air
        bool accent = to && (to->accent || to->marcato || to->attacked);
        if (accent && !n->tremolo && !to->tremolo)
            himc_music_omit(m, MUSIC_ATTACKS, to->at.bar); // it is not struck again
        // a roll is held to the end of a fermata that it is tied to; an accent on it begins anew
        bool goes_on = to && (!n->tremolo == !to->tremolo || (n->tremolo && to->held)) &&
                       !(accent && to->tremolo);
        if (!goes_on || n->tremolo >= MUSIC_PAIR_BEGIN || to->tremolo >= MUSIC_PAIR_BEGIN)
            continue;
        if (n->tremolo)
            n->rolled += to->tremolo ? to->rolled : to->length;
        n->length += to->length;
        n->ring = to->ring;
        n->glides |= to->glides;
        to->length = -1;
    }
}

static double level(const shaper *s, double beat)
{
    return himc_music_level(s->now->levels, s->now->count, beat);
}

static void choose_lane(shaper *s, int number)
{
    s->now = s->lanes;
    for (int k = 1; k < s->lane_count; k++)
        if (s->lanes[k].lane == number)
            s->now = &s->lanes[k];
}

// A stroke of one voice in a roll of another on that drum is a stroke of it: the roll ends there,
// and goes on from the stroke. One that begins with it takes its place.
static void continue_roll(shaper *s, music_note *roll, music_note *n)
{
    double end = roll->at.beat + roll->rolled, at = n->at.beat;
    choose_lane(s, n->lane);
    double struck = n->dynamic > MUSIC_UNSAID ? n->dynamic : level(s, at);
    choose_lane(s, roll->lane);
    n->struck = fmax(struck - level(s, at), 0);
    n->goes_on = true;
    n->dynamic = MUSIC_UNSAID;
    n->lane = roll->lane;
    n->tremolo = roll->tremolo;
    n->marks = roll->marks;
    n->kind = roll->kind;
    n->pressed = roll->pressed;
    n->flags = roll->flags;
    n->ratio = roll->ratio;
    n->length = n->rolled = end - at;
    n->ring = roll->ring;
    roll->ring = 0;
    roll->rolled = at - roll->at.beat;
    if (roll->rolled > SAME)
        return;
    n->accent |= roll->accent;
    n->marcato |= roll->marcato;
    n->attacked |= roll->attacked;
    n->held |= roll->held;
    n->glides |= roll->glides;
    roll->length = -1;
}

static bool is_long(const music_note *n)
{
    return n->rolled > 0 &&
           (n->tremolo == MUSIC_ROLL || (n->tremolo == MUSIC_MARKS && n->marks > 2));
}

// rolls with strokes of other voices on their drums; hidden ones are how a program plays the roll
static void join_rolls(shaper *s)
{
    music *m = s->music;
    music_note *roll[256] = {NULL}, *last[256] = {NULL}; // of each key
    for (int i = 0; i < m->note_count; i++) {
        music_note *n = &m->notes[i], **now = &roll[n->key], **before = &last[n->key];
        if (n->at.part != s->part || n->grace || n->length <= 0)
            continue;
        bool inside = *now && n->choice == (*now)->choice &&
                      n->at.beat < (*now)->at.beat + (*now)->rolled - SAME;
        if (n->hidden && inside) {
            himc_music_omit(m, MUSIC_HIDDEN, n->at.bar);
            n->length = -1;
        } else if (is_long(n) && *before && n->choice == (*before)->choice &&
                   n->at.beat < (*before)->at.beat + SAME) {
            continue_roll(s, n, *before);
            *now = *before;
        } else if (is_long(n)) {
            *now = n;
        } else if (!n->tremolo && inside) {
            continue_roll(s, *now, n);
            *now = n;
        } else if (!n->tremolo) {
            *before = n;
        }
    }
}

// what is made

static void emit(shaper *s, const music_note *n, double beat, double end, const midi_way *way)
{
    midi_file *f = s->file;
    if (f->note_count >= MOST_STROKES && !s->failed) {
        himc_error_set(s->error, "more than %d strokes", MOST_STROKES);
        s->failed = true;
    }
    if (s->failed || (s->failed = !himc_array_grow(&f->notes, f->note_count, &s->note_room,
                                                   sizeof *f->notes, s->error)))
        return;
    f->notes[f->note_count++] = (midi_note){
        .beat = beat,
        .seconds = himc_score_seconds(f->tempi, f->tempo_count, beat),
        .off = himc_score_seconds(f->tempi, f->tempo_count, end),
        .track = n->at.part,
        .player = n->at.part,
        .key = (uint8_t)n->key,
        .velocity = 80,
        .choice = n->choice,
        .way = *way,
    };
}

static bool is_several(const shaper *s)
{
    return s->kinds & (s->kinds - 1);
}

// of an accent on a roll, or a stroke in it (beats)
static double attack_beats(double second)
{
    return fmax(MUSIC_ATTACK_TIME * second, fmax(himc_argument_find("LENGTH", "roll")->low, 0.1));
}

static int by_beat(const void *a, const void *b)
{
    const double *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

// where the part's dynamics bend, its tremolos begin and end, and accents on them end
static bool list_cuts(shaper *s)
{
    const music *m = s->music;
    const midi_file *f = s->file;
    size_t points = 0;
    for (int k = 0; k < s->lane_count; k++)
        points += (size_t)s->lanes[k].count;
    s->cuts = malloc((points + 3 * (size_t)m->note_count + 1) * sizeof *s->cuts);
    if (!s->cuts)
        return himc_error_set(s->error, "out of memory for %d notes", m->note_count);
    s->cut_count = 0;
    for (int k = 0; k < s->lane_count && !is_several(s); k++)
        for (int i = 0; i < s->lanes[k].count; i++)
            s->cuts[s->cut_count++] = s->lanes[k].levels[i].beat;
    for (int i = 0; i < m->note_count; i++) {
        const music_note *n = &m->notes[i];
        if (n->at.part != s->part || n->length <= 0 || !(n->rolled > 0))
            continue;
        s->cuts[s->cut_count++] = n->at.beat;
        s->cuts[s->cut_count++] = n->at.beat + n->rolled;
        double attack = attack_beats(himc_midi_bpm(f->tempi, f->tempo_count, n->at.beat) / 60);
        if ((n->accent || n->marcato || n->attacked || n->struck > 0) && n->rolled > 2 * attack)
            s->cuts[s->cut_count++] = n->at.beat + attack;
    }
    qsort(s->cuts, (size_t)s->cut_count, sizeof *s->cuts, by_beat);
    return true;
}

// the first cut at or after `from`, up to `end`
static double next_cut(const shaper *s, double from, double end)
{
    int low = 0, high = s->cut_count;
    while (low < high) {
        int middle = (low + high) / 2;
        if (s->cuts[middle] < from)
            low = middle + 1;
        else
            high = middle;
    }
    end = low < s->cut_count ? fmin(s->cuts[low], end) : end;
    if (!is_several(s))
        return end;
    // of several kinds only its own dynamics cut a roll
    for (low = 0, high = s->now->count; low < high;) {
        int middle = (low + high) / 2;
        if (s->now->levels[middle].beat < from)
            low = middle + 1;
        else
            high = middle;
    }
    return low < s->now->count ? fmin(s->now->levels[low].beat, end) : end;
}

// a roll, or what is left of one, cut at the points between
static void emit_stretch(shaper *s, const music_note *n, double begin, double end, double louder,
                         midi_way way)
{
    const himc_argument *range = himc_argument_find("LENGTH", "roll");
    double least = fmax(range->low, 0.1), attack = attack_beats(s->second);
    double base = way.dynamic, most = fmin(range->high, LONGEST * s->second);
    for (double at = begin; at < end - SAME && !s->failed;) {
        double to = next_cut(s, at + least, end);
        double up = at == begin ? louder : 0;
        if (to > end - fmax(least, LEAST_REST * s->second)) // a hairpin ends with the roll
            to = end;
        if (up > 0 && end - at > 2 * attack)
            to = fmin(to, at + attack);
        to = to > end - least ? end : to;
        if (to > at + most) // no rest shorter than a roll can be
            to = end < at + most + least ? at + most / 2 : at + most;
        way.length = to - at;
        way.dynamic = fmin((at == begin ? base : level(s, at)) + up, 1);
        // just before the point, which may be a step
        way.last_dynamic = fmin(level(s, to - 2 * SAME), 1);
        emit(s, n, at, to, &way);
        way.extra = true;
        at = to;
    }
}

// the part's strokes of hands that are no rolls
static bool list_struck(shaper *s)
{
    const music *m = s->music;
    s->struck_count = 0;
    s->struck = malloc(((size_t)m->note_count + 1) * sizeof *s->struck);
    for (int i = 0; i < m->note_count && s->struck; i++) {
        const music_note *n = &m->notes[i];
        bool foot = n->choice == MIDI_DRUMS && (n->key == 35 || n->key == 36 || n->key == 44);
        if (n->at.part == s->part && !n->grace && n->length > 0 && !is_long(n) && !foot)
            s->struck[s->struck_count++] = n;
    }
    return s->struck || himc_error_set(s->error, "out of memory for %d notes", m->note_count);
}

// the next stroke on another drum than a roll's, or `end`
static double next_other(const shaper *s, const music_note *roll, double from, double end)
{
    int low = 0, high = s->struck_count;
    while (low < high) {
        int middle = (low + high) / 2;
        if (s->struck[middle]->at.beat < from - SAME)
            low = middle + 1;
        else
            high = middle;
    }
    while (low < s->struck_count && s->struck[low]->choice == roll->choice &&
           s->struck[low]->key == roll->key)
        low++;
    bool inside = low < s->struck_count && s->struck[low]->at.beat < end - SAME;
    return inside ? s->struck[low]->at.beat : end;
}

// A roll between strokes on other drums; returns how much of it is left (beats).
static double emit_between(shaper *s, const music_note *n, double end, double louder, midi_way way,
                           bool sounds)
{
    double least = fmax(himc_argument_find("LENGTH", "roll")->low, 0.1), left = 0;
    for (double at = n->at.beat, to; at < end - SAME; at = to + BACK_TIME * s->second) {
        to = next_other(s, n, at, end);
        if (sounds && at == n->at.beat && to < at + SAME) { // the other hand begins it
            midi_way one = way;
            one.ornament = HIMC_PLAIN;
            one.length = 0;
            one.begins_roll = true;
            one.dynamic = fmin(way.dynamic + louder, 1);
            emit(s, n, at, at, &one);
            way.extra = true;
        }
        if (to < at + least)
            continue;
        left += to - at;
        way.dynamic = at > n->at.beat ? level(s, at) : way.dynamic;
        if (sounds)
            emit_stretch(s, n, at, to, way.extra ? 0 : louder, way);
        way.extra = true;
    }
    return left;
}

// a roll on two drums or bars, a hand each
static void emit_both(shaper *s, const music_note *n, const music_note *other, double all,
                      midi_way way)
{
    way.ornament = himc_music_usual_roll(n->choice, n->key, false);
    way.length = all;
    way.last_dynamic = fmin(level(s, n->at.beat + all - 2 * SAME), 1);
    emit(s, n, n->at.beat, n->at.beat + all, &way);
    way.extra |= n->upper > 0; // one note is written
    emit(s, other, n->at.beat, n->at.beat + all, &way);
}

static bool is_trill(const music_note *n, double all)
{
    const himc_argument *range = himc_argument_find("LENGTH", "roll");
    return n->upper > 0 && n->choice > MIDI_DRUMS && all >= range->low && all <= range->high;
}

// from the note's beat to `end`; where too little would be left, the hands choose
static void emit_roll(shaper *s, const music_note *n, double end, double louder, midi_way way)
{
    music_note upper = *n;
    upper.key += n->upper;
    if (is_trill(n, end - n->at.beat))
        emit_both(s, n, &upper, end - n->at.beat, way);
    else if (emit_between(s, n, end, louder, way, false) > (end - n->at.beat) / 2)
        emit_between(s, n, end, louder, way, true);
    else
        emit_stretch(s, n, n->at.beat, end, louder, way);
}

// of the strokes behind the first
static himc_nuance after_accent(himc_nuance nuance)
{
    return nuance == HIMC_ACCENT || nuance == HIMC_VERTICAL_ACCENT ? HIMC_LEGATO : nuance;
}

static void emit_measured(shaper *s, const music_note *n, double unit, midi_way way)
{
    int count = (int)lround(n->rolled / unit);
    count = count > 0 ? count : 1; // a note without a type has no flags
    for (int i = 0; i < count; i++) {
        double at = n->at.beat + i * n->rolled / count;
        way.dynamic = i == 0 ? way.dynamic : level(s, at);
        emit(s, n, at, i + 1 < count ? at : n->at.beat + n->length, &way);
        way.extra = true;
        way.hand = 0;
        way.nuance = after_accent(way.nuance);
    }
}

// two notes in turn; the second one is found behind the first
static void emit_pair(shaper *s, music_note *n, double unit, midi_way way)
{
    music_note *other = find_next(s->music, n, BY_TREMOLO);
    double all = 2 * n->length;
    if (other && other->key != n->key && unit / s->second < ALTERNATE && unit < n->length &&
        all >= himc_argument_find("LENGTH", "roll")->low) {
        emit_both(s, n, other, all, way);
        other->length = -1;
        return;
    }
    while (unit / s->second < ALTERNATE && unit < n->length)
        unit *= 2;
    int count = (int)lround(all / unit);
    count = count < 2 || !other ? 2 : count;
    for (int i = 0; i < count; i++) {
        double at = n->at.beat + i * all / count;
        way.dynamic = i == 0 ? way.dynamic : level(s, at);
        way.nuance = i == 0 ? way.nuance : after_accent(way.nuance);
        way.extra = i > 1;
        if (i % 2 == 0)
            emit(s, n, at, at + all / count, &way);
        else if (other)
            emit(s, other, at, at + all / count, &way);
        way.hand = 0;
    }
    if (other)
        other->length = -1;
}

// flam, drag or ruff, or strokes of their own
static void emit_graces(shaper *s, const music_note *n, bool roll, midi_way *way)
{
    bool same = true, slow = true; // two with one beam are a ruff
    for (int i = 0; i < s->graces; i++) {
        same &= s->grace[i]->key == n->key && s->grace[i]->choice == n->choice;
        slow &= s->grace[i]->flags == 1;
    }
    if (same && !roll && s->graces < 3) {
        static const himc_ornament ornament[] = {HIMC_PLAIN, HIMC_FLAM, HIMC_DRAG, HIMC_RUFF};
        way->ornament = ornament[s->graces + (s->graces == 2 && slow)];
        s->graces = 0;
        return;
    }
    midi_way grace = *way;
    grace.extra = true;
    grace.hand = 0;
    grace.nuance = HIMC_LEGATO;
    grace.dynamic = fmax(way->dynamic - GRACE_SOFTER, 0);
    for (int i = 0; i < s->graces; i++) // a score has beats before the first
        emit(s, s->grace[i], n->at.beat - (s->graces - i) * GRACE_TIME * s->second, n->at.beat,
             &grace);
    s->graces = 0;
}

// words and signs

static void add_order(shaper *s, midi_order_kind kind, const music_sign *sign, midi_choice choice)
{
    midi_file *f = s->file;
    int value = (int)sign->value;
    bool tunes = kind == MIDI_TUNING;
    if (s->failed || (s->failed = !himc_array_grow(&f->orders, f->order_count, &s->order_room,
                                                   sizeof *f->orders, s->error)))
        return;
    f->orders[f->order_count++] = (midi_order){
        .beat = sign->at.beat,
        .seconds = himc_score_seconds(f->tempi, f->tempo_count, sign->at.beat),
        .kind = kind,
        .choice = choice,
        .from = tunes ? value / 100 : 0,
        .value = tunes ? value % 100 : value,
        .glides = tunes && sign->meaning == MUSIC_GLISS,
        .line = sign->line,
    };
}

// the last gliss of that line ends at a beat
static void end_gliss(shaper *s, int line, double beat)
{
    midi_file *f = s->file;
    for (int i = f->order_count - 1; i >= 0; i--)
        if (f->orders[i].glides && f->orders[i].line == line) {
            f->orders[i].length =
                himc_score_seconds(f->tempi, f->tempo_count, beat) - f->orders[i].seconds;
            return;
        }
}

// a line from a timpano's note to the next
static void add_gliss(shaper *s, const music_note *n)
{
    const music_note *to = n->glides ? find_next(s->music, n, BY_GLISS) : NULL;
    if (!to || n->choice != MIDI_TIMPANI || to->key == n->key)
        return;
    for (int i = s->file->order_count - 1; i >= 0 && s->file->orders[i].glides; i--)
        if (fabs(s->file->orders[i].beat - n->at.beat) < SAME &&
            s->file->orders[i].value % 12 == to->key % 12) { // words say the same
            s->file->orders[i].line = -1;
            end_gliss(s, -1, to->at.beat);
            return;
        }
    music_sign sign = {
        .at = n->at, .meaning = MUSIC_GLISS, .value = 100 * n->key + to->key, .line = -1};
    add_order(s, MIDI_TUNING, &sign, n->choice);
    end_gliss(s, -1, to->at.beat);
}

// what sounds, or a drum with a pitch, is damped at a beat, or rings on
static void end_at(shaper *s, double beat, midi_choice choice, int ring, int key)
{
    midi_file *f = s->file;
    double at = himc_score_seconds(f->tempi, f->tempo_count, beat);
    bool done[256] = {false}; // the last stroke of each drum
    for (int i = f->note_count - 1, steps = 0; i >= 0 && steps < 16; i--, steps++) {
        midi_note *n = &f->notes[i];
        if (n->track != s->part || n->beat > beat - SAME || done[n->key] ||
            (choice != MIDI_ANY && n->choice != choice))
            continue;
        done[n->key] = true;
        bool ended = n->way.ring < 0 && n->off < at;
        if ((key > 0 && n->key != key) || ended)
            continue;
        n->way.ring = ring;
        n->off = ring < 0 ? at : n->off;
    }
}

// of several kinds the one that a sign is for: the next on its staff, else that of the next note
static midi_choice kind_of(const shaper *s, const music_sign *sign, int next, midi_choice choice)
{
    const music *m = s->music;
    for (int i = next; is_several(s) && sign->lane >= 100 && i < m->note_count; i++) {
        const music_note *n = &m->notes[i];
        if (i - next > MOST_CANDIDATES)
            break;
        if (n->at.part == s->part && n->lane / 100 == sign->lane / 100 &&
            n->at.beat > sign->at.beat - SAME)
            return n->choice;
    }
    return choice;
}

// the signs up to the beat of a note; its index
static void take_signs(shaper *s, double beat, midi_choice choice, int next)
{
    for (; s->sign < s->music->sign_count; s->sign++) {
        const music_sign *sign = &s->music->signs[s->sign];
        if (sign->at.beat > beat + SAME)
            return;
        if (sign->at.part != s->part)
            continue;
        midi_choice kind = kind_of(s, sign, next, choice);
        saying *says = &s->says[kind];
        switch (sign->meaning) {
        case MUSIC_SPOT: says->spot = (himc_spot)sign->value; break;
        case MUSIC_SPOT_HERE: says->here = (himc_spot)sign->value; break;
        case MUSIC_RING:
            // at a rest it is for what sounds
            if (sign->value < -1)
                end_at(s, sign->at.beat, MIDI_ANY, -1, -(int)sign->value);
            else if (sign->at.beat > beat - SAME)
                says->ring = (int)sign->value;
            else
                end_at(s, sign->at.beat, sign->lane >= 100 ? kind : MIDI_ANY, (int)sign->value, 0);
            break;
        case MUSIC_RING_ALWAYS: says->always = (int)sign->value; break;
        case MUSIC_DAMP: end_at(s, sign->at.beat, MIDI_ANY, -1, 0); break;
        case MUSIC_HAND: says->hand = 1 + (int)sign->value; break;
        case MUSIC_FERMATA: s->held = sign->at.beat + sign->value; break;
        case MUSIC_MEASURED: says->measured = (int)sign->value; break;
        case MUSIC_MALLET: add_order(s, MIDI_MALLET, sign, kind); break;
        case MUSIC_PEDAL:
            if (kind == MIDI_VIBRAPHONE || (kind == MIDI_ANY && s->kinds >> MIDI_VIBRAPHONE & 1))
                add_order(s, MIDI_PEDAL, sign, MIDI_VIBRAPHONE);
            else
                himc_music_omit(s->music, MUSIC_PEDALS, sign->at.bar);
            break;
        case MUSIC_MUFFLE: add_order(s, MIDI_MUFFLE, sign, kind); break;
        case MUSIC_WIRES: add_order(s, MIDI_WIRES, sign, kind); break;
        case MUSIC_TUNING:
        case MUSIC_GLISS: add_order(s, MIDI_TUNING, sign, kind); break;
        case MUSIC_GLISS_END: end_gliss(s, sign->line, sign->at.beat); break;
        default: break;
        }
    }
}

// true if its strokes are a roll; `unit`: from stroke to stroke (beats)
static bool is_roll(const shaper *s, const music_note *n, double *unit)
{
    *unit = pow(0.5, n->marks + n->flags) / n->ratio;
    double rate = s->second / *unit;
    if (n->tremolo == MUSIC_ROLL)
        return true;
    if (n->tremolo != MUSIC_MARKS)
        return false;
    bool held = n->held || n->at.beat < s->held - SAME; // what is held is not counted
    int measured = s->says[n->choice].measured;
    if (rate > FASTEST || n->marks > 3 || (n->marks == 3 && (measured == 0 || held)))
        return true;
    return n->marks == 3 && measured != 1 && rate > FAST - SAME;
}

static void shape_note(shaper *s, music_note *n)
{
    const saying *says = &s->says[n->choice];
    double unit, least = himc_argument_find("LENGTH", "roll")->low;
    bool roll = is_roll(s, n, &unit) && n->rolled >= least, attack = n->attacked || n->marcato;
    midi_way way = {.dynamic = n->dynamic > MUSIC_UNSAID ? n->dynamic : level(s, n->at.beat),
                    .drum = n->drum,
                    .nuance = attack      ? HIMC_VERTICAL_ACCENT
                              : n->accent ? HIMC_ACCENT
                              : n->pulled ? HIMC_STACCATO
                              : n->tenuto ? HIMC_TENUTO
                                          : HIMC_LEGATO,
                    .spot = n->spot != HIMC_SPOT_NORMAL      ? n->spot
                            : says->here != HIMC_SPOT_NORMAL ? says->here
                                                             : says->spot,
                    .hand = n->hand ? n->hand : says->hand,
                    .ring = n->ring      ? n->ring
                            : says->ring ? says->ring
                                         : says->always};
    if (n->staccato && !n->pulled && way.ring == 0 && n->choice == MIDI_TIMPANI) {
        way.ring = -1; // a dot: the same attack, and a hand on the head
        n->length /= 2;
    }
    double louder = (attack ? 2 * STEP : n->accent ? STEP : 0) + n->struck;
    emit_graces(s, n, roll, &way);
    if (roll)
        way.ornament = n->kind ? n->kind : himc_music_usual_roll(n->choice, n->key, n->pressed);
    if (n->attacked && n->dynamic == MUSIC_UNSAID) { // an f at least
        double up = fmax(FORTE - way.dynamic, STEP);
        louder = fmax(louder, up);
        way.dynamic = roll ? way.dynamic : fmin(way.dynamic + up, 1);
    }
    if (!roll && n->accent && !attack)
        way.dynamic = fmin(way.dynamic + STEP, 1);
    if (n->ghost && n->dynamic == MUSIC_UNSAID)
        way.dynamic -= GHOST_SOFTER;
    way.dynamic = fmax(way.dynamic, 0);
    if (roll)
        emit_roll(s, n, n->at.beat + n->rolled, louder, way);
    else if (n->tremolo == MUSIC_MARKS)
        emit_measured(s, n, unit, way);
    else if (n->tremolo == MUSIC_PAIR_BEGIN)
        emit_pair(s, n, unit, way);
    else
        emit(s, n, n->at.beat, n->at.beat + n->length, &way);
    add_gliss(s, n);
}

static bool add_lane(shaper *s, int number)
{
    lane *l = &s->lanes[s->lane_count++];
    double second = himc_midi_bpm(s->file->tempi, s->file->tempo_count, 0) / 60;
    *l = (lane){.lane = number};
    l->levels = himc_music_levels(s->music, s->part, number, second, &l->count);
    return l->levels || himc_error_set(s->error, "out of memory for the dynamics");
}

// of several kinds on several staves each staff has dynamics of its own
static bool is_of_staff(const shaper *s, const music_note *n)
{
    return is_several(s) && n->lane >= 100;
}

static bool list_lanes(shaper *s)
{
    const music *m = s->music;
    bool seen[1000] = {false};
    int known = 0;
    s->lane_count = 0;
    bool good = add_lane(s, MUSIC_ALL_LANES);
    for (int i = 0; i < m->note_count && good && known < MOST_LANES; i++) {
        bool of_staff = is_of_staff(s, &m->notes[i]);
        int number = of_staff ? m->notes[i].lane / 100 * 100 : m->notes[i].lane;
        if (m->notes[i].at.part == s->part && !seen[number]) {
            seen[number] = true;
            known++;
            good = !(of_staff || himc_music_apart(m, s->part, number)) || add_lane(s, number);
        }
    }
    s->now = s->lanes;
    return good;
}

static bool shape_part(shaper *s, int part)
{
    music *m = s->music;
    double last = -1;
    s->part = part;
    s->sign = s->graces = 0;
    s->kinds = 0;
    s->held = 0;
    for (int i = 0; i < MIDI_CHOICES; i++)
        s->says[i] = (saying){.spot = HIMC_SPOT_NORMAL, .here = HIMC_SPOT_NORMAL, .measured = -1};
    for (int i = 0; i < m->note_count; i++)
        s->kinds |= m->notes[i].at.part == part ? 1u << m->notes[i].choice : 0;
    s->cuts = NULL;
    s->struck = NULL;
    s->failed |= !list_lanes(s);
    if (!s->failed)
        join_rolls(s);
    s->failed |= !s->failed && !(list_struck(s) && list_cuts(s));
    for (int i = 0; i < m->note_count && !s->failed; i++) {
        music_note *n = &m->notes[i];
        if (n->at.part != part || n->length < 0)
            continue;
        for (int k = 0; k < MIDI_CHOICES && n->at.beat > last + SAME && last >= 0; k++) {
            s->says[k].ring = s->says[k].hand = 0;
            s->says[k].here = HIMC_SPOT_NORMAL;
        }
        if (n->grace && s->graces < MOST_GRACES)
            s->grace[s->graces++] = n;
        else if (n->grace)
            himc_music_omit(m, MUSIC_GRACES, n->at.bar);
        if (n->grace)
            continue;
        take_signs(s, n->at.beat, n->choice, i);
        last = n->at.beat;
        s->second = himc_midi_bpm(s->file->tempi, s->file->tempo_count, last) / 60;
        choose_lane(s, is_of_staff(s, n) ? n->lane / 100 * 100 : n->lane);
        shape_note(s, n);
    }
    for (int i = 0; i < s->graces; i++) // no note follows
        himc_music_omit(m, MUSIC_GRACES, s->grace[i]->at.bar);
    take_signs(s, HUGE_VAL, MIDI_ANY, m->note_count);
    for (int k = 0; k < s->lane_count; k++)
        free(s->lanes[k].levels);
    free(s->cuts);
    free(s->struck);
    return !s->failed;
}

static int by_time(const void *a, const void *b)
{
    const midi_note *x = a, *y = b;
    if (x->seconds != y->seconds)
        return x->seconds < y->seconds ? -1 : 1;
    return x->track != y->track ? x->track - y->track : x->key - y->key;
}

static int by_order(const void *a, const void *b)
{
    const midi_order *x = a, *y = b;
    if (x->seconds != y->seconds)
        return x->seconds < y->seconds ? -1 : 1;
    return x->glides - y->glides;
}

bool himc_music_shape(music *m, midi_file *file, himc_error *error)
{
    shaper s = {.music = m, .file = file, .error = error};
    int parts = 0;
    mark_attacks(m);
    join_ties(m);
    for (int i = 0; i < m->note_count; i++)
        parts = m->notes[i].at.part >= parts ? m->notes[i].at.part + 1 : parts;
    for (int part = 0; part < parts; part++)
        if (!shape_part(&s, part))
            return false;
    if (file->note_count > 0)
        qsort(file->notes, (size_t)file->note_count, sizeof *file->notes, by_time);
    if (file->order_count > 0)
        qsort(file->orders, (size_t)file->order_count, sizeof *file->orders, by_order);
    file->tracks = parts;
    return true;
}
