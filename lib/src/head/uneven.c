/// uneven.c: the Rayleigh and Ritz problem of a membrane whose tension depends on direction.
///
/// A round film that its hoop pulls with T (1 + sum_k t_k cos(k th - psi_k)), k even (lugs.h), is
/// in plane balance under Airy's stress function sum_k (A_k r^k + B_k r^(k+2)) cos(k th - psi_k), r
/// in radii, without shear at the hoop:
///     B_k = t_k/(2 (k + 1)),   A_k = -B_k (k + 1)/(k - 1),
///     s_rr = R cos,   s_tt = S cos,   s_rt = Q sin   of (k th - psi_k),
///     R = A k (1 - k) r^(k-2) + B (k + 2 - k^2) r^k
///     S = A k (k - 1) r^(k-2) + B (k + 2) (k + 1) r^k
///     Q = A k (k - 1) r^(k-2) + B k (k + 1) r^k
/// Its stiffness in the even head's shapes phi_i = J_m(j r) cos(m th - a_i) is
///     K_ij = K_i [i = j] + T int s_ab d_a phi_i d_b phi_j dS,
/// with the masses M_i, in air those of the loaded modes. The angle's integrals are cosines of
/// psi_k and a_i, a_j, and not zero only for k = m + m' and k = |m - m'|; the radius' are computed
/// once for a list. Eigenvectors v of M^-1/2 K M^-1/2 (Jacobi) are the uneven head's modes. They
/// have the mass of the mode whose place in the list they take, c_ij = v_j sqrt(M_i/M_j). The
/// splitting of a pair by k = 2 m is in K_i already (lugs.c).
///
/// Force and displacement have the same mixed shapes, so whatever the field, energy never grows.
#include "head/uneven.h"

#include "base/jacobi.h"
#include "head/bessel.h"
#include "head/modes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NODES 128  // of a radius' integral (Simpson); chosen: 1e-5 of it for the highest mode
#define SWEEPS 6   // of Jacobi's method; chosen: it converges in 3 or 4
#define LEAST 1e-7 // tangent of a rotation that counts; chosen: -140 dB
#define ENTRIES (HIMC_UNEVEN_ORDERS * HIMC_UNEVEN_RANKS)

struct himc_uneven_pair {
    short a, b; // entries of the list, a < b
    short k;    // order of the field per t_k
    // integrals over the radius of R f_a f_b, S g_a g_b/r^2, Q f_a g_b/r, Q g_a f_b/r
    double rr, tt, rt, tr;
};

static bool mixes(const himc_mode_entry *e)
{
    return e->m < HIMC_UNEVEN_ORDERS && e->n <= HIMC_UNEVEN_RANKS;
}

// J_m(z r) and its slope along r at each node
typedef struct radial_shape {
    double value[NODES + 1], slope[NODES + 1];
} radial_shape;

static void find_shape(const himc_mode_entry *e, radial_shape *s)
{
    double j[HIMC_UNEVEN_ORDERS + 1];
    for (int i = 0; i <= NODES; i++) {
        himc_bessel_orders(e->z * i / NODES, e->m + 1, j);
        s->value[i] = j[e->m];
        s->slope[i] = e->z * (e->m > 0 ? 0.5 * (j[e->m - 1] - j[e->m + 1]) : -j[1]);
    }
}

static himc_uneven_pair integrals(const radial_shape *a, const radial_shape *b, int k)
{
    himc_uneven_pair sum = {.k = (short)k};
    double big_b = 1 / (2 * (k + 1.0)), big_a = -1 / (2 * (k - 1.0));
    for (int i = 1; i <= NODES; i++) { // at r = 0 nothing: k and the orders' sum are at least 2
        double r = (double)i / NODES, low = big_a * pow(r, k - 2), high = big_b * pow(r, k);
        double weight = (i == NODES ? 1 : i % 2 ? 4 : 2) / (3.0 * NODES);
        double radial = k * (1 - k) * low + (k + 2 - k * k) * high;
        double round = k * (k - 1) * low + (k + 2) * (k + 1) * high;
        double shear = k * ((k - 1) * low + (k + 1) * high);
        sum.rr += weight * r * radial * a->slope[i] * b->slope[i];
        sum.tt += weight * round * a->value[i] * b->value[i] / r;
        sum.rt += weight * shear * a->slope[i] * b->value[i];
        sum.tr += weight * shear * a->value[i] * b->slope[i];
    }
    return sum;
}

