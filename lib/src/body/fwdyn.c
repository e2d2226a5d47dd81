/// fwdyn.c: articulated bodies joined by ball joints, in world coordinates.
///
/// For its parent, a segment on a ball joint is only a 3 x 3 mass matrix at the joint, since a ball
/// joint transmits a force and, here, a known torque. With J the rotational inertia about the
/// joint, H = m [c]x the moment for a unit acceleration of the joint and M the mass (each including
/// the children's mass matrices A_c, moved to this joint),
///     J alpha + H a = -n,   f = M a + H' alpha + p   =>   A = M - H' J^-1 H,   b = p - H' J^-1 n,
/// where n and p sum up centripetal terms, gravity, torques and forces (Featherstone 2008, chapter
/// 7, for joints with three rotational freedoms); J^-1 H is called the response.
///
/// A joint that resists its own relative acceleration with D (alpha - alpha_p) (a servo integrated
/// implicitly, D = h Kd + h^2 Kp) transmits moments too. With K = (J + D)^-1
///     alpha = K (-n - H a + D alpha_p),
/// so the parent is subject, beside A and b, to the inertia E = D - D K D, the coupling G = D K H
/// and the moment D K n.
///
/// A pelvis that is free has the same J, H, M, n and p, and no parent that needs a force: f = 0, so
///     a = -A^-1 b,   alpha = -J^-1 (n + H a).
#include "body/dynamics.h"

static himc_vec3 column(const himc_mat3 *a, int i)
{
    return himc_vec3_make(a->m[0][i], a->m[1][i], a->m[2][i]);
}

// a += scale b
static void add_to(himc_mat3 *a, const himc_mat3 *b, double scale)
{
    for (int i = 0; i < 3; i++) {
        a->m[i][0] += scale * b->m[i][0];
        a->m[i][1] += scale * b->m[i][1];
        a->m[i][2] += scale * b->m[i][2];
    }
}

static himc_mat3 transpose(const himc_mat3 *a)
{
    return himc_mat3_from_axes(himc_vec3_make(a->m[0][0], a->m[0][1], a->m[0][2]),
                               himc_vec3_make(a->m[1][0], a->m[1][1], a->m[1][2]),
                               himc_vec3_make(a->m[2][0], a->m[2][1], a->m[2][2]));
}

static himc_mat3 full(const himc_symmetric *a)
{
    return (himc_mat3){{{a->xx, a->xy, a->xz}, {a->xy, a->yy, a->yz}, {a->xz, a->yz, a->zz}}};
}

static himc_symmetric sum(const himc_symmetric *a, const himc_symmetric *b)
{
    return (himc_symmetric){a->xx + b->xx, a->xy + b->xy, a->xz + b->xz,
                            a->yy + b->yy, a->yz + b->yz, a->zz + b->zz};
}

// J, H and M of a segment and, later, of its children
typedef struct block {
    himc_symmetric j, m;
    himc_mat3 h;
} block;

// a segment's own, with its place in the world
static void place_segment(const himc_skeleton *skeleton, const himc_body_state *s, int i,
                          himc_articulation *art, block *own)
{
    const himc_segment *segment = &skeleton->segment[i];
    double m = segment->mass;
    himc_vec3 c = himc_mat3_apply(&s->rotation[i], segment->center), mc = himc_vec3_scale(c, m);
    double steiner = himc_vec3_dot(c, mc);
    art->center[i] = c;
    if (segment->parent >= 0)
        art->lever[i] = himc_mat3_apply(&s->rotation[segment->parent], segment->origin);
    art->inertia[i] = own->j = himc_world_tensor(&s->rotation[i], segment->inertia);
    own->j.xx += steiner;
    own->j.yy += steiner;
    own->j.zz += steiner;
    himc_add_square(&own->j, -m, c);
    own->h = (himc_mat3){{{0, -mc.z, mc.y}, {mc.z, 0, -mc.x}, {-mc.y, mc.x, 0}}};
    own->m = (himc_symmetric){.xx = m, .yy = m, .zz = m};
}

