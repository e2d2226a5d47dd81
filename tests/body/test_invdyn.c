/// test_invdyn.c: inverse and forward dynamics are mirrors; both agree with statics computed by
/// hand and with differences of motion.
#include "body/character.h"
#include "body/dynamics.h"
#include "body/posture.h"

#include "bodies.h"
#include "unity.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define UPPER_JOINTS (HIMC_LEFT_UPPER_LEG - 1) // joints of trunk, neck, head and arms

void setUp(void)
{
    default_skeleton(6);
}

void tearDown(void)
{
}

static void random_accelerations(himc_vec3 relative[HIMC_JOINTS], double scale)
{
    for (int j = 0; j < HIMC_JOINTS; j++)
        relative[j] = random_vector(scale);
}

static double distance(himc_vec3 a, himc_vec3 b)
{
    return himc_vec3_length(himc_vec3_sub(a, b));
}

// both sticks level over a head, as at impact
static void playing_state(himc_body_state *s)
{
    himc_posture posture;
    himc_pose pose;
    himc_posture_init(&posture, &skeleton, 0.8675 - 0.0134); // so the sticks are level
    himc_vec3 tip[HIMC_HANDS] = {{0.48, 0.05, 0.8675}, {0.48, -0.05, 0.8675}};
    himc_posture_at(&posture, tip, &pose);
    himc_pose_to_state(&skeleton, &pose, NULL, s);
}

static void test_forward_dynamics_returns_the_accelerations_inverse_dynamics_was_asked_for(void)
{
    for (int n = 0; n < 1000; n++) {
        himc_body_state s;
        himc_articulation art;
        himc_vec3 relative[HIMC_JOINTS], torque[HIMC_JOINTS], back[HIMC_JOINTS];
        random_state(&s, 10);
        random_accelerations(relative, 100);
        himc_inverse_dynamics(&skeleton, &s, relative, false, torque);
        himc_articulate(&skeleton, &s, &art);
        himc_forward_dynamics(&skeleton, &s, &art, torque, NULL, back);
        for (int j = 0; j < HIMC_JOINTS; j++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-9 * 100, 0, distance(relative[j], back[j]));
    }
}

static void test_inverse_dynamics_returns_the_torques_forward_dynamics_was_given(void)
{
    for (int n = 0; n < 1000; n++) {
        himc_body_state s;
        himc_articulation art;
        himc_vec3 torque[HIMC_JOINTS], relative[HIMC_JOINTS], back[HIMC_JOINTS];
        random_state(&s, 10);
        for (int j = 0; j < HIMC_JOINTS; j++) {
            torque[j] = random_vector(1);
            relative[j] = himc_vec3_make(0, 0, 0);
        }
        himc_articulate(&skeleton, &s, &art);
        himc_forward_dynamics(&skeleton, &s, &art, torque, NULL, relative);
        himc_inverse_dynamics(&skeleton, &s, relative, false, back);
        for (int j = 0; j < HIMC_JOINTS; j++) // accelerations of thin sticks reach 1e6 rad/s^2
            TEST_ASSERT_DOUBLE_WITHIN(1e-8, 0, distance(torque[j], back[j]));
    }
}

// both arms and sticks held out forward: the weights times their distances from the shoulder
static void test_gravity_torque_of_a_horizontal_straight_arm(void)
{
    himc_pose pose = himc_pose_zero();
    himc_body_state s;
    himc_vec3 torque[HIMC_JOINTS];
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        pose.joint[himc_arm_joint((himc_hand)hand, 0)] =
            himc_quat_exp(himc_vec3_make(0, -HIMC_PI / 2, 0));
    himc_pose_to_state(&skeleton, &pose, NULL, &s);
    himc_inverse_dynamics(&skeleton, &s, NULL, true, torque);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        double moment = 0;
        for (int k = HIMC_ARM_JOINTS - 1; k >= 0; k--) {
            double beyond = 0;
            for (int l = k; l < HIMC_ARM_JOINTS; l++) {
                const himc_segment *part =
                    &skeleton.segment[himc_arm_joint((himc_hand)hand, l) + 1];
                double from = 0;
                for (int i = k; i < l; i++)
                    from += skeleton.segment[himc_arm_joint((himc_hand)hand, i) + 1].length;
                beyond += part->mass * 9.80665 * (from - part->center.z);
            }
            moment = fmax(moment, beyond);
            // the muscles lift: forward is x, so up is a turn about -y
            himc_vec3 want = himc_vec3_make(0, -beyond, 0);
            himc_vec3 got = torque[himc_arm_joint((himc_hand)hand, k)];
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, distance(want, got));
        }
        TEST_ASSERT_DOUBLE_WITHIN(0.02, 11.24, moment); // of 75 kg at 1.75 m, on paper
    }
}

