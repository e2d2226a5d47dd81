/// instruments.c: the instruments of a part, and which of them a written note is for.
///
/// A row for each score-instrument, by its name, its sound, then its MIDI instrument; without any
/// by the part's name. Words add rows. A name that is no instrument here is kept: its notes are
/// told by it. Invariant: there is a first row.
#include "musicxml/instruments.h"

#include "midi/part.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/// Where drums are written; the first row of a place is the drum of a note that says no more, the
/// first of a key where it is printed.
static const struct {
    int key, at;
    bool metal;
} places[] = {
    {44, 62, true},  {36, 65, false}, {36, 64, false},
    {35, 65, false}, {41, 67, false}, {43, 69, false},
    {45, 71, false}, {38, 72, false}, {47, 74, false},
    {50, 76, false}, {48, 76, false}, {51, 77, true},
    {53, 77, true},  {59, 77, true},  {42, 79, true},
    {46, 79, true},  {49, 81, true},  {55, 81, true},
    {57, 83, true},  {52, 83, true},  {MIDI_BASS_DRUM, 65, false},
};

#define PLACES (sizeof places / sizeof *places)

static int drum_at(int written)
{
    for (size_t i = 0; i < PLACES; i++)
        if (places[i].at == written)
            return places[i].key;
    return 38;
}

int himc_music_place(int key, bool *metal)
{
    size_t i = 0;
    while (i < PLACES && places[i].key != key)
        i++;
    *metal = i < PLACES && places[i].metal;
    return i < PLACES ? places[i].at : 72;
}

void himc_music_places(const bool used[MIDI_KEY_COUNT], int place[MIDI_KEY_COUNT],
                       bool others[MIDI_KEY_COUNT])
{
    static const int staff[] = {79, 77, 76, 74, 72, 71, 69, 67, 65};
    enum { PLACES_OF_STAFF = sizeof staff / sizeof *staff, BLOCK = MIDI_LOW_TEMPLE_BLOCK };
    // clang-format off
    static const int sounds[] = { // from high to low
        80, 81, 67, 68,                          // triangle, agogos
        MIDI_HIGH_COWBELL, 56, MIDI_LOW_COWBELL,
        75, 76, MIDI_MIDDLE_BLOCK, 77,           // claves, wood blocks
        BLOCK + 4, BLOCK + 3, BLOCK + 2, BLOCK + 1, BLOCK, MIDI_TEMPLE_BLOCKS,
        54, 60, 61, 65, 66, 62, 63, 64,          // tambourine, bongos, timbales, congas
        MIDI_BASS_DRUM, MIDI_TAM_TAM};
    // clang-format on
    int left[PLACES_OF_STAFF], room = 0, count = 0, next = 0;
    bool metal, taken[128] = {false};
    for (int key = 0; key < MIDI_KEY_COUNT; key++) {
        place[key] = himc_music_place(key, &metal);
        others[key] = false;
    }
    for (size_t i = 0; i < sizeof sounds / sizeof *sounds; i++)
        count += others[sounds[i]] = used[sounds[i]];
    for (int key = 0; key < MIDI_KEY_COUNT; key++)
        taken[place[key]] |= used[key] && !others[key];
    for (int i = 0; i < PLACES_OF_STAFF; i++)
        if (!taken[staff[i]])
            left[room++] = staff[i];
    for (size_t i = 0; i < sizeof sounds / sizeof *sounds; i++)
        if (others[sounds[i]])
            place[sounds[i]] = left[(2 * next++ + 1) * room / (2 * count)];
}

int himc_music_staff(const xml_node *node)
{
    return abs(himc_xml_whole(node, "staff", 0)) % MUSIC_STAVES;
}

// the drums that a name lists, from high to low; returns how many
static int list_names(const char *name, int keys[MUSIC_NAMES_MAX])
{
    bool used[MIDI_KEY_COUNT] = {false}, others[MIDI_KEY_COUNT];
    int place[MIDI_KEY_COUNT], count = 0;
    for (size_t length; *name; name += length + (name[length] != '\0')) {
        char word[64];
        int key;
        length = strcspn(name, ",/&+()");
        snprintf(word, sizeof word, "%.*s", (int)length, name);
        if (himc_music_instrument(word, &key) == MIDI_DRUMS && key >= 0 && key < MIDI_NO_SOUND)
            used[key] = true;
    }
    himc_music_places(used, place, others);
    for (int at = 127; at >= 0; at--)
        for (int key = 0; key < MIDI_NO_SOUND; key++)
            if (used[key] && place[key] == at && count < MUSIC_NAMES_MAX)
                keys[count++] = key;
    return count;
}

