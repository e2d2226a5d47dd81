/// performance_motion.c: the targets of the body.
///
/// A hand follows the take while that plays, else the planner. At the change the planner continues
/// from the tip's present state, C2. Joint targets come from the take's postures, the
/// natural posture or, as null-space target of `himc`, a player's posture regression; from one
/// source to another they cross-fade (posture_crossfade.h).
#include "performance/performance_motion.h"
#include "base/array.h"
#include "control/law.h"

#include "control/alive.h"

#include "body/limits.h"
#include "base/head_frame.h"
#include "control/grip.h"
#include "plan/gesture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define REST_HEIGHT 0.12 // chosen: resting tips over the sticks' level, until there is a drum (m)
#define TRUNK_FORESIGHT 1.2 // chosen: strokes further ahead do not turn the trunk (s)
#define USUAL_TICK 0.004    // (s)
#define CLEARING_STEPS 40   // of the avoidance, before the body is first placed
#define TRUNK_STEP 0.02     // longest step of himc_trunk_posture_approach (s)
// postures a second of the planner's rehearsal; chosen: 10 % of a core, and a tenth of that near
// contacts, whose steps cost most
#define WORK 50000.0
#define BUSY_WORK 5000.0
#define REPLANNED 0.02    // chosen: least delay of a stroke that is given up and planned again (s)
#define LIMIT_HEIGHT 0.35 // chosen: a large stroke; the mean posture's tips go up to here (m)
#define LIMIT_HEIGHTS 8   // postures in that mean
#define PRESS_RIM 0.9     // share of a head's radius; further out targets go past its rim, too

// a live target that falls faster than sticks do has jumped; so that it presses without a blow, it
// comes down to the head as if braked; chosen: a press arrives with less than 20 N
#define JUMP_SPEED 8.0    // (m/s)
#define JUMP_GAP 0.3      // between targets of a stream, at most (s)
#define PRESS_ARRIVAL 0.6 // at the head (m/s)
#define PRESS_BRAKE 20.0  // above it (m/s^2)

#define BEAT_BEGINNING 0.1 // of a beat; chosen: a tick at 1000 beats a minute

// a stroke that does not rebound: at both times after it the tip is wanted so low; chosen: the
// softest roll of one hand, ppp at 12 Hz, is higher at the first, the fastest at one of them
static const double rests_at[] = {0.06, 0.09}; // (s)
#define RESTS_BELOW 0.002                      // (m)
#define CALM 0.5                               // dynamic of hands without a stroke to play; chosen
#define ROLLED 0.2    // strokes of one hand nearer to each other are a roll's (s); chosen
#define TOUCHING 1e-3 // before a contact, the plan has the stick's speed in it (s)

// the piece is the take if there is one; it moves the hands that it has, from `play` on
static void choose_sources(performance_motion *m, bool played)
{
    const hand_source planner = {&himc_planner_source, m->planner};
    m->piece = m->track ? (hand_source){&himc_track_source, m->track} : planner;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        bool takes = played && m->track && himc_track_present(m->track, (himc_hand)hand);
        m->source[hand] = takes ? m->piece : planner;
    }
}

performance_motion *himc_motion_new(himc_error *error)
{
    performance_motion *m = himc_new(sizeof *m, "performance", error);
    himc_planner_config planning = himc_planner_default();
    if (!m)
        return NULL;
    planning.mallet_radius = himc_skeleton_default().mallet_radius;
    planning.body = &m->body;
    m->planner = himc_planner_new(&planning, error);
    if (!m->planner) {
        free(m);
        return NULL;
    }
    m->body.posture.level = planning.rest[HIMC_RIGHT].z - REST_HEIGHT;
    choose_sources(m, false);
    m->last_beat = m->feet.played_to = -1;
    m->subdivide = 1;
    m->prepared[HIMC_LEFT] = m->prepared[HIMC_RIGHT] = -INFINITY;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        m->answered[hand] = -INFINITY;
    return m;
}

void himc_motion_free(performance_motion *m)
{
    if (!m)
        return;
    himc_planner_free(m->planner);
    himc_feet_free(&m->feet);
    himc_track_free(m->track);
    free(m);
}

void himc_motion_replan(performance_motion *m)
{
    m->replan = true;
}

