/// stand.c: balance on two feet.
///
/// Only the pressure under his feet moves a standing player's centre of mass c. With p the centre
/// of pressure, both from the middle of the soles, z the height of c and c0 where c is wanted,
///     c'' = g/z (c - p)
/// (the linear inverted pendulum: Kajita et al. 2001). He wants c'' = -w^2 (c - c0) - 2 w c', so p
/// is to be at c - z/g c'', within the soles. Two rotations bring it there: the feet's (toes down:
/// p goes forwards) and the pelvis' to the side (it loads the foot on the lower side). Forwards the
/// hips keep the pelvis upright. So a blow of the arms reaches the ground.
///
/// c0 is c with the pelvis at its place, so the hips stay where he leans to a drum; but it keeps
/// off the edge of the soles, and then the hips go to the other side.
///
/// Both legs get the same correction; their difference is the soft posture's, since a leg without
/// load has nothing else to go by. So a foot that is pushed up by 20 N can make him fall. How
/// thighs and shanks accelerate is taken from the last step: that depends on the ground, too, and
/// not only on the torques of the joints.
#include "body/stand.h"

#define SWAY 4.0    // w (rad/s); chosen: back at c0 in half a second
#define UPRIGHT 3.0 // of the pelvis (Hz); chosen
#define FOOT 6.0    // of the centre of pressure by the feet (Hz); chosen: faster than he sways
#define LOAD 9.0   // of the same by the pelvis (Hz); chosen: a foot that has left the floor is back
#define FOLLOW 3.0 // of c0 (1/s); chosen: slower than he sways
#define QUICKEST 1.0 // c'' (m/s^2); chosen: the pressure moves 0.1 m
// of the floor under both soles; from support.c
#define TILT 8000.0     // moment over their angle (N m/rad)
#define PRESS 7.1e5     // force over their depth (N/m)
#define SOLE_HALF 0.095 // the pressure is wanted at most so far to heels and toes (m); chosen
// c0 is at most so far from the middle of the soles; chosen: half of them is left for blows
#define GOAL_AHEAD 0.04   // (m)
#define GOAL_ASIDE 0.06   // (m)
#define CLOSED 0.05       // feet that are nearer to each other count as so far apart (m); chosen
#define LEAST_WEIGHT 50.0 // of feet that have hardly any ground (N); chosen
enum { HIP = HIMC_LEFT_UPPER_LEG - 1, KNEE = HIMC_LEFT_LOWER_LEG - 1, ANKLE = HIMC_LEFT_FOOT - 1 };

static const himc_vec3 up = {0, 0, 1};

// the centre of mass from the hips (m), and its velocity (m/s)
static himc_vec3 find_center(const himc_skeleton *skeleton, const himc_body_state *s,
                             himc_vec3 *moving)
{
    double mass = 0;
    himc_vec3 velocity[HIMC_SEGMENTS], center = {0, 0, 0}, momentum = {0, 0, 0}; // of the joints
    for (int i = 0; i < HIMC_SEGMENTS; i++) {
        const himc_segment *segment = &skeleton->segment[i];
        int p = segment->parent;
        velocity[i] = s->velocity;
        if (p >= 0) {
            himc_vec3 r = himc_vec3_sub(s->origin[i], s->origin[p]);
            velocity[i] = himc_vec3_add(velocity[p], himc_vec3_cross(s->spin[p], r));
        }
        himc_vec3 c = himc_mat3_apply(&s->rotation[i], segment->center);
        himc_vec3 v = himc_vec3_add(velocity[i], himc_vec3_cross(s->spin[i], c));
        himc_vec3 r = himc_vec3_add(himc_vec3_sub(s->origin[i], s->origin[0]), c);
        center = himc_vec3_madd(center, segment->mass, r);
        momentum = himc_vec3_madd(momentum, segment->mass, v);
        mass += segment->mass;
    }
    *moving = himc_vec3_scale(momentum, 1 / mass);
    return himc_vec3_scale(center, 1 / mass);
}

static double within(double x, double most)
{
    return fmin(fmax(x, -most), most);
}

