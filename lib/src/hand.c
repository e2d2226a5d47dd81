/// hand.c: how a tip gets from anywhere to its next touch, as a timpanist's does.
///
/// A chunk is planned in the frame of the head it goes to: the height along the normal n, and the ground, the rest. The height
/// rises from the rebound to the apex of the *next* stroke (co-articulation), falls with the speed asked for and no
/// acceleration, and turns in the predicted contact: from -v to e v in 7 ms. With little time the rise is one quintic;
/// with more, the rebound goes as high as its nuance makes it and floats up; with much, the tip sinks, waits low and
/// is raised again. The ground swings back towards the player while the tip rises, forward while it falls, and stands
/// still before the touch. A trial quintic is sampled: if it would dip or overshoot the motion is braked first.
/// Invariant: position, velocity and acceleration of the sum are continuous wherever nothing was measured.
#include "hand.h"

#define RESTITUTION 0.85
#define STANDSTILL 0.06     // ground stands still before a touch (s)
#define LEAST_DOWN 0.012    // no lift is planned in less (s)
#define LEAST_CHUNK 0.02    // no stroke is (s)
#define FASTEST_FALL 9.0    // mean speed of a fall (m/s)
#define HARDEST_MOVE 250.0  // peak acceleration along the ground (m/s^2)
#define HURRIED_RISE 0.12   // shorter rises are one quintic (s)
#define SINK_TIME 0.5       // spare time after which a tip sinks (s)
#define LOW 0.12            // where it waits (m)
#define SWAY 0.008          // (m)
#define GENTLE_MOVE 12.0    // (m/s^2)
#define QUICK_MOVE 80.0     // (m/s^2)
#define RAISED_TIME 0.115   // a raised stick falls at once (s)
#define ABSORB 0.02         // in which the acceleration a contact left dies out (s)
#define MOST_PIECES 12      // of a chunk
#define MIN_JERK_PEAK 5.774 // peak acceleration of a minimum-jerk move, in D/T^2

/// Height and its derivatives along a normal.
typedef struct height {
    double h, v, a;
} height;

static himc_target along(himc_vec3 n, double h, double v, double a)
{
    return (himc_target){himc_vec3_scale(n, h), himc_vec3_scale(n, v), himc_vec3_scale(n, a)};
}

static himc_target still(himc_vec3 x)
{
    return (himc_target){x, {0, 0, 0}, {0, 0, 0}};
}

static himc_target sum(himc_target a, himc_target b)
{
    return (himc_target){himc_vec3_add(a.x, b.x), himc_vec3_add(a.v, b.v), himc_vec3_add(a.a, b.a)};
}

static himc_target difference(himc_target a, himc_target b)
{
    return (himc_target){himc_vec3_sub(a.x, b.x), himc_vec3_sub(a.v, b.v), himc_vec3_sub(a.a, b.a)};
}

/// The chunk being built: its frame and where its two chains have got to.
typedef struct chunk {
    himc_hand_plan *plan;
    himc_vec3 n;
    double lift_end, ground_end;
    height at;
    himc_target on;
    double approach; ///< time to come from far (s)
} chunk;

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

static himc_piece trial(const chunk *c, double t, height to)
{
    himc_target a = along(c->n, c->at.h, c->at.v, c->at.a), b = along(c->n, to.h, to.v, to.a);
    return himc_piece_make(c->lift_end, &a, t, &b);
}

static void lift_to(chunk *c, double t, height to)
{
    if (t <= c->lift_end)
        return;
    himc_target a = along(c->n, c->at.h, c->at.v, c->at.a), b = along(c->n, to.h, to.v, to.a);
    himc_chain_add(&c->plan->lift, c->lift_end, &a, t, &b);
    c->lift_end = t;
    c->at = to;
}

static void ground_to(chunk *c, double t, himc_vec3 x)
{
    if (t <= c->ground_end)
        return;
    himc_target to = still(x);
    himc_chain_add(&c->plan->ground, c->ground_end, &c->on, t, &to);
    c->ground_end = t;
    c->on = to;
}

