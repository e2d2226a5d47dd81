/// test_limits.c: the mean rotation, the bounds learned from motion of known distribution, and the
/// nearest point of an ellipsoid.
#include "body/limits.h"

#include "bodies.h"
#include "unity.h"

#include <string.h>

#define FRAMES 4000
#define ELBOW (HIMC_LEFT_FOREARM - 1)

static himc_pose motion[FRAMES];
static himc_limits limits;
static himc_error error;

void setUp(void)
{
    default_skeleton(11);
    error.text[0] = 0;
}

void tearDown(void)
{
}

static double uniform(double low, double high)
{
    return low + (high - low) * rand() / RAND_MAX;
}

// nearly normal: the sum of twelve uniform numbers
static double normal(void)
{
    double sum = -6;
    for (int i = 0; i < 12; i++)
        sum += uniform(0, 1);
    return sum;
}

static himc_quat random_rotation(void)
{
    return himc_quat_unit((himc_quat){normal(), normal(), normal(), normal()});
}

// the angle between two rotations (rad)
static double between(himc_quat a, himc_quat b)
{
    return himc_vec3_length(himc_quat_log(himc_quat_mul(himc_quat_conj(a), b)));
}

// random rotations of all joints around their means, with the standard deviations `sigma` along
// axes of their own (rad) and random signs
static void spread_motion(const himc_pose *mean, const himc_pose *axes, himc_vec3 sigma)
{
    for (int f = 0; f < FRAMES; f++)
        for (int j = 0; j < HIMC_JOINTS; j++) {
            himc_vec3 t = {sigma.x * normal(), sigma.y * normal(), sigma.z * normal()};
            himc_quat q = himc_quat_exp(himc_quat_rotate(axes->joint[j], t));
            q = himc_quat_mul(mean->joint[j], q);
            motion[f].joint[j] = rand() % 2 ? himc_quat_scale(q, -1) : q;
        }
}

static himc_pose random_pose(void)
{
    himc_pose pose;
    for (int j = 0; j < HIMC_JOINTS; j++)
        pose.joint[j] = random_rotation();
    return pose;
}

static void learn(double margin)
{
    bool learned = himc_limits_learn(&limits, motion, FRAMES, margin, &error);
    TEST_ASSERT_TRUE_MESSAGE(learned, error.text);
}

static void test_mean_of_rotations_does_not_depend_on_signs(void)
{
    himc_pose mean = random_pose(), axes = random_pose();
    spread_motion(&mean, &axes, himc_vec3_make(0.35, 0.16, 0.04));
    himc_pose found = himc_limits_mean(motion, FRAMES);
    for (int j = 0; j < HIMC_JOINTS; j++)
        TEST_ASSERT_TRUE(between(found.joint[j], mean.joint[j]) < 0.02);
}

static void test_mean_of_one_rotation_is_that_rotation_and_of_two_the_middle(void)
{
    motion[0] = random_pose();
    for (int j = 0; j < HIMC_JOINTS; j++)
        motion[1].joint[j] =
            himc_quat_mul(motion[0].joint[j], himc_quat_exp(himc_vec3_make(0.8, 0, 0)));
    himc_pose one = himc_limits_mean(motion, 1), two = himc_limits_mean(motion, 2);
    for (int j = 0; j < HIMC_JOINTS; j++) {
        himc_quat half = himc_quat_exp(himc_vec3_make(0.4, 0, 0));
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0, between(one.joint[j], motion[0].joint[j]));
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0,
                                  between(two.joint[j], himc_quat_mul(motion[0].joint[j], half)));
    }
}

static void test_learned_axes_and_radii_are_those_of_the_distribution(void)
{
    himc_pose mean = random_pose(), axes = random_pose();
    spread_motion(&mean, &axes, himc_vec3_make(0.35, 0.16, 0.04));
    learn(0);
    for (int j = 0; j < HIMC_JOINTS; j++) {
        const himc_limit *l = &limits.joint[j];
        himc_mat3 truth = himc_mat3_from_quat(axes.joint[j]);
        double along = 0;
        for (int i = 0; i < 3; i++)
            along += l->axes.m[i][0] * truth.m[i][0];
        TEST_ASSERT_TRUE(l->bound);
        TEST_ASSERT_DOUBLE_WITHIN(0.002, 1, fabs(along));
        // each sigma of 4000 samples is known to 1.1 %
        TEST_ASSERT_DOUBLE_WITHIN(0.15, 0.35 / 0.16, l->radius.x / l->radius.y);
        TEST_ASSERT_DOUBLE_WITHIN(0.27, 0.16 / 0.04, l->radius.y / l->radius.z);
        // of 4000 normal samples the farthest is between three and six sigmas away
        TEST_ASSERT_TRUE(l->radius.x > 3 * 0.35 && l->radius.x < 6 * 0.35);
    }
}

