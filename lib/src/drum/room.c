/// room.c: walls, as a network of delays without loss, and a loss in each.
///
/// 32 delays of 16 to 77 ms, the ways between walls 6 to 26 m apart. What leaves them is
/// reflected, x = A y, by an orthogonal A (Householder's reflection, then each to the next delay:
/// Jot & Chaigne 1991), so no energy comes or goes; it passes a filter y = keep y + take x on its
/// way, whose gain is at most 10^(-3 d/T60) for the delay d at every frequency. So the energy in
/// the room only falls, by 60 dB in T60 below 1 kHz and faster above, whatever the delays. While
/// the walls change, keep and take are means of two such filters: their gain is below 1, too.
///
/// So many, because the tail of a note rings at the modes next to it. The sum of all delays, 1.2 s,
/// is the number of modes per hertz. Tails are 8 cents RMS beside their pitch (test_room), with 16
/// delays 15; in a hall of 1500 m3, which has 14 modes per hertz at 180 Hz, 8.
///
/// Level. A source that sends p at 1 m fills a room of volume V with p^2 16 pi/(D A), D its
/// directivity and A = 0.161 V/T60 its absorption (Sabine). A timpano sends D = 2 to 6 times its
/// mean in the plane of its head, where listeners are. What enters the network, 1 in each delay,
/// leaves it sum g^2/(1 - g^2) times.
///
/// The two ears add the delays with signs that are orthogonal, so they hear nothing alike, at any
/// frequency. In a diffuse field ears 17 cm apart hear low tones alike; microphones in a hall,
/// which recordings are made with, do not (chosen: as these).
#include "drum/room.h"

#include <math.h>
#include <string.h>

// Of 3,000 rooms tried the most even: a hall's modes lift some notes and swallow others, and this
// one leaves the four lowest partials of each semitone from C2 to A3 within 4 dB (SD 1.8) of the
// hall's mean, at the usual listener's; a plain geometric row of 17 to 71 ms within 9 (2.5).
#define SHORTEST 0.0163 // (s) of a delay; a room of 6 by 26 m
#define LONGEST (HIMC_ROOM_LONGEST * 1e-3)
#define BEND 1.24       // the row's: 1 is geometric
#define HIGH 4000.0     // (Hz) where ...
#define HIGH_PART 0.6   // ... T60 is so much of itself; chosen: curtains and air
#define SABINE 0.161    // (s/m)
#define DIRECTIVITY 4.0 // chosen: between a monopole's in a baffle, 2, and a dipole's, 6
#define FADE 0.005      // (s) chosen: no click
#define CACHE_LINE 8    // doubles
#define FORGOTTEN 5.0   // T60s until it is empty; chosen: -300 dB
#define LEAST_GAIN 0.1  // g that counts for the level; chosen: all do from T60 = 0.21 s on

// of what enters the delay after each: a Walsh function, orthogonal to those at the ears
static const double ENTERING[HIMC_ROOM_LINES] = {-1, -1, 1,  1,  -1, -1, 1,  1,  -1, -1, 1,
                                                 1,  -1, -1, 1,  1,  -1, -1, 1,  1,  -1, -1,
                                                 1,  1,  -1, -1, 1,  1,  -1, -1, 1,  1};

static himc_room_form form_of(const himc_walls *walls, const int *delay, double rate)
{
    himc_room_form f;
    double loss = 0, t60 = walls->seconds, angle = 2 * HIMC_PI * fmin(HIGH, 0.4 * rate) / rate;
    for (int l = 0; l < HIMC_ROOM_LINES; l++) {
        // the filter of a wall after the delay: (1 - p)^2 = b |1 - p exp(-i w)|^2
        double d = delay[l] / rate, ratio = pow(10, -3 * d / t60 * (1 / HIGH_PART - 1));
        double b = ratio * ratio, s = 1 - b, c = 1 - b * cos(angle);
        double p = (c - sqrt((c - s) * (c + s))) / s;
        f.keep[l] = p;
        f.take[l] = pow(10, -3 * d / t60) * (1 - p);
        // of a shorter T60 the longest ways, which nobody hears, would count for all
        double gain = fmax(f.take[l] / (1 - f.keep[l]), LEAST_GAIN);
        loss += (1 / (gain * gain) - 1) / HIMC_ROOM_LINES;
    }
    double absorption = SABINE * walls->volume / t60;
    double filled = 16 * HIMC_PI / (DIRECTIVITY * absorption);
    f.out = sqrt(filled * loss / HIMC_ROOM_LINES);
    return f;
}

