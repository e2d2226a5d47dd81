/// test_character.c: the body in the physics engine against inverse dynamics, a compound pendulum
/// and the effective mass; two runs are equal.
///
/// Two properties of the engine have an effect here. It constrains joints by their velocities, so
/// centripetal forces act one step late: after a state is set, the first steps have an error of w x
/// (w x r), so the comparison begins after a dozen steps. And its gyroscopic term is implicit: it
/// brakes the roll of the thin stick (3e-6 kg m^2 about its length, a hundred times more across),
/// so the spins here are those of strokes.
#define _POSIX_C_SOURCE 200809L
#include "body/character.h"
#include "control/controller.h"
#include "himc/body.h"
#include "body/posture.h"

#include "step_with_tips.h"
#include "bodies.h"
#include "unity.h"

#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define LEGS HIMC_LEFT_UPPER_LEG

static himc_character *character;
static const himc_vec3 no_torque[HIMC_JOINTS];

void setUp(void)
{
    himc_skeleton_config config = himc_skeleton_default();
    himc_error error;
    himc_skeleton_init(&skeleton, &config, NULL);
    character = himc_character_new(&skeleton, &error);
    TEST_ASSERT_NOT_NULL(character);
    srand(7);
}

void tearDown(void)
{
    himc_character_free(character);
    himc_character_free(NULL); // allowed, as free(NULL) is
}

static double distance(himc_vec3 a, himc_vec3 b)
{
    return himc_vec3_length(himc_vec3_sub(a, b));
}

static void moderate_state(himc_body_state *s, double spin)
{
    himc_posture posture;
    himc_pose pose;
    himc_vec3 rate[HIMC_JOINTS], tip[HIMC_HANDS] = {{0.5, 0.1, 0.95}, {0.48, -0.05, 1.1}};
    himc_posture_init(&posture, &skeleton, 0.8675);
    himc_posture_at(&posture, tip, &pose);
    for (int j = 0; j < HIMC_JOINTS; j++)
        rate[j] = random_vector(spin);
    himc_pose_to_state(&skeleton, &pose, rate, s);
}

static himc_vec3 relative_spin(const himc_body_state *s, int j)
{
    return himc_vec3_sub(s->spin[j + 1], s->spin[skeleton.segment[j + 1].parent]);
}

// a step with the torques for these accelerations
static void asked_step(himc_body_state *s, const himc_vec3 *relative, double h)
{
    himc_vec3 torque[HIMC_JOINTS];
    himc_inverse_dynamics(&skeleton, s, relative, false, torque);
    himc_character_step(character, torque, NULL, 0, h);
    himc_character_observe(character, s);
}

// after `settled` steps: largest difference between accelerations asked for and made, over the
// largest asked for
static double mirror_error(const himc_body_state *start, const himc_vec3 *relative, int settled,
                           double h)
{
    himc_body_state s = *start, after;
    double worst = 0, size = 0;
    himc_character_place(character, &s);
    for (int n = 0; n < settled; n++)
        asked_step(&s, relative, h);
    after = s;
    asked_step(&after, relative, h);
    for (int j = 0; j < HIMC_JOINTS; j++) {
        himc_vec3 change = himc_vec3_sub(relative_spin(&after, j), relative_spin(&s, j));
        himc_vec3 missing = himc_vec3_sub(himc_vec3_scale(change, 1 / h), relative[j]);
        if (j + 1 == HIMC_LEFT_STICK || j + 1 == HIMC_RIGHT_STICK) { // but for its roll
            missing = himc_mat3_apply_transposed(&s.rotation[j + 1], missing);
            missing.z = 0;
        }
        worst = fmax(worst, himc_vec3_length(missing));
        size = fmax(size, himc_vec3_length(relative[j]));
    }
    return worst / size;
}

static void test_torques_of_inverse_dynamics_make_the_accelerations_asked_for(void)
{
    double coarse = 0, fine = 0;
    for (int n = 0; n < 50; n++) {
        himc_body_state s;
        himc_vec3 relative[HIMC_JOINTS];
        moderate_state(&s, 2);
        for (int j = 0; j < HIMC_JOINTS; j++)
            relative[j] = random_vector(30);
        coarse = fmax(coarse, mirror_error(&s, relative, 12, 1e-4));
        fine = fmax(fine, mirror_error(&s, relative, 12, 1e-5));
    }
    TEST_ASSERT_TRUE(coarse < 0.004); // measured .0020
    TEST_ASSERT_TRUE(fine < 0.0004);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.1, fine / coarse); // of first order
}

static void test_at_rest_the_mirror_has_no_error_of_the_step(void)
{
    himc_body_state s;
    himc_vec3 relative[HIMC_JOINTS];
    moderate_state(&s, 0);
    for (int j = 0; j < HIMC_JOINTS; j++)
        relative[j] = random_vector(30);
    TEST_ASSERT_TRUE(mirror_error(&s, relative, 0, 1e-4) < 1e-6);
}