static void chunk_finish(chunk *c)
{
    c->plan->end = c->lift_end;
    ground_to(c, c->lift_end, c->on.x);
}

/// Whether the way to a height stays within bounds.
static bool stays(const chunk *c, double t, height to, double low, double high)
{
    himc_piece piece = trial(c, t, to);
    for (int i = 1; i < 16; i++) {
        double at = piece.t0 + (t - piece.t0) * i / 16;
        double h = himc_vec3_dot(c->n, himc_piece_at(&piece, at).x);
        if (h < low || h > high)
            return false;
    }
    return true;
}

/// Comes to a halt from whatever the height is doing, before `limit`.
static void brake(chunk *c, double limit)
{
    double h = c->at.h, v = c->at.v;
    double T = v < 0 ? fmin(0.12, 1.2 * fmax(h, 0.02) / -v) : 0.12;
    T = fmin(fmax(T, 0.02), 0.5 * (limit - c->lift_end));
    double stop = fmax(h + 0.5 * v * T, 0.2 * h);
    lift_to(c, c->lift_end + T, (height){stop, 0, 0});
}

/// The rebound as its nuance makes it: how high, how fast, and with what speed it floats on to `next`.
static void rebound(chunk *c, double top, double next)
{
    const himc_gesture *g = &c->plan->last.gesture;
    double h = c->at.h, v = c->at.v;
    double high = g->rebound * g->height;
    if (!c->plan->struck)
        high = h; // a rise that was broken off: only halt it
    if (high > next)
        high = next;
    high = fmax(high, h + v * 0.09 / 2.2);
    double pull = c->plan->struck ? g->pull : 2.0;
    double T = fmin(fmax(pull * (high - h) / v, 0.08), 0.3);
    T = fmin(T, 0.75 * (top - c->lift_end));
    high = fmin(fmax(high, h + v * T / 2.4), fmax(h, 0.9));
    double rest = top - c->lift_end - T;
    double on = 0;
    if (next > high && rest < SINK_TIME)
        on = fmin(1.5 * (next - high) / rest, 0.5 * v);
    lift_to(c, c->lift_end + T, (height){high, on, 0});
}

/// Sinks, waits low and is raised again, if there is time for that; returns when the last rise begins.
static double sink(chunk *c, double top, double next)
{
    double spare = top - c->lift_end;
    double raise = fmin(0.45, 0.5 * spare);
    if (c->plan->away) {
        lift_to(c, top - fmin(c->approach, spare), (height){c->at.h, 0, 0});
        return c->lift_end;
    }
    if (spare <= SINK_TIME)
        return c->lift_end;
    double low = fmax(fmin(LOW, 0.9 * next), 0.05);
    low += (c->at.h - low) * (1 - fmin((spare - SINK_TIME) / 0.5, 1));
    double settle = fmin(0.6, 0.5 * spare);
    lift_to(c, c->lift_end + settle, (height){low, 0, 0});
    if (top - raise - c->lift_end > 0.05)
        lift_to(c, top - raise, (height){low + SWAY, 0, 0});
    return top - raise;
}

/// The longest rise that is one quintic (s): not slower than the way is long, nor than the last nuance has it.
static double single_rise(const chunk *c, double high)
{
    const himc_gesture *last = &c->plan->last.gesture;
    if (c->at.v <= 0.3)
        return SINK_TIME;
    double longest = 2.6 * fmax(high - c->at.h, 0.01) / c->at.v;
    if (!c->plan->struck)
        return longest;
    return fmin(longest, 1.5 * last->pull * last->rebound * last->height / c->at.v);
}

