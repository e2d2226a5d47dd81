/// performance_contacts.c: when a contact begins and ends, and its effect on body and plan.
///
/// Near a head a stick becomes a point of its effective mass 1 / (n J M^-1 J' n), with the free
/// acceleration of forward dynamics, and is solved with the head's modes sample by sample
/// (membrane.h); the impulse goes back to the body as a force in the same physics step. So both
/// ends of the contact see the same force, and the body's tip and the point differ only by the
/// change of M in a step; that offset is kept during contact and decays afterwards. What the drum's
/// mallet has more or less than the body's own stick, it has at the end of the stick while it is
/// near the head: the body feels the part of the force that moves its own mass. From the
/// planned time of a stroke's contact, or its first force, to separation, control does not act
/// along the head's normal. Then the plan continues from the measured state of the stick.
///
/// A stroke that bounces (bounce.h) is left to the fingers from its first contact to its last, in
/// the air, too; each contact is reported as a strike of its own. The plan continues after the
/// last. A dead stroke is left to the arm in the same way; it is one contact, and damps the head.
///
/// A contact that no stroke asked for is a press (grip.h), and so is a stroke after which the tip
/// rests on the head: control acts on with a bounded force, and the plan is not changed. A press
/// ends when the stick has clearly left the head, so a stick that rests has one contact.
#include "performance/performance_contacts.h"
#include "drum/contact.h"

#include "body/dynamics.h"
#include "base/head_frame.h"
#include "control/grip.h"

#include <string.h>

// chosen: about the smallest error of a stroke that can be heard and seen
#define PLAYED_TIME 0.005 // a stroke has landed if it touches within this of its time (s) ...
#define PLAYED_PLACE 0.02 // ... and within this of its place (m)
// chosen: a step at 30 m/s is 3 mm, and resting sticks hang over the rim
#define NEAR_HEAD 0.02       // above the head at rest: sticks below this are simulated (m)
#define HIGHEST_BOUNCE 0.35  // ... and below this when they bounce (m)
#define DEEPEST_CONTACT 0.10 // a stick deeper than this is under the head (m) ...
#define DEEPEST_ARRIVAL 0.03 // ... and a stick not from above is if deeper than this (m)
// No arm moves a stick faster. A body that is thrown about by gains or a rate that cannot hold it
// does, up to 100 m/s; the head then feels a blow as of the fastest free mallet, in each step.
#define FASTEST_TIP HIMC_STRIKE_VELOCITY_MAX // (m/s) along the normal, and its change in a step
// chosen: longer than the gaps inside one contact of a mallet and a swinging head
#define RISING_GAP 0.0015 // time without force that ends the contact of a rising stick (s) ...
#define ANY_GAP 0.005     // ... and of any stick (s)
// chosen: a mallet that is kept on the head takes a quarter of what a hand does
#define DEAD_DAMP 0.25
// chosen: a few times the 5 .. 15 ms of a contact
#define LONGEST_RELEASE 0.060  // control releases the normal for at most this time (s)
#define LEAST_PREPARATION 0.03 // of the next stroke: bounces end then, chosen (s)
#define LATEST_CONTACT 0.015   // of a contact after its planned time (s)
#define EARLY_STROKE 0.030     // of a contact before its planned time, soon after another (s)
#define RESTING_CONTACT 0.020  // a stick that bounces and has touched for so long rests (s)
#define SLOWEST_STRIKE 0.01    // (m/s); chosen: a stick at rest moves by 1e-5
#define SAME_STROKE 0.100      // largest time between planned and real contact of one stroke (s)
// chosen: more than a pressed stick moves on a head that swings, less than one that is lifted
#define LIFTED_HEIGHT 0.003 // a pressed stick so high has left the head (m) ...
#define LIFTED_SPEED 0.2    // ... or one that rises so fast (m/s)
#define RESTING_SPEED 0.25  // a contact slower than this ...
#define RESTING_TIME 0.1    // ... so soon after the last one is no strike (m/s, s)
#define LEAST_STICK 0.25    // of the body's stick; chosen: about its shaft without its ball
// chosen: 1e-4 s / ln(1 / 0.9), a factor of 0.9 a step at 10 kHz: short and without a jump
#define OFFSET_TIME 0.95e-3 // time constant of the offset after a contact (s)
#define TAKEN_UP 0.75       // of a speed aside; chosen: tips then go astray least

