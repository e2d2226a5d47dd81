/// modes.h: the modes of an ideal membrane: which there are, in order of frequency, and their
/// shapes. Round unless said otherwise.
///
/// Mode (m, n) has m nodal diameters and n nodal circles, phi = J_m(j_mn r/a) cos(m th) or sin(m
/// th), and sounds at j_mn/(2 pi a) sqrt(T/sigma) (Morse & Ingard 1968, section 5.2; Fletcher &
/// Rossing 1998, section 3.3). The list depends on nothing but its length: radius, tension and
/// density scale all frequencies alike.
#ifndef HIMC_MODES_H
#define HIMC_MODES_H

#include "himc/grid.h"

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
#define HIMC_TENSION_MIN 10.0 ///< (N/m)
#define HIMC_TENSION_MAX 1e5  ///< (N/m)

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
