/// performance_report.c: the reports of a performance: figures, rows of motion, `info`; and the
/// recording of its motion.
#include "performance/performance_state.h"

#include "base/format.h"
#include "body/dynamics.h"
#include "capture/take.h"
#include "control/tracking_error.h"

#include <stdlib.h>
#include <string.h>

#define LONGEST_RECORDING 1200.0 // chosen: 20 minutes, 0.5 GB of poses at 250 Hz (s)

bool himc_performance_event(himc_performance *p, himc_event *event)
{
    return himc_events_take(&p->events, event);
}

void himc_performance_on_motion(himc_performance *p, void (*row)(void *, const himc_motion_row *),
                                void *user)
{
    p->host.on_motion = row;
    p->host.motion_user = user;
    himc_body_account(p->body, row != NULL);
    memset(p->statistics.mallet, 0, sizeof p->statistics.mallet);
    double unused[2];
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        himc_contacts_take_row(&p->contacts, (himc_hand)hand, &unused[0], &unused[1]);
}

void himc_performance_on_tick(himc_performance *p, void (*tick)(void *, const himc_tick *),
                              void *user)
{
    p->host.on_tick = tick;
    p->host.tick_user = user;
}

himc_performance_stats himc_performance_measure(const himc_performance *p)
{
    const performance_clock *c = &p->clock;
    himc_performance_stats s = himc_statistics_told(&p->statistics);
    s.seconds = fmax((double)c->played, 0) / c->sample_rate;
    s.beat = himc_motion_score_beat(p->motion, s.seconds);
    s.bpm = himc_planner_bpm(p->motion->planner, s.seconds);
    s.limit_hits = himc_body_limit_hits(p->body);
    for (int j = 0; j < HIMC_JOINTS; j++) {
        double strength = p->settings.control.strength[j];
        double reserve = strength > 0 ? p->body->saturation.given[j] / strength : 0;
        s.reserve_joint = reserve > s.reserve ? j : s.reserve_joint;
        s.reserve = fmax(s.reserve, reserve);
    }
    s.events_lost = p->events.lost;
    s.hearings = p->drums.hearings;
    s.sample_rate = c->sample_rate;
    s.physics_rate = c->physics_rate;
    s.task_rate = c->task_rate;
    return s;
}

void himc_performance_take_energy(himc_performance *p)
{
    const performance_body *b = p->body;
    const himc_body_work *w = &b->work;
    himc_energy *e = &p->energy;
    if (!b->accounting)
        return;
    *e = (himc_energy){
        .push = w->push, .support = w->support, .placed = w->placed, .numerical = w->numerical};
    memcpy(e->joint, w->joint, sizeof e->joint);
    memcpy(e->contact, w->contact, sizeof e->contact);
    memcpy(e->mallet, p->statistics.mallet, sizeof e->mallet);
    e->kinetic = himc_character_kinetic(b->character);
    e->potential = himc_character_potential(b->character);
    himc_drums_catch_up(&p->drums);
    for (int i = 0; i < p->drums.count; i++)
        e->heads += himc_membrane_energy(himc_drum_membrane(p->drums.slot[i].drum));
    e->lost = p->statistics.given - e->heads;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        e->felt[hand] = himc_contacts_felt_energy(&p->contacts, (himc_hand)hand);
        e->lost -= e->felt[hand];
    }
}

// of the arm's squared joint rates, the share within the null space of the tip
static double null_share(const himc_body_state *state, himc_hand hand, const himc_vec3 *rate)
{
    himc_arm_jacobian jacobian;
    himc_vec3 arm[HIMC_ARM_JOINTS], within[HIMC_ARM_JOINTS] = {{0, 0, 0}};
    double all = 0, share = 0;
    himc_arm_gather(rate, hand, arm);
    himc_arm_jacobian_at(state, hand, &jacobian);
    himc_ik_add_null(&jacobian, arm, within);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        all += himc_vec3_dot(arm[k], arm[k]);
        share += himc_vec3_dot(within[k], within[k]);
    }
    return all > 0 ? share / all : 0;
}

static himc_vec3 push_point(const performance_body *b, const himc_body_state *state, int i,
                            double t)
{
    return himc_vec3_add(state->origin[i],
                         himc_mat3_apply(&state->rotation[i], himc_body_pushed(b, i, t).at));
}

