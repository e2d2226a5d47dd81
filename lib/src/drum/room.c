/// room.c: walls, as a network of delays without loss, and a loss in each.
///
/// Sixteen delays of 17 to 71 ms, the ways between walls 6 to 24 m apart. What leaves them is
/// reflected, x = A y, by an orthogonal A (Householder's reflection, then each to the next delay:
/// Jot & Chaigne 1991), so no energy comes or goes; it passes a filter y = keep y + take x on its
/// way, whose gain is at most 10^(-3 d/T60) for the delay d at every frequency. So the energy in the
/// room only falls, by 60 dB in T60 below 1 kHz and faster above, whatever the delays. While the
/// walls change, keep and take are means of two such filters: their gain is below 1, too.
///
/// Level. A source that sends p at 1 m fills a room of volume V with p^2 16 pi/(D A), D its
/// directivity and A = 0.161 V/T60 its absorption (Sabine). A timpano sends D = 2 to 6 times its
/// mean in the plane of its head, where listeners are. What enters the network, 1 in each delay,
/// leaves it sum g^2/(1 - g^2) times.
///
/// The two ears add the delays with signs that are orthogonal, so they hear nothing alike, at any
/// frequency. In a diffuse field ears 17 cm apart hear low tones alike; microphones in a hall, which
/// recordings are made with, do not (chosen: as these).
#include "drum/room.h"

#include <math.h>
#include <string.h>

#define SHORTEST 0.017  // (s) of a delay; chosen: a room of 6 by 24 m
#define LONGEST 0.071   // (s)
#define HIGH 4000.0     // (Hz) where ...
#define HIGH_PART 0.6   // ... T60 is so much of itself; chosen: curtains and air
#define SABINE 0.161    // (s/m)
#define DIRECTIVITY 4.0 // chosen: between a monopole's in a baffle, 2, and a dipole's, 6
#define FADE 0.005      // (s) chosen: no click
#define CACHE_LINE 8    // doubles
#define FORGOTTEN 5.0   // T60s until it is empty; chosen: -300 dB
#define LEAST_GAIN 0.1  // g that counts for the level; chosen: all do from T60 = 0.21 s on

// of each delay at both ears, and of what enters it: Walsh functions, orthogonal
static const double AT_EAR[2][HIMC_ROOM_LINES] = {
    {1, -1, 1, -1, -1, 1, -1, 1, 1, -1, 1, -1, -1, 1, -1, 1},
    {1, 1, -1, -1, 1, 1, -1, -1, -1, -1, 1, 1, -1, -1, 1, 1}};
static const double ENTERING[HIMC_ROOM_LINES] = {1, -1, -1, 1, 1, -1, -1, 1,
                                                 1, -1, -1, 1, 1, -1, -1, 1};

// the filter of a wall after a delay of d seconds
static void set_wall(himc_room_form *f, int line, double d, double t60, double rate)
{
    double gain = pow(10, -3 * d / t60), high = fmin(HIGH, 0.4 * rate);
    double ratio = pow(10, -3 * d / t60 * (1 / HIGH_PART - 1)), b = ratio * ratio;
    // (1 - p)^2 = b |1 - p exp(-i w)|^2
    double s = 1 - b, c = 1 - b * cos(2 * HIMC_PI * high / rate);
    double p = (c - sqrt((c - s) * (c + s))) / s;
    f->keep[line] = p;
    f->take[line] = gain * (1 - p);
}