// adds E and G of segment `i`, moved to its parent's joint, to the parent's J and H
static void add_parent_moments(const himc_articulation *art, int i, block *parent)
{
    himc_mat3 e = himc_mat3_mul(&art->transfer[i], &art->resistance[i]);
    himc_mat3 g = transpose(&art->parent_coupling[i]), all = art->resistance[i];
    himc_vec3 r = art->lever[i]; // back is [r]x g
    himc_mat3 back = himc_mat3_from_axes(himc_vec3_cross(r, column(&g, 0)),
                                         himc_vec3_cross(r, column(&g, 1)),
                                         himc_vec3_cross(r, column(&g, 2))),
              moved = transpose(&back);
    add_to(&all, &e, -1);
    add_to(&all, &moved, 1);
    add_to(&all, &back, 1);
    himc_symmetric j = {all.m[0][0], all.m[0][1], all.m[0][2],
                        all.m[1][1], all.m[1][2], all.m[2][2]};
    parent->j = sum(&parent->j, &j);
    add_to(&parent->h, &art->parent_coupling[i], 1);
}

// what a segment with its children is for its parent: J^-1 H and A = M - H' J^-1 H
static void eliminate(himc_articulation *art, int i, const block *own)
{
    himc_vec3 h0 = column(&own->h, 0), h1 = column(&own->h, 1), h2 = column(&own->h, 2);
    const himc_symmetric *k = &art->inverse[i], *m = &own->m;
    himc_vec3 k0 = himc_symmetric_apply(k, h0), k1 = himc_symmetric_apply(k, h1);
    himc_vec3 k2 = himc_symmetric_apply(k, h2);
    art->response[i] = himc_mat3_from_axes(k0, k1, k2);
    art->mass[i] = (himc_symmetric){m->xx - himc_vec3_dot(h0, k0), m->xy - himc_vec3_dot(h0, k1),
                                    m->xz - himc_vec3_dot(h0, k2), m->yy - himc_vec3_dot(h1, k1),
                                    m->yz - himc_vec3_dot(h1, k2), m->zz - himc_vec3_dot(h2, k2)};
}

// adds A, moved to the parent's joint: M += A, H += [r]x A, J += [r]x A [r]x'
static void add_to_parent(const himc_articulation *art, int i, block *parent)
{
    himc_vec3 r = art->lever[i];
    const himc_symmetric *a = &art->mass[i];
    himc_mat3 ra = himc_mat3_from_axes(himc_vec3_cross(r, himc_vec3_make(a->xx, a->xy, a->xz)),
                                       himc_vec3_cross(r, himc_vec3_make(a->xy, a->yy, a->yz)),
                                       himc_vec3_cross(r, himc_vec3_make(a->xz, a->yz, a->zz)));
    const double *x = ra.m[0], *y = ra.m[1], *z = ra.m[2]; // its rows, times [r]x' from the right
    himc_symmetric rar = {r.y * x[2] - r.z * x[1], r.z * x[0] - r.x * x[2],
                          r.x * x[1] - r.y * x[0], r.z * y[0] - r.x * y[2],
                          r.x * y[1] - r.y * y[0], r.x * z[1] - r.y * z[0]};
    parent->m = sum(&parent->m, a);
    parent->j = sum(&parent->j, &rar);
    add_to(&parent->h, &ra, 1);
}

static void articulate(const himc_skeleton *skeleton, const himc_body_state *s, int end,
                       const himc_vec3 *resistance, himc_articulation *art)
{
    block own[HIMC_SEGMENTS];
    art->first = himc_first_moving(skeleton);
    art->end = end;
    art->resists = resistance;
    for (int i = art->first; i < end; i++)
        place_segment(skeleton, s, i, art, &own[i]);
    for (int i = end - 1; i > 0; i--) {
        int p = skeleton->segment[i].parent;
        if (resistance) { // J becomes J + D
            himc_symmetric d = himc_world_tensor(&s->rotation[i], resistance[i - 1]);
            own[i].j = sum(&own[i].j, &d);
            art->resistance[i] = full(&d);
        }
        art->inverse[i] = himc_symmetric_inverse(&own[i].j);
        if (resistance) { // D K and G
            himc_mat3 k = full(&art->inverse[i]);
            art->transfer[i] = himc_mat3_mul(&art->resistance[i], &k);
            art->parent_coupling[i] = himc_mat3_mul(&art->transfer[i], &own[i].h);
        }
        eliminate(art, i, &own[i]);
        if (skeleton->segment[p].joint == HIMC_JOINT_FIXED)
            continue;
        add_to_parent(art, i, &own[p]);
        if (resistance)
            add_parent_moments(art, i, &own[p]);
    }
    if (art->first > 0)
        return;
    art->inverse[0] = himc_symmetric_inverse(&own[0].j);
    eliminate(art, 0, &own[0]);
    art->root = himc_symmetric_inverse(&art->mass[0]);
}

