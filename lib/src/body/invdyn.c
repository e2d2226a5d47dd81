/// invdyn.c: recursive Newton-Euler for a tree of ball joints, in world coordinates.
///
/// Outwards: alpha_c = alpha_p + relative_c, a_c = a_p + alpha_p x r + w_p x (w_p x r) for each
/// joint; inwards: the force m (a_com - g) and moment I alpha + w x I w of each segment and the
/// forces and moments of its children give the moment that its joint must transmit. A joint has
/// three rotational freedoms, so its torque is a vector in the world frame, without axes. fwdyn.c
/// is the mirror: a test puts the torques of one into the other and gets the accelerations back.
#include "body/dynamics.h"

typedef struct motion {
    himc_vec3 angular, linear; // acceleration of the segment, and of its joint
    himc_vec3 force, moment;   // that its children need
} motion;

static inline himc_vec3 add_centripetal(himc_vec3 base, himc_vec3 alpha, himc_vec3 spin,
                                        himc_vec3 r)
{
    base = himc_vec3_add(base, himc_vec3_cross(alpha, r));
    return himc_vec3_add(base, himc_vec3_cross(spin, himc_vec3_cross(spin, r)));
}

// what a segment itself needs: a force, and a moment about its joint
static void find_own(const himc_skeleton *skeleton, const himc_body_state *s,
                     const himc_articulation *art, int i, const motion *m, himc_vec3 spin,
                     himc_vec3 *force, himc_vec3 *moment)
{
    const himc_segment *segment = &skeleton->segment[i];
    himc_vec3 c = art ? art->center[i] : himc_mat3_apply(&s->rotation[i], segment->center);
    himc_symmetric inertia =
        art ? art->inertia[i] : himc_world_tensor(&s->rotation[i], segment->inertia);
    himc_vec3 a = add_centripetal(m->linear, m->angular, spin, c);
    himc_vec3 l = himc_symmetric_apply(&inertia, spin);
    himc_vec3 rotational = himc_symmetric_apply(&inertia, m->angular);
    rotational = himc_vec3_add(rotational, himc_vec3_cross(spin, l));
    *force = himc_vec3_scale(a, segment->mass);
    *moment = himc_vec3_add(rotational, himc_vec3_cross(c, *force));
}

// of the segments before `end`
static void find_torques(const himc_skeleton *skeleton, const himc_body_state *s,
                         const himc_articulation *art, int end, const himc_vec3 *relative,
                         const himc_vec3 *spin, const himc_spatial *root,
                         himc_vec3 torque[HIMC_JOINTS], himc_spatial *needed)
{
    motion m[HIMC_SEGMENTS];
    himc_vec3 own, n;
    // outwards; gravity acts like an upward acceleration of the pelvis
    m[0] = (motion){.linear = {0, 0, HIMC_GRAVITY}};
    if (root) {
        m[0].angular = root->angular;
        m[0].linear = himc_vec3_add(m[0].linear, root->linear);
    }
    for (int i = 1; i < end; i++) {
        int p = skeleton->segment[i].parent;
        himc_vec3 r = himc_vec3_sub(s->origin[i], s->origin[p]);
        himc_vec3 linear = add_centripetal(m[p].linear, m[p].angular, spin[p], r);
        himc_vec3 angular = himc_vec3_add(m[p].angular, relative[i - 1]);
        m[i] = (motion){angular, linear, {0, 0, 0}, {0, 0, 0}};
    }
    // inwards
    for (int i = end - 1; i > 0; i--) {
        find_own(skeleton, s, art, i, &m[i], spin[i], &own, &n);
        himc_vec3 f = himc_vec3_add(m[i].force, own);
        int p = skeleton->segment[i].parent;
        motion *parent = &m[p];
        himc_vec3 r = himc_vec3_sub(s->origin[i], s->origin[p]);
        n = torque[i - 1] = himc_vec3_add(m[i].moment, n);
        parent->force = himc_vec3_add(parent->force, f);
        parent->moment = himc_vec3_add(parent->moment, himc_vec3_add(n, himc_vec3_cross(r, f)));
    }
    if (!needed)
        return;
    find_own(skeleton, s, art && art->first == 0 ? art : NULL, 0, &m[0], spin[0], &own, &n);
    *needed = (himc_spatial){himc_vec3_add(m[0].moment, n), himc_vec3_add(m[0].force, own)};
}

