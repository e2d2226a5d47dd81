/// performance_command.c: the commands, one small function each.
///
/// Commands act between physics steps: one that comes with a delay waits in a queue until the step
/// at its sample. A command that cannot be carried out changes nothing and says why in one line.
#include "performance/performance_state.h"

#include <stdio.h>
#include <string.h>

#define LONGEST_DELAY 8192 // chosen: the largest block of Pure Data and more (samples)

// which of the words, which the parser has checked
int himc_performance_word(const char *word, const char *const *words, int count)
{
    for (int i = 0; i < count; i++)
        if (strcmp(word, words[i]) == 0)
            return i;
    return 0;
}

// what to play

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
    if (c->count > 1)
        return himc_error_set(error,
                              "tempo: BEAT: only in a score file; here a tempo holds from now on");
    return himc_performance_set_tempo(p, c->atom[0].number, error);
}

static bool do_clear(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)c, (void)error;
    himc_planner_clear(p->motion->planner);
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

static bool run_now(himc_performance *p, const himc_command *c, himc_error *error)
{
    return himc_performance_command(p, c, 0, error);
}

static bool do_score(himc_performance *p, const himc_command *c, himc_error *error)
{
    return himc_performance_load_score(p, c->atom[0].symbol, run_now, error);
}

static bool do_take(himc_performance *p, const himc_command *c, himc_error *error)
{
    return himc_performance_load_take(p, c->atom[0].symbol, error);
}

static bool do_units(himc_performance *p, const himc_command *c, himc_error *error)
{
    static const char *const nuances[] = {"legato", "tenuto", "accent", "vertical-accent",
                                          "staccato"};
    static const char *const spots[] = {"center", "normal", "rim"};
    himc_motion_replan(p->motion);
    if (c->count == 1) {
        himc_planner_clear_units(p->motion->planner);
        return true;
    }
    himc_nuance nuance =
        (himc_nuance)himc_performance_word(c->atom[1].symbol, nuances, HIMC_NUANCES);
    bool has_spot = c->count > 2 && c->atom[2].kind == HIMC_ATOM_SYMBOL;
    himc_spot spot = HIMC_SPOT_NORMAL;
    if (has_spot)
        spot = (himc_spot)himc_performance_word(c->atom[2].symbol, spots, 3);
    return himc_performance_add_units(p, c->atom[0].symbol, nuance, has_spot ? &spot : NULL, error);
}

static bool do_target(himc_performance *p, const himc_command *c, himc_error *error)
{
    himc_hand hand = strcmp(c->atom[0].symbol, "left") == 0 ? HIMC_LEFT : HIMC_RIGHT;
    (void)error;
    himc_performance_target(
        p, hand, himc_vec3_make(c->atom[1].number, c->atom[2].number, c->atom[3].number));
    return true;
}

static bool do_drum(himc_performance *p, const himc_command *c, himc_error *error)
{
    const char *name = c->atom[0].symbol;
    if (!p->host.make_drums || himc_drums_find(&p->drums, name) >= 0)
        return true; // in Pd each [membrane~ NAME] is a drum
    return himc_performance_make_drum(p, name, c->count > 1 ? c->atom[1].number : USUAL_INCHES,
                                      error);
}

// control

static bool do_mode(himc_performance *p, const himc_command *c, himc_error *error)
{
    static const char *const words[] = {"himc", "id", "ik"};
    himc_pipeline mode = (himc_pipeline)himc_performance_word(c->atom[0].symbol, words, 3);
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
    static const char *const words[HIMC_SOLVERS] = {"dls", "pinv", "transpose", "nakamura", "sdls"};
    performance_settings s = p->settings;
    (void)error;
    s.control.solver = (himc_solver)himc_performance_word(c->atom[0].symbol, words, HIMC_SOLVERS);
    himc_performance_adopt(p, &s);
    return true;
}

static bool do_damping(himc_performance *p, const himc_command *c, himc_error *error)
{
    performance_settings s = p->settings;
    (void)error;
    s.control.damping = c->atom[0].number;
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
    (void)error;
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        s.control.weight[k] = c->atom[k].number;
    himc_performance_adopt(p, &s);
    return true;
}

static bool do_law(himc_performance *p, const himc_command *c, himc_error *error)
{
    static const char *const words[] = {"printed", "feedforward", "computed-torque"};
    performance_settings s = p->settings;
    (void)error;
    s.control.law = (himc_law)himc_performance_word(c->atom[0].symbol, words, 3);
    himc_performance_adopt(p, &s);
    return true;
}

// all joints: k_s goes with the square of the natural frequency, k_d with the frequency itself
static void scale_frequencies(const himc_controller *controller, himc_controller_config *config,
                              double factor)
{
    for (int j = 0; j < HIMC_JOINTS; j++) {
        himc_gain usual = himc_controller_usual_gain(controller, j);
        config->gain[j].stiffness = himc_vec3_scale(usual.stiffness, factor * factor);
        config->gain[j].damping = himc_vec3_scale(usual.damping, factor);
        config->gain_set[j] = true;
    }
}

