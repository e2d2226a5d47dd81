/// osc.c: the thread that talks to the network, so that nobody else has to.
///
/// It waits at the sockets for 2 ms at most while there are subscribers (20 ms otherwise), takes
/// what came in, and sends what the host has left in its ring. The host makes no system call to
/// wake it: a strike leaves within 2 ms. Everything taken from outside is paid for from buckets
/// (so much a second, so much at once); who is beyond that is counted before being read, and the
/// thread then rests a millisecond, so that a flood costs the machine little.
#define _GNU_SOURCE // setpriority of one thread is Linux's own
#include "osc/osc_state.h"

#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define RECORDS 1024
#define ORDERS 512
#define LINES 64
#define NICE 5 // sound goes first

himc_osc_config himc_osc_default(void)
{
    return (himc_osc_config){.port = HIMC_OSC_PORT};
}

double himc_osc_clock(int clock)
{
    struct timespec t;
    clock_gettime((clockid_t)clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void himc_osc_tell(himc_osc *osc, const char *format, ...)
{
    char *line = himc_osc_ring_slot(&osc->lines);
    if (!line)
        return;
    va_list args;
    va_start(args, format);
    vsnprintf(line, HIMC_OSC_LINE, format, args);
    va_end(args);
    himc_osc_ring_push(&osc->lines);
}

bool himc_osc_afford(osc_bucket *b, double cost)
{
    double now = himc_osc_clock(CLOCK_MONOTONIC);
    b->level += b->rate * (now - b->last);
    b->level = b->level > b->size ? b->size : b->level;
    b->last = now;
    if (b->level < cost)
        return false;
    b->level -= cost;
    return true;
}

void himc_osc_answer(himc_osc *osc, const osc_address *to, bool error, const char *text)
{
    if (!himc_osc_afford(&osc->answers, 1))
        return;
    osc_packets *p = &osc->packet[0][0];
    osc->packed[0][0] = false;
    himc_osc_pack_begin(p, SMALL_PACKET, false, 0);
    himc_osc_pack(p, error ? "/himc/error" : "/himc/info", "s", text);
    if (p->count)
        himc_osc_send_to(osc, to, p->data[0], p->size[0]);
}

static void wait_for_packets(himc_osc *osc, bool resting)
{
    struct pollfd at[] = {{osc->in, POLLIN, 0}, {osc->out[0], POLLIN, 0}, {osc->out[1], POLLIN, 0}};
    bool busy = atomic_load_explicit(&osc->count[COUNT_SUBSCRIPTIONS], memory_order_relaxed) > 0;
    if (resting)
        nanosleep(&(struct timespec){0, 1000000}, NULL);
    else
        poll(at, 3, busy ? 2 : 20);
}

static void *run(void *object)
{
    himc_osc *osc = object;
    bool resting = false;
    setpriority(PRIO_PROCESS, 0, NICE);
    while (!atomic_load_explicit(&osc->stop, memory_order_acquire)) {
        const osc_record *record;
        wait_for_packets(osc, resting);
        resting = himc_osc_take_packets(osc);
        himc_osc_resolved(osc);
        for (int i = 0; i < RECORDS && (record = himc_osc_ring_peek(&osc->records)); i++) {
            himc_osc_send_record(osc, record);
            himc_osc_ring_pop(&osc->records);
        }
        himc_osc_read_errors(osc, himc_osc_refused);
        himc_osc_forget_gone(osc, himc_osc_clock(CLOCK_MONOTONIC));
    }
    return NULL;
}

static bool set_files(himc_osc *osc, const char *folder, himc_error *error)
{
    struct stat about;
    if (!folder)
        return true;
    osc->files = realpath(folder, NULL);
    if (!osc->files || stat(osc->files, &about) != 0 || !S_ISDIR(about.st_mode))
        return himc_error_set(error, "files: %.200s is no folder", folder);
    return true;
}

static bool prepare(himc_osc *osc, const himc_osc_config *config, himc_error *error)
{
    double now = himc_osc_clock(CLOCK_MONOTONIC);
    osc->packets = (osc_bucket){8000, 8000, 8000, now};
    osc->commands = (osc_bucket){4000, 1000, 4000, now};
    osc->answers = (osc_bucket){50, 50, 50, now};
    osc->work = (osc_bucket){0.05, 0.1, 0.05, now};
    if (!himc_osc_ring_init(&osc->records, sizeof(osc_record), RECORDS) ||
        !himc_osc_ring_init(&osc->orders, sizeof(osc_order), ORDERS) ||
        !himc_osc_ring_init(&osc->lines, HIMC_OSC_LINE, LINES))
        return himc_error_set(error, "osc: out of memory");
    if (!set_files(osc, config->files, error) || !himc_osc_listen(osc, config, error))
        return false;
    osc->allowed_count = himc_osc_allowed_hosts(osc, config->allow, error);
    if (osc->allowed_count < 0)
        return false;
    osc->running = pthread_create(&osc->thread, NULL, run, osc) == 0;
    return osc->running || himc_error_set(error, "osc: no thread to be had");
}

himc_osc *himc_osc_new(const himc_osc_config *config, himc_error *error)
{
    himc_osc *osc = calloc(1, sizeof *osc);
    if (!osc) {
        himc_error_set(error, "osc: out of memory");
        return NULL;
    }
    osc->in = osc->out[0] = osc->out[1] = -1;
    if (prepare(osc, config, error))
        return osc;
    himc_osc_free(osc);
    return NULL;
}

static void stop_thread(himc_osc *osc)
{
    atomic_store_explicit(&osc->stop, true, memory_order_release);
    if (osc->running)
        pthread_join(osc->thread, NULL);
    osc->running = false;
}

static void put_wish(himc_osc *osc, const osc_wish *wish)
{
    osc_record *r = himc_osc_ring_slot(&osc->records);
    if (!r)
        return;
    r->kind = RECORD_WISH;
    r->wish = *wish;
    himc_osc_ring_push(&osc->records);
}

// what the old one has granted, and what it was still asked for; its thread stands still
static void hand_over(himc_osc *old, himc_osc *osc)
{
    const osc_record *r;
    for (const osc_subscriber *s = old->subscriber; s < old->subscriber + SUBSCRIBERS; s++)
        if (s->used)
            put_wish(osc,
                     &(osc_wish){.what = s->what, .hz = s->hz, .granted = true, .from = s->to});
    for (; (r = himc_osc_ring_peek(&old->records)); himc_osc_ring_pop(&old->records))
        if (r->kind == RECORD_WISH)
            put_wish(osc, &r->wish);
    osc->strikes = old->strikes;
}

himc_osc *himc_osc_reopen(himc_osc *old, const himc_osc_config *config, himc_error *error)
{
    himc_osc *osc = himc_osc_new(config, error);
    if (!osc || !old)
        return osc;
    stop_thread(old);
    hand_over(old, osc);
    himc_osc_free(old);
    return osc;
}

void himc_osc_free(himc_osc *osc)
{
    if (!osc)
        return;
    stop_thread(osc);
    himc_osc_resolve_drop(osc);
    int fd[] = {osc->in, osc->out[0], osc->out[1]};
    for (int i = 0; i < 3; i++)
        if (fd[i] >= 0)
            close(fd[i]);
    free(osc->records.data);
    free(osc->orders.data);
    free(osc->lines.data);
    free(osc->files);
    free(osc);
}

int himc_osc_port(const himc_osc *osc)
{
    return osc->port;
}
