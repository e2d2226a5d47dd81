/// planner_rest.c: where the sticks rest: each over the drum it has struck last, at first over the
/// one that it will strike first, not crossed.
#include "plan/planner_motion.h"

// where a tip rests (m); chosen: near enough to look at rest, too high to touch a ringing head; at
// the height of the usual strike point, the hands as far apart as the shoulders
#define REST_OVER 0.085     // the mallet over the head: a hit at mf comes within a quarter second
#define REST_BACK (2.0 / 3) // from the centre towards the performer, of the radius
#define REST_ASIDE 0.3      // to the hand's own side, of the radius ...
#define REST_MOST_ASIDE 0.1 // ... and at most

static himc_vec3 rest_over(const himc_planner *planner, himc_hand hand, int drum)
{
    const himc_head_frame *head = &planner->drum[drum];
    double aside = fmin(REST_ASIDE * head->radius, REST_MOST_ASIDE);
    himc_vec3 at = himc_planner_tip_at(planner, head, -REST_BACK * head->radius,
                                       hand == HIMC_LEFT ? aside : -aside);
    return himc_vec3_madd(at, REST_OVER, himc_head_frame_normal(head));
}

static double azimuth(const himc_head_frame *head)
{
    return atan2(head->center.y, head->center.x);
}

static int own_drum(const himc_planner *planner, himc_hand hand)
{
    const planner_score *score = &planner->score;
    const planner_hand *h = &planner->hand[hand];
    return h->struck ? h->drum : himc_planner_score_first_drum(score, hand, score->beat, h->drum);
}

/// The drum over which a hand rests: its own, but the hands do not rest crossed.
static int rest_drum(const himc_planner *planner, himc_hand hand)
{
    int left = own_drum(planner, HIMC_LEFT), right = own_drum(planner, HIMC_RIGHT);
    bool crossed = azimuth(&planner->drum[left]) < azimuth(&planner->drum[right]);
    return (hand == HIMC_LEFT) != crossed ? left : right;
}

static bool is_rest(const himc_planner *planner, himc_hand hand, int drum, himc_vec3 *place)
{
    const himc_planner_config *c = &planner->config;
    *place = rest_over(planner, hand, drum);
    return planner->known[drum] &&
           !(c->beyond && c->beyond(c->body, hand, *place) > PLANNER_UNREACHED);
}

himc_vec3 himc_planner_rest_place(const himc_planner *planner, himc_hand hand)
{
    himc_vec3 place;
    if (is_rest(planner, hand, rest_drum(planner, hand), &place))
        return place;
    for (int drum = 0; drum < HIMC_DRUMS; drum++)
        if (is_rest(planner, hand, drum, &place))
            return place;
    return planner->config.rest[hand];
}
