/// test_ik.c: the Jacobian against differences, the solvers against a dense 3 x 12 reference, the
/// null space, the elbow task, the release of the contact normal.
#include "control/ik.h"

#include "bodies.h"
#include "unity.h"

#include <stdlib.h>
#include <string.h>

#define COLUMNS (3 * HIMC_ARM_JOINTS)
#define POSES 1000

void setUp(void)
{
    default_skeleton(4);
}

void tearDown(void)
{
}

static double distance(himc_vec3 a, himc_vec3 b)
{
    return himc_vec3_length(himc_vec3_sub(a, b));
}

// turns a joint of an arm, and all beyond it, by a small rotation in the world
static void turn(himc_body_state *s, himc_hand hand, int k, himc_vec3 rotation)
{
    himc_quat q = himc_quat_exp(rotation);
    for (; k < HIMC_ARM_JOINTS; k++) {
        int i = himc_arm_joint(hand, k) + 1;
        s->orientation[i] = himc_quat_mul(q, s->orientation[i]);
    }
    himc_body_state_complete(&skeleton, s);
}

static void test_jacobian_is_the_difference_of_the_tip(void)
{
    double h = 1e-6;
    for (int n = 0; n < 100; n++) {
        himc_body_state s;
        random_state(&s, 0);
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            for (int c = 0; c < COLUMNS; c++) {
                himc_arm_jacobian j;
                himc_arm_jacobian_at(&s, (himc_hand)hand, &j);
                himc_vec3 axis = himc_vec3_make(c % 3 == 0, c % 3 == 1, c % 3 == 2);
                himc_vec3 one[HIMC_ARM_JOINTS] = {{0, 0, 0}};
                one[c / 3] = axis;
                himc_body_state after = s, before = s;
                turn(&after, (himc_hand)hand, c / 3, himc_vec3_scale(axis, h));
                turn(&before, (himc_hand)hand, c / 3, himc_vec3_scale(axis, -h));
                himc_vec3 v = himc_vec3_sub(after.tip[hand], before.tip[hand]);
                v = himc_vec3_scale(v, 0.5 / h);
                TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, distance(v, himc_ik_forward(&j, one)));
            }
    }
}

// the dense Jacobian, column by column from unit rotations
static void dense(const himc_arm_jacobian *j, double a[3][COLUMNS])
{
    for (int c = 0; c < COLUMNS; c++) {
        himc_vec3 one[HIMC_ARM_JOINTS] = {{0, 0, 0}};
        one[c / 3] = himc_vec3_make(c % 3 == 0, c % 3 == 1, c % 3 == 2);
        himc_vec3 column = himc_ik_forward(j, one);
        a[0][c] = column.x, a[1][c] = column.y, a[2][c] = column.z;
    }
}

// (J'J + lambda^2 W^-1) x = J'e by Gauss elimination with pivots: the 12 x 12 form, where the
// module uses the 3 x 3 form
static void dense_damped(double a[3][COLUMNS], const double weight[HIMC_ARM_JOINTS], double lambda,
                         const double e[3], double x[COLUMNS])
{
    double m[COLUMNS][COLUMNS + 1];
    for (int r = 0; r < COLUMNS; r++) {
        for (int c = 0; c < COLUMNS; c++)
            m[r][c] = a[0][r] * a[0][c] + a[1][r] * a[1][c] + a[2][r] * a[2][c] +
                      (r == c) * lambda * lambda / weight[r / 3];
        m[r][COLUMNS] = a[0][r] * e[0] + a[1][r] * e[1] + a[2][r] * e[2];
    }
    for (int p = 0; p < COLUMNS; p++) {
        int best = p;
        for (int r = p; r < COLUMNS; r++)
            best = fabs(m[r][p]) > fabs(m[best][p]) ? r : best;
        for (int c = 0; c <= COLUMNS; c++) {
            double keep = m[p][c];
            m[p][c] = m[best][c], m[best][c] = keep;
        }
        for (int r = 0; r < COLUMNS; r++)
            for (int c = COLUMNS; r != p && c >= p; c--)
                m[r][c] -= m[r][p] / m[p][p] * m[p][c];
    }
    for (int r = 0; r < COLUMNS; r++)
        x[r] = m[r][COLUMNS] / m[r][r];
}

static double component(himc_vec3 v, int i)
{
    return i == 0 ? v.x : i == 1 ? v.y : v.z;
}

