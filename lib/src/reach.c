/// reach.c: Levenberg and Marquardt's method in coordinates in which the limits are simple.
///
/// In the coordinates x of reach_joint.c a joint moves as willingly as its range is wide, and a
/// step that leaves the limits is put back by shortening x. With G the derivative of the tips by
/// all x and P what takes away, at joints on their bounds, motion further out,
///     dx = W P G' (G W P G' + mu)^-1 e,  mu = |e|^2 / 2 + mu_0 and larger while no step helps,
/// 6 equations for 27 unknowns (Sugihara 2011: such a damping converges quadratically and needs
/// not know what is reachable). Where it sticks it begins again from a posture at random, the same
/// numbers each time.
#include "himc/reach.h"

#include "reach_joint.h"

#include <string.h>

#define JOINTS (1 + HIMC_HANDS * HIMC_ARM_JOINTS) // waist, then left and right arms
#define ROWS (3 * HIMC_HANDS)
#define LEAST_DAMPING 1e-9 // mu_0 (m^2)
#define DAMPING_GROWTH 8.0
#define RETRIES 5        // with larger damping
#define LARGEST_TURN 0.8 // of a joint in a step (rad)
#define SLOW 0.98        // a step that leaves more of the error than this is slow ...
#define PATIENCE 4       // ... and after so many another try begins
#define STRAY 0.7        // of free joints, when a try begins at random (rad)

typedef struct body {
    const himc_skeleton *skeleton;
    const himc_reach_goal *goal;
    himc_reach_joint joint[JOINTS];
    himc_vec3 turn[JOINTS][3];               // axis in the world of each x (rad)
    himc_vec3 origin[JOINTS];                // (m)
    himc_vec3 error[HIMC_HANDS];             // (m)
    himc_vec3 column[JOINTS][HIMC_HANDS][3]; // G
    unsigned chance;
} body;

himc_reach_goal himc_reach_default(void)
{
    return (himc_reach_goal){.tolerance = 1e-6, .trunk = 0.1, .steps = 60, .tries = 40};
}

static double uniform(body *b)
{
    b->chance = b->chance * 1664525u + 1013904223u;
    return (b->chance >> 8) / 8388608.0 - 1;
}

// joint `i` on its parent's orientation and place; gives its own
static void place_joint(body *b, int i, himc_quat *orientation, himc_vec3 *place)
{
    himc_vec3 turn[3];
    himc_quat q = himc_reach_joint_rotation(&b->joint[i], turn);
    b->origin[i] = himc_vec3_add(
        *place, himc_quat_rotate(*orientation, b->skeleton->segment[b->joint[i].id + 1].origin));
    himc_mat3 r = himc_mat3_from_quat(*orientation);
    for (int c = 0; c < 3; c++)
        b->turn[i][c] = himc_mat3_apply(&r, turn[c]);
    *place = b->origin[i];
    *orientation = himc_quat_mul(*orientation, q);
}

// forward kinematics; returns the sum of the squared distances (m^2)
static double place_body(body *b)
{
    double square = 0;
    himc_quat trunk = himc_quat_identity();
    himc_vec3 waist = b->skeleton->root;
    place_joint(b, 0, &trunk, &waist);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_quat q = trunk;
        himc_vec3 at = waist;
        for (int k = 0; k < HIMC_ARM_JOINTS; k++)
            place_joint(b, 1 + hand * HIMC_ARM_JOINTS + k, &q, &at);
        himc_vec3 tip = himc_vec3_add(at, himc_quat_rotate(q, b->skeleton->tip));
        b->error[hand] = himc_vec3_sub(b->goal->tip[hand], tip);
        if (b->goal->free[hand])
            b->error[hand] = himc_vec3_make(0, 0, 0);
        square += himc_vec3_dot(b->error[hand], b->error[hand]);
    }
    return square;
}

static bool moves(const body *b, int i, int hand)
{
    return !b->goal->free[hand] && (i == 0 || (i - 1) / HIMC_ARM_JOINTS == hand);
}

// G: what each coordinate does to each tip
static void fill_columns(body *b)
{
    for (int i = 0; i < JOINTS; i++)
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            himc_vec3 tip = himc_vec3_sub(b->goal->tip[hand], b->error[hand]);
            himc_vec3 lever = himc_vec3_sub(tip, b->origin[i]);
            for (int c = 0; c < 3 && moves(b, i, hand); c++)
                b->column[i][hand][c] = himc_vec3_cross(b->turn[i][c], lever);
        }
}

static double component(himc_vec3 v, int i)
{
    return i == 0 ? v.x : i == 1 ? v.y : v.z;
}

// the lower half of G W P G' + mu
static void fill_gram(const body *b, double mu, double a[ROWS][ROWS])
{
    memset(a, 0, ROWS * sizeof *a);
    for (int i = 0; i < JOINTS; i++) {
        double row[ROWS][3];
        const himc_reach_joint *j = &b->joint[i];
        for (int r = 0; r < ROWS; r++) {
            if (!moves(b, i, r / 3))
                continue;
            for (int c = 0; c < 3; c++)
                row[r][c] = component(b->column[i][r / 3][c], r % 3);
            himc_reach_joint_hold(j, row[r]);
            for (int s = 0; s <= r; s++)
                if (moves(b, i, s / 3))
                    a[r][s] += j->willing * (row[r][0] * row[s][0] + row[r][1] * row[s][1] +
                                             row[r][2] * row[s][2]);
        }
    }
    for (int r = 0; r < ROWS; r++)
        a[r][r] += mu;
}

