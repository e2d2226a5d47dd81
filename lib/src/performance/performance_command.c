/// performance_command.c: the performer's commands, one function for each row of command_rows.h
/// that is for the performer.
///
/// They act between physics steps. A command of kind AT_SAMPLE with a delay waits in a short queue
/// until the step at its sample; the others may allocate or read files, and act at once. A command
/// that cannot be carried out changes nothing and gives the reason in one line.
#include "performance/performance_state.h"

#include <stdio.h>
#include <string.h>

#define LONGEST_DELAY 8192       // samples
#define LONGEST_RECORDING 1200.0 // (s)

// the action of each row for the performer is himc_performance_do_ and its word
#define ACTION_DRUM(ID, word, when)
#define ACTION_PERFORMER(ID, word, when) performance_action himc_performance_do_##word;
#define HIMC_COMMAND_ROW(ID, word, receiver, when, marks, atoms, does) \
    ACTION_##receiver(ID, word, when)
#include "himc/command_rows.h"

bool himc_performance_do_mode(himc_performance *p, const himc_command *c, himc_error *error)
{
    himc_pipeline mode = (himc_pipeline)c->choice[0];
    (void)error;
    // leaving `ik` the body takes up where the picture was
    if (p->controller.mode == HIMC_PIPELINE_IK && mode != HIMC_PIPELINE_IK)
        himc_character_place(p->character, &p->state);
    p->controller.mode = mode;
    p->replan = p->replan || p->has_regression;
    return true;
}

bool himc_performance_do_solver(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    p->controller.solver = (himc_solver)c->choice[0];
    return true;
}

bool himc_performance_do_damping(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    p->controller.damping = c->atom[0].number;
    return true;
}

bool himc_performance_do_posture(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    p->controller.null_space_off = c->atom[0].number == 0;
    return true;
}

bool himc_performance_do_bend(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    p->unbent = c->atom[0].number == 0;
    p->replan = true;
    return true;
}

bool himc_performance_do_elbow(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    p->controller.elbow = c->atom[0].number != 0;
    return true;
}

bool himc_performance_do_weights(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        p->controller.weight[k] = c->atom[k].number;
    return true;
}

bool himc_performance_do_law(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    p->controller.law = (himc_law)c->choice[0];
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

bool himc_performance_do_gain(himc_performance *p, const himc_command *c, himc_error *error)
{
    enum { RESET, FREQUENCY };
    if (c->form == RESET)
        return reset_gains(p);
    if (c->form == FREQUENCY)
        return scale_frequencies(p, c->atom[1].number);
    int joint;
    if (!himc_performance_find_joint(c, "gain", &joint, error))
        return false;
    himc_controller_set_gain(&p->controller, joint, c->atom[1].number, c->atom[2].number);
    return true;
}

bool himc_performance_do_rate(himc_performance *p, const himc_command *c, himc_error *error)
{
    enum { PHYSICS, TASK };
    double hz = c->atom[1].number;
    if (c->form == PHYSICS) {
        p->config.physics_rate = hz;
    } else {
        if (p->recording)
            return himc_error_set(error, "rate task: %g: not while recording %s", hz,
                                  himc_recording_path(p->recording));
        p->config.task_rate = hz;
    }
    himc_performance_reset_clock(p);
    return true;
}

bool himc_performance_do_coupling(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    p->one_way = c->choice[0] == HIMC_COUPLING_ONE_WAY;
    return true;
}

bool himc_performance_do_grip(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)error;
    p->grip = (himc_grip)c->choice[0];
    himc_planner_set_grip(p->planner, p->grip);
    return true;
}

bool himc_performance_do_player(himc_performance *p, const himc_command *c, himc_error *error)
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

bool himc_performance_do_record(himc_performance *p, const himc_command *c, himc_error *error)
{
    enum { STOP };
    const char *path = c->atom[0].symbol;
    bool stop = c->form == STOP;
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

bool himc_performance_do_reset(himc_performance *p, const himc_command *c, himc_error *error)
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

// carried out by the program around the library, with himc_performance_describe
static bool leave_to_host(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)p, (void)c, (void)error;
    return true;
}

static bool refuse_network(himc_performance *p, const himc_command *c, himc_error *error)
{
    (void)p;
    return himc_error_set(error, "%s: allowed as a message to [himc~] or over OSC",
                          himc_command_table((int)c->id)->name);
}

static performance_action *const actions[HIMC_COMMANDS] = {
#define ACTION_NOW(word) himc_performance_do_##word
#define ACTION_AT_SAMPLE(word) himc_performance_do_##word
#define ACTION_HOST(word) leave_to_host
#define ACTION_NETWORK(word) refuse_network
#undef ACTION_PERFORMER
#define ACTION_PERFORMER(ID, word, when) [HIMC_COMMAND_##ID] = ACTION_##when(word),
#define HIMC_COMMAND_ROW(ID, word, receiver, when, marks, atoms, does) \
    ACTION_##receiver(ID, word, when)
#include "himc/command_rows.h"
};

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
    if (delay <= 0 || himc_command_table((int)command->id)->when != HIMC_WHEN_AT_SAMPLE)
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
