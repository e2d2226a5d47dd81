/// drum_command.c: a drum's commands, the rows of command_rows.h that are for a drum. They act on
/// settings; a drum takes them when they are good.
#include "drum/drum_state.h"

#include "base/argument.h"
#include "base/format.h"
#include "base/head_frame.h"
#include "base/text.h"
#include "head/air.h"
#include "head/grid.h"
#include "head/idiophone.h"
#include "head/pickup.h"
#include "head/two_heads.h"

#include <stdio.h>
#include <string.h>

#define PICKUP_STEP (HIMC_PI / 3) // (rad) of azimuth; chosen: six pickups surround the drum
// chosen: a room; larger numbers are mistakes of unit
#define FARTHEST_PLACE 10.0 // on each axis (m)
#define FULL_SOUND 4000.0   // of the highest mode (Hz); chosen: with less a blow sounds dull

// What a head feels of a stick is its own mallet and the shaft's inertia about the fulcrum, of a
// uniform rod; how it is held counts 2 %. Chosen: a light shaft of wood or bamboo, of usual length.
#define SHAFT 0.018 // (kg)
#define LENGTH 0.36 // (m)
#define FULCRUM 0.1 // from the butt (m)
#define OF_SHAFT                                                                        \
    (SHAFT * (LENGTH * LENGTH / 12 + (LENGTH / 2 - FULCRUM) * (LENGTH / 2 - FULCRUM)) / \
     ((LENGTH - FULCRUM) * (LENGTH - FULCRUM)))
#define FELT 0.0074 // a mallet of felt (kg); chosen
#define BEAD 0.0044 // one of wood (kg); chosen: its contact lasts 3 to 6 ms, as Wagner's (2006)

// Found by trial on four recordings. The spectrum of a contact has its first gap at 1.5 over its
// length. With 24 to 30 g, as Rhaouti, Chaigne & Joly's (1999), (2,1) falls into it on some drums,
// and the fifth is missing. The hard felt's exponent is from an open drum engine's range, the soft
// one's core doubles the centroid of its sound from pp to ff. A light stick sounds all heads
// evenly, so mallets differ most by the noise of their blows.
// In the order of the words of `mallet`.
static const himc_mallet_head presets[] = {
    [DRUM_MALLET_SOFT] = {.stiffness = 6e6,
                          .exponent = 1.8,
                          .mass = FELT + OF_SHAFT,
                          .radius = 0.017,
                          .relaxation = 0.3e-3,
                          .core = 1e8,
                          .noise = 0.5},
    [DRUM_MALLET_MEDIUM] = {.stiffness = 4e7,
                            .exponent = 2,
                            .mass = FELT + OF_SHAFT,
                            .radius = 0.017,
                            .relaxation = 0.2e-3,
                            .core = 1e9,
                            .noise = 1},
    [DRUM_MALLET_HARD] = {.stiffness = 1e10,
                          .exponent = 2.54,
                          .mass = FELT + OF_SHAFT,
                          .radius = 0.017,
                          .relaxation = 0.15e-3,
                          .noise = 1.5},
    [DRUM_MALLET_WOOD] = {.stiffness = 3e8,
                          .exponent = 1.5,
                          .mass = BEAD + OF_SHAFT,
                          .radius = 0.008,
                          .relaxation = 5e-6,
                          .noise = 2},
};

#define OWN_MALLET "own"
#define OWN_RADIUS 0.0175 // (m) of a mallet given by numbers; chosen: a usual felt's

static void take_mallet(himc_drum_settings *s, int hand, const himc_mallet_head *mallet,
                        himc_word name)
{
    s->mallet[hand] = *mallet;
    s->mallet_name[hand] = name;
}

static void take_preset(himc_drum_settings *s, int hand, drum_mallet_preset preset)
{
    const himc_shape *shape = &s->head.shape;
    bool own = preset == DRUM_MALLET_USUAL && shape->kind->mallet;
    if (preset == DRUM_MALLET_USUAL && !own)
        preset = DRUM_MALLET_MEDIUM;
    take_mallet(s, hand, own ? shape->kind->mallet(shape) : &presets[preset],
                himc_command_word(HIMC_COMMAND_MALLET, 0, (int)preset));
}

