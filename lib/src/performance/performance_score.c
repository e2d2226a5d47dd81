/// performance_score.c: `score FILE`: a score is accepted as a whole, or refused.
///
/// It is a job (base/job.h). The file is parsed as a whole (score.c) and then tried aside: its
/// lines for drums go to copies of their settings, its lines for the performer are checked against
/// what the lines before them leave, its drums are counted and those that are missing are made.
/// Only then is it installed: the drums take the heads of the copies, lines and strokes follow in
/// portions, a line that takes long is a job of its own. While a score plays, the beats of the next
/// one follow its own. Invariants: a score that is refused has changed nothing; a score from the
/// network may do what its sender may do. A hit or a blow, which happens once, is no reason to
/// refuse a score: a note tells why it is left out.
#include "performance/performance_state.h"

#include "capture/take.h"
#include "midi/score_file.h"
#include "performance/confine.h"
#include "performance/research.h"
#include "plan/ornament.h"
#include "plan/score.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TRIAL_RECORDING 0.1 // of the trial of a file that can be opened (s)
// chosen: a portion takes a tenth of a millisecond
#define LINES_AT_ONCE 16
#define STROKES_AT_ONCE 64

/// A drum of the score.
typedef struct score_drum {
    himc_drum_settings trial; ///< owned; the lines were carried out on them
    himc_model *made;         ///< owned; of the head that they leave, NULL if it is the drum's
    himc_drum *missing;       ///< owned; a drum to be added, NULL if there is one
    drum_source source;       ///< of the missing one
    bool exchanged;           ///< the drum has the head of the trial
    bool changed;             ///< since the trial: lines are carried out in place
} score_drum;

/// A drum that a line names and that is not there; names are those of the score.
typedef struct unknown_drum {
    const char *name;
    himc_spot spot; ///< of the stroke
    int line;
} unknown_drum;

/// What a line for the performer leaves and a later one meets.
typedef struct score_state {
    bool recording;
    int units; ///< of motion, that the planner has
} score_state;

/// In the order of installing.
typedef enum score_part { BEGINNING, BEFORE_STROKES, CHANGES, STROKES, AFTER_STROKES } score_part;

typedef struct score_job {
    himc_job job;
    himc_performance *performance; ///< borrowed
    himc_command command;
    const char *path;
    const char *text; ///< borrowed; the score, if it is in no file
    // of the performance, when the job was made
    himc_take_options options;
    himc_skeleton skeleton;
    double sample_rate, task_rate; ///< (Hz)
    bool make_drums, host_finds;
    score_state state;
    himc_job *take; ///< owned; to try takes
    himc_drum_settings form[HIMC_DRUMS];
    int forms;
    // the score, tried
    himc_score *score;
    score_drum drum[HIMC_DRUMS];
    int drums;
    const char *known[HIMC_DRUMS]; ///< the performance's drums and those that the score makes
    int known_count;
    unknown_drum unknown[HIMC_DRUMS]; ///< the host may have them
    int unknown_count;
    // how far it is installed
    int tries;
    score_part part;
    int at;                             ///< next line or stroke
    bool queued;                        ///< it follows the one that plays
    double from;                        ///< its first beat
    himc_job *line, *done;              ///< owned; a line that takes long: under way, and finished
    himc_track *dropped;                ///< owned
    bool asked;                         ///< the changes of heads have been asked for
    himc_drum_heads *heads[HIMC_DRUMS]; ///< owned; of form[i], to be installed
    himc_drum_heads *over[HIMC_DRUMS];  ///< owned; what they replaced
} score_job;

static score_drum *find_drum(score_job *j, const char *name)
{
    for (int i = 0; i < j->drums; i++)
        if (strcmp(j->drum[i].trial.name, name) == 0)
            return &j->drum[i];
    return NULL;
}

static const himc_drum_settings *find_form(const score_job *j, const char *name)
{
    for (int i = 0; i < j->forms; i++)
        if (strcmp(j->form[i].name, name) == 0)
            return &j->form[i];
    return NULL;
}

