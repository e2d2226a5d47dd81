/// performance_settings.h: the settings made by commands, a row each (himc/command_rows.h); `reset`
/// restores the default.
#ifndef HIMC_PERFORMANCE_SETTINGS_H
#define HIMC_PERFORMANCE_SETTINGS_H

#include "base/line.h"
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

/// In the order of the words of `stance`.
typedef enum himc_stance {
    HIMC_STANCE_FIXED,   ///< the pelvis is bolted to the world
    HIMC_STANCE_SEATED,  ///< it rests on a stool, the feet on the floor
    HIMC_STANCE_STANDING ///< he stands on his feet
} himc_stance;

/// In the order of the words of `sync`.
typedef enum himc_sync { HIMC_SYNC_MIDI, HIMC_SYNC_PHASE, HIMC_SYNC_OFF } himc_sync;

/// In the order of the words of `noteoff`.
typedef enum himc_noteoff { HIMC_NOTEOFF_RING, HIMC_NOTEOFF_DAMP } himc_noteoff;

/// In the order of the words of `coupling`.
typedef enum himc_coupling { HIMC_COUPLING_TWO_WAY, HIMC_COUPLING_ONE_WAY } himc_coupling;

typedef struct performance_settings {
    double physics_rate, task_rate; ///< requested (Hz)
    himc_skeleton_config skeleton;
    double asked_height, asked_mass; ///< by `player` (m, kg), also of a take's player; 0: not asked
    double weight[HIMC_SEGMENTS];    ///< mass of each simulated segment over its assumed mass
    himc_controller_config control;
    asked_gain gain[HIMC_JOINTS]; ///< where control.gain_set
    himc_engine engine;
    himc_stance stance;
    himc_limits_kind limits;
    himc_grip grip;
    bool servo; ///< strokes have one contact each, though they shall bounce
    himc_human human;
    bool alive;     ///< head, weight and breath follow the music
    double latency; ///< of a hit, from its message to its contact; 0: as soon as it can (s)
    himc_sync sync;
    double subdivide; ///< parts of a beat that are told
    himc_noteoff noteoff;
    himc_coupling coupling;
    bool bend; ///< `id` bends a take's arms to its tips, else it follows them as captured
    captured_player captured;
} performance_settings;

/// The settings of a new performance with that configuration.
performance_settings himc_settings_default(const himc_performance_config *config);

/// The consequence of a changed setting, besides that controller and engine get it.
typedef enum setting_effect {
    AFTER_NOTHING,
    AFTER_REPLAN, ///< the next task is read again
    AFTER_STEPS,  ///< a step begins, with these rates
    AFTER_BODY,   ///< another body
    AFTER_MODE,   ///< the engine takes up the kinematic pose; a regression follows otherwise
    AFTER_LIMITS, ///< other limits
    AFTER_FADER,  ///< with one number the drums', not the joints' gain
    AFTER_GRIP,   ///< the planner's grip
    AFTER_HUMAN   ///< the planner's variation
} setting_effect;

HIMC_RT setting_effect himc_settings_effect(himc_command_id id);
/// Sets what a command says, and nothing if it is no setting. `usual` are the default settings: a
/// number that equals theirs in single precision becomes theirs. False with the reason.
HIMC_RT bool himc_settings_read(performance_settings *settings, const performance_settings *usual,
                                const himc_command *command, himc_error *error);
/// Tells the settings from one row to another (not told) as commands.
void himc_settings_tell(const performance_settings *settings, himc_command_id from,
                        himc_command_id to, const himc_line_sink *sink);

/// True if the captured trunk is known; it replaces the natural one.
static inline bool himc_settings_trunk_known(const performance_settings *settings)
{
    return settings->captured.known[HIMC_TRUNK - 1];
}

#endif
