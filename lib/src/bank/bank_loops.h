/// bank_loops.h: the loops of bank_kernel.h for one vector unit. Included by bank_kernel.c once for
/// each, with WIDTH the doubles of its vectors, TARGET the attribute that lets the compiler use it,
/// NAMED(x) the name of x in this version.
///
/// The arrays may alias as the two loops that change a state in place need it: each element is read
/// before it is written.

// one vector of the unit
typedef double NAMED(vec) __attribute__((vector_size(WIDTH * sizeof(double)), may_alias));
#define VEC NAMED(vec)
// one at any place
typedef double NAMED(loose)
    __attribute__((vector_size(WIDTH * sizeof(double)), may_alias, aligned(sizeof(double))));
#define LOOSE NAMED(loose)
#define PARTS (HIMC_BANK_LANES / WIDTH) // vectors of eight lanes
#define TOGETHER (WIDTH == 8 ? 4 : 2)   // oscillators that the unit has registers for

TARGET static double NAMED(total)(const VEC *sum)
{
    const double *x = (const double *)sum;
    return ((x[0] + x[4]) + (x[2] + x[6])) + ((x[1] + x[5]) + (x[3] + x[7]));
}

TARGET static void NAMED(rotate)(double *p, double *s, const double *c, const double *w, int length)
{
    for (int i = 0; i < length; i += WIDTH) {
        VEC *vp = (VEC *)(p + i), *vs = (VEC *)(s + i);
        VEC vc = *(const VEC *)(c + i), vw = *(const VEC *)(w + i);
        VEC next = vc * *vp + vw * *vs;
        *vs = vc * *vs - vw * *vp;
        *vp = next;
    }
}

TARGET static void NAMED(weigh)(const himc_bank_waves *waves, const double *rp, const double *rs,
                                const double *p, const double *s, int length)
{
    for (int i = 0; i < length; i += WIDTH) {
        VEC vp = *(const VEC *)(p + i), vs = *(const VEC *)(s + i);
        VEC up = *(const VEC *)(rp + i), us = *(const VEC *)(rs + i);
        *(VEC *)(waves->a + i) = up * vp + us * vs;
        *(VEC *)(waves->b + i) = up * vs - us * vp;
    }
}

TARGET static double NAMED(weigh_more)(const himc_bank_waves *waves, const double *rp,
                                       const double *rs, const double *more, double by,
                                       const double *p, const double *s, int length)
{
    VEC sum[PARTS] = {{0}};
    for (int i = 0; i < length; i += HIMC_BANK_LANES)
        for (int k = 0; k < PARTS; k++) {
            int at = i + k * WIDTH;
            VEC vp = *(const VEC *)(p + at), vs = *(const VEC *)(s + at);
            VEC f = *(const VEC *)(more + at), up = *(const VEC *)(rp + at) + f * by;
            VEC us = *(const VEC *)(rs + at);
            *(VEC *)(waves->a + at) = up * vp + us * vs;
            *(VEC *)(waves->b + at) = up * vs - us * vp;
            sum[k] += f * vp;
        }
    return NAMED(total)(sum);
}

TARGET static void NAMED(stretch)(double *kick, const double *on_p, const double *per_mass,
                                  const double *damp, const double *p, const double *s, int length,
                                  double *sum)
{
    VEC power[PARTS] = {{0}}, norm[PARTS] = {{0}};
    for (int i = 0; i < length; i += HIMC_BANK_LANES)
        for (int k = 0; k < PARTS; k++) {
            int at = i + k * WIDTH;
            VEC vp = *(const VEC *)(p + at), g = *(const VEC *)(on_p + at) * vp;
            VEC v = *(const VEC *)(s + at) - *(const VEC *)(damp + at) * vp;
            VEC b = *(const VEC *)(per_mass + at) * g;
            *(VEC *)(kick + at) = b;
            power[k] += g * v;
            norm[k] += g * b;
        }
    sum[0] = NAMED(total)(power);
    sum[1] = NAMED(total)(norm);
}

