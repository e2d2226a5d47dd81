/// felt.c: the law of a mallet's head.
///
/// At rest its force is f = V', the sum of two power laws: the felt's own, and below the depth c_c
/// that of its core, which is much stiffer,
///     V(c) = k c^(alpha+1)/(alpha+1) + k_2 max(c - c_c, 0)^3.5/3.5.
/// Felt of a piano hammer stiffens alike as it is pressed (exponents 2.1 to 5: Boutillon 1988).
/// Over a step of length h the compression goes from c0 to c1 = c0 + r and the force is constant,
///     F(r) = max(0, D (1 + mu r/h) + tau (f(c1) - f(c0))/h),   D = (V(c1) - V(c0))/r.
/// D, the discrete gradient, does exactly the work V(c1) - V(c0) (Chatziioannou & van Walstijn
/// 2015; Bilbao, Torin & Chatziioannou 2015). mu is the loss of Hunt & Crossley 1975; tau is the
/// slow limit of felt with memory, F = f + tau df/dt (Stulov 1995): fibres that give way late.
///
/// Both losses only take energy. If F > 0 they take D mu r^2/h >= 0, as V does not decrease, and
/// tau (f(c1) - f(c0)) r/h >= 0, as V is convex and so f does not decrease. If F = 0, then r <= 0,
/// since no term is negative for r > 0, and the contact loses -D r >= 0.
///
/// F does not decrease with r, which makes the solution in contact.c unique: of a convex V both D
/// and f(c0 + r) rise with r, and so does D (1 + mu r/h) where that factor is positive. Where it is
/// not, r is negative, no term is positive and F = 0.
#include "drum/felt.h"

#include <math.h>

#define CORE_DEPTH 0.003  // c_c (m); chosen: a sixth of the felt of a usual mallet's radius
#define CORE_EXPONENT 2.5 // chosen: Hertz's contact between felt's and wood's, and cheap
#define SMALL_STEP 1e-3   // r per compression below which a series replaces the difference

// c^exponent for c > 0
static double power(double c, double exponent)
{
    return exponent == CORE_EXPONENT ? c * c * sqrt(c) : pow(c, exponent);
}

static felt_term term_at(double k, double exponent, double c0)
{
    felt_term t = {.k = k, .exponent = exponent, .c0 = c0};
    if (c0 > 0 && k > 0) {
        t.force = k * power(c0, exponent);
        t.potential = t.force * c0 / (exponent + 1);
    }
    return t;
}

felt himc_felt_at(const himc_mallet_head *head, double scale, double c0)
{
    return (felt){.outer = term_at(scale * head->stiffness, head->exponent, c0),
                  .core = term_at(scale * head->core, CORE_EXPONENT, c0 - CORE_DEPTH),
                  .loss = head->loss,
                  .relaxation = head->relaxation};
}

// D and f(c1) - f(c0) with their derivatives
typedef struct gradient {
    double mean, mean_slope, rise, rise_slope;
} gradient;

static void add_gradient(gradient *g, const felt_term *t, double r)
{
    double c1 = t->c0 + r, mid = t->c0 + 0.5 * r, n = t->exponent;
    if ((c1 <= 0 && t->c0 <= 0) || t->k == 0)
        return;
    // small steps, where the difference would cancel: f and its slope at the midpoint, and their
    // second derivatives, are exact to (r/mid)^4
    if (fabs(r) < SMALL_STEP * mid) {
        double force = t->k * power(mid, n), s = r / mid, slope = n * force / mid;
        g->mean += force * (1 + n * (n - 1) / 24 * s * s);
        g->mean_slope += 0.5 * slope;
        g->rise += slope * r * (1 + (n - 1) * (n - 2) / 24 * s * s);
        g->rise_slope += slope;
        return;
    }
    double force = c1 > 0 ? t->k * power(c1, n) : 0;
    double mean = (c1 > 0 ? force * c1 / (n + 1) - t->potential : -t->potential) / r;
    g->mean += mean;
    g->mean_slope += (force - mean) / r;
    g->rise += force - t->force;
    g->rise_slope += c1 > 0 ? n * force / c1 : 0;
}

double himc_felt_force(const felt *f, double r, double h, double *slope)
{
    gradient g = {0};
    add_gradient(&g, &f->outer, r);
    add_gradient(&g, &f->core, r);
    double grip = 1 + f->loss * r / h, delay = f->relaxation / h;
    double force = g.mean * grip + delay * g.rise;
    *slope = g.mean_slope * grip + g.mean * f->loss / h + delay * g.rise_slope;
    if (force > 0)
        return force;
    *slope = 0;
    return 0;
}
