/// hand.c: how a tip gets from anywhere to its next touch, as a timpanist's does.
///
/// A chunk is planned in the frame of the head it goes to: the height along the normal n, and the
/// ground, the rest. The height rises from the rebound to the apex of the *next* stroke
/// (co-articulation, lift.c), falls with the speed asked for and no acceleration, and turns in the
/// predicted contact: from -v to e v in 7 ms. The ground swings back towards the player while the
/// tip rises, forward while it falls, and stands still before the touch. Invariant: position,
/// velocity and acceleration of the sum are continuous wherever nothing was measured.
#include "plan/stroke_plan.h"

#define RESTITUTION 0.85
#define STANDSTILL 0.06    // ground stands still before a touch (s)
#define LEAST_CHUNK 0.02   // no stroke is (s)
#define FASTEST_FALL 9.0   // mean speed of a fall (m/s)
#define HARDEST_MOVE 250.0 // peak acceleration along the ground (m/s^2)
#define GENTLE_MOVE 12.0   // (m/s^2)
#define QUICK_MOVE 80.0    // (m/s^2)
#define RAISED_TIME 0.115  // a raised stick falls at once (s)
#define ABSORB 0.02        // in which the acceleration a contact left dies out (s)
#define KNOTS 5            // of a unit's fall
#define MOST_PIECES 16     // of a chunk
#define LONGEST_COAST 0.3  // way a tip would go by its speed before it is halted (m) ...
#define LONGEST_HALT 0.15  // ... and goes meanwhile (m)
#define SWING_PEAK 60.0    // acceleration of the swing behind the spot (m/s^2)

static himc_target sum(himc_target a, himc_target b)
{
    return (himc_target){himc_vec3_add(a.x, b.x), himc_vec3_add(a.v, b.v), himc_vec3_add(a.a, b.a)};
}

/// The state at the plan's end in the frame of a head.
static chunk frame(const himc_hand_plan *plan, himc_vec3 spot, himc_vec3 n)
{
    himc_target s = himc_hand_at(plan, plan->end);
    chunk c = {.n = n, .lift_end = plan->end, .ground_end = plan->end};
    c.at.h = himc_vec3_dot(n, himc_vec3_sub(s.x, spot));
    c.at.v = himc_vec3_dot(n, s.v);
    c.at.a = himc_vec3_dot(n, s.a);
    c.on = difference(s, along(n, c.at.h, c.at.v, c.at.a));
    return c;
}

static chunk chunk_begin(himc_hand_plan *plan, himc_vec3 spot, himc_vec3 n)
{
    chunk c = frame(plan, spot, n);
    c.plan = plan;
    return c;
}

static void ground_piece(chunk *c, double t, himc_vec3 x)
{
    himc_target to = still(x);
    himc_spline_add(&c->plan->ground, c->ground_end, &c->on, t, &to);
    c->ground_end = t;
    c->on = to;
}

/// A tip that is fast and has time halts first: one long quintic would carry it far off.
static void ground_to(chunk *c, double t, himc_vec3 x)
{
    double T = t - c->ground_end;
    if (T <= 0)
        return;
    double speed = himc_vec3_length(c->on.v);
    if (speed * T > LONGEST_COAST) {
        double halt = fmin(fmin(0.12, 0.4 * T), 2 * LONGEST_HALT / speed);
        ground_piece(c, c->ground_end + halt, himc_vec3_madd(c->on.x, 0.5 * halt, c->on.v));
    }
    ground_piece(c, t, x);
}

static void chunk_finish(chunk *c)
{
    c->plan->end = c->lift_end;
    ground_to(c, c->lift_end, c->on.x);
}

/// The ground: to behind the spot while the tip rises, forward while it falls, still before the
/// touch.
static void swing(chunk *c, const himc_goal *goal, const himc_gesture *g, double begin)
{
    if (c->plan->away)
        ground_to(c, begin, c->on.x);
    double span = goal->time - c->ground_end;
    double forward = fmin(fmax(g->down, 0.2), 0.55 * span);
    double back_at = goal->time - forward, quiet = fmin(STANDSTILL, 0.3 * forward);
    himc_vec3 spot = goal->spot;
    double shorter = fmin(forward - quiet, back_at - c->ground_end);
    double depth = fmin(g->depth, SWING_PEAK / HIMC_MOVE_PEAK * shorter * shorter);
    himc_vec3 behind = himc_vec3_madd(spot, depth, goal->back);
    double off = himc_vec3_length(himc_vec3_sub(c->on.x, spot));
    // with no time to go back and forth, straight there
    if (span < 0.2 && off > depth)
        back_at = c->ground_end;
    if (back_at - c->ground_end > 1.1) {
        ground_to(c, c->ground_end + 0.65, himc_vec3_madd(spot, 0.3 * depth, goal->back));
        ground_to(c, back_at - 0.45, himc_vec3_madd(spot, 0.35 * depth, goal->back));
    }
    ground_to(c, back_at, behind);
    ground_to(c, goal->time - quiet, spot);
    ground_to(c, goal->time, spot);
}

