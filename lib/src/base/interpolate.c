/// interpolate.c: quintic Hermite interpolation; one set of six basis values serves every channel.
///
/// With u = (t - t0) / T, the six basis quintics for position, velocity and acceleration at each
/// end, and their first two derivatives, are computed once. Joints are interpolated as
/// four-component quaternions q with q' = w q / 2 and q'' = (w' - |w|^2 / 2) q / 2 (w in the
/// parent's frame, as a pure quaternion), then normalised; w and w' come back as 2 vec(q' q*) /
/// |q|^2 and its derivative.
#include "base/interpolate.h"

// the basis quintics of x0, v0 and a0 at u = 0 and their derivatives; those of the other end are
// their mirror images
static void half_basis(double u, double h[3][3])
{
    double u2 = u * u, u3 = u2 * u, u4 = u3 * u, u5 = u4 * u;
    h[0][0] = 1 - 10 * u3 + 15 * u4 - 6 * u5;
    h[1][0] = -30 * u2 + 60 * u3 - 30 * u4;
    h[2][0] = -60 * u + 180 * u2 - 120 * u3;
    h[0][1] = u - 6 * u3 + 8 * u4 - 3 * u5;
    h[1][1] = 1 - 18 * u2 + 32 * u3 - 15 * u4;
    h[2][1] = -36 * u + 96 * u2 - 60 * u3;
    h[0][2] = 0.5 * (u2 - 3 * u3 + 3 * u4 - u5);
    h[1][2] = u - 4.5 * u2 + 6 * u3 - 2.5 * u4;
    h[2][2] = 1 - 9 * u + 18 * u2 - 10 * u3;
}

himc_interpolation himc_interpolate_make(double time, double length)
{
    himc_interpolation b;
    double near[3][3], far[3][3], power[3] = {1, length, length * length};
    half_basis(time / length, near);
    half_basis(1 - time / length, far);
    for (int d = 0; d < 3; d++)
        for (int k = 0; k < 3; k++) {
            double scale = power[k] / power[d];
            b.weight[d][k] = near[d][k] * scale;
            b.weight[d][3 + k] = ((d + k) % 2 ? -1 : 1) * far[d][k] * scale;
        }
    return b;
}

static himc_vec3 mix3(const double w[6], const himc_target *p, const himc_target *q)
{
    himc_vec3 v = himc_vec3_scale(p->x, w[0]);
    v = himc_vec3_madd(himc_vec3_madd(v, w[1], p->v), w[2], p->a);
    v = himc_vec3_madd(himc_vec3_madd(v, w[3], q->x), w[4], q->v);
    return himc_vec3_madd(v, w[5], q->a);
}

himc_target himc_interpolate_points(const himc_interpolation *b, const himc_target *from,
                                    const himc_target *to)
{
    return (himc_target){mix3(b->weight[0], from, to), mix3(b->weight[1], from, to),
                         mix3(b->weight[2], from, to)};
}

static himc_quat add4(himc_quat a, double s, himc_quat b)
{
    return (himc_quat){a.w + s * b.w, a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

static himc_quat pure(himc_vec3 v)
{
    return (himc_quat){0, v.x, v.y, v.z};
}

static joint_knot spin_of(himc_quat q, himc_vec3 w, himc_vec3 a)
{
    himc_quat second = himc_quat_mul(pure(a), q);
    second = add4(second, -0.5 * himc_vec3_dot(w, w), q);
    return (joint_knot){q, himc_quat_scale(himc_quat_mul(pure(w), q), 0.5),
                        himc_quat_scale(second, 0.5)};
}

static himc_quat mix4(const double w[6], const joint_knot *p, const joint_knot *q)
{
    himc_quat r = himc_quat_scale(p->q, w[0]);
    r = add4(add4(r, w[1], p->rate), w[2], p->second);
    r = add4(add4(r, w[3], q->q), w[4], q->rate);
    return add4(r, w[5], q->second);
}

void himc_interpolate_knots(const joint_state *from, const joint_state *to, joint_knot knot[2])
{
    double sign = himc_quat_dot(from->q, to->q) < 0 ? -1 : 1;
    knot[0] = spin_of(from->q, from->rate, from->acceleration);
    knot[1] = spin_of(himc_quat_scale(to->q, sign), to->rate, to->acceleration);
}

joint_state himc_interpolate_joint(const himc_interpolation *b, const joint_knot knot[2])
{
    const joint_knot *p = &knot[0], *q = &knot[1];
    himc_quat x = mix4(b->weight[0], p, q), v = mix4(b->weight[1], p, q),
              a = mix4(b->weight[2], p, q);
    double square = himc_quat_dot(x, x);
    himc_quat back = himc_quat_scale(himc_quat_conj(x), 2 / square);
    himc_vec3 w = himc_quat_vector(himc_quat_mul(v, back));
    return (joint_state){himc_quat_scale(x, 1 / sqrt(square)), w,
                         himc_vec3_madd(himc_quat_vector(himc_quat_mul(a, back)),
                                        -2 * himc_quat_dot(x, v) / square, w)};
}

joint_state himc_interpolate_joints(const himc_interpolation *b, const joint_state *from,
                                    const joint_state *to)
{
    joint_knot knot[2];
    himc_interpolate_knots(from, to, knot);
    return himc_interpolate_joint(b, knot);
}
