/// strength.c: torque maxima, in the 2012 paper a feature of its physics engine (section 3.3).
///
/// There each axis of a motor has its own maximum; here the length of a joint's torque has one. Of
/// all torques t of that length the one is given whose acceleration A t is nearest to that of the
/// torque asked for, t0, in the norm of 1/A: t = (A + l)^-1 A t0. So what is missing is missing
/// where the limb is heavy. If the torque kept its direction, an upper arm would whirl about its
/// own axis, where it is light.
///
/// Measured isometric maxima: neck 51 N m backwards, 30 forwards (Fice, Siegmund & Blouin 2014,
/// men); shoulder 68 +- 28, wrist 10 +- 5 (Holzbaur, Delp, Gold & Murray 2007, women and men);
/// wrist 12 in flexion, 7 in extension, 11 sideways (Delp, Grierson & Buchanan 1996, men). Those
/// for a man of 75 kg are taken from their upper half; the elbow's stands near the shoulder's, the
/// fingers' on a thin stick, the trunk's and the legs' are round figures of the size dynamometers
/// show.
///
/// A muscle that shortens pulls less, and at its highest speed not at all (Hill 1938). So a maximum
/// falls with the joint's speed v along the torque, most (1 - v/FASTEST), and no joint gets power
/// above FASTEST (fingers are faster): torques cut short one by one do not go together any more,
/// and without this such an arm whirled at 100 m/s. A torque against the motion keeps its maximum.
///
/// A stroke is not lost for want of strength: while a tip is astray, a reserve multiplies the
/// maxima of a man's arm and trunk, the more the farther. No man has it; it is counted, and `info`
/// tells it.
#include "control/strength.h"

#include "body/dynamics.h"
#include "control/balance.h"
#include "control/tracking_error.h"

#define MEASURED_MASS 75.0 // of the man of the table (kg)
#define STEPS 4            // to the shortened torque; five digits
#define FASTEST 20.0       // (rad/s) chosen: an elbow that has nothing to lift reaches about that
// of the fingers (rad/s): their flexors are 8 cm long, shorten by ten lengths a second (Zajac 1989)
// and pull 1 cm from the knuckles; a loud stroke turns its stick by 30
#define FASTEST_GRIP 80.0
// the reserve; chosen: calm strokes use none, and random ff strokes on four drums land
#define ASTRAY 0.006 // a tip farther from its target draws on it (m) ...
#define LOST 0.018   // ... and this far on all of it (m)
// strength with all of it, over a man's; measured: 8 moves him on his stool, 3 throws him off his
// feet
#define RESERVE 6.0
#define STANDING_RESERVE 2.0

void himc_controller_set_human_strength(himc_controller_config *c, double mass)
{
    // isometric maxima (N m), see above
    static const double spine[3] = {250, 50, 50},     // waist, neck, head
        limb[8] = {80, 70, 12, 5, 200, 200, 130, 15}; // shoulder .. grip, hip .. toes
    c->human_strength = true;
    for (int j = 0; j < HIMC_JOINTS; j++)
        c->strength[j] = (j < 3 ? spine[j] : limb[(j - 3) / 2]) * mass / MEASURED_MASS;
}

const himc_articulation *himc_strength_articulation(const himc_controller *c,
                                                    const himc_skeleton *skeleton,
                                                    const himc_body_state *s,
                                                    himc_articulation *own)
{
    if (c->articulation)
        return c->articulation;
    himc_articulate_upper(skeleton, s, own);
    return own;
}

double himc_strength_reserve(const himc_controller *c, const himc_reference *r,
                             const himc_body_state *s, himc_hand hand)
{
    double all = c->balance && c->balance->stand.standing ? STANDING_RESERVE : RESERVE;
    himc_vec3 off = himc_vec3_sub(r->tip[hand].x, s->tip[hand]), n = r->normal[hand];
    if (r->released[hand]) // along the normal the contact moves it
        off = himc_vec3_madd(off, -himc_vec3_dot(off, n), n);
    double u = fmin(fmax((himc_vec3_length(off) - ASTRAY) / (LOST - ASTRAY), 0), 1);
    return 1 + (all - 1) * u * u * (3 - 2 * u);
}

