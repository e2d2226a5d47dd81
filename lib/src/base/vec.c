/// vec.c: the conversion from a rotation matrix to a quaternion.
#include "himc/vec.h"

// Shepperd 1978 (Quaternion from rotation matrix, J. Guidance and Control 1(3)): solve for the
// largest of the four components first, so that no divisor is small
himc_quat himc_quat_from_mat3(himc_mat3 a)
{
    double trace = a.m[0][0] + a.m[1][1] + a.m[2][2];
    if (trace > 0) {
        double s = 2 * sqrt(trace + 1);
        return himc_quat_unit((himc_quat){0.25 * s, (a.m[2][1] - a.m[1][2]) / s,
                                          (a.m[0][2] - a.m[2][0]) / s,
                                          (a.m[1][0] - a.m[0][1]) / s});
    }
    int i = a.m[1][1] > a.m[0][0] ? 1 : 0;
    if (a.m[2][2] > a.m[i][i])
        i = 2;
    int j = (i + 1) % 3, k = (i + 2) % 3;
    double s = 2 * sqrt(1 + a.m[i][i] - a.m[j][j] - a.m[k][k]), v[3];
    v[i] = 0.25 * s;
    v[j] = (a.m[j][i] + a.m[i][j]) / s;
    v[k] = (a.m[k][i] + a.m[i][k]) / s;
    return himc_quat_unit((himc_quat){(a.m[k][j] - a.m[j][k]) / s, v[0], v[1], v[2]});
}
