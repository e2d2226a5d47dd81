// Eigen's names get our prefix, so that they never meet those of a host with another Eigen. Its
// assertions would end the process.
#define Eigen himc_eigen
#define EIGEN_NO_DEBUG
#include "base/linear.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <complex>
#include <new>

namespace
{

using matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using columns = Eigen::MatrixXd;
using vector = Eigen::VectorXd;
using given = Eigen::Map<const matrix>;
using complex_columns = Eigen::MatrixXcd;
using complex_vector = Eigen::VectorXcd;
using signals = Eigen::Map<const complex_columns>;

himc_linear outcome(Eigen::ComputationInfo info, himc_linear otherwise)
{
    return info == Eigen::Success ? HIMC_LINEAR_SOLVED : otherwise;
}

// Eigen parts its sums as the processor's caches have room. With these sizes (bytes; chosen: a
// usual machine's) they are the same on any.
void fix_sums()
{
    static const bool fixed = (Eigen::setCpuCacheSizes(48 << 10, 2 << 20, 32 << 20), true);
    (void)fixed;
}

// what `solve` returns, or that there was no memory for it
template <class work> himc_linear attempt(work solve)
{
    fix_sums();
#ifdef __cpp_exceptions
    try {
        return solve();
    } catch (const std::bad_alloc &) {
        return HIMC_LINEAR_NO_MEMORY;
    }
#else
    return solve(); // memory that is short ends a program without exceptions, as in a page
#endif
}

// the covariance of `lags` values in a row; along a diagonal one value comes and one goes, from the
// later and softer ones on, so that no digits are lost
complex_columns covariance(const signals &z, int lags)
{
    complex_columns sum = complex_columns::Zero(lags, lags);
    int places = (int)z.rows() - lags + 1, last = lags - 1;
    for (int channel = 0; channel < z.cols(); channel++) {
        auto x = z.col(channel);
        for (int j = 0; j < lags; j++) {
            std::complex<double> value = x.segment(j, places).dot(x.segment(last, places));
            sum(last, j) += value;
            for (int i = last - 1, k = j - 1; k >= 0; i--, k--) {
                value += x[i] * std::conj(x[k]) - x[i + places] * std::conj(x[k + places]);
                sum(i, k) += value;
            }
        }
    }
    return sum;
}

// what turns the space of the signal from one value to the next; empty: not found
complex_vector turns(const complex_columns &space)
{
    auto first = space.topRows(space.rows() - 1), next = space.bottomRows(space.rows() - 1);
    complex_columns squares = first.adjoint() * first;
    complex_columns turn = squares.ldlt().solve(first.adjoint() * next);
    Eigen::ComplexEigenSolver<complex_columns> poles(turn, false);
    return poles.info() == Eigen::Success ? poles.eigenvalues() : complex_vector();
}

complex_columns amplitudes(const signals &z, const complex_vector &poles)
{
    complex_columns powers(z.rows(), poles.size());
    for (int k = 0; k < poles.size(); k++) {
        std::complex<double> power = std::abs(poles[k]) < 1 ? 1 : 0;
        for (int n = 0; n < z.rows(); n++, power *= poles[k])
            powers(n, k) = power;
    }
    return powers.colPivHouseholderQr().solve(z);
}

} // namespace

