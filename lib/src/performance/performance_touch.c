/// performance_touch.c: sticks on heads: when a contact begins and ends, what it does to the body
/// and to the plan.
///
/// Near a head a stick becomes a point of its effective mass 1 / (n J M^-1 J' n), free
/// acceleration as forward dynamics has it, and is solved with the head's modes sample by sample
/// (contact.h); the impulse goes back to the body as a force in the same physics step. So both
/// ends of the contact see the same force, and the body's tip and the point differ only by what M
/// changes in a step; that offset is kept while they touch and fades afterwards. From the planned
/// time of contact, or the first force, to separation control lets go of the head's normal; then
/// the plan goes on from the stick as it really is.
#include "performance/performance_state.h"
#include "base/head_frame.h"
#include "body/dynamics.h"

#include <string.h>

#define NEAR 0.02         // above the head at rest: from here on a stick is looked after (m)
#define UNDER (-0.10)     // a stick deeper than this is not on the head but under it (m) ...
#define BELOW (-0.03)     // ... and one that did not come from above (m)
#define GAP 0.0015        // without force that ends a contact of a rising stick (s) ...
#define LONG_GAP 0.005    // ... and of any (s)
#define LONGEST 0.060     // control lets go at most so long (s)
#define WINDOW 0.015      // after the planned time, for a contact still to come (s)
#define REPLANNED 0.02    // a stroke that was given up may be planned again so much later (s)
#define SAME_STROKE 0.100 // between planned and real contact of one stroke (s)

void himc_performance_forget_touch(himc_performance *p)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        p->touch[hand] = (touch){.answered = -INFINITY};
}

planned_stroke himc_performance_plan(const himc_performance *p, himc_hand hand, double t)
{
    planned_stroke next = {.any = false, .drum = 0};
    himc_stroke stroke;
    if (himc_performance_tracks(p, hand)) {
        next.any =
            himc_track_current(p->track, hand, t - p->track_start, &next.time, &next.x, &next.y);
        next.time += p->track_start;
        strcpy(next.nuance, "none");
    } else if (himc_planner_current(p->planner, hand, t, &stroke, &next.drum, &next.time)) {
        next.any = next.drum < p->drums;
        if (next.any)
            himc_stroke_spot(&stroke, himc_drum_head_frame(p->drum[next.drum].drum)->radius,
                             &next.x, &next.y);
        strcpy(next.nuance, himc_nuance_name(stroke.nuance));
    }
    next.any = next.any && next.time > p->touch[hand].answered + REPLANNED && isfinite(next.time);
    return next;
}

static himc_target measured_tip(const himc_performance *p, himc_hand hand)
{
    const touch *c = &p->touch[hand];
    himc_vec3 n = p->reference.normal[hand], a = p->reference.tip[hand].a;
    himc_target m = {p->state.tip[hand], p->state.tip_velocity[hand],
                     himc_vec3_madd(a, -himc_vec3_dot(a, n), n)};
    if (p->controller.mode == HIMC_PIPELINE_IK && c->touching) {
        m.x = p->reference.tip[hand].x;
        m.v = p->reference.tip[hand].v;
    }
    return m;
}

static void go_on_from_here(himc_performance *p, himc_hand hand, double t)
{
    himc_target measured = measured_tip(p, hand);
    if (himc_performance_tracks(p, hand))
        himc_track_separated(p->track, hand, t - p->track_start, &measured);
    else
        himc_planner_separated(p->planner, hand, t, &measured);
    p->replan = true;
}

// a planned contact that has not come: the plan goes on without it
static void give_up(himc_performance *p, himc_hand hand, double t, const planned_stroke *next)
{
    p->touch[hand].answered = next->time;
    p->strokes++;
    himc_performance_note(p, "%s stick missed the %s at %.3f s", himc_hand_name(hand),
                          next->drum < p->drums ? himc_drum_name(p->drum[next->drum].drum) : "drum",
                          next->time);
    go_on_from_here(p, hand, t);
}

// in `ik` the stick's end in contact is the micro-contact's, and the arm follows it
static void follow_stick(himc_performance *p, himc_hand hand, double t)
{
    touch *c = &p->touch[hand];
    himc_target *tip = &p->reference.tip[hand];
    const himc_head_frame *place = himc_drum_head_frame(p->drum[c->drum].drum);
    himc_vec3 n = p->reference.normal[hand];
    double height = himc_head_frame_from_world(place, tip->x).z - p->skeleton.mallet_radius;
    tip->x = himc_vec3_madd(tip->x, c->stick.height - height, n);
    tip->v = himc_vec3_madd(tip->v, c->stick.velocity - himc_vec3_dot(n, tip->v), n);
    tip->a = himc_vec3_madd(tip->a, -himc_vec3_dot(n, tip->a), n);
    himc_performance_posture(p, t, p->reference.tip, &p->reference.posture);
}

