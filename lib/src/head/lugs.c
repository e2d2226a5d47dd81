/// lugs.c: the splitting of pairs by the harmonics of an uneven tension.
///
/// L lugs at th_l = 2 pi (l + 1/2)/L (players strike between two lugs) pull with errors of standard
/// deviation s = 2 % (1 - uniformity) of T, independent of each other. The pull at the rim then has
/// harmonics T t_k cos k (th - th_k) of RMS t_k = 2 s/sqrt(L). Every head has just these; its seed
/// gives their directions, of t_2 only those in which a stroke on the x axis gives each member of
/// (1, n) at least a quarter of the energy (chosen: every seed can be heard). Harmonics finer than
/// the lugs, k > L/2, are aliases of coarser ones,
///     z_k = t_k exp(i k th_k) ~ sum_l e_l exp(i k th_l):   z_(L-k) = -conj(z_k),   z_(L+k) = -z_k,
/// which the hoop smooths by 1/(1 + (k/4)^4) (chosen); so z_(L/2) is imaginary and z_L real. k = 0
/// is tuning and does not count.
///
/// The film is in plane balance under this pull, without shear at the hoop (Airy's stress function
/// has r^k and r^(k+2)). To first order only the harmonic k = 2 m couples the members of a pair
/// (m, n), and splits it equally for every n (docs/model.md):
///     (f_sine - f_cosine)/f = t_k (2 k - 1)/(2 (k^2 - 1)).
/// The stiffer member, here the sine, has antinodes on the tighter axes th_k + j pi/m.
///
/// The members are the uneven head's own modes to this order: oscillators as any other, with the
/// pair's mass and each its own stiffness. Nothing couples them, so energy cannot grow. In air the
/// split is the same part of the frequency.
#include "head/lugs.h"

#include "base/random.h"

#include <math.h>

#define LUGS 8         // L; chosen: a timpano has 6 or 8 (the phases are for 8)
#define UNEVEN 0.02    // s with uniformity 0; chosen: a semitone is 12 % of tension
#define HOOP_ORDER 4.0 // k that the hoop halves; chosen
// t_8 with uniformity 0: eight points that pull have 2, of which the hoop keeps a 17th; guessed
#define PULL 0.1

// k th_k of the harmonics k = 0, 2 .. LUGS - 2, by k/2
static void find_phases(int seed, double *phase)
{
    uint64_t state = (uint64_t)seed, bits = himc_random_bits(&state);
    double part = himc_random_uniform(&state);
    double turn = (bits & 4 ? 1 : -1) * HIMC_PI * (1 + part) / 3;
    phase[0] = bits & 1 ? 0 : HIMC_PI;
    phase[1] = turn;
    phase[2] = bits & 2 ? 0.5 * HIMC_PI : -0.5 * HIMC_PI;
    phase[3] = HIMC_PI - turn;
}

static himc_lugs_harmonic harmonic(int k, double uniformity, const double *phase)
{
    if (k == LUGS) // tight at the lugs, half a step from the x axis
        return (himc_lugs_harmonic){PULL * (1 - uniformity), HIMC_PI};
    double hoop = k > LUGS / 2 ? 1 / (1 + pow(k / HOOP_ORDER, 4)) : 1;
    return (himc_lugs_harmonic){UNEVEN * (1 - uniformity) * 2 / sqrt(LUGS) * hoop,
                                phase[k % LUGS / 2] + k / LUGS * HIMC_PI};
}

void himc_lugs_fields(double uniformity, int seed,
                      himc_lugs_harmonic field[HIMC_LUGS_FIELD / 2 + 1])
{
    double phase[LUGS / 2];
    find_phases(seed, phase);
    field[0] = (himc_lugs_harmonic){0};
    for (int k = 2; k <= HIMC_LUGS_FIELD; k += 2)
        field[k / 2] = harmonic(k, uniformity, phase);
}

static himc_lugs_pair split(int m, double uniformity, const double *phase)
{
    int k = 2 * m;
    himc_lugs_harmonic h = harmonic(k, uniformity, phase);
    // m th_k, and a quarter of a turn back to the cosine
    double angle = 0.5 * (h.phase - HIMC_PI);
    return (himc_lugs_pair){
        .split = h.amount * (2 * k - 1) / (2.0 * (k * k - 1)),
        .axis = angle / m,
        .cosine = cos(angle),
        .sine = sin(angle),
    };
}

void himc_lugs_split(double uniformity, int seed, himc_lugs_pair *pairs)
{
    double phase[LUGS / 2];
    find_phases(seed, phase);
    for (int m = 0; m < HIMC_LUGS_ORDERS; m++)
        pairs[m] =
            m > 0 && uniformity < 1 ? split(m, uniformity, phase) : (himc_lugs_pair){.cosine = 1};
}