static bool do_gain(himc_performance *p, const himc_command *c, himc_error *error)
{
    performance_settings s = p->settings;
    himc_controller_config *config = &s.control;
    int joint;
    if (c->count == 1) {
        memset(config->gain_set, 0, sizeof config->gain_set);
    } else if (c->count == 2) {
        scale_frequencies(&p->body->controller, config, c->atom[1].number);
    } else {
        if (!himc_body_find_joint(c->atom[0].symbol, "gain", &joint, error))
            return false;
        config->gain[joint] =
            himc_controller_gain(&p->body->controller, joint, c->atom[1].number, c->atom[2].number);
        config->gain_set[joint] = true;
    }
    himc_performance_adopt(p, &s);
    return true;
}

static bool do_limits(himc_performance *p, const himc_command *c, himc_error *error)
{
    static const char *const words[] = {"off", "ellipsoid", "euler"};
    performance_settings s = p->settings;
    (void)error;
    s.limits = (himc_limits_kind)himc_performance_word(c->atom[0].symbol, words, 3);
    himc_performance_adopt(p, &s);
    himc_performance_renew_limits(p);
    himc_body_clear_limit_counts(p->body); // they were of other limits
    return true;
}

static bool do_strength(himc_performance *p, const himc_command *c, himc_error *error)
{
    performance_settings s = p->settings;
    int joint;
    if (c->count > 1) {
        if (!himc_body_find_joint(c->atom[0].symbol, "strength", &joint, error))
            return false;
        s.control.strength[joint] = c->atom[1].number;
    } else if (strcmp(c->atom[0].symbol, "human") == 0) {
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
    bool physics = strcmp(c->atom[0].symbol, "physics") == 0;
    double hz = c->atom[1].number;
    if (!himc_performance_check_rate(physics, hz, error))
        return false;
    if (!physics && p->recording.file)
        return himc_error_set(error, "rate task: %g: not while recording %s", hz,
                              himc_recording_path(p->recording.file));
    *(physics ? &s.physics_rate : &s.task_rate) = hz;
    himc_performance_adopt(p, &s);
    himc_performance_restart_steps(p);
    return true;
}

static bool do_coupling(himc_performance *p, const himc_command *c, himc_error *error)
{
    performance_settings s = p->settings;
    (void)error;
    s.one_way = strcmp(c->atom[0].symbol, "one-way") == 0;
    himc_performance_adopt(p, &s);
    return true;
}

// body and instrument

static bool do_grip(himc_performance *p, const himc_command *c, himc_error *error)
{
    performance_settings s = p->settings;
    (void)error;
    s.grip = strcmp(c->atom[0].symbol, "french") == 0 ? HIMC_GRIP_FRENCH : HIMC_GRIP_GERMAN;
    himc_performance_adopt(p, &s);
    himc_planner_set_grip(p->motion->planner, s.grip);
    return true;
}

static bool do_player(himc_performance *p, const himc_command *c, himc_error *error)
{
    performance_settings s = p->settings;
    s.skeleton.height = c->atom[0].number;
    s.skeleton.mass = c->atom[1].number;
    s.skeleton.seat = s.skeleton.shoulders = 0; // not those that a take has measured
    memset(s.skeleton.length, 0, sizeof s.skeleton.length);
    return himc_performance_rebuild(p, &s, error);
}

static int find_segment(const char *name)
{
    for (int i = HIMC_PELVIS + 1; i < HIMC_SEGMENTS; i++)
        if (strcmp(name, himc_segment_name(i)) == 0)
            return i;
    return -1;
}

static bool unknown_segment(const char *name, himc_error *error)
{
    himc_error_set(error, "push: SEGMENT: %s, allowed", name);
    size_t used = error ? strlen(error->text) : 0;
    for (int i = HIMC_PELVIS + 1; error && i < HIMC_SEGMENTS; i++)
        used += (size_t)snprintf(error->text + used, sizeof error->text - used, " %s",
                                 himc_segment_name(i));
    return false;
}

static bool do_push(himc_performance *p, const himc_command *c, himc_error *error)
{
    int i = find_segment(c->atom[0].symbol);
    if (i < 0)
        return unknown_segment(c->atom[0].symbol, error);
    himc_vec3 force = {c->atom[1].number, c->atom[2].number, c->atom[3].number};
    himc_body_push(p->body, i, force, step_time(p) + c->atom[4].number);
    return true;
}

// a recording that cannot be written is lost, and the error says so
static bool finish_recording(himc_performance *p, himc_error *error)
{
    bool written = himc_performance_write_recording(p, error);
    himc_performance_drop_recording(p);
    return written;
}

static bool do_record(himc_performance *p, const himc_command *c, himc_error *error)
{
    const char *path = c->atom[0].symbol;
    bool stop = strcmp(path, "stop") == 0;
    if (stop && !p->recording.file)
        return himc_error_set(error, "record: stop: nothing is being recorded, allowed FILE");
    if (stop)
        return finish_recording(p, error);
    if (p->recording.file)
        return himc_error_set(error, "record: %s: already recording %s, allowed stop", path,
                              himc_recording_path(p->recording.file));
    return himc_performance_begin_recording(p, path, error);
}

static bool do_reset(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)c;
    return himc_performance_reset(p, error);
}