static void free_drums(score_job *j)
{
    for (; j->drums > 0; j->drums--) {
        score_drum *d = &j->drum[j->drums - 1];
        himc_drum_settings_free(&d->trial);
        himc_model_free(d->made);
        himc_drum_release(d->missing);
    }
}

/// The trial drum of that name; "" is the performer's first.
static himc_drum_settings *trial_drum(score_job *j, const char *name, double inches,
                                      drum_source source, himc_error *error)
{
    if (!name[0] && j->forms > 0)
        name = j->form[0].name;
    score_drum *known = find_drum(j, name);
    const himc_drum_settings *form = find_form(j, name);
    if (known)
        return &known->trial;
    if (j->drums == HIMC_DRUMS) {
        himc_drums_full(name, error);
        return NULL;
    }
    score_drum *made = &j->drum[j->drums];
    *made = (score_drum){.source = source};
    if (!form)
        made->missing = himc_drum_new(name, inches, j->sample_rate, error);
    if (!form && !made->missing)
        return NULL;
    made->trial = form ? himc_drum_settings_copy(form) : himc_drum_settings_of(made->missing);
    j->drums++;
    return &made->trial;
}

/// Computes the heads that the lines leave.
static bool make_heads(score_job *j, himc_error *error)
{
    bool good = true;
    for (int i = 0; i < j->drums && good; i++) {
        score_drum *d = &j->drum[i];
        const himc_drum_settings *form = find_form(j, d->trial.name);
        if (form ? himc_membrane_config_equal(&form->head, &d->trial.head)
                 : himc_drum_has_head(d->missing, &d->trial))
            continue;
        d->made = himc_model_new(&d->trial.head, NULL, error);
        good = d->made;
    }
    return good;
}

static bool rehearse_record(const score_job *j, const himc_command *c, score_state *state,
                            himc_error *error)
{
    if (!himc_performance_allows(state->recording, c, error))
        return false;
    state->recording = !state->recording;
    if (!state->recording)
        return true;
    himc_recording *trial =
        himc_recording_new(c->atom[0].symbol, &j->skeleton, j->task_rate, TRIAL_RECORDING, error);
    himc_recording_free(trial);
    return (trial && himc_recording_may_replace(c->atom[0].symbol, error)) ||
           himc_error_prefix(error, "record");
}

static bool rehearse_units(const score_job *j, const himc_command *c, score_state *state,
                           himc_error *error)
{
    int file, more = 0;
    if (himc_command_file(c, &file) == HIMC_FILE_NONE)
        state->units = 0; // `units clear`
    else
        more = himc_performance_count_units(c, &j->options, error);
    state->units += more;
    return more >= 0 && himc_planner_check_units(state->units - more, more, error);
}

// before the first drum as the lines before have placed it
static bool rehearse_take(score_job *j, const himc_command *c, himc_error *error)
{
    const score_drum *first = j->forms > 0 ? find_drum(j, j->form[0].name) : j->drum;
    bool tried = first && j->drums > 0;
    const himc_head_frame *place = tried          ? &first->trial.place
                                   : j->forms > 0 ? &j->form[0].place
                                                  : NULL;
    return himc_performance_try_take(j->take, c, place, error);
}

/// True if a line for the performer can be carried out; reads the file that it names.
static bool rehearse_command(score_job *j, const himc_command *c, score_state *state,
                             himc_error *error)
{
    performance_settings aside = {.alive = false};
    switch (c->id) {
    case HIMC_COMMAND_MAKE_DRUM:
        return trial_drum(j, c->atom[0].symbol,
                          c->count > 1 ? c->atom[1].number : HIMC_INCHES_USUAL,
                          j->make_drums ? DRUM_MADE : DRUM_SILENT, error);
    case HIMC_COMMAND_PUSH: return himc_body_read_push(c, &(planned_push){0}, error);
    case HIMC_COMMAND_RESET: *state = (score_state){.units = 0}; return true;
    case HIMC_COMMAND_TAKE: return rehearse_take(j, c, error);
    case HIMC_COMMAND_NUDGE: return himc_performance_try_nudge(j->take, c, error);
    case HIMC_COMMAND_UNITS: return rehearse_units(j, c, state, error);
    case HIMC_COMMAND_RECORD: return rehearse_record(j, c, state, error);
    default: // the network's are always refused
        return himc_performance_allows(state->recording, c, error) &&
               himc_settings_read(&aside, &j->performance->host.usual, c, error) &&
               (himc_command_table((int)c->id)->when != HIMC_WHEN_NETWORK ||
                j->performance->runner.run(j->performance, c, 0, error));
    }
}

