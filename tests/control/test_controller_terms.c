/// test_controller_terms.c: single terms of the laws against the equations: what is asked of a tip
/// by the transpose, gains of the user axis by axis, servos at the step's end.
#include "body/dynamics.h"

#include "still_controller.h"
#include "unity.h"

static himc_controller controller;
static himc_vec3 torque[HIMC_JOINTS];

void setUp(void)
{
    controller = still_controller();
}

void tearDown(void)
{
}

static double distance(himc_vec3 a, himc_vec3 b)
{
    return himc_vec3_length(himc_vec3_sub(a, b));
}

static himc_vec3 per_axis(himc_vec3 a, himc_vec3 b)
{
    return himc_vec3_make(a.x * b.x, a.y * b.y, a.z * b.z);
}

// `v` times `axes` about a joint's own axes
static himc_vec3 about_child(int joint, himc_vec3 axes, himc_vec3 v)
{
    const himc_mat3 *r = &state.rotation[joint + 1];
    return himc_mat3_apply(r, per_axis(axes, himc_mat3_apply_transposed(r, v)));
}

static const himc_mat3 *parent(int joint)
{
    return &state.rotation[skeleton.segment[joint + 1].parent];
}

static void find_torques(void)
{
    himc_controller_torques(&controller, &skeleton, &state, &reference, torque);
}

// at its place, too slow: the step of the transpose is that of the velocity's error, not of the
// place's, which is none
static void test_transpose_has_a_step_length_for_each_demand(void)
{
    himc_vec3 place = {0.01, -0.02, 0.015}, speed = {0.2, -0.1, 0.4}, without[HIMC_JOINTS];
    himc_vec3 turn[HIMC_ARM_JOINTS], faster[HIMC_ARM_JOINTS];
    himc_arm_jacobian jacobian;
    controller.config.law = HIMC_LAW_FEEDFORWARD;
    controller.config.solver = HIMC_SOLVER_TRANSPOSE;
    controller.config.posture = false;
    controller.step = 0;
    find_torques();
    memcpy(without, torque, sizeof torque);
    himc_arm_jacobian_at(&state, HIMC_LEFT, &jacobian);
    for (int away = 0; away < 2; away++) {
        himc_vec3 missing = himc_vec3_scale(place, away);
        reference.tip[HIMC_LEFT].x = himc_vec3_add(state.tip[HIMC_LEFT], missing);
        reference.tip[HIMC_LEFT].v = speed;
        find_torques();
        himc_ik_solve(&jacobian, HIMC_SOLVER_TRANSPOSE, 0, missing, turn);
        himc_ik_solve(&jacobian, HIMC_SOLVER_TRANSPOSE, 0, speed, faster);
        for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
            int j = himc_arm_joint(HIMC_LEFT, k);
            himc_vec3 want = himc_vec3_add(about_child(j, controller.gain[j].stiffness, turn[k]),
                                           about_child(j, controller.gain[j].damping, faster[k]));
            TEST_ASSERT_TRUE(himc_vec3_length(want) > 1e-3);
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0,
                                      distance(himc_vec3_sub(torque[j], without[j]), want));
        }
    }
}

// ks e + kd e' over a step h: (ks e + (kd + h ks) e') / (I + h kd + h^2 ks) for each axis
static double implicit(double ks, double kd, double inertia, double e, double rate)
{
    double h = controller.step;
    return (ks * e + (kd + h * ks) * rate) / (inertia + h * kd + h * h * ks);
}

