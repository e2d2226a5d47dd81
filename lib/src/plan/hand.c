/// hand.c: the way of a tip from any state to its next touch, as a timpanist's tip goes.
///
/// A stroke is planned in the frame of its head: the height along the normal n, and the tangential
/// path, the rest. The height rises from the rebound to the apex of the *next* stroke
/// (co-articulation, height_profile.c), falls to the touch with the speed asked for and no
/// acceleration, and reverses in the predicted contact: from -v to e v in 9 ms. The tangential path
/// swings back towards the player while the tip rises, forward while it falls, and stands still
/// before the touch. Invariant: position, velocity and acceleration of the sum are continuous
/// wherever nothing was measured.
#include "plan/stroke_plan.h"

/// Restitution of the predicted contact, only until the measured state replaces the prediction at
/// separation. Chosen: simulated strokes of 0.9 to 5 m/s leave with .77 to .86 of their speed.
#define PREDICTED_RESTITUTION 0.82
#define BOUNCE_RATIO 0.5 // of the speeds of the last bounce and the stroke; chosen, as above

// limits of a hand: beyond them a stroke is refused; chosen: well beyond captured strokes
// (impacts of up to 10 m/s), so that only the impossible is refused
#define LEAST_STROKE_TIME 0.02 // from the plan's end to the touch (s)
#define FASTEST_FALL 9.0       // mean speed of a fall (m/s)

#define SOUND_SAMPLES \
    4 // intervals of a quintic where its speed is looked at; chosen: it turns 4 times

// over the other hand; chosen: as a wrist lifts a stick in a hurry, and sooner than any new touch
#define LIFT_FADE 0.1  // of a lift that is broken off (s) ...
#define LIFT_SHARE 0.8 // ... but no more than this share of the time to a touch

// habits of a hand; chosen by eye
#define GENTLE_MOVE 12.0        // peak acceleration of a move with time (m/s^2)
#define HOME_MOVE 1.5           // ... and of the way home, when there is nothing to play (m/s^2)
#define MOVE_MARGIN 1.4         // a stroke's swing takes so much longer than a straight move
#define HURRY_SHARE 0.7         // of the unhurried time that a hurried gesture takes at least
#define RAISED_SHARE 0.45       // a stick at this share of the stroke's height counts as raised ...
#define RAISED_TIME 0.115       // ... and can fall at once (s)
#define LEAVE_HOME_TIME 0.4     // a tip at home takes at least so long to its stroke (s)
#define LEAST_APPROACH_TIME 0.5 // ... and begins so much before its rise, at least (s)
#define LEAST_MOVE_TIME 0.06    // of a move in space (s)
#define MOVE_OVER 0.05          // its height over both ends, at most (m)

// the swing: times and distances along the head; chosen: the order of depths of the five nuances
// (Bouënard, Gibet & Wanderley 2012, section 3) holds at every dynamic and tempo
#define STILL_TIME 0.06       // the path stands still before a touch (s) ...
#define STILL_SHARE 0.3       // ... but for no more than this share of the way forward
#define FORWARD_TIME 0.2      // the way forward takes as long as the fall, at least this (s) ...
#define FORWARD_SHARE 0.55    // ... but no more than this share of the time there is
#define SWING_PEAK 60.0       // peak acceleration of the swing behind the spot (m/s^2)
#define NEAREST_SWING 0.24    // ... which comes no nearer to the body's axis than a face (m)
#define STRAIGHT_TIME 0.2     // with less time a tip off its spot goes straight there (s)
#define IDLE_TIME 1.4         // with more time the tip first waits behind the spot (s) ...
#define IDLE_ARRIVAL 0.65     // ... coming there in this time (s) ...
#define IDLE_DEPTH 0.3        // ... at this share of the swing's depth ...
#define IDLE_DEPARTURE 0.45   // ... and leaving so long before the swing's end (s) ...
#define IDLE_DEPTH_LATER 0.35 // ... from this share: a drift of .3 s or more, no frozen hand