void himc_performance_release(himc_performance *p, double t)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        touch *c = &p->touch[hand];
        planned_stroke next = himc_performance_plan(p, (himc_hand)hand, t);
        bool due = next.any && t >= next.time && !c->touching;
        if (due && t >= next.time + WINDOW) {
            give_up(p, (himc_hand)hand, t, &next);
            due = false;
        }
        int drum = c->touching ? c->drum : next.drum;
        c->released = due || (c->touching && t < c->strike.time + LONGEST);
        p->reference.released[hand] = c->released;
        if (drum < p->drums)
            p->reference.normal[hand] =
                himc_head_frame_normal(himc_drum_head_frame(p->drum[drum].drum));
        if (c->touching && p->controller.mode == HIMC_PIPELINE_IK)
            follow_stick(p, (himc_hand)hand, t);
    }
}

// whether a tip is on that head or near enough to matter; `local` is its place and height over it
static bool is_over(const himc_performance *p, himc_hand hand, int drum, himc_vec3 *local)
{
    const himc_head_frame *place = himc_drum_head_frame(p->drum[drum].drum);
    himc_vec3 at = himc_head_frame_from_world(place, p->state.tip[hand]);
    at.z -= p->skeleton.mallet_radius;
    double lowest = p->touch[hand].touching && p->touch[hand].drum == drum ? UNDER : BELOW;
    *local = at;
    return at.x * at.x + at.y * at.y < place->radius * place->radius && at.z < NEAR &&
           at.z > lowest;
}

// the drum a tip is over, or -1; of two at one place the one it means to strike
static int drum_below(const himc_performance *p, himc_hand hand, himc_vec3 *local)
{
    planned_stroke next = himc_performance_plan(p, hand, step_time(p));
    const touch *c = &p->touch[hand];
    int meant = c->touching ? c->drum : next.any ? next.drum : -1;
    if (meant >= 0 && meant < p->drums && is_over(p, hand, meant, local))
        return meant;
    for (int i = 0; i < p->drums; i++)
        if (is_over(p, hand, i, local))
            return i;
    return -1;
}

// the stick as a point on the head's normal, at the beginning of the step
static void load_stick(himc_performance *p, himc_hand hand, himc_vec3 local,
                       const himc_articulation *art, const himc_vec3 *relative)
{
    touch *c = &p->touch[hand];
    himc_drum *drum = p->drum[c->drum].drum;
    himc_vec3 n = himc_head_frame_normal(himc_drum_head_frame(drum));
    bool kinematic = p->controller.mode == HIMC_PIPELINE_IK;
    if (!c->stick.touching) // mallets are changed in the air
        c->stick.head = *himc_drum_mallet(drum);
    c->stick.mass = himc_effective_mass(&p->plant, &p->state, art, hand, n);
    c->stick.one_way = p->one_way;
    c->stick.x = local.x;
    c->stick.y = local.y;
    c->stick.acceleration = 0;
    if (!kinematic)
        c->stick.acceleration =
            himc_vec3_dot(n, himc_tip_acceleration(&p->plant, &p->state, hand, relative));
    if (kinematic && c->touching)
        return;
    c->stick.height = local.z + c->offset;
    c->stick.velocity = himc_vec3_dot(n, p->state.tip_velocity[hand]);
}

static void begin_strike(himc_performance *p, himc_hand hand, double time, double velocity)
{
    touch *c = &p->touch[hand];
    planned_stroke next = himc_performance_plan(p, hand, time);
    bool planned = next.any && fabs(next.time - time) < SAME_STROKE;
    c->touching = true;
    c->strike = (himc_strike){.time = time,
                              .hand = hand,
                              .x = c->stick.x,
                              .y = c->stick.y,
                              .velocity = -velocity,
                              .planned_time = planned ? next.time : NAN,
                              .planned_x = next.x,
                              .planned_y = next.y};
    strcpy(c->strike.drum, himc_drum_name(p->drum[c->drum].drum));
    strcpy(c->strike.nuance, planned ? next.nuance : "none");
    if (!planned)
        return;
    double off = hypot(c->stick.x - next.x, c->stick.y - next.y);
    c->answered = next.time;
    p->strokes++;
    p->played +=
        fabs(time - next.time) <= PLAYED_TIME && next.drum == c->drum && off <= PLAYED_PLACE;
}

