/// test_controller.c: the laws at a two-handed stroke of 375 mm at 2 Hz, the release of the normal,
/// gains far off.
///
/// Bounds of tracking stand some 30 % above what was measured (computed torque: twice), the figure
/// beside each.
#include "control/law.h"
#include "control/solvers.h"
#include "himc/command.h"
#include "body/character.h"
#include "body/dynamics.h"
#include "control/controller.h"

#include "bodies.h"
#include "unity.h"

#include <stdlib.h>
#include <string.h>

#define HEIGHT 0.375
#define LEVEL 0.8675
#define STEP 1e-4

static himc_posture posture;
static himc_controller controller;

static void set_gain(int joint, double stiffness, double damping)
{
    himc_controller_config config = controller.config;
    config.gain[joint] = himc_controller_gain(&controller, joint, stiffness, damping);
    config.gain_set[joint] = true;
    himc_controller_configure(&controller, &config);
}
static himc_character *character;
static himc_reference reference;
static himc_body_state state;

// the stroke at time t: hands in opposite phase, a little forward and back as they go
static void stroke(double t, double rate, himc_target tip[HIMC_HANDS])
{
    double w = 2 * HIMC_PI * rate, r = 0.5 * HEIGHT;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        double p = w * t + hand * HIMC_PI, s = sin(p), c = cos(p), y = hand ? -0.05 : 0.05;
        tip[hand].x = himc_vec3_make(0.48 + 0.02 * s, y, LEVEL + r * (1 - c));
        tip[hand].v = himc_vec3_make(0.02 * w * c, 0, r * w * s);
        tip[hand].a = himc_vec3_make(-0.02 * w * w * s, 0, r * w * w * c);
    }
}

static void place_on(const himc_posture_motion *motion)
{
    himc_pose pose;
    memcpy(pose.joint, motion->joint, sizeof pose.joint);
    himc_pose_to_state(&skeleton, &pose, motion->rate, &state);
}

void setUp(void)
{
    himc_skeleton_config config = himc_skeleton_default();
    himc_skeleton_init(&skeleton, &config, NULL);
    himc_posture_init(&posture, &skeleton, LEVEL);
    character = himc_character_new(&skeleton, NULL);
    memset(&reference, 0, sizeof reference);
    stroke(0, 2, reference.tip);
    himc_posture_moving(&posture, reference.tip, &reference.posture);
    place_on(&reference.posture);
    himc_controller_config control = himc_controller_config_default();
    himc_controller_init(&controller, &control, &skeleton, &state);
    srand(10);
}

void tearDown(void)
{
    himc_character_free(character);
}

typedef struct result {
    double rms;   // of both tips, part of the stroke's height
    double elbow; // the left elbow's vertical range over its reference's
    double worst; // largest distance of a tip from its target (m)
    bool finite;
} result;

static double distance(himc_vec3 a, himc_vec3 b)
{
    return himc_vec3_length(himc_vec3_sub(a, b));
}

static void widen(double range[2], double z)
{
    range[0] = fmin(range[0], z);
    range[1] = fmax(range[1], z);
}

