/// bank.c: each oscillator's exact step is a rotation.
///
/// With w_d = sqrt(w^2 - d^2), the coordinates p = w_d q and s = q' + d q rotate by the angle w_d h
/// and shrink by exp(-d h) in a step of length h:
///     p' = C p + S s,   s' = C s - S p,   C = exp(-d h) cos w_d h,   S = exp(-d h) sin w_d h.
/// A force f constant over the step adds b1 f to q and b2 f to q' (zero-order hold), b1 = (1 -
/// a11)/(m w^2) with a11 = C + d S/w_d, and b2 = S/(m w_d); in p, s: w_d b1 f and (b2 + d b1) f.
///
/// p and s do not depend on h, so steps of two lengths, a sample and a substep, may follow each
/// other in any order: the bank keeps a set of coefficients for each length.
///
/// After a force, the state makes one step of one sample. Then, as long as none acts, it makes
/// steps of 64 samples, a pass; a readout's samples within it come from the state at its start.
/// With C_n, S_n the coefficients of n samples, the readout rp p + rs s is after n samples
///     y_n = C_n a + S_n b,   a = rp p + rs s,   b = rp s - rs p,
/// taken from a table for n = 1 .. 16, eight samples at once, and from then on
///     y_n = 2 C_8 y_(n-8) - (C_8^2 + S_8^2) y_(n-16).
/// When a force ends the pass early, the state makes the steps of 32, 16, .. samples that lead
/// there. So the steps hang on the forces alone, not on how many samples are asked for at a time,
/// and a readout costs only when it is read.
///
/// The film, of energy s^2/2, pulls with the modal forces -s g, g_i = a_i q_i, and s' = g . q'. It
/// is split from the rest (energy quadratisation: Ducceschi & Bilbao 2019; splitting: Strang 1968).
/// While the oscillators make their step, s holds and the film does not act. Then, in no time, the
/// film and the velocities exchange what belongs to the time t, while all q hold:
///     v' = v - t (s + u/2) g/m,   s' = s + u,   u = t g . (v + v')/2,
/// which is linear in u, and one division solves it. The modes gain sum m (v'^2 - v^2)/2 = -t (s +
/// u/2) g . (v + v')/2 = -(s + u/2) u, the film s'^2/2 - s^2/2 = (s + u/2) u: together nothing, for
/// any t, forwards or backwards. The oscillators' own step takes energy or adds the work of a
/// force, whatever the film. So energy grows by the work of forces alone, however long the film is
/// held, and contact need not know of the film.
///
/// Half of an exchange is made before a step of the oscillators, half after: of second order, and
/// the pitch of each mode rises as it would with shorter steps, whatever its frequency w. The film
/// is `lead` samples ahead of the oscillators; a step that a force ends early takes back what it
/// has had too much. In the samples between, a readout adds what the film would do, to first order
/// in time.
///
/// The steps are 1, 4, 8 or 16 samples: with the lowest mode's w t, about (w t)^2/9 of a rise of
/// its pitch is lost, and the longest steps are taken that lose little of the largest rise at
/// present. Exchanges at w t near pi would see a mode too seldom to follow its share of s. So above
/// w t = 1 (478 Hz with 16 samples of 48000) a mode makes steps of 64 samples, and the film only
/// turns its phase, by w' t with w' = s a/(2 m w): a rotation of (w q, v), which keeps its energy.
/// Its share of s is small. It moves q between two steps, so contact waits for it
/// (himc_bank_ready). All this is decided at the start of a pass of 64.
///
/// s follows what the state makes of it to second order. After forces and every 1024 samples it is
/// set to that, and all velocities are scaled to take or give the difference of energy.
///
/// The order of all sums is fixed (bank_kernel.h): the same bits on any machine. About every 1024
/// samples the oscillators at the top that have fallen below 1e-8 m/s are set to rest and skipped
/// until the next force: high modes die first, and denormal numbers never arise. That takes energy,
/// and of a sound at most 1e-8 m/s times the sum of its weights: 200 modes of one stroke, which
/// began with 1 m/s, lack 160 dB of its peak.
#include "bank/bank_state.h"

#include <math.h>
#include <string.h>

#define QUIET 1e-8         // (m/s) of p and s; chosen: 160 dB below a stroke
#define TIDY_INTERVAL 1024 // least samples between two searches for quiet ones; chosen: 20 ms
#define BOUNDS_TIME 256    // samples between two searches for the bounds; chosen: they cost nothing
#define FILM_SWING 2.0     // growth of a swing by what the film gives back; the comment there

