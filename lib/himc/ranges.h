/// ranges.h: the ranges of the physical quantities, shared by the commands' arguments
/// (lib/src/base/argument.c) and by the checks of the structs that C programs fill.
///
/// They are wide but physical: no drum, person or room lies outside them. Chosen: the orders of
/// magnitude of drums from bongo to gong, and what the simulation has been tested with.
#ifndef HIMC_RANGES_H
#define HIMC_RANGES_H

#define HIMC_RADIUS_MIN 0.05           ///< of a head (m)
#define HIMC_RADIUS_MAX 1.0            ///< (m)
#define HIMC_TENSION_MIN 10.0          ///< of a head (N/m)
#define HIMC_TENSION_MAX 1e5           ///< (N/m)
#define HIMC_DENSITY_MAX 1000.0        ///< of a head or plate: 13 cm of steel (kg/m^2)
#define HIMC_SIGMA0_MAX 1000.0         ///< decay of all modes, from 0 (1/s)
#define HIMC_SIGMA1_MAX 1.0            ///< decay with the square of the frequency, from 0 (s)
#define HIMC_WIRES_MAX 2000.0          ///< pull of a strainer on wires, from 0 (m/s^2); chosen
#define HIMC_MOTOR_MAX 15.0            ///< swings a second by a vibraphone, from 0 (Hz); chosen
#define HIMC_INCHES_MIN 12.0           ///< diameter of a drum (inches)
#define HIMC_INCHES_MAX 60.0           ///< (inches)
#define HIMC_INCHES_USUAL 26.0         ///< when nothing is said: the commonest timpano (inches)
#define HIMC_PICKUPS 8                 ///< most that a membrane is heard by at once
#define HIMC_ELEVATION_MAX 1.5708      ///< of a pickup over the head: overhead, from 0 (rad)
#define HIMC_PICKUP_DISTANCE_MIN 0.3   ///< from the head's centre (m)
#define HIMC_PICKUP_DISTANCE_MAX 100.0 ///< (m)
#define HIMC_STRIKE_VELOCITY_MIN 0.001 ///< of a mallet without a hand (m/s); chosen
#define HIMC_STRIKE_VELOCITY_MAX 30.0  ///< of a mallet without a hand (m/s)
#define HIMC_FORCE_MAX 1e4             ///< on a head: 1 kg at 30 m/s, stopped in 3 ms (N)

#define HIMC_PHYSICS_RATE_MIN 500.0   ///< (Hz)
#define HIMC_PHYSICS_RATE_MAX 48000.0 ///< (Hz)
#define HIMC_TASK_RATE_MIN 50.0       ///< (Hz)
#define HIMC_TASK_RATE_MAX 2000.0     ///< (Hz)
#define HIMC_BPM_MIN 1.0              ///< (beats per minute)
#define HIMC_BPM_MAX 1000.0           ///< (beats per minute)
#define HIMC_LATENCY_MAX 1000.0       ///< of a hit, from 0 (ms)
#define HIMC_SEED_MAX 999999.0        ///< of random numbers, from 0
#define HIMC_BODY_MASS_MIN 30.0       ///< of a player (kg)
#define HIMC_BODY_MASS_MAX 200.0      ///< (kg)

#endif
