/// planner_clear.c: hands that would meet pass each other: one is lifted over the other.
///
/// The gap of both sticks and arms is looked at in steps along what has just been planned. Where it
/// is too small, lifts of several lengths and directions are tried, and the one that lacks least is
/// kept.
#include "plan/planner_motion.h"

// hands that pass each other; chosen: sticks that play one head side by side are 14 mm apart
#define NEAR_SPAN \
    10.0 // (s) of a plan that is searched; chosen: longer than any motion, a wait may be endless
#define NEAR_STEP 0.01   // between two looks (s)
#define NEAR_GAP 0.003   // hands nearer than this are kept apart (m) ...
#define CROSSED_GAP 0.05 // ... and crossed ones nearer by this
#define CROSSED 0.02     // one tip is so far on the other's side (m)
#define FAR_APART 0.6    // tips so far apart are not looked at (m); two sticks' and hands' lengths
#define NEAR_BESIDE 0.2  // a way past is tried so long before and after, too (s)
#define WAYS 2           // directions of a way past ...
#define LIFT 0.08        // ... its length in these steps (m) ...
#define LIFTS 4          // ... and up to so many
#define QUICK_LIFT 60.0  // peak acceleration of a lift with time (m/s^2)
#define STILL 0.03       // no lift so near before a touch (s)

/// A time in which the hands come near.
typedef struct near_time {
    double lack;     ///< what gaps lack of NEAR_GAP, over the time (m s)
    double gap;      ///< least (m)
    double from, to; ///< first and last time of a gap below NEAR_GAP (s)
} near_time;

static bool is_crossed(const himc_vec3 tip[HIMC_HANDS])
{
    himc_vec3 left = tip[HIMC_LEFT], right = tip[HIMC_RIGHT];
    return left.x * right.y - left.y * right.x > CROSSED * hypot(left.x, left.y);
}

static void tips_at(const himc_planner *planner, double t, himc_vec3 tip[HIMC_HANDS])
{
    for (int i = 0; i < HIMC_HANDS; i++)
        tip[i] = himc_hand_at(&planner->hand[i].plan, t).x;
}

static near_time find_near(const himc_planner *planner, double begin, double end, double step)
{
    near_time n = {0, HUGE_VAL, HUGE_VAL, -HUGE_VAL};
    for (double t = begin; t < end; t += step) {
        himc_vec3 tip[HIMC_HANDS];
        tips_at(planner, t, tip);
        if (himc_vec3_length(himc_vec3_sub(tip[HIMC_LEFT], tip[HIMC_RIGHT])) > FAR_APART)
            continue;
        double gap = planner->config.gap(planner->config.body, tip);
        double lack = NEAR_GAP - gap + (is_crossed(tip) ? CROSSED_GAP : 0);
        n.gap = fmin(n.gap, gap);
        if (lack < 0)
            continue;
        n.lack += step * lack;
        n.from = fmin(n.from, t);
        n.to = t;
    }
    return n;
}

/// Ways past the other hand, in the order in which they are tried: over it, outside it, before it.
static himc_vec3 way_past(himc_vec3 tip, int k)
{
    static const double share[WAYS][2] = {{1, 0}, {1, 0.7}};
    double size = LIFT * (1 + k / WAYS), distance = hypot(tip.x, tip.y);
    const double *s = share[k % WAYS];
    return himc_vec3_make(size * s[1] * tip.x / distance, size * s[1] * tip.y / distance,
                          size * s[0]);
}

static bool lift_past(himc_hand_plan *plan, double begin, double touch, const near_time *n,
                      himc_vec3 way)
{
    double up = himc_move_time(himc_vec3_length(way), QUICK_LIFT);
    double down = fmin(n->to, touch - STILL - up);
    return himc_hand_lift(plan, fmax(begin, n->from - up), n->from, fmax(down, n->from), down + up,
                          way);
}

bool himc_planner_keep_clear(himc_planner *planner, himc_hand hand, double begin, double touch)
{
    himc_hand_plan *plan = &planner->hand[hand].plan;
    double end = fmin(touch, planner->hand[hand == HIMC_LEFT ? HIMC_RIGHT : HIMC_LEFT].plan.end);
    himc_vec3 tips[HIMC_HANDS], best = {0, 0, 0};
    if (!planner->config.gap)
        return true;
    begin = fmax(begin, end - NEAR_SPAN);
    near_time n = find_near(planner, begin, end, NEAR_STEP), least = n;
    tips_at(planner, begin, tips);
    if (n.lack == 0 || (is_crossed(tips) && planner->above != hand))
        return n.gap >= 0;
    himc_vec3 tip = himc_hand_at(plan, n.from).x;
    double from = fmax(begin, n.from - NEAR_BESIDE), to = fmin(end, n.to + NEAR_BESIDE);
    for (int k = 0; k < LIFTS * WAYS && least.lack > 0; k++) {
        himc_vec3 way = way_past(tip, k);
        int lifts = plan->lift.count;
        if (!lift_past(plan, begin, touch, &n, way))
            continue;
        near_time now = find_near(planner, from, to, 2 * NEAR_STEP);
        plan->lift.count = lifts;
        if (now.lack >= least.lack)
            continue;
        least = now;
        best = way;
    }
    if (himc_vec3_length(best) == 0)
        return n.gap >= 0;
    planner->above = hand;
    return lift_past(plan, begin, touch, &n, best) && least.gap >= 0;
}