static bool is_field(int k)
{
    return k >= 2 && k <= HIMC_LUGS_FIELD && k % 2 == 0;
}

himc_uneven_pair *himc_uneven_pairs(const himc_modes *modes, int *count)
{
    radial_shape *shape = malloc(sizeof *shape * ENTRIES);
    himc_uneven_pair *pairs = malloc(sizeof *pairs * ENTRIES * ENTRIES);
    int entry[ENTRIES], found = 0;
    *count = 0;
    for (int i = 0; shape && pairs && i < modes->entry_count; i++)
        if (mixes(&modes->entries[i])) {
            entry[found] = i;
            find_shape(&modes->entries[i], &shape[found++]);
        }
    for (int i = 0; i < found; i++)
        for (int l = i + 1; l < found; l++) {
            int m = modes->entries[entry[i]].m, other = modes->entries[entry[l]].m;
            int field[2] = {abs(m - other), m + other};
            for (int s = 0; s < (m > 0 && other > 0 ? 2 : 1); s++) {
                if (!is_field(field[s]))
                    continue;
                pairs[*count] = integrals(&shape[i], &shape[l], field[s]);
                pairs[*count].a = (short)entry[i];
                pairs[(*count)++].b = (short)entry[l];
            }
        }
    himc_uneven_pair *fitting =
        shape && pairs ? realloc(pairs, sizeof *pairs * (size_t)(*count > 0 ? *count : 1)) : NULL;
    if (!fitting)
        free(pairs);
    free(shape);
    return fitting;
}

// a member of a pair: cos(m th - angle)
typedef struct member {
    int m;
    double angle;
} member;

static member member_of(const himc_modes *modes, int index)
{
    const himc_mode_entry *e = &modes->entries[modes->of[index]];
    bool sine = index > modes->first[modes->of[index]];
    return (member){e->m, e->m * modes->pairs[e->m].axis + (sine ? HIMC_PI / 2 : 0)};
}

// int s_ab d_a phi_i d_b phi_j dS of two members, per T, for one harmonic of the tension
static double coupling(const himc_uneven_pair *p, const member *a, const member *b,
                       const himc_lugs_harmonic *field)
{
    bool sum = p->k == a->m + b->m, less = p->k == b->m - a->m, more = p->k == a->m - b->m;
    double plus = sum ? cos(field->phase - a->angle - b->angle) : 0;
    double minus = less   ? cos(field->phase + a->angle - b->angle)
                   : more ? cos(field->phase - a->angle + b->angle)
                          : 0;
    // of the products of three sines and cosines; of order 0 both terms are one and the same
    double cc = plus + minus, ss = a->m * b->m * (minus - plus);
    double cs = -b->m * (plus + (less ? minus : -minus)),
           sc = -a->m * (plus + (more ? minus : -minus));
    double parts = p->rr * cc + p->tt * ss + p->rt * cs + p->tr * sc;
    return 0.5 * HIMC_PI * field->amount * parts;
}

// adds a coupling of two entries to the matrix, between each of their members
static void add_pair(const himc_modes *modes, const himc_uneven_pair *p,
                     const himc_lugs_harmonic *field, const int *row, int n, double tension,
                     double *matrix)
{
    int first[2] = {modes->first[p->a], modes->first[p->b]};
    for (int i = first[0]; i < modes->exact && modes->of[i] == p->a; i++)
        for (int l = first[1]; l < modes->exact && modes->of[l] == p->b; l++) {
            member a = member_of(modes, i), b = member_of(modes, l);
            double value = tension * coupling(p, &a, &b, field);
            matrix[row[i] * n + row[l]] += value;
            matrix[row[l] * n + row[i]] += value;
        }
}

// of order 0 the shapes of the list are mixtures by a kettle: both sides of the matrix follow
static void mix_order_0(const himc_modes *modes, const himc_uneven_block *block, double *matrix)
{
    const himc_mixture *mix = &modes->mixture;
    int at[HIMC_MIXED], n = block->count;
    for (int k = 0; k < mix->count; k++)
        for (int i = 0; i < n; i++)
            if (block->index[i] == mix->index[k])
                at[k] = i;
    for (int side = 0; side < 2; side++)
        for (int i = 0; i < n; i++) {
            double bare[HIMC_MIXED];
            for (int k = 0; k < mix->count; k++)
                bare[k] = matrix[side ? at[k] * n + i : i * n + at[k]];
            for (int k = 0; k < mix->count; k++) {
                double sum = 0;
                for (int l = 0; l < mix->count; l++)
                    sum += mix->part[k][l] * bare[l];
                matrix[side ? at[k] * n + i : i * n + at[k]] = sum;
            }
        }
}