void himc_motion_seat(performance_motion *m, double height)
{
    m->body.posture.skeleton.segment[HIMC_PELVIS].origin.z = height;
}

bool himc_motion_rests_elsewhere(const performance_motion *m)
{
    double far = 0;
    for (int hand = 0; hand < HIMC_HANDS && himc_motion_plays_score(m); hand++)
        far += himc_vec3_length(himc_vec3_sub(himc_planner_target(m->planner, (himc_hand)hand, 0).x,
                                              m->from.tip[hand].x));
    return far > 0;
}

void himc_motion_set_drum(performance_motion *m, int index, const himc_head_frame *frame,
                          bool first)
{
    himc_planner_set_drum(m->planner, index, frame);
    if (first)
        m->body.posture.level = frame->center.z + m->body.posture.skeleton.mallet_radius;
    m->replan = true;
}

// take or planner

bool himc_motion_plays_score(const performance_motion *m)
{
    return m->piece.kind == &himc_planner_source;
}

bool himc_motion_tracks(const performance_motion *m, himc_hand hand)
{
    return m->source[hand].kind == &himc_track_source;
}

double himc_motion_take_time(const performance_motion *m, double t)
{
    bool moves = himc_motion_tracks(m, HIMC_LEFT) || himc_motion_tracks(m, HIMC_RIGHT);
    return moves ? t - himc_track_start(m->track) : -INFINITY;
}

bool himc_motion_is_idle(const performance_motion *m, himc_hand hand, double t)
{
    return himc_motion_tracks(m, hand) ? himc_motion_take_time(m, t) < 0
                                       : m->track && !himc_track_present(m->track, hand);
}

bool himc_motion_captured(const performance_motion *m, himc_hand hand, double t, himc_vec3 *x)
{
    return himc_motion_tracks(m, hand) &&
           himc_track_captured(m->track, hand, himc_motion_take_time(m, t), x);
}

bool himc_motion_captured_joints(const performance_motion *m, double t, himc_posture_motion *joints)
{
    double at = himc_motion_take_time(m, t);
    if (!isfinite(at) || !himc_track_has_posture(m->track))
        return false;
    *joints = m->reference.posture;
    himc_track_posture(m->track, &m->body.posture.skeleton, at, NULL, joints);
    return true;
}

// Gives the hands of the take to the planner.
static void take_hands_back(performance_motion *m, double t)
{
    bool tracked = false;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        if (himc_motion_tracks(m, (himc_hand)hand)) {
            himc_planner_resume(m->planner, t, (himc_hand)hand, &m->reference.tip[hand]);
            tracked = true;
        }
    choose_sources(m, false);
    m->crossfade_due = m->crossfade_due || tracked;
    m->replan = true;
}

bool himc_motion_free_hand(performance_motion *m, himc_hand hand, double t)
{
    if (himc_motion_tracks(m, hand) && t >= m->piece.kind->end(m->piece.of))
        take_hands_back(m, t);
    return !himc_motion_tracks(m, hand);
}

himc_track *himc_motion_set_track(performance_motion *m, himc_track *track,
                                  const himc_limits *learned, double t)
{
    himc_track *old = m->track;
    take_hands_back(m, t);
    m->track = track;
    choose_sources(m, false);
    m->over = false;
    m->has_learned = learned != NULL;
    if (learned)
        m->learned = *learned;
    return old;
}

// plan

himc_target himc_motion_planned(const performance_motion *m, himc_hand hand, double t)
{
    return m->source[hand].kind->target(m->source[hand].of, hand, t);
}

static bool is_coming(const performance_motion *m, himc_hand hand, double time)
{
    return time > m->answered[hand] + REPLANNED && isfinite(time);
}

himc_source_contact himc_motion_next(const performance_motion *m, const performance_drums *drums,
                                     himc_hand hand, double t)
{
    himc_source_contact next = m->source[hand].kind->next(m->source[hand].of, hand, t);
    next.any = next.any && next.drum < drums->count && is_coming(m, hand, next.time);
    return next;
}

himc_source_stroke himc_motion_stroke(const performance_motion *m, const performance_drums *drums,
                                      himc_hand hand, double t)
{
    himc_source_stroke next = m->source[hand].kind->stroke(m->source[hand].of, hand, t);
    next.any = next.any && next.drum < drums->count && is_coming(m, hand, next.time);
    return next;
}

