/// thread.h: threads of the library, and the priority of the calling thread.
#ifndef HIMC_SYSTEM_THREAD_H
#define HIMC_SYSTEM_THREAD_H

#include <pthread.h>
#include <stdbool.h>

/// Gives way to threads that compute sound. Useful, not required: no answer.
void himc_system_give_way(void);
/// Goes ahead of programs without a deadline, if the system allows it.
void himc_system_go_first(void);

/// Starts a thread that has no deadline, whatever the caller's priority is, with a stack of 1 MB.
bool himc_system_start_thread(pthread_t *thread, void *(*run)(void *), void *object);

#endif
