/// wires.c: the wires of a snare drum, points that a strainer draws to the lower head.
///
/// A few points of mass m at fixed places. Each feels the pull F0 = m a to the head and the head
/// itself, a spring that only pushes: with V = k c^2/2 for a compression c > 0, over a step of
/// length h in which c goes from c0 to c1 = c0 + r,
///     F(r) = max(0, (V(c1) - V(c0))/r + eta (max(c1, 0) - max(c0, 0))/h),
/// felt.c's law with the exponent 1: it does the work V(c1) - V(c0) or less, and does not decrease
/// with r. All is counted from rest, where F = F0 and c = F0/k, so a head at rest has wires at
/// rest: head and point feel P = F - F0, and what is stored is
///     U(r) = V(F0/k + r) - V(F0/k) - F0 r >= 0,   P r >= U(r1) - U(r0).
/// Its wire is under tension, which pulls it, as the head bends it by a/u^2 = BENT: alone, a
/// point swings about its rest with u, so far flights are as short as near ones, and loud strokes
/// rattle no longer than soft ones.
///
/// A step. Without change of force point i would come r = b_i nearer; forces make of it
///     r_i = b_i - sum_j G_ij P_j,   G = that of the head + (i = j) (1 - cos u h)/(m u^2),
/// those of sticks on the other head among them (contact.c). That is the minimum of the same convex
/// Psi, so the same proof holds: head, points and springs together gain -P r - (U1 - U0) <= 0 in a
/// step. It is found line by line: with all other forces given, one line is linear while the point
/// stays pressed, and a quadratic equation where it lands or leaves. Few rounds are needed, as a
/// point hardly feels another one in the same step. (Bilbao 2012 and Torin, Hamilton & Bilbao 2014
/// have strings instead of points, and take longer than they sound.)
///
/// Wires that have lain still for a while stick to the head until a blow; their energy is lost.
#include "head/two_heads.h"

#include <math.h>
#include <string.h>

// chosen: a usual set of 20 weighs so much, and the places are without symmetry
#define MASS (0.0085 / HIMC_WIRES) // of a point (kg)
#define BENT 6e-4                  // (m) chosen, as MASS: louder is brighter up to ff
#define STIFFNESS 3e5              // k (N/m); chosen, as eta
#define LOSS 1.0                   // eta (N s/m)
#define ROUNDS 30                  // most of a step; chosen: 3 to 5 are usual
#define ENOUGH 1e-6        // of F0, a change of forces that ends it; chosen: losses are larger
#define STILL 1e-3         // of F0: less is 60 dB softer than the rattle; chosen
#define STILL_SAMPLES 1024 // chosen: longer than a period of any head

// along the wires, which lie across the head as the performer sees it, and across them, per radius
const double himc_wires_place[HIMC_WIRES][2] = {{0.08, -0.86},  {-0.05, -0.62}, {0.03, -0.37},
                                                {-0.09, -0.13}, {0.06, 0.10},   {-0.02, 0.34},
                                                {0.09, 0.60},   {-0.07, 0.82}};

void himc_wires_rest(himc_wires *w, const double *displacement)
{
    *w = (himc_wires){.awake = true};
    memcpy(w->height, displacement, sizeof w->height);
}

void himc_wires_follow(himc_wires *w, const double *displacement)
{
    for (int i = 0; i < HIMC_WIRES; i++)
        w->height[i] = displacement[i] + w->pressed[i];
}

void himc_wires_begin(const himc_wires *w, const double *displacement, double pull, double h,
                      double *b)
{
    double u = sqrt(pull / BENT), c = cos(u * h), s = sin(u * h) / u;
    for (int i = 0; i < HIMC_WIRES; i++)
        b[i] = c * w->height[i] + s * w->velocity[i] - displacement[i] - w->pressed[i];
}

// how far a newton moves a point in a step (m/N)
static double own_of(double pull, double h)
{
    double square = pull / BENT;
    return (1 - cos(sqrt(square) * h)) / (MASS * square);
}

