/// contact.h: a mallet against a head: Hertz's law with loss, solved passively sample by sample.
///
/// F = k c^alpha (1 + mu c') for c > 0 (2012 paper, equation 6; Hunt and Crossley 1975). The step
/// is exact for the modes and gives back just the contact's potential energy, so energy never grows
/// whatever k.
#ifndef HIMC_CONTACT_H
#define HIMC_CONTACT_H

#include "himc/membrane.h"

/// The struck end of a stick.
typedef struct himc_mallet_head {
    double stiffness; ///< k (N/m^alpha)
    double exponent;  ///< alpha
    double loss;      ///< mu (s/m)
    double mass;      ///< of a free mallet (kg)
    double radius;    ///< (m)
} himc_mallet_head;

/// A stick's end moving along the head's normal during micro-steps. Heights are above the head at
/// rest, the mallet's radius taken off: contact compression is c = d(x, y) - height with d the
/// head's displacement, up positive.
///
/// While it touches, the place of first touch holds: felt does not slide, and a change of place
/// under load would do work.
typedef struct himc_stick {
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
} himc_stick;

#define HIMC_STICKS 8

/// A stick higher than this (m) is not looked at: no blow raises a head so far.
#define HIMC_CONTACT_REACH 0.02

/// One-way, the head is driven by F_s = k_s c^alpha with k_s = k F_m / HIMC_ONE_WAY_FORCE and F_m
/// the largest force of the stick's motion in this touch (2012 paper, table 2 and equation 6: k
/// proportional to F_m). At 100 N the head meets the mallet's own stiffness; softer blows meet
/// softer felt. F_s is never more than the motion's own force: the path does not yield as a stick
/// does, and a head that swings back into it would be pushed without bound.
#define HIMC_ONE_WAY_FORCE 100.0 // (N)

/// What a finished contact was.
typedef struct himc_contact_report {
    double time;     ///< of the first touch (s since the drum's realign)
    double x, y;     ///< place on the head (m)
    double velocity; ///< of impact, downward positive (m/s)
    double force;    ///< peak (N)
    double impulse;  ///< (N s)
    double duration; ///< (s)
} himc_contact_report;

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