void himc_contacts_clear(performance_contacts *c)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        c->hand[hand] = (stick_contact){.touching = false};
    c->quiet = 0;
}

void himc_contacts_take_row(performance_contacts *c, himc_hand hand, double *peak, double *impulse)
{
    *peak = c->hand[hand].peak_row;
    *impulse = c->hand[hand].impulse_row;
    c->hand[hand].peak_row = c->hand[hand].impulse_row = 0;
}

double himc_contacts_felt_energy(const performance_contacts *c, himc_hand hand)
{
    const himc_stick *stick = &c->hand[hand].stick;
    double kinetic = 0.5 * stick->mass * stick->velocity * stick->velocity;
    return stick->touching ? himc_contact_energy(stick) - kinetic : 0;
}

static bool is_kinematic(const contact_scene *s)
{
    return s->settings->control.mode == HIMC_PIPELINE_IK;
}

static const himc_head_frame *frame_of(const contact_scene *s, int drum)
{
    return himc_drums_frame(s->drums, drum);
}

static himc_vec3 normal_of(const contact_scene *s, int drum)
{
    return himc_drums_axes(s->drums, drum)->normal;
}

// place of a tip on a head, z the mallet's height over it (m)
static himc_vec3 over_head(const contact_scene *s, int drum, himc_vec3 tip)
{
    himc_vec3 at = himc_drums_local(s->drums, drum, tip);
    at.z -= s->body->skeleton.mallet_radius;
    return at;
}

// true while the stick and not the plan moves the tip along the normal
static bool is_free(const stick_contact *c)
{
    return c->touching || c->bounce.on;
}

// true while the fingers keep the mallet on the head
static bool is_dead(const stick_contact *c)
{
    return c->bounce.on && c->bounce.bounces == HIMC_DEAD;
}

// height of a stick over its head (m), and its velocity along the normal (m/s), up
static double height_of(const stick_contact *c, const contact_scene *s, himc_hand hand)
{
    return is_kinematic(s) ? c->stick.height : over_head(s, c->drum, s->body->state.tip[hand]).z;
}

static double velocity_of(const stick_contact *c, const contact_scene *s, himc_hand hand)
{
    himc_vec3 n = normal_of(s, c->drum);
    return is_kinematic(s) ? c->stick.velocity
                           : himc_vec3_dot(n, s->body->state.tip_velocity[hand]);
}

static void go_on_from_here(const stick_contact *c, const contact_scene *s, himc_hand hand,
                            double t)
{
    const himc_reference *r = &s->motion->reference;
    himc_vec3 n = r->normal[hand], a = r->tip[hand].a;
    himc_target m = {s->body->state.tip[hand], s->body->state.tip_velocity[hand],
                     himc_vec3_madd(a, -himc_vec3_dot(a, n), n)};
    if (is_kinematic(s) && is_free(c)) {
        m.x = r->tip[hand].x;
        m.v = r->tip[hand].v;
    }
    // a blow pushes the stick aside, too; the arm takes most of that up
    himc_vec3 pushed = himc_vec3_sub(m.v, r->tip[hand].v);
    pushed = himc_vec3_madd(pushed, -himc_vec3_dot(pushed, n), n);
    if (s->body->controller.config.human_strength)
        m.v = himc_vec3_madd(m.v, -TAKEN_UP, pushed);
    himc_motion_go_on_from(s->motion, hand, t, &m);
}

// true for a stroke of a take after which the tip stays on the head
static bool rests_after(const contact_scene *s, himc_hand hand, int drum, double time)
{
    return drum < s->drums->count &&
           himc_motion_rests_after(s->motion, hand, time, frame_of(s, drum));
}

