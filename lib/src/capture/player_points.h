/// player_points.h: the joint centres of a take, whatever its points are called; private.
#ifndef HIMC_PLAYER_POINTS_H
#define HIMC_PLAYER_POINTS_H

#include "himc/mocap.h"

/// Left of a pair; its right is the next.
typedef enum player_point {
    POINT_HIPS, ///< between the hip joints
    POINT_WAIST,
    POINT_NECK,
    POINT_HEAD,
    POINT_SHOULDER,
    POINT_ELBOW = POINT_SHOULDER + 2,
    POINT_WRIST = POINT_ELBOW + 2,
    POINT_GRIP = POINT_WRIST + 2,
    POINT_TIP = POINT_GRIP + 2,
    POINT_HIP = POINT_TIP + 2,
    POINT_KNEE = POINT_HIP + 2,
    POINT_ANKLE = POINT_KNEE + 2,
    POINT_TOE = POINT_ANKLE + 2,
    POINT_TOE_END = POINT_TOE + 2,
    POINT_HEAD_END = POINT_TOE_END + 2,
    POINT_BESIDE = POINT_HEAD_END + 2, ///< beside a segment's joint, along its y: + the segment
    POINT_COUNT = POINT_BESIDE + HIMC_SEGMENTS
} player_point;

typedef struct player_points {
    const himc_take *take; ///< borrowed
    int frames;
    himc_vec3 *x[POINT_COUNT]; ///< (frames) (m), owned, no gaps; NULL if not shown
    int node[POINT_COUNT];     ///< the take's point it is, -1 if it is the middle of several
} player_points;

/// Fills gaps; what has a longer one is not shown, with a note to the player. False without memory.
bool himc_player_points_find(player_points *points, himc_take *take,
                             const himc_take_options *options, himc_player *player);
void himc_player_points_free(player_points *points);
/// Quantile (0 .. 0.99, 0.5 the median) of two centres' distance over the frames (m), 0 if one is
/// not shown.
double himc_player_distance(const player_points *points, int from, int to, double quantile);
void himc_player_note(himc_player *player, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

#endif
