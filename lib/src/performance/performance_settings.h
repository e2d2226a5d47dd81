/// performance_settings.h: what commands set; `reset` puts the default back.
#ifndef HIMC_PERFORMANCE_SETTINGS_H
#define HIMC_PERFORMANCE_SETTINGS_H

#include "control/controller.h"
#include "himc/performance.h"

/// How the player of a take holds the body.
typedef struct captured_player {
    bool known[HIMC_JOINTS];  ///< joints of `rest` that the take shows
    himc_pose rest;           ///< mean of neck, head and legs
    himc_trunk_posture trunk; ///< mean of the trunk; of use if its joint is known
} captured_player;

typedef struct performance_settings {
    double physics_rate, task_rate; ///< asked for (Hz)
    himc_skeleton_config skeleton;
    double weight[HIMC_SEGMENTS]; ///< of each simulated segment over the one control believes in
    himc_controller_config control;
    himc_limits_kind limits;
    himc_grip grip;
    bool one_way; ///< the head's vibration does not push back on the stick
    bool unbent;  ///< `id` follows a take's arms as captured
    captured_player captured;
} performance_settings;

/// Those of a performance just made with that configuration.
performance_settings himc_settings_default(const himc_performance_config *config);

/// Whether the captured trunk is known: then it is held instead of the natural one.
static inline bool himc_settings_trunk_known(const performance_settings *settings)
{
    return settings->captured.known[HIMC_TRUNK - 1];
}

#endif
