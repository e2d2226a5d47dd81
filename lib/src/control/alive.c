/// alive.c: where a player looks, leans and breathes.
///
/// Players look at the place of the next stroke, and in rests to the conductor; they breathe, shift
/// their weight on the stool, and lift head and chest before a first note, which falls with it. All
/// are goals of the slow parts of the posture, which follow them without jumps of the acceleration
/// (posture.h). They move trunk, neck and head; the tips' targets stay, and inverse kinematics
/// makes up for the shoulders, as it does for a turning trunk. Amplitudes are chosen: seen, and
/// small.
#include "control/alive.h"

#include <math.h>

#define READS_AHEAD 2.5      // a stroke within this time is looked at (s); else the conductor is
#define GAZE_SHARE 0.7       // of the way to the place; the eyes do the rest
#define RESTING_LOOK 0.22    // down, of the natural posture (rad)
#define MOST_ASIDE 1.0       // of the head in the trunk (rad)
#define MOST_DOWN 0.4        // beyond the resting look (rad) ...
#define MOST_UP (-0.35)      // ... and up
#define CONDUCTOR_UP (-0.15) // (rad)
#define WEIGHT_SHARE 0.06    // lean to the side, of the azimuth of the place
#define MOST_WEIGHT 0.05     // (rad)
#define SWAY 0.012           // slow shift of the weight (rad) ...
#define SWAY_PERIOD 9.1      // (s)
#define BREATH 0.006         // of the chest (rad) ...
#define BREATH_PERIOD 4.2    // at rest (s)
#define FIRST_AFTER 2.0      // a stroke after so long a rest is a first note (s)
#define LIFT_BEGINS 0.9      // the lift before it begins (s) ...
#define LIFT_ENDS 0.5        // ... and falls again, as long as the posture takes (posture.h) (s)
#define LIFT_HEAD 0.22       // (rad)
#define LIFT_CHEST 0.04      // (rad)

static double bounded(double x, double low, double high)
{
    return fmin(fmax(x, low), high);
}

static void look_at(const himc_posture *posture, himc_vec3 place, himc_trunk_posture *goal)
{
    const himc_segment *s = posture->skeleton.segment;
    double height = posture->skeleton.segment[HIMC_PELVIS].origin.z + s[HIMC_TRUNK].origin.z +
                    s[HIMC_NECK].origin.z + s[HIMC_NECK].length;
    double aside = atan2(place.y, place.x), far = hypot(place.x, place.y);
    double down = atan2(height - place.z, far) - goal->value[HIMC_TRUNK_POSTURE_LEAN];
    double turn = aside - goal->value[HIMC_TRUNK_POSTURE_TURN];
    goal->value[HIMC_TRUNK_POSTURE_LOOK_LEFT] = bounded(GAZE_SHARE * turn, -MOST_ASIDE, MOST_ASIDE);
    goal->value[HIMC_TRUNK_POSTURE_LOOK_DOWN] =
        bounded(GAZE_SHARE * down - RESTING_LOOK, MOST_UP, MOST_DOWN);
    goal->value[HIMC_TRUNK_POSTURE_SIDE] -=
        bounded(WEIGHT_SHARE * aside, -MOST_WEIGHT, MOST_WEIGHT);
}

void himc_alive_add(const himc_posture *posture, const himc_next_stroke *next, double t,
                    himc_trunk_posture *goal)
{
    double turn = goal->value[HIMC_TRUNK_POSTURE_TURN];
    goal->value[HIMC_TRUNK_POSTURE_SIDE] += SWAY * sin(2 * HIMC_PI * t / SWAY_PERIOD);
    if (next->in < READS_AHEAD) {
        look_at(posture, next->at, goal);
    } else {
        goal->value[HIMC_TRUNK_POSTURE_LOOK_LEFT] = bounded(-turn, -MOST_ASIDE, MOST_ASIDE);
        goal->value[HIMC_TRUNK_POSTURE_LOOK_DOWN] = CONDUCTOR_UP;
    }
    goal->value[HIMC_TRUNK_POSTURE_LEAN] += BREATH * sin(2 * HIMC_PI * t / BREATH_PERIOD);
    if (next->since > FIRST_AFTER && next->in < LIFT_BEGINS && next->in > LIFT_ENDS) {
        goal->value[HIMC_TRUNK_POSTURE_LOOK_DOWN] -= LIFT_HEAD;
        goal->value[HIMC_TRUNK_POSTURE_LEAN] -= LIFT_CHEST;
    }
}