static void test_standing_still_in_the_zero_pose_needs_almost_no_torque_in_the_arms(void)
{
    himc_pose pose = himc_pose_zero();
    himc_body_state s;
    himc_vec3 torque[HIMC_JOINTS];
    himc_pose_to_state(&skeleton, &pose, NULL, &s);
    himc_inverse_dynamics(&skeleton, &s, NULL, false, torque);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        for (int k = 0; k < HIMC_ARM_JOINTS; k++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-14, 0,
                                      himc_vec3_length(torque[himc_arm_joint((himc_hand)hand, k)]));
}

static void test_still_gives_the_torques_of_gravity_alone(void)
{
    himc_body_state s, resting;
    himc_vec3 a[HIMC_JOINTS], b[HIMC_JOINTS], c[HIMC_JOINTS];
    random_state(&s, 10);
    resting = s;
    memset(resting.spin, 0, sizeof resting.spin);
    himc_inverse_dynamics(&skeleton, &s, NULL, true, a);
    himc_inverse_dynamics(&skeleton, &resting, NULL, false, b);
    himc_inverse_dynamics(&skeleton, &s, NULL, false, c);
    TEST_ASSERT_EQUAL_MEMORY(a, b, sizeof a);
    TEST_ASSERT_TRUE(distance(a[0], c[0]) > 0.1);
}

static double energy(const himc_body_state *s, const himc_vec3 *earlier, const himc_vec3 *later,
                     double h)
{
    double sum = 0;
    for (int i = 1; i < HIMC_SEGMENTS; i++) {
        const himc_segment *segment = &skeleton.segment[i];
        himc_vec3 v = himc_vec3_scale(himc_vec3_sub(later[i], earlier[i]), 0.5 / h);
        himc_vec3 w = himc_mat3_apply_transposed(&s->rotation[i], s->spin[i]);
        himc_vec3 c =
            himc_vec3_add(s->origin[i], himc_mat3_apply(&s->rotation[i], segment->center));
        sum += 0.5 * segment->mass * himc_vec3_dot(v, v) + segment->mass * 9.80665 * c.z;
        sum += 0.5 * (segment->inertia.x * w.x * w.x + segment->inertia.y * w.y * w.y +
                      segment->inertia.z * w.z * w.z);
    }
    return sum;
}

// a time t further on: each segment's spin and angular acceleration kept constant in the world
static void carried(const himc_body_state *s, const himc_vec3 *alpha, double t,
                    himc_body_state *out)
{
    *out = *s;
    for (int i = 1; i < HIMC_SEGMENTS; i++) {
        himc_vec3 turn = himc_vec3_madd(himc_vec3_scale(s->spin[i], t), 0.5 * t * t, alpha[i]);
        out->orientation[i] = himc_quat_mul(himc_quat_exp(turn), s->orientation[i]);
        out->spin[i] = himc_vec3_madd(s->spin[i], t, alpha[i]);
    }
    himc_body_state_complete(&skeleton, out);
}

static void absolute(const himc_vec3 relative[HIMC_JOINTS], himc_vec3 alpha[HIMC_SEGMENTS])
{
    alpha[0] = himc_vec3_make(0, 0, 0);
    for (int i = 1; i < HIMC_SEGMENTS; i++)
        alpha[i] = himc_vec3_add(alpha[skeleton.segment[i].parent], relative[i - 1]);
}

static void centers(const himc_body_state *s, himc_vec3 c[HIMC_SEGMENTS])
{
    for (int i = 0; i < HIMC_SEGMENTS; i++)
        c[i] = himc_vec3_add(s->origin[i],
                             himc_mat3_apply(&s->rotation[i], skeleton.segment[i].center));
}

