/// performance_statistics.h: the part of a performance that measures how well it is played.
#ifndef HIMC_PERFORMANCE_STATISTICS_H
#define HIMC_PERFORMANCE_STATISTICS_H

#include "himc/performance.h"
#include "himc/vec.h"

typedef struct performance_statistics {
    double square_sum; ///< of the distances from tip to target outside contact (m^2)
    long square_count;
    double height_sum; ///< of strokes, apex to contact (m)
    long height_count;
    double apex[HIMC_HANDS]; ///< highest target over the head since the last strike (m)
    int strokes, played, hits;
    double hit_latency, longest_latency; ///< from a hit's command to its touch as planned (s)
    double peak_force;                   ///< (N)
    long recoveries;
} performance_statistics;

HIMC_RT void himc_statistics_clear(performance_statistics *statistics);
/// The target of that hand is `height` over the head (m).
HIMC_RT void himc_statistics_height(performance_statistics *statistics, himc_hand hand,
                                    double height, bool touching);
/// A tip is `away` from its target (m).
HIMC_RT void himc_statistics_tip(performance_statistics *statistics, himc_vec3 away);
/// Strokes of the score are over, `played` of them landed on time and place.
HIMC_RT void himc_statistics_strokes(performance_statistics *statistics, int strokes, int played);
/// A hit is planned to touch that long after its command (s).
HIMC_RT void himc_statistics_hit(performance_statistics *statistics, double latency);
HIMC_RT void himc_statistics_force(performance_statistics *statistics, double force);
/// A state that was not finite has been replaced; returns how many there were before.
HIMC_RT long himc_statistics_recovery(performance_statistics *statistics);

/// Fills what is measured here.
HIMC_RT void himc_statistics_read(const performance_statistics *statistics,
                                  himc_performance_stats *out);

#endif