static void test_learned_bounds_contain_the_motion_and_touch_it(void)
{
    himc_pose mean = random_pose(), axes = random_pose();
    spread_motion(&mean, &axes, himc_vec3_make(0.2, 0.1, 0.02));
    learn(0);
    for (int kind = HIMC_LIMITS_ELLIPSOID; kind <= HIMC_LIMITS_EULER; kind++)
        for (int j = 0; j < HIMC_JOINTS; j++) {
            double farthest = 0;
            limits.kind = (himc_limits_kind)kind;
            for (int f = 0; f < FRAMES; f++)
                farthest = fmax(farthest, himc_limit_measure(&limits, j, motion[f].joint[j]));
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1, farthest);
        }
}

static void test_margin_widens_ellipsoid_and_box_by_its_share(void)
{
    himc_pose mean = random_pose(), axes = random_pose();
    spread_motion(&mean, &axes, himc_vec3_make(0.2, 0.1, 0.02));
    learn(0);
    himc_limits tight = limits;
    learn(0.25);
    for (int j = 0; j < HIMC_JOINTS; j++) {
        const himc_limit *a = &tight.joint[j], *b = &limits.joint[j];
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.25 * a->radius.x, b->radius.x);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.25 * (a->upper.y - a->lower.y), b->upper.y - b->lower.y);
    }
}

static void test_loosened_bounds_have_the_least_width_and_wider_ones_stay(void)
{
    learn(0);
    himc_limits before = limits;
    himc_limits_loosen(&limits, 0.05);
    for (int j = 0; j < HIMC_JOINTS; j++) {
        const himc_limit *l = &limits.joint[j], *b = &before.joint[j];
        TEST_ASSERT_EQUAL_DOUBLE(fmax(b->radius.x, 0.05), l->radius.x);
        TEST_ASSERT_EQUAL_DOUBLE(fmax(b->radius.y, 0.05), l->radius.y);
        TEST_ASSERT_EQUAL_DOUBLE(fmax(b->radius.z, 0.05), l->radius.z);
        TEST_ASSERT_EQUAL_DOUBLE(fmin(b->lower.x, -0.05), l->lower.x);
        TEST_ASSERT_EQUAL_DOUBLE(fmin(b->lower.z, -0.05), l->lower.z);
        TEST_ASSERT_EQUAL_DOUBLE(fmax(b->upper.y, 0.05), l->upper.y);
        TEST_ASSERT_EQUAL_DOUBLE(fmax(b->upper.z, 0.05), l->upper.z);
    }
}

static void test_joint_that_did_not_move_turns_freely_and_frames_may_be_one(void)
{
    for (int f = 0; f < FRAMES; f++)
        motion[f] = himc_pose_zero();
    for (int f = 0; f < FRAMES; f++)
        motion[f].joint[ELBOW] = himc_quat_exp(himc_vec3_make(0, 0.5 * sin(0.01 * f), 0));
    learn(0);
    for (int j = 0; j < HIMC_JOINTS; j++)
        TEST_ASSERT_EQUAL(j == ELBOW, limits.joint[j].bound);
    TEST_ASSERT_EQUAL_DOUBLE(0, himc_limit_measure(&limits, 0, random_rotation()));
    TEST_ASSERT_TRUE(himc_limits_learn(&limits, motion, 1, 0, &error));
}

static void test_learning_refuses_no_frames_margins_out_of_range_and_non_rotations(void)
{
    himc_limits before;
    memset(&limits, 7, sizeof limits);
    before = limits;
    TEST_ASSERT_FALSE(himc_limits_learn(&limits, motion, 0, 0, &error));
    TEST_ASSERT_EQUAL_STRING("limits: 0 frames, expected at least 1", error.text);
    TEST_ASSERT_FALSE(himc_limits_learn(&limits, motion, 2, 1.5, &error));
    TEST_ASSERT_NOT_NULL(strstr(error.text, "margin"));
    motion[0] = motion[1] = himc_pose_zero();
    motion[1].joint[ELBOW].w = NAN;
    TEST_ASSERT_FALSE(himc_limits_learn(&limits, motion, 2, 0, &error));
    TEST_ASSERT_NOT_NULL(strstr(error.text, "frame 2: left-elbow"));
    TEST_ASSERT_EQUAL_MEMORY(&before, &limits, sizeof limits);
}