himc_linear himc_linear_exponentials(int samples, int channels, const double *z, int most,
                                     double clear, double *p, double *c, int *found)
{
    return attempt([=] {
        signals values(reinterpret_cast<const std::complex<double> *>(z), samples, channels);
        int lags = std::min(samples / 2, HIMC_LINEAR_LAGS);
        // the eigenvectors of the real tridiagonal matrix, and of these the signal's alone turned
        // back, take half the time of a complex problem
        Eigen::Tridiagonalization<complex_columns> three(covariance(values, lags));
        Eigen::SelfAdjointEigenSolver<columns> spaces;
        spaces.computeFromTridiagonal(three.diagonal(), three.subDiagonal());
        if (spaces.info() != Eigen::Success)
            return HIMC_LINEAR_UNSOLVED;
        double noise =
            std::max(spaces.eigenvalues()[lags / 4], 1e-12 * spaces.eigenvalues()[lags - 1]);
        *found = std::min(most, (int)(spaces.eigenvalues().array() > clear * noise).count());
        if (*found == 0)
            return HIMC_LINEAR_SOLVED;
        columns signal = spaces.eigenvectors().rightCols(*found);
        complex_vector poles = turns(three.matrixQ() * signal.cast<std::complex<double>>());
        if (poles.size() == 0)
            return HIMC_LINEAR_UNSOLVED;
        Eigen::Map<complex_vector>(reinterpret_cast<std::complex<double> *>(p), *found) = poles;
        Eigen::Map<complex_columns>(reinterpret_cast<std::complex<double> *>(c), *found, channels) =
            amplitudes(values, poles);
        return HIMC_LINEAR_SOLVED;
    });
}

himc_linear himc_linear_solve(int n, double *a, double *x)
{
    fix_sums();
    Eigen::Map<columns> matrix_of(a, n, n);
    Eigen::LLT<Eigen::Ref<columns>> factors(matrix_of);
    if (factors.info() == Eigen::Success)
        factors.solveInPlace(Eigen::Map<vector>(x, n));
    return outcome(factors.info(), HIMC_LINEAR_NOT_DEFINITE);
}

himc_linear himc_linear_least_squares(int rows, int terms, int wanted, const double *a,
                                      const double *b, double negligible, double *x, int *rank)
{
    return attempt([=] {
        given terms_of(a, rows, terms);
        Eigen::SelfAdjointEigenSolver<columns> squares(terms_of.transpose() * terms_of);
        if (squares.info() != Eigen::Success)
            return HIMC_LINEAR_UNSOLVED;
        // the largest are the last ones
        double least = negligible * negligible * squares.eigenvalues()[terms - 1];
        *rank = (int)(squares.eigenvalues().array() > least).count();
        columns kept = squares.eigenvectors().rightCols(*rank);
        columns along = kept.transpose() * (terms_of.transpose() * given(b, rows, wanted));
        along = squares.eigenvalues().tail(*rank).cwiseInverse().asDiagonal() * along;
        Eigen::Map<matrix>(x, terms, wanted) = kept * along;
        return HIMC_LINEAR_SOLVED;
    });
}

himc_linear himc_linear_eigenvalues(int n, const double *a, double *lambda, double *v)
{
    return attempt([=] {
        Eigen::SelfAdjointEigenSolver<columns> found(given(a, n, n), v ? Eigen::ComputeEigenvectors
                                                                       : Eigen::EigenvaluesOnly);
        if (found.info() != Eigen::Success)
            return HIMC_LINEAR_UNSOLVED;
        Eigen::Map<vector>(lambda, n) = found.eigenvalues();
        if (v)
            Eigen::Map<columns>(v, n, n) = found.eigenvectors();
        return HIMC_LINEAR_SOLVED;
    });
}

himc_linear himc_linear_vibrations(int n, const double *k, const double *m, double *lambda,
                                   double *v)
{
    return attempt([=] {
        if (Eigen::LLT<columns>(given(m, n, n)).info() != Eigen::Success)
            return HIMC_LINEAR_NOT_DEFINITE;
        Eigen::GeneralizedSelfAdjointEigenSolver<columns> modes(
            given(k, n, n), given(m, n, n),
            (v ? Eigen::ComputeEigenvectors : Eigen::EigenvaluesOnly) | Eigen::Ax_lBx);
        if (modes.info() != Eigen::Success)
            return HIMC_LINEAR_UNSOLVED;
        Eigen::Map<vector>(lambda, n) = modes.eigenvalues();
        if (v)
            Eigen::Map<columns>(v, n, n) = modes.eigenvectors();
        return HIMC_LINEAR_SOLVED;
    });
}
