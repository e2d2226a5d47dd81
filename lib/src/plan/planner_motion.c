/// planner_motion.c: goals become motion of the two tips.
///
/// Each hand's plan is extended stroke by stroke from its own end, always to a point beyond the
/// horizon. Every change (of tempo or score, a hit, the measured state at separation) cuts the plan
/// and extends it again from the state there, so there is one way of planning and all joins are
/// alike. A stroke less than 80 ms away is committed: no player could take it back.
///
/// Planning a stroke has a result: planned, too far away, or no time to prepare it. In the last two
/// cases it is reassigned to the other hand, or given up. Only a stroke of the score is reassigned,
/// once, and only if the other hand has nothing else within HIT_GAP and is there in time; a player
/// would rather leave a stroke out than disturb another one. Meanwhile the other hand's own strokes
/// are not reassigned in turn, so two hands are all that one call plans.
///
/// A hit is a stroke with a time instead of a beat; it waits in a short queue of its hand, and so
/// does a reassigned stroke, which keeps its beat. Invariants: strokes of one hand are planned in
/// the order of time; each is played once, or given up and counted.
#include "plan/planner_state.h"
#include "plan/sticking.h"
#include "plan/bounce.h"
#include "base/format.h"

// when a stroke is planned; chosen: a player cannot take back the second half of a fall, and
// prepares no stroke more than a slow bar ahead
#define COMMIT_TIME 0.08    // a stroke so near is not changed any more (s)
#define PREPARED_AHEAD 3.0  // a stroke further away is not prepared yet (s)
#define PREPARED_MARGIN 0.5 // by which a human may play it early, and more; chosen (s)
#define LATEST 0.1          // a stroke of the score is not played later than so much (s); chosen
#define LATE_STEP 0.005     // it is tried so much later again (s)
#define MOST_TRIES 32       // of one search; chosen: twice the strokes that can be planned

// the measured touch against the planned one; chosen: a tip bounces once within 0.12 s, and strokes
// are rarely nearer than 0.1 s
#define EARLY_TOUCH 0.03 // a touch may come so much before its time (s)
#define BOUNCE_TIME 0.12 // a rise so soon after a touch is its rebound (s)

// room for hits and reassigned strokes; chosen: a legato needs 0.115 s at least (hand.c)
#define HIT_GAP 0.12        // to the strokes before and after (s)
#define HIT_GAP_MARGIN 1.01 // a hit that is moved comes so many gaps later

#define LIFT_MARGIN \
    1.001               // of the quickest lift's time: it is possible in spite of rounding; chosen
#define SAME_TOUCH 1e-6 // (s); chosen

#define HOME_MOVED 1e-4 // (m) a smaller change of the resting place moves nothing; chosen

/// What has become of a stroke that was to be planned.
typedef enum plan_result { PLANNED, TOO_FAR, NO_TIME, MEETS, LEFT_OUT, UNSOUND } plan_result;

void himc_planner_changed(himc_planner *planner, double t)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        planner->hand[hand].checked = fmin(planner->hand[hand].checked, t);
    if (!planner->clear.planning)
        planner->changed = fmin(planner->changed, t);
}

const timed_stroke *himc_planner_current_planned(const planner_hand *h, double t)
{
    for (int i = 0; i < h->planned_count; i++) {
        const timed_stroke *s = &h->planned[i];
        double next = i + 1 < h->planned_count ? s[1].goal.time : HUGE_VAL;
        if (t <= s->goal.time + fmin(PLANNER_CURRENT, 0.5 * (next - s->goal.time)))
            return s;
    }
    return NULL;
}

int himc_planner_next_planned(const planner_hand *h, double t)
{
    int k = 0;
    while (k < h->planned_count && h->planned[k].goal.time <= t)
        k++;
    return k;
}

double himc_planner_touch_after(const planner_hand *h, double t)
{
    int k = himc_planner_next_planned(h, t);
    return k < h->planned_count ? h->planned[k].goal.time : HUGE_VAL;
}

double himc_planner_lift_time(const planner_lift *l)
{
    return LIFT_MARGIN * himc_move_time(himc_vec3_length(l->way), HIMC_QUICK_MOVE);
}

bool himc_planner_lift_from(planner_hand *h, const planner_lift *l, double t)
{
    double begin = fmax(l->begin, t), from = fmax(l->from, begin + himc_planner_lift_time(l));
    return himc_hand_lift(&h->plan, begin, from, fmax(l->to, from), l->end, l->way);
}

double himc_planner_waiting_time(const himc_planner *planner, const timed_stroke *s)
{
    return s->reassigned ? himc_planner_score_touch(&planner->score, s->place.round, &s->stroke)
                         : s->goal.time;
}