void himc_drum_take_mallet(himc_drum_settings *s, drum_mallet_preset preset)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        take_preset(s, hand, preset);
}

static double number(const himc_command *c, int index)
{
    return c->atom[index].number;
}

// What a command computes is kept in single precision, as what it is given: so another can say it.
// The number as the value of that argument.
static double as_said(const char *argument, double value)
{
    return himc_argument_number(himc_argument_find(argument, NULL), value);
}

// a config's, if it can have that outline, head and pickups
static bool set_config(himc_drum_settings *s, const himc_membrane_config *config, himc_error *error)
{
    if (!himc_membrane_config_check(config, error))
        return false;
    s->head = *config;
    himc_membrane_config_keep_pickups(&s->head);
    s->place = himc_head_frame_at(&s->place, &(himc_head_frame){.radius = s->head.head.radius});
    if (config->shape.kind->surface)
        config->shape.kind->surface(&config->shape, &s->place);
    return true;
}

// the head that a drum of this shape has at first
static himc_head usual_head(const himc_shape *shape, const himc_head *usual)
{
    himc_head head = *usual;
    if (shape->kind->fit)
        shape->kind->fit(shape, &head);
    return head;
}

static bool find_tune(const himc_shape *shape, const himc_command *c, himc_head *head,
                      himc_error *error)
{
    himc_head lowest = *head, highest = *head;
    double hz = number(c, 0);
    const char *name = himc_command_table((int)c->id)->name;
    char note[HIMC_NOTE_SIZE], what[40];
    himc_format(what, sizeof what, himc_note_name(hz, note) ? "%s: %s" : "%s", name, note);
    lowest.tension = HIMC_TENSION_MIN;
    highest.tension = HIMC_TENSION_MAX;
    if (!himc_check_range(what, hz, himc_head_principal(&lowest, shape),
                          himc_head_principal(&highest, shape), "Hz", error))
        return false;
    head->tension = as_said("TENSION", himc_head_tension(head, shape, hz));
    return true;
}

// In the order of the words of `skin`. Calf is heavier than Mylar, radiates less for it, and loses
// more in itself: its beat is more staccato, with less ringing (Hardy & Ancell 1961). The figures
// are chosen, as none with their method are known, so that it rings shorter at every pitch: skin
// of 0.27 mm, a film's loss eight and four times.
typedef enum drum_skin { PLASTIC, CALF } drum_skin;
#define CALF_DENSITY 0.355
#define CALF_CONSTANT 2.5 // (1/s)
#define CALF_SQUARE 2e-7  // (s)

// the head in another skin, tuned as it was
static void find_skin(const himc_shape *shape, const himc_head *usual, drum_skin skin,
                      himc_head *head)
{
    double hz = himc_head_principal(head, shape), before = head->density;
    bool calf = skin == CALF;
    head->density = calf ? as_said("DENSITY", CALF_DENSITY) : usual->density;
    head->decay_constant = calf ? as_said("SIGMA0", CALF_CONSTANT) : usual->decay_constant;
    head->decay_square = calf ? as_said("SIGMA1", CALF_SQUARE) : usual->decay_square;
    if (head->density != before)
        head->tension = himc_argument_usual(as_said("TENSION", himc_head_tension(head, shape, hz)),
                                            usual->tension);
}

