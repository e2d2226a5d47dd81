/// bessel.c: J_m by backward recurrence, its zeros by safeguarded Newton steps.
///
/// Recurrence J_{k-1} = (2 k/z) J_k - J_{k+1}, run downwards, suppresses everything but J (J. C. P.
/// Miller, British Association Mathematical Tables X, 1952). It starts where J has fallen below
/// 1e-20 of its largest value, at order M = K + 14 K^(1/3) + 15 with K = max(z, top) (J_M behaves
/// as an Airy function there), from any value, and is scaled by J_0 + 2 (J_2 + J_4 + ...) = 1. A
/// common factor does not move a zero, so the zeros are as exact as the recurrence: a few units in
/// the last place.
///
/// Zeros of one order are more than 3.1 apart and the first lies above m (Watson 1944, section
/// 15.3), so steps of 1.5 from m upwards can not miss one.
#include "drum/bessel.h"

#include <math.h>

#define BIG 1e200 // far from overflow: one step multiplies by 2 k/z at most

// doubles are scaled back when they grow; what has been stored already shrinks with them
static void rescale(double *j, int from, int top, double factor)
{
    for (int k = from; k <= top; k++)
        j[k] *= factor;
}

void himc_bessel_orders(double z, int top, double *j)
{
    for (int k = 0; k <= top; k++)
        j[k] = 0;
    j[0] = 1;
    // below this every J_m but the first is smaller than any rounding that matters
    if (!(z > 1e-30))
        return;
    double reach = fmax(z, top);
    int k = (int)(reach + 14 * cbrt(reach) + 15);
    double above = 0, here = 1e-200, sum = 0;
    for (; k > 0; k--) {
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

// J_m and its derivative J_m' = J_{m-1} - (m/z) J_m without keeping the orders between
static void with_slope(int m, double z, double *value, double *slope)
{
    double reach = fmax(z, m), above = 0, here = 1e-200, sum = 0, at = 0, before = 0;
    for (int k = (int)(reach + 14 * cbrt(reach) + 15); k > 0; k--) {
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
    if (m == 0) // J_0' = -J_1, which is what `above` holds at the end
        before = -above;
    *value = at / sum;
    *slope = before / sum - m / z * *value;
}

double himc_bessel_j(int m, double z)
{
    if (!(z > 1e-30))
        return m == 0 ? 1 : 0;
    double value, slope;
    with_slope(m, z, &value, &slope);
    return value;
}

double himc_bessel_zero_between(int m, double low, double high)
{
    double value, slope, sign = himc_bessel_j(m, low), z = 0.5 * (low + high);
    for (int i = 0; i < 80; i++) {
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
        if (fabs(next - z) <= 2e-16 * z)
            return next;
        z = next;
    }
    return z;
}

double himc_bessel_zero(int m, int n)
{
    double low = m > 0 ? m : 0.5, before = himc_bessel_j(m, low);
    for (;;) {
        double high = low + 1.5, after = himc_bessel_j(m, high);
        if ((before > 0) != (after > 0) && --n == 0)
            return himc_bessel_zero_between(m, low, high);
        low = high;
        before = after;
    }
}