void himc_motion_answer(performance_motion *m, himc_hand hand, double planned_time)
{
    m->answered[hand] = planned_time;
}

void himc_motion_correct(performance_motion *m, const performance_settings *s, himc_hand hand,
                         double t, const himc_target *measured)
{
    const hand_source *source = &m->source[hand];
    if (himc_laws[s->control.law].accelerates && source->kind->correct &&
        source->kind->correct(source->of, hand, t, measured))
        m->replan = true;
}

void himc_motion_go_on_from(performance_motion *m, himc_hand hand, double t,
                            const himc_target *measured)
{
    m->source[hand].kind->separated(m->source[hand].of, hand, t, measured);
    m->replan = true;
}

// trunk and grip

// the course at a time, not before it was set
static himc_trunk_posture trunk_at(const performance_motion *m, double t)
{
    return himc_trunk_posture_approach(&m->body.from, &m->body.goal,
                                       fmin(fmax(t - m->body.time, 0), TRUNK_STEP));
}

// sets a new course, from trunk and grip at `t` to those for the next strokes
static void set_course(performance_motion *m, const performance_settings *s,
                       const performance_drums *drums, double t)
{
    himc_planned_body *b = &m->body;
    himc_vec3 place[HIMC_HANDS]; // of each hand: its next strike point, or its position
    himc_vec3 tip[HIMC_FORESEEN][HIMC_HANDS];
    himc_next_stroke first = {.in = INFINITY, .since = INFINITY};
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_source_stroke next = himc_motion_stroke(m, drums, (himc_hand)hand, t);
        himc_vec3 at = {0, 0, 0};
        if (next.any)
            at = himc_head_frame_to_world(himc_drums_frame(drums, next.drum), next.x, next.y);
        place[hand] = next.any && next.time <= t + TRUNK_FORESIGHT
                          ? at
                          : himc_motion_planned(m, (himc_hand)hand, t).x;
        first.since = fmin(first.since, t - m->answered[hand]);
        if (next.any && next.time >= t && next.time - t < first.in) {
            first.in = next.time - t;
            first.at = at;
        }
    }
    b->from = trunk_at(m, t);
    b->goal = himc_posture_trunk(&m->body.posture, place, s->grip);
    if (m->track && himc_settings_trunk_known(s)) {
        const double *captured = s->captured.trunk.value;
        b->goal.value[HIMC_TRUNK_POSTURE_TURN] = captured[HIMC_TRUNK_POSTURE_TURN];
        b->goal.value[HIMC_TRUNK_POSTURE_LEAN] = captured[HIMC_TRUNK_POSTURE_LEAN];
    }
    if (s->alive && !m->track) // a take shows its own
        himc_alive_add(&b->posture, &first, t, &b->goal);
    double turn = b->goal.value[HIMC_TRUNK_POSTURE_TURN];
    b->goal.value[HIMC_TRUNK_POSTURE_LEAN] -= m->foot.back * cos(turn) + m->foot.aside * sin(turn);
    b->goal.value[HIMC_TRUNK_POSTURE_SIDE] += m->foot.aside * cos(turn) - m->foot.back * sin(turn);
    if (t - b->avoided >= HIMC_AVOIDANCE_PERIOD) { // the arms stay clear along the tips' way
        for (int k = 0; k < HIMC_FORESEEN; k++)
            for (int hand = 0; hand < HIMC_HANDS; hand++)
                tip[k][hand] =
                    himc_motion_planned(m, (himc_hand)hand, t + himc_avoidance_times[k]).x;
        himc_posture now = b->posture;
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            now.hand[hand] = himc_hand_path_at(&m->path[hand], t);
        himc_avoidance_look_ahead(&b->avoidance, &now, &b->shells, &b->from, &b->goal, tip,
                                  t - b->avoided);
        b->avoided = t;
    }
    himc_avoidance_apply(&b->avoidance, &b->goal);
    b->time = t;
}

// the hands

