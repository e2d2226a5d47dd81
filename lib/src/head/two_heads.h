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
    double rim;     ///< how much louder than in a baffle statistical modes are, per root of z
    double wires;   ///< pull on its wires (m/s^2), 0: it has none
    double unequal; ///< of the sound of (0, n), as a dipole; chosen
    const himc_mallet_head *mallet;
};

/// The drum of that name, in the order of HIMC_SHELLS (himc/command_rows.h).
extern const himc_shell himc_shell_rows[];
/// The mallet of a kick: the beater of a pedal.
extern const himc_mallet_head himc_shell_beater;

/// Whether sticks play it, which also meet its hoop and its shell (fittings.c).
HIMC_RT bool himc_shell_has_hoop(const himc_shell *shell);

#define HIMC_WIRES_USUAL 250.0 ///< pull (m/s^2); chosen: they rattle for 50 ms

static inline bool himc_shell_takes_wires(const himc_shell *shell)
{
    return shell && shell->lower_density > 0;
}

/// Of a drum that has two heads, the modes' shapes where wire `wire` touches the lower one, to be
/// mixed (himc_modes_mix).
HIMC_RT void himc_two_heads_under(const himc_modes *modes, int wire, double *shapes);
/// Mode of the list that has the shape `index` of a round head alone, on the upper one; -1: none.
HIMC_RT int himc_two_heads_upper(const himc_modes *modes, int index);

// Hoop, shell, another stick (fittings.c).

#define HIMC_FITTINGS 16        ///< modes of all of them
#define HIMC_FITTINGS_RING 0.01 ///< width of the ring beyond the rim where each is met, per radius

/// What meets what at a spot beyond the rim, borrowed, and how far out, per radius. Of a rim shot
/// the shaft, as of a cross-stick.
HIMC_RT const himc_mallet_head *himc_fittings_meet(himc_spot spot, double *out);
/// A mode of theirs on a drum of that radius (m).
HIMC_RT himc_oscillator himc_fittings_oscillator(int index, double radius);
/// Its shape so far out, per radius.
HIMC_RT double himc_fittings_shape(int index, double out);
/// Its sound at 1 m per acceleration (Pa s^2/m).
HIMC_RT double himc_fittings_pressure(int index);

// Wires (wires.c). Arrays have an entry for each of them; displacements are the lower head's.

#define HIMC_WIRES 8 ///< points in their place; chosen: 24 sound no nearer to recorded ones

/// Where they touch the lower head: x, y per radius.
extern const double himc_wires_place[HIMC_WIRES][2];

typedef double himc_wires_matrix[HIMC_WIRES][HIMC_WIRES];

/// Counted from rest; up positive.
typedef struct himc_wires {
    bool awake; ///< else they stick to the head
    int still;  ///< samples in which they have hardly pressed otherwise than at rest
    double height[HIMC_WIRES], velocity[HIMC_WIRES]; ///< (m, m/s)
    double pressed[HIMC_WIRES];                      ///< compression (m)
    double force[HIMC_WIRES];                        ///< on the head (N)
} himc_wires;

/// They lie on the head where it is, and are awake.
HIMC_RT void himc_wires_rest(himc_wires *wires, const double *displacement);
/// The head has been moved between two steps: they keep their compression.
HIMC_RT void himc_wires_follow(himc_wires *wires, const double *displacement);
/// A step of length `h` (s) in which the head alone would come there: the changes `b` of the
/// compressions (m); `pull` > 0 (m/s^2).
HIMC_RT void himc_wires_begin(const himc_wires *wires, const double *displacement, double pull,
                              double h, double *b);
/// Finds the forces, beginning with those of the last step; `g` are the head's compliances (m/N).
HIMC_RT void himc_wires_solve(himc_wires *wires, double pull, double h, himc_wires_matrix g,
                              const double *b);
/// The step's end with these forces. They may be asleep then.
HIMC_RT void himc_wires_end(himc_wires *wires, double pull, double h, himc_wires_matrix g,
                            const double *b);
/// (J)
HIMC_RT double himc_wires_energy(const himc_wires *wires, double pull);

#endif
