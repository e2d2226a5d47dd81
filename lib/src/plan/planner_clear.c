/// planner_clear.c: hands that would meet pass each other: one is lifted over the other.
///
/// What has just been planned is rehearsed: in steps along it the body is asked for its gaps, with
/// trunk, elbows and wrists as they will have moved by then. Where the hands come near, the upper one
/// is lifted: lifts of several lengths and directions are tried, and the one that lacks least is
/// kept. The least gap that remains is the planner's to judge (planner_motion.c).
#include "plan/planner_motion.h"
#include "plan/stroke_plan.h"

// hands that pass each other; chosen: sticks that play one head side by side are 14 mm apart
#define NEAR_SPAN \
    10.0 // (s) of a plan that is searched; chosen: longer than any motion, a wait may be endless
#define NEAR_STEP 0.02     // between two looks (s)
#define PASSING_GAP 0.1    // sticks nearer than this (m) ...
#define PASSING_STEP 0.005 // ... are looked at so often (s): they pass at up to 6 m/s
#define NEAR_GAP 0.008     // hands nearer than this are kept apart (m) ...
#define CROSSED_GAP 0.05   // ... and crossed ones nearer by this
#define CROSSED 0.02       // one tip is so far on the other's side (m)
#define OVERREACH 0.04     // no lift so far out of reach of the usual posture (m)
#define FOLDED 0.25        // no way of a tip so near to its shoulder (m): the arm would whip
#define UNREACHED 0.1      // and no stroke so far (m): the arm would not find back
#define PLACE_AHEAD 1.2    // the trunk turns to a touch within this time (s)
#define NEAR_BESIDE 0.2    // a way past is tried so long before and after, too (s)
#define WAYS 3             // directions of a way past ...
#define LIFT 0.08          // ... its length in these steps (m) ...
#define LIFTS 4            // ... and up to so many
#define QUICK_LIFT 60.0    // peak acceleration of a lift with time (m/s^2)
#define STILL 0.03         // no lift so near before a touch (s)

/// A time in which the hands come near.
typedef struct near_time {
    double lack;     ///< what gaps lack of NEAR_GAP, over the time (m s)
    double gap;      ///< least of all (m)
    double from, to; ///< first and last time of a gap below NEAR_GAP (s)
    int order;       ///< of the arms then: 1 the left one is above, -1 below, 0 not crossed
} near_time;

static bool is_crossed(const himc_vec3 tip[HIMC_HANDS])
{
    himc_vec3 left = tip[HIMC_LEFT], right = tip[HIMC_RIGHT];
    return left.x * right.y - left.y * right.x > CROSSED * hypot(left.x, left.y);
}

// where the hand touches next, if that is soon; else its tip
static himc_vec3 next_place(const planner_hand *h, double t, himc_vec3 tip)
{
    for (int i = 0; i < h->planned_count; i++)
        if (h->planned[i].goal.time >= t && h->planned[i].goal.time < t + PLACE_AHEAD)
            return h->planned[i].goal.spot;
    return tip;
}

static himc_moment moment_at(const himc_planner *planner, double t, double after)
{
    himc_moment m = {.time = t, .after = after};
    for (int i = 0; i < HIMC_HANDS; i++) {
        const himc_hand_plan *plan = &planner->hand[i].plan;
        m.tip[i] = himc_hand_at(plan, fmin(t, plan->end)).x;
        if (t > plan->end) // it will be somewhere there
            m.tip[i].z = fmax(m.tip[i].z, plan->last.spot.z + HIMC_WAIT_HEIGHT);
        m.place[i] = next_place(&planner->hand[i], t, m.tip[i]);
    }
    return m;
}

