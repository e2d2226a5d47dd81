/// track_fit.c: local cubic fits, x(u) = c0 + c1 u + c2 u^2 + c3 u^3 by least squares over frames
/// within +-FIT_HALF_WIDTH seconds on the same side of every strike (Savitzky and Golay 1964), so
/// noise is smoothed before it is differentiated and no impact is smeared.
#include "track/track_fit.h"

// chosen: a blow at 5 m/s loses less than 2 % of its speed, at 0.2 mm of noise less than 5 %
// (tests/track/test_track.c)
#define FIT_HALF_WIDTH 0.025    // of the local fits (s)
#define EDGE_FRAMES 6           // of the one-sided fit beside a strike, at least ...
#define LONGEST_EDGE_TIME 0.048 // ... and for a noisy capture up to so many seconds ...
#define EDGE_RATE_ERROR 0.03    // ... until the error of its rate is that small (m/s)
#define LEAST_FIT_FRAMES 3      // on each side
#define FAR_SIDE_SHARE 1.5 // edges that a noisy cubic beside a strike has on both sides together

// the rate at the end of a parabola through n points has the error sqrt(192 / n^3) noise / dt
int himc_fit_edge(double noise, double rate)
{
    double n = cbrt(192 * pow(noise * rate / EDGE_RATE_ERROR, 2)),
           most = fmax(EDGE_FRAMES, LONGEST_EDGE_TIME * rate);
    return (int)fmin(fmax(n, EDGE_FRAMES), most);
}

fit_window himc_fit_window(int k, int lo, int hi, const fit_series *series)
{
    int reach = (int)fmax(LEAST_FIT_FRAMES, FIT_HALF_WIDTH * series->rate), edge = series->edge - 1;
    // beside a strike a noisy cubic has more frames on its far side
    if (edge >= EDGE_FRAMES && fmin(k - lo, hi - k) < reach)
        reach = (int)fmax(reach, FAR_SIDE_SHARE * edge - fmin(k - lo, hi - k));
    fit_window w = {k - reach < lo ? lo : k - reach, k, k + reach > hi ? hi : k + reach, 4, reach};
    if (k == lo || k == hi) { // at its end a parabola errs less than a cubic
        w.order = 3;
        w.reach = 0;
    }
    if (k == hi && hi < series->frames - 1 && k - edge > lo)
        w.first = k - edge;
    if (k == lo && lo > 0 && k + edge < hi)
        w.last = k + edge;
    return w;
}

himc_target himc_fit(const himc_vec3 *x, fit_window w, double dt)
{
    double a[4][7] = {{0}}, c[4][3] = {{0}};
    int span = w.last - w.first, most = span >= 5 ? 4 : span >= 3 ? 3 : span >= 1 ? 2 : 1;
    int order = w.order < most ? w.order : most;
    // the normal equations of the powers of u and the three coordinates. Weights fall to zero at
    // the window's ends: else each frame that enters or leaves would shake the fit, and with it the
    // acceleration between neighbouring frames (Cleveland 1979)
    for (int i = w.first; i <= w.last; i++) {
        double u = i - w.k, p[4] = {1, u, u * u, u * u * u}, v[3] = {x[i].x, x[i].y, x[i].z};
        double share = w.reach > 0 ? u / (w.reach + 1) : 0, bell = 1 - share * share;
        double weight = bell * bell;
        for (int r = 0; r < 4; r++) {
            for (int k = 0; k < 4; k++)
                a[r][k] += weight * p[r] * p[k];
            for (int k = 0; k < 3; k++)
                a[r][4 + k] += weight * p[r] * v[k];
        }
    }
    for (int r = 0; r < order; r++) {
        if (fabs(a[r][r]) < 1e-12)
            return (himc_target){.x = x[w.k]};
        for (int s = 0; s < order; s++) {
            double f = s == r ? 0 : a[s][r] / a[r][r];
            for (int k = 0; k < 7; k++)
                a[s][k] -= f * a[r][k];
        }
    }
    for (int r = 0; r < order; r++)
        for (int d = 0; d < 3; d++)
            c[r][d] = a[r][4 + d] / a[r][r];
    return (himc_target){himc_vec3_make(c[0][0], c[0][1], c[0][2]),
                         himc_vec3_scale(himc_vec3_make(c[1][0], c[1][1], c[1][2]), 1 / dt),
                         himc_vec3_scale(himc_vec3_make(c[2][0], c[2][1], c[2][2]), 2 / (dt * dt))};
}