TARGET static void NAMED(turn)(double *p, double *s, const double *rate, const double *tight,
                               const double *slack, const double *damp, double by, int length)
{
    for (int i = 0; i < length; i += WIDTH) {
        VEC vp = *(VEC *)(p + i), d = *(const VEC *)(damp + i);
        VEC x = *(const VEC *)(tight + i) * vp, y = *(VEC *)(s + i) - d * vp;
        VEC half = *(const VEC *)(rate + i) * (0.5 * by), size = 1 / (1 + half * half);
        VEC c = (1 - half * half) * size, w = 2 * half * size;
        vp = (c * x + w * y) * *(const VEC *)(slack + i);
        *(VEC *)(p + i) = vp;
        *(VEC *)(s + i) = c * y - w * x + d * vp;
    }
}

TARGET static void NAMED(add)(double *x, const double *y, double by, int length)
{
    for (int i = 0; i < length; i += WIDTH)
        *(VEC *)(x + i) += *(const VEC *)(y + i) * by;
}

TARGET static void NAMED(push)(double *p, double *s, const double *on_p, const double *on_s,
                               const double *shape, double force, int length)
{
    for (int i = 0; i < length; i += WIDTH) {
        VEC f = *(const VEC *)(shape + i) * force;
        *(VEC *)(p + i) += *(const VEC *)(on_p + i) * f;
        *(VEC *)(s + i) += *(const VEC *)(on_s + i) * f;
    }
}

TARGET static double NAMED(dot)(const double *x, const double *y, int length)
{
    VEC sum[PARTS] = {{0}};
    for (int i = 0; i < length; i += HIMC_BANK_LANES)
        for (int k = 0; k < PARTS; k++)
            sum[k] += *(const VEC *)(x + i + k * WIDTH) * *(const VEC *)(y + i + k * WIDTH);
    return NAMED(total)(sum);
}

TARGET static void NAMED(read_rows)(const double *rows, int stride, const double *per,
                                    const double *p, int length, double *sum)
{
    VEC part[HIMC_BANK_ROWS][PARTS] = {{{0}}};
    for (int i = 0; i < length; i += HIMC_BANK_LANES)
        for (int k = 0; k < PARTS; k++) {
            int at = i + k * WIDTH;
            VEC q = *(const VEC *)(per + at) * *(const VEC *)(p + at);
            for (int r = 0; r < HIMC_BANK_ROWS; r++)
                part[r][k] += *(const VEC *)(rows + r * stride + at) * q;
        }
    for (int r = 0; r < HIMC_BANK_ROWS; r++)
        sum[r] = NAMED(total)(part[r]);
}

TARGET static void NAMED(push_rows)(double *p, double *s, const double *on_p, const double *on_s,
                                    const double *rows, int stride, const double *force, int length)
{
    for (int i = 0; i < length; i += WIDTH) {
        VEC f = {0};
        for (int r = 0; r < HIMC_BANK_ROWS; r++)
            f += *(const VEC *)(rows + r * stride + i) * force[r];
        *(VEC *)(p + i) += *(const VEC *)(on_p + i) * f;
        *(VEC *)(s + i) += *(const VEC *)(on_s + i) * f;
    }
}

TARGET static double NAMED(read)(const double *rp, const double *rs, const double *p,
                                 const double *s, int length)
{
    VEC sum[PARTS] = {{0}};
    for (int i = 0; i < length; i += HIMC_BANK_LANES)
        for (int k = 0; k < PARTS; k++) {
            int at = i + k * WIDTH;
            sum[k] += *(const VEC *)(rp + at) * *(const VEC *)(p + at) +
                      *(const VEC *)(rs + at) * *(const VEC *)(s + at);
        }
    return NAMED(total)(sum);
}