// a f = e by Cholesky's factors; mu keeps a positive definite
static void solve(double a[ROWS][ROWS], const himc_vec3 e[HIMC_HANDS], double f[ROWS])
{
    for (int r = 0; r < ROWS; r++) {
        f[r] = component(e[r / 3], r % 3);
        for (int s = 0; s <= r; s++) {
            for (int k = 0; k < s; k++)
                a[r][s] -= a[r][k] * a[s][k];
            a[r][s] = s < r ? a[r][s] / a[s][s] : sqrt(a[r][r]);
        }
        for (int k = 0; k < r; k++)
            f[r] -= a[r][k] * f[k];
        f[r] /= a[r][r];
    }
    for (int r = ROWS - 1; r >= 0; r--) {
        for (int k = r + 1; k < ROWS; k++)
            f[r] -= a[k][r] * f[k];
        f[r] /= a[r][r];
    }
}

// W G' f of a joint
static void pull(const body *b, int i, const double f[ROWS], double dx[3])
{
    for (int c = 0; c < 3; c++) {
        dx[c] = 0;
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            if (moves(b, i, hand))
                dx[c] +=
                    b->joint[i].willing *
                    himc_vec3_dot(b->column[i][hand][c],
                                  himc_vec3_make(f[3 * hand], f[3 * hand + 1], f[3 * hand + 2]));
    }
}

// the step for a damping, bounds held as needed
static void find_step(body *b, double mu, double dx[JOINTS][3])
{
    bool more = true;
    for (int i = 0; i < JOINTS; i++)
        memset(b->joint[i].held, 0, sizeof b->joint[i].held);
    for (int pass = 0; pass < 3 && more; pass++) {
        double a[ROWS][ROWS], f[ROWS];
        fill_gram(b, mu, a);
        solve(a, b->error, f);
        more = false;
        for (int i = 0; i < JOINTS; i++) {
            pull(b, i, f, dx[i]);
            more = himc_reach_joint_hold_more(&b->joint[i], dx[i]) || more;
        }
    }
    for (int i = 0; i < JOINTS; i++)
        himc_reach_joint_hold(&b->joint[i], dx[i]);
}

static void move(body *b, double dx[JOINTS][3])
{
    double most = 0;
    for (int i = 0; i < JOINTS; i++) {
        himc_vec3 turned = {0, 0, 0};
        for (int c = 0; c < 3; c++)
            turned = himc_vec3_madd(turned, dx[i][c], b->turn[i][c]);
        most = fmax(most, himc_vec3_length(turned));
    }
    double scale = most > LARGEST_TURN ? LARGEST_TURN / most : 1;
    for (int i = 0; i < JOINTS; i++) {
        for (int c = 0; c < 3; c++)
            b->joint[i].x[c] += scale * dx[i][c];
        himc_reach_joint_inside(&b->joint[i]);
    }
}

static double farthest(const body *b)
{
    return fmax(himc_vec3_length(b->error[0]), himc_vec3_length(b->error[1]));
}

// one step that brings the tips nearer; false if none does
static bool improve(body *b, double *square)
{
    himc_reach_joint before[JOINTS];
    double mu = 0.5 * *square + LEAST_DAMPING, dx[JOINTS][3];
    memcpy(before, b->joint, sizeof before);
    for (int i = 0; i < RETRIES; i++, mu *= DAMPING_GROWTH) {
        fill_columns(b);
        find_step(b, mu, dx);
        move(b, dx);
        double now = place_body(b);
        if (now < *square) {
            *square = now;
            return true;
        }
        memcpy(b->joint, before, sizeof before);
        place_body(b);
    }
    return false;
}

// until the tips are there or it sticks; returns the steps made
static int descend(body *b)
{
    int slow = 0, step = 0;
    double square = place_body(b);
    while (step < b->goal->steps && farthest(b) > b->goal->tolerance && slow < PATIENCE) {
        double before = square;
        step++;
        if (!improve(b, &square))
            break;
        slow = square > SLOW * SLOW * before ? slow + 1 : 0;
    }
    return step;
}

static void begin_anywhere(body *b)
{
    for (int i = 0; i < JOINTS; i++) {
        himc_reach_joint *j = &b->joint[i];
        for (int c = 0; c < 3; c++)
            j->x[c] = (j->bounds == REACH_FREE ? STRAY : 1) * uniform(b);
        himc_reach_joint_inside(j);
    }
}

static void begin(body *b, const himc_limits *limits, const himc_pose *pose)
{
    for (int i = 0; i < JOINTS; i++) {
        himc_reach_joint *j = &b->joint[i];
        int arm = (i - 1) / HIMC_ARM_JOINTS, k = (i - 1) % HIMC_ARM_JOINTS;
        j->id = i == 0 ? HIMC_TRUNK - 1 : himc_arm_joint((himc_hand)arm, k);
        j->willing = i == 0 ? b->goal->trunk : 1;
        himc_reach_joint_begin(j, limits, pose->joint[j->id]);
    }
}

bool himc_reach(const himc_skeleton *skeleton, const himc_limits *limits,
                const himc_reach_goal *goal, himc_pose *pose, himc_reach_result *result)
{
    body b = {.skeleton = skeleton, .goal = goal, .chance = 1};
    himc_reach_joint best[JOINTS];
    himc_reach_result r = {.missing = INFINITY};
    begin(&b, limits, pose);
    for (; r.tries < goal->tries && !(r.missing <= goal->tolerance); r.tries++) {
        if (r.tries > 0)
            begin_anywhere(&b);
        r.steps += descend(&b);
        if (farthest(&b) < r.missing) {
            r.missing = farthest(&b);
            memcpy(best, b.joint, sizeof best);
        }
    }
    for (int i = 0; i < JOINTS && r.tries > 0; i++) {
        himc_vec3 unused[3];
        pose->joint[best[i].id] = himc_reach_joint_rotation(&best[i], unused);
    }
    if (result)
        *result = r;
    return r.missing <= goal->tolerance;
}
