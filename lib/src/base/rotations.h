/// rotations.h: the mean of rotations, and a tensor that is diagonal in a rotated frame: for
/// limits, energy (body) and regressions, servos (control).
///
/// The mean of unit quaternions q_i is the unit quaternion q that maximises q' S q, S = sum q_i
/// q_i': the eigenvector of the largest eigenvalue of S. It minimises the sum of squared
/// differences of the rotation matrices and does not depend on the signs of the q_i (Markley,
/// Cheng, Crassidis & Oshman, Averaging Quaternions, Journal of Guidance, Control, and Dynamics
/// 30(4), 2007, equation 13).
#ifndef HIMC_ROTATIONS_H
#define HIMC_ROTATIONS_H

#include "himc/vec.h"

#include "base/jacobi.h"

/// A sum of rotations to average; all zero when empty.
typedef struct himc_rotations {
    double sum[16]; ///< S in the order w x y z, by rows
} himc_rotations;

/// Adds a rotation (unit quaternion). HIMC_RT.
static inline void himc_rotations_add(himc_rotations *r, himc_quat q)
{
    const double v[4] = {q.w, q.x, q.y, q.z};
    for (int i = 0; i < 16; i++)
        r->sum[i] += v[i / 4] * v[i % 4];
}

/// The mean of the added rotations, w not negative; the identity if there are none. HIMC_RT.
static inline himc_quat himc_rotations_mean(const himc_rotations *r)
{
    himc_rotations a = *r;
    double v[16];
    int largest = 0;
    himc_jacobi(4, a.sum, v);
    for (int i = 1; i < 4; i++)
        largest = a.sum[5 * i] > a.sum[5 * largest] ? i : largest;
    himc_quat q =
        himc_quat_unit((himc_quat){v[largest], v[4 + largest], v[8 + largest], v[12 + largest]});
    return q.w < 0 ? himc_quat_scale(q, -1) : q;
}

/// R diag(d) R' v: scales v by d.x, d.y, d.z along the columns of the rotation matrix R.
static inline himc_vec3 himc_mat3_scale_along(const himc_mat3 *r, himc_vec3 d, himc_vec3 v)
{
    himc_vec3 local = himc_mat3_apply_transposed(r, v);
    himc_vec3 scaled = {d.x * local.x, d.y * local.y, d.z * local.z};
    return himc_mat3_apply(r, scaled);
}

#endif
