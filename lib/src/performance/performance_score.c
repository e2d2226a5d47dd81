/// performance_score.c: `score FILE`: a score is accepted as a whole, or refused.
///
/// The file is parsed as a whole (score.c) and then tried: its lines for drums go to copies of the
/// drums, its lines for the performer are checked, its drums are counted. Only then is it carried
/// out. While a score plays, the beats of the next one follow its own. Invariants: a score that is
/// refused has changed nothing; a score from the network may do what its sender may do.
#include "performance/performance_state.h"

#include "base/confine.h"
#include "capture/take.h"
#include "plan/score.h"

#include <stdio.h>
#include <string.h>

#define TRIAL_RECORDING 0.1 // of the trial of a file that can be opened (s)

/// Copies of the drums, for trying a score; owned.
typedef struct rehearsal {
    himc_performance *performance;
    performance_action *run; ///< of a command
    himc_drum *drum[HIMC_DRUMS];
    int drums;
} rehearsal;

static himc_drum *find(himc_drum *const *drum, int drums, const char *name)
{
    for (int i = 0; i < drums; i++)
        if (strcmp(himc_drum_name(drum[i]), name) == 0)
            return drum[i];
    return NULL;
}

static himc_drum *real_drum(const himc_performance *p, const char *name)
{
    int index = himc_drums_find(&p->drums, name);
    return index < 0 ? NULL : p->drums.slot[index].drum;
}

/// The trial drum of that name; "" is the performer's first.
static himc_drum *trial_drum(rehearsal *r, const char *name, double inches, himc_error *error)
{
    himc_performance *p = r->performance;
    if (!name[0] && p->drums.count > 0)
        name = himc_drum_name(p->drums.slot[0].drum);
    himc_drum *drum = find(r->drum, r->drums, name), *real = real_drum(p, name);
    if (drum)
        return drum;
    if (r->drums == HIMC_DRUMS) {
        himc_error_set(error, "drum %s: a performer plays on %d drums at most", name, HIMC_DRUMS);
        return NULL;
    }
    drum = himc_drum_new(name, inches, p->clock.sample_rate, error);
    if (drum && real &&
        !himc_membrane_follow(himc_drum_membrane(drum), himc_drum_membrane(real), error)) {
        himc_drum_release(drum);
        return NULL;
    }
    if (!drum)
        return NULL;
    himc_drum_set_external_sound(drum, real && himc_drum_has_external_sound(real));
    return r->drum[r->drums++] = drum;
}

/// True if a line for the performer can be carried out; reads the file that it names.
static bool rehearse_command(rehearsal *r, const himc_command *c, himc_error *error)
{
    himc_performance *p = r->performance;
    const char *word = c->count > 0 ? c->atom[0].symbol : "";
    himc_take *take;
    himc_recording *recording;
    int joint, file;
    switch (c->id) {
    case HIMC_COMMAND_MAKE_DRUM:
        return !p->host.make_drums ||
               trial_drum(r, word, c->count > 1 ? c->atom[1].number : USUAL_INCHES, error);
    case HIMC_COMMAND_GAIN:
        return c->count < 3 || himc_body_find_joint(word, "gain", &joint, error);
    case HIMC_COMMAND_STRENGTH:
        return c->count < 2 || himc_body_find_joint(word, "strength", &joint, error);
    case HIMC_COMMAND_TAKE:
    case HIMC_COMMAND_UNITS:
        if (himc_command_file(c, &file) == HIMC_FILE_NONE)
            return true; // `units clear`
        take = himc_take_load_in(c->folder, word, &p->host.take_options, error);
        himc_take_free(take);
        return take;
    case HIMC_COMMAND_RECORD:
        if (p->recording.file || himc_command_file(c, &file) == HIMC_FILE_NONE)
            return true;
        recording = himc_recording_new(word, &p->body->skeleton, p->clock.task_rate,
                                       TRIAL_RECORDING, error);
        himc_recording_free(recording);
        return recording || himc_error_prefix(error, "record");
    default: // the network's are always refused
        return himc_command_table((int)c->id)->when != HIMC_WHEN_NETWORK || r->run(p, c, error);
    }
}

static bool rehearse_line(rehearsal *r, const himc_score_line *line, himc_error *error)
{
    if (!line->drum[0])
        return rehearse_command(r, &line->command, error);
    himc_drum *drum = trial_drum(r, line->drum, USUAL_INCHES, error);
    return drum && (himc_drum_command(drum, &line->command, error) ||
                    himc_error_prefix(error, "%s", line->drum));
}

