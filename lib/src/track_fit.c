/// track_fit.c: local cubic fits, x(u) = c0 + c1 u + c2 u^2 + c3 u^3 by least squares over the frames
/// within +-WINDOW seconds on the same side of every strike (Savitzky and Golay 1964), so noise is
/// smoothed before it is differentiated and no impact is smeared.
#include "track_fit.h"

#define WINDOW 0.025 // half width of the local fits (s)
#define EDGE 5       // frames of the one-sided fit beside a strike, less one

fit_window himc_fit_window(int k, int lo, int hi, int frames, double rate)
{
    int reach = (int)fmax(3, WINDOW * rate);
    fit_window w = {k - reach < lo ? lo : k - reach, k, k + reach > hi ? hi : k + reach, 4};
    if (k == lo || k == hi)
        w.order = 3; // a parabola is not thrown as far as a cubic
    if (k == hi && hi < frames - 1 && k - EDGE > lo)
        w.first = k - EDGE;
    if (k == lo && lo > 0 && k + EDGE < hi)
        w.last = k + EDGE;
    return w;
}

// normal equations of the powers of u and the three coordinates
static void normal_equations(const himc_vec3 *x, const fit_window *w, double a[4][7])
{
    for (int i = w->first; i <= w->last; i++) {
        double u = i - w->k, p[4] = {1, u, u * u, u * u * u}, v[3] = {x[i].x, x[i].y, x[i].z};
        for (int r = 0; r < 4; r++) {
            for (int c = 0; c < 4; c++)
                a[r][c] += p[r] * p[c];
            for (int c = 0; c < 3; c++)
                a[r][4 + c] += p[r] * v[c];
        }
    }
}

himc_target himc_fit(const himc_vec3 *x, fit_window w, double dt)
{
    double a[4][7] = {{0}}, c[4][3] = {{0}};
    int span = w.last - w.first, most = span >= 5 ? 4 : span >= 3 ? 3 : span >= 1 ? 2 : 1;
    int order = w.order < most ? w.order : most;
    normal_equations(x, &w, a);
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
