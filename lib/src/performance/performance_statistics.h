/// performance_statistics.h: the errors and counts of a performance.
#ifndef HIMC_PERFORMANCE_STATISTICS_H
#define HIMC_PERFORMANCE_STATISTICS_H

#include "himc/body.h"
#include "himc/performance.h"

// A pitcher's shoulder, the fastest joint that has been measured of people, turns at some 7000
// degrees a second (Dillman, Fleisig & Andrews 1993); chosen: a third more is no person's
#define HIMC_FASTEST_JOINT 160.0 // (rad/s)

typedef struct performance_statistics {
    himc_performance_stats told; ///< the counts and largest values that it tells as they are
    double square_sum;           ///< of the distances from tip to target outside contact (m^2)
    long square_count;
    double height_sum; ///< of strokes, apex to contact (m)
    long height_count;
    double apex[HIMC_HANDS]; ///< highest target over the head since the last strike (m)
    long aside;              ///< strokes that have landed beside their place
    double captured_sum;     ///< of squared distances from tip to capture (m^2)
    long captured_count;
    double captured_most;                   ///< the largest of them (m^2)
    double impact_sum, captured_impact_sum; ///< of the same impacts, played and captured (m/s)
    double rate[HIMC_JOINTS];               ///< largest squared rate of each joint (rad^2/s^2)
    bool told_apart;                        ///< the body has flown apart
    bool told_fast;                         ///< himc_statistics_too_fast has been true
    double torque[HIMC_JOINTS];             ///< largest squared torque (N^2 m^2)
    double given;                           ///< by sticks to heads (J)
    double
        mallet[HIMC_HANDS]; ///< work of the heads on mallets' own masses since the rows began (J)
} performance_statistics;

HIMC_RT void himc_statistics_clear(performance_statistics *statistics);
/// Adds a target of that hand, `height` over the head (m).
HIMC_RT void himc_statistics_height(performance_statistics *statistics, himc_hand hand,
                                    double height, bool touching);
/// Adds the distance `away` of a tip from its target (m).
HIMC_RT void himc_statistics_tip(performance_statistics *statistics, himc_vec3 away);
/// Adds the distance `away` of a tip from its place in the capture (m).
HIMC_RT void himc_statistics_captured(performance_statistics *statistics, himc_vec3 away);
/// Adds the rates of the joints, and their torques (N m); NULL if there are none.
HIMC_RT void himc_statistics_joints(performance_statistics *statistics,
                                    const himc_skeleton *skeleton, const himc_body_state *state,
                                    const himc_vec3 *torque);
/// True once, when a joint has turned faster than any person's: the joint and its rate (rad/s).
/// Not after a recovery, which is told.
HIMC_RT bool himc_statistics_too_fast(performance_statistics *statistics, int *joint, double *rate);
/// Adds a contact that no stroke asked for.
HIMC_RT void himc_statistics_unplanned(performance_statistics *statistics);
/// Adds a contact of that force (N) that has lasted so long (s).
HIMC_RT void himc_statistics_contact(performance_statistics *statistics, double force,
                                     double duration);
/// Adds finished strokes of the score; `played` of them landed on time and place.
HIMC_RT void himc_statistics_strokes(performance_statistics *statistics, int strokes, int played);
/// Adds the speed of a stroke's contact (m/s), as it was captured (NAN: it is not of a take), and
/// the distance to where it was asked for (m).
HIMC_RT void himc_statistics_landed(performance_statistics *statistics, double speed,
                                    double captured, double yields);
/// Counts a stroke that has landed beside its place; returns how many there were before.
HIMC_RT long himc_statistics_aside(performance_statistics *statistics);
/// Adds a hit, with the time from its command to its planned contact (s).
HIMC_RT void himc_statistics_hit(performance_statistics *statistics, double latency);
/// Adds the work of a head on a stick (J), of which `own` is on the mallet's own mass.
HIMC_RT void himc_statistics_contact_work(performance_statistics *statistics, himc_hand hand,
                                          double work, double own);
/// Counts a body that was put back, after a fall or because it flew apart; true if that is to be
/// told: each fall, and the first time that it flew apart.
HIMC_RT bool himc_statistics_recovery(performance_statistics *statistics, bool fell);

/// The figures; 0 in the fields that this part does not measure.
HIMC_RT himc_performance_stats himc_statistics_told(const performance_statistics *statistics);

#endif