// from time 0 on the reference, figures from `settle` to `end` (s)
static result play(double rate, double settle, double end)
{
    himc_vec3 torque[HIMC_JOINTS];
    double sum = 0, is[2] = {9, -9}, should[2] = {9, -9};
    long count = 0;
    result r = {.finite = true};
    for (long n = 0; n < lround(end / STEP); n++) {
        stroke(n * STEP, rate, reference.tip);
        himc_posture_moving(&posture, reference.tip, &reference.posture);
        if (n == 0) {
            place_on(&reference.posture);
            himc_character_place(character, &state);
        }
        himc_character_observe(character, &state);
        for (int hand = 0; n * STEP >= settle && hand < HIMC_HANDS; hand++, count++) {
            double away = distance(state.tip[hand], reference.tip[hand].x);
            sum += away * away;
            r.worst = fmax(r.worst, away);
        }
        if (n * STEP >= settle && n % 10 == 0) {
            himc_body_state wanted = state;
            widen(is, state.origin[HIMC_LEFT_FOREARM].z);
            himc_pose pose;
            memcpy(pose.joint, reference.posture.joint, sizeof pose.joint);
            himc_pose_to_state(&skeleton, &pose, NULL, &wanted);
            widen(should, wanted.origin[HIMC_LEFT_FOREARM].z);
        }
        himc_controller_torques(&controller, &skeleton, &state, &reference, torque);
        himc_character_step(character, torque, NULL, 0, STEP);
        r.finite = r.finite && himc_body_state_finite(&state);
    }
    r.rms = sqrt(sum / (double)count) / HEIGHT;
    r.elbow = (is[1] - is[0]) / (should[1] - should[0]);
    return r;
}

static void tracks(himc_pipeline mode, himc_law law, double rms)
{
    controller.config.mode = mode;
    controller.config.law = law;
    result r = play(2, 0.25, 1.25);
    TEST_ASSERT_TRUE(r.finite);
    TEST_ASSERT_TRUE(r.rms < rms);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 1, r.elbow);
}

static void test_himc_computed_torque_tracks_the_tips_within_a_hundredth_of_a_percent(void)
{
    tracks(HIMC_PIPELINE_HIMC, HIMC_LAW_COMPUTED_TORQUE, 0.0001); // measured .000043
}

static void test_himc_feedforward_tracks_within_six_tenths_of_a_percent(void)
{
    tracks(HIMC_PIPELINE_HIMC, HIMC_LAW_FEEDFORWARD, 0.006); // measured .0045
}

static void test_himc_printed_tracks_within_six_and_a_half_percent(void)
{
    tracks(HIMC_PIPELINE_HIMC, HIMC_LAW_PRINTED, 0.065); // measured .0510
}

static void test_id_computed_torque_tracks_within_a_hundredth_of_a_percent(void)
{
    tracks(HIMC_PIPELINE_ID, HIMC_LAW_COMPUTED_TORQUE, 0.0001); // measured .000047
}

static void test_id_feedforward_tracks_within_six_tenths_of_a_percent(void)
{
    tracks(HIMC_PIPELINE_ID, HIMC_LAW_FEEDFORWARD, 0.006); // measured .0046
}

static void test_id_printed_tracks_within_six_and_a_half_percent(void)
{
    tracks(HIMC_PIPELINE_ID, HIMC_LAW_PRINTED, 0.065); // measured .0511
}

static void test_tips_alone_steer_himc_and_not_id(void)
{
    himc_vec3 a[HIMC_JOINTS], b[HIMC_JOINTS];
    for (int mode = HIMC_PIPELINE_HIMC; mode <= HIMC_PIPELINE_ID; mode++) {
        controller.config.mode = (himc_pipeline)mode;
        himc_controller_torques(&controller, &skeleton, &state, &reference, a);
        reference.tip[HIMC_LEFT].x.z += 0.01;
        himc_controller_torques(&controller, &skeleton, &state, &reference, b);
        reference.tip[HIMC_LEFT].x.z -= 0.01;
        double change = distance(a[himc_arm_joint(HIMC_LEFT, 1)], b[himc_arm_joint(HIMC_LEFT, 1)]);
        TEST_ASSERT_EQUAL_INT(mode == HIMC_PIPELINE_HIMC, change > 0.01);
    }
}

// acceleration of a tip under the controller's torques and no contact
static himc_vec3 commanded(himc_hand hand)
{
    himc_vec3 torque[HIMC_JOINTS], relative[HIMC_JOINTS];
    himc_articulation art;
    himc_controller_torques(&controller, &skeleton, &state, &reference, torque);
    himc_articulate(&skeleton, &state, &art);
    himc_forward_dynamics(&skeleton, &state, &art, torque, NULL, relative);
    return himc_tip_acceleration(&skeleton, &state, hand, relative, NULL);
}

