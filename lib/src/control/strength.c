/// strength.c: torque maxima, in the 2012 paper a feature of its physics engine (section 3.3).
///
/// There each axis of a motor has its own maximum; here a joint's torque keeps its direction and is
/// shortened, so that a weak joint pulls weakly but in the right direction. Measured isometric maxima: neck
/// 51 N m backwards, 30 forwards (Fice, Siegmund & Blouin 2014, men); shoulder 68 +- 28, wrist 10
/// +- 5 (Holzbaur, Delp, Gold & Murray 2007, women and men); wrist 12 in flexion, 7 in extension,
/// 11 sideways (Delp, Grierson & Buchanan 1996, men). Those for a man of 75 kg are taken from their
/// upper half; the elbow's stands near the shoulder's, the fingers' on a thin stick, the trunk's
/// and the legs' are round figures of the size dynamometers show.
#include "control/strength.h"

#define MEASURED_MASS 75.0 // of the man of the table (kg)

// isometric maxima (N m), see above
static double measured(int joint)
{
    static const double spine[3] = {250, 50, 50},     // waist, neck, head
        limb[8] = {80, 70, 12, 5, 200, 200, 130, 15}; // shoulder .. grip, hip .. toes
    return joint < 3 ? spine[joint] : limb[(joint - 3) / 2];
}

void himc_controller_set_human_strength(himc_controller_config *c, double mass)
{
    c->human_strength = true;
    for (int j = 0; j < HIMC_JOINTS; j++)
        c->strength[j] = measured(j) * mass / MEASURED_MASS;
}

void himc_strength_apply(const himc_controller *c, himc_vec3 torque[HIMC_JOINTS])
{
    for (int j = 0; j < HIMC_JOINTS; j++) {
        double asked = himc_vec3_length(torque[j]), most = c->config.strength[j];
        bool weak = most > 0 && asked > most;
        if (weak)
            torque[j] = himc_vec3_scale(torque[j], most / asked);
        if (c->saturation) {
            c->saturation->torque[j] = fmax(c->saturation->torque[j], asked);
            c->saturation->weak[j] += weak;
        }
    }
    if (c->saturation)
        c->saturation->steps++;
}
