/// planner_motion.c: strokes in their order become touches, touches become chunks of motion.
///
/// Each hand's plan is extended chunk by chunk from its own end, always to a point beyond the
/// horizon. Whatever changes (tempo, score, a hit, what was measured at separation) cuts the plan
/// and extends it again from the state there, so there is one way of planning and all joins are
/// alike. A touch less than 80 ms away is committed: no player could take it back. Invariant:
/// strokes of one hand are planned in the order of time, each at most once.
#include "planner_state.h"

#define FORESIGHT 3.0  // a stroke further away is not prepared yet (s)
#define EARLY 0.03     // a touch may come this much before its time (s)
#define AFTERGLOW 0.05 // and is the current one until this much after (s)
#define REBOUND 0.12   // a rise within this time of a touch is its rebound (s)
#define HIT_GAP 0.12   // between a hit and its neighbours (s)
#define SMALL 0.6      // a stroke smaller than this share of its height is worth a word
#define MOST_TRIES 32

static double touch_end(const planner_touch *touch)
{
    return touch->goal.time + HIMC_CONTACT_TIME;
}

/// The unit that fits best: of that nuance and hand, if possible of that grip and spot, and near in
/// speed.
static const himc_unit *find_unit(const himc_planner *planner, const himc_stroke *stroke)
{
    double speed = himc_gesture_of(stroke->nuance, stroke->dynamic).speed, least = HUGE_VAL;
    const himc_unit *best = NULL;
    for (int i = 0; i < planner->unit_count; i++) {
        const himc_unit *unit = &planner->unit[i];
        if (unit->nuance != stroke->nuance || unit->hand != stroke->hand)
            continue;
        bool elsewhere = unit->spot != HIMC_SPOT_XY && unit->spot != stroke->spot;
        double away =
            fabs(log(unit->speed / speed)) + 10 * elsewhere + 20 * (unit->grip != planner->grip);
        if (away < least) {
            least = away;
            best = unit;
        }
    }
    return best;
}

static himc_gesture gesture_of(const himc_planner *planner, const himc_stroke *stroke)
{
    const himc_unit *unit = planner->unit_count > 0 ? find_unit(planner, stroke) : NULL;
    return unit ? himc_gesture_from(unit, stroke->nuance, stroke->dynamic)
                : himc_gesture_of(stroke->nuance, stroke->dynamic);
}

himc_goal himc_planner_goal(himc_planner *planner, const himc_stroke *stroke, int drum, double t)
{
    const himc_place *place = &planner->place[drum];
    double x, y, limit = 0.97 * place->radius;
    himc_stroke_spot(stroke, place->radius, &x, &y);
    double r = hypot(x, y);
    if (r > limit) {
        himc_planner_say(planner, PLANNER_OUTSIDE,
                         "%s hand: %.3g %.3g is beyond the rim, struck inside it",
                         himc_hand_name(stroke->hand), x, y);
        x *= limit / r;
        y *= limit / r;
    }
    himc_goal goal = {.time = t, .normal = himc_place_normal(place)};
    goal.spot = himc_vec3_madd(himc_place_to_world(place, x, y), planner->config.mallet_radius,
                               goal.normal);
    goal.back = himc_vec3_scale(himc_place_away(place), -1);
    goal.gesture = gesture_of(planner, stroke);
    return goal;
}

/// The first stroke, of the score or a hit, that is not planned yet.
static bool next_touch(himc_planner *planner, himc_hand hand, planner_touch *touch)
{
    planner_hand *h = &planner->hand[hand];
    int index = 0, round = 0;
    double t = HUGE_VAL;
    const planner_stroke *s = himc_planner_next(planner, h, 0, &index, &round, &t);
    if (h->hits > 0 && h->hit[0].goal.time < t) {
        *touch = h->hit[0];
        touch->goal = himc_planner_goal(planner, &touch->stroke, touch->drum, touch->goal.time);
        return true;
    }
    if (!s)
        return false;
    *touch = (planner_touch){.stroke = s->stroke, .drum = s->drum, .index = index, .round = round};
    touch->goal = himc_planner_goal(planner, &s->stroke, s->drum, t);
    return true;
}

static void consume(planner_hand *h, const planner_touch *touch)
{
    if (touch->index >= 0) {
        h->next = touch->index + 1;
        h->round = touch->round;
        return;
    }
    h->hits--;
    for (int i = 0; i < h->hits; i++)
        h->hit[i] = h->hit[i + 1];
}

