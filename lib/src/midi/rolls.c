/// rolls.c: which fast repeats of the timpani are rolls.
///
/// A roll in a MIDI file is a row of notes as fast as its maker could; a player plays as many
/// strokes as drum and dynamic ask for. So strokes of one drum at 9 a second and more, 32nds at 8,
/// four at least, with no other drum between them, become a `roll` from the first to the end of the
/// last. Where the dynamics do not lie on a line, another roll begins. The drum channel has no
/// rolls: there such rows are fills, whose rhythm counts.
#include "base/argument.h"
#include "midi/part.h"

#include <math.h>

#define SLOWEST 9.0      // strokes of a roll (1/s)
#define SLOWEST_32ND 7.9 // of 32nds, as programs write a tremolo of three strokes
#define LEAST_NOTES 4    // of a roll
#define MOST_NOTES 1000  // of a roll; chosen: a minute of a fast one
#define LONGEST 60.0     // (s) chosen: the score's limit less a last stroke at the slowest tempo
#define MOVE_TIME 0.5 // from its last stroke to one on another drum (s); chosen: sticking.c's need
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

// true if the dynamics from the first to the last lie on a line
static bool is_straight(const midi_part *part, int first, int last)
{
    const midi_stroke *a = &part->stroke[first], *b = &part->stroke[last];
    double time = b->note->seconds - a->note->seconds;
    for (int i = first; i != last; i = next_played(part, i)) {
        const midi_stroke *s = &part->stroke[i];
        double share = time > 0 ? (s->note->seconds - a->note->seconds) / time : 0;
        if (fabs(s->dynamic - a->dynamic - share * (b->dynamic - a->dynamic)) > MOST_OFF_LINE)
            return false;
    }
    return true;
}

// A roll ends early enough for a hand to go to the next drum: the strokes after it keep the hands
// that sticking.c gave them, one of which may go ahead.
void himc_midi_find_rolls(midi_part *part)
{
    const himc_argument *range = himc_argument_find("LENGTH", "roll");
    midi_stroke *s = part->stroke;
    for (int first = next_played(part, -1), last; first >= 0; first = next_played(part, last)) {
        int end = first, row = 1, next, notes = 1;
        if (s[last = first].roll.length > 0)
            continue;
        while (row < MOST_NOTES && (next = next_played(part, end)) >= 0 &&
               s[next].head == s[first].head && s[next].roll.length == 0 &&
               is_fast(s[end].note, s[next].note) &&
               s[next].note->seconds - s[first].note->seconds <= LONGEST &&
               is_straight(part, first, next)) {
            end = next;
            row++;
        }
        next = end;
        while (next >= 0 && s[next].head == s[first].head)
            next = next_played(part, next);
        double until = next >= 0 ? s[next].note->seconds - MOVE_TIME : HUGE_VAL;
        last = first;
        while (last != end && s[next_played(part, last)].note->seconds <= until) {
            last = next_played(part, last);
            notes++;
        }
        // the last stroke lasts as long as the others
        double beats = s[last].note->beat - s[first].note->beat;
        double length = notes >= LEAST_NOTES ? beats * notes / (notes - 1) : 0;
        if (length < range->low || length > range->high) {
            last = first;
            continue;
        }
        s[first].roll = (midi_roll){length, s[last].dynamic};
        for (int k = first; k != last;)
            s[k = next_played(part, k)].in_roll = true;
        part->rolls++;
        part->rolled += notes;
    }
}
