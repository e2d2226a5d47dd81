/// galerkin.h: the modes of a head over its kettle in air, solved in full, to make and to check the
/// table of lib/src/head/air.c.
///
/// Frequencies are x = w a/c, and a drum is three numbers: epsilon = rho a/sigma, L/a and the
/// tension tau = T/(sigma c^2). Setup functions; they need LAPACK.
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
} himc_air_problem;

/// One resonance.
typedef struct himc_air_root {
    double x;       ///< w a/c
    double decay;   ///< delta a/c by radiation
    double inertia; ///< modal mass for a force distributed as J_m(j_mn r/a), per the bare head's
} himc_air_root;

/// Computes the constants of angular order `m` (0 .. 20).
void himc_air_order_make(himc_air_order *order, int m);

/// Load of the air outside an infinite baffle at real x: added mass `real` and resistance `imag`,
/// per rho a^3.
void himc_air_outside(const himc_air_order *order, double x,
                      double real[HIMC_AIR_BASIS][HIMC_AIR_BASIS],
                      double imag[HIMC_AIR_BASIS][HIMC_AIR_BASIS]);

/// Load of the air in a rigid cylinder of depth L/a, per rho a^3; for m = 0 without the change of
/// volume.
void himc_air_inside(const himc_air_order *order, double x, double depth,
                     double load[HIMC_AIR_BASIS][HIMC_AIR_BASIS]);

/// The resonances that respond most to shapes n = 1 .. `count` (1 .. 4). False if the eigenproblem
/// could not be solved.
bool himc_air_solve(const himc_air_order *order, const himc_air_problem *problem, int count,
                    himc_air_root *roots, himc_error *error);

#endif
