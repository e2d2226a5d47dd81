/// test_two_way.c: a free arm's stick on a head: physics at 10 kHz with the contact at 48 kHz
/// inside, against one in which engine and contact step together at 480 kHz.
///
/// The arm has no torques: this compares the coupling alone (effective mass, micro-steps and
/// the impulse given back in the same step), for soft felt to a rigid mallet.
#include "himc/himc.h"

#include "unity.h"
#include "body/posture.h"
#include "body/dynamics.h"
#include "body/character.h"
#include "himc/membrane.h"
#include "heads.h"

#include <stdio.h>

#define SECONDS 0.03
#define FINE 480000.0

static himc_skeleton skeleton;
static himc_body_state start;

typedef struct result {
    double impulse, force, contact; // (N s, N, s)
} result;

void setUp(void)
{
}

void tearDown(void)
{
}

// stick level just above the head, every joint of the right arm moving it down, 4 m/s at the tip
static void make_start(void)
{
    static const int joints[] = {HIMC_RIGHT_FOREARM - 1, HIMC_RIGHT_HAND - 1, HIMC_RIGHT_STICK - 1};
    himc_skeleton_config config = himc_skeleton_default();
    himc_posture posture;
    himc_pose pose;
    himc_vec3 rate[HIMC_JOINTS] = {{0}};
    himc_vec3 tip[HIMC_HANDS] = {{0.48, 0.05, 0.8675}, {0.48, -0.05, 0.8675}};
    himc_skeleton_init(&skeleton, &config, NULL);
    himc_posture_init(&posture, &skeleton, 0.8675 - 0.0134); // so the sticks are level
    himc_posture_at(&posture, tip, &pose);
    for (int k = 0; k < 3; k++) {
        double *axis[] = {&rate[joints[k]].x, &rate[joints[k]].y, &rate[joints[k]].z};
        for (int i = 0; i < 3; i++) {
            himc_vec3 alone[HIMC_JOINTS] = {{0}};
            ((double *)&alone[joints[k]])[i] = 1;
            himc_pose_to_state(&skeleton, &pose, alone, &start);
            *axis[i] = -start.tip_velocity[HIMC_RIGHT].z;
        }
    }
    himc_pose_to_state(&skeleton, &pose, rate, &start);
    double scale = -4 / start.tip_velocity[HIMC_RIGHT].z;
    for (int j = 0; j < HIMC_JOINTS; j++)
        rate[j] = himc_vec3_scale(rate[j], scale);
    himc_pose_to_state(&skeleton, &pose, rate, &start);
}

// the stick's end over a head that lies where it is at the start
static void load_stick(himc_stick *stick, const himc_body_state *state, double offset)
{
    himc_vec3 n = {0, 0, 1}, relative[HIMC_JOINTS], none[HIMC_JOINTS] = {{0}};
    himc_articulation art;
    himc_articulate(&skeleton, state, &art);
    himc_forward_dynamics(&skeleton, state, &art, none, NULL, relative);
    stick->mass = himc_effective_mass(&skeleton, state, &art, HIMC_RIGHT, n);
    stick->acceleration = himc_tip_acceleration(&skeleton, state, HIMC_RIGHT, relative, NULL).z;
    stick->height = state->tip[HIMC_RIGHT].z - start.tip[HIMC_RIGHT].z + offset;
    stick->velocity = state->tip_velocity[HIMC_RIGHT].z;
}

// a strike, `steps` of the engine for every `samples` of the head
static result strike(double k, double radius, double rate, int samples, int steps)
{
    static const himc_vec3 none[HIMC_JOINTS];
    himc_error error = {""};
    himc_head head = dry_head();
    himc_character *body = himc_character_new(&skeleton, &error);
    himc_membrane *membrane = himc_membrane_new(&head, rate, &error);
    TEST_ASSERT_TRUE_MESSAGE(body && membrane, error.text);
    himc_body_state state = start;
    himc_stick stick = {.head = {.stiffness = k, .exponent = 2.54, .mass = 0.03, .radius = radius},
                        .x = -0.75 * head.radius},
               *one = &stick;
    himc_character_place(body, &start);
    double offset = 0;
    int played = 0;
    result r = {0};
    for (int step = 1; played < SECONDS * rate; step++) {
        int n = step * samples / steps - (step - 1) * samples / steps;
        load_stick(&stick, &state, offset);
        double impulse = 0;
        for (int i = 0; i < n; i++, played++) {
            himc_contact_step(membrane, &one, 1);
            impulse += stick.force / rate;
            r.force = fmax(r.force, fmax(stick.force, stick.peak));
            r.contact += stick.force > 0 ? 1 / rate : 0;
        }
        r.impulse += impulse;
        himc_vec3 push = {0, 0, impulse * rate / n};
        world_contact tip = himc_tip_contact(&skeleton, HIMC_RIGHT, push, NULL);
        himc_character_step(body, none, &tip, 1, n / rate);
        himc_character_observe(body, &state);
        double height = state.tip[HIMC_RIGHT].z - start.tip[HIMC_RIGHT].z;
        offset = stick.touching ? stick.height - height : 0.9 * offset;
    }
    himc_character_free(body);
    himc_membrane_free(membrane);
    return r;
}

static void test_two_way_contact_is_that_of_a_fine_simulation_of_arm_and_head_together(void)
{
    // soft, medium and hard felt, wood, which first meets the head in a spike of a few samples and
    // parts from it grazing
    static const double k[] = {1e7, 1.6e8, 1e9, 1e10};
    for (int i = 0; i < 8; i++) {
        double radius = i < 4 ? 0 : 0.0175; // a point, a patch
        result fine = strike(k[i % 4], radius, FINE, 1, 1);
        result now = strike(k[i % 4], radius, 48000, 24, 5);
        printf("k %.2g: impulse %.4f Ns (%+.3f %%), force %.1f N (%+.2f %%), contact %.2f ms "
               "(%+.2f %%)\n",
               k[i % 4], fine.impulse, 100 * (now.impulse / fine.impulse - 1), fine.force,
               100 * (now.force / fine.force - 1), fine.contact * 1e3,
               100 * (now.contact / fine.contact - 1));
        TEST_ASSERT_DOUBLE_WITHIN(1e-3 * fine.impulse, fine.impulse, now.impulse);
        TEST_ASSERT_DOUBLE_WITHIN(1e-2 * fine.force, fine.force, now.force);
        TEST_ASSERT_DOUBLE_WITHIN(2e-2 * fine.contact, fine.contact, now.contact);
    }
}

int main(void)
{
    UNITY_BEGIN();
    make_start();
    RUN_TEST(test_two_way_contact_is_that_of_a_fine_simulation_of_arm_and_head_together);
    return UNITY_END();
}
