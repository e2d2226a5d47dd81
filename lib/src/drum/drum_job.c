/// drum_job.c: a command that computes a drum's head anew, mode by mode, is carried out on a copy
/// of the drum's settings, and the model of the new head is made; then the drum takes both. If
/// another command has changed its head meanwhile, that is done again; if it happens again and
/// again, the command is carried out in place.
#include "drum/drum_state.h"

#include "base/array.h"
#include "base/file.h"
#include "head/statistical.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// exact modes of all readouts; chosen: 0.3 ms of computing, a quarter of a block, and enough for a
// head that chooses its modes itself
#define SHORT_WORK 700
#define STATISTICAL_WORK 3 // so many statistical modes take as long as an exact one

// modes of a head, those that are computed faster counted for less
static int mode_work(const himc_membrane *membrane)
{
    int count = membrane->model->modes->count;
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
    bool heard = himc_drum_is_heard(drum);
    int readouts = pickups + 1 + (heard ? HIMC_RAYS : 0); // and the watched point
    if (command->id == HIMC_COMMAND_PICKUPS)
        readouts = 1 + (int)fmax(pickups, command->atom[0].number);
    if (command->id == HIMC_COMMAND_DRUM_DUMP)
        return command->count > 0;
    if (command->id == HIMC_COMMAND_PLACE)
        return heard && himc_drum_listening_takes_long(drum);
    return command->id == HIMC_COMMAND_GLISS || command->id == HIMC_COMMAND_SHAPE ||
           command->id == HIMC_COMMAND_DRUM_PRESET || command->id == HIMC_COMMAND_MODES ||
           ((himc_command_table((int)command->id)->marks & HIMC_CHANGES_HEAD) &&
            mode_work(drum->membrane) * readouts > SHORT_WORK);
}

typedef struct drum_job {
    himc_job job;
    himc_drum *drum; ///< borrowed
    himc_command command;
    const char *state;         ///< borrowed; a preset's lines that are in no file
    himc_listener listener;    ///< the drum's, or of himc_drum_listen_job ...
    bool listens;              ///< ... which has no command
    himc_drum_settings before; ///< of the drum when the job was begun
    himc_drum_settings after;  ///< of the command
    himc_model *made;          ///< owned; of the head after; once installed, the one before
    himc_ears *ears;           ///< owned; for a drum without any
    int tries;
} drum_job;

#define LONGEST_PRESET 65536 // chosen: thirty times what a drum tells (bytes)

// lines of a preset: what sets something and names no file but a shape's
static bool run_lines(himc_drum_settings *s, const char *rest, const char *name, himc_error *error)
{
    char storage[2 * HIMC_PATH_SIZE];
    himc_atom atoms[HIMC_COMMAND_ATOMS + 2];
    himc_text_statement line = {.atom = atoms,
                                .capacity = HIMC_COMMAND_ATOMS + 2,
                                .storage = storage,
                                .size = sizeof storage};
    int at = 1;
    while (himc_text_next(&rest, &at, &line)) {
        himc_command c;
        int count = line.count < line.capacity ? line.count : line.capacity;
        if (line.count == 0)
            continue;
        const char *word = atoms[0].symbol;
        bool good = line.overflow
                        ? himc_error_set(error, "a line is too long")
                        : himc_command_parse(&c, HIMC_DRUM, word, atoms + 1, count - 1, error);
        if (good && (c.id == HIMC_COMMAND_DRUM_PRESET || c.id == HIMC_COMMAND_DRUM_DUMP ||
                     c.id == HIMC_COMMAND_DRUM_INFO || c.id == HIMC_COMMAND_STRIKE))
            good = himc_error_set(error, "%s: not allowed in a preset", word);
        if (!good || !himc_drum_settings_command(s, &c, error))
            return himc_error_prefix(error, "%s:%d", name, line.line);
    }
    return true;
}

bool himc_drum_settings_preset(himc_drum_settings *s, const char *name, himc_error *error)
{
    char path[HIMC_PATH_SIZE + 8];
    size_t size;
    snprintf(path, sizeof path, "%s.txt", name);
    char *text = himc_file_load(path, LONGEST_PRESET, &size, error);
    bool good = text && himc_text_check(text, size, path, error) && run_lines(s, text, path, error);
    free(text);
    return good || himc_error_prefix(error, "preset");
}

