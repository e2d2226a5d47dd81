/// dynamics.h: forward dynamics with implicit servos, and the tips' accelerations; private.
#ifndef HIMC_DYNAMICS_H
#define HIMC_DYNAMICS_H

#include "himc/body.h"

/// Articulated inertias where each joint resists its own relative acceleration by `resistance`
/// about the child's axes (kg m^2). This models a servo integrated implicitly over a step,
/// D = h Kd + h^2 Kp (Tan, Liu & Turk 2011). himc_effective_mass does not allow such an
/// articulation.
HIMC_RT void himc_articulate_resisting(const himc_skeleton *skeleton, const himc_body_state *state,
                                       const himc_vec3 resistance[HIMC_JOINTS],
                                       himc_articulation *articulation);

#define HIMC_LEGS HIMC_LEFT_UPPER_LEG ///< segments 1 .. HIMC_LEGS - 1 are trunk, neck, head, arms

/// The first segment that moves: the pelvis, 0, if it is free, else 1.
static inline int himc_first_moving(const himc_skeleton *skeleton)
{
    return skeleton->segment[HIMC_PELVIS].joint == HIMC_JOINT_FREE ? 0 : 1;
}

/// himc_articulate without the legs: their entries stay, and they take no part.
HIMC_RT void himc_articulate_upper(const himc_skeleton *skeleton, const himc_body_state *state,
                                   himc_articulation *articulation);

/// An acceleration of a body about its origin, or a wrench on it (world frame).
typedef struct himc_spatial {
    himc_vec3 angular; ///< acceleration (rad/s^2), or moment about the origin (N m)
    himc_vec3 linear;  ///< of the origin (m/s^2), or force (N)
} himc_spatial;

/// What moves a segment on its joint (world frame).
typedef struct tree_load {
    himc_vec3 moment; ///< needed about the joint while nothing accelerates (N m)
    himc_vec3 force;  ///< needed at the joint while nothing accelerates (N)
    himc_vec3 gap;    ///< acceleration of the joint relative to that point of the parent (m/s^2)
} tree_load;

/// Solves the tree under loads (HIMC_SEGMENTS; the pelvis' counts if it is free), which are
/// overwritten: the angular accelerations of the segments (rad/s^2) and the accelerations of their
/// joints (m/s^2). Only the segments of the articulation are written, and the pelvis.
HIMC_RT void himc_articulation_solve(const himc_skeleton *skeleton,
                                     const himc_articulation *articulation,
                                     tree_load load[HIMC_SEGMENTS], himc_vec3 alpha[HIMC_SEGMENTS],
                                     himc_vec3 acceleration[HIMC_SEGMENTS]);

/// The product of a symmetric matrix and a vector.
static inline himc_vec3 himc_symmetric_apply(const himc_symmetric *a, himc_vec3 v)
{
    return himc_vec3_make(a->xx * v.x + a->xy * v.y + a->xz * v.z,
                          a->xy * v.x + a->yy * v.y + a->yz * v.z,
                          a->xz * v.x + a->yz * v.y + a->zz * v.z);
}

/// a + l times the unit matrix.
static inline himc_symmetric himc_symmetric_plus(const himc_symmetric *a, double l)
{
    return (himc_symmetric){a->xx + l, a->xy, a->xz, a->yy + l, a->yz, a->zz + l};
}

/// The inverse of a positive definite matrix, by cofactors.
static inline himc_symmetric himc_symmetric_inverse(const himc_symmetric *a)
{
    double xx = a->yy * a->zz - a->yz * a->yz, xy = a->xz * a->yz - a->xy * a->zz,
           xz = a->xy * a->yz - a->xz * a->yy;
    double s = 1 / (a->xx * xx + a->xy * xy + a->xz * xz);
    return (himc_symmetric){xx * s,
                            xy * s,
                            xz * s,
                            (a->xx * a->zz - a->xz * a->xz) * s,
                            (a->xy * a->xz - a->xx * a->yz) * s,
                            (a->xx * a->yy - a->xy * a->xy) * s};
}