static bool rehearse_on_drum(himc_drum_settings *drum, const himc_command *c, himc_error *error)
{
    return c->id == HIMC_COMMAND_DRUM_PRESET
               ? himc_drum_settings_preset(drum, c->atom[0].symbol, error)
               : himc_drum_settings_command(drum, c, error);
}

static bool rehearse_line(score_job *j, const himc_score_line *line, score_state *state,
                          himc_error *error)
{
    if (!line->drum[0])
        return rehearse_command(j, &line->command, state, error);
    himc_drum_settings *drum = trial_drum(j, line->drum, HIMC_INCHES_USUAL, DRUM_SILENT, error);
    return drum && (rehearse_on_drum(drum, &line->command, error) ||
                    himc_error_prefix(error, "%s", line->drum));
}

/// Counts the drums with this score: the present ones, and those named by lines and strokes; makes
/// those that only strokes name.
static bool count_drums(score_job *j, himc_error *error)
{
    const char *name[HIMC_DRUMS];
    int count = 0;
    for (int i = 0; i < j->forms; i++)
        name[count++] = j->form[i].name;
    for (int i = -j->drums; i < j->score->stroke_count; i++) {
        const char *wanted = i < 0 ? j->drum[-1 - i].trial.name : j->score->strokes[i].drum;
        if (!wanted[0] && count == 0)
            wanted = FIRST_DRUM;
        int k = 0;
        while (k < count && strcmp(name[k], wanted) != 0)
            k++;
        if (k < count || !wanted[0])
            continue;
        if (count == HIMC_DRUMS)
            return himc_drums_full(wanted, error);
        if (!trial_drum(j, wanted, HIMC_INCHES_USUAL, DRUM_SILENT, error))
            return false;
        name[count++] = wanted;
    }
    return true;
}

// the changes of the head of a drum of that form; NULL with the reason
static himc_drum_heads *heads_of(const score_job *j, const himc_drum_settings *form,
                                 himc_error *error)
{
    himc_drum_heads *heads = himc_drum_heads_new(form, error);
    for (int i = 0; heads && i < j->score->change_count; i++) {
        const himc_score_line *line = &j->score->changes[i];
        if (strcmp(line->drum, form->name) != 0 ||
            himc_drum_heads_add(heads, j->from + line->beat, &line->command, error))
            continue;
        himc_error_prefix(error, "%s:%d: %s", j->path, line->line, line->drum);
        himc_drum_heads_free(heads);
        return NULL;
    }
    return heads;
}

// the pushes of the score (*count, HIMC_PUSHES at most), `from` beats later
static bool pushes_of(const himc_score *score, const char *path, double from, planned_push *list,
                      int *count, himc_error *error)
{
    *count = 0;
    for (int i = 0; i < score->change_count; i++) {
        const himc_score_line *line = &score->changes[i];
        if (line->drum[0])
            continue;
        bool good = *count < HIMC_PUSHES ||
                    himc_error_set(error, "push: one too many, expected %d", HIMC_PUSHES);
        if (!good || !himc_body_read_push(&line->command, &list[*count], error))
            return himc_error_prefix(error, "%s:%d", path, line->line);
        list[(*count)++].beat = from + line->beat;
    }
    return true;
}

// plans the pushes of the score
static bool plan_pushes(score_job *j, himc_error *error)
{
    planned_push list[HIMC_PUSHES];
    int count;
    return pushes_of(j->score, j->path, j->from, list, &count, error) &&
           himc_body_plan_pushes(j->performance->body, list, count,
                                 j->queued ? PUSHES_AFTER : PUSHES_ANEW, error);
}