bool himc_drum_find_head(const himc_shape *shape, const himc_head *usual, const himc_command *c,
                         himc_head *head, himc_error *error)
{
    enum { T60, BOTH, AUTO = 1, VOLUME = 1, PULL = 1 }; // forms
    himc_head here = usual_head(shape, usual);
    double said = number(c, 0), square = c->form == BOTH ? number(c, 1) : 0;
    switch (c->id) {
    case HIMC_COMMAND_RADIUS: head->radius = himc_argument_usual(said, here.radius); break;
    case HIMC_COMMAND_TENSION: head->tension = himc_argument_usual(said, here.tension); break;
    case HIMC_COMMAND_DENSITY: head->density = himc_argument_usual(said, here.density); break;
    case HIMC_COMMAND_GLIDE: head->glide = himc_argument_usual(said, here.glide); break;
    case HIMC_COMMAND_DAMP: head->damp = himc_argument_usual(said, here.damp); break;
    case HIMC_COMMAND_PEDAL:
        if (!shape->body || !shape->body->dampers)
            return himc_error_set(error, "pedal: expected a hi-hat or a vibraphone");
        head->dampers = shape->body->dampers * (shape->body->pedal_lifts ? 1 - said : said);
        break;
    case HIMC_COMMAND_MOTOR:
        if (!shape->body || !shape->body->discs)
            return himc_error_set(error, "motor: expected a vibraphone");
        head->motor = said;
        break;
    case HIMC_COMMAND_MUFFLE: head->muffle = himc_argument_usual(said, here.muffle); break;
    case HIMC_COMMAND_SKIN:
        if (shape->body || shape->shell)
            return himc_error_set(error,
                                  shape->body ? "skin: %s, expected an instrument that has one"
                                              : "skin: %s, expected a drum without a shell",
                                  c->atom[0].symbol);
        find_skin(shape, usual, (drum_skin)c->choice[0], head);
        break;
    case HIMC_COMMAND_DECAY:
        said = c->form == T60 ? as_said("SIGMA0", log(1000) / said) : said;
        head->decay_constant = himc_argument_usual(said, here.decay_constant);
        head->decay_square = himc_argument_usual(square, here.decay_square);
        break;
    case HIMC_COMMAND_MODES: head->modes = c->form == AUTO ? HIMC_MODES_AUTO : (int)said; break;
    case HIMC_COMMAND_AIR: head->air = said == 1; break;
    case HIMC_COMMAND_KETTLE:
        if (c->form == VOLUME && !himc_air_check(said, head->radius, error))
            return false;
        head->kettle = c->form == VOLUME ? said : 0;
        break;
    case HIMC_COMMAND_WIRES:
        head->wires = c->form == PULL  ? said
                      : said == 0      ? 0
                      : here.wires > 0 ? here.wires
                                       : HIMC_WIRES_USUAL;
        if (head->wires > 0 && !himc_shell_takes_wires(shape->shell))
            return himc_error_set(error, "wires: expected a drum with two heads");
        break;
    case HIMC_COMMAND_UNIFORMITY:
        head->uniformity = himc_argument_usual(said, usual->uniformity);
        head->uniformity_seed = c->count == 2 ? (int)number(c, 1) : head->uniformity_seed;
        if (head->uniformity < 1 && !shape->kind->air) // it has no pairs to split
            return himc_error_set(error, "uniformity: %.6g, expected 1 on a head that is not round",
                                  head->uniformity);
        break;
    default: return find_tune(shape, c, head, error);
    }
    return true;
}

static bool change_head(himc_drum_settings *s, const himc_command *c, himc_error *error)
{
    himc_membrane_config config = s->head;
    if (!himc_drum_find_head(&s->head.shape, &s->usual, c, &config.head, error) ||
        !set_config(s, &config, error))
        return false;
    bool gliss = c->id == HIMC_COMMAND_GLISS;
    if (gliss || c->id == HIMC_COMMAND_TUNE || c->id == HIMC_COMMAND_TENSION) {
        s->pedal = true;
        s->gliss = gliss ? number(c, 1) : 0;
    }
    return true;
}

static void change_mallets(himc_drum_settings *s, const himc_command *c)
{
    enum { PRESET, NUMBERS, HAND_PRESET, HAND_NUMBERS };
    bool numbers = c->form == NUMBERS || c->form == HAND_NUMBERS;
    int first = c->form >= HAND_PRESET; // atom behind the hand
    himc_mallet_head mallet = {.radius = OWN_RADIUS, .noise = 1};
    himc_word name = {OWN_MALLET};
    if (numbers) {
        mallet.stiffness = number(c, first);
        mallet.exponent = number(c, first + 1);
        mallet.mass = number(c, first + 2);
    }
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        if (first == 1 && hand != c->choice[0])
            continue;
        if (numbers)
            take_mallet(s, hand, &mallet, name);
        else
            take_preset(s, hand, (drum_mallet_preset)c->choice[first]);
    }
}

