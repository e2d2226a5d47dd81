/// membrane.h: a drumhead, its pickups, and sticks in contact with it. Second tier.
///
/// w(x, y, t) = sum_i phi_i(x, y) q_i(t), up positive; each q_i is a damped oscillator, loaded by
/// the air if the head says so; as the head bows out its tension rises by its glide. Positions (x,
/// y) are in metres from the centre, x away from the performer, y to the left. Needs libm alone.
/// Functions with a himc_error return NULL or false if they refuse, write one line into it (which
/// may be NULL), and change nothing.
#ifndef HIMC_MEMBRANE_H
#define HIMC_MEMBRANE_H

#include "himc/base.h"
#include "himc/ranges.h"

HIMC_BEGIN

/// The material of a head, with its modes and air.
typedef struct himc_head {
    double radius;         ///< a (m), 0.05 .. 1
    double tension;        ///< T (N/m), 10 .. 1e5
    double density;        ///< sigma (kg/m^2), 0.001 .. 1000
    double decay_constant; ///< S0 (1/s), 0 .. 1000: a mode decays as exp(-(S0 + S1 omega^2) t)
    double decay_square;   ///< S1 (s), 0 .. 1
    int modes;             ///< 1 .. HIMC_MODES_MAX, members of a pair counted; or HIMC_MODES_AUTO
    bool air;              ///< true if air and kettle load it; for round heads only
    double kettle;         ///< volume under it (m^3), half to twice the usual; 0 is the usual
    double glide;          ///< tension modulation, 0 none .. 1 a Mylar film's; of a cymbal: cascade
    double damp;           ///< a hand on the head: 0 none .. 1 dead at once
    double dampers;        ///< that a pedal lays on: felt, another cymbal (1/s), 0 .. 100
    double motor;          ///< swings a second of what a vibraphone's tubes send (Hz), 0: off .. 15
    double muffle;         ///< a cloth on the head: 0 none .. 1 all over it
    double wires;          ///< pull of wires to the lower head of two (m/s^2), 0: none .. 2000
    double uniformity;     ///< of the lugs' tension, 0 (2 % off) .. 1 even; of round heads only
    int uniformity_seed;   ///< which lugs are off, 0 .. HIMC_SEED_MAX
} himc_head;

/// As `modes` of a head: on a round head 209 exact modes, up to about 1.6 kHz on a timpano, and 392
/// statistical ones for all others up to 8 kHz and more; on others 200, or as many as it has.
#define HIMC_MODES_AUTO 0

/// One mode of the list. Modes with m > 0 come as a pair: cosine, then sine. On an even head their
/// frequency is equal; else the sine's is higher, and each order m has an axis of its own. If the
/// list ends within a pair, it has the cosine, which on an even head is the one that a blow on the
/// x axis excites.
typedef struct himc_mode {
    int m; ///< nodal diameters; of a rectangle half waves along x; of a grid 0; statistical: -1
    int n; ///< nodal circles with the rim; half waves along y; of a grid or statistical 1, 2, ...
    bool sine;        ///< the second one of a pair: sin(m (azimuth - axis)) in place of cos
    double axis;      ///< (rad), 0 on an even head
    double zero;      ///< j_mn; of other outlines its counterpart, wave number times radius
    double norm;      ///< integral of phi^2 over the head, per pi a^2
    double frequency; ///< undamped (Hz)
    double decay;     ///< (1/s): S0 + S1 omega^2 and the hand's, at most 0.9 omega
    double mass;      ///< sigma pi a^2 norm (kg)
    double stiffness; ///< mass omega^2 (N/m)
} himc_mode;

#define HIMC_MODES_MAX 4000 ///< chosen: bounds time and memory

/// Added to the decay of a bare head by `damp` 1 (1/s); chosen: T60 = 0.1 s.
#define HIMC_DAMP 69.0
/// Added by `muffle` 1 (1/s), and per omega (1); chosen: at D3 (1,1) has T60 = 0.3 s, what is
/// higher less.
#define HIMC_MUFFLE 30.0
#define HIMC_MUFFLE_HIGH 0.012

/// A timpano of 26 inches in air that sounds D3 (146.83 Hz): 0.2653 kg/m^2 (Christian et al. 1984),
/// HIMC_MODES_AUTO, lugs 1.6 % off (uniformity 0.2).
himc_head himc_head_default(void);

