/// ears.h: a drum as heard by two ears at one place, over a floor.
#ifndef HIMC_EARS_H
#define HIMC_EARS_H

#include "drum/membrane_config.h"
#include "drum/room.h"
#include "himc/vec.h"

/// Where a listener is.
typedef struct himc_listener {
    bool on;
    bool yields;     ///< to the pickups of a drum, where these have been asked for
    himc_vec3 place; ///< midway between the ears, in the world (m)
    double yaw;      ///< the way the face looks, to the left of the world's x axis (rad)
} himc_listener;

/// A listener there who faces the performer at the world's origin; one who is there looks along x.
himc_listener himc_listener_at(himc_vec3 place);
/// The one who hears what has been asked for by nobody: in front of the drums and a little to the
/// left, and yields.
himc_listener himc_listener_usual(void);
/// Whether a drum is heard by that listener; `picked`: its pickups have been asked for.
HIMC_RT bool himc_listener_hears(const himc_listener *listener, bool picked);
/// True if both are off, or in one place and facing one way, and both yield or none.
bool himc_listener_equal(const himc_listener *a, const himc_listener *b);

/// Sound of the ears per sound of a pickup at the same distance: a sound of 1.0 is 27 Pa.
/// Chosen: one mf stroke on any timpano has a momentary loudness of -30 LUFS and more, as in
/// libraries of samples; the strongest strokes would pass full scale, and are bent to it.
#define HIMC_EARS_LEVEL (HIMC_PICKUP_PRESSURE / 27)
#define HIMC_EARS_LINEAR 0.5 ///< what a drum's sound at an ear may be without being bent

/// One way of the sound from a drum to an ear.
typedef struct himc_ear_path {
    double delay; ///< (s)
    double gain;  ///< of a ray, which is the sound at 1 m
    double shelf; ///< of high frequencies beside low ones, by the shadow of the head
} himc_ear_path;

/// All of them, and the rays that they carry.
typedef struct himc_ear_paths {
    himc_pickup ray[HIMC_RAYS];
    himc_ear_path direct[HIMC_EARS], floor[HIMC_EARS];
} himc_ear_paths;

/// The paths from the head at `frame` to the ears of a listener.
himc_ear_paths himc_ears_trace(const himc_listener *listener, const himc_head_frame *frame);

#ifndef HIMC_EARS_LINE
#define HIMC_EARS_LINE 32768 ///< (samples) the longest path, 35 m, at 192 kHz, and more
#endif

/// A path in samples: four weights of a fractional delay, the gain in them.
typedef struct himc_ear_tap {
    int whole;
    double weight[4], shelf;
} himc_ear_tap;

typedef struct himc_ear_taps {
    himc_ear_tap direct[HIMC_EARS], floor[HIMC_EARS];
} himc_ear_taps;

/// A filter of one pole: y = keep y + take (x + last x).
typedef struct himc_one_pole {
    double keep, take, x, y;
} himc_one_pole;

/// The ears of a drum. 0: nobody listens.
typedef struct himc_ears {
    bool on;                         ///< the paths are set; else the ears give way to the pickups
    double level;                    ///< of the ears beside the pickups, 0 .. 1
    double step;                     ///< of a fade, a sample
    himc_ear_taps now, before, next; ///< `before` gives way to `now`; then it is the turn of `next`
    bool changes;                    ///< there is a `next`
    double faded;                    ///< 0 .. 1, of that
    int reach;                       ///< (samples) the longest path of `before` and `now`
    himc_one_pole shadow[HIMC_EARS], floor;
    int at;     ///< in `line`, of the coming sample
    int span;   ///< (samples) of `line` in use, a power of 2
    int silent; ///< samples without sound, so far
    double line[HIMC_RAYS][HIMC_EARS_LINE];
    himc_room room;
} himc_ears;

/// Begins to listen between these walls, or changes place or walls, in 5 ms.
HIMC_RT void himc_ears_set(himc_ears *ears, const himc_ear_paths *paths, const himc_walls *walls,
                           double rate);
/// The pickups come back, in 5 ms.
HIMC_RT void himc_ears_close(himc_ears *ears);

/// True if the ears are heard: set, or giving way. NULL is nobody's.
static inline bool himc_ears_heard(const himc_ears *ears)
{
    return ears && (ears->on || ears->level > 0);
}
/// True if the ears alone are heard. NULL is nobody's.
static inline bool himc_ears_alone(const himc_ears *ears)
{
    return ears && ears->on && ears->level == 1;
}
/// True if nothing is left to be heard, and nothing about to change.
HIMC_RT bool himc_ears_at_rest(const himc_ears *ears);

/// `n` samples: takes the rays (NULL: silence), and turns the first HIMC_EARS rows of pickups into
/// what is heard: the ears, and of the pickups what the ears leave. `gain` is what the sound is
/// multiplied with afterwards.
HIMC_RT void himc_ears_hear(himc_ears *ears, int n, double *const *rays, double *const *rows,
                            double gain);

#endif
