/// trial.h: one trial of the evaluation: a captured sequence, disturbed, played under one control.
#ifndef TRIAL_H
#define TRIAL_H

#include "mocap/mocap.h"
#include "himc/performance.h"
#include "control/controller.h"

/// The compared condition: one row of the published table.
typedef struct trial_kind {
    himc_nuance nuance;
    himc_pipeline controller;
    himc_law law; ///< unused by HIMC_PIPELINE_IK
} trial_kind;

/// The measures of a trial, over both hands and all frames of the capture from the first stroke's
/// preparation to the last one's end.
typedef struct trial_result {
    double rms;       ///< RMS distance of simulated and captured tips, impacts included (m)
    double outside;   ///< RMS distance of tips and their targets, outside contact (m)
    double amplitude; ///< mean height of the captured strokes, apex to impact (m)
    double elbow;     ///< range of the elbow's height, simulated / captured
    double shoulder_error, elbow_error, wrist_error; ///< RMS angle to the captured joints (rad)
    double strokes;                                  ///< number captured
    double played;                                   ///< number of these struck within 5 ms, 2 cm
} trial_result;

#define TRIAL_SPOTS 3
/// Trials with numbers that differ by this play the same sequence with different disturbances.
#define TRIAL_SEQUENCES (HIMC_MOCAP_PLAYERS * TRIAL_SPOTS)

himc_word trial_controller_name(himc_pipeline controller);
himc_word trial_law_name(const trial_kind *kind); ///< "none" for `ik`

/// A frame of a trial, captured and simulated, in the library's coordinates.
typedef struct trial_frame {
    double time;                   ///< from the take's first frame (s)
    const himc_skeleton *skeleton; ///< of the captured body
    const himc_pose *captured_pose;
    const himc_body_state *captured;
    const himc_motion_row *simulated;
    const himc_body_state *simulated_body;
} trial_frame;

/// The settings of a trial.
typedef struct trial_config {
    trial_kind kind;
    int number;          ///< from 1: selects player, spot and disturbance
    double noise;        ///< standard deviation of each marker coordinate (m)
    double mass_error;   ///< standard deviation of true / assumed mass of the segments
    double length_error; ///< standard deviation of assumed / true length, except of the sticks
    double gain;         ///< servo frequencies / default ones
    double pace;         ///< speed of the sequence / its own
    bool bent;           ///< `id` bends the arms to the tips; else as published (command `bend`)
    bool limits;         ///< uses the joint limits learned from the take
    void (*frame)(void *user, const trial_frame *frame); ///< called at each frame, or NULL
    void *user;
} trial_config;

/// The settings of the evaluation.
trial_config trial_default(const trial_kind *kind, int number);

/// The sequence of the motion database that a trial plays.
himc_mocap_config trial_sequence(const trial_config *config);
/// Strokes per second of one hand in that sequence, at its pace; NAN if it cannot be made.
double trial_own_rate(const trial_config *config);

/// Gives a performance the controller, law and gains of a trial, and its limits.
bool trial_set_control(himc_performance *performance, const trial_config *config,
                       himc_error *error);

/// Runs a trial. The disturbance depends on the number only, not on the controller. False with the
/// reason.
bool trial_run(const trial_config *config, trial_result *result, himc_error *error);

#endif