// a tip that is fast along the head, but not to its goal, halts first; chosen: see the test of a
// tip thrown at 16 m/s
#define COAST_LIMIT 0.3 // way its speed would carry it off before it is halted (m) ...
#define HALT_WAY 0.15   // ... and way it goes meanwhile, at most (m)
#define HALT_TIME 0.12  // a halt takes no more than this (s) ...
#define HALT_SHARE 0.4  // ... and no more than this share of the time there is
#define ON_THE_WAY 2.5  // mean speeds from which a quintic comes to rest and does not pass its goal

/// Time in which the acceleration that a contact left fades (s). Chosen: long beside a contact.
#define ABSORB_TIME 0.02
#define ABSORB_SHARE 0.2        // ... but no more than this share of the time to the next touch
#define LEAST_ABSORB_TIME 0.001 // (s)

// a strong rebound that is followed rather than fought; chosen: no reversal within a quarter second
#define FOLLOW_TIME 0.25       // rises longer than this are shaped, not followed (s)
#define FOLLOW_FALL_SHARE 0.65 // of the time: the fall after such a rise, at most

/// Speed for which a tip from rest has time, over that time (m/s^2). Chosen: twice what is asked of
/// it, so that only what comes late softens a stroke: a new tempo, a disturbance.
#define FASTEST_HURRY (2 * HIMC_HURRY)

// the wait over the last spot; chosen: a slow sway of one or two centimetres looks alive
#define HOVER_LEAST_HEIGHT 0.05 // lower tips are raised first (m)
#define HOVER_TIME 1.0          // one sway (s)
#define HOVER_ARRIVAL 0.6       // coming to the waiting height (s)
#define FREE_REBOUND_TIME 2.0   // a rebound with nothing after it has so much time (s)
#define BRAKE_LIMIT 1.0         // a halt with nothing after it has so much time (s)
#define BREAK_OFF 5.0           // a stroke broken off with more acceleration is halted (m/s^2)
#define HOME_WAIT 0.5           // a wait at home lasts this long at least (s)

/// A long way bows out round the body, so that it comes no nearer to its axis, the world's z, than
/// this or the nearer end (m): an arm that is folded up whips its elbow. Chosen: farther out the
/// elbows are hardly slower, and the hands meet more often.
#define ROUND_BODY 0.62
#define ROUND_BODY_STRAIGHT 0.45 // of a way that does not bow out as far as it could
#define BOWS_FROM 0.3            // shorter ways are straight (m) ...
#define BOWS_MORE 0.4            // ... and ways so much longer bow out in full
#define BOW_PULL 24.0            // of 64 u^3 (1 - u)^3 in its middle (bows / time^2)

/// A far way takes all the time before the touch if it would be fast. Chosen: at most 3 m/s.
#define FAR_WAY 0.35 // (m)
#define FAST_WAY 1.6 // mean speed (m/s); a quintic's largest is 1.875 times that

/// A unit's fall is so many quintics. Chosen: more than its shape has numbers (himc_unit.bend).
#define UNIT_KNOTS 5
/// Segments of one spline for one stroke, at most: sink 3, rise 2, dwell, fall UNIT_KNOTS, contact,
/// and some to spare.
#define MOST_SEGMENTS 16

static himc_target unlifted_at(const himc_hand_plan *plan, double t)
{
    return himc_target_add(himc_spline_at(&plan->tangential_path, t),
                           himc_spline_at(&plan->height_profile, t));
}

/// The state at t in the frame of a head.
static stroke_plan frame_at(const himc_hand_plan *plan, double t, himc_vec3 spot, himc_vec3 n)
{
    himc_target now = unlifted_at(plan, t);
    stroke_plan s = {.n = n, .height_end = t, .path_end = t};
    s.height.h = himc_vec3_dot(n, himc_vec3_sub(now.x, spot));
    s.height.v = himc_vec3_dot(n, now.v);
    s.height.a = himc_vec3_dot(n, now.a);
    s.path = himc_target_sub(now, himc_target_along(n, s.height.h, s.height.v, s.height.a));
    return s;
}