bool himc_drum_check_place(himc_vec3 center, himc_error *error)
{
    return himc_check_range("place X", center.x, -FARTHEST_PLACE, FARTHEST_PLACE, "m", error) &&
           himc_check_range("place Y", center.y, -FARTHEST_PLACE, FARTHEST_PLACE, "m", error) &&
           himc_check_range("place Z", center.z, -FARTHEST_PLACE, FARTHEST_PLACE, "m", error);
}

// Pickup `index` from the command's atoms from `first` on; the others stay. `pickup` and `channel`
// have the same two forms.
static bool change_pickup(himc_drum_settings *s, const himc_command *c, int first, int index,
                          himc_error *error)
{
    enum { AIR, POINT };
    himc_pickup pickup = s->head.pickups[index];
    pickup.kind = c->form == AIR ? HIMC_PICKUP_AIR : HIMC_PICKUP_POINT;
    if (c->form == AIR) {
        double usual = himc_pickup_default().elevation;
        pickup.azimuth = number(c, first + 1);
        pickup.elevation = himc_argument_usual(number(c, first + 2), usual);
        pickup.distance = number(c, first + 3);
    } else {
        pickup.x = number(c, first);
        pickup.y = number(c, first + 1);
    }
    if (!himc_pickup_check(&pickup, &s->head.head, error))
        return false;
    s->head.pickups[index] = pickup;
    s->picked = s->picked || index < HIMC_EARS; // the ears leave the others
    return true;
}

// each new pickup is PICKUP_STEP to the right of the one before
static void set_pickup_count(himc_drum_settings *s, int wanted)
{
    himc_pickup *all = s->head.pickups;
    for (int i = s->head.pickup_count; i < wanted; i++) {
        all[i] = all[i - 1];
        all[i].kind = HIMC_PICKUP_AIR;
        all[i].distance = fmax(all[i].distance, himc_pickup_default().distance);
        all[i].azimuth = himc_argument_single(remainder(all[i].azimuth - PICKUP_STEP, 2 * HIMC_PI));
    }
    s->head.pickup_count = wanted;
}

// takes the outline and its reference
static bool replace_shape(himc_drum_settings *s, himc_shape shape, himc_error *error)
{
    himc_membrane_config config = s->head;
    himc_shape before = config.shape;
    himc_head *head = &config.head;
    if (before.kind->mallet) // nothing of it suits another
        *head = s->usual;
    // those of a file or of a rectangle were not said
    head->radius = himc_argument_usual(as_said("RADIUS", head->radius), s->usual.radius);
    head->tension = himc_argument_usual(as_said("TENSION", head->tension), s->usual.tension);
    head->density = himc_argument_usual(as_said("DENSITY", head->density), s->usual.density);
    head->dampers = head->motor = 0; // pedal and motor were the other outline's
    *head = usual_head(&shape, head);
    // one that may be in air again is in air again
    head->air = shape.kind->air && (head->air || !s->head.shape.kind->air);
    config.shape = shape;
    bool good = set_config(s, &config, error);
    himc_shape_release(good ? &before : &shape);
    if (good && (before.kind->mallet || shape.kind->mallet))
        himc_drum_take_mallet(s, DRUM_MALLET_USUAL);
    return good;
}

static bool change_shape(himc_drum_settings *s, const himc_command *c, himc_error *error)
{
#define KIND(name, form) &himc_kind_##name,
#define LISTED(name, form) form ", "
    static const himc_kind *const kinds[] = {HIMC_KINDS(KIND) KIND(grid, "FILE")};
    himc_shape shape = {.kind = kinds[c->form]};
    if (shape.kind->read && !shape.kind->read(c, &shape, error))
        return false;
    if (shape.kind->name)
        return replace_shape(s, shape, error);
    const char *file = c->atom[0].symbol;
    shape.grid = himc_grid_load(file, error);
    if (shape.grid && (replace_shape(s, shape, error) || himc_error_prefix(error, "%s", file)))
        return true;
    if (strpbrk(file, "./\\"))
        return himc_error_prefix(error, "shape");
    // the word of a misspelt outline looks like no file's name
    return himc_error_set(error, "shape: %.80s, expected " HIMC_KINDS(LISTED) "or a file", file);
}

