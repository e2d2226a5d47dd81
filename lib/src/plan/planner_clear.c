/// planner_clear.c: hands that would meet pass each other: the search for a way, a little at a
/// time.
///
/// What is planned stands at once and is rehearsed afterwards (rehearsal.c): a walk goes through
/// both plans, ahead of the time at which they can still be changed, as far as both are known.
/// Where the hands come near, changes are tried in a fixed order: the upper hand is lifted over the
/// other one, or over and outwards, then the other hand is; if the body still meets itself, the
/// spot of the next stroke is moved aside, or its hand waits, or the other hand plays it; where the
/// body still meets itself it is left out, and a line says so. For these the planner itself plans a
/// trial (PLANNER_TRY). The best change is made, and the walk goes on through it.
///
/// All of this is work that is counted in postures of the body and paid for by the time that passes
/// (himc_planner_think), so no step carries more than a few of them, and the result does not depend
/// on the speed of the machine. A plan that changes before the walk's place lets the walk begin
/// anew; lifts and other ways that have been found stay with their stroke.
#include "plan/planner_state.h"

// the walk; chosen
#define MOST_CREDIT 16.0   // work that is not done is not owed
#define KEPT_TIME 0.2      // between moments that are kept (s): longer than the beginning of a lift
#define WAIT_FOR_MORE 0.36 // what is near later than this may go on beyond what is known (s)
#define BESIDE 0.2         // a lift is looked at for so long after what was near (s) ...
#define AFTER_WAY 0.5      // ... and a stroke played in another way (s)

// lifts; chosen
#define LIFT 0.08         // their length in these steps (m) ...
#define LIFTS 4           // ... and up to so many
#define WAYS 3            // directions
#define QUICK_LIFT 60.0   // peak acceleration with time (m/s^2)
#define LIFT_MARGIN 1.001 // of the quickest lift's time: it is possible in spite of rounding
#define SAME_TOUCH 1e-6   // (s)
#define STILL 0.03        // no lift so near before a touch (s)
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
static const planner_way stroke_way[] = {
    {.aside = 0.03}, {.aside = 0.06}, {.waits = true}, {.other = true}, {.leaves = true}};
#define STROKE_WAYS (int)(sizeof stroke_way / sizeof stroke_way[0])
#define KEPT_WAYS 3 ///< the first ones: its hand plays it

static himc_hand other_hand(himc_hand hand)
{
    return hand == HIMC_LEFT ? HIMC_RIGHT : HIMC_LEFT;
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
    walk_from(&planner->clear, himc_rehearsal_begin(planner->now));
    planner->clear.searched = -HUGE_VAL;
}

void himc_planner_changed(himc_planner *planner, double t)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        planner->hand[hand].checked = fmin(planner->hand[hand].checked, t);
    if (t < planner->clear.walk.t - fmax(planner->clear.walk.after, 0) && !planner->clear.planning)
        walk_anew(planner);
}

/// Index of the hand's first planned stroke after t; the count if there is none.
static int next_planned(const planner_hand *h, double t)
{
    int k = 0;
    while (k < h->planned_count && h->planned[k].goal.time <= t)
        k++;
    return k;
}

/// Time of the hand's next planned touch after t (s).
static double touch_after(const planner_hand *h, double t)
{
    int k = next_planned(h, t);
    return k < h->planned_count ? h->planned[k].goal.time : HUGE_VAL;
}

/// The hand that has more time after the time near.
static himc_hand later_hand(const himc_planner *planner, const near_time *n)
{
    return touch_after(&planner->hand[HIMC_LEFT], n->from - AT_TOUCH) >
                   touch_after(&planner->hand[HIMC_RIGHT], n->from - AT_TOUCH)
               ? HIMC_LEFT
               : HIMC_RIGHT;
}

/// Of hands over each other the upper one is lifted; else the one with more time.
static himc_hand upper_hand(const himc_planner *planner, const near_time *n)
{
    if (n->order != 0)
        return n->order > 0 ? HIMC_LEFT : HIMC_RIGHT;
    return later_hand(planner, n);
}

/// Ways past the other hand: over it, over and outwards.
static himc_vec3 way_past(himc_vec3 tip, int k)
{
    static const double share[WAYS][2] = {{1, 0}, {1, 0.7}, {0.3, 1}};
    double size = LIFT * (1 + k / WAYS), distance = hypot(tip.x, tip.y);
    const double *s = share[k % WAYS];
    return himc_vec3_make(size * s[1] * tip.x / distance, size * s[1] * tip.y / distance,
                          size * s[0]);
}

