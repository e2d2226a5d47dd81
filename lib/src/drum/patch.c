/// patch.c: the size of a contact.
///
/// A mallet of radius R covers a disc of the head with an even pressure F/(pi b^2). A mode's mean
/// over the disc is its value at the centre times W(k b) = 2 J1(k b)/(k b), k its wave number:
/// exact for every solution of lap w = -k^2 w. Force and displacement have the same W, so the patch
/// does the work that the modes receive.
///
/// Radius. Under F the felt flattens by c and the head bends with radius 2 pi T b^2/F: two spheres
/// that touch as Hertz's do, c = b^2 (1/R - F/(2 pi T b^2)), so
///     b^2 = R (c + F/(2 pi T)).
/// b is fixed for a blow, at the force-weighted mean of that. Its largest force comes from the
/// energy at impact, m v^2/2 = V(c) + C(b) f(c)^2/2 (C: round.c): felt and head in series, as if
/// they had time. A few Newton steps on the logarithms solve it.
///
/// Residual. The modes that a list lacks yield, too. All together move like one oscillator with the
/// compliance and the inverse mass that they have together,
///     C_res = C(b) - sum phi^2 W^2/K,   1/m_res = 1/(sigma pi b^2) - sum phi^2 W^2/M,
/// over the bare modes of the list (sigma pi b^2 is the mass of the film under the patch): right
/// for a slow push and for a sudden one. Its damping stands for the waves that carry the push away.
/// It is one more passive oscillator, exact in any step; nobody hears it. In coordinates x =
/// q/sqrt(C), y = q' sqrt(m) its energy is (x^2 + y^2)/2 and its step a rotation that shrinks, so a
/// rotation of another length gives it none, either.
#include "drum/patch.h"

#include "drum/felt.h"
#include "head/bessel.h"
#include "head/kind.h"

#include <math.h>

#define WEIGHTED_MEAN 0.92 // b by force over largest b, computed for felt at 1 .. 8 m/s
#define SOLVER_STEPS 4     // chosen: b is then exact to 1e-3
#define SLOWEST 0.05       // (m/s) taken for a mallet that is laid down; chosen
#define SERIES_END 8.0     // z below which a series of SERIES terms has an error below 1e-12
#define SERIES 20
#define RESIDUAL_DAMPING 0.3 // of critical; chosen: forces hang least on the number of modes

double himc_patch_weight(double z)
{
    if (z > SERIES_END)
        return 2 * himc_bessel_j(1, z) / z;
    double t = 0.25 * z * z, sum = 1;
    for (int k = SERIES; k > 0; k--)
        sum = 1 - t / (k * (k + 1)) * sum;
    return sum;
}

double himc_patch_radius(const himc_head *head, const himc_mallet_head *mallet, double mass,
                         double distance, double speed)
{
    double most = fmin(mallet->radius, head->radius - distance), n = mallet->exponent;
    double v = fmax(speed, SLOWEST), energy = 0.5 * mass * v * v, b = most;
    if (!(most > 0 && energy > 0 && mallet->stiffness > 0))
        return 0;
    double c = pow((n + 1) * energy / mallet->stiffness, 1 / (n + 1));
    for (int i = 0; i < SOLVER_STEPS; i++) {
        felt f = himc_felt_at(mallet, 1, c);
        double force = f.outer.force + f.core.force, potential = himc_felt_potential(&f);
        double bent = force / (2 * HIMC_PI * head->tension);
        b = fmin(WEIGHTED_MEAN * sqrt(mallet->radius * (c + bent)), most);
        double pressed = himc_kind_round.compliance(head, distance, 0, b) * force * force;
        double work = force * c, held = potential + 0.5 * pressed;
        double power = (work + pressed * (work / potential - 1)) / held; // d ln held/d ln c
        c *= pow(energy / held, 1 / power);
    }
    return b;
}

himc_residual himc_residual_of(double compliance, double per_mass)
{
    if (!(compliance > 0 && per_mass > 0))
        return (himc_residual){0};
    return (himc_residual){sqrt(compliance), sqrt(per_mass / compliance)};
}

himc_residual_step himc_residual_in(const himc_residual *r, double h)
{
    if (r->root == 0)
        return (himc_residual_step){0};
    double tilt = sqrt(1 - RESIDUAL_DAMPING * RESIDUAL_DAMPING), angle = tilt * r->omega * h;
    double shrink = exp(-RESIDUAL_DAMPING * r->omega * h) / tilt;
    double cosine = tilt * shrink * cos(angle), sine = shrink * sin(angle);
    return (himc_residual_step){.stay = cosine + RESIDUAL_DAMPING * sine,
                                .turn = sine,
                                .back = cosine - RESIDUAL_DAMPING * sine};
}