// points at random outside random ellipsoids, some of them on a plane of symmetry
static himc_vec3 random_case(himc_vec3 *radius)
{
    *radius = himc_vec3_make(exp(uniform(-6.9, 1)), exp(uniform(-6.9, 1)), exp(uniform(-6.9, 1)));
    for (;;) {
        himc_vec3 x = {normal(), normal(), normal()};
        if (rand() % 4 == 0)
            x.y = 0;
        if (rand() % 8 == 0)
            x.z = 0;
        himc_vec3 z = {x.x / radius->x, x.y / radius->y, x.z / radius->z};
        if (himc_vec3_length(z) > 1)
            return x;
    }
}

static void test_closest_point_of_3000_ellipsoids_is_on_them_with_the_way_along_the_normal(void)
{
    for (int i = 0; i < 3000; i++) {
        himc_vec3 r, x = random_case(&r), y = himc_limit_closest_on_ellipsoid(r, x);
        himc_vec3 z = {y.x / r.x, y.y / r.y, y.z / r.z};
        himc_vec3 outward = himc_vec3_unit(himc_vec3_make(z.x / r.x, z.y / r.y, z.z / r.z));
        himc_vec3 way = himc_vec3_unit(himc_vec3_sub(x, y));
        TEST_ASSERT_DOUBLE_WITHIN(1e-10, 1, himc_vec3_length(z));
        if (himc_vec3_length(himc_vec3_sub(x, y)) > 1e-4)
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, himc_vec3_length(himc_vec3_cross(way, outward)));
    }
}

// y_k = r_k^2 x_k / (t + r_k^2) with the root t by bisection, in long double
static himc_vec3 bisected(himc_vec3 radius, himc_vec3 x)
{
    const long double r[3] = {(long double)radius.x * radius.x, (long double)radius.y * radius.y,
                              (long double)radius.z * radius.z};
    const double p[3] = {x.x, x.y, x.z}, a[3] = {radius.x, radius.y, radius.z};
    long double low = 0, high = 0, t = 0;
    for (int k = 0; k < 3; k++)
        high += fabs(p[k]) * a[k]; // every z_k is at most its share of 1 there
    for (int i = 0; i < 200; i++) {
        long double sum = 0;
        t = 0.5L * (low + high);
        for (int k = 0; k < 3; k++)
            sum += (a[k] * p[k] / (t + r[k])) * (a[k] * p[k] / (t + r[k]));
        *(sum > 1 ? &low : &high) = t;
    }
    return himc_vec3_make((double)(r[0] * p[0] / (t + r[0])), (double)(r[1] * p[1] / (t + r[1])),
                          (double)(r[2] * p[2] / (t + r[2])));
}

static void test_closest_point_is_that_of_a_bisection(void)
{
    for (int i = 0; i < 20000; i++) {
        himc_vec3 r, x = random_case(&r);
        if (i % 2) { // a hair outside
            himc_vec3 z = {x.x / r.x, x.y / r.y, x.z / r.z};
            x = himc_vec3_scale(x, (1 + exp(uniform(-30, 0))) / himc_vec3_length(z));
        } else if (i % 10 == 0) { // far outside
            x = himc_vec3_scale(x, exp(uniform(0, 10)));
        }
        himc_vec3 y = himc_limit_closest_on_ellipsoid(r, x), want = bisected(r, x);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, himc_vec3_length(himc_vec3_sub(y, want)));
    }
}

static void test_brute_force_finds_no_point_of_the_ellipsoid_nearer(void)
{
    for (int i = 0; i < 3000; i++) {
        himc_vec3 r, x = random_case(&r), y = himc_limit_closest_on_ellipsoid(r, x);
        double best = himc_vec3_length(himc_vec3_sub(x, y));
        for (int k = 0; k < 300; k++) {
            himc_vec3 u = himc_vec3_unit(himc_vec3_make(normal(), normal(), normal()));
            if (k % 2) { // near the answer, to find a better one
                himc_vec3 d = {y.x / r.x, y.y / r.y, y.z / r.z};
                u = himc_vec3_unit(himc_vec3_madd(d, 0.02, u));
            }
            himc_vec3 p = {r.x * u.x, r.y * u.y, r.z * u.z};
            TEST_ASSERT_TRUE(himc_vec3_length(himc_vec3_sub(x, p)) > best - 1e-12);
        }
    }
}

