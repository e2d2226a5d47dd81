/// character.h: the dynamic layer: the body as rigid segments on ball joints (2012 paper, equation
/// 1: D), moved by the Open Dynamics Engine or by the same equations solved along the tree;
/// private. Joint torques move it, no motors; the pelvis is fixed to the world, or free.
#ifndef HIMC_CHARACTER_H
#define HIMC_CHARACTER_H

#include "body/energy.h"

typedef struct himc_character himc_character;

/// A body at rest in the zero pose. Call it from the thread that will step the body. NULL, with an
/// error, if memory is short. Free it with himc_character_free.
himc_character *himc_character_new(const himc_skeleton *skeleton, himc_error *error);
void himc_character_free(himc_character *character);

/// Who solves the equations of a step. In the order of the words of `engine`.
typedef enum himc_engine {
    HIMC_ENGINE_TREE, ///< this library, along the tree (tree.c); the default
    HIMC_ENGINE_ODE   ///< dWorldStep
} himc_engine;

/// Chooses the engine, from the next step on. Both make the same motion to rounding.
HIMC_RT void himc_character_use(himc_character *character, himc_engine engine);
HIMC_RT himc_engine himc_character_engine(const himc_character *character);

/// Sets the height of the pelvis (m), which takes the body along; a body that himc_character_place
/// has refused is then in the zero pose. False, and nothing changed, if the height is not finite.
HIMC_RT bool himc_character_seat(himc_character *character, double height);

/// Sets the body to a state. Only orientations and spins are used, the rest follows from them.
/// False if the engine would end the process for it; then there are no steps.
HIMC_RT bool himc_character_place(himc_character *character, const himc_body_state *state);

/// Reads the body's state: the kinematic layer from the dynamic layer.
HIMC_RT void himc_character_observe(const himc_character *character, himc_body_state *state);

/// Adds up the work on the body in `work` from now on; NULL: no longer.
HIMC_RT void himc_character_account(himc_character *character, himc_body_work *work);
/// Kinetic and potential energy of all segments (J).
HIMC_RT double himc_character_kinetic(const himc_character *character);
HIMC_RT double himc_character_potential(const himc_character *character);

/// The articulated inertias at the present state: computed at most once a step, and valid until
/// the next one. Legs at rest take no part, but their entries hold.
HIMC_RT const himc_articulation *himc_character_articulation(himc_character *character);

/// The contact of a drumstick's tip.
static inline world_contact himc_tip_contact(const himc_skeleton *skeleton, himc_hand hand,
                                             himc_vec3 force, double *work)
{
    return (world_contact){
        .segment = himc_stick_segment(hand), .at = skeleton->tip, .force = force, .work = work};
}

/// One step of `h` seconds (1e-5 .. 0.01) under gravity, the `torque` of each joint on its child
/// and its opposite on the parent (world frame, N m), and the contacts with the world (contacts).
/// False, without a step, if a torque or a force is not finite; false also if the body's state is
/// not finite afterwards, or a segment rotates faster than 3000 rad/s: the engine would end the
/// process. Then there are no steps until himc_character_place.
HIMC_RT bool himc_character_step(himc_character *character, const himc_vec3 torque[HIMC_JOINTS],
                                 const world_contact *contact, int contacts, double h);

#endif
