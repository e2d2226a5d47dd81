/// allocations.h: how often this thread called the allocator between two points, for the tests of
/// what runs in the audio callback; and allocations that fail. It stands in front of libc's own; a
/// sanitizer brings another, under which nothing is counted and nothing fails.
#ifndef HIMC_TESTS_ALLOCATIONS_H
#define HIMC_TESTS_ALLOCATIONS_H

#include "unity.h"

#include <stdbool.h>
#include <stdlib.h>

// volatile: a compiler knows malloc and thinks it touches neither
static _Thread_local volatile bool watching;
static _Thread_local volatile int allocations;
static _Thread_local volatile int until_failure; // allocations up to the one that fails; 0: none

static inline bool fails(void)
{
    return until_failure > 0 && --until_failure == 0;
}

/// The `n`-th allocation from now on fails; 0: none.
static inline void fail_allocation(int n)
{
    until_failure = n;
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define CAN_FAIL_ALLOCATIONS 1
void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *old, size_t size);
void *__libc_memalign(size_t alignment, size_t size);
void __libc_free(void *old);

void *malloc(size_t size)
{
    allocations += watching;
    return fails() ? NULL : __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    allocations += watching;
    return fails() ? NULL : __libc_calloc(count, size);
}

void *realloc(void *old, size_t size)
{
    allocations += watching;
    return fails() ? NULL : __libc_realloc(old, size);
}

void *aligned_alloc(size_t alignment, size_t size)
{
    allocations += watching;
    return fails() ? NULL : __libc_memalign(alignment, size);
}

void free(void *old)
{
    allocations += watching && old;
    __libc_free(old);
}
#else
#define CAN_FAIL_ALLOCATIONS 0
#endif

static inline void watch_allocations(void)
{
    allocations = 0;
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
