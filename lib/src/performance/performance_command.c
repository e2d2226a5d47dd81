/// performance_command.c: what each command of the vocabulary does to a performance.
///
/// One table, one small function a command. They act between physics steps: one that comes with a
/// delay waits in a short queue until the step at its sample. A command that cannot be carried
/// out changes nothing and says why in one line.
#include "performance/performance_state.h"

#include <stdio.h>
#include <string.h>

#define LONGEST_DELAY 8192       // samples
#define LONGEST_RECORDING 1200.0 // (s)

// which of the words, which the parser has checked
int himc_performance_word(const char *word, const char *const *words, int count)
{
    for (int i = 0; i < count; i++)
        if (strcmp(word, words[i]) == 0)
            return i;
    return 0;
}

static bool do_mode(himc_performance *p, const himc_command *c, himc_error *error)
{
    static const char *const words[] = {"himc", "id", "ik"};
    himc_pipeline mode = (himc_pipeline)himc_performance_word(c->atom[0].symbol, words, 3);
    (void)error;
    // leaving `ik` the body takes up where the picture was
    if (p->controller.mode == HIMC_PIPELINE_IK && mode != HIMC_PIPELINE_IK)
        himc_character_place(p->character, &p->state);
    p->controller.mode = mode;
    p->replan = p->replan || p->has_regression;
    return true;
}

static bool do_solver(himc_performance *p, const himc_command *c, himc_error *error)
{
    static const char *const words[HIMC_SOLVERS] = {"dls", "pinv", "transpose", "nakamura", "sdls"};
    (void)error;
    p->controller.solver =
        (himc_solver)himc_performance_word(c->atom[0].symbol, words, HIMC_SOLVERS);
    return true;
}

static bool do_damping(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    p->controller.damping = c->atom[0].number;
    return true;
}

static bool do_posture(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    p->controller.null_space_off = c->atom[0].number == 0;
    return true;
}

static bool do_bend(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    p->unbent = c->atom[0].number == 0;
    p->replan = true;
    return true;
}

static bool do_elbow(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    p->controller.elbow = c->atom[0].number != 0;
    return true;
}

static bool do_weights(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        p->controller.weight[k] = c->atom[k].number;
    return true;
}

static bool do_law(himc_performance *p, const himc_command *c, himc_error *error)
{
    static const char *const words[] = {"printed", "feedforward", "computed-torque"};
    (void)error;
    p->controller.law = (himc_law)himc_performance_word(c->atom[0].symbol, words, 3);
    return true;
}

static bool reset_gains(himc_performance *p)
{
    himc_controller fresh;
    himc_performance_fresh_controller(p, &fresh);
    memcpy(p->controller.inertia, fresh.inertia, sizeof fresh.inertia);
    memcpy(p->controller.gain, fresh.gain, sizeof fresh.gain);
    memcpy(p->controller.gain_set, fresh.gain_set, sizeof fresh.gain_set);
    return true;
}

// k_s goes with the square of the natural frequency, k_d with the frequency itself
static bool scale_frequencies(himc_performance *p, double factor)
{
    reset_gains(p);
    for (int j = 0; j < HIMC_JOINTS; j++) {
        himc_gain *gain = &p->controller.gain[j];
        gain->stiffness = himc_vec3_scale(gain->stiffness, factor * factor);
        gain->damping = himc_vec3_scale(gain->damping, factor);
        p->controller.gain_set[j] = true;
    }
    return true;
}

static bool do_gain(himc_performance *p, const himc_command *c, himc_error *error)
{
    if (c->count == 1)
        return reset_gains(p);
    if (c->count == 2)
        return scale_frequencies(p, c->atom[1].number);
    int joint;
    if (!himc_performance_find_joint(c, "gain", &joint, error))
        return false;
    himc_controller_set_gain(&p->controller, joint, c->atom[1].number, c->atom[2].number);
    return true;
}

static bool do_rate(himc_performance *p, const himc_command *c, himc_error *error)
{
    bool physics = strcmp(c->atom[0].symbol, "physics") == 0;
    double hz = c->atom[1].number;
    if (physics) {
        if (!himc_check_range("rate physics", hz, 500, 48000, "Hz", error))
            return false;
        p->config.physics_rate = hz;
    } else {
        if (!himc_check_range("rate task", hz, 50, 2000, "Hz", error))
            return false;
        if (p->recording)
            return himc_error_set(error, "rate task: %g: not while recording %s", hz,
                                  himc_recording_path(p->recording));
        p->config.task_rate = hz;
    }
    himc_performance_reset_clock(p);
    return true;
}