/// The least time in which a hand can be lifted so (s).
static double lift_time(const planner_lift *l)
{
    return LIFT_MARGIN * himc_move_time(himc_vec3_length(l->way), HIMC_HARDEST_LIFT);
}

/// The k-th lift of a hand where it is near; false if there is no time for it.
static bool make_lift(himc_planner *planner, himc_hand hand, int k)
{
    planner_clear *c = &planner->clear;
    const planner_hand *h = &planner->hand[hand];
    const himc_spline *lifts = &h->plan.lift;
    const near_time *n = &c->plain;
    int next = next_planned(h, n->from);
    double begin = planner->now + PLANNER_AHEAD, end = h->plan.end;
    if (next > 0)
        begin = fmax(begin, himc_goal_end(&h->planned[next - 1].goal));
    if (lifts->count > 0)
        begin = fmax(begin, lifts->segment[lifts->count - 1].t1);
    planner_lift l = {.hand = hand, .touch = touch_after(h, n->from)};
    end = fmin(end, l.touch);
    l.way = way_past(himc_hand_at(&h->plan, n->from).x, k);
    double size = himc_vec3_length(l.way), up = himc_move_time(size, QUICK_LIFT);
    l.from = fmax(n->from, begin + lift_time(&l));
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
    int k = next_planned(h, n->from - AT_TOUCH);
    const timed_stroke *s = &h->planned[k];
    bool changeable = k < h->planned_count && (s->index >= 0 || s->reassigned) &&
                      s->goal.time > planner->now + CHANGEABLE;
    return changeable ? s : NULL;
}

/// To which side a stroke's spot is moved: away from the other hand; 0 if that is far.
static double side_of(const himc_planner *planner, himc_hand hand, const timed_stroke *s)
{
    const himc_head_frame *head = &planner->drum[s->drum];
    himc_vec3 at = himc_head_frame_from_world(head, s->goal.spot);
    himc_target other = himc_hand_at(&planner->hand[other_hand(hand)].plan, s->goal.time);
    himc_vec3 tip = himc_head_frame_from_world(head, other.x);
    double side = at.y - tip.y;
    if (hypot(at.x - tip.x, side) > SAME_PLACE)
        return 0;
    if (fabs(side) < LEAST_SIDE)
        return hand == HIMC_LEFT ? 1 : -1;
    return copysign(1, side);
}

/// Whether the other hand may be asked to play the stroke.
static bool may_pass_on(const himc_planner *planner, himc_hand hand, const timed_stroke *s)
{
    return !s->reassigned && planner->clear.least.gap < 0 &&
           himc_planner_reaches(planner, other_hand(hand), &s->written);
}

/// Whether the stroke may be left out: a leap to another drum, not one of a roll, where a gap would
/// be worse than sticks that touch.
static bool may_leave_out(const himc_planner *planner, himc_hand hand, const timed_stroke *s)
{
    return planner->clear.least.gap < 0 &&
           (s == planner->hand[hand].planned || s[-1].drum != s->drum);
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
    way.aside *= side_of(planner, hand, s);
    if ((tried->touch == way.touch && k < tried->tried) ||
        !(way.aside != 0 || way.waits || (way.other && may_pass_on(planner, hand, s)) ||
          (way.leaves && may_leave_out(planner, hand, s))))
        return false;
    c->way = way;
    return true;
}

/// First the lifts of either hand, then the ways of a stroke of either hand: that the other hand
/// plays it comes late, that it is left out last.
static bool make_candidate(himc_planner *planner)
{
    planner_clear *c = &planner->clear;
    int k = c->candidate, way = k - 2 * LIFT_TRIES, late = way - 2 * KEPT_WAYS;
    himc_hand upper = upper_hand(planner, &c->plain), later = later_hand(planner, &c->plain);
    try_nothing(c);
    if (way < 0)
        return make_lift(planner, k < LIFT_TRIES ? upper : other_hand(upper), k % LIFT_TRIES);
    bool first = late < 0 ? way < KEPT_WAYS : late % 2 == 0;
    return make_way(planner, first ? later : other_hand(later),
                    late < 0 ? way % KEPT_WAYS : KEPT_WAYS + late / 2);
}

/// Whether it is worth while to try the next candidate. A lift that would come too late if more
/// were tried is made, if nothing meets. A stroke is played in another way only if the hands meet:
/// a slightly larger gap is not worth another spot.
static bool goes_on(const himc_planner *planner)
{
    const planner_clear *c = &planner->clear;
    double enough = c->candidate < 2 * LIFT_TRIES ? HIMC_SURE_GAP : 0;
    bool due = c->best_lift.end > 0 && c->best_lift.begin < planner->now + 2 * LEAST_AHEAD;
    return c->least.lack > 0 && c->candidate < 2 * (LIFT_TRIES + STROKE_WAYS) &&
           (c->least.gap < enough || (c->candidate < LIFT_TRIES && !due));
}

