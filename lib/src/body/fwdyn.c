/// fwdyn.c: articulated bodies joined by ball joints, in world coordinates.
///
/// For its parent, a segment on a ball joint is only a 3 x 3 mass matrix at the joint, since a ball
/// joint transmits a force and, here, a known torque. With J the rotational inertia about the
/// joint, H = m [c]x the moment for a unit acceleration of the joint and M the mass (each including
/// the children's mass matrices A_c, moved to this joint),
///     J alpha + H a = -n,   f = M a + H' alpha + p   =>   A = M - H' J^-1 H,   b = p - H' J^-1 n,
/// where n and p sum up centripetal terms, gravity, torques and forces (Featherstone 2008, chapter
/// 7, for joints with three rotational freedoms). The legs hang on the fixed pelvis, so the arms do
/// not act on them, and they are left out.
///
/// A joint that resists its own relative acceleration with D (alpha - alpha_p) (a servo integrated
/// implicitly, D = h Kd + h^2 Kp) transmits moments too. With K = (J + D)^-1
///     alpha = K (-n - H a + D alpha_p),
/// so the parent is subject, beside A and b, to the inertia E = D - D K D, the coupling G = D K H
/// and the moment D K n. Then all segments take part, since the legs have servos as well.
#include "body/dynamics.h"

#define UPPER_END HIMC_LEFT_UPPER_LEG // segments 1 .. UPPER_END - 1 are trunk, neck, head and arms

static himc_mat3 cross_matrix(himc_vec3 v)
{
    return (himc_mat3){{{0, -v.z, v.y}, {v.z, 0, -v.x}, {-v.y, v.x, 0}}};
}

static himc_vec3 row(const himc_mat3 *a, int i)
{
    return himc_vec3_make(a->m[i][0], a->m[i][1], a->m[i][2]);
}

static himc_vec3 column(const himc_mat3 *a, int i)
{
    return himc_vec3_make(a->m[0][i], a->m[1][i], a->m[2][i]);
}

// a += scale b
static void add_to(himc_mat3 *a, const himc_mat3 *b, double scale)
{
    double *to = a->m[0];
    const double *from = b->m[0];
    for (int i = 0; i < 9; i++)
        to[i] += scale * from[i];
}

// a b', if symmetric
static himc_mat3 symmetric_product(const himc_mat3 *a, const himc_mat3 *b)
{
    himc_vec3 x = row(a, 0), y = row(a, 1), u = row(b, 0), v = row(b, 1), w = row(b, 2);
    double xy = himc_vec3_dot(x, v), xz = himc_vec3_dot(x, w), yz = himc_vec3_dot(y, w);
    return (himc_mat3){{{himc_vec3_dot(x, u), xy, xz},
                        {xy, himc_vec3_dot(y, v), yz},
                        {xz, yz, himc_vec3_dot(row(a, 2), w)}}};
}

static himc_mat3 transpose(const himc_mat3 *a)
{
    return himc_mat3_from_axes(row(a, 0), row(a, 1), row(a, 2));
}

// [v]x a
static himc_mat3 cross_columns(himc_vec3 v, const himc_mat3 *a)
{
    return himc_mat3_from_axes(himc_vec3_cross(v, column(a, 0)), himc_vec3_cross(v, column(a, 1)),
                               himc_vec3_cross(v, column(a, 2)));
}

// a b, column by column
static himc_mat3 product(const himc_mat3 *a, const himc_mat3 *b)
{
    return himc_mat3_from_axes(himc_mat3_apply(a, column(b, 0)), himc_mat3_apply(a, column(b, 1)),
                               himc_mat3_apply(a, column(b, 2)));
}

// a tensor given about a segment's axes, in the world frame
static himc_mat3 world_tensor(const himc_mat3 *rotation, himc_vec3 axes)
{
    himc_mat3 scaled = himc_mat3_from_axes(himc_vec3_scale(column(rotation, 0), axes.x),
                                           himc_vec3_scale(column(rotation, 1), axes.y),
                                           himc_vec3_scale(column(rotation, 2), axes.z));
    return symmetric_product(&scaled, rotation);
}

// J, H and M of a segment and, later, of its children
typedef struct block {
    himc_mat3 j, h, m;
} block;

