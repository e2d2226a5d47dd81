/// vec.c: the conversions too long to be inline.
#include "himc/vec.h"

// Shepperd 1978: solve for the largest of the four components first, so that no small number is
// divided by
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

himc_quat himc_quat_from_limb(himc_vec3 along, himc_vec3 flexion)
{
    himc_vec3 z = himc_vec3_scale(along, -1);
    himc_vec3 y = himc_vec3_madd(flexion, -himc_vec3_dot(flexion, z), z);
    if (himc_vec3_length(y) < 1e-6) {
        himc_vec3 level = {-z.y, z.x, 0};
        y = himc_vec3_length(level) > 1e-6 ? level : himc_vec3_make(0, 1, 0);
    }
    y = himc_vec3_unit(y);
    return himc_quat_from_mat3(himc_mat3_from_axes(himc_vec3_cross(y, z), y, z));
}
