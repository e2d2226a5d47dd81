/// performance.c: the sample clock and the physics step: algorithm 2 of the 2012 paper, with a
/// drum in it.
///
/// Step k of the physics covers the samples from floor(k fs / F_S) to floor((k + 1) fs / F_S)
/// counted from where the rates were last set: 4 or 5 samples of 48 kHz at 10 kHz, 24 in every 5
/// steps. A task tick comes every F_S / F_T steps. A step is simulated when its first sample is
/// asked for, and its forces wait here; so what is played does not depend on how many samples are
/// asked for at a time.
#include "performance/performance_state.h"
#include "performance/research.h"

#include "base/head_frame.h"

#include <stdlib.h>
#include <string.h>

#define TORN 0.01        // a joint further apart holds nothing (m)
#define REST_HEIGHT 0.12 // of resting tips above the sticks' level, until there is a drum (m)
#define FORESIGHT 1.2    // a stroke further ahead does not turn the trunk yet (s)

himc_performance_config himc_performance_default(void)
{
    return (himc_performance_config){.sample_rate = 48000, .physics_rate = 10000, .task_rate = 250};
}

void himc_performance_reset_clock(himc_performance *p)
{
    p->physics_rate = fmin(p->config.physics_rate, p->config.sample_rate);
    p->step_origin = p->made;
    p->step = 0;
    p->replan = true;
}

static uint64_t step_begin(const himc_performance *p, uint64_t step)
{
    return p->step_origin + (uint64_t)floor((double)step * p->config.sample_rate / p->physics_rate);
}

// steps between task ticks, at least one
static uint64_t steps_per_task(const himc_performance *p)
{
    double ratio = round(p->physics_rate / p->config.task_rate);
    return ratio < 1 ? 1 : (uint64_t)ratio;
}

himc_target himc_performance_planned(const himc_performance *p, himc_hand hand, double t)
{
    if (himc_performance_tracks(p, hand))
        return himc_track_target(p->track, hand, t - p->track_start);
    return himc_planner_target(p->planner, hand, t);
}

// where a hand strikes next, or where it is
static himc_vec3 attention(const himc_performance *p, himc_hand hand, double t)
{
    planned_stroke next = himc_performance_plan(p, hand, t);
    if (!next.any || next.time > t + FORESIGHT)
        return himc_performance_planned(p, hand, t).x;
    return himc_head_frame_to_world(himc_drum_head_frame(p->drum[next.drum].drum), next.x, next.y);
}

// trunk and grip as they are at a time not before the course was set
static himc_trunk_posture bearing_at(const himc_performance *p, double t)
{
    return himc_trunk_posture_approach(&p->course.from, &p->course.goal,
                                       fmin(fmax(t - p->course.time, 0), 0.02));
}

// sets the course of trunk and grip anew, from how they are at `t` to how the next strokes want
// them
static void set_course(himc_performance *p, double t)
{
    himc_vec3 place[HIMC_HANDS];
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        place[hand] = attention(p, (himc_hand)hand, t);
    p->course.from = bearing_at(p, t);
    p->course.goal = himc_posture_trunk(place, p->grip);
    if (p->track && p->captured_rest_known[HIMC_TRUNK - 1]) {
        p->course.goal.value[HIMC_TRUNK_POSTURE_TURN] =
            p->trunk_posture.value[HIMC_TRUNK_POSTURE_TURN];
        p->course.goal.value[HIMC_TRUNK_POSTURE_LEAN] =
            p->trunk_posture.value[HIMC_TRUNK_POSTURE_LEAN];
    }
    p->course.time = t;
}

static void fill_tick(himc_performance *p, himc_setpoint *tick, double t)
{
    p->posture.trunk_posture = bearing_at(p, t);
    tick->time = t;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        tick->tip[hand] = himc_performance_planned(p, (himc_hand)hand, t);
    himc_performance_posture(p, t, tick->tip, &tick->posture);
    himc_performance_follow_posture_regression(p, tick);
    himc_performance_ease(p, tick);
}

