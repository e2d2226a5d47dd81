/// support.c: seat and floor as points that press a plane, F = k d^1.5 (1 + c d') with the depth d
/// (Hunt & Crossley 1975), never less than 0. Seat and soles are three patches that hold or slip
/// each as a whole, as flesh and leather do: friction is a spring to where each point has touched,
/// in proportion to its pressure, with damping, up to the coefficient of friction times the
/// pressure of all; then the anchors come along. A spring, not a friction of speed, and not
/// point by point; and the cushion is hollow under each point: so that nobody creeps off his stool
/// within half an hour.
#include "body/support.h"

#include "body/dynamics.h"
#include "body/posture.h"

#define FEET_SHARE 0.25 // of the weight; chosen: .2 to .3 of seated people
// chosen: a cushion that gives 5 mm, and soles that give a millimetre; both damp their own bounce
#define SEAT_STIFFNESS 2.8e5 // k (N/m^1.5)
#define SOLE_STIFFNESS 1.5e6
#define DAMPING 4.0 // c (s/m)
// along the plane, of seat and of a sole; chosen: 5 Hz with the mass that rests there, half damped
#define SEAT_HOLD 7.2e4     // (N/m)
#define SEAT_DRAG 2400.0    // (N s/m)
#define SOLE_HOLD 5e4       // (N/m)
#define SOLE_DRAG 240.0     // (N s/m)
#define SEAT_HOLLOW 0.12    // radius of the cushion under each point (m); brings him back
#define LEAST_SHARE 0.1     // of sit bones and of thighs, whatever the balance; chosen
#define LEAST_PRESSURE 1e-6 // (N); chosen: nothing
#define SOLE_AHEAD 0.15     // (m)
#define SOLE_ASIDE 0.04     // (m)
#define THIGH_DEPTH 0.075   // its axis over the seat, at 1.75 m (m)
// of the left sit bone, from the midpoint of the hip joints, at 1.75 m (m)
#define BONE_BEHIND 0.02
#define BONE_ASIDE 0.06
static const double along_thigh[] = {0.3, 0.5}; // shares of its length

/// What carries: a share of the weight is theirs together.
typedef enum carrier { BONES, THIGHS, SOLES, CARRIERS } carrier;

static carrier carrier_of(int point)
{
    return point >= HIMC_SEAT_POINTS ? SOLES : point % (HIMC_SEAT_POINTS / 2) ? THIGHS : BONES;
}

static void place_points(himc_support *s, const himc_skeleton *skeleton)
{
    int n = 0;
    for (int side = 0; side < HIMC_HANDS; side++) {
        int thigh = HIMC_LEFT_UPPER_LEG + side, foot = HIMC_LEFT_FOOT + side;
        double left = side == HIMC_LEFT ? 1 : -1, scale = skeleton->height / 1.75;
        s->point[n++] = (himc_support_point){
            .segment = HIMC_PELVIS,
            .at = himc_vec3_make(-BONE_BEHIND * scale, left * BONE_ASIDE * scale,
                                 -HIMC_SEAT_DEPTH * skeleton->height)};
        for (int k = 0; k < 2; k++)
            s->point[n++] = (himc_support_point){
                .segment = thigh,
                .at = himc_vec3_make(-THIGH_DEPTH * scale, 0,
                                     -along_thigh[k] * skeleton->segment[thigh].length)};
        for (int k = 0; k < HIMC_SOLE_POINTS; k++)
            s->point[HIMC_SEAT_POINTS + HIMC_SOLE_POINTS * side + k] = (himc_support_point){
                .segment = foot,
                .at = himc_vec3_make(k < 2 ? -HIMC_SOLE_BEHIND : SOLE_AHEAD,
                                     k % 2 ? SOLE_ASIDE : -SOLE_ASIDE, -HIMC_ANKLE_HEIGHT)};
    }
}

// into seat or floor
static double depth_under(double force, carrier by)
{
    return pow(force / (by == SOLES ? SOLE_STIFFNESS : SEAT_STIFFNESS), 2.0 / 3);
}

