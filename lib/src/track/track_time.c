/// track_time.c: a quintic leads the take's time from a stand to the usual rate, and back.
///
/// From rate 0 at -R/2 to rate 1 at R/2 in the time R the quintic passes over R/2 of the take, so
/// that between the two ramps the take's time is the time itself.
#include "track/track_time.h"

#define WARP_BISECTIONS 50 // from 0.2 s to rounding

void himc_track_warp(double length, double t, double at[3])
{
    double half = 0.5 * HIMC_TRACK_RAMP;
    himc_target from = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, to = {{half, 0, 0}, {1, 0, 0}, {0, 0, 0}};
    double u = t + half;
    at[0] = t;
    at[1] = 1;
    at[2] = 0;
    if (t > half && t < length - half)
        return;
    if (t >= length - half) {
        from = (himc_target){{length - half, 0, 0}, {1, 0, 0}, {0, 0, 0}};
        to = (himc_target){{length, 0, 0}, {0, 0, 0}, {0, 0, 0}};
        u = t - (length - half);
    }
    himc_quintic q = himc_quintic_make(&from, &to, HIMC_TRACK_RAMP);
    himc_target s = himc_quintic_at(&q, fmin(fmax(u, 0), HIMC_TRACK_RAMP));
    at[0] = s.x.x;
    at[1] = s.v.x;
    at[2] = s.a.x;
}

double himc_track_unwarp(double length, double taken)
{
    double lo = taken - HIMC_TRACK_RAMP, hi = taken + HIMC_TRACK_RAMP, at[3];
    himc_track_warp(length, taken, at);
    if (at[0] == taken && at[1] == 1)
        return taken;
    for (int i = 0; i < WARP_BISECTIONS; i++) {
        double middle = 0.5 * (lo + hi);
        himc_track_warp(length, middle, at);
        if (at[0] < taken)
            lo = middle;
        else
            hi = middle;
    }
    return hi;
}