static double last_time(const planner_hand *h)
{
    return h->touches > 0 ? h->touch[h->touches - 1].goal.time : -HUGE_VAL;
}

static void say_given_up(himc_planner *planner, const planner_touch *touch)
{
    const char *hand = himc_hand_name(touch->stroke.hand);
    if (touch->index < 0)
        himc_planner_say(planner, PLANNER_GIVEN_UP, "hit %s: given up, no time to prepare it",
                         hand);
    else
        himc_planner_say(planner, PLANNER_GIVEN_UP,
                         "stroke at beat %g %s: given up, no time to prepare it",
                         touch->stroke.beat, hand);
}

static void say_smaller(himc_planner *planner, const planner_touch *touch, double since)
{
    double high = planner->hand[touch->stroke.hand].plan.last.gesture.height;
    if (touch->index >= 0 && since < 1 && high < SMALL * touch->goal.gesture.height)
        himc_planner_say(planner, PLANNER_SMALLER,
                         "stroke at beat %g %s: %.2g s after the last, played %.2g m high",
                         touch->stroke.beat, himc_hand_name(touch->stroke.hand), since, high);
}

static void plan_touch(himc_planner *planner, planner_hand *h, planner_touch *touch)
{
    double since = touch->goal.time - last_time(h);
    consume(h, touch);
    if (h->touches == PLANNER_TOUCHES || !himc_hand_strike(&h->plan, &touch->goal)) {
        say_given_up(planner, touch);
        return;
    }
    say_smaller(planner, touch, since);
    h->touch[h->touches] = *touch;
    h->touch[h->touches++].goal = h->plan.last;
}

void himc_planner_extend(himc_planner *planner, himc_hand hand, double until)
{
    planner_hand *h = &planner->hand[hand];
    for (int i = 0; i < MOST_TRIES && h->plan.end < until && himc_hand_room(&h->plan); i++) {
        planner_touch touch;
        bool more = next_touch(planner, hand, &touch);
        if (more && touch.goal.time < h->plan.end + FORESIGHT)
            plan_touch(planner, h, &touch);
        else
            himc_hand_wait(&h->plan, until, more);
    }
}

/// Takes a planned touch back to where it came from.
static void unplan(planner_hand *h, const planner_touch *touch)
{
    if (touch->index >= 0) {
        h->next = touch->index;
        h->round = touch->round;
        return;
    }
    if (h->hits == PLANNER_HITS)
        return;
    for (int i = h->hits++; i > 0; i--)
        h->hit[i] = h->hit[i - 1];
    h->hit[0] = *touch;
}

/// Takes back all touches more than `margin` after t.
static void unplan_after(planner_hand *h, double t, double margin)
{
    while (h->touches > 0 && h->touch[h->touches - 1].goal.time - margin > t)
        unplan(h, &h->touch[--h->touches]);
}

void himc_planner_cut(himc_planner *planner, himc_hand hand, double t)
{
    planner_hand *h = &planner->hand[hand];
    if (h->plan.end < t)
        himc_planner_extend(planner, hand, t);
    unplan_after(h, t, PLANNER_COMMIT);
    const planner_touch *last = h->touches > 0 ? &h->touch[h->touches - 1] : NULL;
    if (last && !last->parted)
        t = fmax(t, touch_end(last));
    himc_hand_cut(&h->plan, t);
    if (!last)
        return;
    h->plan.last = last->goal;
    h->plan.struck = h->plan.end - last->goal.time < REBOUND;
}

void himc_planner_replan(himc_planner *planner, double t)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_planner_cut(planner, (himc_hand)hand, t);
        himc_planner_extend(planner, (himc_hand)hand, t + PLANNER_HORIZON);
    }
}

void himc_planner_advance(himc_planner *planner, double t)
{
    planner->now = fmax(planner->now, t);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        planner_hand *h = &planner->hand[hand];
        int past = 0;
        while (past + 1 < h->touches && h->touch[past].goal.time + AFTERGLOW < planner->now)
            past++;
        for (int i = past; past > 0 && i < h->touches; i++)
            h->touch[i - past] = h->touch[i];
        h->touches -= past;
        himc_chain_drop(&h->plan.ground, planner->now);
        himc_chain_drop(&h->plan.lift, planner->now);
        himc_planner_extend(planner, (himc_hand)hand, planner->now + PLANNER_HORIZON);
    }
}