static double energy_after(const himc_body_state *s, const himc_vec3 *alpha, double t)
{
    himc_body_state before, at, after;
    himc_vec3 c0[HIMC_SEGMENTS], c1[HIMC_SEGMENTS];
    double h = 1e-5;
    carried(s, alpha, t - h, &before);
    carried(s, alpha, t, &at);
    carried(s, alpha, t + h, &after);
    centers(&before, c0);
    centers(&after, c1);
    return energy(&at, c0, c1, h);
}

// power of the torques = change of kinetic and potential energy, differentiated numerically:
// independent of both modules
static void test_power_of_the_torques_is_the_change_of_energy(void)
{
    for (int n = 0; n < 50; n++) {
        himc_body_state s;
        himc_vec3 relative[HIMC_JOINTS], torque[HIMC_JOINTS], alpha[HIMC_SEGMENTS];
        random_state(&s, 3);
        random_accelerations(relative, 30);
        absolute(relative, alpha);
        himc_inverse_dynamics(&skeleton, &s, relative, false, torque);
        double power = 0, size = 0, h = 1e-4;
        for (int j = 0; j < HIMC_JOINTS; j++) {
            himc_vec3 w = himc_vec3_sub(s.spin[j + 1], s.spin[skeleton.segment[j + 1].parent]);
            power += himc_vec3_dot(torque[j], w);
            size += fabs(himc_vec3_dot(torque[j], w));
        }
        double change = (energy_after(&s, alpha, h) - energy_after(&s, alpha, -h)) / (2 * h);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4 * size, power, change);
    }
}

static void test_tip_acceleration_is_the_difference_of_its_velocity(void)
{
    double h = 1e-5;
    for (int n = 0; n < 200; n++) {
        himc_body_state s, before, after;
        himc_vec3 relative[HIMC_JOINTS], alpha[HIMC_SEGMENTS];
        random_state(&s, 5);
        random_accelerations(relative, 50);
        absolute(relative, alpha);
        carried(&s, alpha, -h, &before);
        carried(&s, alpha, h, &after);
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            himc_vec3 a = himc_vec3_sub(after.tip_velocity[hand], before.tip_velocity[hand]);
            a = himc_vec3_scale(a, 0.5 / h);
            himc_vec3 got = himc_tip_acceleration(&skeleton, &s, (himc_hand)hand, relative, NULL);
            TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0, distance(a, got));
        }
    }
}

static void test_a_carried_tip_accelerates_as_with_arms_that_do_not(void)
{
    for (int n = 0; n < 200; n++) {
        himc_body_state s;
        himc_vec3 relative[HIMC_JOINTS], held[HIMC_JOINTS];
        random_state(&s, 5);
        random_accelerations(relative, 50);
        memcpy(held, relative, sizeof held);
        for (int i = HIMC_LEFT_UPPER_ARM; i <= HIMC_RIGHT_STICK; i++)
            held[i - 1] = himc_vec3_make(0, 0, 0);
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            himc_vec3 a = himc_tip_carried(&skeleton, &s, (himc_hand)hand, relative, NULL);
            himc_vec3 b = himc_tip_acceleration(&skeleton, &s, (himc_hand)hand, held, NULL);
            TEST_ASSERT_EQUAL_DOUBLE(0, distance(a, b));
        }
    }
}

static void test_an_articulation_spares_work_and_changes_no_torque(void)
{
    for (int n = 0; n < 200; n++) {
        himc_body_state s;
        himc_articulation art;
        himc_vec3 relative[HIMC_JOINTS], alone[HIMC_JOINTS], shared[HIMC_JOINTS];
        random_state(&s, 5);
        random_accelerations(relative, 50);
        himc_articulate(&skeleton, &s, &art);
        himc_inverse_dynamics_of(&skeleton, &s, NULL, relative, NULL, alone, NULL);
        himc_inverse_dynamics_of(&skeleton, &s, &art, relative, NULL, shared, NULL);
        TEST_ASSERT_EQUAL_MEMORY(alone, shared, sizeof alone);
    }
}