static bool do_coupling(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    p->one_way = strcmp(c->atom[0].symbol, "one-way") == 0;
    return true;
}

static bool do_grip(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    p->grip = strcmp(c->atom[0].symbol, "french") == 0 ? HIMC_GRIP_FRENCH : HIMC_GRIP_GERMAN;
    himc_planner_set_grip(p->planner, p->grip);
    return true;
}

static bool do_player(himc_performance *p, const himc_command *c, himc_error *error)
{
    himc_skeleton_config old = p->body;
    p->body.height = c->atom[0].number;
    p->body.mass = c->atom[1].number;
    p->body.seat = p->body.shoulders = 0; // whatever a take has measured
    memset(p->body.length, 0, sizeof p->body.length);
    if (himc_performance_build_body(p, error))
        return true;
    p->body = old;
    return false;
}

// writes what has been recorded; a recording that cannot be written is lost, and that is said
static bool finish_recording(himc_performance *p, himc_error *error)
{
    bool written = himc_recording_write(p->recording, error);
    if (written)
        himc_performance_note(p, "recorded %.2f s in %s",
                              himc_recording_frames(p->recording) / p->config.task_rate,
                              himc_recording_path(p->recording));
    himc_recording_free(p->recording);
    p->recording = NULL;
    return written || himc_error_prefix(error, "record");
}

static bool do_record(himc_performance *p, const himc_command *c, himc_error *error)
{
    const char *path = c->atom[0].symbol;
    bool stop = strcmp(path, "stop") == 0;
    if (stop && !p->recording)
        return himc_error_set(error, "record: stop: nothing is being recorded, allowed FILE");
    if (stop)
        return finish_recording(p, error);
    if (p->recording)
        return himc_error_set(error, "record: %s: already recording %s, allowed stop", path,
                              himc_recording_path(p->recording));
    p->recording =
        himc_recording_new(path, &p->skeleton, p->config.task_rate, LONGEST_RECORDING, error);
    p->recording_full = false;
    return p->recording || himc_error_prefix(error, "record");
}

