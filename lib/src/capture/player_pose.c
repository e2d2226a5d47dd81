/// player_pose.c: postures from joint centres, frame by frame.
///
/// A limb's segment in the world is the rotation that takes the zero pose's axis to the line
/// between its joint centres. Its turn about that line: from a skeleton, the joint's own world
/// rotation after the turn A that takes our zero pose to the file's, Q A, then swung the least onto
/// the line; A is the least swing from our hanging limb to the file's (a T-pose has its elbows'
/// creases forward and its palms down). From markers, y is the axis of flexion: a marker beside the
/// segment, else upper arm x forearm and thigh x shank, else the level direction across the stroke.
/// The trunk's z runs from the waist to the neck, its y along the shoulders. The pelvis of the body
/// is held still, so the waist and the hips have the rotations in the world. Invariant: a take of
/// this library's own body comes back as it was.
#include "capture/player_pose.h"

#include "base/limb_frame.h"

#include <stdlib.h>

#define SIDEWAYS 0.5  // of a zero pose's arm: from here on it is a T-pose's
#define STRAIGHT 0.1  // what the mean plane of a bent limb counts beside a frame's own
#define MEAN_STEPS 20 // of the mean rotation

typedef struct limb {
    int segment; // left
    player_point from, to;
    bool is_hand; // turns with the palm: all beyond the elbow
} limb;

static const limb limbs[] = {
    {HIMC_LEFT_UPPER_ARM, POINT_SHOULDER, POINT_ELBOW, false},
    {HIMC_LEFT_FOREARM, POINT_ELBOW, POINT_WRIST, true},
    {HIMC_LEFT_HAND, POINT_WRIST, POINT_GRIP, true},
    {HIMC_LEFT_STICK, POINT_GRIP, POINT_TIP, true},
    {HIMC_LEFT_UPPER_LEG, POINT_HIP, POINT_KNEE, false},
    {HIMC_LEFT_LOWER_LEG, POINT_KNEE, POINT_ANKLE, false},
};
#define LIMBS ((int)(sizeof limbs / sizeof limbs[0]))

// how one limb's turn about itself is known
typedef struct limb_frame {
    bool shown;
    int node;        // of a skeleton, or -1
    himc_quat align; // our zero pose to the file's
    himc_vec3 plane; // mean normal of the bent limb
} limb_frame;

typedef struct reader {
    const player_points *points;
    const himc_skeleton *skeleton;
    himc_player *player;
    himc_quat *node; // world rotations of the file's joints, or NULL
    limb_frame frame[LIMBS][HIMC_HANDS];
    himc_vec3 waist; // where the held pelvis ends (m), if hips are shown
    himc_vec3 hips;  // mean of the centre between the hip joints (m)
    bool has_trunk;
} reader;

// the least rotation that takes one unit vector to another
static himc_quat swing(himc_vec3 from, himc_vec3 to)
{
    double c = himc_vec3_dot(from, to);
    himc_vec3 axis = himc_vec3_cross(from, to);
    if (c < -0.999999) {
        himc_vec3 other = fabs(from.x) < 0.5 ? himc_vec3_make(1, 0, 0) : himc_vec3_make(0, 1, 0);
        axis = himc_vec3_unit(himc_vec3_cross(from, other));
        return (himc_quat){0, axis.x, axis.y, axis.z};
    }
    return himc_quat_unit((himc_quat){1 + c, axis.x, axis.y, axis.z});
}

static himc_vec3 between_points(const reader *r, int from, int to, int frame)
{
    himc_vec3 d = himc_vec3_sub(r->points->x[to][frame], r->points->x[from][frame]);
    // two centres in one place point nowhere: down, as limbs hang
    return himc_vec3_length(d) > 1e-9 ? himc_vec3_unit(d) : himc_vec3_make(0, 0, -1);
}

// from node to node in the file's zero pose; false if `from` is no ancestor
static bool zero_direction(const himc_take *take, int from, int to, himc_vec3 *direction)
{
    himc_vec3 sum = {0, 0, 0};
    int i = to;
    for (; i >= 0 && i != from; i = himc_take_parent(take, i))
        sum = himc_vec3_add(sum, himc_take_offset(take, i));
    *direction = himc_vec3_unit(sum);
    return i == from && i >= 0 && himc_vec3_length(sum) > 1e-6;
}

