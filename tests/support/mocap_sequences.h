/// mocap_sequences.h: the 45 sequences of the motion database, for its tests.
#ifndef MOCAP_SEQUENCES_H
#define MOCAP_SEQUENCES_H

#include "mocap/mocap.h"

#include "unity.h"

#include <stdio.h>
#include <stdlib.h>

#define MOCAP_SPOTS 3
#define MOCAP_SEQUENCES (HIMC_MOCAP_PLAYERS * HIMC_NUANCES * MOCAP_SPOTS)

static himc_error error;

static inline himc_mocap_config sequence_config(int index)
{
    himc_mocap_config c = himc_mocap_default();
    c.player = index / (HIMC_NUANCES * MOCAP_SPOTS);
    c.nuance = (himc_nuance)(index / MOCAP_SPOTS % HIMC_NUANCES);
    c.spot = (himc_spot)(index % MOCAP_SPOTS);
    return c;
}

static inline himc_mocap *sequence_made(const himc_mocap_config *config)
{
    himc_mocap *m = himc_mocap_new(config, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(m, error.text);
    return m;
}

static inline himc_mocap *sequence(int index)
{
    himc_mocap_config c = sequence_config(index);
    return sequence_made(&c);
}

static inline himc_body_state sequence_state(const himc_mocap *m, double t)
{
    himc_body_state state;
    himc_pose pose = himc_mocap_pose(m, t);
    himc_pose_to_state(himc_mocap_skeleton(m), &pose, NULL, &state);
    return state;
}

#endif