static bool is_settled(const himc_planner *planner, himc_hand hand, const planner_place *place)
{
    return place->number >= 0 && himc_planner_score_is_settled(&planner->score, hand, place);
}

/// Bounces leave time for the hand's next stroke; none with the servo grip. The stroke is so many
/// `ahead` in the score.
static void fit_bounces(himc_planner *planner, timed_stroke *s, double t, int ahead)
{
    planner_due after;
    himc_stroke *stroke = &s->stroke;
    if (planner->servo)
        stroke->bounces = 0;
    if (stroke->bounces == 0 || s->place.number < 0)
        return;
    do {
        if (!himc_planner_score_next(&planner->score, stroke->hand, ++ahead, &after))
            return;
    } while (is_settled(planner, stroke->hand, &after.place) && ahead < MOST_TRIES);
    double most = himc_planner_bounce_most(planner, stroke->bounces, t, &after);
    stroke->bounce_time = fmin(stroke->bounce_time, most);
}

/// The next stroke of a hand, waiting or of the score and there so many `ahead`, as written; false
/// if there is none.
static bool written_at(himc_planner *planner, himc_hand hand, int ahead, timed_stroke *next)
{
    const planner_hand *h = &planner->hand[hand];
    planner_due due;
    bool scored = himc_planner_score_next(&planner->score, hand, ahead, &due);
    double t = scored ? due.time : HUGE_VAL;
    if (h->waiting_count > 0 && himc_planner_waiting_time(planner, &h->waiting[0]) < t) {
        *next = h->waiting[0];
        t = himc_planner_waiting_time(planner, next);
    } else if (scored) {
        *next = (timed_stroke){.stroke = due.stroke, .drum = due.drum, .place = due.place};
    } else {
        return false;
    }
    fit_bounces(planner, next, t, ahead);
    next->written = himc_planner_goal(planner, &next->stroke, next->drum, t);
    next->goal = next->written;
    next->varied = false;
    return true;
}

/// The next stroke of a hand that is not given up or reassigned already.
static bool next_written(himc_planner *planner, himc_hand hand, timed_stroke *next)
{
    for (int ahead = 0; ahead < MOST_TRIES && written_at(planner, hand, ahead, next); ahead++)
        if (!is_settled(planner, hand, &next->place))
            return true;
    return false;
}

/// The same as a human plays it.
static bool next_stroke(himc_planner *planner, himc_hand hand, timed_stroke *next)
{
    bool more = written_at(planner, hand, 0, next);
    if (more && planner->human.amount > 0)
        himc_planner_vary(planner, next);
    return more;
}

/// The next stroke of the score is that one, or the one of its hand after it.
static void go_to(himc_planner *planner, const timed_stroke *s, int after)
{
    planner_place place = s->place;
    place.number += place.roll < 0 ? after : 2 * after; // the hands take turns in a roll
    himc_planner_score_go(&planner->score, s->stroke.hand, place);
}

/// Takes the next stroke out of the score or of the queue.
static void take(himc_planner *planner, const timed_stroke *s)
{
    planner_hand *h = &planner->hand[s->stroke.hand];
    if (s->place.number >= 0) {
        go_to(planner, s, 1);
        return;
    }
    h->waiting_count--;
    for (int i = 0; i < h->waiting_count; i++)
        h->waiting[i] = h->waiting[i + 1];
}

void himc_planner_give_up_hit(himc_planner *planner, const timed_stroke *s, double t)
{
    himc_planner_notes_hit(&planner->notes, t, HUGE_VAL); // as late as never: it is counted as lost
    himc_planner_notes_miss(
        &planner->notes,
        &(himc_planner_miss){s->stroke, s->drum, true, s->goal.time, "no hand has the time"});
}

/// Puts a planned stroke back where it was taken from; a hit is dropped if no room is left.
static void put_back(himc_planner *planner, himc_hand hand, const timed_stroke *s)
{
    planner_hand *h = &planner->hand[hand];
    if (s->place.number >= 0) {
        go_to(planner, s, 0);
        return;
    }
    if (h->waiting_count == PLANNER_WAITING) {
        himc_planner_give_up_hit(planner, s, planner->now);
        return;
    }
    for (int i = h->waiting_count++; i > 0; i--)
        h->waiting[i] = h->waiting[i - 1];
    h->waiting[0] = *s;
    h->waiting[0].goal = s->written;
}