/// a += scale v v'.
static inline void himc_add_square(himc_symmetric *a, double scale, himc_vec3 v)
{
    himc_vec3 u = himc_vec3_scale(v, scale);
    a->xx += u.x * v.x;
    a->xy += u.x * v.y;
    a->xz += u.x * v.z;
    a->yy += u.y * v.y;
    a->yz += u.y * v.z;
    a->zz += u.z * v.z;
}

/// A tensor given about a segment's axes, in the world frame: R diag(d) R' = d.z 1 + the excess of
/// d.x and d.y along their axes.
static inline himc_symmetric himc_world_tensor(const himc_mat3 *r, himc_vec3 d)
{
    himc_symmetric t = {.xx = d.z, .yy = d.z, .zz = d.z};
    himc_add_square(&t, d.x - d.z, himc_vec3_make(r->m[0][0], r->m[1][0], r->m[2][0]));
    himc_add_square(&t, d.y - d.z, himc_vec3_make(r->m[0][1], r->m[1][1], r->m[2][1]));
    return t;
}

/// Centre of mass of a segment (m).
static inline himc_vec3 himc_segment_center(const himc_skeleton *skeleton,
                                            const himc_body_state *state, int segment)
{
    return himc_vec3_add(
        state->origin[segment],
        himc_mat3_apply(&state->rotation[segment], skeleton->segment[segment].center));
}

/// Adds a force (N) on a segment at the point `at` to the joints' torques (N m) as the torques that
/// act as it does: those of its segment and of all up to the pelvis.
HIMC_RT void himc_add_force(const himc_skeleton *skeleton, const himc_body_state *state,
                            int segment, himc_vec3 at, himc_vec3 force,
                            himc_vec3 torque[HIMC_JOINTS]);

/// himc_inverse_dynamics of a moving body, with the centres and inertias of this articulation;
/// NULL: they are found. `root` is the pelvis' acceleration, NULL for none; `needed` takes the
/// wrench on it that goes with all this, unless NULL.
HIMC_RT void himc_inverse_dynamics_of(const himc_skeleton *skeleton, const himc_body_state *state,
                                      const himc_articulation *articulation,
                                      const himc_vec3 *relative, const himc_spatial *root,
                                      himc_vec3 torque[HIMC_JOINTS], himc_spatial *needed);

/// The same without the legs, under a pelvis that does not move: their torques stay.
HIMC_RT void himc_inverse_dynamics_upper(const himc_skeleton *skeleton,
                                         const himc_body_state *state,
                                         const himc_articulation *articulation,
                                         const himc_vec3 *relative, himc_vec3 torque[HIMC_JOINTS]);

/// himc_forward_dynamics, and under a wrench on a pelvis that is free (NULL: none); `root` takes
/// the acceleration of the pelvis, unless NULL.
HIMC_RT void himc_forward_dynamics_of(const himc_skeleton *skeleton, const himc_body_state *state,
                                      const himc_articulation *articulation,
                                      const himc_vec3 *torque, const himc_vec3 *tip_force,
                                      const himc_spatial *wrench, himc_vec3 relative[HIMC_JOINTS],
                                      himc_spatial *root);

/// Acceleration of a drumstick tip (m/s^2) under the joints' relative accelerations (rad/s^2)
/// (HIMC_JOINTS; NULL for zero) and that of the pelvis (NULL for zero).
HIMC_RT himc_vec3 himc_tip_acceleration(const himc_skeleton *skeleton, const himc_body_state *state,
                                        himc_hand hand, const himc_vec3 *relative,
                                        const himc_spatial *root);
/// The same while the joints of the arms have none.
HIMC_RT himc_vec3 himc_tip_carried(const himc_skeleton *skeleton, const himc_body_state *state,
                                   himc_hand hand, const himc_vec3 *relative,
                                   const himc_spatial *root);

#endif
