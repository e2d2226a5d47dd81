/// performance.c: the sample clock and the physics step: algorithm 2 of the 2012 paper, with a
/// drum in it.
///
/// A step is simulated when the host takes its first sample; its forces wait here. So the result
/// does not depend on the block size.
#include "performance/performance_state.h"

#include <math.h>
#include <string.h>

#define MIXED 256  // samples read at once; chosen: 4 kB of the stack
#define MOVED 0.03 // a stroke that comes so much later is another gesture (s); chosen

static contact_scene scene_of(himc_performance *p)
{
    return (contact_scene){.clock = &p->clock,
                           .settings = &p->settings,
                           .body = p->body,
                           .drums = &p->drums,
                           .motion = p->motion,
                           .statistics = &p->statistics,
                           .events = &p->events};
}

// Replaces an invalid state of the physics by that of the targets, counts it and tells each fall.
// Targets that are not finite are replaced as well.
static void recover(himc_performance *p, double t)
{
    bool servo = p->body->controller.config.law != HIMC_LAW_COMPUTED_TORQUE,
         fell = himc_body_has_fallen(p->body),
         tell = himc_statistics_recovery(&p->statistics, fell);
    if (tell && fell)
        himc_events_note(&p->events, "the player fell at %.1f s and was put back%s", t,
                         servo && p->settings.stance == HIMC_STANCE_STANDING
                             ? ": he keeps his balance with law computed-torque only"
                             : "");
    else if (tell)
        himc_events_note(&p->events,
                         "the body flew apart at a physics rate of %g Hz and was put back",
                         p->clock.physics_rate);
    himc_motion_recover(p->motion, &p->settings, t);
    himc_body_place(p->body, &p->motion->from);
    himc_contacts_clear(&p->contacts);
}

// distance of tips and targets, and heights of strokes; at ticks of tips and capture
static void measure(himc_performance *p, double t, bool tick)
{
    const himc_reference *r = &p->motion->reference;
    himc_vec3 captured;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        const stick_contact *c = &p->contacts.hand[hand];
        if (tick && himc_motion_captured(p->motion, (himc_hand)hand, t, &captured))
            himc_statistics_captured(&p->statistics,
                                     himc_vec3_sub(p->body->state.tip[hand], captured));
        if (himc_motion_is_idle(p->motion, (himc_hand)hand, t))
            continue;
        if (p->drums.count > 0) {
            himc_vec3 over = himc_drums_local(&p->drums, c->drum, r->tip[hand].x);
            double height = over.z - p->body->skeleton.mallet_radius;
            himc_statistics_height(&p->statistics, (himc_hand)hand, height, c->touching);
        }
        if (!r->released[hand] && !c->touching)
            himc_statistics_tip(&p->statistics,
                                himc_vec3_sub(p->body->state.tip[hand], r->tip[hand].x));
    }
}

// Inverse kinematics, inverse dynamics, forward dynamics; contact is solved inside the same step.
// In `ik` the body is moved by inverse kinematics; only the ends of the sticks are in contact.
static void step_body(himc_performance *p, int n, double t, double h, bool tick)
{
    contact_scene scene = scene_of(p);
    performance_body *b = p->body;
    bool kinematic = p->settings.control.mode == HIMC_PIPELINE_IK;
    if (!(kinematic ? himc_body_follow(b, &p->motion->reference, h) : himc_body_observe(b, tick)))
        recover(p, t);
    if (tick && !kinematic && himc_body_has_fallen(b))
        recover(p, t);
    if (tick)
        himc_performance_take_energy(p);
    himc_contacts_finish(&p->contacts, &scene, t);
    // hits in their last milliseconds, from where the sticks are
    for (int hand = 0; hand < HIMC_HANDS && !kinematic; hand++) {
        himc_target measured = {b->state.tip[hand], b->state.tip_velocity[hand], {0, 0, 0}};
        if (!p->contacts.hand[hand].touching)
            himc_motion_correct(p->motion, &p->settings, (himc_hand)hand, t, &measured);
    }
    if (!kinematic)
        himc_body_control(b, &p->motion->reference, h);
    himc_contacts_advance(&p->contacts, &scene, n, b->tip_force);
    measure(p, t, tick);
    himc_statistics_joints(&p->statistics, &b->skeleton, &b->state, kinematic ? NULL : b->torque);
    if (!kinematic && !himc_body_simulate(b, t, h))
        recover(p, t);
}

static void tell_planner_notes(himc_performance *p)
{
    himc_planner_note note;
    while (himc_planner_note_next(p->motion->planner, &note))
        himc_events_note_as(&p->events, note.minor ? NOTE_MINOR : NOTE_USUAL, "%s", note.text);
}

// strokes given up, beats, the end
static void watch(himc_performance *p, double t)
{
    himc_statistics_strokes(&p->statistics, himc_planner_given_up(p->motion->planner), 0);
    tell_planner_notes(p);
    himc_performance_tell_misses(p);
    if (himc_motion_is_calm(p->motion, t))
        return;
    double beat = himc_motion_beat(p->motion, t);
    if (beat >= 0)
        himc_events_add(&p->events,
                        &(himc_event){.kind = HIMC_EVENT_BEAT, .beat = beat, .time = t});
    if (!himc_contacts_any(&p->contacts) && himc_motion_done(p->motion, t)) {
        tell_planner_notes(p);
        himc_events_add(&p->events, &(himc_event){.kind = HIMC_EVENT_DONE});
    }
    himc_motion_foresee(p->motion, himc_clock_next_tick(&p->clock));
}

