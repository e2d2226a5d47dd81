/// muscle.c: at contact, hold: tau = tau_a + tau_i.
///
/// A servo that reacts at once takes the blow out of a stick by the least motion of all joints, and
/// so by the shoulder, with hundreds of N m within a millisecond. A muscle needs 40 ms to its full
/// force and a contact lasts 7. So from the first force on the active part tau_a follows what the
/// law asks for by no more than strength / 40 ms, and what is missing then is co-contraction tau_i:
/// the stiffness of muscles that pull on both sides of a joint, at once, but with a small share of
/// the strength. After the separation that share grows until the law has its torques back. At all
/// other times a muscle follows: a lag of the whole torque would make a servo of 20 Hz unstable.
#include "control/muscle.h"

#define ACTIVATION 0.040 // to full strength (s); voluntary contractions take 40 to 100 ms
#define RECOVERY 0.020   // after a contact (s); chosen: less is a jerk, more lets the tip go astray
#define RECOVERED 4.0    // of the strength, which co-contraction then may have; chosen: all
// co-contraction over strength at waist, neck and head and from shoulder to grip; chosen: slow
// heavy joints are soft
static const double trunk_share = 0.10, arm_share[HIMC_ARM_JOINTS] = {0.20, 0.25, 0.25, 0.25};

void himc_muscles_rest(himc_muscles *m)
{
    *m = (himc_muscles){.since = {HUGE_VAL, HUGE_VAL}};
}

static himc_vec3 bounded(himc_vec3 v, double most)
{
    double length = himc_vec3_length(v);
    return length > most ? himc_vec3_scale(v, most / length) : v;
}

static void act(himc_muscles *m, int joint, double share, double strength, double h,
                himc_vec3 *torque)
{
    himc_vec3 *active = &m->active[joint], asked = *torque;
    m->co_contraction[joint] = 0;
    if (strength <= 0)
        return;
    himc_vec3 missing = himc_vec3_sub(asked, *active);
    *active = himc_vec3_add(*active, bounded(missing, strength * h / ACTIVATION));
    missing = bounded(himc_vec3_sub(asked, *active), share * strength);
    *torque = himc_vec3_add(*active, missing);
    m->co_contraction[joint] = himc_vec3_length(missing) / strength;
}

void himc_muscles_act(himc_muscles *m, const bool struck[HIMC_HANDS],
                      const double strength[HIMC_JOINTS], double h, himc_vec3 torque[HIMC_JOINTS])
{
    const int trunk = HIMC_LEFT_UPPER_ARM - 1; // joints before the arms'
    double more[HIMC_HANDS];                   // of co-contraction than in a contact
    bool slow[HIMC_HANDS];
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        m->since[hand] = struck[hand] ? 0 : m->since[hand] + h;
        double u = m->since[hand] / RECOVERY;
        slow[hand] = u < 1;
        more[hand] = RECOVERED * u * u;
    }
    for (int j = m->first; j < HIMC_LEFT_UPPER_LEG - 1; j++) {
        int hand = j < trunk ? more[HIMC_RIGHT] < more[HIMC_LEFT] : (j - trunk) % HIMC_HANDS;
        double share = j < trunk ? trunk_share : arm_share[(j - trunk) / HIMC_HANDS];
        if (slow[hand])
            act(m, j, share + more[hand], strength[j], h, &torque[j]);
        else
            m->active[j] = torque[j], m->co_contraction[j] = 0;
    }
}
