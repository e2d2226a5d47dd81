/// air.h: the effect of the air on both sides of a head, and of the kettle, on its modes.
///
/// Air moves with the head and makes it heavier, the low modes most; it carries sound away;
/// enclosed in the kettle it is a spring to the modes of order m = 0, mixes their shapes, and has
/// losses. Any other loaded mode keeps its shape and its stiffness T (j/a)^2 int phi^2 dS, so a
/// slow push and a change of tension act on the same head; its mass and decay change. A head
/// without air needs none of these functions.
///
/// In the head's own measures a drum is three numbers, tau = T/(sigma c^2), epsilon = rho a/sigma
/// and L/a = V/(pi a^3). A table, made once by solving the whole problem for drums of 20, 23, 26,
/// 29 and 32 inches, serves every head of like measures; closed forms do beyond it, joined without
/// a step or a bend in tension.
#ifndef HIMC_AIR_H
#define HIMC_AIR_H

#include "head/modes.h"

#define HIMC_AIR_SPEED 344.0  ///< c (m/s)
#define HIMC_AIR_DENSITY 1.21 ///< rho (kg/m^3); both as in Christian et al. 1984
/// Added mass of a mode by that of an infinite membrane; chosen: the table's higher modes.
#define HIMC_AIR_RIM 1.07

/// A head over its kettle: constant while neither changes.
typedef struct himc_air {
    double radius;         ///< a (m)
    double tension;        ///< tau
    double loading;        ///< epsilon
    double depth;          ///< L/a of the kettle
    int node, drum;        ///< cell of the table; this and the rest are set by air.c
    double along, between; ///< place in it (0 .. 1): in log tension, in epsilon
    double beyond;         ///< distance outside it in log tension
    double weight;         ///< of the table for this epsilon (0 .. 1)
} himc_air;

/// Volume (m^3) of a kettle of usual shape: 0.14 m^3 under a 26 inch head (Christian et al. 1984),
/// others alike.
HIMC_RT double himc_air_kettle(double radius);

/// True for half to twice the usual volume; else an error with the value and the range.
bool himc_air_check(double kettle, double radius, himc_error *error);

/// The air around `head` (in its ranges) over a kettle of that volume (m^3, within himc_air_check).
HIMC_RT himc_air himc_air_around(const himc_head *head, double kettle);

/// The effect of air on a mode.
typedef struct himc_air_load {
    double frequency; ///< per that of the bare head
    double radiation; ///< decay by sound carried away and the kettle's loss (1/s)
    double friction;  ///< decay by the air that rubs along head and kettle (1/s)
    double mass;      ///< modal mass per that of the bare head
    double stretch;   ///< stiffness of the film in its shape, per that in the bare shape
    double stiffness; ///< with the kettle's spring, the same: 1 for m > 0
} himc_air_load;

/// For mode (m, n) with the zero j_mn; a statistical one has m = -1.
HIMC_RT himc_air_load himc_air_on(const himc_air *air, int m, int n, double zero);

/// The shapes that the kettle's spring gives to the modes of order 0.
HIMC_RT himc_mixture himc_air_mixture(const himc_air *air);

/// The mode with that load: frequency, mass, stiffness, and decay S0 + S1 omega^2 at its new
/// frequency plus radiation and friction, at most 0.9 omega. S1 = eta/2 with eta = 0.6e-6 s is a
/// viscoelastic film's (Rhaouti, Chaigne & Joly 1999), S0 = 0.5 1/s the rest.
HIMC_RT himc_mode himc_air_loaded(const himc_air_load *load, const himc_head *head,
                                  const himc_mode *bare);
/// The same, with the load found first; that of both members of a pair is equal.
HIMC_RT himc_mode himc_air_mode(const himc_air *air, const himc_head *head, const himc_mode *bare);

// The table (air_table.c), computed by tools/research/air/table.c.

#define HIMC_AIR_DRUMS 5
#define HIMC_AIR_ORDERS 11 ///< m = 0 .. 10
#define HIMC_AIR_RANKS 4   ///< n = 1 .. 4
#define HIMC_AIR_NODES 16  ///< tensions, equally spaced in their logarithm, both ends included

#define HIMC_AIR_TABLE_FILM 0.2653 ///< sigma (kg/m^2)
#define HIMC_AIR_TABLE_LOW 800.0   ///< tension (N/m)
#define HIMC_AIR_TABLE_HIGH 12000.0
#define HIMC_AIR_KETTLE_SHAPE 3.967 ///< V/a^3
#define HIMC_AIR_FLOOR 1e-8         ///< added to delta a/c before its logarithm is taken
#define HIMC_AIR_RATIO_UNIT 1e-4    ///< of ln(f/f_bare)
#define HIMC_AIR_DECAY_UNIT 2e-3    ///< of ln(delta a/c + floor)

/// Entries of a table, and where the row of mode (m, n + 1) of a drum begins.
#define HIMC_AIR_ENTRIES (HIMC_AIR_DRUMS * HIMC_AIR_ORDERS * HIMC_AIR_RANKS * HIMC_AIR_NODES)
#define HIMC_AIR_ROW(drum, m, n) \
    ((((drum)*HIMC_AIR_ORDERS + (m)) * HIMC_AIR_RANKS + (n)) * HIMC_AIR_NODES)

extern const double himc_air_radius[HIMC_AIR_DRUMS]; ///< (m)
extern const short himc_air_ratio[HIMC_AIR_ENTRIES], himc_air_decay[HIMC_AIR_ENTRIES];

/// Added mass of a mode at rest per rho a and area, outside and in the kettle (without its change
/// of volume).
extern const double himc_air_outer[HIMC_AIR_ORDERS][HIMC_AIR_RANKS];
extern const double himc_air_inner[HIMC_AIR_ORDERS][HIMC_AIR_RANKS];
/// First zero of J_m' after 0.
extern const double himc_air_slosh[HIMC_AIR_ORDERS];

#endif