static void test_place_and_observe_return_the_state(void)
{
    for (int n = 0; n < 100; n++) {
        himc_body_state s, seen;
        himc_pose pose;
        himc_vec3 rate[HIMC_JOINTS];
        for (int j = 0; j < HIMC_JOINTS; j++) {
            pose.joint[j] = himc_quat_exp(random_vector(2));
            rate[j] = random_vector(10);
        }
        himc_pose_to_state(&skeleton, &pose, rate, &s);
        himc_character_place(character, &s);
        memset(&seen, 0xFF, sizeof seen);
        himc_character_observe(character, &seen);
        const double *a = (const double *)&s, *b = (const double *)&seen;
        for (size_t i = 0; i < sizeof s / sizeof *a; i++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, a[i], b[i]);
    }
}

static void test_body_is_still_when_torques_balance_gravity(void)
{
    himc_body_state s, after;
    himc_vec3 torque[HIMC_JOINTS];
    moderate_state(&s, 0);
    himc_inverse_dynamics(&skeleton, &s, NULL, true, torque);
    himc_character_place(character, &s);
    for (int n = 0; n < 1000; n++) // an unstable balance: held for a tenth of a second
        himc_character_step(character, torque, NULL, 0, 1e-4);
    himc_character_observe(character, &after);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, distance(s.tip[hand], after.tip[hand]));
}

// straight legs with stiff knees, ankles and toes swing as one rigid body: T = 2 pi sqrt(I / (m g
// d)) (1 + a^2 / 16)
static double rigid_leg_period(double amplitude)
{
    himc_pose pose = himc_pose_zero();
    himc_body_state s;
    himc_pose_to_state(&skeleton, &pose, NULL, &s);
    double inertia = 0, first_x = 0, first_z = 0;
    for (int i = LEGS; i < HIMC_SEGMENTS; i += 2) {
        const himc_segment *segment = &skeleton.segment[i];
        himc_vec3 c = himc_vec3_sub(himc_vec3_add(s.origin[i], segment->center), s.origin[LEGS]);
        inertia += segment->inertia.y + segment->mass * (c.x * c.x + c.z * c.z);
        first_x += segment->mass * c.x;
        first_z += segment->mass * c.z;
    }
    double static_moment = sqrt(first_x * first_x + first_z * first_z) * 9.80665;
    return 2 * HIMC_PI * sqrt(inertia / static_moment) * (1 + amplitude * amplitude / 16);
}

// torques that keep the leg rigid: constraint forces by hand, from a stiff damped spring at knee,
// ankle and toes
static void stiffen(const himc_body_state *s, himc_vec3 torque[HIMC_JOINTS])
{
    for (int j = LEGS - 1; j < HIMC_JOINTS; j++) {
        torque[j] = himc_vec3_make(0, 0, 0);
        if (j < LEGS + 1) // the hips are free
            continue;
        const himc_segment *segment = &skeleton.segment[j + 1];
        double own =
            segment->inertia.y + segment->mass * himc_vec3_dot(segment->center, segment->center);
        double w = 2 * HIMC_PI * 60;
        himc_vec3 turned = himc_quat_log(
            himc_quat_mul(s->orientation[j + 1], himc_quat_conj(s->orientation[segment->parent])));
        torque[j] = himc_vec3_scale(turned, -own * w * w);
        torque[j] = himc_vec3_madd(torque[j], -2 * own * w, relative_spin(s, j));
    }
}

static void test_stiff_leg_swings_with_the_period_of_a_compound_pendulum(void)
{
    himc_pose pose = himc_pose_zero();
    himc_body_state s;
    himc_vec3 torque[HIMC_JOINTS] = {{0, 0, 0}};
    // foot and toes pull the centre forward: the leg swings about where that hangs below the hip
    double amplitude = 0.05, h = 2e-4, crossing[3], last = 0;
    int crossings = 0;
    for (int side = 0; side < 2; side++)
        pose.joint[LEGS - 1 + side] = himc_quat_exp(himc_vec3_make(0, amplitude, 0));
    himc_pose_to_state(&skeleton, &pose, NULL, &s);
    himc_character_place(character, &s);
    for (long n = 0; n < 20000 && crossings < 3; n++) {
        himc_character_observe(character, &s);
        double spin = s.spin[LEGS].y;
        if (n > 10 && last != 0 && (spin > 0) != (last > 0))
            crossing[crossings++] = (n - spin / (spin - last)) * h;
        last = spin;
        stiffen(&s, torque);
        himc_character_step(character, torque, NULL, 0, h);
    }
    TEST_ASSERT_EQUAL_INT(3, crossings);
    double period = crossing[2] - crossing[0];
    TEST_ASSERT_DOUBLE_WITHIN(0.002 * period, rigid_leg_period(amplitude), period);
}

