/// bank_kernel.h: the loops over all oscillators of a bank, for several vector units.
///
/// Every version does the same additions and multiplications in the same order: what a wider unit
/// does in one instruction, a narrower one does in several. None fuses a product with a sum. So all
/// versions give the same bits. Sums over oscillators have eight lanes, lane k with the oscillators
/// k, k + 8, ...; lengths are multiples of 8, and arrays are aligned to 64 bytes.
#ifndef HIMC_BANK_KERNEL_H
#define HIMC_BANK_KERNEL_H

#define HIMC_BANK_LANES 8  ///< oscillators at once, samples at once
#define HIMC_BANK_PASS 64  ///< samples that are computed ahead from one state
#define HIMC_BANK_ALIKE 3  ///< readouts that share their waves
#define HIMC_BANK_ROWS 8   ///< points that are read and pushed together
#define HIMC_BANK_TABLE 32 ///< numbers of an oscillator's table

/// What turns two weights and the state at the start of a pass into samples.
typedef struct himc_bank_waves {
    double *a, *b;       ///< sample n is the sum of C_n a + S_n b
    const double *table; ///< C_1 .. C_8, S_1 .. S_8, C_9 .. C_16, S_9 .. S_16 of each oscillator
    const double *twice; ///< 2 C_8
    const double *fall;  ///< C_8^2 + S_8^2
} himc_bank_waves;

typedef struct himc_bank_kernel {
    const char *name;
    /// p, s = c p + w s, c s - w p
    void (*rotate)(double *p, double *s, const double *c, const double *w, int length);
    /// a, b = rp p + rs s, rp s - rs p
    void (*weigh)(const himc_bank_waves *waves, const double *rp, const double *rs, const double *p,
                  const double *s, int length);
    /// The same with rp + more by in place of rp. Returns sum more p.
    double (*weigh_more)(const himc_bank_waves *waves, const double *rp, const double *rs,
                         const double *more, double by, const double *p, const double *s,
                         int length);
    /// kick = per_mass g with g = on_p p; sum[0], sum[1] = sum g (s - damp p), sum g kick
    void (*stretch)(double *kick, const double *on_p, const double *per_mass, const double *damp,
                    const double *p, const double *s, int length, double *sum);
    /// Turns x = tight p and y = s - damp p by the angle rate by (to its third power), with
    /// slack = 1/tight.
    void (*turn)(double *p, double *s, const double *rate, const double *tight, const double *slack,
                 const double *damp, double by, int length);
    /// x += y by
    void (*add)(double *x, const double *y, double by, int length);
    /// p += on_p (shape force), s += on_s (shape force)
    void (*push)(double *p, double *s, const double *on_p, const double *on_s, const double *shape,
                 double force, int length);
    /// sum x y
    double (*dot)(const double *x, const double *y, int length);
    /// sum[k] = sum row[k] (per p) for HIMC_BANK_ROWS rows, `stride` apart
    void (*read_rows)(const double *rows, int stride, const double *per, const double *p,
                      int length, double *sum);
    /// push with the shape sum force[k] row[k]
    void (*push_rows)(double *p, double *s, const double *on_p, const double *on_s,
                      const double *rows, int stride, const double *force, int length);
    /// sum (rp p + rs s)
    double (*read)(const double *rp, const double *rs, const double *p, const double *s,
                   int length);
    /// sum[k] = sum gain[k] ((rp + more by) p + rs s) for HIMC_BANK_ALIKE gains
    void (*read_alike)(const double *rp, const double *rs, const double *more, double by,
                       const double *const *gain, const double *p, const double *s, int length,
                       double *sum);
    /// sum (s - damp p)^2 + (tight p)^2
    double (*square)(const double *p, const double *s, const double *damp, const double *tight,
                     int length);
    /// v, u = c v - w u, w v + c u with v and u = s - damp p of i and i + distance, c and w of b =
    /// root sign by as in bank_cascade.c, for i = 0 .. distance - 1, 2 distance .. 3 distance - 1,
    /// ... as far as i + distance < length, which need not be a multiple of 8.
    void (*scatter)(double *s, const double *p, const double *damp, const double *root,
                    const double *sign, double by, int distance, int length);
    /// adds samples 1 .. n to `out`, n being 8, 16, 32 or HIMC_BANK_PASS
    void (*ahead)(const himc_bank_waves *waves, int length, int n, double *out);
    /// The same to each of several, times its gain of each oscillator.
    void (*ahead_alike)(const himc_bank_waves *waves, const double *const *gain, int length, int n,
                        double *const *out);
} himc_bank_kernel;

/// Version `index` of those this machine can run, the fastest last; NULL past the last.
const himc_bank_kernel *himc_bank_kernel_version(int index);
/// The fastest of them.
const himc_bank_kernel *himc_bank_kernel_fastest(void);

#endif
