/// performance_setup.c: a performance made, rebuilt and reset.
///
/// A performance is its settings and the parts that follow from them. Each part that
/// can fail, a new body or a new plan, is made first and then replaces the old one, so a failure
/// changes nothing. `reset` is the default settings and new parts. Time begins at 0 at the first
/// sample not yet simulated, so every floating point sum equals that of a new performance.
#include "performance/performance_state.h"

#include "base/array.h"
#include "drum/membrane_state.h"
#include "head/idiophone.h"
#include "performance/research.h"
#include "himc/loader.h"

#include <stdlib.h>

#define LIGHTEST 0.2 // chosen: an uncertain body, not another one; true over assumed mass
#define HEAVIEST 5.0

himc_performance_config himc_performance_default(void)
{
    return (himc_performance_config){.sample_rate = 48000, .physics_rate = 10000, .task_rate = 250};
}

// the stool as the drums of the hands need it; none for one who stands
static void fit_stool(performance_motion *motion, performance_body *body,
                      const performance_drums *drums, const performance_settings *s)
{
    double lowest = INFINITY, highest = -INFINITY;
    for (int i = 0; i < drums->count; i++) {
        double level = himc_drums_frame(drums, i)->center.z + s->skeleton.mallet_radius;
        if (himc_drum_is_footed(drums->slot[i].drum))
            continue;
        lowest = fmin(lowest, level);
        highest = fmax(highest, level);
    }
    himc_body_seat(body, s->stance == HIMC_STANCE_STANDING
                             ? himc_posture_standing(&s->skeleton, lowest)
                             : himc_posture_seat(&s->skeleton, lowest, highest));
    himc_motion_seat(motion, body->skeleton.segment[HIMC_PELVIS].origin.z);
}

// body and motion begin together, at the targets of `t`
static void put_together(performance_motion *motion, performance_body *body,
                         const performance_settings *s, double t)
{
    himc_pose rest;
    himc_motion_build(motion, &body->skeleton, s, t);
    himc_body_place(body, &motion->from);
    himc_motion_resting_pose(motion, &rest);
    himc_body_init_controller(body, s, &rest);
}

/// The parts that need memory.
typedef struct made_parts {
    performance_motion *motion;
    performance_body *body;
} made_parts;

static void free_parts(made_parts *parts)
{
    himc_motion_free(parts->motion);
    himc_body_free(parts->body);
}

static bool make_parts(made_parts *parts, const performance_settings *s, himc_error *error)
{
    parts->motion = himc_motion_new(error);
    parts->body = parts->motion ? himc_body_new(s, error) : NULL;
    if (!parts->body) {
        free_parts(parts);
        return false;
    }
    put_together(parts->motion, parts->body, s, 0);
    return true;
}

// restarts everything except drums, events and recording with these parts and the usual settings
static void begin(himc_performance *p, const made_parts *parts)
{
    p->settings = p->host.usual;
    p->written.take[0] = '\0';
    himc_text_clear(&p->written.score);
    himc_text_clear(&p->written.units);
    himc_dynamics_clear(&p->written.dynamics);
    p->sync =
        (performance_sync){.beat = -1.0 / SYNC_TICKS, .halt = NAN}; // the first tick is beat 0
    p->motion = parts->motion;
    p->body = parts->body;
    himc_body_account(p->body, p->host.on_motion != NULL);
    himc_statistics_clear(&p->statistics);
    p->events.lost = 0;
    himc_queue_clear(&p->queue);
    himc_contacts_clear(&p->contacts);
    himc_clock_restart(&p->clock);
    himc_performance_restart_steps(p);
}

static void free_written(performance_written *written)
{
    free(written->score.bytes);
    free(written->units.bytes);
    free(written->dynamics.cresc);
}