static bool do_reset(himc_performance *p, const himc_command *c, himc_error *error)
{
    himc_skeleton_config old = p->body;
    (void)c;
    if (p->recording && !finish_recording(p, error))
        return false;
    p->body = himc_skeleton_default();
    p->controller = (himc_controller){.law = HIMC_LAW_COMPUTED_TORQUE}; // not the gains set since
    p->limits.kind = HIMC_LIMITS_OFF;
    p->human = p->has_regression = false;
    p->saturation = (himc_saturation_counts){.steps = 0};
    p->grip = HIMC_GRIP_GERMAN;
    p->course.time = 0; // trunk and grip as in the beginning
    memset(p->captured_rest_known, 0, sizeof p->captured_rest_known);
    for (int i = 0; i < HIMC_SEGMENTS; i++)
        p->weight[i] = 1;
    himc_performance_drop_track(p);
    if (!himc_performance_build_body(p, error)) {
        p->body = old;
        return false;
    }
    himc_planner_stop(p->planner, step_time(p));
    himc_planner_clear(p->planner);
    himc_planner_set_tempi(p->planner, &(himc_tempo_change){0, HIMC_TEMPO}, 1, NULL);
    himc_planner_loop(p->planner, step_time(p), false);
    himc_planner_set_grip(p->planner, p->grip);
    himc_planner_clear_units(p->planner);
    p->controller.mode = HIMC_PIPELINE_HIMC;
    p->controller.law = HIMC_LAW_COMPUTED_TORQUE;
    p->controller.solver = HIMC_SOLVER_DLS;
    p->config.physics_rate = himc_performance_default().physics_rate;
    p->config.task_rate = himc_performance_default().task_rate;
    p->one_way = p->playing = p->unbent = false;
    memset(p->push, 0, sizeof p->push);
    memset(p->beyond, 0, sizeof p->beyond);
    p->waiting_count = 0;
    p->commands_dropped = 0;
    p->square_sum = p->height_sum = p->peak_force = 0;
    p->square_count = p->height_count = p->recoveries = 0;
    p->strokes = p->played = p->hits = 0;
    p->hit_latency = p->longest_latency = 0;
    himc_performance_reset_clock(p);
    return true;
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
    [HIMC_COMMAND_STROKE] = himc_performance_do_stroke,
    [HIMC_COMMAND_HIT] = himc_performance_do_hit,
    [HIMC_COMMAND_TEMPO] = himc_performance_do_tempo,
    [HIMC_COMMAND_CLEAR] = himc_performance_do_clear,
    [HIMC_COMMAND_GRIP] = do_grip,
    [HIMC_COMMAND_LOOP] = himc_performance_do_loop,
    [HIMC_COMMAND_RECORD] = do_record,
    [HIMC_COMMAND_UNITS] = himc_performance_do_units,
    [HIMC_COMMAND_PLAY] = himc_performance_do_play,
    [HIMC_COMMAND_STOP] = himc_performance_do_stop,
    [HIMC_COMMAND_SEEK] = himc_performance_do_seek,
    [HIMC_COMMAND_SCORE] = himc_performance_do_score,
    [HIMC_COMMAND_TAKE] = himc_performance_do_take,
    [HIMC_COMMAND_TARGET] = himc_performance_do_target,
    [HIMC_COMMAND_MODE] = do_mode,
    [HIMC_COMMAND_SOLVER] = do_solver,
    [HIMC_COMMAND_DAMPING] = do_damping,
    [HIMC_COMMAND_POSTURE] = do_posture,
    [HIMC_COMMAND_BEND] = do_bend,
    [HIMC_COMMAND_ELBOW] = do_elbow,
    [HIMC_COMMAND_WEIGHTS] = do_weights,
    [HIMC_COMMAND_LAW] = do_law,
    [HIMC_COMMAND_GAIN] = do_gain,
    [HIMC_COMMAND_LIMITS] = himc_performance_do_limits,
    [HIMC_COMMAND_STRENGTH] = himc_performance_do_strength,
    [HIMC_COMMAND_RATE] = do_rate,
    [HIMC_COMMAND_COUPLING] = do_coupling,
    [HIMC_COMMAND_PLAYER] = do_player,
    [HIMC_COMMAND_PUSH] = himc_performance_do_push,
    [HIMC_COMMAND_INFO] = do_info,
    [HIMC_COMMAND_RESET] = do_reset,
    [HIMC_COMMAND_MAKE_DRUM] = himc_performance_do_drum,
    [HIMC_COMMAND_SUBSCRIBE] = do_network,
    [HIMC_COMMAND_UNSUBSCRIBE] = do_network,
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
    if (p->waiting_count == WAITING_COMMANDS) // one line for a storm: the rest is counted
        return p->commands_dropped++ > 0 ||
               himc_error_set(error, "more than %d commands at once: this one is dropped",
                              WAITING_COMMANDS);
    if (!prepare(p, command, error))
        return false;
    waiting_command *w = &p->waiting[p->waiting_count++];
    w->due = p->sample + (uint64_t)delay;
    himc_command_copy(&w->command, command);
    return true;
}

void himc_performance_run_due_commands(himc_performance *p)
{
    int kept = 0;
    for (int i = 0; i < p->waiting_count; i++) {
        himc_error error;
        if (p->waiting[i].due > p->made) {
            if (kept != i) {
                p->waiting[kept].due = p->waiting[i].due;
                himc_command_copy(&p->waiting[kept].command, &p->waiting[i].command);
            }
            kept++;
        } else if (!actions[p->waiting[i].command.id](p, &p->waiting[i].command, &error)) {
            himc_performance_note(p, "%s", error.text);
        }
    }
    p->waiting_count = kept;
    if (p->commands_dropped > 0 && kept < WAITING_COMMANDS / 2) {
        himc_performance_note(p, "%ld commands dropped: more than %d waited", p->commands_dropped,
                              WAITING_COMMANDS);
        p->commands_dropped = 0;
    }
}

void himc_performance_make_drums(himc_performance *p, bool make_drums)
{
    p->make_drums = make_drums;
}

void himc_performance_take_options(himc_performance *p, const himc_take_options *options)
{
    p->take_options = *options;
}