static stroke_plan plan_begin(himc_hand_plan *plan, himc_vec3 spot, himc_vec3 n)
{
    stroke_plan s = frame_at(plan, plan->end, spot, n);
    s.plan = plan;
    return s;
}

static void path_segment(stroke_plan *s, double t, himc_vec3 x)
{
    himc_target to = himc_target_at_rest(x);
    himc_spline_add(&s->plan->tangential_path, s->path_end, &s->path, t, &to);
    s->path_end = t;
    s->path = to;
}

/// If the straight way to x leads near the body: the first half of one that bows out round it.
static void go_round_body(stroke_plan *s, double t, himc_vec3 x)
{
    himc_vec3 from = s->path.x, way = himc_vec3_sub(x, from), out = {1, 0, 0};
    double length = hypot(way.x, way.y), T = t - s->path_end;
    double share = length > 0 ? -(from.x * way.x + from.y * way.y) / (length * length) : 0;
    himc_vec3 beside = himc_vec3_madd(from, share, way);
    double away = hypot(beside.x, beside.y), far = (length - BOWS_FROM) / BOWS_MORE;
    double round = fmin(s->straight ? ROUND_BODY_STRAIGHT : ROUND_BODY,
                        fmin(hypot(from.x, from.y), hypot(x.x, x.y)));
    if (!(share > 0 && share < 1 && away < round && far > 0))
        return;
    far = fmin(far, 1);
    if (away > 0)
        out = himc_vec3_make(beside.x / away, beside.y / away, 0);
    if (out.x < 0) { // before him, not behind his back
        out = himc_vec3_scale(out, -1);
        away = -away;
    }
    double bow = far * far * (3 - 2 * far) * (round - away) * 4 * share * (1 - share);
    himc_target to = himc_target_at_rest(x);
    himc_spline_segment straight = himc_spline_segment_make(s->path_end, &s->path, t, &to);
    himc_target middle = himc_spline_segment_at(&straight, s->path_end + 0.5 * T);
    middle.x = himc_vec3_madd(middle.x, bow, out);
    middle.a = himc_vec3_madd(middle.a, -BOW_PULL * bow / (T * T), out);
    himc_spline_add(&s->plan->tangential_path, s->path_end, &s->path, s->path_end + 0.5 * T,
                    &middle);
    s->path_end += 0.5 * T;
    s->path = middle;
}

/// The tangential path to rest at x. A tip that is fast elsewhere and has time halts first: one
/// long quintic would carry it far off. Long ways lead round the body.
static void path_to(stroke_plan *s, double t, himc_vec3 x)
{
    double T = t - s->path_end;
    if (T <= 0)
        return;
    // how far the tip's speed would carry it off its way
    himc_vec3 way = himc_vec3_sub(x, s->path.x), coast = himc_vec3_scale(s->path.v, T);
    double square = himc_vec3_dot(way, way), along = himc_vec3_dot(coast, way);
    double share = square > 0 ? fmin(fmax(along / square, 0), ON_THE_WAY) : 0;
    if (himc_vec3_length(himc_vec3_madd(coast, -share, way)) > COAST_LIMIT) {
        double speed = himc_vec3_length(s->path.v);
        double halt = fmin(fmin(HALT_TIME, HALT_SHARE * T), 2 * HALT_WAY / speed);
        path_segment(s, s->path_end + halt, himc_vec3_madd(s->path.x, 0.5 * halt, s->path.v));
    }
    go_round_body(s, t, x);
    path_segment(s, t, x);
}

static void plan_finish(stroke_plan *s)
{
    s->plan->end = s->height_end;
    path_to(s, s->height_end, s->path.x);
}

