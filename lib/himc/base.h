/// base.h: shared by all modules: version, errors, hands, places of drumheads, the two kinds of
/// functions.
///
/// Every public function is either *setup* (may allocate, lock, read files; the default) or
/// marked HIMC_RT: it never allocates, locks, prints or waits, and its time is bounded, so it may
/// be called from an audio callback. SI units everywhere (m, kg, s, N, N m, rad, Hz). World
/// frame: right-handed, x forward (performer towards drum), y left, z up, origin on the floor
/// under the pelvis (ROS REP-103).
#ifndef HIMC_BASE_H
#define HIMC_BASE_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// HIMC_BEGIN and HIMC_END stand around the declarations of each public header: C linkage for C++,
/// and symbols that the shared library shows.
#ifdef __cplusplus
#define HIMC_BEGIN                                     \
    _Pragma("GCC visibility push(default)") extern "C" \
    {
#define HIMC_END \
    }            \
    _Pragma("GCC visibility pop")
#else
#define HIMC_BEGIN _Pragma("GCC visibility push(default)")
#define HIMC_END _Pragma("GCC visibility pop") ///< closes HIMC_BEGIN
#endif

HIMC_BEGIN

/// Marks a function that is safe in an audio callback; a test with its own malloc checks this.
#define HIMC_RT

/// Rises when programs must be changed (docs/api.md).
#define HIMC_VERSION_MAJOR 0
/// Rises with additions; while MAJOR is 0, with any change.
#define HIMC_VERSION_MINOR 1
/// Rises with repairs.
#define HIMC_VERSION_PATCH 0
/// \cond
#define HIMC_VERSION_TEXT_(major, minor, patch) #major "." #minor "." #patch
#define HIMC_VERSION_JOIN_(major, minor, patch) HIMC_VERSION_TEXT_(major, minor, patch)
/// \endcond
/// Version of the headers: "MAJOR.MINOR.PATCH".
#define HIMC_VERSION HIMC_VERSION_JOIN_(HIMC_VERSION_MAJOR, HIMC_VERSION_MINOR, HIMC_VERSION_PATCH)

/// Version of the library that is linked, "MAJOR.MINOR.PATCH". Borrowed, static.
HIMC_RT const char *himc_version(void);

#define HIMC_PI 3.14159265358979323846 ///< M_PI, which C17 does not have

/// One line with the fault, the value, the expected values, and in a file `file:line`.
typedef struct himc_error {
    char text[512]; ///< without line end; only written if a function fails
} himc_error;

/// Writes one line into `error` (printf format); `error` may be NULL. Returns false, so that a
/// check can end with `return himc_error_set(...)`.
bool himc_error_set(himc_error *error, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/// Puts "context: " before the line already in `error` (which may be NULL). Returns false.
bool himc_error_prefix(himc_error *error, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/// False, with an error like "radius: 0 m, expected 0.05 .. 1 m", if `value` is outside [low, high]
/// or not finite.
bool himc_check_range(const char *name, double value, double low, double high, const char *unit,
                      himc_error *error);

/// A hand of the performer, with its arm and stick. In the order of the argument HAND.
typedef enum himc_hand {
    HIMC_LEFT,     ///< "left"
    HIMC_RIGHT,    ///< "right"
    HIMC_HANDS,    ///< number of hands, the length of arrays indexed by a hand
    HIMC_HAND_ANY, ///< "any", of a hit only: the performer chooses
    HIMC_FOOT      ///< "foot", of a stroke or hit only: with a beater on a pedal
} himc_hand;

/// "left", "right" or "foot", the words of commands. Borrowed, static.
const char *himc_hand_name(himc_hand hand);

/// A vector or a point; the unit is that of its use.
typedef struct himc_vec3 {
    double x; ///< forward
    double y; ///< left
    double z; ///< up
} himc_vec3;

/// A quaternion w + x i + y j + z k.
typedef struct himc_quat {
    double w; ///< real part; cos(angle / 2) of a rotation
    double x; ///< sin(angle / 2) times the axis' x
    double y; ///< the same of y
    double z; ///< the same of z
} himc_quat;

/// The struck surface of an instrument, such as a drumhead, in the world frame. Its x axis points
/// away from the performer, its y axis to the left.
typedef struct himc_head_frame {
    himc_vec3 center;    ///< centre of the surface at rest (m)
    double tilt;         ///< positive lifts the side away from the performer (rad)
    double radius;       ///< of the disc, or of the circle around a rectangle (m)
    double length;       ///< of a rectangle along x (m); 0: a disc
    double width;        ///< of a rectangle along y; of a disc its depth: of a shell, a plate (m)
    const double *spots; ///< places of HIMC_SPOT_CENTER, _NORMAL and _RIM, from the centre towards
                         ///< the performer, per radius (3); borrowed; NULL: those of a drumhead
} himc_head_frame;

#define HIMC_DRUMS 16 ///< most that one performer plays on

#define HIMC_SEGMENTS 20                ///< rigid segments of the body; body.h names them
#define HIMC_JOINTS (HIMC_SEGMENTS - 1) ///< ball joints: joint j is between j + 1 and its parent

HIMC_END

#endif
