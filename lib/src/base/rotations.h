/// rotations.h: the mean of rotations; private.
///
/// The unit quaternion q that maximises q' S q, S = sum q_i q_i', is the one nearest to all q_i in
/// the sum of the squares of the rotation matrices' differences, whatever their signs: the
/// eigenvector of the largest eigenvalue of S (Markley, Cheng, Crassidis & Oshman, Averaging
/// Quaternions, Journal of Guidance, Control, and Dynamics 30(4), 2007, equation 13).
#ifndef HIMC_ROTATIONS_H
#define HIMC_ROTATIONS_H

#include "himc/vec.h"

#include "base/jacobi.h"

/// Rotations to be averaged; none when zero.
typedef struct himc_rotations {
    double sum[16]; ///< S, of w x y z, by rows
} himc_rotations;

static inline void himc_rotations_add(himc_rotations *r, himc_quat q)
{
    const double v[4] = {q.w, q.x, q.y, q.z};
    for (int i = 0; i < 16; i++)
        r->sum[i] += v[i / 4] * v[i % 4];
}

/// Their mean, w not negative; the identity when there are none. HIMC_RT.
static inline himc_quat himc_rotations_mean(const himc_rotations *r)
{
    himc_rotations a = *r;
    double v[16];
    int most = 0;
    himc_jacobi(4, a.sum, v);
    for (int i = 1; i < 4; i++)
        most = a.sum[5 * i] > a.sum[5 * most] ? i : most;
    himc_quat q = himc_quat_unit((himc_quat){v[most], v[4 + most], v[8 + most], v[12 + most]});
    return q.w < 0 ? himc_quat_scale(q, -1) : q;
}

#endif
