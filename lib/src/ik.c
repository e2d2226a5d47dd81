/// ik.c: everything is a force f at the tip, three numbers, put through J': rotation_j = lever_j
/// x f.
///
/// Damped least squares f = (J J' + lambda^2)^-1 e; pseudo-inverse f = sum over singular values
/// s_i > tol s_max of u_i (u_i . e) / s_i^2, from the eigenvectors of J J' (Jacobi rotations,
/// always converging for 3 x 3).
#include "himc/ik.h"

#define PINV_TOLERANCE 0.02 // singular values below this share of the largest are left out
#define NULL_FLOOR 1e-12    // keeps the null space projector finite when the arm is straight (m^2)

void himc_arm_jacobian_at(const himc_body_state *s, himc_hand hand, himc_arm_jacobian *jacobian)
{
    himc_mat3 g = {{{0}}};
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        himc_vec3 r = himc_vec3_sub(s->tip[hand], s->origin[himc_arm_joint(hand, k) + 1]);
        jacobian->lever[k] = r;
        g.m[0][0] += r.y * r.y + r.z * r.z;
        g.m[1][1] += r.x * r.x + r.z * r.z;
        g.m[2][2] += r.x * r.x + r.y * r.y;
        g.m[0][1] -= r.x * r.y;
        g.m[0][2] -= r.x * r.z;
        g.m[1][2] -= r.y * r.z;
    }
    g.m[1][0] = g.m[0][1];
    g.m[2][0] = g.m[0][2];
    g.m[2][1] = g.m[1][2];
    jacobian->gram = g;
    for (int i = 0; i < 3; i++)
        g.m[i][i] += NULL_FLOOR;
    jacobian->inverse = himc_mat3_inverse_symmetric(&g);
}

static void through_transpose(const himc_arm_jacobian *jacobian, himc_vec3 f,
                              himc_vec3 rotation[HIMC_ARM_JOINTS])
{
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        rotation[k] = himc_vec3_cross(jacobian->lever[k], f);
}

static himc_vec3 damped(const himc_mat3 *gram, double damping, himc_vec3 e)
{
    himc_mat3 g = *gram;
    for (int i = 0; i < 3; i++)
        g.m[i][i] += damping * damping + NULL_FLOOR;
    himc_mat3 inverse = himc_mat3_inverse_symmetric(&g);
    return himc_mat3_apply(&inverse, e);
}

// one Jacobi rotation that zeroes a[p][q]
static void jacobi_rotate(double a[3][3], double v[3][3], int p, int q)
{
    if (a[p][q] == 0)
        return;
    double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
    double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
    double c = 1 / sqrt(t * t + 1), s = t * c;
    for (int i = 0; i < 3; i++) {
        double x = a[i][p], y = a[i][q];
        a[i][p] = c * x - s * y;
        a[i][q] = s * x + c * y;
    }
    for (int i = 0; i < 3; i++) {
        double x = a[p][i], y = a[q][i];
        a[p][i] = c * x - s * y;
        a[q][i] = s * x + c * y;
        x = v[i][p];
        y = v[i][q];
        v[i][p] = c * x - s * y;
        v[i][q] = s * x + c * y;
    }
}

static himc_vec3 truncated(const himc_mat3 *gram, himc_vec3 e)
{
    double a[3][3], v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int i = 0; i < 9; i++)
        a[i / 3][i % 3] = gram->m[i / 3][i % 3];
    for (int sweep = 0; sweep < 8; sweep++) {
        jacobi_rotate(a, v, 0, 1);
        jacobi_rotate(a, v, 0, 2);
        jacobi_rotate(a, v, 1, 2);
    }
    double largest = fmax(a[0][0], fmax(a[1][1], a[2][2]));
    himc_vec3 f = {0, 0, 0};
    for (int i = 0; i < 3; i++) {
        himc_vec3 u = {v[0][i], v[1][i], v[2][i]};
        if (a[i][i] > PINV_TOLERANCE * PINV_TOLERANCE * largest)
            f = himc_vec3_madd(f, himc_vec3_dot(u, e) / a[i][i], u);
    }
    return f;
}

void himc_ik_solve(const himc_arm_jacobian *jacobian, himc_solver solver, double damping,
                   himc_vec3 error, himc_vec3 rotation[HIMC_ARM_JOINTS])
{
    himc_vec3 f;
    if (solver == HIMC_SOLVER_DLS) {
        f = damped(&jacobian->gram, damping, error);
    } else if (solver == HIMC_SOLVER_PINV) {
        f = truncated(&jacobian->gram, error);
    } else {
        himc_vec3 ge = himc_mat3_apply(&jacobian->gram, error);
        double square = himc_vec3_dot(ge, ge);
        f = himc_vec3_scale(error, square > 0 ? himc_vec3_dot(error, ge) / square : 0);
    }
    through_transpose(jacobian, f, rotation);
}

himc_vec3 himc_ik_forward(const himc_arm_jacobian *jacobian,
                          const himc_vec3 rotation[HIMC_ARM_JOINTS])
{
    himc_vec3 moved = {0, 0, 0};
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        moved = himc_vec3_add(moved, himc_vec3_cross(rotation[k], jacobian->lever[k]));
    return moved;
}

void himc_ik_add_null(const himc_arm_jacobian *jacobian, const himc_vec3 wish[HIMC_ARM_JOINTS],
                      himc_vec3 rotation[HIMC_ARM_JOINTS])
{
    himc_vec3 f = himc_mat3_apply(&jacobian->inverse, himc_ik_forward(jacobian, wish));
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        himc_vec3 seen = himc_vec3_cross(jacobian->lever[k], f);
        rotation[k] = himc_vec3_add(rotation[k], himc_vec3_sub(wish[k], seen));
    }
}

void himc_ik_release(const himc_arm_jacobian *jacobian, himc_vec3 direction, double remain,
                     himc_vec3 rotation[HIMC_ARM_JOINTS])
{
    // f = (J J')^-1 n takes away along n and nothing across it
    double along = himc_vec3_dot(direction, himc_ik_forward(jacobian, rotation)) - remain;
    himc_vec3 f = himc_mat3_apply(&jacobian->inverse, direction);
    if (himc_vec3_dot(direction, f) > 1e4) // a straight arm along n: nothing moves the tip that way
        return;
    double effect = himc_vec3_dot(direction, himc_mat3_apply(&jacobian->gram, f));
    f = himc_vec3_scale(f, along / effect);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        rotation[k] = himc_vec3_sub(rotation[k], himc_vec3_cross(jacobian->lever[k], f));
}