static double mean(double a, double b, double part)
{
    return a + part * (b - a);
}

// the form now
static himc_room_form present(const himc_room *r)
{
    himc_room_form f;
    double part = r->faded * r->faded * (3 - 2 * r->faded);
    f.out = mean(r->from.out, r->to.out, part);
    for (int l = 0; l < HIMC_ROOM_LINES; l++) {
        f.take[l] = mean(r->from.take[l], r->to.take[l], part);
        f.keep[l] = mean(r->from.keep[l], r->to.keep[l], part);
    }
    return f;
}

static void forget(himc_room *r)
{
    for (int l = 0; l < HIMC_ROOM_LINES; l++)
        memset(r->line[l], 0, sizeof *r->line[l] * (size_t)r->delay[l]);
    memset(r->y, 0, sizeof r->y);
    r->silent = HIMC_ROOM_EMPTY;
}

void himc_room_set(himc_room *r, const himc_walls *walls, double rate)
{
    bool before = himc_room_heard(r);
    r->on = walls->seconds > 0;
    if (!before && !r->on)
        return;
    if (!before || r->rate != rate) { // an empty room
        r->rate = rate;
        for (int l = 0; l < HIMC_ROOM_LINES; l++) {
            double part = pow((double)l / (HIMC_ROOM_LINES - 1), BEND);
            r->delay[l] = (int)lround(rate * SHORTEST * pow(LONGEST / SHORTEST, part));
            r->at[l] = 0;
        }
        forget(r);
    }
    r->from = present(r);
    if (r->on) {
        r->to = form_of(walls, r->delay, rate);
        r->forget = (int)(FORGOTTEN * walls->seconds * rate) + r->delay[HIMC_ROOM_LINES - 1];
    }
    if (!before) {
        r->from = r->to;
        r->from.out = 0;
    }
    if (!r->on)
        r->to.out = 0;
    r->faded = 0;
    r->step = 1 / (FADE * rate);
}

void himc_room_leave(himc_room *r)
{
    r->on = false;
    r->faded = 1;
}

// two delays at once, as any x86-64 has it
typedef double pair __attribute__((vector_size(2 * sizeof(double)), aligned(8), may_alias));
#define PAIRS (HIMC_ROOM_LINES / 2)

// The sums of z with all signs +, and with those of both ears: Walsh functions, orthogonal. Left
// (+-+--+-+), four times; right (++--++--), then the opposite, twice. The order is one that pairs
// keep.
static double sums(const pair *z, double ear[2])
{
    pair a[PAIRS / 4], b[PAIRS / 4], c[2], d[2], e[2];
    for (int k = 0; k < PAIRS / 4; k++) {
        pair first = z[k] + z[k + PAIRS / 2], second = z[k + PAIRS / 4] + z[k + 3 * PAIRS / 4];
        a[k] = first + second;
        b[k] = first - second;
    }
    for (int k = 0; k < 2; k++) {
        c[k] = a[k] + a[k + 2];
        d[k] = a[k] - a[k + 2];
        e[k] = b[k] + b[k + 2];
    }
    ear[0] = (d[0][0] - d[0][1]) + (d[1][0] - d[1][1]);
    ear[1] = (e[0][0] + e[0][1]) - (e[1][0] + e[1][1]);
    return (c[0][0] + c[0][1]) + (c[1][0] + c[1][1]);
}

