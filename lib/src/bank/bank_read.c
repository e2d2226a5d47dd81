/// bank_read.c: what is heard of a bank, and what a force will do to it.
///
/// A readout's samples within a pass come from the state at its start. With C_n, S_n the
/// coefficients of n samples, the readout rp p + rs s is after n samples
///     y_n = C_n a + S_n b,   a = rp p + rs s,   b = rp s - rs p,
/// taken from a table for n = 1 .. 16, eight samples at once, and from then on
///     y_n = 2 C_8 y_(n-8) - (C_8^2 + S_8^2) y_(n-16).
/// So a readout costs only when it is read.
#include "bank/bank_state.h"

#include <string.h>

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
    if (bank->low == 0 || readout->part == bank->part)
        return;
    // what the film's present step adds
    const bank_film *f = &bank->film;
    double out[2 * LANES] = {0}, *ahead = readout->ahead + bank->at - bank->step_at;
    bool stretched = readout->film != NULL;
    double sum = add_waves(bank, readout, 0, bank->low, stretched,
                           readout->direct ? -himc_bank_audible(f) : 0,
                           bank->step < LANES ? LANES : bank->step, out);
    double slope = stretched ? himc_bank_film_slope(bank, readout, sum) : 0;
    for (int n = 0; n < bank->step; n++)
        ahead[n] += out[n] + (f->lead - 1 - n) * slope;
    readout->part = bank->part;
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
        double sum = bank->loops->dot(readout->film, bank->p, bank_coupled(bank));
        value = value - (readout->direct ? himc_bank_audible(f) * sum : 0) +
                f->lead * himc_bank_film_slope(bank, readout, sum);
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
    double by = f->on ? f->lead * himc_bank_film_slope(bank, form, 1) - himc_bank_audible(f) : 0;
    for (int part = 0; part < 2; part++) {
        int first = part * bank_coupled(bank), end = part ? bank->live : bank_coupled(bank);
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

void himc_bank_read_ahead(himc_bank *bank, himc_readout *readout, int n, double *out)
{
    look_ahead(bank, readout);
    memcpy(out, readout->ahead + bank->at, sizeof *out * (size_t)n);
}

double himc_bank_read_single(himc_bank *bank, himc_readout *readout)
{
    if (readout->alike && readout->read_pass != bank->pass)
        read_alike(bank, readout->alike);
    return himc_bank_read(bank, readout);
}

double himc_bank_peek(const himc_bank *bank, const himc_readout *readout)
{
    const bank_film *f = &bank->film;
    double value = 0, sum = 0;
    for (int i = 0; i < bank->live; i++) {
        double p, s, c = bank->present.c[i], w = bank->present.s[i];
        bank_present(bank, i, &p, &s);
        value += readout->p[i] * (c * p + w * s) + readout->s[i] * (c * s - w * p);
        sum += readout->film && i < bank_coupled(bank) ? readout->film[i] * (c * p + w * s) : 0;
    }
    return value - (readout->direct ? himc_bank_audible(f) * sum : 0) +
           (f->lead - bank->step_at - 1) * himc_bank_film_slope(bank, readout, sum);
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
