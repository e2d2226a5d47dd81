/// galerkin.c: a head between the open air and its kettle, by Galerkin's method.
///
/// The shape is sum_n c_n J_m(alpha_n r/a). Outside, an infinite baffle; inside, a rigid cylinder
/// of the kettle's volume. Per sigma a^2, with x = w a/c and D(x) = tau
/// diag(alpha^2 N) + epsilon K - x^2 (diag(N) + epsilon A(x)),
///     D(x) c = 0,   N_n = J_{m+1}(alpha_n)^2/2,   A = A_out + A_in
///     Re A_out = int_0^inf W W' dg           at kap^2 = g^2 + x^2
///     Im A_out = int_0^{pi/2} W W' x sin t dt   at kap = x sin t
///     A_in = sum_s C_s C_s'/n_s coth(mu L/a)/mu,   mu^2 = beta_s^2 - x^2
/// (above cut-off, for imaginary mu, -cot(|mu| L/a)/|mu|)
/// with the Hankel transform W_n(kap) = alpha_n J_{m+1}(alpha_n) J_m(kap)/(alpha_n^2 - kap^2)
/// (Morse & Ingard 1968; the drum is that of Christian et al. 1984). For m = 0 the uniform cavity
/// mode is a spring, K = x C C' 2 cot(x L/a), added to the tension: as a mass it would be negative.
///
/// A's poles are the kettle's own resonances, x^2 = beta_s^2 + (q pi a/L)^2. Between two of them
/// the eigenvalues of the real part of D(x) fall as x grows (Foster 1924), so sign changes between
/// poles find every root and no iteration can reach a wrong one. A root is then made complex, with
/// A and K taken at Re x. Many roots belong to the kettle: the root that a force of shape n excites
/// most has the smallest inertia c'(-dD/dx)c/(2 x N_n c_n^2). Where a sloshing of the kettle splits
/// a shape into two roots of similar inertia, within a factor of two, the lower one is taken: it
/// rings long, the upper decays in a tenth of a second, and the lower was measured (314 Hz for
/// (1,2) of a 26 inch drum, here 311 and 352).
#include "galerkin.h"

#include "head/bessel.h"
#include "head/air.h"

#include <complex.h>
#include <lapacke.h>
#include <math.h>
#include <string.h>

#define SIZE HIMC_AIR_BASIS
#define INTEGRAL_END 100.0 // of the integral over g; chosen: W W' falls as kap^-5
#define PANEL 2.0          // its panels; chosen: W W' oscillates with a period of pi
#define MOST_POLES 256     // chosen: more than there are below the highest mode
#define MOST_FINDS 256
#define SHAPES 4           // n = 1 .. 4, as in the table
#define SHARED_INERTIA 2.0 // ratio of two roots that share a shape; chosen
#define POLE_GAP 1e-7      // distance kept from a pole, relative; chosen
#define SEARCH_STEP 0.04   // of the search between poles, in ln x; chosen

typedef double matrix[SIZE][SIZE];

// Gauss-Legendre, 10 points on [-1, 1] (Abramowitz & Stegun 1964, table 25.4)
static const double NODE[5] = {0.1488743389816312, 0.4333953941292472, 0.6794095682990244,
                               0.8650633666889845, 0.9739065285171717};
static const double WEIGHT[5] = {0.2955242247147529, 0.2692667193099963, 0.2190863625159820,
                                 0.1494513491505806, 0.0666713443086881};

// J_m' changes sign once in the interval; J_m'' = -J_m'/z - (1 - m^2/z^2) J_m
static double slope_zero(int m, double low, double high)
{
    double z = 0.5 * (low + high), j[32];
    for (int i = 0, rising = -1; i < 60; i++) {
        himc_bessel_orders(z, m + 1, j);
        double slope = m / z * j[m] - j[m + 1], bend = -slope / z - (1 - m * m / (z * z)) * j[m];
        if (rising < 0) {
            himc_bessel_orders(low, m + 1, j);
            rising = m / low * j[m] > j[m + 1];
        }
        if ((slope > 0) == rising)
            low = z;
        else
            high = z;
        double next = z - slope / bend;
        next = next > low && next < high ? next : 0.5 * (low + high);
        if (fabs(next - z) < 1e-15 * z)
            return next;
        z = next;
    }
    return z;
}

