/// planner_hits.c: what is asked for while it happens: strokes, and tips led to a place.
///
/// A hit without a time comes as soon as its gesture allows, later if it was asked for in a hurry:
/// nothing is lost, and nothing is even. A hit with a time of touch, its message plus a constant
/// latency, keeps that time to the end: the law of haste (gesture.c) makes it as strong as that
/// time allows, so hits at one latency are alike. Because the latency is longer than most
/// intervals, the next hit is known before the last one has landed.
///
/// The hand asked for plays it, if it has LEAST_PREPARATION after its stroke before, can get there,
/// and leaves as much to its stroke after; else the other hand. Where the performer chooses, the
/// cheaper hand plays: far, short and crossed ways cost, a hand that has just struck costs, so on
/// one drum between both hands they alternate. Where no hand has time, one without other strokes to
/// come plays late, by as little as its way there needs; else the hit is given up. Both are
/// counted.
/// Choosing changes nothing; only the plan of the hand that plays is cut.
///
/// A tip is led, by live targets or to lie on a head, while no stroke is near.
#include "plan/planner_state.h"
#include "plan/sticking.h"

#define QUEUED_HITS 4 // without a time; chosen: a player remembers no more
/// Time a hand has for a hit, at least (s). Chosen: with less a mezzo forte loses more than 5 dB.
#define LEAST_PREPARATION 0.06
#define SOON 0.15     // a hit without a time is expected so soon, to choose its hand (s)
#define SETTLING 0.03 // chosen: from the end of a contact until the tip is under way again (s)
#define LATER 0.01    // chosen: a hit that is late is tried so much later again (s) ...
#define LATEST 0.5    // ... up to this; chosen: the longest way at ease

/// Until so long before its touch a hit still gives way to the one that follows it, so that the
/// first hit of a fast run is as strong as the rest (s). Chosen: LEAST_STROKE_TIME (hand.c) and a
/// task's period. The rest of its latency is the time a hit has: then there is no interval at which
/// the first one has more.
#define GIVES_WAY 0.024

#define LOUDER \
    1.06 // a tip that is too high and has no time may strike so much harder; chosen: 0.5 dB

// a tip that has drifted from its plan; chosen: what a tenth of the time left can make good
#define CORRECTION_TIME 0.01 // before the touch (s)
#define LEAST_DRIFT 0.00005  // a smaller one is not heard (s at the speed of the touch) ...
#define LARGEST_DRIFT 0.001  // ... and a larger one is a disturbance

#define ON_SPOT 0.03 // chosen: so short a way is none: a spot scatters as much (m)
// chosen: a way on the drum over which the hand waits costs so much of another, so that the hands
// take turns all over it
#define OVER_DRUM 0.25
// chosen: 10 ms sooner is worth 0.7 m of way, 6 ms the other side of the other hand
#define LATE_COST 100.0 // (1/s)

// a hand that is led
#define LIFT_TIME 0.5 // of a hand that has lain on a head, to its rest (s); chosen: without haste
#define TARGET_STROKE 0.6 // a stroke so near is prepared, live targets are not followed (s)

/// Strokes of a hand next to a time; their times are infinite if there are none.
typedef struct neighbours {
    himc_goal before, after;
    bool scored; ///< the one after is of the score
} neighbours;

static void keep_nearer(neighbours *n, double at, const himc_goal *goal, double time, bool scored)
{
    himc_goal *side = time <= at ? &n->before : &n->after;
    if (time <= at ? time < side->time : time > side->time)
        return;
    *side = *goal;
    side->time = time;
    if (time > at)
        n->scored = scored;
}

static neighbours neighbours_at(himc_planner *planner, himc_hand hand, double at)
{
    const planner_hand *h = &planner->hand[hand];
    neighbours n = {{.time = -HUGE_VAL}, {.time = HUGE_VAL}, false};
    planner_due due = {.time = -HUGE_VAL};
    for (int i = 0; i < h->planned_count; i++) {
        himc_goal goal = h->planned[i].goal;
        goal.gesture = h->planned[i].written.gesture; // not as haste has bent it
        keep_nearer(&n, at, &goal, goal.time, h->planned[i].place.number >= 0);
    }
    for (int i = 0; i < h->waiting_count; i++)
        keep_nearer(&n, at, &h->waiting[i].goal, himc_planner_waiting_time(planner, &h->waiting[i]),
                    h->waiting[i].reassigned);
    for (int i = 0; due.time <= at; i++) {
        if (!himc_planner_score_next(&planner->score, hand, i, &due))
            break;
        himc_goal goal = himc_planner_goal(planner, &due.stroke, due.drum, due.time);
        keep_nearer(&n, at, &goal, due.time, true);
    }
    return n;
}