TARGET static void NAMED(read_alike)(const double *rp, const double *rs, const double *more,
                                     double by, const double *const *gain, const double *p,
                                     const double *s, int length, double *sum)
{
    VEC part[HIMC_BANK_ALIKE][PARTS] = {{{0}}};
    for (int i = 0; i < length; i += HIMC_BANK_LANES)
        for (int k = 0; k < PARTS; k++) {
            int at = i + k * WIDTH;
            VEC up = *(const VEC *)(rp + at) + *(const VEC *)(more + at) * by;
            VEC u = up * *(const VEC *)(p + at) + *(const VEC *)(rs + at) * *(const VEC *)(s + at);
            for (int r = 0; r < HIMC_BANK_ALIKE; r++)
                part[r][k] += *(const VEC *)(gain[r] + at) * u;
        }
    for (int r = 0; r < HIMC_BANK_ALIKE; r++)
        sum[r] = NAMED(total)(part[r]);
}

TARGET static double NAMED(square)(const double *p, const double *s, const double *damp,
                                   const double *tight, int length)
{
    VEC sum[PARTS] = {{0}};
    for (int i = 0; i < length; i += HIMC_BANK_LANES)
        for (int k = 0; k < PARTS; k++) {
            int at = i + k * WIDTH;
            VEC vp = *(const VEC *)(p + at), u = *(const VEC *)(tight + at) * vp;
            VEC v = *(const VEC *)(s + at) - *(const VEC *)(damp + at) * vp;
            sum[k] += v * v + u * u;
        }
    return NAMED(total)(sum);
}

// pairs of one stretch, i from `first` to `end`
#define EXCHANGE(real, i, j)                                                               \
    do {                                                                                   \
        real lost_i = *(const real *)(damp + (i)) * *(const real *)(p + (i));              \
        real lost_j = *(const real *)(damp + (j)) * *(const real *)(p + (j));              \
        real v = *(const real *)(s + (i)) - lost_i, u = *(const real *)(s + (j)) - lost_j; \
        real b = *(const real *)(root + (i)) * *(const real *)(sign + (i)) * by;           \
        real size = 1 / (1 + b * b), c = (1 - b * b) * size, w = 2 * b * size;             \
        *(real *)(s + (i)) = c * v - w * u + lost_i;                                       \
        *(real *)(s + (j)) = w * v + c * u + lost_j;                                       \
    } while (0)

TARGET static void NAMED(scatter)(double *s, const double *p, const double *damp,
                                  const double *root, const double *sign, double by, int distance,
                                  int length)
{
    for (int first = 0; first + distance < length; first += 2 * distance) {
        int most = length - distance, end = first + distance < most ? first + distance : most;
        int i = first;
        for (; i + WIDTH <= end; i += WIDTH)
            EXCHANGE(LOOSE, i, i + distance);
        for (; i < end; i++)
            EXCHANGE(double, i, i + distance);
    }
}

// A few oscillators at a time, which do not wait for each other, one part of the eight samples
// after the other: so the sums of a whole pass stay in registers. They are added in pairs. `eights`
// is a constant in each of the four calls.
TARGET static inline __attribute__((always_inline)) void
NAMED(look)(const himc_bank_waves *waves, int length, int eights, double *out)
{
    for (int k = 0; k < PARTS; k++) {
        VEC sum[HIMC_BANK_PASS / HIMC_BANK_LANES], before[TOGETHER], now[TOGETHER];
        const VEC *x = (const VEC *)waves->table + k;
        for (int n = 0; n < eights; n++)
            memcpy(&sum[n], out + n * HIMC_BANK_LANES + k * WIDTH, sizeof sum[n]);
        for (int i = 0; i < length; i += TOGETHER) {
#pragma GCC unroll 4
            for (int m = 0; m < TOGETHER; m++) {
                double a = waves->a[i + m], b = waves->b[i + m];
                before[m] = a * x[0] + b * x[PARTS];
                if (eights > 1)
                    now[m] = a * x[2 * PARTS] + b * x[3 * PARTS];
                x += 4 * PARTS;
            }
#pragma GCC unroll 2
            for (int m = 0; m < TOGETHER; m += 2) {
                sum[0] += before[m] + before[m + 1];
                if (eights > 1)
                    sum[1] += now[m] + now[m + 1];
            }
#pragma GCC unroll 8
            for (int n = 2; n < eights; n++) {
#pragma GCC unroll 4
                for (int m = 0; m < TOGETHER; m++) {
                    VEC next = waves->twice[i + m] * now[m] - waves->fall[i + m] * before[m];
                    before[m] = now[m];
                    now[m] = next;
                }
#pragma GCC unroll 2
                for (int m = 0; m < TOGETHER; m += 2)
                    sum[n] += now[m] + now[m + 1];
            }
        }
        for (int n = 0; n < eights; n++)
            memcpy(out + n * HIMC_BANK_LANES + k * WIDTH, &sum[n], sizeof sum[n]);
    }
}