void himc_support_init(himc_support *s, const himc_skeleton *skeleton, const himc_body_state *rest,
                       bool standing)
{
    double mass = 0, center = 0, lowest = HUGE_VAL, ahead[CARRIERS] = {0}, share[CARRIERS];
    int points[CARRIERS] = {0};
    place_points(s, skeleton);
    himc_support_press(s, skeleton, rest); // for the levers
    for (int i = 0; i < HIMC_SEGMENTS; i++) {
        double x = himc_segment_center(skeleton, rest, i).x - rest->origin[0].x;
        mass += skeleton->segment[i].mass;
        center += skeleton->segment[i].mass * x;
    }
    center /= mass;
    for (int i = 0; i < HIMC_SUPPORTS; i++) {
        carrier by = carrier_of(i);
        ahead[by] += s->point[i].lever.x;
        points[by]++;
        if (by == SOLES)
            lowest = fmin(lowest, rest->origin[0].z + s->point[i].lever.z);
    }
    for (int by = 0; by < CARRIERS; by++)
        ahead[by] /= points[by];
    s->standing = standing;
    s->soles_ahead = ahead[SOLES];
    // shares that balance about the axis from left to right
    bool hang = !standing && lowest >= 0.5 * HIMC_ANKLE_HEIGHT; // the feet
    share[SOLES] = hang ? 0 : FEET_SHARE;
    share[THIGHS] = (center - share[SOLES] * ahead[SOLES] - (1 - share[SOLES]) * ahead[BONES]) /
                    (ahead[THIGHS] - ahead[BONES]);
    share[THIGHS] = fmin(fmax(share[THIGHS], LEAST_SHARE), 1 - share[SOLES] - LEAST_SHARE);
    share[BONES] = 1 - share[SOLES] - share[THIGHS];
    for (int i = 0; i < HIMC_SUPPORTS; i++) {
        carrier by = carrier_of(i);
        bool carries = by == SOLES ? !hang : !standing;
        double height = by == SOLES ? lowest : rest->origin[0].z + s->point[i].lever.z;
        double force = (standing ? 1 : share[by]) / points[by] * mass * HIMC_GRAVITY;
        s->point[i].plane = carries ? height + depth_under(force, by) : 0;
        s->point[i].home = himc_vec3_add(rest->origin[0], s->point[i].lever);
    }
    himc_support_lift(s);
}

void himc_support_lift(himc_support *s)
{
    for (int i = 0; i < HIMC_SUPPORTS; i++) {
        s->point[i].touching = false;
        s->point[i].force = himc_vec3_make(0, 0, 0);
    }
}

// seat and soles, each of which slips as a whole; coefficients of friction chosen: trousers on
// leather, shoes on wood
static const struct {
    int first, count;
    double stiffness, curvature, hold, drag, friction;
} patch[] = {{0, HIMC_SEAT_POINTS, SEAT_STIFFNESS, 1 / SEAT_HOLLOW, SEAT_HOLD, SEAT_DRAG, 0.6},
             {HIMC_SEAT_POINTS, HIMC_SOLE_POINTS, SOLE_STIFFNESS, 0, SOLE_HOLD, SOLE_DRAG, 0.8},
             {HIMC_SEAT_POINTS + HIMC_SOLE_POINTS, HIMC_SOLE_POINTS, SOLE_STIFFNESS, 0, SOLE_HOLD,
              SOLE_DRAG, 0.8}};
#define PATCHES ((int)(sizeof patch / sizeof *patch))

// the pressure on a point, and on a hollow the force towards its bottom; a thigh that moves with
// its foot slides over the cushion
static double press_down(himc_support_point *p, int k, himc_vec3 place, double velocity)
{
    double x = place.x - p->home.x, y = place.y - p->home.y,
           curvature = p->slides ? 0 : patch[k].curvature;
    double depth = fmax(p->plane + 0.5 * curvature * (x * x + y * y) - place.z, 0);
    double force = patch[k].stiffness * depth * sqrt(depth) * fmax(1 - DAMPING * velocity, 0);
    p->force = himc_vec3_make(-force * curvature * x, -force * curvature * y, force);
    return force;
}

