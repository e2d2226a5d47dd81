/// tree.c: the equations of ODE's dWorldStep, solved along the tree of ball joints.
///
/// dWorldStep finds forces at the joints such that, at the end of the step, the two bodies of each
/// joint approach with a velocity that closes the share ERP of its gap,
///     v+ + w+ x c - (v_p+ + w_p+ x c_p) = ERP / h gap,
/// and solves all joints at once. Divided by h this is an acceleration of the joint relative to its
/// place on the parent,
///     g = ERP / h^2 gap + 1 / h (velocity of the parent there - velocity of the joint),
/// so the blocks of fwdyn.c eliminate it in one pass inwards and one outwards. Constraint force
/// mixing is zero.
///
/// The gyroscopic moment is implicit (Lacoursiere, Stabilizing gyroscopic forces in rigid multibody
/// simulations, 2006): I w+ = L + h L x w+ with the angular momentum L = I w, so the moment is
/// L x w+. With adj(I) L = det I w,
///     w+ = (det I w + h (I L) x L + h^2 L |L|^2) / (det I + h^2 L' I L).
///
/// Then v+ = v + h a, x+ = x + h v+, and q+ = q + h / 2 w+ q, made a unit quaternion.
#include "body/tree.h"

himc_vec3 himc_gyroscopic_moment(const himc_symmetric *inertia, himc_vec3 own, himc_vec3 w,
                                 double h)
{
    himc_vec3 l = himc_symmetric_apply(inertia, w), il = himc_symmetric_apply(inertia, l);
    double det = own.x * own.y * own.z;
    // the part along L has no moment
    himc_vec3 after = himc_vec3_madd(himc_vec3_scale(w, det), h, himc_vec3_cross(il, l));
    return himc_vec3_scale(himc_vec3_cross(l, after), 1 / (det + h * h * himc_vec3_dot(l, il)));
}

static void fill_loads(const himc_skeleton *skeleton, const himc_articulation *art,
                       const segment_forces *f, const segment_states *s, double erp, double h,
                       tree_load load[HIMC_SEGMENTS])
{
    const himc_body_state *b = &s->joints;
    himc_vec3 velocity[HIMC_SEGMENTS]; // of the joints
    velocity[0] = himc_vec3_make(0, 0, 0);
    for (int i = art->first; i < art->end; i++) {
        const himc_segment *segment = &skeleton->segment[i];
        himc_vec3 torque =
            himc_gyroscopic_moment(&art->inertia[i], segment->inertia, b->spin[i], h);
        torque = himc_vec3_add(torque, f->torque[i]);
        velocity[i] = himc_vec3_sub(s->velocity[i], himc_vec3_cross(b->spin[i], art->center[i]));
        load[i].force = himc_vec3_scale(f->force[i], -1);
        load[i].force.z += segment->mass * HIMC_GRAVITY;
        load[i].moment = himc_vec3_sub(himc_vec3_cross(art->center[i], load[i].force), torque);
        if (i == 0)
            continue;
        int p = segment->parent;
        himc_vec3 gap = himc_vec3_sub(himc_vec3_add(b->origin[p], art->lever[i]), b->origin[i]);
        himc_vec3 there = himc_vec3_add(velocity[p], himc_vec3_cross(b->spin[p], art->lever[i]));
        himc_vec3 rate = himc_vec3_sub(there, velocity[i]);
        load[i].gap = himc_vec3_scale(himc_vec3_madd(rate, erp / h, gap), 1 / h);
    }
}

void himc_tree_step(const himc_skeleton *skeleton, const himc_articulation *art,
                    const segment_forces *forces, double erp, double h, segment_states *states)
{
    tree_load load[HIMC_SEGMENTS];
    himc_vec3 alpha[HIMC_SEGMENTS], a[HIMC_SEGMENTS];
    fill_loads(skeleton, art, forces, states, erp, h, load);
    himc_articulation_solve(skeleton, art, load, alpha, a);
    himc_body_state *b = &states->joints;
    for (int i = art->first; i < art->end; i++) {
        a[i] = himc_vec3_add(a[i], himc_vec3_cross(alpha[i], art->center[i])); // of the centre
        states->velocity[i] = himc_vec3_madd(states->velocity[i], h, a[i]);
        states->position[i] = himc_vec3_madd(states->position[i], h, states->velocity[i]);
        b->spin[i] = himc_vec3_madd(b->spin[i], h, alpha[i]);
        himc_vec3 w = himc_vec3_scale(b->spin[i], 0.5 * h);
        himc_quat q = b->orientation[i], dq = himc_quat_mul((himc_quat){0, w.x, w.y, w.z}, q);
        q = (himc_quat){q.w + dq.w, q.x + dq.x, q.y + dq.y, q.z + dq.z};
        b->orientation[i] = himc_quat_unit(q);
        b->rotation[i] = himc_mat3_from_quat(b->orientation[i]);
        himc_vec3 center = himc_mat3_apply(&b->rotation[i], skeleton->segment[i].center);
        b->origin[i] = himc_vec3_sub(states->position[i], center);
    }
}