/// Number of drums with this score: the present ones, and those named by lines and strokes.
static bool count_drums(const rehearsal *r, const himc_score *score, himc_error *error)
{
    const char *name[HIMC_DRUMS];
    const himc_performance *p = r->performance;
    int count = 0;
    for (int i = 0; i < p->drums.count; i++)
        name[count++] = himc_drum_name(p->drums.slot[i].drum);
    for (int i = -r->drums; i < score->stroke_count; i++) {
        const char *wanted = i < 0 ? himc_drum_name(r->drum[-1 - i]) : score->strokes[i].drum;
        int k = 0;
        while (k < count && strcmp(name[k], wanted) != 0)
            k++;
        if (k < count || !wanted[0])
            continue;
        if (count == HIMC_DRUMS)
            return himc_error_set(error, "drum %s: a performer plays on %d drums at most", wanted,
                                  HIMC_DRUMS);
        name[count++] = wanted;
    }
    return true;
}

static bool rehearse(himc_performance *p, himc_score *score, const char *path, const char *folder,
                     performance_action *run, himc_error *error)
{
    rehearsal r = {.performance = p, .run = run};
    bool good = true;
    for (int i = 0; i < score->line_count && good; i++) {
        good = (!folder || himc_confine_command(&score->lines[i].command, folder, error)) &&
               rehearse_line(&r, &score->lines[i], error);
        if (good && score->lines[i].command.id == HIMC_COMMAND_TAKE && score->stroke_count > 0)
            good = himc_error_set(error, "take: a score with strokes cannot play a take");
        good = good || himc_error_prefix(error, "%s:%d", path, score->lines[i].line);
    }
    good = good && (count_drums(&r, score, error) || himc_error_prefix(error, "%s", path));
    for (int i = 0; i < r.drums; i++)
        himc_drum_release(r.drum[i]);
    return good;
}

// a line that is not a stroke: for the performer or one of its drums
static bool run_line(himc_performance *p, const himc_score_line *line, performance_action *run,
                     himc_error *error)
{
    int index;
    if (!line->drum[0])
        return run(p, &line->command, error);
    return himc_performance_ensure_drum(p, line->drum, &index, error) &&
           (himc_drum_command(p->drums.slot[index].drum, &line->command, error) ||
            himc_error_prefix(error, "%s", line->drum));
}

// commands that act on strokes or on the transport are carried out after the strokes are loaded
static bool comes_after_strokes(const himc_score_line *line)
{
    return himc_command_table((int)line->command.id)->marks & HIMC_AFTER_STROKES;
}

static bool run_lines(himc_performance *p, const himc_score *score, bool after, const char *path,
                      performance_action *run, himc_error *error)
{
    for (int i = 0; i < score->line_count; i++)
        if (comes_after_strokes(&score->lines[i]) == after &&
            !run_line(p, &score->lines[i], run, error))
            return himc_error_prefix(error, "%s:%d", path, score->lines[i].line);
    return true;
}

static bool fill_from_score(himc_performance *p, const himc_score *score, const char *path,
                            performance_action *run, himc_error *error)
{
    // while a score is played the next one waits for its end
    bool queued = p->motion->playing && !p->motion->track;
    himc_performance_drop_track(p);
    if (!run_lines(p, score, false, path, run, error))
        return false;
    himc_performance_notice_drums(p);
    if (!queued)
        himc_planner_clear(p->motion->planner);
    double from = queued ? himc_planner_next_start(p->motion->planner, step_time(p)) : 0;
    if (!himc_planner_append_tempi(p->motion->planner, score->tempi, score->tempo_count, from,
                                   error))
        return himc_error_prefix(error, "%s", path);
    for (int i = 0; i < score->stroke_count; i++) {
        himc_stroke stroke = score->strokes[i];
        stroke.beat += from;
        if (!himc_performance_add_stroke(p, &stroke, error))
            return himc_error_prefix(error, "%s", path);
    }
    return run_lines(p, score, true, path, run, error);
}

bool himc_performance_load_score(himc_performance *p, const char *path, const char *folder,
                                 performance_action *run, himc_error *error)
{
    himc_score *score = himc_score_load_in(folder, path, error);
    if (!score)
        return false;
    bool ok =
        rehearse(p, score, path, folder, run, error) && fill_from_score(p, score, path, run, error);
    himc_score_free(score);
    himc_motion_replan(p->motion);
    return ok;
}