// of the head of that drum, NULL: of any
static bool has_changes(const himc_score *score, const char *drum)
{
    for (int i = 0; i < score->change_count; i++)
        if (drum ? strcmp(score->changes[i].drum, drum) == 0 : score->changes[i].drum[0])
            return true;
    return false;
}

/// Tries the pushes and the changes of heads, after all other lines.
static bool rehearse_changes(score_job *j, himc_error *error)
{
    planned_push list[HIMC_PUSHES];
    int count;
    for (int i = 0; i < j->score->change_count; i++)
        if (j->score->changes[i].drum[0] &&
            !trial_drum(j, j->score->changes[i].drum, HIMC_INCHES_USUAL, DRUM_SILENT, error))
            return himc_error_prefix(error, "%s:%d", j->path, j->score->changes[i].line);
    bool good = pushes_of(j->score, j->path, 0, list, &count, error);
    for (int i = 0; i < j->drums && good; i++) {
        if (!has_changes(j->score, j->drum[i].trial.name))
            continue;
        himc_drum_heads *heads = heads_of(j, &j->drum[i].trial, error);
        good = heads != NULL;
        himc_drum_heads_free(heads);
    }
    return good;
}

static bool rehearse(score_job *j, himc_error *error)
{
    const himc_score *score = j->score;
    const char *folder = j->command.folder;
    score_state state = j->state;
    bool good = true;
    for (int i = 0; i < score->line_count && good; i++) {
        good = (!folder || himc_confine_command(&score->lines[i].command, folder, error)) &&
               rehearse_line(j, &score->lines[i], &state, error);
        if (good && score->lines[i].command.id == HIMC_COMMAND_TAKE && score->stroke_count > 0)
            good = himc_error_set(error, "take: a score with strokes cannot play a take");
        good = good || himc_error_prefix(error, "%s:%d", j->path, score->lines[i].line);
    }
    return good && rehearse_changes(j, error) &&
           (count_drums(j, error) || himc_error_prefix(error, "%s", j->path));
}

/// The drums that there are with this score; returns their number, HIMC_DRUMS at most.
static int list_drums(const score_job *j, const char *name[HIMC_DRUMS])
{
    int count = 0;
    for (; count < j->forms; count++)
        name[count] = j->form[count].name;
    for (int i = 0; i < j->score->line_count && count < HIMC_DRUMS; i++) {
        const himc_command *c = &j->score->lines[i].command;
        int k = 0;
        if (c->id != HIMC_COMMAND_MAKE_DRUM)
            continue;
        while (k < count && strcmp(name[k], c->atom[0].symbol) != 0)
            k++;
        name[k] = c->atom[0].symbol;
        count += k == count;
    }
    return count;
}

// notes a drum that a line names if it is not among the known ones
static void look_for(score_job *j, const char *name, himc_spot spot, int line)
{
    for (int k = 0; k < j->known_count; k++)
        if (strcmp(j->known[k], name) == 0)
            return;
    for (int k = 0; k < j->unknown_count; k++)
        if (strcmp(j->unknown[k].name, name) == 0)
            return;
    if (name[0] && j->unknown_count < HIMC_DRUMS)
        j->unknown[j->unknown_count++] = (unknown_drum){name, spot, line};
}

static bool refuse_drum(const score_job *j, const unknown_drum *drum, himc_error *error)
{
    himc_drums_refuse_of(j->known, j->known_count, drum->name, drum->spot, error);
    return himc_error_prefix(error, "%s:%d", j->path, drum->line);
}

/// Finds the drums that the score names and nobody has made; false if no host can have them.
static bool check_drums(score_job *j, himc_error *error)
{
    const himc_score *score = j->score;
    j->known_count = list_drums(j, j->known);
    j->unknown_count = 0;
    for (int i = 0; i < score->line_count; i++)
        look_for(j, score->lines[i].drum, HIMC_SPOT_XY, score->lines[i].line);
    for (int i = 0; i < score->change_count; i++)
        look_for(j, score->changes[i].drum, HIMC_SPOT_XY, score->changes[i].line);
    for (int i = 0; i < score->stroke_count; i++)
        look_for(j, score->strokes[i].drum, score->strokes[i].spot, score->stroke_lines[i]);
    return j->host_finds || j->unknown_count == 0 || refuse_drum(j, &j->unknown[0], error);
}

