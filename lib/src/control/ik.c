/// ik.c: every solution has the form x = W J' f with a vector f of three numbers at the tip:
/// rotation_j = w_j lever_j x f. The solvers (solvers.c) differ in their approximation of
/// (J W J')^-1 in f = (J W J')^-1 e.
#include "control/ik.h"

// chosen: levers below about 1 cm across the direction: a straight arm along it
#define RELEASE_MOST 1e4 // n' (J W J')^-1 n, largest that is released (1/m^2)

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
        double w = weight[k];
        jacobian->lever[k] = r;
        jacobian->weight[k] = w;
        g.m[0][0] += w * (r.y * r.y + r.z * r.z);
        g.m[1][1] += w * (r.x * r.x + r.z * r.z);
        g.m[2][2] += w * (r.x * r.x + r.y * r.y);
        g.m[0][1] -= w * r.x * r.y;
        g.m[0][2] -= w * r.x * r.z;
        g.m[1][2] -= w * r.y * r.z;
    }
    g.m[1][0] = g.m[0][1];
    g.m[2][0] = g.m[0][2];
    g.m[2][1] = g.m[1][2];
    jacobian->gram = g;
    for (int i = 0; i < 3; i++)
        g.m[i][i] += HIMC_NULL_FLOOR;
    jacobian->inverse = himc_mat3_inverse_symmetric(&g);
}

void himc_ik_apply_transposed(const himc_arm_jacobian *jacobian, himc_vec3 f,
                              himc_vec3 rotation[HIMC_ARM_JOINTS])
{
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        rotation[k] = himc_vec3_cross(jacobian->lever[k], himc_vec3_scale(f, jacobian->weight[k]));
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
        s.m[i][i] += damping * damping + HIMC_NULL_FLOOR;
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