himc_performance *himc_performance_make(const himc_performance_config *config, himc_error *error)
{
    made_parts parts;
    if (!himc_drum_check_rate(config->sample_rate, error) ||
        !himc_check_range("physics rate", config->physics_rate, HIMC_PHYSICS_RATE_MIN,
                          HIMC_PHYSICS_RATE_MAX, "Hz", error) ||
        !himc_check_range("task rate", config->task_rate, HIMC_TASK_RATE_MIN, HIMC_TASK_RATE_MAX,
                          "Hz", error))
        return NULL;
    himc_performance *p = himc_new(sizeof *p, "performance", error);
    if (!p)
        return NULL;
    p->host = (performance_host){.config = *config,
                                 .take_options = himc_take_default(),
                                 .usual = himc_settings_default(config)};
    if (!himc_written_room(&p->written.score, "performance", error) ||
        !himc_written_room(&p->written.units, "performance", error) ||
        !make_parts(&parts, &p->host.usual, error)) {
        free_written(&p->written);
        free(p);
        return NULL;
    }
    p->clock.sample_rate = config->sample_rate;
    himc_drums_begin(&p->drums, config->heard);
    begin(p, &parts);
    return p;
}

void himc_performance_free(himc_performance *p)
{
    if (!p)
        return;
    himc_drums_release(&p->drums);
    himc_performance_end_recording(p, NULL);
    himc_performance_drop_recording(p);
    free_written(&p->written);
    free_parts(&(made_parts){p->motion, p->body});
    free(p);
}

bool himc_performance_reset(himc_performance *p, himc_error *error)
{
    made_parts fresh, old = {p->motion, p->body};
    if (!make_parts(&fresh, &p->host.usual, error))
        return himc_error_prefix(error, "reset");
    if (!himc_performance_end_recording(p, error)) {
        free_parts(&fresh);
        return himc_error_prefix(error, "reset");
    }
    begin(p, &fresh);
    free_parts(&old);
    himc_drums_put_back(&p->drums);
    himc_performance_notice_drums(p);
    return true;
}

void himc_performance_restart_steps(himc_performance *p)
{
    himc_clock_set_rates(&p->clock, p->settings.physics_rate, p->settings.task_rate);
    himc_motion_replan(p->motion);
}

void himc_performance_adopt(himc_performance *p, const performance_settings *s)
{
    const himc_controller *controller = &p->body->controller;
    p->settings = *s;
    himc_motion_subdivide(p->motion, s->subdivide, step_time(p));
    // the gains of the joints as they were asked for, for this body
    for (int j = 0; j < HIMC_JOINTS; j++) {
        const asked_gain *asked = &s->gain[j];
        double factor = asked->frequency;
        himc_gain usual = himc_controller_usual_gain(controller, j);
        if (!s->control.gain_set[j])
            continue;
        // k_s is proportional to the square of the natural frequency, k_d to the frequency
        p->settings.control.gain[j] =
            factor > 0 ? (himc_gain){himc_vec3_scale(usual.stiffness, factor * factor),
                                     himc_vec3_scale(usual.damping, factor)}
                       : himc_controller_gain(controller, j, asked->stiffness, asked->damping);
    }
    himc_body_configure(p->body, &p->settings);
}

// The order counts: the body is placed on its seat first, and the settings act last, since placing
// resets the controller and its usual gains follow from the new masses.
void himc_performance_embody(himc_performance *p, const performance_settings *wanted,
                             const body_parts *parts)
{
    performance_settings s = *wanted;
    himc_body_adopt(p->body, parts);
    if (s.control.human_strength)
        himc_controller_set_human_strength(&s.control, s.skeleton.mass);
    fit_stool(p->motion, p->body, &p->drums, &s);
    put_together(p->motion, p->body, &s, step_time(p));
    himc_performance_adopt(p, &s);
    himc_performance_renew_limits(p);
}

bool himc_performance_rebuild(himc_performance *p, const performance_settings *wanted,
                              himc_error *error)
{
    body_parts parts;
    if (!himc_body_make_parts(&parts, wanted, error))
        return false;
    himc_performance_embody(p, wanted, &parts);
    return true;
}

bool himc_performance_set_weights(himc_performance *p, const double *factor, himc_error *error)
{
    performance_settings s = p->settings;
    for (int i = 0; factor && i < HIMC_SEGMENTS; i++)
        if (!himc_check_range("weight", factor[i], LIGHTEST, HEAVIEST, "", error))
            return himc_error_prefix(error, "%s", himc_segment_name(i));
    for (int i = 0; i < HIMC_SEGMENTS; i++)
        s.weight[i] = factor ? factor[i] : 1;
    return himc_performance_rebuild(p, &s, error);
}

