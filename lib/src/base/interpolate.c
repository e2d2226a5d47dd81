/// interpolate.c: joints on quintics; one set of powers of the time serves all of them.
///
/// Joints are interpolated as four-component quaternions q with q' = w q / 2 and
/// q'' = (w' - |w|^2 / 2) q / 2 (w in the parent's frame, as a pure quaternion), then normalised;
/// w and w' come back as 2 vec(q' q*) / |q|^2 and its derivative.
#include "base/interpolate.h"

himc_powers himc_powers_at(double t)
{
    double t2 = t * t, t3 = t2 * t, t4 = t2 * t2;
    return (himc_powers){{{1, t, t2, t3, t4, t4 * t},
                          {0, 1, 2 * t, 3 * t2, 4 * t3, 5 * t4},
                          {0, 0, 2, 6 * t, 12 * t2, 20 * t3}}};
}

static himc_quat add4(himc_quat a, double s, himc_quat b)
{
    return (himc_quat){a.w + s * b.w, a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

static himc_quat pure(himc_vec3 v)
{
    return (himc_quat){0, v.x, v.y, v.z};
}

// q, q' and q''
typedef struct knot {
    himc_quat q, rate, second;
} knot;

static knot knot_of(himc_quat q, himc_vec3 w, himc_vec3 a)
{
    himc_quat second = himc_quat_mul(pure(a), q);
    second = add4(second, -0.5 * himc_vec3_dot(w, w), q);
    return (knot){q, himc_quat_scale(himc_quat_mul(pure(w), q), 0.5), himc_quat_scale(second, 0.5)};
}

// the three conditions at its end give the three highest coefficients, as in quintic.h
static void find_course(const joint_state *from, const joint_state *to, double t, himc_quat c[6])
{
    double sign = himc_quat_dot(from->q, to->q) < 0 ? -1 : 1, t2 = t * t;
    knot p = knot_of(from->q, from->rate, from->acceleration);
    knot r = knot_of(himc_quat_scale(to->q, sign), to->rate, to->acceleration);
    himc_quat half = himc_quat_scale(p.second, 0.5);
    himc_quat x = add4(add4(add4(r.q, -1, p.q), -t, p.rate), -t2, half);
    himc_quat v = add4(add4(r.rate, -1, p.rate), -t, p.second), a = add4(r.second, -1, p.second);
    x = himc_quat_scale(x, 1 / (t2 * t));
    v = himc_quat_scale(v, 1 / t2);
    a = himc_quat_scale(a, 1 / t);
    c[0] = p.q, c[1] = p.rate, c[2] = half;
    c[3] = add4(add4(himc_quat_scale(x, 10), -4, v), 0.5, a);
    c[4] = himc_quat_scale(add4(add4(himc_quat_scale(x, -15), 7, v), -1, a), 1 / t);
    c[5] = himc_quat_scale(add4(add4(himc_quat_scale(x, 6), -3, v), 0.5, a), 1 / t2);
}

void himc_joint_course(const joint_state *from, const joint_state *to, double length,
                       joint_courses *courses, int lane)
{
    himc_quat c[6];
    find_course(from, to, length, c);
    for (int k = 0; k < 6; k++) {
        courses->c[k][0][lane] = c[k].w;
        courses->c[k][1][lane] = c[k].x;
        courses->c[k][2][lane] = c[k].y;
        courses->c[k][3][lane] = c[k].z;
    }
}

// Of `lanes` joints side by side; the compiler takes as many at once as the processor has places
// for. The coefficients come as those of joint_courses, the states go as joint_states.
static inline __attribute__((always_inline)) void
evaluate(const double *restrict c, const himc_powers *powers, int lanes, double *restrict q,
         double *restrict rate, double *restrict acceleration)
{
    const himc_powers p = *powers;
    for (int j = 0; j < lanes; j++) {
        double x[4], v[4], a[4];
#pragma GCC unroll 4
        for (int n = 0; n < 4; n++) {
            const double *k = c + n * lanes + j;
            double c2 = k[8 * lanes], c3 = k[12 * lanes], c4 = k[16 * lanes], c5 = k[20 * lanes];
            x[n] = k[0] + p.weight[0][1] * k[4 * lanes] + p.weight[0][2] * c2 +
                   p.weight[0][3] * c3 + p.weight[0][4] * c4 + p.weight[0][5] * c5;
            v[n] = k[4 * lanes] + p.weight[1][2] * c2 + p.weight[1][3] * c3 + p.weight[1][4] * c4 +
                   p.weight[1][5] * c5;
            a[n] = p.weight[2][2] * c2 + p.weight[2][3] * c3 + p.weight[2][4] * c4 +
                   p.weight[2][5] * c5;
        }
        double square = x[0] * x[0] + x[1] * x[1] + x[2] * x[2] + x[3] * x[3];
        double along = x[0] * v[0] + x[1] * v[1] + x[2] * v[2] + x[3] * v[3];
        double unit = 1 / sqrt(square), twice = 2 * unit * unit, slower = -twice * along;
#pragma GCC unroll 4
        for (int n = 0; n < 4; n++)
            q[n * lanes + j] = x[n] * unit;
#pragma GCC unroll 3
        for (int n = 1; n < 4; n++) {
            int y = n % 3 + 1, z = y % 3 + 1; // of v conj(x)
            double w = (v[n] * x[0] - v[0] * x[n] + v[z] * x[y] - v[y] * x[z]) * twice;
            rate[(n - 1) * lanes + j] = w;
            acceleration[(n - 1) * lanes + j] =
                (a[n] * x[0] - a[0] * x[n] + a[z] * x[y] - a[y] * x[z]) * twice + slower * w;
        }
    }
}

void himc_joint_courses_at(const joint_courses *courses, const himc_powers *powers,
                           joint_states *states)
{
    evaluate(courses->c[0][0], powers, HIMC_JOINT_LANES, states->q[0], states->rate[0],
             states->acceleration[0]);
}

joint_state himc_interpolate_joints(double time, double length, const joint_state *from,
                                    const joint_state *to)
{
    himc_quat c[6];
    joint_state s;
    himc_powers powers = himc_powers_at(time);
    find_course(from, to, length, c);
    evaluate(&c[0].w, &powers, 1, &s.q.w, &s.rate.x, &s.acceleration.x);
    return s;
}
