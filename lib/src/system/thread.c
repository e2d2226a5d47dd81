/// thread.c: threads of the library; the priority of a thread: on Linux its own nice value, on
/// macOS its quality of service, on Windows its priority.
#define _GNU_SOURCE // SCHED_RESET_ON_FORK
#include "system/thread.h"

#ifdef _WIN32
#include <windows.h>

void himc_system_give_way(void)
{
    SetThreadPriority(GetCurrentThread(), THREAD_PRIORITY_BELOW_NORMAL);
}

void himc_system_go_first(void)
{
    SetThreadPriority(GetCurrentThread(), THREAD_PRIORITY_TIME_CRITICAL);
}

#elif defined __APPLE__

void himc_system_give_way(void)
{
    pthread_set_qos_class_self_np(QOS_CLASS_UTILITY, 0);
}

void himc_system_go_first(void)
{
    pthread_set_qos_class_self_np(QOS_CLASS_USER_INTERACTIVE, 0);
}

#else
#include <sched.h>
#include <sys/resource.h>

#ifndef SCHED_RESET_ON_FORK // Linux's own
#define SCHED_RESET_ON_FORK 0
#endif
#define NICE 5      // chosen: sound goes first
#define REALTIME 10 // chosen: below what a sound server takes

void himc_system_give_way(void)
{
    // a host's real-time priority is inherited, and makes nice meaningless
    sched_setscheduler(0, SCHED_OTHER, &(struct sched_param){.sched_priority = 0});
    setpriority(PRIO_PROCESS, 0, NICE);
}

void himc_system_go_first(void)
{
    sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &(struct sched_param){REALTIME});
}
#endif

// (bytes) asked for, as musl gives 128 kB. Chosen: a packet of UDP takes 64 kB of it, and all that
// the tests load is read in as much
#define STACK (1 << 20)

bool himc_system_start_thread(pthread_t *thread, void *(*run)(void *), void *object)
{
    pthread_attr_t attributes;
    pthread_attr_init(&attributes);
    pthread_attr_setstacksize(&attributes, STACK);
    pthread_attr_setinheritsched(&attributes, PTHREAD_EXPLICIT_SCHED);
    pthread_attr_setschedpolicy(&attributes, SCHED_OTHER);
    // without it the host's own, which is not allowed for this policy
    pthread_attr_setschedparam(&attributes, &(struct sched_param){.sched_priority = 0});
    bool started = pthread_create(thread, &attributes, run, object) == 0;
    pthread_attr_destroy(&attributes);
    return started;
}
