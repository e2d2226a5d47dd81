/// modes.h: the modes of an ideal membrane: which there are, in order of frequency, and their
/// shapes. Round unless said otherwise.
///
/// Mode (m, n) has m nodal diameters and n nodal circles, phi = J_m(j_mn r/a) cos(m th) or sin(m
/// th), and sounds at j_mn/(2 pi a) sqrt(T/sigma) (Morse & Ingard 1968, section 5.2; Fletcher &
/// Rossing 1998, section 3.3). The list depends on nothing but its length: radius, tension and
/// density scale all frequencies alike.
#ifndef HIMC_MODES_H
#define HIMC_MODES_H

#include "drum/grid.h"
#include "himc/membrane.h"

typedef struct himc_modes himc_modes;

/// The lowest `count` modes (1 .. HIMC_MODES_MAX) of a round head.
himc_modes *himc_modes_new(int count, himc_error *error);
/// And of any; a grid (retained) has no more than it came with. Modes of a rectangle have m and n
/// half waves along x and y, those of a grid are numbered by n; both have no pairs.
himc_modes *himc_modes_new_of(const himc_shape *shape, int count, himc_error *error);
void himc_modes_free(himc_modes *modes);

HIMC_RT int himc_modes_count(const himc_modes *modes);
HIMC_RT const himc_shape *himc_modes_outline(const himc_modes *modes);
/// Area of the head (m^2).
HIMC_RT double himc_modes_area(const himc_modes *modes, double radius);

/// Mode `index` (0 .. count-1) of that head.
HIMC_RT himc_mode himc_modes_get(const himc_modes *modes, const himc_head *head, int index);

/// Its shape at (x, y) (m); 0 outside the head. Exact; himc_modes_shapes is the fast way.
double himc_modes_shape(const himc_modes *modes, double radius, int index, double x, double y);

/// All shapes at (x, y) (m) into `shapes` (count), from a table, within 1e-8.
HIMC_RT void himc_modes_shapes(const himc_modes *modes, double radius, double x, double y,
                               double *shapes);

/// Of a head that is not round: the integrals of a shape times cos and sin of kx x + ky y (k in
/// rad/m) over it (m^2).
HIMC_RT void himc_modes_beam(const himc_modes *modes, double radius, int index, double kx,
                             double ky, double *even, double *odd);

#endif