static void test_gram_is_j_times_j_transposed(void)
{
    for (int n = 0; n < POSES; n++) {
        himc_body_state s;
        himc_arm_jacobian j;
        double a[3][COLUMNS];
        random_state(&s, 0);
        himc_arm_jacobian_at(&s, (himc_hand)(n % 2), &j);
        dense(&j, a);
        for (int k = 0; k < 9; k++) {
            double sum = 0;
            for (int c = 0; c < COLUMNS; c++)
                sum += a[k / 3][c] * a[k % 3][c];
            TEST_ASSERT_DOUBLE_WITHIN(1e-14, sum, j.gram.m[k / 3][k % 3]);
        }
    }
}

static void test_damped_least_squares_is_the_dense_solution(void)
{
    static const double damping[] = {0.01, 0.1, 0.5};
    static const double weights[][HIMC_ARM_JOINTS] = {{1, 1, 1, 1}, {0.2, 0.5, 1, 3}};
    for (int n = 0; n < POSES; n++) {
        const double *weight = weights[n % 2];
        himc_body_state s;
        himc_arm_jacobian j;
        himc_vec3 e = random_vector(0.05), got[HIMC_ARM_JOINTS];
        double a[3][COLUMNS], x[COLUMNS], error[3] = {e.x, e.y, e.z}, lambda = damping[n % 3];
        random_state(&s, 0);
        himc_arm_jacobian_weighted(&s, (himc_hand)(n / 2 % 2), weight, &j);
        dense(&j, a);
        dense_damped(a, weight, lambda, error, x);
        himc_ik_solve(&j, HIMC_SOLVER_DLS, lambda, e, got);
        for (int c = 0; c < COLUMNS;
             c++) // 1e-6: the module's floor of 1e-12 m^2 under lambda^2 = 1e-4
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, x[c], component(got[c / 3], c % 3));
    }
}

static void test_pseudo_inverse_reaches_the_tip_with_the_least_rotation(void)
{
    for (int n = 0; n < POSES; n++) {
        himc_body_state s;
        himc_arm_jacobian j;
        himc_vec3 e = random_vector(0.05), got[HIMC_ARM_JOINTS], other[HIMC_ARM_JOINTS];
        random_state(&s, 0);
        himc_arm_jacobian_at(&s, (himc_hand)(n % 2), &j);
        himc_ik_solve(&j, HIMC_SOLVER_PINV, 0, e, got);
        TEST_ASSERT_DOUBLE_WITHIN(1e-13, 0, distance(e, himc_ik_forward(&j, got)));
        // least: perpendicular to everything that leaves the tip where it is
        for (int k = 0; k < HIMC_ARM_JOINTS; k++)
            other[k] = random_vector(1);
        himc_vec3 null[HIMC_ARM_JOINTS] = {{0, 0, 0}};
        himc_ik_add_null(&j, other, null);
        double dot = 0;
        for (int k = 0; k < HIMC_ARM_JOINTS; k++)
            dot += himc_vec3_dot(got[k], null[k]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0, dot);
    }
}

// all levers along z except for `bend`: nothing moves along z, and `bend` sets a small singular
// value
static void straight(himc_arm_jacobian *j, double bend)
{
    himc_body_state s;
    himc_pose pose = himc_pose_zero();
    himc_pose_to_state(&skeleton, &pose, NULL, &s);
    turn(&s, HIMC_RIGHT, 1, himc_vec3_make(0, bend, 0));
    himc_arm_jacobian_at(&s, HIMC_RIGHT, j);
}

static void test_pseudo_inverse_leaves_out_the_direction_of_a_straight_arm(void)
{
    static const double bend[] = {0, 1e-8, 1e-3, 0.03};
    himc_arm_jacobian j;
    himc_vec3 got[HIMC_ARM_JOINTS], along = {0, 0, 0.05}, across = {0.05, 0, 0};
    for (int i = 0; i < 4; i++) {
        straight(&j, bend[i]);
        himc_ik_solve(&j, HIMC_SOLVER_PINV, 0, along, got);
        for (int k = 0; k < HIMC_ARM_JOINTS; k++)
            TEST_ASSERT_TRUE(himc_vec3_length(got[k]) < 0.01);
        himc_ik_solve(&j, HIMC_SOLVER_PINV, 0, across, got);
        TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.05, himc_ik_forward(&j, got).x);
    }
    straight(&j, 0.5);
    himc_ik_solve(&j, HIMC_SOLVER_PINV, 0, along, got);
    TEST_ASSERT_DOUBLE_WITHIN(1e-13, 0, distance(along, himc_ik_forward(&j, got)));
}

