/// still_controller.h: a controller of the default body at rest, on the joint targets and the
/// tips', for tests of single terms.
#ifndef HIMC_TESTS_STILL_CONTROLLER_H
#define HIMC_TESTS_STILL_CONTROLLER_H

#include "bodies.h"
#include "control/controller.h"

#include <string.h>

#define LEVEL 0.8675 // of the sticks (m)

static himc_reference reference;
static himc_body_state state;
static himc_pose pose;

static inline himc_controller still_controller(void)
{
    himc_controller controller;
    himc_posture posture;
    himc_vec3 tip[HIMC_HANDS] = {{0.48, 0.05, LEVEL + 0.1}, {0.46, -0.05, LEVEL + 0.2}};
    default_skeleton(8);
    himc_posture_init(&posture, &skeleton, LEVEL);
    himc_posture_at(&posture, tip, &pose);
    himc_pose_to_state(&skeleton, &pose, NULL, &state);
    himc_controller_config control = himc_controller_config_default();
    himc_controller_init(&controller, &control, &skeleton, &state);
    memset(&reference, 0, sizeof reference);
    memcpy(reference.posture.joint, pose.joint, sizeof pose.joint);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        reference.tip[hand].x = state.tip[hand];
    return controller;
}

#endif