void himc_bank_wake(himc_bank *bank)
{
    int live = bank->count;
    while (live > 0 && bank->p[live - 1] == 0 && bank->s[live - 1] == 0)
        live--;
    bank->live = bank_round_up(live);
}

void himc_bank_use(himc_bank *bank, const himc_bank_kernel *kernel)
{
    bank->loops = kernel;
}

int himc_bank_padded(const himc_bank *bank)
{
    return bank->capacity;
}

int himc_bank_count(const himc_bank *bank)
{
    return bank->count;
}

void himc_bank_set_substeps(himc_bank *bank, int count)
{
    bank->substeps = count;
}

void himc_bank_set_step(himc_bank *bank, himc_step_length step)
{
    bank->kind = step;
    bank->present = step == HIMC_STEP_SUBSTEP ? bank->sub : bank->power[0];
    bank->push = step == HIMC_STEP_SUBSTEP ? bank->parted : bank->whole;
}

// turns the oscillators from `first` to `end` by n samples
static void rotate(himc_bank *bank, int first, int end, int n)
{
    for (int k = POWERS - 1; k >= 0 && end > first; k--)
        if (n >> k & 1)
            bank->loops->rotate(bank->p + first, bank->s + first, bank->power[k].c + first,
                                bank->power[k].s + first, end - first);
}

// brings the state to the present sample, which ends the pass
static void arrive(himc_bank *bank)
{
    rotate(bank, 0, bank->low, bank->step_at);
    rotate(bank, bank->low, bank->live, bank->at);
    bank->film.lead -= bank->step_at;
    bank->film.due += bank->film.s * bank->at * bank->h;
    bank->at = bank->length = bank->low = bank->step_at = 0;
    bank->pass++;
}

// number of oscillators on which the film acts
static int coupled(const himc_bank *bank)
{
    int count = bank->film.reach[bank->film.level];
    return count < bank->live ? count : bank->live;
}

// the film's exchange with the velocities, after which it is `lead` samples ahead
static void exchange(himc_bank *bank, double lead)
{
    bank_film *f = &bank->film;
    double t = (lead - f->lead) * bank->h, sum[2];
    int count = coupled(bank);
    f->lead = lead;
    if (!f->on || t == 0)
        return;
    bank->loops->stretch(f->kick, f->on_p, f->per_mass, f->damp, bank->p, bank->s, count, sum);
    double u = (t * sum[0] - 0.5 * t * t * sum[1] * f->s) / (1 + 0.25 * t * t * sum[1]);
    bank->loops->add(bank->s, f->kick, -t * (f->s + 0.5 * u), count);
    f->mean = f->s + 0.5 * u;
    f->s += u;
    f->power = sum[0];
}

// the film is off, and its energy lost
static void slacken(himc_bank *bank)
{
    bank_film *f = &bank->film;
    f->on = false;
    f->s = f->power = f->lead = f->due = 0;
    f->level = 0;
}

void himc_bank_settle(himc_bank *bank)
{
    arrive(bank);
    exchange(bank, 0);
}

// s as a readout hears it: at most twice the pull of the last exchange, which a film stiffer than
// the modes themselves has not had in full
static double audible(const bank_film *f)
{
    return copysign(fmin(fabs(f->s), 2 * fabs(f->mean)), f->s);
}

// What the film adds to a readout between exchanges, per sample of its lead, `sum` being the
// readout's weights `film` on the state. The rate of s counts at most so that s doubles in a step.
static double film_slope(const himc_bank *bank, const himc_readout *readout, double sum)
{
    const bank_film *f = &bank->film;
    double s = audible(f), most = fabs(s) / (LANES * bank->h);
    return bank->h * sum * (readout->direct ? fmin(fmax(f->power, -most), most) : s);
}

// p and s of one oscillator at the present sample: the same numbers as by arrive
static void present_state(const himc_bank *bank, int i, double *p, double *s)
{
    *p = bank->p[i];
    *s = bank->s[i];
    int n = i < bank->low ? bank->step_at : bank->at;
    for (int k = POWERS - 1; k >= 0; k--) {
        if (!(n >> k & 1))
            continue;
        double c = bank->power[k].c[i], w = bank->power[k].s[i], before = *p;
        *p = c * before + w * *s;
        *s = c * *s - w * before;
    }
}