// true if a tip is on that head or less than `highest` over it (m); `local` is its place and height
static bool is_over(const stick_contact *c, const contact_scene *s, himc_hand hand, int drum,
                    double highest, himc_vec3 *local)
{
    const himc_head_frame *frame = frame_of(s, drum);
    // most sticks are away from most heads, and a distance costs less than a head's frame
    himc_vec3 away = himc_vec3_sub(s->body->state.tip[hand], frame->center);
    double reach = fmax(highest, DEEPEST_CONTACT) + s->body->skeleton.mallet_radius;
    if (himc_vec3_dot(away, away) > frame->radius * frame->radius + reach * reach)
        return false;
    double lowest = c->touching && c->drum == drum ? -DEEPEST_CONTACT : -DEEPEST_ARRIVAL;
    *local = over_head(s, drum, s->body->state.tip[hand]);
    return himc_head_frame_contains(frame, local->x, local->y) && local->z < highest &&
           local->z > lowest;
}

// the highest head that the hand's tip is above or on, or -1
static int head_under(const stick_contact *c, const contact_scene *s, himc_hand hand)
{
    int under = -1;
    double least = HUGE_VAL;
    himc_vec3 at;
    for (int i = 0; i < s->drums->count; i++)
        if (is_over(c, s, hand, i, least, &at)) {
            least = at.z;
            under = i;
        }
    return under;
}

void himc_contacts_look_down(performance_contacts *contacts, const contact_scene *s, double t,
                             double next)
{
    for (int i = 0; i < HIMC_HANDS; i++) {
        himc_hand hand = (himc_hand)i;
        const stick_contact *c = &contacts->hand[i];
        himc_source_contact stroke = himc_motion_next(s->motion, s->drums, hand, t);
        // the plan of a stroke that rebounds dips into the head, and nothing follows it there
        bool rebounds = c->bounce.on  ? true
                        : c->touching ? !c->pressed
                                      : stroke.any && stroke.time < next + (next - t) &&
                                            !rests_after(s, hand, stroke.drum, stroke.time);
        int under = rebounds ? -1 : head_under(c, s, hand);
        himc_motion_set_under(s->motion, hand, under < 0 ? NULL : frame_of(s, under));
    }
}

// the stroke that is due, as a line names it; false if none is, or it is a take's
static bool name_stroke(const contact_scene *s, himc_hand hand, double t,
                        char name[HIMC_PLANNER_NAME])
{
    return !himc_motion_tracks(s->motion, hand) &&
           himc_planner_name_current(s->motion->planner, hand, t, name);
}

// gives up a planned contact that has not come; the plan continues from the stick, or `beside` all
// heads as it was
static void give_up(const stick_contact *c, const contact_scene *s, himc_hand hand, double t,
                    const himc_source_contact *next, bool beside)
{
    char name[HIMC_PLANNER_NAME];
    bool known = next->drum < s->drums->count;
    const char *drum = known ? himc_drum_name(s->drums->slot[next->drum].drum) : "drum";
    himc_source_stroke stroke = himc_motion_stroke(s->motion, s->drums, hand, t);
    himc_strike missed = {.time = next->time,
                          .hand = hand,
                          .x = stroke.x,
                          .y = stroke.y,
                          .planned_time = next->time,
                          .beat = stroke.beat};
    memcpy(missed.nuance, stroke.nuance, sizeof missed.nuance);
    himc_motion_answer(s->motion, hand, next->time);
    himc_statistics_strokes(s->statistics, 1, 0);
    if (name_stroke(s, hand, t, name))
        himc_events_note(s->events, "%s: the stick missed the head at %.3f s", name, next->time);
    else
        himc_events_note(s->events, "%s stick missed %s%s at %.3f s", himc_hand_name(hand),
                         known ? "drum " : "its ", drum, next->time);
    himc_events_missed(s->events, &missed, drum, "the stick missed the head");
    if (!beside)
        go_on_from_here(c, s, hand, t);
}

