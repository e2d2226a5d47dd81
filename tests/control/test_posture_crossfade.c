/// test_posture_crossfade.c: joint targets from one source to another: they begin as the old ones,
/// end as the new ones, and neither place nor rate jumps on the way.
#include "bodies.h"
#include "control/posture_crossfade.h"

#include "unity.h"

#include <string.h>

#define DURATION 0.6
#define STEP 1e-4

static himc_vec3 axis[2][HIMC_JOINTS], other[2][HIMC_JOINTS];

void setUp(void)
{
    srand(7);
    for (int source = 0; source < 2; source++)
        for (int j = 0; j < HIMC_JOINTS; j++) {
            axis[source][j] = random_vector(0.5);
            other[source][j] = random_vector(0.3);
        }
}

void tearDown(void)
{
}

// a source of joint targets that swings about two axes; rates are those of the world's frame
static himc_posture_motion source_at(int source, double t)
{
    himc_posture_motion m;
    double w = 3 + source;
    for (int j = 0; j < HIMC_JOINTS; j++) {
        himc_vec3 a = axis[source][j];
        m.joint[j] = himc_quat_mul(himc_quat_exp(himc_vec3_scale(a, sin(w * t))),
                                   himc_quat_exp(other[source][j]));
        m.rate[j] = himc_vec3_scale(a, w * cos(w * t));
        m.acceleration[j] = himc_vec3_scale(a, -w * w * sin(w * t));
    }
    return m;
}

static himc_posture_motion faded(const himc_posture_crossfade *c, double t)
{
    himc_posture_motion m = source_at(1, t);
    himc_posture_crossfade_apply(c, t, &m);
    return m;
}

static himc_posture_crossfade begun_at(double t)
{
    himc_posture_crossfade c;
    himc_posture_motion before = source_at(0, t), now = source_at(1, t);
    himc_posture_crossfade_begin(&c, t, &before, &now);
    return c;
}

static void test_crossfade_begins_as_the_old_source(void)
{
    himc_posture_crossfade c = begun_at(1.5);
    himc_posture_motion want = source_at(0, 1.5), is = faded(&c, 1.5);
    for (int j = 0; j < HIMC_JOINTS; j++) {
        himc_quat d = himc_quat_mul(is.joint[j], himc_quat_conj(want.joint[j]));
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, himc_vec3_length(himc_quat_log(d)));
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, want.rate[j].x, is.rate[j].x);
        TEST_ASSERT_DOUBLE_WITHIN(1e-10, want.acceleration[j].z, is.acceleration[j].z);
    }
}

static void test_crossfade_ends_as_the_new_source_and_stays(void)
{
    himc_posture_crossfade c = begun_at(0.25);
    for (double t = 0.25 + DURATION + 1e-9; t < 2; t += 0.1) {
        himc_posture_motion want = source_at(1, t), is = faded(&c, t);
        TEST_ASSERT_EQUAL_MEMORY(&want, &is, sizeof want);
    }
}

static void test_crossfade_never_jumps(void)
{
    himc_posture_crossfade c = begun_at(0.4);
    himc_posture_motion last = faded(&c, 0.4);
    for (double t = 0.4 + STEP; t < 0.4 + DURATION + 0.01; t += STEP) {
        himc_posture_motion is = faded(&c, t);
        for (int j = 0; j < HIMC_JOINTS; j++) {
            himc_quat d = himc_quat_mul(is.joint[j], himc_quat_conj(last.joint[j]));
            himc_vec3 faster = himc_vec3_sub(is.rate[j], last.rate[j]);
            TEST_ASSERT_TRUE(himc_vec3_length(himc_quat_log(d)) < 12 * STEP);
            TEST_ASSERT_TRUE(himc_vec3_length(faster) < 120 * STEP);
        }
        last = is;
    }
}

static void test_crossfade_that_is_cancelled_changes_nothing(void)
{
    himc_posture_crossfade c = begun_at(0);
    himc_posture_crossfade_cancel(&c);
    himc_posture_motion want = source_at(1, 0.1), is = faded(&c, 0.1);
    TEST_ASSERT_EQUAL_MEMORY(&want, &is, sizeof want);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_crossfade_begins_as_the_old_source);
    RUN_TEST(test_crossfade_ends_as_the_new_source_and_stays);
    RUN_TEST(test_crossfade_never_jumps);
    RUN_TEST(test_crossfade_that_is_cancelled_changes_nothing);
    return UNITY_END();
}
