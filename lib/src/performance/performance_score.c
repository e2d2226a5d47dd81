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

#include "base/head_frame.h"
#include "capture/take.h"
#include "head/idiophone.h"
#include "musicxml/score_file.h"
#include "performance/confine.h"
#include "performance/research.h"
#include "plan/score.h"
#include "himc/loader.h"

#include <stdlib.h>
#include <string.h>

#define TRIAL_RECORDING 0.1 // of the trial of a file that can be opened (s)
// chosen: a portion takes a tenth of a millisecond
#define LINES_AT_ONCE 16
#define STROKES_AT_ONCE 64

/// A drum that the performance has or the score makes.
typedef struct score_drum {
    himc_drum_settings was, trial; ///< owned; before the score's lines, and after them
    himc_model *made;              ///< owned; of the trial's head, NULL if that is as it was
    himc_drum *missing;            ///< owned; to be added, NULL if the performance has it
    drum_source source;            ///< of the missing one
    bool exchanged;                ///< the drum has the head of the trial
    himc_drum_heads *heads;        ///< owned; its changes in the score, to be installed
} score_drum;

/// The name of a drum in a score.
typedef struct named_drum {
    const char *name; ///< "": none, or the first
    himc_spot spot;   ///< of the stroke
    int line;
} named_drum;

/// In the order of installing.
typedef enum score_part { BEGINNING, BEFORE_STROKES, CHANGES, STROKES, AFTER_STROKES } score_part;

typedef struct score_job {
    himc_job job;
    himc_performance *performance; ///< borrowed
    himc_command command;
    const char *path;
    const char *text; ///< borrowed; the score, if it is in no file
    // of the performance, when the job was made
    performance_host host;
    performance_clock clock;
    himc_skeleton skeleton;
    // of the performance, then what the lines tried so far leave
    performance_settings settings;
    bool recording;
    int units;      ///< of motion, that the planner has
    himc_job *take; ///< owned; to try takes
    score_drum drum[HIMC_DRUMS];
    int present, drums; ///< drums of the performance, and all
    himc_score *score;
    bool unknown; ///< it names drums that only the host may have: it has not been tried
    bool unheard; ///< its listener and its changes of heads are left out
    // how far it is installed
    int tries;
    score_part part;
    int at;                            ///< next line or stroke
    bool queued;                       ///< it follows the one that plays
    double from;                       ///< its first beat
    himc_job *line, *done;             ///< owned; a line that takes long: under way, and finished
    himc_track *dropped;               ///< owned
    bool asked;                        ///< the changes of heads have been asked for
    himc_drum_heads *over[HIMC_DRUMS]; ///< owned; what they replaced
} score_job;

// instruments alone: what is played goes on
static bool is_setup(const score_job *j)
{
    return j->command.id == HIMC_COMMAND_SETUP;
}

// the drums of the score

static score_drum *find_drum(score_job *j, const char *name)
{
    for (int i = 0; i < j->drums; i++)
        if (strcmp(j->drum[i].trial.name, name) == 0)
            return &j->drum[i];
    return NULL;
}

static void free_drums(score_job *j)
{
    for (; j->drums > 0; j->drums--) {
        score_drum *d = &j->drum[j->drums - 1];
        himc_drum_settings_free(&d->was);
        himc_drum_settings_free(&d->trial);
        himc_model_free(d->made);
        himc_drum_release(d->missing);
        himc_drum_heads_free(d->heads);
    }
}

static void copy_performance(score_job *j)
{
    const himc_performance *p = j->performance;
    free_drums(j);
    for (; j->drums < p->drums.count; j->drums++) {
        himc_drum_settings was = himc_drum_settings_of(p->drums.slot[j->drums].drum);
        j->drum[j->drums] = (score_drum){.was = was, .trial = himc_drum_settings_copy(&was)};
    }
    j->present = j->drums;
    j->host = p->host;
    j->clock = p->clock;
    j->skeleton = p->body->skeleton;
    j->settings = p->settings;
    j->recording = p->recording.file != NULL;
    j->units = himc_planner_units(p->motion->planner);
}

