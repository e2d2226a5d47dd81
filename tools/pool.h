/// pool.h: independent work spread over the cores, one process each.
#ifndef POOL_H
#define POOL_H

#include "himc/base.h"

#define POOL_RESULT 1024 ///< largest result (bytes)

/// What is to be done and what becomes of it.
typedef struct pool {
    int items;          ///< numbered from 0
    int jobs;           ///< processes, at least 1
    size_t result_size; ///< (bytes) at most POOL_RESULT
    /// Does one item, in a process of its own that shares nothing; false with the reason.
    bool (*work)(void *user, int item, void *result, himc_error *error);
    /// Takes a result, here, as soon as it is there, in whatever order; false stops everything.
    bool (*done)(void *user, int item, const void *result, himc_error *error);
    void *user;
} pool;

/// Runs all items; false with the first reason if one failed, after which no more are begun.
bool pool_run(const pool *pool, himc_error *error);

/// Cores that are online.
int pool_cores(void);

#endif
