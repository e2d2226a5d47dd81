/// pickup.c: the sound of each mode at a listener far from the head, or at a point of it.
///
/// Rayleigh's integral over a baffled membrane gives, far away in the direction (th from the
/// normal, az), with k = w/c and x = k a sin th,
///     p = (rho/R) (-i)^m a^2 j J_{m+1}(j) J_m(x)/(j^2 - x^2) {cos m az | sin m az} q''(t - R/c)
/// (Morse & Ingard 1968, section 7.4; the integral of two Bessel functions is Lommel's). The common
/// delay R/c is left out.
///
/// Nearer, the lowest multipole that a mode sends, of order m, is stronger by |x h_m(x)|, x = k R,
/// h_m the spherical Hankel function (Morse & Ingard 1968, section 7.2): at 1 m 1 dB for (3,1) at
/// D3 and 7 dB at C2, whose sound is longer. (0,n) are monopoles, which have no near field, and
/// statistical modes are far in theirs. The phase of it is left out.
///
/// With the time factor exp(-i w t), -i q'' is -w q'. So modes of even m sound by their
/// acceleration, those of odd m a quarter of a period apart, by w times their velocity; the signs
/// repeat with period 4 in m. A statistical mode counts as one of odd m.
///
/// A head without air would give no pressure at all. It is given what Rayleigh's integral makes of
/// it, times BARE: it loses no sound, its loudest mode (0,1) rings on for seconds, and with the
/// same stroke it would be heard 14 dB louder than the same head in air.
///
/// The acceleration includes the force itself: q'' = phi f/m - w^2 q - 2 d q'. Without that part, a
/// mallet pressing on the head would give a pressure that does not exist, for in equilibrium phi
/// f/m cancels w^2 q.
#include "head/pickup.h"

#include "head/air.h"
#include "head/bessel.h"

#include <math.h>

#define NEAREST 2         // (radii) chosen: nearer, higher multipoles count, and it grows no more
#define MOST_NEARER 1e150 // of a far field below 1e-150, of modes far below what is heard
#define BARE 0.2 // chosen: within 2 dB in loudness (ITU-R BS.1770) of the same stroke in air

himc_pickup himc_pickup_default(void)
{
    return (himc_pickup){.kind = HIMC_PICKUP_AIR, .elevation = 10 * HIMC_PI / 180, .distance = 1};
}

bool himc_pickup_check(const himc_pickup *pickup, const himc_head *head, himc_error *error)
{
    if (pickup->kind == HIMC_PICKUP_AIR)
        return himc_check_range("pickup: AZIMUTH", pickup->azimuth, -2 * HIMC_PI, 2 * HIMC_PI,
                                "rad", error) &&
               himc_check_range("pickup: ELEVATION", pickup->elevation, 0, HIMC_ELEVATION_MAX,
                                "rad", error) &&
               himc_check_range("pickup: DISTANCE", pickup->distance, HIMC_PICKUP_DISTANCE_MIN,
                                HIMC_PICKUP_DISTANCE_MAX, "m", error);
    double r = hypot(pickup->x, pickup->y);
    return himc_check_range("pickup: X Y, from the centre", r, 0, head->radius, "m", error);
}

// J_{m+1} at the mode's zero, which is in its norm; the sign changes from zero to zero
static double bessel_next(const himc_mode *mode)
{
    double size = sqrt(mode->m > 0 ? 2 * mode->norm : mode->norm);
    return mode->n % 2 ? size : -size;
}

// the integral of J_m(j r/a) J_m(x r/a) r dr over the head, by a^2, with J_{m+1}(j) and J_m(x)
static double overlap(double j, double next, double x, double bessel)
{
    return fabs(x - j) < 1e-6 * j ? 0.5 * next * next : j * next * bessel / ((j - x) * (j + x));
}

// that of a mode, or of the mixture that a kettle makes of modes of order 0
static double whole_overlap(const himc_head *head, const himc_modes *modes, const himc_mode *mode,
                            double x, double bessel)
{
    const himc_mixture *mix = &modes->mixture;
    if (mode->m != 0 || mode->n > mix->count)
        return overlap(mode->zero, bessel_next(mode), x, bessel);
    double sum = 0;
    for (int k = 0; k < mix->count; k++) {
        himc_mode bare = himc_modes_get(modes, head, mix->index[k]);
        sum += mix->part[mode->n - 1][k] * overlap(bare.zero, bessel_next(&bare), x, bessel);
    }
    return sum;
}

// those of all modes of a block
static void find_overlaps(const himc_modes *modes, const himc_uneven_block *block, double x,
                          double overlaps[HIMC_UNEVEN_MODES])
{
    const himc_mixture *mix = &modes->mixture;
    double j[HIMC_UNEVEN_ORDERS], bare[HIMC_UNEVEN_RANKS];
    int of_order_0 = 0, at[HIMC_UNEVEN_RANKS];
    himc_bessel_orders(x, HIMC_UNEVEN_ORDERS - 1, j);
    for (int l = 0; l < block->count; l++) {
        int m = block->even[l].m;
        overlaps[l] = overlap(block->even[l].zero, block->even[l].slope, x, j[m]);
        if (m == 0) {
            bare[of_order_0] = overlaps[l];
            at[of_order_0++] = l;
        }
    }
    for (int n = 0; n < mix->count && n < of_order_0; n++) {
        overlaps[at[n]] = 0;
        for (int k = 0; k < mix->count; k++)
            overlaps[at[n]] += mix->part[n][k] * bare[k];
    }
}

