/// bessel.c: J_m by backward recurrence, its zeros by safeguarded Newton steps.
///
/// The recurrence J_{k-1} = (2 k/z) J_k - J_{k+1}, run downwards, suppresses all solutions but J
/// (J. C. P. Miller, British Association Mathematical Tables X, 1952). It starts from any value
/// where J has fallen below 1e-20 of its largest value, at order M = K + 14 K^(1/3) + 15 with K =
/// max(z, top) (J_M behaves as an Airy function there), and is scaled by J_0 + 2 (J_2 + J_4 + ...)
/// = 1. A common factor does not move a zero, so the zeros are as exact as the recurrence: a few
/// units in the last place.
///
/// Zeros of one order are more than 3.1 apart and the first lies above m (Watson 1944, section
/// 15.3), so steps of 1.5 from m upwards cannot miss one.
#include "head/bessel.h"

#include <math.h>

#define BIG 1e200        // far from overflow: one step multiplies by 2 k/z at most
#define START 1e-200     // the first value; any would do
#define SMALLEST_Z 1e-30 // below it every J_m but the first is less than any rounding
#define ZERO_STEP 1.5    // as above
#define NEWTON_STEPS 80  // chosen: bisection alone converges in them
#define ROUNDING 2e-16   // relative: the last place of a double

// multiplies the values stored so far
static void rescale(double *j, int from, int top, double factor)
{
    for (int k = from; k <= top; k++)
        j[k] *= factor;
}

// the order M at which the recurrence starts
static int first_order(double z, int top)
{
    double highest = fmax(z, top);
    return (int)(highest + 14 * cbrt(highest) + 15);
}

void himc_bessel_orders(double z, int top, double *j)
{
    for (int k = 0; k <= top; k++)
        j[k] = 0;
    j[0] = 1;
    if (!(z > SMALLEST_Z))
        return;
    double above = 0, here = START, sum = 0;
    for (int k = first_order(z, top); k > 0; k--) {
        double below = 2 * k / z * here - above;
        above = here;
        here = below;
        if (k - 1 <= top)
            j[k - 1] = here;
        if ((k - 1) % 2 == 0)
            sum += k > 1 ? 2 * here : here;
        if (fabs(here) > BIG) {
            rescale(j, k - 1, top, 1 / BIG);
            here /= BIG;
            above /= BIG;
            sum /= BIG;
        }
    }
    rescale(j, 0, top, 1 / sum);
}

// J_m and its derivative J_m' = J_{m-1} - (m/z) J_m, without storing the other orders
static void with_slope(int m, double z, double *value, double *slope)
{
    double above = 0, here = START, sum = 0, at = 0, before = 0;
    for (int k = first_order(z, m); k > 0; k--) {
        double below = 2 * k / z * here - above;
        above = here;
        here = below;
        if (k - 1 == m)
            at = here;
        if (k - 1 == m - 1)
            before = here;
        if ((k - 1) % 2 == 0)
            sum += k > 1 ? 2 * here : here;
        if (fabs(here) > BIG) {
            here /= BIG;
            above /= BIG;
            sum /= BIG;
            at /= BIG;
            before /= BIG;
            if (k - 1 > m)
                at = before = 0;
        }
    }
    if (m == 0) // J_0' = -J_1, which is `above` at the end
        before = -above;
    *value = at / sum;
    *slope = before / sum - m / z * *value;
}

double himc_bessel_j(int m, double z)
{
    if (!(z > SMALLEST_Z))
        return m == 0 ? 1 : 0;
    double value, slope;
    with_slope(m, z, &value, &slope);
    return value;
}

// polynomials by Abramowitz & Stegun 1964, 9.4.1 and 9.4.3: errors below 5e-8
double himc_bessel_j0(double z)
{
    double t = z * z / 9, u = 3 / z;
    if (z <= 3)
        return 1 + t * (-2.2499997 +
                        t * (1.2656208 +
                             t * (-.3163866 + t * (.0444479 + t * (-.0039444 + t * .0002100)))));
    double size = .79788456 +
                  u * (-.00000077 +
                       u * (-.00552740 +
                            u * (-.00009512 + u * (.00137237 + u * (-.00072805 + u * .00014476)))));
    double angle =
        z - .78539816 +
        u * (-.04166397 +
             u * (-.00003954 +
                  u * (.00262573 + u * (-.00054125 + u * (-.00029333 + u * .00013558)))));
    return size * cos(angle) / sqrt(z);
}

double himc_bessel_zero_between(int m, double low, double high)
{
    double value, slope, sign = himc_bessel_j(m, low), z = 0.5 * (low + high);
    for (int i = 0; i < NEWTON_STEPS; i++) {
        with_slope(m, z, &value, &slope);
        if (value == 0)
            return z;
        if ((value > 0) == (sign > 0))
            low = z;
        else
            high = z;
        double next = z - value / slope;
        if (!(next > low && next < high))
            next = 0.5 * (low + high);
        if (fabs(next - z) <= ROUNDING * z)
            return next;
        z = next;
    }
    return z;
}

double himc_bessel_zero(int m, int n)
{
    double low = m > 0 ? m : 0.5, before = himc_bessel_j(m, low);
    for (;;) {
        double high = low + ZERO_STEP, after = himc_bessel_j(m, high);
        if ((before > 0) != (after > 0) && --n == 0)
            return himc_bessel_zero_between(m, low, high);
        low = high;
        before = after;
    }
}