static void test_closest_point_of_a_ball_is_on_the_way_to_its_centre(void)
{
    for (int i = 0; i < 100; i++) {
        himc_vec3 x = himc_vec3_scale(himc_vec3_unit(random_vector(1)), uniform(0.31, 3));
        himc_vec3 y = himc_limit_closest_on_ellipsoid(himc_vec3_make(0.3, 0.3, 0.3), x);
        himc_vec3 truth = himc_vec3_scale(himc_vec3_unit(x), 0.3);
        TEST_ASSERT_DOUBLE_WITHIN(1e-13, 0, himc_vec3_length(himc_vec3_sub(y, truth)));
    }
}

static void test_closest_rotation_is_itself_inside_and_on_the_bounds_outside(void)
{
    himc_pose mean = random_pose(), axes = random_pose();
    int moved = 0;
    spread_motion(&mean, &axes, himc_vec3_make(0.1, 0.05, 0.01));
    learn(0);
    for (int kind = HIMC_LIMITS_ELLIPSOID; kind <= HIMC_LIMITS_EULER; kind++)
        for (int i = 0; i < 3000; i++) {
            himc_vec3 turn = random_vector(1);
            himc_quat q = himc_quat_mul(mean.joint[ELBOW], himc_quat_exp(turn));
            limits.kind = (himc_limits_kind)kind;
            himc_quat near = himc_limit_closest(&limits, ELBOW, q);
            if (himc_limit_measure(&limits, ELBOW, q) <= 1) {
                TEST_ASSERT_EQUAL_MEMORY(&q, &near, sizeof q);
                continue;
            }
            moved++;
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1, himc_limit_measure(&limits, ELBOW, near));
        }
    TEST_ASSERT_TRUE(moved > 4000);
}

// the elbow's bounds: an ellipsoid with random mean and axes
static void random_bounds(double widest)
{
    himc_mat3 axes = himc_mat3_from_quat(random_rotation());
    himc_vec3 r = {exp(uniform(-6.9, 0)), exp(uniform(-6.9, 0)), exp(uniform(-6.9, 0))};
    limits = (himc_limits){.kind = HIMC_LIMITS_ELLIPSOID};
    limits.joint[ELBOW] = (himc_limit){.bound = true,
                                       .mean = random_rotation(),
                                       .axes = axes,
                                       .radius = himc_vec3_scale(r, widest)};
}

// a rotation with that place along the elbow's ellipsoid's axes
static himc_quat at_place(himc_vec3 t)
{
    const himc_limit *l = &limits.joint[ELBOW];
    return himc_quat_mul(l->mean, himc_quat_exp(himc_mat3_apply(&l->axes, t)));
}

// the nearest rotation within, all of it in long double, from the definition
static himc_quat found_by_bisection(himc_quat q)
{
    const himc_limit *l = &limits.joint[ELBOW];
    himc_quat away = himc_quat_mul(himc_quat_conj(l->mean), q);
    himc_vec3 v = himc_mat3_apply_transposed(&l->axes, himc_quat_vector(away));
    long double sine =
        sqrtl((long double)v.x * v.x + (long double)v.y * v.y + (long double)v.z * v.z);
    long double sign = away.w < 0 ? -1 : 1, s = 2 * sign * atan2l(sine, sign * away.w) / sine;
    v = himc_vec3_make((double)(s * v.x), (double)(s * v.y), (double)(s * v.z));
    himc_vec3 t = himc_mat3_apply(&l->axes, bisected(l->radius, v));
    long double half =
        sqrtl((long double)t.x * t.x + (long double)t.y * t.y + (long double)t.z * t.z) / 2;
    himc_quat near = {(double)cosl(half), t.x * (double)(sinl(half) / half / 2),
                      t.y * (double)(sinl(half) / half / 2), t.z * (double)(sinl(half) / half / 2)};
    return himc_quat_mul(l->mean, near);
}