/// The tangential path of a stroke: to behind the spot while the tip rises, forward while it falls,
/// still before the touch.
static void swing(stroke_plan *s, const himc_goal *goal, const himc_gesture *g, double begin)
{
    s->straight = goal->straight;
    if (s->plan->at_home)
        path_to(s, begin, s->path.x);
    double span = goal->time - s->path_end;
    double forward = fmin(fmax(g->down, FORWARD_TIME), FORWARD_SHARE * span);
    double back_at = goal->time - forward, still = fmin(STILL_TIME, STILL_SHARE * forward);
    himc_vec3 spot = goal->spot;
    double shorter = fmin(forward - still, back_at - s->path_end);
    double depth = fmin(g->depth, SWING_PEAK / HIMC_MOVE_PEAK * shorter * shorter);
    depth = fmin(depth, fmax(hypot(spot.x, spot.y) - NEAREST_SWING, 0));
    himc_vec3 behind = himc_vec3_madd(spot, depth, goal->back);
    double off = himc_vec3_length(himc_vec3_sub(s->path.x, spot));
    bool hurries = himc_move_time(off, HIMC_QUICK_MOVE) > back_at - s->path_end;
    bool far = off > FAR_WAY && off > FAST_WAY * (back_at - s->path_end);
    if ((span < STRAIGHT_TIME || hurries || far) && off > depth)
        back_at = s->path_end;
    if (back_at - s->path_end > IDLE_TIME) {
        path_to(s, s->path_end + IDLE_ARRIVAL,
                himc_vec3_madd(spot, IDLE_DEPTH * depth, goal->back));
        path_to(s, back_at - IDLE_DEPARTURE,
                himc_vec3_madd(spot, IDLE_DEPTH_LATER * depth, goal->back));
    }
    path_to(s, back_at, behind);
    path_to(s, goal->time - still, spot);
    path_to(s, goal->time, spot);
}

/// Appends a motion in space from t on, which is no stroke.
static void go(himc_hand_plan *plan, double t, const himc_target *from, double end,
               const himc_target *to)
{
    himc_target nothing = {0};
    himc_spline_add(&plan->tangential_path, t, from, end, to);
    himc_spline_add(&plan->height_profile, t, &nothing, end, &nothing);
    plan->end = end;
}

void himc_hand_place(himc_hand_plan *plan, double t, himc_vec3 home)
{
    *plan = (himc_hand_plan){.home = home, .at_home = true};
    plan->last = (himc_goal){.time = -1e9, .spot = home, .normal = {0, 0, 1}, .back = {-1, 0, 0}};
    himc_target at = himc_target_at_rest(home);
    go(plan, t, &at, t + HOME_WAIT, &at);
}

himc_target himc_hand_at(const himc_hand_plan *plan, double t)
{
    himc_target s = unlifted_at(plan, t);
    return plan->lift.count > 0 ? himc_target_add(s, himc_spline_at(&plan->lift, t)) : s;
}

/// A lift that goes on after `latest` is broken off at t, and over at `end`.
static void end_lift(himc_hand_plan *plan, double t, double latest, double end)
{
    himc_spline *lift = &plan->lift;
    himc_target nothing = {0}, now = himc_spline_at(lift, t);
    if (lift->count == 0 || lift->segment[lift->count - 1].t1 <= latest)
        return;
    if (t <= lift->segment[0].t0) {
        lift->count = 0;
        return;
    }
    himc_spline_cut(lift, t);
    himc_spline_add(lift, t, &now, end, &nothing);
}

bool himc_hand_lift(himc_hand_plan *plan, double begin, double from, double to, double end,
                    himc_vec3 way)
{
    himc_spline *lift = &plan->lift;
    double up = himc_move_time(himc_vec3_length(way), HIMC_QUICK_MOVE);
    himc_target nothing = {0}, raised = himc_target_at_rest(way);
    bool busy = lift->count > 0 && lift->segment[lift->count - 1].t1 > begin;
    bool in_time = from - begin >= up && end - to >= up;
    if (busy || lift->count + 3 > HIMC_SPLINE_SEGMENTS || !in_time)
        return false;
    himc_spline_add(lift, begin, &nothing, from, &raised);
    if (to > from)
        himc_spline_add(lift, from, &raised, to, &raised);
    himc_spline_add(lift, to, &raised, end, &nothing);
    return true;
}

