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
/// The kettle's air has a quality Q: inside, x is x (1 + i/(2 Q)), with the time factor exp(-i w
/// t).
///
/// Without loss, A's poles are the kettle's own resonances, x^2 = beta_s^2 + (q pi a/L)^2. Between
/// two of them the eigenvalues of the real part of D(x) fall as x grows (Foster 1924), so sign
/// changes between poles find every root and no iteration can reach a wrong one. From there
/// Newton's method finds the root of D itself at complex w; only A_out is taken at Re w.
///
/// Many roots belong to the kettle: the root that a force of shape n excites most has the smallest
/// inertia c'(-dD/dx)c/(2 x N_n c_n^2), and 1/inertia is its part of the shape. Where a resonance
/// of the kettle splits a shape into two roots of similar inertia, himc_air_solve gives the lower
/// one, within a factor of two: it rings longer, and the lower was measured (314 Hz for (1,2) of a
/// 26 inch drum, here 311 and 352). himc_air_oscillators makes one oscillator of both, with the
/// mean logarithms of their frequencies and decays. The weight of root i is F_i^p - F_{i+1}^p, F_i
/// the share of the shape in root i and all above. p = 3.1 is chosen: with p = 1 the mean would be
/// the mode without the kettle's resonance, 110 cents above what was measured at 3990 N/m; with
/// larger p the mean follows the lower root and then rises too fast. So while a pedal moves, no
/// ratio to (1,1) changes by 30 cents in a semitone.
#include "galerkin.h"

#include "base/linear.h"
#include "head/bessel.h"
#include "head/air.h"

#include <complex.h>
#include <math.h>
#include <string.h>

#define SIZE HIMC_AIR_BASIS
#define INTEGRAL_END 100.0 // of the integral over g; chosen: W W' falls as kap^-5
#define PANEL 2.0          // its panels; chosen: W W' oscillates with a period of pi
#define MOST_POLES 256     // chosen: more than there are below the highest mode
#define MOST_FINDS 256
#define MOST_STEPS 40      // of an iteration that needs about ten
#define SHAPES 4           // n = 1 .. 4, as in the table
#define SHARED_INERTIA 2.0 // ratio of two roots that share a shape; chosen
#define NEIGHBOURHOOD 0.9  // in ln x, of a shape's frequency without kettle; chosen
#define PASSING 3.1        // power of the share above a root; chosen: galerkin.h
#define LEAST_SHARE 0.005  // of a shape: what a root holds below this is not counted; chosen
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