static void release_hand(stick_contact *c, const contact_scene *s, himc_hand hand, double t)
{
    himc_source_contact next = himc_motion_next(s->motion, s->drums, hand, t);
    bool due = next.any && t >= next.time && !is_free(c);
    // nothing would stop a stick that is let go beside all heads; the take goes on by itself
    bool beside = due && himc_motion_tracks(s->motion, hand) && head_under(c, s, hand) < 0;
    bool pressed = next.any && c->touching && c->pressed; // it lies there, and does not fall
    if ((due || pressed) && (beside || t >= next.time + LATEST_CONTACT)) {
        give_up(c, s, hand, t, &next, beside || pressed);
        due = false;
    }
    int drum = is_free(c) ? c->drum : next.drum;
    bool released = is_free(c) || (due && !rests_after(s, hand, next.drum, next.time));
    double yield = 0; // the hand's acceleration of the stick along the normal
    if (is_dead(c)) {
        yield = himc_bounce_dead(&c->bounce, t, velocity_of(c, s, hand));
    } else if (c->bounce.on) {
        yield =
            himc_bounce_acceleration(&c->bounce, height_of(c, s, hand), velocity_of(c, s, hand));
    } else if (c->touching && c->pressed) {
        himc_target tip = {s->body->state.tip[hand], s->body->state.tip_velocity[hand], {0, 0, 0}};
        yield = himc_grip_press(&s->motion->reference.tip[hand], &tip, normal_of(s, c->drum),
                                c->stick.mass);
    }
    himc_motion_release(s->motion, hand, released, yield);
    s->motion->reference.struck[hand] = c->touching && !c->pressed && !c->bounce.on;
    if (drum < s->drums->count)
        himc_motion_set_normal(s->motion, hand, normal_of(s, drum));
    if (!is_free(c) || !is_kinematic(s))
        return;
    // in `ik` the contact moves the end of the stick, and the arm follows
    himc_target tip = s->motion->reference.tip[hand];
    himc_vec3 n = s->motion->reference.normal[hand];
    double height = over_head(s, c->drum, tip.x).z;
    tip.x = himc_vec3_madd(tip.x, c->stick.height - height, n);
    tip.v = himc_vec3_madd(tip.v, c->stick.velocity - himc_vec3_dot(n, tip.v), n);
    tip.a = himc_vec3_madd(tip.a, -himc_vec3_dot(n, tip.a), n);
    himc_motion_move_tip(s->motion, s->settings, hand, &tip, t);
}

void himc_contacts_release(performance_contacts *c, const contact_scene *s, double t)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        release_hand(&c->hand[hand], s, (himc_hand)hand, t);
}

// the drum below a tip, or -1; of two drums at one place, the planned one
static int drum_below(const stick_contact *c, const contact_scene *s, himc_hand hand,
                      himc_vec3 *local)
{
    int below = -1;
    for (int i = 0; i < s->drums->count; i++) {
        himc_vec3 at;
        double highest = c->bounce.on && c->drum == i ? HIGHEST_BOUNCE : NEAR_HEAD;
        if (!is_over(c, s, hand, i, highest, &at))
            continue;
        if (below >= 0) { // which one is meant matters here alone
            himc_source_contact next =
                himc_motion_next(s->motion, s->drums, hand, himc_clock_time(s->clock));
            if (i != (is_free(c) ? c->drum : next.any ? next.drum : -1))
                continue;
        }
        below = i;
        *local = at;
    }
    return below;
}

static double bounded(double x, double most)
{
    return x > most ? most : x < -most ? -most : x;
}

// the spot of the stroke that is due on this drum
static himc_spot spot_of(const stick_contact *c, const contact_scene *s, himc_hand hand)
{
    double t = himc_clock_time(s->clock);
    himc_source_stroke due = himc_motion_stroke(s->motion, s->drums, hand, t);
    bool is = due.any && due.drum == c->drum && fabs(t - due.time) < SAME_STROKE;
    return is ? due.spot : HIMC_SPOT_NORMAL;
}

