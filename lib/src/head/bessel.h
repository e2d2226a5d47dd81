/// bessel.h: Bessel functions of the first kind and integer order, and their zeros; the shapes of a
/// round membrane.
#ifndef HIMC_BESSEL_H
#define HIMC_BESSEL_H

/// J_0(z) .. J_top(z) into `j` (top + 1), z >= 0; absolute error about 1e-15.
void himc_bessel_orders(double z, int top, double *j);

/// J_m(z), m >= 0, z >= 0.
double himc_bessel_j(int m, double z);

/// J_0(z), z >= 0, to 1e-7; fast.
double himc_bessel_j0(double z);

/// The n-th positive zero of J_m (m >= 0, n >= 1), to about 1e-15 relative.
double himc_bessel_zero(int m, int n);

#define HIMC_BESSEL_FIRST 0x1.ea75575af6f08p+1 ///< himc_bessel_zero(1, 1), to the bit

/// The zero of J_m in [low, high]; this interval must have exactly one.
double himc_bessel_zero_between(int m, double low, double high);

#endif
