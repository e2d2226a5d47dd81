/// pedal.c: a seated player's foot goes to the pedal of a drum and turns with it.
///
/// The pedal is a plate below the drum's edge that points to the player, hinged on the floor at its
/// end on his side. There the heel rests, and the ball of the foot turns with the plate. A foot is
/// its heel, its heading and its pitch, each on a quintic from rest to rest; on the way the heel is
/// lifted by a bump that begins and ends with its acceleration 0. Hip, knee and ankle follow from
/// them: the triangle of thigh and shank stands upright over the line from hip to ankle, the ankle
/// does the rest. Where captured legs rest otherwise, that difference goes away on the way.
///
/// Balance: without that foot the cushion gives way, and he tips towards it. So his trunk leans
/// away until it is back, and the foot is aimed at the floor and not at his pelvis, which tilts. On
/// the floor the leg goes with the pelvis again: a foot that kept its place would push him up.
#include "body/pedal.h"

#include "body/support.h"

#include <math.h>

#define HINGE_BESIDE 0.07  // of the hinge, outside the head's edge (m); chosen, as it is drawn
#define NEAREST_HINGE 0.12 // before the hips (m); chosen: clear of the stool
#define LEFT_FROM 0.2      // azimuth of drums whose pedal is the left foot's (rad); chosen
// the leg on a pedal; chosen: not quite straight, thighs as far apart as in a straddle
#define LONGEST 0.985
#define OUTWARDS 1.0 // of the leg (rad)
#define INWARDS 0.5  // (rad)
// the pedal; chosen: 60 mm at the ball of the foot between the lowest and the highest pitch
#define MIDDLE 0.22    // (rad)
#define HALF_TURN 0.15 // (rad)
#define PER_OCTAVE 1.5 // of its turn, near the usual pitch
// a leg makes up for the sway of the pelvis while its foot is on its way; chosen
#define FOLLOWS 40.0      // (1/s)
#define FADES 12.0        // afterwards, as the foot takes its load (1/s) ...
#define SETTLES 0.8       // ... during that time (s)
#define LONGEST_STEP 0.02 // after a time without ticks (s)
#define STABLE 0.5        // rate of the filter times its step; from 0.7 on it grows
// the trunk leans away from a foot that is lifted; measured: the seat then slips least
#define LEANS_BACK 0.12  // (rad)
#define LEANS_ASIDE 0.09 // (rad)
#define LEANS_MORE 0.24  // with the way of the foot (rad/m)
#define LIFTED 0.02      // of the heel on the way (m); chosen

static const himc_vec3 sole = {-HIMC_SOLE_BEHIND, 0, -HIMC_ANKLE_HEIGHT}; // heel from the ankle

/// Of one foot.
typedef struct placed {
    himc_vec3 heel;
    double heading, pitch;
} placed;

static himc_quat about(double x, double y, double z)
{
    return himc_quat_exp(himc_vec3_make(x, y, z));
}

static himc_vec3 hip_of(const himc_posture *posture, himc_hand side)
{
    const himc_segment *s = posture->skeleton.segment;
    return himc_vec3_add(s[HIMC_PELVIS].origin, s[HIMC_LEFT_UPPER_LEG + side].origin);
}

static himc_quat foot_of(const placed *p)
{
    return himc_quat_mul(about(0, 0, p->heading), about(0, -p->pitch, 0));
}

// from the hip to the ankle
static himc_vec3 leg_to(const himc_posture *posture, himc_hand side, himc_vec3 heel, himc_quat foot)
{
    himc_vec3 ankle = himc_vec3_sub(heel, himc_quat_rotate(foot, sole));
    return himc_vec3_sub(ankle, hip_of(posture, side));
}

typedef struct leg {
    himc_quat joint[3]; // hip, knee, ankle
} leg;

static int joint_of(himc_hand side, int k)
{
    return HIMC_LEFT_UPPER_LEG - 1 + HIMC_HANDS * k + (int)side;
}

static leg solve_leg(const himc_posture *posture, himc_hand side, himc_vec3 heel, himc_quat foot)
{
    himc_vec3 r = leg_to(posture, side, heel, foot);
    double thigh = posture->skeleton.segment[HIMC_LEFT_UPPER_LEG].length,
           shank = posture->skeleton.segment[HIMC_LEFT_LOWER_LEG].length,
           length = fmin(himc_vec3_length(r), thigh + shank);
    double raise = himc_corner(thigh, length, shank) + atan2(hypot(r.x, r.y), -r.z);
    double knee = HIMC_PI - himc_corner(thigh, shank, length);
    leg l = {{himc_quat_mul(about(0, 0, atan2(r.y, r.x)), about(0, -raise, 0)), about(0, knee, 0)}};
    himc_quat shin = himc_quat_mul(l.joint[0], l.joint[1]);
    l.joint[2] = himc_quat_mul(himc_quat_conj(shin), foot);
    return l;
}

