/// pool.c: workers are forks of this process. The number of the next item is a counter in shared
/// memory. Results go to the parent through one pipe; each is a single write of at most PIPE_BUF
/// bytes, which POSIX does not interleave with others. A worker that dies leaves an item without an
/// answer, and that is an error. A worker that fails stops the others after their present items.
#define _GNU_SOURCE // MAP_ANONYMOUS
#include "pool.h"

#include <errno.h>
#include <stdatomic.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#define JOBS_MAX 256    // the range of --jobs
#define ANSWER_MAX 4096 // PIPE_BUF of Linux (bytes)

typedef struct answer {
    int item;
    bool good;
    char text[512];
    _Alignas(16) unsigned char result[POOL_RESULT];
} answer;

_Static_assert(sizeof(answer) <= ANSWER_MAX, "an answer must be one atomic write");

static bool read_whole(int from, answer *a)
{
    char *into = (char *)a;
    for (size_t got = 0; got < sizeof *a;) {
        ssize_t n = read(from, into + got, sizeof *a - got);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return false;
        got += (size_t)n;
    }
    return true;
}

static void answer_items(const pool *p, atomic_int *next, int to)
{
    for (int item; (item = atomic_fetch_add(next, 1)) < p->items;) {
        answer a = {.item = item};
        himc_error error = {{0}};
        a.good = p->work(p->user, item, a.result, &error);
        if (!a.good)
            memcpy(a.text, error.text, sizeof a.text - 1);
        if (write(to, &a, sizeof a) != (ssize_t)sizeof a)
            return;
    }
}

static int start_workers(const pool *p, atomic_int *next, const int ends[2], pid_t *worker)
{
    int count = 0, jobs = p->jobs < p->items ? p->jobs : p->items;
    for (; count < jobs && count < JOBS_MAX; count++) {
        worker[count] = fork();
        if (worker[count] < 0)
            break;
        if (worker[count] == 0) {
            close(ends[0]);
            answer_items(p, next, ends[1]);
            _exit(0);
        }
    }
    return count;
}

// receives answers until all workers have closed the pipe; the number of items done, -1 on failure
static int collect(const pool *p, atomic_int *next, int from, himc_error *error)
{
    int done = 0;
    bool good = true;
    answer a;
    while (read_whole(from, &a)) {
        if (!good)
            continue;
        good = a.good ? p->done(p->user, a.item, a.result, error)
                      : himc_error_set(error, "%s", a.text);
        if (good)
            done++;
        else
            atomic_store(next, p->items);
    }
    return good ? done : -1;
}

bool pool_run(const pool *p, himc_error *error)
{
    int ends[2];
    pid_t worker[JOBS_MAX];
    if (p->items == 0)
        return true;
    atomic_int *next =
        mmap(NULL, sizeof *next, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (next == MAP_FAILED || pipe(ends))
        return himc_error_set(error, "cannot start workers: %s", strerror(errno));
    atomic_init(next, 0);
    int workers = start_workers(p, next, ends, worker);
    close(ends[1]);
    int fork_error = errno, done = workers ? collect(p, next, ends[0], error) : 0;
    close(ends[0]);
    for (int i = 0; i < workers; i++)
        waitpid(worker[i], NULL, 0);
    munmap(next, sizeof *next);
    if (workers == 0)
        return himc_error_set(error, "cannot start workers: %s", strerror(fork_error));
    if (done >= 0 && done < p->items)
        return himc_error_set(error, "a worker process died: %d of %d items done", done, p->items);
    return done == p->items;
}

int pool_cores(void)
{
    long cores = sysconf(_SC_NPROCESSORS_ONLN);
    return cores < 1 ? 1 : cores > JOBS_MAX ? JOBS_MAX : (int)cores;
}
