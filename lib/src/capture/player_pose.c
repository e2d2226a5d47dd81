/// player_pose.c: poses from joint centres, frame by frame, then arms fitted to the centres.
///
/// The world rotation of a limb's segment takes the axis of the zero pose to the line between its
/// joint centres. Its rotation about that line comes from a skeleton, if there is one: the joint's
/// world rotation Q after the rotation A that takes the library's zero pose to the file's, Q A,
/// then the smallest rotation onto the line; A is the smallest rotation from the library's hanging
/// limb to the file's (in a T-pose elbows bend forward and palms are down). From markers, y is the
/// axis of flexion: a marker beside the segment, else upper arm x forearm and thigh x shank, else
/// the horizontal direction across the stroke. The trunk's z runs from the waist to the neck, its y
/// along the shoulders. The pelvis of the body is held still, so the rotations of trunk and thighs
/// are those in the world.
///
/// Captured limbs stretch by a centimetre or two, since joint centres are guessed from outside; a
/// simulated body's do not. So an arm's pose is rotated by the least that brings its elbow, wrist
/// and grip nearest to the captured centres and its tip onto the captured one (global optimisation,
/// Lu & O'Connor 1999):
///     min sum_p w_p |x_p + J_p theta - c_p|^2 + s |theta|^2
/// with theta the rotations at the four joints, by Gauss-Newton. The tip has the largest weight,
/// because the tip plays. Invariant: a take of this library's own body comes back unchanged.
#include "capture/player.h"

#include "base/limb_frame.h"
#include "base/linear.h"
#include "body/posture.h"

#include <stdlib.h>

// true for what rotates with the palm: all beyond the elbow
static bool is_hand(const player_measure *limb)
{
    return limb->segment >= HIMC_LEFT_FOREARM && limb->segment <= HIMC_LEFT_STICK;
}

// the source of a limb's rotation about its own axis
typedef struct limb_frame {
    bool shown;
    int node;        // of a skeleton, or -1
    himc_quat align; // from the library's zero pose to the file's
    himc_vec3 plane; // mean normal of the bent limb
} limb_frame;

typedef struct reader {
    const player_points *points;
    const himc_skeleton *skeleton;
    himc_player *player;
    himc_quat *node; // world rotations of the file's joints, or NULL
    limb_frame frame[PLAYER_LIMBS][HIMC_HANDS];
    himc_vec3 waist; // where the held pelvis ends (m)
    himc_vec3 hips;  // mean of the centre between the hip joints (m)
    bool has_trunk;
} reader;

// the smallest rotation that takes one unit vector to another
static himc_quat smallest_rotation(himc_vec3 from, himc_vec3 to)
{
    double c = himc_vec3_dot(from, to);
    himc_vec3 axis = himc_vec3_cross(from, to);
    if (c < -0.999999) { // opposite
        himc_vec3 other = fabs(from.x) < 0.5 ? himc_vec3_make(1, 0, 0) : himc_vec3_make(0, 1, 0);
        axis = himc_vec3_unit(himc_vec3_cross(from, other));
        return (himc_quat){0, axis.x, axis.y, axis.z};
    }
    return himc_quat_unit((himc_quat){1 + c, axis.x, axis.y, axis.z});
}

static himc_vec3 between_points(const reader *r, int from, int to, int frame)
{
    himc_vec3 d = himc_vec3_sub(r->points->x[to][frame], r->points->x[from][frame]);
    // two centres in one place have no direction: down, as limbs hang
    return himc_vec3_length(d) > 1e-9 ? himc_vec3_unit(d) : himc_vec3_make(0, 0, -1);
}