void himc_hand_place(himc_hand_plan *plan, double t, himc_vec3 home)
{
    *plan = (himc_hand_plan){.home = home, .end = t, .away = true};
    plan->last = (himc_goal){.time = -1e9, .spot = home, .normal = {0, 0, 1}, .back = {-1, 0, 0}};
    himc_target at = still(home), nothing = {0};
    plan->end = t + 0.5;
    himc_spline_add(&plan->ground, t, &at, plan->end, &at);
    himc_spline_add(&plan->lift, t, &nothing, plan->end, &nothing);
}

himc_target himc_hand_at(const himc_hand_plan *plan, double t)
{
    return sum(himc_spline_at(&plan->ground, t), himc_spline_at(&plan->lift, t));
}

void himc_hand_cut(himc_hand_plan *plan, double t)
{
    if (t >= plan->end)
        return;
    t = fmax(t, plan->ground.segment[0].t0);
    himc_spline_cut(&plan->ground, t);
    himc_spline_cut(&plan->lift, t);
    plan->end = t;
    plan->struck = false;
    himc_target s = himc_hand_at(plan, t);
    plan->away = plan->away && himc_vec3_length(s.v) < 1e-6 && himc_vec3_length(s.a) < 1e-6;
}

void himc_hand_restart(himc_hand_plan *plan, double t, const himc_target *state, double next)
{
    double T = fmin(ABSORB, fmax(0.2 * (next - t), 0.001));
    himc_hand_cut(plan, t);
    himc_target on = {himc_vec3_madd(state->x, T, state->v), state->v, {0, 0, 0}};
    himc_target nothing = {0};
    himc_spline_add(&plan->ground, t, state, t + T, &on);
    himc_spline_add(&plan->lift, t, &nothing, t + T, &nothing);
    plan->end = t + T;
    plan->struck = true;
    plan->away = false;
}

bool himc_hand_room(const himc_hand_plan *plan)
{
    int most = plan->ground.count > plan->lift.count ? plan->ground.count : plan->lift.count;
    return most + MOST_PIECES <= HIMC_SPLINE_SEGMENTS;
}

static double distance_to(const chunk *c, const himc_goal *goal)
{
    return himc_vec3_length(himc_vec3_sub(goal->spot, c->on.x));
}

double himc_hand_time(const himc_hand_plan *plan, const himc_goal *goal)
{
    chunk c = frame(plan, goal->spot, goal->normal);
    double T = himc_gesture_time(&goal->gesture, c.at.h);
    double move = himc_move_time(distance_to(&c, goal), GENTLE_MOVE) + goal->gesture.down;
    return fmax(T, fmax(move, plan->away ? 0.4 : 0));
}

double himc_hand_least_time(const himc_hand_plan *plan, const himc_goal *goal)
{
    chunk c = frame(plan, goal->spot, goal->normal);
    double T = 0.7 * himc_gesture_time(&goal->gesture, c.at.h);
    if (c.at.h >= 0.6 * goal->gesture.height)
        T = fmin(T, RAISED_TIME);
    T = fmax(T, SLOWEST_FALL * c.at.h / goal->gesture.speed); // a soft stroke does not fall fast
    return fmax(fmax(T, RAISED_TIME), 1.4 * himc_move_time(distance_to(&c, goal), QUICK_MOVE));
}

/// Whether anyone could be there in time.
static bool playable(const chunk *c, const himc_goal *goal)
{
    double T = goal->time - c->lift_end;
    if (!(T >= LEAST_CHUNK) || c->at.h / T > FASTEST_FALL)
        return false;
    return 1.4 * himc_move_time(distance_to(c, goal), HARDEST_MOVE) <= T;
}

bool himc_hand_can_strike(const himc_hand_plan *plan, const himc_goal *goal)
{
    chunk c = frame(plan, goal->spot, goal->normal);
    return playable(&c, goal);
}

/// A strong rebound with little time left is not fought: the stroke goes as high as the rebound
/// takes it.
static void go_with(const chunk *c, double t, himc_gesture *g)
{
    double T = t - c->lift_end, rise_time = T - g->down - g->dwell;
    if (c->at.v < 0.3 || rise_time > 0.25 || c->at.h + c->at.v * rise_time / 2.4 < g->height)
        return;
    g->dwell = 0;
    g->down = 0.65 * T;
    g->height = c->at.h + c->at.v * (T - g->down) / 2.4;
    g->speed = fmin(fmax(g->speed, 0.8 * g->height / g->down), 2.4 * g->height / g->down);
}

