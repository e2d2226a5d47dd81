/// drum_job.c: a command that computes a drum's head anew, mode by mode, is carried out on a copy
/// of the drum, at rest; then the two exchange their heads. The head that sounds gives its motion
/// to the new one. If another command has changed it meanwhile, a new copy is made; if that happens
/// again and again, the command is carried out in place.
#include "drum/drum_state.h"

#include "base/file.h"
#include "base/text.h"
#include "head/statistical.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// exact modes of all readouts; chosen: 0.3 ms of computing, a quarter of a block, and enough for a
// head that chooses its modes itself
#define SHORT_WORK 700
#define STATISTICAL_WORK 3 // so many statistical modes take as long as an exact one

himc_drum_form himc_drum_form_of(const himc_drum *drum)
{
    himc_drum_form form = {.head = himc_membrane_form_of(drum->membrane),
                           .usual = drum->usual,
                           .manner = himc_drum_manner_of(drum),
                           .place = drum->place,
                           .listener = drum->listener,
                           .walls = drum->walls,
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
    bool shares = himc_membrane_shares(drum->membrane);
    himc_membrane_exchange(drum->membrane, made->membrane);
    himc_membrane_share(drum->membrane, shares); // `made` stood alone
    drum->place.radius = made->place.radius;
    drum->revision += grown;
    himc_drum_find_ways(drum);
}

// modes of a head, those that are computed faster counted for less
static int mode_work(const himc_membrane *membrane)
{
    int count = himc_membrane_modes(membrane);
    bool statistical = himc_membrane_mode(membrane, count - 1).m < 0;
    return statistical ? count - HIMC_STATISTICAL_MODES + HIMC_STATISTICAL_MODES / STATISTICAL_WORK
                       : count;
}

bool himc_drum_listening_takes_long(const himc_drum *drum)
{
    return mode_work(drum->membrane) * HIMC_RAYS > SHORT_WORK;
}

bool himc_drum_takes_long(const himc_drum *drum, const himc_command *command)
{
    int pickups;
    himc_membrane_pickups(drum->membrane, &pickups);
    bool heard = drum->listener.on;
    int readouts = pickups + 1 + (heard ? HIMC_RAYS : 0); // and the watched point
    if (command->id == HIMC_COMMAND_PICKUPS)
        readouts = 1 + (int)fmax(pickups, command->atom[0].number);
    if (command->id == HIMC_COMMAND_DRUM_DUMP)
        return command->count > 0;
    if (command->id == HIMC_COMMAND_PLACE)
        return heard && himc_drum_listening_takes_long(drum);
    return command->id == HIMC_COMMAND_SHAPE || command->id == HIMC_COMMAND_DRUM_PRESET ||
           command->id == HIMC_COMMAND_MODES ||
           ((himc_command_table((int)command->id)->marks & HIMC_CHANGES_HEAD) &&
            mode_work(drum->membrane) * readouts > SHORT_WORK);
}

typedef struct drum_job {
    himc_job job;
    himc_drum *drum; ///< borrowed
    himc_command command;
    const char *state;      ///< borrowed; a preset's lines that are in no file
    himc_listener listener; ///< of himc_drum_listen_job; then there is no command
    bool listens;
    himc_drum_form form; ///< of the drum when the job was made
    himc_drum *made;     ///< owned
    int tries;
} drum_job;

#define LONGEST_PRESET 65536 // chosen: thirty times what a drum tells (bytes)

// a line of a preset: what sets something and names no file but a shape's
static bool run_line(himc_drum *drum, const himc_text_statement *line, himc_error *error)
{
    himc_command c;
    int count = line->count < line->capacity ? line->count : line->capacity;
    if (line->overflow)
        return himc_error_set(error, "a line is too long");
    if (!himc_command_parse(&c, HIMC_DRUM, line->atom[0].symbol, line->atom + 1, count - 1, error))
        return false;
    if (c.id == HIMC_COMMAND_DRUM_PRESET || c.id == HIMC_COMMAND_DRUM_DUMP ||
        c.id == HIMC_COMMAND_DRUM_INFO || c.id == HIMC_COMMAND_STRIKE)
        return himc_error_set(error, "%s: not allowed in a preset", line->atom[0].symbol);
    return himc_drum_command(drum, &c, error);
}

// the lines of a preset, on a copy of the drum
static bool run_lines(himc_drum *drum, const char *rest, const char *name, himc_error *error)
{
    char storage[2 * HIMC_PATH_SIZE];
    himc_atom atoms[HIMC_COMMAND_ATOMS + 2];
    himc_text_statement line = {.atom = atoms,
                                .capacity = HIMC_COMMAND_ATOMS + 2,
                                .storage = storage,
                                .size = sizeof storage};
    int at = 1;
    bool good = true;
    while (good && himc_text_next(&rest, &at, &line))
        good = line.count == 0 || run_line(drum, &line, error) ||
               himc_error_prefix(error, "%s:%d", name, line.line);
    return good;
}

static bool run_preset(himc_drum *drum, const char *name, himc_error *error)
{
    char path[HIMC_PATH_SIZE + 8];
    size_t size;
    snprintf(path, sizeof path, "%s.txt", name);
    char *text = himc_file_load(path, LONGEST_PRESET, &size, error);
    bool good =
        text && himc_text_check(text, size, path, error) && run_lines(drum, text, path, error);
    free(text);
    return good || himc_error_prefix(error, "preset");
}

static bool prepare(himc_job *job, himc_error *error)
{
    drum_job *j = (drum_job *)job;
    himc_drum_release(j->made);
    j->made = himc_drum_new_of(&j->form, error);
    if (j->made && j->listens)
        himc_drum_listen(j->made, &j->listener);
    if (j->made && j->state)
        return run_lines(j->made, j->state, "state", error);
    if (j->made && !j->listens && j->command.id == HIMC_COMMAND_DRUM_PRESET)
        return run_preset(j->made, j->command.atom[0].symbol, error);
    return j->made && (j->listens || himc_drum_command(j->made, &j->command, error));
}

// beside its head, all that a preset has set
static himc_job_state take_preset(drum_job *j)
{
    himc_drum_manner manner = himc_drum_manner_of(j->made);
    himc_head_frame place = j->made->place;
    himc_drum_exchange(j->drum, j->made);
    himc_drum_set_manner(j->drum, &manner);
    j->drum->place = place;
    himc_drum_find_ways(j->drum);
    return HIMC_JOB_DONE;
}

// Carries it out on the drum itself. Where only rays change and the drum has them already, that is
// quick.
static bool act(drum_job *j, himc_error *error)
{
    if (!j->listens)
        return himc_drum_command(j->drum, &j->command, error);
    himc_drum_listen(j->drum, &j->listener);
    return true;
}

static himc_job_state install(himc_job *job, himc_error *error)
{
    drum_job *j = (drum_job *)job;
    bool preset = !j->listens && j->command.id == HIMC_COMMAND_DRUM_PRESET;
    if (preset && (himc_drum_has_form(j->drum, &j->form) || ++j->tries == HIMC_JOB_TRIES))
        return take_preset(j);
    if (himc_drum_has_form(j->drum, &j->form)) {
        bool rays = j->listens || j->command.id == HIMC_COMMAND_PLACE;
        himc_drum_exchange(j->drum, j->made);
        return !rays || act(j, error) ? HIMC_JOB_DONE : HIMC_JOB_FAILED;
    }
    if (!preset && ++j->tries == HIMC_JOB_TRIES)
        return act(j, error) ? HIMC_JOB_DONE : HIMC_JOB_FAILED;
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

static drum_job *job_new(himc_drum *drum, const char *what, himc_error *error)
{
    drum_job *j = calloc(1, sizeof *j);
    if (!j) {
        himc_error_set(error, "%s: out of memory", what);
        return NULL;
    }
    j->job = (himc_job){prepare, install, free_job};
    j->drum = drum;
    j->form = himc_drum_form_of(drum);
    return j;
}

// the state of now into a file
static himc_job *dump_job(const himc_drum *drum, const himc_command *command, himc_error *error)
{
    himc_text_lines lines = {0};
    himc_drum_describe(drum, HIMC_DESCRIBE_STATE, himc_text_add, &lines);
    return himc_file_write_job("dump", command->atom[0].symbol, &lines, error);
}

himc_job *himc_drum_job(himc_drum *drum, const himc_command *command, himc_error *error)
{
    if (command->id == HIMC_COMMAND_DRUM_DUMP)
        return dump_job(drum, command, error);
    drum_job *j = job_new(drum, himc_command_table((int)command->id)->name, error);
    if (!j)
        return NULL;
    himc_command_copy(&j->command, command);
    return &j->job;
}

himc_job *himc_drum_state_job(himc_drum *drum, const char *state, himc_error *error)
{
    drum_job *j = job_new(drum, "state", error);
    if (!j)
        return NULL;
    j->command.id = HIMC_COMMAND_DRUM_PRESET;
    j->state = state;
    return &j->job;
}

// `info`, and `dump` without a file, are answered by the host, with himc_drum_describe
bool himc_drum_command(himc_drum *drum, const himc_command *command, himc_error *error)
{
    himc_command checked; // also one that was put together without the parser
    if (!himc_command_check(&checked, HIMC_DRUM, command, error))
        return false;
    if (checked.id == HIMC_COMMAND_DRUM_INFO ||
        (checked.id == HIMC_COMMAND_DRUM_DUMP && checked.count == 0))
        return true;
    if (checked.id == HIMC_COMMAND_DRUM_DUMP || checked.id == HIMC_COMMAND_DRUM_PRESET)
        return himc_job_carry_out(himc_drum_job(drum, &checked, error), error);
    return himc_drum_act(drum, &checked, error);
}

himc_job *himc_drum_listen_job(himc_drum *drum, const himc_listener *listener, himc_error *error)
{
    drum_job *j = job_new(drum, "listener", error);
    if (!j)
        return NULL;
    j->listener = *listener;
    j->listens = true;
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
    j->form.shares = false; // no other head is near the follower
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