// `command` makes it, or NULL: it is for strokes on the first drum
static bool make_drum(score_job *j, const himc_command *command, drum_source source,
                      himc_error *error)
{
    const char *name = command ? command->atom[0].symbol : FIRST_DRUM;
    if (find_drum(j, name))
        return true;
    if (j->drums == HIMC_DRUMS)
        return himc_drums_full(name, error);
    himc_drum *made = command ? himc_drum_made(command, j->clock.sample_rate, error)
                              : himc_drum_new(name, HIMC_INCHES_USUAL, j->clock.sample_rate, error);
    if (!made)
        return false;
    himc_drum_settings was = himc_drum_settings_of(made);
    j->drum[j->drums++] = (score_drum){
        .was = was, .trial = himc_drum_settings_copy(&was), .missing = made, .source = source};
    return true;
}

/// Makes the drums that the performance does not have: those of `drum` and `instrument`, or one for
/// strokes on the first.
static bool make_drums(score_job *j, himc_error *error)
{
    for (int i = 0; i < j->score->line_count; i++) {
        const himc_command *c = &j->score->lines[i].command;
        if (himc_score_makes_drum(&j->score->lines[i]) &&
            !make_drum(j, c, j->host.make_drums ? DRUM_MADE : DRUM_SILENT, error))
            return himc_error_prefix(error, "%s:%d", j->path, j->score->lines[i].line);
    }
    return j->drums > 0 || j->score->stroke_count == 0 || make_drum(j, NULL, DRUM_SILENT, error);
}

/// The first line, change or stroke of the score from `*i` on whose drum the performance does not
/// have and the score does not make; false if there is none.
static bool find_unknown(score_job *j, int *i, named_drum *out)
{
    const himc_score *score = j->score;
    for (;; ++*i) {
        int change = *i - score->line_count, stroke = change - score->change_count;
        if (stroke >= score->stroke_count)
            return false;
        const himc_score_line *line = change < 0 ? &score->lines[*i] : &score->changes[change];
        *out = stroke < 0 ? (named_drum){line->drum, HIMC_SPOT_XY, line->line}
                          : (named_drum){score->strokes[stroke].drum, score->strokes[stroke].spot,
                                         score->stroke_lines[stroke]};
        if (out->name[0] && !find_drum(j, out->name))
            return true;
    }
}

static bool refuse_drum(const score_job *j, const named_drum *drum, himc_error *error)
{
    const char *names[HIMC_DRUMS];
    for (int i = 0; i < j->drums; i++)
        names[i] = j->drum[i].trial.name;
    himc_drums_refuse_of(names, j->drums, drum->name, drum->spot, error);
    return himc_error_prefix(error, "%s:%d", j->path, drum->line);
}

// the score tried

/// True if a line can be carried out after those before; reads the file that it names.
static bool rehearse_line(score_job *j, const himc_score_line *line, himc_error *error)
{
    const himc_command *c = &line->command;
    int file, more;
    himc_recording *trial;
    if (line->drum[0])
        return himc_drum_settings_command(&find_drum(j, line->drum)->trial, c, error) ||
               himc_error_prefix(error, "%s", line->drum);
    switch (c->id) {
    case HIMC_COMMAND_PUSH:
        return himc_body_read_push(c, j->settings.stance, &(planned_push){0}, error);
    case HIMC_COMMAND_RESET:
        j->recording = false;
        j->units = 0;
        j->settings = j->host.usual;
        return true;
    case HIMC_COMMAND_TAKE: // before the first drum as the lines before have placed it
        return himc_performance_try_take(j->take, c, j->drums > 0 ? &j->drum[0].trial.place : NULL,
                                         error) &&
               (j->score->stroke_count == 0 ||
                himc_error_set(error, "take: a score with strokes cannot play a take"));
    case HIMC_COMMAND_NUDGE: return himc_performance_try_nudge(j->take, c, error);
    case HIMC_COMMAND_UNITS:
        if (himc_command_file(c, &file) == HIMC_FILE_NONE) { // clear
            j->units = 0;
            return true;
        }
        more = himc_performance_count_units(c, &j->host.take_options, error);
        if (more < 0 || !himc_planner_check_units(j->units, more, error))
            return false;
        j->units += more;
        return true;
    case HIMC_COMMAND_RECORD:
        if (!himc_performance_allows(j->recording, c, error))
            return false;
        j->recording = !j->recording;
        if (!j->recording)
            return true;
        trial = himc_recording_new(c->atom[0].symbol, &j->skeleton, j->clock.task_rate,
                                   TRIAL_RECORDING, error);
        himc_recording_free(trial);
        return (trial && himc_recording_may_replace(c->atom[0].symbol, error)) ||
               himc_error_prefix(error, "record");
    default: // the network's are always refused
        return himc_performance_allows(j->recording, c, error) &&
               himc_settings_read(&j->settings, &j->host.usual, c, error) &&
               (himc_command_table((int)c->id)->when != HIMC_WHEN_NETWORK ||
                j->performance->runner.run(j->performance, c, 0, error));
    }
}

