/// performance_contacts.h: the contacts of sticks and heads in a performance.
#ifndef HIMC_PERFORMANCE_CONTACTS_H
#define HIMC_PERFORMANCE_CONTACTS_H

#include "himc/membrane.h"
#include "plan/bounce.h"
#include "performance/performance_body.h"
#include "performance/performance_clock.h"
#include "performance/performance_motion.h"
#include "performance/performance_statistics.h"

#define LONG_BLOCK 0.0015 // (s) chosen: 64 samples of 44.1 kHz
#define LONGEST_STEP 512  // samples of one physics step: 192 kHz at 500 Hz has 384

/// A hand's stick on a head.
typedef struct stick_contact {
    bool touching;      ///< from the first force to separation
    bool pressed;       ///< while touching: not a stroke of the plan, or one that stays
    bool told;          ///< while touching: the strike has been reported
    himc_bounce bounce; ///< of the last stroke
    double left;        ///< when the last contact ended (s)
    int drum;           ///< slot
    himc_stick stick;   ///< in micro-contact
    double x, y;        ///< of the tip over the head (m)
    double share;       ///< of the force that the body feels; the rest moves the mallet's mass
    double offset;      ///< of the stick's height from the body's tip (m); decays after contact
    double last_force;  ///< time of the last force (s)
    double peak_row;    ///< largest force since the last motion row (N)
    double impulse_row; ///< impulse since then (N s)
    himc_strike strike; ///< in progress
} stick_contact;

typedef struct performance_contacts {
    stick_contact hand[HIMC_HANDS];
    double force[HIMC_HANDS][LONGEST_STEP]; ///< of the last step (N)
    int force_count;                        ///< its samples
    double quiet; ///< since a stick was so near a head that its samples were made one by one (s)
} performance_contacts;

/// The parts that a contact changes: it ends a stroke, continues the plan and reports to the user.
typedef struct contact_scene {
    const performance_clock *clock;
    const performance_settings *settings;
    const performance_body *body;
    performance_drums *drums;
    performance_motion *motion;
    performance_statistics *statistics;
    performance_events *events;
} contact_scene;

/// Sets all sticks to the air, without a history; forces not yet played remain.
HIMC_RT void himc_contacts_clear(performance_contacts *contacts);
/// Finds the heads under the hands before the targets of the ticks at `t` and `next` are read.
HIMC_RT void himc_contacts_look_down(performance_contacts *contacts, const contact_scene *scene,
                                     double t, double next);
/// Decides for each hand at `t` whether control releases the head's normal; gives up strokes that
/// are past their contact time without a contact.
HIMC_RT void himc_contacts_release(performance_contacts *contacts, const contact_scene *scene,
                                   double t);
/// Advances all drums by `n` samples with the sticks on them; the forces on the tips (N).
HIMC_RT void himc_contacts_advance(performance_contacts *contacts, const contact_scene *scene,
                                   int n, himc_vec3 tip_force[HIMC_HANDS]);
/// Ends the contacts of sticks that have separated, at `t`.
HIMC_RT void himc_contacts_finish(performance_contacts *contacts, const contact_scene *scene,
                                  double t);

static inline bool himc_contacts_any(const performance_contacts *contacts)
{
    return contacts->hand[HIMC_LEFT].touching || contacts->hand[HIMC_RIGHT].touching;
}

/// True while contacts take most of the time of a host's block, whose samples are played together.
static inline bool himc_contacts_busy(const performance_contacts *contacts)
{
    return himc_contacts_any(contacts) || contacts->quiet < LONG_BLOCK;
}

/// Largest force (N) and impulse (N s) of a hand since the last call.
HIMC_RT void himc_contacts_take_row(performance_contacts *contacts, himc_hand hand, double *peak,
                                    double *impulse);
/// Energy stored in the felt of a hand's mallet (J).
HIMC_RT double himc_contacts_felt_energy(const performance_contacts *contacts, himc_hand hand);

#endif
