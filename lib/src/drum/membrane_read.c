/// membrane_read.c: what a membrane is asked for: its head, modes and pitch, and the shapes that it
/// has now. Nothing changes it.
#include "drum/drum_performer.h"
#include "drum/membrane_state.h"
#include "head/uneven.h"

#include <math.h>

const himc_membrane_config *himc_membrane_config_of(const himc_membrane *membrane)
{
    return &membrane->model->config;
}

const himc_head *himc_membrane_head(const himc_membrane *membrane)
{
    return &membrane->model->config.head;
}

const himc_pickup *himc_membrane_pickups(const himc_membrane *membrane, int *count)
{
    *count = membrane->model->config.pickup_count;
    return membrane->model->config.pickups;
}

double himc_membrane_rate(const himc_membrane *membrane)
{
    return membrane->model->config.rate;
}

himc_mode himc_membrane_mode(const himc_membrane *membrane, int index)
{
    const himc_model *model = membrane->model;
    if (index >= model->modes->count)
        return (himc_mode){0};
    himc_mode mode = himc_model_mode(model, index);
    for (int i = 0; i < model->shared_count; i++)
        mode.decay += model->shared[i].index == index ? model->shared[i].decay : 0;
    mode.stiffness = mode.mass * pow(2 * HIMC_PI * mode.frequency, 2);
    return mode;
}

double himc_membrane_principal(const himc_membrane *membrane, const himc_head *head)
{
    return himc_head_principal(head, &membrane->model->config.shape);
}

int himc_membrane_audible(const himc_membrane *membrane)
{
    return himc_bank_count(membrane->model->bank);
}

void himc_membrane_state(const himc_membrane *membrane, int index, double *q, double *v)
{
    himc_bank_state(membrane->model->bank, index, q, v);
}

// of the even head's shape `index`, in what the uneven head's modes, of which `modal` has `count`,
// make of them
static double even_displacement(const himc_membrane *m, int count, const double *modal, int index)
{
    int row;
    const himc_uneven_block *block = himc_uneven_of(m->model->modes, index, &row);
    double sum = 0;
    if (!block)
        return index < count ? modal[index] : 0;
    for (int i = 0; i < block->count; i++)
        if (block->index[i] < count)
            sum += block->part[i][row] * modal[block->index[i]];
    return sum;
}

void himc_membrane_upright(const himc_membrane *membrane, int count, const double *modal,
                           double *displacement)
{
    const himc_modes *modes = membrane->model->modes;
    const himc_head *head = &membrane->model->config.head;
    const himc_mixture *mix = &modes->mixture;
    double mixed[HIMC_MIXED], now[HIMC_MODES_MAX], v;
    int known = modal ? count : himc_membrane_audible(membrane);
    for (int i = 0; !modal && i < known; i++)
        himc_membrane_state(membrane, i, &now[i], &v);
    modal = modal ? modal : now;
    for (int i = 0; i < count; i++) {
        int own = modes->disc ? himc_two_heads_upper(modes, i) : i;
        displacement[i] = own < 0 ? 0 : even_displacement(membrane, known, modal, own);
    }
    // of the bare shapes of order 0, from those of what a kettle makes of them
    for (int n = 0; n < mix->count; n++)
        mixed[n] = mix->index[n] < count ? displacement[mix->index[n]] : 0;
    for (int k = 0; k < mix->count && mix->index[k] < count; k++) {
        double sum = 0;
        for (int n = 0; n < mix->count; n++)
            sum += mix->part[n][k] * mixed[n];
        displacement[mix->index[k]] = sum;
    }
    for (int i = 0; i < count && membrane->model->config.shape.kind->air; i++) {
        himc_mode mode = himc_modes_get(modes, head, i);
        if (mode.m <= 0 || mode.sine)
            continue;
        const himc_lugs_pair *axis = &modes->pairs[mode.m];
        bool whole = i + 1 < modes->count && himc_modes_get(modes, head, i + 1).sine;
        double cosine = displacement[i],
               sine = whole ? even_displacement(membrane, known, modal, i + 1) : 0;
        displacement[i] = cosine * axis->cosine - sine * axis->sine;
        if (i + 1 < count && whole)
            displacement[i + 1] = sine * axis->cosine + cosine * axis->sine;
    }
}