// how a hand plays its next stroke
static himc_hand_style style_of(const performance_motion *m, himc_hand hand,
                                const himc_source_stroke *next)
{
    himc_nuance nuance = 0;
    if (next->time - m->answered[hand] < ROLLED)
        return himc_hand_style_roll();
    while (nuance < HIMC_NUANCES && strcmp(next->nuance, himc_nuance_name(nuance)) != 0)
        nuance++;
    if (nuance == HIMC_NUANCES) // a take's stroke has none
        nuance = HIMC_LEGATO;
    double speed = -himc_motion_planned(m, hand, next->time - TOUCHING).v.z;
    return himc_hand_style_of(nuance,
                              himc_gesture_dynamic_at(nuance, fmax(speed, HIMC_SLOWEST_GESTURE)));
}

// aims the hands' paths at the plan, from a tick at `t` to the next
static void aim_hands(performance_motion *m, const performance_drums *drums, double t, double next)
{
    double middle = 0.5 * (t + next), stick = himc_vec3_length(m->body.posture.skeleton.tip);
    m->body.posture.trunk_posture = trunk_at(m, t);
    for (int i = 0; i < HIMC_HANDS; i++) {
        himc_hand hand = (himc_hand)i;
        himc_source_stroke stroke = himc_motion_stroke(m, drums, hand, t);
        if (!m->path[i].moving) {
            m->style[i] = himc_hand_style_of(HIMC_LEGATO, CALM);
            m->level[i] = m->body.posture.level;
        }
        if (stroke.any) { // else it goes on as for the one before
            m->style[i] = style_of(m, hand, &stroke);
            m->level[i] = himc_drums_frame(drums, stroke.drum)->center.z +
                          m->body.posture.skeleton.mallet_radius;
        }
        const himc_hand_style *style = &m->style[i];
        double grip_at = middle + himc_hand_path_foresight(style->grip_lead),
               hand_at = middle + himc_hand_path_foresight(style->hand_lead);
        himc_hand_ahead ahead = {
            .grip = himc_motion_planned(m, hand, grip_at).x.z - m->level[i],
            .hand = himc_motion_planned(m, hand, hand_at).x.z - m->level[i],
            .now = himc_motion_planned(m, hand, t).x.z - m->level[i],
            .up = himc_motion_planned(m, hand, middle + HIMC_HAND_PATH_RISES).v.z,
            .level = m->level[i],
            .french = m->body.posture.trunk_posture.value[HIMC_TRUNK_POSTURE_FRENCH_GRIP]};
        m->path[i] = himc_hand_path_at(&m->path[i], t);
        himc_hand_path_aim(&m->path[i], style, &ahead, stick);
        himc_posture_swing(&m->body.posture, hand, himc_motion_planned(m, hand, t).x,
                           himc_motion_planned(m, hand, t + HIMC_HAND_PATH_SWINGS).x, &m->path[i]);
    }
}

// the joints

// the take's posture for the tips, else the natural one
static void find_posture(const performance_motion *m, const performance_settings *s, double t,
                         const himc_target tip[HIMC_HANDS], himc_posture_motion *motion)
{
    double at = himc_motion_take_time(m, t);
    himc_posture now = m->body.posture; // whose hands rest wherever the tips are
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        now.hand[hand] = himc_hand_path_at(&m->path[hand], t);
    himc_posture_moving(&now, tip, motion);
    if (s->control.mode != HIMC_PIPELINE_HIMC && isfinite(at) && himc_track_has_posture(m->track))
        himc_track_posture(m->track, &m->body.posture.skeleton, at, s->bend ? tip : NULL, motion);
    himc_pedal_leg(&m->foot, &m->body.posture, t, motion);
}

void himc_motion_set_regression(performance_motion *m, const performance_settings *s,
                                const himc_posture_regression *regression, bool of_take)
{
    m->regression_of_take = of_take;
    if (regression)
        m->regression = *regression;
    if (m->has_regression != (regression != NULL)) {
        m->has_regression = regression != NULL;
        m->crossfade_due = true;
        m->replan = true;
    }
    if (!regression || !m->track || !himc_settings_trunk_known(s))
        return;
    // with a take the trunk has its captured posture, not the one for the strokes; the regression's
    // trunk rotation is relative to it
    himc_pose pose;
    himc_posture held = m->body.posture;
    const himc_vec3 tip[HIMC_HANDS] = {m->from.tip[HIMC_LEFT].x, m->from.tip[HIMC_RIGHT].x};
    held.trunk_posture = s->captured.trunk;
    himc_posture_at(&held, tip, &pose);
    m->regression.player.natural_trunk = pose.joint[HIMC_TRUNK - 1];
}