static void test_effective_mass_is_force_over_tip_acceleration(void)
{
    for (int n = 0; n < 500; n++) {
        himc_body_state s;
        himc_articulation art;
        himc_vec3 torque[HIMC_JOINTS], free[HIMC_JOINTS], pushed[HIMC_JOINTS];
        himc_hand hand = (himc_hand)(n % 2);
        himc_vec3 normal = himc_vec3_unit(random_vector(1)), force[HIMC_HANDS] = {{0, 0, 0}};
        random_state(&s, 5);
        for (int j = 0; j < HIMC_JOINTS; j++) {
            torque[j] = random_vector(1);
            free[j] = pushed[j] = himc_vec3_make(0, 0, 0);
        }
        force[hand] = himc_vec3_scale(normal, 10);
        himc_articulate(&skeleton, &s, &art);
        himc_forward_dynamics(&skeleton, &s, &art, torque, NULL, free);
        himc_forward_dynamics(&skeleton, &s, &art, torque, force, pushed);
        himc_vec3 more = himc_vec3_sub(himc_tip_acceleration(&skeleton, &s, hand, pushed, NULL),
                                       himc_tip_acceleration(&skeleton, &s, hand, free, NULL));
        double mass = himc_effective_mass(&skeleton, &s, &art, hand, normal);
        TEST_ASSERT_DOUBLE_WITHIN(1e-7 * mass, 10 / himc_vec3_dot(normal, more), mass);
    }
}

// the pelvis with six freedoms under a wrench: both ways, and what a tip weighs then
static void test_a_free_pelvis_accelerates_as_inverse_dynamics_was_asked_for(void)
{
    skeleton.segment[HIMC_PELVIS].joint = HIMC_JOINT_FREE;
    for (int n = 0; n < 1000; n++) {
        himc_body_state s;
        himc_articulation art;
        himc_spatial root = {random_vector(50), random_vector(50)}, needed, back, pushed;
        himc_vec3 relative[HIMC_JOINTS], torque[HIMC_JOINTS], joint[HIMC_JOINTS];
        random_state(&s, 10);
        s.spin[0] = random_vector(5);
        random_accelerations(relative, 100);
        himc_articulate(&skeleton, &s, &art);
        himc_inverse_dynamics_of(&skeleton, &s, &art, relative, &root, torque, &needed);
        himc_forward_dynamics_of(&skeleton, &s, &art, torque, NULL, &needed, joint, &back);
        for (int j = 0; j < HIMC_JOINTS; j++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0, distance(relative[j], joint[j]));
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0, distance(root.angular, back.angular));
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0, distance(root.linear, back.linear));
        himc_hand hand = (himc_hand)(n % 2);
        himc_vec3 normal = himc_vec3_unit(random_vector(1)), force[HIMC_HANDS] = {{0, 0, 0}};
        force[hand] = himc_vec3_scale(normal, 10);
        himc_vec3 before = himc_tip_acceleration(&skeleton, &s, hand, joint, &back);
        himc_forward_dynamics_of(&skeleton, &s, &art, torque, force, &needed, joint, &pushed);
        himc_vec3 after = himc_tip_acceleration(&skeleton, &s, hand, joint, &pushed);
        double mass = himc_effective_mass(&skeleton, &s, &art, hand, normal);
        double more = himc_vec3_dot(normal, himc_vec3_sub(after, before));
        TEST_ASSERT_DOUBLE_WITHIN(1e-7 * mass, 10 / more, mass);
    }
}

// 0.0271 kg for a planar arm; between the stick floating freely and the stick pinned at the grip
static void test_pivoting_stick_of_45_g_weighs_27_g_at_its_tip(void)
{
    himc_body_state s;
    himc_articulation art;
    playing_state(&s);
    himc_articulate(&skeleton, &s, &art);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        double mass =
            himc_effective_mass(&skeleton, &s, &art, (himc_hand)hand, himc_vec3_make(0, 0, 1));
        const himc_segment *stick = &skeleton.segment[himc_stick_segment((himc_hand)hand)];
        double c = stick->center.z, reach = skeleton.tip.z;
        double pinned = (stick->inertia.x + stick->mass * c * c) / (reach * reach);
        double loose = 1 / (1 / stick->mass + (reach - c) * (reach - c) / stick->inertia.x);
        TEST_ASSERT_DOUBLE_WITHIN(0.0004, 0.0271, mass);
        TEST_ASSERT_TRUE(loose < mass && mass < pinned);
    }
}