void himc_planner_queue(himc_planner *planner, const timed_stroke *s)
{
    planner_hand *h = &planner->hand[s->stroke.hand];
    int i = h->waiting_count++;
    for (; i > 0 && h->waiting[i - 1].goal.time > s->goal.time; i--)
        h->waiting[i] = h->waiting[i - 1];
    h->waiting[i] = *s;
}

static void settle(himc_planner *planner, const timed_stroke *s)
{
    if (s->place.number >= 0 && !planner->clear.planning)
        himc_planner_score_settle(&planner->score, s->stroke.hand, &s->place);
}

void himc_planner_rest_again(himc_planner *planner)
{
    for (int i = 0; i < HIMC_HANDS; i++) {
        planner_hand *h = &planner->hand[i];
        if (!planner->begun && h->planned_count == 0 && h->plan.at_home && !h->targeted)
            himc_hand_place(&h->plan, 0, himc_planner_rest_place(planner, (himc_hand)i));
    }
}

static const char *reason_of(const himc_planner *planner, const timed_stroke *s, plan_result result,
                             char text[48])
{
    if (result == TOO_FAR)
        himc_format(text, 48, "out of reach by %.2f m",
                    himc_planner_beyond(planner, s->stroke.hand, s->written.spot));
    else
        himc_format(text, 48, "%s",
                    result == NO_TIME   ? "no time to prepare it"
                    : result == UNSOUND ? "no body could make its motion"
                                        : "the hands would meet");
    return text;
}

/// The share of its `speed` that a stroke keeps for the sake of the one after it: as much as that
/// one, or this one if it is softer, keeps with the time between them. So the first stroke of a
/// fast run is one of it.
static double kept_before(const timed_stroke *s, double speed, const himc_goal *after)
{
    himc_gesture softer = after->gesture;
    double time = after->time - s->goal.time - s->goal.hold;
    if (!(time > 0))
        return 1;
    softer.speed = fmin(softer.speed, speed);
    double hurry = himc_goal_hurry(s->goal.spot, after->spot);
    return himc_gesture_bend(softer, hurry * time).speed / softer.speed;
}

/// The goal's gesture as strong as the time before it allows, by the law of haste (gesture.c).
static himc_gesture in_haste(himc_planner *planner, timed_stroke *s)
{
    const planner_hand *h = &planner->hand[s->stroke.hand];
    // speed for which there is time since its message, or since a touch
    double most = s->latency > 0 ? HIMC_HURRY * s->latency : HUGE_VAL;
    if (h->planned_count > 0) {
        const himc_goal *last = &h->planned[h->planned_count - 1].goal;
        most = fmin(most, himc_goal_hurry(last->spot, s->goal.spot) *
                              (s->goal.time - last->time - last->hold));
    }
    himc_gesture own = s->goal.gesture, g = himc_gesture_bend(own, most);
    timed_stroke after;
    bool more = next_written(planner, s->stroke.hand, &after);
    double share = more ? kept_before(s, own.speed, &after.written) : 1;
    s->gives_way = share * own.speed < g.speed;
    return s->gives_way ? himc_gesture_scale(own, share) : g;
}

/// Counts a stroke that was struck softer than asked for, and says so once; a plan may still change
/// before. That fingers have no time for its bounces has been said already.
static void tell_haste(himc_planner *planner, const timed_stroke *struck)
{
    char text[HIMC_PLANNER_NAME];
    double speed = struck->goal.gesture.speed;
    if (speed >= PLANNER_AS_STRONG * struck->asked)
        return;
    const char *name = himc_planner_name(planner, struck, text);
    if (struck->place.roll >= 0) {
        himc_format(text, sizeof text, "roll at beat %g",
                    planner->score.roll[struck->place.roll].stroke.beat);
        name = text;
    }
    himc_planner_notes_count(&planner->notes, PLANNER_HURRIED);
    if (speed >= PLANNER_AS_STRONG * himc_bounce_fastest(struck->stroke.bounces, struck->goal.hold))
        return;
    himc_planner_say(planner, struck->place.roll < 0 ? PLANNER_HURRIED : PLANNER_HURRIED_ROLL,
                     "%s: too little time for %.2g m/s, struck with %.2g", name, struck->asked,
                     speed);
}

/// Whether a varied stroke can be played, and leaves as much to the stroke after it as the written
/// one: a variation makes no stroke impossible.
static bool can_vary(himc_planner *planner, const timed_stroke *s)
{
    himc_hand hand = s->stroke.hand;
    timed_stroke after;
    if (!himc_planner_reaches(planner, hand, s->goal.spot) ||
        !himc_hand_can_strike(&planner->hand[hand].plan, &s->goal))
        return false;
    return !next_written(planner, hand, &after) || himc_hand_can_follow(&s->goal, &after.written) ||
           !himc_hand_can_follow(&s->written, &after.written);
}

