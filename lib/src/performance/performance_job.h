/// performance_job.h: the commands of a performance that take long, as jobs.
#ifndef HIMC_PERFORMANCE_JOB_H
#define HIMC_PERFORMANCE_JOB_H

#include "base/job.h"
#include "himc/performance.h"

/// True if a command takes longer than an audio block can wait: it reads or writes a file, or makes
/// a drum.
HIMC_RT bool himc_performance_takes_long(const himc_performance *performance,
                                         const himc_command *command);
/// Such a command as a job; the performance must outlive it. NULL with the reason.
himc_job *himc_performance_job(himc_performance *performance, const himc_command *command,
                               himc_error *error);

#endif