// What s is to be in the present state, so that its mean in coming steps of length t is right:
// sum a q^2/2, but of each oscillation of s only x/tan x, x = w t, since the exchanges make of it
// x/sin x, half a step away.
static double film_of(const himc_bank *bank, double t)
{
    const bank_film *f = &bank->film;
    double sum = 0;
    for (int i = 0, count = coupled(bank); i < count; i++) {
        double x = bank->omega[i] * t, y = x * x;
        double part = 1 - y * (1.0 / 3 + y * (1.0 / 45 + y * 2.0 / 945)); // x / tan x
        double q = bank->p[i] * bank->q_per_p[i];
        double v = (bank->s[i] - f->damp[i] * bank->p[i]) * f->slack[i] * bank->q_per_p[i];
        sum += f->on_p[i] * bank->damped[i] * ((1 + part) * q * q + (1 - part) * v * v);
    }
    return 0.25 * sum;
}

// the highest s that the oscillators could make together
static double highest(const himc_bank *bank)
{
    const bank_film *f = &bank->film;
    double sum = 0;
    for (int i = 0; i < bank->live; i++) {
        double q = bank->p[i] * bank->q_per_p[i];
        double v = (bank->s[i] - f->damp[i] * bank->p[i]) * f->slack[i] * bank->q_per_p[i];
        sum += 0.5 * f->on_p[i] * bank->damped[i] * (q * q + v * v);
    }
    return sum;
}

void himc_bank_find_film(himc_bank *bank)
{
    bank_film *f = &bank->film;
    himc_bank_settle(bank);
    f->level = 0;
    f->s = f->mean = film_of(bank, 0);
    f->on = f->moved = f->s > 0;
}

double himc_bank_film(const himc_bank *bank)
{
    return bank->film.s;
}

double himc_bank_energy(const himc_bank *bank)
{
    double sum = 0;
    for (int i = 0; i < bank->live && i < bank->count; i++) {
        double q, v;
        himc_bank_state(bank, i, &q, &v);
        double w = bank->omega[i] * q;
        sum += 0.5 * bank->mass[i] * (v * v + w * w);
    }
    return sum;
}

void himc_bank_state(const himc_bank *bank, int index, double *q, double *v)
{
    *q = *v = 0;
    if (index >= bank->count)
        return;
    double p, s;
    present_state(bank, index, &p, &s);
    *q = p / bank->damped[index];
    *v = s - bank->decay[index] * *q;
}

// an oscillator moves; for how long the bank has been at rest, some of it not run, makes no
// difference
static void stir(himc_bank *bank, int index)
{
    if (bank->live == 0)
        bank->age = bank->bounds_left = 0;
    if (index >= bank->live)
        bank->live = bank_round_up(index + 1);
}

void himc_bank_excite(himc_bank *bank, int index, double q, double v)
{
    if (index >= bank->count)
        return;
    himc_bank_settle(bank);
    bank->p[index] = bank->damped[index] * q;
    bank->s[index] = v + bank->decay[index] * q;
    if (bank->p[index] == 0 && bank->s[index] == 0)
        himc_bank_wake(bank);
    else
        stir(bank, index);
    bank->forced = true;
}

void himc_bank_rest(himc_bank *bank)
{
    memset(bank->p, 0, sizeof(double) * (size_t)bank->capacity);
    memset(bank->s, 0, sizeof(double) * (size_t)bank->capacity);
    bank->live = bank->age = 0;
    himc_bank_settle(bank);
    slacken(bank);
    bank->forced = true;
}

static himc_bank_waves waves_at(himc_bank *bank, int i)
{
    return (himc_bank_waves){bank->a, bank->b, bank->table + (size_t)i * HIMC_BANK_TABLE,
                             bank->twice + i, bank->fall + i};
}

// Adds the samples 1 .. n of a readout of the oscillators from `first` to `end`; where `stretched`
// its weights are enlarged by those of the film times `by`. Returns the sum of these on the state.
static double add_waves(himc_bank *bank, const himc_readout *r, int first, int end, bool stretched,
                        double by, int n, double *out)
{
    double sum = 0;
    for (int i = first; i < end; i += BLOCK) {
        int count = end - i < BLOCK ? end - i : BLOCK;
        himc_bank_waves waves = waves_at(bank, i);
        if (stretched)
            sum += bank->loops->weigh_more(&waves, r->p + i, r->s + i, r->film + i, by, bank->p + i,
                                           bank->s + i, count);
        else
            bank->loops->weigh(&waves, r->p + i, r->s + i, bank->p + i, bank->s + i, count);
        bank->loops->ahead(&waves, count, n, out);
    }
    return sum;
}

