/// keyboard.c: marimba, xylophone, vibraphone, glockenspiel, tubular bells: which bar a note is.
///
/// The instrument has the bars from the lowest to the highest note, an octave at least. Where more
/// notes fit what is built then, all are moved by octaves, so that intervals stay; a note that is
/// still beyond it is moved alone.
#include "midi/part.h"

#include "base/format.h"
#include "base/setups.h"

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
    [MIDI_TUBULAR_BELL - FIRST] = {"tubular-bell", 14, 60, 77, .058},
};

midi_choice himc_midi_program_choice(int program)
{
    const int timpani = 47; // "48 Timpani" of General MIDI, which counts from 1
    for (int i = FIRST; i < MIDI_CHOICES; i++)
        if (boards[i - FIRST].program == program)
            return (midi_choice)i;
    return program == timpani ? MIDI_TIMPANI : MIDI_ANY;
}

static const char *const notes[] = {"C",  "C#", "D",  "D#", "E",  "F",
                                    "F#", "G",  "G#", "A",  "A#", "B"};

void himc_midi_key_name(char name[HIMC_NOTE_SIZE], int key)
{
    himc_format(name, HIMC_NOTE_SIZE, "%s%d", notes[key % 12], key / 12 - 1);
}

// naturals below a key, and whether it is one
static int naturals(int key)
{
    static const int below[] = {0, 1, 1, 2, 2, 3, 4, 4, 5, 5, 6, 6};
    return 7 * (key / 12) + below[key % 12];
}

// by how many octaves all notes move so that most fit; as few as do
static int octaves_of(const midi_part *part, int low, int high)
{
    int best = 0, most = -1;
    for (int k = 0; k <= 20; k++) { // 0 1 -1 2 ..
        int octaves = k % 2 ? (k + 1) / 2 : -k / 2, fit = 0;
        for (int i = 0; i < part->count; i++) {
            int key = part->stroke[i].key + 12 * octaves;
            fit += key >= low && key <= high;
        }
        if (fit > most) {
            most = fit;
            best = octaves;
        }
    }
    return best;
}

void himc_midi_keyboard(midi_part *part)
{
    int low = boards[part->choice - FIRST].low, high = boards[part->choice - FIRST].high;
    int first = high, last = low, octaves = octaves_of(part, low, high);
    part->octaves[part->choice] = octaves;
    for (int i = 0; i < part->count; i++) {
        midi_stroke *s = &part->stroke[i];
        s->key += 12 * octaves;
        while (s->key < low)
            s->key += 12;
        while (s->key > high)
            s->key -= 12;
        part->moved += s->key != s->note->key + 12 * octaves;
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
    const char *made;
    int length;
    double place[4] = {.45, 0, .87}; // (m) of what lies
    if (part->choice == MIDI_TUBULAR_BELL)
        himc_setup_find(himc_setup_bells, "bells", &made, &length, place);
    *head = (midi_head){.name = name, .x = place[0], .z = place[2], .key = MIDI_UNTUNED};
    char low_name[HIMC_NOTE_SIZE], high_name[HIMC_NOTE_SIZE];
    himc_midi_key_name(low_name, first);
    himc_midi_key_name(high_name, last);
    himc_format(head->made, sizeof head->made, "%s %s %s", name, low_name, high_name);
    double pitch = boards[part->choice - FIRST].pitch,
           middle = .5 * (naturals(first) + naturals(last));
    head->depth = 4 * pitch; // about, of two rows
    head->side = 0.5 * pitch * (naturals(last) - naturals(first) + 1);
    for (int i = 0; i < part->count; i++) {
        midi_stroke *s = &part->stroke[i];
        bool natural = notes[s->key % 12][1] == '\0';
        s->x = natural ? -.07 : .07; // (m) about, of the two rows
        s->y = pitch * (middle - naturals(s->key) + (natural ? 0 : .5));
        himc_midi_key_name(s->part, s->key);
    }
    himc_midi_join(part);
}
