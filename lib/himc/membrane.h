/// membrane.h: a drumhead: its modes, swinging, and ears that hear them.
///
/// w(x, y, t) = sum_i phi_i(x, y) q_i(t), up positive; each q_i is an oscillator of the bank,
/// loaded by the air if the head says so; and as it bows out, its tension rises by its glide. Needs
/// libm alone.
#ifndef HIMC_MEMBRANE_H
#define HIMC_MEMBRANE_H

#include "himc/modes.h"

typedef enum himc_pickup_kind {
    HIMC_PICKUP_AIR,  ///< pressure far away; 1.0 is HIMC_PICKUP_PRESSURE
    HIMC_PICKUP_POINT ///< velocity of the head at a place; 1.0 is HIMC_PICKUP_VELOCITY
} himc_pickup_kind;

#define HIMC_PICKUP_PRESSURE \
    100.0 ///< (Pa): a stroke of 110 N heard from one metre peaks at 0.5 to 0.8
#define HIMC_PICKUP_VELOCITY 10.0 ///< (m/s)

/// What the sound is read from. Azimuth 0 is beyond the drum as the performer sees it, positive to
/// the left.
typedef struct himc_pickup {
    himc_pickup_kind kind;
    double x, y;      ///< of a point (m, on the head)
    double azimuth;   ///< of the listener (rad)
    double elevation; ///< above the plane of the head (rad), 0 .. 1.5708
    double distance;  ///< from the centre (m), 0.3 .. 100
} himc_pickup;

/// Listening beyond the drum, 10 degrees up, from 1 m.
himc_pickup himc_pickup_default(void);

#define HIMC_PICKUPS 8 ///< most that a membrane is heard by at once

typedef struct himc_membrane himc_membrane;

/// A head at rest at `rate` (Hz, 4000 .. 480000).
himc_membrane *himc_membrane_new(const himc_head *head, double rate, himc_error *error);
void himc_membrane_free(himc_membrane *membrane);

/// Changes the head while it sounds: modes keep energy and phase, those that no longer exist fade
/// in 5 ms, and the sound does not jump. Allocates only when the number of modes changes. False,
/// and nothing changed, if a value is not allowed.
bool himc_membrane_set_head(himc_membrane *membrane, const himc_head *head, himc_error *error);
/// A head of another outline, at rest; the old sound fades in 5 ms. Retains a grid. Air is known
/// for round heads alone.
bool himc_membrane_set_shape(himc_membrane *membrane, const himc_shape *shape,
                             const himc_head *head, himc_error *error);
HIMC_RT const himc_shape *himc_membrane_shape(const himc_membrane *membrane);
/// From now on it is heard by these `count` (1 .. HIMC_PICKUPS); fades over 5 ms.
bool himc_membrane_set_pickups(himc_membrane *membrane, const himc_pickup *pickups, int count,
                               himc_error *error);
/// Moves the first.
bool himc_membrane_set_pickup(himc_membrane *membrane, const himc_pickup *pickup,
                              himc_error *error);
/// Another sample rate; what sounds goes on sounding.
bool himc_membrane_set_rate(himc_membrane *membrane, double rate, himc_error *error);

/// Whether two are made, and heard, alike.
HIMC_RT bool himc_membrane_alike(const himc_membrane *a, const himc_membrane *b);
/// Makes `membrane` so: outline, head and pickups of `other`; what is alike goes on sounding.
bool himc_membrane_follow(himc_membrane *membrane, const himc_membrane *other, himc_error *error);

HIMC_RT const himc_head *himc_membrane_head(const himc_membrane *membrane);
/// The first, and all `count` of them.
HIMC_RT const himc_pickup *himc_membrane_pickup(const himc_membrane *membrane);
HIMC_RT const himc_pickup *himc_membrane_pickups(const himc_membrane *membrane, int *count);
HIMC_RT double himc_membrane_rate(const himc_membrane *membrane);
/// Mode `index` (0 .. head.modes-1) as it sounds, with its air.
HIMC_RT himc_mode himc_membrane_mode(const himc_membrane *membrane, int index);
/// Where the principal mode of such a head with this outline sounds (Hz): (1,1) if round, whether
/// or not it is in the list, else the lowest.
HIMC_RT double himc_membrane_principal(const himc_membrane *membrane, const himc_head *head);
/// The tension (N/m, HIMC_TENSION_MIN .. HIMC_TENSION_MAX) that brings it nearest to `frequency`.
HIMC_RT double himc_membrane_tension_for(const himc_membrane *membrane, const himc_head *head,
                                         double frequency);
/// Modes below 0.49 of the rate; those above are silent, not aliased.
HIMC_RT int himc_membrane_audible(const himc_membrane *membrane);

/// The place whose displacement the functions below give as `seen`.
HIMC_RT void himc_membrane_watch(himc_membrane *membrane, double x, double y);
/// Adds a force (N, down positive, as a stick's) at (x, y) (m) to the coming sample. At most 8 a
/// sample.
HIMC_RT void himc_membrane_push(himc_membrane *membrane, double x, double y, double force);
/// Plays `n` samples without contact: heard[k][i] is the sound of pickup k (1.0 as it says; for as
/// many as there are), seen[i] the displacement (m, up positive) of the watched place. The forces
/// pushed act in the first sample.
HIMC_RT void himc_membrane_run_all(himc_membrane *membrane, int n, double *const *heard,
                                   double *seen);
/// The same, the sound of the first pickup alone.
HIMC_RT void himc_membrane_run(himc_membrane *membrane, int n, double *heard, double *seen);
/// The last sample's, of the first pickup and of any.
HIMC_RT double himc_membrane_heard(const himc_membrane *membrane);
HIMC_RT double himc_membrane_heard_by(const himc_membrane *membrane, int pickup);
HIMC_RT double himc_membrane_seen(const himc_membrane *membrane);

/// Displacement of a place (m, up positive).
HIMC_RT double himc_membrane_displacement(const himc_membrane *membrane, double x, double y);
/// Kinetic and potential energy, the film's stretching included (J).
HIMC_RT double himc_membrane_energy(const himc_membrane *membrane);
/// What the tension has risen by as the head bows out (N/m).
HIMC_RT double himc_membrane_rise(const himc_membrane *membrane);
/// Displacement and velocity of mode `index` (m, m/s).
HIMC_RT void himc_membrane_state(const himc_membrane *membrane, int index, double *q, double *v);
/// Sets them.
HIMC_RT void himc_membrane_excite(himc_membrane *membrane, int index, double q, double v);
/// Brings the head to rest; the sound ends in 5 ms.
HIMC_RT void himc_membrane_rest(himc_membrane *membrane);

#endif