// An instrument's name says more than the id of its sound: "Kick Drum" of drum.bass-drum. A cymbal
// is any.
static midi_choice choose_name(const char *sound, const char *name, int *key)
{
    const int cymbal = 49;
    int said = MUSIC_NO_KEY;
    midi_choice of_sound = himc_music_instrument(sound, key),
                of_name = himc_music_instrument(name, &said);
    bool drums = of_name == MIDI_DRUMS && (of_sound == MIDI_DRUMS || of_sound == MIDI_ANY);
    if (of_sound != MIDI_ANY && (!drums || said < 0 || (said == cymbal && *key >= 0)))
        return of_sound;
    *key = said;
    return of_name;
}

// by the names first, then by the MIDI instrument
static void read_instrument(music_instruments *of, const xml_node *list, const xml_node *score,
                            midi_choice part, int part_key)
{
    music_instrument *made = &of->row[of->count++];
    const char *id = himc_xml_attribute(score, "id");
    *made = (music_instrument){id, "", .key = MUSIC_NO_KEY};
    const char *const name[] = {himc_xml_text(score, "instrument-sound"),
                                himc_xml_text(score, "instrument-name"),
                                himc_xml_text(score, "instrument-abbreviation")};
    made->choice = choose_name(name[0], name[1], &made->key);
    if (made->choice == MIDI_ANY)
        made->choice = himc_music_instrument(name[2], &made->key);
    for (int i = 1; i >= 0 && !made->name[0]; i--)
        made->name = himc_music_names(name[i]) ? name[i] : "";
    made->drum = himc_music_drum(name[1]);
    // only the name of the one instrument of a part may be unknown: the part's says what it is
    bool single = !himc_xml_next(himc_xml_child(list, "score-instrument")),
         only = single && (part != MIDI_DRUMS || part_key >= 0);
    const xml_node *midi = himc_xml_child(list, "midi-instrument");
    while (midi && !himc_xml_has(midi, "id", made->id))
        midi = himc_xml_next(midi);
    int key = himc_xml_whole(midi, "midi-unpitched", 0) - 1;
    int program = himc_xml_whole(midi, "midi-program", 0) - 1;
    bool drums = himc_xml_number(midi, "midi-channel", 0) == 10;
    if (made->choice == MIDI_ANY && part != MIDI_ANY && (only || !made->name[0]))
        *made = (music_instrument){id, made->name, .choice = part, .key = part_key};
    if (made->choice == MIDI_ANY && midi && !drums)
        made->choice = himc_midi_program_choice(program);
    if (made->choice == MIDI_ANY && (drums || part != MIDI_ANY)) {
        made->choice = MIDI_DRUMS;
        made->key = made->name[0] && key < 0 ? MIDI_NO_SOUND : MUSIC_NO_KEY;
    }
    // the MIDI key decides, unless both names say a concert instrument, which General MIDI lacks
    bool concert = made->key >= 128 && part_key >= 128;
    made->concert = made->choice == MIDI_DRUMS && made->key == MIDI_BASS_DRUM;
    made->sort = made->choice == MIDI_DRUMS && himc_music_of_sort(made->key, 0, 2) != made->key;
    if (made->choice == MIDI_DRUMS && key >= 0 && key < 128 && !concert &&
        made->key != MIDI_NO_SOUND) {
        made->key = key;
        made->sort = false;
        return;
    }
    if (made->choice == MIDI_DRUMS)
        made->names = list_names(name[1], made->of);
    if (made->choice == MIDI_DRUMS && made->names < 2 && single)
        made->names = list_names(himc_xml_text(list, "part-name"), made->of);
}

int himc_music_pitch(const xml_node *note)
{
    static const int natural[] = {9, 11, 0, 2, 4, 5, 7};
    const xml_node *pitch = himc_xml_child(note, "pitch"),
                   *of = pitch ? pitch : himc_xml_child(note, "unpitched");
    const char *letter = himc_xml_text(of, pitch ? "step" : "display-step");
    if (letter[0] < 'A' || letter[0] > 'G')
        return -1;
    return natural[letter[0] - 'A'] +
           12 * (himc_xml_whole(of, pitch ? "octave" : "display-octave", 4) + 1) +
           himc_xml_whole(of, "alter", 0);
}