// where a force and its moment about the hips press on the plane of the seat, or on the floor
static himc_vec3 pressure_center(const performance_body *b, himc_vec3 f, himc_vec3 m)
{
    himc_vec3 hips = b->state.origin[HIMC_PELVIS];
    bool stands = b->controller.balance && b->support.standing;
    double plane =
        stands ? b->support.point[HIMC_SEAT_POINTS].plane : himc_posture_stool(&b->plant);
    double down = hips.z - plane;
    if (f.z <= 0)
        return himc_vec3_make(NAN, NAN, NAN);
    return himc_vec3_make(hips.x - (m.y + down * f.x) / f.z, hips.y + (m.x - down * f.y) / f.z,
                          plane);
}

// how the world has held the pelvis since the last row, and what a stool would have to do instead
static void take_root(performance_body *b, himc_motion_row *row)
{
    himc_body_work *w = &b->work;
    double rate = w->root_seconds > 0 ? 1 / w->root_seconds : 0; // none after a step of `ik`
    himc_vec3 f = himc_vec3_scale(w->root_impulse, rate);
    himc_vec3 m = himc_vec3_scale(w->root_angular, rate);
    for (int j = 0; j < HIMC_JOINTS && b->controller.config.human_strength; j++)
        row->co_contraction[j] = b->muscles.co_contraction[j];
    row->seat_force = himc_vec3_scale(w->seat_impulse, rate);
    w->root_impulse = w->root_angular = w->seat_impulse = himc_vec3_make(0, 0, 0);
    for (int foot = 0; foot < HIMC_HANDS; foot++) {
        row->foot_force[foot] = himc_vec3_scale(w->foot_impulse[foot], rate);
        w->foot_impulse[foot] = himc_vec3_make(0, 0, 0);
    }
    w->root_seconds = 0;
    row->root_force = f;
    row->root_moment = m;
    row->root_center = pressure_center(b, f, m);
    row->root_friction = f.z > 0 ? hypot(f.x, f.y) / f.z : NAN;
}

// torques, and the accelerations that they, the tips' forces and the pushes make; a body that is
// moved by inverse kinematics has none
static void fill_dynamics(performance_body *b, bool kinematic, himc_motion_row *row)
{
    himc_energy *e = &row->energy;
    himc_articulation art;
    himc_body_state state;
    himc_vec3 load[HIMC_JOINTS];
    himc_pose pose;
    himc_balance balance = b->balance;
    himc_vec3 rate[HIMC_JOINTS], none = {NAN, NAN, NAN};
    for (int j = 0; kinematic && j < HIMC_JOINTS; j++) {
        row->acceleration[j] = row->torque[j] = none;
        row->power[j] = e->joint[j] = row->co_contraction[j] = NAN;
    }
    if (kinematic) {
        row->root_force = row->root_moment = row->root_center = row->seat_force = none;
        row->root_friction = NAN;
        e->push = e->support = e->placed = e->numerical = e->kinetic = e->potential = NAN;
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            e->contact[hand] = e->mallet[hand] = NAN, row->foot_force[hand] = none;
        return;
    }
    take_root(b, row);
    // the state of the row's pose and rates: without the joints' gaps, which are the engine's
    memcpy(pose.joint, row->rotation, sizeof pose.joint);
    for (int j = 0; j < HIMC_JOINTS; j++) {
        int parent = b->plant.segment[j + 1].parent;
        rate[j] = himc_mat3_apply_transposed(&b->state.rotation[parent], row->rate[j]);
    }
    himc_pose_to_state(&b->plant, &pose, rate, &state);
    if (b->controller.balance)
        state = b->state;
    memcpy(load, b->torque, sizeof load);
    for (int i = 0; i < HIMC_SEGMENTS; i++) {
        himc_vec3 at = push_point(b, &state, i, row->time), r = himc_vec3_sub(at, state.origin[0]);
        himc_add_force(&b->plant, &state, i, at, row->push[i], load);
        balance.carried.linear = himc_vec3_add(balance.carried.linear, row->push[i]);
        balance.carried.angular =
            himc_vec3_add(balance.carried.angular, himc_vec3_cross(r, row->push[i]));
    }
    himc_articulate(&b->plant, &state, &art);
    himc_balance_accelerate(b->controller.balance ? &balance : NULL, &b->plant, &state, &art, load,
                            row->tip_force, row->acceleration);
    for (int j = 0; j < HIMC_JOINTS; j++) {
        row->torque[j] = b->torque[j];
        row->power[j] = himc_vec3_dot(row->torque[j], row->rate[j]);
    }
}

