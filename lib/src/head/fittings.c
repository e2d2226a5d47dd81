/// fittings.c: what a stick meets of a snare drum, a tom or a timbale beside its heads: the hoop,
/// the shell, and another stick.
///
/// They are modes in the drum's list like those of its heads, and move only where they are struck:
/// just beyond the rim, each in a ring of its own (HIMC_FITTINGS_RING). So their contacts are those
/// of contact.c, and energy never grows. A shaft on the hoop bends, too: the compression is that of
/// the hoop and of the stick together, so both have the shape 1 there. Modes of the hoop and of the
/// shell have their largest amplitude where they are struck, as the drum is round. A hoop of
/// 2.5 kg bends in rings; one of the same profile, at 1/radius^2. A stick that a hand holds, or
/// that lies on the head, bends at 1200 and 3090 Hz, as recorded cross-sticks sound.
///
/// Chosen: all frequencies but those two, all losses (T60 of .02 to .1 s: a click) and what they
/// send, by the sound of hoop and shell as wide strips of .04 and .14 m. That the heads hear
/// nothing of hoop and shell is left out.
#include "head/two_heads.h"

#include "himc/vec.h"

#include <math.h>

#define USUAL 0.178 // (m) radius of the drum with these

enum { HOOP, STICK, SHELL, KINDS };

static const struct {
    int of;
    double frequency, t60, mass; // (Hz, s, kg)
    double pressure;             // at 1 m, any way, per acceleration (Pa s^2/m)
} fitting[HIMC_FITTINGS] = {
    {HOOP, 620, 0.1, 1.2, 3e-3},     {HOOP, 1150, 0.08, 1.2, 4e-3},
    {HOOP, 1750, 0.07, 1.2, 5e-3},   {HOOP, 2450, 0.06, 1.2, 6e-3},
    {HOOP, 3300, 0.05, 1.2, 5e-3},   {HOOP, 4300, 0.04, 1.2, 4e-3},
    {HOOP, 5600, 0.03, 1.2, 2.5e-3}, {STICK, 1200, 0.06, 0.03, 6e-4},
    {STICK, 3090, 0.03, 0.03, 3e-4}, {STICK, 5600, 0.02, 0.03, 1e-4},
    {SHELL, 340, 0.12, 2, 3e-3},     {SHELL, 520, 0.12, 2, 4e-3},
    {SHELL, 790, 0.1, 2, 4e-3},      {SHELL, 1150, 0.08, 2, 3e-3},
    {SHELL, 1600, 0.07, 2, 2e-3},    {SHELL, 2200, 0.06, 2, 1.5e-3},
};

// Hertz: hickory on a steel hoop, the shafts of two sticks (computed), wood on a shell (chosen).
// The shaft's mass is that of a stick that turns about its fulcrum, halfway to the tip. Of a
// cross-stick the whole is in the terms of the end that moves twice as far: a force is half, a
// displacement twice as large.
#define LEVER 2.0
#define HICKORY 1.2e9
static const himc_mallet_head
    laid = {.stiffness = HICKORY / (LEVER * LEVER * 1.41421356),
            .exponent = 1.5,
            .relaxation = 2e-6},
    on_hoop = {.stiffness = HICKORY, .exponent = 1.5, .mass = 0.05, .relaxation = 2e-6},
    on_stick = {.stiffness = 7e7, .exponent = 1.5, .mass = 0.05, .relaxation = 5e-6},
    on_shell = {.stiffness = 3e8, .exponent = 1.5, .mass = 0.05, .relaxation = 5e-6};

// Shapes in each ring, from the rim outwards. A hoop under the hand of a cross-stick moves less;
// chosen.
static const double moves[][KINDS] = {{0.15 * LEVER, LEVER, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}};
static const himc_mallet_head *const met[] = {&laid, &on_hoop, &on_stick, &on_shell};

const himc_mallet_head *himc_fittings_meet(himc_spot spot, double *out)
{
    int ring = (int)spot - HIMC_SPOT_CROSSSTICK; // in the order of the spots
    *out = 1 + (ring + 0.5) * HIMC_FITTINGS_RING;
    return met[ring];
}

himc_oscillator himc_fittings_oscillator(int index, double radius)
{
    double smaller = USUAL / radius, of = fitting[index].of;
    double by = of == HOOP ? smaller * smaller : of == SHELL ? smaller : 1;
    return (himc_oscillator){2 * HIMC_PI * fitting[index].frequency * by,
                             log(1000) / fitting[index].t60, fitting[index].mass};
}

double himc_fittings_shape(int index, double out)
{
    int ring = (int)((out - 1) / HIMC_FITTINGS_RING);
    return out > 1 && ring < KINDS + 1 ? moves[ring][fitting[index].of] : 0;
}

double himc_fittings_pressure(int index)
{
    return fitting[index].pressure;
}
