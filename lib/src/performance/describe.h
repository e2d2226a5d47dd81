/// describe.h: the state of a performance told in parts, for a thread that has little time:
/// osc_host.c; `dump` tells all of it.
#ifndef HIMC_PERFORMANCE_DESCRIBE_H
#define HIMC_PERFORMANCE_DESCRIBE_H

#include "himc/performance.h"

/// How far it has been told. All zero: nothing yet.
typedef struct himc_describe_place {
    int part;
    size_t at;
} himc_describe_place;

/// Tells the next lines of HIMC_DESCRIBE_STATE, those of one drum or at most 32; false after the
/// last ones. What is changed in between is told as it was or as it is.
bool himc_performance_describe_on(const himc_performance *performance, himc_describe_place *place,
                                  void (*line)(void *, const char *), void *user);

#endif