void himc_air_order_make(himc_air_order *order, int m)
{
    order->m = m;
    double zero = m > 0 ? 0.5 * m : 0.5;
    for (int s = 0; s < HIMC_AIR_CAVITY; s++) {
        // beta_s lies before j_ms, and after j_m,s-1; for m = 0 the first is 0
        double before = zero;
        zero = himc_bessel_zero(m, s + 1);
        if (s < SIZE) {
            order->alpha[s] = zero;
            order->next[s] = himc_bessel_j(m + 1, zero);
        }
        order->beta[s] = m == 0 && s == 0 ? 0 : slope_zero(m, before, zero);
    }
    for (int s = 0; s < HIMC_AIR_CAVITY; s++) {
        double b = order->beta[s];
        double norm = b > 0 ? (1 - m * m / (b * b)) / 2 : 0.5; // n_s/J_m(beta_s)^2
        double sign = himc_bessel_j(m, b) < 0 ? -1 : 1;
        for (int n = 0; n < SIZE; n++) {
            double a = order->alpha[n];
            order->share[s][n] = sign * a * order->next[n] / ((a * a - b * b) * sqrt(norm));
        }
    }
}

// W_n(kap) of all n
static void hankel(const himc_air_order *order, double kap, double *w)
{
    double j = himc_bessel_j(order->m, kap);
    for (int n = 0; n < SIZE; n++) {
        double a = order->alpha[n];
        bool limit = fabs(kap - a) < 1e-6;
        w[n] = limit ? order->next[n] * order->next[n] / 2
                     : a * order->next[n] * j / (a * a - kap * kap);
    }
}

static void accumulate(matrix sum, const double *w, double weight)
{
    for (int i = 0; i < SIZE; i++)
        for (int j = 0; j < SIZE; j++)
            sum[i][j] += weight * w[i] * w[j];
}

void himc_air_outside(const himc_air_order *order, double x, matrix real, matrix imag)
{
    double w[SIZE];
    memset(real, 0, sizeof(matrix));
    memset(imag, 0, sizeof(matrix));
    for (double start = 0; start < INTEGRAL_END; start += PANEL)
        for (int i = 0; i < 10; i++) {
            double g = start + PANEL / 2 * (1 + (i < 5 ? NODE[i] : -NODE[i - 5]));
            hankel(order, hypot(g, x), w);
            accumulate(real, w, PANEL / 2 * WEIGHT[i % 5]);
        }
    int panels = 2 + (int)(x / 3);
    double width = HIMC_PI / 2 / panels;
    for (int k = 0; k < 10 * panels; k++) {
        int i = k % 10;
        double t = width * (k / 10 + 0.5 * (1 + (i < 5 ? NODE[i] : -NODE[i - 5])));
        hankel(order, x * sin(t), w);
        accumulate(imag, w, width / 2 * WEIGHT[i % 5] * x * sin(t));
    }
}

void himc_air_inside(const himc_air_order *order, double x, double depth, matrix load)
{
    memset(load, 0, sizeof(matrix));
    for (int s = order->m == 0; s < HIMC_AIR_CAVITY; s++) {
        double square = order->beta[s] * order->beta[s] - x * x, mu = sqrt(fabs(square));
        double factor = square > 0 ? 1 / (mu * tanh(mu * depth)) : -1 / (mu * tan(mu * depth));
        accumulate(load, order->share[s], factor);
    }
}

// the matrices of D at real x
typedef struct parts {
    matrix stiffness; // tau diag(alpha^2 N) + epsilon K
    matrix mass;      // diag(N) + epsilon Re A
    matrix loss;      // epsilon Im A
} parts;

static void assemble(const himc_air_order *order, const himc_air_problem *p, double x, parts *d)
{
    matrix inside;
    himc_air_outside(order, x, d->mass, d->loss);
    himc_air_inside(order, x, p->depth, inside);
    memset(d->stiffness, 0, sizeof(matrix));
    if (order->m == 0)
        accumulate(d->stiffness, order->share[0], p->loading * x / tan(x * p->depth));
    for (int i = 0; i < SIZE; i++) {
        for (int j = 0; j < SIZE; j++) {
            d->mass[i][j] = p->loading * (d->mass[i][j] + inside[i][j]);
            d->loss[i][j] *= p->loading;
        }
        double norm = order->next[i] * order->next[i] / 2;
        d->mass[i][i] += norm;
        d->stiffness[i][i] += p->tension * order->alpha[i] * order->alpha[i] * norm;
    }
}

