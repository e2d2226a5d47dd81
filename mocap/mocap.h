/// mocap.h: synthetic motion captures of three timpanists, made in joint space.
///
/// Each sequence is one player, nuance and spot: both hands in turn, the whole body and the
/// sticks; defined at any time and so at any rate. Tips follow from the joints by forward
/// kinematics. The same config gives the same motion, bit by bit; another seed gives another trial
/// by the same player.
#ifndef HIMC_DATABASE_H
#define HIMC_DATABASE_H

#include "himc/command.h"
#include "body/posture.h"
#include "himc/body.h"

#define HIMC_MOCAP_PLAYERS 3
#define HIMC_MOCAP_RATE 250.0   ///< of the files (Hz)
#define HIMC_MOCAP_HEAD 0.85    ///< height of the drumhead (m)
#define HIMC_MOCAP_RADIUS 0.292 ///< of the drumhead, 23 inches (m)

typedef struct himc_mocap_config {
    int player; ///< 0 .. HIMC_MOCAP_PLAYERS - 1
    himc_nuance nuance;
    himc_spot spot; ///< center, normal or rim
    uint64_t seed;  ///< default 1
    int strokes;    ///< of both hands together, 2 .. 200, default 16
    double pace;    ///< factor on the speed of the same motion, 0.25 .. 4, default 1
} himc_mocap_config;

himc_mocap_config himc_mocap_default(void);

/// One sequence.
typedef struct himc_mocap himc_mocap;

/// Makes the sequence; NULL with the reason.
himc_mocap *himc_mocap_new(const himc_mocap_config *config, himc_error *error);
void himc_mocap_free(himc_mocap *mocap);

/// "ida", "jon", "max".
const char *himc_mocap_player_name(int player);
/// The player's body.
const himc_skeleton *himc_mocap_skeleton(const himc_mocap *mocap);
/// Centre of the drumhead (m).
himc_vec3 himc_mocap_drum(const himc_mocap *mocap);
double himc_mocap_length(const himc_mocap *mocap); ///< (s)
int himc_mocap_frames(const himc_mocap *mocap);    ///< at HIMC_MOCAP_RATE

/// The posture at time `t` (s), which is held before 0 and after the end.
HIMC_RT himc_pose himc_mocap_pose(const himc_mocap *mocap, double t);

/// A stroke as intended.
typedef struct himc_mocap_touch {
    himc_hand hand;
    double time; ///< of the impact (s)
    himc_vec3 x; ///< of the tip there (m)
} himc_mocap_touch;

int himc_mocap_touches(const himc_mocap *mocap);
/// In order of time.
himc_mocap_touch himc_mocap_touch_at(const himc_mocap *mocap, int index);

/// Writes all frames as .bvh, .c3d or .trc. False with the reason.
bool himc_mocap_write(const himc_mocap *mocap, const char *path, himc_error *error);

/// Quantities that a motion capture laboratory would measure on strokes.
typedef enum himc_mocap_figure {
    HIMC_MOCAP_HEIGHT,     ///< apex to impact of a point 0.15 m behind the mallet (m)
    HIMC_MOCAP_DOWN,       ///< its fastest downward speed (m/s)
    HIMC_MOCAP_UP,         ///< its fastest rebound speed near impact (m/s)
    HIMC_MOCAP_IMPACT,     ///< speed of the mallet at impact (m/s)
    HIMC_MOCAP_TIP_HEIGHT, ///< apex to impact of the mallet (m)
    HIMC_MOCAP_DEPTH,      ///< range of the mallet towards and from the player (m)
    HIMC_MOCAP_ELEVATION,  ///< of the stick at impact, 0 level (rad)
    HIMC_MOCAP_INTERVAL,   ///< to the same hand's next impact (s)
    HIMC_MOCAP_SINK,       ///< lowest the mallet goes below the head (m)
    HIMC_MOCAP_FIGURES
} himc_mocap_figure;

typedef struct himc_mocap_statistics {
    int count[HIMC_MOCAP_FIGURES];
    double sum[HIMC_MOCAP_FIGURES], squares[HIMC_MOCAP_FIGURES];
    double least[HIMC_MOCAP_FIGURES], most[HIMC_MOCAP_FIGURES];
} himc_mocap_statistics;

/// Adds the strokes of a sequence, measured in its frames; start with `statistics` all zero.
void himc_mocap_measure(const himc_mocap *mocap, himc_mocap_statistics *statistics);
/// Mean and standard deviation; NaN without strokes.
double himc_mocap_mean(const himc_mocap_statistics *statistics, himc_mocap_figure figure);
double himc_mocap_deviation(const himc_mocap_statistics *statistics, himc_mocap_figure figure);

/// Writes the comparison with measured strokes, a table in Markdown, into `text`. False with the
/// reason.
bool himc_mocap_compare(uint64_t seed, char *text, size_t size, himc_error *error);

#endif