/// Reads the changes of heads that the score has for drums as the trial has left them.
static bool read_heads(score_job *j, himc_error *error)
{
    for (int i = 0; !j->unheard && i < j->score->change_count; i++) {
        const himc_score_line *line = &j->score->changes[i];
        score_drum *d = line->drum[0] ? find_drum(j, line->drum) : NULL;
        if (d && !d->heads)
            d->heads = himc_drum_heads_new(&d->trial, error);
        if (d && (!d->heads ||
                  !himc_drum_heads_add(d->heads, j->from + line->beat, &line->command, error)))
            return himc_error_prefix(error, "%s:%d: %s", j->path, line->line, line->drum);
    }
    return true;
}

/// True if all drums that the trial has left have the parts that strokes are for.
static bool check_parts(score_job *j, himc_error *error)
{
    for (int i = 0; i < j->score->stroke_count; i++) {
        himc_stroke stroke = j->score->strokes[i];
        bool asks = stroke.part[0] || himc_spot_is_beyond(stroke.spot);
        const score_drum *d = !asks            ? NULL
                              : stroke.drum[0] ? find_drum(j, stroke.drum)
                              : j->drums > 0   ? &j->drum[0]
                                               : NULL;
        if (d &&
            !himc_idiophone_place(&d->trial.head.shape, d->trial.head.head.radius, &stroke, error))
            return himc_error_prefix(error, "%s:%d", j->path, j->score->stroke_lines[i]);
    }
    return true;
}

/// The pushes of the score (*count, HIMC_PUSHES at most).
static bool read_pushes(const score_job *j, planned_push *list, int *count, himc_error *error)
{
    *count = 0;
    for (int i = 0; i < j->score->change_count; i++) {
        const himc_score_line *line = &j->score->changes[i];
        if (line->drum[0])
            continue;
        bool good = *count < HIMC_PUSHES ||
                    himc_error_set(error, "push: one too many, expected %d", HIMC_PUSHES);
        if (!good || !himc_body_read_push(&line->command, j->settings.stance, &list[*count], error))
            return himc_error_prefix(error, "%s:%d", j->path, line->line);
        list[(*count)++].beat = j->from + line->beat;
    }
    return true;
}

static bool rehearse(score_job *j, himc_error *error)
{
    const char *folder = j->command.folder;
    planned_push pushes[HIMC_PUSHES];
    int count;
    bool good = true;
    for (int i = 0; i < j->score->line_count; i++) {
        himc_score_line *line = &j->score->lines[i];
        if ((folder && !himc_confine_command(&line->command, folder, error)) ||
            !rehearse_line(j, line, error))
            return himc_error_prefix(error, "%s:%d", j->path, line->line);
    }
    if (!read_pushes(j, pushes, &count, error) || !read_heads(j, error) || !check_parts(j, error))
        return false;
    for (int i = 0; i < j->drums && good; i++) {
        score_drum *d = &j->drum[i];
        if (himc_membrane_config_equal(&d->was.head, &d->trial.head))
            continue;
        d->made = himc_model_new(&d->trial.head, NULL, error);
        good = d->made;
    }
    return good;
}

static bool prefix_line(const score_job *j, himc_error *error)
{
    return himc_error_prefix(error, "%s:%d", j->path, j->score->lines[j->at].line);
}