// the stick as a point on the head's normal, at the beginning of the step
static void load_stick(stick_contact *c, const contact_scene *s, himc_hand hand, himc_vec3 local,
                       const himc_articulation *art, const himc_vec3 *relative,
                       const himc_spatial *root)
{
    const performance_body *b = s->body;
    himc_vec3 n = normal_of(s, c->drum);
    if (!c->stick.touching) // mallets are changed in the air
        c->stick.head = *himc_drum_mallet(s->drums->slot[c->drum].drum, hand);
    double body = himc_effective_mass(&b->plant, &b->state, art, hand, n);
    // effective mass of the body's own stick at its end, held at the grip
    const himc_segment *own = &b->skeleton.segment[HIMC_LEFT_STICK + hand];
    double turned = own->inertia.x + own->mass * own->center.z * own->center.z;
    double added = c->stick.head.mass - turned / (b->skeleton.tip.z * b->skeleton.tip.z);
    c->stick.mass = fmax(body + added, LEAST_STICK * body);
    c->share = body / c->stick.mass;
    c->stick.hold = is_dead(c) ? DEAD_DAMP : 0;
    c->stick.one_way = s->settings->coupling == HIMC_COUPLING_ONE_WAY;
    c->stick.x = c->x = local.x;
    c->stick.y = c->y = local.y;
    if (!c->stick.touching)
        himc_drum_meet(s->drums->slot[c->drum].drum, spot_of(c, s, hand), &c->stick);
    double a = s->motion->reference.yield[hand];
    if (!is_kinematic(s))
        a = bounded(
            himc_vec3_dot(n, himc_tip_acceleration(&b->plant, &b->state, hand, relative, root)),
            FASTEST_TIP * s->clock->physics_rate);
    c->stick.acceleration = a;
    if (is_kinematic(s) && is_free(c))
        return;
    c->stick.height = local.z + c->offset;
    c->stick.velocity = bounded(himc_vec3_dot(n, b->state.tip_velocity[hand]), FASTEST_TIP);
}

// A contact begins at `time` (s) with that velocity along the normal, up positive (m/s): what was
// planned for it is answered, and its report begins.
static void begin_strike(stick_contact *c, const contact_scene *s, himc_hand hand, double time,
                         double velocity)
{
    himc_source_stroke next = himc_motion_stroke(s->motion, s->drums, hand, time);
    // so soon after a contact an early one is a rebound
    double earliest = time < c->left + RESTING_TIME ? EARLY_STROKE : SAME_STROKE;
    bool bounced = c->bounce.on, planned = !bounced && next.any && time - next.time < SAME_STROKE &&
                                           time - next.time > -earliest;
    himc_word nuance = {""};
    strcpy(nuance.text, planned ? next.nuance : bounced ? c->strike.nuance : "none");
    c->touching = true;
    c->told = false;
    c->pressed = !bounced && (!planned || rests_after(s, hand, next.drum, next.time));
    c->strike = (himc_strike){.time = time,
                              .hand = hand,
                              .x = c->x,
                              .y = c->y,
                              .velocity = -velocity,
                              .planned_time = planned ? next.time : NAN,
                              .planned_x = next.x,
                              .planned_y = next.y,
                              .beat = planned ? next.beat : NAN};
    strcpy(c->strike.drum, himc_drum_name(s->drums->slot[c->drum].drum));
    strcpy(c->strike.nuance, nuance.text);
    if (!bounced && !planned)
        himc_statistics_unplanned(s->statistics);
    if (!planned)
        return;
    if (next.bounces && !s->settings->servo)
        c->bounce = himc_bounce_begin(next.bounces, next.bounce_time, time);
    double off = hypot(c->x - next.x, c->y - next.y);
    bool played =
        fabs(time - next.time) <= PLAYED_TIME && next.drum == c->drum && off <= PLAYED_PLACE;
    himc_motion_answer(s->motion, hand, next.time);
    himc_statistics_strokes(s->statistics, 1, played);
    himc_statistics_landed(s->statistics, -velocity, next.speed, next.yields);
    char name[HIMC_PLANNER_NAME];
    if (off > PLAYED_PLACE && himc_motion_plays_score(s->motion) &&
        himc_statistics_aside(s->statistics) == 0 &&
        name_stroke(s, hand, time, name)) // once: a stroke of a score, or a hit
        himc_events_note(s->events, "%s: landed at %.3g %.3g, %.2g m from its place", name,
                         c->strike.x, c->strike.y, off);
}