/// Kind of a pickup.
typedef enum himc_pickup_kind {
    HIMC_PICKUP_AIR,  ///< pressure far away; a sound of 1.0 is HIMC_PICKUP_PRESSURE
    HIMC_PICKUP_POINT ///< velocity of a point of the head; a sound of 1.0 is HIMC_PICKUP_VELOCITY
} himc_pickup_kind;

/// (Pa) chosen: the strongest stroke on a timpano, heard from one metre, stays below 1
#define HIMC_PICKUP_PRESSURE 130.0
#define HIMC_PICKUP_VELOCITY 10.0 ///< (m/s) chosen

/// Where the sound is read. Azimuth 0 is beyond the drum as the performer sees it, positive to
/// the left.
typedef struct himc_pickup {
    himc_pickup_kind kind; ///< AIR: azimuth, elevation, distance count; POINT: x, y
    double x;              ///< of the point of the head (m)
    double y;              ///< of the point of the head (m)
    double azimuth;        ///< of the listener (rad)
    double elevation;      ///< above the plane of the head (rad), 0 .. 1.5708
    double distance;       ///< from the centre (m), 0.3 .. 100
} himc_pickup;

/// Listening beyond the drum, 10 degrees up, from 1 m.
himc_pickup himc_pickup_default(void);

/// A drumhead with its state, and its pickups. Opaque.
typedef struct himc_membrane himc_membrane;

/// A round head at rest at `rate` (Hz, 4000 .. 480000), with the default pickup. Owned by the
/// caller.
himc_membrane *himc_membrane_new(const himc_head *head, double rate, himc_error *error);
/// Frees it. NULL is allowed.
void himc_membrane_free(himc_membrane *membrane);

/// Replaces the pickups by these `count` (1 .. HIMC_PICKUPS); their sound changes over in 5 ms.
bool himc_membrane_set_pickups(himc_membrane *membrane, const himc_pickup *pickups, int count,
                               himc_error *error);
/// Sets another sample rate (Hz, 4000 .. 480000); the sound goes on.
bool himc_membrane_set_rate(himc_membrane *membrane, double rate, himc_error *error);

/// Its head, borrowed.
HIMC_RT const himc_head *himc_membrane_head(const himc_membrane *membrane);
/// All pickups (*count), borrowed.
HIMC_RT const himc_pickup *himc_membrane_pickups(const himc_membrane *membrane, int *count);
/// Sample rate (Hz).
HIMC_RT double himc_membrane_rate(const himc_membrane *membrane);
/// Mode `index` (0 ..) as it sounds, with its air; all fields are 0 past the last.
HIMC_RT himc_mode himc_membrane_mode(const himc_membrane *membrane, int index);
/// Frequency of the principal mode (Hz) of `head` with this membrane's outline: (1,1) if round,
/// whether or not it is in the list, else the lowest.
HIMC_RT double himc_membrane_principal(const himc_membrane *membrane, const himc_head *head);
/// Number of modes below 0.49 of the rate; those above are silent, not aliased.
HIMC_RT int himc_membrane_audible(const himc_membrane *membrane);

/// Sets the watched point, whose displacement the functions below give; at first the centre.
HIMC_RT void himc_membrane_watch(himc_membrane *membrane, double x, double y);
/// Adds a force (N, down positive, as a stick's) at (x, y) to the coming sample. At most 8 in a
/// sample; more are ignored.
HIMC_RT void himc_membrane_push(himc_membrane *membrane, double x, double y, double force);
/// Advances by `n` samples without contact: sound[k][i] is the sound of pickup k (1.0 as its kind
/// says; as many rows as there are pickups), watched[i] the displacement (m, up positive) of the
/// watched point. A row that is NULL, or `watched`, costs no time; what follows below is then 0.
/// Pushed forces act in the first sample.
HIMC_RT void himc_membrane_run(himc_membrane *membrane, int n, double *const *sound,
                               double *watched);
/// The last sample's sound of pickup 0 .. count - 1 (1.0 as its kind says).
HIMC_RT double himc_membrane_sound(const himc_membrane *membrane, int pickup);
/// The displacement of the watched point now (m).
HIMC_RT double himc_membrane_watched(const himc_membrane *membrane);

/// Kinetic and potential energy, the film's stretching included (J).
HIMC_RT double himc_membrane_energy(const himc_membrane *membrane);
/// Displacement q and velocity v of mode `index` (0 ..) (m, m/s); 0 past the last audible one.
HIMC_RT void himc_membrane_state(const himc_membrane *membrane, int index, double *q, double *v);
/// Brings the head to rest; the sound ends in 5 ms.
HIMC_RT void himc_membrane_rest(himc_membrane *membrane);