static void test_way_back_of_random_poses_is_that_found_by_bisection(void)
{
    int outside = 0;
    for (int i = 0; i < 20000; i++) {
        double room;
        random_bounds(1);
        himc_vec3 t = random_vector(1), r = limits.joint[ELBOW].radius;
        if (i % 2) // a hair outside
            t = himc_vec3_scale(himc_vec3_make(t.x * r.x, t.y * r.y, t.z * r.z),
                                (1 + exp(uniform(-20, -2))) / himc_vec3_length(t));
        himc_quat q = i % 4 ? at_place(t) : random_rotation();
        himc_vec3 back = himc_limit_back(&limits, ELBOW, q, 0, &room);
        if (himc_limit_measure(&limits, ELBOW, q) <= 1) {
            TEST_ASSERT_EQUAL_DOUBLE(0, himc_vec3_length(back));
            continue;
        }
        outside++;
        himc_quat near = himc_quat_mul(himc_quat_exp(back), q);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, between(near, found_by_bisection(q)));
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, between(near, himc_limit_closest(&limits, ELBOW, q)));
    }
    TEST_ASSERT_TRUE(outside > 15000);
}

static void test_a_rotation_within_the_room_of_a_place_keeps_the_bounds(void)
{
    int tight = 0;
    for (int i = 0; i < 30000; i++) {
        random_bounds(2 * HIMC_PI);
        himc_vec3 z = himc_vec3_unit(random_vector(1)), r = limits.joint[ELBOW].radius;
        z = himc_vec3_scale(z, 1 - exp(uniform(-5, 0)));
        himc_quat q = at_place(himc_vec3_make(z.x * r.x, z.y * r.y, z.z * r.z));
        himc_limit_place place = himc_limit_locate(&limits, ELBOW, q);
        himc_vec3 turn = himc_vec3_scale(himc_vec3_unit(random_vector(1)), place.room);
        himc_quat then = himc_quat_mul(himc_quat_exp(turn), q);
        double measure = himc_limit_measure(&limits, ELBOW, then);
        TEST_ASSERT_TRUE(place.measure > 1 || measure < 1 + 1e-12);
        tight += measure - place.measure > 0.5 * (1 - place.measure);
    }
    TEST_ASSERT_TRUE(tight > 200);
}

static void test_way_back_is_left_out_only_where_it_is_shorter_than_asked_for(void)
{
    int left_out = 0, shorter = 0;
    for (int kind = HIMC_LIMITS_ELLIPSOID; kind <= HIMC_LIMITS_EULER; kind++)
        for (int i = 0; i < 20000; i++) {
            double room, farther = exp(uniform(-10, 0));
            random_bounds(1);
            himc_limit *l = &limits.joint[ELBOW];
            limits.kind = (himc_limits_kind)kind;
            l->upper = l->radius;
            l->lower = himc_vec3_scale(l->radius, -1);
            himc_vec3 t = himc_vec3_unit(random_vector(1));
            t = himc_vec3_scale(
                himc_vec3_make(t.x * l->radius.x, t.y * l->radius.y, t.z * l->radius.z),
                1 + exp(uniform(-10, 0)));
            himc_quat q = at_place(t);
            himc_vec3 back = himc_limit_back(&limits, ELBOW, q, 0, &room);
            himc_vec3 far = himc_limit_back(&limits, ELBOW, q, farther, &room);
            double length = himc_vec3_length(back);
            double most = himc_limit_locate(&limits, ELBOW, q).most_beyond;
            TEST_ASSERT_TRUE(length <= most + 1e-12);
            // of an ellipsoid the centre is within
            TEST_ASSERT_TRUE(kind == HIMC_LIMITS_EULER || most <= himc_vec3_length(t) + 1e-9);
            shorter += length < farther;
            if (length > 0 && himc_vec3_length(far) == 0) {
                left_out++;
                TEST_ASSERT_TRUE(length < farther + 1e-12);
            } else {
                TEST_ASSERT_EQUAL_MEMORY(&back, &far, sizeof far);
            }
        }
    TEST_ASSERT_TRUE(left_out > shorter / 4);
}

static void test_ellipsoids_and_boxes_of_no_width_give_finite_rotations(void)
{
    himc_limit point = {
        .bound = true, .mean = himc_quat_identity(), .axes = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
    limits.joint[ELBOW] = point;
    for (int kind = HIMC_LIMITS_ELLIPSOID; kind <= HIMC_LIMITS_EULER; kind++)
        for (int i = 0; i < 1000; i++) {
            limits.kind = (himc_limits_kind)kind;
            himc_quat near = himc_limit_closest(&limits, ELBOW, random_rotation());
            TEST_ASSERT_TRUE(between(near, himc_quat_identity()) < 2e-3);
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1, himc_quat_dot(near, near));
        }
}

