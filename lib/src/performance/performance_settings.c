/// performance_settings.c: the table of settings, from the rows HIMC_SETTING_ROW of
/// himc/command_rows.h.
///
/// The kind of a row is two functions: read_KIND stores a command's atoms in the field, tell_KIND
/// tells the field as a command. Three kinds serve most rows; a command that is more than its field
/// has a kind of its own. Invariant: read_KIND stores what tell_KIND tells as it was, bit by bit.
/// Numbers are told in single precision, so one that equals the default in single precision is the
/// default (himc_argument_usual).
#include "performance/performance_settings.h"

#include "base/argument.h"
#include "base/format.h"
#include "base/text.h"
#include "performance/performance_body.h"

#include <stddef.h>
#include <string.h>

/// That a hit needs from rest (s): measured, an accent at ff; vertical accents need more from f on.
#define LONGEST_PREPARATION 0.33

/// A command to be stored.
typedef struct reading {
    const himc_command *command;
    performance_settings *settings;
    const performance_settings *usual;
    void *field;             ///< of `settings`
    const void *usual_field; ///< of `usual`
    size_t size;             ///< of the field (bytes)
    himc_error *error;
} reading;

/// A setting to be told.
typedef struct telling {
    himc_command_id id;
    const performance_settings *settings;
    const void *field;
    size_t size;
    const himc_line_sink *to;
} telling;

static void tell(const telling *t, const char *word, int count, const double *numbers)
{
    himc_state_tell(t->to, himc_command_table((int)t->id)->name, word, count, numbers);
}

// kinds of many rows

static bool read_switch(const reading *r)
{
    *(bool *)r->field = r->command->atom[0].number != 0;
    return true;
}

static void tell_switch(const telling *t)
{
    tell(t, NULL, 1, (double[]){*(const bool *)t->field});
}

// an enum, in the order of the words of the first atom
static bool read_word(const reading *r)
{
    memcpy(r->field, &r->command->choice[0], sizeof(int));
    return true;
}

static void tell_word(const telling *t)
{
    int choice;
    memcpy(&choice, t->field, sizeof choice);
    tell(t, himc_command_word(t->id, 0, choice).text, 0, NULL);
}

static bool read_numbers(const reading *r)
{
    double *to = r->field;
    for (size_t i = 0; i < r->size / sizeof *to; i++)
        to[i] =
            himc_argument_usual(r->command->atom[i].number, ((const double *)r->usual_field)[i]);
    return true;
}

static void tell_numbers(const telling *t)
{
    tell(t, NULL, (int)(t->size / sizeof(double)), t->field);
}

// kinds of one row

static bool read_rate(const reading *r)
{
    enum { PHYSICS };
    bool physics = r->command->form == PHYSICS;
    double hz = r->command->atom[1].number;
    *(physics ? &r->settings->physics_rate : &r->settings->task_rate) =
        himc_argument_usual(hz, physics ? r->usual->physics_rate : r->usual->task_rate);
    return true;
}

static void tell_rate(const telling *t)
{
    tell(t, "physics", 1, &t->settings->physics_rate);
    tell(t, "task", 1, &t->settings->task_rate);
}

// Height and mass as asked for replace those of a take's player, whether the take comes after or
// has come before. The usual ones are as if nobody had asked.
static bool read_player(const reading *r)
{
    performance_settings *s = r->settings;
    const himc_skeleton_config *usual = &r->usual->skeleton;
    s->skeleton.height = himc_argument_usual(r->command->atom[0].number, usual->height);
    s->skeleton.mass = himc_argument_usual(r->command->atom[1].number, usual->mass);
    bool asked = s->skeleton.height != usual->height || s->skeleton.mass != usual->mass;
    s->asked_height = asked ? s->skeleton.height : 0;
    s->asked_mass = asked ? s->skeleton.mass : 0;
    s->skeleton.seat = s->skeleton.shoulders = 0; // not those measured from a take
    memset(s->skeleton.length, 0, sizeof s->skeleton.length);
    return true;
}

// a take has measured the player if it has lengths; then the take's line tells them, and `player`
// only what has been asked for instead
static void tell_player(const telling *t)
{
    const himc_skeleton_config *s = &t->settings->skeleton;
    bool measured = s->seat != 0 || s->shoulders != 0;
    for (size_t i = 0; i < sizeof s->length / sizeof *s->length; i++)
        measured = measured || s->length[i] != 0;
    if (!measured || t->settings->asked_height > 0)
        tell(t, NULL, 2, (double[]){s->height, s->mass});
}

