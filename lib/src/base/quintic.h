/// quintic.h: targets (position, velocity and acceleration of a point), sums of targets, and the
/// polynomial of fifth degree that joins two of them; all planned motion is made of these.
#ifndef HIMC_QUINTIC_H
#define HIMC_QUINTIC_H

#include "himc/vec.h"

/// A state of motion, such as the target of a drumstick tip.
typedef struct himc_target {
    himc_vec3 x; ///< position (m)
    himc_vec3 v; ///< velocity (m/s)
    himc_vec3 a; ///< acceleration (m/s^2)
} himc_target;

/// At rest at `x`.
HIMC_RT static inline himc_target himc_target_at_rest(himc_vec3 x)
{
    return (himc_target){x, {0, 0, 0}, {0, 0, 0}};
}

/// A motion along the unit vector `n`: distance (m), speed (m/s) and acceleration (m/s^2).
HIMC_RT static inline himc_target himc_target_along(himc_vec3 n, double x, double v, double a)
{
    return (himc_target){himc_vec3_scale(n, x), himc_vec3_scale(n, v), himc_vec3_scale(n, a)};
}

HIMC_RT static inline himc_target himc_target_add(himc_target a, himc_target b)
{
    return (himc_target){himc_vec3_add(a.x, b.x), himc_vec3_add(a.v, b.v), himc_vec3_add(a.a, b.a)};
}

HIMC_RT static inline himc_target himc_target_sub(himc_target a, himc_target b)
{
    return (himc_target){himc_vec3_sub(a.x, b.x), himc_vec3_sub(a.v, b.v), himc_vec3_sub(a.a, b.a)};
}

/// The target `dt` (s) later at constant acceleration.
HIMC_RT static inline himc_target himc_target_after(const himc_target *t, double dt)
{
    himc_target after = {himc_vec3_madd(himc_vec3_madd(t->x, dt, t->v), 0.5 * dt * dt, t->a),
                         himc_vec3_madd(t->v, dt, t->a), t->a};
    return after;
}

HIMC_RT static inline bool himc_target_finite(const himc_target *t)
{
    return himc_vec3_finite(t->x) && himc_vec3_finite(t->v) && himc_vec3_finite(t->a);
}

typedef struct himc_quintic {
    himc_vec3 c[6]; ///< coefficients of 1, t, ... t^5 (m, m/s, ...)
} himc_quintic;

/// The quintic from `from` at time 0 to `to` at `duration` (s, > 0): the three conditions at its
/// end give its three highest coefficients.
HIMC_RT static inline himc_quintic himc_quintic_make(const himc_target *from, const himc_target *to,
                                                     double duration)
{
    double t = duration, t2 = t * t;
    himc_vec3 half = himc_vec3_scale(from->a, 0.5);
    himc_vec3 x =
        himc_vec3_sub(to->x, himc_vec3_madd(himc_vec3_madd(from->x, t, from->v), t2, half));
    himc_vec3 v = himc_vec3_sub(to->v, himc_vec3_madd(from->v, t, from->a));
    himc_vec3 a = himc_vec3_sub(to->a, from->a);
    x = himc_vec3_scale(x, 1 / (t2 * t));
    v = himc_vec3_scale(v, 1 / t2);
    a = himc_vec3_scale(a, 1 / t);
    himc_quintic q = {{from->x, from->v, half}};
    q.c[3] = himc_vec3_madd(himc_vec3_madd(himc_vec3_scale(x, 10), -4, v), 0.5, a);
    q.c[4] = himc_vec3_madd(himc_vec3_madd(himc_vec3_scale(x, -15), 7, v), -1, a);
    q.c[5] = himc_vec3_madd(himc_vec3_madd(himc_vec3_scale(x, 6), -3, v), 0.5, a);
    q.c[4] = himc_vec3_scale(q.c[4], 1 / t);
    q.c[5] = himc_vec3_scale(q.c[5], 1 / t2);
    return q;
}

/// 10 / sqrt(3): peak acceleration of a quintic from rest to rest over the distance D in the time
/// T, in units of D / T^2 (Flash & Hogan 1985).
#define HIMC_MOVE_PEAK 5.774

/// Duration (s) of such a move over `distance` (m, not negative) with the peak acceleration `peak`
/// (m/s^2, > 0).
HIMC_RT static inline double himc_move_time(double distance, double peak)
{
    return sqrt(HIMC_MOVE_PEAK * distance / peak);
}

/// The state of the quintic at time `t` (s from its start).
HIMC_RT static inline himc_target himc_quintic_at(const himc_quintic *q, double t)
{
    // Horner's rule for the value and its first two derivatives; the second comes out halved
    himc_target s = {q->c[5], {0, 0, 0}, {0, 0, 0}};
    for (int i = 4; i >= 0; i--) {
        s.a = himc_vec3_madd(s.v, t, s.a);
        s.v = himc_vec3_madd(s.x, t, s.v);
        s.x = himc_vec3_madd(q->c[i], t, s.x);
    }
    s.a = himc_vec3_scale(s.a, 2);
    return s;
}

#endif