// the same of the oscillators from `low` on, of readouts that are alike
static void add_alike(himc_bank *bank, const himc_alike *alike)
{
    const himc_readout *form = &alike->form;
    double *out[HIMC_BANK_ALIKE];
    const double *gain[HIMC_BANK_ALIKE];
    for (int k = 0; k < HIMC_BANK_ALIKE; k++) {
        himc_readout *r = alike->readout[k];
        out[k] = memset(r->ahead, 0, sizeof r->ahead);
        r->pass = bank->pass;
        r->part = 0;
    }
    for (int i = bank->low; i < bank->live; i += BLOCK) {
        int count = bank->live - i < BLOCK ? bank->live - i : BLOCK;
        himc_bank_waves waves = waves_at(bank, i);
        for (int k = 0; k < HIMC_BANK_ALIKE; k++)
            gain[k] = alike->gain[k] + i;
        bank->loops->weigh(&waves, form->p + i, form->s + i, bank->p + i, bank->s + i, count);
        bank->loops->ahead_alike(&waves, gain, count, bank->length, out);
    }
}

// adds the film's present step to readout->ahead
static void add_step(himc_bank *bank, himc_readout *readout)
{
    const bank_film *f = &bank->film;
    double out[2 * LANES] = {0}, *ahead = readout->ahead + bank->at - bank->step_at;
    bool stretched = readout->film != NULL;
    double sum =
        add_waves(bank, readout, 0, bank->low, stretched, readout->direct ? -audible(f) : 0,
                  bank->step < LANES ? LANES : bank->step, out);
    double slope = stretched ? film_slope(bank, readout, sum) : 0;
    for (int n = 0; n < bank->step; n++)
        ahead[n] += out[n] + (f->lead - 1 - n) * slope;
    readout->part = bank->part;
}

// fills readout->ahead as far as the present step goes
static void look_ahead(himc_bank *bank, himc_readout *readout)
{
    if (readout->pass != bank->pass && readout->alike) {
        add_alike(bank, readout->alike);
    } else if (readout->pass != bank->pass) {
        memset(readout->ahead, 0, sizeof readout->ahead);
        add_waves(bank, readout, bank->low, bank->live, false, 0, bank->length, readout->ahead);
        readout->pass = bank->pass;
        readout->part = 0;
    }
    if (bank->low > 0 && readout->part != bank->part)
        add_step(bank, readout);
}

double himc_bank_read(himc_bank *bank, himc_readout *readout)
{
    const bank_film *f = &bank->film;
    if (bank->at > 0) {
        look_ahead(bank, readout);
        return readout->ahead[bank->at - 1];
    }
    if (readout->read_pass == bank->pass)
        return readout->value;
    double value = bank->loops->read(readout->p, readout->s, bank->p, bank->s, bank->live);
    if (f->on && readout->film) {
        double sum = bank->loops->dot(readout->film, bank->p, coupled(bank));
        value = value - (readout->direct ? audible(f) * sum : 0) +
                f->lead * film_slope(bank, readout, sum);
    }
    readout->read_pass = bank->pass;
    readout->value = value;
    return value;
}

// the values of readouts that are alike, after a step of its own
static void read_alike(himc_bank *bank, const himc_alike *alike)
{
    const bank_film *f = &bank->film;
    const himc_readout *form = &alike->form;
    double value[2][HIMC_BANK_ALIKE];
    double by = f->on ? f->lead * film_slope(bank, form, 1) - audible(f) : 0;
    for (int part = 0; part < 2; part++) {
        int first = part * coupled(bank), end = part ? bank->live : coupled(bank);
        const double *gain[HIMC_BANK_ALIKE];
        for (int k = 0; k < HIMC_BANK_ALIKE; k++)
            gain[k] = alike->gain[k] + first;
        bank->loops->read_alike(form->p + first, form->s + first, form->film + first, part ? 0 : by,
                                gain, bank->p + first, bank->s + first, end - first, value[part]);
    }
    for (int k = 0; k < HIMC_BANK_ALIKE; k++) {
        alike->readout[k]->value = value[0][k] + value[1][k];
        alike->readout[k]->read_pass = bank->pass;
    }
}