/// From the chunk's start to the apex of the stroke at time `top`; returns when the preparation began.
static double rise(chunk *c, double top, const himc_gesture *g)
{
    height apex = {g->height, 0, -g->arc * g->height / (g->down * g->down)};
    if (g->dwell > 0.01)
        apex.a = 0;
    double begin = c->lift_end, high = fmax(g->height, c->at.h);
    if (c->at.v < -0.3)
        brake(c, top);
    bool moving = c->at.v > 0.3;
    bool single = top - begin < HURRIED_RISE ||
                  (top - begin <= single_rise(c, g->height) &&
                  stays(c, top, apex, fmin(c->at.h, g->height) - 0.004, 1.04 * high + 0.004));
    if (!single) {
        if (moving)
            rebound(c, top, g->height);
        begin = sink(c, top, g->height);
        if (c->at.v == 0 && top - c->lift_end > 1.5 * g->down)
            apex.a = 0;
    }
    if (!stays(c, top, apex, fmin(c->at.h, g->height) - 0.004, 1.04 * high + 0.004))
        apex.a = 0;
    lift_to(c, top, apex);
    return begin;
}

/// Whether the tip may simply fall from where it is, and how fast it then lands.
static bool falls(const chunk *c, double t, himc_gesture *g)
{
    double T = t - c->lift_end, h = c->at.h;
    bool hurried = T < g->down + 0.5 * g->lift;
    if (h <= 0.01 || !hurried || (c->at.v > -0.2 && h < 0.6 * g->height && T > LEAST_DOWN))
        return false;
    g->speed = fmin(fmax(g->speed, 1.2 * h / T), 2.4 * h / T);
    g->height = h;
    return stays(c, t, (height){0, -g->speed, 0}, -1e-6, 1.1 * h + 0.02);
}