// what the samples of a step did; returns the impulse (N s)
static double note_forces(himc_performance *p, himc_hand hand, int n, double velocity)
{
    touch *c = &p->touch[hand];
    double dt = 1 / p->config.sample_rate, impulse = 0;
    for (int i = 0; i < n; i++) {
        double force = p->force[hand][i];
        if (force <= 0)
            continue;
        double time = (double)(p->made + (uint64_t)i) * dt;
        if (!c->touching)
            begin_strike(p, hand, time, velocity);
        c->last_force = time;
        c->strike.force = fmax(c->strike.force, force);
        c->peak_row = fmax(c->peak_row, force);
        impulse += force * dt;
    }
    // within a sample a stiff contact's force is higher than its mean
    if (c->touching)
        c->strike.force = fmax(c->strike.force, c->stick.peak);
    c->strike.impulse += impulse;
    c->strike.duration = c->last_force + dt - c->strike.time;
    p->peak_force = fmax(p->peak_force, c->strike.force);
    return impulse;
}

void himc_performance_contact(himc_performance *p, int n, himc_vec3 tip_force[HIMC_HANDS])
{
    himc_articulation art;
    himc_vec3 relative[HIMC_JOINTS], local[HIMC_HANDS];
    double velocity[HIMC_HANDS];
    int below[HIMC_HANDS];
    bool any = false;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        below[hand] = drum_below(p, (himc_hand)hand, &local[hand]);
        any = any || below[hand] >= 0;
        tip_force[hand] = himc_vec3_make(0, 0, 0);
        memset(p->force[hand], 0, (size_t)n * sizeof(double));
    }
    if (any) {
        himc_articulate(&p->plant, &p->state, &art);
        if (p->controller.mode != HIMC_PIPELINE_IK)
            himc_forward_dynamics(&p->plant, &p->state, &art, p->torque, NULL, relative);
    }
    for (int i = 0; i < p->drums; i++) {
        himc_stick *sticks[HIMC_HANDS];
        double *forces[HIMC_HANDS];
        int count = 0;
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            if (below[hand] == i) {
                p->touch[hand].drum = i;
                load_stick(p, (himc_hand)hand, local[hand], &art, relative);
                velocity[hand] = p->touch[hand].stick.velocity;
                sticks[count] = &p->touch[hand].stick;
                forces[count++] = p->force[hand];
            }
        himc_drum_advance_sticks(p->drum[i].drum, n, sticks, count, forces, NULL);
    }
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        if (below[hand] >= 0) {
            double impulse = note_forces(p, (himc_hand)hand, n, velocity[hand]);
            himc_vec3 normal =
                himc_head_frame_normal(himc_drum_head_frame(p->drum[below[hand]].drum));
            tip_force[hand] = himc_vec3_scale(normal, impulse * p->config.sample_rate / n);
        }
}

static void end_strike(himc_performance *p, himc_hand hand, double t)
{
    touch *c = &p->touch[hand];
    himc_event event = {.kind = HIMC_EVENT_STRIKE, .strike = c->strike};
    if (c->strike.velocity > 0) // a head raised into a resting stick is no blow
        himc_performance_emit(p, &event);
    if (c->released)
        go_on_from_here(p, hand, t);
    c->touching = false;
}

void himc_performance_after_contact(himc_performance *p, double t)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        touch *c = &p->touch[hand];
        if (!c->touching) {
            c->offset *= 0.9;
            continue;
        }
        const himc_head_frame *place = himc_drum_head_frame(p->drum[c->drum].drum);
        double height =
            himc_head_frame_from_world(place, p->state.tip[hand]).z - p->skeleton.mallet_radius;
        if (p->controller.mode != HIMC_PIPELINE_IK)
            c->offset = c->stick.height - height;
        double quiet = t - c->last_force;
        if ((quiet > GAP && c->stick.velocity > 0) || quiet > LONG_GAP)
            end_strike(p, (himc_hand)hand, t);
        else if (c->released && t >= c->strike.time + LONGEST)
            go_on_from_here(p, (himc_hand)hand, t);
    }
}
