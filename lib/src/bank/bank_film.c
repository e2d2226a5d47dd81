/// bank_film.c: the film, which couples all oscillators and never adds energy.
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
#include "bank/bank_state.h"

#include <math.h>

void himc_bank_exchange(himc_bank *bank, double lead)
{
    bank_film *f = &bank->film;
    double t = (lead - f->lead) * bank->h, sum[2];
    int count = bank_coupled(bank);
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

void himc_bank_settle(himc_bank *bank)
{
    bank_arrive(bank);
    himc_bank_exchange(bank, 0);
}

void himc_bank_slacken(himc_bank *bank)
{
    bank_film *f = &bank->film;
    f->on = false;
    f->s = f->power = f->lead = f->due = 0;
    f->level = 0;
}

double himc_bank_audible(const bank_film *f)
{
    return copysign(fmin(fabs(f->s), 2 * fabs(f->mean)), f->s);
}

double himc_bank_film_slope(const himc_bank *bank, const himc_readout *readout, double sum)
{
    const bank_film *f = &bank->film;
    double s = himc_bank_audible(f), most = fabs(s) / (LANES * bank->h);
    return bank->h * sum * (readout->direct ? fmin(fmax(f->power, -most), most) : s);
}

// 4 times what an oscillator has of s, of its oscillation only `part`
static inline double four_of(const himc_bank *bank, int i, double part)
{
    const bank_film *f = &bank->film;
    double q = bank->p[i] * bank->q_per_p[i];
    double v = (bank->s[i] - f->damp[i] * bank->p[i]) * f->slack[i] * bank->q_per_p[i];
    return f->on_p[i] * bank->damped[i] * ((1 + part) * q * q + (1 - part) * v * v);
}

// What s is to be in the present state, so that its mean in coming steps of length t is right:
// sum a q^2/2, but of each oscillation of s only x/tan x, x = w t, since the exchanges make of it
// x/sin x, half a step away.
static double film_of(const himc_bank *bank, double t)
{
    double sum = 0;
    for (int i = 0, count = bank_coupled(bank); i < count; i++) {
        double x = bank->omega[i] * t, y = x * x;
        // x / tan x
        sum += four_of(bank, i, 1 - y * (1.0 / 3 + y * (1.0 / 45 + y * 2.0 / 945)));
    }
    return 0.25 * sum;
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

void himc_bank_anchor(himc_bank *bank)
{
    bank_film *f = &bank->film;
    double kinetic = 0, potential = 0, most = 0; // of s that the oscillators could make together
    for (int i = 0; i < bank->live; i++)
        most += 0.5 * four_of(bank, i, 0);
    himc_bank_exchange(bank, 0);
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
        himc_bank_slacken(bank);
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

void himc_bank_turn(himc_bank *bank)
{
    bank_film *f = &bank->film;
    int i = bank_coupled(bank);
    if (f->on && f->due != 0)
        bank->loops->turn(bank->p + i, bank->s + i, f->rate + i, f->tight + i, f->slack + i,
                          f->damp + i, f->due, bank->live - i);
    f->due = 0;
}
