/// kit.c: the drum channel of General MIDI: which instrument a key is, where it is struck, by hand
/// or foot, and what stands in for what a percussionist here does not have.
///
/// The instruments stand as in the set-ups (setups.c). A hi-hat is opened and closed by its pedal
/// before the stroke.
#include "midi/part.h"

#include "base/head_frame.h"
#include "base/setups.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum how { BY_HAND, BY_FOOT, CLOSED, OPENED, PEDALLED };

/// A key of General MIDI's percussion map.
typedef struct gm_key {
    const char *sound;
    const char *instrument; ///< NULL: none here
    enum how how;
    himc_spot spot;
    bool instead;     ///< it is another sound: that is told
    const char *part; ///< of the instrument; NULL: all of it
} gm_key;

#define FIRST_KEY 31

static const gm_key keys[] = {
    {"sticks", "snare", BY_HAND, HIMC_SPOT_CLICK, false, NULL},
    {"square click", NULL, BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"metronome click", NULL, BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"metronome bell", NULL, BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"acoustic bass drum", "kick", BY_FOOT, HIMC_SPOT_NORMAL, false, NULL},
    {"bass drum 1", "kick", BY_FOOT, HIMC_SPOT_NORMAL, false, NULL},
    {"side stick", "snare", BY_HAND, HIMC_SPOT_CROSSSTICK, false, NULL},
    {"acoustic snare", "snare", BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"hand clap", NULL, BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"electric snare", "snare", BY_HAND, HIMC_SPOT_RIMSHOT, true, NULL},
    {"low floor tom", "low-floor", BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"closed hi-hat", "hats", CLOSED, HIMC_SPOT_RIM, false, NULL},
    {"high floor tom", "floor", BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"pedal hi-hat", "hats", PEDALLED, HIMC_SPOT_NORMAL, false, NULL},
    {"low tom", "mid-tom", BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"open hi-hat", "hats", OPENED, HIMC_SPOT_RIM, false, NULL},
    {"low-mid tom", "tom", BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"high-mid tom", "tom", BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"crash cymbal 1", "crash", BY_HAND, HIMC_SPOT_RIM, false, NULL},
    {"high tom", "high-tom", BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"ride cymbal 1", "ride", BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"chinese cymbal", "china", BY_HAND, HIMC_SPOT_RIM, false, NULL},
    {"ride bell", "ride", BY_HAND, HIMC_SPOT_CENTER, false, NULL},
    {"tambourine", "tambourine", BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"splash cymbal", "splash", BY_HAND, HIMC_SPOT_RIM, false, NULL},
    {"cowbell", "cowbell", BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"crash cymbal 2", "crash-16", BY_HAND, HIMC_SPOT_RIM, false, NULL},
    {"vibraslap", NULL, BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"ride cymbal 2", "ride", BY_HAND, HIMC_SPOT_NORMAL, true, NULL},
    {"high bongo", "high-bongo", BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"low bongo", "low-bongo", BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"mute high conga", "high-conga", BY_HAND, HIMC_SPOT_CENTER, true, NULL},
    {"open high conga", "high-conga", BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"low conga", "low-conga", BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"high timbale", "high-timbale", BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"low timbale", "low-timbale", BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"high agogo", "agogo", BY_HAND, HIMC_SPOT_NORMAL, false, "high"},
    {"low agogo", "agogo", BY_HAND, HIMC_SPOT_NORMAL, false, "low"},
    {"cabasa", NULL, BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"maracas", NULL, BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"short whistle", NULL, BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"long whistle", NULL, BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"short guiro", NULL, BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"long guiro", NULL, BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"claves", "claves", BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"high wood block", "high-block", BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"low wood block", "low-block", BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"mute cuica", NULL, BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"open cuica", NULL, BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"mute triangle", "triangle", BY_HAND, HIMC_SPOT_NORMAL, true, NULL},
    {"open triangle", "triangle", BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
};

// what General MIDI does not have, from MIDI_BASS_DRUM on
static const gm_key concert[] = {
    {"bass drum", "bass-drum", BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"tam-tam", "tam-tam", BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"temple block", "temple-blocks", BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"low temple block", "temple-blocks", BY_HAND, HIMC_SPOT_NORMAL, false, "low"},
    {"second temple block", "temple-blocks", BY_HAND, HIMC_SPOT_NORMAL, false, "second"},
    {"third temple block", "temple-blocks", BY_HAND, HIMC_SPOT_NORMAL, false, "third"},
    {"fourth temple block", "temple-blocks", BY_HAND, HIMC_SPOT_NORMAL, false, "fourth"},
    {"high temple block", "temple-blocks", BY_HAND, HIMC_SPOT_NORMAL, false, "high"},
    {"middle wood block", "middle-block", BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"low cowbell", "low-cowbell", BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"high cowbell", "high-cowbell", BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
    {"other percussion", NULL, BY_HAND, HIMC_SPOT_NORMAL, false, NULL},
};

static const gm_key *find_key(int key)
{
    if (key >= MIDI_BASS_DRUM && key < MIDI_KEY_COUNT)
        return &concert[key - MIDI_BASS_DRUM];
    bool known = key >= FIRST_KEY && key < FIRST_KEY + (int)(sizeof keys / sizeof keys[0]);
    return known ? &keys[key - FIRST_KEY] : NULL;
}

// how well a key stands for that spot and part; another sound is worse
static int likeness(const gm_key *k, const char *part, himc_spot spot)
{
    return (strcmp(k->part ? k->part : "", part) == 0 ? 8 : 0) +
           (k->spot == spot               ? 4
            : k->spot == HIMC_SPOT_NORMAL ? 2
                                          : 0) -
           k->instead;
}

himc_spot himc_midi_key_spot(int key)
{
    const gm_key *k = find_key(key);
    return k ? k->spot : HIMC_SPOT_NORMAL;
}

int himc_midi_key_of(const char *instrument, const char *part, himc_spot spot, bool open)
{
    int found = -1;
    for (int key = FIRST_KEY; key < MIDI_KEY_COUNT; key++) {
        const gm_key *k = find_key(key);
        if (!k || !k->instrument || strcmp(k->instrument, instrument) != 0)
            continue;
        bool fits = k->how == CLOSED ? !open : k->how == OPENED ? open : k->how != PEDALLED;
        bool better = found < 0 || likeness(k, part, spot) > likeness(find_key(found), part, spot);
        if (fits && better)
            found = key;
    }
    return found;
}

const char *himc_midi_key_sound(int key)
{
    const gm_key *k = find_key(key);
    return k ? k->sound : "";
}

void himc_midi_join(midi_part *part)
{
    int last[2][MIDI_KEY_COUNT]; // by hand, by foot: a hi-hat may be struck as it is closed
    memset(last, -1, sizeof last);
    for (int i = 0; i < part->count; i++) {
        midi_stroke *s = &part->stroke[i];
        int *before = &last[s->foot][part->choice != MIDI_DRUMS || s->head < 0 ? s->key : s->head];
        if (s->fate != MIDI_PLAYED)
            continue;
        midi_stroke *first = *before >= 0 ? &part->stroke[*before] : NULL;
        // two notes within 0.01 s are one stroke; chosen: no flam is as close
        if (first && s->note->seconds - first->note->seconds < 0.01) {
            first->dynamic = fmax(first->dynamic, s->dynamic);
            s->fate = MIDI_TOGETHER;
        } else {
            *before = i;
        }
    }
}

double himc_midi_split_size(char *made)
{
    char *end = made + strcspn(made, " ");
    double size = atof(end);
    *end = '\0';
    return size;
}

// what a set-up makes of that name, and where; false if it has none
static bool find(const char *setup, midi_head *head)
{
    const char *made;
    int length;
    double place[4];
    if (!himc_setup_find(setup, head->name, &made, &length, place))
        return false;
    snprintf(head->made, sizeof head->made, "%.*s", length, made);
    head->x = place[0];
    head->y = place[1];
    head->z = place[2];
    head->tilt = place[3];
    return true;
}

const char *himc_midi_instrument_like(const char *name, const char *kind, double size,
                                      const char *const *used)
{
    const char *found = "";
    double least = HUGE_VAL;
    for (int key = FIRST_KEY; key < MIDI_KEY_COUNT; key++) {
        const gm_key *k = find_key(key);
        midi_head head = {.name = k && k->instrument ? k->instrument : ""};
        if (strcmp(head.name, name) == 0 && head.name[0])
            return head.name;
        if (!head.name[0] || (!find(himc_setup_kit, &head) && !find(himc_setup_around, &head)))
            continue;
        double inches = himc_midi_split_size(head.made),
               away = size <= 0    ? 0
                      : inches > 0 ? fabs(log(size / inches))
                                   : 0.2; // usual size
        for (const char *const *u = used; *u; u++)
            away += strcmp(*u, head.name) == 0 ? 10 : 0;
        if (strcmp(head.made, kind) == 0 && away < least) {
            least = away;
            found = head.name;
        }
    }
    return found;
}

int himc_midi_concert_key(const char *text, size_t size)
{
    int found = 0; // of two that fit the later row is the longer: "low temple block"
    for (int key = MIDI_BASS_DRUM; key < MIDI_NO_SOUND; key++) {
        const char *sound = find_key(key)->sound;
        size_t length = strlen(sound);
        if (size >= length && memcmp(text + size - length, sound, length) == 0 &&
            (size == length || text[size - length - 1] == ' '))
            found = key;
    }
    return found;
}

// the instrument of a set-up with that name, or else that of its kind nearest in size; its place
static bool find_own(const himc_score *setup, midi_head *head)
{
    midi_head usual = *head;
    const char *own = NULL;
    double *place[] = {&head->x, &head->y, &head->z, &head->tilt};
    if (!find(himc_setup_kit, &usual) && !find(himc_setup_around, &usual))
        return false;
    double inches = himc_midi_split_size(usual.made), least = HUGE_VAL;
    for (int i = 0; i < setup->line_count; i++) {
        const himc_command *c = &setup->lines[i].command;
        if (c->id != HIMC_COMMAND_INSTRUMENT || setup->lines[i].drum[0])
            continue;
        bool named = strcmp(c->atom[0].symbol, head->name) == 0,
             alike = strcmp(c->atom[1].symbol, usual.made) == 0;
        double away = c->count > 2 ? fabs(c->atom[2].number - inches) : 0;
        away = named ? -1 : away;
        if ((named || alike) && away < least) {
            least = away;
            own = c->atom[0].symbol;
        }
    }
    if (!own)
        return false;
    head->name = own;
    for (int i = 0; i < setup->line_count; i++) {
        const himc_command *c = &setup->lines[i].command;
        for (int k = 0; c->id == HIMC_COMMAND_PLACE && k < c->count && k < 4; k++)
            if (strcmp(setup->lines[i].drum, own) == 0)
                *place[k] = c->atom[k].number;
    }
    return true;
}

// the index of an instrument of the part, which gets it if it is new; -1: there is none, or too
// many
static int head_of(midi_part *part, const char *name)
{
    midi_head own = {.name = name, .key = MIDI_UNTUNED};
    if (part->setup && !find_own(part->setup, &own))
        return -1;
    name = own.name;
    for (int i = 0; i < part->heads; i++)
        if (strcmp(part->head[i].name, name) == 0)
            return i;
    if (part->heads + part->taken == MIDI_HEADS)
        return -1;
    midi_head *head = &part->head[part->heads];
    *head = own;
    if (!part->setup && !find(himc_setup_kit, head) && !find(himc_setup_around, head))
        return -1;
    char made[sizeof head->made];
    snprintf(made, sizeof made, "%s", head->made);
    double inches = himc_midi_split_size(made);
    head->radius = inches > 0 && inches < 50 ? 0.0127 * inches : 0.1; // (m), of what is small
    head->side = strcmp(made, "temple-blocks") == 0 ? 0.2 : 0;
    return part->heads++;
}

static bool has_hoop(const char *instrument)
{
    return strcmp(instrument, "snare") == 0 || strstr(instrument, "tom") ||
           strstr(instrument, "floor") || strstr(instrument, "timbale");
}

void himc_midi_kit(midi_part *part)
{
    for (int i = 0; i < part->count; i++) {
        midi_stroke *s = &part->stroke[i];
        const gm_key *key = find_key(s->key);
        s->head = key && key->instrument ? head_of(part, key->instrument) : -1;
        if (s->head < 0) {
            s->fate = MIDI_NO_INSTRUMENT;
            continue;
        }
        if (himc_spot_is_beyond(s->spot) && !has_hoop(key->instrument))
            s->spot = HIMC_SPOT_NORMAL;
        s->spot = s->spot == HIMC_SPOT_NORMAL ? key->spot : s->spot;
        s->foot = key->how == BY_FOOT || key->how == PEDALLED;
        if (s->foot && s->roll.length > 0)
            s->fate = MIDI_FOOT_ROLL;
        s->pedal = key->how == OPENED ? MIDI_OPEN : key->how >= CLOSED ? MIDI_CLOSE : MIDI_AS_IT_IS;
        snprintf(s->part, sizeof s->part, "%s", key->part ? key->part : "");
    }
    himc_midi_join(part);
}

int himc_midi_tell_key(const midi_part *part, int key, char *line, size_t size)
{
    const gm_key *of = find_key(key);
    int missing = 0, played = 0;
    for (int i = 0; i < part->count; i++) {
        const midi_stroke *s = &part->stroke[i];
        bool of_key = s->choice == MIDI_DRUMS && s->key == key;
        missing += of_key && s->fate == MIDI_NO_INSTRUMENT;
        played += of_key && s->fate == MIDI_PLAYED;
    }
    *line = '\0';
    if (key == MIDI_NO_SOUND) // told by its name
        return missing;
    if (missing > 0 && of && of->instrument && part->setup && part->heads < MIDI_HEADS)
        snprintf(line, size, "%d of %s: no %s in the set-up", missing, of->sound, of->instrument);
    else if (missing > 0 && of && of->instrument)
        snprintf(line, size, "%d of %s: no room for one more instrument", missing, of->sound);
    else if (missing > 0 && of)
        snprintf(line, size, "%d of %s: no such instrument here", missing, of->sound);
    else if (missing > 0)
        snprintf(line, size, "%d of key %d: no sound in General MIDI", missing, key);
    else if (played > 0 && of->instead)
        snprintf(line, size, "%d of %s: played on %s", played, of->sound, of->instrument);
    return missing + played;
}
