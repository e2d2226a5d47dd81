/// ring.h: a ring of records between two threads that never wait for each other.
#ifndef HIMC_SYSTEM_RING_H
#define HIMC_SYSTEM_RING_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

/// Wait-free ring with one writer and one reader; slots of one size.
typedef struct system_ring {
    char *data;
    size_t slot, count;           ///< size of a slot (bytes); slots, a power of two
    _Atomic size_t written, read; ///< slots since the start
    _Atomic long lost;            ///< records refused because the ring was full
} system_ring;

/// A ring of zeros; false without memory, then it is to be freed as well.
bool himc_ring_init(system_ring *ring, size_t slot, size_t count);
void himc_ring_free(system_ring *ring);
/// The writer's next slot, to be filled and then pushed; NULL if the ring is full (counted).
void *himc_ring_slot(system_ring *ring);
/// Slots that the writer may fill before it is full. slot, room and push are the writer's, peek,
/// pop and lost the reader's.
size_t himc_ring_room(const system_ring *ring);
void himc_ring_push(system_ring *ring);
/// The oldest record, or NULL if there is none.
const void *himc_ring_peek(const system_ring *ring);
void himc_ring_pop(system_ring *ring);
/// Records refused since the last call.
long himc_ring_lost(system_ring *ring);

#endif
