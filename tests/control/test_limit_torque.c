/// test_limit_torque.c: joints sent beyond their bounds come back under every law and mode,
/// whatever the bounds; and the strength of muscles.
#include "body/character.h"
#include "control/controller.h"

#include "control/limit_torque.h"
#include "control/balance.h"
#include "control/strength.h"

#include "unity.h"

#include <stdlib.h>
#include <string.h>

#define HEIGHT 0.375
#define LEVEL 0.8675
#define STEP 1e-4
#define FRAMES 125
#define DEGREE (HIMC_PI / 180)

static himc_skeleton skeleton;
static himc_posture posture;
static himc_controller controller;
static himc_character *character;
static himc_reference reference;
static himc_body_state state;
static himc_limits limits;
static himc_saturation_counts saturation;
static himc_error error;

// a stroke at 2 Hz, hands in opposite phase, a little forward and back as they go
static void stroke(double t, himc_target tip[HIMC_HANDS])
{
    double w = 2 * HIMC_PI * 2, r = 0.5 * HEIGHT;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        double p = w * t + hand * HIMC_PI, s = sin(p), c = cos(p), y = hand ? -0.05 : 0.05;
        tip[hand].x = himc_vec3_make(0.48 + 0.02 * s, y, LEVEL + r * (1 - c));
        tip[hand].v = himc_vec3_make(0.02 * w * c, 0, r * w * s);
        tip[hand].a = himc_vec3_make(-0.02 * w * w * s, 0, r * w * w * c);
    }
}

static himc_pose pose_of(const himc_posture_motion *motion)
{
    himc_pose pose;
    memcpy(pose.joint, motion->joint, sizeof pose.joint);
    return pose;
}

static void aim(double t)
{
    stroke(t, reference.tip);
    himc_posture_moving(&posture, reference.tip, &reference.posture);
}

static void place(const himc_pose *pose, const himc_vec3 *rate)
{
    himc_pose_to_state(&skeleton, pose, rate, &state);
    himc_character_place(character, &state);
}

// limits learned from one period of the stroke
static void learn(double margin)
{
    static himc_pose motion[FRAMES];
    for (int f = 0; f < FRAMES; f++) {
        aim(0.5 * f / FRAMES);
        motion[f] = pose_of(&reference.posture);
    }
    TEST_ASSERT_TRUE_MESSAGE(himc_limits_learn(&limits, motion, FRAMES, margin, &error),
                             error.text);
}

void setUp(void)
{
    himc_skeleton_config config = himc_skeleton_default();
    himc_skeleton_init(&skeleton, &config, NULL);
    himc_posture_init(&posture, &skeleton, LEVEL);
    character = himc_character_new(&skeleton, NULL);
    memset(&reference, 0, sizeof reference);
    memset(&saturation, 0, sizeof saturation);
    aim(0);
    himc_pose pose = pose_of(&reference.posture);
    place(&pose, reference.posture.rate);
    himc_controller_config control = himc_controller_config_default();
    himc_controller_init(&controller, &control, &skeleton, &state);
    controller.saturation = &saturation;
    srand(12);
}

void tearDown(void)
{
    himc_character_free(character);
}

static void step(void)
{
    himc_vec3 torque[HIMC_JOINTS];
    himc_character_observe(character, &state);
    himc_controller_torques(&controller, &skeleton, &state, &reference, torque);
    TEST_ASSERT_TRUE(himc_character_step(character, torque, NULL, 0, STEP));
}

// the largest measure over all joints
static double measure_now(void)
{
    himc_pose pose = himc_pose_from_state(&skeleton, &state);
    double most = 0;
    for (int j = 0; j < HIMC_JOINTS; j++)
        most = fmax(most, himc_limit_measure(&limits, j, pose.joint[j]));
    return most;
}

// an arm's posture is no longer asked for: its joints shall stay as they are
static void forget_arms(void)
{
    himc_pose now = himc_pose_from_state(&skeleton, &state);
    for (int j = HIMC_LEFT_UPPER_ARM - 1; j <= HIMC_RIGHT_STICK - 1; j++) {
        reference.posture.joint[j] = now.joint[j];
        reference.posture.rate[j] = reference.posture.acceleration[j] = himc_vec3_make(0, 0, 0);
    }
}

