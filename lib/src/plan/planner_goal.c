/// planner_goal.c: where the tips go: strokes become goals, with a place, a time and a gesture, and
/// without a stroke a tip rests over the drum it has struck last, not crossed, at first over the
/// one that it will strike first, crossed or not: the arms that begin crossed are in order.
///
/// The gesture is that of the nuance and dynamic, in the shape of the motion unit that fits best,
/// no faster than fingers can turn the stick for its bounces, and varied as a player's.
#include "plan/planner_state.h"
#include "plan/bounce.h"
#include "plan/planner_roll.h"

// the goal; chosen: a unit of another spot further off than any of another speed, of another grip
// further still
#define CROSSED_MOST 0.6 // between drums over which crossed hands wait; chosen (m)
#define OTHER_SPOT 10    // as a difference of log speed
#define OTHER_GRIP 20    // as a difference of log speed

// the last bounces of a hand before a written stroke
#define FULL_HURRY 0.97       // of an arm's greatest speed: so fast a stroke is within 0.5 dB
#define LEAST_BUZZ_SHARE 0.25 // of the time to that stroke; chosen: still a buzz ...
#define MOST_DOUBLE_SHARE 0.5 // ... and a double as even as within the roll, before a grace note

// where a tip rests (m); chosen: near enough to look at rest, too high to touch a ringing head; at
// the height of the usual strike point, the hands as far apart as the shoulders
#define REST_OVER 0.085     // the mallet over the head: a hit at mf comes within a quarter second
#define REST_BACK (2.0 / 3) // from the centre towards the performer, of the radius
#define REST_ASIDE 0.3      // to the hand's own side, of the radius ...
#define REST_MOST_ASIDE 0.1 // ... and at most

/// By the unit that fits best: of that nuance and hand, if possible of that grip and spot, and near
/// in speed.
static himc_gesture gesture_of(const himc_planner *planner, const himc_stroke *stroke)
{
    himc_gesture usual = himc_gesture_of(stroke->nuance, stroke->dynamic);
    double least = HUGE_VAL;
    const himc_unit *best = NULL;
    for (int i = 0; i < planner->unit_count; i++) {
        const himc_unit *unit = &planner->unit[i];
        if (unit->nuance != stroke->nuance || unit->hand != stroke->hand)
            continue;
        bool elsewhere = unit->spot != HIMC_SPOT_XY && unit->spot != stroke->spot;
        double away = fabs(log(unit->speed / usual.speed)) + OTHER_SPOT * elsewhere +
                      OTHER_GRIP * (unit->grip != planner->grip);
        if (away < least) {
            least = away;
            best = unit;
        }
    }
    return best ? himc_gesture_from(best, stroke->nuance, stroke->dynamic) : usual;
}

double himc_planner_bounce_most(himc_planner *planner, int bounces, double t,
                                const planner_due *after)
{
    double time = fmax(after->time - t, 0), share = himc_planner_bounce_share(bounces);
    if (after->place.roll >= 0)
        return share * time;
    himc_goal goal = himc_planner_goal(planner, &after->stroke, after->drum, after->time);
    double left = time - goal.gesture.speed / (FULL_HURRY * HIMC_HURRY);
    if (bounces == HIMC_BUZZ)
        return fmin(share * time, fmax(left, LEAST_BUZZ_SHARE * time));
    return fmax(share * time, fmin(left, MOST_DOUBLE_SHARE * time));
}

double himc_planner_asked(const himc_planner *planner, const timed_stroke *s)
{
    double varied = s->goal.gesture.speed / s->written.gesture.speed;
    return varied * gesture_of(planner, &s->stroke).speed;
}

/// The tip's position when it touches a head at (x, y) (m).
static himc_vec3 tip_at(const himc_planner *planner, const himc_head_frame *head, double x,
                        double y)
{
    return himc_vec3_madd(himc_head_frame_to_world(head, x, y), planner->config.mallet_radius,
                          himc_head_frame_normal(head));
}

double himc_planner_beyond(const himc_planner *planner, himc_hand hand, himc_vec3 place)
{
    const himc_planned_body *b = planner->config.body;
    return b ? himc_vec3_length(
                   himc_vec3_sub(place, himc_posture_reachable(&b->posture, hand, place)))
             : 0;
}

bool himc_planner_reaches(const himc_planner *planner, himc_hand hand, himc_vec3 place)
{
    return himc_planner_beyond(planner, hand, place) <= PLANNER_UNREACHED;
}

himc_vec3 himc_planner_aside(const himc_planner *planner, const timed_stroke *s, double by)
{
    const himc_head_frame *head = &planner->drum[s->drum];
    himc_vec3 at = himc_head_frame_from_world(head, s->goal.spot);
    double most = himc_head_frame_half_width(head, himc_head_frame_struck(head), at.x);
    at.y = by > 0 ? fmin(at.y + by, fmax(most, at.y)) : fmax(at.y + by, fmin(-most, at.y));
    return tip_at(planner, head, at.x, at.y);
}