/// A hand's way to a hit.
typedef struct chance {
    himc_goal goal; ///< at the time at which the hand can play it first
    double late;    ///< so much after the time asked for (s); infinite: never
    bool reaches;
    neighbours near;
    bool idle;      ///< no stroke of the hand is under way or to come before the hit
    bool over;      ///< its last stroke was on that drum
    himc_vec3 from; ///< where the tip comes from (m)
} chance;

/// Whether a hand gets from one stroke to the next.
static bool can_follow(const himc_goal *first, const himc_goal *second)
{
    himc_goal settled = *first;
    settled.time += SETTLING;
    return himc_hand_can_follow(&settled, second);
}

/// Whether a fall at once from where the tip is at t would not be louder than the gesture.
static bool lands_softly(const planner_hand *h, double t, const himc_goal *goal, double speed)
{
    return himc_hand_least_speed(&h->plan, t, goal) <= LOUDER * speed;
}

/// Whether the hand has time for the hit before and after it.
static bool has_time(const himc_planner *planner, himc_hand hand, double t, double least,
                     const chance *c)
{
    const planner_hand *h = &planner->hand[hand];
    const himc_goal *goal = &c->goal, *after = &c->near.after;
    double at = goal->time, before = himc_goal_end(&c->near.before);
    if (at - fmax(t, before) < least || after->time - at < least + HIMC_CONTACT_TIME)
        return false;
    if (c->idle) { // strikes no louder than the time before the hit allows: else it comes later
        double time = fmax(at - t - GIVES_WAY, GIVES_WAY);
        himc_gesture hurried = himc_gesture_bend(goal->gesture, HIMC_HURRY * time);
        if (!himc_hand_can_strike_from(&h->plan, t, goal) ||
            !lands_softly(h, t, goal, hurried.speed) ||
            !himc_planner_bends_to(planner, hand, t, goal))
            return false;
    } else if (!can_follow(&c->near.before, goal)) {
        return false;
    }
    if (isinf(after->time))
        return true;
    // a stroke of the score after the hit stays as strong as it would be without it
    double now = himc_goal_hurry(goal->spot, after->spot) * (after->time - himc_goal_end(goal)),
           without = himc_goal_hurry(c->near.before.spot, after->spot) * (after->time - before);
    return can_follow(goal, after) &&
           (!c->near.scored ||
            himc_gesture_bend(after->gesture, now).speed >=
                PLANNER_AS_STRONG * himc_gesture_bend(after->gesture, without).speed);
}

static chance chance_of(himc_planner *planner, himc_hand hand, double t, const himc_hit *hit)
{
    const planner_hand *h = &planner->hand[hand];
    himc_stroke own = *hit->stroke;
    own.hand = hand;
    chance c = {.goal = himc_planner_goal(planner, &own, hit->drum, hit->at)};
    c.near = neighbours_at(planner, hand, hit->at);
    c.idle = himc_goal_end(&c.near.before) < t;
    c.over = h->drum == hit->drum;
    c.from = c.idle ? himc_hand_at(&h->plan, t).x : c.near.before.spot;
    c.reaches = himc_planner_reaches(planner, hand, c.goal.spot);
    // delayed to the first time at which the hand can play it; for one with strokes to come that is
    // the time asked for, or none
    double least = fmin(LEAST_PREPARATION, hit->at - t);
    bool room = h->waiting_count + h->planned_count < PLANNER_WAITING;
    for (c.late = 0; c.reaches && room && c.late < LATEST; c.late += LATER) {
        c.goal.time = hit->at + c.late;
        if (has_time(planner, hand, t, least, &c))
            return c;
        if (!c.idle)
            break;
    }
    c.late = HUGE_VAL;
    return c;
}