/// What two seconds of strokes were like after the first half second.
typedef struct result {
    double rms;      // of the tips, part of the stroke's height
    double joints;   // of the arms off their natural angles, RMS (rad)
    double measure;  // largest of the joints
    double farthest; // beyond the bounds (rad)
} result;

static result play(bool with_posture)
{
    result r = {0, 0, 0, 0};
    double sum = 0, square = 0;
    long count = 0;
    aim(0);
    himc_pose start = pose_of(&reference.posture);
    place(&start, reference.posture.rate);
    memset(&saturation, 0, sizeof saturation);
    for (int n = 0; n < 15000; n++) {
        aim(n * STEP);
        himc_pose natural = pose_of(&reference.posture);
        if (!with_posture)
            forget_arms();
        step();
        if (n < 5000)
            continue;
        himc_pose now = himc_pose_from_state(&skeleton, &state);
        for (int j = HIMC_LEFT_UPPER_ARM - 1; j <= HIMC_RIGHT_STICK - 1; j++) {
            himc_quat off = himc_quat_mul(himc_quat_conj(natural.joint[j]), now.joint[j]);
            himc_vec3 turn = himc_quat_log(off);
            square += himc_vec3_dot(turn, turn) / 4;
        }
        for (int hand = 0; hand < HIMC_HANDS; hand++, count++) {
            himc_vec3 away = himc_vec3_sub(state.tip[hand], reference.tip[hand].x);
            sum += himc_vec3_dot(away, away);
        }
        if (controller.limits && n % 20 == 0)
            r.measure = fmax(r.measure, measure_now());
    }
    for (int j = 0; j < HIMC_JOINTS; j++)
        r.farthest = fmax(r.farthest, saturation.farthest[j]);
    r.joints = sqrt(square / (double)count);
    r.rms = sqrt(sum / (double)count) / HEIGHT;
    return r;
}

static void gains(double frequency)
{
    for (int j = 0; j < HIMC_JOINTS; j++) {
        himc_gain *g = &controller.gain[j];
        g->stiffness = himc_vec3_scale(g->stiffness, frequency * frequency);
        g->damping = himc_vec3_scale(g->damping, frequency);
    }
}

static void test_limits_switched_off_change_no_bit_of_the_torques(void)
{
    himc_vec3 without[HIMC_JOINTS], with[HIMC_JOINTS];
    learn(0);
    limits.kind = HIMC_LIMITS_OFF;
    aim(0.1);
    for (int law = HIMC_LAW_PRINTED; law <= HIMC_LAW_COMPUTED_TORQUE; law++) {
        controller.config.law = (himc_law)law;
        controller.limits = NULL;
        himc_controller_torques(&controller, &skeleton, &state, &reference, without);
        controller.limits = &limits;
        himc_controller_torques(&controller, &skeleton, &state, &reference, with);
        TEST_ASSERT_EQUAL_MEMORY(without, with, sizeof with);
    }
}

static void test_limits_learned_from_a_motion_leave_that_motion_alone(void)
{
    for (int kind = HIMC_LIMITS_ELLIPSOID; kind <= HIMC_LIMITS_EULER; kind++) {
        learn(0.02);
        limits.kind = (himc_limits_kind)kind;
        controller.limits = &limits;
        result r = play(true);
        TEST_ASSERT_TRUE(r.rms < 0.0001); // measured .000043 as without limits
        TEST_ASSERT_TRUE(r.measure < 1);
        for (int j = 0; j < HIMC_JOINTS; j++)
            TEST_ASSERT_EQUAL_INT(0, saturation.hits[j]);
    }
}