static void released_lets_go(const char *what)
{
    himc_vec3 z = {0, 0, 1};
    for (int n = 0; n < 100; n++) {
        himc_vec3 d = random_vector(0.01), v = random_vector(0.5);
        stroke(0.05, 2, reference.tip);
        himc_posture_moving(&posture, reference.tip, &reference.posture);
        place_on(&reference.posture);
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            reference.tip[hand].x = himc_vec3_add(reference.tip[hand].x, d);
            reference.tip[hand].v = himc_vec3_add(reference.tip[hand].v, v);
            reference.released[hand] = hand == n % 2;
            reference.normal[hand] = himc_vec3_unit(himc_vec3_add(z, random_vector(0.3)));
        }
        himc_hand hand = (himc_hand)(n % 2), other = (himc_hand)(1 - n % 2);
        double normal = himc_vec3_dot(reference.normal[hand], commanded(hand));
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-4, 0, normal, what);
        reference.released[hand] = false;
        TEST_ASSERT_TRUE(himc_vec3_length(commanded(other)) > 1);
        TEST_ASSERT_TRUE(fabs(himc_vec3_dot(reference.normal[hand], commanded(hand))) > 1);
    }
}

static void test_released_tip_is_not_accelerated_along_the_normal(void)
{
    released_lets_go("himc");
    controller.config.mode = HIMC_PIPELINE_ID;
    released_lets_go("id");
}

static void test_released_tip_is_not_accelerated_along_the_normal_with_gains_of_the_user(void)
{
    himc_gain own = controller.gain[himc_arm_joint(HIMC_LEFT, 2)];
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        set_gain(himc_arm_joint((himc_hand)hand, 2), 0.5 * own.stiffness.y, own.damping.y);
    released_lets_go("himc with a softer wrist");
}

// in every law and mode a target 1 cm below the head, moving down at 2 m/s, adds no push into it
static void test_released_tip_is_not_pushed_by_a_target_below_the_head(void)
{
    for (int law = HIMC_LAW_PRINTED; law <= HIMC_LAW_COMPUTED_TORQUE; law++)
        for (int mode = HIMC_PIPELINE_HIMC; mode <= HIMC_PIPELINE_ID; mode++) {
            double push[2];
            char what[32];
            controller.config.law = (himc_law)law;
            controller.config.mode = (himc_pipeline)mode;
            for (int below = 0; below < 2; below++) {
                for (int hand = 0; hand < HIMC_HANDS; hand++) {
                    reference.tip[hand] = (himc_target){.x = state.tip[hand]};
                    reference.tip[hand].x.z -= below ? 0.01 : 0;
                    reference.tip[hand].v.z = below ? -2 : 0;
                    reference.released[hand] = true;
                    reference.normal[hand] = himc_vec3_make(0, 0, 1);
                }
                himc_posture_moving(&posture, reference.tip, &reference.posture);
                push[below] = commanded(HIMC_LEFT).z;
            }
            snprintf(what, sizeof what, "law %d, mode %d", law, mode);
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1, push[0], push[1], what); // held: 370 to 790 m/s^2
        }
}

static void test_released_tip_is_still_steered_across_the_normal(void)
{
    double w = 2 * HIMC_PI * controller.config.bandwidth;
    stroke(0, 2, reference.tip);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        reference.tip[hand].v = reference.tip[hand].a = himc_vec3_make(0, 0, 0);
        reference.released[hand] = true;
        reference.normal[hand] = himc_vec3_make(0, 0, 1);
    }
    himc_posture_moving(&posture, reference.tip, &reference.posture);
    place_on(&reference.posture);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        reference.tip[hand].x = himc_vec3_add(state.tip[hand], himc_vec3_make(0.005, 0.005, -0.03));
        himc_vec3 a = commanded((himc_hand)hand);
        TEST_ASSERT_DOUBLE_WITHIN(0.25 * w * w * 0.005, w * w * 0.005, a.x);
        TEST_ASSERT_DOUBLE_WITHIN(0.25 * w * w * 0.005, w * w * 0.005, a.y);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0, a.z);
    }
}