/// The fall from the top: one quintic, or through the knots of a unit's.
static void fall(chunk *c, double t, const himc_gesture *g, bool from_top)
{
    double landing = g->speed * g->down / g->height;
    for (int k = 1; g->unit && from_top && k < KNOTS; k++) {
        double f[3], u = (double)k / KNOTS;
        himc_unit_at(g->unit, u, landing, f);
        chunk_height knot = {g->height * f[0], g->height * f[1] / g->down,
                             g->height * f[2] / (g->down * g->down)};
        himc_stroke_plan_lift_to(c, t - g->down * (1 - u), knot);
    }
    himc_stroke_plan_lift_to(c, t, (chunk_height){0, -g->speed, 0});
}

bool himc_hand_strike(himc_hand_plan *plan, const himc_goal *goal)
{
    chunk c = chunk_begin(plan, goal->spot, goal->normal);
    if (!playable(&c, goal))
        return false;
    himc_gesture g = goal->gesture;
    double begin = c.lift_end;
    c.approach = fmax(0.5, himc_move_time(distance_to(&c, goal), GENTLE_MOVE));
    bool from_top = !himc_stroke_plan_falls(&c, goal->time, &g);
    if (from_top) {
        g = himc_gesture_squeeze(goal->gesture, goal->time - plan->end, c.at.h);
        go_with(&c, goal->time, &g);
        double top = goal->time - g.down - g.dwell;
        begin = himc_stroke_plan_rise(&c, top, &g);
        if (c.at.a == 0)
            himc_stroke_plan_lift_to(&c, top + g.dwell, c.at);
    }
    fall(&c, goal->time, &g, from_top);
    himc_stroke_plan_lift_to(&c, goal->time + HIMC_CONTACT_TIME,
                             (chunk_height){0, RESTITUTION * g.speed, 0});
    swing(&c, goal, &g, begin);
    chunk_finish(&c);
    plan->last = *goal;
    plan->last.gesture = g;
    plan->struck = true;
    plan->away = false;
    return true;
}

/// Moves to a place in space; what way the tip has is first taken from it if it would touch the
/// head.
static void go(chunk *c, himc_vec3 x, double gentle)
{
    himc_vec3 n = c->n;
    chunk_height to = {himc_vec3_dot(n, himc_vec3_sub(x, c->plan->last.spot)), 0, 0};
    double distance = himc_vec3_length(himc_vec3_sub(x, himc_hand_at(c->plan, c->plan->end).x));
    double T = fmax(himc_move_time(distance, gentle), 0.06);
    if (c->at.v < -0.3 &&
        !himc_stroke_plan_stays(c, c->lift_end + T, to, fmin(to.h, 0.5 * c->at.h), HUGE_VAL))
        himc_stroke_plan_brake(c, c->lift_end + 1);
    himc_stroke_plan_lift_to(c, c->lift_end + T, to);
    ground_to(c, c->lift_end, himc_vec3_madd(x, -to.h, n));
}

void himc_hand_reach(himc_hand_plan *plan, himc_vec3 x)
{
    chunk c = chunk_begin(plan, plan->last.spot, plan->last.normal);
    go(&c, x, QUICK_MOVE);
    chunk_finish(&c);
    plan->home = x;
    plan->away = true;
    plan->struck = false;
}

/// Over the last spot: comes down to where a hand waits, or sways a little there.
static void hover(chunk *c)
{
    bool low = c->at.h < LOW + 2 * SWAY && c->at.h > 0.05;
    double side = c->plan->swayed ? -1 : 1;
    himc_vec3 x =
        himc_vec3_madd(c->on.x, low ? side * SWAY : 0.1, low ? c->plan->last.back : c->on.v);
    c->plan->swayed = !c->plan->swayed;
    himc_stroke_plan_lift_to(c, c->lift_end + (low ? 1 : 0.6),
                             (chunk_height){LOW + (low ? side * SWAY / 2 : 0), 0, 0});
    ground_to(c, c->lift_end, x);
}

void himc_hand_wait(himc_hand_plan *plan, double until, bool ready)
{
    chunk c = chunk_begin(plan, plan->last.spot, plan->last.normal);
    if (c.at.v > 0.3)
        himc_stroke_plan_rebound(&c, c.lift_end + 2, 0.9);
    else if (c.at.v < -0.3)
        himc_stroke_plan_brake(&c, c.lift_end + 1);
    plan->struck = false;
    if (plan->away) {
        himc_stroke_plan_lift_to(&c, fmax(until, c.lift_end + 0.5), (chunk_height){c.at.h, 0, 0});
        ground_to(&c, c.lift_end, c.on.x);
    } else if (ready) {
        hover(&c);
    } else {
        go(&c, plan->home, GENTLE_MOVE / 8);
        plan->away = true;
    }
    chunk_finish(&c);
}
