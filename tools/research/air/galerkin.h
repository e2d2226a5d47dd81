/// galerkin.h: the modes of a head over its kettle in air, solved in full, to make and to check the
/// table of lib/src/head/air.c.
///
/// Frequencies are x = w a/c, and a drum is three numbers: epsilon = rho a/sigma, L/a and the
/// tension tau = T/(sigma c^2). Setup functions; they allocate.
#ifndef HIMC_AIR_GALERKIN_H
#define HIMC_AIR_GALERKIN_H

#include "head/air.h"

#define HIMC_AIR_BASIS 8    ///< functions J_m(j_mn r/a) that a loaded shape is made of
#define HIMC_AIR_CAVITY 120 ///< modes of the kettle for each angular order

/// Constants of one angular order.
typedef struct himc_air_order {
    int m;
    double alpha[HIMC_AIR_BASIS]; ///< j_mn
    double next[HIMC_AIR_BASIS];  ///< J_{m+1}(j_mn)
    double beta[HIMC_AIR_CAVITY]; ///< zeros of J_m', with 0 for m = 0
    double share[HIMC_AIR_CAVITY]
                [HIMC_AIR_BASIS]; ///< C_ns/sqrt(n_s): overlap of shape n and mode s of the kettle
} himc_air_order;

typedef struct himc_air_problem {
    double tension; ///< tau = T/(sigma c^2)
    double loading; ///< epsilon = rho a/sigma
    double depth;   ///< L/a = V/(pi a^3)
    double quality; ///< Q of the air in the kettle; INFINITY without loss
} himc_air_problem;

/// One resonance.
typedef struct himc_air_root {
    double x;       ///< w a/c
    double decay;   ///< delta a/c by radiation and the kettle's loss
    double inertia; ///< modal mass for a force distributed as J_m(j_mn r/a), per the bare head's
    double shape[HIMC_AIR_BASIS]; ///< parts of J_m(j_mn r/a), set by himc_air_solve
} himc_air_root;

/// Q of the air in a kettle. An effective value, chosen: friction at the wall and at a vent leave
/// 340 and more, and what a real kettle loses by its walls, at the rim and by jets is not measured.
/// With 40, (1,2) and (0,3) of a 26 inch drum ring for at most 1.1 and 0.9 s, and no mode with a
/// nodal circle takes over the sound.
#define HIMC_AIR_KETTLE_QUALITY 40.0

/// Computes the constants of angular order `m` (0 .. 20).
void himc_air_order_make(himc_air_order *order, int m);

/// Load of the air outside an infinite baffle at real x: added mass `real` and resistance `imag`,
/// per rho a^3.
void himc_air_outside(const himc_air_order *order, double x,
                      double real[HIMC_AIR_BASIS][HIMC_AIR_BASIS],
                      double imag[HIMC_AIR_BASIS][HIMC_AIR_BASIS]);

/// Load of the air in a rigid cylinder of depth L/a without loss, per rho a^3; for m = 0 without
/// the change of volume.
void himc_air_inside(const himc_air_order *order, double x, double depth,
                     double load[HIMC_AIR_BASIS][HIMC_AIR_BASIS]);

/// The resonance that responds most to each of the shapes n = 1 .. `count` (1 .. 4). False if the
/// eigenproblem could not be solved.
bool himc_air_solve(const himc_air_order *order, const himc_air_problem *problem, int count,
                    himc_air_root *roots, himc_error *error);

/// One oscillator for each of these shapes, as the table has it: where two resonances share a shape
/// it is a mean of both, which passes from the lower to the upper as the lower one's share falls.
bool himc_air_oscillators(const himc_air_order *order, const himc_air_problem *problem, int count,
                          himc_air_root *roots, himc_error *error);

#endif