// Read task: the targets at the next tick, and at this one if the plan has changed since it was
// read
static void read_task(himc_performance *p, double t)
{
    uint64_t period = steps_per_task(p), next = (p->step / period + 1) * period;
    himc_planner_advance(p->planner, t);
    set_course(p, t);
    if (p->replan)
        fill_tick(p, &p->from, t);
    else
        p->from = p->to;
    fill_tick(p, &p->to, (double)step_begin(p, next) / p->config.sample_rate);
    p->replan = false;
}

// the body wherever it can be put at once: at rest, or back from a state that was not finite
static void place_body(himc_performance *p)
{
    himc_pose pose;
    memcpy(pose.joint, p->from.posture.joint, sizeof pose.joint);
    himc_pose_to_state(&p->skeleton, &pose, p->from.posture.rate, &p->state);
    himc_character_place(p->character, &p->state);
}

// the body as it weighs, not as it is believed to
static himc_skeleton make_plant(const himc_performance *p, const himc_skeleton *skeleton)
{
    himc_skeleton plant = *skeleton;
    for (int i = 0; i < HIMC_SEGMENTS; i++) {
        plant.segment[i].mass *= p->weight[i];
        plant.segment[i].inertia = himc_vec3_scale(plant.segment[i].inertia, p->weight[i]);
    }
    return plant;
}

void himc_performance_fresh_controller(const himc_performance *p, himc_controller *controller)
{
    himc_planner_config resting = himc_planner_default();
    himc_posture posture = p->posture;
    himc_body_state state;
    himc_pose pose;
    himc_posture_init(&posture, &p->skeleton, resting.rest[HIMC_RIGHT].z - REST_HEIGHT);
    posture.rest = p->posture.rest;
    himc_posture_at(&posture, resting.rest, &pose);
    himc_pose_to_state(&p->skeleton, &pose, NULL, &state);
    himc_controller_init(controller, &p->skeleton, &state);
}

bool himc_performance_build_body(himc_performance *p, himc_error *error)
{
    himc_skeleton skeleton;
    if (!himc_skeleton_init(&skeleton, &p->body, error))
        return false;
    himc_skeleton plant = make_plant(p, &skeleton);
    himc_character *character = himc_character_new(&plant, error);
    if (!character)
        return false;
    himc_character_free(p->character);
    p->character = character;
    p->skeleton = skeleton;
    p->plant = plant;
    p->regression_since =
        p->has_regression ? step_time(p) : -INFINITY; // the body begins in the posture
    himc_performance_forget_ease(p);                  // likewise
    himc_posture_init(&p->posture, &skeleton, p->posture.level);
    for (int j = HIMC_TRUNK; j < HIMC_JOINTS; j++)
        if (p->captured_rest_known[j])
            p->posture.rest.joint[j] = p->captured_rest_pose.joint[j];
    if (p->course.time == 0)
        p->course.from = p->course.goal = p->posture.trunk_posture;
    fill_tick(p, &p->from, step_time(p));
    memcpy(p->reference.tip, p->from.tip, sizeof p->from.tip);
    p->reference.posture = p->from.posture;
    place_body(p);
    himc_controller *c = &p->controller, old = *c;
    himc_performance_fresh_controller(p, c);
    c->mode = old.mode;
    c->law = old.law;
    c->solver = old.solver;
    if (old.bandwidth > 0) {
        c->damping = old.damping;
        c->bandwidth = old.bandwidth;
        c->elbow = old.elbow;
        c->null_space_off = old.null_space_off;
        memcpy(c->weight, old.weight, sizeof c->weight);
    }
    for (int j = 0; j < HIMC_JOINTS; j++)
        if (old.gain_set[j]) {
            c->gain[j] = old.gain[j];
            c->gain_set[j] = true;
        }
    himc_performance_keep_strength(p, &old);
    himc_performance_renew_limits(p);
    p->replan = true;
    return true;
}

bool himc_performance_set_weights(himc_performance *p, const double *factor, himc_error *error)
{
    for (int i = 0; factor && i < HIMC_SEGMENTS; i++)
        if (!himc_check_range("weight", factor[i], 0.2, 5, "", error))
            return himc_error_prefix(error, "%s", himc_segment_name(i));
    for (int i = 0; i < HIMC_SEGMENTS; i++)
        p->weight[i] = factor ? factor[i] : 1;
    return himc_performance_build_body(p, error);
}

