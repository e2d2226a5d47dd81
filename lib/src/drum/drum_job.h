/// drum_job.h: commands that compute a drum's head anew, carried out on a copy of the drum.
#ifndef HIMC_DRUM_JOB_H
#define HIMC_DRUM_JOB_H

#include "base/job.h"
#include "drum/membrane_form.h"
#include "himc/drum.h"

/// All of a drum that its commands change, without its motion.
typedef struct himc_drum_form {
    char name[HIMC_NAME_SIZE];
    himc_membrane_form head;
    himc_head_frame place;
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

/// himc_membrane_follow as a job; both must outlive it. NULL without memory.
himc_job *himc_membrane_job(himc_membrane *follower, const himc_membrane *leader,
                            himc_error *error);

#endif