// of the joint's strength
static double reserve_of(int j, const double reserve[HIMC_HANDS])
{
    const int trunk = HIMC_LEFT_UPPER_ARM - 1, legs = HIMC_LEFT_UPPER_LEG - 1;
    if (j < trunk)
        return fmax(reserve[HIMC_LEFT], reserve[HIMC_RIGHT]);
    return j < legs ? reserve[(j - trunk) % HIMC_HANDS] : 1;
}

// (a + l)^-1 a t of length `most`; l by Newton's steps for 1/length, which rise to it
static himc_vec3 shorten(himc_vec3 asked, double most, const himc_symmetric *a)
{
    himc_vec3 accelerates = himc_symmetric_apply(a, asked), t = asked;
    double l = 0;
    for (int i = 0; most > 0 && i < STEPS; i++) {
        double length = himc_vec3_length(t);
        himc_symmetric sum = himc_symmetric_plus(a, l), inverse = himc_symmetric_inverse(&sum);
        double slope = himc_vec3_dot(t, himc_symmetric_apply(&inverse, t));
        l += length * length * (length - most) / (most * slope);
        sum = himc_symmetric_plus(a, l);
        inverse = himc_symmetric_inverse(&sum);
        t = himc_symmetric_apply(&inverse, accelerates);
    }
    return himc_vec3_scale(t, most / himc_vec3_length(t));
}

double himc_strength_most(const himc_controller *c, const himc_skeleton *skeleton,
                          const himc_body_state *s, int joint, const double reserve[HIMC_HANDS],
                          himc_vec3 torque)
{
    double asked = himc_vec3_length(torque), strength = c->config.strength[joint];
    if (strength <= 0 || asked <= 0)
        return HUGE_VAL;
    // what a muscle of this strength has left at the joint's speed along the torque
    double speed = himc_vec3_dot(himc_relative_spin(skeleton, s, joint), torque) / asked;
    bool fingers = joint == himc_arm_joint(HIMC_LEFT, HIMC_ARM_JOINTS - 1) ||
                   joint == himc_arm_joint(HIMC_RIGHT, HIMC_ARM_JOINTS - 1);
    double own = strength * fmin(fmax(1 - speed / (fingers ? FASTEST_GRIP : FASTEST), 0), 1);
    return own * reserve_of(joint, reserve);
}

bool himc_strength_bound(const himc_controller *c, const himc_skeleton *skeleton,
                         const himc_body_state *s, int joint, const double reserve[HIMC_HANDS],
                         himc_vec3 *torque)
{
    double asked = himc_vec3_length(*torque);
    double most = himc_strength_most(c, skeleton, s, joint, reserve, *torque);
    bool weak = asked * reserve_of(joint, reserve) > most;
    if (asked > most) {
        himc_articulation here;
        const himc_articulation *art = himc_strength_articulation(c, skeleton, s, &here);
        bool moves = joint + 1 < art->end; // else it is a leg of a fixed pelvis
        *torque = moves ? shorten(*torque, most, &art->inverse[joint + 1])
                        : himc_vec3_scale(*torque, most / asked);
    }
    return weak;
}

void himc_strength_apply(const himc_controller *c, const himc_skeleton *skeleton,
                         const himc_body_state *s, const double reserve[HIMC_HANDS],
                         himc_vec3 torque[HIMC_JOINTS])
{
    himc_saturation_counts *counts = c->saturation;
    for (int j = 0; j < HIMC_JOINTS; j++) {
        bool bounded = c->config.strength[j] > 0;
        double asked = himc_vec3_length(torque[j]);
        bool weak = bounded && himc_strength_bound(c, skeleton, s, j, reserve, &torque[j]);
        double given = bounded ? himc_vec3_length(torque[j]) : asked;
        if (!counts)
            continue;
        if (asked > counts->torque[j]) // fmax is a call, and NaN is no maximum either
            counts->torque[j] = asked;
        if (given > counts->given[j])
            counts->given[j] = given;
        counts->weak[j] += weak;
    }
    if (counts)
        counts->steps++;
}
