/// planner_hands.c: which hand plays, and when: hits find a gap, and a stroke that its own hand
/// cannot reach or has no time for goes to the other one.
///
/// A hit is a stroke with a time instead of a beat; it waits in a short queue of its hand. A stroke
/// lent to the other hand waits in the same queue and keeps its beat. Only a stroke of the score is
/// lent, once, and only if the other hand has nothing else within HIT_GAP and is there in time; a
/// player would leave a stroke out before disturbing another. Invariant: a stroke is played once,
/// or given up and counted.
#include "plan/planner_state.h"

#include <stdio.h>

#define HIT_GAP 0.12 // between a hit and its neighbours (s)
#define MOST_TRIES 32
#define FAR 0.01 // out of reach by more is not tried (m)

/// "stroke at beat 3 left" or "hit left"
static const char *name_of(const planner_touch *touch, char text[64])
{
    const char *hand = himc_hand_name(touch->stroke.hand);
    if (touch->index < 0 && !touch->lent)
        snprintf(text, 64, "hit %s", hand);
    else
        snprintf(text, 64, "stroke at beat %g %s", touch->stroke.beat, hand);
    return text;
}

/// It will not be planned again when the plan is made anew.
static void settle(himc_planner *planner, const planner_touch *touch)
{
    if (touch->index >= 0)
        planner->hand[touch->stroke.hand].list[touch->index].settled =
            himc_planner_turn_name(planner, touch->round);
}

static void give_up(himc_planner *planner, const planner_touch *touch, const char *why)
{
    char name[64];
    bool written = touch->index >= 0 || touch->lent;
    planner->given_up += written;
    planner->left += written;
    settle(planner, touch);
    himc_planner_say(planner, PLANNER_GIVEN_UP, "%s: given up, %s", name_of(touch, name), why);
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

static double beyond(const himc_planner *planner, const planner_touch *touch)
{
    const himc_planner_config *c = &planner->config;
    return c->beyond ? c->beyond(c->body, touch->stroke.hand, touch->goal.spot) : 0;
}

static void queue_hit(planner_hand *h, const planner_touch *hit)
{
    int i = h->hits++;
    for (; i > 0 && h->hit[i - 1].goal.time > hit->goal.time; i--)
        h->hit[i] = h->hit[i - 1];
    h->hit[i] = *hit;
}

/// Whether the hand could play it besides what it has to play; its plan ends as early as it can.
static bool has_hand_free(himc_planner *planner, const planner_hand *h, const planner_touch *touch)
{
    double t = touch->goal.time, gap = t;
    return h->hits < PLANNER_HITS && beyond(planner, touch) <= FAR && find_gap(planner, h, &gap) &&
           gap == t && t >= h->plan.end + himc_hand_least_time(&h->plan, &touch->goal);
}

/// What a hand cannot play goes to the other one, if that has nothing to do and is near enough.
static bool lend(himc_planner *planner, const planner_touch *touch)
{
    himc_hand other = touch->stroke.hand == HIMC_LEFT ? HIMC_RIGHT : HIMC_LEFT;
    double from = planner->now + PLANNER_AHEAD;
    planner_touch taken = *touch;
    if (planner->lending || touch->lent || touch->index < 0)
        return false;
    planner->lending = true;
    himc_planner_cut(planner, other, from);
    taken.index = -1;
    taken.lent = true;
    taken.stroke.hand = other;
    taken.goal = himc_planner_goal(planner, &taken.stroke, taken.drum, touch->goal.time);
    bool can = has_hand_free(planner, &planner->hand[other], &taken);
    if (can)
        queue_hit(&planner->hand[other], &taken);
    himc_planner_extend(planner, other, from + PLANNER_HORIZON);
    planner->lending = false;
    return can;
}

/// Lends it, or gives it up.
static void do_without(himc_planner *planner, const planner_touch *touch, const char *why)
{
    char name[64];
    if (!lend(planner, touch)) {
        give_up(planner, touch, why);
        return;
    }
    planner->lent++;
    settle(planner, touch);
    himc_planner_say(planner, PLANNER_LENT, "%s: %s, the %s hand plays it", name_of(touch, name),
                     why, himc_hand_name(touch->stroke.hand == HIMC_LEFT ? HIMC_RIGHT : HIMC_LEFT));
}

bool himc_planner_too_far(himc_planner *planner, const planner_touch *touch)
{
    char why[48];
    double far = beyond(planner, touch);
    if (far <= FAR)
        return false;
    snprintf(why, sizeof why, "out of reach by %.2f m", far);
    do_without(planner, touch, why);
    return true;
}

void himc_planner_no_time(himc_planner *planner, const planner_touch *touch)
{
    do_without(planner, touch, "no time to prepare it");
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
        queue_hit(h, &hit);
    }
    himc_planner_extend(planner, stroke->hand, t + PLANNER_HORIZON);
    return touch;
}