static double joint_gap(void)
{
    himc_body_state s;
    double worst = 0;
    himc_character_observe(character, &s);
    for (int i = 1; i < HIMC_SEGMENTS; i++) {
        int p = skeleton.segment[i].parent;
        himc_vec3 joint = himc_mat3_apply(&s.rotation[p], skeleton.segment[i].origin);
        worst = fmax(worst, distance(himc_vec3_add(s.origin[p], joint), s.origin[i]));
    }
    return worst;
}

static void test_joints_hold_within_a_micrometre_over_a_second_of_strokes(void)
{
    himc_posture posture;
    himc_controller controller;
    himc_reference reference = {.released = {false, false}};
    himc_vec3 torque[HIMC_JOINTS];
    himc_body_state s;
    double worst = 0;
    himc_posture_init(&posture, &skeleton, 0.8675);
    moderate_state(&s, 0);
    himc_controller_config control = himc_controller_config_default();
    himc_controller_init(&controller, &control, &skeleton, &s);
    for (int n = 0; n < 10000; n++) {
        double w = 2 * HIMC_PI * 2, phase = w * n * 1e-4, r = 0.375 / 2;
        for (int hand = 0; hand < HIMC_HANDS; hand++, phase += HIMC_PI)
            reference.tip[hand] = (himc_target){
                {0.48, hand == HIMC_LEFT ? 0.05 : -0.05, 0.8675 + r * (1 - cos(phase))},
                {0, 0, r * w * sin(phase)},
                {0, 0, r * w * w * cos(phase)}};
        himc_posture_moving(&posture, reference.tip, &reference.posture);
        if (n == 0) {
            himc_pose pose;
            memcpy(pose.joint, reference.posture.joint, sizeof pose.joint);
            himc_pose_to_state(&skeleton, &pose, reference.posture.rate, &s);
            himc_character_place(character, &s);
        }
        himc_character_observe(character, &s);
        himc_controller_torques(&controller, &skeleton, &s, &reference, torque);
        himc_character_step(character, torque, NULL, 0, 1e-4);
        worst = fmax(worst, joint_gap());
    }
    TEST_ASSERT_TRUE(worst < 1e-6); // measured 3e-8
}

static void test_body_without_torques_falls_and_its_joints_hold(void)
{
    himc_body_state s;
    double worst = 0;
    moderate_state(&s, 2);
    himc_character_place(character, &s);
    for (int n = 0; n < 10000; n++) {
        himc_character_step(character, no_torque, NULL, 0, 1e-4);
        worst = fmax(worst, joint_gap());
    }
    himc_character_observe(character, &s);
    TEST_ASSERT_TRUE(himc_body_state_finite(&s));
    TEST_ASSERT_TRUE(worst < 1e-4); // measured 2e-5
}

static void run_free(himc_character *c, himc_body_state *s)
{
    himc_vec3 force[HIMC_HANDS] = {{0, 0, 5}, {1, 0, -3}}, torque[HIMC_JOINTS];
    moderate_state(s, 2);
    himc_character_place(c, s);
    srand(8);
    for (int n = 0; n < 2000; n++) {
        for (int j = 0; j < HIMC_JOINTS; j++)
            torque[j] = random_vector(0.1);
        step_with_tips(c, &skeleton, torque, force, 1e-4);
    }
    memset(s, 0, sizeof *s);
    himc_character_observe(c, s);
}

static void test_two_runs_are_equal_bit_by_bit(void)
{
    himc_body_state first, again, other;
    himc_character *second = himc_character_new(&skeleton, NULL);
    srand(9);
    run_free(character, &first);
    srand(9);
    run_free(character, &again);
    srand(9);
    run_free(second, &other);
    himc_character_free(second);
    TEST_ASSERT_TRUE(himc_body_state_finite(&first));
    TEST_ASSERT_EQUAL_MEMORY(&first, &again, sizeof first);
    TEST_ASSERT_EQUAL_MEMORY(&first, &other, sizeof first);
}

