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

static himc_lugs_pair split(int m, double uniformity, const double *phase)
{
    int k = 2 * m;
    double hoop = k > LUGS / 2 ? 1 / (1 + pow(k / HOOP_ORDER, 4)) : 1;
    double harmonic = UNEVEN * (1 - uniformity) * 2 / sqrt(LUGS) * hoop;
    double turned = phase[k % LUGS / 2] + k / LUGS * HIMC_PI;
    // m th_k, and a quarter of a turn back to the cosine
    double angle = 0.5 * (turned - HIMC_PI);
    return (himc_lugs_pair){
        .split = harmonic * (2 * k - 1) / (2.0 * (k * k - 1)),
        .axis = angle / m,
        .cosine = cos(angle),
        .sine = sin(angle),
    };
}

void himc_lugs_split(double uniformity, int seed, himc_lugs_pair *pairs)
{
    uint64_t state = (uint64_t)seed, bits = himc_random_bits(&state);
    double part = ldexp((double)(himc_random_bits(&state) >> 11), -53);
    double turn = (bits & 4 ? 1 : -1) * HIMC_PI * (1 + part) / 3;
    // k th_k of the harmonics k = 0, 2 .. LUGS - 2, by k/2
    double phase[LUGS / 2] = {bits & 1 ? 0 : HIMC_PI, turn,
                              bits & 2 ? 0.5 * HIMC_PI : -0.5 * HIMC_PI, HIMC_PI - turn};
    for (int m = 0; m < HIMC_LUGS_ORDERS; m++)
        pairs[m] =
            m > 0 && uniformity < 1 ? split(m, uniformity, phase) : (himc_lugs_pair){.cosine = 1};
}
