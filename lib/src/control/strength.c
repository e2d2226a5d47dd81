/// strength.c: torque maxima, in the 2012 paper a feature of its physics engine (section 3.3).
///
/// There each axis of a motor has its own maximum; here a joint's torque keeps its direction and is
/// shortened, so that a weak joint pulls weakly but in the right direction. Measured isometric
/// maxima: neck 51 N m backwards, 30 forwards (Fice, Siegmund & Blouin 2014, men); shoulder 68 +-
/// 28, wrist 10 +- 5 (Holzbaur, Delp, Gold & Murray 2007, women and men); wrist 12 in flexion, 7 in
/// extension, 11 sideways (Delp, Grierson & Buchanan 1996, men). Those for a man of 75 kg are taken
/// from their upper half; the elbow's stands near the shoulder's, the fingers' on a thin stick, the
/// trunk's and the legs' are round figures of the size dynamometers show.
///
/// A muscle that shortens pulls less, and at its highest speed not at all (Hill 1938). So a maximum
/// falls with the joint's speed v along the torque, most (1 - v/FASTEST), and no joint gets power
/// above FASTEST: torques cut short one by one do not go together any more, and without this such
/// an arm whirled at 100 m/s. A torque against the motion keeps its maximum.
#include "control/strength.h"

#include "control/tracking_error.h"

#define MEASURED_MASS 75.0 // of the man of the table (kg)
#define FASTEST 20.0       // (rad/s) chosen: an elbow that has nothing to lift reaches about that

void himc_controller_set_human_strength(himc_controller_config *c, double mass)
{
    // isometric maxima (N m), see above
    static const double spine[3] = {250, 50, 50},     // waist, neck, head
        limb[8] = {80, 70, 12, 5, 200, 200, 130, 15}; // shoulder .. grip, hip .. toes
    c->human_strength = true;
    for (int j = 0; j < HIMC_JOINTS; j++)
        c->strength[j] = (j < 3 ? spine[j] : limb[(j - 3) / 2]) * mass / MEASURED_MASS;
}

bool himc_strength_bound(const himc_controller *c, const himc_skeleton *skeleton,
                         const himc_body_state *s, int joint, himc_vec3 *torque)
{
    double asked = himc_vec3_length(*torque), strength = c->config.strength[joint];
    if (strength <= 0 || asked <= 0)
        return false;
    // what a muscle of this strength has left at the joint's speed along the torque
    double speed = himc_vec3_dot(himc_relative_spin(skeleton, s, joint), *torque) / asked;
    double most = strength * fmin(fmax(1 - speed / FASTEST, 0), 1);
    if (asked > most)
        *torque = himc_vec3_scale(*torque, most / asked);
    return asked > most;
}

void himc_strength_apply(const himc_controller *c, const himc_skeleton *skeleton,
                         const himc_body_state *s, himc_vec3 torque[HIMC_JOINTS])
{
    himc_saturation_counts *counts = c->saturation;
    for (int j = 0; j < HIMC_JOINTS; j++) {
        double asked = himc_vec3_length(torque[j]);
        bool weak = himc_strength_bound(c, skeleton, s, j, &torque[j]);
        if (!counts)
            continue;
        counts->torque[j] = fmax(counts->torque[j], asked);
        counts->weak[j] += weak;
    }
    if (counts)
        counts->steps++;
}