static void test_every_solver_stays_bounded_at_a_straight_arm(void)
{
    static const double bend[] = {0, 1e-12, 1e-9, 1e-6, 1e-4, 1e-2};
    for (int i = 0; i < 6; i++)
        for (int solver = HIMC_SOLVER_DLS; solver < HIMC_SOLVERS; solver++) {
            himc_arm_jacobian j;
            himc_vec3 got[HIMC_ARM_JOINTS];
            straight(&j, bend[i]);
            himc_ik_solve(&j, (himc_solver)solver, 0.01, himc_vec3_make(0.01, 0.02, 0.04), got);
            for (int k = 0; k < HIMC_ARM_JOINTS; k++)
                TEST_ASSERT_TRUE(himc_vec3_length(got[k]) < 0.05 / (2 * 0.01));
        }
}

static void test_transpose_step_is_the_best_along_its_direction(void)
{
    for (int n = 0; n < 100; n++) {
        himc_body_state s;
        himc_arm_jacobian j;
        himc_vec3 e = random_vector(0.05), got[HIMC_ARM_JOINTS];
        random_state(&s, 0);
        himc_arm_jacobian_at(&s, HIMC_LEFT, &j);
        himc_ik_solve(&j, HIMC_SOLVER_TRANSPOSE, 0, e, got);
        himc_vec3 moved = himc_ik_forward(&j, got), left = himc_vec3_sub(e, moved);
        TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0, himc_vec3_dot(moved, left));
        TEST_ASSERT_TRUE(himc_vec3_length(left) < himc_vec3_length(e));
    }
    himc_arm_jacobian j;
    himc_vec3 got[HIMC_ARM_JOINTS];
    straight(&j, 0);
    himc_ik_solve(&j, HIMC_SOLVER_TRANSPOSE, 0, himc_vec3_make(0, 0, 0.05), got);
    TEST_ASSERT_EQUAL_DOUBLE(0, himc_vec3_length(got[0]));
}

static void test_nakamura_damps_near_singular_postures_alone(void)
{
    himc_arm_jacobian j;
    himc_vec3 got[HIMC_ARM_JOINTS], e = {0.01, 0.02, 0.04};
    straight(&j, 1.2);
    himc_ik_solve(&j, HIMC_SOLVER_NAKAMURA, 0.1, e, got);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, distance(e, himc_ik_forward(&j, got)));
    straight(&j, 0);
    himc_vec3 damped[HIMC_ARM_JOINTS];
    himc_ik_solve(&j, HIMC_SOLVER_NAKAMURA, 0.1, e, got);
    himc_ik_solve(&j, HIMC_SOLVER_DLS, 0.1, e, damped);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) // at a manipulability of 0, the whole damping
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, distance(got[k], damped[k]));
}

static void test_selective_damping_is_the_pseudo_inverse_for_small_errors_only(void)
{
    for (int n = 0; n < POSES; n++) {
        himc_body_state s;
        himc_arm_jacobian j;
        himc_vec3 got[HIMC_ARM_JOINTS], small = random_vector(1e-4), large = random_vector(3);
        random_state(&s, 0);
        himc_arm_jacobian_at(&s, (himc_hand)(n % 2), &j);
        himc_ik_solve(&j, HIMC_SOLVER_SDLS, 0, small, got);
        TEST_ASSERT_DOUBLE_WITHIN(1e-10, 0, distance(small, himc_ik_forward(&j, got)));
        himc_ik_solve(&j, HIMC_SOLVER_SDLS, 0, large, got);
        for (int k = 0; k < HIMC_ARM_JOINTS; k++)
            for (int c = 0; c < 3; c++)
                TEST_ASSERT_TRUE(fabs(component(got[k], c)) < 0.25 * HIMC_PI + 1e-3);
        himc_vec3 left = himc_vec3_sub(large, himc_ik_forward(&j, got));
        TEST_ASSERT_TRUE(himc_vec3_length(left) < himc_vec3_length(large));
    }
}

// priorities: the tip gets its displacement exactly, the elbow its own in the tip's null space, and
// the rest of the posture changes neither
static void test_elbow_comes_after_the_tip_and_before_the_posture(void)
{
    for (int n = 0; n < POSES; n++) {
        himc_body_state s;
        himc_arm_jacobian j;
        himc_elbow_task task;
        himc_hand hand = (himc_hand)(n % 2);
        himc_vec3 x[HIMC_ARM_JOINTS], posture[HIMC_ARM_JOINTS], e = random_vector(0.05);
        random_state(&s, 0);
        int shoulder = himc_arm_joint(hand, 0) + 1, elbow = himc_arm_joint(hand, 1) + 1;
        himc_vec3 lever = himc_vec3_sub(s.origin[elbow], s.origin[shoulder]);
        himc_vec3 demand = himc_vec3_cross(random_vector(0.05), lever);
        himc_arm_jacobian_at(&s, hand, &j);
        himc_elbow_task_init(&task, &j, lever, 1e-4);
        for (int k = 0; k < HIMC_ARM_JOINTS; k++)
            posture[k] = random_vector(0.1);
        himc_ik_solve(&j, HIMC_SOLVER_PINV, 0, e, x);
        himc_ik_add_null(&j, posture, x);
        himc_ik_add_elbow(&j, &task, demand, x);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, distance(e, himc_ik_forward(&j, x)));
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0, distance(demand, himc_vec3_cross(x[0], lever)));
    }
}

