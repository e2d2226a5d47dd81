/// muscle.c: at contact, hold: tau = tau_a + tau_i.
///
/// A servo that reacts at once takes the blow out of a stick by the least motion of all joints, and
/// so by the shoulder, with hundreds of N m within a millisecond. A muscle needs 40 ms to its full
/// force and a contact lasts 7. So from the first force on the active part tau_a follows what the
/// law asks for by no more than strength / 40 ms, and what is missing then is co-contraction tau_i:
/// the stiffness of muscles that pull on both sides of a joint, at once, but with a small share of
/// the strength. After the separation that share grows evenly until the law has its torques back:
/// a slow and then fast return is a blow of its own, which the waist has to bear. At all other
/// times a muscle follows: a lag of the whole torque would make a servo of 20 Hz unstable.
///
/// The torques of an arm go together: where one joint is behind, all are by the same share. Else
/// what the elbow no longer gives against the shoulder whirls the upper arm about its length, by
/// 2500 degrees a second.
///
/// Co-contracted muscles also resist the joint's speed: in a contact, and while the tip is astray
/// and the arm draws on its reserve.
#include "control/muscle.h"

#include "body/dynamics.h"

#define ACTIVATION 0.040 // to full strength (s); voluntary contractions take 40 to 100 ms
#define RECOVERY 0.020   // after a contact (s); chosen: less is a jerk, more lets the tip go astray
#define RECOVERED 2.0    // of the strength, which co-contraction then may have: any change at all
// co-contraction over strength from shoulder to grip; chosen: slow heavy joints are soft
static const double shares[HIMC_ARM_JOINTS] = {0.20, 0.25, 0.25, 0.25};
// torque over speed of co-contracted muscles from shoulder to grip (N m s/rad); chosen: without it
// an arm that is nearly straight is whirled about its length, where it is light
static const double viscosity[HIMC_ARM_JOINTS] = {6, 3, 0.3, 0.03};

void himc_muscles_rest(himc_muscles *m)
{
    *m = (himc_muscles){.since = {HUGE_VAL, HUGE_VAL}};
}

// what a change of torque may be, over what it is; no strength: no bound
static double over(double strength, double share, himc_vec3 missing)
{
    return strength > 0 ? share * strength / himc_vec3_length(missing) : HUGE_VAL;
}

static void hold(himc_muscles *m, himc_hand hand, double more, const himc_muscle_input *in,
                 himc_vec3 torque[HIMC_JOINTS])
{
    double rise = 1, share = 1;
    himc_vec3 missing[HIMC_ARM_JOINTS];
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        int j = himc_arm_joint(hand, k);
        missing[k] = himc_vec3_sub(torque[j], m->active[j]);
        rise = fmin(rise, over(in->strength[j], in->h / ACTIVATION, missing[k]));
    }
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        int j = himc_arm_joint(hand, k);
        m->active[j] = himc_vec3_madd(m->active[j], in->strength[j] > 0 ? rise : 1, missing[k]);
        missing[k] = himc_vec3_sub(torque[j], m->active[j]);
        share = fmin(share, over(in->strength[j], shares[k] + more, missing[k]));
    }
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        int j = himc_arm_joint(hand, k);
        torque[j] = himc_vec3_madd(m->active[j], share, missing[k]);
        m->co_contraction[j] =
            in->strength[j] > 0 ? share * himc_vec3_length(missing[k]) / in->strength[j] : 0;
    }
}

// Muscles that pull on both sides of a joint resist its speed, whatever is asked of them: c times
// what the rate misses at the end of the step, for a stick about its length is light.
static void resist(himc_muscles *m, himc_hand hand, double tense, const himc_muscle_input *in,
                   himc_vec3 torque[HIMC_JOINTS])
{
    for (int k = 0; tense > 0 && k < HIMC_ARM_JOINTS; k++) {
        int j = himc_arm_joint(hand, k);
        if (in->strength[j] <= 0)
            continue;
        // (h A + 1/c)^-1 rate, with the acceleration A t of a limb under a torque t
        double l = 1 / (in->h * tense * viscosity[k]);
        himc_symmetric sum = himc_symmetric_plus(&in->art->inverse[j + 1], l);
        sum = himc_symmetric_inverse(&sum);
        himc_vec3 brakes = himc_vec3_scale(himc_symmetric_apply(&sum, in->rate[j]), 1 / in->h);
        brakes = himc_vec3_scale(brakes, fmin(over(in->strength[j], 1, brakes), 1));
        torque[j] = himc_vec3_add(torque[j], brakes);
        m->co_contraction[j] += himc_vec3_length(brakes) / in->strength[j];
    }
}

void himc_muscles_act(himc_muscles *m, const himc_muscle_input *in, himc_vec3 torque[HIMC_JOINTS])
{
    for (int i = 0; i < HIMC_HANDS; i++) {
        himc_hand hand = (himc_hand)i;
        m->since[hand] = in->struck[hand] ? 0 : m->since[hand] + in->h;
        double u = m->since[hand] / RECOVERY;
        if (u < 1)
            hold(m, hand, RECOVERED * u, in, torque);
        for (int k = 0; u >= 1 && k < HIMC_ARM_JOINTS; k++) {
            int j = himc_arm_joint(hand, k);
            m->active[j] = torque[j];
            m->co_contraction[j] = 0;
        }
        resist(m, hand, u < 1 ? 1 : fmin(in->reserve[hand] - 1, 1), in, torque);
    }
}
