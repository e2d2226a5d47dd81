/// performance_settings.c: the table of settings, from the rows HIMC_SETTING_ROW of
/// himc/command_rows.h.
///
/// The kind of a row says how a command's atoms are read into the field, and how the field is told
/// as a command. Three kinds serve most rows; a command that is more than its field has a kind of
/// its own. Invariant: what is told is read as it was, bit by bit. Numbers are told in single
/// precision, so one that equals the default in single precision is the default
/// (himc_argument_usual).
#include "performance/performance_settings.h"

#include "base/argument.h"
#include "base/format.h"
#include "base/text.h"
#include "body/engine_ode.h"
#include "performance/performance_body.h"

#include <stddef.h>
#include <string.h>

/// That a hit needs from rest (s): measured, an accent at ff; vertical accents need more from f on.
#define LONGEST_PREPARATION 0.33

// kinds of one row that are more than a line or two

// a take has measured the player if it has lengths; then the take's line tells them, and `player`
// only what has been asked for instead
static void tell_player(const performance_settings *settings, const himc_line_sink *to)
{
    const himc_skeleton_config *s = &settings->skeleton;
    bool measured = s->seat != 0 || s->shoulders != 0;
    for (size_t i = 0; i < sizeof s->length / sizeof *s->length; i++)
        measured = measured || s->length[i] != 0;
    if (!measured || settings->asked_height > 0)
        himc_state_tell(to, "player", NULL, 2, (double[]){s->height, s->mass});
}

static bool read_gain(performance_settings *s, const himc_command *c, himc_error *error)
{
    enum { RESET, FREQUENCY, JOINT };
    int joint;
    if (c->form == RESET) {
        memset(s->control.gain_set, 0, sizeof s->control.gain_set);
        memset(s->gain, 0, sizeof s->gain);
    } else if (c->form == FREQUENCY) {
        for (joint = 0; joint < HIMC_JOINTS; joint++) {
            s->control.gain_set[joint] = true;
            s->gain[joint] = (asked_gain){.frequency = c->atom[1].number};
        }
    } else if (c->form == JOINT) {
        if (!himc_body_find_joint(c->atom[0].symbol, "gain: JOINT", &joint, error))
            return false;
        s->control.gain_set[joint] = true;
        s->gain[joint] = (asked_gain){c->atom[1].number, c->atom[2].number, 0};
    }
    return true;
}

static void tell_gain(const performance_settings *s, const himc_line_sink *to)
{
    const asked_gain *asked = s->gain;
    double frequency = 0;
    himc_state_tell(to, "gain", "reset", 0, NULL);
    for (int j = 0; j < HIMC_JOINTS; j++)
        frequency = fmax(frequency, asked[j].frequency);
    if (frequency > 0)
        himc_state_tell(to, "gain", "frequency", 1, &frequency);
    for (int j = 0; j < HIMC_JOINTS; j++)
        if (s->control.gain_set[j] && asked[j].frequency == 0)
            himc_state_tell(to, "gain", himc_joint_name(j), 2,
                            (double[]){asked[j].stiffness, asked[j].damping});
}

static bool read_strength(performance_settings *s, const himc_command *c, himc_error *error)
{
    enum { ALL, JOINT };
    enum { HUMAN };
    himc_controller_config *config = &s->control;
    int joint;
    if (c->form == JOINT) {
        if (!himc_body_find_joint(c->atom[0].symbol, "strength: JOINT", &joint, error))
            return false;
        config->strength[joint] = c->atom[1].number;
    } else if (c->choice[0] == HUMAN) {
        himc_controller_set_human_strength(config, s->skeleton.mass);
    } else {
        memset(config->strength, 0, sizeof config->strength);
        config->human_strength = false;
    }
    return true;
}

static void tell_strength(const performance_settings *s, const himc_line_sink *to)
{
    const himc_controller_config *c = &s->control;
    himc_controller_config all = {.human_strength = false};
    if (c->human_strength)
        himc_controller_set_human_strength(&all, s->skeleton.mass);
    himc_state_tell(to, "strength", c->human_strength ? "human" : "off", 0, NULL);
    for (int j = 0; j < HIMC_JOINTS; j++)
        if (c->strength[j] != all.strength[j])
            himc_state_tell(to, "strength", himc_joint_name(j), 1, &c->strength[j]);
}

// the table

typedef enum setting_kind {
    KIND_switch,
    KIND_word, ///< an enum, in the order of the words of the first atom
    KIND_numbers,
    KIND_rate,
    KIND_player,
    KIND_gain,
    KIND_strength,
    KIND_grip,
    KIND_human,
    KIND_latency
} setting_kind;

typedef struct setting {
    himc_command_id id;
    setting_kind kind;
    size_t at, size; ///< of the field, in performance_settings
    const char *usual;
    setting_effect after;
} setting;