static void fill_row(himc_performance *p, double t, himc_motion_row *row)
{
    performance_body *b = p->body;
    himc_pose pose = himc_pose_from_state(&b->skeleton, &b->state);
    *row = (himc_motion_row){.time = t, .energy = p->energy};
    for (int j = 0; j < HIMC_JOINTS; j++) {
        himc_quat target = p->motion->reference.posture.joint[j];
        row->rotation[j] = pose.joint[j];
        row->joint[j] = himc_quat_log(pose.joint[j]);
        row->joint_error[j] =
            himc_vec3_length(himc_quat_log(himc_quat_mul(himc_quat_conj(target), pose.joint[j])));
        row->limit[j] = b->controller.limits ? b->saturation.measure[j] : 0;
        row->rate[j] = himc_relative_spin(&b->skeleton, &b->state, j);
    }
    for (int i = 0; i < HIMC_HANDS; i++) {
        himc_hand hand = (himc_hand)i;
        const himc_target *target = &p->motion->reference.tip[i];
        row->target[i] = target->x;
        row->target_velocity[i] = target->v;
        row->tip[i] = b->state.tip[i];
        row->tip_velocity[i] = b->state.tip_velocity[i];
        row->tip_error[i] = himc_vec3_sub(row->tip[i], row->target[i]);
        himc_contacts_take_row(&p->contacts, hand, &row->force[i], &row->impulse[i]);
        row->elbow[i] = b->state.origin[HIMC_LEFT_FOREARM + i];
        row->tip_force[i] = b->tip_force[i];
        // the head's force on the mallet's own mass, as a share of that on the body's stick
        double share = p->contacts.hand[i].share;
        row->mallet_force[i] = himc_vec3_scale(b->tip_force[i], share > 0 ? 1 / share - 1 : 0);
        row->null_space[i] = null_share(&b->state, hand, row->rate);
    }
    for (int i = 0; i < HIMC_SEGMENTS; i++) {
        row->segment[i] = b->state.origin[i];
        row->orientation[i] = b->state.orientation[i];
        row->center[i] = himc_segment_center(&b->plant, &b->state, i);
        row->push[i] = himc_body_pushed(b, i, t).force;
        row->push_at[i] = push_point(b, &b->state, i, t);
    }
    fill_dynamics(b, p->settings.control.mode == HIMC_PIPELINE_IK, row);
}

static void note_written(himc_performance *p, const himc_recording *file)
{
    int frames = himc_recording_frames(file);
    himc_events_note(&p->events, frames ? "recorded %.2f s in %s" : "recorded %.2f s: no file %s",
                     frames / p->clock.task_rate, himc_recording_path(file));
}

void himc_performance_tell_tick(himc_performance *p, double t)
{
    himc_motion_row row;
    himc_posture_motion captured;
    himc_support_forces support = {{0, 0, 0}, {{0, 0, 0}}, {0, 0, 0}};
    performance_recording *r = &p->recording;
    const performance_body *b = p->body;
    if (p->host.on_motion)
        fill_row(p, t, &row);
    if (p->host.on_tick) {
        himc_tick tick = {.time = t, .body = &b->state, .row = p->host.on_motion ? &row : NULL};
        // of a pelvis that is free: how seat and floor hold it in the last step
        if (b->controller.balance && p->settings.control.mode != HIMC_PIPELINE_IK) {
            for (int i = 0; i < HIMC_SUPPORTS; i++) {
                const himc_support_point *s = &b->support.point[i];
                himc_vec3 *of = i < HIMC_SEAT_POINTS ? &support.seat
                                                     : &support.foot[s->segment - HIMC_LEFT_FOOT];
                *of = himc_vec3_add(*of, s->force);
            }
            support.center =
                pressure_center(b, b->balance.carried.linear, b->balance.carried.angular);
            tick.support = &support;
        }
        if (himc_motion_captured_joints(p->motion, t, &captured))
            tick.captured = captured.joint;
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            tick.target[hand] = p->motion->reference.tip[hand].x;
        p->host.on_tick(p->host.tick_user, &tick);
    }
    if (p->host.on_motion)
        p->host.on_motion(p->host.motion_user, &row);
    if (!r->file || himc_recording_add(r->file, &b->state) || r->full)
        return;
    r->full = true;
    himc_events_note(&p->events, "%s: the recording is full, recorded up to %.3f s",
                     himc_recording_path(r->file), t);
}

