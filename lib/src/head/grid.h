/// grid.h: a head of masses and springs at given places, so that any outline can be played.
///
/// M z'' + K z = f (2012 paper, equations 4 and 5) at N places. A head's file is text, one item a
/// line, `#` begins a comment; file names in it are relative to it:
///     tension 3528        the tension (N/m) and
///     density 0.2653      mass per area (kg/m^2) that the matrices are made for
///     places places.txt   rows of X Y (m), first the N of the matrices, then any that stand still;
///                         N up to 800, all up to 4000
///     mass mass.mtx       N x N (kg), symmetric, positive
///     stiffness k.mtx     N x N (N/m), symmetric, not negative
/// A matrix is a Matrix Market file (coordinate or array, real or integer, general or symmetric) or
/// N rows of N numbers. A free body, for example a bar, also has motions without bending; they
/// make no sound and are left out, as if it lay on something soft. Between places a shape is
/// interpolated linearly (grid_kind.c), so list the rim.
#ifndef HIMC_GRID_H
#define HIMC_GRID_H

#include "himc/base.h"

#define HIMC_GRID_PLACES 800 ///< most places that move; chosen: a second of computing

/// Its modes. Constant once made; counts its references, which may be in several threads.
typedef struct himc_grid himc_grid;
struct himc_grid {
    _Atomic int references;
    char *path;              ///< of the file (owned)
    int places;              ///< that move
    int all;                 ///< with those that stand still
    int modes;               ///< in order of frequency
    bool free;               ///< not held: moves without bending, so it is under no tension
    double tension, density; ///< of the file (N/m, kg/m^2)
    double radius;           ///< of the circle around all places (m)
    double *x, *y;           ///< from that circle's centre, per radius (all)
    double *area;            ///< of head around each, per radius^2 (places)
    double *zero;            ///< radius times wavenumber (modes)
    double *norm;            ///< modal mass per density pi radius^2 (modes)
    double *shape;           ///< (modes, places); the largest of each is 1
};

/// Reads the file and computes the modes. NULL with "file:line: ..." or the fault of a matrix. One
/// reference belongs to the caller.
himc_grid *himc_grid_load(const char *path, himc_error *error);
himc_grid *himc_grid_retain(himc_grid *grid);
void himc_grid_release(himc_grid *grid);

#endif
