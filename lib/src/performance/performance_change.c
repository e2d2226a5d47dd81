/// performance_change.c: what a score has at beats beside strokes: a pedal moves, a hand is laid on
/// a head, the player is pushed. `at` adds one to the score that plays or will be played.
///
/// It is a job (base/job.h): the heads that follow from it are computed aside. Invariants: the
/// piece lasts until the last of them; a beat that is past is told, and acts when it comes again.
#include "performance/performance_state.h"

#include "plan/score.h"

#include <stdlib.h>
#include <string.h>

typedef struct change_job {
    himc_job job;
    himc_performance *performance; ///< borrowed
    himc_score_line line;
    himc_head_insertion *insertion, *over; ///< owned; of a head: under way, and what did not fit
    int tries;
} change_job;

void himc_performance_find_end(himc_performance *p)
{
    double end = himc_feet_last(&p->motion->feet);
    for (int i = 0; i < p->drums.count; i++)
        end = fmax(end, himc_drum_heads_last(p->drums.slot[i].heads));
    for (int i = 0; i < p->body->planned_count; i++)
        end = fmax(end, p->body->planned[i].beat);
    himc_planner_last_until(p->motion->planner, end);
}

/// Begins with the heads as they are now.
static bool begin(change_job *j, himc_error *error)
{
    himc_performance *p = j->performance;
    int index;
    if (!j->line.drum[0])
        return true;
    if (!himc_performance_index_drum(p, j->line.drum, HIMC_SPOT_XY, &index, error))
        return false;
    j->over = j->insertion;
    j->insertion = himc_head_insertion_new(p->drums.slot[index].heads, p->drums.slot[index].drum,
                                           j->line.beat, &j->line.command, error);
    return j->insertion;
}

static bool prepare(himc_job *job, himc_error *error)
{
    change_job *j = (change_job *)job;
    himc_head_insertion_free(j->over);
    j->over = NULL;
    return !j->insertion || himc_head_insertion_prepare(j->insertion, error) ||
           himc_error_prefix(error, "%s", j->line.drum);
}

static himc_job_state install(himc_job *job, himc_error *error)
{
    change_job *j = (change_job *)job;
    himc_performance *p = j->performance;
    const himc_score_line *line = &j->line;
    planned_push push;
    double now = himc_motion_score_beat(p->motion, step_time(p));
    int index;
    bool good;
    if (!j->insertion) {
        good = himc_body_read_push(&line->command, p->settings.stance, &push, error);
        push.beat = line->beat;
        good = good && himc_body_insert_push(p->body, &push, error);
    } else {
        good = himc_written_room(&p->written.score, "at", error) &&
               himc_performance_index_drum(p, line->drum, HIMC_SPOT_XY, &index, error);
        if (good && !himc_head_insertion_install(j->insertion, &p->drums.slot[index].heads, now)) {
            if (++j->tries < HIMC_JOB_TRIES)
                return begin(j, error) ? HIMC_JOB_AGAIN : HIMC_JOB_FAILED;
            good = himc_error_set(error, "at: drum %s changes all the time", line->drum);
        }
        if (good)
            himc_written_change(&p->written.score, line, 0);
    }
    bool comes_again =
        himc_motion_plays_score(p->motion) && himc_planner_is_looped(p->motion->planner);
    if (good && now > line->beat && !comes_again) // before the next `play`
        himc_events_note(&p->events, "at %g %s%s%s: given up, that beat is past", line->beat,
                         line->drum, line->drum[0] ? " " : "",
                         himc_command_table((int)line->command.id)->name);
    himc_performance_find_end(p);
    himc_motion_stir(p->motion);
    return good ? HIMC_JOB_DONE : HIMC_JOB_FAILED;
}

static void free_job(himc_job *job)
{
    change_job *j = (change_job *)job;
    himc_head_insertion_free(j->insertion);
    himc_head_insertion_free(j->over);
    free(j);
}

himc_job *himc_performance_change_job(himc_performance *p, const himc_command *command,
                                      himc_error *error)
{
    change_job *j = himc_job_new(sizeof *j, "at", (himc_job){prepare, install, free_job}, error);
    if (!j)
        return NULL;
    j->performance = p;
    bool read = himc_score_read_change(command->atom, command->count, &j->line, error);
    if (read && begin(j, error))
        return &j->job;
    free_job(&j->job);
    return NULL;
}
