/// performance_command.c: the performer's commands, one function for each row of command_rows.h
/// that is for the performer.
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
/// That a hit needs from rest (s): measured, an accent at ff; vertical accents need more from f on.
#define LONGEST_PREPARATION 0.33

static bool carry_out(himc_performance *p, const himc_command *c, himc_error *error)
{
    return himc_job_carry_out(p->runner.job(p, c, error), error);
}

// playing

static bool do_stroke(himc_performance *p, const himc_command *c, himc_error *error)
{
    return himc_performance_add_stroke(p, &c->stroke, error);
}

static bool do_roll(himc_performance *p, const himc_command *c, himc_error *error)
{
    return himc_performance_add_stroke(p, &c->stroke, error);
}

static bool do_flam(himc_performance *p, const himc_command *c, himc_error *error)
{
    return himc_performance_add_stroke(p, &c->stroke, error);
}

static bool do_drag(himc_performance *p, const himc_command *c, himc_error *error)
{
    return himc_performance_add_stroke(p, &c->stroke, error);
}

static bool do_ruff(himc_performance *p, const himc_command *c, himc_error *error)
{
    return himc_performance_add_stroke(p, &c->stroke, error);
}

static bool do_hit(himc_performance *p, const himc_command *c, himc_error *error)
{
    return himc_performance_hit(p, &c->stroke, error);
}

static bool do_at(himc_performance *p, const himc_command *c, himc_error *error)
{
    return carry_out(p, c, error);
}