static placed resting(const himc_posture *posture, himc_hand side)
{
    himc_vec3 at = hip_of(posture, side);
    himc_quat q = {1, 0, 0, 0};
    for (int k = 0; k < 3; k++) {
        int j = joint_of(side, k);
        if (k > 0)
            at = himc_vec3_add(at, himc_quat_rotate(q, posture->skeleton.segment[j + 1].origin));
        q = himc_quat_mul(q, posture->rest.joint[j]);
    }
    himc_vec3 ahead = himc_quat_rotate(q, himc_vec3_make(1, 0, 0));
    return (placed){himc_vec3_add(at, himc_quat_rotate(q, sole)), atan2(ahead.y, ahead.x),
                    asin(fmin(fmax(ahead.z, -1), 1))};
}

double himc_pedal_angle(double octaves)
{
    return MIDDLE - HALF_TURN * tanh(PER_OCTAVE * octaves);
}

bool himc_pedal_of(const himc_posture *posture, const himc_head_frame *head, himc_pedal *pedal)
{
    double azimuth = atan2(head->center.y, head->center.x),
           far = hypot(head->center.x, head->center.y) - head->radius - HINGE_BESIDE;
    pedal->foot = azimuth > LEFT_FROM ? HIMC_LEFT : HIMC_RIGHT;
    pedal->heading = azimuth;
    pedal->heel = himc_vec3_make(far * cos(azimuth), far * sin(azimuth), 0);
    bool good = far > NEAREST_HINGE;
    double thigh = posture->skeleton.segment[HIMC_LEFT_UPPER_LEG].length,
           shank = posture->skeleton.segment[HIMC_LEFT_LOWER_LEG].length;
    for (int end = -1; end <= 1; end += 2) {
        placed p = {pedal->heel, azimuth, MIDDLE + end * HALF_TURN};
        himc_vec3 r = leg_to(posture, pedal->foot, p.heel, foot_of(&p));
        double out = atan2(pedal->foot == HIMC_LEFT ? r.y : -r.y, r.x);
        good = good && himc_vec3_length(r) < LONGEST * (thigh + shank) && out < OUTWARDS &&
               out > -INWARDS;
    }
    return good;
}

static himc_target course_at(const himc_pedal_course *c, double t)
{
    return himc_quintic_at(&c->x, fmin(fmax(t - c->begun, -HIMC_DIFFERENCE_STEP), c->takes));
}

static bool is_over(const himc_pedal_course *c, double t)
{
    return c->takes <= 0 || t >= c->begun + c->takes;
}

// from where it is at `t`
static void steer(himc_pedal_course *c, const himc_target *from, himc_vec3 to, double t,
                  double seconds)
{
    himc_target end = himc_target_at_rest(to);
    *c = (himc_pedal_course){t, seconds, himc_quintic_make(from, &end, seconds)};
}

bool himc_pedal_moves(const himc_pedal_foot *f, himc_hand side, double t)
{
    return side == f->foot && (f->away || !is_over(&f->heel, t - SETTLES));
}

// the bump and its derivatives
static himc_target lift(double u, double takes)
{
    double b = u * (1 - u), slope = 1 - 2 * u, k = 64 * LIFTED;
    return himc_target_along(himc_vec3_make(0, 0, 1), k * b * b * b, 3 * k * b * b * slope / takes,
                             6 * k * b * (slope * slope - b) / (takes * takes));
}

static himc_target heel_at(const himc_pedal_foot *f, double t)
{
    himc_target x = course_at(&f->heel, t);
    double u = (t - f->heel.begun) / f->heel.takes;
    return u <= 0 || is_over(&f->heel, t) ? x : himc_target_add(x, lift(u, f->heel.takes));
}

void himc_pedal_press(himc_pedal_foot *f, double angle, double t, double seconds)
{
    himc_target from = course_at(&f->angle, t);
    steer(&f->angle, &from, himc_vec3_make(angle, 0, 0), t, seconds);
}

void himc_pedal_go(himc_pedal_foot *f, const himc_posture *posture, const himc_pedal *pedal,
                   double t)
{
    himc_hand side = pedal ? pedal->foot : f->foot;
    placed rest = resting(posture, side);
    bool moving = f->away || !is_over(&f->heel, t);
    himc_target heel = heel_at(f, t), turn = course_at(&f->turn, t);
    himc_vec3 at = rest.heel, turned = {rest.heading, 0, 0};
    f->away = pedal != NULL;
    f->foot = side;
    if (pedal) {
        double left = side == HIMC_LEFT ? 1 : -1;
        at = himc_vec3_make(pedal->heel.x, pedal->heel.y, fmin(rest.heel.z, 0));
        turned = himc_vec3_make(pedal->heading, 1, 0);
        f->back = LEANS_BACK + LEANS_MORE * (at.x - rest.heel.x);
        f->aside = left * LEANS_ASIDE + LEANS_MORE * (at.y - rest.heel.y);
    }
    if (!moving) {
        t += HIMC_PEDAL_LEAN;
        heel = himc_target_at_rest(rest.heel);
        turn = himc_target_at_rest(himc_vec3_make(rest.heading, 0, 0));
    }
    steer(&f->heel, &heel, at, t, HIMC_PEDAL_WAY);
    steer(&f->turn, &turn, turned, t, HIMC_PEDAL_WAY);
}