// all gains of all joints, as the user sets them, so that computed torque uses them as well
static void scale_gains(double factor)
{
    for (int j = 0; j < HIMC_JOINTS; j++)
        set_gain(j, factor * controller.gain[j].stiffness.y, factor * controller.gain[j].damping.y);
}

// Half a second of strokes at 2 Hz, the first half of it with scaled gains; `away` is how far tips
// are off at the end (m). False if the body was ever lost.
static bool stands(himc_pipeline mode, himc_law law, double factor, double *away)
{
    himc_vec3 torque[HIMC_JOINTS];
    double h = controller.step;
    bool on = true;
    controller.config.mode = mode;
    controller.config.law = law;
    himc_controller usual = controller;
    scale_gains(factor);
    long steps = lround(0.5 / h);
    for (long n = 0; on && n < steps; n++) {
        controller = n == steps / 2 ? usual : controller;
        stroke((double)n * h, 2, reference.tip);
        himc_posture_moving(&posture, reference.tip, &reference.posture);
        if (n == 0) {
            place_on(&reference.posture);
            himc_character_place(character, &state);
        }
        himc_character_observe(character, &state);
        himc_controller_torques(&controller, &skeleton, &state, &reference, torque);
        on = himc_character_step(character, torque, NULL, 0, h) && himc_body_state_finite(&state);
    }
    *away = fmax(distance(state.tip[0], reference.tip[0].x),
                 distance(state.tip[1], reference.tip[1].x));
    controller = usual;
    return on;
}

static void keeps_on_its_feet(double factor, double step)
{
    // of printed, feedforward, computed torque, a quarter of a second after the usual gains are
    // back
    static const double near[] = {0.07 * HEIGHT, 0.012 * HEIGHT, 0.0002};
    controller.step = step;
    for (int law = HIMC_LAW_PRINTED; law <= HIMC_LAW_COMPUTED_TORQUE; law++)
        for (int mode = HIMC_PIPELINE_HIMC; mode <= HIMC_PIPELINE_ID; mode++) {
            double away;
            char what[80];
            bool on = stands((himc_pipeline)mode, (himc_law)law, factor, &away);
            snprintf(what, sizeof what, "law %d, mode %d, gains x %g, %g s: %g m", law, mode,
                     factor, step, away);
            TEST_ASSERT_TRUE_MESSAGE(on && away < near[law] * fmax(1, step / 1e-4), what);
        }
}

static void test_all_laws_are_stable_at_gains_of_a_tenth_ten_and_a_thousand_times(void)
{
    keeps_on_its_feet(0.1, STEP);
    keeps_on_its_feet(10, STEP);
    keeps_on_its_feet(1000, STEP);
}

static void test_all_laws_are_stable_at_those_gains_at_1_khz_physics(void)
{
    keeps_on_its_feet(0.1, 1e-3);
    keeps_on_its_feet(1, 1e-3);
    keeps_on_its_feet(10, 1e-3);
}

