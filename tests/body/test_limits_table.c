/// test_limits_table.c: the bounds of table 1 against the paper's numbers, their boxes, and Euler
/// angles at gimbal lock.
#include "himc/body.h"

#include "bodies.h"
#include "unity.h"

#define DEGREE (HIMC_PI / 180)
#define NECK (HIMC_NECK - 1)
#define ELBOW (HIMC_LEFT_FOREARM - 1)

/// A row of the table: lambda, e_x, e_y, e_z.
typedef struct row {
    double lambda, e[3];
} row;

// Bouenard, Gibet and Wanderley 2012, table 1, as it is printed
static const row neck_rows[3] = {
    {5.7, {0.111, 0.993, 0.045}}, {2.9, {-0.978, 0.117, -0.173}}, {2.3, {0.177, 0.025, -0.984}}};
static const row arm_rows[3][3] = {
    {{4.4, {0.291, 0.018, -0.957}}, {2.7, {-0.955, -0.062, -0.291}}, {0.1, {0.064, -0.998, 0.001}}},
    {{14.6, {0.337, -0.684, 0.647}},
     {8.9, {-0.889, -0.004, 0.458}},
     {4.4, {-0.311, -0.729, -0.609}}},
    {{19.9, {0.231, -0.932, 0.278}},
     {9.1, {0.003, -0.285, -0.958}},
     {2.1, {-0.973, -0.222, 0.063}}}};

static himc_limits limits;
static himc_pose zero;

void setUp(void)
{
    srand(21);
    zero = himc_pose_zero();
    limits = himc_limits_table_1(&zero);
}

void tearDown(void)
{
}

static himc_vec3 column(const himc_mat3 *m, int k)
{
    return himc_vec3_make(m->m[0][k], m->m[1][k], m->m[2][k]);
}

static double part(himc_vec3 v, int i)
{
    return i == 0 ? v.x : i == 1 ? v.y : v.z;
}

// the ellipsoid's axes are the printed ones, which have three digits and are not quite orthonormal
static void check_rows(int joint, const row rows[3], const himc_vec3 axes[3])
{
    const himc_limit *l = &limits.joint[joint];
    for (int k = 0; k < 3; k++) {
        himc_vec3 e = column(&l->axes, k);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 2 * rows[k].lambda * DEGREE, part(l->radius, k));
        for (int i = 0; i < 3; i++)
            TEST_ASSERT_DOUBLE_WITHIN(0.0015, part(axes[k], i), part(e, i));
    }
}

// captures: x to the left, y up, z forward; here x is forward, y to the left, z up
static void test_neck_of_table_1_is_as_printed(void)
{
    himc_vec3 axes[3];
    for (int k = 0; k < 3; k++) {
        const double *e = neck_rows[k].e;
        axes[k] = himc_vec3_make(e[2], e[0], e[1]);
    }
    check_rows(NECK, neck_rows, axes);
}

// the captures hold the left arm along their x; here it hangs along -z, and forward stays forward
static void test_arms_of_table_1_are_as_printed_and_the_right_one_mirrored(void)
{
    himc_vec3 axes[3];
    for (int k = 0; k < 3; k++)
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            for (int i = 0; i < 3; i++) {
                const double *e = arm_rows[k][i].e;
                axes[i] = himc_vec3_make(e[2], hand == HIMC_LEFT ? e[1] : -e[1], -e[0]);
            }
            check_rows(himc_arm_joint((himc_hand)hand, k), arm_rows[k], axes);
        }
}

// where an ellipsoid goes farthest along x, y or z: A A' n / |A' n|, A = axes times radii
static himc_vec3 farthest(const himc_limit *l, himc_vec3 n)
{
    himc_vec3 r = l->radius, local = himc_mat3_apply_transposed(&l->axes, n);
    himc_vec3 u = himc_vec3_unit(himc_vec3_make(r.x * local.x, r.y * local.y, r.z * local.z));
    return himc_mat3_apply(&l->axes, himc_vec3_make(r.x * u.x, r.y * u.y, r.z * u.z));
}

static void test_boxes_of_table_1_touch_their_ellipsoids_on_every_side(void)
{
    for (int j = 0; j < HIMC_JOINTS; j++) {
        const himc_limit *l = &limits.joint[j];
        for (int i = 0; i < 3 && l->bound; i++) {
            himc_vec3 n = himc_vec3_make(i == 0, i == 1, i == 2), most = farthest(l, n);
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1, himc_limit_measure(&limits, j, himc_quat_exp(most)));
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, part(most, i), part(l->upper, i));
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, -part(most, i), part(l->lower, i));
        }
    }
}

static void test_a_rotation_about_one_axis_to_the_boxes_bound_is_on_the_bound(void)
{
    limits.kind = HIMC_LIMITS_EULER;
    for (int j = 0; j < HIMC_JOINTS; j++)
        for (int i = 0; i < 3 && limits.joint[j].bound; i++) {
            double most = part(limits.joint[j].upper, i);
            himc_vec3 turn = himc_vec3_make(most * (i == 0), most * (i == 1), most * (i == 2));
            for (int sign = -1; sign <= 1; sign += 2)
                TEST_ASSERT_DOUBLE_WITHIN(
                    1e-9, 1,
                    himc_limit_measure(&limits, j, himc_quat_exp(himc_vec3_scale(turn, sign))));
        }
}

static himc_quat about(double x, double y, double z)
{
    himc_quat turn = himc_quat_mul(himc_quat_exp(himc_vec3_make(0, y, 0)),
                                   himc_quat_exp(himc_vec3_make(x, 0, 0)));
    return himc_quat_mul(himc_quat_exp(himc_vec3_make(0, 0, z)), turn);
}

// at y = pi/2 x and z rotate about the same line, and x gets the whole rotation
static void test_in_gimbal_lock_x_gets_the_whole_rotation(void)
{
    limits.kind = HIMC_LIMITS_EULER;
    limits.joint[ELBOW] = (himc_limit){
        .bound = true, .mean = himc_quat_identity(), .lower = {-0.5, -2, -1}, .upper = {0.5, 2, 1}};
    for (int side = -1; side <= 1; side += 2)
        for (double x = -0.9; x < 1; x += 0.2)
            for (double z = -0.3; z < 0.4; z += 0.3) {
                double y = side * HIMC_PI / 2, whole = x - side * z;
                himc_quat q = about(x, y, z), near = himc_limit_closest(&limits, ELBOW, q);
                himc_quat want = about(fmin(fmax(whole, -0.5), 0.5), y, 0);
                TEST_ASSERT_DOUBLE_WITHIN(1e-7, fmax(fabs(whole) / 0.5, HIMC_PI / 4),
                                          himc_limit_measure(&limits, ELBOW, q));
                TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1, fabs(himc_quat_dot(want, near)));
            }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_neck_of_table_1_is_as_printed);
    RUN_TEST(test_arms_of_table_1_are_as_printed_and_the_right_one_mirrored);
    RUN_TEST(test_boxes_of_table_1_touch_their_ellipsoids_on_every_side);
    RUN_TEST(test_a_rotation_about_one_axis_to_the_boxes_bound_is_on_the_bound);
    RUN_TEST(test_in_gimbal_lock_x_gets_the_whole_rotation);
    return UNITY_END();
}
