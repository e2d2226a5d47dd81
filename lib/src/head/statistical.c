/// statistical.c: the density, mobility, radiation and directivity of a round head's high modes.
///
/// With z = k a, a head has N(z) = z^2/4 - z/2 modes below z (H. Weyl 1911; the second term is the
/// rim's). Film loss makes a mode's bandwidth grow with w^2. So n_s(z) = A (1/z_0 - 1/z) modes are
/// kept above z_0, A = z_0^2 N'(z_0): at z_0 each stands for one, further up always as many to a
/// bandwidth. That is three on a 26 inch head at D3, where three modes share a bandwidth at z_0.
/// n_s is cut into equal parts; each has one mode, at random, for the g modes of the part.
///
/// Point mobility. A diffuse field of waves of all directions, mirrored at a straight rim, has a
/// mean square 1 - J_0(2 k d) at the distance d from it, 1 far from it. A mode has that times
/// sqrt(2) cos(k e.x + psi), direction e and phase psi fixed, so that size and sign change smoothly
/// with the place; its mass is that of the head, divided by g: the mean of phi^2/m is that of g
/// modes.
///
/// Radiation. A mode of m nodal diameters below the speed of sound radiates (pickup.c)
///     p = (rho/R) a^2 j J_{m+1}(j) J_m(y)/(j^2 - y^2) {cos m az | sin m az} q'',   y = k_air a
///     sin th.
/// Near z there are sqrt(1 - m^2/z^2)/pi modes of order m in dz (Debye's phase of J_m), twice for m
/// > 0, and sum_m J_m^2 = 1, sum_m m^2 J_m^2 = y^2/2 over all integers. The mean of p^2 for a shape
/// of mean square 1 is therefore, with h = y^2/z^2,
///     (rho a^2 q''/R)^2 2/(pi z^3) (1 - h/4)/(1 - h)^2,
/// and its integral over the half sphere gives the mean decay, s = w^2/(k c)^2 the square of the
/// wave's speed over sound's and M mass per area with air,
///     delta = rho c/M (2 s/(pi z)) D(s),   D = int_0^1 (1 - h/4)/(1 - h)^2 d cos th,
/// h = s sin^2 th. The few modes of low m radiate nearly all of it (J_m(y) is small for m > y); the
/// mean is what their energy loses. Of four neighbours the pressures' signs and sizes come from a
/// place at the rim, where such waves radiate, in phase and a quarter of a period apart.
#include "head/statistical.h"

#include "base/random.h"
#include "head/bessel.h"

#include <math.h>

#define SEED 1 // chosen: any

// z below which `n` modes of a list are
static double zero_at(double from, double to, int count, double n)
{
    double density = from * from * (from - 1) / 2; // A, with z_0 = `from`
    return to > 0 ? from * pow(to / from, n / count) : 1 / (1 / from - n / density);
}

static double modes_below(double z)
{
    return 0.25 * z * z - 0.5 * z;
}

void himc_statistical_list(himc_statistical *list, double from, double to, int count)
{
    uint64_t state = SEED;
    list->count = count;
    for (int i = 0; i < count; i++)
        list->mode[i] = (himc_statistical_mode){
            .zero = zero_at(from, to, count, i + himc_random_uniform(&state)),
            .count = modes_below(zero_at(from, to, count, i + 1)) -
                     modes_below(zero_at(from, to, count, i)),
        };
    for (int k = 0; k < count / 4; k++) {
        double zero = zero_at(from, to, count, 4 * k + 2),
               direction = 2 * HIMC_PI * himc_random_uniform(&state);
        list->wave[k] = (himc_statistical_wave){
            .zero = zero,
            .x = zero * cos(direction),
            .y = zero * sin(direction),
            .phase = 2 * HIMC_PI * himc_random_uniform(&state),
            .azimuth = 2 * HIMC_PI * himc_random_uniform(&state),
            .phase_in_air = 2 * HIMC_PI * himc_random_uniform(&state),
        };
    }
}

void himc_statistical_shapes(const himc_statistical *list, double x, double y, double *shapes)
{
    double from_rim = 1 - sqrt(x * x + y * y);
    for (int k = 0; k < list->count / 4; k++) {
        const himc_statistical_wave *w = &list->wave[k];
        double near_rim = himc_bessel_j0(2 * w->zero * from_rim);
        double size = sqrt(2 * fmax(1 - near_rim, 0)), angle = w->x * x + w->y * y + w->phase;
        double even = size * cos(angle), odd = size * sin(angle);
        shapes[4 * k] = shapes[4 * k + 2] = even;
        shapes[4 * k + 1] = shapes[4 * k + 3] = odd;
    }
}

double himc_statistical_radiation(double zero, double square)
{
    // D in closed form; 1 - h = b^2 + s u^2 with u = cos th
    double s = fmin(square, HIMC_STATISTICAL_EDGE), b = 1 - s, root = sqrt(s / b);
    double once = atan(root) / (root * b), twice = 0.5 * (1 / b + once / b);
    return 2 * s / (HIMC_PI * zero) * (0.75 * twice + 0.25 * once);
}

double himc_statistical_pressure(const himc_statistical *list, int index, double across,
                                 double azimuth)
{
    const himc_statistical_wave *w = &list->wave[index / 4];
    const himc_statistical_mode *mode = &list->mode[index];
    double h = fmin(across * across / (mode->zero * mode->zero), HIMC_STATISTICAL_EDGE);
    double angle = across * cos(azimuth - w->azimuth) + w->phase_in_air;
    double sign = sqrt(2) * (index & 2 ? sin(angle) : cos(angle));
    return sign * sqrt(2 / (HIMC_PI * mode->zero * mode->count) * (1 - 0.25 * h)) /
           (mode->zero * (1 - h));
}
