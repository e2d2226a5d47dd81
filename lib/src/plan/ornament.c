/// ornament.c: which strokes rolls, flams, drags and ruffs are made of, and when.
///
/// No tables of their times have been published, and names differ by school; the figures are chosen
/// as percussionists describe them. Timpani rolls are single strokes, faster on a higher drum and
/// when loud: from ppp to f 7 to 9 a second at C2, 11 to 14 at A3. From f on they get no faster, as
/// arms then need all the time for their speed. Doubles and presses are drummers': a double roll
/// has fewer arm strokes, each of which bounces once, so that all contacts are even: the bounce
/// comes half a stroke later. In a press roll each stroke bounces on a little longer than to the
/// next one, so that the hands overlap. Both slow down when loud, until fingers can turn the stick
/// round in time (bounce.c): a louder roll is louder.
///
/// Grace notes keep their time before the beat at any tempo, a roll its rate (planner_roll.c). The
/// other hand plays them all, the second of a drag or a ruff as a bounce, so that the hand of the
/// main stroke has all its time since its stroke before: after a grace note of its own, 90 ms
/// earlier, an arm has no forte. A ruff is as a drag, more open. The main stroke has the point that
/// is written, a grace note lies beside it, as at a named spot.
#include "plan/ornament.h"

#include "plan/bounce.h"
#include "plan/planner_state.h"
#include "plan/planner_roll.h"
#include "plan/sticking.h"

// strokes of both arms together (1/s); chosen, see above
#define USUAL_PITCH 110.0 // (Hz), at which single strokes and ...
#define SINGLE_RATE 10.0
#define SINGLE_RISE 0.37  // exponent of the pitch
#define BOUNCED_RATE 11.0 // ... those that doubles and presses have their shares of, as its root
#define SOFT_RATE 0.85    // share at ppp ...
#define LOUD_RATE 0.3     // ... and so much more for a dynamic of 1, up to f
#define SLOWEST_SINGLE 7.0
#define FASTEST_SINGLE 14.0
#define DOUBLE_SHARE 0.8
#define SLOWEST_DOUBLE 7.0
#define FASTEST_DOUBLE 12.0
#define PRESS_SHARE 0.6 // march tempo with five bounces each
#define SLOWEST_PRESS 5.0
#define FASTEST_PRESS 8.0
#define DOUBLE_GAP 0.44  // of the time between strokes: to the bounce, where they are nearest
#define SLOWEST_LOUD 6.0 // of loud doubles, which wait for their bounces; chosen: still a roll

// grace notes; chosen, see above
#define FLAM_TIME 0.025  // before the beat (s) ...
#define FLAM_SHARE 0.12  // ... and of the time since the stroke before, at most
#define DRAG_TIME 0.040  // between the notes of a drag (s)
#define RUFF_TIME 0.045  // ... and of a ruff (s)
#define GRACE_SHARE 0.35 // of the time since the stroke before, all together, at most
#define GRACE_SPEED 0.4  // of the stroke's speed; of two their mean
#define GRACE_FIRST 1.18 // of two the first over the mean, as a bounce keeps .7 of its speed
#define BESIDE 0.03      // of a written point, as at named spots (m) ...
#define OUTERMOST 0.92   // ... up to this share of the radius, the spot named rim
#define LOUD 0.8         // dynamic from which graces are wider
#define SLOW_PERIOD 0.85 // a beat longer than this, too (s): 70 beats a minute
#define WIDER 1.2

/// Speed of a grace note, or of the first of two (m/s).
static double grace_speed(const himc_stroke *stroke, bool two)
{
    double own = himc_gesture_of(stroke->nuance, stroke->dynamic).speed;
    return GRACE_SPEED * (two ? GRACE_FIRST : 1) * own;
}