const himc_skeleton *himc_performance_plant(const himc_performance *p)
{
    return &p->body->plant;
}

bool himc_performance_set_rate(himc_performance *p, double sample_rate, himc_error *error)
{
    if (!himc_drum_check_rate(sample_rate, error))
        return false;
    if (sample_rate == p->clock.sample_rate)
        return true;
    for (int i = 0; i < p->drums.count; i++)
        if (!himc_drum_set_rate(p->drums.slot[i].drum, sample_rate, error))
            return false;
    himc_clock_set_sample_rate(&p->clock, sample_rate);
    himc_performance_restart_steps(p);
    return true;
}

void himc_performance_renew_limits(himc_performance *p)
{
    const performance_motion *m = p->motion;
    if (p->settings.limits == HIMC_LIMITS_OFF) {
        himc_body_set_limits(p->body, NULL);
        return;
    }
    himc_pose mean = himc_motion_mean_pose(m, step_time(p));
    himc_limits limits = m->has_learned ? m->learned : himc_limits_table_1(&mean);
    limits.kind = p->settings.limits;
    himc_body_set_limits(p->body, &limits);
}

void himc_performance_notice_drums(himc_performance *p)
{
    bool noticed[HIMC_DRUMS], unseen = p->clock.made == 0;
    bool changed = unseen && himc_motion_rests_elsewhere(p->motion);
    for (int i = 0; i < p->drums.count; i++) {
        noticed[i] = himc_drums_noticed(&p->drums, i);
        changed = changed || noticed[i];
    }
    if (!changed)
        return;
    if (unseen)
        fit_stool(p->motion, p->body, &p->drums, &p->settings);
    int first = 0; // of the hands
    while (first + 1 < p->drums.count && himc_drum_is_footed(p->drums.slot[first].drum))
        first++;
    for (int i = 0; i < p->drums.count; i++)
        if (noticed[i])
            himc_motion_set_drum(p->motion, i, himc_drums_frame(&p->drums, i), i == first);
    if (unseen) {
        put_together(p->motion, p->body, &p->settings, 0);
        himc_performance_adopt(p, &p->settings);
    }
    himc_drums_join(&p->drums);
    himc_performance_renew_limits(p);
}

bool himc_performance_adopt_drum(himc_performance *p, himc_drum *drum, drum_source source,
                                 int *index, himc_error *error)
{
    if (!himc_drums_add(&p->drums, drum, source, index, error)) {
        himc_drum_release(drum);
        return false;
    }
    himc_performance_notice_drums(p);
    if (source == DRUM_SILENT)
        himc_events_note(&p->events, "no drum %s: playing on a silent one", himc_drum_name(drum));
    return true;
}

bool himc_performance_add_drum(himc_performance *p, himc_drum *drum, himc_error *error)
{
    int index;
    return himc_performance_adopt_drum(p, himc_drum_retain(drum), DRUM_GIVEN, &index, error);
}

bool himc_performance_hear_as(himc_performance *p, const himc_performance *other, himc_error *error)
{
    if (!himc_listener_equal(&p->drums.listener, &other->drums.listener) &&
        !himc_drums_listen(&p->drums, &other->drums.listener, error))
        return false;
    himc_drums_enclose(&p->drums, &other->drums.walls);
    return true;
}

bool himc_performance_find_drum(himc_performance *p, const char *name)
{
    const himc_performance_config *host = &p->host.config;
    return himc_drums_find(&p->drums, name) >= 0 ||
           (host->find_drum && host->find_drum(host->find_user, name));
}

bool himc_performance_index_drum(himc_performance *p, const char *name, himc_spot spot, int *index,
                                 himc_error *error)
{
    *index = 0;
    if (name[0])
        *index = himc_performance_find_drum(p, name) ? himc_drums_find(&p->drums, name) : -1;
    return *index >= 0 || himc_drums_refuse(&p->drums, name, spot, error);
}