static himc_room_form form_of(const himc_walls *walls, const int *delay, double rate)
{
    himc_room_form f;
    double loss = 0;
    for (int l = 0; l < HIMC_ROOM_LINES; l++) {
        set_wall(&f, l, delay[l] / rate, walls->seconds, rate);
        // of a shorter T60 the longest ways, which nobody hears, would count for all
        double gain = fmax(f.take[l] / (1 - f.keep[l]), LEAST_GAIN);
        loss += (1 / (gain * gain) - 1) / HIMC_ROOM_LINES;
    }
    double absorption = SABINE * walls->volume / walls->seconds;
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

// an empty room at that rate
static void begin(himc_room *r, double rate)
{
    r->rate = rate;
    for (int l = 0; l < HIMC_ROOM_LINES; l++) {
        double part = (double)l / (HIMC_ROOM_LINES - 1);
        r->delay[l] = (int)lround(rate * SHORTEST * pow(LONGEST / SHORTEST, part));
    }
    memset(r->at, 0, sizeof r->at);
    forget(r);
}

void himc_room_set(himc_room *r, const himc_walls *walls, double rate)
{
    bool before = himc_room_heard(r);
    r->on = walls->seconds > 0;
    if (!before && !r->on)
        return;
    if (!before || r->rate != rate)
        begin(r, rate);
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

// sum of 16 numbers, in an order that vectors keep
static double sum(const double *x)
{
    double s[8];
    for (int l = 0; l < 8; l++)
        s[l] = x[l] + x[l + 8];
    return ((s[0] + s[4]) + (s[1] + s[5])) + ((s[2] + s[6]) + (s[3] + s[7]));
}

// A delay is a ring of its length: what leaves it makes room for what enters it. Here, `y` receives
// what leaves each in n samples.
static void read_lines(const himc_room *r, int n, double y[HIMC_ROOM_RUN][HIMC_ROOM_LINES])
{
    for (int l = 0; l < HIMC_ROOM_LINES; l++)
        for (int i = 0, at = r->at[l]; i < n; i++) {
            y[i][l] = r->line[l][at];
            at = at + 1 < r->delay[l] ? at + 1 : 0;
        }
}

// x enters; asks the memory for what leaves next
static void write_lines(himc_room *r, int n, double x[HIMC_ROOM_RUN][HIMC_ROOM_LINES])
{
    for (int l = 0; l < HIMC_ROOM_LINES; l++) {
        int at = r->at[l];
        for (int i = 0; i < n; i++) {
            r->line[l][at] = x[i][l];
            at = at + 1 < r->delay[l] ? at + 1 : 0;
        }
        r->at[l] = at;
        for (int i = 0; i <= HIMC_ROOM_RUN; i += CACHE_LINE)
            __builtin_prefetch(&r->line[l][at + i], 1);
    }
}

// n samples of the network, fewer than any delay; their sound at both ears
static void reflect(himc_room *r, const himc_room_form *f, int n, double *const *drum,
                    double *const *ears)
{
    double y[HIMC_ROOM_RUN][HIMC_ROOM_LINES], part[HIMC_ROOM_LINES], z[HIMC_ROOM_LINES];
    read_lines(r, n, y);
    memcpy(z, r->y, sizeof z);
    for (int i = 0; i < n; i++) {
        for (int l = 0; l < HIMC_ROOM_LINES; l++)
            z[l] = f->keep[l] * z[l] + f->take[l] * y[i][l];
        for (int ear = 0; ear < 2; ear++) {
            for (int l = 0; l < HIMC_ROOM_LINES; l++)
                part[l] = AT_EAR[ear][l] * z[l];
            ears[ear][i] = f->out * sum(part);
        }
        double all = 2.0 / HIMC_ROOM_LINES * sum(z);
        for (int l = 0; l < HIMC_ROOM_LINES; l++)
            part[l] = z[l] - all;
        for (int l = 0; l < HIMC_ROOM_LINES; l++) // each goes to the next delay
            y[i][l] =
                part[(l + HIMC_ROOM_LINES - 1) % HIMC_ROOM_LINES] + ENTERING[l] * drum[l % 2][i];
    }
    memcpy(r->y, z, sizeof z);
    write_lines(r, n, y);
}

int himc_room_steady(const himc_room *r, int n)
{
    bool ends = r->silent < HIMC_ROOM_EMPTY && r->silent >= r->forget - n;
    return r->faded < 1 || ends ? 1 : n;
}

void himc_room_hear(himc_room *r, int n, double *const *drum, double *const *ears)
{
    for (int i = 0; i < n; i++) {
        ears[0][i] = ears[1][i] = 0;
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
