/// statistical.h: the modes of a round head above those listed one by one, a few for many.
///
/// Where modes overlap, nobody hears one of them: only how many there are, how easily they are
/// moved, how they decay and how much of their energy they radiate. So a fixed list of plane waves
/// stands for them, an ordinary mode each. It depends on nothing: radius, tension and density scale
/// all its frequencies as those of the exact modes.
#ifndef HIMC_STATISTICAL_H
#define HIMC_STATISTICAL_H

#include "himc/base.h"

#define HIMC_STATISTICAL_MODES 392  ///< a multiple of 4
#define HIMC_STATISTICAL_FROM 30.0  ///< they begin at this radius times wavenumber, ...
#define HIMC_STATISTICAL_EXACT 209  ///< ... below which a round head has so many modes
#define HIMC_STATISTICAL_MOST 1.676 ///< no shape is larger: sqrt(2 (1 - J_0)), J_0 >= -0.4028
#define HIMC_STATISTICAL_EDGE 0.8   ///< largest square of a wave's speed over sound's in a formula

/// A statistical mode.
typedef struct himc_statistical_mode {
    double zero;  ///< radius times wavenumber
    double count; ///< of the head's modes that it stands for
} himc_statistical_mode;

/// What four neighbours share: they take cosine and sine of both phases.
typedef struct himc_statistical_wave {
    double zero;         ///< radius times wavenumber
    double x, y;         ///< direction across the head, of length `zero`
    double phase;        ///< at the centre (rad)
    double azimuth;      ///< of the place at the rim that they are heard from (rad)
    double phase_in_air; ///< (rad)
} himc_statistical_wave;

typedef struct himc_statistical {
    int count;                                              ///< of the modes, a multiple of 4
    himc_statistical_mode mode[HIMC_STATISTICAL_MODES];     ///< by increasing zero
    himc_statistical_wave wave[HIMC_STATISTICAL_MODES / 4]; ///< of modes 4 k .. 4 k + 3
} himc_statistical;

/// Fills the list with `count` modes (up to HIMC_STATISTICAL_MODES) above that radius times
/// wavenumber: up to another, by equal ratios; or, if that is 0, as many to a bandwidth.
void himc_statistical_list(himc_statistical *list, double from, double to, int count);

/// All shapes at (x, y) (per radius, inside the head) into `shapes` (count); the
/// mean of their squares over the head is 1.
HIMC_RT void himc_statistical_shapes(const himc_statistical *list, double x, double y,
                                     double *shapes);

/// The decay by radiation over rho c/(surface density with air), for a mode with that zero;
/// `square` is the square of the wave's speed over sound's.
HIMC_RT double himc_statistical_radiation(double zero, double square);

/// Amplitude of a mode's pressure far away over rho a^2/R and its acceleration: k a cos(elevation)
/// is `across`, `azimuth` the listener's.
HIMC_RT double himc_statistical_pressure(const himc_statistical *list, int index, double across,
                                         double azimuth);

#endif
