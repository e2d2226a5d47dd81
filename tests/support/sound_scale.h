/// sound_scale.h: the largest displacement and sample that an energy in a head can give.
///
/// Displacement at x: with the energy E in the modes, |sum phi_i q_i| <= sqrt(2 E sum phi_i^2/K_i)
/// (Cauchy and Schwarz). Air pickup at distance R of a head of area A and mass sigma per area: the
/// pressure is at most rho/(2 pi R) sqrt(A) |a|, |a| the root of the integral of the acceleration's
/// square. Modes below w give |a| <= w |v|, twice over as even and odd m are read a quarter of a
/// period apart; a force in a step of h gives |dv|/h, and each |v| <= sqrt(2 E/sigma). Point
/// pickup: sqrt(2 E sum phi_i^2/m_i). E is the energy of the head and of all sticks on it.
///
/// A declick of L samples starts with the difference of two sounds, at most twice the larger scale
/// S, and of their slopes, at most 4 S per sample. It is a cubic that adds 4/27 L times the slope
/// at most. A change before its end begins another one at its value and slope, which like an
/// oscillator with v'' = -6 v/L^2 - 4 v'/L only falls. So (3 + 0.6 L) S bounds the sum.
#ifndef HIMC_TESTS_SOUND_SCALE_H
#define HIMC_TESTS_SOUND_SCALE_H

#include "drum/contact.h"
#include "drum/drum_state.h"
#include "drum/membrane_state.h"
#include "head/modes.h"

#include <math.h>

#define SOUND_SCALE_RHO 1.2 // (kg/m^3) of air

/// sum phi_i^2/K_i at (x, y) (m/N), and sum phi_i^2/m_i (1/kg).
static inline double point_yield(const himc_drum *d, double x, double y, double *inverse_mass)
{
    static double shape[HIMC_MODES_MAX + 4];
    const himc_membrane *m = d->membrane;
    double yield = 0;
    himc_modes_shapes(m->model->modes, m->model->config.head.radius, x, y, shape);
    *inverse_mass = 0;
    for (int i = 0; i < himc_membrane_audible(m); i++) {
        himc_mode mode = himc_membrane_mode(m, i);
        yield += shape[i] * shape[i] / (mode.mass * pow(2 * HIMC_PI * mode.frequency, 2));
        *inverse_mass += shape[i] * shape[i] / mode.mass;
    }
    return yield;
}

/// Largest displacement of the watched point (m) with `energy` (J) in the head.
static inline double largest_displacement(const himc_drum *d, double energy)
{
    double unused;
    return sqrt(2 * energy * point_yield(d, d->outside_x, d->outside_y, &unused));
}

/// Largest sample of a pickup with `energy` (J) in head and sticks, without declicks.
static inline double largest_sample(const himc_drum *d, int pickup, double energy)
{
    int count;
    const himc_membrane *m = d->membrane;
    const himc_pickup *at = &himc_membrane_pickups(m, &count)[pickup];
    double area = HIMC_PI * pow(m->model->config.head.radius, 2), inverse_mass;
    double step = 1 / (d->rate * himc_membrane_substeps(d->rate));
    double fastest = sqrt(2.0) * 2 * HIMC_PI * 0.49 * d->rate + 2 / step;
    if (at->kind == HIMC_PICKUP_POINT) {
        point_yield(d, at->x, at->y, &inverse_mass);
        return sqrt(2 * energy * inverse_mass) / HIMC_PICKUP_VELOCITY;
    }
    return SOUND_SCALE_RHO / (2 * HIMC_PI * at->distance * HIMC_PICKUP_PRESSURE) *
           sqrt(2 * area * energy / m->model->config.head.density) * fastest;
}

/// The same with declicks, `scale` being the largest before and after the changes.
static inline double largest_declicked(const himc_drum *d, double scale)
{
    return (3 + 0.6 * (DECLICK_TIME * d->rate + 1)) * scale;
}

/// Energy in the head and in its own mallets (J).
static inline double drum_energy(const himc_drum *d)
{
    double sum = himc_membrane_energy(d->membrane);
    for (int i = 0; i < HIMC_STICKS; i++)
        if (d->mallets[i].used)
            sum += himc_contact_energy(&d->mallets[i].stick);
    return sum;
}

#endif