// N J# = 0: the result of a pseudo-inverse has no part in the null space, and the null space does
// not move the tip
static void test_null_space_leaves_the_tip_alone_and_projects_once(void)
{
    static const double weights[][HIMC_ARM_JOINTS] = {{1, 1, 1, 1}, {0.2, 0.5, 1, 3}};
    for (int n = 0; n < POSES; n++) {
        himc_body_state s;
        himc_arm_jacobian j;
        himc_vec3 desired[HIMC_ARM_JOINTS], got[HIMC_ARM_JOINTS] = {{0, 0, 0}};
        himc_vec3 twice[HIMC_ARM_JOINTS] = {{0, 0, 0}}, reach[HIMC_ARM_JOINTS];
        himc_vec3 none[HIMC_ARM_JOINTS] = {{0, 0, 0}};
        for (int k = 0; k < HIMC_ARM_JOINTS; k++)
            desired[k] = random_vector(1);
        random_state(&s, 0);
        himc_arm_jacobian_weighted(&s, (himc_hand)(n % 2), weights[n % 3 == 0], &j);
        himc_ik_add_null(&j, desired, got);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, himc_vec3_length(himc_ik_forward(&j, got)));
        himc_ik_add_null(&j, got, twice);
        himc_ik_solve(&j, HIMC_SOLVER_PINV, 0, random_vector(1), reach);
        himc_ik_add_null(&j, reach, none);
        for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, distance(got[k], twice[k]));
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, himc_vec3_length(none[k]));
        }
    }
}

static void test_release_keeps_the_allowed_remainder_and_the_tangential_motion(void)
{
    for (int n = 0; n < POSES; n++) {
        himc_body_state s;
        himc_arm_jacobian j;
        himc_vec3 x[HIMC_ARM_JOINTS], normal = himc_vec3_unit(random_vector(1));
        double remain = n % 3 ? random_vector(1).x : 0;
        for (int k = 0; k < HIMC_ARM_JOINTS; k++)
            x[k] = random_vector(1);
        random_state(&s, 0);
        himc_arm_jacobian_at(&s, (himc_hand)(n % 2), &j);
        himc_vec3 want = himc_ik_forward(&j, x);
        want = himc_vec3_madd(want, remain - himc_vec3_dot(normal, want), normal);
        himc_ik_release(&j, normal, remain, x);
        himc_vec3 moved = himc_ik_forward(&j, x);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, remain, himc_vec3_dot(normal, moved));
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0, distance(want, moved));
    }
}

static void test_release_along_a_straight_arm_stays_bounded(void)
{
    static const double bend[] = {0, 1e-12, 1e-9, 1e-6, 1e-5, 1e-4};
    for (int i = 0; i < 6; i++) {
        himc_arm_jacobian j;
        himc_vec3 x[HIMC_ARM_JOINTS] = {{0, 1, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
        straight(&j, bend[i]);
        himc_ik_release(&j, himc_vec3_make(0, 0, 1), 0.01, x);
        for (int k = 0; k < HIMC_ARM_JOINTS; k++) // 0.01 m over the floor of 3e-5 m, and a reserve
            TEST_ASSERT_TRUE(himc_vec3_length(x[k]) < 1000);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_jacobian_is_the_difference_of_the_tip);
    RUN_TEST(test_gram_is_j_times_j_transposed);
    RUN_TEST(test_damped_least_squares_is_the_dense_solution);
    RUN_TEST(test_pseudo_inverse_reaches_the_tip_with_the_least_rotation);
    RUN_TEST(test_pseudo_inverse_leaves_out_the_direction_of_a_straight_arm);
    RUN_TEST(test_every_solver_stays_bounded_at_a_straight_arm);
    RUN_TEST(test_transpose_step_is_the_best_along_its_direction);
    RUN_TEST(test_nakamura_damps_near_singular_postures_alone);
    RUN_TEST(test_selective_damping_is_the_pseudo_inverse_for_small_errors_only);
    RUN_TEST(test_elbow_comes_after_the_tip_and_before_the_posture);
    RUN_TEST(test_null_space_leaves_the_tip_alone_and_projects_once);
    RUN_TEST(test_release_keeps_the_allowed_remainder_and_the_tangential_motion);
    RUN_TEST(test_release_along_a_straight_arm_stays_bounded);
    return UNITY_END();
}
