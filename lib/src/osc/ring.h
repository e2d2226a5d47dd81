/// ring.h: the data that the audio thread and the network thread share: rings of records, and
/// counters. Neither thread ever waits for the other.
#ifndef HIMC_OSC_RING_H
#define HIMC_OSC_RING_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

/// Wait-free ring with one writer and one reader; slots of one size.
typedef struct osc_ring {
    char *data;
    size_t slot, count;           ///< size of a slot (bytes); slots, a power of two
    _Atomic size_t written, read; ///< slots since the start
    _Atomic long lost;            ///< records refused because the ring was full
} osc_ring;

bool himc_osc_ring_init(osc_ring *ring, size_t slot, size_t count);
void himc_osc_ring_free(osc_ring *ring);
/// The writer's next slot, to be filled and then pushed; NULL if the ring is full (counted).
void *himc_osc_ring_slot(osc_ring *ring);
/// Slots that the writer may fill before it is full.
size_t himc_osc_ring_room(const osc_ring *ring);
void himc_osc_ring_push(osc_ring *ring);
/// The oldest record, or NULL if there is none.
const void *himc_osc_ring_peek(osc_ring *ring);
void himc_osc_ring_pop(osc_ring *ring);

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