double himc_bank_peek(const himc_bank *bank, const himc_readout *readout)
{
    const bank_film *f = &bank->film;
    double value = 0, sum = 0;
    for (int i = 0; i < bank->live; i++) {
        double p, s, c = bank->present.c[i], w = bank->present.s[i];
        present_state(bank, i, &p, &s);
        value += readout->p[i] * (c * p + w * s) + readout->s[i] * (c * s - w * p);
        sum += readout->film && i < coupled(bank) ? readout->film[i] * (c * p + w * s) : 0;
    }
    return value - (readout->direct ? audible(f) * sum : 0) +
           (f->lead - bank->step_at - 1) * film_slope(bank, readout, sum);
}

himc_bank_bounds himc_bank_bounds_of(himc_bank *bank, const double *most)
{
    himc_bank_bounds *b = &bank->bounds;
    if (bank->forced || bank->bounds_left <= 0) {
        *b = (himc_bank_bounds){0};
        for (int i = 0; i < bank->live; i++) {
            double size = most[i] * sqrt(bank->p[i] * bank->p[i] + bank->s[i] * bank->s[i]);
            b->swing += bank->q_per_p[i] * size;
            b->speed += (1 + bank->film.damp[i]) * size; // q' = s - d q
        }
        bank->bounds_left = BOUNDS_TIME;
    }
    double film = bank->film.on ? FILM_SWING : 1;
    return (himc_bank_bounds){film * b->swing, film * b->speed};
}

// Chooses the film's steps, sets s to what the state makes of it, and scales the velocities so that
// the energy stays. Ends the film when the oscillators' energy has become small.
static void anchor(himc_bank *bank)
{
    bank_film *f = &bank->film;
    double kinetic = 0, potential = 0, most = highest(bank);
    exchange(bank, 0);
    for (f->level = LEVELS - 1; f->level > 0 && most > f->most[f->level];)
        f->level--;
    for (int i = 0; i < bank->live; i++) {
        double v = bank->s[i] - f->damp[i] * bank->p[i], u = f->tight[i] * bank->p[i];
        kinetic += 0.5 * bank->mass[i] * v * v;
        potential += 0.5 * bank->mass[i] * u * u;
    }
    f->moved = false;
    bank->bounds_left = 0;
    if (kinetic + potential <= f->least) {
        slacken(bank);
        return;
    }
    // at most half of the velocities' energy is taken, and they are given as much as they have
    double s = film_of(bank, bank_steps[f->level] * bank->h),
           gain = fmin(0.5 * (f->s * f->s - s * s), kinetic);
    if (gain < -0.5 * kinetic) {
        gain = -0.5 * kinetic;
        s = sqrt(f->s * f->s + kinetic);
    }
    f->s = f->mean = s;
    double scale = kinetic > 0 ? sqrt(1 + gain / kinetic) : 1;
    for (int i = 0; i < bank->live; i++) {
        double lost = f->damp[i] * bank->p[i]; // s = v + d q
        bank->s[i] = lost + scale * (bank->s[i] - lost);
    }
}

// from time to time: sets the quiet oscillators at the top to rest
static void tidy(himc_bank *bank)
{
    int live = bank->live;
    while (live > 0 && fabs(bank->p[live - 1]) < QUIET && fabs(bank->s[live - 1]) < QUIET) {
        live--;
        bank->p[live] = bank->s[live] = 0;
    }
    bank->live = bank_round_up(live);
    bank->age = 0;
}

// a step of its own: a sample after a force, or a substep
static void single_step(himc_bank *bank)
{
    double samples = bank->kind == HIMC_STEP_SUBSTEP ? 1.0 / bank->substeps : 1;
    arrive(bank);
    if (bank->film.level > 0)
        exchange(bank, 0);
    bank->film.level = 0;
    exchange(bank, samples / 2);
    bank->loops->rotate(bank->p, bank->s, bank->present.c, bank->present.s, bank->live);
    bank->film.lead -= samples;
    bank->age++;
    bank->forced = false;
    bank->bounds_left = 0;
}

// turns the oscillators on which the film does not act by what its pull has been
static void turn(himc_bank *bank)
{
    bank_film *f = &bank->film;
    int i = coupled(bank);
    if (f->on && f->due != 0)
        bank->loops->turn(bank->p + i, bank->s + i, f->rate + i, f->tight + i, f->slack + i,
                          f->damp + i, f->due, bank->live - i);
    f->due = 0;
}

