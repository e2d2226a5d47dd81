/// bodies.h: the default skeleton, random vectors and states, for tests of the body.
#ifndef HIMC_TESTS_BODIES_H
#define HIMC_TESTS_BODIES_H

#include "himc/body.h"

#include <stdlib.h>

static himc_skeleton skeleton;

/// Sets `skeleton` to the default body and seeds the random numbers.
static inline void default_skeleton(unsigned seed)
{
    himc_skeleton_config config = himc_skeleton_default();
    himc_skeleton_init(&skeleton, &config, NULL);
    srand(seed);
}

/// Each component uniform in [-scale, scale].
static inline himc_vec3 random_vector(double scale)
{
    double v[3];
    for (int i = 0; i < 3; i++)
        v[i] = scale * (2.0 * rand() / RAND_MAX - 1);
    return himc_vec3_make(v[0], v[1], v[2]);
}

/// Any pose of `skeleton`, relative spins in [-spin, spin] (rad/s).
static inline void random_state(himc_body_state *s, double spin)
{
    himc_pose pose;
    himc_vec3 rate[HIMC_JOINTS];
    for (int j = 0; j < HIMC_JOINTS; j++) {
        pose.joint[j] = himc_quat_exp(random_vector(1.5));
        rate[j] = random_vector(spin);
    }
    himc_pose_to_state(&skeleton, &pose, rate, s);
}

#endif
