/// performance_settings.h: the settings made by commands; `reset` restores the default.
#ifndef HIMC_PERFORMANCE_SETTINGS_H
#define HIMC_PERFORMANCE_SETTINGS_H

#include "body/character.h"
#include "control/controller.h"
#include "himc/performance.h"
#include "plan/human.h"

/// The captured rest pose: the posture of a take's player.
typedef struct captured_player {
    bool known[HIMC_JOINTS];  ///< joints of `rest` that the take shows
    himc_pose rest;           ///< mean of neck, head and legs
    himc_trunk_posture trunk; ///< mean of the trunk; valid if its joint is known
} captured_player;

/// The gain of a joint as it was asked for.
typedef struct asked_gain {
    double stiffness, damping; ///< (N m/rad, N m s/rad)
    double frequency;          ///< instead, over the usual natural frequency; 0: not so
} asked_gain;

typedef struct performance_settings {
    double physics_rate, task_rate; ///< requested (Hz)
    himc_skeleton_config skeleton;
    double asked_height, asked_mass; ///< by `player` (m, kg), also of a take's player; 0: not asked
    double weight[HIMC_SEGMENTS];    ///< mass of each simulated segment over its assumed mass
    himc_controller_config control;
    asked_gain gain[HIMC_JOINTS]; ///< where control.gain_set
    himc_engine engine;
    himc_limits_kind limits;
    himc_grip grip;
    bool servo; ///< strokes have one contact each, though they shall bounce
    himc_human human;
    bool alive;     ///< head, weight and breath follow the music
    double latency; ///< of a hit, from its message to its contact; 0: as soon as it can (s)
    bool one_way;   ///< the head's vibration does not push back on the stick
    bool unbent;    ///< `id` follows a take's arms as captured
    captured_player captured;
} performance_settings;

/// Chosen: softer than f nothing is lost, at f 2 dB.
#define USUAL_LATENCY 0.15 // (s)

/// The settings of a new performance with that configuration.
performance_settings himc_settings_default(const himc_performance_config *config);

/// Sets the gains of the joints as they were asked for, for the body of that controller.
void himc_settings_gains(performance_settings *settings, const himc_controller *controller);

/// True if the captured trunk is known; it replaces the natural one.
static inline bool himc_settings_trunk_known(const performance_settings *settings)
{
    return settings->captured.known[HIMC_TRUNK - 1];
}

#endif
