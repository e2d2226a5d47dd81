/// test_support.c: a stool's cushion is hollow: it draws a body that sits aside back to its middle,
/// and lifts it on the way there.
#include "body/posture.h"
#include "body/support.h"

#include "unity.h"

#define HOLLOW 0.12 // its radius (m)

static himc_skeleton skeleton;
static himc_body_state rest, moved;
static himc_support support;

void setUp(void)
{
    himc_skeleton_config config = himc_skeleton_default();
    himc_posture posture;
    himc_pose pose;
    himc_vec3 tip[HIMC_HANDS] = {{0.48, 0.05, 0.8675}, {0.48, -0.05, 0.8675}};
    himc_skeleton_init(&skeleton, &config, NULL);
    himc_posture_init(&posture, &skeleton, 0.85);
    himc_posture_at(&posture, tip, &pose);
    himc_pose_to_state(&skeleton, &pose, NULL, &rest);
    himc_support_init(&support, &skeleton, &rest, false);
}
void tearDown(void)
{
}

// the seat's force (N) on the body set down so far from its rest, before it slides
static himc_vec3 seat_force(double x, double y, double z)
{
    himc_vec3 sum = {0, 0, 0};
    moved = rest;
    for (int i = 0; i < HIMC_SEGMENTS; i++)
        moved.origin[i] = himc_vec3_add(rest.origin[i], himc_vec3_make(x, y, z));
    himc_support_lift(&support);
    himc_support_press(&support, &skeleton, &moved);
    for (int i = 0; i < HIMC_SEAT_POINTS; i++)
        sum = himc_vec3_add(sum, support.point[i].force);
    return sum;
}

static void test_a_body_aside_is_drawn_back_by_the_slope_of_the_cushion(void)
{
    double aside = 0.01, height = aside * aside / (2 * HOLLOW), weight = seat_force(0, 0, 0).z;
    TEST_ASSERT_TRUE(weight > 400 && weight < 700);
    for (int k = 0; k < 4; k++) {
        double x = k < 2 ? aside * (1 - 2 * k) : 0, y = k < 2 ? 0 : aside * (5 - 2 * k);
        himc_vec3 f = seat_force(x, y, height);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6 * weight, weight, f.z); // as much as at its middle, higher
        TEST_ASSERT_DOUBLE_WITHIN(1e-6 * weight, -weight * x / HOLLOW, f.x);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6 * weight, -weight * y / HOLLOW, f.y);
        TEST_ASSERT_TRUE(seat_force(x, y, 0).z > 1.05 * weight); // who is not lifted sinks in
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_body_aside_is_drawn_back_by_the_slope_of_the_cushion);
    return UNITY_END();
}
