/// nudge.c: a bump of two quintics, from rest to rest: 10 s^3 - 15 s^4 + 6 s^5 up, the same down.
/// Its value, velocity and acceleration are zero at both ends, and its velocity and acceleration at
/// the top, so its two sides may have different lengths.
#include "track/nudge.h"

// value and derivatives of the bump whose sides last `before` and `after`; 0 where a side has no
// length
static void bump(double t, double before, double after, double out[3])
{
    double side = t < 0 ? before : after, s = side > 0 ? 1 - fabs(t) / side : 0,
           sign = t < 0 ? 1 : -1;
    bool in = s > 0 && before > 0 && after > 0;
    out[0] = in ? s * s * s * (10 + s * (-15 + 6 * s)) : 0;
    out[1] = in ? sign * 30 * s * s * (1 - s) * (1 - s) / side : 0;
    out[2] = in ? 60 * s * (1 - s) * (1 - 2 * s) / (side * side) : 0;
}

himc_target himc_nudge_at(const himc_nudge *n, double t)
{
    double across[3], up[3];
    bump(t - n->time, n->span, n->span, across);
    bump(t - n->time, n->rise, n->fall, up);
    himc_vec3 *part[3], w = n->way;
    himc_target s;
    part[0] = &s.x, part[1] = &s.v, part[2] = &s.a;
    for (int i = 0; i < 3; i++)
        *part[i] = himc_vec3_make(across[i] * w.x, across[i] * w.y, up[i] * w.z);
    return s;
}