// normal of the plane in which elbow or knee bends, its length the sine of the angle; 0 elsewhere
static himc_vec3 bend_plane(const reader *r, const player_measure *l, int hand, int frame)
{
    bool leg = l->segment >= HIMC_LEFT_UPPER_LEG;
    int a = (leg ? POINT_HIP : POINT_SHOULDER) + hand, b = (leg ? POINT_KNEE : POINT_ELBOW) + hand,
        c = (leg ? POINT_ANKLE : POINT_WRIST) + hand;
    himc_vec3 *const *x = r->points->x;
    if (!x[a] || !x[b] || !x[c])
        return himc_vec3_make(0, 0, 0);
    himc_vec3 upper = between_points(r, a, b, frame), lower = between_points(r, b, c, frame);
    return leg ? himc_vec3_cross(upper, lower) : himc_vec3_cross(lower, upper);
}

// finds the source of a limb's rotation about its axis: a skeleton's node, else the bend plane
static void prepare_limb(reader *r, int i, int hand)
{
    const player_measure *l = &himc_player_limbs[i];
    const int *nodes = r->points->node;
    limb_frame *f = &r->frame[i][hand];
    himc_vec3 *const *x = r->points->x, sum = {0, 0, 0};
    f->shown = x[(int)l->from + hand] && x[(int)l->to + hand];
    if (!f->shown)
        return;
    int from = nodes[(int)l->from + hand], to = nodes[(int)l->to + hand];
    // in some files stick and hand are one segment
    if (l->from == POINT_GRIP && from < 0)
        from = nodes[POINT_WRIST + hand];
    if (l->to == POINT_GRIP && to < 0)
        to = nodes[POINT_TIP + hand];
    // from node to node in the file's zero pose, if one is the other's ancestor
    himc_vec3 zero = {0, 0, 0};
    int node = r->node && from >= 0 ? to : -1;
    for (; node >= 0 && node != from; node = himc_take_parent(r->points->take, node))
        zero = himc_vec3_add(zero, himc_take_offset(r->points->take, node));
    f->node = himc_vec3_length(zero) > 1e-6 ? node : -1;
    if (f->node >= 0) {
        zero = himc_vec3_unit(zero);
        f->align = smallest_rotation(himc_vec3_make(0, 0, -1), zero);
        // chosen: an arm whose direction is so much sideways is a T-pose's
        if (is_hand(l) && fabs(zero.y) > 0.5)
            f->align = himc_quat_from_limb(zero, himc_vec3_make(hand == HIMC_LEFT ? -1 : 1, 0, 0));
    }
    for (int k = 0; k < r->points->frames && !is_hand(l); k++)
        sum = himc_vec3_add(sum, bend_plane(r, l, hand, k));
    f->plane = himc_vec3_scale(himc_vec3_unit(sum), 0.1); // chosen: its weight beside a frame's own
}

static himc_quat limb_rotation(const reader *r, int i, int hand, int frame)
{
    const player_measure *l = &himc_player_limbs[i];
    const limb_frame *f = &r->frame[i][hand];
    himc_vec3 *const *x = r->points->x;
    himc_vec3 along = between_points(r, (int)l->from + hand, (int)l->to + hand, frame);
    if (f->node >= 0) {
        himc_quat q = himc_quat_mul(r->node[f->node], f->align);
        himc_vec3 now = himc_quat_rotate(q, himc_vec3_make(0, 0, -1));
        return himc_quat_unit(himc_quat_mul(smallest_rotation(now, along), q));
    }
    int beside = POINT_BESIDE + l->segment + hand;
    if (x[beside])
        return himc_quat_from_limb(along, between_points(r, (int)l->from + hand, beside, frame));
    if (!is_hand(l))
        return himc_quat_from_limb(along, himc_vec3_add(bend_plane(r, l, hand, frame), f->plane));
    // across the stroke: horizontal, to the left of the line from elbow to tip, since a raised
    // stick itself may point up or back
    int from = POINT_ELBOW + hand, to = POINT_TIP + hand;
    while (from < POINT_GRIP + hand && !x[from])
        from += 2;
    while (to > POINT_WRIST + hand && !x[to])
        to -= 2;
    himc_vec3 d = between_points(r, from, to, frame);
    return himc_quat_from_limb(along, himc_vec3_make(-d.y, d.x, 0));
}