bool himc_performance_place_stroke(const himc_performance *p, himc_stroke *stroke, int index,
                                   himc_error *error)
{
    const himc_membrane_config none = {.head.radius = 1}, *head = &none;
    if (index < p->drums.count) {
        himc_drum *drum = p->drums.slot[index].drum;
        head = himc_membrane_config_of(himc_drum_membrane(drum));
        if (stroke->hand != HIMC_FOOT && himc_drum_is_footed(drum))
            return himc_error_set(error, "stroke on %s: no hand reaches it, expected foot",
                                  himc_drum_name(drum));
    }
    return himc_idiophone_place(&head->shape, head->head.radius, stroke, error);
}

bool himc_performance_ensure_drum(himc_performance *p, const char *name, himc_spot spot, int *index,
                                  himc_error *error)
{
    if (!himc_performance_index_drum(p, name, spot, index, error))
        return false;
    if (p->drums.count > 0)
        return true;
    himc_drum *first = himc_drum_new(FIRST_DRUM, HIMC_INCHES_USUAL, p->clock.sample_rate, error);
    return first && himc_performance_adopt_drum(p, first, DRUM_SILENT, index, error);
}

// the commands `drum` and `instrument`
typedef struct make_drum_job {
    himc_job job;
    himc_performance *performance; ///< borrowed
    himc_command command;
    double sample_rate; ///< (Hz)
    himc_drum *drum;    ///< owned
} make_drum_job;

static bool make_drum(himc_job *job, himc_error *error)
{
    make_drum_job *j = (make_drum_job *)job;
    const himc_command *c = &j->command;
    himc_drum_release(j->drum);
    j->drum = himc_drum_made(c, j->sample_rate, error);
    return j->drum;
}

static himc_job_state add_drum(himc_job *job, himc_error *error)
{
    make_drum_job *j = (make_drum_job *)job;
    himc_performance *p = j->performance;
    himc_drum *drum = j->drum;
    int index;
    if (himc_performance_find_drum(p, himc_drum_name(drum)))
        return HIMC_JOB_DONE;
    if (j->sample_rate != p->clock.sample_rate) {
        j->sample_rate = p->clock.sample_rate;
        return HIMC_JOB_AGAIN;
    }
    j->drum = NULL;
    drum_source source = p->host.make_drums ? DRUM_MADE : DRUM_SILENT;
    return himc_performance_adopt_drum(p, drum, source, &index, error) ? HIMC_JOB_DONE
                                                                       : HIMC_JOB_FAILED;
}

static void free_drum(himc_job *job)
{
    himc_drum_release(((make_drum_job *)job)->drum);
    free(job);
}

himc_job *himc_performance_drum_job(himc_performance *p, const himc_command *command,
                                    himc_error *error)
{
    make_drum_job *j =
        himc_job_new(sizeof *j, "drum", (himc_job){make_drum, add_drum, free_drum}, error);
    if (!j)
        return NULL;
    j->performance = p;
    j->sample_rate = p->clock.sample_rate;
    himc_command_copy(&j->command, command);
    return &j->job;
}

himc_drum *himc_performance_drum(himc_performance *p, int index)
{
    return index >= 0 && index < p->drums.count ? p->drums.slot[index].drum : NULL;
}

void himc_performance_make_drums(himc_performance *p, bool make_drums)
{
    p->host.make_drums = make_drums;
}

void himc_performance_take_options(himc_performance *p, const himc_take_options *options)
{
    p->host.take_options = *options;
}

void himc_performance_set_posture_regression(himc_performance *p,
                                             const himc_posture_regression *regression)
{
    himc_motion_set_regression(p->motion, &p->settings, regression, false);
}

himc_track *himc_performance_drop_track(himc_performance *p)
{
    p->written.take[0] = '\0';
    himc_track *track = himc_motion_set_track(p->motion, NULL, NULL, step_time(p));
    himc_performance_renew_limits(p);
    if (p->motion->regression_of_take)
        himc_performance_set_posture_regression(p, NULL);
    return track;
}