/// Appends a stroke to its hand's plan, if the hand can play it; in the way found for it, if there
/// is one.
static plan_result plan_stroke(himc_planner *planner, timed_stroke *s)
{
    static const planner_way as_written;
    planner_hand *h = &planner->hand[s->stroke.hand];
    int n = h->planned_count;
    if (s->varied && !can_vary(planner, s)) {
        s->goal = s->written;
        s->varied = false;
    }
    const planner_way *way = h->way.touch == s->written.time ? &h->way : &as_written;
    if (!himc_planner_reaches(planner, s->stroke.hand, s->goal.spot))
        return TOO_FAR;
    if (way->leaves)
        return LEFT_OUT;
    if (way->other && s->place.number >= 0)
        return MEETS;
    s->yields = 0;
    s->goal.straight = way->straight;
    if (way->aside != 0) {
        himc_vec3 to = himc_planner_aside(planner, s, way->aside);
        s->yields = himc_vec3_length(himc_vec3_sub(to, s->goal.spot));
        s->goal.spot = to;
        s->varied = true;
    }
    if (way->waits) { // over the last spot, if that leaves the stroke all its time
        himc_hand_plan before = h->plan;
        himc_hand_wait(&h->plan, h->plan.end, true);
        if (h->plan.end + himc_hand_time(&h->plan, &s->goal) > s->goal.time)
            h->plan = before;
    }
    if (n == PLANNER_PLANNED || !himc_hand_can_strike(&h->plan, &s->goal))
        return NO_TIME;
    himc_goal goal = s->goal;
    goal.gesture = in_haste(planner, s);
    if (!himc_hand_strike(&h->plan, &goal))
        return NO_TIME;
    timed_stroke *planned = &h->planned[h->planned_count++];
    *planned = *s;
    planned->goal = h->plan.last;
    planned->asked = himc_planner_asked(planner, s);
    h->drum = s->drum;
    h->struck = true;
    h->targeted = false;
    return PLANNED;
}

/// Plans a hand's next stroke, or a wait before it. If the result is not PLANNED, `refused` is the
/// stroke that cannot be played: that one, or the one after it. The stroke before that one is put
/// back if it has given way to it, to be planned without it.
static plan_result plan_next(himc_planner *planner, himc_hand hand, double until,
                             timed_stroke *refused)
{
    planner_hand *h = &planner->hand[hand];
    timed_stroke next;
    bool more;
    while ((more = next_stroke(planner, hand, &next)) && is_settled(planner, hand, &next.place))
        take(planner, &next);
    if (!(more && next.goal.time < h->plan.end + PREPARED_AHEAD)) {
        himc_vec3 home =
            more || h->targeted ? h->plan.home : himc_planner_rest_place(planner, hand);
        if (himc_vec3_length(himc_vec3_sub(home, h->plan.home)) > HOME_MOVED) {
            h->plan.home = home;
            h->plan.at_home = false;
        }
        himc_hand_wait(&h->plan, until, more);
        return PLANNED;
    }
    take(planner, &next);
    himc_hand_plan before = h->plan;
    plan_result result = plan_stroke(planner, &next);
    *refused = next;
    if (result != PLANNED)
        return result;
    // the stroke of the score after it: asked now, while the other hand still has time to play it
    if (!next_written(planner, hand, refused) || refused->place.number < 0)
        return PLANNED;
    if (!himc_planner_reaches(planner, hand, refused->written.spot))
        result = TOO_FAR;
    else if (!himc_hand_can_strike(&h->plan, &refused->written))
        result = NO_TIME;
    if (result != PLANNED && next.gives_way && !planner->clear.planning) {
        h->plan = before;
        put_back(planner, hand, &h->planned[--h->planned_count]);
    }
    return result;
}

static bool has_to_plan(const planner_hand *h, double until, int tries)
{
    return tries < MOST_TRIES && h->plan.end < until && himc_hand_room(&h->plan);
}

void himc_planner_tell_next_round(himc_planner *planner, const himc_stroke *stroke)
{
    char name[HIMC_PLANNER_NAME];
    timed_stroke s = {.stroke = *stroke, .place = {-1, 0, -1}};
    himc_planner_say(planner, PLANNER_NEXT_ROUND,
                     "%s: no time to prepare it, it sounds from the next round on",
                     himc_planner_name(planner, &s, name));
}