// one that was stopped before its first frame has no file
static bool write_frames(himc_recording *file, himc_error *error)
{
    return himc_recording_frames(file) == 0 || himc_recording_write(file, error) ||
           himc_error_prefix(error, "record");
}

bool himc_performance_end_recording(himc_performance *p, himc_error *error)
{
    if (!p->recording.file)
        return true;
    if (!write_frames(p->recording.file, error))
        return false;
    note_written(p, p->recording.file);
    himc_performance_drop_recording(p);
    return true;
}

void himc_performance_drop_recording(himc_performance *p)
{
    himc_recording_free(p->recording.file);
    p->recording.file = NULL;
}

// the command `record`: a recording is made, or taken away and written
enum { STOP }; // its forms

typedef struct record_job {
    himc_job job;
    himc_performance *performance; ///< borrowed
    himc_command command;
    himc_skeleton skeleton;
    double rate;          ///< of tasks (Hz)
    himc_recording *file; ///< owned
} record_job;

static bool prepare_recording(himc_job *job, himc_error *error)
{
    record_job *j = (record_job *)job;
    if (j->command.form == STOP)
        return write_frames(j->file, error);
    himc_recording_free(j->file);
    j->file = himc_recording_new(j->command.atom[0].symbol, &j->skeleton, j->rate,
                                 LONGEST_RECORDING, error);
    return j->file || himc_error_prefix(error, "record");
}

static himc_job_state install_recording(himc_job *job, himc_error *error)
{
    record_job *j = (record_job *)job;
    (void)error;
    if (j->command.form == STOP) {
        note_written(j->performance, j->file);
        return HIMC_JOB_DONE;
    }
    j->performance->recording = (performance_recording){.file = j->file};
    j->file = NULL;
    return HIMC_JOB_DONE;
}

static void free_recording(himc_job *job)
{
    himc_recording_free(((record_job *)job)->file);
    free(job);
}

bool himc_performance_allows(bool recording, const himc_command *c, himc_error *error)
{
    enum { PHYSICS }; // form of `rate`
    if (c->id == HIMC_COMMAND_RATE)
        return !recording || c->form == PHYSICS ||
               himc_error_set(error,
                              "rate task: %g: not possible while recording, first send record stop",
                              c->atom[1].number);
    if (c->id != HIMC_COMMAND_RECORD || recording == (c->form == STOP))
        return true;
    return recording
               ? himc_error_set(error, "record: %s: already recording, expected stop",
                                c->atom[0].symbol)
               : himc_error_set(error, "record: stop: nothing is being recorded, expected FILE");
}

himc_job *himc_performance_record_job(himc_performance *p, const himc_command *command,
                                      himc_error *error)
{
    if (!himc_performance_allows(p->recording.file, command, error))
        return NULL;
    record_job *j =
        himc_job_new(sizeof *j, "record",
                     (himc_job){prepare_recording, install_recording, free_recording}, error);
    if (!j)
        return NULL;
    j->performance = p;
    himc_command_copy(&j->command, command);
    j->skeleton = p->body->skeleton;
    j->rate = p->clock.task_rate;
    j->file = p->recording.file; // one that cannot be written is lost, with an error
    p->recording.file = NULL;
    return &j->job;
}

// info

static himc_word word(himc_command_id id, int choice)
{
    return himc_command_word(id, 0, choice);
}