void himc_articulate(const himc_skeleton *skeleton, const himc_body_state *s,
                     himc_articulation *art)
{
    articulate(skeleton, s, HIMC_SEGMENTS, NULL, art);
}

void himc_articulate_upper(const himc_skeleton *skeleton, const himc_body_state *s,
                           himc_articulation *art)
{
    articulate(skeleton, s, HIMC_LEGS, NULL, art);
}

void himc_articulate_resisting(const himc_skeleton *skeleton, const himc_body_state *s,
                               const himc_vec3 resistance[HIMC_JOINTS], himc_articulation *art)
{
    articulate(skeleton, s, HIMC_SEGMENTS, resistance, art);
}

void himc_articulation_solve(const himc_skeleton *skeleton, const himc_articulation *art,
                             tree_load load[HIMC_SEGMENTS], himc_vec3 alpha[HIMC_SEGMENTS],
                             himc_vec3 a[HIMC_SEGMENTS])
{
    alpha[0] = a[0] = himc_vec3_make(0, 0, 0);
    // inwards: n and p of all segments further out; alpha is that of a joint at rest
    for (int i = art->end - 1; i > 0; i--) {
        int p = skeleton->segment[i].parent;
        himc_vec3 n = load[i].moment, gap = load[i].gap;
        alpha[i] = himc_vec3_scale(himc_symmetric_apply(&art->inverse[i], n), -1);
        if (skeleton->segment[p].joint == HIMC_JOINT_FIXED)
            continue;
        himc_vec3 force = himc_vec3_add(load[i].force, himc_symmetric_apply(&art->mass[i], gap));
        force = himc_vec3_sub(force, himc_mat3_apply_transposed(&art->response[i], n));
        load[p].force = himc_vec3_add(load[p].force, force);
        load[p].moment = himc_vec3_add(load[p].moment, himc_vec3_cross(art->lever[i], force));
        if (art->resists) {
            himc_vec3 rotational = himc_mat3_apply(&art->parent_coupling[i], gap);
            rotational = himc_vec3_add(rotational, himc_mat3_apply(&art->transfer[i], n));
            load[p].moment = himc_vec3_add(load[p].moment, rotational);
        }
    }
    if (art->first == 0) {
        himc_vec3 b = himc_vec3_sub(load[0].force,
                                    himc_mat3_apply_transposed(&art->response[0], load[0].moment));
        a[0] = himc_vec3_scale(himc_symmetric_apply(&art->root, b), -1);
        alpha[0] = himc_vec3_scale(himc_symmetric_apply(&art->inverse[0], load[0].moment), -1);
        alpha[0] = himc_vec3_sub(alpha[0], himc_mat3_apply(&art->response[0], a[0]));
    }
    // outwards
    for (int i = 1; i < art->end; i++) {
        int p = skeleton->segment[i].parent;
        a[i] = himc_vec3_add(a[p], himc_vec3_cross(alpha[p], art->lever[i]));
        a[i] = himc_vec3_add(a[i], load[i].gap);
        alpha[i] = himc_vec3_sub(alpha[i], himc_mat3_apply(&art->response[i], a[i]));
        if (art->resists) // K D alpha_p, K D being the transpose of D K
            alpha[i] =
                himc_vec3_add(alpha[i], himc_mat3_apply_transposed(&art->transfer[i], alpha[p]));
    }
}

static himc_vec3 centripetal(himc_vec3 spin, himc_vec3 r)
{
    return himc_vec3_cross(spin, himc_vec3_cross(spin, r));
}

void himc_forward_dynamics(const himc_skeleton *skeleton, const himc_body_state *s,
                           const himc_articulation *art, const himc_vec3 *torque,
                           const himc_vec3 *tip_force, himc_vec3 relative[HIMC_JOINTS])
{
    himc_forward_dynamics_of(skeleton, s, art, torque, tip_force, NULL, relative, NULL);
}

