/// inner_state.h: the inner state of a head, which only tests set and read.
#ifndef HIMC_TESTS_INNER_STATE_H
#define HIMC_TESTS_INNER_STATE_H

#include "drum/drum_performer.h"
#include "drum/membrane_state.h"

#include <math.h>

/// Gives the membrane another head of the same outline.
static inline bool himc_membrane_set_head(himc_membrane *m, const himc_head *head,
                                          himc_error *error)
{
    himc_membrane_config config = m->model->config;
    config.head = *head;
    return himc_membrane_become(m, &config, error);
}

/// Sets displacement q and velocity v of mode `index` (m, m/s); no effect on a silent mode.
static inline void himc_membrane_excite(himc_membrane *m, int index, double q, double v)
{
    himc_bank_excite(m->model->bank, index, q, v);
    himc_bank_find_film(m->model->bank);
}

/// Displacement at (x, y) (m, up positive).
static inline double himc_membrane_displacement(himc_membrane *m, double x, double y)
{
    return himc_strike_point_displacement(m, himc_membrane_strike_point(m, x, y, 0));
}

/// Rise of the tension as the head bows out (N/m).
static inline double himc_membrane_rise(const himc_membrane *m)
{
    return sqrt(2 * himc_model_film_stiffness(m->model)) * himc_bank_film(m->model->bank);
}

#endif
