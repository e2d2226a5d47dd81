/// energy.c: the work of a step in the form that is exact for the integrator of tree.c and of ODE.
///
/// A step solves M (v+ - v) = h F with the inertias M and the levers of its beginning, then moves
/// the segments by v+. With the mean velocity u = (v + v+) / 2
///     v+' M v+ / 2 - v' M v / 2 = u' M (v+ - v) = h u' F,
/// and the turn that follows has the axis w+, so it changes the inertia about the world's axes but
/// not the kinetic energy. So each force has the work h u' F, with u at the point where it acts:
///     joint torque  h t . (u_child - u_parent),  contact with the world  h f . u.
/// What remains is the integrator's own, `numerical`:
///     weight   the fall in the step is h v+, not h u: h m g (v+ - v) / 2 upwards, whose sum over a
///              motion between two rests is 0;
///     joints   the levers are those of the step's beginning, so the two ends of a joint part with
///     a
///              mean velocity of h w (w c) / 2; the force in the joint does work on it;
///     spin     the gyroscopic moment (tree.h) is implicit and takes energy.
/// The force in a joint is what accelerates all segments beyond it, less the other forces on them.
/// The moments' equation is not used, so the balance tests it.
///
/// The world holds the pelvis with the change of momentum less the weights and the contacts,
///     h F = sum of m (v+ - v - h g) - h sum of f
/// (seat and floor hold one that is free: contacts that support it are not subtracted),
/// and, about the midpoint of the hip joints, with the moments of these and each segment's
/// I (w+ - w) less h times its gyroscopic moment. x+ = x + h v+, so the sums of h F are exact. A
/// single F is not: steps of 4 and 5 samples in turn close gaps by turns faster and slower.
#include "body/energy.h"

#include "base/rotations.h"

typedef struct step {
    const himc_skeleton *skeleton;
    const himc_articulation *art;
    const segment_states *before, *after;
    himc_vec3 spin[HIMC_SEGMENTS];     // mean over the step (rad/s)
    himc_vec3 velocity[HIMC_SEGMENTS]; // mean, of the centre of mass (m/s)
    himc_vec3 force[HIMC_SEGMENTS];    // on the centre of mass, without weight and joints (N)
    himc_vec3 origin[HIMC_SEGMENTS];   // joint, from that of the pelvis (m)
    double h;
} step;

static himc_vec3 mean(himc_vec3 a, himc_vec3 b)
{
    return himc_vec3_scale(himc_vec3_add(a, b), 0.5);
}

// mean velocity of the point of segment i that is `r` from its joint
static himc_vec3 point_velocity(const step *s, int i, himc_vec3 r)
{
    if (i < s->art->first)
        return himc_vec3_make(0, 0, 0);
    himc_vec3 from_center = himc_vec3_sub(r, s->art->center[i]);
    return himc_vec3_add(s->velocity[i], himc_vec3_cross(s->spin[i], from_center));
}

// power that the step gives by itself, at segment i; `joint` has the forces in the joints beyond
static double numerical_power(const step *s, int i, himc_vec3 joint[HIMC_SEGMENTS])
{
    const himc_segment *segment = &s->skeleton->segment[i];
    int p = segment->parent;
    himc_vec3 gained = himc_vec3_sub(s->after->velocity[i], s->before->velocity[i]);
    himc_vec3 needed = himc_vec3_scale(gained, segment->mass / s->h);
    needed.z += segment->mass * HIMC_GRAVITY;
    himc_vec3 parting = {0, 0, 0};
    joint[i] = himc_vec3_add(joint[i], himc_vec3_sub(needed, s->force[i]));
    if (p >= 0) {
        joint[p] = himc_vec3_add(joint[p], joint[i]);
        himc_vec3 here = point_velocity(s, i, himc_vec3_make(0, 0, 0));
        parting = himc_vec3_sub(here, point_velocity(s, p, s->art->lever[i]));
    }
    himc_vec3 moment = himc_gyroscopic_moment(&s->art->inertia[i], segment->inertia,
                                              s->before->joints.spin[i], s->h);
    return himc_vec3_dot(joint[i], parting) + himc_vec3_dot(s->spin[i], moment) +
           0.5 * segment->mass * HIMC_GRAVITY * gained.z;
}

// adds an impulse at a place from the pelvis' joint to those on the pelvis
static void add_to_root(himc_body_work *work, himc_vec3 at, himc_vec3 impulse)
{
    work->root_impulse = himc_vec3_add(work->root_impulse, impulse);
    work->root_angular = himc_vec3_add(work->root_angular, himc_vec3_cross(at, impulse));
}

