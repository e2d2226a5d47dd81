/// test_ik_selective.c: selectively damped least squares against the paper's algorithm with the
/// full Jacobian (Buss & Kim 2005, section 4).
#include "himc/body.h"

#include "base/linear.h"

#include "bodies.h"
#include "unity.h"

#include <string.h>

#define COLUMNS (3 * HIMC_ARM_JOINTS)
#define MOST_TURN 0.785 // gamma_max, the paper's pi / 4 (rad)
#define POSES 1000

static double jacobian[COLUMNS][3]; // a column for each freedom
static himc_arm_jacobian arm;

void setUp(void)
{
    default_skeleton(17);
}

void tearDown(void)
{
}

static void random_arm(void)
{
    himc_pose pose;
    himc_body_state s;
    for (int j = 0; j < HIMC_JOINTS; j++)
        pose.joint[j] = himc_quat_exp(random_vector(1.5));
    himc_pose_to_state(&skeleton, &pose, NULL, &s);
    himc_arm_jacobian_at(&s, HIMC_LEFT, &arm);
    for (int c = 0; c < COLUMNS; c++) {
        himc_vec3 axis = himc_vec3_make(c % 3 == 0, c % 3 == 1, c % 3 == 2);
        himc_vec3 moved = himc_vec3_cross(axis, arm.lever[c / 3]);
        memcpy(jacobian[c], &moved, sizeof moved);
    }
}

static double largest(const double *v)
{
    double most = 0;
    for (int c = 0; c < COLUMNS; c++)
        most = fmax(most, fabs(v[c]));
    return most;
}

static void clamp_max_abs(double *v, double most)
{
    double scale = fmin(1, most / largest(v));
    for (int c = 0; c < COLUMNS; c++)
        v[c] *= scale;
}

static double singular[3], left[3][3], right[3][COLUMNS];

// J = sum s_i u_i v_i', from the three largest eigenvalues s_i^2 and eigenvectors v_i of J' J
static void singular_values(void)
{
    double square[COLUMNS][COLUMNS], lambda[COLUMNS], v[COLUMNS][COLUMNS];
    for (int i = 0; i < COLUMNS; i++)
        for (int k = 0; k < COLUMNS; k++) {
            const double *a = jacobian[i], *b = jacobian[k];
            square[i][k] = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        }
    TEST_ASSERT_EQUAL_INT(HIMC_LINEAR_SOLVED,
                          himc_linear_eigenvalues(COLUMNS, square[0], lambda, v[0]));
    memset(left, 0, sizeof left);
    for (int i = 0; i < 3; i++) {
        singular[i] = sqrt(lambda[COLUMNS - 1 - i]);
        memcpy(right[i], v[COLUMNS - 1 - i], sizeof right[i]);
        for (int c = 0; c < COLUMNS; c++)
            for (int k = 0; k < 3; k++)
                left[i][k] += jacobian[c][k] * right[i][c] / singular[i];
    }
}

// J = sum s_i u_i v_i'; with one end effector N_i = |u_i| = 1 and
//     M_i = 1 / s_i sum_j |v_ji| |ds / dq_j|,   gamma_i = min(1, N_i / M_i) gamma_max
//     dq = clamp(sum clamp(1 / s_i (u_i . e) v_i, gamma_i), gamma_max)
// returns the smallest gamma_i / gamma_max that clamped
static double buss_and_kim(const double e[3], double dq[COLUMNS])
{
    double share = 1;
    singular_values();
    memset(dq, 0, COLUMNS * sizeof *dq);
    for (int i = 0; i < 3; i++) {
        double along = left[i][0] * e[0] + left[i][1] * e[1] + left[i][2] * e[2];
        double m = 0, phi[COLUMNS];
        for (int c = 0; c < COLUMNS; c++) {
            const double *j = jacobian[c];
            m += fabs(right[i][c]) * sqrt(j[0] * j[0] + j[1] * j[1] + j[2] * j[2]) / singular[i];
            phi[c] = along * right[i][c] / singular[i];
        }
        double gamma = fmin(1, 1 / m) * MOST_TURN;
        if (largest(phi) > gamma)
            share = fmin(share, gamma / MOST_TURN);
        clamp_max_abs(phi, gamma);
        for (int c = 0; c < COLUMNS; c++)
            dq[c] += phi[c];
    }
    clamp_max_abs(dq, MOST_TURN);
    return share;
}

static void test_selective_damping_is_buss_and_kims_for_errors_of_every_size(void)
{
    static const double sizes[] = {1e-3, 0.1, 0.3, 1, 10};
    int damped = 0;
    for (int n = 0; n < POSES; n++) {
        himc_vec3 e = random_vector(sizes[n % 5]), got[HIMC_ARM_JOINTS];
        double error[3] = {e.x, e.y, e.z}, want[COLUMNS], turned[COLUMNS];
        random_arm();
        damped += buss_and_kim(error, want) < 0.7;
        himc_ik_solve(&arm, HIMC_SOLVER_SDLS, 0, e, got);
        memcpy(turned, got, sizeof turned);
        for (int c = 0; c < COLUMNS; c++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, want[c], turned[c]);
    }
    TEST_ASSERT_TRUE(damped > POSES / 4); // by a gamma_i well below gamma_max
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_selective_damping_is_buss_and_kims_for_errors_of_every_size);
    return UNITY_END();
}