/// The ground: to behind the spot while the tip rises, forward while it falls, still before the touch.
static void swing(chunk *c, const himc_goal *goal, const himc_gesture *g, double begin)
{
    double span = goal->time - c->ground_end;
    double forward = fmin(fmax(g->down, 0.2), 0.55 * span);
    double back_at = goal->time - forward, quiet = fmin(STANDSTILL, 0.3 * forward);
    himc_vec3 spot = goal->spot;
    himc_vec3 behind = himc_vec3_madd(spot, g->depth, goal->back);
    if (c->plan->away)
        ground_to(c, begin, c->on.x);
    if (back_at - c->ground_end > 1.1) {
        ground_to(c, c->ground_end + 0.65, himc_vec3_madd(spot, 0.3 * g->depth, goal->back));
        ground_to(c, back_at - 0.45, himc_vec3_madd(spot, 0.35 * g->depth, goal->back));
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
    himc_chain_add(&plan->ground, t, &at, plan->end, &at);
    himc_chain_add(&plan->lift, t, &nothing, plan->end, &nothing);
}

himc_target himc_hand_at(const himc_hand_plan *plan, double t)
{
    return sum(himc_chain_at(&plan->ground, t), himc_chain_at(&plan->lift, t));
}

void himc_hand_cut(himc_hand_plan *plan, double t)
{
    if (t >= plan->end)
        return;
    t = fmax(t, plan->ground.piece[0].t0);
    himc_chain_cut(&plan->ground, t);
    himc_chain_cut(&plan->lift, t);
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
    himc_chain_add(&plan->ground, t, state, t + T, &on);
    himc_chain_add(&plan->lift, t, &nothing, t + T, &nothing);
    plan->end = t + T;
    plan->struck = true;
    plan->away = false;
}

bool himc_hand_room(const himc_hand_plan *plan)
{
    int most = plan->ground.count > plan->lift.count ? plan->ground.count : plan->lift.count;
    return most + MOST_PIECES <= HIMC_CHAIN_PIECES;
}

static double distance_to(const chunk *c, const himc_goal *goal)
{
    return himc_vec3_length(himc_vec3_sub(goal->spot, c->on.x));
}

static double move_time(double distance, double acceleration)
{
    return sqrt(MIN_JERK_PEAK * distance / acceleration);
}

double himc_hand_time(const himc_hand_plan *plan, const himc_goal *goal)
{
    chunk c = frame(plan, goal->spot, goal->normal);
    double T = himc_gesture_time(&goal->gesture, c.at.h);
    double move = move_time(distance_to(&c, goal), GENTLE_MOVE) + goal->gesture.down;
    return fmax(T, fmax(move, plan->away ? 0.4 : 0));
}

double himc_hand_least_time(const himc_hand_plan *plan, const himc_goal *goal)
{
    chunk c = frame(plan, goal->spot, goal->normal);
    double T = 0.7 * himc_gesture_time(&goal->gesture, c.at.h);
    if (c.at.h >= 0.6 * goal->gesture.height)
        T = fmin(T, RAISED_TIME);
    return fmax(fmax(T, RAISED_TIME), 1.4 * move_time(distance_to(&c, goal), QUICK_MOVE));
}

/// Whether anyone could be there in time.
static bool playable(const chunk *c, const himc_goal *goal)
{
    double T = goal->time - c->lift_end;
    if (!(T >= LEAST_CHUNK) || c->at.h / T > FASTEST_FALL)
        return false;
    return 1.4 * move_time(distance_to(c, goal), HARDEST_MOVE) <= T;
}

/// A strong rebound with little time left is not fought: the stroke goes as high as the rebound takes it.
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

bool himc_hand_strike(himc_hand_plan *plan, const himc_goal *goal)
{
    chunk c = chunk_begin(plan, goal->spot, goal->normal);
    if (!playable(&c, goal))
        return false;
    himc_gesture g = himc_gesture_squeeze(goal->gesture, goal->time - plan->end, c.at.h);
    go_with(&c, goal->time, &g);
    double begin = c.lift_end;
    c.approach = fmax(0.5, move_time(distance_to(&c, goal), GENTLE_MOVE));
    if (!falls(&c, goal->time, &g)) {
        double top = goal->time - g.down - g.dwell;
        begin = rise(&c, top, &g);
        if (c.at.a == 0)
            lift_to(&c, top + g.dwell, c.at);
    }
    lift_to(&c, goal->time, (height){0, -g.speed, 0});
    lift_to(&c, goal->time + HIMC_CONTACT_TIME, (height){0, RESTITUTION * g.speed, 0});
    swing(&c, goal, &g, begin);
    chunk_finish(&c);
    plan->last = *goal;
    plan->last.gesture = g;
    plan->struck = true;
    plan->away = false;
    return true;
}

/// Moves to a place in space; what way the tip has is first taken from it if it would touch the head.
static void go(chunk *c, himc_vec3 x, double gentle)
{
    himc_vec3 n = c->n;
    height to = {himc_vec3_dot(n, himc_vec3_sub(x, c->plan->last.spot)), 0, 0};
    double distance = himc_vec3_length(himc_vec3_sub(x, himc_hand_at(c->plan, c->plan->end).x));
    double T = fmax(move_time(distance, gentle), 0.06);
    if (c->at.v < -0.3 && !stays(c, c->lift_end + T, to, fmin(to.h, 0.5 * c->at.h), HUGE_VAL))
        brake(c, c->lift_end + 1);
    lift_to(c, c->lift_end + T, to);
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
    himc_vec3 x = himc_vec3_madd(c->on.x, low ? side * SWAY : 0.1, low ? c->plan->last.back : c->on.v);
    c->plan->swayed = !c->plan->swayed;
    lift_to(c, c->lift_end + (low ? 1 : 0.6), (height){LOW + (low ? side * SWAY / 2 : 0), 0, 0});
    ground_to(c, c->lift_end, x);
}

void himc_hand_wait(himc_hand_plan *plan, double until, bool ready)
{
    chunk c = chunk_begin(plan, plan->last.spot, plan->last.normal);
    if (c.at.v > 0.3)
        rebound(&c, c.lift_end + 2, 0.9);
    else if (c.at.v < -0.3)
        brake(&c, c.lift_end + 1);
    plan->struck = false;
    if (plan->away) {
        lift_to(&c, fmax(until, c.lift_end + 0.5), (height){c.at.h, 0, 0});
        ground_to(&c, c.lift_end, c.on.x);
    } else if (ready) {
        hover(&c);
    } else {
        go(&c, plan->home, GENTLE_MOVE / 8);
        plan->away = true;
    }
    chunk_finish(&c);
}
