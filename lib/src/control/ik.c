/// ik.c: every solution has the form x = W J' f with a vector f of three numbers at the tip:
/// rotation_j = w_j lever_j x f. The solvers differ in their approximation of (J W J')^-1 in
/// f = (J W J')^-1 e.
///
/// With the eigenvalues s_i^2 and eigenvectors u_i of J W J' (jacobi.h) each approximation is
/// sum g_i u_i u_i' / s_i^2 with its own gain g_i:
///     pseudo-inverse          1, or 0 if s_i is below a share of the largest one
///     damped least squares    s_i^2 / (s_i^2 + lambda^2); Nakamura's lambda is
///                             lambda_0 (1 - w / w_0) for a manipulability w = s_1 s_2 s_3 < w_0
///     selectively damped      limits the rotation of every joint to gamma_i, which is smaller
///                             where the joints move the tip much more than they bring it nearer
#include "control/ik.h"

#include "base/jacobi.h"

// chosen: a playing arm has 0.1 or more, so only a nearly straight arm loses a direction
#define PINV_TOLERANCE 0.02 // singular values below this share of the largest are left out
// chosen: (1 um)^2, six orders below the smallest useful damping, only keeps the inverse finite
#define NULL_FLOOR 1e-12 // added to J W J' (m^2)
// chosen: a playing arm has 0.12 .. 0.25 m^3, so damping begins well outside its region
#define NAKAMURA_SINGULAR 0.05 // w_0 (m^3)
#define SDLS_MOST_ROTATION \
    0.785 // gamma_max of one joint in one step (rad): Buss & Kim 2005, pi / 4
// chosen: levers below about 1 cm across the direction: a straight arm along it
#define RELEASE_MOST 1e4 // n' (J W J')^-1 n, largest that is released (1/m^2)

static void add_weighted(himc_mat3 *g, double w, himc_vec3 r)
{
    g->m[0][0] += w * (r.y * r.y + r.z * r.z);
    g->m[1][1] += w * (r.x * r.x + r.z * r.z);
    g->m[2][2] += w * (r.x * r.x + r.y * r.y);
    g->m[0][1] -= w * r.x * r.y;
    g->m[0][2] -= w * r.x * r.z;
    g->m[1][2] -= w * r.y * r.z;
}

void himc_arm_jacobian_at(const himc_body_state *s, himc_hand hand, himc_arm_jacobian *jacobian)
{
    static const double equal[HIMC_ARM_JOINTS] = {1, 1, 1, 1};
    himc_arm_jacobian_weighted(s, hand, equal, jacobian);
}

void himc_arm_jacobian_weighted(const himc_body_state *s, himc_hand hand,
                                const double weight[HIMC_ARM_JOINTS], himc_arm_jacobian *jacobian)
{
    himc_mat3 g = {{{0}}};
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        himc_vec3 r = himc_vec3_sub(s->tip[hand], s->origin[himc_arm_joint(hand, k) + 1]);
        jacobian->lever[k] = r;
        jacobian->weight[k] = weight[k];
        add_weighted(&g, weight[k], r);
    }
    g.m[1][0] = g.m[0][1];
    g.m[2][0] = g.m[0][2];
    g.m[2][1] = g.m[1][2];
    jacobian->gram = g;
    for (int i = 0; i < 3; i++)
        g.m[i][i] += NULL_FLOOR;
    jacobian->inverse = himc_mat3_inverse_symmetric(&g);
}

void himc_ik_apply_transposed(const himc_arm_jacobian *jacobian, himc_vec3 f,
                              himc_vec3 rotation[HIMC_ARM_JOINTS])
{
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        rotation[k] = himc_vec3_cross(jacobian->lever[k], himc_vec3_scale(f, jacobian->weight[k]));
}

