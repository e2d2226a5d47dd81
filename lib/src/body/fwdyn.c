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

typedef struct bias {
    himc_vec3 moment, force; // n and p
} bias;

static himc_mat3 cross_matrix(himc_vec3 v)
{
    return (himc_mat3){{{0, -v.z, v.y}, {v.z, 0, -v.x}, {-v.y, v.x, 0}}};
}

static void add_to(himc_mat3 *a, const himc_mat3 *b, double scale)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            a->m[i][j] += scale * b->m[i][j];
}

// a b'
static himc_mat3 mul_transposed(const himc_mat3 *a, const himc_mat3 *b)
{
    himc_mat3 c;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            c.m[i][j] = a->m[i][0] * b->m[j][0] + a->m[i][1] * b->m[j][1] + a->m[i][2] * b->m[j][2];
    return c;
}

static himc_mat3 transpose(const himc_mat3 *a)
{
    himc_mat3 t;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            t.m[i][j] = a->m[j][i];
    return t;
}

// a' b
static himc_mat3 transposed_mul(const himc_mat3 *a, const himc_mat3 *b)
{
    himc_mat3 c;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            c.m[i][j] = a->m[0][i] * b->m[0][j] + a->m[1][i] * b->m[1][j] + a->m[2][i] * b->m[2][j];
    return c;
}

// a tensor given about a segment's axes, in the world frame
static himc_mat3 world_tensor(const himc_mat3 *rotation, himc_vec3 axes)
{
    himc_mat3 scaled = *rotation;
    for (int i = 0; i < 3; i++) {
        scaled.m[i][0] *= axes.x;
        scaled.m[i][1] *= axes.y;
        scaled.m[i][2] *= axes.z;
    }
    return mul_transposed(&scaled, rotation);
}

// a segment's own J, H and M about its joint
static void own_inertia(const himc_segment *segment, const himc_mat3 *rotation, himc_mat3 *j,
                        himc_mat3 *h, himc_mat3 *m)
{
    himc_vec3 c = himc_mat3_apply(rotation, segment->center);
    himc_mat3 cx = cross_matrix(c), steiner = mul_transposed(&cx, &cx);
    *j = world_tensor(rotation, segment->inertia);
    add_to(j, &steiner, segment->mass);
    *h = (himc_mat3){0};
    add_to(h, &cx, segment->mass);
    *m = (himc_mat3){{{segment->mass, 0, 0}, {0, segment->mass, 0}, {0, 0, segment->mass}}};
}

// the matrices of a joint that resists its acceleration; `j` becomes J + D
static void add_resistance(himc_articulation *art, int i, const himc_mat3 *d, const himc_mat3 *h,
                           himc_mat3 *j)
{
    add_to(j, d, 1);
    art->inverse[i] = himc_mat3_inverse_symmetric(j);
    art->resistance[i] = *d;
    art->transfer[i] = himc_mat3_mul(d, &art->inverse[i]);
    art->parent_coupling[i] = himc_mat3_mul(&art->transfer[i], h);
}

// adds E and G of segment `i`, moved to its parent's joint at -rx, to the parent's J and H
static void add_parent_moments(const himc_articulation *art, int i, const himc_mat3 *rx,
                               himc_mat3 *j, himc_mat3 *h)
{
    himc_mat3 e = himc_mat3_mul(&art->transfer[i], &art->resistance[i]);
    himc_mat3 moved = mul_transposed(&art->parent_coupling[i], rx), back = transpose(&moved);
    add_to(j, &art->resistance[i], 1);
    add_to(j, &e, -1);
    add_to(j, &moved, 1);
    add_to(j, &back, 1);
    add_to(h, &art->parent_coupling[i], 1);
}

static void articulate(const himc_skeleton *skeleton, const himc_body_state *s,
                       const himc_vec3 *resistance, himc_articulation *art)
{
    himc_mat3 j[HIMC_SEGMENTS], h[HIMC_SEGMENTS], m[HIMC_SEGMENTS];
    art->end = resistance ? HIMC_SEGMENTS : UPPER_END;
    art->resists = resistance;
    for (int i = 1; i < art->end; i++)
        own_inertia(&skeleton->segment[i], &s->rotation[i], &j[i], &h[i], &m[i]);
    for (int i = art->end - 1; i > 0; i--) {
        if (resistance) {
            himc_mat3 d = world_tensor(&s->rotation[i], resistance[i - 1]);
            add_resistance(art, i, &d, &h[i], &j[i]);
        } else {
            art->inverse[i] = himc_mat3_inverse_symmetric(&j[i]);
        }
        art->coupling[i] = h[i];
        himc_mat3 inverse_h = himc_mat3_mul(&art->inverse[i], &h[i]);
        himc_mat3 rotational = transposed_mul(&h[i], &inverse_h);
        art->mass[i] = m[i];
        add_to(&art->mass[i], &rotational, -1);
        int p = skeleton->segment[i].parent;
        if (p == HIMC_PELVIS)
            continue;
        himc_mat3 rx = cross_matrix(himc_vec3_sub(s->origin[i], s->origin[p]));
        himc_mat3 rx_a = himc_mat3_mul(&rx, &art->mass[i]), rx_a_rx = mul_transposed(&rx_a, &rx);
        add_to(&m[p], &art->mass[i], 1);
        add_to(&h[p], &rx_a, 1);
        add_to(&j[p], &rx_a_rx, 1);
        if (resistance)
            add_parent_moments(art, i, &rx, &j[p], &h[p]);
    }
}

void himc_articulate(const himc_skeleton *skeleton, const himc_body_state *s,
                     himc_articulation *art)
{
    articulate(skeleton, s, NULL, art);
}

