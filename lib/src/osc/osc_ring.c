/// osc_ring.c: a ring between two threads that never wait for each other.
///
/// One writes, one reads; each moves its own index and only looks at the other's. The release of
/// `written` makes a slot's contents visible to whoever acquires it, and the same with `read` for
/// its reuse. A full ring refuses and counts: what is late is worth less than what comes next.
#include "osc/osc_state.h"

#include <stdlib.h>

bool himc_osc_ring_init(osc_ring *ring, size_t slot, size_t count)
{
    ring->slot = (slot + 63) / 64 * 64;
    ring->count = count;
    ring->data = calloc(count, ring->slot);
    return ring->data != NULL;
}

void *himc_osc_ring_slot(osc_ring *ring)
{
    size_t written = atomic_load_explicit(&ring->written, memory_order_relaxed);
    if (written - atomic_load_explicit(&ring->read, memory_order_acquire) == ring->count) {
        atomic_fetch_add_explicit(&ring->lost, 1, memory_order_relaxed);
        return NULL;
    }
    return ring->data + written % ring->count * ring->slot;
}

void himc_osc_ring_push(osc_ring *ring)
{
    size_t written = atomic_load_explicit(&ring->written, memory_order_relaxed);
    atomic_store_explicit(&ring->written, written + 1, memory_order_release);
}

const void *himc_osc_ring_peek(osc_ring *ring)
{
    size_t read = atomic_load_explicit(&ring->read, memory_order_relaxed);
    if (atomic_load_explicit(&ring->written, memory_order_acquire) == read)
        return NULL;
    return ring->data + read % ring->count * ring->slot;
}

void himc_osc_ring_pop(osc_ring *ring)
{
    size_t read = atomic_load_explicit(&ring->read, memory_order_relaxed);
    atomic_store_explicit(&ring->read, read + 1, memory_order_release);
}