static bool prepare(himc_job *job, himc_error *error)
{
    score_job *j = (score_job *)job;
    named_drum unknown;
    int i = 0;
    if (j->done)
        j->done->free(j->done);
    j->done = NULL;
    if (j->line)
        return j->line->prepare(j->line, error) || prefix_line(j, error);
    if (j->part == CHANGES) { // the heads are computed before they are needed
        bool good = read_heads(j, error);
        for (int k = 0; k < j->drums && good; k++)
            good =
                !j->drum[k].heads || j->unheard || himc_drum_heads_prepare(j->drum[k].heads, error);
        return good;
    }
    himc_score_free(j->score);
    j->score = is_setup(j) ? himc_score_of_setup(&j->command, error)
               : j->text   ? himc_score_parse(j->text, j->path, j->command.folder, error)
                           : himc_score_load_in(j->command.folder, j->path, error);
    if (!j->score || !make_drums(j, error))
        return false;
    // the host is asked later, in its own thread
    j->unknown = find_unknown(j, &i, &unknown);
    return j->unknown ? j->host.config.find_drum || refuse_drum(j, &unknown, error)
                      : rehearse(j, error);
}

// the score installed

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

// a line for a drum; the first that changes its head brings the head that all of them lead to
static bool run_on_drum(score_job *j, const himc_score_line *line, himc_error *error)
{
    int index;
    score_drum *d = find_drum(j, line->drum);
    if (!installed_drum(j, line->drum, &index, error))
        return false;
    himc_drum *drum = j->performance->drums.slot[index].drum;
    if (!(himc_command_table((int)line->command.id)->marks & HIMC_CHANGES_HEAD))
        return himc_drum_command(drum, &line->command, error) ||
               himc_error_prefix(error, "%s", line->drum);
    himc_drum_settings to = himc_drum_settings_of(drum);
    himc_drum_settings_free(&to); // what is prepared has its own grid
    himc_drum_settings_take_head(&to, &d->trial);
    bool good = d->exchanged || himc_drum_set(drum, &to, &d->made, error);
    d->exchanged = true;
    return good;
}

