/// membrane.h: a drumhead: its modes, swinging, and ears that hear them.
///
/// w(x, y, t) = sum_i phi_i(x, y) q_i(t), up positive; each q_i is an oscillator of the bank,
/// loaded by the air if the head says so; and as it bows out, its tension rises by its glide. Needs
/// libm alone.
#ifndef HIMC_MEMBRANE_H
#define HIMC_MEMBRANE_H

#include "himc/base.h"
#include "himc/ranges.h"

/// A head of masses and springs, read from a file.
typedef struct himc_grid himc_grid;

/// What the head is made of.
typedef struct himc_head {
    double radius;         ///< a (m), 0.05 .. 1
    double tension;        ///< T (N/m), 10 .. 1e5
    double density;        ///< sigma (kg/m^2), 0.001 .. 10
    double decay_constant; ///< S0 (1/s), 0 .. 1000: a mode decays as exp(-(S0 + S1 omega^2) t)
    double decay_square;   ///< S1 (s), 0 .. 1
    int modes;             ///< both members of a pair count, 1 .. HIMC_MODES_MAX
    bool air;              ///< whether air and kettle load it (air.h)
    double kettle;         ///< volume under it (m^3); 0 is the usual for its radius
    double glide;          ///< tension modulation: 0 none, 1 a Mylar film's
    double damp;           ///< a hand on the head: 0 none .. 1 dead at once
} himc_head;

/// A member of the list. One of m > 0 comes as a pair of equal frequency: cosine, then sine. A
/// count that cuts a pair keeps the cosine, which is the one that a blow on the x axis excites.
typedef struct himc_mode {
    int m, n;
    bool sine;
    double zero;      ///< j_mn
    double norm;      ///< integral of phi^2 over the head, per pi a^2
    double frequency; ///< undamped (Hz)
    double decay;     ///< (1/s): S0 + S1 omega^2 and the hand's, at most 0.9 omega: it still swings
    double mass;      ///< sigma pi a^2 norm (kg)
    double stiffness; ///< mass omega^2 (N/m)
} himc_mode;

#define HIMC_MODES_MAX 4000

/// What a hand's whole weight adds to the decay of a bare head (1/s): T60 = 0.1 s.
#define HIMC_DAMP 69.0

/// 23 inches, 0.2653 kg/m^2 (Christian et al. 1984), 200 modes, without air; tension and decay as
/// modes.c explains.
himc_head himc_head_default(void);

/// Every field of `head` in its range, or false with the field, the value and the range.
bool himc_head_check(const himc_head *head, himc_error *error);

/// The tension (N/m) at which the principal mode (1,1) of the bare head sounds at `frequency` (Hz).
double himc_head_tension_for(const himc_head *head, double frequency);

/// What a mode of that frequency (rad/s) loses, radiation not counted (1/s): S0 + S1 omega^2 and
/// the hand's resistance over its mass, `loading` times a bare head's; at most 0.9 omega.
HIMC_RT double himc_head_decay(const himc_head *head, double omega, double loading);

typedef enum himc_outline { HIMC_CIRCLE, HIMC_RECTANGLE, HIMC_GRID } himc_outline;

/// A head's outline. Its size is the head's radius, that of the circle around it.
typedef struct himc_shape {
    himc_outline kind;
    double length, width; ///< of a rectangle along x and y (m); only their ratio counts
    himc_grid *grid;      ///< of HIMC_GRID
} himc_shape;

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

// contact.h: a mallet against a head: Hertz's law with loss, solved passively sample by sample.
//
// F = k c^alpha (1 + mu c') for c > 0 (2012 paper, equation 6; Hunt and Crossley 1975). The step
// is exact for the modes and gives back just the contact's potential energy, so energy never grows
// whatever k.

/// The struck end of a stick.
typedef struct himc_mallet_head himc_mallet_head;
struct himc_mallet_head {
    double stiffness; ///< k (N/m^alpha)
    double exponent;  ///< alpha
    double loss;      ///< mu (s/m)
    double mass;      ///< of a free mallet (kg)
    double radius;    ///< (m)
};

/// A stick's end moving along the head's normal during micro-steps. Heights are above the head at
/// rest, the mallet's radius taken off: contact compression is c = d(x, y) - height with d the
/// head's displacement, up positive.
///
/// While it touches, the place of first touch holds: felt does not slide, and a change of place
/// under load would do work.
typedef struct himc_stick himc_stick;
struct himc_stick {
    himc_mallet_head head;
    double mass;             ///< effective mass along the normal (kg)
    double acceleration;     ///< without contact (m/s^2, up positive)
    double x, y;             ///< place on the head (m)
    double height, velocity; ///< up positive (m, m/s)
    double force;            ///< of the last sample, its mean (N, >= 0, on the stick upwards)
    bool one_way;  ///< the stick meets a head at rest; the head's vibration does not push back
    bool touching; ///< c > 0 after the last sample; contact.c's own, false to begin with
    double touch_x, touch_y; ///< where, while it touches (m); contact.c's own
    double dent;             ///< of the head under it after that (m); contact.c's own
    double peak;             ///< largest force of this touch (N); contact.c's own
    unsigned touches;        ///< begun so far, chatter counted once; contact.c's own
    double chatter;          ///< a force within this time (s) is still the same touch; its own
    double impact;           ///< downward velocity as the touch began (m/s); contact.c's own
};

#define HIMC_STICKS 8

/// A stick higher than this (m) is not looked at: no blow raises a head so far.
#define HIMC_CONTACT_REACH 0.02

/// One-way, the head is driven by F_s = k_s c^alpha with k_s = k F_m / HIMC_ONE_WAY_FORCE and F_m
/// the largest force of the stick's motion in this touch (2012 paper, table 2 and equation 6: k
/// proportional to F_m). At 100 N the head meets the mallet's own stiffness; softer blows meet
/// softer felt. F_s is never more than the motion's own force: the path does not yield as a stick
/// does, and a head that swings back into it would be pushed without bound.
#define HIMC_ONE_WAY_FORCE 100.0 // (N)

/// Advances the head and all its sticks (at most 2 HIMC_STICKS) by one sample of its rate; several
/// are solved together.
HIMC_RT void himc_contact_step(himc_membrane *membrane, himc_stick *const *sticks, int count);

/// For how many of the coming `n` samples no stick comes within HIMC_CONTACT_REACH, for sure.
HIMC_RT int himc_contact_clear(const himc_membrane *membrane, himc_stick *const *sticks, int count,
                               int n);

/// Moves a stick by one sample without looking at the head: what himc_contact_step does to one out
/// of reach.
HIMC_RT void himc_stick_fly(himc_stick *stick, double h);

/// Energy in a stick and its contact: m v^2/2 + k c^(alpha+1)/(alpha+1) (J); gravity not counted.
HIMC_RT double himc_contact_energy(const himc_membrane *membrane, const himc_stick *stick);

#endif
