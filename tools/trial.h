/// trial.h: one trial of the evaluation: a captured sequence, disturbed, played under one control.
#ifndef TRIAL_H
#define TRIAL_H

#include "himc/controller.h"

/// What is compared: one row of the published table.
typedef struct trial_kind {
    himc_nuance nuance;
    himc_pipeline controller;
    himc_law law; ///< means nothing to HIMC_PIPELINE_IK
} trial_kind;

/// What a trial measures. Distances are between captured and simulated tips at the capture's
/// frames, both hands, from the first stroke's preparation to the last one's end.
typedef struct trial_result {
    double rms;       ///< impacts included (m)
    double outside;   ///< the same outside contact (m)
    double amplitude; ///< mean height of the captured strokes, apex to impact (m)
    double elbow;     ///< range of the elbow's height, simulated over captured
    double shoulder_error, elbow_error, wrist_error; ///< RMS angle to the captured joints (rad)
    double strokes;                                  ///< captured
    double played;                                   ///< of these, struck within 5 ms and 2 cm
} trial_result;

#define TRIAL_LAWS 3

const char *trial_controller_name(himc_pipeline controller);
const char *trial_law_name(const trial_kind *kind); ///< "none" for `ik`

/// Runs trial `number` (from 1). The disturbance is that number's, the same for every controller.
bool trial_run(const trial_kind *kind, int number, trial_result *result, himc_error *error);

#endif
