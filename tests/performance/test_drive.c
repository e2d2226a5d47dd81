/// test_drive.c: joints driven from outside: the torques of one performer move another likewise, an
/// aimed joint comes to its rotation, and without a drive the performer has its body again.
#include "session.h"
#include "himc/drive.h"
#include "himc/vec.h"

#define STEPS 600 // of 1 ms: a stroke's way up and down, its contact and what follows
#define SAMPLES 48

static himc_performance *performer(void)
{
    himc_performance_config config = himc_performance_default();
    config.physics_rate = config.task_rate = 1000; // each step is a tick
    himc_performance *p = himc_performance_new(&config, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(p, error.text);
    return p;
}

static void keep(void *user, const himc_motion_row *row)
{
    *(himc_motion_row *)user = *row;
}

// the angle between two rotations (rad)
static double between(himc_quat a, himc_quat b)
{
    return himc_vec3_length(himc_quat_log(himc_quat_mul(himc_quat_conj(a), b)));
}

// a row's torques about the children's own axes
static himc_drive torques_of(const himc_motion_row *row)
{
    himc_drive drive = {.aimed = {false}};
    for (int j = 0; j < HIMC_JOINTS; j++) {
        himc_mat3 frame = himc_mat3_from_quat(row->orientation[j + 1]);
        drive.turned[j] = true;
        drive.torque[j] = himc_mat3_apply_transposed(&frame, row->torque[j]);
    }
    return drive;
}

static void test_torques_of_one_performer_move_another_likewise(void)
{
    himc_performance *a = performer(), *b = performer();
    himc_motion_row played, driven;
    double farthest = 0, highest = 0;
    himc_performance_on_motion(a, keep, &played);
    himc_performance_on_motion(b, keep, &driven);
    TEST_ASSERT_TRUE_MESSAGE(session_try(a, "target right .4 -.1 1.1"), error.text);
    for (int i = 0; i < STEPS; i++) {
        himc_performance_process(a, SAMPLES, NULL);
        himc_drive drive = torques_of(&played);
        TEST_ASSERT_TRUE_MESSAGE(himc_performance_drive(b, &drive, &error), error.text);
        himc_performance_process(b, SAMPLES, NULL);
        himc_vec3 apart = himc_vec3_sub(played.tip[HIMC_RIGHT], driven.tip[HIMC_RIGHT]);
        farthest = fmax(farthest, himc_vec3_length(apart));
        highest = fmax(highest, played.tip[HIMC_RIGHT].z);
    }
    TEST_ASSERT_TRUE(highest > 1); // it has moved
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, farthest);
    himc_performance_free(a);
    himc_performance_free(b);
}

static void test_an_aimed_joint_comes_to_its_rotation_and_is_given_back(void)
{
    himc_performance *p = performer();
    himc_motion_row row;
    const int elbow = HIMC_RIGHT_FOREARM - 1;
    TEST_ASSERT_TRUE(session_try(p, "mode id"));
    himc_performance_on_motion(p, keep, &row);
    himc_performance_process(p, 48000, NULL);
    himc_quat before = row.rotation[elbow];
    himc_drive drive = {.aimed = {false}};
    drive.aimed[elbow] = true;
    drive.rotation[elbow] = himc_quat_mul(before, himc_quat_exp(himc_vec3_make(0, -.3, 0)));
    TEST_ASSERT_TRUE_MESSAGE(himc_performance_drive(p, &drive, &error), error.text);
    himc_performance_process(p, 48000, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0, between(row.rotation[elbow], drive.rotation[elbow]));
    drive.rate[elbow] = himc_vec3_make(0, 1, 0); // held with a rate, it stays beside it
    TEST_ASSERT_TRUE_MESSAGE(himc_performance_drive(p, &drive, &error), error.text);
    himc_performance_process(p, 48000, NULL);
    TEST_ASSERT_TRUE(between(row.rotation[elbow], drive.rotation[elbow]) > 5e-3);
    TEST_ASSERT_TRUE(himc_performance_drive(p, NULL, &error));
    himc_performance_process(p, 48000, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0, between(row.rotation[elbow], before));
    himc_performance_free(p);
}

static void test_what_no_joint_can_have_is_refused_and_changes_nothing(void)
{
    himc_performance *p = performer();
    himc_motion_row row;
    himc_performance_on_motion(p, keep, &row);
    himc_drive drive = {.turned = {true}, .torque = {{NAN, 0, 0}}};
    TEST_ASSERT_FALSE(himc_performance_drive(p, &drive, &error));
    TEST_ASSERT_EQUAL_STRING("drive: waist: expected a finite torque", error.text);
    drive = (himc_drive){.aimed = {true}, .rotation = {{2, 0, 0, 0}}};
    TEST_ASSERT_FALSE(himc_performance_drive(p, &drive, &error));
    TEST_ASSERT_EQUAL_STRING("drive: waist: a rotation of length 2, expected 1", error.text);
    himc_performance_process(p, 48000, NULL);
    TEST_ASSERT_TRUE(himc_vec3_length(row.tip_error[HIMC_RIGHT]) < 1e-4);
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_torques_of_one_performer_move_another_likewise);
    RUN_TEST(test_an_aimed_joint_comes_to_its_rotation_and_is_given_back);
    RUN_TEST(test_what_no_joint_can_have_is_refused_and_changes_nothing);
    return UNITY_END();
}