// n samples, at most two, of the network from sample `at` of the present ways on; z is behind the
// walls
static inline __attribute__((always_inline)) void mix(pair z[PAIRS], const himc_room_form *f,
                                                      int at, int n,
                                                      double *const way[HIMC_ROOM_LINES],
                                                      double *const *drum, double *const *ears)
{
    const pair *keep = (const pair *)f->keep, *take = (const pair *)f->take;
    const pair *entering = (const pair *)ENTERING;
    pair x[2][PAIRS];
    for (int k = 0; k < PAIRS; k++) { // from two samples of a delay to one of two
        pair a = *(const pair *)(way[2 * k] + at), b = *(const pair *)(way[2 * k + 1] + at);
        x[0][k] = (pair){a[0], b[0]};
        x[1][k] = (pair){a[1], b[1]};
    }
    for (int j = 0; j < n; j++) {
        double ear[2];
        pair in = {drum[1][at + j], drum[0][at + j]};
        for (int k = 0; k < PAIRS; k++)
            z[k] = keep[k] * z[k] + take[k] * x[j][k];
        double all = 2.0 / HIMC_ROOM_LINES * sums(z, ear);
        ears[0][at + j] = f->out * ear[0];
        ears[1][at + j] = f->out * ear[1];
        for (int k = 0; k < PAIRS; k++)
            x[j][k] = z[k] - all + entering[k] * in;
    }
    for (int k = 0; k < PAIRS; k++) { // and back; each goes to the next delay
        double *to = way[2 * k + 1] + at, *next = way[(2 * k + 2) % HIMC_ROOM_LINES] + at;
        if (n == 2) {
            *(pair *)to = (pair){x[0][k][0], x[1][k][0]};
            *(pair *)next = (pair){x[0][k][1], x[1][k][1]};
        } else {
            *to = x[0][k][0];
            *next = x[0][k][1];
        }
    }
}

// n samples of the network, fewer than any delay. A delay is a ring of its length: what leaves it
// makes room for what enters it.
static void reflect(himc_room *r, const himc_room_form *f, int n, double *const *drum,
                    double *const *ears)
{
    double *way[HIMC_ROOM_LINES];
    pair z[PAIRS];
    memcpy(z, r->y, sizeof z);
    for (int done = 0, run; done < n; done += run) {
        run = n - done; // until one of the rings begins anew
        for (int l = 0; l < HIMC_ROOM_LINES; l++) {
            int left = r->delay[l] - r->at[l];
            way[l] = r->line[l] + r->at[l];
            run = run < left ? run : left;
        }
        double *in[] = {drum[0] + done, drum[1] + done}, *out[] = {ears[0] + done, ears[1] + done};
        for (int at = 0; at < run - 1; at += 2)
            mix(z, f, at, 2, way, in, out);
        if (run % 2 == 1)
            mix(z, f, run - 1, 1, way, in, out);
        for (int l = 0; l < HIMC_ROOM_LINES; l++) {
            int at = r->at[l] + run;
            r->at[l] = at < r->delay[l] ? at : 0;
            // asks the memory for what comes within reach
            for (int i = HIMC_ROOM_RUN - run; i <= HIMC_ROOM_RUN; i += CACHE_LINE)
                __builtin_prefetch(&r->line[l][r->at[l] + i], 1);
        }
    }
    memcpy(r->y, z, sizeof z);
}

int himc_room_steady(const himc_room *r, int n)
{
    bool ends = r->silent < HIMC_ROOM_EMPTY && r->silent >= r->forget - n;
    return r->faded < 1 || ends ? 1 : n;
}

void himc_room_hear(himc_room *r, int n, double *const *drum, double *const *ears)
{
    memset(ears[0], 0, (size_t)n * sizeof **ears);
    memset(ears[1], 0, (size_t)n * sizeof **ears);
    for (int i = 0; i < n; i++) {
        if (drum[0][i] != 0 || drum[1][i] != 0)
            r->silent = 0;
        else if (r->silent < HIMC_ROOM_EMPTY && ++r->silent >= r->forget)
            forget(r);
    }
    if (r->faded < 1) {
        r->faded = fmin(r->faded + r->step, 1);
        himc_room_form now = present(r);
        reflect(r, &now, n, drum, ears);
    } else if (r->on && r->silent < HIMC_ROOM_EMPTY) {
        reflect(r, &r->to, n, drum, ears);
    }
}