// with no step to look ahead over, servos are equation 2 to the letter
static void test_printed_law_over_no_time_is_equation_2(void)
{
    himc_vec3 torque[HIMC_JOINTS];
    controller.config.mode = HIMC_PIPELINE_ID;
    controller.config.law = HIMC_LAW_PRINTED;
    controller.step = 0;
    stroke(0.07, 2, reference.tip);
    himc_posture_moving(&posture, reference.tip, &reference.posture);
    for (int j = 0; j < HIMC_JOINTS; j++) {
        const himc_mat3 *r = &state.rotation[j + 1];
        int p = skeleton.segment[j + 1].parent;
        himc_quat q = himc_quat_mul(himc_quat_conj(state.orientation[p]), state.orientation[j + 1]);
        himc_vec3 missing = himc_mat3_apply(
            &state.rotation[p],
            himc_quat_log(himc_quat_mul(reference.posture.joint[j], himc_quat_conj(q))));
        himc_vec3 e = himc_mat3_apply_transposed(r, missing), ks = controller.gain[j].stiffness;
        himc_vec3 w = himc_mat3_apply_transposed(r,
                                                 himc_vec3_sub(state.spin[j + 1], state.spin[p])),
                  kd = controller.gain[j].damping;
        himc_vec3 want = himc_vec3_make(ks.x * e.x - kd.x * w.x, ks.y * e.y - kd.y * w.y,
                                        ks.z * e.z - kd.z * w.z);
        himc_controller_torques(&controller, &skeleton, &state, &reference, torque);
        double size = himc_vec3_length(want);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12 * (1 + size), 0,
                                  distance(himc_mat3_apply(r, want), torque[j]));
    }
}

// the paper clips no step: a soft servo lags by more than a few centimetres
static void test_printed_torque_of_a_tip_12_cm_off_is_three_times_that_of_4_cm(void)
{
    himc_vec3 near[HIMC_JOINTS], far[HIMC_JOINTS], rest = reference.tip[HIMC_LEFT].x;
    controller.config.law = HIMC_LAW_PRINTED;
    controller.config.posture = false;
    controller.step = 0;
    memset(state.spin, 0, sizeof state.spin);
    himc_body_state_complete(&skeleton, &state);
    reference.tip[HIMC_LEFT].x = himc_vec3_add(rest, himc_vec3_make(0, 0, 0.04));
    himc_controller_torques(&controller, &skeleton, &state, &reference, near);
    reference.tip[HIMC_LEFT].x = himc_vec3_add(rest, himc_vec3_make(0, 0, 0.12));
    himc_controller_torques(&controller, &skeleton, &state, &reference, far);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        int j = himc_arm_joint(HIMC_LEFT, k);
        TEST_ASSERT_TRUE(himc_vec3_length(near[j]) > 1e-3);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6 * himc_vec3_length(far[j]), 0,
                                  distance(himc_vec3_scale(near[j], 3), far[j]));
    }
}

static void test_default_gains_are_critically_damped_at_the_frequencies_of_the_table(void)
{
    static const double hertz[HIMC_ARM_JOINTS] = {24, 30, 42, 54};
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
            int j = himc_arm_joint((himc_hand)hand, k);
            double i = controller.inertia[j].y, w = 2 * HIMC_PI * hertz[k];
            TEST_ASSERT_DOUBLE_WITHIN(1e-9 * i * w * w, i * w * w, controller.gain[j].stiffness.y);
            TEST_ASSERT_DOUBLE_WITHIN(1e-9 * i * w, 2 * i * w, controller.gain[j].damping.y);
        }
    // the grip carries the stick alone: 0.0016 kg m^2 across, 3e-6 along
    himc_vec3 grip = controller.inertia[himc_arm_joint(HIMC_LEFT, 3)];
    TEST_ASSERT_DOUBLE_WITHIN(5e-5, 0.0016, grip.y);
    TEST_ASSERT_DOUBLE_WITHIN(5e-7, 3e-6, grip.z);
}

static void test_set_gain_sets_flexion_and_spares_the_length_axis(void)
{
    int j = himc_arm_joint(HIMC_RIGHT, 3);
    set_gain(j, 20, 0.36);
    TEST_ASSERT_EQUAL_DOUBLE(20, controller.gain[j].stiffness.y);
    TEST_ASSERT_EQUAL_DOUBLE(0.36, controller.gain[j].damping.y);
    himc_vec3 i = controller.inertia[j];
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.36 * i.z / i.y, controller.gain[j].damping.z);
}