static himc_mat3 damped(const himc_mat3 *gram, double damping)
{
    himc_mat3 g = *gram;
    for (int i = 0; i < 3; i++)
        g.m[i][i] += damping * damping + NULL_FLOOR;
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

static himc_mat3 truncated(const himc_mat3 *gram)
{
    spectrum s = spectrum_of(gram);
    himc_mat3 inverse = {{{0}}};
    double largest = fmax(s.square[0], fmax(s.square[1], s.square[2]));
    for (int i = 0; i < 3; i++)
        if (s.square[i] > PINV_TOLERANCE * PINV_TOLERANCE * largest)
            add_outer(&inverse, 1 / s.square[i], s.axis[i]);
    return inverse;
}

static double nakamura(const himc_mat3 *gram, double most)
{
    const double(*m)[3] = gram->m;
    double det = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[1][2]) -
                 m[0][1] * (m[0][1] * m[2][2] - m[1][2] * m[0][2]) +
                 m[0][2] * (m[0][1] * m[1][2] - m[1][1] * m[0][2]);
    return most * fmax(1 - sqrt(fmax(det, 0)) / NAKAMURA_SINGULAR, 0);
}

static double largest_component(himc_vec3 v)
{
    return fmax(fabs(v.x), fmax(fabs(v.y), fabs(v.z)));
}

// Buss & Kim 2005, equations 10 to 14, for one end effector: N_i = 1. The undamped inverse would
// rotate the joints by a W J' u_i / s_i^2 for the component a of the error along u_i; M_i is the
// sum of the distances by which each joint alone would move the tip per unit of that component.
static double selective_gain(const himc_arm_jacobian *jacobian, double square, himc_vec3 u,
                             double a)
{
    himc_vec3 step[HIMC_ARM_JOINTS];
    double distance = 0, most = 0;
    himc_ik_apply_transposed(jacobian, himc_vec3_scale(u, 1 / square), step);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        himc_vec3 r = jacobian->lever[k];
        distance += fabs(step[k].x) * hypot(r.y, r.z) + fabs(step[k].y) * hypot(r.x, r.z) +
                    fabs(step[k].z) * hypot(r.x, r.y);
        most = fmax(most, fabs(a) * largest_component(step[k]));
    }
    double gamma = fmin(1, 1 / distance) * SDLS_MOST_ROTATION;
    return most > gamma ? gamma / most : 1;
}

static himc_mat3 selective(const himc_arm_jacobian *jacobian, himc_vec3 error)
{
    spectrum s = spectrum_of(&jacobian->gram);
    himc_mat3 inverse = {{{0}}};
    himc_vec3 step[HIMC_ARM_JOINTS];
    for (int i = 0; i < 3; i++) {
        double square = fmax(s.square[i], NULL_FLOOR), a = himc_vec3_dot(s.axis[i], error);
        add_outer(&inverse, selective_gain(jacobian, square, s.axis[i], a) / square, s.axis[i]);
    }
    double most = 0;
    himc_ik_apply_transposed(jacobian, himc_mat3_apply(&inverse, error), step);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        most = fmax(most, largest_component(step[k]));
    if (most > SDLS_MOST_ROTATION)
        for (int i = 0; i < 9; i++)
            inverse.m[i / 3][i % 3] *= SDLS_MOST_ROTATION / most;
    return inverse;
}

static himc_mat3 transposed(const himc_mat3 *gram, himc_vec3 error)
{
    himc_vec3 ge = himc_mat3_apply(gram, error);
    double square = himc_vec3_dot(ge, ge),
           scale = square > 0 ? himc_vec3_dot(error, ge) / square : 0;
    return (himc_mat3){{{scale, 0, 0}, {0, scale, 0}, {0, 0, scale}}};
}

himc_mat3 himc_ik_inverse(const himc_arm_jacobian *jacobian, himc_solver solver, double damping,
                          himc_vec3 error)
{
    switch (solver) {
    case HIMC_SOLVER_PINV: return truncated(&jacobian->gram);
    case HIMC_SOLVER_TRANSPOSE: return transposed(&jacobian->gram, error);
    case HIMC_SOLVER_NAKAMURA: return damped(&jacobian->gram, nakamura(&jacobian->gram, damping));
    case HIMC_SOLVER_SDLS: return selective(jacobian, error);
    default: return damped(&jacobian->gram, damping);
    }
}