// by which share of a horizontal force a patch holds less
static double too_much(himc_vec3 force, double most)
{
    double along = hypot(force.x, force.y);
    return along > most ? 1 - most / along : 0;
}

// of a point in what holds its patch
static double share_of(const himc_support_point *p, double all)
{
    return p->slides ? 0 : p->force.z / fmax(all, LEAST_PRESSURE);
}

// the forces of a patch whose points are at `place` and move at `velocity`; the anchors come along
// as soon as the springs alone would hold too much
static void press(himc_support_point *point, int k, const himc_vec3 *place,
                  const himc_vec3 *velocity)
{
    double all = 0;
    bool touched = point->touching;
    himc_vec3 held = {0, 0, 0}, sum = {0, 0, 0}, grip[HIMC_SUPPORTS];
    for (int i = 0; i < patch[k].count; i++) {
        double pressure = press_down(&point[i], k, place[i], velocity[i].z);
        all += point[i].slides ? 0 : pressure;
    }
    for (int i = 0; i < patch[k].count; i++) {
        himc_support_point *p = &point[i];
        double share = share_of(p, all);
        if (!touched || p->slides)
            p->anchor = place[i];
        p->touching = all > 0;
        held = himc_vec3_madd(held, share * patch[k].hold, himc_vec3_sub(p->anchor, place[i]));
    }
    double most = patch[k].friction * all;
    himc_vec3 slip = himc_vec3_scale(held, too_much(held, most) / patch[k].hold);
    for (int i = 0; i < patch[k].count; i++) {
        himc_support_point *p = &point[i];
        double share = share_of(p, all);
        p->anchor.x -= slip.x;
        p->anchor.y -= slip.y;
        himc_vec3 way = himc_vec3_sub(p->anchor, place[i]);
        grip[i] = himc_vec3_scale(
            himc_vec3_madd(himc_vec3_scale(way, patch[k].hold), -patch[k].drag, velocity[i]),
            share);
        sum = himc_vec3_add(sum, grip[i]);
    }
    double less = too_much(sum, most);
    for (int i = 0; i < patch[k].count; i++) {
        double share = share_of(&point[i], all);
        point[i].force.x += grip[i].x - share * less * sum.x;
        point[i].force.y += grip[i].y - share * less * sum.y;
    }
}

void himc_support_slide(himc_support *s, const bool moves[HIMC_HANDS])
{
    for (int i = 0; i < HIMC_SEAT_POINTS; i++)
        s->point[i].slides = carrier_of(i) == THIGHS && moves[i / (HIMC_SEAT_POINTS / 2)];
}

void himc_support_press(himc_support *s, const himc_skeleton *skeleton,
                        const himc_body_state *state)
{
    himc_vec3 velocity[HIMC_SEGMENTS]; // of the joints of pelvis and legs
    velocity[0] = state->velocity;
    for (int i = HIMC_LEFT_UPPER_LEG; i < HIMC_SEGMENTS; i++) {
        int p = skeleton->segment[i].parent;
        himc_vec3 r = himc_vec3_sub(state->origin[i], state->origin[p]);
        velocity[i] = himc_vec3_add(velocity[p], himc_vec3_cross(state->spin[p], r));
    }
    himc_vec3 place[HIMC_SUPPORTS], moving[HIMC_SUPPORTS];
    for (int i = 0; i < HIMC_SUPPORTS; i++) {
        himc_support_point *p = &s->point[i];
        himc_vec3 r = himc_mat3_apply(&state->rotation[p->segment], p->at);
        place[i] = himc_vec3_add(state->origin[p->segment], r);
        moving[i] =
            himc_vec3_add(velocity[p->segment], himc_vec3_cross(state->spin[p->segment], r));
        p->lever = himc_vec3_sub(place[i], state->origin[0]);
    }
    for (int k = 0; k < PATCHES; k++) {
        int i = patch[k].first;
        press(&s->point[i], k, &place[i], &moving[i]);
    }
}