void himc_hand_cut(himc_hand_plan *plan, double t)
{
    if (t >= plan->end)
        return;
    t = fmax(t, plan->tangential_path.segment[0].t0);
    himc_spline_cut(&plan->tangential_path, t);
    himc_spline_cut(&plan->height_profile, t);
    end_lift(plan, t, t, t + LIFT_FADE);
    plan->end = t;
    plan->rebounding = false;
    himc_target s = himc_hand_at(plan, t);
    plan->at_home = plan->at_home && himc_vec3_length(s.v) < 1e-6 && himc_vec3_length(s.a) < 1e-6;
}

static double absorb_time(double until_next)
{
    return fmin(ABSORB_TIME, fmax(ABSORB_SHARE * until_next, LEAST_ABSORB_TIME));
}

void himc_hand_restart(himc_hand_plan *plan, double t, const himc_target *state, double next)
{
    double T = absorb_time(next - t);
    himc_hand_cut(plan, t);
    plan->lift.count = 0; // the measured state contains it
    himc_target on = {himc_vec3_madd(state->x, T, state->v), state->v, {0, 0, 0}};
    go(plan, t, state, t + T, &on);
    plan->rebounding = true;
    plan->at_home = false;
}

/// Time in which the tip goes on as it left a predicted contact, if the plan ends with one (s): so
/// it will when it has been measured (himc_hand_restart).
static double leaving_time(const himc_hand_plan *plan, double next)
{
    bool leaves = plan->rebounding && plan->end == himc_goal_end(&plan->last);
    return leaves ? absorb_time(next - plan->end) : 0;
}

static void leave(himc_hand_plan *plan, double next)
{
    double T = leaving_time(plan, next);
    himc_target path = himc_spline_at(&plan->tangential_path, plan->end), to = path,
                rise = himc_spline_at(&plan->height_profile, plan->end), up = rise;
    if (T == 0)
        return;
    to.x = himc_vec3_madd(path.x, T, path.v);
    up.x = himc_vec3_madd(rise.x, T, rise.v);
    himc_spline_add(&plan->tangential_path, plan->end, &path, plan->end + T, &to);
    himc_spline_add(&plan->height_profile, plan->end, &rise, plan->end + T, &up);
    plan->end += T;
}

/// True if a spline is finite from then on and no faster than a tip can be, at SOUND_SAMPLES places
/// of each segment.
static bool is_sound(const himc_spline *spline, double from)
{
    for (const himc_spline_segment *s = spline->segment; s < spline->segment + spline->count; s++)
        for (int i = 0; s->t1 > from && i <= SOUND_SAMPLES; i++) {
            himc_target at = himc_spline_segment_at(s, s->t0 + (s->t1 - s->t0) * i / SOUND_SAMPLES);
            if (!himc_target_finite(&at) || himc_vec3_length(at.v) > HIMC_FASTEST_TIP)
                return false;
        }
    return true;
}

bool himc_hand_is_sound(const himc_hand_plan *plan, double from)
{
    return isfinite(plan->end) && is_sound(&plan->tangential_path, from) &&
           is_sound(&plan->height_profile, from) && is_sound(&plan->lift, from);
}

bool himc_hand_room(const himc_hand_plan *plan)
{
    int path = plan->tangential_path.count, height = plan->height_profile.count;
    return (path > height ? path : height) + MOST_SEGMENTS <= HIMC_SPLINE_SEGMENTS;
}

static double distance_to(const stroke_plan *s, const himc_goal *goal)
{
    return himc_vec3_length(himc_vec3_sub(goal->spot, s->path.x));
}

