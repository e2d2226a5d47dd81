/// performance_command.c: the performer's commands, one row of a table for each of command_rows.h.
///
/// They act between physics steps. A command of kind AT_SAMPLE with a delay waits in a queue until
/// the step at its sample; the others may allocate or read files, and act at once. A command that
/// cannot be carried out changes nothing and gives the reason in one line.
#include "base/argument.h"
#include "base/format.h"
#include "performance/performance_state.h"

#include <stdio.h>
#include <string.h>

#define LONGEST_DELAY 8192 // chosen: the largest block of Pure Data and more (samples)

static bool carry_out(himc_performance *p, const himc_command *c, himc_error *error)
{
    return himc_job_carry_out(p->runner.job(p, c, error), error);
}

// playing

static bool do_stroke(himc_performance *p, const himc_command *c, himc_error *error)
{
    return himc_performance_add_stroke(p, &c->stroke, error);
}

static bool do_hit(himc_performance *p, const himc_command *c, himc_error *error)
{
    return himc_performance_hit(p, &c->stroke, error);
}

static bool do_tempo(himc_performance *p, const himc_command *c, himc_error *error)
{
    if (c->count == 1)
        return himc_performance_set_tempo(p, c->atom[0].number, error);
    himc_tempo_change tempo = {.bpm = c->atom[0].number, .beat = c->atom[1].number};
    himc_motion_replan(p->motion);
    return himc_planner_add_tempo(p->motion->planner, &tempo, error);
}

static bool do_clear(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)c, (void)error;
    himc_planner_clear(p->motion->planner);
    himc_text_clear(&p->written.score);
    himc_drums_drop_heads(&p->drums);
    himc_body_plan_pushes(p->body, NULL, 0, PUSHES_ANEW, NULL);
    himc_motion_replan(p->motion);
    return true;
}

static bool do_loop(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    himc_planner_loop(p->motion->planner, step_time(p), c->atom[0].number != 0);
    himc_motion_replan(p->motion);
    return true;
}

static bool do_play(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)c;
    return himc_performance_play(p, error);
}

static bool do_stop(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)c, (void)error;
    himc_performance_stop(p);
    return true;
}

static bool do_seek(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    himc_planner_seek(p->motion->planner, step_time(p), c->atom[0].number);
    himc_motion_replan(p->motion);
    return true;
}

static bool do_units(himc_performance *p, const himc_command *c, himc_error *error)
{
    enum { CLEAR };
    if (c->form != CLEAR)
        return carry_out(p, c, error);
    himc_motion_replan(p->motion);
    himc_planner_clear_units(p->motion->planner);
    himc_text_clear(&p->written.units);
    return true;
}

static bool do_target(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    himc_performance_target(
        p, (himc_hand)c->choice[0],
        himc_vec3_make(c->atom[1].number, c->atom[2].number, c->atom[3].number));
    return true;
}

static bool do_nudge(himc_performance *p, const himc_command *c, himc_error *error)
{
    himc_nudge nudge = himc_performance_nudge(c);
    if (!p->motion->track)
        return himc_error_set(error, "nudge: no take is loaded");
    return himc_track_nudge(p->motion->track, &nudge, error);
}

// the settings

// what follows from a command that has changed a setting
static void follow(himc_performance *p, const himc_command *c, himc_pipeline before)
{
    const performance_settings *s = &p->settings;
    himc_planner *planner = p->motion->planner;
    enum { DRUMS = 3 }; // form of `gain`
    switch (himc_settings_effect(c->id)) {
    case AFTER_MODE:
        if (before == HIMC_PIPELINE_IK && s->control.mode != HIMC_PIPELINE_IK)
            himc_body_take_up(p->body);
        if (p->motion->has_regression)
            himc_motion_replan(p->motion);
        return;
    case AFTER_LIMITS:
        himc_performance_renew_limits(p);
        himc_body_clear_limit_counts(p->body); // the counts belong to other limits
        return;
    case AFTER_FADER:
        if (c->form == DRUMS)
            himc_drums_fade(&p->drums, pow(10, c->atom[0].number / 20), p->drums.mute);
        return;
    case AFTER_STEPS: himc_performance_restart_steps(p); return;
    case AFTER_GRIP:
        himc_planner_set_grip(planner, s->grip);
        himc_planner_set_servo(planner, s->servo);
        break;
    case AFTER_HUMAN: himc_planner_set_human(planner, s->human); break;
    case AFTER_REPLAN: break;
    default: return;
    }
    himc_motion_replan(p->motion);
}

static bool do_setting(himc_performance *p, const himc_command *c, himc_error *error)
{
    performance_settings s = p->settings;
    himc_pipeline before = s.control.mode;
    if (!himc_performance_allows(p->recording.file, c, error) ||
        !himc_settings_read(&s, &p->host.usual, c, error))
        return false;
    if (himc_settings_effect(c->id) == AFTER_BODY) {
        performance_settings old = p->settings;
        if (!p->motion->track || p->written.take_command.count == 0)
            return himc_performance_rebuild(p, &s, error);
        p->settings = s; // a take is loaded again for a body of other size: its lengths stay
        if (himc_job_carry_out(himc_performance_take_again_job(p, error), error))
            return true;
        p->settings = old;
        return false;
    }
    himc_performance_adopt(p, &s);
    follow(p, c, before);
    return true;
}