static bool do_info(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)p, (void)c, (void)error; // answered by whoever asked, with himc_performance_describe
    return true;
}

static bool do_network(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)p;
    return himc_error_set(error, "%s: allowed as a message to [himc~] or over OSC",
                          c->id == HIMC_COMMAND_SUBSCRIBE     ? "subscribe"
                          : c->id == HIMC_COMMAND_UNSUBSCRIBE ? "unsubscribe"
                                                              : "listen");
}

static performance_action *const actions[HIMC_COMMANDS] = {
    [HIMC_COMMAND_STROKE] = do_stroke,     [HIMC_COMMAND_HIT] = do_hit,
    [HIMC_COMMAND_TEMPO] = do_tempo,       [HIMC_COMMAND_CLEAR] = do_clear,
    [HIMC_COMMAND_GRIP] = do_grip,         [HIMC_COMMAND_LOOP] = do_loop,
    [HIMC_COMMAND_RECORD] = do_record,     [HIMC_COMMAND_UNITS] = do_units,
    [HIMC_COMMAND_PLAY] = do_play,         [HIMC_COMMAND_STOP] = do_stop,
    [HIMC_COMMAND_SEEK] = do_seek,         [HIMC_COMMAND_SCORE] = do_score,
    [HIMC_COMMAND_TAKE] = do_take,         [HIMC_COMMAND_TARGET] = do_target,
    [HIMC_COMMAND_MODE] = do_mode,         [HIMC_COMMAND_SOLVER] = do_solver,
    [HIMC_COMMAND_DAMPING] = do_damping,   [HIMC_COMMAND_POSTURE] = do_posture,
    [HIMC_COMMAND_BEND] = do_bend,         [HIMC_COMMAND_ELBOW] = do_elbow,
    [HIMC_COMMAND_WEIGHTS] = do_weights,   [HIMC_COMMAND_LAW] = do_law,
    [HIMC_COMMAND_GAIN] = do_gain,         [HIMC_COMMAND_LIMITS] = do_limits,
    [HIMC_COMMAND_STRENGTH] = do_strength, [HIMC_COMMAND_RATE] = do_rate,
    [HIMC_COMMAND_COUPLING] = do_coupling, [HIMC_COMMAND_PLAYER] = do_player,
    [HIMC_COMMAND_PUSH] = do_push,         [HIMC_COMMAND_INFO] = do_info,
    [HIMC_COMMAND_RESET] = do_reset,       [HIMC_COMMAND_MAKE_DRUM] = do_drum,
    [HIMC_COMMAND_SUBSCRIBE] = do_network, [HIMC_COMMAND_UNSUBSCRIBE] = do_network,
    [HIMC_COMMAND_LISTEN] = do_network,
};

// commands that act at their sample; others, which may allocate, read files or be refused for what
// the parser does not know, act at once
static bool waits(himc_command_id id)
{
    return id == HIMC_COMMAND_HIT || id == HIMC_COMMAND_TARGET || id == HIMC_COMMAND_TEMPO ||
           id == HIMC_COMMAND_PLAY || id == HIMC_COMMAND_STOP || id == HIMC_COMMAND_SEEK ||
           id == HIMC_COMMAND_MODE || id == HIMC_COMMAND_LAW || id == HIMC_COMMAND_SOLVER ||
           id == HIMC_COMMAND_DAMPING || id == HIMC_COMMAND_ELBOW || id == HIMC_COMMAND_WEIGHTS ||
           id == HIMC_COMMAND_COUPLING || id == HIMC_COMMAND_PUSH || id == HIMC_COMMAND_POSTURE ||
           id == HIMC_COMMAND_BEND;
}

// drums that a waiting command will want are made now, not in the audio callback
static bool prepare(himc_performance *p, const himc_command *command, himc_error *error)
{
    int index;
    if (command->id == HIMC_COMMAND_HIT)
        return himc_performance_ensure_drum(p, command->stroke.drum, &index, error);
    return command->id != HIMC_COMMAND_PLAY || himc_performance_ensure_drum(p, "", &index, error);
}

bool himc_performance_command(himc_performance *p, const himc_command *command, int delay,
                              himc_error *error)
{
    performance_action *act = actions[command->id];
    if (!act)
        return himc_error_set(error, "a drum's command, not the performer's");
    if (delay <= 0 || !waits(command->id))
        return act(p, command, error);
    if (delay > LONGEST_DELAY)
        return himc_error_set(error, "delay: %d samples, allowed 0 .. %d", delay, LONGEST_DELAY);
    if (!himc_queue_has_room(&p->queue))
        return himc_queue_drop(&p->queue, error);
    if (!prepare(p, command, error))
        return false;
    himc_queue_add(&p->queue, command, p->clock.played + delay);
    return true;
}

static bool run_waiting(himc_performance *p, const himc_command *command, himc_error *error)
{
    return actions[command->id](p, command, error);
}

void himc_performance_run_due_commands(himc_performance *p)
{
    himc_queue_run(&p->queue, p->clock.made, run_waiting, p, &p->events);
}
