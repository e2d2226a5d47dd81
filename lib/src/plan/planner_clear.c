/// planner_clear.c: both plans are rehearsed ahead of time with the whole body, and hands that
/// would meet pass each other.
///
/// What is planned stands at once and is rehearsed afterwards: a walk goes through both plans,
/// ahead of the time at which they can still be changed, as far as both are known. At each touch,
/// and as often as needed between touches, it asks the body for its gaps, with trunk, elbows and
/// wrists as they will have moved by then: the same steps of the avoidance are taken with the same
/// tips.
///
/// Where the hands come near, changes are tried in a fixed order: the upper hand is lifted over the
/// other one, or over and outwards, then the other hand is; if the body still meets itself, the
/// spot of the next stroke is moved aside, or its hand waits or goes a straighter way, or the other
/// hand plays it; where the body still meets itself it is left out, and a line says so. For these a
/// trial is planned. Each change is walked through in the same way, from a moment before it begins.
/// The best one is made, and the walk goes on through it.
///
/// All of this is work that is counted in postures of the body and paid for by the time that passes
/// (himc_planner_think), so no step carries more than a few of them, and the result does not depend
/// on the speed of the machine. A plan that changes before the walk's place lets the walk begin
/// again; lifts and other ways that have been found stay with their stroke.
#include "plan/planner_state.h"
#include "plan/sticking.h"

#include <string.h>

// moments; chosen: sticks that play one head side by side are 14 mm apart
#define STEP 0.012         // between two looks (s)
#define PASSING_GAP 0.1    // sticks nearer than this (m) ...
#define PASSING_STEP 0.004 // ... are looked at so often (s): they pass at up to 6 m/s
#define NEAR_GAP 0.008     // hands nearer than this are kept apart (m) ...
#define CROSSED_GAP 0.05   // ... and crossed ones nearer by this
#define CROSSED 0.02       // one tip is so far on the other's side (m)
#define UNSURE_GAP 0.004 // real gaps are less than rehearsed ones by up to this (m): seen 1 to 4 mm
#define SLIDE 1.5        // of tips along each other in strokes on one drum, at most (m/s); chosen
#define UNSURE 0.003     // so early or late a stick may pass (s): the rebound is only predicted ...
#define MOST_UNSURE 0.01 // ... so that the gap may be less by this, too (m)
#define STRETCHED 2.0    // ... and a body gap by this share of the way out of reach: seen up to 1.8
#define OVERREACH 0.04   // no motion so far out of reach of the usual posture (m)
#define FOLDED 0.25      // no way of a tip so near to its shoulder (m): the arm would whip
#define UNREACHED 0.1    // and no stroke so far (m): the arm would not find back
#define PLACE_AHEAD 1.2  // the trunk turns to a touch within this time (s)
#define TRUNK_STEP 0.004 // of the rehearsed trunk, at most (s): a usual tick
/// With a smaller gap other ways are tried (m); chosen: a rebound changes the plan by 6 mm.
#define SURE_GAP 0.008

// the walk; chosen
#define MOST_CREDIT 16.0   // work that is not done is not owed
#define KEPT_TIME 0.2      // between moments that are kept (s): longer than the beginning of a lift
#define WAIT_FOR_MORE 0.36 // what is near later than this may go on beyond what is known (s)
#define BESIDE 0.2         // a lift is looked at for so long after what was near (s) ...
#define AFTER_WAY 0.5      // ... and a stroke played in another way (s)

// lifts; chosen
#define LIFT 0.08       // their length in these steps (m) ...
#define LIFTS 4         // ... and up to so many
#define WAYS 3          // directions
#define QUICK_LIFT 60.0 // peak acceleration with time (m/s^2)
#define STILL 0.03      // no lift so near before a touch (s)
#define LEAST_AHEAD \
    0.012 // changes begin after now (s); more than the longest period of advance, 10 ms

// strokes that make way; chosen
#define CHANGEABLE 0.14  // a stroke nearer than this is left as it is (s)
#define AT_TOUCH 0.03    // what is near so long after a touch is near at the touch (s)
#define SAME_PLACE 0.25  // spots are moved away from tips so near (m)
#define LEAST_SIDE 0.01  // with less each hand goes to its own side (m)
#define PLANNING_WORK 25 // to plan a trial, in postures: 12 to 27 us, measured
#define LIFT_TRIES (LIFTS * WAYS)

