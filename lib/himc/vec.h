/// vec.h: vectors, quaternions and 3x3 matrices. All are plain values; every function is HIMC_RT.
///
/// A unit quaternion q rotates the vector v to q v q^-1; the product a b applies b first. A
/// rotation vector is the axis times the angle (rad). The logarithm here gives the full angle,
/// twice the half-angle logarithm of the 2012 paper's algorithm 1.
#ifndef HIMC_VEC_H
#define HIMC_VEC_H

#include "himc/base.h"

#include <math.h>

HIMC_BEGIN

/// A 3x3 matrix.
typedef struct himc_mat3 {
    double m[3][3]; ///< [row][column]
} himc_mat3;

// Vectors

/// (x, y, z).
static inline himc_vec3 himc_vec3_make(double x, double y, double z)
{
    himc_vec3 result = {x, y, z};
    return result;
}

/// a + b.
static inline himc_vec3 himc_vec3_add(himc_vec3 a, himc_vec3 b)
{
    himc_vec3 result = {a.x + b.x, a.y + b.y, a.z + b.z};
    return result;
}

/// a - b.
static inline himc_vec3 himc_vec3_sub(himc_vec3 a, himc_vec3 b)
{
    himc_vec3 result = {a.x - b.x, a.y - b.y, a.z - b.z};
    return result;
}

/// s a.
static inline himc_vec3 himc_vec3_scale(himc_vec3 a, double s)
{
    himc_vec3 result = {a.x * s, a.y * s, a.z * s};
    return result;
}

