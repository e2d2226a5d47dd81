/// osc.c: a performance on the network: the network thread, its beginning and end.
///
/// The network thread waits at the sockets for 2 ms at most while there are subscriptions (20 ms
/// otherwise), takes the packets that arrived, and sends the states that the host left in the ring.
/// The host makes no system call to wake it: a strike leaves within 2 ms. All that arrives is paid
/// for from buckets (so much a second, so much at once). When the thread has read its share of
/// packets it rests a millisecond and leaves the others in the socket, where the system drops and
/// counts what does not fit; so a flood costs this thread no more than its share.
#define _POSIX_C_SOURCE 200809L // clocks
#include "osc/osc_state.h"
#include "base/array.h"
#include "system/files.h"
#include "system/thread.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define RECORDS 1024          // chosen: poses of 4 s at 250 Hz
#define LINES_PER_SECOND 50.0 // of answers; chosen: a stranger gets no more than he sends

himc_osc_counts himc_osc_count(const himc_osc *osc)
{
    const osc_counters *c = &osc->counts;
#define COUNTED(ID, field) .field = himc_osc_read(c, COUNT_##ID),
    return (himc_osc_counts){.lost = osc->records.lost + osc->orders.lost + osc->lines.lost,
                             .subscriptions = osc->subscriptions.count,
                             OSC_COUNTERS(COUNTED)};
}

// --- the network thread

static bool allows(himc_osc *osc, const osc_address *to, size_t bytes)
{
    return himc_osc_allows(&osc->subscriptions, to, (double)bytes, 1, himc_osc_now(osc));
}

// false if the host has had its bytes; `paid`: they are paid for already
static bool send_line(himc_osc *osc, const osc_address *to, bool error, const char *text, bool paid)
{
    osc_packets *p = &osc->line;
    himc_osc_encode_begin(p, SMALL_PACKET, false, 0);
    himc_osc_encode_line(p, error, text);
    bool good = p->count && (paid || allows(osc, to, p->size[0]));
    if (good)
        himc_osc_network_send(&osc->network, to, p->data[0], p->size[0]);
    return good;
}

// to its sender, to the user (each line once), and to the subscribers of refusals
static void send_refusal(himc_osc *osc, const osc_address *to, const char *line)
{
    const osc_subscription *one = NULL;
    send_line(osc, to, true, line, false);
    uint32_t hash = 2166136261u; // Fowler, Noll and Vo, FNV-1a
    for (const char *c = line; *c; c++)
        hash = (hash ^ (unsigned char)*c) * 16777619u;
    int known = 0;
    while (known < osc->refusals && osc->refusal[known] != hash)
        known++;
    if (known == osc->refusals && known < OSC_REFUSALS) {
        osc->refusal[osc->refusals++] = hash;
        himc_osc_tell(&osc->lines, "refused: %s%s", line,
                      osc->refusals == OSC_REFUSALS ? " (further ones are counted alone)" : "");
    }
    while ((one = himc_osc_errors_next(&osc->subscriptions, one)))
        if (!himc_osc_address_same(&one->to, to) &&
            himc_osc_afford(&osc->answers, himc_osc_now(osc), 1))
            send_line(osc, &one->to, true, line, false);
}

static void refuse(himc_osc *osc, const osc_address *to, const char *line)
{
    himc_osc_add(&osc->counts, COUNT_REFUSED, 1);
    if (to && himc_osc_afford(&osc->answers, himc_osc_now(osc), 1))
        send_refusal(osc, to, line);
    else if (!to)
        himc_osc_tell(&osc->lines, "%s", line);
}

static void subscribe(himc_osc *osc, const osc_change *change)
{
    himc_error error;
    if (!himc_osc_subscribe(&osc->subscriptions, change, himc_osc_now(osc), &error))
        refuse(osc, change->local ? NULL : &change->from, error.text);
}

static void take_message(void *object, osc_verdict verdict, himc_command *command,
                         const himc_error *error)
{
    const osc_sender *s = object;
    himc_osc *osc = s->osc;
    himc_error why;
    osc_change change = {.from = *s->address};
    if (verdict == OSC_MALFORMED || verdict == OSC_FOREIGN) {
        himc_osc_add(&osc->counts, verdict == OSC_FOREIGN ? COUNT_FOREIGN : COUNT_MALFORMED, 1);
    } else if (verdict == OSC_WRONG) {
        refuse(osc, s->address, error->text);
    } else if (!himc_osc_afford(&osc->points, himc_osc_now(osc), himc_osc_command_cost(command))) {
        himc_osc_add(&osc->counts, COUNT_FREQUENT, 1);
    } else if (himc_osc_change_from(&change, command)) {
        himc_osc_add(&osc->counts, COUNT_COMMANDS, 1);
        subscribe(osc, &change);
    } else if (!himc_osc_command_admit(command, osc->files, &why)) {
        refuse(osc, s->address, why.text);
    } else {
        osc_order *slot = himc_ring_slot(&osc->orders);
        if (slot) {
            slot->from = *s->address;
            himc_command_copy(&slot->command, command);
            himc_ring_push(&osc->orders);
        }
        himc_osc_add(&osc->counts, slot ? COUNT_COMMANDS : COUNT_FREQUENT, 1);
    }
}

