/// allocations.h: how often this thread called the allocator between two points, for the tests of
/// what runs in the audio callback; and allocations that fail. It stands in front of libc's own, so
/// it sees the libraries' allocations too; a sanitizer brings another, under which nothing is
/// counted and nothing fails.
#ifndef HIMC_TESTS_ALLOCATIONS_H
#define HIMC_TESTS_ALLOCATIONS_H

#include "unity.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>

// volatile: a compiler knows malloc and thinks it touches neither
static _Thread_local volatile bool watching;
static _Thread_local volatile int allocations;
static _Thread_local volatile size_t bytes_asked; // while watching; never given back
static _Thread_local volatile int until_failure;  // allocations up to the one that fails; 0: none
static _Thread_local volatile long held;          // blocks that this thread has made and not freed

// allocations that never fail here: of code from one address to below another, of that size or more
static struct spared_allocations {
    uintptr_t from, to;
    size_t size;
} spared[8] __attribute__((unused)); // by a test that spares none, or under a sanitizer
static int spared_count __attribute__((unused));

/// The `n`-th allocation from now on fails; 0: none.
static inline void fail_allocation(int n)
{
    until_failure = n;
}

/// Whether that allocation has come.
static inline bool has_failed(void)
{
    return until_failure == 0;
}

/// Blocks this thread has allocated and not freed, to compare two moments.
static inline long blocks_held(void)
{
    return held;
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define CAN_FAIL_ALLOCATIONS 1
// without this the libraries would not find these functions but libc's
#pragma GCC visibility push(default)
void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *old, size_t size);
void *__libc_memalign(size_t alignment, size_t size);
void __libc_free(void *old);

static inline bool fails(const void *caller, size_t size)
{
    const struct spared_allocations *s = spared;
    for (int i = 0; i < spared_count && until_failure > 0; i++, s++)
        if ((uintptr_t)caller >= s->from && (uintptr_t)caller < s->to && size >= s->size)
            return false;
    return until_failure > 0 && --until_failure == 0;
}

static inline void *allocated(void *block, size_t size)
{
    allocations += watching;
    bytes_asked += watching ? size : 0;
    held += block != NULL;
    return block;
}

void *malloc(size_t size)
{
    bool fail = fails(__builtin_return_address(0), size);
    return allocated(fail ? NULL : __libc_malloc(size), size);
}

void *calloc(size_t count, size_t size)
{
    bool fail = fails(__builtin_return_address(0), count * size);
    return allocated(fail ? NULL : __libc_calloc(count, size), count * size);
}

void *realloc(void *old, size_t size)
{
    bool fail = fails(__builtin_return_address(0), size);
    void *block = allocated(fail ? NULL : __libc_realloc(old, size), size);
    held -= block && old;
    return block;
}

void *aligned_alloc(size_t alignment, size_t size)
{
    bool fail = fails(__builtin_return_address(0), size);
    return allocated(fail ? NULL : __libc_memalign(alignment, size), size);
}

void free(void *old)
{
    allocations += watching && old;
    held -= old != NULL;
    __libc_free(old);
}
#pragma GCC visibility pop
#else
#define CAN_FAIL_ALLOCATIONS 0
#endif

static inline void watch_allocations(void)
{
    allocations = 0;
    bytes_asked = 0;
    watching = true;
}

/// Since the watch began, which ends here; fails if the watch was asleep.
static inline int allocations_seen(void)
{
    int count = allocations;
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    void *volatile block = malloc(8);
    free(block);
    TEST_ASSERT_EQUAL_INT_MESSAGE(count + 2, allocations, "the allocator is not watched");
#endif
    watching = false;
    return count;
}

#endif
