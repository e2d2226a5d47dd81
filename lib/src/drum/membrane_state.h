/// membrane_state.h: what a membrane is made of; shared by membrane_core.c (how that follows from
/// its head), membrane.c (what it is and how it changes) and membrane_step.c (how it moves).
#ifndef HIMC_MEMBRANE_STATE_H
#define HIMC_MEMBRANE_STATE_H

#include "drum/air.h"

#include "drum/declick.h"
#include "drum/strike_point.h"

#define PUSHES 8
#define GLANCE 64 ///< samples between looks whether the film is still stretched

/// What a pickup reads: of the state, and of forces directly.
typedef struct ear {
    himc_readout tap;
    double *answer[HIMC_BANK_SUBSTEPS]; ///< sound per newton of modal force in a step (padded)
} ear;

/// What depends on the number of modes and is allocated with it.
typedef struct core {
    himc_modes *modes;
    himc_bank *bank;
    himc_oscillator *oscillators; ///< (modes)
    double *memory;               ///< all arrays below, (padded) each, and the spots'
    double *on_q, *on_v, *on_force, *scratch;
    double *stretch, *weight; ///< a_i of the film's stretching; the same as the bank takes it
    himc_tension_coupling pull;
    ear ears[HIMC_PICKUPS];
    himc_readout watch;
    double *watch_answer[HIMC_BANK_SUBSTEPS]; ///< displacement there per newton of modal force
} core;

/// The film's stretching (membrane_step.c).
typedef struct tension {
    bool on;
    double s;        ///< root of twice its energy (J^1/2)
    double base;     ///< mean of s in this sample if no stick pressed
    double half;     ///< what a stick's push through the pull takes off that mean
    unsigned glance; ///< samples since the last look
} tension;

typedef struct push {
    double x, y, force;
} push;

struct himc_membrane {
    himc_head head;
    himc_air air; ///< around it
    himc_pickup pickups[HIMC_PICKUPS];
    int pickup_count;
    double rate;
    int gear;       ///< of the step that comes: a sample or a part of it
    bool part_last; ///< it ends a sample
    core core;
    double watch_x, watch_y;
    spot spots[SPOTS];
    unsigned long clock; ///< of the spots' use
    tension tension;
    push pushes[PUSHES];
    int push_count;
    push pressed[SPOTS]; ///< forces of the last step, up positive
    int pressed_count;
    fade fades[HIMC_PICKUPS];
    double heard[HIMC_PICKUPS], seen; ///< of the last sample
};

/// Modes, bank and arrays for `count` modes of that outline, and the spots' arrays in them. False,
/// and nothing kept, if there is no memory.
bool himc_core_new(core *c, spot spots[SPOTS], const himc_shape *shape, int count,
                   himc_error *error);
void himc_core_free(core *c);

/// Volume under a head (m^3): its own, or the usual one for its radius.
HIMC_RT double himc_head_kettle(const himc_head *head);
/// A bare mode as it sounds, with its air.
HIMC_RT himc_mode himc_membrane_loaded(const himc_membrane *m, const himc_mode *bare);
/// After head or rate changed: oscillators and taps. Spots are computed again when asked for.
HIMC_RT void himc_membrane_retune(himc_membrane *m);
/// After pickup `index`, or the watched place, changed.
HIMC_RT void himc_membrane_aim_ear(himc_membrane *m, int index);
HIMC_RT void himc_membrane_aim_watch(himc_membrane *m);
/// The film's energy as the state has it.
HIMC_RT void himc_membrane_find_tension(himc_membrane *m);
/// After a change: no more than `energy` (J) is left, the head bent less if need be.
HIMC_RT void himc_membrane_keep_energy(himc_membrane *m, double energy);
/// kappa: what int |grad w|^2 dS adds to the tension, by glide (N/m^3).
HIMC_RT double himc_membrane_film(const himc_membrane *m);

#endif