void himc_performance_notice_drums(himc_performance *p)
{
    for (int i = 0; i < p->drums; i++) {
        unsigned revision = himc_drum_revision(p->drum[i].drum);
        if (revision == p->drum[i].revision)
            continue;
        const himc_head_frame *place = himc_drum_head_frame(p->drum[i].drum);
        p->drum[i].revision = revision;
        himc_planner_set_drum(p->planner, i, place);
        if (i == 0)
            p->posture.level = place->center.z + p->skeleton.mallet_radius;
        himc_performance_renew_limits(p);
        p->replan = true;
    }
}

// a state that the physics cannot go on from is replaced by the one the targets have, and counted
static void recover(himc_performance *p)
{
    if (p->recoveries++ == 0)
        himc_performance_note(p, "the body flew apart at a physics rate of %g Hz and was put back",
                              p->physics_rate);
    place_body(p);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        p->touch[hand] = (touch){.answered = p->touch[hand].answered};
}

// the engine keeps joints together to a micrometre; where it could not, numbers are still finite
// but there is no body any more
static bool torn_apart(const himc_performance *p)
{
    for (int i = 1; i < HIMC_SEGMENTS; i++) {
        const himc_segment *segment = &p->skeleton.segment[i];
        himc_vec3 r = himc_mat3_apply(&p->state.rotation[segment->parent], segment->origin);
        himc_vec3 gap =
            himc_vec3_sub(himc_vec3_add(p->state.origin[segment->parent], r), p->state.origin[i]);
        if (!(himc_vec3_dot(gap, gap) < TORN * TORN))
            return true;
    }
    return false;
}

// Inverse kinematics, inverse dynamics, forward dynamics; the contact is solved inside the same
// step
static void step_dynamics(himc_performance *p, int n, double h, bool tick)
{
    himc_vec3 tip_force[HIMC_HANDS];
    himc_character_observe(p->character, &p->state);
    if (tick && torn_apart(p))
        recover(p);
    himc_performance_after_contact(p, step_time(p));
    p->controller.step = h;
    himc_controller_torques(&p->controller, &p->skeleton, &p->state, &p->reference, p->torque);
    himc_performance_contact(p, n, tip_force);
    himc_performance_measure_step(p);
    himc_performance_push_body(p, step_time(p));
    if (!himc_character_step(p->character, p->torque, tip_force, h))
        recover(p);
}

// the body shown as inverse kinematics has it; only the sticks' ends meet the head
static void step_kinematics(himc_performance *p, int n, double h)
{
    himc_pose pose;
    himc_vec3 unused[HIMC_HANDS];
    himc_vec3 rate[HIMC_JOINTS];
    p->controller.step = h;
    himc_controller_kinematic_step(&p->controller, &p->skeleton, &p->reference, &p->state, &pose,
                                   rate);
    himc_performance_clamp_kinematic_pose(p, &pose, rate);
    himc_pose_to_state(&p->skeleton, &pose, rate, &p->state);
    if (!himc_body_state_finite(&p->state))
        recover(p);
    himc_performance_after_contact(p, step_time(p));
    himc_performance_contact(p, n, unused);
    himc_performance_measure_step(p);
}

static void performance_step(himc_performance *p)
{
    himc_performance_run_due_commands(p);
    himc_performance_notice_drums(p);
    int n = (int)(step_begin(p, p->step + 1) - p->made);
    double t = step_time(p);
    bool tick = p->step % steps_per_task(p) == 0;
    if (tick || p->replan)
        read_task(p, t);
    himc_setpoint_interpolate(&p->from, &p->to, t, &p->reference);
    himc_performance_release(p, t);
    if (p->controller.mode == HIMC_PIPELINE_IK)
        step_kinematics(p, n, n / p->config.sample_rate);
    else
        step_dynamics(p, n, n / p->config.sample_rate, tick);
    if (tick)
        himc_performance_motion_row(p, t);
    himc_performance_watch(p, t);
    p->force_count = n;
    p->made += (uint64_t)n;
    p->step++;
}

