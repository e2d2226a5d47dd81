/// solvers.c: the solvers of inverse kinematics: approximations of (J W J')^-1. A new one is a
/// function here, a row of the table at the end, and a word in the row of `solver` in
/// himc/command_rows.h.
///
/// With the eigenvalues s_i^2 and eigenvectors u_i of J W J' (jacobi.h) each approximation is
/// sum g_i u_i u_i' / s_i^2 with its own gain g_i:
///     pseudo-inverse          1, or 0 if s_i is below a share of the largest one
///     damped least squares    s_i^2 / (s_i^2 + lambda^2); Nakamura's lambda is
///                             lambda_0 (1 - w / w_0) for a manipulability w = s_1 s_2 s_3 < w_0
///     selectively damped      limits the rotation of every joint to gamma_i, which is smaller
///                             where the joints move the tip much more than they bring it nearer
#include "control/solvers.h"

#include "base/jacobi.h"

// chosen: a playing arm has 0.1 or more, so only a nearly straight arm loses a direction
#define PINV_TOLERANCE 0.02 // singular values below this share of the largest are left out
// chosen: a playing arm has 0.12 .. 0.25 m^3, so damping begins well outside its region
#define NAKAMURA_SINGULAR 0.05 // w_0 (m^3)
#define SDLS_MOST_ROTATION \
    0.785 // gamma_max of one joint in one step (rad): Buss & Kim 2005, pi / 4

static himc_mat3 damped(const himc_arm_jacobian *jacobian, double damping, himc_vec3 error)
{
    himc_mat3 g = jacobian->gram;
    (void)error;
    for (int i = 0; i < 3; i++)
        g.m[i][i] += damping * damping + HIMC_NULL_FLOOR;
    return himc_mat3_inverse_symmetric(&g);
}

typedef struct spectrum {
    double square[3];  // singular values, squared (m^2)
    himc_vec3 axis[3]; // unit vectors
} spectrum;

static spectrum spectrum_of(const himc_mat3 *gram)
{
    double a[9], v[9];
    spectrum s;
    for (int i = 0; i < 9; i++)
        a[i] = gram->m[i / 3][i % 3];
    himc_jacobi(3, a, v);
    for (int i = 0; i < 3; i++) {
        s.square[i] = a[4 * i];
        s.axis[i] = himc_vec3_make(v[i], v[3 + i], v[6 + i]);
    }
    return s;
}

static void add_outer(himc_mat3 *sum, double scale, himc_vec3 u)
{
    const double c[3] = {u.x, u.y, u.z};
    for (int i = 0; i < 9; i++)
        sum->m[i / 3][i % 3] += scale * c[i / 3] * c[i % 3];
}

static himc_mat3 truncated(const himc_arm_jacobian *jacobian, double damping, himc_vec3 error)
{
    (void)damping, (void)error;
    spectrum s = spectrum_of(&jacobian->gram);
    himc_mat3 inverse = {{{0}}};
    double largest = fmax(s.square[0], fmax(s.square[1], s.square[2]));
    for (int i = 0; i < 3; i++)
        if (s.square[i] > PINV_TOLERANCE * PINV_TOLERANCE * largest)
            add_outer(&inverse, 1 / s.square[i], s.axis[i]);
    return inverse;
}

static himc_mat3 nakamura(const himc_arm_jacobian *jacobian, double damping, himc_vec3 error)
{
    const double(*m)[3] = jacobian->gram.m;
    double det = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[1][2]) -
                 m[0][1] * (m[0][1] * m[2][2] - m[1][2] * m[0][2]) +
                 m[0][2] * (m[0][1] * m[1][2] - m[1][1] * m[0][2]);
    double near = fmax(1 - sqrt(fmax(det, 0)) / NAKAMURA_SINGULAR, 0);
    return damped(jacobian, damping * near, error);
}

static double largest_component(himc_vec3 v)
{
    return fmax(fabs(v.x), fmax(fabs(v.y), fabs(v.z)));
}

// Buss & Kim 2005, equations 10 to 14, for one end effector: N_i = 1. The undamped inverse would
// rotate the joints by a W J' u_i / s_i^2 for the component a of the error along u_i; M_i is the
// sum of the distances by which each joint alone would move the tip per unit of that component.
static himc_mat3 selective(const himc_arm_jacobian *jacobian, double damping, himc_vec3 error)
{
    (void)damping;
    spectrum s = spectrum_of(&jacobian->gram);
    himc_mat3 inverse = {{{0}}};
    himc_vec3 step[HIMC_ARM_JOINTS];
    double most;
    for (int i = 0; i < 3; i++) {
        double square = fmax(s.square[i], HIMC_NULL_FLOOR), a = himc_vec3_dot(s.axis[i], error);
        double distance = most = 0;
        himc_ik_apply_transposed(jacobian, himc_vec3_scale(s.axis[i], 1 / square), step);
        for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
            himc_vec3 r = jacobian->lever[k];
            distance += fabs(step[k].x) * hypot(r.y, r.z) + fabs(step[k].y) * hypot(r.x, r.z) +
                        fabs(step[k].z) * hypot(r.x, r.y);
            most = fmax(most, fabs(a) * largest_component(step[k]));
        }
        double gamma = fmin(1, 1 / distance) * SDLS_MOST_ROTATION;
        add_outer(&inverse, (most > gamma ? gamma / most : 1) / square, s.axis[i]);
    }
    most = 0;
    himc_ik_apply_transposed(jacobian, himc_mat3_apply(&inverse, error), step);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        most = fmax(most, largest_component(step[k]));
    if (most > SDLS_MOST_ROTATION)
        for (int i = 0; i < 9; i++)
            inverse.m[i / 3][i % 3] *= SDLS_MOST_ROTATION / most;
    return inverse;
}

static himc_mat3 transposed(const himc_arm_jacobian *jacobian, double damping, himc_vec3 error)
{
    (void)damping;
    himc_vec3 ge = himc_mat3_apply(&jacobian->gram, error);
    double square = himc_vec3_dot(ge, ge),
           scale = square > 0 ? himc_vec3_dot(error, ge) / square : 0;
    return (himc_mat3){{{scale, 0, 0}, {0, scale, 0}, {0, 0, scale}}};
}

const himc_solver_row himc_solvers[HIMC_SOLVERS] = {
    [HIMC_SOLVER_DLS] = {"dls", damped, false},
    [HIMC_SOLVER_PINV] = {"pinv", truncated, false},
    [HIMC_SOLVER_TRANSPOSE] = {"transpose", transposed, true},
    [HIMC_SOLVER_NAKAMURA] = {"nakamura", nakamura, false},
    [HIMC_SOLVER_SDLS] = {"sdls", selective, false},
};

void himc_ik_solve(const himc_arm_jacobian *jacobian, himc_solver solver, double damping,
                   himc_vec3 error, himc_vec3 rotation[HIMC_ARM_JOINTS])
{
    himc_mat3 inverse = himc_solvers[solver].inverse(jacobian, damping, error);
    himc_ik_apply_transposed(jacobian, himc_mat3_apply(&inverse, error), rotation);
}
