/// membrane_state.h: the parts of a membrane; shared by membrane.c (how it is made and changed),
/// membrane_step.c (how it moves) and membrane_read.c (what it is asked for). Calls go from
/// membrane.c to the other two only.
#ifndef HIMC_MEMBRANE_STATE_H
#define HIMC_MEMBRANE_STATE_H

#include "bank/bank.h"
#include "drum/membrane_form.h"
#include "head/shared.h"
#include "drum/strike_point.h"
#include "head/air.h"

#define MAX_PUSHES 8       ///< forces of himc_membrane_push in one sample; himc/membrane.h
#define STRIKE_POINTS 24   ///< all sticks and mallets of a drum (16) and all pushes (8)
#define PATCHES 4          ///< of different radii, kept; chosen: two hands and two mallets
#define DECLICK_TIME 0.005 ///< (s) chosen: no click, and shorter than a stroke's onset

/// A pickup's sound, which is read from the modes.
typedef struct output {
    himc_readout readout;
    double *response[HIMC_STEP_LENGTHS]; ///< per newton of modal force during a step (padded)
} output;

/// The weights of all modes under patches of one radius.
typedef struct patch {
    double b;          ///< (m); 0 if not in use
    unsigned long age; ///< the larger, the more recently used
    double *weight;    ///< W(k_i b), owned by the membrane (padded)
} patch;

/// All that depends on the number of modes and is allocated with it.
typedef struct core {
    himc_modes *modes;
    himc_bank *bank;
    himc_oscillator *oscillators; ///< (modes)
    double *memory;               ///< all arrays below, (padded) each, and those of strike points
    double *on_q, *on_v, *on_force, *scratch;
    double *stretch;                  ///< a_i of the film's stretching
    double *most;                     ///< largest size of a mode's shape; not of a grid's
    double *wave;                     ///< wave numbers of the bare modes (1/m); 0 of a grid's
    double *per_stiffness, *per_mass; ///< of the bare modes (m/N, 1/kg)
    patch patches[PATCHES];
    output outputs[HIMC_OUTPUTS];
    bool stale;      ///< the pickups' outputs are not of these modes: they were muted
    himc_alike rays; ///< of a round head
    himc_readout watched;
} core;

/// What a newton at a strike point during a step has done at its end.
typedef struct unit_response {
    double compliance;          ///< displacement of the point itself (m/N)
    double sound[HIMC_OUTPUTS]; ///< (1/N)
} unit_response;

/// A point of the head and its coupling to each mode. A pure function of place, patch and head, so
/// caching it does not change results.
struct strike_point {
    bool used;
    double x, y, b;       ///< place and radius of the patch (m)
    unsigned long age;    ///< the larger, the more recently used
    double *shape;        ///< phi_i W_i there, owned by the membrane (padded)
    himc_readout readout; ///< of the displacement there
    himc_residual residual;
    unit_response response[HIMC_STEP_LENGTHS]; ///< see himc_strike_point_response
    bool responds[HIMC_STEP_LENGTHS];          ///< that is known
};

/// A force at a strike point of the head (m, N).
typedef struct push {
    double x, y, b, force;
} push;

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
    himc_head head;
    himc_air air;                      ///< around it
    himc_pickup pickups[HIMC_OUTPUTS]; ///< rays from HIMC_PICKUPS on
    int pickup_count;
    bool rays;   ///< it has them
    bool muted;  ///< the pickups' sound is not wanted
    bool shares; ///< air between heads takes what the shared modes radiate
    himc_shared_mode shared[HIMC_SHARED];
    int shared_count;
    unsigned revision; ///< grows with every change of head or rate
    double rate;
    himc_step_length step; ///< of the next step
    bool ends_sample;      ///< the next step is the last one of a sample
    core core;
    double watch_x, watch_y;
    strike_point points[STRIKE_POINTS];
    unsigned long clock; ///< of the use of strike points and patches
    push pushes[MAX_PUSHES];
    int push_count;
    push applied[STRIKE_POINTS]; ///< forces of the last step, up positive
    int applied_count;
    declick declicks[HIMC_OUTPUTS];
    double sound[HIMC_OUTPUTS]; ///< of the last sample
};

/// Whether the membrane has output k, a pickup or a ray.
static inline bool himc_membrane_has(const himc_membrane *m, int k)
{
    return k < m->pickup_count || (m->rays && k >= HIMC_PICKUPS);
}

/// Whether its sound is wanted, too.
static inline bool himc_membrane_wants(const himc_membrane *m, int k)
{
    return himc_membrane_has(m, k) && !(m->muted && k < HIMC_PICKUPS);
}

/// What a newton at the point does in a step of that length, found when first asked for.
HIMC_RT const unit_response *himc_strike_point_response(himc_membrane *m, strike_point *s,
                                                        himc_step_length length);
/// The film's constant kappa: int |grad w|^2 dS times kappa is the rise of tension (N/m^3).
HIMC_RT double himc_membrane_film_stiffness(const himc_membrane *m);

/// The air around a head, over its own volume or the usual one for its radius.
static inline himc_air himc_membrane_air(const himc_head *head)
{
    return himc_air_around(head, head->kettle > 0 ? head->kettle : himc_air_kettle(head->radius));
}

#endif