// body and instrument

static bool do_push(himc_performance *p, const himc_command *c, himc_error *error)
{
    planned_push push;
    if (!himc_body_read_push(c, &push, error))
        return false;
    himc_body_push(p->body, &push, step_time(p));
    return true;
}

// who listens, as the command says
static himc_listener listener_of(const himc_command *c)
{
    enum { OFF };
    if (c->form == OFF)
        return (himc_listener){.on = false};
    himc_listener listener =
        himc_listener_at(himc_vec3_make(c->atom[0].number, c->atom[1].number, c->atom[2].number));
    if (c->count > 3)
        listener.yaw = himc_argument_usual(c->atom[3].number, listener.yaw);
    return listener;
}

static bool do_listener(himc_performance *p, const himc_command *c, himc_error *error)
{
    himc_listener listener = listener_of(c);
    return himc_drums_listen(&p->drums, &listener, error);
}

static himc_job *listener_job(himc_performance *p, const himc_command *c, himc_error *error)
{
    himc_listener listener = listener_of(c);
    return himc_drums_listen_job(&p->drums, &listener, error);
}

static bool do_room(himc_performance *p, const himc_command *c, himc_error *error)
{
    const himc_walls usual = HIMC_WALLS_USUAL;
    himc_walls walls = {himc_argument_usual(c->atom[0].number, usual.seconds),
                        p->drums.walls.volume};
    (void)error;
    if (c->count > 1)
        walls.volume = himc_argument_usual(c->atom[1].number, usual.volume);
    himc_drums_enclose(&p->drums, &walls);
    return true;
}

static bool do_mute(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    himc_drums_fade(&p->drums, p->drums.gain, c->atom[0].number == 1);
    return true;
}

static bool do_reset(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)c;
    return himc_performance_reset(p, error);
}

static bool do_drum(himc_performance *p, const himc_command *c, himc_error *error)
{
    return himc_performance_find_drum(p, c->atom[0].symbol) || carry_out(p, c, error);
}

// without a file the host answers, with himc_performance_describe; as `info`
static bool do_dump(himc_performance *p, const himc_command *c, himc_error *error)
{
    return c->count == 0 || carry_out(p, c, error);
}

static bool refuse_network(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)p;
    return himc_error_set(error, "%s: only as a message to [himc~] or over OSC",
                          himc_command_table((int)c->id)->name);
}

// the table

static bool names_file(const himc_performance *p, const himc_command *c)
{
    int file;
    (void)p;
    return himc_command_file(c, &file) != HIMC_FILE_NONE;
}

static bool makes_drum(const himc_performance *p, const himc_command *c)
{
    return himc_drums_find(&p->drums, c->atom[0].symbol) < 0;
}

static bool listening_takes_long(const himc_performance *p, const himc_command *c)
{
    (void)c;
    return himc_drums_listening_takes_long(&p->drums);
}

/// How a command is carried out. One that reads or writes a file, makes a drum or computes heads
/// takes long: a loader (himc/loader.h) carries out its job, which the performance must outlive.
typedef struct performer_action {
    performance_action *act; ///< carry_out: always a job
    himc_job *(*job)(himc_performance *, const himc_command *, himc_error *);
    bool (*takes_long)(const himc_performance *, const himc_command *); ///< NULL: always
} performer_action;

