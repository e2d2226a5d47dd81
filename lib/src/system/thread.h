/// thread.h: the priority of the calling thread.
#ifndef HIMC_SYSTEM_THREAD_H
#define HIMC_SYSTEM_THREAD_H

/// Gives way to threads that compute sound. Useful, not required: no answer.
void himc_system_give_way(void);
/// Goes ahead of programs without a deadline, if the system allows it.
void himc_system_go_first(void);

#endif
