/// drum_job.c: a command that computes a drum's head anew, mode by mode, is carried out on a copy of
/// the drum, at rest; then the two exchange their heads. The head that sounds gives its motion to
/// the new one. If another command has changed it meanwhile, a new copy is made; if that happens
/// again and again, the command is carried out in place.
#include "drum/drum_state.h"

#include "head/statistical.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// exact modes of all readouts; chosen: 0.3 ms of computing, a quarter of a block, and enough for a
// head that chooses its modes itself
#define SHORT_WORK 700
#define STATISTICAL_WORK 3 // so many statistical modes take as long as an exact one

himc_drum_form himc_drum_form_of(const himc_drum *drum)
{
    himc_drum_form form = {.head = himc_membrane_form_of(drum->membrane),
                           .place = drum->place,
                           .external_sound = drum->external_sound};
    memcpy(form.name, drum->name, sizeof form.name);
    return form;
}

void himc_drum_form_free(himc_drum_form *form)
{
    himc_membrane_form_free(&form->head);
}

bool himc_drum_has_form(const himc_drum *drum, const himc_drum_form *form)
{
    return himc_membrane_has_form(drum->membrane, &form->head);
}

void himc_drum_exchange(himc_drum *drum, himc_drum *made)
{
    bool grown =
        drum->place.radius != made->place.radius ||
        himc_membrane_shape(drum->membrane)->kind != himc_membrane_shape(made->membrane)->kind;
    if (himc_membrane_rate(made->membrane) != drum->rate)
        himc_membrane_set_rate(made->membrane, drum->rate, NULL);
    himc_membrane_exchange(drum->membrane, made->membrane);
    drum->place.radius = made->place.radius;
    drum->revision += grown;
}

// modes of a head, those that are computed faster counted for less
static int mode_work(const himc_membrane *membrane)
{
    int count = himc_membrane_modes(membrane);
    bool statistical = himc_membrane_mode(membrane, count - 1).m < 0;
    return statistical ? count - HIMC_STATISTICAL_MODES + HIMC_STATISTICAL_MODES / STATISTICAL_WORK
                       : count;
}

bool himc_drum_takes_long(const himc_drum *drum, const himc_command *command)
{
    int pickups;
    himc_membrane_pickups(drum->membrane, &pickups);
    int readouts = pickups + 1; // and the watched point
    if (command->id == HIMC_COMMAND_PICKUPS)
        readouts = 1 + (int)fmax(pickups, command->atom[0].number);
    return command->id == HIMC_COMMAND_SHAPE || command->id == HIMC_COMMAND_MODES ||
           ((himc_command_table((int)command->id)->marks & HIMC_CHANGES_HEAD) &&
            mode_work(drum->membrane) * readouts > SHORT_WORK);
}

typedef struct drum_job {
    himc_job job;
    himc_drum *drum; ///< borrowed
    himc_command command;
    himc_drum_form form; ///< of the drum when the job was made
    himc_drum *made;     ///< owned
    int tries;
} drum_job;

static bool prepare(himc_job *job, himc_error *error)
{
    drum_job *j = (drum_job *)job;
    himc_drum_release(j->made);
    j->made = himc_drum_new_of(&j->form, error);
    return j->made && himc_drum_command(j->made, &j->command, error);
}

static himc_job_state install(himc_job *job, himc_error *error)
{
    drum_job *j = (drum_job *)job;
    if (himc_drum_has_form(j->drum, &j->form)) {
        himc_drum_exchange(j->drum, j->made);
        return HIMC_JOB_DONE;
    }
    if (++j->tries == HIMC_JOB_TRIES)
        return himc_drum_command(j->drum, &j->command, error) ? HIMC_JOB_DONE : HIMC_JOB_FAILED;
    himc_drum_form_free(&j->form);
    j->form = himc_drum_form_of(j->drum);
    return HIMC_JOB_AGAIN;
}

static void free_job(himc_job *job)
{
    drum_job *j = (drum_job *)job;
    himc_drum_form_free(&j->form);
    himc_drum_release(j->made);
    free(j);
}

himc_job *himc_drum_job(himc_drum *drum, const himc_command *command, himc_error *error)
{
    drum_job *j = calloc(1, sizeof *j);
    if (!j) {
        himc_error_set(error, "%s: out of memory", himc_command_table((int)command->id)->name);
        return NULL;
    }
    j->job = (himc_job){prepare, install, free_job};
    j->drum = drum;
    himc_command_copy(&j->command, command);
    j->form = himc_drum_form_of(drum);
    return &j->job;
}

typedef struct follow_job {
    himc_job job;
    himc_membrane *follower; ///< borrowed, as the leader
    const himc_membrane *leader;
    himc_membrane_form form; ///< of the leader, at the follower's rate
    himc_membrane *made;     ///< owned
    int tries;
} follow_job;

static void copy_leader(follow_job *j)
{
    himc_membrane_form_free(&j->form);
    j->form = himc_membrane_form_of(j->leader);
    j->form.rate = himc_membrane_rate(j->follower);
}

static bool prepare_follower(himc_job *job, himc_error *error)
{
    follow_job *j = (follow_job *)job;
    himc_membrane_free(j->made);
    j->made = himc_membrane_new_of(&j->form, error);
    return j->made;
}

static himc_job_state install_follower(himc_job *job, himc_error *error)
{
    follow_job *j = (follow_job *)job;
    (void)error;
    bool same = himc_membrane_alike(j->made, j->leader) || ++j->tries == HIMC_JOB_TRIES;
    if (same && himc_membrane_rate(j->made) == himc_membrane_rate(j->follower)) {
        himc_membrane_exchange(j->follower, j->made);
        return HIMC_JOB_DONE;
    }
    copy_leader(j);
    return HIMC_JOB_AGAIN;
}

static void free_follower(himc_job *job)
{
    follow_job *j = (follow_job *)job;
    himc_membrane_form_free(&j->form);
    himc_membrane_free(j->made);
    free(j);
}

himc_job *himc_membrane_job(himc_membrane *follower, const himc_membrane *leader, himc_error *error)
{
    follow_job *j = calloc(1, sizeof *j);
    if (!j) {
        himc_error_set(error, "head: out of memory");
        return NULL;
    }
    j->job = (himc_job){prepare_follower, install_follower, free_follower};
    j->follower = follower;
    j->leader = leader;
    copy_leader(j);
    return &j->job;
}