/// Asks the host for the drums that the performance does not have: for one that the score makes,
/// it may have one that sounds.
static bool ask_host(score_job *j, himc_error *error)
{
    for (int k = 0; k < j->known_count; k++)
        himc_performance_find_drum(j->performance, j->known[k]);
    for (int k = 0; k < j->unknown_count; k++)
        if (!himc_performance_find_drum(j->performance, j->unknown[k].name))
            return refuse_drum(j, &j->unknown[k], error);
    return true;
}

/// Computes the heads to come, of the drums as they are with the score's other lines.
static bool prepare_changes(score_job *j, himc_error *error)
{
    for (int i = 0; i < j->forms; i++) {
        if (!has_changes(j->score, j->form[i].name))
            continue;
        j->heads[i] = heads_of(j, &j->form[i], error);
        if (!j->heads[i] || !himc_drum_heads_prepare(j->heads[i], error))
            return false;
    }
    return true;
}

static bool prefix_line(const score_job *j, himc_error *error)
{
    return himc_error_prefix(error, "%s:%d", j->path, j->score->lines[j->at].line);
}

static bool prepare(himc_job *job, himc_error *error)
{
    score_job *j = (score_job *)job;
    if (j->done)
        j->done->free(j->done);
    j->done = NULL;
    if (j->line)
        return j->line->prepare(j->line, error) || prefix_line(j, error);
    if (j->part == CHANGES)
        return prepare_changes(j, error);
    free_drums(j);
    himc_score_free(j->score);
    j->score = j->text ? himc_score_parse(j->text, j->path, error)
                       : himc_score_load_in(j->command.folder, j->path, error);
    // where the host may have other drums it is asked later, in its own thread
    return j->score && check_drums(j, error) && rehearse(j, error) && make_heads(j, error);
}

// the drum of that name; a missing one is added
static bool installed_drum(score_job *j, const char *name, int *index, himc_error *error)
{
    himc_performance *p = j->performance;
    score_drum *made = find_drum(j, name[0] || p->drums.count > 0 ? name : FIRST_DRUM);
    if (!made || !made->missing || himc_drums_find(&p->drums, himc_drum_name(made->missing)) >= 0)
        return himc_performance_ensure_drum(p, name, HIMC_SPOT_NORMAL, index, error);
    himc_drum *missing = made->missing;
    made->missing = NULL;
    if (himc_drum_rate(missing) != p->clock.sample_rate)
        himc_drum_set_rate(missing, p->clock.sample_rate, NULL);
    return himc_performance_adopt_drum(p, missing, made->source, index, error);
}

// a line for a drum
static bool run_on_drum(score_job *j, const himc_score_line *line, himc_error *error)
{
    int index;
    score_drum *made = find_drum(j, line->drum);
    if (!installed_drum(j, line->drum, &index, error))
        return false;
    himc_drum *drum = j->performance->drums.slot[index].drum;
    if (made->changed || !(himc_command_table((int)line->command.id)->marks & HIMC_CHANGES_HEAD))
        return himc_drum_command(drum, &line->command, error) ||
               himc_error_prefix(error, "%s", line->drum);
    himc_drum_settings to = himc_drum_settings_of(drum);
    himc_drum_settings_free(&to); // what is prepared has its own grid
    to.head = made->trial.head;
    to.place.radius = made->trial.place.radius;
    bool good = made->exchanged || himc_drum_set(drum, &to, &made->made, error);
    made->exchanged = true;
    return good;
}

// of the present line
static himc_job_state failed(const score_job *j, himc_error *error)
{
    himc_command_id id = j->score->lines[j->at].command.id;
    prefix_line(j, error);
    if (id != HIMC_COMMAND_HIT && id != HIMC_COMMAND_STRIKE)
        return HIMC_JOB_FAILED;
    himc_events_note(&j->performance->events, "%s", error->text);
    error->text[0] = '\0';
    return HIMC_JOB_DONE;
}