himc_goal himc_planner_goal(himc_planner *planner, const himc_stroke *stroke, int drum, double t)
{
    const himc_head_frame *head = &planner->drum[drum];
    double x, y;
    himc_head_frame_spot(head, stroke, &x, &y);
    double asked_x = x, asked_y = y;
    // a hand's side of the last bar of a keyboard may be beside it
    if (himc_head_frame_keep_inside(head, himc_head_frame_struck(head), &x, &y) && !stroke->part[0])
        himc_planner_say(planner, PLANNER_OUTSIDE,
                         "%.3g %.3g is beyond the rim: struck at %.3g %.3g", asked_x, asked_y, x,
                         y);
    // no faster than fingers can turn the stick for its bounces
    himc_gesture g = gesture_of(planner, stroke);
    double most = himc_bounce_fastest(stroke->bounces, stroke->bounce_time);
    if (g.speed > most && most > HIMC_SLOWEST_GESTURE) // else it is given up
        himc_planner_say(planner, PLANNER_SOFTER,
                         "bounces within %.3g s: struck with %.2g m/s at most, softer than written",
                         stroke->bounce_time, most);
    return (himc_goal){.time = t,
                       .spot = tip_at(planner, head, x, y),
                       .normal = himc_head_frame_normal(head),
                       .back = himc_vec3_scale(himc_head_frame_away(head), -1),
                       .gesture = g.speed > most ? himc_gesture_scale(g, most / g.speed) : g,
                       .hold = stroke->bounces ? stroke->bounce_time : 0};
}

void himc_planner_vary(const himc_planner *planner, timed_stroke *s)
{
    const himc_head_frame *head = &planner->drum[s->drum];
    bool hit = s->place.number < 0 && !s->reassigned;
    if (!hit)
        s->variation = himc_human_stroke(&planner->human, &planner->score, s->stroke.hand,
                                         s->place.round, s->stroke.beat);
    const himc_variation *v = &s->variation;
    himc_vec3 at = himc_head_frame_from_world(head, s->written.spot);
    himc_variation_place(v, s->stroke.hand, &at.x, &at.y);
    himc_head_frame_keep_inside(head, himc_head_frame_struck(head), &at.x, &at.y);
    s->varied = true;
    s->goal.spot = tip_at(planner, head, at.x, at.y);
    if (s->goal.gesture.speed > HIMC_SLOWEST_GESTURE)
        s->goal.gesture = himc_gesture_scale(s->goal.gesture, exp(v->log_speed));
    himc_vec3 aside = himc_vec3_cross(s->goal.normal, s->goal.back);
    s->goal.back = himc_vec3_madd(himc_vec3_scale(s->goal.back, cos(v->turn)), sin(v->turn), aside);
    if (!hit) // a hit's time has been varied when it came
        s->goal.time += v->late;
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

/// The hand has not struck yet, and has a stroke to come.
static bool begins_with(const himc_planner *planner, himc_hand hand)
{
    const planner_score *score = &planner->score;
    return !planner->hand[hand].struck &&
           himc_planner_score_first_drum(score, hand, score->beat, -1) >= 0;
}

static bool is_rest(const himc_planner *planner, himc_hand hand, int drum, himc_vec3 *place)
{
    const himc_head_frame *head = &planner->drum[drum];
    double x = -REST_BACK * head->radius, aside = fmin(REST_ASIDE * head->radius, REST_MOST_ASIDE);
    double y = hand == HIMC_LEFT ? aside : -aside;
    himc_head_frame_keep_inside(head, himc_head_frame_struck(head), &x, &y);
    himc_vec3 at = tip_at(planner, head, x, y);
    *place = himc_vec3_madd(at, REST_OVER, himc_head_frame_normal(head));
    return planner->known[drum] && himc_planner_reaches(planner, hand, *place);
}

himc_vec3 himc_planner_rest_place(const himc_planner *planner, himc_hand hand)
{
    himc_vec3 place;
    // over its own drum, but the hands rest crossed only where both are to begin so, and near
    int left = own_drum(planner, HIMC_LEFT), right = own_drum(planner, HIMC_RIGHT);
    bool begins = begins_with(planner, HIMC_LEFT) && begins_with(planner, HIMC_RIGHT) &&
                  himc_vec3_length(himc_vec3_sub(planner->drum[left].center,
                                                 planner->drum[right].center)) < CROSSED_MOST;
    bool crossed = !begins && azimuth(&planner->drum[left]) < azimuth(&planner->drum[right]);
    if (is_rest(planner, hand, (hand == HIMC_LEFT) != crossed ? left : right, &place))
        return place;
    for (int drum = 0; drum < HIMC_DRUMS; drum++)
        if (is_rest(planner, hand, drum, &place))
            return place;
    return planner->config.rest[hand];
}
