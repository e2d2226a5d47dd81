/// christian_drum.h: the 26 inch timpano of Christian et al. (1984) for tests of air: solved by
/// tools/research/air, and its frequencies by an independent solution.
#ifndef HIMC_TESTS_CHRISTIAN_DRUM_H
#define HIMC_TESTS_CHRISTIAN_DRUM_H

#include "tools/research/air/galerkin.h"

#include "unity.h"

#include <math.h>

#define COUNT(array) ((int)(sizeof(array) / sizeof *(array)))
#define T60 6.907755278982137 // ln 1000

typedef struct expected {
    int m, n;
    double value;
} expected;

// Christian et al. 1984: 26 inches
static const double A = 0.328, SIGMA = 0.2653, V = 0.14;

// with the table's loss in the kettle; INFINITY for `quality` has none
static inline himc_air_problem problem_of(double a, double tension, double volume)
{
    return (himc_air_problem){.tension = tension / (SIGMA * HIMC_AIR_SPEED * HIMC_AIR_SPEED),
                              .loading = HIMC_AIR_DENSITY * a / SIGMA,
                              .depth = volume / (HIMC_PI * a * a * a),
                              .quality = HIMC_AIR_KETTLE_QUALITY};
}

// computed once each
static inline const himc_air_order *order_of(int m)
{
    static himc_air_order order[21];
    static bool made[21];
    if (!made[m])
        himc_air_order_make(&order[m], m);
    made[m] = true;
    return &order[m];
}

// resonance (m, n) of Christian's drum over a kettle without loss
static inline himc_air_root christian(int m, int n)
{
    static himc_air_root root[21][HIMC_AIR_RANKS];
    himc_error error;
    himc_air_problem problem = problem_of(A, 3990, V);
    problem.quality = INFINITY;
    bool known = root[m][0].x > 0;
    known = known || himc_air_solve(order_of(m), &problem, HIMC_AIR_RANKS, root[m], &error);
    TEST_ASSERT_TRUE_MESSAGE(known, error.text);
    return root[m][n - 1];
}

// its frequency (Hz)
static inline double pitch(himc_air_root root)
{
    return root.x * HIMC_AIR_SPEED / (2 * HIMC_PI * A);
}

static inline double cents(double a, double b)
{
    return 1200 * log2(a / b);
}

// its frequencies, solved independently (Hz)
static const expected PITCH[] = {{0, 1, 127.6}, {1, 1, 150.9}, {2, 1, 227.7}, {0, 2, 253.6},
                                 {3, 1, 300.2}, {1, 2, 311.1}, {4, 1, 370.6}, {2, 2, 412.0},
                                 {0, 3, 416.6}, {5, 1, 439.8}, {6, 1, 508.1}};

#endif