// a line for the performer, or the next part of one that takes long
static himc_job_state run_line(score_job *j, const himc_score_line *line, himc_error *error)
{
    himc_performance *p = j->performance;
    if (line->drum[0])
        return run_on_drum(j, line, error) ? HIMC_JOB_DONE : failed(j, error);
    if (line->command.id == HIMC_COMMAND_MAKE_DRUM) {
        int index;
        return installed_drum(j, line->command.atom[0].symbol, &index, error) ? HIMC_JOB_DONE
                                                                              : failed(j, error);
    }
    if (j->line) {
        himc_job_state state = j->line->install(j->line, error);
        if (state == HIMC_JOB_MORE || state == HIMC_JOB_AGAIN)
            return state;
        j->done = j->line;
        j->line = NULL;
        return state == HIMC_JOB_DONE ? state : failed(j, error);
    }
    if (!p->runner.takes_long(p, &line->command))
        return p->runner.run(p, &line->command, 0, error) ? HIMC_JOB_DONE : failed(j, error);
    j->line = p->runner.job(p, &line->command, error);
    return j->line ? HIMC_JOB_AGAIN : failed(j, error);
}

// a portion of the lines before or after the strokes; DONE after the last
static himc_job_state run_lines(score_job *j, bool after, himc_error *error)
{
    for (int run = 0; j->at < j->score->line_count; j->at++) {
        const himc_score_line *line = &j->score->lines[j->at];
        unsigned marks = himc_command_table((int)line->command.id)->marks;
        if (((marks & HIMC_AFTER_STROKES) != 0) != after) // on strokes or the transport
            continue;
        if (run == LINES_AT_ONCE)
            return HIMC_JOB_MORE;
        himc_job_state state = run_line(j, line, error);
        if (state != HIMC_JOB_DONE)
            return state;
        // a head, and what took long, is a portion by itself
        run = j->done || line->drum[0] ? LINES_AT_ONCE : run + 1;
    }
    return HIMC_JOB_DONE;
}

static himc_job_state begin_strokes(score_job *j, himc_error *error)
{
    himc_performance *p = j->performance;
    himc_planner *planner = p->motion->planner;
    himc_performance_notice_drums(p);
    if (!j->queued) {
        himc_planner_clear(planner);
        himc_text_clear(&p->written.score);
    }
    j->from = j->queued ? himc_planner_next_start(planner, step_time(p)) : 0;
    if (himc_planner_append_tempi(planner, j->score->tempi, j->score->tempo_count, j->from, error))
        return HIMC_JOB_DONE;
    himc_error_prefix(error, "%s", j->path);
    return HIMC_JOB_FAILED;
}

static void copy_performance(score_job *j)
{
    const himc_performance *p = j->performance;
    while (j->forms > 0)
        himc_drum_settings_free(&j->form[--j->forms]);
    for (int i = 0; i < p->drums.count; i++)
        j->form[j->forms++] = himc_drum_settings_of(p->drums.slot[i].drum);
    j->options = p->host.take_options;
    j->skeleton = p->body->skeleton;
    j->sample_rate = p->clock.sample_rate;
    j->task_rate = p->clock.task_rate;
    j->make_drums = p->host.make_drums;
    j->host_finds = p->host.config.find_drum != NULL;
    j->state.recording = p->recording.file != NULL;
    j->state.units = himc_planner_units(p->motion->planner);
}

// the heads that the score changes, the end of those of the score before, and its pushes
static himc_job_state install_changes(score_job *j, himc_error *error)
{
    performance_drums *drums = &j->performance->drums;
    double now = himc_motion_score_beat(j->performance->motion, step_time(j->performance));
    if (j->score->change_count > 0 && !j->asked) {
        copy_performance(j);
        j->asked = true;
        return HIMC_JOB_AGAIN;
    }
    for (int i = 0; i < drums->count; i++) {
        int k = 0; // its form
        while (k < j->forms && strcmp(j->form[k].name, himc_drum_name(drums->slot[i].drum)) != 0)
            k++;
        himc_drum_heads *heads = k < j->forms ? j->heads[k] : NULL;
        if (j->queued && !heads)
            continue;
        himc_drum_heads *before = himc_drums_set_heads(drums, i, heads);
        if (heads)
            j->heads[k] = NULL;
        j->over[i] = j->queued ? himc_drum_heads_follow(heads, before, j->from, now) : before;
    }
    bool good = plan_pushes(j, error);
    himc_performance_find_end(j->performance);
    return good ? HIMC_JOB_DONE : HIMC_JOB_FAILED;
}