static near_time find_near(const himc_planner *planner, double begin, double end)
{
    double known = fmin(planner->hand[HIMC_LEFT].plan.end, planner->hand[HIMC_RIGHT].plan.end);
    near_time n = {0, HUGE_VAL, HUGE_VAL, -HUGE_VAL, 0};
    bool met = true;
    for (double t = begin, after = -1; t < end; t += after) {
        himc_moment at = moment_at(planner, t, after);
        himc_clearance clear = planner->config.rehearse(planner->config.motion, &at);
        if (t > known)
            clear.sticks = HUGE_VAL;
        double body = fmin(clear.body, OVERREACH - clear.beyond);
        double gap = fmin(fmin(clear.body, clear.sticks), UNREACHED - clear.beyond);
        double lack = NEAR_GAP - clear.sticks + (is_crossed(at.tip) ? CROSSED_GAP : 0);
        lack = fmax(lack, fmax(-body, FOLDED - clear.folded));
        after = clear.sticks < PASSING_GAP ? PASSING_STEP : NEAR_STEP;
        met = met && gap < 0; // no plan parts what meets already
        n.gap = met ? n.gap : fmin(n.gap, gap);
        if (lack < 0)
            continue;
        if (n.lack == 0) {
            n.from = t;
            n.order = clear.order;
        }
        n.lack += after * lack;
        n.to = t;
    }
    return n;
}

/// Ways past the other hand, in the order in which they are tried: over it, over and outwards.
static himc_vec3 way_past(himc_vec3 tip, int k)
{
    static const double share[WAYS][2] = {{1, 0}, {1, 0.7}, {0.3, 1}};
    double size = LIFT * (1 + k / WAYS), distance = hypot(tip.x, tip.y);
    const double *s = share[k % WAYS];
    return himc_vec3_make(size * s[1] * tip.x / distance, size * s[1] * tip.y / distance,
                          size * s[0]);
}

static bool lift_past(himc_hand_plan *plan, double begin, double touch, const near_time *n,
                      himc_vec3 way)
{
    double up = himc_move_time(himc_vec3_length(way), QUICK_LIFT);
    if (n->from < begin)
        return false;
    double down = fmin(n->to, touch - STILL - up);
    return himc_hand_lift(plan, fmax(begin, n->from - up), n->from, fmax(down, n->from), down + up,
                          way);
}

static bool is_better(const near_time *a, const near_time *b)
{
    return (a->gap >= 0) == (b->gap >= 0) ? a->lack < b->lack : a->gap >= 0;
}

/// A hand that may be lifted, and the time in which it may.
typedef struct lifter {
    himc_hand_plan *plan;
    double begin, end; ///< (s); strokes touch there, or the plan ends
} lifter;

static lifter lifter_of(himc_planner *planner, himc_hand hand, double begin, double at)
{
    planner_hand *h = &planner->hand[hand];
    lifter l = {&h->plan, begin, h->plan.end};
    for (int i = 0; i < h->planned_count; i++) {
        const himc_goal *goal = &h->planned[i].goal;
        if (goal->time > at)
            l.end = fmin(l.end, goal->time);
        else
            l.begin = fmax(l.begin, himc_goal_end(goal));
    }
    return l;
}

/// Lifts a hand where the hands come near, if that is better; returns the time near then.
static near_time lift_clear(himc_planner *planner, const lifter *l, double begin, double end,
                            near_time n)
{
    near_time least = n;
    himc_vec3 best = {0, 0, 0}, tip = himc_hand_at(l->plan, n.from).x;
    for (int k = 0; k < LIFTS * WAYS && least.lack > 0; k++) {
        himc_vec3 way = way_past(tip, k);
        himc_spline lifts = l->plan->lift;
        if (!lift_past(l->plan, l->begin, l->end, &n, way))
            continue;
        near_time now = find_near(planner, begin, fmin(end, n.to + NEAR_BESIDE));
        l->plan->lift = lifts;
        if (!is_better(&now, &least))
            continue;
        least = now;
        best = way;
    }
    if (himc_vec3_length(best) > 0)
        lift_past(l->plan, l->begin, l->end, &n, best);
    return least;
}

double himc_planner_keep_clear(himc_planner *planner, himc_hand hand, double begin)
{
    himc_hand other = hand == HIMC_LEFT ? HIMC_RIGHT : HIMC_LEFT;
    double end = planner->hand[hand].plan.end;
    if (!planner->config.rehearse)
        return HUGE_VAL;
    begin = fmax(begin, end - NEAR_SPAN);
    near_time n = find_near(planner, begin, end);
    if (n.lack == 0)
        return n.gap;
    bool below = n.order == (hand == HIMC_LEFT ? -1 : 1);
    lifter l = below ? lifter_of(planner, other, planner->now + PLANNER_AHEAD, n.from)
                     : lifter_of(planner, hand, begin, n.from);
    if (!below || n.gap < 0)
        n = lift_clear(planner, &l, begin, end, n);
    return n.gap;
}
