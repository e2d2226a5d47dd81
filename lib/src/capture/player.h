/// player.h: the parts of reading a player from a take: joint centres, poses, seat. track.c
/// and performance_take.c play it.
#ifndef HIMC_PLAYER_H
#define HIMC_PLAYER_H

#include "himc/mocap.h"

/// Joint centres. Of a pair this is the left one; the right one is the next.
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
    int node[POINT_COUNT];     ///< index of the point in the take, -1 if it is a mean of several
    double *distance;          ///< (frames), owned: room for himc_player_distance
} player_points;

/// A segment's length as the distance between two joint centres.
typedef struct player_measure {
    int segment; ///< of the left side
    player_point from, to;
    double usual;    ///< (m), of a man of 1.741 m (de Leva 1996)
    bool tells_size; ///< of the body: sticks and hands do not
} player_measure;

#define PLAYER_LIMBS 6
#define PLAYER_SPINE 3
extern const player_measure himc_player_limbs[PLAYER_LIMBS], himc_player_spine[PLAYER_SPINE];

// chosen: hip joints of a child on a stool, and of a tall standing man (m)
#define PLAYER_LOWEST_SEAT 0.3
#define PLAYER_HIGHEST_SEAT 1.3

// Joint centres: player_points.c.

/// Finds the centres and bridges gaps; a centre with a longer gap is not shown, with a note to the
/// player. False without memory.
bool himc_player_points_find(player_points *points, himc_take *take,
                             const himc_take_options *options, himc_player *player);
void himc_player_points_free(player_points *points);
/// Quantile (0 .. 0.99, 0.5 the median) of two centres' distance over the frames (m), 0 if one is
/// not shown.
double himc_player_distance(const player_points *points, int from, int to, double quantile);
/// The length if it is humanly possible for a segment of that usual length, else 0.
double himc_player_plausible(double length, double usual);
/// Drops centres that do not keep their distance, with a note. False if the body is not of human
/// size or left and right are exchanged.
bool himc_player_check(player_points *points, himc_player *player, himc_error *error);
/// Keeps a line for himc_player_describe.
void himc_player_note(himc_player *player, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

// Poses: player_pose.c.

/// Fills pose, known and, for the known joints, mean; the others keep their mean. False without
/// memory.
bool himc_player_read_poses(himc_player *player, const player_points *points,
                            const himc_skeleton *skeleton);

// The seat: player.c.

/// Offset that moves the centre of the take's strikes onto the drum's usual strike place (m);
/// without strikes it moves the lowest position of a tip to a little above that place. False
/// without memory.
bool himc_strike_offset(const himc_take *take, const himc_take_tip tips[HIMC_HANDS],
                        const himc_head_frame *drum, double mallet_radius, himc_vec3 *offset);

#endif