void himc_add_force(const himc_skeleton *skeleton, const himc_body_state *s, int segment,
                    himc_vec3 at, himc_vec3 force, himc_vec3 torque[HIMC_JOINTS])
{
    for (int i = segment; i > 0; i = skeleton->segment[i].parent)
        torque[i - 1] =
            himc_vec3_add(torque[i - 1], himc_vec3_cross(himc_vec3_sub(at, s->origin[i]), force));
}

void himc_inverse_dynamics(const himc_skeleton *skeleton, const himc_body_state *s,
                           const himc_vec3 *relative, bool still, himc_vec3 torque[HIMC_JOINTS])
{
    static const himc_vec3 none[HIMC_SEGMENTS];
    find_torques(skeleton, s, NULL, HIMC_SEGMENTS, relative ? relative : none,
                 still ? none : s->spin, NULL, torque, NULL);
}

void himc_inverse_dynamics_of(const himc_skeleton *skeleton, const himc_body_state *s,
                              const himc_articulation *art, const himc_vec3 *relative,
                              const himc_spatial *root, himc_vec3 torque[HIMC_JOINTS],
                              himc_spatial *needed)
{
    find_torques(skeleton, s, art, HIMC_SEGMENTS, relative, s->spin, root, torque, needed);
}

void himc_inverse_dynamics_upper(const himc_skeleton *skeleton, const himc_body_state *s,
                                 const himc_articulation *art, const himc_vec3 *relative,
                                 himc_vec3 torque[HIMC_JOINTS])
{
    find_torques(skeleton, s, art, HIMC_LEGS, relative, s->spin, NULL, torque, NULL);
}

// with the relative accelerations of the joints before segment `end`
static himc_vec3 tip_acceleration(const himc_skeleton *skeleton, const himc_body_state *s,
                                  himc_hand hand, const himc_vec3 *relative, int end,
                                  const himc_spatial *root)
{
    int chain[HIMC_SEGMENTS], count = 0;
    for (int i = himc_stick_segment(hand); i > 0; i = skeleton->segment[i].parent)
        chain[count++] = i;
    himc_vec3 alpha = {0, 0, 0}, a = {0, 0, 0};
    if (root) {
        alpha = root->angular;
        a = add_centripetal(root->linear, alpha, s->spin[0],
                            himc_vec3_sub(s->origin[chain[count - 1]], s->origin[0]));
    }
    while (count-- > 0) {
        int i = chain[count];
        himc_vec3 to = count > 0 ? s->origin[chain[count - 1]] : s->tip[hand];
        alpha = i < end ? himc_vec3_add(alpha, relative[i - 1]) : alpha;
        a = add_centripetal(a, alpha, s->spin[i], himc_vec3_sub(to, s->origin[i]));
    }
    return a;
}

himc_vec3 himc_tip_acceleration(const himc_skeleton *skeleton, const himc_body_state *s,
                                himc_hand hand, const himc_vec3 *relative, const himc_spatial *root)
{
    return tip_acceleration(skeleton, s, hand, relative, relative ? HIMC_SEGMENTS : 0, root);
}

himc_vec3 himc_tip_carried(const himc_skeleton *skeleton, const himc_body_state *s, himc_hand hand,
                           const himc_vec3 *relative, const himc_spatial *root)
{
    return tip_acceleration(skeleton, s, hand, relative, HIMC_LEFT_UPPER_ARM, root);
}