/// Plays a stroke of the score as soon as its hand can, after a new tempo that has left it no time:
/// a stick that is up strikes. False where it would be much later, or has no time before the next
/// one.
static bool play_late(himc_planner *planner, const timed_stroke *s)
{
    const planner_hand *h = &planner->hand[s->stroke.hand];
    char name[HIMC_PLANNER_NAME];
    timed_stroke late = *s, after;
    const planner_part *part = &planner->score.part[s->stroke.hand];
    int next = part->listed.number;
    bool is_next = s->place.number >= 0 && s->place.roll < 0 &&
                   part->listed.round == s->place.round &&
                   (next == s->place.number || next == s->place.number + 1);
    if (!is_next || planner->clear.planning || s->written.time > planner->hastened)
        return false;
    go_to(planner, s, 1);
    bool more = next_written(planner, s->stroke.hand, &after);
    late.varied = false;
    for (double d = LATE_STEP; d < LATEST; d += LATE_STEP) {
        late.goal = s->written;
        late.goal.time += d;
        if (more && !himc_hand_can_follow(&late.goal, &after.written))
            return false;
        if (!himc_hand_can_strike(&h->plan, &late.goal) || plan_stroke(planner, &late) != PLANNED)
            continue;
        himc_planner_say(planner, PLANNER_DELAYED, "%s: %.0f ms late, no time to prepare it",
                         himc_planner_name(planner, s, name), 1e3 * d);
        return true;
    }
    return false;
}

/// No hand can play it: a line says so. One that the other hand has no time for is played all the
/// same; where the hands then meet, the search leaves it out.
static void give_up(himc_planner *planner, const timed_stroke *s, plan_result result)
{
    char name[HIMC_PLANNER_NAME];
    timed_stroke anyway = *s;
    himc_planner_miss miss = {s->stroke, s->drum, s->place.number < 0 && !s->reassigned,
                              s->written.time, ""};
    planner->hand[s->stroke.hand].way.other = false;
    if ((result == MEETS && plan_stroke(planner, &anyway) == PLANNED) ||
        (result == NO_TIME && play_late(planner, s)))
        return;
    if (result == NO_TIME && s->place.number >= 0 && s->place.roll < 0 &&
        planner->hand[s->stroke.hand].added == s->place.number + 1) {
        settle(planner, s);
        himc_planner_tell_next_round(planner, &s->stroke);
        return;
    }
    reason_of(planner, s, result, miss.why);
    settle(planner, s);
    himc_planner_tell_miss(planner, &miss, himc_planner_name(planner, s, name));
}

/// Each plan is checked once before it is played or continued, from where it was changed on. One
/// that no body could follow is dropped from there on, with its strokes: the hand goes to its rest,
/// at once where even the state there is not sound.
static void check_plan(himc_planner *planner, himc_hand hand)
{
    planner_hand *h = &planner->hand[hand];
    double t = fmax(h->checked, planner->now);
    if (h->checked != h->plan.end && !himc_hand_is_sound(&h->plan, t)) {
        while (h->planned_count > 0 && h->planned[h->planned_count - 1].goal.time > t)
            give_up(planner, &h->planned[--h->planned_count], UNSOUND);
        himc_planner_say(planner, PLANNER_DROPPED,
                         "%s hand: a motion that no body could make was dropped at %.3f s",
                         himc_hand_name(hand), t);
        h->targeted = false;
        h->plan.home = himc_planner_rest_place(planner, hand);
        h->plan.at_home = false;
        himc_hand_cut(&h->plan, t);
        himc_hand_wait(&h->plan, t, false);
        if (!himc_hand_is_sound(&h->plan, t))
            himc_hand_place(&h->plan, t, h->plan.home);
    }
    h->checked = h->plan.end;
}

typedef void planner_refuse(himc_planner *planner, const timed_stroke *s, plan_result result);

/// Plans a hand to `until`. Where so many strokes are refused that the tries do not get there, the
/// tip waits: no plan may end before it is played.
static void extend(himc_planner *planner, himc_hand hand, double until, planner_refuse *refuse)
{
    planner_hand *h = &planner->hand[hand];
    timed_stroke refused;
    check_plan(planner, hand);
    for (int i = 0; has_to_plan(h, until, i); i++) {
        plan_result result = plan_next(planner, hand, until, &refused);
        if (result != PLANNED)
            refuse(planner, &refused, result);
    }
    if (has_to_plan(h, until, 0))
        himc_hand_wait(&h->plan, until, true);
    check_plan(planner, hand);
}

void himc_planner_unplan(himc_planner *planner, himc_hand hand, double t, double margin)
{
    planner_hand *h = &planner->hand[hand];
    while (h->planned_count > 0 && h->planned[h->planned_count - 1].goal.time - margin > t)
        put_back(planner, hand, &h->planned[--h->planned_count]);
}