// the rotation that makes a[p][q] zero; rows are changed, and the columns are the same numbers
static void rotate(int n, double *a, double *v, int p, int q)
{
    double *x = a + p * n, *y = a + q * n, c, s;
    himc_jacobi_angle(x[p], x[q], y[q], &c, &s);
    himc_jacobi_mix(n, x, y, 1, c, s);
    himc_jacobi_mix(n, v + p * n, v + q * n, 1, c, s);
    himc_jacobi_mix(1, x + p, x + q, 1, c, s);
    himc_jacobi_mix(1, y + p, y + q, 1, c, s);
    for (int i = 0; i < n; i++) {
        a[i * n + p] = x[i];
        a[i * n + q] = y[i];
    }
}

// eigenvectors of a symmetric matrix, which becomes diagonal, in the rows of v
static void diagonalise(int n, double *a, double *v)
{
    for (int i = 0; i < n * n; i++)
        v[i] = i % (n + 1) == 0;
    for (int sweep = 0, turned = 1; sweep < SWEEPS && turned > 0; sweep++) {
        turned = 0;
        for (int p = 0; p < n; p++)
            for (int q = p + 1; q < n; q++)
                if (fabs(a[p * n + q]) > LEAST * fabs(a[p * n + p] - a[q * n + q])) {
                    rotate(n, a, v, p, q);
                    turned++;
                }
    }
}

static void find_block(himc_modes *modes, int parity, double tension, const double *mass,
                       double *stiffness)
{
    himc_uneven_block *block = &modes->block[parity];
    double matrix[HIMC_UNEVEN_MODES * HIMC_UNEVEN_MODES], v[HIMC_UNEVEN_MODES * HIMC_UNEVEN_MODES];
    int row[HIMC_MODES_MAX], n = 0;
    for (int i = 0; i < modes->exact; i++) {
        const himc_mode_entry *e = &modes->entries[modes->of[i]];
        if (mixes(e) && e->m % 2 == parity) {
            double angle = member_of(modes, i).angle, norm = e->m > 0 ? 2 * e->norm : e->norm;
            block->index[n] = i;
            block->even[n].m = e->m;
            block->even[n].zero = e->z;
            block->even[n].slope = (e->n % 2 ? 1 : -1) * sqrt(norm);
            block->even[n].cosine = cos(angle);
            block->even[n].sine = sin(angle);
            row[i] = n++;
        }
    }
    block->count = n;
    memset(matrix, 0, sizeof *matrix * (size_t)(n * n));
    for (int p = 0; p < modes->uneven_count; p++)
        if (modes->entries[modes->uneven[p].a].m % 2 == parity) {
            const himc_lugs_harmonic *field = &modes->field[modes->uneven[p].k / 2];
            add_pair(modes, &modes->uneven[p], field, row, n, tension, matrix);
        }
    if (parity == 0)
        mix_order_0(modes, block, matrix);
    double root[HIMC_UNEVEN_MODES];
    for (int i = 0; i < n; i++)
        root[i] = sqrt(mass[block->index[i]]);
    for (int i = 0; i < n; i++) {
        matrix[i * n + i] += stiffness[block->index[i]];
        for (int l = 0; l < n; l++)
            matrix[i * n + l] /= root[i] * root[l];
    }
    diagonalise(n, matrix, v);
    for (int i = 0; i < n; i++) {
        double sign = v[i * n + i] < 0 ? -1 : 1;
        stiffness[block->index[i]] = matrix[i * n + i] * root[i] * root[i];
        for (int l = 0; l < n; l++)
            block->part[i][l] = sign * v[i * n + l] * root[i] / root[l];
    }
}

void himc_uneven_find(himc_modes *modes, double tension, const double *mass, double *stiffness)
{
    for (int parity = 0; parity < 2; parity++)
        find_block(modes, parity, tension, mass, stiffness);
}

const himc_uneven_block *himc_uneven_of(const himc_modes *modes, int index, int *row)
{
    for (int parity = 0; parity < 2 && index < modes->exact; parity++)
        for (int i = 0; i < modes->block[parity].count; i++)
            if (modes->block[parity].index[i] == index) {
                *row = i;
                return &modes->block[parity];
            }
    return NULL;
}
