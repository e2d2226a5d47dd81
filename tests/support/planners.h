/// planners.h: for tests of the planner: a planner with two drums at a tempo, strokes for it, and
/// the states of its tips.
#ifndef HIMC_TESTS_PLANNERS_H
#define HIMC_TESTS_PLANNERS_H

#include "body/posture.h"
#include "plan/planner.h"

#include "unity.h"

#define PLANE 0.87 // height of the tip at a touch: head and mallet's radius (m)

static himc_planner *planner;
static himc_error error;
static himc_planned_body body; ///< of a planner from use_body

static inline himc_planner *make_with(const himc_planner_config *config, double bpm)
{
    himc_planner *p = himc_planner_new(config, &error);
    himc_tempo_change tempo = {0, bpm};
    TEST_ASSERT_NOT_NULL(p);
    TEST_ASSERT_TRUE(himc_planner_set_tempi(p, &tempo, 1, &error));
    himc_planner_set_drum(p, 0, &(himc_head_frame){.center = {0.75, 0, 0.85}, .radius = 0.3});
    himc_planner_set_drum(
        p, 1, &(himc_head_frame){.center = {0.7, 0.65, 0.8}, .tilt = 0.15, .radius = 0.33});
    return p;
}

static inline himc_planner *make(double bpm)
{
    himc_planner_config config = himc_planner_default();
    return make_with(&config, bpm);
}

static inline void add(himc_planner *p, double beat, himc_hand hand, himc_nuance nuance,
                       double dynamic)
{
    himc_stroke s = {
        .beat = beat, .hand = hand, .nuance = nuance, .dynamic = dynamic, .spot = HIMC_SPOT_NORMAL};
    TEST_ASSERT_TRUE_MESSAGE(himc_planner_add(p, &s, 0, &error), error.text);
}

static inline himc_target at(himc_planner *p, himc_hand hand, double t)
{
    himc_planner_advance(p, t);
    return himc_planner_target(p, hand, t);
}

void setUp(void)
{
    planner = make(120);
}

void tearDown(void)
{
    himc_planner_free(planner);
    planner = NULL;
}

static inline void use(double bpm)
{
    himc_planner_free(planner);
    planner = make(bpm);
}

/// A seated timpanist of the usual size; planners made with it rehearse.
static inline himc_planner_config with_body(void)
{
    himc_planner_config config = himc_planner_default();
    himc_skeleton_config of = himc_skeleton_default();
    himc_skeleton skeleton;
    TEST_ASSERT_TRUE(himc_skeleton_init(&skeleton, &of, &error));
    body = (himc_planned_body){.grip = HIMC_GRIP_GERMAN};
    himc_posture_init(&body.posture, &skeleton, PLANE);
    body.from = body.goal = himc_posture_trunk(&body.posture, config.rest, body.grip);
    config.body = &body;
    return config;
}

static inline void same_state(himc_target a, himc_target b)
{
    TEST_ASSERT_TRUE(himc_vec3_length(himc_vec3_sub(a.x, b.x)) < 1e-9);
    TEST_ASSERT_TRUE(himc_vec3_length(himc_vec3_sub(a.v, b.v)) < 1e-7);
    TEST_ASSERT_TRUE(himc_vec3_length(himc_vec3_sub(a.a, b.a)) < 1e-4);
}

/// Planned time of the hand's first touch (s).
static inline double first_touch(himc_hand hand)
{
    himc_stroke s;
    int drum;
    double touch = -1;
    TEST_ASSERT_TRUE(himc_planner_current(planner, hand, 0, &s, &drum, &touch));
    return touch;
}

#endif