// adds the forces of a step's `n` samples to the strike; returns the impulse (N s)
static double note_forces(stick_contact *c, const contact_scene *s, himc_hand hand,
                          const double *forces, int n, double velocity)
{
    double dt = 1 / s->clock->sample_rate, impulse = 0;
    for (int i = 0; i < n; i++) {
        double force = forces[i];
        if (force <= 0)
            continue;
        double time = (double)(s->clock->made + i) * dt;
        if (!c->touching)
            begin_strike(c, s, hand, time, velocity);
        c->last_force = time;
        c->strike.force = fmax(c->strike.force, force);
        c->peak_row = fmax(c->peak_row, force);
        impulse += force * dt;
    }
    // within a sample a stiff contact's force is higher than its mean
    if (c->touching)
        c->strike.force = fmax(c->strike.force, c->stick.peak);
    c->strike.impulse += impulse;
    c->impulse_row += impulse;
    c->strike.duration = c->last_force + dt - c->strike.time;
    himc_statistics_contact(s->statistics, c->strike.force, c->strike.duration);
    return impulse;
}

// all drums, together from one exchange through the air between them to the next
static void advance_drums(performance_contacts *c, const contact_scene *s, int n,
                          const int below[HIMC_HANDS])
{
    for (int done = 0, run; done < n; done += run) {
        int64_t now = s->clock->made + done;
        himc_air_between *air = s->drums->air;
        if (air && himc_air_between_due(air, now)) {
            himc_drums_catch_up(s->drums);
            himc_air_between_exchange(air);
        }
        run = air ? himc_air_between_until(air, now, n - done) : n - done;
        for (int i = 0; i < s->drums->count; i++) {
            himc_stick *sticks[HIMC_HANDS];
            double *forces[HIMC_HANDS];
            int count = 0;
            for (int hand = 0; hand < HIMC_HANDS; hand++)
                if (below[hand] == i) {
                    sticks[count] = &c->hand[hand].stick;
                    forces[count++] = c->force[hand] + done;
                }
            s->drums->slot[i].behind += count == 0 ? run : 0;
            if (count == 0)
                continue;
            himc_drums_catch_up_one(s->drums, i);
            if (himc_drum_advance_sticks(s->drums->slot[i].drum, run, sticks, count, forces, NULL))
                c->quiet = 0;
        }
    }
}

void himc_contacts_advance(performance_contacts *c, const contact_scene *s, int n,
                           himc_vec3 tip_force[HIMC_HANDS])
{
    const performance_body *body = s->body;
    int below[HIMC_HANDS]; // drum, or -1
    himc_vec3 local[HIMC_HANDS], relative[HIMC_JOINTS];
    himc_articulation kinematic; // in `ik`, where the body is not simulated
    const himc_articulation *art = &kinematic;
    himc_spatial root;
    bool any = false;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        below[hand] = drum_below(&c->hand[hand], s, (himc_hand)hand, &local[hand]);
        any = any || below[hand] >= 0;
        if (below[hand] != c->hand[hand].drum)
            c->hand[hand].stick.touching = false; // it has left the head that it touched
    }
    if (any && is_kinematic(s)) {
        himc_articulate(&body->plant, &body->state, &kinematic);
    } else if (any) {
        art = himc_character_articulation(body->character);
        root = himc_balance_accelerate(body->controller.balance, &body->plant, &body->state, art,
                                       body->torque, NULL, relative);
    }
    c->force_count = n;
    c->quiet += n / s->clock->sample_rate;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        memset(c->force[hand], 0, (size_t)n * sizeof(double));
        if (below[hand] < 0)
            continue;
        c->hand[hand].drum = below[hand];
        load_stick(&c->hand[hand], s, (himc_hand)hand, local[hand], art, relative, &root);
    }
    himc_stick before[HIMC_HANDS] = {c->hand[HIMC_LEFT].stick, c->hand[HIMC_RIGHT].stick};
    advance_drums(c, s, n, below);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        tip_force[hand] = himc_vec3_make(0, 0, 0);
        if (below[hand] < 0)
            continue;
        const himc_stick *a = &before[hand], *b = &c->hand[hand].stick;
        double impulse =
            note_forces(&c->hand[hand], s, (himc_hand)hand, c->force[hand], n, a->velocity);
        // work of the head on the stick (J): it is a free body under this and the hand's
        // acceleration, both constant in a sample
        double kinetic = 0.5 * b->mass * (b->velocity * b->velocity - a->velocity * a->velocity);
        double work =
            impulse > 0 ? kinetic - b->mass * b->acceleration * (b->height - a->height) : 0;
        himc_statistics_contact_work(s->statistics, (himc_hand)hand, work,
                                     (1 - c->hand[hand].share) * work);
        double force = impulse * s->clock->sample_rate / n;
        tip_force[hand] = himc_vec3_scale(normal_of(s, below[hand]), c->hand[hand].share * force);
    }
}

