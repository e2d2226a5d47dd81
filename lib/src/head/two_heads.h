/// two_heads.h: drums with a shell: two heads and the air between them, or one head over an open
/// shell.
#ifndef HIMC_TWO_HEADS_H
#define HIMC_TWO_HEADS_H

#include "head/kind.h"

/// A drum of a usual size. A larger one is deeper, slacker and rings longer, by powers of the ratio
/// of their radii. Its head (himc/membrane.h) is the upper one; the lower one keeps its ratios to
/// it, whatever is tuned.
struct himc_shell {
    const char *name;
    double radius, depth;   ///< (m)
    double tension;         ///< (N/m)
    double density;         ///< (kg/m^2)
    double constant;        ///< S0 (1/s)
    double square;          ///< S1 (s)
    double deeper, slacker; ///< powers of the depth, and of 1/tension; 1/S0 and 1/S1: two_heads.c
    // of the lower head, per upper one; density 0: there is none
    double lower_tension, lower_density, lower_constant, lower_square;
    double wires; ///< pull on its wires (m/s^2), 0: it has none
    himc_mallet_head mallet;
};

/// The drum of that name, in the order of HIMC_SHELLS (himc/command_rows.h).
extern const himc_shell himc_shells[];

#define HIMC_WIRES_USUAL 250.0 ///< pull (m/s^2); chosen: they rattle for 50 ms

static inline bool himc_shell_takes_wires(const himc_shell *shell)
{
    return shell && shell->lower_density > 0;
}

/// Of a drum that has two heads, the modes' shapes at a point of the lower one, each to be mixed
/// (himc_modes_mix).
HIMC_RT void himc_two_heads_under(const himc_modes *modes, double radius, double x, double y,
                                  double *shapes);
/// Mode of the list that has the shape `index` of a round head alone, on the upper one; -1: none.
HIMC_RT int himc_two_heads_upper(const himc_modes *modes, int index);

#endif
