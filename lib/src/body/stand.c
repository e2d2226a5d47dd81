/// stand.c: balance on two feet.
///
/// Only the pressure under his feet moves a standing player's centre of mass c. With p the centre
/// of pressure, both from the middle of the soles, and z the height of c,
///     c'' = g/z (c - p)
/// (the linear inverted pendulum: Kajita et al. 2001). He wants c'' = -w^2 c - 2 w c', so p is to
/// be at c - z/g c'', as far as the soles reach. Ankles turn the feet until it is: a foot whose
/// toes go down has the pressure at its toes. Sideways the legs lean, too. Hips keep the pelvis
/// upright. A blow of the arms so reaches the ground, and when the trunk leans forwards the hips go
/// back.
///
/// All this moves both legs alike; the difference between them is left to the posture, since a leg
/// that carries nothing would swing where it likes. How thighs and shanks accelerate is taken from
/// the last step: that depends on the ground, too, and not only on the torques of the joints.
#include "body/stand.h"

#define SWAY 4.0     // w (rad/s); chosen: he is back in half a second
#define UPRIGHT 3.0  // of the pelvis (Hz); chosen
#define FOOT 6.0     // of the centre of pressure (Hz); chosen: faster than he sways
#define TILT 8000.0  // moment of the floor over the soles' angle (N m/rad); from support.c
#define QUICKEST 1.0 // sway (m/s^2); chosen: the pressure moves 0.1 m
// how far from the middle of the soles the pressure is wanted at most; chosen: within the feet
#define SOLE_HALF 0.08    // to heels and toes (m)
#define FEET_HALF 0.10    // to the left and right (m)
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

void himc_stand_feel(himc_stand *b, const himc_support *support, const himc_skeleton *skeleton,
                     const himc_body_state *s)
{
    double weight = 0;
    himc_vec3 middle = {0, 0, 0}, pressed = {0, 0, 0};
    b->standing = support->standing;
    if (!b->standing)
        return;
    for (int i = HIMC_SEAT_POINTS; i < HIMC_SUPPORTS; i++) {
        const himc_support_point *p = &support->point[i];
        middle = himc_vec3_madd(middle, 1.0 / (2 * HIMC_SOLE_POINTS), p->lever);
        pressed = himc_vec3_madd(pressed, p->force.z, p->lever);
        weight += p->force.z;
    }
    b->weight = fmax(weight, LEAST_WEIGHT);
    b->over = himc_vec3_sub(find_center(skeleton, s, &b->moving), middle);
    b->pressed = himc_vec3_scale(himc_vec3_madd(pressed, -weight, middle), 1 / b->weight);
}

// to the middle of the soles (m/s^2)
static himc_vec3 sway(const himc_stand *b)
{
    himc_vec3 a = himc_vec3_madd(himc_vec3_scale(b->over, -SWAY * SWAY), -2 * SWAY, b->moving);
    a.z = 0;
    double size = himc_vec3_length(a);
    return himc_vec3_scale(a, size > QUICKEST ? QUICKEST / size : 1);
}

// the feet's angular acceleration that brings the pressure to where that sway needs it
static himc_vec3 turn_feet(const himc_stand *b, himc_vec3 a, himc_vec3 spin)
{
    double w = 2 * HIMC_PI * FOOT;
    himc_vec3 p = himc_vec3_madd(b->over, -b->over.z / HIMC_GRAVITY, a);
    himc_vec3 off = {fmin(fmax(p.x, -SOLE_HALF), SOLE_HALF) - b->pressed.x,
                     fmin(fmax(p.y, -FEET_HALF), FEET_HALF) - b->pressed.y, 0};
    himc_vec3 more = himc_vec3_scale(himc_vec3_cross(up, off), b->weight / TILT);
    return himc_vec3_madd(himc_vec3_scale(more, w * w), -2 * w, spin);
}

static himc_vec3 mean(const himc_vec3 *pair)
{
    return himc_vec3_scale(himc_vec3_add(pair[HIMC_LEFT], pair[HIMC_RIGHT]), 0.5);
}

void himc_stand_legs(himc_stand *b, const himc_body_state *s, himc_vec3 pelvis,
                     himc_vec3 wanted[HIMC_JOINTS])
{
    double w = 2 * HIMC_PI * UPRIGHT;
    himc_vec3 a = sway(b), knees = mean(&wanted[KNEE]);
    himc_vec3 tilt = himc_quat_log(s->orientation[HIMC_PELVIS]), spin = s->spin[HIMC_PELVIS];
    himc_vec3 upright = himc_vec3_madd(himc_vec3_scale(tilt, -w * w), -2 * w, spin);
    himc_vec3 usual_hips = mean(&wanted[HIP]), usual_ankles = mean(&wanted[ANKLE]);
    himc_vec3 thighs = himc_vec3_add(pelvis, b->hips);
    himc_vec3 hips = himc_vec3_sub(thighs, upright);
    hips.x = usual_hips.x - a.y / b->over.z;
    hips.z = usual_hips.z;
    himc_vec3 feet = turn_feet(b, a, mean(&s->spin[HIMC_LEFT_FOOT]));
    himc_vec3 shanks = himc_vec3_add(himc_vec3_add(pelvis, hips), knees);
    himc_vec3 ankles = himc_vec3_sub(feet, shanks);
    ankles.z = usual_ankles.z;
    b->hips = hips;
    for (int i = 0; i < HIMC_HANDS; i++) {
        wanted[HIP + i] = himc_vec3_add(wanted[HIP + i], himc_vec3_sub(hips, usual_hips));
        wanted[ANKLE + i] = himc_vec3_add(wanted[ANKLE + i], himc_vec3_sub(ankles, usual_ankles));
    }
}