/// The plan, which reaches to t, ends there, or after the contact of a committed stroke.
static void cut_plan(himc_planner *planner, himc_hand hand, double t)
{
    planner_hand *h = &planner->hand[hand];
    himc_planner_unplan(planner, hand, t, COMMIT_TIME);
    const timed_stroke *last = h->planned_count > 0 ? &h->planned[h->planned_count - 1] : NULL;
    if (last && !last->separated)
        t = fmax(t, himc_goal_end(&last->goal));
    himc_hand_cut(&h->plan, t);
    himc_planner_changed(planner, t);
    if (!last)
        return;
    h->plan.last = last->goal;
    h->plan.rebounding = h->plan.end - last->goal.time < BOUNCE_TIME;
}

bool himc_planner_find_gap(const himc_planner *planner, himc_hand hand, double *t)
{
    const planner_hand *h = &planner->hand[hand];
    for (int tries = 0; tries < MOST_TRIES; tries++) {
        double clash = -HUGE_VAL;
        for (int i = 0; i < h->waiting_count; i++)
            if (fabs(h->waiting[i].goal.time - *t) < HIT_GAP)
                clash = fmax(clash, h->waiting[i].goal.time);
        for (int i = 0; i < MOST_TRIES; i++) {
            planner_due due;
            if (!himc_planner_score_next(&planner->score, hand, i, &due) || due.time > *t + HIT_GAP)
                break;
            if (due.time > *t - HIT_GAP && !is_settled(planner, hand, &due.place))
                clash = fmax(clash, due.time);
        }
        if (clash == -HUGE_VAL)
            return true;
        *t = clash + HIT_GAP_MARGIN * HIT_GAP;
    }
    return false;
}

/// Whether the hand gets from its own strokes to another one at its time, and on to the next.
static bool fits_in(himc_planner *planner, himc_hand hand, const himc_goal *goal)
{
    planner_due due = {.time = -HUGE_VAL};
    for (int i = 0; i < MOST_TRIES && due.time <= goal->time; i++) {
        if (!himc_planner_score_next(&planner->score, hand, i, &due))
            break;
        if (is_settled(planner, hand, &due.place))
            continue;
        himc_goal own = himc_planner_goal(planner, &due.stroke, due.drum, due.time);
        bool first = due.time <= goal->time;
        if (!himc_hand_can_follow(first ? &own : goal, first ? goal : &own))
            return false;
    }
    return true;
}

/// A stroke has been looked at out of turn.
static void look_at(himc_planner *planner, himc_hand hand, const planner_place *place)
{
    planner_part *part = &planner->score.part[hand];
    if (place->roll < 0 && place->number >= part->looked)
        part->looked = place->number + 1;
}

/// The other hand takes a stroke of the score, if it has nothing to do and is near enough; in a
/// hurry if it must, else its plan ends as early as it can.
static bool reassign(himc_planner *planner, const timed_stroke *s, bool hurries)
{
    himc_hand other = himc_other_hand(s->stroke.hand);
    planner_hand *h = &planner->hand[other];
    double from = planner->now + PLANNER_AHEAD;
    timed_stroke taken = *s;
    planner_due due;
    if (s->reassigned || s->place.number < 0)
        return false;
    if (h->plan.end < from)
        extend(planner, other, from, give_up);
    cut_plan(planner, other, from);
    taken.place = (planner_place){-1, -1, s->place.round};
    taken.reassigned = true;
    taken.stroke.hand = other;
    taken.goal = himc_planner_goal(planner, &taken.stroke, taken.drum, s->written.time);
    double t = taken.goal.time, gap = t;
    bool in_time = hurries ? himc_hand_can_strike(&h->plan, &taken.goal)
                           : t >= h->plan.end + himc_hand_least_time(&h->plan, &taken.goal);
    for (int i = 0; himc_planner_score_next(&planner->score, other, i, &due); i++) {
        look_at(planner, other, &due.place);
        if (due.time > t + HIT_GAP)
            break;
    }
    bool can = h->waiting_count < PLANNER_WAITING &&
               himc_planner_reaches(planner, other, taken.goal.spot) &&
               himc_planner_find_gap(planner, other, &gap) && gap == t && in_time &&
               fits_in(planner, other, &taken.goal);
    if (can)
        himc_planner_queue(planner, &taken);
    extend(planner, other, from + PLANNER_HORIZON, give_up);
    return can;
}