// the printed law has nothing for the null space: only limits keep the arm from folding up
static void test_limits_hold_the_arm_that_the_printed_law_lets_fold_up(void)
{
    controller.config.law = HIMC_LAW_PRINTED;
    gains(1 / 3.0);
    result without = play(false);
    learn(0);
    controller.limits = &limits;
    result with = play(false);
    TEST_ASSERT_TRUE(without.joints > 12 * DEGREE); // measured 14.5
    TEST_ASSERT_TRUE(with.joints < 10 * DEGREE);    // measured 8.8
    TEST_ASSERT_TRUE(with.farthest < 0.3 * DEGREE); // measured .12
}

static void comes_back(himc_law law, himc_pipeline mode, himc_limits_kind kind)
{
    int elbow = himc_arm_joint(HIMC_LEFT, 1), wrist = himc_arm_joint(HIMC_LEFT, 2);
    controller.config.law = law;
    controller.config.mode = mode;
    learn(0.1);
    limits.kind = kind;
    controller.limits = &limits;
    aim(0.125);
    himc_pose pose = pose_of(&reference.posture);
    pose.joint[elbow] =
        himc_quat_mul(pose.joint[elbow], himc_quat_exp(himc_vec3_make(0.3, -0.4, 0.3)));
    pose.joint[wrist] = himc_quat_mul(pose.joint[wrist], himc_quat_exp(himc_vec3_make(0, 0, 0.5)));
    place(&pose, NULL);
    TEST_ASSERT_TRUE(measure_now() > 2);
    for (int n = 0; n < 3000; n++) {
        // nothing is asked of the joints; of the tip, to stay where it is
        if (mode == HIMC_PIPELINE_HIMC)
            forget_arms();
        step();
    }
    himc_character_observe(character, &state);
    pose = himc_pose_from_state(&skeleton, &state);
    for (int j = 0; j < HIMC_JOINTS; j++) {
        himc_quat near = himc_limit_closest(&limits, j, pose.joint[j]);
        himc_quat beyond = himc_quat_mul(himc_quat_conj(near), pose.joint[j]);
        TEST_ASSERT_TRUE(himc_vec3_length(himc_quat_log(beyond)) < 0.2 * DEGREE);
    }
    TEST_ASSERT_TRUE(saturation.hits[elbow] > 0 && saturation.hits[wrist] > 0);
    TEST_ASSERT_TRUE(saturation.farthest[elbow] > 5 * DEGREE);
}

static void test_joint_beyond_its_bounds_comes_back_under_every_law_and_mode(void)
{
    for (int law = HIMC_LAW_PRINTED; law <= HIMC_LAW_COMPUTED_TORQUE; law++)
        for (int mode = HIMC_PIPELINE_HIMC; mode <= HIMC_PIPELINE_ID; mode++)
            for (int kind = HIMC_LIMITS_ELLIPSOID; kind <= HIMC_LIMITS_EULER; kind++)
                comes_back((himc_law)law, (himc_pipeline)mode, (himc_limits_kind)kind);
}

static void test_target_out_of_the_bounds_is_not_followed_beyond_them(void)
{
    for (int law = HIMC_LAW_PRINTED; law <= HIMC_LAW_COMPUTED_TORQUE; law++) {
        controller.config.law = (himc_law)law;
        learn(0);
        controller.limits = &limits;
        memset(&saturation, 0, sizeof saturation);
        aim(0);
        himc_pose start = pose_of(&reference.posture);
        place(&start, NULL);
        for (int n = 0; n < 4000; n++) {
            reference.tip[HIMC_LEFT] = (himc_target){.x = {0.3, 0.6, LEVEL + 0.4}};
            step();
        }
        double farthest = 0;
        for (int j = 0; j < HIMC_JOINTS; j++)
            farthest = fmax(farthest, saturation.farthest[j]);
        TEST_ASSERT_TRUE(farthest < 1.5 * DEGREE);
    }
}