// true if the share of packets is used up; the others wait in the sockets
static bool take_packets(himc_osc *osc)
{
    // chosen: so many in one pass, then states are sent again
    for (int i = 0; i < 256; i++) {
        char data[65536]; // the largest packet of UDP (bytes)
        osc_address from;
        if (!himc_osc_afford(&osc->packets, himc_osc_now(osc), 1))
            return true;
        long size = himc_osc_network_receive(&osc->network, &from, data, sizeof data);
        if (size >= 0) {
            himc_osc_decode(data, (size_t)size, take_message,
                            &(osc_sender){.osc = osc, .address = &from});
        } else if (!himc_osc_network_discard(&osc->network)) {
            osc->packets.level += 1; // none was read
            return false;
        }
    }
    return false;
}

// Each line to a stranger is paid for, so that a short command brings no flood to a forged address;
// the first line of an answer pays for the line of a cut in addition.
static void send_answer(himc_osc *osc, const osc_line *line)
{
    char text[HIMC_OSC_LINE];
    const osc_address *to = &line->to;
    bool stranger = !himc_osc_trusted(&osc->subscriptions, to), sent = false;
    if (!line->further) {
        double cost = stranger && !line->error ? 2 : 1;
        bool afforded = himc_osc_afford(&osc->answers, himc_osc_now(osc), cost);
        if (afforded && line->error)
            send_refusal(osc, to, line->text);
        sent = afforded && (line->error || (allows(osc, to, SMALL_PACKET) &&
                                            send_line(osc, to, false, line->text, false)));
        osc->answered = sent;
        osc->cut = !sent;
        return;
    }
    if (osc->cut)
        return;
    sent = !line->error && (!stranger || himc_osc_afford(&osc->answers, himc_osc_now(osc), 1)) &&
           send_line(osc, to, false, line->text, false);
    osc->answered += sent;
    osc->cut = !sent;
    if (sent)
        return;
    snprintf(text, sizeof text, OSC_CUT "expected at most %g lines and 500 kB a second",
             osc->answered, LINES_PER_SECOND);
    send_line(osc, to, true, line->error ? line->text : text, true);
}

bool himc_osc_step(himc_osc *osc)
{
    const osc_record *r;
    himc_osc_counts counts;
    bool flood = take_packets(osc);
    himc_osc_subscribe_found(&osc->subscriptions, himc_osc_now(osc));
    for (int i = 0; i < RECORDS && (r = himc_ring_peek(&osc->records)); i++) {
        switch (r->kind) {
        case RECORD_STATE:
            counts = himc_osc_count(osc);
            himc_osc_deliver(&osc->subscriptions, &r->state, &counts, himc_osc_now(osc));
            break;
        case RECORD_LINE: send_answer(osc, &r->line); break;
        case RECORD_CHANGE: subscribe(osc, &r->change); break;
        }
        himc_ring_pop(&osc->records);
    }
    himc_osc_forget(&osc->subscriptions, himc_osc_now(osc));
    return flood;
}

static void *run(void *object)
{
    himc_osc *osc = object;
    bool flood = false;
    himc_system_give_way();
    while (!atomic_load_explicit(&osc->stop, memory_order_acquire)) {
        // Times are chosen: a strike leaves within 2 ms, also after the share of packets. When idle
        // a packet ends the wait, only a local subscription waits.
        if (flood)
            nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
        else
            himc_osc_network_wait(&osc->network, osc->subscriptions.count > 0 ? 2 : 20);
        flood = himc_osc_step(osc);
    }
    return NULL;
}

// --- beginning and end

himc_osc_config himc_osc_default(void)
{
    return (himc_osc_config){.port = HIMC_OSC_PORT};
}