static void test_force_on_a_tip_accelerates_the_effective_mass(void)
{
    double h = 1e-5, worst = 0;
    for (int n = 0; n < 50; n++) {
        himc_body_state s, free, pushed;
        himc_articulation art;
        himc_vec3 force[HIMC_HANDS] = {{0, 0, 0}}, torque[HIMC_JOINTS];
        himc_hand hand = (himc_hand)(n % 2);
        himc_vec3 normal = himc_vec3_unit(himc_vec3_make(random_vector(0.3).x, 0.1, 1));
        moderate_state(&s, 1);
        force[hand] = himc_vec3_scale(normal, 20);
        himc_inverse_dynamics(&skeleton, &s, NULL, false, torque);
        himc_character_place(character, &s);
        himc_character_step(character, torque, NULL, 0, h);
        himc_character_observe(character, &free);
        himc_character_place(character, &s);
        step_with_tips(character, &skeleton, torque, force, h);
        himc_character_observe(character, &pushed);
        himc_vec3 dv = himc_vec3_sub(pushed.tip_velocity[hand], free.tip_velocity[hand]);
        himc_articulate(&skeleton, &s, &art);
        double mass = himc_effective_mass(&skeleton, &s, &art, hand, normal);
        worst = fmax(worst, fabs(himc_vec3_dot(normal, dv) / h * mass / 20 - 1));
    }
    TEST_ASSERT_TRUE(worst < 1e-3); // measured 2e-5
}

// in a separate process, since the engine aborts on bad input
static int survives(double torque)
{
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        himc_vec3 all[HIMC_JOINTS], force[HIMC_HANDS];
        himc_body_state s;
        fclose(stderr);
        for (int j = 0; j < HIMC_JOINTS; j++)
            all[j] = himc_vec3_make(torque, -torque, torque);
        force[0] = force[1] = all[0];
        for (int n = 0; n < 20; n++)
            step_with_tips(character, &skeleton, all, force, 1e-4);
        moderate_state(&s, 1);
        himc_character_place(character, &s);
        himc_character_step(character, no_torque, NULL, 0, 1e-4);
        himc_character_observe(character, &s);
        _exit(himc_body_state_finite(&s) ? 0 : 1);
    }
    int status = -1;
    waitpid(child, &status, 0);
    return status;
}

static void test_no_torque_or_force_ends_the_process_and_the_body_can_be_placed_again(void)
{
    static const double torques[] = {1e3, 1e6, 1e12, 1e200, 1e308, INFINITY, NAN};
    for (int i = 0; i < 7; i++) {
        char what[32];
        snprintf(what, sizeof what, "%g N m", torques[i]);
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, survives(torques[i]), what);
    }
}

// places, seats and steps a body in such a state
static void use_bad(himc_character *c, int what, himc_engine engine)
{
    static const himc_quat bad_quat[] = {
        {NAN, 0, 0, 0}, {0, 0, 0, 0}, {INFINITY, 0, 0, 0}, {1e-200, 0, 0, 0}, {1e200, 0, 0, 0}};
    static const double bad_spin[] = {NAN, INFINITY, 1e200, 4000};
    himc_body_state s;
    himc_pose zero = himc_pose_zero();
    himc_pose_to_state(&skeleton, &zero, NULL, &s);
    if (what < 5)
        s.orientation[HIMC_TRUNK] = bad_quat[what];
    else
        s.spin[HIMC_TRUNK].y = bad_spin[what - 5];
    himc_character_use(c, engine);
    if (himc_character_place(c, &s) || himc_character_step(c, no_torque, NULL, 0, 1e-4))
        _exit(1);
    if (!himc_character_seat(c, skeleton.segment[HIMC_PELVIS].origin.z + 0.1) ||
        himc_character_seat(c, NAN))
        _exit(2);
    if (!himc_character_step(c, no_torque, NULL, 0, 1e-4))
        _exit(3);
    himc_character_observe(c, &s);
    if (!himc_body_state_finite(&s))
        _exit(4);
}

static void test_no_state_that_is_placed_or_seated_ends_the_process(void)
{
    for (int i = 0; i < 18; i++) {
        int status;
        pid_t child = fork();
        if (child == 0) {
            use_bad(character, i / 2, (himc_engine)(i % 2));
            _exit(0);
        }
        waitpid(child, &status, 0);
        TEST_ASSERT_TRUE(WIFEXITED(status));
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, WEXITSTATUS(status), "1 placed, 2 seat, 3 step, 4 state");
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_torques_of_inverse_dynamics_make_the_accelerations_asked_for);
    RUN_TEST(test_at_rest_the_mirror_has_no_error_of_the_step);
    RUN_TEST(test_place_and_observe_return_the_state);
    RUN_TEST(test_body_is_still_when_torques_balance_gravity);
    RUN_TEST(test_stiff_leg_swings_with_the_period_of_a_compound_pendulum);
    RUN_TEST(test_joints_hold_within_a_micrometre_over_a_second_of_strokes);
    RUN_TEST(test_body_without_torques_falls_and_its_joints_hold);
    RUN_TEST(test_two_runs_are_equal_bit_by_bit);
    RUN_TEST(test_force_on_a_tip_accelerates_the_effective_mass);
    RUN_TEST(test_no_torque_or_force_ends_the_process_and_the_body_can_be_placed_again);
    RUN_TEST(test_no_state_that_is_placed_or_seated_ends_the_process);
    return UNITY_END();
}