void himc_bank_ready(himc_bank *bank)
{
    if (bank->at < bank->length || bank->forced || bank->kind == HIMC_STEP_SUBSTEP)
        return;
    arrive(bank);
    turn(bank);
}

static void begin_pass(himc_bank *bank)
{
    bank_film *f = &bank->film;
    bool due = bank->age >= TIDY_INTERVAL;
    if (due)
        tidy(bank);
    if (f->on && (due || f->moved))
        anchor(bank);
    bank->length = bank->whole_pass;
    bank->step = f->on && bank_steps[f->level] < bank->length ? bank_steps[f->level] : bank->length;
    bank->low = f->on ? coupled(bank) : 0;
}

// samples that the present step can give, at most n; begins the next one at its end
static int go_on(himc_bank *bank, int n)
{
    bool next_pass = bank->at == bank->length;
    if (next_pass) {
        himc_bank_ready(bank);
        begin_pass(bank);
    } else if (bank->step_at == bank->step) {
        rotate(bank, 0, bank->low, bank->step);
        bank->film.lead -= bank->step;
        bank->step_at = 0;
    }
    if (bank->step_at == 0) {
        bank->part++;
        exchange(bank, 0.5 * bank->step);
    }
    int left = bank->step - bank->step_at;
    return n < left ? n : left;
}

// the samples after `at` of the present pass
static void copy_ahead(himc_bank *bank, himc_readout *readout, int n, double *out)
{
    look_ahead(bank, readout);
    memcpy(out, readout->ahead + bank->at, sizeof *out * (size_t)n);
}

// its value after a step of its own
static double read_single(himc_bank *bank, himc_readout *readout)
{
    if (readout->alike && readout->read_pass != bank->pass)
        read_alike(bank, readout->alike);
    return himc_bank_read(bank, readout);
}

void himc_bank_run(himc_bank *bank, int n, himc_readout *const *readouts, int count,
                   double *const *out)
{
    for (int done = 0, run; done < n; done += run) {
        bool single = bank->forced || bank->kind == HIMC_STEP_SUBSTEP;
        run = single ? 1 : go_on(bank, n - done);
        if (single)
            single_step(bank);
        for (int k = 0; k < count; k++) {
            if (!out[k])
                continue;
            if (bank->live == 0)
                memset(out[k] + done, 0, sizeof **out * (size_t)run);
            else if (single)
                out[k][done] = read_single(bank, readouts[k]);
            else
                copy_ahead(bank, readouts[k], run, out[k] + done);
        }
        bank->at += single ? 0 : run;
        bank->step_at += single ? 0 : run;
        bank->age += single ? 0 : run;
        bank->bounds_left -= run;
    }
}

void himc_bank_push(himc_bank *bank, const double *shape, double force)
{
    arrive(bank);
    bank->live = bank_round_up(bank->count);
    bank->age = 0;
    bank->forced = true;
    if (!bank->film.on)
        slacken(bank);
    bank->film.on = bank->film.moved = bank->film.set;
    bank->loops->push(bank->p, bank->s, bank->push.p, bank->push.s, shape, force, bank->live);
}

void himc_bank_set_pass(himc_bank *bank, int samples)
{
    bank->whole_pass = samples;
}

void himc_bank_kick(himc_bank *bank, int index, double change)
{
    if (index >= bank->count)
        return;
    arrive(bank);
    bank->s[index] += change;
    bank->bounds.swing += HIMC_BANK_MOST * fabs(change) * bank->q_per_p[index];
    bank->bounds.speed += HIMC_BANK_MOST * fabs(change);
    stir(bank, index);
}

void himc_bank_step_response(const himc_bank *bank, const himc_readout *readout, double *response)
{
    for (int i = 0; i < bank->capacity; i++)
        response[i] = readout->p[i] * bank->push.p[i] + readout->s[i] * bank->push.s[i];
}

double himc_bank_response(const himc_bank *bank, const double *shape, const himc_readout *readout)
{
    double sum = 0;
    for (int i = 0; i < bank->capacity; i++)
        sum += shape[i] * (readout->p[i] * bank->push.p[i] + readout->s[i] * bank->push.s[i]);
    return sum;
}

double himc_bank_sum(const himc_bank *bank, const double *shape, const double *response)
{
    return bank->loops->dot(shape, response, bank->capacity);
}

bool himc_bank_at_rest(const himc_bank *bank)
{
    return bank->live == 0;
}
