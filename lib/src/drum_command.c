/// drum_command.c: a drum's commands: each makes the new state aside, has it checked, and only then
/// takes it.
#include "drum_state.h"

#include "argument.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// Felt after Rhaouti, Chaigne & Joly 1999 (medium); the others span an open drum engine's range. A
// softer felt loses more. A stick's head and what moves with it when nobody holds it weigh about 30
// g.
static const struct {
    const char *name;
    himc_mallet_head head;
} presets[] = {
    {"soft", {.stiffness = 1e7, .exponent = 2.54, .loss = 0.15, .mass = 0.030, .radius = 0.0175}},
    {"medium",
     {.stiffness = 1.6e8, .exponent = 2.54, .loss = 0.10, .mass = 0.030, .radius = 0.0175}},
    {"hard", {.stiffness = 1e9, .exponent = 2.5, .loss = 0.05, .mass = 0.030, .radius = 0.0175}},
    {"wood", {.stiffness = 1e10, .exponent = 2.5, .loss = 0.02, .mass = 0.030, .radius = 0.0175}},
};

bool himc_drum_mallet_preset(const char *name, himc_mallet_head *head)
{
    for (size_t i = 0; i < sizeof presets / sizeof presets[0]; i++) {
        if (strcmp(presets[i].name, name) == 0) {
            *head = presets[i].head;
            return true;
        }
    }
    return false;
}

static double number(const himc_command *c, int index)
{
    return c->atom[index].number;
}

static bool is_symbol(const himc_command *c, int index)
{
    return index < c->count && c->atom[index].kind == HIMC_ATOM_SYMBOL;
}

// the command's atoms are `count` numbers; the table has checked that already when it came by text
static bool numbers(const himc_command *c, const char *name, int count, himc_error *error)
{
    bool good = c->count == count;
    for (int i = 0; i < c->count; i++)
        good = good && c->atom[i].kind == HIMC_ATOM_NUMBER;
    return good ||
           himc_error_set(error, "%s: takes %d number%s", name, count, count == 1 ? "" : "s");
}

static bool set_head(himc_drum *drum, const himc_head *head, himc_error *error)
{
    if (!himc_membrane_set_head(drum->membrane, head, error))
        return false;
    if (drum->place.radius != head->radius) {
        drum->place.radius = head->radius;
        drum->revision++;
    }
    return true;
}

// `radius`, `tension`, `density`: one number of the head
static bool set_field(himc_drum *drum, const himc_command *c, const char *name, size_t field,
                      himc_error *error)
{
    himc_head head = *himc_membrane_head(drum->membrane);
    if (!numbers(c, name, 1, error))
        return false;
    memcpy((char *)&head + field, &c->atom[0].number, sizeof(double));
    return set_head(drum, &head, error);
}

static bool set_modes(himc_drum *drum, const himc_command *c, himc_error *error)
{
    himc_head head = *himc_membrane_head(drum->membrane);
    if (!numbers(c, "modes", 1, error) ||
        !himc_check_range("modes", number(c, 0), 1, HIMC_MODES_MAX, "", error))
        return false;
    if (number(c, 0) != floor(number(c, 0)))
        return himc_error_set(error, "modes: %g, allowed a whole number 1 .. %d", number(c, 0),
                              HIMC_MODES_MAX);
    head.modes = (int)number(c, 0);
    return set_head(drum, &head, error);
}

static bool set_decay(himc_drum *drum, const himc_command *c, himc_error *error)
{
    himc_head head = *himc_membrane_head(drum->membrane);
    if (c->count == 1) {
        if (!numbers(c, "decay", 1, error) ||
            !himc_check_range("decay T60", number(c, 0), 0.001, 100, "s", error))
            return false;
        head.decay_constant = log(1000) / number(c, 0);
        head.decay_square = 0;
    } else {
        if (!numbers(c, "decay", 2, error))
            return false;
        head.decay_constant = number(c, 0);
        head.decay_square = number(c, 1);
    }
    return set_head(drum, &head, error);
}

static bool tune(himc_drum *drum, const himc_command *c, himc_error *error)
{
    himc_head head = *himc_membrane_head(drum->membrane);
    double hz = number(c, 0);
    if (is_symbol(c, 0) && !himc_note_frequency(c->atom[0].symbol, &hz))
        return himc_error_set(error, "tune: %s, allowed Hz or a note name as A2, f#3, Bb2",
                              c->atom[0].symbol);
    if (c->count != 1)
        return himc_error_set(error, "tune: takes a frequency or a note name");
    double per_hz = himc_head_tension_for(&head, 1);
    if (!himc_check_range("tune", hz, sqrt(HIMC_TENSION_MIN / per_hz),
                          sqrt(HIMC_TENSION_MAX / per_hz), "Hz", error))
        return false;
    head.tension = per_hz * hz * hz;
    return set_head(drum, &head, error);
}

