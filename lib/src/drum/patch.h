/// patch.h: the part of a head that a mallet covers: its radius, its weight on each mode, and what
/// gives way beside the modes of a list.
#ifndef HIMC_PATCH_H
#define HIMC_PATCH_H

#include "himc/membrane.h"

/// Radius of the patch of a blow (m): `mallet` of effective mass `mass` (kg) meets `head` at
/// `speed` (m/s), `distance` from its centre (m). 0 for a mallet of radius 0, which is a point.
HIMC_RT double himc_patch_radius(const himc_head *head, const himc_mallet_head *mallet, double mass,
                                 double distance, double speed);

/// Mean of a mode over a patch per its value at the centre, W(z) = 2 J1(z)/z with z >= 0 the wave
/// number times the patch's radius.
HIMC_RT double himc_patch_weight(double z);

/// An oscillator that yields as all modes together that a list lacks. All 0 for none.
typedef struct himc_residual {
    double root;  ///< of its compliance ((m/N)^1/2)
    double omega; ///< undamped (rad/s)
} himc_residual;

/// The residual of that compliance (m/N) and inverse mass (1/kg); none if one is not positive.
HIMC_RT himc_residual himc_residual_of(double compliance, double per_mass);

/// A step of it: x' = stay x + turn y + (1 - stay) root f, y' = back y - turn x + turn root f with
/// the force f (N). Its displacement is root x, its energy (x^2 + y^2)/2 (x, y in J^1/2).
typedef struct himc_residual_step {
    double stay, turn, back;
} himc_residual_step;

/// Its step of length `h` (s).
HIMC_RT himc_residual_step himc_residual_in(const himc_residual *r, double h);

#endif