static void finish_hand(stick_contact *c, const contact_scene *s, himc_hand hand, double t,
                        double kept)
{
    if (!c->touching) {
        c->offset *= kept;
        return;
    }
    // both are whole samples; half of one, so that the rounding of times does not decide
    double quiet = t - c->last_force - 0.5 / s->clock->sample_rate;
    double height = over_head(s, c->drum, s->body->state.tip[hand]).z, rise = c->stick.velocity;
    bool lifted = height > LIFTED_HEIGHT || rise > LIFTED_SPEED;
    double since = fmax(c->strike.time, c->bounce.begin); // a dead stroke was lifted
    bool late = !c->bounce.on && t >= since + LONGEST_RELEASE;
    bool separated = is_dead(c)        ? false
                     : quiet > ANY_GAP ? !c->pressed || lifted
                                       : !c->pressed && quiet > RISING_GAP && rise > 0;
    if (!is_kinematic(s))
        c->offset = c->stick.height - height;
    if (!separated && !late)
        return;
    // the strike is reported once; a head raised into a resting stick is none, nor is a stick laid
    // down again
    himc_event event = {.kind = HIMC_EVENT_STRIKE, .strike = c->strike};
    bool resting =
        c->pressed && c->strike.velocity < RESTING_SPEED && c->strike.time < c->left + RESTING_TIME;
    if (c->strike.velocity > SLOWEST_STRIKE && !resting && !c->told)
        himc_events_add(s->events, &event);
    c->told = true;
    if (separated && c->bounce.on)
        himc_bounce_separated(&c->bounce, t, t - c->last_force, height_of(c, s, hand),
                              velocity_of(c, s, hand));
    else if (!c->pressed)
        go_on_from_here(c, s, hand, t);
    c->pressed = c->pressed || !separated;
    c->touching = !separated;
    c->left = separated ? t : c->left;
}

void himc_contacts_finish(performance_contacts *c, const contact_scene *s, double t)
{
    double h = c->force_count / s->clock->sample_rate, kept = exp(-h / OFFSET_TIME);
    for (int i = 0; i < HIMC_HANDS; i++) {
        himc_hand hand = (himc_hand)i;
        stick_contact *own = &c->hand[i];
        finish_hand(own, s, hand, t, kept);
        if (!own->bounce.on)
            continue;
        // the hand takes up a stick that has bounced, also when the next stroke is near
        himc_source_contact next = himc_motion_next(s->motion, s->drums, hand, t);
        bool near = next.any && t > next.time - LEAST_PREPARATION;
        bool presses = own->touching && t < own->strike.time + RESTING_CONTACT;
        if (!near && (presses || !himc_bounce_is_over(&own->bounce, t, velocity_of(own, s, hand))))
            continue;
        own->bounce = (himc_bounce){.begin = t};
        himc_motion_release(s->motion, hand, true, 0); // the plan begins without their acceleration
        go_on_from_here(own, s, hand, t);
        own->pressed = true; // a contact that goes on is no stroke
    }
}