// strokes whose gesture begins, once each; one that is moved is told again
static void tell_gestures(himc_performance *p, double t)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_source_stroke s = himc_motion_stroke(p->motion, &p->drums, (himc_hand)hand, t);
        double *told = &p->motion->prepared[hand];
        if (!s.any || t < s.time - s.lead || t > s.time || fabs(s.time - *told) < MOVED)
            continue;
        *told = s.time;
        himc_events_prepare(&p->events, s.time, (himc_hand)hand,
                            himc_drum_name(p->drums.slot[s.drum].drum));
    }
}

static void performance_step(himc_performance *p)
{
    himc_performance_run_due_commands(p);
    himc_performance_notice_drums(p);
    contact_scene scene = scene_of(p);
    int n = himc_clock_step_samples(&p->clock);
    int joint;
    double t = step_time(p), h = n / p->clock.sample_rate, rate;
    bool tick = himc_clock_is_tick(&p->clock);
    if (tick || p->motion->replan) {
        double next = himc_clock_next_tick(&p->clock);
        himc_contacts_look_down(&p->contacts, &scene, t, next);
        himc_performance_move_foot(p, t);
        himc_motion_read_task(p->motion, &p->settings, &p->drums, t, next);
        if (!himc_motion_is_finite(p->motion))
            recover(p, t);
    }
    himc_performance_leave_clock(p, t);
    if (tick) { // what the score has at a beat
        double beat = himc_motion_score_beat(p->motion, t);
        himc_planner *planner = p->motion->planner;
        himc_drums_turn_heads(&p->drums, beat,
                              himc_motion_plays_score(p->motion) ? himc_planner_round(planner, t)
                                                                 : 0,
                              himc_planner_length(planner), &p->events);
        double next = himc_motion_score_beat(p->motion, himc_clock_next_tick(&p->clock));
        himc_body_begin_pushes(p->body, beat, next, t);
        performance_feet *feet = &p->motion->feet;
        double force = 0;
        int missed = himc_feet_play(feet, &p->drums, planner, t, beat, next, &p->events);
        int told = himc_feet_tell(feet, &p->drums, &p->events, t, &force);
        himc_statistics_strokes(&p->statistics, told + missed, told);
        himc_statistics_contact(&p->statistics, force, 0);
    }
    himc_motion_think(p->motion, h, himc_contacts_busy(&p->contacts));
    himc_motion_interpolate(p->motion, t);
    himc_contacts_release(&p->contacts, &scene, t);
    step_body(p, n, t, h, tick);
    if (tick) {
        tell_gestures(p, t);
        himc_performance_tell_tick(p, t);
        // a joint faster than any person's, whatever the cause; once
        if (himc_statistics_too_fast(&p->statistics, &joint, &rate))
            himc_events_note(&p->events,
                             "at %.2f s %s turns at %.0f rad/s, a person's at %.0f at most", t,
                             himc_joint_name(joint), rate, HIMC_FASTEST_JOINT);
    }
    watch(p, t);
    p->clock.made += n;
    p->clock.step++;
}

void himc_performance_process(himc_performance *p, int n, double *const force[HIMC_HANDS])
{
    const performance_contacts *c = &p->contacts;
    himc_motion_stir(p->motion); // the host may have changed the score
    for (int done = 0; done < n;) {
        if (himc_clock_ahead(&p->clock) == 0)
            performance_step(p);
        int ready = himc_clock_ahead(&p->clock), count = ready < n - done ? ready : n - done;
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            if (force && force[hand])
                memcpy(force[hand] + done, c->force[hand] + c->force_count - ready,
                       (size_t)count * sizeof(double));
        p->clock.played += count;
        done += count;
    }
    himc_drums_catch_up(&p->drums);
}

// up to MIXED samples of a channel, from `start`; returns their peak
static double mix(const himc_performance *p, uint64_t start, int n, int channel, int channels,
                  float *out)
{
    double heard[MIXED], sum[MIXED] = {0}, peak = 0;
    for (int d = 0; d < p->drums.count && channel < HIMC_PICKUPS; d++) {
        if (channels == 1)
            himc_drum_read(p->drums.slot[d].drum, start, n, heard, NULL);
        else
            himc_drum_read_channel(p->drums.slot[d].drum, channel, start, n, heard);
        for (int i = 0; i < n; i++)
            sum[i] += heard[i];
    }
    for (int i = 0; i < n; i++) {
        out[i * channels + channel] = (float)sum[i];
        peak = fmax(peak, fabs(sum[i]));
    }
    return peak;
}

double himc_performance_read(himc_performance *p, float *frames, int channels, int n)
{
    double peak = 0;
    for (int at = 0; at < n; at += MIXED) {
        int count = n - at < MIXED ? n - at : MIXED;
        uint64_t start = himc_performance_time(p);
        himc_performance_process(p, count, NULL);
        for (int channel = 0; channel < channels; channel++)
            peak = fmax(peak, mix(p, start, count, channel, channels, frames + at * channels));
    }
    return peak;
}

himc_performance *himc_performance_new(const himc_performance_config *config, himc_error *error)
{
    himc_performance *p = himc_performance_make(config, error);
    if (p)
        p->runner = himc_performance_runner;
    return p;
}

uint64_t himc_performance_time(const himc_performance *p)
{
    return (uint64_t)(p->clock.played - p->clock.aligned);
}

void himc_performance_realign(himc_performance *p)
{
    p->clock.aligned = p->clock.played;
    for (int i = 0; i < p->drums.count; i++)
        himc_drum_realign(p->drums.slot[i].drum, himc_clock_ahead(&p->clock));
}