double himc_hand_time(const himc_hand_plan *plan, const himc_goal *goal)
{
    stroke_plan s = frame_at(plan, plan->end, goal->spot, goal->normal);
    double T = himc_gesture_time(&goal->gesture, s.height.h);
    double move = himc_move_time(distance_to(&s, goal), GENTLE_MOVE) + goal->gesture.down;
    return fmax(T, fmax(move, plan->at_home ? LEAVE_HOME_TIME : 0));
}

double himc_hand_least_time(const himc_hand_plan *plan, const himc_goal *goal)
{
    stroke_plan s = frame_at(plan, plan->end, goal->spot, goal->normal);
    double T = HURRY_SHARE * himc_gesture_time(&goal->gesture, s.height.h);
    if (s.height.h >= RAISED_SHARE * goal->gesture.height)
        T = fmin(T, RAISED_TIME);
    // a soft stroke does not fall fast
    T = fmax(T, HIMC_LEAST_LANDING * s.height.h / goal->gesture.speed);
    return fmax(fmax(T, RAISED_TIME),
                MOVE_MARGIN * himc_move_time(distance_to(&s, goal), HIMC_QUICK_MOVE));
}

static bool is_possible(const stroke_plan *s, const himc_goal *goal)
{
    double T = goal->time - s->height_end;
    if (!(T >= LEAST_STROKE_TIME && goal->gesture.speed > HIMC_SLOWEST_GESTURE) ||
        s->height.h / T > FASTEST_FALL)
        return false;
    return MOVE_MARGIN * himc_move_time(distance_to(s, goal), HIMC_HARDEST_MOVE) <= T;
}

double himc_hand_leap_time(double way)
{
    double T = MOVE_MARGIN * himc_move_time(way, HIMC_HARDEST_MOVE);
    return HIMC_CONTACT_TIME + T + absorb_time(T);
}

double himc_hand_least_speed(const himc_hand_plan *plan, double t, const himc_goal *goal)
{
    stroke_plan s = frame_at(plan, t, goal->spot, goal->normal);
    return himc_height_profile_least_landing(fmax(s.height.h, 0), goal->time - t);
}

/// The stroke begins so at t; where the plan ends with a contact, when the tip has left.
static stroke_plan begin_from(const himc_hand_plan *plan, double t, const himc_goal *goal)
{
    stroke_plan s = frame_at(plan, t, goal->spot, goal->normal);
    double T = t == plan->end ? leaving_time(plan, goal->time) : 0;
    s.height_end += T;
    s.height.h += T * s.height.v;
    s.lift = himc_vec3_dot(goal->normal, himc_spline_at(&plan->lift, t).x);
    return s;
}

/// Possible, and not much louder than the goal asks for.
static bool can_play(const stroke_plan *s, const himc_goal *goal)
{
    double T = goal->time - s->height_end;
    return is_possible(s, goal) &&
           !himc_height_profile_plunges(s->height.h + s->lift, T, goal->gesture.speed);
}

bool himc_hand_can_strike_from(const himc_hand_plan *plan, double t, const himc_goal *goal)
{
    stroke_plan s = begin_from(plan, t, goal);
    return can_play(&s, goal);
}

bool himc_hand_can_strike(const himc_hand_plan *plan, const himc_goal *goal)
{
    return himc_hand_can_strike_from(plan, plan->end, goal);
}

bool himc_hand_can_follow(const himc_goal *first, const himc_goal *second)
{
    himc_vec3 way = himc_vec3_sub(first->spot, second->spot);
    stroke_plan s = {.height_end = himc_goal_end(first)};
    s.height_end += absorb_time(second->time - s.height_end);
    s.height.h = himc_vec3_dot(second->normal, way);
    s.path.x = himc_vec3_madd(first->spot, -s.height.h, second->normal);
    return can_play(&s, second);
}