static bool change_technique(himc_drum_settings *s, const himc_command *c, himc_error *error)
{
    himc_technique wanted = (himc_technique)c->choice[0];
    if (wanted != HIMC_TECHNIQUE_MODAL && !s->external_sound)
        return himc_error_set(error,
                              "technique: %s, expected modal here: signal and clip are patches, "
                              "[technique~ NAME] in Pure Data",
                              c->atom[0].symbol);
    s->technique = wanted;
    return true;
}

bool himc_drum_settings_command(himc_drum_settings *s, const himc_command *command,
                                himc_error *error)
{
    enum { OFF };         // form of `listener`
    himc_command checked; // also one that was put together without the parser
    const himc_command *c = &checked;
    if (!himc_command_check(&checked, HIMC_DRUM, command, error))
        return false;
    switch (c->id) {
    case HIMC_COMMAND_SHAPE: return change_shape(s, c, error);
    case HIMC_COMMAND_MALLET: change_mallets(s, c); return true;
    case HIMC_COMMAND_NOISE:
        s->noise = number(c, 0);
        s->noise_seed = c->count == 2 ? (int)number(c, 1) : s->noise_seed;
        return true;
    case HIMC_COMMAND_PLACE:
        s->place.center = himc_vec3_make(number(c, 0), number(c, 1), number(c, 2));
        s->place.tilt = c->count == 4 ? number(c, 3) : s->place.tilt;
        s->placed = true;
        return true;
    case HIMC_COMMAND_PICKUP: return change_pickup(s, c, 0, 0, error);
    case HIMC_COMMAND_PICKUPS: set_pickup_count(s, (int)number(c, 0)); return true;
    case HIMC_COMMAND_CHANNEL:
        return himc_check_range("channel", number(c, 0), 1, s->head.pickup_count, "", error) &&
               change_pickup(s, c, 1, (int)number(c, 0) - 1, error);
    case HIMC_COMMAND_DRUM_LISTENER: s->picked = c->form == OFF; return true;
    case HIMC_COMMAND_DRUM_GAIN: s->gain = pow(10, number(c, 0) / 20); return true;
    case HIMC_COMMAND_DRUM_MUTE: s->mute = number(c, 0) == 1; return true;
    case HIMC_COMMAND_TECHNIQUE: return change_technique(s, c, error);
    case HIMC_COMMAND_STRIKE:
        return himc_drum_may_strike(&s->place, number(c, 0), number(c, 1), number(c, 2), error);
    case HIMC_COMMAND_DRUM_INFO: // the host answers; the other two are jobs (drum_job.c)
    case HIMC_COMMAND_DRUM_DUMP:
    case HIMC_COMMAND_DRUM_PRESET: return true;
    default: return change_head(s, c, error);
    }
}

static bool has_one_mallet(const himc_drum_settings *s)
{
    return memcmp(&s->mallet[HIMC_LEFT], &s->mallet[HIMC_RIGHT], sizeof *s->mallet) == 0;
}

// what a thing without a skin is by: a plate's modes have no pitch
static void size_of(const himc_shape *shape, double principal, char *text, size_t room)
{
    const double *size = shape->body->pitches;
    if (shape->kind->cascade)
        snprintf(text, room, "%.4g inches, %.3g mm", size[0], size[1]);
    else
        snprintf(text, room, "pitch %.5g Hz", principal);
}

