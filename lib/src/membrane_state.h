/// membrane_state.h: what a membrane is made of; shared by membrane.c (what it is) and
/// membrane_step.c (how it moves).
#ifndef HIMC_MEMBRANE_STATE_H
#define HIMC_MEMBRANE_STATE_H

#include "himc/air.h"

#include "fade.h"
#include "spot.h"

#define PUSHES 8
#define GLANCE 64 ///< samples between looks whether the film is still stretched

/// What a pickup reads: of the state, and of forces directly.
typedef struct ear {
    himc_tap tap;
    double *answer; ///< sound per newton of modal force in the sample (padded)
} ear;

/// What depends on the number of modes and is allocated with it.
typedef struct core {
    himc_modes *modes;
    himc_bank *bank;
    himc_oscillator *oscillators; ///< (modes)
    double *memory;               ///< all arrays below, (padded) each, and the spots'
    double *on_q, *on_v, *on_force, *scratch;
    double *stretch, *weight; ///< a_i of the film's stretching; the same as the bank takes it
    himc_pull pull;
    ear ears[HIMC_PICKUPS];
    himc_tap watch;
    double *watch_answer; ///< displacement there per newton of modal force
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
    core core;
    double watch_x, watch_y;
    spot spots[SPOTS];
    unsigned long clock; ///< of the spots' use
    tension tension;
    push pushes[PUSHES];
    int push_count;
    fade fades[HIMC_PICKUPS];
    double heard[HIMC_PICKUPS], seen; ///< of the last sample
};

/// kappa: what int |grad w|^2 dS adds to the tension, by glide (N/m^3).
HIMC_RT double himc_membrane_film(const himc_membrane *m);

#endif
