/// air_table.h: what tools/air/table.c has computed for air.c.
#ifndef HIMC_AIR_TABLE_H
#define HIMC_AIR_TABLE_H

#include "drum/air.h"

#define HIMC_AIR_DRUMS 4
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