// Re D(x)
static void real_part(const himc_air_order *order, const himc_air_problem *p, double x, matrix d)
{
    parts o;
    assemble(order, p, x, &o);
    for (int i = 0; i < SIZE; i++)
        for (int j = 0; j < SIZE; j++)
            d[i][j] = o.stiffness[i][j] - x * x * o.mass[i][j];
}

// its eigenvalues, rising; NaN if LAPACK fails, which then brackets nothing
static void eigenvalues(const himc_air_order *order, const himc_air_problem *p, double x,
                        double *values)
{
    matrix d;
    real_part(order, p, x, d);
    if (LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'N', 'U', SIZE, d[0], SIZE, values) != 0)
        for (int i = 0; i < SIZE; i++)
            values[i] = NAN;
}

// the resonances of the kettle alone in (low, high), rising, after low and before high
static int find_poles(const himc_air_order *order, double depth, double low, double high,
                      double *pole)
{
    int count = 0;
    pole[count++] = low;
    for (int s = 0; s < HIMC_AIR_CAVITY && order->beta[s] < high; s++)
        for (int q = 0; count < MOST_POLES - 1; q++) {
            double x = hypot(order->beta[s], q * HIMC_PI / depth);
            if (x >= high)
                break;
            if (x <= low)
                continue;
            int i = count++;
            for (; i > 1 && pole[i - 1] > x; i--)
                pole[i] = pole[i - 1];
            pole[i] = x;
        }
    pole[count] = high;
    return count;
}

// eigenvalue k changes sign in [low, high], where it is `at_low` and `at_high`: regula falsi
// (Illinois)
static double bracketed(const himc_air_order *order, const himc_air_problem *p, int k, double low,
                        double high, double at_low, double at_high)
{
    double values[SIZE], x = low;
    for (int i = 0, side = 0; i < 40 && high - low > 1e-9 * high; i++) {
        // near a pole the secant creeps: every third step halves
        x = i % 3 == 2 ? 0.5 * (low + high) : (low * at_high - high * at_low) / (at_high - at_low);
        eigenvalues(order, p, x, values);
        if (fabs(values[k]) < 1e-13)
            break;
        if ((values[k] > 0) == (at_low > 0)) {
            low = x;
            at_low = values[k];
            at_high *= side == 1 ? 0.5 : 1;
            side = 1;
        } else {
            high = x;
            at_high = values[k];
            at_low *= side == -1 ? 0.5 : 1;
            side = -1;
        }
    }
    return x;
}

// inertia of shape n at a root of Re D, for all shapes: the eigenvector is the one of the smallest
// eigenvalue
static bool inertias(const himc_air_order *order, const himc_air_problem *p, double x,
                     double *inertia)
{
    matrix d, above, below;
    double values[SIZE], h = 1e-5 * x, fall = 0;
    real_part(order, p, x, d);
    real_part(order, p, x + h, above);
    real_part(order, p, x - h, below);
    if (LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'V', 'U', SIZE, d[0], SIZE, values) != 0)
        return false;
    int k = 0;
    for (int i = 1; i < SIZE; i++)
        k = fabs(values[i]) < fabs(values[k]) ? i : k;
    for (int i = 0; i < SIZE; i++)
        for (int j = 0; j < SIZE; j++)
            fall += d[i][k] * d[j][k] * (below[i][j] - above[i][j]) / (2 * h);
    for (int n = 0; n < SHAPES; n++) {
        double norm = order->next[n] * order->next[n] / 2;
        inertia[n] = fall / (2 * x * norm * d[n][k] * d[n][k]);
    }
    return true;
}