// setpoints

// height of a tip over a head, as the mallet has it
static double height_over(const performance_motion *m, const himc_head_frame *head, himc_vec3 tip)
{
    return himc_head_frame_from_world(head, tip).z - m->body.posture.skeleton.mallet_radius;
}

static void fill_tick(performance_motion *m, const performance_settings *s, himc_setpoint *tick,
                      double t)
{
    himc_target ahead[HIMC_REGRESSION_OFFSETS][HIMC_HANDS];
    m->body.posture.trunk_posture = trunk_at(m, t);
    tick->time = t;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        const himc_head_frame *head = &m->under[hand];
        himc_target *tip = &tick->tip[hand];
        *tip = himc_motion_planned(m, (himc_hand)hand, t);
        if (head->radius == 0)
            continue;
        // a target below the head becomes a press; towards the rim it may go deeper, so that one
        // that goes past the rim does not jump
        himc_vec3 at = himc_head_frame_from_world(head, tip->x), n = himc_head_frame_normal(head);
        double out = fmax(himc_head_frame_out(head, at.x, at.y) - PRESS_RIM, 0) / (1 - PRESS_RIM);
        double h = at.z - m->body.posture.skeleton.mallet_radius, v = himc_vec3_dot(n, tip->v),
               a = himc_vec3_dot(n, tip->a), free = h, free_v = v, free_a = a;
        if (out >= 1)
            continue;
        himc_grip_limit_depth(HIMC_GRIP_DEPTH / (1 - out), &h, &v, &a);
        tip->x = himc_vec3_madd(tip->x, h - free, n);
        tip->v = himc_vec3_madd(tip->v, v - free_v, n);
        tip->a = himc_vec3_madd(tip->a, a - free_a, n);
    }
    find_posture(m, s, t, tick->tip, &tick->posture);
    if (s->control.mode == HIMC_PIPELINE_HIMC && m->has_regression) {
        for (int k = 0; k < HIMC_REGRESSION_OFFSETS; k++)
            for (int hand = 0; hand < HIMC_HANDS; hand++)
                ahead[k][hand] =
                    himc_motion_planned(m, (himc_hand)hand, t + k * HIMC_REGRESSION_OFFSET_STEP);
        himc_posture_regression_moving(&m->regression, (const himc_target(*)[HIMC_HANDS])ahead,
                                       &tick->posture);
    }
    if (m->crossfade_due && tick == &m->from) {
        himc_posture_crossfade_begin(&m->crossfade, t, &m->reference.posture, &tick->posture);
        m->crossfade_due = false;
    }
    if (!m->crossfade_due)
        himc_posture_crossfade_apply(&m->crossfade, t, &tick->posture);
}

void himc_motion_read_task(performance_motion *m, const performance_settings *s,
                           const performance_drums *drums, double t, double next)
{
    himc_free_hand hand[HIMC_HANDS];
    himc_damped_head head[HIMC_DRUMS];
    m->body.grip = s->grip;
    m->body.shells.count = drums->count;
    for (int i = 0; i < drums->count; i++)
        m->body.shells.head[i] = *himc_drums_frame(drums, i);
    himc_planner_follow_ramp(m->planner);
    himc_planner_advance(m->planner, t);
    himc_motion_stir(m);
    if (s->alive && !m->track) { // hands lie on heads that are damped; a take shows its own
        double soon = himc_motion_score_beat(m, t + HIMC_DAMPING_FORESIGHT);
        for (int i = 0; i < HIMC_HANDS; i++) { // free while it has nothing to play or to follow
            himc_source_stroke stroke = himc_motion_stroke(m, drums, (himc_hand)i, t);
            bool live = m->live[i].time > 0 && m->live[i].time > m->answered[i];
            double until = stroke.any ? stroke.time : INFINITY;
            hand[i] = (himc_free_hand){m->answered[i], live ? m->answered[i] : until};
        }
        for (int i = 0; i < drums->count; i++)
            head[i] = (himc_damped_head){.frame = himc_drums_frame(drums, i),
                                         .now = himc_drums_damped(drums, i),
                                         .soon = himc_drums_will_be_damped(drums, i, soon)};
        if (himc_damping_move(&m->damping, m->planner, &m->body.posture, head, drums->count, hand,
                              t))
            m->replan = true;
    }
    set_course(m, s, drums, t);
    aim_hands(m, drums, t, next);
    if (m->replan)
        fill_tick(m, s, &m->from, t);
    else
        m->from = m->to;
    fill_tick(m, s, &m->to, next);
    himc_setpoint_course_make(&m->between, &m->from, &m->to);
    m->between.legs = himc_pedal_moves(&m->foot, m->foot.foot, t);
    m->replan = false;
}