static void test_effective_mass_along_the_stick_is_much_larger(void)
{
    himc_body_state s;
    himc_articulation art;
    playing_state(&s);
    himc_articulate(&skeleton, &s, &art);
    himc_vec3 z = {s.rotation[HIMC_LEFT_STICK].m[0][2], s.rotation[HIMC_LEFT_STICK].m[1][2],
                   s.rotation[HIMC_LEFT_STICK].m[2][2]};
    TEST_ASSERT_TRUE(himc_effective_mass(&skeleton, &s, &art, HIMC_LEFT, z) > 0.045);
}

static void test_legs_at_rest_take_no_part_and_their_entries_hold(void)
{
    himc_body_state s;
    himc_articulation all, upper;
    himc_vec3 torque[HIMC_JOINTS] = {{0, 0, 0}}, relative[HIMC_JOINTS], part[HIMC_JOINTS];
    random_state(&s, 5);
    for (int j = 0; j < HIMC_JOINTS; j++)
        part[j] = himc_vec3_make(7, 8, 9);
    himc_articulate(&skeleton, &s, &all);
    upper = all;
    himc_articulate_upper(&skeleton, &s, &upper);
    himc_forward_dynamics(&skeleton, &s, &all, torque, NULL, relative);
    himc_forward_dynamics(&skeleton, &s, &upper, torque, NULL, part);
    TEST_ASSERT_EQUAL_MEMORY(relative, part, sizeof *part * UPPER_JOINTS);
    for (int j = UPPER_JOINTS; j < HIMC_JOINTS; j++)
        TEST_ASSERT_EQUAL_DOUBLE(0, distance(part[j], himc_vec3_make(7, 8, 9)));
    TEST_ASSERT_EQUAL_INT(HIMC_LEGS, upper.end);
    upper.end = all.end;
    TEST_ASSERT_EQUAL_MEMORY(&all, &upper, sizeof all);
}

// the torques minus the joints' resistance make the accelerations, in the legs too
static void test_resisting_joints_accelerate_by_their_remaining_torques(void)
{
    for (int n = 0; n < 1000; n++) {
        himc_body_state s;
        himc_articulation art;
        himc_vec3 torque[HIMC_JOINTS], relative[HIMC_JOINTS], back[HIMC_JOINTS];
        himc_vec3 resistance[HIMC_JOINTS], force[HIMC_HANDS] = {{0, 0, 0}, {0, 0, 0}};
        himc_hand hand = (himc_hand)(n % 2);
        random_state(&s, 10);
        for (int j = 0; j < HIMC_JOINTS; j++) {
            torque[j] = random_vector(1);
            himc_vec3 d = random_vector(n % 3 ? 0.01 : 10);
            resistance[j] = himc_vec3_make(fabs(d.x), fabs(d.y), fabs(d.z));
        }
        force[hand] = random_vector(n % 5 ? 0 : 20);
        himc_articulate_resisting(&skeleton, &s, resistance, &art);
        himc_forward_dynamics(&skeleton, &s, &art, torque, force, relative);
        himc_inverse_dynamics(&skeleton, &s, relative, false, back);
        // the torques of the tip force, subtracted from the stick to the pelvis
        for (int i = himc_stick_segment(hand); i > 0; i = skeleton.segment[i].parent)
            back[i - 1] = himc_vec3_sub(
                back[i - 1], himc_vec3_cross(himc_vec3_sub(s.tip[hand], s.origin[i]), force[hand]));
        for (int j = 0; j < HIMC_JOINTS; j++) {
            himc_vec3 a = himc_mat3_apply_transposed(&s.rotation[j + 1], relative[j]);
            himc_vec3 d = resistance[j];
            a = himc_mat3_apply(&s.rotation[j + 1],
                                himc_vec3_make(d.x * a.x, d.y * a.y, d.z * a.z));
            TEST_ASSERT_DOUBLE_WITHIN(1e-8, 0, distance(himc_vec3_sub(torque[j], a), back[j]));
        }
    }
}

