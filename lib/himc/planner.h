/// planner.h: from strokes to the trajectories of the two drumstick tips.
///
/// Each hand's trajectory is a queue of quintic pieces in three dimensions, joined with equal position, velocity and
/// acceleration (C2); PHYSICS: strokes of five nuances after section G. The planner knows nothing of bodies or sound:
/// it is told where the drums stand, when a tip touched and, at separation, how the tip really moves.
#ifndef HIMC_PLANNER_H
#define HIMC_PLANNER_H

#include "himc/quintic.h"
#include "himc/score.h"

/// Where a drumhead stands.
typedef struct himc_place {
    himc_vec3 center; ///< centre of the head at rest (m)
    double tilt;      ///< about the y axis, positive lifts the far side (rad)
    double radius;    ///< of the head (m)
} himc_place;

/// Unit normal of the head, up.
HIMC_RT himc_vec3 himc_place_normal(const himc_place *place);
/// Point (x, y) of the head (m, x away from the performer) in the world.
HIMC_RT himc_vec3 himc_place_to_world(const himc_place *place, double x, double y);
/// The inverse: (x, y) on the head and the height above it.
HIMC_RT himc_vec3 himc_place_from_world(const himc_place *place, himc_vec3 point);
/// (x, y) on the head of a named spot: center, normal (0.75 of the radius towards the performer), rim (0.92), each hand
/// 1.5 cm to its own side; a stroke with HIMC_SPOT_XY gives its own x, y.
HIMC_RT void himc_stroke_spot(const himc_stroke *stroke, double radius, double *x, double *y);

typedef struct himc_planner_config {
    double mallet_radius;       ///< the tip is the mallet's centre: it touches at this height (m)
    himc_vec3 rest[HIMC_HANDS]; ///< where a tip waits when there is nothing to play (m)
} himc_planner_config;

himc_planner_config himc_planner_default(void);

typedef struct himc_planner himc_planner;

/// What the planner wants said to the user; each is one line.
typedef struct himc_planner_note {
    char text[160];
} himc_planner_note;

himc_planner *himc_planner_new(const himc_planner_config *config, himc_error *error);
void himc_planner_free(himc_planner *planner);

#define HIMC_DRUMS 16

/// Drum `index` (0 .. HIMC_DRUMS-1) stands there from now on; strokes planned but not begun go to the new place.
HIMC_RT bool himc_planner_set_drum(himc_planner *planner, int index, const himc_place *place);

/// Adds a stroke of the score at its beat, for drum `index`; may allocate. Strokes may come in any order; two strokes of
/// one hand closer than 40 ms are refused.
bool himc_planner_add(himc_planner *planner, const himc_stroke *stroke, int drum, himc_error *error);
/// Replaces the tempo map (copied).
bool himc_planner_set_tempi(himc_planner *planner, const himc_tempo_change *tempi, int count, himc_error *error);
/// Forgets all strokes; sticks under way come to rest.
void himc_planner_clear(himc_planner *planner);

/// Starts the transport at time `t` (s) from the current beat. If the first stroke could not be prepared in time,
/// beat zero is moved later by as much as it needs, and a note says so.
HIMC_RT void himc_planner_play(himc_planner *planner, double t);
HIMC_RT void himc_planner_stop(himc_planner *planner, double t);
HIMC_RT void himc_planner_seek(himc_planner *planner, double t, double beat);
/// From now on (s) at this tempo; the motion under way is bent, C2, never jumped.
HIMC_RT void himc_planner_tempo(himc_planner *planner, double t, double bpm);

/// A stroke as soon as the gesture allows. Returns the time at which it will touch (s).
HIMC_RT double himc_planner_hit(himc_planner *planner, double t, const himc_stroke *stroke, int drum);
/// A live target: the tip goes there, smoothly, and stays until the next one or the next stroke.
HIMC_RT void himc_planner_reach(himc_planner *planner, double t, himc_hand hand, himc_vec3 x);

/// Brings plans up to time `t` (s, never backwards): drops what is past, plans at least 30 ms (in practice whole
/// strokes) ahead. Call at least every task period.
HIMC_RT void himc_planner_advance(himc_planner *planner, double t);
/// The planned state of a tip at `t` (s), between the last advance and 30 ms after it. Pure.
HIMC_RT himc_target himc_planner_target(const himc_planner *planner, himc_hand hand, double t);
/// The tip left the head at `t` in this measured state: the plan goes on from there (C2), PHYSICS section I.
HIMC_RT void himc_planner_separated(himc_planner *planner, himc_hand hand, double t, const himc_target *measured);

/// The stroke that hand is on or about to play at `t`: its drum, spot and planned time of contact. False if none.
HIMC_RT bool himc_planner_current(const himc_planner *planner, himc_hand hand, double t, himc_stroke *stroke,
                                  int *drum, double *contact_time);

/// Beat at time `t`, or a negative number when stopped.
HIMC_RT double himc_planner_beat(const himc_planner *planner, double t);
/// Time after which nothing is left to play (s): the last stroke and its coming to rest. Infinite while stopped.
HIMC_RT double himc_planner_end(const himc_planner *planner);
/// Takes the oldest note; false if there is none. At most 32 are kept; what is lost is counted in the last.
HIMC_RT bool himc_planner_note_next(himc_planner *planner, himc_planner_note *note);

#endif