// pressure at R per that of the far field, of modes of orders 0 .. top; x = k R
static void near_fields(int top, double x, double *out)
{
    double j = sin(x), y = -cos(x), j_before = cos(x), y_before = sin(x);
    out[0] = 1;
    for (int m = 1; m <= top; m++) {
        double j_next = (2 * m - 1) / x * j - j_before, y_next = (2 * m - 1) / x * y - y_before;
        j_before = j;
        y_before = y;
        j = j_next;
        y = y_next;
        out[m] = fmin(sqrt(j * j + y * y), MOST_NEARER); // once both are infinite, NaN, too
    }
}

// sound per pascal of Rayleigh's integral
static double per_pascal(const himc_head *head)
{
    return (head->air ? 1 : BARE) / HIMC_PICKUP_PRESSURE;
}

double himc_pickup_pressure(const himc_pickup *pickup, const himc_head *head,
                            const himc_modes *modes, int index, const himc_mode *mode)
{
    double x =
        2 * HIMC_PI * mode->frequency / HIMC_AIR_SPEED * head->radius * cos(pickup->elevation);
    double angle = mode->m * (pickup->azimuth - mode->axis),
           scale = HIMC_AIR_DENSITY / pickup->distance * head->radius * head->radius;
    if (mode->m < 0)
        return scale * himc_statistical_pressure(modes->statistical, index - modes->exact, x,
                                                 pickup->azimuth);
    return scale * whole_overlap(head, modes, mode, x, himc_bessel_j(mode->m, x)) *
           (mode->sine ? sin(angle) : cos(angle));
}

bool himc_pickup_find_orders(const himc_pickup *pickup, const himc_head *head,
                             const himc_modes *modes, int index, const himc_mode *mode,
                             himc_pickup_orders *orders)
{
    int row;
    const himc_uneven_block *block = himc_uneven_of(modes, index, &row);
    if (!block)
        return false;
    double k = 2 * HIMC_PI * mode->frequency / HIMC_AIR_SPEED, overlaps[HIMC_UNEVEN_MODES];
    double scale = HIMC_AIR_DENSITY / pickup->distance * head->radius * head->radius;
    *orders = (himc_pickup_orders){0};
    find_overlaps(modes, block, k * head->radius * cos(pickup->elevation), overlaps);
    for (int l = 0; l < block->count; l++) {
        int m = block->even[l].m;
        double turn = (m - mode->m) % 4 == 0 ? 1 : -1; // (-i)^(m - own order) of equal parity
        double part = turn * scale * block->part[row][l] * overlaps[l];
        orders->cosine[m] += part * block->even[l].cosine;
        orders->sine[m] += part * block->even[l].sine;
    }
    return true;
}

pickup_weights himc_pickup_of_outline(const himc_pickup *pickup, const himc_head *head,
                                      const himc_modes *modes, int index, const himc_mode *mode)
{
    double even, odd, omega = 2 * HIMC_PI * mode->frequency, a = head->radius;
    double k = omega / HIMC_AIR_SPEED * cos(pickup->elevation);
    modes->shape.kind->transform(modes, index, k * cos(pickup->azimuth) * a,
                                 k * sin(pickup->azimuth) * a, &even, &odd);
    even *= a * a;
    odd *= a * a;
    double weight = HIMC_AIR_DENSITY / (2 * HIMC_PI * pickup->distance) * per_pascal(head);
    return (pickup_weights){.displacement = -weight * even * omega * omega,
                            .velocity = -weight * (2 * mode->decay * even + omega * odd),
                            .force = weight * even / mode->mass};
}

pickup_weights himc_pickup_of_gain(const himc_mode *mode, double gain)
{
    double omega = 2 * HIMC_PI * mode->frequency;
    double sign = mode->m % 4 == 1 || mode->m % 4 == 2 ? -1 : 1;
    if (mode->m % 2 != 0)
        return (pickup_weights){.velocity = sign * gain * omega, .gain = gain};
    return (pickup_weights){.displacement = -sign * gain * omega * omega,
                            .velocity = -sign * gain * 2 * mode->decay,
                            .force = sign * gain / mode->mass,
                            .gain = gain};
}

pickup_weights himc_pickup_form(const himc_mode *mode)
{
    return himc_pickup_of_gain(mode, 1);
}

pickup_weights himc_pickup_of_round(const himc_pickup *pickup, const himc_head *head,
                                    const himc_modes *modes, int index, const himc_mode *mode)
{
    himc_pickup_orders orders;
    double omega = 2 * HIMC_PI * mode->frequency, nearer[HIMC_LUGS_ORDERS], pressure = 0;
    double x = omega / HIMC_AIR_SPEED * fmax(pickup->distance, NEAREST * head->radius);
    bool mixed = himc_pickup_find_orders(pickup, head, modes, index, mode, &orders);
    near_fields(mixed ? HIMC_UNEVEN_ORDERS - 1 : mode->m, x, nearer);
    for (int m = mode->m % 2; mixed && m < HIMC_UNEVEN_ORDERS; m += 2)
        pressure += nearer[m] * (orders.cosine[m] * cos(m * pickup->azimuth) +
                                 orders.sine[m] * sin(m * pickup->azimuth));
    if (!mixed)
        pressure = (mode->m > 0 ? nearer[mode->m] : 1) *
                   himc_pickup_pressure(pickup, head, modes, index, mode);
    return himc_pickup_of_gain(mode, pressure * per_pascal(head));
}

pickup_weights himc_pickup_weights(const himc_pickup *pickup, const himc_head *head,
                                   const himc_modes *modes, int index, const himc_mode *mode,
                                   double point_shape)
{
    if (pickup->kind == HIMC_PICKUP_POINT)
        return (pickup_weights){.velocity = point_shape / HIMC_PICKUP_VELOCITY};
    return modes->shape.kind->far(pickup, head, modes, index, mode);
}