static void align_limb(const reader *r, const limb *l, int hand, limb_frame *f)
{
    const int *node = r->points->node;
    int from = node[(int)l->from + hand], to = node[(int)l->to + hand];
    himc_vec3 zero;
    f->node = -1;
    // a stick that the file has in one piece with the hand
    if (l->from == POINT_GRIP && from < 0)
        from = node[POINT_WRIST + hand];
    if (l->to == POINT_GRIP && to < 0)
        to = node[POINT_TIP + hand];
    if (!r->node || from < 0 || to < 0 || !zero_direction(r->points->take, from, to, &zero))
        return;
    f->node = from;
    f->align = swing(himc_vec3_make(0, 0, -1), zero);
    if (l->is_hand && fabs(zero.y) > SIDEWAYS)
        f->align = himc_quat_from_limb(zero, himc_vec3_make(hand == HIMC_LEFT ? -1 : 1, 0, 0));
}

// normal of the plane in which elbow or knee bends, as long as the sine of the angle; 0 elsewhere
static himc_vec3 bend_plane(const reader *r, const limb *l, int hand, int frame)
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

static void prepare_limb(reader *r, int i, int hand)
{
    const limb *l = &limbs[i];
    limb_frame *f = &r->frame[i][hand];
    himc_vec3 *const *x = r->points->x, sum = {0, 0, 0};
    f->shown = x[(int)l->from + hand] && x[(int)l->to + hand];
    if (!f->shown)
        return;
    align_limb(r, l, hand, f);
    for (int k = 0; k < r->points->frames && !l->is_hand; k++)
        sum = himc_vec3_add(sum, bend_plane(r, l, hand, k));
    f->plane = himc_vec3_scale(himc_vec3_unit(sum), STRAIGHT);
}

// level, to the left of where the tip is as seen from the elbow: a raised stick itself may point up
// or back
static himc_vec3 across_stroke(const reader *r, int hand, int frame)
{
    himc_vec3 *const *x = r->points->x;
    int from = POINT_ELBOW + hand, to = POINT_TIP + hand;
    while (from < POINT_GRIP + hand && !x[from])
        from += 2;
    while (to > POINT_WRIST + hand && !x[to])
        to -= 2;
    himc_vec3 d = between_points(r, from, to, frame);
    return himc_vec3_make(-d.y, d.x, 0);
}

static himc_quat limb_rotation(const reader *r, int i, int hand, int frame)
{
    const limb *l = &limbs[i];
    const limb_frame *f = &r->frame[i][hand];
    himc_vec3 along = between_points(r, (int)l->from + hand, (int)l->to + hand, frame);
    if (f->node >= 0) {
        himc_quat q = himc_quat_mul(r->node[f->node], f->align);
        himc_vec3 now = himc_quat_rotate(q, himc_vec3_make(0, 0, -1));
        return himc_quat_unit(himc_quat_mul(swing(now, along), q));
    }
    int beside = POINT_BESIDE + l->segment + hand;
    if (r->points->x[beside])
        return himc_quat_from_limb(along, between_points(r, (int)l->from + hand, beside, frame));
    if (l->is_hand)
        return himc_quat_from_limb(along, across_stroke(r, hand, frame));
    return himc_quat_from_limb(along, himc_vec3_add(bend_plane(r, l, hand, frame), f->plane));
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

// world rotations of the file's joints
static void turn_nodes(reader *r, int frame)
{
    const himc_take *take = r->points->take;
    for (int i = 0; r->node && i < himc_take_points(take); i++) {
        int parent = himc_take_parent(take, i);
        himc_quat q = himc_take_rotation(take, frame, i);
        r->node[i] = parent < 0 ? q : himc_quat_unit(himc_quat_mul(r->node[parent], q));
    }
}

// an end site has no rotation of its own
static bool has_child(const himc_take *take, int node)
{
    for (int i = node + 1; i < himc_take_points(take); i++)
        if (himc_take_parent(take, i) == node)
            return true;
    return false;
}

// neck, head and feet: a skeleton's word for it, or a line and a marker beside the joint
static const struct {
    int segment;
    int from, to; // player_points
} others[] = {{HIMC_NECK, POINT_NECK, POINT_HEAD},
              {HIMC_HEAD, POINT_HEAD, POINT_HEAD_END},
              {HIMC_LEFT_FOOT, POINT_ANKLE, POINT_TOE},
              {HIMC_RIGHT_FOOT, POINT_ANKLE + 1, POINT_TOE + 1},
              {HIMC_LEFT_TOES, POINT_TOE, POINT_TOE_END},
              {HIMC_RIGHT_TOES, POINT_TOE + 1, POINT_TOE_END + 1}};

// own direction `own`, across y, to `along`; y as near to `side` as may be
static himc_quat frame_of(himc_vec3 own, himc_vec3 along, himc_vec3 side)
{
    himc_vec3 y = himc_vec3_madd(side, -himc_vec3_dot(side, along), along), left = {0, 1, 0};
    if (himc_vec3_length(y) < 1e-6)
        return swing(own, along);
    y = himc_vec3_unit(y);
    himc_mat3 world = himc_mat3_from_axes(along, y, himc_vec3_cross(along, y));
    himc_mat3 body = himc_mat3_from_axes(own, left, himc_vec3_cross(own, left));
    return himc_quat_mul(himc_quat_from_mat3(world), himc_quat_conj(himc_quat_from_mat3(body)));
}

// the direction from a segment's joint to the next, in its frame
static himc_vec3 own_direction(const himc_skeleton *skeleton, int segment)
{
    if (segment == HIMC_LEFT_FOOT || segment == HIMC_RIGHT_FOOT) {
        himc_vec3 toes = skeleton->segment[segment + 2].origin;
        toes.y = 0;
        return himc_vec3_unit(toes);
    }
    return skeleton->segment[segment].axis;
}

static bool other_rotation(const reader *r, int segment, int frame, himc_quat *q)
{
    himc_vec3 *const *x = r->points->x;
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        int from = others[i].from, to = others[i].to, beside = POINT_BESIDE + segment;
        int node = r->node ? r->points->node[from] : -1;
        if (others[i].segment != segment)
            continue;
        if (node >= 0 && has_child(r->points->take, node)) {
            *q = r->node[node];
            return true;
        }
        if (r->node || !x[from] || !x[to] || !x[beside])
            return false;
        *q = frame_of(own_direction(r->skeleton, segment), between_points(r, from, to, frame),
                      between_points(r, from, beside, frame));
        return true;
    }
    return false;
}