static void test_bounds_of_no_width_hold_every_joint_and_nothing_flies_apart(void)
{
    for (int law = HIMC_LAW_PRINTED; law <= HIMC_LAW_COMPUTED_TORQUE; law++) {
        controller.config.law = (himc_law)law;
        learn(0);
        aim(0.125);
        himc_pose pose = pose_of(&reference.posture);
        for (int j = 0; j < HIMC_JOINTS; j++) {
            limits.joint[j].bound = true;
            limits.joint[j].mean = pose.joint[j];
            limits.joint[j].radius = himc_vec3_make(0, 0, 0);
        }
        controller.limits = &limits;
        place(&pose, NULL);
        memset(&saturation, 0, sizeof saturation);
        for (int n = 0; n < 3000; n++) {
            aim(0.125 + n * STEP);
            step();
        }
        for (int j = 0; j < HIMC_JOINTS; j++)
            TEST_ASSERT_TRUE(saturation.farthest[j] < 1.5 * DEGREE);
    }
}

static double energy(void)
{
    double sum = 0;
    for (int i = 1; i < HIMC_SEGMENTS; i++) {
        const himc_segment *g = &skeleton.segment[i];
        himc_vec3 c = himc_mat3_apply(&state.rotation[i], g->center), v = {0, 0, 0};
        himc_vec3 own = himc_mat3_apply_transposed(&state.rotation[i], state.spin[i]);
        for (int k = i; k > 0; k = skeleton.segment[k].parent) {
            himc_vec3 link = himc_vec3_sub(himc_vec3_add(state.origin[i], c), state.origin[k]);
            himc_vec3 spin = himc_vec3_sub(state.spin[k], state.spin[skeleton.segment[k].parent]);
            v = himc_vec3_add(v, himc_vec3_cross(spin, link));
        }
        sum += g->mass * (0.5 * himc_vec3_dot(v, v) + HIMC_GRAVITY * (state.origin[i].z + c.z)) +
               0.5 * (g->inertia.x * own.x * own.x + g->inertia.y * own.y * own.y +
                      g->inertia.z * own.z * own.z);
    }
    return sum;
}

// a body without servos falls into its limits: its energy only falls
static void test_limits_pump_no_energy_into_a_body_that_falls_into_them(void)
{
    controller.config.law = HIMC_LAW_PRINTED;
    gains(0);
    learn(0.1);
    controller.limits = &limits;
    aim(0.25);
    himc_pose pose = pose_of(&reference.posture);
    place(&pose, NULL);
    double start = energy(), most = start;
    for (int n = 0; n < 20000; n++) {
        step();
        if (n % 10 == 0)
            most = fmax(most, energy());
    }
    long hits = 0;
    for (int j = 0; j < HIMC_JOINTS; j++)
        hits += saturation.hits[j];
    TEST_ASSERT_TRUE(hits > 4);
    TEST_ASSERT_TRUE(most < start + 0.005); // of some 470 J
    TEST_ASSERT_TRUE(energy() < start - 1);
}

static void test_strength_shortens_the_torque_of_its_joint_and_counts(void)
{
    int elbow = himc_arm_joint(HIMC_LEFT, 1);
    himc_vec3 free[HIMC_JOINTS], weak[HIMC_JOINTS];
    aim(0.2);
    himc_controller_torques(&controller, &skeleton, &state, &reference, free);
    double asked = himc_vec3_length(free[elbow]);
    memset(&saturation, 0, sizeof saturation);
    controller.config.strength[elbow] = 0.25 * asked;
    himc_controller_torques(&controller, &skeleton, &state, &reference, weak);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9 * asked, 0.25 * asked, himc_vec3_length(weak[elbow]));
    TEST_ASSERT_EQUAL_INT(1, saturation.weak[elbow]);
    TEST_ASSERT_EQUAL_INT(0, saturation.weak[elbow + 1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9 * asked, asked, saturation.torque[elbow]);
    TEST_ASSERT_EQUAL_MEMORY(&free[elbow + 1], &weak[elbow + 1], sizeof free[0]);
}