void himc_stand_feel(himc_stand *b, const himc_support *support, const himc_skeleton *skeleton,
                     const himc_body_state *s)
{
    double weight = 0;
    himc_vec3 middle = {0, 0, 0}, pressed = {0, 0, 0};
    const himc_support_point *sole = &support->point[HIMC_SEAT_POINTS];
    b->standing = support->standing;
    if (!b->standing)
        return;
    for (int i = 0; i < 2 * HIMC_SOLE_POINTS; i++) {
        middle = himc_vec3_madd(middle, 1.0 / (2 * HIMC_SOLE_POINTS), sole[i].lever);
        pressed = himc_vec3_madd(pressed, sole[i].force.z, sole[i].lever);
        weight += sole[i].force.z;
    }
    b->weight = fmax(weight, LEAST_WEIGHT);
    b->aside = 0.5 * (sole[0].lever.y - sole[HIMC_SOLE_POINTS].lever.y);
    b->over = himc_vec3_sub(find_center(skeleton, s, &b->moving), middle);
    b->stays = himc_vec3_make(within(b->over.x + middle.x - support->soles_ahead, GOAL_AHEAD),
                              within(b->over.y + middle.y, GOAL_ASIDE), 0);
    b->pressed = himc_vec3_scale(himc_vec3_madd(pressed, -weight, middle), 1 / b->weight);
}

// to its goal (m/s^2)
static himc_vec3 sway(const himc_stand *b)
{
    himc_vec3 off = himc_vec3_sub(b->over, b->goal);
    himc_vec3 a = himc_vec3_madd(himc_vec3_scale(off, -SWAY * SWAY), -2 * SWAY, b->moving);
    a.z = 0;
    double size = himc_vec3_length(a);
    return himc_vec3_scale(a, size > QUICKEST ? QUICKEST / size : 1);
}

// from the centre of pressure to where that sway needs it (m)
static himc_vec3 pressure_off(const himc_stand *b, himc_vec3 a)
{
    himc_vec3 p = himc_vec3_madd(b->over, -b->over.z / HIMC_GRAVITY, a);
    return himc_vec3_make(within(p.x, SOLE_HALF) - b->pressed.x,
                          within(p.y, b->aside) - b->pressed.y, 0);
}

static himc_vec3 mean(const himc_vec3 *pair)
{
    return himc_vec3_scale(himc_vec3_add(pair[HIMC_LEFT], pair[HIMC_RIGHT]), 0.5);
}

// critically damped, to an angle off (rad/s^2)
static himc_vec3 turn(himc_vec3 angle, himc_vec3 spin, double frequency)
{
    double w = 2 * HIMC_PI * frequency;
    return himc_vec3_madd(himc_vec3_scale(angle, w * w), -2 * w, spin);
}

void himc_stand_legs(himc_stand *b, const himc_body_state *s, himc_vec3 pelvis, double step,
                     himc_vec3 wanted[HIMC_JOINTS])
{
    double aside = fmax(b->aside, CLOSED);
    b->goal = himc_vec3_madd(b->goal, step * FOLLOW, himc_vec3_sub(b->stays, b->goal));
    himc_vec3 knees = mean(&wanted[KNEE]), spin = s->spin[HIMC_PELVIS];
    himc_vec3 usual_hips = mean(&wanted[HIP]), usual_ankles = mean(&wanted[ANKLE]);
    himc_vec3 moment = himc_vec3_scale(himc_vec3_cross(up, pressure_off(b, sway(b))), b->weight);
    himc_vec3 upright =
        turn(himc_vec3_scale(himc_quat_log(s->orientation[HIMC_PELVIS]), -1), spin, UPRIGHT);
    himc_vec3 load = turn(himc_vec3_scale(moment, 1 / (PRESS * aside * aside)), spin, LOAD);
    himc_vec3 feet = turn(himc_vec3_scale(moment, 1 / TILT), mean(&s->spin[HIMC_LEFT_FOOT]), FOOT);
    himc_vec3 thighs = himc_vec3_add(pelvis, b->hips);
    himc_vec3 hips = {thighs.x - load.x, thighs.y - upright.y, usual_hips.z};
    himc_vec3 shanks = himc_vec3_add(himc_vec3_add(pelvis, hips), knees);
    himc_vec3 ankles = himc_vec3_sub(feet, shanks);
    ankles.z = usual_ankles.z;
    b->hips = hips;
    for (int i = 0; i < HIMC_HANDS; i++) {
        wanted[HIP + i] = himc_vec3_add(wanted[HIP + i], himc_vec3_sub(hips, usual_hips));
        wanted[ANKLE + i] = himc_vec3_add(wanted[ANKLE + i], himc_vec3_sub(ankles, usual_ankles));
    }
}
