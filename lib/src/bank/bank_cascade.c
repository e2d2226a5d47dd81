/// bank_cascade.c: in a plate that bends far, energy goes from mode to mode, and upwards.
///
/// Between two samples, at intervals, pairs of oscillators i and j = i + D of one mass exchange
/// velocities, by an angle of any size and sign:
///     v_i <- c v_i - w v_j,   v_j <- w v_i + c v_j,   c = (1 - b^2)/(1 + b^2), w = 2 b/(1 + b^2).
/// c^2 + w^2 = 1, so v_i^2 + v_j^2 stays, and the kinetic energy; no displacement moves, so neither
/// the potential energy, nor a film's, nor a mallet's compression. So the energy is what it was,
/// whatever b, and however long the interval; the steps between take energy or add a force's work,
/// as without. At rate 0 nothing is computed.
///
/// Phases of different modes are as good as random, so energy diffuses: dE_i/dt = rate (E_j - E_i)
/// with
///     (2 b)^2 = 2 rate t,   rate = kappa f_i/(1 kHz) x^2/(1 + x^2),   x = E/E_0,
/// E the energy of all, t the time since the last exchange. It spreads over about rate D^2 modes^2
/// a second, faster the higher and the louder: the phenomenology of turbulent plates (Humbert,
/// Josserand, Touze & Cadot 2017), not their equations (von Karman's), of which a thousand modes
/// are far from real time. A soft stroke, x near 0, is linear. D takes 16 values up to the span in
/// turns. The sign of b hangs on i and D alone: with new signs each line would become noise. Far
/// and seldom pairs keep lines, too: they need few exchanges to carry energy as far.
#include "bank/bank_state.h"
#include "base/random.h"

#include <math.h>

#define LEAST 1e-4       // (rad) of the highest pair: less is not done; chosen: -80 dB of a mode
#define REFERENCE 1000.0 // (Hz) of kappa
#define APART 61         // signs of two distances begin so far apart; chosen: any odd number

void himc_bank_set_cascade(himc_bank *bank, const himc_cascade *set)
{
    bank_cascade *c = &bank->cascade;
    uint64_t state = 1; // chosen: any
    c->set = set ? *set : (himc_cascade){0};
    for (int i = 0; i < bank->capacity && set; i++) {
        c->root[i] = sqrt(bank->omega[i] / (2 * HIMC_PI * REFERENCE));
        c->sign[i] = c->sign[bank->capacity + i] = himc_random_bits(&state) & 1 ? 1 : -1;
    }
}

bool himc_bank_cascade_due(const himc_bank *bank)
{
    const bank_cascade *c = &bank->cascade;
    return c->set.rate > 0 && bank->live > 0 && c->since >= bank->whole_pass;
}

void himc_bank_scatter(himc_bank *bank)
{
    bank_cascade *c = &bank->cascade;
    const bank_film *f = &bank->film;
    bank_arrive(bank);
    double energy =
        0.5 * bank->mass[0] * bank->loops->square(bank->p, bank->s, f->damp, f->tight, bank->live);
    double x = energy / c->set.energy, y = x * x, t = c->since * bank->h;
    double by = sqrt(2 * t * c->set.rate * y / (1 + y));
    int k = c->turn;
    c->turn = (k + 1) % TURNS;
    c->since = 0;
    c->acts = by * c->root[bank->count - 1] > LEAST;
    if (!c->acts)
        return;
    bank->live = bank_round_up(bank->count);
    bank->loops->scatter(bank->s, bank->p, f->damp, c->root, c->sign + k * APART % bank->capacity,
                         0.5 * by, 1 + (2 * k + 1) * c->set.span / (2 * TURNS), bank->count);
}
