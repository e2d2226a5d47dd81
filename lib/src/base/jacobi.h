/// jacobi.h: eigenvalues and eigenvectors of a small symmetric matrix: means of rotations,
/// solvers of the hands, modes of an uneven head.
///
/// Cyclic Jacobi method: rotates in one plane p, q after the other by the smaller angle that makes
/// a_pq zero. The tangent t of that angle solves t^2 + 2 theta t = 1, theta = (a_qq - a_pp) / 2
/// a_pq. It always converges, at the end quadratically (Golub & Van Loan, Matrix Computations,
/// 2013, section 8.5). HIMC_RT: no memory, at most HIMC_JACOBI_SWEEPS sweeps.
#ifndef HIMC_JACOBI_H
#define HIMC_JACOBI_H

#include <math.h>

#define HIMC_JACOBI_SWEEPS 8       // chosen: matrices of 3 x 3 and 4 x 4 need 4 to 6
#define HIMC_JACOBI_DIAGONAL 1e-17 // chosen: below the rounding of doubles, 1.1e-16, of the trace

// x' = c x - s y, y' = s x + c y for n pairs, neighbours `stride` apart in memory
static inline void himc_jacobi_mix(int n, double *x, double *y, int stride, double c, double s)
{
    for (int i = 0; i < n * stride; i += stride) {
        double a = x[i], b = y[i];
        x[i] = c * a - s * b;
        y[i] = s * a + c * b;
    }
}

// cosine and sine of the rotation that makes a_pq zero
static inline void himc_jacobi_angle(double pp, double pq, double qq, double *c, double *s)
{
    double theta = (qq - pp) / (2 * pq);
    double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
    *c = 1 / sqrt(t * t + 1);
    *s = t * *c;
}

// the rotation that makes a[p][q] zero
static inline void himc_jacobi_rotate(int n, double *a, double *v, int p, int q)
{
    double c, s;
    if (a[p * n + q] == 0)
        return;
    himc_jacobi_angle(a[p * n + p], a[p * n + q], a[q * n + q], &c, &s);
    himc_jacobi_mix(n, a + p, a + q, n, c, s);
    himc_jacobi_mix(n, a + p * n, a + q * n, 1, c, s);
    himc_jacobi_mix(n, v + p, v + q, n, c, s);
}

/// Eigenvalues and eigenvectors of `a`, symmetric, positive semidefinite, n x n by rows. On return
/// `a` is the diagonal matrix of the eigenvalues in any order, and the columns of `v` (n x n by
/// rows) are the unit eigenvectors in the same order.
static inline void himc_jacobi(int n, double *a, double *v)
{
    double trace = 0;
    for (int i = 0; i < n * n; i++)
        v[i] = i % (n + 1) == 0;
    for (int i = 0; i < n; i++)
        trace += a[i * n + i];
    for (int sweep = 0; sweep < HIMC_JACOBI_SWEEPS; sweep++) {
        double off = 0;
        for (int p = 0; p < n; p++)
            for (int q = p + 1; q < n; q++)
                off += fabs(a[p * n + q]);
        if (!(off > HIMC_JACOBI_DIAGONAL * trace))
            return;
        for (int p = 0; p < n; p++)
            for (int q = p + 1; q < n; q++)
                himc_jacobi_rotate(n, a, v, p, q);
    }
}

#endif
