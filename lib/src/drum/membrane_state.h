/// membrane_state.h: a head in motion: its model and its state; shared by membrane.c (how it is
/// made and changed), membrane_step.c (how it moves) and membrane_read.c (what it is asked for).
/// Calls go from membrane.c to the other two only.
#ifndef HIMC_MEMBRANE_STATE_H
#define HIMC_MEMBRANE_STATE_H

#include "drum/model.h"

#define MAX_PUSHES 8       ///< forces of himc_membrane_push in one sample; himc/membrane.h
#define DECLICK_TIME 0.005 ///< (s) chosen: no click, and shorter than a stroke's onset

/// A force at a strike point of the head (m, N).
typedef struct himc_push {
    double x, y, b, force;
} himc_push;

/// When head, pickup or rate change, the sound would jump by a step, and its slope by another. The
/// difference between the sound before and after the change is added back as the cubic that starts
/// with both and ends with value and slope zero: no click, and no filter in the signal at any other
/// time.
typedef struct declick {
    double step, slope; ///< at its start: (1.0 as the pickup's), and per sample
    int at, length;     ///< (samples); at the end, and after it, at is length + 1
} declick;

/// What is added to sample `at`, which may lie just before the start.
static inline double declick_at(const declick *d, int at)
{
    if (d->length == 0 || at >= d->length)
        return 0;
    double t = (double)at / d->length, u = 1 - t;
    return u * u * ((1 + 2 * t) * d->step + t * d->length * d->slope);
}

struct himc_membrane {
    himc_model *model;     ///< owned; with the state of its modes
    unsigned revision;     ///< grows with every change of head or rate
    himc_wires wires;      ///< on the lower head, if it has one
    himc_step_length step; ///< of the next step
    bool ends_sample;      ///< the next step is the last one of a sample
    double watch_x, watch_y;
    himc_push pushes[MAX_PUSHES];
    int push_count;
    himc_push applied[HIMC_STRIKE_POINTS]; ///< forces of the last step, up positive
    int applied_count;
    double disc, speed; ///< of a motor: 0 open, .5 shut .. 1; swings a second, as last set
    declick declicks[HIMC_OUTPUTS];
    double sound[HIMC_OUTPUTS]; ///< of the last sample
};

/// Whether output k of the membrane, a pickup or a ray, sounds.
static inline bool himc_membrane_has(const himc_membrane *m, int k)
{
    return himc_membrane_config_has(&m->model->config, k);
}

/// What a newton at the point does in a step of that length, found when first asked for.
HIMC_RT const himc_unit_response *himc_strike_point_response(himc_membrane *m, strike_point *s,
                                                             himc_step_length length);

/// The wires after a step of the head: how they would come nearer (HIMC_WIRES), and their end with
/// the forces that they have now. Asleep they do nothing.
HIMC_RT void himc_membrane_begin_wires(himc_membrane *m, double h, double *b);
HIMC_RT void himc_membrane_end_wires(himc_membrane *m, double h, const double *b);
/// Both, without sticks.
HIMC_RT void himc_membrane_rattle(himc_membrane *m, double h);
/// After the head was changed: the wires lie on what they have now.
HIMC_RT void himc_membrane_keep_wires(himc_membrane *m, double pull_before);

HIMC_RT const himc_membrane_config *himc_membrane_config_of(const himc_membrane *membrane);
/// A membrane at rest with that model, which it owns from now on. NULL, and the model freed, with
/// the reason; a model that is NULL has one.
himc_membrane *himc_membrane_new_of(himc_model *model, himc_error *error);

/// Gives the membrane another model, between two samples; returns the former one, the caller's from
/// now on. Modes of the same outline keep energy and phase, the sound of those that no longer exist
/// ends in 5 ms, and there is no click; another outline begins at rest.
HIMC_RT himc_model *himc_membrane_exchange(himc_membrane *membrane, himc_model *model);
/// Takes its model a share (0 .. 1) of the way to another one of the same head at another tension;
/// otherwise the same.
HIMC_RT void himc_membrane_approach(himc_membrane *membrane, himc_model *goal, double share);
/// The same as an exchange for a config; without allocation if its model has room in the present
/// one's place (himc_model_has_room). False with the reason, and nothing changed, if there is no
/// such head.
bool himc_membrane_become(himc_membrane *membrane, const himc_membrane_config *config,
                          himc_error *error);

/// Sets its rays (HIMC_RAYS, of kind AIR), or NULL for none. Their sound begins, or changes over,
/// in 5 ms; the pickups do not notice.
HIMC_RT void himc_membrane_set_rays(himc_membrane *membrane, const himc_pickup *rays);
/// Whether the air between this head and others takes what its shared modes radiate.
HIMC_RT void himc_membrane_share(himc_membrane *membrane, bool shares);

/// himc_membrane_run with a row for each of the HIMC_OUTPUTS; rows of muted pickups stay as they
/// are.
HIMC_RT void himc_membrane_run_all(himc_membrane *membrane, int n, double *const *sound,
                                   double *watched);
/// Whether the sound of the pickups is not wanted: himc_membrane_sound is then 0.
HIMC_RT void himc_membrane_mute_pickups(himc_membrane *membrane, bool mute);

#endif