void himc_motion_think(performance_motion *m, double h, bool busy)
{
    himc_planner_think(m->planner, h * (busy ? BUSY_WORK : WORK));
}

void himc_motion_interpolate(performance_motion *m, double t)
{
    himc_setpoint_at(&m->between, t, &m->reference);
}

void himc_motion_init_posture(himc_posture *posture, const himc_skeleton *skeleton,
                              const captured_player *captured, double level, himc_stance stance)
{
    himc_posture_init(posture, skeleton, level);
    if (stance == HIMC_STANCE_STANDING)
        himc_posture_stand(posture);
    for (int j = HIMC_TRUNK; j < HIMC_JOINTS; j++)
        if (captured->known[j])
            posture->rest.joint[j] = captured->rest.joint[j];
}

// Targets and reference at `t`, without a cross-fade; with `clear` from a new course: the trunk
// turned to the tips, elbows and wrists where nothing is near.
static void begin_at(performance_motion *m, const performance_settings *s, double t, bool clear)
{
    himc_foreseen f[HIMC_FORESEEN];
    m->crossfade_due = false;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        m->path[hand] = (himc_hand_path){.moving = false};
    himc_posture_crossfade_cancel(&m->crossfade);
    if (clear) {
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            f[0].tip[hand] = himc_motion_planned(m, (himc_hand)hand, t).x;
        f[0].trunk = himc_posture_trunk(&m->body.posture, f[0].tip, s->grip);
        for (int k = 1; k < HIMC_FORESEEN; k++)
            f[k] = f[0];
        m->body.avoidance = (himc_avoidance){{0}, 0};
        for (int i = 0; i < CLEARING_STEPS; i++)
            himc_avoidance_update(&m->body.avoidance, &m->body.posture, &m->body.shells, f,
                                  HIMC_AVOIDANCE_PERIOD);
        m->body.goal = f[0].trunk;
        himc_avoidance_apply(&m->body.avoidance, &m->body.goal);
        m->body.from = m->body.goal;
        m->body.time = t;
    }
    fill_tick(m, s, &m->from, t);
    memcpy(m->reference.tip, m->from.tip, sizeof m->from.tip);
    m->reference.posture = m->from.posture;
    m->replan = true;
}

bool himc_motion_is_finite(const performance_motion *m)
{
    return himc_setpoint_finite(&m->from) && himc_setpoint_finite(&m->to);
}

void himc_motion_recover(performance_motion *m, const performance_settings *s, double t)
{
    if (himc_pedal_moves(&m->foot, m->foot.foot, t)) { // both feet are on the floor again
        m->foot = (himc_pedal_foot){.away = false};
        fill_tick(m, s, &m->from, t);
        m->replan = true;
    }
    if (himc_motion_is_finite(m))
        return;
    himc_planner_recover(m->planner, t);
    bool sound = true;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_target planned = himc_motion_planned(m, (himc_hand)hand, t);
        sound = sound && himc_target_finite(&planned);
        m->live[hand] = (live_target){.time = 0};
    }
    if (!sound)
        choose_sources(m, false);
    begin_at(m, s, t, true);
    m->to = m->from;
    m->to.time += USUAL_TICK; // until the setpoints are read again
    himc_setpoint_course_make(&m->between, &m->from, &m->to);
}

