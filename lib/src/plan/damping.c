/// damping.c: where and when a hand lies down on a head.
///
/// Timpanists stop a head with the fingers of a hand that holds its stick, near the spot of the
/// strokes; the stick stays over the head. The tip is the hand's only task, so its place is that of
/// a natural posture with the fingers on the head. The plan moves it there, C2 and at rest in time,
/// as it moves to any target. The head is damped at its own time, whether a hand has come or not:
/// the losses are the head's, and the fingers have no contact of their own.
#include "plan/damping.h"

#define FINGERS_BACK 0.55 // from the centre towards the performer, of the radius; chosen
#define FINGERS_OVER 0.03 // the grip over the head: fingers are so thick (m); chosen
#define TIP_OVER 0.015  // the mallet over the head, at least (m); chosen: a lifted wrist lowers it
#define LEAST_STAY 0.25 // as a hand in an imported score lies (s)
#define NEXT_STROKE 0.4 // a hand then has so much time to its next stroke (s); chosen
#define SETTLED 0.06    // after a stroke, its rebound is over (s); chosen
#define QUICK 0.25      // a hand that is called late comes within this (s); chosen
#define LATEST 0.3      // no hand comes later than this (s); chosen

// the free hand that has the shorter way comes; false if none can
static bool send(himc_damping *d, himc_planner *planner, const himc_posture *posture,
                 const himc_damped_head *head, int drum, const himc_free_hand *free, double t)
{
    double at = fmax(d->due[drum], t + QUICK), way[HIMC_HANDS];
    himc_vec3 place[HIMC_HANDS];
    double x = -FINGERS_BACK * head->frame->radius, y = 0;
    himc_head_frame_keep_inside(head->frame, FINGERS_BACK, &x, &y);
    himc_vec3 fingers = himc_head_frame_to_world(head->frame, x, y);
    fingers = himc_vec3_madd(fingers, FINGERS_OVER, himc_head_frame_normal(head->frame));
    for (int i = 0; i < HIMC_HANDS; i++) {
        place[i] = himc_posture_tip_of_grip(posture, (himc_hand)i, fingers);
        double over = himc_head_frame_from_world(head->frame, place[i]).z;
        double lack = TIP_OVER + posture->skeleton.mallet_radius - over;
        place[i] = himc_vec3_madd(place[i], fmax(lack, 0), himc_head_frame_normal(head->frame));
        himc_vec3 now = himc_planner_target(planner, (himc_hand)i, t).x;
        bool can = d->lies_on[i] == 0 && t > free[i].from + SETTLED &&
                   at + LEAST_STAY + NEXT_STROKE < free[i].until;
        way[i] = can ? himc_vec3_length(himc_vec3_sub(place[i], now)) : INFINITY;
    }
    for (int tries = 0; tries < HIMC_HANDS; tries++) {
        int i = way[HIMC_LEFT] < way[HIMC_RIGHT] ? HIMC_LEFT : HIMC_RIGHT;
        if (isfinite(way[i]) && himc_planner_lay(planner, t, (himc_hand)i, place[i], at)) {
            d->lies_on[i] = drum + 1;
            d->lies[i] = at;
            return true;
        }
        way[i] = INFINITY;
    }
    return false;
}

bool himc_damping_move(himc_damping *d, himc_planner *planner, const himc_posture *posture,
                       const himc_damped_head *head, int heads,
                       const himc_free_hand hand[HIMC_HANDS], double t)
{
    bool moved = false;
    // a hand that has struck since, or has another task, does not lie any more
    for (int i = 0; i < HIMC_HANDS; i++) {
        int drum = d->lies_on[i] - 1;
        bool left = drum >= heads || hand[i].until <= t || hand[i].from > d->lies[i];
        if (drum < 0 || (!left && (head[drum].now || t < d->lies[i] + LEAST_STAY)))
            continue;
        d->lies_on[i] = 0;
        moved = (!left && himc_planner_lift(planner, t, (himc_hand)i)) || moved;
    }
    for (int i = 0; i < heads; i++) {
        if (head[i].soon && !d->damped[i]) {
            d->wanted[i] = true;
            d->due[i] = head[i].now ? t : t + HIMC_DAMPING_FORESIGHT;
        }
        d->damped[i] = head[i].soon;
        d->wanted[i] = d->wanted[i] && t + QUICK <= d->due[i] + LATEST;
        if (!d->wanted[i] || !send(d, planner, posture, &head[i], i, hand, t))
            continue;
        d->wanted[i] = false;
        moved = true;
    }
    return moved;
}