// the complex eigenvalue nearest to x, with the air's load at x
static bool complex_at(const himc_air_order *order, const himc_air_problem *p, double x,
                       double complex *nearest)
{
    parts o;
    double complex k[SIZE][SIZE], m[SIZE][SIZE], top[SIZE], bottom[SIZE];
    assemble(order, p, x, &o);
    for (int i = 0; i < SIZE; i++)
        for (int j = 0; j < SIZE; j++) {
            k[i][j] = o.stiffness[i][j];
            m[i][j] = o.mass[i][j] + I * o.loss[i][j];
        }
    if (LAPACKE_zggev(LAPACK_ROW_MAJOR, 'N', 'N', SIZE, k[0], SIZE, m[0], SIZE, top, bottom, NULL,
                      1, NULL, 1) != 0)
        return false;
    double best = INFINITY;
    for (int i = 0; i < SIZE; i++) {
        double complex z = csqrt(top[i] / bottom[i]);
        if (cabs(z - x) < best) {
            best = cabs(z - x);
            *nearest = z;
        }
    }
    return best < INFINITY;
}

// x with Re w(x) = x, by secant from a root of the real part
static bool polish(const himc_air_order *order, const himc_air_problem *p, double x,
                   himc_air_root *root)
{
    double complex w;
    if (!complex_at(order, p, x, &w))
        return false;
    double last = x, miss = creal(w) - x;
    x += 0.5 * miss;
    for (int i = 0; i < 20 && fabs(miss) > 1e-10 * x; i++) {
        if (!complex_at(order, p, x, &w))
            return false;
        double now = creal(w) - x, gain = now != miss ? (x - last) / (miss - now) : 0.5;
        last = x;
        miss = now;
        x += gain * now;
    }
    root->x = x;
    root->decay = -cimag(w);
    return true;
}

// the roots of Re D found so far, rising
typedef struct finds {
    int count;
    double x[MOST_FINDS], inertia[MOST_FINDS][SHAPES];
} finds;

// all roots of Re D between two neighbouring poles
static bool search(const himc_air_order *order, const himc_air_problem *p, double low, double high,
                   finds *f)
{
    double before[SIZE], after[SIZE];
    int steps = 2 + (int)(log(high / low) / SEARCH_STEP);
    eigenvalues(order, p, low, before);
    for (int i = 1; i <= steps; i++) {
        double from = low + (high - low) * (i - 1) / steps, to = low + (high - low) * i / steps;
        eigenvalues(order, p, to, after);
        for (int k = 0; k < SIZE && f->count < MOST_FINDS; k++) {
            if (!(before[k] > 0 && after[k] <= 0))
                continue;
            double x = f->x[f->count] = bracketed(order, p, k, from, to, before[k], after[k]);
            if (!inertias(order, p, x, f->inertia[f->count++]))
                return false;
        }
        memcpy(before, after, sizeof before);
    }
    return true;
}

// index of the root of shape n, after `last`; -1 if there is none
static int own(const finds *f, int n, int last)
{
    double least = INFINITY;
    int found = -1;
    for (int i = last + 1; i < f->count; i++)
        least = f->inertia[i][n] > 0 ? fmin(least, f->inertia[i][n]) : least;
    for (int i = f->count - 1; i > last; i--)
        found = f->inertia[i][n] > 0 && f->inertia[i][n] <= SHARED_INERTIA * least ? i : found;
    return found;
}

bool himc_air_solve(const himc_air_order *order, const himc_air_problem *p, int count,
                    himc_air_root *roots, himc_error *error)
{
    // air makes modes lower, by less than to a third; the kettle's spring raises those of m = 0
    double low = 0.33 * order->alpha[0] * sqrt(p->tension), top = order->alpha[count - 1];
    double spring = order->m == 0 ? 4 * p->loading / p->depth : 0;
    double high = 1.1 * sqrt(p->tension * top * top + spring), pole[MOST_POLES + 1];
    int segments = find_poles(order, p->depth, low, high, pole);
    finds f = {0};
    bool solved = true;
    for (int i = 0; i < segments && solved; i++)
        if (pole[i + 1] * (1 - POLE_GAP) > pole[i] * (1 + POLE_GAP))
            solved = search(order, p, pole[i] * (1 + POLE_GAP), pole[i + 1] * (1 - POLE_GAP), &f);
    for (int n = 0, i = -1; n < count && solved; n++) {
        i = own(&f, n, i);
        solved = i >= 0 && polish(order, p, f.x[i], &roots[n]);
        roots[n].inertia = solved ? f.inertia[i][n] : 0;
    }
    return solved ||
           himc_error_set(error, "air: no solution for order %d, tension %g, loading %g, depth %g",
                          order->m, p->tension, p->loading, p->depth);
}