// the entry that a note names; -1: none
static int find_instrument(const music_instruments *of, const xml_node *named)
{
    const char *id = himc_xml_attribute(named, "id");
    for (int i = 0; i < of->declared && id[0]; i++)
        if (strcmp(of->row[i].id, id) == 0)
            return i;
    return -1;
}

// where drums of one sort are written
static void survey(music_instruments *of, const xml_node *part)
{
    bool any = false;
    for (int i = 0; i < of->count; i++)
        any |= of->row[i].sort || of->row[i].names > 1;
    const xml_node *measure = any ? himc_xml_child(part, "measure") : NULL;
    for (; measure; measure = himc_xml_next(measure))
        for (const xml_node *n = himc_xml_child(measure, "note"); n; n = himc_xml_next(n)) {
            int i = find_instrument(of, himc_xml_child(n, "instrument")),
                written = himc_music_pitch(n);
            if (written >= 0 && written < 128)
                of->row[i < 0 ? 0 : i].at[written / 64] |= (uint64_t)1 << written % 64;
        }
}

static bool is_kick(int key)
{
    return key == 35 || key == 36;
}

// hi-hats, toms, rides
static bool is_of_kit(int key)
{
    return key >= 41 && key <= 59 && !memchr((const char[]){49, 52, 54, 55, 56, 57, 58}, key, 7);
}

void himc_music_choose_bass_drum(const music_instruments *of, music *m, int first)
{
    bool kit = false, roll = false;
    for (int i = 0; i < of->declared; i++)
        kit |= of->row[i].choice == MIDI_DRUMS && is_of_kit(of->row[i].key);
    for (int i = first; i < m->note_count; i++) {
        const music_note *n = &m->notes[i];
        kit |= n->choice == MIDI_DRUMS && is_of_kit(n->key);
        roll |= n->choice == MIDI_DRUMS && is_kick(n->key) &&
                (n->tremolo == MUSIC_ROLL || (n->tremolo == MUSIC_MARKS && n->marks > 2));
    }
    for (int i = first; i < m->note_count && !kit; i++) {
        music_note *n = &m->notes[i];
        bool named = n->concert && of->part_key != MUSIC_NO_KEY;
        if (n->choice == MIDI_DRUMS && is_kick(n->key) && (roll || named))
            n->key = MIDI_BASS_DRUM;
    }
}

void himc_music_instruments_read(music_instruments *of, const xml_node *list, const xml_node *part)
{
    int key = MUSIC_NO_KEY;
    midi_choice choice = himc_music_instrument(himc_xml_text(list, "part-name"), &key);
    if (choice == MIDI_ANY)
        choice = himc_music_instrument(himc_xml_text(list, "part-abbreviation"), &key);
    *of = (music_instruments){.part_key = choice == MIDI_ANY ? MUSIC_ANY_KEY : key};
    memset(of->current, -1, sizeof of->current);
    const xml_node *score = himc_xml_child(list, "score-instrument");
    // without one each of the names "Timpani, Xylophone" is
    const char *name = himc_xml_text(list, "part-name");
    for (size_t length; !score && of->count < MUSIC_INSTRUMENTS_MAX; name += length + 1) {
        char word[64];
        length = strcspn(name, ",/&+");
        music_instrument made = {"", himc_xml_text(list, "part-name"), .choice = choice,
                                 .key = key};
        snprintf(word, sizeof word, "%.*s", (int)length, name);
        if (of->count > 0 || name[length])
            made.choice = himc_music_instrument(word, &made.key);
        made.sort = made.choice == MIDI_DRUMS && himc_music_of_sort(made.key, 0, 2) != made.key;
        if (made.choice != MIDI_ANY || (!name[length] && of->count == 0))
            of->row[of->count++] = made;
        if (!name[length])
            break;
    }
    if (of->count > 0 && of->row[0].choice == MIDI_DRUMS)
        of->row[0].names = list_names(himc_xml_text(list, "part-name"), of->row[0].of);
    for (; score && of->count < MUSIC_INSTRUMENTS_MAX; score = himc_xml_next(score))
        read_instrument(of, list, score, choice, key);
    of->declared = of->count;
    survey(of, part);
}