// tells a stroke or a change as the file has it, for `dump`; a push is told as it is planned
static bool write_line(score_job *j, int place, himc_error *error)
{
    himc_text_lines *written = &j->performance->written.score;
    if (!himc_written_room(written, "score", error))
        return false;
    if (place >= 0) {
        himc_stroke stroke = j->score->strokes[place];
        stroke.beat += j->from;
        himc_written_stroke(written, &stroke);
    } else if (j->score->changes[-1 - place].drum[0]) {
        himc_written_change(written, &j->score->changes[-1 - place], j->from);
    }
    return true;
}

static bool add_stroke(score_job *j, himc_stroke stroke, bool ornament, himc_error *error)
{
    int drum;
    stroke.beat += j->from;
    if (!installed_drum(j, stroke.drum, &drum, error))
        return false;
    if (ornament)
        himc_performance_add_ornament(j->performance, &stroke, drum);
    if (ornament || stroke.ornament >= HIMC_ROLL_SINGLE)
        return true;
    stroke.ornament = HIMC_PLAIN;
    return himc_performance_put_stroke(j->performance, &stroke, error);
}

// what is written, then the strokes, then what ornaments add, which leaves out what does not fit
static himc_job_state add_strokes(score_job *j, himc_error *error)
{
    const himc_score *score = j->score;
    int count = score->stroke_count, lines = count + score->change_count;
    for (int added = 0; j->at < lines + 2 * count; j->at++, added++) {
        if (added >= STROKES_AT_ONCE)
            return HIMC_JOB_MORE;
        bool good = true, ornament = j->at - lines >= count;
        if (j->at < lines) {
            good = write_line(j, score->order[j->at], error);
        } else {
            const himc_stroke *stroke = &score->strokes[(j->at - lines) % count];
            // a roll may be long: it is a portion by itself
            added += ornament && stroke->ornament >= HIMC_ROLL_SINGLE ? STROKES_AT_ONCE : 0;
            good = add_stroke(j, *stroke, ornament, error);
        }
        if (!good) {
            himc_error_prefix(error, "%s", j->path);
            return HIMC_JOB_FAILED;
        }
    }
    return HIMC_JOB_DONE;
}

// true if the drums are those with which the score was tried; marks those that are not
static bool drums_as_tried(score_job *j)
{
    const performance_drums *drums = &j->performance->drums;
    bool same = drums->count == j->forms && j->sample_rate == j->performance->clock.sample_rate;
    for (int i = 0; i < drums->count; i++) {
        himc_drum *drum = drums->slot[i].drum;
        const himc_drum_settings *form = find_form(j, himc_drum_name(drum));
        bool changed = !form || !himc_drum_has_head(drum, form);
        score_drum *made = find_drum(j, himc_drum_name(drum));
        if (made)
            made->changed = changed;
        same = same && !changed;
    }
    return same;
}

// true if strokes and pushes find room behind those of the score that plays
static bool follows(const score_job *j, himc_error *error)
{
    const himc_score *score = j->score;
    int pushes = 0;
    for (int i = 0; i < score->change_count; i++)
        pushes += !score->changes[i].drum[0];
    return (himc_planner_has_room(j->performance->motion->planner, score->strokes,
                                  score->stroke_count, error) &&
            himc_body_make_push_room(j->performance->body, pushes, error)) ||
           himc_error_prefix(error, "%s", j->path);
}

static himc_job_state begin(score_job *j, himc_error *error)
{
    himc_performance *p = j->performance;
    if (!ask_host(j, error))
        return HIMC_JOB_FAILED;
    if (!drums_as_tried(j) && ++j->tries < HIMC_JOB_TRIES) {
        copy_performance(j);
        return HIMC_JOB_AGAIN;
    }
    // while a score is played the next one waits for its end
    j->queued = p->motion->playing && !p->motion->track;
    if (j->queued && !follows(j, error))
        return HIMC_JOB_FAILED;
    j->dropped = himc_performance_drop_track(p);
    return HIMC_JOB_DONE;
}

