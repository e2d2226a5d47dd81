/// watch.c: the real-time contract from outside: a library to be preloaded, that stands in front of
/// all that may wait. Between watch_span_begin and watch_span_end, in that thread, each call of the
/// allocator, a lock, a file, a socket, printf or sleep is counted; the first callers are named
/// when the process ends. [himc~] and [membrane~] call the two around their DSP routines if they
/// are there (drum-link.h), test_contract.c around each function that is marked HIMC_RT.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#define CALLERS 8

void watch_span_begin(void);
void watch_span_end(void);
long watch_calls(void);
long watch_spans(void);

static _Thread_local volatile int depth;
static atomic_long calls, spans;
static struct caller {
    const char *name;
    void *from;
} caller[CALLERS];

void watch_span_begin(void)
{
    depth++;
    atomic_fetch_add(&spans, 1);
}

void watch_span_end(void)
{
    depth--;
}

/// Calls that were seen so far.
long watch_calls(void)
{
    return atomic_load(&calls);
}

/// Spans that were watched so far.
long watch_spans(void)
{
    return atomic_load(&spans);
}

static void seen(const char *name, void *from)
{
    if (depth == 0)
        return;
    long n = atomic_fetch_add(&calls, 1);
    if (n < CALLERS)
        caller[n] = (struct caller){name, from};
}

#define SEEN(name) seen(name, __builtin_return_address(0))

static void report(void) __attribute__((destructor));
static void report(void)
{
    long n = atomic_load(&calls);
    depth = 0;
    if (atomic_load(&spans) == 0)
        return;
    fprintf(stderr, "watch: %ld calls in %ld spans\n", n, atomic_load(&spans));
    for (int i = 0; i < CALLERS && i < n; i++) {
        Dl_info info = {0};
        dladdr(caller[i].from, &info);
        fprintf(stderr, "watch: %s from %s+0x%lx %s\n", caller[i].name,
                info.dli_fname ? info.dli_fname : "?",
                (unsigned long)((char *)caller[i].from - (char *)info.dli_fbase),
                info.dli_sname ? info.dli_sname : "");
    }
}

// the allocator: libc's own names, as dlsym allocates itself
void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *old, size_t size);
void *__libc_memalign(size_t alignment, size_t size);
void __libc_free(void *old);

void *malloc(size_t size)
{
    SEEN("malloc");
    return __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    SEEN("calloc");
    return __libc_calloc(count, size);
}

void *realloc(void *old, size_t size)
{
    SEEN("realloc");
    return __libc_realloc(old, size);
}

void *aligned_alloc(size_t alignment, size_t size)
{
    SEEN("aligned_alloc");
    return __libc_memalign(alignment, size);
}

int posix_memalign(void **out, size_t alignment, size_t size)
{
    SEEN("posix_memalign");
    *out = __libc_memalign(alignment, size);
    return *out ? 0 : 12;
}

void free(void *old)
{
    if (old)
        SEEN("free");
    __libc_free(old);
}

// the rest: the next library's function of that name
#define NEXT(type, name, parameters, arguments)        \
    type name parameters                               \
    {                                                  \
        static type(*next) parameters;                 \
        SEEN(#name);                                   \
        if (!next)                                     \
            *(void **)&next = dlsym(RTLD_NEXT, #name); \
        return next arguments;                         \
    }

NEXT(int, pthread_mutex_lock, (pthread_mutex_t * m), (m))
NEXT(int, pthread_cond_wait, (pthread_cond_t * c, pthread_mutex_t *m), (c, m))
NEXT(int, pthread_cond_signal, (pthread_cond_t * c), (c))
NEXT(int, pthread_cond_broadcast, (pthread_cond_t * c), (c))
NEXT(int, pthread_rwlock_rdlock, (pthread_rwlock_t * l), (l))
NEXT(int, pthread_rwlock_wrlock, (pthread_rwlock_t * l), (l))
NEXT(int, pthread_join, (pthread_t t, void **result), (t, result))
NEXT(int, pthread_create,
     (pthread_t * t, const pthread_attr_t *a, void *(*run)(void *), void *argument),
     (t, a, run, argument))
NEXT(FILE *, fopen, (const char *path, const char *mode), (path, mode))
NEXT(int, fclose, (FILE * f), (f))
NEXT(size_t, fread, (void *out, size_t size, size_t n, FILE *f), (out, size, n, f))
NEXT(size_t, fwrite, (const void *in, size_t size, size_t n, FILE *f), (in, size, n, f))
NEXT(int, fputs, (const char *s, FILE *f), (s, f))
NEXT(int, puts, (const char *s), (s))
NEXT(int, close, (int file), (file))
NEXT(ssize_t, read, (int file, void *out, size_t n), (file, out, n))
NEXT(ssize_t, write, (int file, const void *in, size_t n), (file, in, n))
NEXT(ssize_t, send, (int file, const void *in, size_t n, int flags), (file, in, n, flags))
NEXT(ssize_t, sendto,
     (int file, const void *in, size_t n, int flags, const struct sockaddr *to, socklen_t length),
     (file, in, n, flags, to, length))
NEXT(ssize_t, sendmsg, (int file, const struct msghdr *message, int flags), (file, message, flags))
NEXT(ssize_t, recvfrom,
     (int file, void *out, size_t n, int flags, struct sockaddr *from, socklen_t *length),
     (file, out, n, flags, from, length))
NEXT(int, nanosleep, (const struct timespec *t, struct timespec *rest), (t, rest))
NEXT(int, clock_nanosleep,
     (clockid_t c, int flags, const struct timespec *t, struct timespec *rest), (c, flags, t, rest))
NEXT(int, usleep, (useconds_t t), (t))
NEXT(void *, mmap, (void *at, size_t n, int protection, int flags, int file, off_t offset),
     (at, n, protection, flags, file, offset))
NEXT(int, munmap, (void *at, size_t n), (at, n))
NEXT(int, brk, (void *at), (at))
NEXT(int, vsnprintf, (char *out, size_t n, const char *format, va_list args),
     (out, n, format, args))
NEXT(int, vfprintf, (FILE * f, const char *format, va_list args), (f, format, args))

int snprintf(char *out, size_t n, const char *format, ...)
{
    va_list args;
    SEEN("snprintf");
    va_start(args, format);
    int length = vsnprintf(out, n, format, args);
    va_end(args);
    return length;
}

int fprintf(FILE *f, const char *format, ...)
{
    va_list args;
    SEEN("fprintf");
    va_start(args, format);
    int length = vfprintf(f, format, args);
    va_end(args);
    return length;
}

int printf(const char *format, ...)
{
    va_list args;
    SEEN("printf");
    va_start(args, format);
    int length = vfprintf(stdout, format, args);
    va_end(args);
    return length;
}

int open(const char *path, int flags, ...);
int open(const char *path, int flags, ...)
{
    static int (*next)(const char *, int, ...);
    va_list args;
    SEEN("open");
    va_start(args, flags);
    int mode = va_arg(args, int);
    va_end(args);
    if (!next)
        *(void **)&next = dlsym(RTLD_NEXT, "open");
    return next(path, flags, mode);
}