static void test_computed_torque_uses_the_users_gains_of_each_axis(void)
{
    himc_vec3 ks = {10, 20, 40}, kd = {0.3, 0.1, 0.2}, want[HIMC_JOINTS];
    himc_vec3 e = {0.02, -0.03, 0.04}, rate = {0.5, 0.7, -0.6}; // about the child's axes
    controller.config.mode = HIMC_PIPELINE_ID;
    controller.config.law = HIMC_LAW_COMPUTED_TORQUE;
    for (int j = HIMC_LEFT_UPPER_ARM - 1; j <= HIMC_RIGHT_STICK - 1; j++) {
        himc_vec3 wanted[HIMC_JOINTS] = {{0, 0, 0}}, i = controller.inertia[j];
        const himc_mat3 *child = &state.rotation[j + 1];
        controller.gain[j] = (himc_gain){ks, kd};
        controller.config.gain_set[j] = true;
        reference.posture.joint[j] = himc_quat_mul(pose.joint[j], himc_quat_exp(e));
        reference.posture.rate[j] =
            himc_mat3_apply_transposed(parent(j), himc_mat3_apply(child, rate));
        find_torques();
        himc_vec3 alpha = {implicit(ks.x, kd.x, i.x, e.x, rate.x),
                           implicit(ks.y, kd.y, i.y, e.y, rate.y),
                           implicit(ks.z, kd.z, i.z, e.z, rate.z)};
        wanted[j] = himc_mat3_apply(child, alpha);
        himc_inverse_dynamics(&skeleton, &state, wanted, false, want);
        for (int k = 0; k < HIMC_JOINTS; k++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-9 * (1 + himc_vec3_length(want[k])), 0,
                                      distance(want[k], torque[k]));
        reference.posture.joint[j] = pose.joint[j];
        reference.posture.rate[j] = himc_vec3_make(0, 0, 0);
    }
}

// tau = g + ks (e + h e' + h^2 (q''_t - q'')) + kd (e' + h (q''_t - q'')), q'' being what tau makes
static void test_feedforward_servos_are_equation_2_at_the_end_of_the_step(void)
{
    himc_vec3 gravity[HIMC_JOINTS], got[HIMC_JOINTS];
    himc_vec3 e[HIMC_JOINTS], rate[HIMC_JOINTS], asked[HIMC_JOINTS];
    himc_articulation articulation;
    double h = 1e-3;
    controller.config.mode = HIMC_PIPELINE_ID;
    controller.config.law = HIMC_LAW_FEEDFORWARD;
    controller.step = h;
    for (int j = 0; j < HIMC_JOINTS; j++) {
        himc_posture_motion *m = &reference.posture;
        himc_vec3 turn = random_vector(0.05);
        m->joint[j] = himc_quat_mul(himc_quat_exp(turn), pose.joint[j]);
        m->rate[j] = random_vector(1);
        m->acceleration[j] = random_vector(100);
        e[j] = himc_mat3_apply(parent(j), turn);
        rate[j] = himc_mat3_apply(parent(j), m->rate[j]);
        asked[j] = himc_mat3_apply(parent(j), m->acceleration[j]);
    }
    find_torques();
    static const himc_vec3 none[HIMC_JOINTS];
    himc_articulate_resisting(&skeleton, &state, none, &articulation);
    himc_forward_dynamics(&skeleton, &state, &articulation, torque, NULL, got);
    himc_inverse_dynamics(&skeleton, &state, NULL, true, gravity);
    for (int j = 0; j < HIMC_JOINTS; j++) {
        himc_vec3 late = himc_vec3_sub(asked[j], got[j]);
        himc_vec3 angle = himc_vec3_madd(himc_vec3_madd(e[j], h, rate[j]), h * h, late);
        himc_vec3 want = about_child(j, controller.gain[j].stiffness, angle);
        himc_vec3 damping = himc_vec3_madd(rate[j], h, late);
        want = himc_vec3_add(want, about_child(j, controller.gain[j].damping, damping));
        want = himc_vec3_add(want, gravity[j]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-8 * (1 + himc_vec3_length(want)), 0,
                                  distance(want, torque[j]));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_transpose_has_a_step_length_for_each_demand);
    RUN_TEST(test_computed_torque_uses_the_users_gains_of_each_axis);
    RUN_TEST(test_feedforward_servos_are_equation_2_at_the_end_of_the_step);
    return UNITY_END();
}
