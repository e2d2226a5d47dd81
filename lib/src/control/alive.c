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

void himc_alive_add(const himc_posture *posture, const himc_next_stroke *next, double t,
                    himc_trunk_posture *goal)
{
    const himc_segment *s = posture->skeleton.segment;
    double *side = &goal->value[HIMC_TRUNK_POSTURE_SIDE],
           *lean = &goal->value[HIMC_TRUNK_POSTURE_LEAN],
           *left = &goal->value[HIMC_TRUNK_POSTURE_LOOK_LEFT],
           *down = &goal->value[HIMC_TRUNK_POSTURE_LOOK_DOWN];
    double turn = goal->value[HIMC_TRUNK_POSTURE_TURN];
    *side += SWAY * sin(2 * HIMC_PI * t / SWAY_PERIOD);
    if (next->in < READS_AHEAD) {
        double height = s[HIMC_PELVIS].origin.z + s[HIMC_TRUNK].origin.z + s[HIMC_NECK].origin.z +
                        s[HIMC_NECK].length;
        double aside = atan2(next->at.y, next->at.x), far = hypot(next->at.x, next->at.y);
        double below = atan2(height - next->at.z, far) - *lean;
        *left = bounded(GAZE_SHARE * (aside - turn), -MOST_ASIDE, MOST_ASIDE);
        *down = bounded(GAZE_SHARE * below - RESTING_LOOK, MOST_UP, MOST_DOWN);
        *side -= bounded(WEIGHT_SHARE * aside, -MOST_WEIGHT, MOST_WEIGHT);
    } else {
        *left = bounded(-turn, -MOST_ASIDE, MOST_ASIDE);
        *down = CONDUCTOR_UP;
    }
    *lean += BREATH * sin(2 * HIMC_PI * t / BREATH_PERIOD);
    if (next->since > FIRST_AFTER && next->in < LIFT_BEGINS && next->in > LIFT_ENDS) {
        *down -= LIFT_HEAD;
        *lean -= LIFT_CHEST;
    }
}
