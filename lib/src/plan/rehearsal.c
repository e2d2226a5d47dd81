/// rehearsal.c: the gaps of the body along both plans, with trunk, elbows and wrists as they will
/// have moved by then, at each touch and as often as needed between touches. What is tried in place
/// of a plan, a lift or another motion, is walked through in the same way, from a moment before it
/// begins.
#include "plan/rehearsal.h"
#include "plan/planner_state.h"
#include "plan/stroke_plan.h"

// moments; chosen: sticks that play one head side by side are 14 mm apart
#define STEP 0.012         // between two looks (s)
#define PASSING_GAP 0.1    // sticks nearer than this (m) ...
#define PASSING_STEP 0.004 // ... are looked at so often (s): they pass at up to 6 m/s
#define NEAR_GAP 0.008     // hands nearer than this are kept apart (m) ...
#define CROSSED_GAP 0.05   // ... and crossed ones nearer by this
#define CROSSED 0.02       // one tip is so far on the other's side (m)
#define UNSURE_GAP 0.004 // real gaps are less than rehearsed ones by up to this (m): seen 1 to 4 mm
#define UNSURE 0.003     // so early or late a stick may pass (s): the rebound is only predicted ...
#define MOST_UNSURE 0.01 // ... so that the gap may be less by this, too (m)
#define STRETCHED 2.0    // ... and a body gap by this share of the way out of reach: seen up to 1.8
#define OVERREACH 0.04   // no motion so far out of reach of the usual posture (m)
#define FOLDED 0.25      // no way of a tip so near to its shoulder (m): the arm would whip
#define UNREACHED 0.1    // and no stroke so far (m): the arm would not find back
#define PLACE_AHEAD 1.2  // the trunk turns to a touch within this time (s)

planner_rehearsal himc_rehearsal_begin(double t)
{
    return (planner_rehearsal){
        .t = t, .after = -1, .met = true, .near = {0, HUGE_VAL, HUGE_VAL, -HUGE_VAL, 0}};
}

static bool is_crossed(const himc_vec3 tip[HIMC_HANDS])
{
    himc_vec3 left = tip[HIMC_LEFT], right = tip[HIMC_RIGHT];
    return left.x * right.y - left.y * right.x > CROSSED * hypot(left.x, left.y);
}

/// The part of a lift at t that is done (0 .. 1), as himc_hand_lift has it.
static double lifted(const planner_lift *l, double t)
{
    double u =
        t < l->from ? (t - l->begin) / (l->from - l->begin) : (l->end - t) / (l->end - l->to);
    u = fmin(fmax(u, 0), 1);
    return u * u * u * (10 - u * (15 - 6 * u));
}

/// Where the hand touches next, if that is soon; else its tip.
static himc_vec3 next_place(const planner_hand *h, double t, himc_vec3 tip)
{
    const timed_stroke *s = himc_planner_current_planned(h, t);
    bool soon = s && s->goal.time >= t && s->goal.time < t + PLACE_AHEAD;
    return soon ? s->goal.spot : tip;
}

himc_vec3 himc_moment_tip(const himc_moment *m, himc_hand hand, double t)
{
    if (!m->plans)
        return m->tip[hand];
    himc_vec3 tip = himc_hand_at(&m->plans[hand].plan, t).x;
    return m->lift->end > 0 && m->lift->hand == hand
               ? himc_vec3_madd(tip, lifted(m->lift, t), m->lift->way)
               : tip;
}

static himc_moment moment_at(const planner_rehearsal *walk, const planner_lift *lift,
                             const planner_hand *hand)
{
    himc_moment m = {.time = walk->t, .after = walk->after, .plans = hand, .lift = lift};
    for (int i = 0; i < HIMC_HANDS; i++) {
        m.tip[i] = himc_moment_tip(&m, (himc_hand)i, walk->t);
        m.place[i] = next_place(&hand[i], walk->t, m.tip[i]);
    }
    return m;
}

/// What the gaps lack at a moment (m), and the hand that should give way: `order` of
/// himc_clearance.
static double lack_of(const himc_clearance *clear, const himc_moment *at, int *order)
{
    double lack = NEAR_GAP - clear->sticks + (is_crossed(at->tip) ? CROSSED_GAP : 0);
    lack = fmax(lack, -fmin(clear->body, OVERREACH - clear->beyond));
    *order = clear->order;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        if (FOLDED - clear->folded[hand] > lack) {
            lack = FOLDED - clear->folded[hand];
            *order = hand == HIMC_LEFT ? 1 : -1;
        }
    return lack;
}

/// Notes what is near at a moment, for the time until the next one.
static void note(near_time *n, double t, double after, double lack, int order)
{
    if (n->lack == 0)
        n->from = t;
    if (n->lack == 0 || n->order == 0)
        n->order = order;
    n->lack += after * lack;
    n->to = t;
}

/// Of the tips past each other, from above (m/s).
static double speed_past(const planner_hand *hand, double t)
{
    himc_vec3 v = himc_vec3_sub(himc_hand_at(&hand[HIMC_LEFT].plan, t).v,
                                himc_hand_at(&hand[HIMC_RIGHT].plan, t).v);
    return hypot(v.x, v.y);
}

/// Time from t to the next planned touch (s).
static double to_touch(const planner_hand *hand, double t)
{
    double least = HUGE_VAL;
    for (int i = 0; i < HIMC_HANDS; i++)
        for (int k = 0; k < hand[i].planned_count; k++)
            if (hand[i].planned[k].goal.time > t)
                least = fmin(least, hand[i].planned[k].goal.time - t);
    return least;
}

int himc_rehearsal_step(const himc_planner_config *config, planner_rehearsal *walk,
                        const planner_lift *lift, const planner_hand *hand, double ignored)
{
    int order;
    himc_moment at = moment_at(walk, lift, hand);
    himc_clearance clear = config->rehearse(config->motion, &at, &walk->state);
    clear.body -= UNSURE_GAP + STRETCHED * clear.beyond;
    clear.sticks -= UNSURE_GAP + fmin(MOST_UNSURE, UNSURE * speed_past(hand, at.time));
    double gap = fmin(fmin(clear.body, clear.sticks), UNREACHED - clear.beyond);
    double lack = lack_of(&clear, &at, &order);
    walk->after = fmin(clear.sticks < PASSING_GAP ? PASSING_STEP : STEP, to_touch(hand, walk->t));
    walk->met = walk->met && gap < 0;
    if (at.time > ignored) {
        walk->near.gap = walk->met ? walk->near.gap : fmin(walk->near.gap, gap);
        if (lack > 0)
            note(&walk->near, at.time, walk->after, lack, order);
    }
    walk->t += walk->after;
    return clear.work;
}

bool himc_rehearsal_is_better(const near_time *a, const near_time *b)
{
    double p = fmin(a->gap, HIMC_SURE_GAP), q = fmin(b->gap, HIMC_SURE_GAP);
    return p == q ? a->lack < b->lack : p > q;
}