/// A strong rebound with little time left is followed: the stroke goes as high as the rebound takes
/// it. A rise at its steepest from (h, v) for T - d and a fall for d of the stroke's own s meet at
///     H = h + v (T - d)/2.4 = speed d/s.
/// The speed stays, so the next rebound is the same. One that would go beyond what an arm does is
/// not followed.
static void follow_rebound(const stroke_plan *s, double t, himc_gesture *g)
{
    double T = t - s->height_end, rise_time = T - g->down - g->dwell;
    double h = s->height.h, climb = s->height.v / HIMC_STEEPEST_QUINTIC;
    if (s->height.v < HIMC_TURNING_SPEED || rise_time > FOLLOW_TIME ||
        h + climb * rise_time < g->height)
        return;
    double shape = g->speed * g->down / g->height;
    double down = fmin(shape * (h + climb * T) / (g->speed + shape * climb), FOLLOW_FALL_SHARE * T);
    if (h + climb * (T - down) > HIMC_HIGHEST_REBOUND)
        return;
    g->dwell = 0;
    g->down = down;
    g->height = h + climb * (T - down);
}

/// The fall to the touch: one quintic, or from the apex through the knots of a unit's fall.
static void fall(stroke_plan *s, double t, const himc_gesture *g, bool from_apex)
{
    double landing = g->speed * g->down / g->height;
    for (int k = 1; g->unit && from_apex && k < UNIT_KNOTS; k++) {
        double f[3], u = (double)k / UNIT_KNOTS;
        himc_unit_at(g->unit, u, landing, f);
        height_state knot = {g->height * f[0], g->height * f[1] / g->down,
                             g->height * f[2] / (g->down * g->down)};
        himc_height_profile_to(s, t - g->down * (1 - u), knot);
    }
    himc_height_profile_to(s, t, (height_state){0, -g->speed, 0});
}

/// The predicted contact; before the rebound from a bounce the hand stays level.
static void contact(stroke_plan *s, const himc_goal *goal, double speed)
{
    double end = himc_goal_end(goal), rebound = PREDICTED_RESTITUTION * speed;
    if (goal->hold > 0) {
        himc_height_profile_to(s, goal->time + HIMC_CONTACT_TIME, (height_state){0, 0, 0});
        himc_height_profile_to(s, end - HIMC_CONTACT_TIME, (height_state){0, 0, 0});
        rebound *= BOUNCE_RATIO;
    }
    himc_height_profile_to(s, end, (height_state){0, rebound, 0});
}

void himc_hand_land(himc_hand_plan *plan, double t, const himc_target *measured,
                    const himc_goal *goal)
{
    double speed = goal->gesture.speed;
    himc_target touch = {goal->spot, himc_vec3_scale(goal->normal, -speed), {0, 0, 0}};
    himc_hand_cut(plan, t);
    go(plan, t, measured, goal->time, &touch);
    stroke_plan s = plan_begin(plan, goal->spot, goal->normal);
    contact(&s, goal, speed);
    plan_finish(&s);
    plan->last = *goal;
    plan->rebounding = true;
}

bool himc_hand_strike(himc_hand_plan *plan, const himc_goal *goal)
{
    stroke_plan s = begin_from(plan, plan->end, goal);
    if (!is_possible(&s, goal))
        return false;
    double over = plan->end + LIFT_SHARE * (goal->time - plan->end);
    end_lift(plan, plan->end, over, over);
    leave(plan, goal->time);
    s = plan_begin(plan, goal->spot, goal->normal);
    // softer if the tip is too low for it with the time left
    double T = goal->time - s.height_end, drop = HIMC_STEEPEST_QUINTIC * fmax(s.height.h, 0) / T;
    himc_gesture g = himc_gesture_bend(goal->gesture, FASTEST_HURRY * T + drop);
    double begin = s.height_end;
    s.approach = fmax(LEAST_APPROACH_TIME, himc_move_time(distance_to(&s, goal), GENTLE_MOVE));
    bool from_apex = !himc_height_profile_falls(&s, goal->time, &g);
    if (from_apex) {
        g = himc_gesture_squeeze(g, goal->time - plan->end, s.height.h);
        follow_rebound(&s, goal->time, &g);
        double top = goal->time - g.down - g.dwell;
        begin = himc_height_profile_rise(&s, top, &g);
        if (s.height.a == 0)
            himc_height_profile_to(&s, top + g.dwell, s.height);
    }
    fall(&s, goal->time, &g, from_apex);
    contact(&s, goal, g.speed);
    swing(&s, goal, &g, begin);
    plan_finish(&s);
    plan->last = *goal;
    plan->last.gesture = g;
    plan->rebounding = true;
    plan->at_home = false;
    return true;
}