static void describe_for_person(const himc_drum *drum, const himc_line_sink *to)
{
    char text[512];
    himc_membrane_config config = himc_drum_head_config(drum);
    const himc_head *head = &config.head;
    const himc_head_frame *p = &drum->set.place;
    double principal = himc_membrane_principal(drum->membrane, head);
    const himc_word *name = drum->set.mallet_name;
    bool same = has_one_mallet(&drum->set);
    int modes = drum->membrane->model->modes->count;
    char mallets[2 * sizeof name->text + sizeof " and "];
    snprintf(mallets, sizeof mallets, "%s%s%s", name[HIMC_LEFT].text, same ? "" : " and ",
             same ? "" : name[HIMC_RIGHT].text);
    snprintf(text, sizeof text,
             "%s: radius %.4g m, tension %.5g N/m, density %.4g kg/m2, principal mode %.5g Hz, "
             "%d modes (%d audible), uniformity %.3g, seed %d, "
             "mallet %s, technique %s, at %.4g %.4g %.4g m",
             drum->set.name, head->radius, head->tension, head->density, principal, modes,
             himc_membrane_audible(drum->membrane), head->uniformity, head->uniformity_seed,
             mallets, himc_command_word(HIMC_COMMAND_TECHNIQUE, 0, (int)drum->set.technique).text,
             p->center.x, p->center.y, p->center.z);
    const himc_idiophone *body = config.shape.body;
    if (body) {
        char size[40];
        size_of(&config.shape, principal, size, sizeof size);
        snprintf(text, sizeof text,
                 "%s: %.200s, %s, parts %s .. %s, %d modes (%d audible), mallet %s, at "
                 "%.4g %.4g %.4g m",
                 drum->set.name, body->name, size, body->part[0].name,
                 body->part[body->parts - 1].name, modes, himc_membrane_audible(drum->membrane),
                 mallets, p->center.x, p->center.y, p->center.z);
    }
    const himc_shell *shell = config.shape.shell;
    if (shell)
        snprintf(
            text, sizeof text,
            "%s: %s, radius %.4g m, tension %.5g N/m, pitch %.5g Hz, wires %.4g m/s2, %d modes "
            "(%d audible), mallet %s, at %.4g %.4g %.4g m",
            drum->set.name, shell->name, head->radius, head->tension, principal, head->wires, modes,
            himc_membrane_audible(drum->membrane), mallets, p->center.x, p->center.y, p->center.z);
    to->line(to->user, text);
    double highest = himc_membrane_mode(drum->membrane, modes - 1).frequency;
    if (body || head->modes == HIMC_MODES_AUTO || highest > FULL_SOUND)
        return;
    snprintf(text, sizeof text, "%s: nothing sounds above %.0f Hz: more `modes`, or `modes auto`",
             drum->set.name, highest);
    to->line(to->user, text);
}

// A state is told in an order in which each line is allowed whatever the drum was before: first the
// outline, a kettle of any size, the size; what depends on them after.

static void tell(const himc_line_sink *to, const char *name, double value)
{
    himc_state_tell(to, name, NULL, 1, &value);
}

// the head without the changes of a score: the drum's own
static void dump_head(const himc_drum *drum, const himc_line_sink *to)
{
    himc_membrane_config config = himc_drum_head_config(drum);
    const himc_head *now = &config.head;
    himc_head own = drum->told ? drum->told->base : *now, *head = &own;
    const himc_shape *shape = &himc_membrane_config_of(drum->membrane)->shape;
    if (drum->told)
        himc_head_keep_edits(head, &drum->told->known, now);
    himc_state_line line = himc_state_begin("shape");
    himc_state_word(&line, shape->kind->name ? shape->kind->name : shape->grid->path);
    if (shape->body)
        himc_state_word(&line, shape->body->name);
    if (shape->shell)
        himc_state_word(&line, shape->shell->name);
    if (shape->shell && shape->width > 0) // it decides in which order the modes are
        himc_state_numbers(&line, 1, (double[]){shape->width / 0.0254});
    for (int i = 0; shape->body && i < 2 && shape->body->pitches[i] > 0; i++)
        himc_state_numbers(&line, 1, &shape->body->pitches[i]);
    himc_state_numbers(&line, shape->length > 0 ? 2 : 0, (double[]){shape->length, shape->width});
    himc_state_end(&line, to);
    himc_state_tell(to, "kettle", "usual", 0, NULL);
    tell(to, "radius", head->radius);
    tell(to, "density", head->density);
    tell(to, "tension", head->tension);
    if (head->modes == HIMC_MODES_AUTO)
        himc_state_tell(to, "modes", "auto", 0, NULL);
    else
        tell(to, "modes", head->modes);
    himc_state_tell(to, "decay", NULL, 2, (double[]){head->decay_constant, head->decay_square});
    tell(to, "air", head->air);
    // without air the head may have grown too large for its kettle, which is then not heard
    if (head->kettle > 0 && himc_air_check(head->kettle, head->radius, NULL))
        tell(to, "kettle", head->kettle);
    tell(to, "glide", head->glide);
    tell(to, "damp", head->damp);
    if (shape->body && shape->body->dampers > 0) {
        double laid = head->dampers / shape->body->dampers;
        tell(to, "pedal", shape->body->pedal_lifts ? 1 - laid : laid);
    }
    if (shape->body && shape->body->discs)
        tell(to, "motor", head->motor);
    tell(to, "muffle", head->muffle);
    if (himc_shell_takes_wires(shape->shell))
        tell(to, "wires", head->wires);
    // its usual seed is of the drum's name, which another may not have
    if (shape->kind->air)
        himc_state_tell(to, "uniformity", NULL, head->uniformity < 1 ? 2 : 1,
                        (double[]){head->uniformity, head->uniformity_seed});
}