// what holds and moves each segment in the step; those that do not take part are at rest
static void find_root(himc_body_work *work, step *s)
{
    const himc_segment *segment = s->skeleton->segment;
    work->root_seconds += s->h;
    for (int i = 0; i < HIMC_SEGMENTS; i++) {
        himc_vec3 gained = {0, 0, 0},
                  center = i < s->art->first ? segment[i].center : s->art->center[i];
        if (i > 0)
            s->origin[i] = himc_vec3_add(s->origin[segment[i].parent], s->art->lever[i]);
        if (i >= s->art->first && i < s->art->end) {
            himc_vec3 spin = s->before->joints.spin[i];
            himc_vec3 turned = himc_vec3_sub(s->after->joints.spin[i], spin);
            himc_vec3 moment =
                himc_gyroscopic_moment(&s->art->inertia[i], segment[i].inertia, spin, s->h);
            turned = himc_symmetric_apply(&s->art->inertia[i], turned);
            turned = himc_vec3_madd(turned, -s->h, moment);
            work->root_angular = himc_vec3_add(work->root_angular, turned);
            gained = himc_vec3_sub(s->after->velocity[i], s->before->velocity[i]);
        }
        gained.z += s->h * HIMC_GRAVITY;
        add_to_root(work, himc_vec3_add(s->origin[i], center),
                    himc_vec3_scale(gained, segment[i].mass));
    }
}

void himc_body_work_add(himc_body_work *work, const himc_skeleton *skeleton,
                        const himc_articulation *art, const himc_step_forces *forces,
                        const segment_states *before, const segment_states *after, double h)
{
    step s = {.skeleton = skeleton, .art = art, .before = before, .after = after, .h = h};
    himc_vec3 joint[HIMC_SEGMENTS] = {{0, 0, 0}};
    for (int i = art->first; i < art->end; i++) {
        s.spin[i] = mean(before->joints.spin[i], after->joints.spin[i]);
        s.velocity[i] = mean(before->velocity[i], after->velocity[i]);
    }
    for (int k = 0; k < forces->contacts; k++) {
        const world_contact *c = &forces->contact[k];
        s.force[c->segment] = himc_vec3_add(s.force[c->segment], c->force);
        if (c->supports) {
            himc_vec3 *sum = c->segment >= HIMC_LEFT_FOOT
                                 ? &work->foot_impulse[c->segment - HIMC_LEFT_FOOT]
                                 : &work->seat_impulse;
            *sum = himc_vec3_madd(*sum, h, c->force);
        }
    }
    find_root(work, &s);
    for (int i = art->end - 1; i >= art->first; i--) {
        if (i > 0) {
            himc_vec3 relative = himc_vec3_sub(s.spin[i], s.spin[skeleton->segment[i].parent]);
            work->joint[i - 1] += h * himc_vec3_dot(forces->torque[i - 1], relative);
        }
        work->numerical += h * numerical_power(&s, i, joint);
    }
    for (int k = 0; k < forces->contacts; k++) {
        const world_contact *c = &forces->contact[k];
        himc_vec3 at = himc_mat3_apply(&before->joints.rotation[c->segment], c->at);
        if (!c->supports)
            add_to_root(work, himc_vec3_add(s.origin[c->segment], at),
                        himc_vec3_scale(c->force, -h));
        if (c->work)
            *c->work += h * himc_vec3_dot(c->force, point_velocity(&s, c->segment, at));
    }
}

double himc_segments_kinetic(const himc_skeleton *skeleton, const segment_states *s)
{
    double twice = 0;
    for (int i = himc_first_moving(skeleton); i < HIMC_SEGMENTS; i++) {
        const himc_segment *segment = &skeleton->segment[i];
        himc_vec3 w = s->joints.spin[i];
        himc_vec3 l = himc_mat3_scale_along(&s->joints.rotation[i], segment->inertia, w);
        twice +=
            segment->mass * himc_vec3_dot(s->velocity[i], s->velocity[i]) + himc_vec3_dot(w, l);
    }
    return 0.5 * twice;
}

double himc_segments_potential(const himc_skeleton *skeleton, const segment_states *s)
{
    double sum = 0;
    for (int i = himc_first_moving(skeleton); i < HIMC_SEGMENTS; i++)
        sum += skeleton->segment[i].mass * HIMC_GRAVITY * s->position[i].z;
    return sum;
}