static bool is_preset(const drum_job *j)
{
    return !j->listens && j->command.id == HIMC_COMMAND_DRUM_PRESET;
}

static bool prepare(himc_job *job, himc_error *error)
{
    drum_job *j = (drum_job *)job;
    himc_drum_settings_free(&j->after);
    himc_model_free(j->made);
    j->made = NULL;
    j->after = himc_drum_settings_copy(&j->before);
    bool good = j->listens ? true
                : j->state ? run_lines(&j->after, j->state, "state", error)
                : is_preset(j)
                    ? himc_drum_settings_preset(&j->after, j->command.atom[0].symbol, error)
                    : himc_drum_settings_command(&j->after, &j->command, error);
    if (!good)
        return false;
    bool heard = himc_listener_hears(&j->listener, j->after.picked);
    if (heard) {
        himc_ear_paths paths = himc_ears_trace(&j->listener, &j->after.place);
        himc_membrane_config_set_rays(&j->after.head, paths.ray);
    }
    if (heard && !j->ears && !(j->ears = himc_new(sizeof *j->ears, "listener", error)))
        return false;
    if (himc_membrane_config_equal(&j->before.head, &j->after.head))
        return true;
    j->made = himc_model_new(&j->after.head, NULL, error);
    return j->made;
}

static himc_job_state install(himc_job *job, himc_error *error)
{
    drum_job *j = (drum_job *)job;
    himc_drum *drum = j->drum;
    bool same = himc_drum_has_head(drum, &j->before), preset = is_preset(j);
    himc_drum_settings to = himc_drum_settings_of(drum);
    if (!same && ++j->tries < HIMC_JOB_TRIES) {
        himc_drum_settings_free(&j->before);
        j->before = to;
        return HIMC_JOB_AGAIN;
    }
    himc_drum_settings_free(&to); // the drum's model, and what is prepared, have the grids
    if (!drum->ears) {
        drum->ears = j->ears;
        j->ears = NULL;
    }
    if (!same && !preset && !j->listens)
        return himc_drum_command(drum, &j->command, error) ? HIMC_JOB_DONE : HIMC_JOB_FAILED;
    if (preset) {
        to = j->after;
    } else {
        himc_drum_settings_take_head(&to, &j->after);
        if (j->command.id == HIMC_COMMAND_PLACE && !j->listens) {
            to.place = j->after.place;
            to.placed = true;
        }
    }
    if ((same || preset) && !himc_drum_set(drum, &to, &j->made, error))
        return HIMC_JOB_FAILED;
    if (j->listens) // quick where the drum has the rays already
        himc_drum_listen(drum, &j->listener);
    return HIMC_JOB_DONE;
}

static void free_job(himc_job *job)
{
    drum_job *j = (drum_job *)job;
    himc_drum_settings_free(&j->before);
    himc_drum_settings_free(&j->after);
    himc_model_free(j->made);
    free(j->ears);
    free(j);
}

static drum_job *job_new(himc_drum *drum, const char *what, himc_error *error)
{
    drum_job *j = himc_job_new(sizeof *j, what, (himc_job){prepare, install, free_job}, error);
    if (!j)
        return NULL;
    j->drum = drum;
    j->before = himc_drum_settings_of(drum);
    j->listener = drum->listener;
    return j;
}

himc_job *himc_drum_job(himc_drum *drum, const himc_command *command, himc_error *error)
{
    if (command->id == HIMC_COMMAND_DRUM_DUMP) { // the state of now into a file
        himc_text_lines lines = {0};
        himc_drum_describe(drum, HIMC_DESCRIBE_STATE, himc_text_add, &lines);
        return himc_file_write_job("dump", command->atom[0].symbol, &lines, error);
    }
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
    if (checked.id == HIMC_COMMAND_STRIKE)
        return himc_drum_strike_at(drum, 0, checked.atom[0].number, checked.atom[1].number,
                                   checked.atom[2].number, error);
    himc_drum_settings to = himc_drum_settings_of(drum);
    bool good =
        himc_drum_settings_command(&to, &checked, error) && himc_drum_set(drum, &to, NULL, error);
    himc_drum_settings_free(&to);
    return good;
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
