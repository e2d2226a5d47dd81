/// job.c: a job carried out by the thread that needs it.
#include "base/job.h"

bool himc_job_carry_out(himc_job *job, himc_error *error)
{
    if (!job)
        return false;
    himc_job_state state = HIMC_JOB_AGAIN;
    while (state == HIMC_JOB_AGAIN || state == HIMC_JOB_MORE) {
        if (state == HIMC_JOB_AGAIN && !job->prepare(job, error))
            state = HIMC_JOB_FAILED;
        else
            state = job->install(job, error);
    }
    job->free(job);
    return state == HIMC_JOB_DONE;
}