// A line, or the next part of one that takes long. A hit or a blow that is refused is left out.
static himc_job_state run_line(score_job *j, const himc_score_line *line, himc_error *error)
{
    himc_performance *p = j->performance;
    const himc_command *c = &line->command;
    bool good;
    int index;
    if (line->drum[0]) {
        good = run_on_drum(j, line, error);
    } else if (himc_score_makes_drum(line)) {
        good = installed_drum(j, c->atom[0].symbol, &index, error);
    } else if (j->line) {
        himc_job_state state = j->line->install(j->line, error);
        if (state == HIMC_JOB_MORE || state == HIMC_JOB_AGAIN)
            return state;
        j->done = j->line;
        j->line = NULL;
        good = state == HIMC_JOB_DONE;
    } else if (j->unheard && c->id == HIMC_COMMAND_LISTENER) {
        return HIMC_JOB_DONE;
    } else if (p->runner.takes_long(p, c)) {
        j->line = p->runner.job(p, c, error);
        if (j->line)
            return HIMC_JOB_AGAIN;
        good = false;
    } else {
        good = p->runner.run(p, c, 0, error);
    }
    if (good)
        return HIMC_JOB_DONE;
    prefix_line(j, error);
    if (c->id != HIMC_COMMAND_HIT && c->id != HIMC_COMMAND_STRIKE)
        return HIMC_JOB_FAILED;
    himc_events_note(&p->events, "%s", error->text);
    error->text[0] = '\0';
    return HIMC_JOB_DONE;
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

// the tempi; the heads that the score changes, the end of those of the score before, and its pushes
static himc_job_state install_changes(score_job *j, himc_error *error)
{
    himc_performance *p = j->performance;
    const himc_score *score = j->score;
    double now = himc_motion_score_beat(p->motion, step_time(p));
    planned_push list[HIMC_PUSHES];
    int count, first;
    if (!j->asked) {
        himc_planner *planner = p->motion->planner;
        himc_performance_notice_drums(p);
        if (!j->queued) {
            himc_planner_clear(planner);
            himc_feet_clear(&p->motion->feet);
            himc_text_clear(&p->written.score);
            himc_dynamics_clear(&p->written.dynamics);
        }
        j->from = j->queued ? himc_planner_next_start(planner, step_time(p)) : 0;
        if (!himc_planner_append_tempi(planner, score->tempi, score->tempo_count, j->from, error)) {
            himc_error_prefix(error, "%s", j->path);
            return HIMC_JOB_FAILED;
        }
    }
    if (score->change_count > 0 && !j->asked) {
        if (score->stroke_count > 0 && !installed_drum(j, "", &first, error))
            return HIMC_JOB_FAILED;
        copy_performance(j);
        j->asked = true;
        return HIMC_JOB_AGAIN;
    }
    for (int i = 0; i < p->drums.count; i++) {
        score_drum *d = find_drum(j, himc_drum_name(p->drums.slot[i].drum));
        himc_drum_heads *heads = d ? d->heads : NULL;
        if (j->queued && !heads)
            continue;
        himc_drum_heads *before = himc_drums_set_heads(&p->drums, i, heads);
        if (heads)
            d->heads = NULL;
        j->over[i] = j->queued ? himc_drum_heads_follow(heads, before, j->from, now) : before;
    }
    bool good =
        read_pushes(j, list, &count, error) &&
        himc_body_plan_pushes(p->body, list, count, j->queued ? PUSHES_AFTER : PUSHES_ANEW, error);
    himc_performance_find_end(p);
    return good ? HIMC_JOB_DONE : HIMC_JOB_FAILED;
}

// What is written, as the file has it, for `dump` (a push is told as it is planned); then the
// strokes; then what ornaments add, which leaves out what does not fit.
static himc_job_state add_strokes(score_job *j, himc_error *error)
{
    himc_performance *p = j->performance;
    const himc_score *score = j->score;
    int count = score->stroke_count, lines = count + score->change_count;
    himc_text_lines *written = &p->written.score;
    for (int added = 0; j->at < lines + 2 * count; j->at++, added++) {
        bool good, writes = j->at < lines, ornament = j->at - lines >= count;
        int drum, place = writes ? score->order[j->at] : (j->at - lines) % count;
        himc_stroke stroke = {.beat = 0};
        if (added >= STROKES_AT_ONCE)
            return HIMC_JOB_MORE;
        if (place >= 0)
            stroke = score->strokes[place];
        stroke.beat += j->from;
        if (writes) {
            good = himc_written_room(written, "score", error);
            if (good && place >= 0)
                himc_written_stroke(written, &stroke);
            else if (good && score->changes[-1 - place].drum[0])
                himc_written_change(written, &score->changes[-1 - place], j->from);
        } else {
            bool rolls = stroke.ornament >= HIMC_ROLL_SINGLE;
            good = installed_drum(j, stroke.drum, &drum, error) &&
                   (!ornament || himc_performance_place_stroke(p, &stroke, drum, error));
            if (good && ornament) {
                himc_performance_add_ornament(p, &stroke, drum);
                added += rolls ? STROKES_AT_ONCE : 0; // it may be long
            } else if (good && !rolls) {
                stroke.ornament = HIMC_PLAIN;
                good = himc_performance_put_stroke(p, &stroke, error);
            }
        }
        if (!good) {
            himc_error_prefix(error, "%s:%d", j->path,
                              place < 0 ? score->changes[-1 - place].line
                                        : score->stroke_lines[place]);
            return HIMC_JOB_FAILED;
        }
    }
    return HIMC_JOB_DONE;
}

static himc_job_state begin(score_job *j, himc_error *error)
{
    himc_performance *p = j->performance;
    const himc_score *score = j->score;
    named_drum unknown;
    int pushes = 0;
    // the host may have the drums that the performance does not have; for one that the score makes,
    // it may have one that sounds
    for (int k = 0; k < j->drums; k++)
        himc_performance_find_drum(p, j->drum[k].trial.name);
    for (int i = 0; j->unknown && find_unknown(j, &i, &unknown); i++)
        if (!himc_performance_find_drum(p, unknown.name) ||
            himc_drums_find(&p->drums, unknown.name) < 0) {
            refuse_drum(j, &unknown, error);
            return HIMC_JOB_FAILED;
        }
    // the drums should be those with which the score was tried
    bool same =
        !j->unknown && p->drums.count == j->present && j->clock.sample_rate == p->clock.sample_rate;
    for (int i = 0; i < p->drums.count && same; i++) {
        himc_drum *drum = p->drums.slot[i].drum;
        const score_drum *d = find_drum(j, himc_drum_name(drum));
        same = d && himc_drum_has_head(drum, &d->was);
    }
    if (!same && (++j->tries < HIMC_JOB_TRIES || j->unknown)) {
        copy_performance(j);
        return HIMC_JOB_AGAIN;
    }
    if (is_setup(j))
        return HIMC_JOB_DONE;
    // while a score is played the next one waits for its end, if it finds room behind it
    j->queued = p->motion->playing && himc_motion_plays_score(p->motion);
    for (int i = 0; i < score->change_count; i++)
        pushes += !score->changes[i].drum[0];
    if (j->queued &&
        (!himc_planner_has_room(p->motion->planner, score->strokes, score->stroke_count, error) ||
         !himc_body_make_push_room(p->body, pushes, error))) {
        himc_error_prefix(error, "%s", j->path);
        return HIMC_JOB_FAILED;
    }
    j->dropped = himc_performance_drop_track(p);
    return HIMC_JOB_DONE;
}

static himc_job_state install(himc_job *job, himc_error *error)
{
    score_job *j = (score_job *)job;
    himc_job_state state;
    switch (j->part) {
    case BEGINNING: state = begin(j, error); break;
    case BEFORE_STROKES: state = run_lines(j, false, error); break;
    case CHANGES: state = install_changes(j, error); break;
    case STROKES: state = add_strokes(j, error); break;
    default: state = run_lines(j, true, error);
    }
    himc_motion_replan(j->performance->motion);
    if (state != HIMC_JOB_DONE)
        return state;
    j->at = 0;
    j->part = is_setup(j) && j->part == BEFORE_STROKES ? AFTER_STROKES : j->part + 1;
    if (j->part <= AFTER_STROKES)
        return HIMC_JOB_MORE;
    // what is played of a MIDI or MusicXML file, and what not; what of a text stands in a comment
    const char *line = j->score->report ? j->score->report : "", *end;
    for (; (end = strchr(line, '\n')); line = end + 1)
        himc_events_note_as(&j->performance->events, j->score->left_out ? NOTE_USUAL : NOTE_MINOR,
                            "%.*s", (int)(end - line), line);
    return HIMC_JOB_DONE;
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
    for (int i = 0; i < HIMC_DRUMS; i++)
        himc_drum_heads_free(j->over[i]);
    himc_track_free(j->dropped);
    himc_score_free(j->score);
    free(j);
}

himc_job *himc_performance_score_job(himc_performance *p, const char *text, const char *name,
                                     const himc_command *command, himc_error *error)
{
    score_job *j = himc_job_new(sizeof *j, "score", (himc_job){prepare, install, free_job}, error);
    if (!j)
        return NULL;
    j->performance = p;
    j->text = text;
    if (command)
        himc_command_copy(&j->command, command);
    j->path = is_setup(j) ? "setup" : command ? j->command.atom[0].symbol : name;
    copy_performance(j);
    j->take = himc_performance_take_job(p, NULL, error);
    if (j->take)
        return &j->job;
    free_job(&j->job);
    return NULL;
}

bool himc_performance_load_text(himc_performance *p, const char *text, const char *name,
                                himc_error *error)
{
    return himc_job_carry_out(himc_performance_score_job(p, text, name, NULL, error), error);
}

bool himc_performance_load_unheard(himc_performance *p, const char *text, const char *name,
                                   himc_error *error)
{
    himc_job *job = himc_performance_score_job(p, text, name, NULL, error);
    if (job)
        ((score_job *)job)->unheard = true;
    return himc_job_carry_out(job, error);
}

double himc_performance_rests_to(const himc_performance *p, himc_hand hand)
{
    return p->motion->track ? himc_motion_take_time(p->motion, step_time(p))
                            : himc_planner_rests_to(p->motion->planner, hand);
}

bool himc_performance_exchange_strokes(himc_performance *p, himc_performance *other)
{
    const performance_body *with = other->body;
    himc_track *track = p->motion->track;
    performance_feet *feet = &p->motion->feet, *others = &other->motion->feet;
    bool good = himc_body_may_exchange_pushes(p->body, with->planned, with->planned_count) &&
                (track || himc_feet_may_exchange(feet, others)) &&
                (track ? himc_track_exchange(track, other->motion->track,
                                             himc_motion_take_time(p->motion, step_time(p)))
                       : himc_planner_exchange(p->motion->planner, other->motion->planner));
    if (good && !track)
        himc_feet_exchange(feet, others);
    if (good)
        himc_body_plan_pushes(p->body, with->planned, with->planned_count, PUSHES_INSTEAD, NULL);
    himc_performance_find_end(p);
    return good;
}