void himc_articulate_resisting(const himc_skeleton *skeleton, const himc_body_state *s,
                               const himc_vec3 resistance[HIMC_JOINTS], himc_articulation *art)
{
    articulate(skeleton, s, resistance, art);
}

static himc_vec3 centripetal(himc_vec3 spin, himc_vec3 r)
{
    return himc_vec3_cross(spin, himc_vec3_cross(spin, r));
}

// n and p of a segment alone: gyroscopic moment, centripetal force, weight
static bias own_bias(const himc_segment *segment, const himc_mat3 *rotation, himc_vec3 spin)
{
    himc_vec3 c = himc_mat3_apply(rotation, segment->center);
    himc_vec3 local = himc_mat3_apply_transposed(rotation, spin);
    local = himc_vec3_make(local.x * segment->inertia.x, local.y * segment->inertia.y,
                           local.z * segment->inertia.z);
    bias b;
    b.force = centripetal(spin, c);
    b.force.z += HIMC_GRAVITY;
    b.force = himc_vec3_scale(b.force, segment->mass);
    b.moment = himc_vec3_cross(spin, himc_mat3_apply(rotation, local));
    b.moment = himc_vec3_add(b.moment, himc_vec3_cross(c, b.force));
    return b;
}

// inwards: the bias forces of each segment on its joint; `alpha_free` is its angular acceleration
// while the joint does not accelerate
static void sum_biases(const himc_skeleton *skeleton, const himc_body_state *s,
                       const himc_articulation *art, const himc_vec3 *torque, bias b[],
                       himc_vec3 alpha_free[])
{
    for (int i = art->end - 1; i > 0; i--) {
        int p = skeleton->segment[i].parent;
        b[i].moment = himc_vec3_sub(b[i].moment, torque[i - 1]);
        alpha_free[i] = himc_vec3_scale(himc_mat3_apply(&art->inverse[i], b[i].moment), -1);
        if (p == HIMC_PELVIS)
            continue;
        himc_vec3 r = himc_vec3_sub(s->origin[i], s->origin[p]);
        himc_vec3 force =
            himc_vec3_add(b[i].force, himc_mat3_apply_transposed(&art->coupling[i], alpha_free[i]));
        b[p].moment = himc_vec3_add(b[p].moment, torque[i - 1]);
        force = himc_vec3_add(force, himc_mat3_apply(&art->mass[i], centripetal(s->spin[p], r)));
        b[p].force = himc_vec3_add(b[p].force, force);
        b[p].moment = himc_vec3_add(b[p].moment, himc_vec3_cross(r, force));
        if (art->resists) {
            himc_vec3 rotational =
                himc_mat3_apply(&art->parent_coupling[i], centripetal(s->spin[p], r));
            rotational = himc_vec3_add(rotational, himc_mat3_apply(&art->transfer[i], b[i].moment));
            b[p].moment = himc_vec3_add(b[p].moment, rotational);
        }
    }
}

void himc_forward_dynamics(const himc_skeleton *skeleton, const himc_body_state *s,
                           const himc_articulation *art, const himc_vec3 *torque,
                           const himc_vec3 *tip_force, himc_vec3 relative[HIMC_JOINTS])
{
    bias b[HIMC_SEGMENTS];
    himc_vec3 alpha[HIMC_SEGMENTS], a[HIMC_SEGMENTS], zero = {0, 0, 0};
    alpha[0] = zero;
    for (int i = 1; i < art->end; i++)
        b[i] = own_bias(&skeleton->segment[i], &s->rotation[i], s->spin[i]);
    for (int hand = 0; tip_force && hand < HIMC_HANDS; hand++) {
        int stick = himc_stick_segment((himc_hand)hand);
        himc_vec3 r = himc_vec3_sub(s->tip[hand], s->origin[stick]);
        b[stick].force = himc_vec3_sub(b[stick].force, tip_force[hand]);
        b[stick].moment = himc_vec3_sub(b[stick].moment, himc_vec3_cross(r, tip_force[hand]));
    }
    sum_biases(skeleton, s, art, torque, b, alpha);
    for (int i = 1; i < art->end; i++) {
        int p = skeleton->segment[i].parent;
        himc_vec3 r = himc_vec3_sub(s->origin[i], s->origin[p]);
        a[i] = zero;
        if (p != HIMC_PELVIS) {
            a[i] = himc_vec3_add(a[p], himc_vec3_cross(alpha[p], r));
            a[i] = himc_vec3_add(a[i], centripetal(s->spin[p], r));
        }
        himc_vec3 coupled =
            himc_mat3_apply(&art->inverse[i], himc_mat3_apply(&art->coupling[i], a[i]));
        alpha[i] = himc_vec3_sub(alpha[i], coupled);
        if (art->resists) // K D alpha_p, K D being the transpose of D K
            alpha[i] =
                himc_vec3_add(alpha[i], himc_mat3_apply_transposed(&art->transfer[i], alpha[p]));
        relative[i - 1] = himc_vec3_sub(alpha[i], alpha[p]);
    }
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
        force = himc_vec3_sub(force, himc_mat3_apply_transposed(&art->coupling[i], alpha[i]));
        end = s->origin[i];
        chain[count++] = i;
    }
    himc_vec3 a = {0, 0, 0};
    while (count-- > 0) {
        int i = chain[count];
        himc_vec3 to = count > 0 ? s->origin[chain[count - 1]] : s->tip[hand];
        himc_vec3 coupled =
            himc_mat3_apply(&art->inverse[i], himc_mat3_apply(&art->coupling[i], a));
        himc_vec3 spin_rate = himc_vec3_sub(alpha[i], coupled);
        a = himc_vec3_add(a, himc_vec3_cross(spin_rate, himc_vec3_sub(to, s->origin[i])));
    }
    return 1 / himc_vec3_dot(n, a);
}