static bool trunk_rotation(const reader *r, int frame, himc_quat *q)
{
    himc_vec3 *const *x = r->points->x;
    if (!r->has_trunk)
        return false;
    const himc_vec3 *neck = x[POINT_NECK], *lx = x[POINT_SHOULDER], *rx = x[POINT_SHOULDER + 1];
    himc_vec3 left = lx ? lx[frame] : neck[frame], right = rx ? rx[frame] : neck[frame];
    himc_vec3 top = neck ? neck[frame] : himc_vec3_scale(himc_vec3_add(left, right), 0.5);
    himc_vec3 waist = r->waist;
    if (r->player->walks)
        waist = himc_vec3_add(waist, himc_vec3_sub(x[POINT_HIPS][frame], r->hips));
    himc_vec3 down = himc_vec3_sub(waist, top);
    if (himc_vec3_length(down) < 1e-6)
        return false;
    down = himc_vec3_unit(down);
    *q = himc_quat_from_limb(down, himc_vec3_sub(left, right));
    return true;
}

// neck, head and feet: the skeleton's rotation, or a line and a marker beside the joint
static const struct {
    int segment;
    int from, to; // player_points
} others[] = {{HIMC_NECK, POINT_NECK, POINT_HEAD},
              {HIMC_HEAD, POINT_HEAD, POINT_HEAD_END},
              {HIMC_LEFT_FOOT, POINT_ANKLE, POINT_TOE},
              {HIMC_RIGHT_FOOT, POINT_ANKLE + 1, POINT_TOE + 1},
              {HIMC_LEFT_TOES, POINT_TOE, POINT_TOE_END},
              {HIMC_RIGHT_TOES, POINT_TOE + 1, POINT_TOE_END + 1}};

static bool other_rotation(const reader *r, int segment, int frame, himc_quat *q)
{
    himc_vec3 *const *x = r->points->x;
    size_t i = 0;
    while (i < sizeof others / sizeof others[0] && others[i].segment != segment)
        i++;
    if (i == sizeof others / sizeof others[0])
        return false;
    int from = others[i].from, to = others[i].to, beside = POINT_BESIDE + segment;
    int node = r->node ? r->points->node[from] : -1;
    // an end site has no rotation of its own
    for (int k = node + 1; node >= 0 && k < himc_take_points(r->points->take); k++)
        if (himc_take_parent(r->points->take, k) == node) {
            *q = r->node[node];
            return true;
        }
    if (r->node || !x[from] || !x[to] || !x[beside])
        return false;
    // the direction from the segment's joint to the next, in its frame
    himc_vec3 own = r->skeleton->segment[segment].axis;
    if (segment == HIMC_LEFT_FOOT || segment == HIMC_RIGHT_FOOT) {
        himc_vec3 toes = r->skeleton->segment[segment + 2].origin;
        own = himc_vec3_unit(himc_vec3_make(toes.x, 0, toes.z));
    }
    // `own`, across y, goes along the line, and y as near to the marker's side as possible
    himc_vec3 along = between_points(r, from, to, frame), left = {0, 1, 0},
              side = between_points(r, from, beside, frame),
              y = himc_vec3_madd(side, -himc_vec3_dot(side, along), along);
    *q = smallest_rotation(own, along);
    if (himc_vec3_length(y) < 1e-6)
        return true;
    y = himc_vec3_unit(y);
    himc_mat3 world = himc_mat3_from_axes(along, y, himc_vec3_cross(along, y));
    himc_mat3 body = himc_mat3_from_axes(own, left, himc_vec3_cross(own, left));
    *q = himc_quat_mul(himc_quat_from_mat3(world), himc_quat_conj(himc_quat_from_mat3(body)));
    return true;
}