static const setting table[] = {
#define HIMC_SETTING_ROW(ID, word, when, atoms, kind, field, usual, after, does) \
    {HIMC_COMMAND_##ID,                                                          \
     KIND_##kind,                                                                \
     offsetof(performance_settings, field),                                      \
     sizeof((performance_settings *)NULL)->field,                                \
     usual,                                                                      \
     AFTER_##after},
#include "himc/command_rows.h"
};

#define SETTINGS (sizeof table / sizeof *table)

static const setting *find(himc_command_id id)
{
    for (size_t i = 0; i < SETTINGS; i++)
        if (table[i].id == id)
            return &table[i];
    return NULL;
}

setting_effect himc_settings_effect(himc_command_id id)
{
    return find(id)->after;
}

bool himc_settings_read(performance_settings *s, const performance_settings *usual,
                        const himc_command *c, himc_error *error)
{
    enum { PHYSICS };      // form of `rate`
    enum { PALMS, SERVO }; // of `grip`
    enum { TIME, AUTO };   // of `latency`
    const setting *row = find(c->id);
    if (!row)
        return true;
    if (c->id == HIMC_COMMAND_ENGINE && c->choice[0] == HIMC_ENGINE_ODE && !himc_ode_is_here())
        return himc_error_set(error, "engine: ode: the Open Dynamics Engine is not built in here, "
                                     "expected tree");
    void *field = (char *)s + row->at;
    const void *field_usual = (const char *)usual + row->at;
    const double first = c->count > 0 ? c->atom[0].number : 0;
    himc_skeleton_config *body = &s->skeleton;
    bool asked;
    switch (row->kind) {
    case KIND_switch: *(bool *)field = first != 0; break;
    case KIND_word: memcpy(field, &c->choice[0], sizeof(int)); break;
    case KIND_numbers:
        for (size_t i = 0; i < row->size / sizeof(double); i++)
            ((double *)field)[i] =
                himc_argument_usual(c->atom[i].number, ((const double *)field_usual)[i]);
        break;
    case KIND_rate:
        if (c->form == PHYSICS)
            s->physics_rate = himc_argument_usual(c->atom[1].number, usual->physics_rate);
        else
            s->task_rate = himc_argument_usual(c->atom[1].number, usual->task_rate);
        break;
    case KIND_player:
        // height and mass as asked for replace those of a take's player, whether the take comes
        // after or has come before; the usual ones are as if nobody had asked
        body->height = himc_argument_usual(first, usual->skeleton.height);
        body->mass = himc_argument_usual(c->atom[1].number, usual->skeleton.mass);
        asked = body->height != usual->skeleton.height || body->mass != usual->skeleton.mass;
        s->asked_height = asked ? body->height : 0;
        s->asked_mass = asked ? body->mass : 0;
        body->seat = body->shoulders = 0; // not those measured from a take
        memset(body->length, 0, sizeof body->length);
        break;
    case KIND_gain: return read_gain(s, c, error);
    case KIND_strength: return read_strength(s, c, error);
    case KIND_grip:
        s->servo = c->form == SERVO || c->count > 1;
        if (c->form != SERVO)
            s->grip = (himc_grip)c->choice[0];
        break;
    case KIND_human:
        s->human = (himc_human){first, c->count > 1 ? (uint32_t)c->atom[1].number : 0};
        break;
    case KIND_latency: s->latency = c->form == AUTO ? LONGEST_PREPARATION : 1e-3 * first; break;
    }
    return true;
}

static void tell(const setting *row, const performance_settings *s, const himc_line_sink *to)
{
    const char *name = himc_command_table((int)row->id)->name;
    const void *field = (const char *)s + row->at;
    himc_state_line line = himc_state_begin(name);
    int choice;
    switch (row->kind) {
    case KIND_switch: himc_state_tell(to, name, NULL, 1, (double[]){*(const bool *)field}); break;
    case KIND_word:
        memcpy(&choice, field, sizeof choice);
        himc_state_tell(to, name, himc_command_word(row->id, 0, choice).text, 0, NULL);
        break;
    case KIND_numbers:
        himc_state_tell(to, name, NULL, (int)(row->size / sizeof(double)), field);
        break;
    case KIND_rate:
        himc_state_tell(to, name, "physics", 1, &s->physics_rate);
        himc_state_tell(to, name, "task", 1, &s->task_rate);
        break;
    case KIND_player: tell_player(s, to); break;
    case KIND_gain: tell_gain(s, to); break;
    case KIND_strength: tell_strength(s, to); break;
    case KIND_grip:
        himc_state_word(&line, himc_command_word(row->id, 0, (int)s->grip).text);
        if (s->servo)
            himc_state_word(&line, "servo");
        himc_state_end(&line, to);
        break;
    case KIND_human:
        himc_state_tell(to, name, NULL, 2, (double[]){s->human.amount, s->human.seed});
        break;
    case KIND_latency: himc_state_tell(to, name, NULL, 1, (double[]){1e3 * s->latency}); break;
    }
}

void himc_settings_tell(const performance_settings *s, himc_command_id from, himc_command_id to,
                        const himc_line_sink *sink)
{
    for (const setting *row = table; row < table + SETTINGS; row++)
        if (row->id >= from && row->id < to)
            tell(row, s, sink);
}

performance_settings himc_settings_default(const himc_performance_config *config)
{
    performance_settings s = {.physics_rate = config->physics_rate,
                              .task_rate = config->task_rate,
                              .skeleton = himc_skeleton_default(),
                              .control = himc_controller_config_default()};
    for (int i = 0; i < HIMC_SEGMENTS; i++)
        s.weight[i] = 1;
    for (size_t i = 0; i < SETTINGS; i++) {
        char text[2 * HIMC_NAME_SIZE];
        himc_command c;
        himc_format(text, sizeof text, "%s %s", himc_command_table((int)table[i].id)->name,
                    table[i].usual);
        if (table[i].usual[0] && himc_command_parse_text(&c, HIMC_PERFORMER, text, NULL))
            himc_settings_read(&s, &s, &c, NULL);
    }
    return s;
}