// Contact: a mallet against a head, solved passively sample by sample.
//
// F = f (1 + mu c') + tau df/dt, f = k c^alpha + k_2 (c - 3 mm)^2.5, each term for a positive base
// (k, alpha: 2012 paper, equation 6; mu: Hunt and Crossley 1975; tau: Stulov 1995). F presses on a
// patch of the head, whose radius follows from the mallet's at the speed of the blow. The step is
// exact for the modes and gives back just the contact's potential energy, so energy never grows,
// whatever k.

/// The head of a stick.
typedef struct himc_mallet_head {
    double stiffness;  ///< k (N/m^alpha)
    double exponent;   ///< alpha, without unit
    double loss;       ///< mu (s/m)
    double mass;       ///< of a free mallet, and at a stick's end in a hand (kg)
    double radius;     ///< (m); 0 touches the head at a point
    double relaxation; ///< tau (s)
    double core;       ///< k_2 (N/m^2.5), 0 for none
    double noise;      ///< of a stroke, beside the head's sound, per that of medium felt
} himc_mallet_head;

/// A stick's end, moving along the head's normal. Heights are above the head at rest, less the
/// mallet's radius: the contact's compression is c = d(x, y) - height with d the head's
/// displacement, up positive.
///
/// During a contact the point of first contact holds: felt does not slide, and moving a loaded
/// point would do work. The caller sets the first group of fields, himc_contact_step the second,
/// which begins as 0. A stick that is put into the head, or deeper than it was, is lifted to the
/// surface, or to the compression that it had: only the step itself presses it in.
typedef struct himc_stick {
    himc_mallet_head head; ///< the felt at its end
    double mass;           ///< effective mass along the normal (kg)
    double acceleration;   ///< without contact (m/s^2, up positive)
    double x;              ///< on the head, away from the performer (m)
    double y;              ///< on the head, to the left (m)
    double height;         ///< up positive (m); the step moves it
    double velocity;       ///< up positive (m/s); the step changes it
    double hold;           ///< while it presses, the head is damped as by so much `damp`, 0 .. 1
    double shaft; ///< speed of a rim shot's shaft on the hoop over the tip's, 0: no rim shot
    bool one_way; ///< the stick meets a head at rest; the head's vibration does not push back

    double force;          ///< mean of the last sample (N, >= 0, on the stick upwards)
    bool touching;         ///< c > 0 after the last sample
    double contact_x;      ///< x of the point of first contact, while touching (m)
    double contact_y;      ///< y of it (m)
    double dent;           ///< displacement of the head there after the last sample (m)
    double compression;    ///< c after the last sample (m, negative: a gap)
    double peak;           ///< largest force of this contact (N)
    unsigned contacts;     ///< begun so far, chatter counted once
    double chatter;        ///< a force within this time (s) belongs to the same contact
    double impact;         ///< downward velocity at the beginning of the contact (m/s)
    double patch;          ///< radius of the disc of the head that it presses in this blow (m)
    double residual_root;  ///< of the compliance that the head has beside its modes ((m/N)^1/2)
    double residual_omega; ///< frequency of that (rad/s)
    double residual_x;     ///< its state: it adds residual_root residual_x to the displacement ...
    double residual_y;     ///< ... and has (residual_x^2 + residual_y^2)/2 of energy (J^1/2)
    double watched_x;      ///< x of the place from which it watches the head, in the air (m)
    double watched_y;      ///< y of it (m)
} himc_stick;

#define HIMC_STICKS 8 ///< of a performer at one head; its own mallets are as many; chosen

/// (m) A stick above this height is out of reach; chosen: no blow raises a head so far.
#define HIMC_CONTACT_REACH 0.02

/// (N) One-way, the head is driven by F_s = k_s c^alpha with k_s = k F_m / HIMC_ONE_WAY_FORCE and
/// F_m the largest force of the stick's motion in this contact (2012 paper, table 2 and equation 6:
/// k proportional to F_m). At 100 N the head meets the mallet's own stiffness; softer blows meet
/// softer felt. F_s is never more than the motion's own force: the path is rigid, and a head that
/// swings back into it would be pushed without bound.
#define HIMC_ONE_WAY_FORCE 100.0

/// Advances the head and all its sticks (at most 2 HIMC_STICKS) by one sample of its rate; several
/// are solved together.
HIMC_RT void himc_contact_step(himc_membrane *membrane, himc_stick *const *sticks, int count);

HIMC_END

#endif
