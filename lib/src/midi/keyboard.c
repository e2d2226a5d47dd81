/// keyboard.c: marimba, xylophone, vibraphone, glockenspiel: which bar a note is.
///
/// The instrument has the bars from the lowest to the highest note, an octave at least; a note
/// beyond what is built is moved by octaves.
#include "midi/part.h"

#include "base/format.h"

#define FIRST MIDI_MARIMBA

/// What is built, and its bars as a player's hands find them.
static const struct {
    const char *name;
    int program, low, high; // (MIDI keys)
    double pitch;           // from natural to natural, about (m)
} boards[] = {
    [MIDI_MARIMBA - FIRST] = {"marimba", 12, 45, 96, .05},
    [MIDI_XYLOPHONE - FIRST] = {"xylophone", 13, 65, 108, .045},
    [MIDI_VIBRAPHONE - FIRST] = {"vibraphone", 11, 53, 89, .05},
    [MIDI_GLOCKENSPIEL - FIRST] = {"glockenspiel", 9, 79, 108, .034},
};

bool himc_midi_is_keyboard(midi_choice choice, int program)
{
    return choice >= FIRST && choice < MIDI_CHOICES && boards[choice - FIRST].program == program;
}

static const char *const notes[] = {"C",  "C#", "D",  "D#", "E",  "F",
                                    "F#", "G",  "G#", "A",  "A#", "B"};

// naturals below a key, and whether it is one
static int naturals(int key)
{
    static const int below[] = {0, 1, 1, 2, 2, 3, 4, 4, 5, 5, 6, 6};
    return 7 * (key / 12) + below[key % 12];
}

void himc_midi_keyboard(midi_part *part)
{
    int low = boards[part->choice - FIRST].low, high = boards[part->choice - FIRST].high;
    int first = high, last = low;
    for (int i = 0; i < part->count; i++) {
        midi_stroke *s = &part->stroke[i];
        while (s->key < low)
            s->key += 12;
        while (s->key > high)
            s->key -= 12;
        part->moved += s->key != s->note->key;
        first = s->key < first ? s->key : first;
        last = s->key > last ? s->key : last;
    }
    for (bool up = true; last - first < 12; up = !up) {
        if (up && last < high)
            last++;
        else if (first > low)
            first--;
    }
    const char *name = boards[part->choice - FIRST].name;
    midi_head *head = &part->head[part->heads++];
    *head = (midi_head){.name = name, .x = .45, .z = .87, .key = MIDI_UNTUNED};
    himc_format(head->made, sizeof head->made, "%s %s%d %s%d", name, notes[first % 12],
                first / 12 - 1, notes[last % 12], last / 12 - 1);
    double pitch = boards[part->choice - FIRST].pitch,
           middle = .5 * (naturals(first) + naturals(last));
    for (int i = 0; i < part->count; i++) {
        midi_stroke *s = &part->stroke[i];
        bool natural = notes[s->key % 12][1] == '\0';
        s->x = natural ? -.07 : .07; // (m) about, of the two rows
        s->y = pitch * (middle - naturals(s->key) + (natural ? 0 : .5));
        himc_format(s->part, sizeof s->part, "%s%d", notes[s->key % 12], s->key / 12 - 1);
    }
    himc_midi_join(part);
}
