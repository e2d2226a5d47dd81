/// pool.h: runs independent items of work in parallel, one process for each core.
#ifndef POOL_H
#define POOL_H

#include "himc/base.h"

#define POOL_RESULT 1024 ///< largest result (bytes)

/// The work and the receiver of its results.
typedef struct pool {
    int items;          ///< numbered from 0
    int jobs;           ///< processes, at least 1
    size_t result_size; ///< (bytes) at most POOL_RESULT
    /// Does one item, in a separate process without shared state; false with the reason.
    bool (*work)(void *user, int item, void *result, himc_error *error);
    /// Receives a result in the calling process, in any order; false with the reason stops all
    /// work.
    bool (*done)(void *user, int item, const void *result, himc_error *error);
    void *user;
} pool;

/// Runs all items. False with the first reason if one failed; then no further items are started.
bool pool_run(const pool *pool, himc_error *error);

/// Number of cores that are online, 1 .. 256.
int pool_cores(void);

#endif
