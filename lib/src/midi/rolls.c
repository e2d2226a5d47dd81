/// rolls.c: which fast repeats of the timpani are rolls.
///
/// A roll in a MIDI file is a row of notes as fast as its maker could; a player plays as many
/// strokes as drum and dynamic ask for. So strokes of one drum at 9 a second and more, 32nds at 8,
/// four at least, with no other drum between them, become a `roll` from the first to the end of the
/// last, and those of two drums at the same times a roll on both. Four have to come before a hand
/// goes to the next drum: fewer are a figure, whose rhythm counts. Where the dynamics do not lie on
/// a line, another roll begins. The drum channel has no rolls: there such rows are fills.
#include "base/argument.h"
#include "midi/part.h"

#include <math.h>

#define SLOWEST 9.0      // strokes of a roll (1/s)
#define SLOWEST_32ND 7.9 // of 32nds, as programs write a tremolo of three strokes
#define LEAST_NOTES 4    // of a roll
#define MOST_NOTES 1000  // of a roll; chosen: a minute of a fast one
#define LONGEST 60.0     // (s) chosen: the score's limit less a last stroke at the slowest tempo
#define MOVE_TIME 0.5  // from its last stroke to one on another drum (s); chosen: sticking.c's need
#define SAME_TIME 0.01 // (s) as himc_midi_join
#define LONG 2.5       // gaps of a row; chosen
#define MOST_OFF_LINE 0.06 // of the dynamics from a straight line; chosen: less than half a step

/// The next stroke that is played, -1 after the last.
static int next_played(const midi_part *part, int index)
{
    while (++index < part->count)
        if (part->stroke[index].fate == MIDI_PLAYED)
            return index;
    return -1;
}

static bool is_fast(const midi_note *a, const midi_note *b)
{
    double gap = b->seconds - a->seconds;
    bool thirty_second = fabs(b->beat - a->beat - 0.125) < 1e-3;
    return gap <= 1 / (thirty_second ? SLOWEST_32ND : SLOWEST);
}

/// Strokes of one drum in a row, or of two drums at the same times.
typedef struct row {
    int first, second; ///< of each drum; -1: of one only
    int end, before;   ///< the last stroke of the first drum, and the one before it
    int notes;         ///< of each drum
} row;

// the stroke on another drum at the same time, if it comes next; else -1
static int partner_of(const midi_part *part, int stroke)
{
    int next = next_played(part, stroke);
    const midi_stroke *s = part->stroke;
    bool together = next >= 0 && s[next].head != s[stroke].head &&
                    s[next].note->seconds - s[stroke].note->seconds < SAME_TIME;
    return together ? next : -1;
}

// true if the dynamics of a drum from the first to the last lie on a line
static bool is_straight(const midi_part *part, int first, int last)
{
    const midi_stroke *a = &part->stroke[first], *b = &part->stroke[last];
    double time = b->note->seconds - a->note->seconds;
    for (int i = first; i != last; i = next_played(part, i)) {
        const midi_stroke *s = &part->stroke[i];
        double share = time > 0 ? (s->note->seconds - a->note->seconds) / time : 0;
        if (s->head == a->head &&
            fabs(s->dynamic - a->dynamic - share * (b->dynamic - a->dynamic)) > MOST_OFF_LINE)
            return false;
    }
    return true;
}

// the last stroke of a row that ends with that of the first drum
static int last_of(const midi_part *part, const row *r, int end)
{
    return r->second < 0 ? end : next_played(part, end);
}

// true if the row goes on with its next stroke, or its next two
static bool goes_on(const midi_part *part, row *r)
{
    const midi_stroke *s = part->stroke;
    int next = next_played(part, last_of(part, r, r->end));
    int other = next >= 0 && r->second >= 0 ? partner_of(part, next) : -1;
    bool both = r->second < 0 || (other >= 0 && s[other].head == s[r->second].head &&
                                  is_straight(part, r->second, other));
    if (next < 0 || !both || r->notes == MOST_NOTES || s[next].head != s[r->first].head ||
        s[next].roll.length > 0 || !is_fast(s[r->end].note, s[next].note) ||
        s[next].note->seconds - s[r->first].note->seconds > LONGEST ||
        !is_straight(part, r->first, next))
        return false;
    r->before = r->end;
    r->end = next;
    r->notes++;
    return true;
}

// The last of some short notes is the stroke that they lead to if it lasts much longer.
static void leave_aim(const midi_part *part, row *r)
{
    const midi_note *last = part->stroke[r->end].note, *before = part->stroke[r->before].note;
    double gap = last->seconds - before->seconds;
    if (r->second >= 0 || r->notes <= LEAST_NOTES || last->off - last->seconds < LONG * gap ||
        before->off - before->seconds >= LONG * gap)
        return;
    r->end = r->before;
    r->notes--;
}

// true if enough notes of a row come so early that a hand could still go to the next drum
static bool is_sure(const midi_part *part, const row *r)
{
    const midi_stroke *s = part->stroke;
    int next = r->end, sure = 0;
    while (next >= 0 && s[next].head == s[r->first].head)
        next = next_played(part, next);
    double until = next >= 0 && r->second < 0 ? s[next].note->seconds - MOVE_TIME : HUGE_VAL;
    for (int i = r->first; sure < LEAST_NOTES && s[i].note->seconds <= until; sure++) {
        if (i == r->end)
            return sure + 1 == LEAST_NOTES;
        i = next_played(part, last_of(part, r, i));
    }
    return sure == LEAST_NOTES;
}

static bool make_roll(midi_part *part, const row *r)
{
    const himc_argument *range = himc_argument_find("LENGTH", "roll");
    const midi_file *f = part->file;
    midi_stroke *s = part->stroke;
    // the last stroke lasts as long as the others
    double beat = s[r->first].note->beat, beats = s[r->end].note->beat - beat,
           length = r->notes > 1 ? beats * r->notes / (r->notes - 1) : 0;
    if (r->notes < LEAST_NOTES || !is_sure(part, r) || length < range->low || length > range->high)
        return false;
    double end = himc_score_seconds(f->tempi, f->tempo_count, beat + length);
    int last = last_of(part, r, r->end);
    for (int k = r->first; k != last;)
        s[k = next_played(part, k)].in_roll = true;
    s[r->first].roll = (midi_roll){length, s[r->end].dynamic, end};
    if (r->second >= 0) {
        s[r->second].in_roll = false;
        s[r->second].roll = (midi_roll){length, s[last].dynamic, end};
    }
    return true;
}

void himc_midi_find_rolls(midi_part *part)
{
    for (int first = next_played(part, -1); first >= 0;) {
        row r = {first, partner_of(part, first), first, first, 1};
        while (part->stroke[first].roll.length == 0 && goes_on(part, &r))
            ;
        leave_aim(part, &r);
        int last = make_roll(part, &r) ? last_of(part, &r, r.end) : first;
        first = next_played(part, last);
    }
}
