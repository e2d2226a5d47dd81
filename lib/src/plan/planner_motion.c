/// planner_motion.c: strokes in their order become touches, touches become chunks of motion.
///
/// Each hand's plan is extended chunk by chunk from its own end, always to a point beyond the
/// horizon. Whatever changes (tempo, score, a hit, what was measured at separation) cuts the plan
/// and extends it again from the state there, so there is one way of planning and all joins are
/// alike. A touch less than 80 ms away is committed: no player could take it back. Invariant:
/// strokes of one hand are planned in the order of time, each at most once.
#include "plan/planner_state.h"
#include "base/head_frame.h"

#define FORESIGHT 3.0  // a stroke further away is not prepared yet (s)
#define EARLY 0.03     // a touch may come this much before its time (s)
#define AFTERGLOW 0.05 // and is the current one until this much after (s)
#define REBOUND 0.12   // a rise within this time of a touch is its rebound (s)
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
    const himc_head_frame *place = &planner->place[drum];
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
    himc_goal goal = {.time = t, .normal = himc_head_frame_normal(place)};
    goal.spot = himc_vec3_madd(himc_head_frame_to_world(place, x, y), planner->config.mallet_radius,
                               goal.normal);
    goal.back = himc_vec3_scale(himc_head_frame_away(place), -1);
    goal.gesture = gesture_of(planner, stroke);
    return goal;
}

/// A lent stroke keeps its beat, a hit its time.
static double hit_time(const himc_planner *planner, const planner_touch *hit)
{
    if (!hit->lent)
        return hit->goal.time;
    double begun = hit->round == 0 ? 0 : hit->round * himc_planner_turn(planner);
    return begun + himc_planner_time_of(planner, hit->stroke.beat);
}

/// The first stroke, of the score or a hit, that is not planned yet.
static bool next_touch(himc_planner *planner, himc_hand hand, planner_touch *touch)
{
    planner_hand *h = &planner->hand[hand];
    int index = 0, round = 0;
    double t = HUGE_VAL;
    const planner_stroke *s = himc_planner_next(planner, h, 0, &index, &round, &t);
    if (h->hits > 0 && hit_time(planner, &h->hit[0]) < t) {
        *touch = h->hit[0];
        touch->goal =
            himc_planner_goal(planner, &touch->stroke, touch->drum, hit_time(planner, touch));
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

/// Whether the stroke, just planned, is much smaller than written.
static bool is_small(himc_planner *planner, const planner_touch *touch, double since)
{
    double high = planner->hand[touch->stroke.hand].plan.last.gesture.height;
    if (touch->index < 0 || since >= 1 || high >= SMALL * touch->goal.gesture.height)
        return false;
    himc_planner_say(planner, PLANNER_SMALLER,
                     "stroke at beat %g %s: %.2g s after the last, played %.2g m high",
                     touch->stroke.beat, himc_hand_name(touch->stroke.hand), since, high);
    return true;
}

static bool is_settled(const himc_planner *planner, const planner_touch *touch)
{
    const planner_hand *h = &planner->hand[touch->stroke.hand];
    return touch->index >= 0 &&
           h->list[touch->index].settled == himc_planner_turn_name(planner, touch->round);
}

/// A stroke that cannot follow the one just planned goes to the other hand while that has time.
static void look_ahead(himc_planner *planner, himc_hand hand)
{
    const planner_hand *h = &planner->hand[hand];
    planner_touch next;
    if (!next_touch(planner, hand, &next) || next.index < 0 || is_settled(planner, &next) ||
        himc_planner_too_far(planner, &next))
        return;
    if (!himc_hand_can_strike(&h->plan, &next.goal))
        himc_planner_no_time(planner, &next);
}

static void plan_touch(himc_planner *planner, planner_hand *h, planner_touch *touch)
{
    double since = touch->goal.time - last_time(h);
    consume(h, touch);
    if (is_settled(planner, touch) || himc_planner_too_far(planner, touch))
        return;
    if (h->touches == PLANNER_TOUCHES || !himc_hand_strike(&h->plan, &touch->goal)) {
        himc_planner_no_time(planner, touch);
        return;
    }
    touch->small = is_small(planner, touch, since);
    h->touch[h->touches] = *touch;
    h->touch[h->touches++].goal = h->plan.last;
    look_ahead(planner, touch->stroke.hand);
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
        himc_spline_drop(&h->plan.ground, planner->now);
        himc_spline_drop(&h->plan.lift, planner->now);
        himc_planner_extend(planner, (himc_hand)hand, planner->now + PLANNER_HORIZON);
    }
}

himc_target himc_planner_target(const himc_planner *planner, himc_hand hand, double t)
{
    return himc_hand_at(&planner->hand[hand].plan, t);
}

static bool is_finite(double t, const himc_target *s)
{
    return isfinite(t) && himc_vec3_finite(s->x) && himc_vec3_finite(s->v) &&
           himc_vec3_finite(s->a);
}

void himc_planner_resume(himc_planner *planner, double t, himc_hand hand, const himc_target *state)
{
    planner_hand *h = &planner->hand[hand];
    if (!is_finite(t, state))
        return;
    unplan_after(h, t, 0);
    h->touches = 0;
    himc_hand_restart(&h->plan, t, state, HUGE_VAL);
    h->plan.struck = false;
    himc_planner_extend(planner, hand, t + PLANNER_HORIZON);
}

void himc_planner_separated(himc_planner *planner, himc_hand hand, double t,
                            const himc_target *measured)
{
    planner_hand *h = &planner->hand[hand];
    planner_touch next;
    if (!is_finite(t, measured))
        return;
    unplan_after(h, t, EARLY);
    bool more = next_touch(planner, hand, &next);
    himc_hand_restart(&h->plan, t, measured, more ? next.goal.time : HUGE_VAL);
    if (h->touches > 0) {
        planner_touch *last = &h->touch[h->touches - 1];
        planner->smaller += last->small && !last->parted;
        last->parted = true;
        h->plan.last = last->goal;
        h->plan.struck = t - last->goal.time < REBOUND;
    }
    himc_planner_extend(planner, hand, t + PLANNER_HORIZON);
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