/// What is tried with a stroke, in this order.
static const planner_way stroke_way[] = {{.aside = 0.03},    {.aside = 0.06}, {.waits = true},
                                         {.straight = true}, {.other = true}, {.leaves = true}};
#define STROKE_WAYS (int)(sizeof stroke_way / sizeof stroke_way[0])
#define KEPT_WAYS 4 ///< the first ones: its hand plays it

/// A walk that begins at t (s).
static planner_rehearsal begin_walk(double t)
{
    return (planner_rehearsal){
        .t = t, .after = -1, .met = true, .near = {0, HUGE_VAL, HUGE_VAL, -HUGE_VAL, 0}};
}

/// Both hands at a moment.
typedef struct moment {
    double time, after;          // the moment before (s); negative: it is the first
    himc_vec3 tip[HIMC_HANDS];   // (m)
    himc_vec3 place[HIMC_HANDS]; // of the next touch, if that is soon, or the tip (m)
    const planner_hand *hand;    // their plans ...
    const planner_lift *lift;    // ... and a lift of one; NULL: the tips stay
} moment;

static himc_vec3 tip_at(const moment *m, himc_hand hand, double t)
{
    if (!m->hand)
        return m->tip[hand];
    himc_vec3 tip = himc_hand_at(&m->hand[hand].plan, t).x;
    const planner_lift *l = m->lift;
    if (l->end == 0 || l->hand != hand)
        return tip;
    // the part of the lift that is done (0 .. 1), as himc_hand_lift has it
    double u =
        t < l->from ? (t - l->begin) / (l->from - l->begin) : (l->end - t) / (l->end - l->to);
    u = fmin(fmax(u, 0), 1);
    return himc_vec3_madd(tip, u * u * u * (10 - u * (15 - 6 * u)), l->way);
}

/// One step of the avoidance, if it is due; the work.
static int avoid(const himc_planned_body *b, const moment *at, planner_rehearsal *r)
{
    himc_vec3 tip[HIMC_FORESEEN][HIMC_HANDS];
    int work = 0;
    r->since += fmax(at->after, 0);
    if (r->since >= HIMC_AVOIDANCE_PERIOD) {
        for (int k = 0; k < HIMC_FORESEEN; k++)
            for (int hand = 0; hand < HIMC_HANDS; hand++)
                tip[k][hand] = tip_at(at, (himc_hand)hand, at->time + himc_avoidance_times[k]);
        work = himc_avoidance_look_ahead(&r->avoidance, &b->posture, &b->shells, &r->trunk,
                                         &r->goal, tip, r->since);
        r->since = 0;
    }
    himc_avoidance_apply(&r->avoidance, &r->goal);
    return work;
}

/// The gaps at a moment. Trunk, elbows and wrists move as they will, at first from where they are
/// now.
static himc_clearance look(const himc_planned_body *b, const moment *at, planner_rehearsal *r)
{
    if (at->after < 0) {
        r->trunk = b->from;
        r->goal = b->goal;
        r->avoidance = b->avoidance;
        r->since = b->time - b->avoided;
    }
    double time = at->after < 0 ? fmax(at->time - b->time, 0) : at->after;
    int steps = (int)ceil(time / TRUNK_STEP);
    for (int i = 0; i < steps; i++)
        r->trunk = himc_trunk_posture_approach(&r->trunk, &r->goal, time / steps);
    himc_posture then = b->posture;
    then.trunk_posture = r->trunk;
    himc_clearance clear = himc_avoidance_gaps(&r->avoidance, &then, &b->shells, at->tip);
    r->goal = himc_posture_trunk(&b->posture, at->place, b->grip);
    clear.work = 1 + avoid(b, at, r);
    return clear;
}

/// Both tips where they are planned to be at t, but that of `hand`.
static moment moment_with(const himc_planner *planner, double t, himc_hand hand, himc_vec3 x)
{
    moment m = {.time = t, .after = -1};
    for (int i = 0; i < HIMC_HANDS; i++)
        m.tip[i] = m.place[i] = i == (int)hand ? x : himc_hand_at(&planner->hand[i].plan, t).x;
    return m;
}