static void describe_body(const himc_performance *p, himc_line_sink to)
{
    const performance_settings *s = &p->settings;
    const himc_controller_config *c = &s->control;
    const himc_saturation_counts *counts = &p->body->saturation;
    bool bounded = false;
    for (int j = 0; j < HIMC_JOINTS; j++)
        bounded = bounded || c->strength[j] > 0;
    himc_tell(&to, "player %.2f m, %.1f kg, 20 segments, 19 joints, 57 degrees of freedom",
              s->skeleton.height, s->skeleton.mass);
    himc_tell(&to, "mode %s%s, solver %s, damping %g m, law %s, coupling %s",
              word(HIMC_COMMAND_MODE, (int)c->mode).text,
              s->bend ? "" : " (in id, arms as captured)",
              word(HIMC_COMMAND_SOLVER, (int)c->solver).text, c->damping,
              word(HIMC_COMMAND_LAW, (int)c->law).text,
              word(HIMC_COMMAND_COUPLING, (int)s->coupling).text);
    himc_tell(&to, "rate physics %g Hz, task %g Hz, sound %g Hz, engine %s", p->clock.physics_rate,
              p->clock.task_rate, p->clock.sample_rate,
              word(HIMC_COMMAND_ENGINE, (int)s->engine).text);
    himc_tell(&to, "limits %s%s, hit %ld times, strength %s",
              word(HIMC_COMMAND_LIMITS, (int)s->limits).text,
              s->limits == HIMC_LIMITS_OFF ? ""
              : p->motion->has_learned     ? " of the take"
                                           : " of table 1",
              himc_body_limit_hits(p->body),
              c->human_strength ? "human"
              : bounded         ? "as set"
                                : "off");
    for (int j = 0; j < HIMC_JOINTS; j++)
        if (counts->hits[j] > 0)
            himc_tell(&to, "limit %s: hit %ld times, up to %.2f degrees beyond", himc_joint_name(j),
                      counts->hits[j], counts->farthest[j] * 180 / HIMC_PI);
    for (int j = 0; j < HIMC_JOINTS; j++)
        if (counts->weak[j] > 0)
            himc_tell(&to,
                      "strength %s %g N m: too weak in %.3g %% of steps, up to %.1f N m asked, "
                      "%.1f given",
                      himc_joint_name(j), c->strength[j],
                      100.0 * (double)counts->weak[j] / (double)counts->steps, counts->torque[j],
                      counts->given[j]);
}

typedef struct drum_sink {
    const himc_line_sink *to;
    const char *before, *after;
} drum_sink;

static void tell_of_drum(void *object, const char *text)
{
    const drum_sink *sink = object;
    char line[3 * HIMC_PATH_SIZE]; // of a file and the words around it
    himc_format(line, sizeof line, "%s %s%s", sink->before, text, sink->after);
    sink->to->line(sink->to->user, line);
}

void himc_performance_tell_drum(const himc_drum *drum, bool placed, const himc_line_sink *to)
{
    drum_sink sink = {to, himc_drum_name(drum), ""};
    himc_drum_tell_state(drum, placed, &(himc_line_sink){tell_of_drum, &sink});
}

void himc_performance_inform(const himc_performance *p, himc_line_sink to)
{
    himc_performance_stats s = himc_performance_measure(p);
    describe_body(p, to);
    for (int i = 0; i < p->drums.count; i++) {
        const drum_slot *slot = &p->drums.slot[i];
        himc_drum_describe(
            slot->drum, HIMC_DESCRIBE_INFO, tell_of_drum,
            &(drum_sink){&to, "drum", slot->source == DRUM_SILENT ? " (silent)" : ""});
    }
    himc_tell(
        &to, "grip %s%s, latency %g ms, hits %d, the last after %.0f ms, the slowest after %.0f ms",
        word(HIMC_COMMAND_GRIP, (int)p->settings.grip).text, p->settings.servo ? " servo" : "",
        1e3 * p->settings.latency, s.hits, 1e3 * s.hit_latency, 1e3 * s.longest_latency);
    if (p->settings.human.amount > 0)
        himc_tell(&to, "human %g, seed %u", p->settings.human.amount,
                  (unsigned)p->settings.human.seed);
    himc_tell(&to,
              "%s %.3f s, strokes %d, played %d, tips within %.4f mm RMS, "
              "peak force %.1f N, recoveries %ld",
              p->motion->playing ? "playing" : "stopped", s.seconds, s.strokes, s.played,
              1e3 * s.tip_rms, s.peak_force, s.recoveries);
    himc_tell(
        &to,
        "contacts: %d unplanned, the longest %.3f s; joints up to %.1f rad/s (%s) and %.1f N m "
        "(%s)",
        s.unplanned_contacts, s.longest_contact, s.peak_rate, himc_joint_name(s.peak_rate_joint),
        s.peak_torque, himc_joint_name(s.peak_torque_joint));
    if (isnan(s.captured_rms))
        return;
    himc_tell(&to,
              "capture: tips %.2f mm RMS off it, at most %.1f mm; %.2f %% and %.1f %% of the "
              "strokes' height; strikes at %.3f of its speeds",
              1e3 * s.captured_rms, 1e3 * s.captured_most, s.captured_rms_percent,
              s.captured_most_percent, s.captured_speed_ratio);
}