// two hands drumming at 2 Hz: the torques of inverse dynamics for the motion, applied without
// feedback for 10 ms from any point of it, keep the body on it
static void test_torques_of_a_motion_reproduce_it_in_open_loop(void)
{
    const double h = 1e-4;
    himc_posture posture;
    himc_character *character = himc_character_new(&skeleton, NULL);
    himc_posture_init(&posture, &skeleton, 0.8675);
    double worst = 0;
    for (int n = 0; n < 5000; n++) {
        himc_target tip[HIMC_HANDS];
        himc_posture_motion motion;
        himc_body_state is, wanted;
        himc_vec3 relative[HIMC_JOINTS], torque[HIMC_JOINTS];
        himc_pose pose;
        // torques are for the middle of the step
        for (int part = 0; part < 2; part++) {
            double w = 4 * HIMC_PI, t = (n + 0.5 * part) * h;
            for (int hand = 0; hand < HIMC_HANDS; hand++) {
                double p = w * t + hand * HIMC_PI, r = 0.19;
                tip[hand].x = himc_vec3_make(0.48 + 0.02 * sin(p), 0.05 - 0.1 * hand,
                                             0.8675 + r * (1 - cos(p)));
                tip[hand].v = himc_vec3_make(0.02 * w * cos(p), 0, r * w * sin(p));
                tip[hand].a = himc_vec3_make(-0.02 * w * w * sin(p), 0, r * w * w * cos(p));
            }
            himc_posture_moving(&posture, tip, &motion);
            memcpy(pose.joint, motion.joint, sizeof pose.joint);
            himc_pose_to_state(&skeleton, &pose, motion.rate, &wanted);
            if (part > 0)
                continue;
            if (n % 100 == 0)
                himc_character_place(character, &wanted);
            himc_character_observe(character, &is);
            for (int hand = 0; hand < HIMC_HANDS; hand++)
                worst = fmax(worst, distance(is.tip[hand], wanted.tip[hand]));
        }
        for (int j = 0; j < HIMC_JOINTS; j++) {
            int p = skeleton.segment[j + 1].parent;
            himc_vec3 rate = himc_mat3_apply(&wanted.rotation[p], motion.rate[j]);
            relative[j] =
                himc_vec3_add(himc_mat3_apply(&wanted.rotation[p], motion.acceleration[j]),
                              himc_vec3_cross(wanted.spin[p], rate));
        }
        himc_inverse_dynamics(&skeleton, &wanted, relative, false, torque);
        TEST_ASSERT_TRUE(himc_character_step(character, torque, NULL, 0, h));
    }
    himc_character_free(character);
    char what[64];
    snprintf(what, sizeof what, "%.6f m", worst);
    TEST_ASSERT_TRUE_MESSAGE(worst < 0.0005, what);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_forward_dynamics_returns_the_accelerations_inverse_dynamics_was_asked_for);
    RUN_TEST(test_inverse_dynamics_returns_the_torques_forward_dynamics_was_given);
    RUN_TEST(test_gravity_torque_of_a_horizontal_straight_arm);
    RUN_TEST(test_standing_still_in_the_zero_pose_needs_almost_no_torque_in_the_arms);
    RUN_TEST(test_still_gives_the_torques_of_gravity_alone);
    RUN_TEST(test_power_of_the_torques_is_the_change_of_energy);
    RUN_TEST(test_tip_acceleration_is_the_difference_of_its_velocity);
    RUN_TEST(test_a_carried_tip_accelerates_as_with_arms_that_do_not);
    RUN_TEST(test_an_articulation_spares_work_and_changes_no_torque);
    RUN_TEST(test_effective_mass_is_force_over_tip_acceleration);
    RUN_TEST(test_a_free_pelvis_accelerates_as_inverse_dynamics_was_asked_for);
    RUN_TEST(test_pivoting_stick_of_45_g_weighs_27_g_at_its_tip);
    RUN_TEST(test_effective_mass_along_the_stick_is_much_larger);
    RUN_TEST(test_legs_at_rest_take_no_part_and_their_entries_hold);
    RUN_TEST(test_resisting_joints_accelerate_by_their_remaining_torques);
    RUN_TEST(test_torques_of_a_motion_reproduce_it_in_open_loop);
    return UNITY_END();
}