void himc_motion_build(performance_motion *m, const himc_skeleton *skeleton,
                       const performance_settings *s, double t)
{
    himc_motion_init_posture(&m->body.posture, skeleton, &s->captured, m->body.posture.level,
                             s->stance);
    m->foot = (himc_pedal_foot){.away = false};
    memset(m->pedal, 0, sizeof m->pedal);
    himc_planner_set_body(m->planner);
    begin_at(m, s, t, m->body.time == 0);
}

void himc_motion_resting_pose(const performance_motion *m, himc_pose *pose)
{
    himc_planner_config resting = himc_planner_default();
    himc_posture posture;
    himc_posture_init(&posture, &m->body.posture.skeleton,
                      resting.rest[HIMC_RIGHT].z - REST_HEIGHT);
    posture.rest = m->body.posture.rest;
    himc_posture_at(&posture, resting.rest, pose);
}

himc_pose himc_motion_mean_pose(const performance_motion *m, double t)
{
    himc_pose pose[LIMIT_HEIGHTS];
    for (int i = 0; i < LIMIT_HEIGHTS; i++) {
        himc_vec3 tip[HIMC_HANDS];
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            tip[hand] = himc_motion_planned(m, (himc_hand)hand, t).x;
            tip[hand].z = m->body.posture.level + LIMIT_HEIGHT * i / (LIMIT_HEIGHTS - 1);
        }
        himc_posture_at(&m->body.posture, tip, &pose[i]);
    }
    return himc_limits_mean(pose, LIMIT_HEIGHTS);
}

// contact

void himc_motion_release(performance_motion *m, himc_hand hand, bool released, double yield)
{
    m->reference.released[hand] = released;
    m->reference.yield[hand] = yield;
}

void himc_motion_set_under(performance_motion *m, himc_hand hand, const himc_head_frame *head)
{
    m->under[hand] = head ? *head : (himc_head_frame){.radius = 0};
}

bool himc_motion_rests_after(const performance_motion *m, himc_hand hand, double time,
                             const himc_head_frame *head)
{
    for (int i = 0; i < 2; i++)
        if (!himc_motion_tracks(m, hand) ||
            height_over(m, head, himc_motion_planned(m, hand, time + rests_at[i]).x) > RESTS_BELOW)
            return false;
    return true;
}

void himc_motion_set_normal(performance_motion *m, himc_hand hand, himc_vec3 normal)
{
    m->reference.normal[hand] = normal;
}

void himc_motion_move_tip(performance_motion *m, const performance_settings *s, himc_hand hand,
                          const himc_target *tip, double t)
{
    m->reference.tip[hand] = *tip;
    find_posture(m, s, t, m->reference.tip, &m->reference.posture);
}

// transport

void himc_motion_play(performance_motion *m, double t)
{
    m->piece.kind->play(m->piece.of, t, m->reference.tip, &m->reference.posture);
    if (m->track)
        choose_sources(m, true);
    m->playing = true;
    m->over = false;
    m->replan = true;
}

void himc_motion_go_on(performance_motion *m, double t)
{
    if (!m->over || !himc_motion_plays_score(m) || !himc_planner_goes_on(m->planner))
        return;
    m->playing = true;
    m->over = false;
    himc_motion_beat(m, t); // the beat under way has begun before
}

void himc_motion_stop(performance_motion *m, double t)
{
    m->piece.kind->stop(m->piece.of, t, m->reference.tip);
    if (!himc_motion_plays_score(m)) // it moves the hand that a one-handed take has not
        himc_planner_stop(m->planner, t);
    m->playing = m->over = false;
    m->replan = true;
}

bool himc_motion_note_target(performance_motion *m, himc_hand hand, bool good)
{
    bool first = !good && !m->out_of_reach[hand];
    m->out_of_reach[hand] = !good;
    return first;
}

himc_vec3 himc_motion_ease_down(performance_motion *m, himc_hand hand, double t, himc_vec3 target,
                                const himc_head_frame *head)
{
    live_target *live = &m->live[hand];
    double gap = t - live->time, from = head ? height_over(m, head, live->x) : 0,
           to = head ? height_over(m, head, target) : 0;
    bool falls = head && gap > 0 && gap < JUMP_GAP && (live->eased || from - to > JUMP_SPEED * gap);
    double most = sqrt(PRESS_ARRIVAL * PRESS_ARRIVAL + 2 * PRESS_BRAKE * fmax(from, 0)) * gap;
    live->eased = falls && from - to > most;
    if (live->eased)
        target = himc_vec3_madd(target, from - most - to, himc_head_frame_normal(head));
    live->x = target;
    live->time = t;
    return target;
}