void himc_forward_dynamics_of(const himc_skeleton *skeleton, const himc_body_state *s,
                              const himc_articulation *art, const himc_vec3 *torque,
                              const himc_vec3 *tip_force, const himc_spatial *wrench,
                              himc_vec3 relative[HIMC_JOINTS], himc_spatial *root)
{
    tree_load load[HIMC_SEGMENTS];
    himc_vec3 alpha[HIMC_SEGMENTS], a[HIMC_SEGMENTS];
    load[0] = (tree_load){.gap = {0, 0, 0}};
    for (int i = art->first; i < art->end; i++) {
        const himc_segment *segment = &skeleton->segment[i];
        himc_vec3 spin = s->spin[i];
        load[i].force = centripetal(spin, art->center[i]);
        load[i].force.z += HIMC_GRAVITY;
        load[i].force = himc_vec3_scale(load[i].force, segment->mass);
        load[i].moment = himc_vec3_cross(spin, himc_symmetric_apply(&art->inertia[i], spin));
        load[i].moment =
            himc_vec3_add(load[i].moment, himc_vec3_cross(art->center[i], load[i].force));
        if (i == 0)
            continue;
        tree_load *parent = &load[segment->parent];
        load[i].gap = centripetal(s->spin[segment->parent], art->lever[i]);
        load[i].moment = himc_vec3_sub(load[i].moment, torque[i - 1]);
        parent->moment = himc_vec3_add(parent->moment, torque[i - 1]);
    }
    if (wrench) {
        load[0].force = himc_vec3_sub(load[0].force, wrench->linear);
        load[0].moment = himc_vec3_sub(load[0].moment, wrench->angular);
    }
    for (int hand = 0; tip_force && hand < HIMC_HANDS; hand++) {
        int stick = himc_stick_segment((himc_hand)hand);
        himc_vec3 r = himc_vec3_sub(s->tip[hand], s->origin[stick]);
        load[stick].force = himc_vec3_sub(load[stick].force, tip_force[hand]);
        load[stick].moment = himc_vec3_sub(load[stick].moment, himc_vec3_cross(r, tip_force[hand]));
    }
    himc_articulation_solve(skeleton, art, load, alpha, a);
    for (int i = 1; i < art->end; i++)
        relative[i - 1] = himc_vec3_sub(alpha[i], alpha[skeleton->segment[i].parent]);
    if (root)
        *root = (himc_spatial){alpha[0], a[0]};
}

// the acceleration of the arm's chain under a unit force alone: the same sweep without other forces
double himc_effective_mass(const himc_skeleton *skeleton, const himc_body_state *s,
                           const himc_articulation *art, himc_hand hand, himc_vec3 n)
{
    int chain[HIMC_SEGMENTS], count = 0;
    himc_vec3 alpha[HIMC_SEGMENTS], force = n, end = s->tip[hand], moment = {0, 0, 0};
    for (int i = himc_stick_segment(hand); i > 0; i = skeleton->segment[i].parent) {
        // `force` acts at `end` and rotates the segment about its joint; the rest acts on the
        // parent
        moment = himc_vec3_cross(himc_vec3_sub(end, s->origin[i]), force);
        alpha[i] = himc_symmetric_apply(&art->inverse[i], moment);
        force = himc_vec3_sub(force, himc_mat3_apply_transposed(&art->response[i], moment));
        end = s->origin[i];
        chain[count++] = i;
    }
    himc_vec3 a = {0, 0, 0};
    if (art->first == 0) { // `force` acts at `end` on the pelvis
        himc_vec3 arm = himc_vec3_sub(end, s->origin[0]), about = himc_vec3_cross(arm, force);
        a = himc_symmetric_apply(
            &art->root, himc_vec3_sub(force, himc_mat3_apply_transposed(&art->response[0], about)));
        himc_vec3 turned = himc_vec3_sub(himc_symmetric_apply(&art->inverse[0], about),
                                         himc_mat3_apply(&art->response[0], a));
        a = himc_vec3_add(a, himc_vec3_cross(turned, arm));
    }
    while (count-- > 0) {
        int i = chain[count];
        himc_vec3 to = count > 0 ? s->origin[chain[count - 1]] : s->tip[hand];
        himc_vec3 spin_rate = himc_vec3_sub(alpha[i], himc_mat3_apply(&art->response[i], a));
        a = himc_vec3_add(a, himc_vec3_cross(spin_rate, himc_vec3_sub(to, s->origin[i])));
    }
    return 1 / himc_vec3_dot(n, a);
}
