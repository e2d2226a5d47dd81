/// character.h: the dynamic layer: the body as rigid capsules on ball joints in the Open Dynamics
/// Engine (2012 paper, equation 1: D). Torques move it, never motors; the pelvis is the world.
#ifndef HIMC_CHARACTER_H
#define HIMC_CHARACTER_H

#include "himc/body.h"

typedef struct himc_character himc_character;

/// A body at rest in the zero pose. Call from the thread that will step it. NULL if the engine
/// refuses.
himc_character *himc_character_new(const himc_skeleton *skeleton, himc_error *error);
void himc_character_free(himc_character *character);

/// Puts the body into a state: orientations and spins count, the rest follows from them.
HIMC_RT void himc_character_place(himc_character *character, const himc_body_state *state);

/// Reads the kinematic layer back from the dynamic one.
HIMC_RT void himc_character_observe(const himc_character *character, himc_body_state *state);

/// A force on a segment's centre of mass (not the pelvis, which is held) during the next step alone
/// (world frame, N); several add up.
HIMC_RT void himc_character_push(himc_character *character, int segment, himc_vec3 force);

/// One step of `h` seconds (1e-5 .. 0.01): `torque` of each joint on its child, the opposite on
/// the parent (world frame, N m); `tip_force` on each drumstick tip (N). Gravity is the engine's.
/// False, and nothing done, if a torque, a force or the body's state is not finite or faster than
/// 3000 rad/s: the engine would end the process.
HIMC_RT bool himc_character_step(himc_character *character, const himc_vec3 torque[HIMC_JOINTS],
                                 const himc_vec3 tip_force[HIMC_HANDS], double h);

#endif
