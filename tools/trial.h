/// trial.h: one trial of the evaluation: a captured sequence, disturbed, played under one control.
#ifndef TRIAL_H
#define TRIAL_H

#include "../mocap/mocap.h"
#include "himc/performance.h"
#include "control/controller.h"

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
    double outside;   ///< to their targets, outside contact (m)
    double amplitude; ///< mean height of the captured strokes, apex to impact (m)
    double elbow;     ///< range of the elbow's height, simulated over captured
    double shoulder_error, elbow_error, wrist_error; ///< RMS angle to the captured joints (rad)
    double strokes;                                  ///< captured
    double played;                                   ///< of these, struck within 5 ms and 2 cm
} trial_result;

#define TRIAL_LAWS 3
#define TRIAL_SPOTS 3
/// Trials whose numbers differ by this play the same sequence, otherwise disturbed.
#define TRIAL_SEQUENCES (HIMC_MOCAP_PLAYERS * TRIAL_SPOTS)

himc_word trial_controller_name(himc_pipeline controller);
himc_word trial_law_name(const trial_kind *kind); ///< "none" for `ik`

/// A frame of a trial: what was captured, in our coordinates, and what was simulated.
typedef struct trial_frame {
    double time; ///< from the take's first frame (s)
    const himc_pose *captured_pose;
    const himc_body_state *captured;
    const himc_motion_row *simulated;
    const himc_body_state *simulated_body;
} trial_frame;

/// How a trial is played.
typedef struct trial_config {
    trial_kind kind;
    int number;         ///< from 1: which player, spot and disturbance
    double noise;       ///< of each marker's coordinate (m)
    double misjudged;   ///< standard deviation of the segments' weights over what control believes
    double mismeasured; ///< and of their lengths, the sticks apart, over what the take shows
    double gain;        ///< frequencies of the servos over the default ones
    double pace;        ///< of the sequence over its own
    bool bent;          ///< `id` bends the arms to the tips; else as published (command `bend`)
    bool limits;        ///< joint limits learned from the take are kept
    void (*frame)(void *user, const trial_frame *frame); ///< called at each one, or NULL
    void *user;
} trial_config;

/// As the evaluation plays it.
trial_config trial_default(const trial_kind *kind, int number);

/// The sequence of the motion database that it plays.
himc_mocap_config trial_sequence(const trial_config *config);
/// Strokes a second with one hand in that sequence, at its pace; NAN if it cannot be made.
double trial_own_rate(const trial_config *config);

/// Runs a trial. The disturbance is its number's, the same for every controller.
bool trial_run(const trial_config *config, trial_result *result, himc_error *error);

#endif
