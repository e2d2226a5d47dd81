/// drum_performer.h: what a performer (performance/) needs of a drum beyond himc/drum.h: its sticks
/// in contact with the head, and the drum's place and mallet.
#ifndef HIMC_DRUM_PERFORMER_H
#define HIMC_DRUM_PERFORMER_H

#include "base/job.h"
#include "drum/ears.h"
#include "drum/membrane_form.h"
#include "himc/drum.h"

/// Forces from outside, one of each for a sample.
typedef struct himc_outside_force {
    const double *force; ///< (N, down positive), or NULL
    const double *x, *y; ///< where it acts (m), or NULL: the point stays
} himc_outside_force;

/// himc_drum_advance with sticks (0 .. HIMC_STICKS) in contact with the head.
/// @param sticks   evolve (membrane.h); may be NULL when count is 0
/// @param forces   forces[s][i] receives the force of stick s in sample i (N); NULL if unwanted
/// @param outside  or NULL
HIMC_RT void himc_drum_advance_sticks(himc_drum *drum, int n, himc_stick *const *sticks, int count,
                                      double *const *forces, const himc_outside_force *outside);

/// Who hears the drum by two ears: from now on they are its first two channels, instead of pickups.
/// A listener who is off, as at first, leaves them to the pickups. It changes over in 5 ms.
HIMC_RT void himc_drum_listen(himc_drum *drum, const himc_listener *listener);

/// True once the command `place` has set its place.
HIMC_RT bool himc_drum_is_placed(const himc_drum *drum);
/// Whether a drum may stand there: within 10 m of the origin on each axis.
bool himc_drum_check_place(himc_vec3 center, himc_error *error);
/// Brings the head to rest, without a click, and drops the drum's own mallets and waiting strikes.
HIMC_RT void himc_drum_rest(himc_drum *drum);
/// Moves the head's centre (m), until the command `place` does.
HIMC_RT void himc_drum_stand(himc_drum *drum, himc_vec3 center);
/// The mallet that strikes it, set by the command `mallet`. Borrowed.
HIMC_RT const himc_mallet_head *himc_drum_mallet(const himc_drum *drum);
/// Grows by one with every change of place, radius or mallet, so that a performer notices.
HIMC_RT unsigned himc_drum_revision(const himc_drum *drum);
/// Frequency of the head's principal mode (Hz).
HIMC_RT double himc_drum_pitch(const himc_drum *drum);

/// What himc_drum_set_external_sound has set.
HIMC_RT bool himc_drum_has_external_sound(const himc_drum *drum);

// Commands that compute a drum's head anew, carried out on a copy of the drum (drum_job.c).

/// All of a drum that its commands change, without its motion.
typedef struct himc_drum_form {
    char name[HIMC_NAME_SIZE];
    himc_membrane_form head;
    himc_head_frame place;
    himc_listener listener;
    bool external_sound;
} himc_drum_form;

/// The form of a drum; free it with himc_drum_form_free.
himc_drum_form himc_drum_form_of(const himc_drum *drum);
void himc_drum_form_free(himc_drum_form *form);
/// True if the drum's head still has that form.
bool himc_drum_has_form(const himc_drum *drum, const himc_drum_form *form);

/// A drum of that form, at rest; NULL with the reason.
himc_drum *himc_drum_new_of(const himc_drum_form *form, himc_error *error);
/// Gives `drum` the head of `made`, which is then only to be released (himc_membrane_exchange). It
/// is quick if both have one sample rate.
void himc_drum_exchange(himc_drum *drum, himc_drum *made);

/// True if a command would take longer than an audio block can wait: a file, or many modes.
HIMC_RT bool himc_drum_takes_long(const himc_drum *drum, const himc_command *command);
/// Such a command as a job; the drum must outlive it. NULL without memory.
himc_job *himc_drum_job(himc_drum *drum, const himc_command *command, himc_error *error);

/// True if himc_drum_listen would take longer than an audio block can wait.
HIMC_RT bool himc_drum_listening_takes_long(const himc_drum *drum);
/// himc_drum_listen as a job; the drum must outlive it, but for `free`. NULL without memory.
himc_job *himc_drum_listen_job(himc_drum *drum, const himc_listener *listener, himc_error *error);

/// himc_membrane_follow as a job; both must outlive it. NULL without memory.
himc_job *himc_membrane_job(himc_membrane *follower, const himc_membrane *leader,
                            himc_error *error);

#endif