bool himc_planner_bends_to(const himc_planner *planner, himc_hand hand, double t,
                           const himc_goal *goal)
{
    const himc_planned_body *body = planner->config.body;
    planner_rehearsal r = begin_walk(t);
    if (!body)
        return true;
    moment m = moment_with(planner, t, hand, himc_hand_at(&planner->hand[hand].plan, t).x);
    m.place[hand] = goal->spot;
    look(body, &m, &r);
    m.time = goal->time;
    m.after = goal->time - t;
    m.tip[hand] = goal->spot;
    return look(body, &m, &r).beyond <= PLANNER_UNREACHED;
}

bool himc_planner_meets_at(const himc_planner *planner, double t, himc_hand hand, himc_vec3 x)
{
    planner_rehearsal r = begin_walk(t);
    moment m = moment_with(planner, t, hand, x);
    return planner->config.body && look(planner->config.body, &m, &r).sticks < 0;
}

/// What the gaps lack at a moment (m), and the hand that should give way: `order` of
/// himc_clearance.
static double lack_of(const himc_clearance *clear, const moment *at, int *order)
{
    himc_vec3 left = at->tip[HIMC_LEFT], right = at->tip[HIMC_RIGHT];
    bool crossed = left.x * right.y - left.y * right.x > CROSSED * hypot(left.x, left.y);
    double lack = NEAR_GAP - clear->sticks + (crossed ? CROSSED_GAP : 0);
    lack = fmax(lack, -fmin(clear->body, OVERREACH - clear->beyond));
    *order = clear->order;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        if (FOLDED - clear->folded[hand] > lack) {
            lack = FOLDED - clear->folded[hand];
            *order = hand == HIMC_LEFT ? 1 : -1;
        }
    return lack;
}

double himc_planner_least_gap(himc_clearance *clear, double speed_past)
{
    clear->body -= UNSURE_GAP + STRETCHED * clear->beyond;
    clear->sticks -= UNSURE_GAP + fmin(MOST_UNSURE, UNSURE * speed_past);
    return fmin(fmin(clear->body, clear->sticks), UNREACHED - clear->beyond);
}

/// Of the tips past each other, from above (m/s): all of it where one stick is over the other; of
/// sticks side by side the part that brings them nearer, and what is faster than strokes on a drum.
static double speed_past(const planner_hand *hand, double t, himc_vec3 across)
{
    himc_vec3 v = himc_vec3_sub(himc_hand_at(&hand[HIMC_LEFT].plan, t).v,
                                himc_hand_at(&hand[HIMC_RIGHT].plan, t).v);
    double all = hypot(v.x, v.y), nearer = hypot(v.x * across.x + v.y * across.y, across.z * all);
    return fmin(all, nearer + fmax(all - SLIDE, 0));
}

/// One moment of the walk through the plans of both hands and a lift; what is near before `ignored`
/// (s) is not noted. Returns the work.
static int walk_step(const himc_planner *planner, planner_rehearsal *walk, const planner_lift *lift,
                     const planner_hand *hand, double ignored)
{
    int order;
    moment at = {.time = walk->t, .after = walk->after, .hand = hand, .lift = lift};
    for (int i = 0; i < HIMC_HANDS; i++) {
        at.tip[i] = tip_at(&at, (himc_hand)i, walk->t);
        const timed_stroke *s = himc_planner_current_planned(&hand[i], walk->t);
        bool soon = s && s->goal.time >= walk->t && s->goal.time < walk->t + PLACE_AHEAD;
        at.place[i] = soon ? s->goal.spot : at.tip[i];
    }
    himc_clearance clear = look(planner->config.body, &at, walk);
    double gap = himc_planner_least_gap(&clear, speed_past(hand, at.time, clear.across));
    double lack = lack_of(&clear, &at, &order);
    walk->after = fmin(clear.sticks < PASSING_GAP ? PASSING_STEP : STEP,
                       fmin(himc_planner_touch_after(&hand[HIMC_LEFT], walk->t),
                            himc_planner_touch_after(&hand[HIMC_RIGHT], walk->t)) -
                           walk->t);
    walk->met = walk->met && gap < 0;
    if (at.time > ignored) {
        near_time *n = &walk->near;
        n->gap = walk->met ? n->gap : fmin(n->gap, gap);
        if (lack > 0) { // until the next moment
            n->from = n->lack == 0 ? at.time : n->from;
            n->order = n->lack == 0 || n->order == 0 ? order : n->order;
            n->lack += walk->after * lack;
            n->to = at.time;
        }
    }
    walk->t += walk->after;
    return clear.work;
}