// the world rotations of the segments, and from them the pose
static void read_frame(reader *r, int frame)
{
    himc_quat world[HIMC_SEGMENTS] = {himc_quat_identity()};
    himc_pose *pose = &r->player->pose[frame];
    const himc_take *take = r->points->take;
    for (int i = 0; r->node && i < himc_take_points(take); i++) {
        int parent = himc_take_parent(take, i);
        himc_quat q = himc_take_rotation(take, frame, i);
        r->node[i] = parent < 0 ? q : himc_quat_unit(himc_quat_mul(r->node[parent], q));
    }
    for (int i = 1; i < HIMC_SEGMENTS; i++) {
        himc_quat parent = world[r->skeleton->segment[i].parent], q;
        int limb = 0; // a left side's segment is even
        while (limb < PLAYER_LIMBS && i / 2 != himc_player_limbs[limb].segment / 2)
            limb++;
        bool shown = false;
        if (i == HIMC_TRUNK)
            shown = trunk_rotation(r, frame, &q);
        else if (limb == PLAYER_LIMBS)
            shown = other_rotation(r, i, frame, &q);
        else if ((shown = r->frame[limb][i % 2].shown))
            q = limb_rotation(r, limb, i % 2, frame);
        r->player->known[i - 1] = shown;
        pose->joint[i - 1] =
            shown ? himc_quat_mul(himc_quat_conj(parent), q) : r->player->mean.joint[i - 1];
        world[i] = himc_quat_mul(parent, pose->joint[i - 1]);
    }
}

#define ANGLES (3 * HIMC_ARM_JOINTS)
#define LARGEST_MISS 0.1 // chosen: keeps the linearisation of a step valid (m)

// adds w J'J and w J'e of one point, moved by the first `joints` joints and captured at `center`
static void add_point(const himc_arm_levers *a, int joints, himc_vec3 center, double weight,
                      double *matrix, double *right)
{
    himc_vec3 e = himc_vec3_sub(center, a->at[joints]);
    double far = himc_vec3_length(e);
    e = himc_vec3_scale(e, far > LARGEST_MISS ? LARGEST_MISS / far : 1);
    for (int k = 0; k < joints; k++) {
        himc_vec3 r = himc_vec3_sub(a->at[joints], a->at[k]), moment = himc_vec3_cross(r, e);
        double f[3] = {moment.x, moment.y, moment.z};
        for (int i = 0; i < 3; i++)
            right[3 * k + i] += weight * f[i];
        for (int l = 0; l < joints; l++) { // (theta x s)' (theta x r): s.r 1 - r s'
            himc_vec3 s = himc_vec3_sub(a->at[joints], a->at[l]);
            double rr[3] = {r.x, r.y, r.z}, ss[3] = {s.x, s.y, s.z}, dot = himc_vec3_dot(r, s);
            for (int i = 0; i < 3; i++)
                for (int n = 0; n < 3; n++)
                    matrix[ANGLES * (3 * k + i) + 3 * l + n] +=
                        weight * ((i == n ? dot : 0) - ss[i] * rr[n]);
        }
    }
}