/// a + s b.
static inline himc_vec3 himc_vec3_madd(himc_vec3 a, double s, himc_vec3 b)
{
    himc_vec3 result = {a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
    return result;
}

/// The scalar product a . b.
static inline double himc_vec3_dot(himc_vec3 a, himc_vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// The vector product a x b.
static inline himc_vec3 himc_vec3_cross(himc_vec3 a, himc_vec3 b)
{
    himc_vec3 result = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    return result;
}

/// |a|, the Euclidean norm.
static inline double himc_vec3_length(himc_vec3 a)
{
    return sqrt(himc_vec3_dot(a, a));
}

/// True if no component is infinite or NaN.
static inline bool himc_vec3_finite(himc_vec3 a)
{
    return isfinite(a.x) && isfinite(a.y) && isfinite(a.z);
}

/// a / |a|; the zero vector stays zero.
static inline himc_vec3 himc_vec3_unit(himc_vec3 a)
{
    double length = himc_vec3_length(a);
    return length > 0 ? himc_vec3_scale(a, 1 / length) : a;
}

// Quaternions

/// 1: no rotation.
static inline himc_quat himc_quat_identity(void)
{
    himc_quat result = {1, 0, 0, 0};
    return result;
}

/// The conjugate; of a unit quaternion the inverse rotation.
static inline himc_quat himc_quat_conj(himc_quat q)
{
    himc_quat result = {q.w, -q.x, -q.y, -q.z};
    return result;
}

/// The product a b: the rotation b followed by the rotation a.
static inline himc_quat himc_quat_mul(himc_quat a, himc_quat b)
{
    himc_quat result = {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
                        a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
                        a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
                        a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
    return result;
}

/// The scalar product of all four components; of unit quaternions cos(angle / 2) between them.
static inline double himc_quat_dot(himc_quat a, himc_quat b)
{
    return a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
}

/// s q.
static inline himc_quat himc_quat_scale(himc_quat q, double s)
{
    himc_quat result = {q.w * s, q.x * s, q.y * s, q.z * s};
    return result;
}

/// q / |q|; q must not be zero.
static inline himc_quat himc_quat_unit(himc_quat q)
{
    return himc_quat_scale(q, 1 / sqrt(himc_quat_dot(q, q)));
}

/// The vector part (x, y, z).
static inline himc_vec3 himc_quat_vector(himc_quat q)
{
    himc_vec3 result = {q.x, q.y, q.z};
    return result;
}

/// q v q^-1, the vector v rotated by the unit quaternion q.
static inline himc_vec3 himc_quat_rotate(himc_quat q, himc_vec3 v)
{
    himc_vec3 u = {q.x, q.y, q.z};
    himc_vec3 t = himc_vec3_scale(himc_vec3_cross(u, v), 2);
    return himc_vec3_add(himc_vec3_madd(v, q.w, t), himc_vec3_cross(u, t));
}

/// The unit quaternion of a rotation vector (rad).
static inline himc_quat himc_quat_exp(himc_vec3 rotation)
{
    double z = 0.25 * himc_vec3_dot(rotation, rotation), y = z * z, w, s;
    if (z < 0.25) { // below 1 rad the series are exact to rounding
        w = 1.0 / 40320 - z * (1.0 / 3628800) + y * (1.0 / 479001600 - z * (1.0 / 87178291200));
        w = 1 - z * 0.5 + y * (1.0 / 24 - z * (1.0 / 720) + y * w);
        s = 1.0 / 725760 - z * (1.0 / 79833600) +
            y * (1.0 / 12454041600 - z * (1.0 / 2615348736000));
        s = 0.5 - z * (1.0 / 12) + y * (1.0 / 240 - z * (1.0 / 10080) + y * s);
    } else {
        double half = sqrt(z);
        w = cos(half);
        s = 0.5 * sin(half) / half;
    }
    himc_quat result = {w, rotation.x * s, rotation.y * s, rotation.z * s};
    return result;
}

/// Angle over the sine of its half, signed: the rotation vector over the vector part of a unit
/// quaternion.
static inline double himc_quat_log_ratio(himc_quat q)
{
    double u = 1 - fabs(q.w), y = u * u, s;
    if (u < 0.2) { // below 1.28 rad a minimax polynomial, exact to 1e-17
        double high = 9.5049082339517749e-4 + u * 8.6761211424043542e-4;
        high = 4.9671380431637343e-3 + u * 2.3789886983455347e-3 + y * high;
        high = 2.3087995632767271e-2 + u * 1.0656517591901795e-2 + y * high;
        high = 1.1428571427235699e-1 + u * 5.0793651644593404e-2 + y * high;
        s = 2 + u * (2.0 / 3 + u * 2.6666666666674782e-1 + y * high);
    } else {
        double length = himc_vec3_length(himc_quat_vector(q));
        s = 2 * atan2(length, fabs(q.w)) / length;
    }
    return q.w < 0 ? -s : s;
}

/// The rotation vector (rad) of a unit quaternion, the shorter way round: |result| <= pi.
static inline himc_vec3 himc_quat_log(himc_quat q)
{
    return himc_vec3_scale(himc_quat_vector(q), himc_quat_log_ratio(q));
}

// Matrices

/// The rotation matrix of a unit quaternion.
static inline himc_mat3 himc_mat3_from_quat(himc_quat q)
{
    double w = q.w, x = q.x, y = q.y, z = q.z;
    himc_mat3 result = {{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                         {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                         {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
    return result;
}

/// The unit quaternion of a rotation matrix (Shepperd 1978: from the largest component).
himc_quat himc_quat_from_mat3(himc_mat3 a);

/// The rotation matrix with the given orthonormal, right-handed axes as its columns.
static inline himc_mat3 himc_mat3_from_axes(himc_vec3 x, himc_vec3 y, himc_vec3 z)
{
    himc_mat3 result = {{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}};
    return result;
}

/// The product a v.
static inline himc_vec3 himc_mat3_apply(const himc_mat3 *a, himc_vec3 v)
{
    himc_vec3 result = {a->m[0][0] * v.x + a->m[0][1] * v.y + a->m[0][2] * v.z,
                        a->m[1][0] * v.x + a->m[1][1] * v.y + a->m[1][2] * v.z,
                        a->m[2][0] * v.x + a->m[2][1] * v.y + a->m[2][2] * v.z};
    return result;
}

/// The product a' v, a' the transpose of a.
static inline himc_vec3 himc_mat3_apply_transposed(const himc_mat3 *a, himc_vec3 v)
{
    himc_vec3 result = {a->m[0][0] * v.x + a->m[1][0] * v.y + a->m[2][0] * v.z,
                        a->m[0][1] * v.x + a->m[1][1] * v.y + a->m[2][1] * v.z,
                        a->m[0][2] * v.x + a->m[1][2] * v.y + a->m[2][2] * v.z};
    return result;
}

/// The product a b.
static inline himc_mat3 himc_mat3_mul(const himc_mat3 *a, const himc_mat3 *b)
{
    himc_mat3 c;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            c.m[i][j] = a->m[i][0] * b->m[0][j] + a->m[i][1] * b->m[1][j] + a->m[i][2] * b->m[2][j];
    return c;
}

/// The inverse of a symmetric positive definite matrix, by cofactors.
static inline himc_mat3 himc_mat3_inverse_symmetric(const himc_mat3 *a)
{
    double c00 = a->m[1][1] * a->m[2][2] - a->m[1][2] * a->m[1][2];
    double c01 = a->m[0][2] * a->m[1][2] - a->m[0][1] * a->m[2][2];
    double c02 = a->m[0][1] * a->m[1][2] - a->m[0][2] * a->m[1][1];
    double c11 = a->m[0][0] * a->m[2][2] - a->m[0][2] * a->m[0][2];
    double c12 = a->m[0][1] * a->m[0][2] - a->m[0][0] * a->m[1][2];
    double c22 = a->m[0][0] * a->m[1][1] - a->m[0][1] * a->m[0][1];
    double s = 1 / (a->m[0][0] * c00 + a->m[0][1] * c01 + a->m[0][2] * c02);
    himc_mat3 result = {
        {{c00 * s, c01 * s, c02 * s}, {c01 * s, c11 * s, c12 * s}, {c02 * s, c12 * s, c22 * s}}};
    return result;
}

HIMC_END

#endif
