/// drum_command.c: a drum's commands: each makes the new state aside, has it checked, and only then
/// takes it.
#include "drum/drum_state.h"

#include "base/argument.h"
#include "drum/air.h"
#include "himc/vec.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// chosen: a room; larger numbers are mistakes of unit
#define FARTHEST_PLACE 10.0 // on each axis (m)

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

// the first atom is a whole number in range
static bool is_whole(const himc_command *c, const char *name, double low, double high,
                     himc_error *error)
{
    if (c->count < 1 || c->atom[0].kind != HIMC_ATOM_NUMBER)
        return himc_error_set(error, "%s: takes a number", name);
    return himc_check_range(name, number(c, 0), low, high, "", error) &&
           (number(c, 0) == floor(number(c, 0)) ||
            himc_error_set(error, "%s: %g, allowed a whole number %g .. %g", name, number(c, 0),
                           low, high));
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
    if (!is_whole(c, "modes", 1, HIMC_MODES_MAX, error))
        return false;
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
    himc_head lowest = head, highest = head;
    lowest.tension = HIMC_TENSION_MIN;
    highest.tension = HIMC_TENSION_MAX;
    if (!himc_check_range("tune", hz, himc_membrane_principal(drum->membrane, &lowest),
                          himc_membrane_principal(drum->membrane, &highest), "Hz", error))
        return false;
    head.tension = himc_membrane_tension_for(drum->membrane, &head, hz);
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

bool himc_drum_check_place(himc_vec3 center, himc_error *error)
{
    return himc_check_range("place X", center.x, -FARTHEST_PLACE, FARTHEST_PLACE, "m", error) &&
           himc_check_range("place Y", center.y, -FARTHEST_PLACE, FARTHEST_PLACE, "m", error) &&
           himc_check_range("place Z", center.z, -FARTHEST_PLACE, FARTHEST_PLACE, "m", error);
}

static bool set_place(himc_drum *drum, const himc_command *c, himc_error *error)
{
    if (!numbers(c, "place", c->count == 4 ? 4 : 3, error))
        return false;
    himc_vec3 center = himc_vec3_make(number(c, 0), number(c, 1), number(c, 2));
    if (!himc_drum_check_place(center, error))
        return false;
    double tilt = c->count == 4 ? number(c, 3) : drum->place.tilt;
    if (!himc_check_range("place tilt", tilt, -1.2, 1.2, "rad", error))
        return false;
    drum->place.center = center;
    drum->place.tilt = tilt;
    drum->placed = true;
    drum->revision++;
    return true;
}

// `X Y` or `air AZIMUTH ELEVATION DISTANCE`, from atom `first` on
static bool read_pickup(const himc_command *c, int first, himc_pickup *pickup, himc_error *error)
{
    int count = c->count - first;
    bool air = is_symbol(c, first) && strcmp(c->atom[first].symbol, "air") == 0;
    bool good = count == (air ? 4 : 2);
    for (int i = first + air; i < c->count; i++)
        good = good && c->atom[i].kind == HIMC_ATOM_NUMBER;
    if (!good)
        return himc_error_set(
            error, "pickup: %s, allowed X Y or air AZIMUTH ELEVATION DISTANCE (m, rad, rad, m)",
            is_symbol(c, first) ? c->atom[first].symbol : "something else");
    pickup->kind = air ? HIMC_PICKUP_AIR : HIMC_PICKUP_POINT;
    if (air) {
        pickup->azimuth = number(c, first + 1);
        pickup->elevation = number(c, first + 2);
        pickup->distance = number(c, first + 3);
    } else {
        pickup->x = number(c, first);
        pickup->y = number(c, first + 1);
    }
    return true;
}

static bool set_pickup(himc_drum *drum, const himc_command *c, himc_error *error)
{
    himc_pickup pickup = *himc_membrane_pickup(drum->membrane);
    return read_pickup(c, 0, &pickup, error) &&
           himc_membrane_set_pickup(drum->membrane, &pickup, error);
}

// a new one hears from further round the drum, 60 degrees to the right of the one before
static bool set_pickups(himc_drum *drum, const himc_command *c, himc_error *error)
{
    himc_pickup all[HIMC_PICKUPS];
    int count;
    const himc_pickup *now = himc_membrane_pickups(drum->membrane, &count);
    if (!is_whole(c, "pickups", 1, HIMC_PICKUPS, error))
        return false;
    memcpy(all, now, sizeof *all * (size_t)count);
    for (int i = count; i < (int)number(c, 0); i++) {
        all[i] = all[i - 1];
        all[i].kind = HIMC_PICKUP_AIR;
        all[i].distance = fmax(all[i].distance, himc_pickup_default().distance);
        all[i].azimuth = remainder(all[i].azimuth - HIMC_PI / 3, 2 * HIMC_PI);
    }
    return himc_membrane_set_pickups(drum->membrane, all, (int)number(c, 0), error);
}

static bool set_channel(himc_drum *drum, const himc_command *c, himc_error *error)
{
    himc_pickup all[HIMC_PICKUPS];
    int count;
    const himc_pickup *now = himc_membrane_pickups(drum->membrane, &count);
    if (!is_whole(c, "channel", 1, count, error))
        return false;
    memcpy(all, now, sizeof *all * (size_t)count);
    return read_pickup(c, 1, &all[(int)number(c, 0) - 1], error) &&
           himc_membrane_set_pickups(drum->membrane, all, count, error);
}

static bool set_air(himc_drum *drum, const himc_command *c, himc_error *error)
{
    himc_head head = *himc_membrane_head(drum->membrane);
    if (!is_whole(c, "air", 0, 1, error))
        return false;
    head.air = number(c, 0) == 1;
    return set_head(drum, &head, error);
}

static bool set_kettle(himc_drum *drum, const himc_command *c, himc_error *error)
{
    himc_head head = *himc_membrane_head(drum->membrane);
    head.kettle = 0;
    if (is_symbol(c, 0) && c->count == 1 && strcmp(c->atom[0].symbol, "usual") == 0)
        return set_head(drum, &head, error);
    if (!numbers(c, "kettle", 1, error) || !himc_air_check(number(c, 0), head.radius, error))
        return false;
    head.kettle = number(c, 0);
    return set_head(drum, &head, error);
}

static bool take_shape(himc_drum *drum, const himc_shape *shape, himc_head *head, himc_error *error)
{
    head->air = head->air && shape->kind == HIMC_CIRCLE;
    if (!himc_membrane_set_shape(drum->membrane, shape, head, error))
        return false;
    drum->place.radius = head->radius;
    drum->revision++;
    return true;
}

static bool load_shape(himc_drum *drum, const char *path, himc_error *error)
{
    himc_head head = *himc_membrane_head(drum->membrane);
    himc_shape shape = {.kind = HIMC_GRID, .grid = himc_grid_load(path, error)};
    if (!shape.grid)
        return false;
    head.radius = shape.grid->radius;
    head.tension = shape.grid->tension;
    head.density = shape.grid->density;
    head.modes = head.modes < shape.grid->modes ? head.modes : shape.grid->modes;
    bool good = take_shape(drum, &shape, &head, error) || himc_error_prefix(error, "%s", path);
    himc_grid_release(shape.grid);
    return good;
}

// a round head again is in air again; only a round one may be
static bool set_shape(himc_drum *drum, const himc_command *c, himc_error *error)
{
    himc_head head = *himc_membrane_head(drum->membrane);
    const char *word = is_symbol(c, 0) ? c->atom[0].symbol : "";
    if (strcmp(word, "circle") == 0) {
        head.air = head.air || himc_membrane_shape(drum->membrane)->kind != HIMC_CIRCLE;
        return take_shape(drum, &(himc_shape){.kind = HIMC_CIRCLE}, &head, error);
    }
    if (strcmp(word, "rectangle") != 0 && word[0])
        return load_shape(drum, word, error);
    if (c->count != 3 || c->atom[1].kind != HIMC_ATOM_NUMBER || c->atom[2].kind != HIMC_ATOM_NUMBER)
        return himc_error_set(error, "shape: allowed circle, rectangle LENGTH WIDTH, or a file");
    himc_shape shape = {HIMC_RECTANGLE, number(c, 1), number(c, 2), NULL};
    if (!himc_check_range("shape rectangle LENGTH", shape.length, 0.05, 1.4, "m", error) ||
        !himc_check_range("shape rectangle WIDTH", shape.width, 0.05, 1.4, "m", error))
        return false;
    head.radius = 0.5 * hypot(shape.length, shape.width);
    return take_shape(drum, &shape, &head, error);
}

static bool set_technique(himc_drum *drum, const himc_command *c, himc_error *error)
{
    int wanted = HIMC_TECHNIQUE_MODAL;
    while (is_symbol(c, 0) && wanted <= HIMC_TECHNIQUE_CLIP &&
           strcmp(c->atom[0].symbol, himc_technique_name((himc_technique)wanted)) != 0)
        wanted++;
    if (c->count != 1 || !is_symbol(c, 0) || wanted > HIMC_TECHNIQUE_CLIP)
        return himc_error_set(error, "technique: allowed modal signal clip");
    if (wanted != HIMC_TECHNIQUE_MODAL && !drum->answered)
        return himc_error_set(error,
                              "technique: %s, allowed modal here: signal and clip are patches, "
                              "[technique~ NAME] in Pure Data",
                              c->atom[0].symbol);
    drum->technique = (himc_technique)wanted;
    return true;
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
    case HIMC_COMMAND_AIR: return set_air(drum, command, error);
    case HIMC_COMMAND_KETTLE: return set_kettle(drum, command, error);
    case HIMC_COMMAND_GLIDE:
        return set_field(drum, command, "glide", offsetof(himc_head, glide), error);
    case HIMC_COMMAND_DAMP:
        return set_field(drum, command, "damp", offsetof(himc_head, damp), error);
    case HIMC_COMMAND_SHAPE: return set_shape(drum, command, error);
    case HIMC_COMMAND_MALLET: return set_mallet(drum, command, error);
    case HIMC_COMMAND_PLACE: return set_place(drum, command, error);
    case HIMC_COMMAND_PICKUP: return set_pickup(drum, command, error);
    case HIMC_COMMAND_PICKUPS: return set_pickups(drum, command, error);
    case HIMC_COMMAND_CHANNEL: return set_channel(drum, command, error);
    case HIMC_COMMAND_TECHNIQUE: return set_technique(drum, command, error);
    case HIMC_COMMAND_STRIKE: return strike(drum, command, error);
    default: return himc_error_set(error, "command %d: not one to a drum", (int)command->id);
    }
}

void himc_drum_describe(const himc_drum *drum, char *text, size_t size)
{
    const himc_head *head = himc_membrane_head(drum->membrane);
    const himc_head_frame *p = &drum->place;
    double principal = himc_membrane_principal(drum->membrane, head);
    snprintf(text, size,
             "%s: radius %.4g m, tension %.5g N/m, density %.4g kg/m2, principal mode %.5g Hz, "
             "%d modes (%d audible), "
             "mallet %s, technique %s, at %.4g %.4g %.4g m",
             drum->name, head->radius, head->tension, head->density, principal, head->modes,
             himc_membrane_audible(drum->membrane), drum->mallet_name,
             himc_technique_name(drum->technique), p->center.x, p->center.y, p->center.z);
}