// F of one point at compression c that would change by b without it; g is its compliance, and
// `softer` is 1/(1 + g (k/2 + eta/h))
static double solve(double c, double b, double g, double loss, double softer)
{
    double k = STIFFNESS;
    if (!(c > 0 || c + b > 0))
        return 0;
    if (c <= 0) { // it lands: r^2 = b r - g (k (c + r)^2/2 + loss (c + r) r)
        double half = 0.5 * (b - g * c * (k + loss));
        double r = (half + sqrt(fmax(half * half - 0.5 * g * k * c * c / softer, 0))) * softer;
        return r < b ? (b - r) / g : 0;
    }
    double force = (k * c + (0.5 * k + loss) * b) * softer;
    if (c + b - g * force >= 0)
        return force > 0 ? force : 0;
    // it leaves: r = -s, s^2 + (b + g loss c) s = g k c^2/2
    double half = 0.5 * (b + g * loss * c);
    double s = -half + sqrt(half * half + 0.5 * g * k * c * c);
    return b + s > 0 ? (b + s) / g : 0;
}

void himc_wires_solve(himc_wires *w, double pull, double h, himc_wires_matrix g, const double *b)
{
    double rest = MASS * pull, own = own_of(pull, h), loss = LOSS / h;
    double free[HIMC_WIRES], softer[HIMC_WIRES];
    for (int i = 0; i < HIMC_WIRES; i++) {
        softer[i] = 1 / (1 + (g[i][i] + own) * (0.5 * STIFFNESS + loss));
        free[i] = b[i];
        for (int j = 0; j < HIMC_WIRES; j++)
            free[i] -= g[i][j] * w->force[j];
    }
    for (int round = 0; round < ROUNDS; round++) {
        double change = 0;
        for (int i = 0; i < HIMC_WIRES; i++) {
            double gi = g[i][i] + own, alone = free[i] + g[i][i] * w->force[i] + gi * rest;
            double c = rest / STIFFNESS + w->pressed[i];
            double force = solve(c, alone, gi, loss, softer[i]) - rest;
            double more = force - w->force[i];
            if (more == 0) // it flies
                continue;
            w->force[i] = force;
            for (int j = 0; j < HIMC_WIRES; j++) // g is symmetric
                free[j] -= g[i][j] * more;
            change = fabs(more) > change ? fabs(more) : change;
        }
        if (change < ENOUGH * rest)
            break;
    }
}

void himc_wires_end(himc_wires *w, double pull, double h, himc_wires_matrix g, const double *b)
{
    double rest = MASS * pull, largest = 0, own = own_of(pull, h);
    double u = sqrt(pull / BENT), c = cos(u * h), s = sin(u * h);
    for (int i = 0; i < HIMC_WIRES; i++) {
        double by = own * w->force[i], height = w->height[i], velocity = w->velocity[i];
        w->pressed[i] += b[i] - by;
        for (int j = 0; j < HIMC_WIRES; j++)
            w->pressed[i] -= g[i][j] * w->force[j];
        w->height[i] = c * height + s / u * velocity - by;
        w->velocity[i] = c * velocity - u * s * height - s / u * w->force[i] / MASS;
        largest = fabs(w->force[i]) > largest ? fabs(w->force[i]) : largest;
    }
    w->still = largest < STILL * rest ? w->still + 1 : 0;
    if (w->still > STILL_SAMPLES)
        *w = (himc_wires){.awake = false};
}

double himc_wires_energy(const himc_wires *w, double pull)
{
    double rest = MASS * pull, at_rest = rest / STIFFNESS, energy = 0;
    for (int i = 0; i < HIMC_WIRES && w->awake; i++) {
        double r = w->pressed[i], v = w->velocity[i];
        energy += 0.5 * MASS * (v * v + pull / BENT * w->height[i] * w->height[i]) +
                  (r > -at_rest ? 0.5 * STIFFNESS * r * r : -rest * (r + 0.5 * at_rest));
    }
    return energy;
}