static bool do_latency(himc_performance *p, const himc_command *c, himc_error *error)
{
    performance_settings s = p->settings;
    enum { TIME, AUTO };
    (void)error;
    s.latency = c->form == AUTO ? LONGEST_PREPARATION : 1e-3 * c->atom[0].number;
    himc_performance_adopt(p, &s);
    return true;
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

static bool do_score(himc_performance *p, const himc_command *c, himc_error *error)
{
    return carry_out(p, c, error);
}

// which the parser makes a score
static bool do_preset(himc_performance *p, const himc_command *c, himc_error *error)
{
    return carry_out(p, c, error);
}

static bool do_take(himc_performance *p, const himc_command *c, himc_error *error)
{
    return carry_out(p, c, error);
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

static bool do_drum(himc_performance *p, const himc_command *c, himc_error *error)
{
    if (himc_performance_find_drum(p, c->atom[0].symbol))
        return true;
    return carry_out(p, c, error);
}

// control

static bool do_mode(himc_performance *p, const himc_command *c, himc_error *error)
{
    himc_pipeline mode = (himc_pipeline)c->choice[0];
    performance_settings s = p->settings;
    (void)error;
    if (s.control.mode == HIMC_PIPELINE_IK && mode != HIMC_PIPELINE_IK)
        himc_body_take_up(p->body);
    s.control.mode = mode;
    himc_performance_adopt(p, &s);
    if (p->motion->has_regression)
        himc_motion_replan(p->motion);
    return true;
}

static bool do_solver(himc_performance *p, const himc_command *c, himc_error *error)
{
    performance_settings s = p->settings;
    (void)error;
    s.control.solver = (himc_solver)c->choice[0];
    himc_performance_adopt(p, &s);
    return true;
}

static bool do_damping(himc_performance *p, const himc_command *c, himc_error *error)
{
    performance_settings s = p->settings;
    (void)error;
    s.control.damping =
        himc_argument_usual(c->atom[0].number, himc_controller_config_default().damping);
    himc_performance_adopt(p, &s);
    return true;
}

static bool do_posture(himc_performance *p, const himc_command *c, himc_error *error)
{
    performance_settings s = p->settings;
    (void)error;
    s.control.null_space_off = c->atom[0].number == 0;
    himc_performance_adopt(p, &s);
    return true;
}

static bool do_nudge(himc_performance *p, const himc_command *c, himc_error *error)
{
    himc_nudge nudge = himc_performance_nudge(c);
    if (!p->motion->track)
        return himc_error_set(error, "nudge: no take is loaded");
    return himc_track_nudge(p->motion->track, &nudge, error);
}

static bool do_bend(himc_performance *p, const himc_command *c, himc_error *error)
{
    performance_settings s = p->settings;
    (void)error;
    s.unbent = c->atom[0].number == 0;
    himc_performance_adopt(p, &s);
    himc_motion_replan(p->motion);
    return true;
}

static bool do_elbow(himc_performance *p, const himc_command *c, himc_error *error)
{
    performance_settings s = p->settings;
    (void)error;
    s.control.elbow = c->atom[0].number != 0;
    himc_performance_adopt(p, &s);
    return true;
}

static bool do_weights(himc_performance *p, const himc_command *c, himc_error *error)
{
    performance_settings s = p->settings;
    const himc_controller_config usual = himc_controller_config_default();
    (void)error;
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        s.control.weight[k] = himc_argument_usual(c->atom[k].number, usual.weight[k]);
    himc_performance_adopt(p, &s);
    return true;
}

static bool do_law(himc_performance *p, const himc_command *c, himc_error *error)
{
    performance_settings s = p->settings;
    (void)error;
    s.control.law = (himc_law)c->choice[0];
    himc_performance_adopt(p, &s);
    return true;
}

static bool do_gain(himc_performance *p, const himc_command *c, himc_error *error)
{
    performance_settings s = p->settings;
    himc_controller_config *config = &s.control;
    enum { RESET, FREQUENCY, JOINT, DRUMS };
    int joint;
    if (c->form == DRUMS) {
        himc_drums_fade(&p->drums, pow(10, c->atom[0].number / 20), p->drums.mute);
        return true;
    }
    if (c->form == RESET) {
        memset(config->gain_set, 0, sizeof config->gain_set);
        memset(s.gain, 0, sizeof s.gain);
    } else if (c->form == FREQUENCY) {
        for (joint = 0; joint < HIMC_JOINTS; joint++) {
            config->gain_set[joint] = true;
            s.gain[joint] = (asked_gain){.frequency = c->atom[1].number};
        }
    } else {
        if (!himc_body_find_joint(c->atom[0].symbol, "gain", &joint, error))
            return false;
        config->gain_set[joint] = true;
        s.gain[joint] = (asked_gain){c->atom[1].number, c->atom[2].number, 0};
    }
    himc_settings_gains(&s, &p->body->controller);
    himc_performance_adopt(p, &s);
    return true;
}

static bool do_limits(himc_performance *p, const himc_command *c, himc_error *error)
{
    performance_settings s = p->settings;
    (void)error;
    s.limits = (himc_limits_kind)c->choice[0];
    himc_performance_adopt(p, &s);
    himc_performance_renew_limits(p);
    himc_body_clear_limit_counts(p->body); // the counts belong to other limits
    return true;
}

static bool do_strength(himc_performance *p, const himc_command *c, himc_error *error)
{
    performance_settings s = p->settings;
    enum { HUMAN, OFF };
    enum { ALL, JOINT };
    int joint;
    if (c->form == JOINT) {
        if (!himc_body_find_joint(c->atom[0].symbol, "strength", &joint, error))
            return false;
        s.control.strength[joint] = c->atom[1].number;
    } else if (c->choice[0] == HUMAN) {
        himc_controller_set_human_strength(&s.control, s.skeleton.mass);
    } else {
        memset(s.control.strength, 0, sizeof s.control.strength);
        s.control.human_strength = false;
    }
    himc_performance_adopt(p, &s);
    return true;
}

static bool do_rate(himc_performance *p, const himc_command *c, himc_error *error)
{
    performance_settings s = p->settings;
    enum { PHYSICS, TASK };
    bool physics = c->form == PHYSICS;
    double hz = c->atom[1].number;
    if (!himc_performance_allows(p->recording.file, c, error))
        return false;
    const himc_performance_config *usual = &p->host.config;
    *(physics ? &s.physics_rate : &s.task_rate) =
        himc_argument_usual(hz, physics ? usual->physics_rate : usual->task_rate);
    himc_performance_adopt(p, &s);
    himc_performance_restart_steps(p);
    return true;
}

static bool do_coupling(himc_performance *p, const himc_command *c, himc_error *error)
{
    performance_settings s = p->settings;
    (void)error;
    s.one_way = c->choice[0] == HIMC_COUPLING_ONE_WAY;
    himc_performance_adopt(p, &s);
    return true;
}

static bool do_engine(himc_performance *p, const himc_command *c, himc_error *error)
{
    performance_settings s = p->settings;
    (void)error;
    s.engine = (himc_engine)c->choice[0];
    himc_performance_adopt(p, &s);
    return true;
}

// body and instrument

static bool do_grip(himc_performance *p, const himc_command *c, himc_error *error)
{
    performance_settings s = p->settings;
    enum { PALMS, SERVO };
    (void)error;
    s.servo = c->form == SERVO || c->count > 1;
    if (c->form == PALMS)
        s.grip = (himc_grip)c->choice[0];
    himc_performance_adopt(p, &s);
    himc_planner_set_grip(p->motion->planner, s.grip);
    himc_planner_set_servo(p->motion->planner, s.servo);
    himc_motion_replan(p->motion);
    return true;
}

static bool do_human(himc_performance *p, const himc_command *c, himc_error *error)
{
    performance_settings s = p->settings;
    (void)error;
    s.human.amount = c->atom[0].number;
    s.human.seed = c->count > 1 ? (uint32_t)c->atom[1].number : 0;
    himc_performance_adopt(p, &s);
    himc_planner_set_human(p->motion->planner, s.human);
    himc_motion_replan(p->motion);
    return true;
}

static bool do_alive(himc_performance *p, const himc_command *c, himc_error *error)
{
    performance_settings s = p->settings;
    (void)error;
    s.alive = c->atom[0].number != 0;
    himc_performance_adopt(p, &s);
    return true;
}

// Height and mass as asked for replace those of a take's player, whether the take comes after or
// has come before. The usual ones are as if nobody had asked.
static bool do_player(himc_performance *p, const himc_command *c, himc_error *error)
{
    performance_settings s = p->settings, before = s;
    const himc_skeleton_config usual = himc_skeleton_default();
    s.skeleton.height = himc_argument_usual(c->atom[0].number, usual.height);
    s.skeleton.mass = himc_argument_usual(c->atom[1].number, usual.mass);
    bool asked = s.skeleton.height != usual.height || s.skeleton.mass != usual.mass;
    s.asked_height = asked ? s.skeleton.height : 0;
    s.asked_mass = asked ? s.skeleton.mass : 0;
    s.skeleton.seat = s.skeleton.shoulders = 0; // not those measured from a take
    memset(s.skeleton.length, 0, sizeof s.skeleton.length);
    if (!p->motion->track || p->written.take_command.count == 0)
        return himc_performance_rebuild(p, &s, error);
    p->settings = s; // the take's lengths stay
    if (himc_job_carry_out(himc_performance_take_again_job(p, error), error))
        return true;
    p->settings = before;
    return false;
}

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

static bool do_record(himc_performance *p, const himc_command *c, himc_error *error)
{
    return carry_out(p, c, error);
}

// without a file the host answers, with himc_performance_describe
static bool do_dump(himc_performance *p, const himc_command *c, himc_error *error)
{
    return c->count == 0 || carry_out(p, c, error);
}

static bool do_reset(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)c;
    return himc_performance_reset(p, error);
}

// carried out by the host, with himc_performance_describe
static bool leave_to_host(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)p, (void)c, (void)error;
    return true;
}