void himc_ik_solve(const himc_arm_jacobian *jacobian, himc_solver solver, double damping,
                   himc_vec3 error, himc_vec3 rotation[HIMC_ARM_JOINTS])
{
    himc_mat3 inverse = himc_ik_inverse(jacobian, solver, damping, error);
    himc_ik_apply_transposed(jacobian, himc_mat3_apply(&inverse, error), rotation);
}

himc_vec3 himc_ik_forward(const himc_arm_jacobian *jacobian,
                          const himc_vec3 rotation[HIMC_ARM_JOINTS])
{
    himc_vec3 moved = {0, 0, 0};
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        moved = himc_vec3_add(moved, himc_vec3_cross(rotation[k], jacobian->lever[k]));
    return moved;
}

void himc_ik_add_null(const himc_arm_jacobian *jacobian, const himc_vec3 desired[HIMC_ARM_JOINTS],
                      himc_vec3 rotation[HIMC_ARM_JOINTS])
{
    himc_vec3 tip_part[HIMC_ARM_JOINTS];
    himc_vec3 moved = himc_ik_forward(jacobian, desired);
    himc_ik_apply_transposed(jacobian, himc_mat3_apply(&jacobian->inverse, moved), tip_part);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        rotation[k] = himc_vec3_add(rotation[k], himc_vec3_sub(desired[k], tip_part[k]));
}

// adds N W J_e' g, with J_e x = x_shoulder x lever and so J_e' g = lever x g at the shoulder
static void add_elbow_force(const himc_arm_jacobian *jacobian, himc_vec3 lever, himc_vec3 g,
                            himc_vec3 rotation[HIMC_ARM_JOINTS])
{
    himc_vec3 desired[HIMC_ARM_JOINTS] = {
        himc_vec3_scale(himc_vec3_cross(lever, g), jacobian->weight[0])};
    himc_ik_add_null(jacobian, desired, rotation);
}

void himc_elbow_task_init(himc_elbow_task *task, const himc_arm_jacobian *jacobian, himc_vec3 lever,
                          double damping)
{
    himc_mat3 s;
    for (int c = 0; c < 3; c++) {
        himc_vec3 g = himc_vec3_make(c == 0, c == 1, c == 2), x[HIMC_ARM_JOINTS] = {{0, 0, 0}};
        add_elbow_force(jacobian, lever, g, x);
        himc_vec3 moved = himc_vec3_cross(x[0], lever);
        s.m[0][c] = moved.x, s.m[1][c] = moved.y, s.m[2][c] = moved.z;
    }
    for (int i = 0; i < 3; i++)
        s.m[i][i] += damping * damping + NULL_FLOOR;
    task->lever = lever;
    task->inverse = himc_mat3_inverse_symmetric(&s);
}

void himc_ik_add_elbow(const himc_arm_jacobian *jacobian, const himc_elbow_task *task,
                       himc_vec3 demand, himc_vec3 rotation[HIMC_ARM_JOINTS])
{
    himc_vec3 left = himc_vec3_sub(demand, himc_vec3_cross(rotation[0], task->lever));
    add_elbow_force(jacobian, task->lever, himc_mat3_apply(&task->inverse, left), rotation);
}

void himc_ik_release(const himc_arm_jacobian *jacobian, himc_vec3 direction, double remain,
                     himc_vec3 rotation[HIMC_ARM_JOINTS])
{
    // f = (J W J')^-1 n changes the tip's motion along n and not across it
    himc_vec3 step[HIMC_ARM_JOINTS];
    double along = himc_vec3_dot(direction, himc_ik_forward(jacobian, rotation)) - remain;
    himc_vec3 f = himc_mat3_apply(&jacobian->inverse, direction);
    if (himc_vec3_dot(direction, f) > RELEASE_MOST) // nothing moves the tip along n
        return;
    double effect = himc_vec3_dot(direction, himc_mat3_apply(&jacobian->gram, f));
    himc_ik_apply_transposed(jacobian, himc_vec3_scale(f, along / effect), step);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        rotation[k] = himc_vec3_sub(rotation[k], step[k]);
}