static int limb_of(int segment)
{
    for (int i = 0; i < LIMBS; i++)
        if (segment == limbs[i].segment || segment == limbs[i].segment + 1)
            return i;
    return -1;
}

// a segment in the world; false if the take does not show it
static bool segment_rotation(const reader *r, int segment, int frame, himc_quat *q)
{
    int i = limb_of(segment);
    if (segment == HIMC_TRUNK)
        return trunk_rotation(r, frame, q);
    if (i < 0)
        return other_rotation(r, segment, frame, q);
    bool shown = r->frame[i][segment - limbs[i].segment].shown;
    if (shown)
        *q = limb_rotation(r, i, segment - limbs[i].segment, frame);
    return shown;
}

static void read_frame(reader *r, int frame)
{
    himc_quat world[HIMC_SEGMENTS] = {himc_quat_identity()};
    himc_pose *pose = &r->player->pose[frame];
    turn_nodes(r, frame);
    for (int i = 1; i < HIMC_SEGMENTS; i++) {
        himc_quat parent = world[r->skeleton->segment[i].parent], q;
        bool shown = segment_rotation(r, i, frame, &q);
        r->player->known[i - 1] = shown;
        pose->joint[i - 1] =
            shown ? himc_quat_mul(himc_quat_conj(parent), q) : r->player->mean.joint[i - 1];
        world[i] = himc_quat_mul(parent, pose->joint[i - 1]);
    }
}

// the rotation about which the others' logarithms have no mean; the nearest to all of them, that of
// rotations.h, is another where motion is wide (by up to 2 mrad in the database)
static himc_quat mean_rotation(const himc_pose *pose, int frames, int j)
{
    himc_quat mean = pose[0].joint[j];
    for (int step = 0; step < MEAN_STEPS; step++) {
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
                            const himc_skeleton *skeleton, const himc_vec3 *waist)
{
    reader r = {.points = points, .skeleton = skeleton, .player = player};
    bool skeletal = himc_take_has_skeleton(points->take);
    if (skeletal)
        r.node = calloc((size_t)himc_take_points(points->take), sizeof *r.node);
    player->pose = calloc((size_t)points->frames, sizeof *player->pose);
    if (!player->pose || (skeletal && !r.node)) {
        free(r.node);
        return false;
    }
    // a shoulder that is not seen is where the neck is, for the direction across
    int across = !!points->x[POINT_SHOULDER] + !!points->x[POINT_SHOULDER + 1];
    r.has_trunk = waist && across + !!points->x[POINT_NECK] >= 2 && across > 0;
    if (waist)
        r.waist = *waist;
    for (int i = 0; waist && i < points->frames; i++)
        r.hips = himc_vec3_madd(r.hips, 1.0 / points->frames, points->x[POINT_HIPS][i]);
    for (int i = 0; i < LIMBS; i++)
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            prepare_limb(&r, i, hand);
    for (int frame = 0; frame < points->frames; frame++)
        read_frame(&r, frame);
    himc_player_fit_arms(player, points, skeleton);
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
