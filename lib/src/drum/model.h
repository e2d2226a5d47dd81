/// model.h: a head at a sample rate, as numbers: what is the same however it moves. Its state is a
/// membrane (membrane_state.h), which has a pointer to its model.
///
/// A model is made from a config, in any thread, and changes no more while it is in use; another
/// head is another model, whose pointer takes the place of the first one
/// (himc_membrane_exchange). Only where no memory may be had, its membrane has it made anew in its
/// own place, between two samples.
#ifndef HIMC_MODEL_H
#define HIMC_MODEL_H

#include "drum/membrane_config.h"
#include "drum/strike_point.h"
#include "head/air.h"
#include "head/two_heads.h"

#define HIMC_STRIKE_POINTS 24 ///< all sticks and mallets of a drum (16) and all pushes (8)
#define HIMC_PATCHES 4        ///< of different radii, kept; chosen: two hands and two mallets

/// A pickup's sound, which is read from the modes.
typedef struct himc_output {
    himc_readout readout;
    double *response[HIMC_STEP_LENGTHS]; ///< per newton of modal force during a step (padded)
} himc_output;

/// The weights of all modes under patches of one radius.
typedef struct himc_patch {
    double b;          ///< (m); 0 if not in use
    unsigned long age; ///< the larger, the more recently used
    double *weight;    ///< W(k_i b) (padded)
} himc_patch;

/// What a newton at a strike point during a step has done at its end.
typedef struct himc_unit_response {
    double compliance;          ///< displacement of the point itself (m/N)
    double sound[HIMC_OUTPUTS]; ///< (1/N)
} himc_unit_response;

/// A point of the head and its coupling to each mode.
struct strike_point {
    bool used;
    double x, y, b;       ///< place and radius of the patch (m)
    unsigned long age;    ///< the larger, the more recently used
    double *shape;        ///< phi_i W_i there (padded)
    himc_readout readout; ///< of the displacement there
    himc_residual residual;
    himc_unit_response response[HIMC_STEP_LENGTHS]; ///< see himc_strike_point_response
    double under[HIMC_STEP_LENGTHS][HIMC_WIRES];    ///< displacement of the wires' points (m/N)
    bool responds[HIMC_STEP_LENGTHS];               ///< that is known
};

/// The wires' points of a lower head, and what a newton at one of them does in a step.
typedef struct himc_under {
    double *shape; ///< HIMC_WIRES rows (padded); NULL: there is no such head
    himc_wires_matrix compliance[HIMC_STEP_LENGTHS];           ///< (m/N)
    double sound[HIMC_STEP_LENGTHS][HIMC_OUTPUTS][HIMC_WIRES]; ///< (1/N)
} himc_under;

typedef struct himc_model {
    himc_membrane_config config;
    himc_air air; ///< around the head
    himc_shared_mode shared[HIMC_SHARED];
    int shared_count;
    himc_modes *modes;
    himc_oscillator *oscillators;     ///< (modes)
    double *memory;                   ///< all arrays (padded) here
    double *stretch;                  ///< a_i of the film's stretching
    double *most;                     ///< largest size of a mode's shape; INFINITY: not known
    double *wave;                     ///< wave numbers of the bare modes (1/m)
    double *per_stiffness, *per_mass; ///< of the bare modes (m/N, 1/kg)
    himc_output outputs[HIMC_OUTPUTS];
    himc_under under;
    himc_readout tubes; ///< of a motor, at 1 m
    himc_alike rays;    ///< of a kind whose rays have a form
    // room for what a membrane has of so many modes: its state, and what it keeps of pure functions
    // of the model
    himc_bank *bank;
    double *on_q, *on_v, *on_force, *scratch;
    himc_readout watched;
    himc_patch patches[HIMC_PATCHES];
    strike_point points[HIMC_STRIKE_POINTS];
    unsigned long clock; ///< of the use of strike points and patches
} himc_model;

/// The model of a config; its grid is retained. `like`, or NULL, is one whose list of modes it may
/// share, and whose numbers it copies if they have the same config. NULL with the reason.
himc_model *himc_model_new(const himc_membrane_config *config, const himc_model *like,
                           himc_error *error);
void himc_model_free(himc_model *model);
/// Whether himc_model_make can make a model of that config out of this one.
HIMC_RT bool himc_model_has_room(const himc_model *model, const himc_membrane_config *config);
/// Makes the model anew, in its own place; what is in its bank keeps energy and phase, and what is
/// muted stays so.
HIMC_RT void himc_model_make(himc_model *model, const himc_membrane_config *config);
/// Takes the model a share (0 .. 1) of the way to `goal`, the same head at another tension: all
/// frequencies by that share of their ratio. Shapes stay, what is in its bank keeps energy and
/// phase.
HIMC_RT void himc_model_approach(himc_model *model, himc_model *goal, double share);
/// Outputs from `first` to `end` that sound; strike points are forgotten, as they hold responses to
/// them.
HIMC_RT void himc_model_find_outputs(himc_model *model, int first, int end);
/// The readout of the displacement at a point.
HIMC_RT void himc_model_watch(himc_model *model, double x, double y);
/// A mode as its oscillator has it: without the decay that the air between heads takes over.
HIMC_RT himc_mode himc_model_mode(const himc_model *model, int index);
/// The film's constant kappa: int |grad w|^2 dS times kappa is the rise of tension (N/m^3).
HIMC_RT double himc_model_film_stiffness(const himc_model *model);
/// Interval between two exchanges with other heads at a rate (Hz): 8, 16, 32 or 64 samples.
HIMC_RT int himc_membrane_interval(double rate);

#endif