static void reassign_or_give_up(himc_planner *planner, const timed_stroke *s, plan_result result)
{
    char name[HIMC_PLANNER_NAME], reason[48];
    if (result == LEFT_OUT || !reassign(planner, s, result == MEETS)) {
        give_up(planner, s, result);
        return;
    }
    himc_planner_notes_count(&planner->notes, PLANNER_REASSIGNED);
    settle(planner, s);
    himc_planner_say(planner, PLANNER_REASSIGNED, "%s: %s, the %s hand plays it",
                     himc_planner_name(planner, s, name), reason_of(planner, s, result, reason),
                     himc_hand_name(himc_other_hand(s->stroke.hand)));
}

void himc_planner_extend(himc_planner *planner, himc_hand hand, double until)
{
    extend(planner, hand, until, reassign_or_give_up);
}

void himc_planner_cut(himc_planner *planner, himc_hand hand, double t)
{
    if (planner->hand[hand].plan.end < t)
        himc_planner_extend(planner, hand, t);
    cut_plan(planner, hand, t);
}

void himc_planner_cut_both(himc_planner *planner, double t)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        himc_planner_cut(planner, (himc_hand)hand, t);
}

void himc_planner_replan(himc_planner *planner, double t)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_planner_cut(planner, (himc_hand)hand, t);
        himc_planner_extend(planner, (himc_hand)hand, t + PLANNER_HORIZON);
    }
}

double himc_planner_looked_to(const himc_planner *planner, himc_hand hand, int *index)
{
    const planner_score *score = &planner->score;
    const planner_part *part = &score->part[hand];
    int next = part->listed.number;
    // a stroke that bounces leaves time to the one after it; rolls are among both
    bool bounces = next < part->count && part->list[next].stroke.bounces > 0;
    *index = next + (bounces || score->roll_count > 0 ? 2 : 1);
    *index = part->looked > *index ? part->looked : *index;
    return planner->hand[hand].plan.end + PREPARED_AHEAD + PREPARED_MARGIN;
}

bool himc_planner_may_be_next(himc_planner *planner, const himc_stroke *a, const himc_stroke *b,
                              int drum)
{
    const himc_stroke *either[] = {a, b};
    const planner_hand *h = &planner->hand[a->hand];
    himc_stroke as_a = *b;
    as_a.nuance = a->nuance;
    as_a.dynamic = a->dynamic;
    if (!himc_planner_score_same(a, &as_a) || a->bounces > 0)
        return false;
    bool silent = planner->notes.silent, good = true;
    double kept[2] = {1, 1}, time = himc_planner_score_touch(&planner->score, 0, a);
    planner->notes.silent = true;
    for (int i = 0; i < 2 && h->planned_count > 0; i++) {
        const timed_stroke *before = &h->planned[h->planned_count - 1];
        himc_goal goal = himc_planner_goal(planner, either[i], drum, time);
        kept[i] = kept_before(before, before->asked, &goal);
        good = good && before->stroke.bounces == 0 && himc_hand_can_strike(&h->plan, &goal) &&
               himc_hand_can_follow(&before->goal, &goal);
    }
    planner->notes.silent = silent;
    return good && kept[0] == kept[1];
}

double himc_planner_lateness(himc_planner *planner)
{
    double late = 0;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        const himc_hand_plan *plan = &planner->hand[hand].plan;
        planner_due due;
        if (!himc_planner_score_next(&planner->score, (himc_hand)hand, 0, &due))
            continue;
        himc_goal goal = himc_planner_goal(planner, &due.stroke, due.drum, due.time);
        if (goal.gesture.speed > HIMC_SLOWEST_GESTURE)
            late = fmax(late, plan->end + himc_hand_time(plan, &goal) - due.time);
    }
    return late;
}

/// A loop that turns without strokes begins again with those that it has got, on the next of its
/// beats for which they can be prepared.
static void fill_loop(himc_planner *planner)
{
    planner_score *score = &planner->score;
    double t = planner->now + PLANNER_AHEAD, count = score->origin;
    double beat = ceil(himc_score_beat(score->tempi, score->tempo_count, t - count));
    if (himc_planner_score_last_beat(score) < 0)
        return;
    himc_planner_cut_both(planner, t);
    double next = himc_planner_score_time(score, 0, beat),
           period = himc_planner_score_time(score, 0, beat + 1) - next;
    himc_planner_score_start(score, next);
    double late = ceil(himc_planner_lateness(planner) / period - BEAT_ROUNDING);
    score->origin += fmax(late, 0) * period;
    score->count = count;
    himc_planner_replan(planner, t);
}

