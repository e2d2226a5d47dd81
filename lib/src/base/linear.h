/// linear.h: linear algebra of any size, by Eigen: arms fitted to captures, grids, regressions. It
/// allocates, and says so when it finds no memory. Matrices are by rows; a symmetric one is the
/// same by columns.
#ifndef HIMC_LINEAR_H
#define HIMC_LINEAR_H

#ifdef __cplusplus
extern "C" {
#endif

/// What became of a problem.
typedef enum himc_linear {
    HIMC_LINEAR_SOLVED,
    HIMC_LINEAR_NO_MEMORY,
    HIMC_LINEAR_NOT_DEFINITE, ///< the matrix that must be positive definite is not
    HIMC_LINEAR_UNSOLVED      ///< the iteration did not converge
} himc_linear;

/// A x = b, A symmetric and positive definite (n x n), overwritten. `x` is b before the call. Needs
/// no memory.
himc_linear himc_linear_solve(int n, double *a, double *x);

/// The x (terms x columns) of least |A x - B| and, where several are least, of least |x|; A (rows x
/// terms), B (rows x columns). Singular values below `negligible` times the largest count as 0;
/// `rank` is the number of the others. By the eigenvalues of A' A, which are their squares, so
/// `negligible` must be well above 1e-8, the root of the rounding of doubles. `x`, which may be B's
/// array, is written unless it fails.
himc_linear himc_linear_least_squares(int rows, int terms, int columns, const double *a,
                                      const double *b, double negligible, double *x, int *rank);

/// A v = lambda v, A symmetric (n x n): all n eigenvalues, rising, and their unit eigenvectors, one
/// after the other (n x n); `v` may be NULL, and may be A's array.
himc_linear himc_linear_eigenvalues(int n, const double *a, double *lambda, double *v);

/// K v = lambda M v, both symmetric (n x n), M positive definite: all n eigenvalues, rising, and
/// their eigenvectors, v' M v = 1, one after the other (n x n); `v` may be NULL.
himc_linear himc_linear_vibrations(int n, const double *k, const double *m, double *lambda,
                                   double *v);

/// Poles p_k and amplitudes c_k of z[n] = sum_k c_k p_k^n in noise, by ESPRIT (Roy and Kailath
/// 1989). `z`: `channels` blocks of `samples` complex values (real, imaginary) with common poles.
/// The covariance is that of samples/2 consecutive values, at most HIMC_LINEAR_LAGS; `found` (at
/// most `most`) is the number of its eigenvalues above `clear` times the median of the lower half.
/// The caller's arrays `p` (2 most) and `c` (2 most channels) get `found` poles, then `found`
/// amplitudes a channel (least squares; 0 of a pole that grows).
himc_linear himc_linear_exponentials(int samples, int channels, const double *z, int most,
                                     double clear, double *p, double *c, int *found);
#define HIMC_LINEAR_LAGS 110 ///< consecutive values; chosen: bounds the eigenvalue problem

#ifdef __cplusplus
}
#endif

#endif