static void dump_pickups(const himc_membrane_config *head, const himc_line_sink *to)
{
    tell(to, "pickups", head->pickup_count);
    for (int i = 0; i < head->pickup_count; i++) {
        const himc_pickup *p = &head->pickups[i];
        himc_state_line line = himc_state_begin("channel");
        himc_state_numbers(&line, 1, (double[]){i + 1});
        if (p->kind == HIMC_PICKUP_AIR) {
            himc_state_word(&line, "air");
            himc_state_numbers(&line, 3, (double[]){p->azimuth, p->elevation, p->distance});
        } else {
            himc_state_numbers(&line, 2, (double[]){p->x, p->y});
        }
        himc_state_end(&line, to);
    }
}

static void dump_mallets(const himc_drum_settings *set, const himc_line_sink *to)
{
    bool one = has_one_mallet(set);
    for (int hand = one ? HIMC_RIGHT : HIMC_LEFT; hand < HIMC_HANDS; hand++) {
        const himc_mallet_head *m = &set->mallet[hand];
        himc_state_line line = himc_state_begin("mallet");
        if (!one)
            himc_state_word(&line, himc_hand_name((himc_hand)hand));
        if (strcmp(set->mallet_name[hand].text, OWN_MALLET) == 0)
            himc_state_numbers(&line, 3, (double[]){m->stiffness, m->exponent, m->mass});
        else
            himc_state_word(&line, set->mallet_name[hand].text);
        himc_state_end(&line, to);
    }
}

void himc_drum_tell_state(const himc_drum *drum, bool placed, const himc_line_sink *to)
{
    const himc_drum_settings *set = &drum->set;
    const himc_vec3 *at = &set->place.center;
    dump_head(drum, to);
    dump_pickups(himc_membrane_config_of(drum->membrane), to);
    himc_state_tell(to, "listener", set->picked ? "off" : "usual", 0, NULL);
    dump_mallets(set, to);
    himc_state_tell(to, "noise", NULL, set->noise_seed > 0 ? 2 : 1,
                    (double[]){set->noise, set->noise_seed});
    if (placed)
        himc_state_tell(to, "place", NULL, 4, (double[]){at->x, at->y, at->z, set->place.tilt});
    tell(to, "gain", 20 * log10(set->gain));
    tell(to, "mute", set->mute);
    himc_state_tell(to, "technique",
                    himc_command_word(HIMC_COMMAND_TECHNIQUE, 0, (int)set->technique).text, 0, 0);
}

void himc_drum_describe(const himc_drum *drum, himc_description what,
                        void (*line)(void *, const char *), void *user)
{
    himc_line_sink to = {line, user};
    if (what == HIMC_DESCRIBE_INFO)
        describe_for_person(drum, &to);
    else
        himc_drum_tell_state(drum, drum->set.placed, &to);
}