void himc_music_instruments_attributes(music_instruments *of, const xml_node *attributes)
{
    of->staves |= himc_xml_whole(attributes, "staves", 1) > 1;
    for (const xml_node *a = attributes->child; a; a = a->next) {
        int staff = atoi(himc_xml_attribute(a, "number"));
        staff = staff > 1 && staff < MUSIC_STAVES ? staff : 1; // a note of one staff may say 0
        if (himc_xml_is(a, "clef"))
            of->clef[staff] = himc_xml_text(a, "sign")[0];
        else if (himc_xml_is(a, "staff-details"))
            of->lines[staff] = himc_xml_whole(a, "staff-lines", 5);
    }
    of->clef[0] = of->clef[1];
    of->lines[0] = of->lines[1];
}

void himc_music_instruments_change(music_instruments *of, int staff, const char *words,
                                   bool instructs)
{
    int key, i = 0;
    bool bare;
    midi_choice choice = himc_music_change(words, &key, &bare);
    // of a drum set, or where notes say it, a name alone is no more than a hint
    bool hint = instructs || of->declared > 1 || of->row[0].key == MUSIC_NO_KEY;
    if (choice == MIDI_ANY || (bare && hint))
        return;
    while (i < of->count && (of->row[i].choice != choice || of->row[i].key != key))
        i++;
    if (i == MUSIC_INSTRUMENTS_MAX)
        return;
    if (i == of->count)
        of->row[of->count++] = (music_instrument){"", words, .choice = choice, .key = key};
    of->current[of->staves ? staff : 0] = i;
}

void himc_music_instruments_sound(music_instruments *of, int staff, const xml_node *change)
{
    int key = MUSIC_NO_KEY, i = find_instrument(of, change);
    const char *name = himc_xml_text(change, "instrument-sound");
    midi_choice choice = himc_music_instrument(name, &key);
    if (choice != MIDI_ANY && i >= 0)
        of->row[i] = (music_instrument){of->row[i].id, name, .choice = choice, .key = key};
    if (i >= 0)
        of->current[of->staves ? staff : 0] = i;
}

// the first instrument from one kind up to another; of several a clef says which
static int of_clef(const music_instruments *of, const xml_node *note)
{
    char clef = of->clef[himc_music_staff(note)];
    bool pitched = himc_xml_child(note, "pitch");
    midi_choice first = !pitched      ? MIDI_DRUMS
                        : clef == 'F' ? MIDI_TIMPANI
                                      : MIDI_MARIMBA,
                last = pitched && clef != 'F' ? MIDI_TUBULAR_BELL : first;
    for (int i = 0; i < of->declared; i++)
        if (of->row[i].choice >= first && of->row[i].choice <= last)
            return i;
    return 0;
}

const music_instrument *himc_music_instrument_of(const music_instruments *of, const xml_node *note)
{
    int named = find_instrument(of, himc_xml_child(note, "instrument")),
        current = of->current[himc_music_staff(note)];
    current = current < 0 ? of->current[0] : current;
    if (named >= 0 && (of->declared > 1 || current < 0))
        return &of->row[named];
    return &of->row[current >= 0 ? current : of_clef(of, note)];
}

int himc_music_drum_of(const music_instruments *of, const xml_node *note,
                       const music_instrument *instrument, int written)
{
    int above = 0, count = 0, nearest = 0;
    for (int k = 0; k < 128; k++)
        if (instrument->at[k / 64] >> k % 64 & 1) {
            above += k > written;
            count++;
        }
    for (int i = 0; i < instrument->names; i++) {
        bool metal;
        int key = instrument->of[i], best = instrument->of[nearest];
        if (abs(himc_music_place(key, &metal) - written) <
            abs(himc_music_place(best, &metal) - written))
            nearest = i;
    }
    if (instrument->names > 1)
        return instrument->of[count == instrument->names ? above : nearest];
    if (instrument->key >= 0)
        return instrument->sort ? himc_music_of_sort(instrument->key, above, count)
                                : instrument->key;
    bool other = himc_xml_child(note, "pitch") && of->declared > 1;
    return other || of->lines[himc_music_staff(note)] == 1 ? MIDI_NO_SOUND : drum_at(written);
}