himc_target himc_planner_target(const himc_planner *planner, himc_hand hand, double t)
{
    return himc_hand_at(&planner->hand[hand].plan, t);
}

void himc_planner_separated(himc_planner *planner, himc_hand hand, double t,
                            const himc_target *measured)
{
    planner_hand *h = &planner->hand[hand];
    if (!isfinite(t) || !himc_vec3_finite(measured->x) || !himc_vec3_finite(measured->v) ||
        !himc_vec3_finite(measured->a))
        return;
    planner_touch next;
    unplan_after(h, t, EARLY);
    bool more = next_touch(planner, hand, &next);
    himc_hand_restart(&h->plan, t, measured, more ? next.goal.time : HUGE_VAL);
    if (h->touches > 0) {
        planner_touch *last = &h->touch[h->touches - 1];
        last->parted = true;
        h->plan.last = last->goal;
        h->plan.struck = t - last->goal.time < REBOUND;
    }
    himc_planner_extend(planner, hand, t + PLANNER_HORIZON);
}

/// Moves a hit's time behind any stroke that is too near; false if there is no gap.
static bool find_gap(const himc_planner *planner, const planner_hand *h, double *t)
{
    for (int tries = 0; tries < MOST_TRIES; tries++) {
        double clash = -HUGE_VAL;
        for (int i = 0; i < h->hits; i++)
            if (fabs(h->hit[i].goal.time - *t) < HIT_GAP)
                clash = fmax(clash, h->hit[i].goal.time);
        for (int i = 0; i < MOST_TRIES; i++) {
            int index, round;
            double scored;
            if (!himc_planner_next(planner, h, i, &index, &round, &scored) || scored > *t + HIT_GAP)
                break;
            if (scored > *t - HIT_GAP)
                clash = fmax(clash, scored);
        }
        if (clash == -HUGE_VAL)
            return true;
        *t = clash + 1.01 * HIT_GAP;
    }
    return false;
}

double himc_planner_hit(himc_planner *planner, double t, const himc_stroke *stroke, int drum)
{
    planner_hand *h = &planner->hand[stroke->hand];
    if (drum < 0 || drum >= HIMC_DRUMS || !isfinite(t))
        return HUGE_VAL;
    himc_planner_cut(planner, stroke->hand, t);
    planner_touch hit = {.stroke = *stroke, .drum = drum, .index = -1};
    hit.goal = himc_planner_goal(planner, stroke, drum, t);
    double touch = h->plan.end + himc_hand_least_time(&h->plan, &hit.goal);
    if (h->hits == PLANNER_HITS || !find_gap(planner, h, &touch)) {
        himc_planner_say(planner, PLANNER_CROWDED, "hit %s: given up, others are waiting",
                         himc_hand_name(stroke->hand));
        touch = HUGE_VAL;
    } else {
        hit.goal.time = touch;
        int i = h->hits++;
        for (; i > 0 && h->hit[i - 1].goal.time > touch; i--)
            h->hit[i] = h->hit[i - 1];
        h->hit[i] = hit;
    }
    himc_planner_extend(planner, stroke->hand, t + PLANNER_HORIZON);
    return touch;
}

/// Until when a touch is the current one, given the next.
static double window_end(const planner_touch *touch, double next)
{
    return touch->goal.time + fmin(AFTERGLOW, 0.5 * (next - touch->goal.time));
}

bool himc_planner_current(const himc_planner *planner, himc_hand hand, double t,
                          himc_stroke *stroke, int *drum, double *contact_time)
{
    const planner_hand *h = &planner->hand[hand];
    for (int i = 0; i < h->touches; i++) {
        double next = i + 1 < h->touches ? h->touch[i + 1].goal.time : HUGE_VAL;
        if (t > window_end(&h->touch[i], next))
            continue;
        *stroke = h->touch[i].stroke;
        *drum = h->touch[i].drum;
        *contact_time = h->touch[i].goal.time;
        return true;
    }
    int index, round;
    const planner_stroke *s = himc_planner_next(planner, h, 0, &index, &round, contact_time);
    if (!s)
        return false;
    *stroke = s->stroke;
    *drum = s->drum;
    return true;
}