static bool read_gain(const reading *r)
{
    enum { RESET, FREQUENCY, JOINT };
    performance_settings *s = r->settings;
    const himc_command *c = r->command;
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
        if (!himc_body_find_joint(c->atom[0].symbol, "gain: JOINT", &joint, r->error))
            return false;
        s->control.gain_set[joint] = true;
        s->gain[joint] = (asked_gain){c->atom[1].number, c->atom[2].number, 0};
    }
    return true;
}

static void tell_gain(const telling *t)
{
    const asked_gain *asked = t->settings->gain;
    double frequency = 0;
    tell(t, "reset", 0, NULL);
    for (int j = 0; j < HIMC_JOINTS; j++)
        frequency = fmax(frequency, asked[j].frequency);
    if (frequency > 0)
        tell(t, "frequency", 1, &frequency);
    for (int j = 0; j < HIMC_JOINTS; j++)
        if (t->settings->control.gain_set[j] && asked[j].frequency == 0)
            tell(t, himc_joint_name(j), 2, (double[]){asked[j].stiffness, asked[j].damping});
}

static bool read_strength(const reading *r)
{
    enum { ALL, JOINT };
    enum { HUMAN };
    himc_controller_config *config = &r->settings->control;
    const himc_command *c = r->command;
    int joint;
    if (c->form == JOINT) {
        if (!himc_body_find_joint(c->atom[0].symbol, "strength: JOINT", &joint, r->error))
            return false;
        config->strength[joint] = c->atom[1].number;
    } else if (c->choice[0] == HUMAN) {
        himc_controller_set_human_strength(config, r->settings->skeleton.mass);
    } else {
        memset(config->strength, 0, sizeof config->strength);
        config->human_strength = false;
    }
    return true;
}

static void tell_strength(const telling *t)
{
    const himc_controller_config *c = &t->settings->control;
    himc_controller_config all = {.human_strength = false};
    if (c->human_strength)
        himc_controller_set_human_strength(&all, t->settings->skeleton.mass);
    tell(t, c->human_strength ? "human" : "off", 0, NULL);
    for (int j = 0; j < HIMC_JOINTS; j++)
        if (c->strength[j] != all.strength[j])
            tell(t, himc_joint_name(j), 1, &c->strength[j]);
}

static bool read_grip(const reading *r)
{
    enum { PALMS, SERVO };
    const himc_command *c = r->command;
    r->settings->servo = c->form == SERVO || c->count > 1;
    return c->form == SERVO || read_word(r);
}

static void tell_grip(const telling *t)
{
    himc_state_line line = himc_state_begin("grip");
    himc_state_word(&line, himc_command_word(t->id, 0, (int)t->settings->grip).text);
    if (t->settings->servo)
        himc_state_word(&line, "servo");
    himc_state_end(&line, t->to);
}

static bool read_human(const reading *r)
{
    const himc_command *c = r->command;
    r->settings->human =
        (himc_human){c->atom[0].number, c->count > 1 ? (uint32_t)c->atom[1].number : 0};
    return true;
}

static void tell_human(const telling *t)
{
    const himc_human *human = &t->settings->human;
    tell(t, NULL, 2, (double[]){human->amount, human->seed});
}

static bool read_latency(const reading *r)
{
    enum { TIME, AUTO };
    r->settings->latency =
        r->command->form == AUTO ? LONGEST_PREPARATION : 1e-3 * r->command->atom[0].number;
    return true;
}

static void tell_latency(const telling *t)
{
    tell(t, NULL, 1, (double[]){1e3 * t->settings->latency});
}

// the table

typedef struct setting {
    himc_command_id id;
    bool (*read)(const reading *);
    void (*tell)(const telling *);
    size_t at, size; ///< of the field, in performance_settings
    const char *usual;
    setting_effect after;
} setting;

static const setting table[] = {
#define HIMC_SETTING_ROW(ID, word, when, atoms, kind, field, usual, after, does) \
    {HIMC_COMMAND_##ID,                                                          \
     read_##kind,                                                                \
     tell_##kind,                                                                \
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
    const setting *row = find(c->id);
    return !row || row->read(&(reading){c, s, usual, (char *)s + row->at,
                                        (const char *)usual + row->at, row->size, error});
}

void himc_settings_tell(const performance_settings *s, himc_command_id from, himc_command_id to,
                        const himc_line_sink *sink)
{
    for (const setting *row = table; row < table + SETTINGS; row++)
        if (row->id >= from && row->id < to)
            row->tell(&(telling){row->id, s, (const char *)s + row->at, row->size, sink});
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
