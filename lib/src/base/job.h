/// job.h: a command that takes long, in two parts: `prepare` reads files and computes, in a helper
/// thread; `install` puts the result in its place, between two blocks of the audio thread.
///
/// Invariant: `prepare` and `free` touch only the job: what they need of the instrument was copied
/// into it when it was made, or by `install`. So one job, carried out here or by a loader
/// (himc/loader.h), has one result.
#ifndef HIMC_JOB_H
#define HIMC_JOB_H

#include "himc/command.h"

#include "base/array.h"

typedef struct himc_drum himc_drum;               ///< himc/drum.h
typedef struct himc_performance himc_performance; ///< himc/performance.h

/// What `install` says.
typedef enum himc_job_state {
    HIMC_JOB_DONE,
    HIMC_JOB_FAILED, ///< with the reason
    HIMC_JOB_MORE,   ///< call `install` again: it has used up its share of a block
    HIMC_JOB_AGAIN   ///< call `prepare` again: the instrument has changed, or the next part is due
} himc_job_state;

/// An instrument that changes all the time does not hold up a job for ever: after so many times
/// `install` does with what it has. Chosen.
#define HIMC_JOB_TRIES 3

typedef struct himc_job himc_job;
/// The first member of each kind of job. No `error` is NULL.
struct himc_job {
    bool (*prepare)(himc_job *job, himc_error *error); ///< false with the reason: it has failed
    himc_job_state (*install)(himc_job *job, himc_error *error); ///< bounded time
    void (*free)(himc_job *job); ///< frees the job and what `install` has replaced
};

/// The first member of a performance: how it takes commands, some of which take long.
typedef struct himc_runner {
    bool (*takes_long)(const himc_performance *receiver, const himc_command *command); ///< HIMC_RT
    /// carries it out `delay` samples from now; false with the reason
    bool (*run)(himc_performance *receiver, const himc_command *command, int delay,
                himc_error *error);
    himc_job *(*job)(himc_performance *receiver, const himc_command *command, himc_error *error);
    /// lines that `dump` has told, borrowed, as a job
    himc_job *(*state_job)(himc_performance *receiver, const char *state, himc_error *error);
    /// the drum that a command with a drum's name is for, borrowed; NULL with the reason
    himc_drum *(*drum)(himc_performance *receiver, const himc_command *command, himc_error *error);
} himc_runner;

/// Memory of `size` bytes, zero but for the job that they begin with; NULL with a reason that
/// begins with `what`.
static inline void *himc_job_new(size_t size, const char *what, himc_job functions, himc_error *why)
{
    himc_job *job = himc_new(size, what, why);
    if (job)
        *job = functions;
    return job;
}

/// Carries out a job at once and frees it. NULL: false; whoever made none has said why.
static inline bool himc_job_carry_out(himc_job *job, himc_error *why)
{
    if (!job)
        return false;
    himc_error untold = {""};
    himc_job_state state = HIMC_JOB_AGAIN;
    why = why ? why : &untold;
    while (state == HIMC_JOB_AGAIN || state == HIMC_JOB_MORE) {
        if (state == HIMC_JOB_AGAIN && !job->prepare(job, why))
            state = HIMC_JOB_FAILED;
        else
            state = job->install(job, why);
    }
    job->free(job);
    return state == HIMC_JOB_DONE;
}

#endif