// its eigenvalues, rising; NaN if they are not found, which then brackets nothing
static void eigenvalues(const himc_air_order *order, const himc_air_problem *p, double x,
                        double *values)
{
    matrix d;
    real_part(order, p, x, d);
    if (himc_linear_eigenvalues(SIZE, d[0], values, NULL) != HIMC_LINEAR_SOLVED)
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

// a root of Re D
typedef struct find {
    double x, shape[SIZE];  // c
    double inertia[SHAPES]; // for a force of each shape
} find;

// shape and inertias at f->x: the eigenvector is the one of the smallest eigenvalue
static bool describe(const himc_air_order *order, const himc_air_problem *p, find *f)
{
    matrix d, above, below, shapes;
    double values[SIZE], h = 1e-5 * f->x, fall = 0;
    real_part(order, p, f->x, d);
    real_part(order, p, f->x + h, above);
    real_part(order, p, f->x - h, below);
    if (himc_linear_eigenvalues(SIZE, d[0], values, shapes[0]) != HIMC_LINEAR_SOLVED)
        return false;
    int k = 0;
    for (int i = 1; i < SIZE; i++)
        k = fabs(values[i]) < fabs(values[k]) ? i : k;
    memcpy(f->shape, shapes[k], sizeof f->shape);
    for (int i = 0; i < SIZE; i++)
        for (int j = 0; j < SIZE; j++)
            fall += f->shape[i] * f->shape[j] * (below[i][j] - above[i][j]) / (2 * h);
    for (int n = 0; n < SHAPES; n++) {
        double norm = order->next[n] * order->next[n] / 2;
        f->inertia[n] = fall / (2 * f->x * norm * f->shape[n] * f->shape[n]);
    }
    return true;
}

// -w^2 coth(mu L/a)/mu of one mode of the kettle and its derivative; mu = sqrt(beta^2 - (q w)^2)
static double complex resonator(double beta, double complex q, double complex w, double depth,
                                double complex *slope)
{
    double complex mu = csqrt(beta * beta - q * q * w * w), coth = 1 / ctanh(mu * depth);
    double complex falls = -(depth * (coth * coth - 1) + coth / mu) / mu; // (coth/mu)' in mu
    *slope = -2 * w * coth / mu + q * q * w * w * w * falls / mu;
    return -w * w * coth / mu;
}

typedef double complex complex_matrix[SIZE][SIZE];

// D at complex w, with the outside at its real part, and its derivative, without the outside's own
static void complex_problem(const himc_air_order *order, const himc_air_problem *p,
                            double complex w, complex_matrix d, complex_matrix slope)
{
    matrix mass, loss;
    double complex q = 1 + I / (2 * p->quality);
    himc_air_outside(order, creal(w), mass, loss);
    for (int i = 0; i < SIZE; i++)
        for (int j = 0; j < SIZE; j++) {
            double norm = i == j ? order->next[i] * order->next[i] / 2 : 0;
            double complex moved = norm + p->loading * (mass[i][j] + I * loss[i][j]);
            d[i][j] = p->tension * order->alpha[i] * order->alpha[i] * norm - w * w * moved;
            slope[i][j] = -2 * w * moved;
        }
    for (int s = 0; s < HIMC_AIR_CAVITY; s++) {
        double complex rise, value = resonator(order->beta[s], q, w, p->depth, &rise);
        for (int i = 0; i < SIZE; i++)
            for (int j = 0; j < SIZE; j++) {
                double share = p->loading * order->share[s][i] * order->share[s][j];
                d[i][j] += share * value;
                slope[i][j] += share * rise;
            }
    }
}

// sum_ij a_i M_ij b_j; D is symmetric, so no conjugates
static double complex product(complex_matrix m, const double complex *v)
{
    double complex sum = 0;
    for (int i = 0; i < SIZE; i++)
        for (int j = 0; j < SIZE; j++)
            sum += v[i] * m[i][j] * v[j];
    return sum;
}

static void swap(double complex *a, double complex *b)
{
    double complex kept = *a;
    *a = *b;
    *b = kept;
}

// D x = v by Gauss's elimination with partial pivoting: x replaces v, and D is lost; false if D is
// singular
static bool solve(complex_matrix d, double complex *v)
{
    for (int k = 0; k < SIZE; k++) {
        int pivot = k;
        for (int i = k + 1; i < SIZE; i++)
            pivot = cabs(d[i][k]) > cabs(d[pivot][k]) ? i : pivot;
        if (d[pivot][k] == 0)
            return false;
        swap(&v[k], &v[pivot]);
        for (int j = k; j < SIZE; j++)
            swap(&d[k][j], &d[pivot][j]);
        for (int i = 0; i < SIZE; i++) {
            double complex share = i == k ? 0 : d[i][k] / d[k][k];
            for (int j = k; j < SIZE; j++)
                d[i][j] -= share * d[k][j];
            v[i] -= share * v[k];
        }
    }
    for (int k = 0; k < SIZE; k++)
        v[k] /= d[k][k];
    return true;
}

// The complex root of D near a root of Re D: inverse iteration for the shape v, whose quotient v D
// v/(v D' v) is the step of w.
static bool polish(const himc_air_order *order, const himc_air_problem *p, const find *f,
                   himc_air_root *root)
{
    complex_matrix d, slope, kept;
    double complex w = f->x, v[SIZE], step = w;
    for (int i = 0; i < SIZE; i++)
        v[i] = f->shape[i];
    for (int i = 0; i < MOST_STEPS && cabs(step) > 1e-11 * f->x; i++) {
        complex_problem(order, p, w, d, slope);
        memcpy(kept, d, sizeof d);
        if (!solve(d, v))
            return false;
        double largest = 0;
        for (int k = 0; k < SIZE; k++)
            largest = fmax(largest, cabs(v[k]));
        for (int k = 0; k < SIZE; k++)
            v[k] /= largest;
        step = product(kept, v) / product(slope, v);
        w -= step;
    }
    root->x = creal(w);
    root->decay = -cimag(w);
    return isfinite(root->x) && cabs(step) <= 1e-9 * f->x;
}

// the roots of Re D found so far, rising
typedef struct finds {
    int count;
    find at[MOST_FINDS];
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
            find *found = &f->at[f->count++];
            found->x = bracketed(order, p, k, from, to, before[k], after[k]);
            if (!describe(order, p, found))
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
        least = f->at[i].inertia[n] > 0 ? fmin(least, f->at[i].inertia[n]) : least;
    for (int i = f->count - 1; i > last; i--)
        found =
            f->at[i].inertia[n] > 0 && f->at[i].inertia[n] <= SHARED_INERTIA * least ? i : found;
    return found;
}

// all roots up to that of shape `count`
static bool find_all(const himc_air_order *order, const himc_air_problem *p, int count, finds *f)
{
    // air makes modes lower, by less than to a third; the kettle's spring raises those of m = 0
    double low = 0.33 * order->alpha[0] * sqrt(p->tension), top = order->alpha[count - 1];
    double spring = order->m == 0 ? 4 * p->loading / p->depth : 0;
    double high = 1.1 * sqrt(p->tension * top * top + spring), pole[MOST_POLES + 1];
    int segments = find_poles(order, p->depth, low, high, pole);
    bool good = true;
    f->count = 0;
    for (int i = 0; i < segments && good; i++)
        if (pole[i + 1] * (1 - POLE_GAP) > pole[i] * (1 + POLE_GAP))
            good = search(order, p, pole[i] * (1 + POLE_GAP), pole[i + 1] * (1 - POLE_GAP), f);
    return good;
}

static bool unsolved(const himc_air_order *order, const himc_air_problem *p, himc_error *error)
{
    return himc_error_set(error, "air: no solution for order %d, tension %g, loading %g, depth %g",
                          order->m, p->tension, p->loading, p->depth);
}

bool himc_air_solve(const himc_air_order *order, const himc_air_problem *p, int count,
                    himc_air_root *roots, himc_error *error)
{
    finds f;
    bool solved = find_all(order, p, count, &f);
    for (int n = 0, i = -1; n < count && solved; n++) {
        i = own(&f, n, i);
        solved = i >= 0 && polish(order, p, &f.at[i], &roots[n]);
        roots[n].inertia = solved ? f.at[i].inertia[n] : 0;
        for (int k = 0; k < HIMC_AIR_BASIS && solved; k++)
            roots[n].shape[k] = f.at[i].shape[k];
    }
    return solved || unsolved(order, p, error);
}

// Parts of shape n that the roots from `first` on hold near the shape's frequency without kettle,
// less LEAST_SHARE of their sum each. The sum of these; *most is the root with the largest.
static double shares(const himc_air_order *order, const himc_air_problem *p, int n, const finds *f,
                     int first, double *share, int *most)
{
    double a = order->alpha[n], sum = 0, kept = 0;
    double spring = order->m == 0 ? 4 * p->loading / (p->depth * a * a) : 0;
    double middle = sqrt((p->tension * a * a + spring) / (1 + 2 * p->loading / a));
    *most = first;
    for (int i = first; i < f->count; i++) {
        double away = log(f->at[i].x / middle) / NEIGHBOURHOOD, near = fmax(1 - away * away, 0);
        share[i] = f->at[i].inertia[n] > 0 ? near * near * near / f->at[i].inertia[n] : 0;
        sum += share[i];
        *most = share[i] > share[*most] ? i : *most;
    }
    for (int i = first; i < f->count; i++)
        kept += share[i] = fmax(share[i] - LEAST_SHARE * sum, 0);
    return kept;
}

// the one oscillator of shape n, from the roots after `last`, which is then the one that holds most
// of it
static bool merge(const himc_air_order *order, const himc_air_problem *p, int n, const finds *f,
                  int *last, himc_air_root *one)
{
    double share[MOST_FINDS], x = 0, decay = 0, inverse = 0;
    int first = *last + 1;
    double all = first < f->count ? shares(order, p, n, f, first, share, last) : 0, above = all;
    for (int i = first; i < f->count; i++) {
        himc_air_root root;
        if (share[i] == 0)
            continue;
        if (!polish(order, p, &f->at[i], &root))
            return false;
        double rest = fmax(above - share[i], 0);
        double part = pow(above / all, PASSING) - pow(rest / all, PASSING);
        x += part * log(root.x);
        decay += part * log(fmax(root.decay, 0) + HIMC_AIR_FLOOR);
        inverse += part / f->at[i].inertia[n];
        above = rest;
    }
    *one =
        (himc_air_root){.x = exp(x), .decay = exp(decay) - HIMC_AIR_FLOOR, .inertia = 1 / inverse};
    return all > 0;
}

bool himc_air_oscillators(const himc_air_order *order, const himc_air_problem *p, int count,
                          himc_air_root *roots, himc_error *error)
{
    finds f;
    // the first shape is below the kettle's resonances
    bool solved = himc_air_solve(order, p, 1, roots, error) && find_all(order, p, count, &f);
    int last = solved ? own(&f, 0, -1) : -1;
    for (int n = 1; n < count && solved; n++)
        solved = merge(order, p, n, &f, &last, &roots[n]);
    return solved || unsolved(order, p, error);
}