static void fit_arm(const reader *r, himc_hand hand, int frame)
{
    himc_vec3 center[HIMC_ARM_JOINTS + 1];
    himc_pose *pose = &r->player->pose[frame];
    for (int k = 0; k <= HIMC_ARM_JOINTS; k++)
        center[k] = r->points->x[POINT_SHOULDER + HIMC_HANDS * k + (int)hand][frame];
    // Gauss-Newton, of quadratic convergence from some centimetres
    for (int step = 0; step < 5; step++) {
        double matrix[ANGLES * ANGLES] = {0}, theta[ANGLES] = {0};
        himc_arm_levers a = himc_arm_levers_of(r->skeleton, r->waist, pose, hand);
        // chosen: the tip, which plays, counts more than the centres
        for (int joints = 1; joints <= HIMC_ARM_JOINTS; joints++)
            add_point(&a, joints, center[joints], joints < HIMC_ARM_JOINTS ? 1 : 1e4, matrix,
                      theta);
        // s, chosen: 1 rad costs as much as 1 cm of one centre
        for (int i = 0; i < ANGLES; i++)
            matrix[ANGLES * i + i] += 1e-4;
        if (himc_linear_solve(ANGLES, matrix, theta) != HIMC_LINEAR_SOLVED)
            return;
        for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
            himc_quat *joint = &pose->joint[himc_arm_joint(hand, k)];
            himc_vec3 rotation = himc_vec3_make(theta[3 * k], theta[3 * k + 1], theta[3 * k + 2]);
            rotation = himc_quat_rotate(himc_quat_conj(a.frame[k]), rotation);
            *joint = himc_quat_unit(himc_quat_mul(himc_quat_exp(rotation), *joint));
        }
    }
}

// the rotation about which the logarithms of all have mean 0. The mean of rotations.h, nearest to
// all in another norm, differs where motion is wide (by up to 2 mrad in the database)
static himc_quat mean_rotation(const himc_pose *pose, int frames, int j)
{
    himc_quat mean = pose[0].joint[j];
    for (int step = 0; step < 20; step++) {
        himc_vec3 sum = {0, 0, 0};
        for (int i = 0; i < frames; i++)
            sum = himc_vec3_add(
                sum, himc_quat_log(himc_quat_mul(himc_quat_conj(mean), pose[i].joint[j])));
        sum = himc_vec3_scale(sum, 1.0 / frames);
        mean = himc_quat_unit(himc_quat_mul(mean, himc_quat_exp(sum)));
        if (himc_vec3_length(sum) < 1e-9)
            break;
    }
    return mean;
}

bool himc_player_read_poses(himc_player *player, const player_points *points,
                            const himc_skeleton *skeleton)
{
    const himc_vec3 *hips = points->x[POINT_HIPS];
    reader r = {.points = points,
                .skeleton = skeleton,
                .player = player,
                .waist = himc_vec3_add(player->hips, skeleton->segment[HIMC_TRUNK].origin)};
    bool skeletal = himc_take_has_skeleton(points->take);
    if (skeletal)
        r.node = calloc((size_t)himc_take_points(points->take), sizeof *r.node);
    player->pose = calloc((size_t)points->frames, sizeof *player->pose);
    if (!player->pose || (skeletal && !r.node)) {
        free(r.node);
        return false;
    }
    // a shoulder that is not seen is taken at the neck, for the direction across
    int across = !!points->x[POINT_SHOULDER] + !!points->x[POINT_SHOULDER + 1];
    r.has_trunk = hips && across + !!points->x[POINT_NECK] >= 2 && across > 0;
    for (int i = 0; hips && i < points->frames; i++)
        r.hips = himc_vec3_madd(r.hips, 1.0 / points->frames, hips[i]);
    for (int i = 0; i < PLAYER_LIMBS; i++)
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            prepare_limb(&r, i, hand);
    for (int frame = 0; frame < points->frames; frame++)
        read_frame(&r, frame);
    for (int i = 0; i < HIMC_HANDS && player->placed && !player->walks; i++) {
        bool shown = himc_player_known_arm(player, (himc_hand)i) == HIMC_ARM_JOINTS; // wholly
        for (int frame = 0; shown && frame < points->frames; frame++)
            fit_arm(&r, (himc_hand)i, frame);
    }
    int known = 0;
    for (int j = 0; j < HIMC_JOINTS; j++) {
        if (player->known[j])
            player->mean.joint[j] = mean_rotation(player->pose, points->frames, j);
        known += player->known[j];
    }
    if (known == 0) {
        free(player->pose);
        player->pose = NULL;
    }
    free(r.node);
    return true;
}