himc_vec3 himc_motion_beyond(const performance_motion *m, const himc_head_frame *head)
{
    himc_vec3 least = {INFINITY, 0, 0};
    for (int i = 0; i < HIMC_HANDS; i++) {
        himc_stroke usual = {.hand = (himc_hand)i, .spot = HIMC_SPOT_NORMAL};
        double x, y;
        himc_head_frame_spot(head, &usual, &x, &y);
        himc_vec3 tip =
            himc_vec3_madd(himc_head_frame_to_world(head, x, y),
                           m->body.posture.skeleton.mallet_radius, himc_head_frame_normal(head));
        himc_vec3 way =
            himc_vec3_sub(tip, himc_posture_reachable(&m->body.posture, usual.hand, tip));
        if (himc_vec3_length(way) < himc_vec3_length(least))
            least = way;
    }
    return least;
}

// of a score, or of the count before it
static double counted_beat(const performance_motion *m, double t)
{
    bool prepares = himc_planner_is_preparing(m->planner, t);
    return prepares ? himc_planner_count(m->planner, t) : himc_planner_beat(m->planner, t);
}

// the part of a beat, counted in parts
static long whole_beat(const performance_motion *m, double t)
{
    double beat = counted_beat(m, t) * m->subdivide;
    bool counts = himc_motion_plays_score(m) && !m->over && beat >= 0;
    return counts ? (long)floor(beat + BEAT_ROUNDING) : -1;
}

double himc_motion_score_beat(const performance_motion *m, double t)
{
    bool stopped = !himc_motion_plays_score(m) && !m->playing && !m->over;
    return stopped ? -1 : m->piece.kind->beat(m->piece.of, t);
}

/// True if a beat begins by t: another one, or the same one of a later round or behind a count. A
/// score that starts within a beat does not begin it.
static bool begins_beat(const performance_motion *m, double t)
{
    long whole = whole_beat(m, t);
    double beat = counted_beat(m, t) * m->subdivide;
    bool within = beat - floor(beat + BEAT_ROUNDING) >= BEAT_BEGINNING;
    bool other = whole != m->last_beat && (m->last_beat >= 0 || whole < 0 || !within);
    return other || himc_planner_round(m->planner, t) > m->last_round ||
           (m->counted && !himc_planner_is_preparing(m->planner, t));
}

// the planner's end is behind the last change of a head and push, that of others need not be
static bool is_over(const performance_motion *m, double t)
{
    const hand_source *piece = &m->piece;
    return m->playing && t >= piece->kind->end(piece->of) &&
           (himc_motion_plays_score(m) ||
            piece->kind->beat(piece->of, t) >= himc_planner_until(m->planner));
}

bool himc_motion_is_calm(const performance_motion *m, double t)
{
    return t < m->calm && !m->replan;
}

void himc_motion_foresee(performance_motion *m, double next)
{
    // beats follow each other in time, so that none begins between two equal ones
    m->calm = !begins_beat(m, next) && !is_over(m, next) ? next : -INFINITY;
}

void himc_motion_stir(performance_motion *m)
{
    m->calm = -INFINITY;
}

double himc_motion_beat(performance_motion *m, double t)
{
    long whole = whole_beat(m, t);
    bool begun = begins_beat(m, t);
    m->last_beat = whole;
    m->counted = himc_planner_is_preparing(m->planner, t);
    m->last_round = himc_planner_round(m->planner, t);
    return begun ? (double)whole / m->subdivide : -1;
}

void himc_motion_subdivide(performance_motion *m, double parts, double t)
{
    bool begun = m->last_beat >= 0, other = parts != m->subdivide;
    m->subdivide = parts;
    if (other && begun)
        m->last_beat = whole_beat(m, t);
    himc_motion_stir(m);
}

bool himc_motion_done(performance_motion *m, double t)
{
    if (!is_over(m, t))
        return false;
    m->playing = false;
    m->over = true;
    himc_planner_finish(m->planner);
    return true;
}