// in steps of two lengths, under other targets from the sixth on, with a gain from the ninth on
static void test_sleeping_legs_have_the_torques_that_a_step_computes(void)
{
    himc_sleeping_legs legs = {.asked = NULL};
    himc_vec3 computed[HIMC_JOINTS], given[HIMC_JOINTS];
    himc_articulation art;
    int spared = 0;
    himc_articulate(&skeleton, &state, &art);
    himc_articulate_upper(&skeleton, &state, &art);
    controller.articulation = &art;
    for (int n = 0; n < 12; n++) {
        controller.step = n % 2 ? STEP : 1.25 * STEP;
        reference.tip[HIMC_LEFT].x.z += 0.001;
        if (n == 6)
            reference.posture.rate[HIMC_LEGS - 1].y = 0.1;
        if (n == 9)
            set_gain(HIMC_LEGS - 1, 300, 10);
        controller.legs = NULL;
        himc_controller_torques(&controller, &skeleton, &state, &reference, computed);
        controller.legs = &legs;
        himc_controller_torques(&controller, &skeleton, &state, &reference, given);
        spared += legs.asked != NULL;
        TEST_ASSERT_EQUAL_MEMORY(computed, given, sizeof given);
    }
    TEST_ASSERT_EQUAL_INT(6, spared);
}

// the choice of a command is the index of a row
static void test_laws_and_solvers_have_the_words_of_their_commands(void)
{
    for (int k = 0; k < HIMC_SOLVERS; k++)
        TEST_ASSERT_EQUAL_STRING(himc_command_word(HIMC_COMMAND_SOLVER, 0, k).text,
                                 himc_solvers[k].word);
    TEST_ASSERT_EQUAL_STRING("", himc_command_word(HIMC_COMMAND_LAW, 0, HIMC_LAW_COUNT).text);
    TEST_ASSERT_EQUAL_STRING("", himc_command_word(HIMC_COMMAND_SOLVER, 0, HIMC_SOLVERS).text);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_himc_computed_torque_tracks_the_tips_within_a_hundredth_of_a_percent);
    RUN_TEST(test_himc_feedforward_tracks_within_six_tenths_of_a_percent);
    RUN_TEST(test_himc_printed_tracks_within_six_and_a_half_percent);
    RUN_TEST(test_id_computed_torque_tracks_within_a_hundredth_of_a_percent);
    RUN_TEST(test_id_feedforward_tracks_within_six_tenths_of_a_percent);
    RUN_TEST(test_id_printed_tracks_within_six_and_a_half_percent);
    RUN_TEST(test_tips_alone_steer_himc_and_not_id);
    RUN_TEST(test_released_tip_is_not_accelerated_along_the_normal);
    RUN_TEST(test_released_tip_is_not_accelerated_along_the_normal_with_gains_of_the_user);
    RUN_TEST(test_released_tip_is_not_pushed_by_a_target_below_the_head);
    RUN_TEST(test_released_tip_is_still_steered_across_the_normal);
    RUN_TEST(test_all_laws_are_stable_at_gains_of_a_tenth_ten_and_a_thousand_times);
    RUN_TEST(test_all_laws_are_stable_at_those_gains_at_1_khz_physics);
    RUN_TEST(test_printed_law_over_no_time_is_equation_2);
    RUN_TEST(test_printed_torque_of_a_tip_12_cm_off_is_three_times_that_of_4_cm);
    RUN_TEST(test_default_gains_are_critically_damped_at_the_frequencies_of_the_table);
    RUN_TEST(test_set_gain_sets_flexion_and_spares_the_length_axis);
    RUN_TEST(test_sleeping_legs_have_the_torques_that_a_step_computes);
    RUN_TEST(test_laws_and_solvers_have_the_words_of_their_commands);
    return UNITY_END();
}
