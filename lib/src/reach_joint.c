/// reach_joint.c: one joint's coordinates x and its limits.
///
/// Within an ellipsoid the rotation is mean exp(A x), A the axes times the semi-axes, and the limit
/// |x| <= 1; within a box the Euler angles are middle + half x, and the limits |x_i| <= 1; a free
/// joint turns by exp(x) from where it was. Invariant: after himc_reach_joint_inside
/// himc_limit_measure is at most 1.
#include "reach_joint.h"

#include "euler.h"

#define INSIDE (1 - 1e-9) // of the bounds: rounding must not take a joint out
#define ON_BOUND (1 - 1e-6)
#define THINNEST 1e-3 // semi-axes and half intervals are at least that, as in limits.h (rad)
#define GIMBAL (0.5 * HIMC_PI - 1e-3) // of y: nearer a quarter turn x and z lose digits (rad)

static himc_vec3 column_of(const himc_mat3 *a, int c)
{
    return himc_vec3_make(a->m[0][c], a->m[1][c], a->m[2][c]);
}

// into the box, the measure of which takes the second angle within a quarter turn
static void begin_box(himc_reach_joint *j, const himc_limit *l)
{
    himc_vec3 low = l->lower, high = l->upper;
    low.y = fmax(low.y, -GIMBAL);
    high.y = fmin(high.y, GIMBAL);
    j->bounds = REACH_BOX;
    j->middle = himc_vec3_scale(himc_vec3_add(low, high), 0.5);
    j->half = himc_vec3_scale(himc_vec3_sub(high, low), 0.5);
    j->half = himc_vec3_make(fmax(j->half.x, THINNEST), fmax(j->half.y, THINNEST),
                             fmax(j->half.z, THINNEST));
}

static void begin_ball(himc_reach_joint *j, const himc_limit *l)
{
    const double radius[3] = {l->radius.x, l->radius.y, l->radius.z};
    j->bounds = REACH_BALL;
    for (int i = 0; i < 9; i++)
        j->span.m[i / 3][i % 3] =
            l->axes.m[i / 3][i % 3] * fmin(fmax(radius[i % 3], THINNEST), HIMC_PI);
}

void himc_reach_joint_inside(himc_reach_joint *j)
{
    double length = sqrt(j->x[0] * j->x[0] + j->x[1] * j->x[1] + j->x[2] * j->x[2]);
    for (int c = 0; c < 3; c++) {
        if (j->bounds == REACH_BALL && length > INSIDE)
            j->x[c] *= INSIDE / length;
        else if (j->bounds == REACH_BOX)
            j->x[c] = fmin(fmax(j->x[c], -INSIDE), INSIDE);
    }
}