/// Moves to a place in space, not before `at`. What would carry the tip down to the head or far
/// up on the way, a fall or the acceleration of a stroke broken off, is halted first.
static void move_to(stroke_plan *s, himc_vec3 x, double peak, double at)
{
    height_state to = {himc_vec3_dot(s->n, himc_vec3_sub(x, s->plan->last.spot)), 0, 0};
    double distance = himc_vec3_length(himc_vec3_sub(x, himc_hand_at(s->plan, s->plan->end).x));
    double T = fmax(fmax(himc_move_time(distance, peak), LEAST_MOVE_TIME), at - s->height_end);
    double high = s->height.v > HIMC_TURNING_SPEED ? HUGE_VAL : fmax(to.h, s->height.h) + MOVE_OVER;
    if (!himc_height_profile_stays(s, s->height_end + T, to, fmin(to.h, 0.5 * s->height.h), high))
        himc_height_profile_brake(s, s->height_end + BRAKE_LIMIT);
    himc_height_profile_to(s, s->height_end + T, to);
    path_to(s, s->height_end, himc_vec3_madd(x, -to.h, s->n));
}

void himc_hand_reach(himc_hand_plan *plan, himc_vec3 x, double at)
{
    stroke_plan s = plan_begin(plan, plan->last.spot, plan->last.normal);
    move_to(&s, x, HIMC_QUICK_MOVE, at);
    plan_finish(&s);
    plan->home = x;
    plan->at_home = true;
    plan->rebounding = false;
}

void himc_hand_wait(himc_hand_plan *plan, double until, bool ready)
{
    leave(plan, HUGE_VAL);
    stroke_plan s = plan_begin(plan, plan->last.spot, plan->last.normal);
    if (s.height.v > HIMC_TURNING_SPEED)
        himc_height_profile_rebound(&s, s.height_end + FREE_REBOUND_TIME, HIMC_HIGHEST_REBOUND);
    else if (s.height.v < -HIMC_TURNING_SPEED || fabs(s.height.a) > BREAK_OFF)
        himc_height_profile_brake(&s, s.height_end + BRAKE_LIMIT);
    plan->rebounding = false;
    if (plan->at_home) {
        himc_height_profile_to(&s, fmax(until, s.height_end + HOME_WAIT),
                               (height_state){s.height.h, 0, 0});
        path_to(&s, s.height_end, s.path.x);
    } else if (ready) { // over the last spot: comes down to the waiting height, or sways there
        bool low =
            s.height.h < HIMC_WAIT_HEIGHT + 2 * HIMC_WAIT_SWAY && s.height.h > HOVER_LEAST_HEIGHT;
        double sway = plan->swayed ? -HIMC_WAIT_SWAY : HIMC_WAIT_SWAY;
        himc_vec3 x = himc_vec3_madd(plan->last.spot, low ? sway : 0, plan->last.back);
        plan->swayed = !plan->swayed;
        himc_height_profile_to(&s, s.height_end + (low ? HOVER_TIME : HOVER_ARRIVAL),
                               (height_state){HIMC_WAIT_HEIGHT + (low ? sway / 2 : 0), 0, 0});
        path_to(&s, s.height_end, x);
    } else {
        move_to(&s, plan->home, HOME_MOVE, 0);
        plan->at_home = true;
    }
    plan_finish(&s);
}