static bool refuse_network(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)p;
    return himc_error_set(error, "%s: only as a message to [himc~] or over OSC",
                          himc_command_table((int)c->id)->name);
}

// the action of a row for the performer is do_ and its word
static performance_action *const actions[HIMC_COMMANDS] = {
#define ACTION_NOW(word) do_##word
#define ACTION_AT_SAMPLE(word) do_##word
#define ACTION_HOST(word) leave_to_host
#define ACTION_NETWORK(word) refuse_network
#define ACTION_DRUM(ID, word, when)
#define ACTION_PERFORMER(ID, word, when) [HIMC_COMMAND_##ID] = ACTION_##when(word),
#define HIMC_COMMAND_ROW(ID, word, receiver, when, marks, atoms, does) \
    ACTION_##receiver(ID, word, when)
#include "himc/command_rows.h"
};

// the drum that a command is for, or NULL with the reason
static himc_drum *drum_of(void *receiver, const himc_command *c, himc_error *error)
{
    himc_performance *p = receiver;
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

// true if it reads or writes a file, makes a drum or computes heads
static bool takes_long(const void *receiver, const himc_command *c)
{
    const himc_performance *p = receiver;
    int file;
    if (c->id == HIMC_COMMAND_MAKE_DRUM)
        return himc_drums_find(&p->drums, c->atom[0].symbol) < 0;
    if (c->id == HIMC_COMMAND_LISTENER)
        return himc_drums_listening_takes_long(&p->drums);
    return c->id == HIMC_COMMAND_AT || c->id == HIMC_COMMAND_RECORD ||
           himc_command_file(c, &file) != HIMC_FILE_NONE;
}

// a command that takes long; the performance must outlive it
static himc_job *job_of(void *receiver, const himc_command *c, himc_error *error)
{
    himc_performance *p = receiver;
    enum { STOP };
    switch (c->id) {
    case HIMC_COMMAND_SCORE: return himc_performance_score_job(p, c, error);
    case HIMC_COMMAND_AT: return himc_performance_change_job(p, c, error);
    case HIMC_COMMAND_DUMP: return himc_performance_dump_job(p, c, error);
    case HIMC_COMMAND_TAKE: return himc_performance_take_job(p, c, error);
    case HIMC_COMMAND_UNITS: return himc_performance_units_job(p, c, error);
    case HIMC_COMMAND_LISTENER: return listener_job(p, c, error);
    case HIMC_COMMAND_MAKE_DRUM: return himc_performance_drum_job(p, c, error);
    default:
        return c->form == STOP ? himc_performance_record_stop_job(p, c, error)
                               : himc_performance_record_job(p, c, error);
    }
}

static bool run(void *receiver, const himc_command *c, int delay, himc_error *error)
{
    return himc_performance_command(receiver, c, delay, error);
}

static himc_job *state_job(void *receiver, const char *state, himc_error *error)
{
    return himc_performance_state_job(receiver, state, error);
}

const himc_runner himc_performance_runner = {takes_long, run, job_of, state_job, drum_of};

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
    performance_action *act = actions[command->id];
    if (command->drum[0])
        return command_drum(p, command, delay, error);
    if (!act)
        return himc_error_set(error, "a drum's command, not the performer's");
    bool on_beat = command->id == HIMC_COMMAND_TEMPO && command->count > 1; // and it allocates
    if (delay <= 0 || row->when != HIMC_WHEN_AT_SAMPLE || on_beat)
        return act(p, command, error);
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
    return actions[command->id](p, command, error);
}

void himc_performance_run_due_commands(himc_performance *p)
{
    himc_queue_run(&p->queue, p->clock.made, run_waiting, p, &p->events);
}
