/// performance_report.c: what a performance tells: events in a bounded queue, figures, rows of
/// motion, its state.
#include "performance/performance_state.h"
#include "base/head_frame.h"

#include <stdio.h>
#include <string.h>

void himc_performance_emit(himc_performance *p, const himc_event *event)
{
    if (p->event_count == WAITING_EVENTS) { // nobody listens: the oldest goes
        p->event_first = (p->event_first + 1) % WAITING_EVENTS;
        p->event_count--;
        p->events_lost++;
    }
    p->event[(p->event_first + p->event_count++) % WAITING_EVENTS] = *event;
}

void himc_performance_note(himc_performance *p, const char *format, ...)
{
    himc_event event = {.kind = HIMC_EVENT_NOTE};
    va_list args;
    va_start(args, format);
    vsnprintf(event.text, sizeof event.text, format, args);
    va_end(args);
    himc_performance_emit(p, &event);
}

bool himc_performance_event(himc_performance *p, himc_event *event)
{
    if (p->event_count == 0)
        return false;
    *event = p->event[p->event_first];
    p->event_first = (p->event_first + 1) % WAITING_EVENTS;
    p->event_count--;
    return true;
}

// height of the target over the head it will strike; its largest value between strikes is the
// stroke's height
static void measure_height(himc_performance *p, himc_hand hand)
{
    touch *c = &p->touch[hand];
    if (p->drums == 0)
        return;
    const himc_head_frame *place = himc_drum_head_frame(p->drum[c->drum].drum);
    double height =
        himc_head_frame_from_world(place, p->reference.tip[hand].x).z - p->skeleton.mallet_radius;
    if (c->touching && c->apex > 0) {
        p->height_sum += c->apex;
        p->height_count++;
        c->apex = 0;
    } else if (!c->touching) {
        c->apex = fmax(c->apex, height);
    }
}

void himc_performance_measure_step(himc_performance *p)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        bool tracks = himc_performance_tracks(p, (himc_hand)hand);
        bool idle = p->track && !himc_track_present(p->track, (himc_hand)hand);
        if (idle || (tracks && step_time(p) < p->track_start)) // nor on its way to a take
            continue;
        measure_height(p, (himc_hand)hand);
        if (p->touch[hand].released || p->touch[hand].touching)
            continue;
        himc_vec3 away = himc_vec3_sub(p->state.tip[hand], p->reference.tip[hand].x);
        p->square_sum += himc_vec3_dot(away, away);
        p->square_count++;
    }
}

himc_performance_stats himc_performance_measure(const himc_performance *p)
{
    himc_performance_stats s = {.seconds = (double)p->sample / p->config.sample_rate,
                                .strokes = p->strokes,
                                .played = p->played,
                                .missed = p->strokes - p->played,
                                .peak_force = p->peak_force,
                                .hits = p->hits,
                                .hit_latency = p->hit_latency,
                                .longest_latency = p->longest_latency,
                                .recoveries = p->recoveries,
                                .limit_hits = himc_performance_limit_hits(p),
                                .events_lost = p->events_lost,
                                .sample_rate = p->config.sample_rate,
                                .physics_rate = p->physics_rate,
                                .task_rate = p->config.task_rate};
    s.tip_rms = p->square_count ? sqrt(p->square_sum / (double)p->square_count) : 0;
    s.stroke_height = p->height_count ? p->height_sum / (double)p->height_count : 0;
    s.tip_rms_percent = s.stroke_height > 0 ? 100 * s.tip_rms / s.stroke_height : NAN;
    return s;
}

static void watch_beats(himc_performance *p, double t)
{
    double beat = himc_planner_beat(p->planner, t);
    long whole = p->track || !(beat >= 0) ? -1 : (long)floor(beat + 1e-9);
    if (whole >= 0 && whole != p->last_beat) {
        himc_event event = {.kind = HIMC_EVENT_BEAT, .beat = (double)whole};
        himc_performance_emit(p, &event);
    }
    p->last_beat = whole;
}

static void say_notes(himc_performance *p)
{
    himc_planner_note note;
    while (himc_planner_note_next(p->planner, &note))
        himc_performance_note(p, "%s", note.text);
}

void himc_performance_watch(himc_performance *p, double t)
{
    p->strokes += himc_planner_given_up(p->planner);
    say_notes(p);
    watch_beats(p, t);
    double end =
        p->track ? p->track_start + himc_track_length(p->track) : himc_planner_end(p->planner);
    bool touching = p->touch[HIMC_LEFT].touching || p->touch[HIMC_RIGHT].touching;
    if (p->playing && t >= end && !touching) {
        himc_event event = {.kind = HIMC_EVENT_DONE};
        p->playing = false;
        himc_planner_sum_up(p->planner);
        say_notes(p);
        himc_performance_emit(p, &event);
    }
}