static void test_human_strength_grows_with_the_body_and_from_fingers_to_waist(void)
{
    himc_controller_set_human_strength(&controller.config, 75);
    for (int k = 1; k < HIMC_ARM_JOINTS; k++)
        TEST_ASSERT_TRUE(controller.config.strength[himc_arm_joint(HIMC_LEFT, k)] <
                         controller.config.strength[himc_arm_joint(HIMC_LEFT, k - 1)]);
    double waist = controller.config.strength[HIMC_TRUNK - 1];
    himc_controller_set_human_strength(&controller.config, 60);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.8 * waist, controller.config.strength[HIMC_TRUNK - 1]);
}

// only a man's strength has it, smoothly with the tip's distance, not along a contact's normal, and
// in the hand's own arm and the trunk
static void test_a_tip_astray_draws_on_a_reserve_that_is_counted(void)
{
    himc_vec3 torque[HIMC_JOINTS];
    int left = himc_arm_joint(HIMC_LEFT, 0), right = himc_arm_joint(HIMC_RIGHT, 0);
    double before = 1;
    himc_controller_set_human_strength(&controller.config, 75);
    aim(0.2);
    for (double off = 0; off < 0.03; off += 1e-3) {
        reference.tip[HIMC_LEFT].x = state.tip[HIMC_LEFT];
        reference.tip[HIMC_LEFT].x.y += off;
        double now = himc_strength_reserve(&controller, &reference, &state, HIMC_LEFT);
        TEST_ASSERT_TRUE(off < 0.006 ? now == 1 : off > 0.0185 ? now == 6 : now - before < 1);
        before = now;
    }
    himc_balance stands = {.stand = {.standing = true}};
    controller.balance = &stands;
    TEST_ASSERT_EQUAL_DOUBLE(2, himc_strength_reserve(&controller, &reference, &state, HIMC_LEFT));
    controller.balance = NULL;
    reference.released[HIMC_LEFT] = true;
    reference.normal[HIMC_LEFT] = himc_vec3_make(0, 1, 0);
    TEST_ASSERT_EQUAL_DOUBLE(1, himc_strength_reserve(&controller, &reference, &state, HIMC_LEFT));
    reference.released[HIMC_LEFT] = false;
    for (int j = 0; j < HIMC_JOINTS; j++) {
        state.spin[j + 1] = state.spin[0];
        torque[j] = himc_vec3_make(0, 400, 0);
    }
    memset(&saturation, 0, sizeof saturation);
    himc_strength_apply(&controller, &skeleton, &state, (double[]){6, 1}, torque);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 400, torque[left].y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 80, himc_vec3_length(torque[right]));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 400, torque[HIMC_TRUNK - 1].y);
    TEST_ASSERT_EQUAL_INT(1, saturation.weak[right]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 80, saturation.given[right]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 400, saturation.given[left]);
}

static void test_strokes_of_375_mm_are_within_human_strength(void)
{
    himc_controller_set_human_strength(&controller.config, 75);
    result r = play(true);
    TEST_ASSERT_TRUE(r.rms < 0.0001);
    for (int j = 0; j < HIMC_JOINTS; j++)
        TEST_ASSERT_EQUAL_INT(0, saturation.weak[j]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_limits_switched_off_change_no_bit_of_the_torques);
    RUN_TEST(test_limits_learned_from_a_motion_leave_that_motion_alone);
    RUN_TEST(test_limits_hold_the_arm_that_the_printed_law_lets_fold_up);
    RUN_TEST(test_joint_beyond_its_bounds_comes_back_under_every_law_and_mode);
    RUN_TEST(test_target_out_of_the_bounds_is_not_followed_beyond_them);
    RUN_TEST(test_bounds_of_no_width_hold_every_joint_and_nothing_flies_apart);
    RUN_TEST(test_limits_pump_no_energy_into_a_body_that_falls_into_them);
    RUN_TEST(test_strength_shortens_the_torque_of_its_joint_and_counts);
    RUN_TEST(test_human_strength_grows_with_the_body_and_from_fingers_to_waist);
    RUN_TEST(test_a_tip_astray_draws_on_a_reserve_that_is_counted);
    RUN_TEST(test_strokes_of_375_mm_are_within_human_strength);
    return UNITY_END();
}