// a segment's own, with its place in the world
static void place_segment(const himc_skeleton *skeleton, const himc_body_state *s, int i,
                          himc_articulation *art, block *own)
{
    const himc_segment *segment = &skeleton->segment[i];
    const himc_mat3 *rotation = &s->rotation[i];
    himc_vec3 c = himc_mat3_apply(rotation, segment->center);
    double m = segment->mass;
    himc_mat3 cx = cross_matrix(c), steiner = cross_columns(himc_vec3_scale(c, -m), &cx);
    art->center[i] = c;
    art->lever[i] = himc_mat3_apply(&s->rotation[segment->parent], segment->origin);
    art->inertia[i] = world_tensor(rotation, segment->inertia);
    own->j = art->inertia[i];
    add_to(&own->j, &steiner, 1);
    own->h = cross_matrix(himc_vec3_scale(c, m));
    own->m = (himc_mat3){{{m, 0, 0}, {0, m, 0}, {0, 0, m}}};
}

// the matrices of a joint that resists its acceleration; J becomes J + D
static void add_resistance(himc_articulation *art, int i, const himc_mat3 *d, block *own)
{
    add_to(&own->j, d, 1);
    art->inverse[i] = himc_mat3_inverse_symmetric(&own->j);
    art->resistance[i] = *d;
    art->transfer[i] = himc_mat3_mul(d, &art->inverse[i]);
    art->parent_coupling[i] = himc_mat3_mul(&art->transfer[i], &own->h);
}

// adds E and G of segment `i`, moved to its parent's joint, to the parent's J and H
static void add_parent_moments(const himc_articulation *art, int i, block *parent)
{
    himc_mat3 e = himc_mat3_mul(&art->transfer[i], &art->resistance[i]);
    himc_mat3 g = transpose(&art->parent_coupling[i]);
    himc_mat3 back = cross_columns(art->lever[i], &g), moved = transpose(&back);
    add_to(&parent->j, &art->resistance[i], 1);
    add_to(&parent->j, &e, -1);
    add_to(&parent->j, &moved, 1);
    add_to(&parent->j, &back, 1);
    add_to(&parent->h, &art->parent_coupling[i], 1);
}

// what a segment with its children is for its parent: J^-1 H and A = M - H' J^-1 H
static void eliminate(himc_articulation *art, int i, const block *own)
{
    himc_mat3 ht = transpose(&own->h), kt;
    art->response[i] = product(&art->inverse[i], &own->h);
    kt = transpose(&art->response[i]);
    kt = symmetric_product(&ht, &kt);
    art->mass[i] = own->m;
    add_to(&art->mass[i], &kt, -1);
}

// adds A, moved to the parent's joint
static void add_to_parent(const himc_articulation *art, int i, block *parent)
{
    himc_vec3 r = art->lever[i];
    himc_mat3 ra = cross_columns(r, &art->mass[i]), rat = transpose(&ra);
    himc_mat3 rar = cross_columns(r, &rat); // r A r' is symmetric
    add_to(&parent->m, &art->mass[i], 1);
    add_to(&parent->h, &ra, 1);
    add_to(&parent->j, &rar, 1);
}

static void articulate(const himc_skeleton *skeleton, const himc_body_state *s, int end,
                       const himc_vec3 *resistance, himc_articulation *art)
{
    block own[HIMC_SEGMENTS];
    art->end = end;
    art->resists = resistance;
    for (int i = 1; i < end; i++)
        place_segment(skeleton, s, i, art, &own[i]);
    for (int i = end - 1; i > 0; i--) {
        int p = skeleton->segment[i].parent;
        if (resistance) {
            himc_mat3 d = world_tensor(&s->rotation[i], resistance[i - 1]);
            add_resistance(art, i, &d, &own[i]);
        } else {
            art->inverse[i] = himc_mat3_inverse_symmetric(&own[i].j);
        }
        eliminate(art, i, &own[i]);
        if (p == HIMC_PELVIS)
            continue;
        add_to_parent(art, i, &own[p]);
        if (resistance)
            add_parent_moments(art, i, &own[p]);
    }
}

void himc_articulate(const himc_skeleton *skeleton, const himc_body_state *s,
                     himc_articulation *art)
{
    articulate(skeleton, s, UPPER_END, NULL, art);
}

void himc_articulate_all(const himc_skeleton *skeleton, const himc_body_state *s,
                         himc_articulation *art)
{
    articulate(skeleton, s, HIMC_SEGMENTS, NULL, art);
}

