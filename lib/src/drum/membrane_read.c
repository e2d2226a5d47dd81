/// membrane_read.c: what a membrane is asked for: its head, modes and pitch, and the shapes that it
/// has now. Nothing changes it.
#include "drum/drum_performer.h"
#include "drum/membrane_state.h"

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

int himc_membrane_modes(const himc_membrane *membrane)
{
    return himc_modes_count(membrane->model->modes);
}

himc_mode himc_membrane_mode(const himc_membrane *membrane, int index)
{
    if (index >= himc_membrane_modes(membrane))
        return (himc_mode){0};
    himc_mode bare = himc_modes_get(membrane->model->modes, &membrane->model->config.head, index);
    return membrane->model->config.head.air
               ? himc_air_mode(&membrane->model->air, &membrane->model->config.head, &bare)
               : bare;
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

// a mode's displacement: that of `modal`, which has `count`, or if that is NULL its own
static double coordinate(const himc_membrane *membrane, int count, const double *modal, int index)
{
    double q, v;
    if (modal)
        return index < count ? modal[index] : 0;
    himc_membrane_state(membrane, index, &q, &v);
    return q;
}

void himc_membrane_upright(const himc_membrane *membrane, int count, const double *modal,
                           double *displacement)
{
    const himc_modes *modes = membrane->model->modes;
    double pair[2] = {0, 0};
    for (int i = 0; i < count; i++) {
        himc_mode mode = himc_modes_get(modes, &membrane->model->config.head, i);
        displacement[i] = coordinate(membrane, count, modal, i);
        if (mode.m <= 0 || !membrane->model->config.shape.kind->air)
            continue;
        const himc_lugs_pair *axis = &himc_modes_pairs(modes)[mode.m];
        bool whole = i + 1 < himc_modes_count(modes) &&
                     himc_modes_get(modes, &membrane->model->config.head, i + 1).sine;
        if (!mode.sine) {
            pair[0] = displacement[i];
            pair[1] = whole ? coordinate(membrane, count, modal, i + 1) : 0;
        }
        displacement[i] = mode.sine ? pair[1] * axis->cosine + pair[0] * axis->sine
                                    : pair[0] * axis->cosine - pair[1] * axis->sine;
    }
    // the bare shapes of order 0, from what a kettle makes of them
    const himc_mixture *mix = himc_modes_mixture(modes);
    for (int k = 0; k < mix->count && mix->index[k] < count; k++) {
        double *sum = &displacement[mix->index[k]];
        *sum = 0;
        for (int n = 0; n < mix->count; n++)
            *sum += mix->part[n][k] * coordinate(membrane, count, modal, mix->index[n]);
    }
}