static void try_nothing(planner_clear *c)
{
    c->lift.end = 0;
    c->way.touch = -HUGE_VAL;
}

static void walk_from(planner_clear *c, planner_rehearsal from)
{
    try_nothing(c);
    c->walk = c->kept[0] = c->kept[1] = from;
    c->searching = c->trying = false;
}

static void walk_anew(himc_planner *planner)
{
    walk_from(&planner->clear, begin_walk(planner->now));
    planner->clear.searched = -HUGE_VAL;
}

/// A plan that has changed where the walk has been is walked through again.
static void notice_change(himc_planner *planner)
{
    const planner_rehearsal *walk = &planner->clear.walk;
    if (planner->changed < walk->t - fmax(walk->after, 0))
        walk_anew(planner);
    planner->changed = HUGE_VAL;
}

/// The hand that has more time after the time near.
static himc_hand later_hand(const himc_planner *planner, const near_time *n)
{
    return himc_planner_touch_after(&planner->hand[HIMC_LEFT], n->from - AT_TOUCH) >
                   himc_planner_touch_after(&planner->hand[HIMC_RIGHT], n->from - AT_TOUCH)
               ? HIMC_LEFT
               : HIMC_RIGHT;
}

/// The k-th lift of a hand where it is near; false if there is no time for it.
static bool make_lift(himc_planner *planner, himc_hand hand, int k)
{
    // over the other hand, over and outwards: up and out
    static const double share[WAYS][2] = {{1, 0}, {1, 0.7}, {0.3, 1}};
    planner_clear *c = &planner->clear;
    const planner_hand *h = &planner->hand[hand];
    const himc_spline *lifts = &h->plan.lift;
    const near_time *n = &c->plain;
    int next = himc_planner_next_planned(h, n->from);
    double begin = planner->now + PLANNER_AHEAD, end = h->plan.end;
    if (next > 0)
        begin = fmax(begin, himc_goal_end(&h->planned[next - 1].goal));
    if (lifts->count > 0)
        begin = fmax(begin, lifts->segment[lifts->count - 1].t1);
    planner_lift l = {.hand = hand, .touch = himc_planner_touch_after(h, n->from)};
    end = fmin(end, l.touch);
    himc_vec3 tip = himc_hand_at(&h->plan, n->from).x;
    double size = LIFT * (1 + k / WAYS), distance = hypot(tip.x, tip.y), out = share[k % WAYS][1];
    l.way = himc_vec3_make(size * out * tip.x / distance, size * out * tip.y / distance,
                           size * share[k % WAYS][0]);
    double up = himc_move_time(himc_vec3_length(l.way), QUICK_LIFT);
    l.from = fmax(n->from, begin + himc_planner_lift_time(&l));
    l.begin = fmax(begin, l.from - up);
    l.to = fmax(l.from, fmin(n->to, end - STILL - up));
    l.end = l.to + up;
    c->lift = l;
    return l.from <= n->to && l.end <= end - STILL;
}

/// The hand's stroke at the time near, or after it, if it can still be changed; else NULL.
static const timed_stroke *yielding(const himc_planner *planner, const near_time *n, himc_hand hand)
{
    const planner_hand *h = &planner->hand[hand];
    int k = himc_planner_next_planned(h, n->from - AT_TOUCH);
    const timed_stroke *s = &h->planned[k];
    bool changeable = k < h->planned_count && (s->place.number >= 0 || s->reassigned) &&
                      s->goal.time > planner->now + CHANGEABLE;
    return changeable ? s : NULL;
}