static himc_target after(const himc_target *x, himc_vec3 jerk, double dt)
{
    himc_target next = himc_target_after(x, dt);
    next.x = himc_vec3_madd(next.x, dt * dt * dt / 6, jerk);
    next.v = himc_vec3_madd(next.v, dt * dt / 2, jerk);
    next.a = himc_vec3_madd(next.a, dt, jerk);
    return next;
}

// of a critically damped motion of third order
static himc_vec3 jerk_to(const himc_target *x, himc_vec3 goal, double w)
{
    himc_vec3 off = himc_vec3_scale(himc_vec3_sub(goal, x->x), w * w * w);
    return himc_vec3_madd(himc_vec3_madd(off, -3 * w * w, x->v), -3 * w, x->a);
}

void himc_pedal_feel(himc_pedal_foot *f, const himc_body_state *s, himc_vec3 home, double t)
{
    double dt = fmin(t - f->felt, LONGEST_STEP), w = FADES;
    himc_vec3 sway = {0, 0, 0}, tilt = {0, 0, 0};
    f->sway = after(&f->sway, f->sway_jerk, dt);
    f->tilt = after(&f->tilt, f->tilt_jerk, dt);
    f->felt = t;
    if (!f->away && is_over(&f->heel, t)) // before, he would tip
        f->back = f->aside = 0;
    if (!himc_pedal_moves(f, f->foot, t)) {
        f->sway = f->tilt = himc_target_at_rest(sway);
    } else if (t >= f->heel.begun && !is_over(&f->heel, t)) { // and the filter's delay, 3 / w
        w = fmin(FOLLOWS, STABLE / fmax(dt, 1e-4));           // a slow task rate has long steps
        sway = himc_vec3_madd(himc_vec3_sub(s->origin[0], home), 3 / w, s->velocity);
        tilt = himc_vec3_madd(himc_quat_log(s->orientation[0]), 3 / w, s->spin[0]);
    }
    f->sway_jerk = jerk_to(&f->sway, sway, w);
    f->tilt_jerk = jerk_to(&f->tilt, tilt, w);
}

// the leg at `t`
static leg aim(const himc_pedal_foot *f, const himc_posture *posture, const placed *rest, double t)
{
    himc_vec3 home = posture->skeleton.segment[HIMC_PELVIS].origin, turn = course_at(&f->turn, t).x,
              sway = after(&f->sway, f->sway_jerk, t - f->felt).x,
              tilt = after(&f->tilt, f->tilt_jerk, t - f->felt).x,
              heel = himc_vec3_sub(himc_vec3_sub(heel_at(f, t).x, sway), home);
    himc_quat back = himc_quat_exp(himc_vec3_scale(tilt, -1));
    placed p = {himc_vec3_add(home, himc_quat_rotate(back, heel)), turn.x,
                rest->pitch + turn.y * (course_at(&f->angle, t).x.x - rest->pitch)};
    return solve_leg(posture, f->foot, p.heel, himc_quat_mul(back, foot_of(&p)));
}

void himc_pedal_leg(const himc_pedal_foot *f, const himc_posture *posture, double t,
                    himc_posture_motion *motion)
{
    if (!himc_pedal_moves(f, f->foot, t - HIMC_DIFFERENCE_STEP))
        return;
    himc_pose pose[3];
    placed rest = resting(posture, f->foot);
    leg natural = solve_leg(posture, f->foot, rest.heel, foot_of(&rest));
    for (int i = 0; i < 3; i++) {
        double at = t + (i - 1) * HIMC_DIFFERENCE_STEP;
        leg l = aim(f, posture, &rest, at);
        for (int k = 0; k < 3; k++) {
            int j = joint_of(f->foot, k);
            himc_quat own = himc_quat_mul(himc_quat_conj(natural.joint[k]), posture->rest.joint[j]);
            himc_vec3 left = himc_vec3_scale(himc_quat_log(own), 1 - course_at(&f->turn, at).x.y);
            pose[i].joint[j] = himc_quat_mul(l.joint[k], himc_quat_exp(left));
        }
    }
    for (int k = 0; k < 3; k++) {
        int j = joint_of(f->foot, k);
        himc_posture_differentiate(pose, HIMC_DIFFERENCE_STEP, j, j + 1, motion);
    }
}