void himc_performance_on_motion(himc_performance *p, void (*row)(void *, const himc_motion_row *),
                                void *user)
{
    p->on_motion = row;
    p->motion_user = user;
}

void himc_performance_on_tick(himc_performance *p, void (*tick)(void *, const himc_tick *),
                              void *user)
{
    p->on_tick = tick;
    p->tick_user = user;
}

static void tell_tick(himc_performance *p, double t)
{
    himc_tick tick = {.time = t, .body = &p->state};
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        tick.target[hand] = p->reference.tip[hand].x;
    if (p->on_tick)
        p->on_tick(p->tick_user, &tick);
}

void himc_performance_motion_row(himc_performance *p, double t)
{
    tell_tick(p, t);
    himc_motion_row row = {.time = t};
    himc_pose pose = himc_pose_from_state(&p->skeleton, &p->state);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        row.target[hand] = p->reference.tip[hand].x;
        row.tip[hand] = p->state.tip[hand];
        row.force[hand] = p->touch[hand].peak_row;
        row.elbow[hand] = p->state.origin[HIMC_LEFT_FOREARM + hand];
        p->touch[hand].peak_row = 0;
    }
    for (int j = 0; j < HIMC_JOINTS; j++) {
        row.joint[j] = himc_quat_log(pose.joint[j]);
        row.limit[j] = p->controller.limits ? p->saturation.measure[j] : 0;
    }
    if (p->on_motion)
        p->on_motion(p->motion_user, &row);
    if (p->recording && !himc_recording_add(p->recording, &p->state) && !p->recording_full) {
        p->recording_full = true;
        himc_performance_note(p, "%s: no more room, recorded up to %.3f s",
                              himc_recording_path(p->recording), t);
    }
}

static void describe_drums(const himc_performance *p, void (*line)(void *, const char *),
                           void *user)
{
    char text[512], about[400];
    for (int i = 0; i < p->drums; i++) {
        himc_drum_describe(p->drum[i].drum, about, sizeof about);
        snprintf(text, sizeof text, "drum %s%s", about, p->drum[i].silent ? " (silent)" : "");
        line(user, text);
    }
}

static himc_word word(himc_command_id id, int choice)
{
    return himc_command_word(id, 0, choice);
}

void himc_performance_describe(const himc_performance *p, void (*line)(void *, const char *),
                               void *user)
{
    char text[512];
    himc_performance_stats s = himc_performance_measure(p);
    snprintf(text, sizeof text,
             "player %.2f m, %.1f kg, 20 segments, 19 joints, 57 degrees of freedom",
             p->body.height, p->body.mass);
    line(user, text);
    snprintf(text, sizeof text, "mode %s%s, solver %s, damping %g m, law %s, coupling %s",
             word(HIMC_COMMAND_MODE, (int)p->controller.mode).text,
             p->unbent ? " (in id, arms as captured)" : "",
             word(HIMC_COMMAND_SOLVER, (int)p->controller.solver).text, p->controller.damping,
             word(HIMC_COMMAND_LAW, (int)p->controller.law).text,
             word(HIMC_COMMAND_COUPLING, p->one_way ? HIMC_COUPLING_ONE_WAY : HIMC_COUPLING_TWO_WAY)
                 .text);
    line(user, text);
    snprintf(text, sizeof text, "rate physics %g Hz, task %g Hz, sound %g Hz", p->physics_rate,
             p->config.task_rate, p->config.sample_rate);
    line(user, text);
    himc_performance_describe_limits(p, line, user);
    describe_drums(p, line, user);
    snprintf(text, sizeof text,
             "grip %s, hits %d, the last after %.0f ms, the slowest after %.0f ms",
             word(HIMC_COMMAND_GRIP, (int)p->grip).text, s.hits, 1e3 * s.hit_latency,
             1e3 * s.longest_latency);
    line(user, text);
    snprintf(text, sizeof text,
             "%s %.3f s, strokes %d, played %d, tips within %.4f mm RMS, "
             "peak force %.1f N, recoveries %ld",
             p->playing ? "playing" : "stopped", s.seconds, s.strokes, s.played, 1e3 * s.tip_rms,
             s.peak_force, s.recoveries);
    line(user, text);
}