/// The k-th way for the hand's stroke; false if it cannot be tried, or has been.
static bool make_way(himc_planner *planner, himc_hand hand, int k)
{
    planner_clear *c = &planner->clear;
    const timed_stroke *s = yielding(planner, &c->plain, hand);
    if (!s)
        return false;
    planner_way way = stroke_way[k];
    const planner_way *tried = &planner->hand[hand].way;
    way.hand = hand;
    way.touch = s->written.time;
    way.tried = k + 1;
    // away from the other hand, if that is near
    const himc_head_frame *head = &planner->drum[s->drum];
    himc_vec3 at = himc_head_frame_from_world(head, s->goal.spot);
    himc_target other_tip = himc_hand_at(&planner->hand[himc_other_hand(hand)].plan, s->goal.time);
    himc_vec3 tip = himc_head_frame_from_world(head, other_tip.x);
    double side = at.y - tip.y;
    if (hypot(at.x - tip.x, side) > SAME_PLACE)
        way.aside = 0;
    else if (fabs(side) < LEAST_SIDE ? hand == HIMC_RIGHT : side < 0)
        way.aside = -way.aside;
    bool meets = c->least.gap < 0;
    bool other = way.other && meets && !s->reassigned &&
                 himc_planner_reaches(planner, himc_other_hand(hand), s->written.spot);
    // left out is a leap to another drum, not a stroke of a roll, where a gap would be worse than
    // sticks that touch
    bool begins = s == planner->hand[hand].planned, leaps = !begins && s[-1].drum != s->drum;
    bool leaves = way.leaves && meets && (begins || leaps);
    if ((tried->touch == way.touch && k < tried->tried) ||
        !(way.aside != 0 || way.waits || other || leaves || (way.straight && leaps)))
        return false;
    c->way = way;
    return true;
}

/// First the lifts of either hand (of hands over each other the upper one, else the one with more
/// time), then the ways of a stroke of either hand: that the other hand
/// plays it comes late, that it is left out last.
static bool make_candidate(himc_planner *planner)
{
    planner_clear *c = &planner->clear;
    int k = c->candidate, way = k - 2 * LIFT_TRIES, late = way - 2 * KEPT_WAYS;
    himc_hand later = later_hand(planner, &c->plain), upper = c->plain.order > 0   ? HIMC_LEFT
                                                              : c->plain.order < 0 ? HIMC_RIGHT
                                                                                   : later;
    try_nothing(c);
    if (way < 0)
        return make_lift(planner, k < LIFT_TRIES ? upper : himc_other_hand(upper), k % LIFT_TRIES);
    bool first = late < 0 ? way < KEPT_WAYS : late % 2 == 0;
    return make_way(planner, first ? later : himc_other_hand(later),
                    late < 0 ? way % KEPT_WAYS : KEPT_WAYS + late / 2);
}

/// Whether it is worth while to try the next candidate. A lift that would come too late if more
/// were tried is made, if nothing meets. A stroke is played in another way only if the hands meet:
/// a slightly larger gap is not worth another spot.
static bool goes_on(const himc_planner *planner)
{
    const planner_clear *c = &planner->clear;
    double enough = c->candidate < 2 * LIFT_TRIES ? SURE_GAP : 0;
    bool due = c->best_lift.end > 0 && c->best_lift.begin < planner->now + 2 * LEAST_AHEAD;
    return c->least.lack > 0 && c->candidate < 2 * (LIFT_TRIES + STROKE_WAYS) &&
           (c->least.gap < enough || (c->candidate < LIFT_TRIES && !due));
}

static void plan_way(himc_planner *planner, const planner_way *way)
{
    double t = planner->now + PLANNER_AHEAD;
    planner->hand[way->hand].way = *way;
    himc_planner_cut(planner, way->hand, t);
    himc_planner_extend(planner, way->hand, t + PLANNER_HORIZON);
}

/// Makes the best change.
static void end_search(himc_planner *planner)
{
    planner_clear *c = &planner->clear;
    const planner_lift *lift = &c->best_lift;
    planner_hand *h = &planner->hand[lift->hand];
    try_nothing(c);
    c->searching = false;
    c->searched = c->plain.to;
    if (c->least.gap < 0) {
        const planner_hand *later = &planner->hand[later_hand(planner, &c->plain)];
        int k = himc_planner_next_planned(later, c->plain.from - AT_TOUCH);
        char name[HIMC_PLANNER_NAME];
        if (k < later->planned_count)
            himc_planner_say(planner, PLANNER_MEET, "%s: the hands come too near on the way",
                             himc_planner_name(planner, &later->planned[k], name));
        else
            himc_planner_say(planner, PLANNER_MEET, "the hands come too near");
    }
    c->walk.near = begin_walk(0).near;
    if (c->best_way.touch > -HUGE_VAL) {
        plan_way(planner, &c->best_way);
        notice_change(planner);
    } else if (lift->end > 0 && himc_planner_lift_from(h, lift, planner->now + LEAST_AHEAD)) {
        h->lift = *lift;
        walk_from(c, c->kept[1]);
    }
}