void himc_planner_advance(himc_planner *planner, double t)
{
    planner->now = fmax(planner->now, t);
    planner->begun = true;
    if (planner->score.empties)
        fill_loop(planner);
    double now = planner->now;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        // drops the strokes that are past but the last, which may still bounce, and the motion
        // before now
        planner_hand *h = &planner->hand[hand];
        int past = 0;
        while (past + 1 < h->planned_count &&
               h->planned[past + 1].goal.time + PLANNER_CURRENT < now)
            past++;
        for (int i = past; past > 0 && i < h->planned_count; i++)
            h->planned[i - past] = h->planned[i];
        h->planned_count -= past;
        himc_spline_drop(&h->plan.tangential_path, now);
        himc_spline_drop(&h->plan.height_profile, now);
        if (h->plan.lift.count > 0)
            himc_spline_drop(&h->plan.lift, now);
        himc_planner_extend(planner, (himc_hand)hand, now + PLANNER_HORIZON);
    }
    himc_planner_notes_tell(&planner->notes, now);
}

void himc_planner_recover(himc_planner *planner, double t)
{
    himc_planner_changed(planner, -HUGE_VAL);
    himc_planner_advance(planner, t);
}

himc_target himc_planner_target(const himc_planner *planner, himc_hand hand, double t)
{
    return himc_hand_at(&planner->hand[hand].plan, t);
}

void himc_planner_resume(himc_planner *planner, double t, himc_hand hand, const himc_target *state)
{
    planner_hand *h = &planner->hand[hand];
    if (!isfinite(t) || !himc_target_finite(state))
        return;
    himc_planner_unplan(planner, hand, t, 0);
    h->planned_count = 0;
    himc_hand_restart(&h->plan, t, state, HUGE_VAL);
    himc_planner_changed(planner, t);
    h->plan.rebounding = false;
    himc_planner_extend(planner, hand, t + PLANNER_HORIZON);
}

void himc_planner_separated(himc_planner *planner, himc_hand hand, double t,
                            const himc_target *measured)
{
    planner_hand *h = &planner->hand[hand];
    timed_stroke next;
    if (!isfinite(t) || !himc_target_finite(measured))
        return;
    himc_planner_unplan(planner, hand, t, EARLY_TOUCH);
    bool more = next_stroke(planner, hand, &next);
    himc_hand_restart(&h->plan, t, measured, more ? next.goal.time : HUGE_VAL);
    if (h->planned_count > 0) {
        timed_stroke *last = &h->planned[h->planned_count - 1];
        if (!last->separated)
            tell_haste(planner, last);
        last->separated = true;
        h->plan.last = last->goal;
        h->plan.rebounding = t - last->goal.time < BOUNCE_TIME;
    }
    himc_planner_changed(planner, t);
    himc_planner_extend(planner, hand, t + PLANNER_HORIZON);
    // the plan, made again, keeps the lift found for its next stroke
    const planner_lift *l = &h->lift;
    double touch = himc_planner_touch_after(h, t);
    bool same = touch == l->touch || fabs(touch - l->touch) < SAME_TOUCH; // or both infinite
    if (l->end > t && same && l->end <= h->plan.end)
        himc_planner_lift_from(h, l, t);
}

double himc_planner_yields(const himc_planner *planner, himc_hand hand, double t)
{
    const timed_stroke *s = himc_planner_current_planned(&planner->hand[hand], t);
    return s ? s->yields : 0;
}

bool himc_planner_current(const himc_planner *planner, himc_hand hand, double t,
                          himc_stroke *stroke, int *drum, double *contact_time)
{
    const timed_stroke *s = himc_planner_current_planned(&planner->hand[hand], t);
    planner_due due;
    if (!s && !himc_planner_score_next(&planner->score, hand, 0, &due))
        return false;
    *drum = s ? s->drum : due.drum;
    *contact_time = s ? s->goal.time : due.time;
    if (!stroke)
        return true;
    *stroke = s ? s->stroke : due.stroke;
    if (s && s->place.number < 0 && !s->reassigned) // a hit
        stroke->beat = NAN;
    if (s && s->varied) {
        himc_vec3 at = himc_head_frame_from_world(&planner->drum[s->drum], s->goal.spot);
        stroke->spot = HIMC_SPOT_XY;
        stroke->part[0] = '\0';
        stroke->x = at.x;
        stroke->y = at.y;
    }
    return true;
}

bool himc_planner_name_current(const himc_planner *planner, himc_hand hand, double t,
                               char text[HIMC_PLANNER_NAME])
{
    const timed_stroke *s = himc_planner_current_planned(&planner->hand[hand], t);
    return s && himc_planner_name(planner, s, text);
}