TARGET static void NAMED(ahead)(const himc_bank_waves *waves, int length, int n, double *out)
{
    if (n == HIMC_BANK_LANES)
        NAMED(look)(waves, length, 1, out);
    else if (n == 2 * HIMC_BANK_LANES)
        NAMED(look)(waves, length, 2, out);
    else if (n == 4 * HIMC_BANK_LANES)
        NAMED(look)(waves, length, 4, out);
    else
        NAMED(look)(waves, length, HIMC_BANK_PASS / HIMC_BANK_LANES, out);
}

// The same for waves that several readouts share, each with its own gains: the waves themselves
// are computed once.
TARGET static inline __attribute__((always_inline)) void
NAMED(look_alike)(const himc_bank_waves *waves, const double *const *gain, int length, int eights,
                  double *const *out)
{
    for (int k = 0; k < PARTS; k++) {
        VEC sum[HIMC_BANK_ALIKE][HIMC_BANK_PASS / HIMC_BANK_LANES], before[2], now[2], next[2];
        const VEC *x = (const VEC *)waves->table + k;
        for (int r = 0; r < HIMC_BANK_ALIKE; r++)
            for (int n = 0; n < eights; n++)
                memcpy(&sum[r][n], out[r] + n * HIMC_BANK_LANES + k * WIDTH, sizeof **sum);
        for (int i = 0; i < length; i += 2) {
#pragma GCC unroll 2
            for (int m = 0; m < 2; m++) {
                double a = waves->a[i + m], b = waves->b[i + m];
                before[m] = a * x[0] + b * x[PARTS];
                now[m] = a * x[2 * PARTS] + b * x[3 * PARTS];
                x += 4 * PARTS;
            }
#pragma GCC unroll 8
            for (int n = 0; n < eights; n++) {
#pragma GCC unroll 3
                for (int r = 0; r < HIMC_BANK_ALIKE; r++)
                    sum[r][n] += gain[r][i] * before[0] + gain[r][i + 1] * before[1];
#pragma GCC unroll 2
                for (int m = 0; m < 2; m++) {
                    if (n + 2 < eights)
                        next[m] = waves->twice[i + m] * now[m] - waves->fall[i + m] * before[m];
                    before[m] = now[m];
                    now[m] = next[m];
                }
            }
        }
        for (int r = 0; r < HIMC_BANK_ALIKE; r++)
            for (int n = 0; n < eights; n++)
                memcpy(out[r] + n * HIMC_BANK_LANES + k * WIDTH, &sum[r][n], sizeof **sum);
    }
}

TARGET static void NAMED(ahead_alike)(const himc_bank_waves *waves, const double *const *gain,
                                      int length, int n, double *const *out)
{
    if (n == HIMC_BANK_LANES)
        NAMED(look_alike)(waves, gain, length, 1, out);
    else if (n == 2 * HIMC_BANK_LANES)
        NAMED(look_alike)(waves, gain, length, 2, out);
    else if (n == 4 * HIMC_BANK_LANES)
        NAMED(look_alike)(waves, gain, length, 4, out);
    else
        NAMED(look_alike)(waves, gain, length, HIMC_BANK_PASS / HIMC_BANK_LANES, out);
}

#undef EXCHANGE
#undef LOOSE
#undef VEC
#undef PARTS
#undef TOGETHER
#undef WIDTH
#undef TARGET
#undef NAMED