/// What the hit costs a hand; `other` is the other hand's chance.
static double cost_of(himc_hand hand, const chance *c, const chance *other)
{
    himc_vec3 to = himc_vec3_sub(c->goal.spot, c->from), n = c->goal.normal;
    double way = himc_vec3_length(himc_vec3_madd(to, -himc_vec3_dot(to, n), n)); // along the head
    double aside = c->goal.spot.y - other->from.y; // the left hand is towards +y
    himc_sticking s = {
        .gap = c->goal.time - c->near.before.time,
        .waits = c->idle,
        .way = way < ON_SPOT ? 0
               : c->over     ? OVER_DRUM * way
                             : way,
        .same_spot = himc_vec3_length(himc_vec3_sub(c->goal.spot, c->near.before.spot)) < ON_SPOT,
        .inwards = hand == HIMC_LEFT ? -aside : aside,
        .other_gap = other->goal.time - other->near.before.time};
    return himc_sticking_cost(&s) + LATE_COST * c->late;
}

/// The hand that plays a hit: the one asked for if it is on time, else the other if that one is, or
/// if it alone can come. When both are late a change gains little, and the other has to reach
/// across.
static himc_hand choose_hand(himc_planner *planner, double t, const himc_hit *hit, chance *chosen)
{
    chance c[HIMC_HANDS];
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        c[hand] = chance_of(planner, (himc_hand)hand, t, hit);
    himc_hand best = hit->stroke->hand;
    if (best == HIMC_HAND_ANY)
        best = cost_of(HIMC_LEFT, &c[HIMC_LEFT], &c[HIMC_RIGHT]) <
                       cost_of(HIMC_RIGHT, &c[HIMC_RIGHT], &c[HIMC_LEFT])
                   ? HIMC_LEFT
                   : HIMC_RIGHT;
    himc_hand other = himc_other_hand(best);
    if (c[other].late < c[best].late && (c[other].late == 0 || isinf(c[best].late)) && !hit->alone)
        best = other;
    *chosen = c[best];
    return best;
}

static timed_stroke stroke_of(himc_planner *planner, const himc_hit *hit, himc_hand hand)
{
    timed_stroke s = {.stroke = *hit->stroke, .drum = hit->drum, .place = {-1, -1, 0}};
    s.stroke.hand = hand;
    s.variation = himc_human_hit(&planner->human, hand, planner->hits++);
    return s;
}

static bool is_hit(const himc_hit *hit, double t)
{
    return hit->drum >= 0 && hit->drum < HIMC_DRUMS && isfinite(t) && isfinite(hit->at);
}

double himc_planner_hit(himc_planner *planner, double t, const himc_stroke *stroke, int drum)
{
    chance chosen;
    himc_hit asked = {.stroke = stroke, .drum = drum, .at = t + SOON};
    himc_hand hand = stroke->hand;
    if (!is_hit(&asked, t))
        return HUGE_VAL;
    if (hand == HIMC_HAND_ANY)
        hand = choose_hand(planner, t, &asked, &chosen);
    planner_hand *h = &planner->hand[hand];
    himc_planner_cut(planner, hand, t);
    timed_stroke hit = stroke_of(planner, &asked, hand);
    hit.goal = himc_planner_goal(planner, &hit.stroke, drum, t);
    double touch = h->plan.end + himc_hand_least_time(&h->plan, &hit.goal) + hit.variation.late;
    if (h->waiting_count >= QUEUED_HITS || !himc_planner_find_gap(planner, hand, &touch)) {
        char name[HIMC_PLANNER_NAME];
        himc_planner_say(planner, PLANNER_CROWDED, "%s: given up, others are waiting",
                         himc_planner_name(planner, &hit, name));
        himc_planner_notes_miss(&planner->notes, &(himc_planner_miss){hit.stroke, drum, true, touch,
                                                                      "others are waiting"});
        touch = HUGE_VAL;
    } else {
        hit.goal.time = touch;
        himc_planner_queue(planner, &hit);
    }
    himc_planner_extend(planner, hand, t + PLANNER_HORIZON);
    return touch;
}