/// A grace note, or two: the second is a bounce. Returns 1 if it is left out.
static int add_grace(himc_planner *planner, int drum, const himc_stroke *stroke, double early,
                     double bounce_time)
{
    himc_stroke grace = *stroke;
    himc_error unused;
    grace.hand = himc_other_hand(stroke->hand);
    // a written point is moved to the hand's own side of it, unless that leads off the head
    double y = grace.y + (grace.hand == HIMC_LEFT ? BESIDE : -BESIDE);
    if (grace.spot == HIMC_SPOT_XY && !grace.part[0] &&
        hypot(grace.x, y) <= OUTERMOST * planner->drum[drum].radius)
        grace.y = y;
    if (stroke->nuance != HIMC_STACCATO)
        grace.nuance = HIMC_LEGATO;
    grace.dynamic = himc_gesture_dynamic_at(grace.nuance, grace_speed(stroke, bounce_time > 0));
    grace.early = early;
    grace.bounces = bounce_time > 0;
    grace.bounce_time = bounce_time;
    return himc_planner_score_room(&planner->score, &grace) < PLANNER_LEAST_ROOM ||
           !himc_planner_add(planner, &grace, drum, &unused);
}

static double clip(double x, double low, double high)
{
    return fmin(fmax(x, low), high);
}

/// Strokes of both arms a second.
static double rate_of(const himc_stroke *roll, double pitch)
{
    double dynamic = fmin(0.5 * (roll->dynamic + roll->last_dynamic), HIMC_FORTE);
    double louder = SOFT_RATE + LOUD_RATE * dynamic, high = pitch / USUAL_PITCH;
    double rate = BOUNCED_RATE * sqrt(high) * louder;
    // of its loudest stroke
    double speed = himc_gesture_of(roll->nuance, fmax(roll->dynamic, roll->last_dynamic)).speed,
           bounce = himc_bounce_full_time(roll->bounces, speed);
    switch (roll->ornament) {
    case HIMC_ROLL_DOUBLE:
        rate = clip(DOUBLE_SHARE * rate, SLOWEST_DOUBLE, FASTEST_DOUBLE);
        return fmin(rate, fmax(DOUBLE_GAP / bounce, SLOWEST_LOUD));
    case HIMC_ROLL_PRESS:
        rate = clip(PRESS_SHARE * rate, SLOWEST_PRESS, FASTEST_PRESS);
        return fmin(rate, fmax(PLANNER_PRESS_OVERLAP / bounce, SLOWEST_PRESS));
    default:
        rate = SINGLE_RATE * pow(high, SINGLE_RISE) * louder;
        return clip(rate, SLOWEST_SINGLE, FASTEST_SINGLE);
    }
}

int himc_planner_add_ornament(himc_planner *planner, const himc_stroke *stroke, int drum,
                              double pitch)
{
    const planner_score *score = &planner->score;
    himc_error unused;
    if (stroke->ornament >= HIMC_ROLL_SINGLE) {
        himc_stroke roll = *stroke;
        roll.bounces = roll.ornament == HIMC_ROLL_DOUBLE  ? 1
                       : roll.ornament == HIMC_ROLL_PRESS ? HIMC_BUZZ
                                                          : 0;
        int out = himc_planner_add_roll(planner, &roll, drum, rate_of(&roll, pitch), &unused);
        return out < 0 ? 1 : out;
    }
    double since = himc_planner_score_since(score, stroke->beat), wide = 1;
    if (stroke->dynamic >= LOUD)
        wide *= WIDER;
    if (himc_planner_score_period(score, fmax(stroke->beat, 1)) > SLOW_PERIOD)
        wide *= WIDER;
    double two = wide * (stroke->ornament == HIMC_DRAG ? DRAG_TIME : RUFF_TIME);
    two = fmin(two, fmin(GRACE_SHARE * since / 2, himc_bounce_longest(grace_speed(stroke, true))));
    if (stroke->ornament == HIMC_FLAM)
        return add_grace(planner, drum, stroke, fmin(wide * FLAM_TIME, FLAM_SHARE * since), 0);
    return stroke->ornament == HIMC_PLAIN ? 0 : add_grace(planner, drum, stroke, 2 * two, two);
}