void himc_articulate_resisting(const himc_skeleton *skeleton, const himc_body_state *s,
                               const himc_vec3 resistance[HIMC_JOINTS], himc_articulation *art)
{
    articulate(skeleton, s, HIMC_SEGMENTS, resistance, art);
}

// inwards: n and p of all segments further out; alpha is that of a joint at rest
static void sum_loads(const himc_skeleton *skeleton, const himc_articulation *art,
                      tree_load load[HIMC_SEGMENTS], himc_vec3 alpha[HIMC_SEGMENTS])
{
    for (int i = art->end - 1; i > 0; i--) {
        int p = skeleton->segment[i].parent;
        himc_vec3 n = load[i].moment, gap = load[i].gap;
        alpha[i] = himc_vec3_scale(himc_mat3_apply(&art->inverse[i], n), -1);
        if (p == HIMC_PELVIS)
            continue;
        himc_vec3 force = himc_vec3_add(load[i].force, himc_mat3_apply(&art->mass[i], gap));
        force = himc_vec3_sub(force, himc_mat3_apply_transposed(&art->response[i], n));
        load[p].force = himc_vec3_add(load[p].force, force);
        load[p].moment = himc_vec3_add(load[p].moment, himc_vec3_cross(art->lever[i], force));
        if (art->resists) {
            himc_vec3 rotational = himc_mat3_apply(&art->parent_coupling[i], gap);
            rotational = himc_vec3_add(rotational, himc_mat3_apply(&art->transfer[i], n));
            load[p].moment = himc_vec3_add(load[p].moment, rotational);
        }
    }
}

void himc_articulation_solve(const himc_skeleton *skeleton, const himc_articulation *art,
                             tree_load load[HIMC_SEGMENTS], himc_vec3 alpha[HIMC_SEGMENTS],
                             himc_vec3 a[HIMC_SEGMENTS])
{
    alpha[0] = a[0] = himc_vec3_make(0, 0, 0);
    sum_loads(skeleton, art, load, alpha);
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

// a segment alone: gyroscopic moment, centripetal force, weight, and its joint's centripetal
// acceleration
static tree_load own_load(const himc_skeleton *skeleton, const himc_articulation *art,
                          const himc_vec3 *spin, int i)
{
    const himc_segment *segment = &skeleton->segment[i];
    tree_load own = {.force = centripetal(spin[i], art->center[i]),
                     .gap = centripetal(spin[segment->parent], art->lever[i])};
    own.force.z += HIMC_GRAVITY;
    own.force = himc_vec3_scale(own.force, segment->mass);
    own.moment = himc_vec3_cross(spin[i], himc_mat3_apply(&art->inertia[i], spin[i]));
    own.moment = himc_vec3_add(own.moment, himc_vec3_cross(art->center[i], own.force));
    return own;
}

void himc_forward_dynamics(const himc_skeleton *skeleton, const himc_body_state *s,
                           const himc_articulation *art, const himc_vec3 *torque,
                           const himc_vec3 *tip_force, himc_vec3 relative[HIMC_JOINTS])
{
    tree_load load[HIMC_SEGMENTS];
    himc_vec3 alpha[HIMC_SEGMENTS], a[HIMC_SEGMENTS];
    load[0] = (tree_load){.gap = {0, 0, 0}};
    for (int i = 1; i < art->end; i++) {
        tree_load *parent = &load[skeleton->segment[i].parent];
        load[i] = own_load(skeleton, art, s->spin, i);
        load[i].moment = himc_vec3_sub(load[i].moment, torque[i - 1]);
        parent->moment = himc_vec3_add(parent->moment, torque[i - 1]);
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
        alpha[i] = himc_mat3_apply(&art->inverse[i], moment);
        force = himc_vec3_sub(force, himc_mat3_apply_transposed(&art->response[i], moment));
        end = s->origin[i];
        chain[count++] = i;
    }
    himc_vec3 a = {0, 0, 0};
    while (count-- > 0) {
        int i = chain[count];
        himc_vec3 to = count > 0 ? s->origin[chain[count - 1]] : s->tip[hand];
        himc_vec3 spin_rate = himc_vec3_sub(alpha[i], himc_mat3_apply(&art->response[i], a));
        a = himc_vec3_add(a, himc_vec3_cross(spin_rate, himc_vec3_sub(to, s->origin[i])));
    }
    return 1 / himc_vec3_dot(n, a);
}