// a row for each command of the performer
static const performer_action actions[HIMC_COMMANDS] = {
#define HIMC_SETTING_ROW(ID, word, when, atoms, kind, field, usual, after, does) \
    [HIMC_COMMAND_##ID] = {.act = do_setting},
#include "himc/command_rows.h"
    [HIMC_COMMAND_STROKE] = {.act = do_stroke},
    [HIMC_COMMAND_ROLL] = {.act = do_stroke},
    [HIMC_COMMAND_FLAM] = {.act = do_stroke},
    [HIMC_COMMAND_DRAG] = {.act = do_stroke},
    [HIMC_COMMAND_RUFF] = {.act = do_stroke},
    [HIMC_COMMAND_HIT] = {.act = do_hit},
    [HIMC_COMMAND_AT] = {.act = carry_out, .job = himc_performance_change_job},
    [HIMC_COMMAND_TEMPO] = {.act = do_tempo},
    [HIMC_COMMAND_LOOP] = {.act = do_loop},
    [HIMC_COMMAND_CLEAR] = {.act = do_clear},
    [HIMC_COMMAND_PLAY] = {.act = do_play},
    [HIMC_COMMAND_STOP] = {.act = do_stop},
    [HIMC_COMMAND_SEEK] = {.act = do_seek},
    [HIMC_COMMAND_SCORE] = {.act = carry_out, .job = himc_performance_score_job},
    [HIMC_COMMAND_TAKE] = {.act = carry_out, .job = himc_performance_take_job},
    [HIMC_COMMAND_NUDGE] = {.act = do_nudge},
    [HIMC_COMMAND_UNITS] = {.act = do_units,
                            .job = himc_performance_units_job,
                            .takes_long = names_file},
    [HIMC_COMMAND_TARGET] = {.act = do_target},
    [HIMC_COMMAND_PUSH] = {.act = do_push},
    [HIMC_COMMAND_LISTENER] = {.act = do_listener,
                               .job = listener_job,
                               .takes_long = listening_takes_long},
    [HIMC_COMMAND_ROOM] = {.act = do_room},
    [HIMC_COMMAND_MUTE] = {.act = do_mute},
    [HIMC_COMMAND_RECORD] = {.act = carry_out, .job = himc_performance_record_job},
    [HIMC_COMMAND_INFO] = {.act = do_dump},
    [HIMC_COMMAND_DUMP] = {.act = do_dump,
                           .job = himc_performance_dump_job,
                           .takes_long = names_file},
    [HIMC_COMMAND_PRESET] = {.act = carry_out,
                             .job = himc_performance_score_job}, // the parser makes it a score
    [HIMC_COMMAND_RESET] = {.act = do_reset},
    [HIMC_COMMAND_MAKE_DRUM] = {.act = do_drum,
                                .job = himc_performance_drum_job,
                                .takes_long = makes_drum},
    [HIMC_COMMAND_SUBSCRIBE] = {.act = refuse_network},
    [HIMC_COMMAND_UNSUBSCRIBE] = {.act = refuse_network},
    [HIMC_COMMAND_LISTEN] = {.act = refuse_network},
};

static bool takes_long(const himc_performance *p, const himc_command *c)
{
    const performer_action *a = &actions[c->id];
    return a->job && (!a->takes_long || a->takes_long(p, c));
}

static himc_job *job_of(himc_performance *p, const himc_command *c, himc_error *error)
{
    return actions[c->id].job(p, c, error);
}

// the drum that a command is for, or NULL with the reason
static himc_drum *drum_of(himc_performance *p, const himc_command *c, himc_error *error)
{
    int index = himc_drums_find(&p->drums, c->drum);
    if (index >= 0)
        return p->drums.slot[index].drum;
    himc_drums_refuse(&p->drums, c->drum, HIMC_SPOT_XY, error);
    return NULL;
}

// DRUM COMMAND ...
static bool command_drum(himc_performance *p, const himc_command *c, int delay, himc_error *error)
{
    himc_drum *drum = drum_of(p, c, error);
    if (!drum)
        return false;
    himc_motion_stir(p->motion);
    int ahead = himc_clock_ahead(&p->clock);
    bool good =
        c->id == HIMC_COMMAND_STRIKE
            ? himc_drum_strike_at(drum, delay > ahead ? delay - ahead : 0, c->atom[0].number,
                                  c->atom[1].number, c->atom[2].number, error)
            : himc_drum_command(drum, c, error);
    return good || himc_error_prefix(error, "%s", c->drum);
}

const himc_runner himc_performance_runner = {takes_long, himc_performance_command, job_of,
                                             himc_performance_state_job, drum_of};

// makes drums for waiting commands now, not in the audio callback
static bool prepare(himc_performance *p, const himc_command *command, himc_error *error)
{
    int index;
    if (command->id == HIMC_COMMAND_HIT)
        return himc_performance_ensure_drum(p, command->stroke.drum, command->stroke.spot, &index,
                                            error);
    return command->id != HIMC_COMMAND_PLAY ||
           himc_performance_ensure_drum(p, "", HIMC_SPOT_NORMAL, &index, error);
}

bool himc_performance_command(himc_performance *p, const himc_command *command, int delay,
                              himc_error *error)
{
    const himc_command_row *row = himc_command_table((int)command->id);
    if (!row)
        return himc_error_set(error, "command %d: not from the parser", (int)command->id);
    if (command->drum[0])
        return command_drum(p, command, delay, error);
    if (row->receiver != HIMC_PERFORMER)
        return himc_error_set(error, "a drum's command, not the performer's");
    bool on_beat = command->id == HIMC_COMMAND_TEMPO && command->count > 1; // and it allocates
    if (delay <= 0 || row->when != HIMC_WHEN_AT_SAMPLE || on_beat)
        return actions[command->id].act(p, command, error);
    if (delay > LONGEST_DELAY)
        return himc_error_set(error, "delay: %d samples, expected 0 .. %d", delay, LONGEST_DELAY);
    if (!himc_queue_has_room(&p->queue))
        return himc_queue_drop(&p->queue, error);
    if (!prepare(p, command, error))
        return false;
    himc_queue_add(&p->queue, command, p->clock.played + delay);
    return true;
}

static bool run_waiting(himc_performance *p, const himc_command *command, himc_error *error)
{
    himc_drums_catch_up(&p->drums);
    himc_motion_stir(p->motion);
    return actions[command->id].act(p, command, error);
}

void himc_performance_run_due_commands(himc_performance *p)
{
    himc_queue_run(&p->queue, p->clock.made, run_waiting, p, &p->events);
}