void himc_performance_process(himc_performance *p, int n, double *const force[HIMC_HANDS])
{
    for (int done = 0; done < n;) {
        if (p->sample == p->made)
            performance_step(p);
        int ready = (int)(p->made - p->sample), count = ready < n - done ? ready : n - done;
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            if (force && force[hand])
                memcpy(force[hand] + done, p->force[hand] + p->force_count - ready,
                       (size_t)count * sizeof(double));
        p->sample += (uint64_t)count;
        done += count;
    }
}

uint64_t himc_performance_time(const himc_performance *p)
{
    return p->sample - p->aligned;
}

void himc_performance_realign(himc_performance *p)
{
    p->aligned = p->sample;
    for (int i = 0; i < p->drums; i++)
        himc_drum_realign(p->drum[i].drum, (int)(p->made - p->sample));
}

bool himc_performance_set_rate(himc_performance *p, double sample_rate, himc_error *error)
{
    if (!himc_check_range("sample rate", sample_rate, 8000, 192000, "Hz", error))
        return false;
    if (sample_rate == p->config.sample_rate)
        return true;
    // the time that has passed stays the same in seconds
    double t = step_time(p);
    for (int i = 0; i < p->drums; i++)
        if (!himc_drum_set_rate(p->drum[i].drum, sample_rate, error))
            return false;
    uint64_t ahead = p->made - p->sample, behind = p->sample - p->aligned;
    p->config.sample_rate = sample_rate;
    p->made = (uint64_t)ceil(t * sample_rate);
    p->sample = p->made > ahead ? p->made - ahead : 0;
    p->aligned = p->sample > behind ? p->sample - behind : 0;
    himc_performance_reset_clock(p);
    return true;
}

// how far a place is from where that tip can be
static double beyond_reach(const void *performance, himc_hand hand, himc_vec3 place)
{
    const himc_performance *p = performance;
    return himc_vec3_length(himc_vec3_sub(place, himc_posture_reachable(&p->posture, hand, place)));
}

static bool config_valid(const himc_performance_config *c, himc_error *error)
{
    return himc_check_range("sample rate", c->sample_rate, 8000, 192000, "Hz", error) &&
           himc_check_range("physics rate", c->physics_rate, HIMC_PHYSICS_RATE_MIN,
                            HIMC_PHYSICS_RATE_MAX, "Hz", error) &&
           himc_check_range("task rate", c->task_rate, HIMC_TASK_RATE_MIN, HIMC_TASK_RATE_MAX, "Hz",
                            error);
}

himc_performance *himc_performance_new(const himc_performance_config *config, himc_error *error)
{
    if (!config_valid(config, error))
        return NULL;
    himc_performance *p = calloc(1, sizeof *p);
    if (!p) {
        himc_error_set(error, "performance: out of memory");
        return NULL;
    }
    p->config = *config;
    p->body = himc_skeleton_default();
    for (int i = 0; i < HIMC_SEGMENTS; i++)
        p->weight[i] = 1;
    p->controller.law = HIMC_LAW_COMPUTED_TORQUE;
    p->take_options = himc_take_default();
    p->track_start = p->end = INFINITY;
    p->last_beat = -1;
    himc_planner_config planning = himc_planner_default();
    planning.mallet_radius = p->body.mallet_radius;
    planning.beyond = beyond_reach;
    planning.body = p;
    p->planner = himc_planner_new(&planning, error);
    p->posture.level = planning.rest[HIMC_RIGHT].z - REST_HEIGHT;
    himc_performance_forget_touch(p);
    himc_performance_reset_clock(p);
    if (!p->planner || !himc_performance_build_body(p, error)) {
        himc_performance_free(p);
        return NULL;
    }
    return p;
}

void himc_performance_free(himc_performance *p)
{
    if (!p)
        return;
    while (p->drums > 0)
        himc_drum_release(p->drum[--p->drums].drum);
    if (p->recording)
        himc_recording_write(p->recording, NULL);
    himc_recording_free(p->recording);
    himc_character_free(p->character);
    himc_planner_free(p->planner);
    himc_track_free(p->track);
    free(p);
}
