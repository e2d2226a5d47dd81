/// ring.c: a ring between two threads that never wait for each other.
///
/// One thread writes, the other reads; each moves its own index and only reads the other's. The
/// release of `written` makes the contents of a slot visible to the reader that acquires it; the
/// release of `read` does the same for the reuse of the slot. A full ring refuses and counts the
/// record, so the host never waits; the oldest records are kept.
#include "system/ring.h"

#include <stdlib.h>

#define CACHE_LINE 64 // (bytes) slots begin on one, so that the two threads rarely share a line

bool himc_ring_init(system_ring *ring, size_t slot, size_t count)
{
    ring->slot = (slot + CACHE_LINE - 1) / CACHE_LINE * CACHE_LINE;
    ring->count = count;
    ring->data = calloc(count, ring->slot);
    return ring->data != NULL;
}

void himc_ring_free(system_ring *ring)
{
    free(ring->data);
    ring->data = NULL;
}

void *himc_ring_slot(system_ring *ring)
{
    size_t written = atomic_load_explicit(&ring->written, memory_order_relaxed);
    if (written - atomic_load_explicit(&ring->read, memory_order_acquire) == ring->count) {
        atomic_fetch_add_explicit(&ring->lost, 1, memory_order_relaxed);
        return NULL;
    }
    return ring->data + written % ring->count * ring->slot;
}

size_t himc_ring_room(const system_ring *ring)
{
    size_t written = atomic_load_explicit(&ring->written, memory_order_relaxed);
    return ring->count - (written - atomic_load_explicit(&ring->read, memory_order_acquire));
}

void himc_ring_push(system_ring *ring)
{
    size_t written = atomic_load_explicit(&ring->written, memory_order_relaxed);
    atomic_store_explicit(&ring->written, written + 1, memory_order_release);
}

const void *himc_ring_peek(const system_ring *ring)
{
    size_t read = atomic_load_explicit(&ring->read, memory_order_relaxed);
    if (atomic_load_explicit(&ring->written, memory_order_acquire) == read)
        return NULL;
    return ring->data + read % ring->count * ring->slot;
}

void himc_ring_pop(system_ring *ring)
{
    size_t read = atomic_load_explicit(&ring->read, memory_order_relaxed);
    atomic_store_explicit(&ring->read, read + 1, memory_order_release);
}

long himc_ring_lost(system_ring *ring)
{
    return atomic_exchange_explicit(&ring->lost, 0, memory_order_relaxed);
}