static double read_clock(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double system_monotonic(void *user)
{
    (void)user;
    return read_clock(CLOCK_MONOTONIC);
}

static double system_wall(void *user)
{
    (void)user;
    return read_clock(CLOCK_REALTIME);
}

static bool prepare(himc_osc *osc, const himc_osc_config *config, himc_error *error)
{
    osc_subscriptions *s = &osc->subscriptions;
    struct stat about;
    double now = himc_osc_now(osc);
    osc->packets = himc_osc_bucket(8000, 8000, now); // chosen: far more than players send
    // points of commands; chosen: 4 targets at 250 Hz; a score of 1000 strokes, sent one by one
    osc->points = himc_osc_bucket(1000, 4000, now);
    osc->answers = himc_osc_bucket(LINES_PER_SECOND, LINES_PER_SECOND, now);
    // the host's time for commands (s); chosen: the sound needs the rest; two heads of 2000 modes
    osc->host.work = himc_osc_bucket(0.1, 0.05, now);
    s->network = &osc->network;
    s->counts = &osc->counts;
    s->lines = &osc->lines;
    // chosen: commands of half a second of 1000 points; the host reads the lines after each block
    if (!himc_ring_init(&osc->records, sizeof(osc_record), RECORDS) ||
        !himc_ring_init(&osc->orders, sizeof(osc_order), 512) ||
        !himc_ring_init(&osc->lines, HIMC_OSC_LINE, 64))
        return himc_error_set(error, "osc: out of memory");
    osc->host.loader = config->loader;
    if (config->files) {
        osc->files = himc_system_real_path(config->files);
        if (!osc->files || stat(config->files, &about) != 0 || !S_ISDIR(about.st_mode))
            return himc_error_set(error, "files: %.200s is no folder", config->files);
    }
    if (!himc_osc_network_open(&osc->network, config->bind, config->port, &osc->counts, error) ||
        !himc_osc_allow(s, config->allow, error))
        return false;
    osc->running = !osc->stepped && himc_system_start_thread(&osc->thread, run, osc);
    return osc->running || osc->stepped || himc_error_set(error, "osc: the system gave no thread");
}

static himc_osc *make(const himc_osc_config *config, const osc_clock *clock, bool stepped,
                      himc_error *error)
{
    himc_osc *osc = himc_new(sizeof *osc, "osc", error);
    if (!osc)
        return NULL;
    osc->network = (osc_network){.socket = {-1, -1, -1}};
    osc->clock = *clock;
    osc->stepped = stepped;
    if (prepare(osc, config, error))
        return osc;
    himc_osc_free(osc);
    return NULL;
}

himc_osc *himc_osc_new(const himc_osc_config *config, himc_error *error)
{
    return make(config, &(osc_clock){system_monotonic, system_wall, NULL}, false, error);
}

himc_osc *himc_osc_new_stepped(const himc_osc_config *config, const osc_clock *clock,
                               himc_error *error)
{
    return make(config, clock, true, error);
}

static void stop_thread(himc_osc *osc)
{
    atomic_store_explicit(&osc->stop, true, memory_order_release);
    if (osc->running)
        pthread_join(osc->thread, NULL);
    osc->running = false;
}

static void put_change(himc_osc *osc, const osc_change *change)
{
    osc_record *r = himc_ring_slot(&osc->records);
    if (!r)
        return;
    r->kind = RECORD_CHANGE;
    r->change = *change;
    himc_ring_push(&osc->records);
}

himc_osc *himc_osc_reopen(himc_osc *old, const himc_osc_config *config, himc_error *error)
{
    if (!old)
        return himc_osc_new(config, error);
    himc_osc *osc = make(config, &old->clock, old->stepped, error);
    if (!osc)
        return NULL;
    stop_thread(old);
    // the subscriptions of the old one, and the changes that still wait in its ring
    const osc_subscription *one = old->subscriptions.subscription;
    for (int i = 0; i < SUBSCRIPTIONS; i++, one++)
        if (one->used)
            put_change(osc, &(osc_change){.stream = one->stream,
                                          .hz = one->hz,
                                          .granted = true,
                                          .from = one->to,
                                          .expires = one->expires});
    const osc_record *r;
    for (; (r = himc_ring_peek(&old->records)); himc_ring_pop(&old->records))
        if (r->kind == RECORD_CHANGE)
            put_change(osc, &r->change);
    osc->host.strikes = old->host.strikes;
    himc_osc_free(old);
    return osc;
}

void himc_osc_free(himc_osc *osc)
{
    if (!osc)
        return;
    stop_thread(osc);
    if (osc->host.loading) // for this
        himc_loader_finish(osc->host.loader);
    himc_osc_subscriptions_free(&osc->subscriptions);
    himc_osc_network_close(&osc->network);
    himc_ring_free(&osc->records);
    himc_ring_free(&osc->orders);
    himc_ring_free(&osc->lines);
    free(osc->files);
    free(osc);
}

int himc_osc_port(const himc_osc *osc)
{
    return osc->network.port;
}