void himc_reach_joint_begin(himc_reach_joint *j, const himc_limits *limits, himc_quat rotation)
{
    const himc_limit *l = limits ? &limits->joint[j->id] : NULL;
    bool bound = l && l->bound && limits->kind != HIMC_LIMITS_OFF;
    *j = (himc_reach_joint){.id = j->id, .willing = j->willing, .mean = bound ? l->mean : rotation};
    j->span = (himc_mat3){{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    if (!bound)
        return;
    rotation = himc_limit_closest(limits, j->id, rotation);
    himc_quat away = himc_quat_mul(himc_quat_conj(l->mean), rotation);
    himc_vec3 t = himc_quat_log(away);
    if (limits->kind == HIMC_LIMITS_ELLIPSOID) {
        begin_ball(j, l);
        for (int c = 0; c < 3; c++) {
            himc_vec3 a = column_of(&j->span, c);
            j->x[c] = himc_vec3_dot(a, t) / himc_vec3_dot(a, a);
        }
    } else {
        begin_box(j, l);
        himc_vec3 angle = himc_euler_from_quat(away);
        j->x[0] = (angle.x - j->middle.x) / j->half.x;
        j->x[1] = (angle.y - j->middle.y) / j->half.y;
        j->x[2] = (angle.z - j->middle.z) / j->half.z;
    }
    himc_reach_joint_inside(j);
}

// the joint's rotation, and what its coordinates turn in the parent's frame. Of exp(t) that is the
// left Jacobian, 1 sin t / t + a a' (1 - sin t / t) + [a] (1 - cos t) / t for t along a
static himc_quat turn_ball(const himc_reach_joint *j, himc_vec3 turn[3])
{
    himc_vec3 t = himc_mat3_apply(&j->span, himc_vec3_make(j->x[0], j->x[1], j->x[2]));
    double angle = himc_vec3_length(t), sine = 1, cosine = 0;
    himc_vec3 a = himc_vec3_unit(t);
    if (angle > 1e-6) {
        sine = sin(angle) / angle;
        cosine = (1 - cos(angle)) / angle;
    }
    for (int c = 0; c < 3; c++) {
        himc_vec3 v = column_of(&j->span, c);
        himc_vec3 w = himc_vec3_madd(himc_vec3_scale(v, sine), (1 - sine) * himc_vec3_dot(a, v), a);
        turn[c] = himc_quat_rotate(j->mean, himc_vec3_madd(w, cosine, himc_vec3_cross(a, v)));
    }
    return himc_quat_mul(j->mean, himc_quat_exp(t));
}

static himc_quat turn_box(const himc_reach_joint *j, himc_vec3 turn[3])
{
    himc_vec3 angle = {j->middle.x + j->half.x * j->x[0], j->middle.y + j->half.y * j->x[1],
                       j->middle.z + j->half.z * j->x[2]};
    himc_quat z = himc_quat_mul(j->mean, himc_quat_exp(himc_vec3_make(0, 0, angle.z)));
    himc_quat zy = himc_quat_mul(z, himc_quat_exp(himc_vec3_make(0, angle.y, 0)));
    turn[0] = himc_quat_rotate(zy, himc_vec3_make(j->half.x, 0, 0));
    turn[1] = himc_quat_rotate(z, himc_vec3_make(0, j->half.y, 0));
    turn[2] = himc_quat_rotate(j->mean, himc_vec3_make(0, 0, j->half.z));
    return himc_quat_mul(zy, himc_quat_exp(himc_vec3_make(angle.x, 0, 0)));
}

himc_quat himc_reach_joint_rotation(const himc_reach_joint *j, himc_vec3 turn[3])
{
    return j->bounds == REACH_BOX ? turn_box(j, turn) : turn_ball(j, turn);
}

void himc_reach_joint_hold(const himc_reach_joint *j, double v[3])
{
    if (j->bounds == REACH_BALL && j->held[0]) {
        double square = j->x[0] * j->x[0] + j->x[1] * j->x[1] + j->x[2] * j->x[2];
        double along = (v[0] * j->x[0] + v[1] * j->x[1] + v[2] * j->x[2]) / square;
        for (int c = 0; c < 3; c++)
            v[c] -= along * j->x[c];
    }
    for (int c = 0; c < 3 && j->bounds == REACH_BOX; c++)
        if (j->held[c])
            v[c] = 0;
}

bool himc_reach_joint_hold_more(himc_reach_joint *j, const double dx[3])
{
    bool more = false;
    double out = dx[0] * j->x[0] + dx[1] * j->x[1] + dx[2] * j->x[2];
    double square = j->x[0] * j->x[0] + j->x[1] * j->x[1] + j->x[2] * j->x[2];
    if (j->bounds == REACH_BALL && !j->held[0] && square > ON_BOUND && out > 0)
        more = j->held[0] = true;
    for (int c = 0; c < 3 && j->bounds == REACH_BOX; c++)
        if (!j->held[c] && fabs(j->x[c]) > ON_BOUND && dx[c] * j->x[c] > 0)
            more = j->held[c] = true;
    return more;
}