/// Begins to try the next candidate; one that cannot be tried costs little.
static int try_next(himc_planner *planner)
{
    planner_clear *c = &planner->clear;
    c->trying = make_candidate(planner);
    if (!c->trying) {
        c->candidate++;
        return 1;
    }
    if (c->lift.end > 0) {
        c->trial_walk = c->kept[1];
        return 2;
    }
    c->trial_walk = begin_walk(planner->now);
    // the hands as they would be planned with that way; nothing else changes
    planner_score score = planner->score;
    memcpy(c->own, planner->hand, sizeof c->own);
    c->planning = planner->notes.silent = true;
    plan_way(planner, &c->way);
    c->planning = planner->notes.silent = false;
    memcpy(c->with_way, planner->hand, sizeof c->own);
    memcpy(planner->hand, c->own, sizeof c->own);
    for (int i = 0; i < HIMC_HANDS; i++) // what the trial has looked at
        himc_planner_looked_to(planner, (himc_hand)i, &score.part[i].looked);
    planner->score = score;
    return PLANNING_WORK;
}

/// Both plans are known so far (s).
static double known_to(const planner_hand *hand)
{
    return fmin(hand[HIMC_LEFT].plan.end, hand[HIMC_RIGHT].plan.end);
}

static int try_on(himc_planner *planner)
{
    planner_clear *c = &planner->clear;
    planner_rehearsal *walk = &c->trial_walk;
    bool lifts = c->lift.end > 0;
    const planner_hand *hand = lifts ? planner->hand : c->with_way;
    double end = fmin(c->plain.to + (lifts ? BESIDE : AFTER_WAY), known_to(hand));
    int work = walk_step(planner, walk, &c->lift, hand, c->searched);
    // its least gap is larger, or both are SURE_GAP, and less is lacking
    double gap = fmin(walk->near.gap, SURE_GAP), least = fmin(c->least.gap, SURE_GAP);
    bool better = gap == least ? walk->near.lack < c->least.lack : gap > least;
    if (better && walk->t < end)
        return work;
    c->trying = false;
    c->candidate++;
    if (better) {
        c->least = walk->near;
        c->best_lift = c->lift;
        c->best_way = c->way;
    }
    return work;
}

/// The next moment of the walk, as far as both plans are known; 0 at its end.
static int walk_on(himc_planner *planner)
{
    planner_clear *c = &planner->clear;
    if (c->walk.t < planner->now)
        walk_anew(planner);
    bool over = c->walk.t >= known_to(planner->hand);
    bool near = c->walk.near.lack > 0;
    bool late = over && c->walk.near.from < planner->now + WAIT_FOR_MORE;
    if (near && (late || c->walk.t > c->walk.near.to + BESIDE)) {
        c->searching = true;
        c->trying = false;
        c->plain = c->least = c->walk.near;
        c->candidate = 0;
        c->best_lift.end = 0;
        c->best_way.touch = -HUGE_VAL;
        return 1;
    }
    if (over)
        return 0;
    if (!near && c->walk.t > c->kept[0].t + KEPT_TIME) {
        c->kept[1] = c->kept[0];
        c->kept[0] = c->walk;
    }
    return walk_step(planner, &c->walk, &c->lift, planner->hand, c->searched);
}

void himc_planner_think(himc_planner *planner, double work)
{
    planner_clear *c = &planner->clear;
    if (!planner->config.body)
        return;
    notice_change(planner);
    c->credit = fmin(c->credit + work, MOST_CREDIT);
    while (c->credit > 0) {
        if (c->searching && !c->trying && !goes_on(planner))
            end_search(planner);
        int done = !c->searching ? walk_on(planner)
                   : c->trying   ? try_on(planner)
                                 : try_next(planner);
        if (done == 0)
            c->credit = 0;
        c->credit -= done;
        c->work += done;
    }
}

long himc_planner_work(const himc_planner *planner)
{
    return planner->clear.work;
}