// the present part; DONE at its end
static himc_job_state install_part(score_job *j, himc_error *error)
{
    himc_job_state state;
    switch (j->part) {
    case BEGINNING: return begin(j, error);
    case BEFORE_STROKES:
        state = run_lines(j, false, error);
        return state == HIMC_JOB_DONE ? begin_strokes(j, error) : state;
    case CHANGES: return install_changes(j, error);
    case STROKES: return add_strokes(j, error);
    default: return run_lines(j, true, error);
    }
}

// what is played of a MIDI file, and what not; what of a text stands in a comment
static void tell_report(score_job *j)
{
    const char *line = j->score->report ? j->score->report : "", *end;
    for (; (end = strchr(line, '\n')); line = end + 1)
        himc_events_note_as(&j->performance->events, j->score->left_out == 0, "%.*s",
                            (int)(end - line), line);
}

static himc_job_state install(himc_job *job, himc_error *error)
{
    score_job *j = (score_job *)job;
    himc_error why = {""};
    himc_job_state state = install_part(j, error ? error : &why);
    himc_motion_replan(j->performance->motion);
    if (state == HIMC_JOB_DONE && j->part == AFTER_STROKES)
        tell_report(j);
    if (state != HIMC_JOB_DONE || j->part == AFTER_STROKES)
        return state;
    j->part++;
    j->at = 0;
    return HIMC_JOB_MORE;
}

static void free_job(himc_job *job)
{
    score_job *j = (score_job *)job;
    if (j->line)
        j->line->free(j->line);
    if (j->done)
        j->done->free(j->done);
    if (j->take)
        j->take->free(j->take);
    free_drums(j);
    while (j->forms > 0)
        himc_drum_settings_free(&j->form[--j->forms]);
    for (int i = 0; i < HIMC_DRUMS; i++) {
        himc_drum_heads_free(j->heads[i]);
        himc_drum_heads_free(j->over[i]);
    }
    himc_track_free(j->dropped);
    himc_score_free(j->score);
    free(j);
}

// of a text that is borrowed, or of the file at `path` if it is NULL
static himc_job *job_new(himc_performance *p, const char *text, const char *path, himc_error *error)
{
    score_job *j = himc_job_new(sizeof *j, "score", (himc_job){prepare, install, free_job}, error);
    if (!j)
        return NULL;
    j->performance = p;
    j->text = text;
    j->path = path;
    copy_performance(j);
    j->take = himc_performance_take_trial(p, error);
    if (j->take)
        return &j->job;
    free_job(&j->job);
    return NULL;
}

himc_job *himc_performance_score_job(himc_performance *p, const himc_command *command,
                                     himc_error *error)
{
    score_job *j = (score_job *)job_new(p, NULL, NULL, error);
    if (!j)
        return NULL;
    himc_command_copy(&j->command, command);
    j->path = j->command.atom[0].symbol;
    return &j->job;
}

himc_job *himc_performance_state_job(himc_performance *p, const char *state, himc_error *error)
{
    return job_new(p, state, "state", error);
}

bool himc_performance_load_text(himc_performance *p, const char *text, const char *name,
                                himc_error *error)
{
    return himc_job_carry_out(job_new(p, text, name, error), error);
}

bool himc_performance_exchange_strokes(himc_performance *p, himc_performance *other)
{
    const performance_body *with = other->body;
    himc_track *track = p->motion->track;
    bool good = himc_body_may_exchange_pushes(p->body, with->planned, with->planned_count) &&
                (track ? himc_track_exchange(track, other->motion->track,
                                             step_time(p) - p->motion->track_start)
                       : himc_planner_exchange(p->motion->planner, other->motion->planner));
    if (good)
        himc_body_plan_pushes(p->body, with->planned, with->planned_count, PUSHES_INSTEAD, NULL);
    himc_performance_find_end(p);
    return good;
}
