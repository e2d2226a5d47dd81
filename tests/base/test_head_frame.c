/// test_head_frame.c: struck surfaces: their frames, outlines and strike points.
#include "unity.h"

#include "himc/command.h"
#include "base/head_frame.h"
#include "body/capsules.h"

#include <stdlib.h>

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_positive_tilt_lifts_the_far_side(void)
{
    himc_head_frame place = {.center = {0.7, 0.1, 0.85}, .tilt = 0.2, .radius = 0.3};
    TEST_ASSERT_TRUE(himc_head_frame_to_world(&place, 0.2, 0).z > 0.85);
    TEST_ASSERT_TRUE(himc_head_frame_to_world(&place, -0.2, 0).z < 0.85);
}

static void test_normal_is_square_to_the_head(void)
{
    himc_head_frame place = {.center = {0.7, 0.1, 0.85}, .tilt = 0.3, .radius = 0.3};
    himc_vec3 n = himc_head_frame_normal(&place);
    himc_vec3 x = himc_vec3_sub(himc_head_frame_to_world(&place, 1, 0), place.center);
    himc_vec3 y = himc_vec3_sub(himc_head_frame_to_world(&place, 0, 1), place.center);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0, himc_vec3_dot(n, x));
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0, himc_vec3_dot(n, y));
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 1, himc_vec3_dot(n, himc_vec3_cross(x, y)));
}

static void test_from_world_undoes_to_world(void)
{
    himc_head_frame place = {.center = {0.7, -0.4, 0.9}, .tilt = -0.25, .radius = 0.3};
    himc_vec3 w = himc_vec3_madd(himc_head_frame_to_world(&place, 0.11, -0.07), 0.05,
                                 himc_head_frame_normal(&place));
    himc_vec3 p = himc_head_frame_from_world(&place, w);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, 0.11, p.x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, -0.07, p.y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, 0.05, p.z);
}

static void test_spots_lie_towards_the_player_each_hand_on_its_side(void)
{
    himc_stroke s = {.hand = HIMC_LEFT, .spot = HIMC_SPOT_NORMAL};
    double x, y;
    himc_stroke_spot(&s, 0.3, &x, &y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, -0.225, x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.015, y);
    s.hand = HIMC_RIGHT, s.spot = HIMC_SPOT_RIM;
    himc_stroke_spot(&s, 0.3, &x, &y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, -0.276, x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, -0.015, y);
    s.spot = HIMC_SPOT_CENTER;
    himc_stroke_spot(&s, 0.3, &x, &y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0, x);
    s.spot = HIMC_SPOT_XY, s.x = 0.1, s.y = 0.2;
    himc_stroke_spot(&s, 0.3, &x, &y);
    TEST_ASSERT_EQUAL_DOUBLE(0.1, x);
    TEST_ASSERT_EQUAL_DOUBLE(0.2, y);
}

// at random points: moved by its distance along its way a point is on the edge, and from inside to
// outside all functions change together
static void check_outline(const himc_head_frame *place)
{
    himc_head_axes axes = himc_head_axes_of(place);
    srand(1);
    for (int i = 0; i < 2000; i++) {
        double x = 0.001 * (rand() % 1001 - 500.5), y = 0.001 * (rand() % 1001 - 500.5);
        himc_vec3 way, from = himc_vec3_madd(himc_vec3_scale(axes.x, x), y, axes.y);
        double apart = himc_head_frame_beside(place, from, &way);
        bool inside = himc_head_frame_contains(place, x, y);
        TEST_ASSERT_EQUAL(inside, apart < 0);
        TEST_ASSERT_EQUAL(inside, himc_head_frame_out(place, x, y) < 1);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1, himc_vec3_length(way));
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, himc_vec3_dot(way, axes.normal));
        himc_vec3 edge = himc_vec3_madd(from, -apart, way);
        TEST_ASSERT_DOUBLE_WITHIN(
            1e-9, 1,
            himc_head_frame_out(place, himc_vec3_dot(edge, axes.x), himc_vec3_dot(edge, axes.y)));
        bool moves = himc_head_frame_out(place, x, y) > 0.9;
        TEST_ASSERT_EQUAL(moves, himc_head_frame_keep_inside(place, 0.9, &x, &y));
        TEST_ASSERT_TRUE(himc_head_frame_out(place, x, y) < 0.9 + 1e-12);
        TEST_ASSERT_TRUE(fabs(y) < himc_head_frame_half_width(place, 0.9, x) + 1e-9);
    }
}

static void test_an_outline_is_one_to_all_that_ask(void)
{
    himc_head_frame place = {.center = {0.7, -0.4, 0.9}, .tilt = -0.25, .radius = 0.3};
    check_outline(&place);
    place.length = 0.2, place.width = 0.5;
    check_outline(&place);
}

// a stick beside the long side of a rectangle, far inside the circle around it
static void test_a_capsule_is_as_near_as_the_outline(void)
{
    himc_head_frame place = {.center = {0.8, 0, 0.9}, .radius = 0.26, .length = 0.1, .width = 0.5};
    himc_capsule stick = {.a = {0.9, -0.1, 0.8}, .b = {0.9, 0.1, 0.8}, .radius = 0.01};
    himc_capsule_near near = himc_capsule_shell(&stick, &place);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.1 - 0.05 - 0.01, near.gap);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1, near.n.x);
    place.length = place.width = 0;
    TEST_ASSERT_TRUE(himc_capsule_shell(&stick, &place).gap < 0);
}

static void test_a_kind_has_spots_of_its_own(void)
{
    const double spots[] = {0, 0.1, 0.5};
    himc_head_frame place = {.radius = 0.2, .spots = spots};
    himc_stroke s = {.hand = HIMC_LEFT, .spot = HIMC_SPOT_RIM};
    double x, y;
    himc_head_frame_spot(&place, &s, &x, &y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, -0.1, x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.015, y);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_positive_tilt_lifts_the_far_side);
    RUN_TEST(test_normal_is_square_to_the_head);
    RUN_TEST(test_from_world_undoes_to_world);
    RUN_TEST(test_spots_lie_towards_the_player_each_hand_on_its_side);
    RUN_TEST(test_an_outline_is_one_to_all_that_ask);
    RUN_TEST(test_a_capsule_is_as_near_as_the_outline);
    RUN_TEST(test_a_kind_has_spots_of_its_own);
    return UNITY_END();
}
