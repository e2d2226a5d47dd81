/// counters.h: what a himc_osc counts, in both its threads.
#ifndef HIMC_OSC_COUNTERS_H
#define HIMC_OSC_COUNTERS_H

#include <stdatomic.h>

/// The counters: X(ID, field of himc_osc_counts).
#define OSC_COUNTERS(X)     \
    X(PACKETS, packets)     \
    X(COMMANDS, commands)   \
    X(MALFORMED, malformed) \
    X(FOREIGN, foreign)     \
    X(REFUSED, refused)     \
    X(FREQUENT, frequent)   \
    X(OVERRUN, overrun)     \
    X(SENT, sent)           \
    X(UNSENT, unsent)       \
    X(CAPPED, capped)
#define OSC_COUNTER(ID, field) COUNT_##ID,
typedef enum osc_counter { OSC_COUNTERS(OSC_COUNTER) COUNTERS } osc_counter;

typedef struct osc_counters {
    _Atomic long count[COUNTERS];
} osc_counters;

static inline void himc_osc_add(osc_counters *counters, osc_counter which, long n)
{
    atomic_fetch_add_explicit(&counters->count[which], n, memory_order_relaxed);
}

static inline long himc_osc_read(const osc_counters *counters, osc_counter which)
{
    return atomic_load_explicit(&counters->count[which], memory_order_relaxed);
}

#endif