static void test_table_1_bounds_neck_shoulders_elbows_and_wrists_and_no_more(void)
{
    himc_pose mean = random_pose();
    limits = himc_limits_table_1(&mean);
    for (int j = 0; j < HIMC_JOINTS; j++) {
        bool named =
            j == HIMC_NECK - 1 || (j >= HIMC_LEFT_UPPER_ARM - 1 && j <= HIMC_RIGHT_HAND - 1);
        TEST_ASSERT_EQUAL(named, limits.joint[j].bound);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, himc_limit_measure(&limits, j, mean.joint[j]));
    }
}

// the table has half angles, so the wrist bends by 2 x 19.9 degrees each way about its longest axis
static void test_table_1_lets_the_wrist_bend_by_40_degrees_most_of_it_in_flexion(void)
{
    himc_pose zero = himc_pose_zero();
    limits = himc_limits_table_1(&zero);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        int wrist = himc_arm_joint((himc_hand)hand, 2);
        const himc_limit *l = &limits.joint[wrist];
        himc_vec3 axis = {l->axes.m[0][0], l->axes.m[1][0], l->axes.m[2][0]};
        himc_quat most = himc_quat_exp(himc_vec3_scale(axis, 39.8 * HIMC_PI / 180));
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1, himc_limit_measure(&limits, wrist, most));
        TEST_ASSERT_TRUE(fabs(axis.y) > 0.9);
        TEST_ASSERT_TRUE(fabs(l->axes.m[2][2]) > 0.95); // hardly about its own length
    }
}

static void test_table_1_of_the_right_arm_mirrors_the_left(void)
{
    himc_pose zero = himc_pose_zero();
    limits = himc_limits_table_1(&zero);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 100; i++) {
            himc_vec3 t = random_vector(1), mirrored = {-t.x, t.y, -t.z};
            double left =
                himc_limit_measure(&limits, himc_arm_joint(HIMC_LEFT, k), himc_quat_exp(t));
            double right =
                himc_limit_measure(&limits, himc_arm_joint(HIMC_RIGHT, k), himc_quat_exp(mirrored));
            TEST_ASSERT_DOUBLE_WITHIN(1e-9 * left, left, right);
        }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_mean_of_rotations_does_not_depend_on_signs);
    RUN_TEST(test_mean_of_one_rotation_is_that_rotation_and_of_two_the_middle);
    RUN_TEST(test_learned_axes_and_radii_are_those_of_the_distribution);
    RUN_TEST(test_learned_bounds_contain_the_motion_and_touch_it);
    RUN_TEST(test_margin_widens_ellipsoid_and_box_by_its_share);
    RUN_TEST(test_loosened_bounds_have_the_least_width_and_wider_ones_stay);
    RUN_TEST(test_joint_that_did_not_move_turns_freely_and_frames_may_be_one);
    RUN_TEST(test_learning_refuses_no_frames_margins_out_of_range_and_non_rotations);
    RUN_TEST(test_closest_point_of_3000_ellipsoids_is_on_them_with_the_way_along_the_normal);
    RUN_TEST(test_closest_point_is_that_of_a_bisection);
    RUN_TEST(test_brute_force_finds_no_point_of_the_ellipsoid_nearer);
    RUN_TEST(test_closest_point_of_a_ball_is_on_the_way_to_its_centre);
    RUN_TEST(test_closest_rotation_is_itself_inside_and_on_the_bounds_outside);
    RUN_TEST(test_way_back_of_random_poses_is_that_found_by_bisection);
    RUN_TEST(test_a_rotation_within_the_room_of_a_place_keeps_the_bounds);
    RUN_TEST(test_way_back_is_left_out_only_where_it_is_shorter_than_asked_for);
    RUN_TEST(test_ellipsoids_and_boxes_of_no_width_give_finite_rotations);
    RUN_TEST(test_table_1_bounds_neck_shoulders_elbows_and_wrists_and_no_more);
    RUN_TEST(test_table_1_lets_the_wrist_bend_by_40_degrees_most_of_it_in_flexion);
    RUN_TEST(test_table_1_of_the_right_arm_mirrors_the_left);
    return UNITY_END();
}