double himc_planner_hit_at(himc_planner *planner, double t, const himc_hit *hit)
{
    chance chosen;
    if (!is_hit(hit, t))
        return HUGE_VAL;
    himc_hand hand = choose_hand(planner, t, hit, &chosen);
    timed_stroke s = stroke_of(planner, hit, hand);
    s.goal = chosen.goal;
    // planning says how far a drum is that is out of reach
    if (chosen.reaches && isinf(chosen.late)) {
        s.goal.time = hit->at;
        himc_planner_give_up_hit(planner, &s, t);
        return HUGE_VAL;
    }
    if (chosen.reaches && chosen.late > 0)
        himc_planner_notes_hit(&planner->notes, t, chosen.late);
    // once: who asked for a hand should know that it is not bound
    if (hit->stroke->hand != HIMC_HAND_ANY && hit->stroke->hand != hand)
        himc_planner_say(planner, PLANNER_OTHER_HAND,
                         "hit %s: the %s hand plays it, which can be there in time",
                         himc_hand_name(hit->stroke->hand), himc_hand_name(hand));
    s.exact = true;
    s.goal.time += s.variation.late;
    s.latency = fmax(s.goal.time - t - GIVES_WAY, GIVES_WAY);
    // the last planned stroke gives way, but not one that falls already, and planned anew would be
    // louder
    const planner_hand *h = &planner->hand[hand];
    const timed_stroke *last = h->planned_count > 0 ? &h->planned[h->planned_count - 1] : NULL;
    bool soft = !last || lands_softly(h, t, &last->goal, last->goal.gesture.speed);
    himc_planner_unplan(planner, hand, t, soft ? GIVES_WAY : last->goal.time - t);
    himc_planner_cut(planner, hand, t);
    himc_planner_queue(planner, &s);
    himc_planner_extend(planner, hand, t + PLANNER_HORIZON);
    return s.goal.time;
}

bool himc_planner_correct(himc_planner *planner, himc_hand hand, double t,
                          const himc_target *measured)
{
    planner_hand *h = &planner->hand[hand];
    int i = himc_planner_next_planned(h, t);
    if (i == h->planned_count || !h->planned[i].exact ||
        h->planned[i].goal.time - t > CORRECTION_TIME)
        return false;
    h->planned[i].exact = false;
    himc_goal goal = h->planned[i].goal;
    himc_target planned = himc_hand_at(&h->plan, t);
    himc_target from = {measured->x, measured->v, planned.a};
    double drift = himc_vec3_length(himc_vec3_sub(measured->x, planned.x)) / goal.gesture.speed;
    if (!(drift > LEAST_DRIFT && drift < LARGEST_DRIFT) || !himc_target_finite(&from))
        return false;
    himc_planner_unplan(planner, hand, goal.time, 0);
    himc_hand_land(&h->plan, t, &from, &goal);
    himc_planner_changed(planner, t);
    himc_planner_extend(planner, hand, t + PLANNER_HORIZON);
    return true;
}

/// Whether a stroke of the hand is so near that it must be prepared now.
static bool stroke_is_near(const himc_planner *planner, himc_hand hand, double t)
{
    const planner_hand *h = &planner->hand[hand];
    planner_due due;
    double end = t + TARGET_STROKE;
    return himc_planner_touch_after(h, t) < end ||
           (h->waiting_count > 0 && h->waiting[0].goal.time < end) ||
           (himc_planner_score_next(&planner->score, hand, 0, &due) && due.time < end);
}

void himc_planner_reach(himc_planner *planner, double t, himc_hand hand, himc_vec3 x)
{
    if (!isfinite(t) || !himc_vec3_finite(x))
        return;
    planner_hand *h = &planner->hand[hand];
    bool stream = himc_stream_add(&h->stream, t, x);
    if (stroke_is_near(planner, hand, t))
        return;
    himc_planner_cut(planner, hand, t);
    if (stream && himc_hand_room(&h->plan))
        himc_stream_follow(&h->stream, &h->plan, t);
    else
        himc_hand_reach(&h->plan, x, 0);
    h->targeted = true;
    himc_planner_extend(planner, hand, t + PLANNER_HORIZON);
}

bool himc_planner_lay(himc_planner *planner, double t, himc_hand hand, himc_vec3 x, double at)
{
    if (!isfinite(t) || stroke_is_near(planner, hand, t) ||
        !himc_planner_reaches(planner, hand, x) || himc_planner_meets_at(planner, t, hand, x))
        return false;
    himc_planner_cut(planner, hand, t);
    himc_hand_reach(&planner->hand[hand].plan, x, at);
    planner->hand[hand].targeted = true;
    himc_planner_extend(planner, hand, t + PLANNER_HORIZON);
    return true;
}

bool himc_planner_lift(himc_planner *planner, double t, himc_hand hand)
{
    bool lifted =
        himc_planner_lay(planner, t, hand, himc_planner_rest_place(planner, hand), t + LIFT_TIME);
    planner->hand[hand].targeted = false;
    return lifted;
}
