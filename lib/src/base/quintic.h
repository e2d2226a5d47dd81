/// quintic.h: the polynomial of fifth degree in space that connects two states of position,
/// velocity and acceleration; all planned motion consists of such quintics.
#ifndef HIMC_QUINTIC_H
#define HIMC_QUINTIC_H

#include "himc/vec.h"

/// A state of motion, such as the target of a drumstick tip.
typedef struct himc_target {
    himc_vec3 x; ///< position (m)
    himc_vec3 v; ///< velocity (m/s)
    himc_vec3 a; ///< acceleration (m/s^2)
} himc_target;

typedef struct himc_quintic {
    himc_vec3 c[6]; ///< coefficients of 1, t, ... t^5 (m, m/s, ...)
} himc_quintic;

/// The quintic from `from` at time 0 to `to` at time `duration` (s, above 0).
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
/// (m/s^2, above 0).
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