static bool set_mallet(himc_drum *drum, const himc_command *c, himc_error *error)
{
    himc_mallet_head head = drum->mallet;
    const char *name = "own";
    if (is_symbol(c, 0)) {
        name = c->atom[0].symbol;
        if (!himc_drum_mallet_preset(name, &head))
            return himc_error_set(
                error, "mallet: %s, allowed soft medium hard wood, or K ALPHA MASS", name);
    } else {
        if (!numbers(c, "mallet", 3, error) ||
            !himc_check_range("mallet K", number(c, 0), 1e3, 1e13, "N/m^ALPHA", error) ||
            !himc_check_range("mallet ALPHA", number(c, 1), 1, 4, "", error) ||
            !himc_check_range("mallet MASS", number(c, 2), 0.001, 1, "kg", error))
            return false;
        head = (himc_mallet_head){number(c, 0), number(c, 1), 0, number(c, 2), drum->mallet.radius};
    }
    drum->mallet = head;
    snprintf(drum->mallet_name, sizeof drum->mallet_name, "%s", name);
    drum->revision++;
    return true;
}

static bool set_place(himc_drum *drum, const himc_command *c, himc_error *error)
{
    static const char *const axes[] = {"place X", "place Y", "place Z"};
    if (!numbers(c, "place", c->count == 4 ? 4 : 3, error))
        return false;
    for (int i = 0; i < 3; i++)
        if (!himc_check_range(axes[i], number(c, i), -10, 10, "m", error))
            return false;
    double tilt = c->count == 4 ? number(c, 3) : drum->place.tilt;
    if (!himc_check_range("place tilt", tilt, -1.2, 1.2, "rad", error))
        return false;
    drum->place.center = himc_vec3_make(number(c, 0), number(c, 1), number(c, 2));
    drum->place.tilt = tilt;
    drum->revision++;
    return true;
}

static bool set_pickup(himc_drum *drum, const himc_command *c, himc_error *error)
{
    himc_pickup pickup = *himc_membrane_pickup(drum->membrane);
    if (!is_symbol(c, 0)) {
        if (!numbers(c, "pickup", 2, error))
            return false;
        pickup.kind = HIMC_PICKUP_POINT;
        pickup.x = number(c, 0);
        pickup.y = number(c, 1);
        return himc_membrane_set_pickup(drum->membrane, &pickup, error);
    }
    if (strcmp(c->atom[0].symbol, "air") != 0 || c->count != 4)
        return himc_error_set(error, "pickup: %s, allowed X Y or air AZIMUTH ELEVATION DISTANCE",
                              c->atom[0].symbol);
    if (c->atom[1].kind != HIMC_ATOM_NUMBER || c->atom[2].kind != HIMC_ATOM_NUMBER ||
        c->atom[3].kind != HIMC_ATOM_NUMBER)
        return himc_error_set(error,
                              "pickup: AZIMUTH ELEVATION DISTANCE are numbers (rad, rad, m)");
    pickup.kind = HIMC_PICKUP_AIR;
    pickup.azimuth = number(c, 1);
    pickup.elevation = number(c, 2);
    pickup.distance = number(c, 3);
    return himc_membrane_set_pickup(drum->membrane, &pickup, error);
}

static bool strike(himc_drum *drum, const himc_command *c, himc_error *error)
{
    return numbers(c, "strike", 3, error) &&
           himc_drum_strike_at(drum, 0, number(c, 0), number(c, 1), number(c, 2), error);
}

bool himc_drum_command(himc_drum *drum, const himc_command *command, himc_error *error)
{
    switch (command->id) {
    case HIMC_COMMAND_RADIUS:
        return set_field(drum, command, "radius", offsetof(himc_head, radius), error);
    case HIMC_COMMAND_TENSION:
        return set_field(drum, command, "tension", offsetof(himc_head, tension), error);
    case HIMC_COMMAND_DENSITY:
        return set_field(drum, command, "density", offsetof(himc_head, density), error);
    case HIMC_COMMAND_TUNE: return tune(drum, command, error);
    case HIMC_COMMAND_MODES: return set_modes(drum, command, error);
    case HIMC_COMMAND_DECAY: return set_decay(drum, command, error);
    case HIMC_COMMAND_MALLET: return set_mallet(drum, command, error);
    case HIMC_COMMAND_PLACE: return set_place(drum, command, error);
    case HIMC_COMMAND_PICKUP: return set_pickup(drum, command, error);
    case HIMC_COMMAND_STRIKE: return strike(drum, command, error);
    default: return himc_error_set(error, "command %d: not one to a drum", (int)command->id);
    }
}

void himc_drum_describe(const himc_drum *drum, char *text, size_t size)
{
    const himc_head *head = himc_membrane_head(drum->membrane);
    const himc_place *p = &drum->place;
    double principal = sqrt(head->tension / himc_head_tension_for(head, 1));
    snprintf(text, size,
             "%s: radius %.4g m, tension %.5g N/m, density %.4g kg/m2, principal mode %.5g Hz, "
             "%d modes (%d audible), "
             "mallet %s, at %.4g %.4g %.4g m",
             drum->name, head->radius, head->tension, head->density, principal, head->modes,
             himc_membrane_audible(drum->membrane), drum->mallet_name, p->center.x, p->center.y,
             p->center.z);
}