static void begin_search(planner_clear *c)
{
    c->searching = true;
    c->trying = false;
    c->plain = c->least = c->walk.near;
    c->candidate = 0;
    c->best_lift.end = 0;
    c->best_way.touch = -HUGE_VAL;
}

static void say_meet(himc_planner *planner)
{
    const near_time *n = &planner->clear.plain;
    himc_hand later = later_hand(planner, n);
    int k = next_planned(&planner->hand[later], n->from - AT_TOUCH);
    const timed_stroke *s = &planner->hand[later].planned[k];
    char name[HIMC_PLANNER_NAME];
    if (k < planner->hand[later].planned_count)
        himc_planner_say(&planner->notes, PLANNER_MEET, "%s: the hands come too near on the way",
                         himc_planner_name(planner, s, name));
    else
        himc_planner_say(&planner->notes, PLANNER_MEET, "the hands come too near");
}

/// Lifts a hand, a little later than found if it cannot begin before t (s); false if it is too
/// late.
static bool lift_from(planner_hand *h, const planner_lift *l, double t)
{
    double begin = fmax(l->begin, t), from = fmax(l->from, begin + lift_time(l));
    return himc_hand_lift(&h->plan, begin, from, fmax(l->to, from), l->end, l->way);
}

static bool lift_now(himc_planner *planner)
{
    const planner_lift *l = &planner->clear.best_lift;
    planner_hand *h = &planner->hand[l->hand];
    if (!(l->end > 0) || !lift_from(h, l, planner->now + LEAST_AHEAD))
        return false;
    h->lift = *l;
    return true;
}

/// Makes the best change. True if a stroke is played in another way, so that its hand has to be
/// planned again.
static bool end_search(himc_planner *planner)
{
    planner_clear *c = &planner->clear;
    try_nothing(c);
    c->searching = false;
    c->searched = c->plain.to;
    if (c->least.gap < 0)
        say_meet(planner);
    c->walk.near = himc_rehearsal_begin(0).near;
    if (c->best_way.touch > -HUGE_VAL)
        return true;
    if (lift_now(planner))
        walk_from(c, c->kept[1]);
    return false;
}

static void judge(planner_clear *c)
{
    c->trying = false;
    c->candidate++;
    if (!himc_rehearsal_is_better(&c->trial_walk.near, &c->least))
        return;
    c->least = c->trial_walk.near;
    c->best_lift = c->lift;
    c->best_way = c->way;
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
    bool lifts = c->lift.end > 0;
    c->trial_walk = lifts ? c->kept[1] : himc_rehearsal_begin(planner->now);
    return lifts ? 2 : PLANNING_WORK;
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
    int work = himc_rehearsal_step(&planner->config, walk, &c->lift, hand, c->searched);
    if (walk->t >= end || !himc_rehearsal_is_better(&walk->near, &c->least))
        judge(c);
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
        begin_search(c);
        return 1;
    }
    if (over)
        return 0;
    if (!near && c->walk.t > c->kept[0].t + KEPT_TIME) {
        c->kept[1] = c->kept[0];
        c->kept[0] = c->walk;
    }
    return himc_rehearsal_step(&planner->config, &c->walk, &c->lift, planner->hand, c->searched);
}

planner_wish himc_planner_search(himc_planner *planner, double work)
{
    planner_clear *c = &planner->clear;
    if (!planner->config.rehearse)
        return PLANNER_NO_WISH;
    c->credit = fmin(c->credit + work, MOST_CREDIT);
    while (c->credit > 0) {
        bool ends = c->searching && !c->trying && !goes_on(planner), begins = !c->trying;
        if (ends && end_search(planner))
            return PLANNER_MAKE;
        int done = !c->searching ? walk_on(planner)
                   : c->trying   ? try_on(planner)
                                 : try_next(planner);
        if (done == 0)
            c->credit = 0;
        c->credit -= done;
        c->work += done;
        if (begins && c->trying && c->way.touch > -HUGE_VAL)
            return PLANNER_TRY;
    }
    return PLANNER_NO_WISH;
}

void himc_planner_lift_again(himc_planner *planner, himc_hand hand, double t)
{
    planner_hand *h = &planner->hand[hand];
    const planner_lift *l = &h->lift;
    double touch = touch_after(h, t);
    bool same = touch == l->touch || fabs(touch - l->touch) < SAME_TOUCH; // or both infinite
    if (l->end > t && same && l->end <= h->plan.end)
        lift_from(h, l, t);
}
