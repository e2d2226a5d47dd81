/// osc.c: a performance on the network: the host's side, the network thread, and the rings between.
///
/// The host's side (an audio callback, Pd's scheduler) only copies into rings or out of them. The
/// time t of the samples and the wall clock W are joined by an offset W - t. It is followed slowly
/// (a second or so), because a host computes blocks in bursts and the sound is steady; it jumps
/// when the two are 0.1 s apart (the sound was off).
///
/// The network thread waits at the sockets for 2 ms at most while there are subscriptions (20 ms
/// otherwise), takes the packets that arrived, and sends the states that the host left in the ring.
/// The host makes no system call to wake it: a strike leaves within 2 ms. All that arrives is paid
/// for from buckets (so much a second, so much at once). When the thread has read its share of
/// packets it rests a millisecond and leaves the others in the socket, where the system drops and
/// counts what does not fit; so a flood costs this thread no more than its share.
#define _POSIX_C_SOURCE 200809L // clocks
#include "drum/drum_performer.h"
#include "drum/membrane_probe.h"
#include "head/modes.h"
#include "himc/osc.h"
#include "himc/body.h"
#include "himc/membrane.h"
#include "osc/decode.h"
#include "osc/stepped.h"
#include "osc/subscribe.h"
#include "performance/describe.h"
#include "system/files.h"
#include "system/thread.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define RECORDS 1024         // chosen: poses of 4 s at 250 Hz
#define RECORDS_OF_STATES 64 // that no answer takes; chosen: poses of 0.25 s
#define COMMANDS_WAITING 512 // chosen: half a second of 1000 points
#define LINES 64             // chosen: the host reads them after each block
#define PACKETS_AT_ONCE 256  // read in one pass; chosen: then states are sent again
#define PACKET_SIZE 65536    // largest of UDP (bytes)
#define WAIT_SUBSCRIBED 2    // (ms) chosen: a strike leaves within it
#define WAIT_IDLE 20         // (ms) chosen: a packet ends the wait, only a local subscription waits
#define REST 1000000         // after the share of packets (ns) chosen: a strike leaves within 2 ms

#define PACKETS_PER_SECOND 8000.0 // chosen: far more than players send
#define POINTS_PER_SECOND 1000.0  // of commands; chosen: 4 targets at 250 Hz
#define POINTS_AT_ONCE 4000.0     // chosen: a score of 1000 strokes, sent one by one
#define LINES_PER_SECOND 50.0     // of answers; chosen: a stranger gets no more than he sends
#define CUT "the answer is cut after %d lines: "
#define WORK_SHARE 0.1    // of the host's time, for commands; chosen: the sound needs the rest
#define WORK_AT_ONCE 0.05 // (s) chosen: two heads of 2000 modes

#define OFFSET_TIME 1.0   // (s) time constant; chosen: longer than the bursts of a host
#define OFFSET_JUMP 0.1   // (s) chosen: sound was off, not late
#define BLOCK_WORK 2e-4   // no further command in a block once they took so long (s); chosen
#define STATUS_PERIOD 1.0 // (s) chosen: as often as a user reads it

typedef struct osc_bucket {
    double level, rate, size, last;
} osc_bucket;

typedef struct osc_line {
    osc_address to;
    bool error;   // else an information
    bool further; // than the first line of its answer; an error: the answer ends here, cut
    char text[HIMC_OSC_LINE];
} osc_line;

// from host to network
typedef struct osc_record {
    enum { RECORD_STATE, RECORD_LINE, RECORD_CHANGE } kind;
    union {
        osc_state state;
        osc_line line;
        osc_change change;
    };
} osc_record;

// from network to host
typedef struct osc_order {
    osc_address from;
    osc_request request;
} osc_order;

// the sender of a command, for the lines of an answer
typedef struct sender {
    himc_osc *osc;
    const osc_address *address;
    bool error;
    int lines; // of this answer, so far
    bool cut;  // takes no further lines
} sender;

// an answer to `dump`, which is told in parts: all of it may take 10 ms
typedef struct osc_dump {
    bool tells;
    himc_describe_place place;
    osc_address to;
    sender from;
} osc_dump;

// owned by the host's thread
typedef struct osc_host {
    double time;                 // t, of the last block (s)
    double offset;               // W - t (s)
    double next_pose, next_head; // (s, of the performance)
    double next_status;          // (s, wall clock)
    double published;            // wall clock of the last block (s)
    double busy;                 // computing since the last status (s)
    bool status_sent;
    uint64_t heard;                    // samples whose sound has been taken
    long strikes;                      // so far
    osc_bucket work;                   // time of commands (s)
    himc_loader *loader;               // borrowed, or NULL
    bool loading;                      // a command waits in the loader ...
    osc_address loading_for;           // ... for this sender
    char loading_drum[HIMC_NAME_SIZE]; // and this drum, or ""
    osc_dump dump;
    unsigned revision[HIMC_DRUMS]; // of the drums, as last sent
} osc_host;

#define REFUSALS 64 // kinds of refusals that the user is told; chosen: a page of a terminal

struct himc_osc {
    osc_clock clock;
    osc_ring records, orders, lines;
    osc_counters counts;
    osc_host host;

    // owned by the network thread
    pthread_t thread;
    bool stepped, running;
    _Atomic bool stop;
    osc_network network;
    osc_subscriptions subscriptions;
    osc_bucket packets, points, answers;
    osc_packets line;           // the answer being sent ...
    int answered;               // ... its lines that were sent ...
    bool cut;                   // ... and no further line is sent
    uint32_t refusal[REFUSALS]; // of lines that the user has been told
    int refusals;
    char *files; // real path, or NULL
};

static double monotonic(const himc_osc *osc)
{
    return osc->clock.monotonic(osc->clock.user);
}

static bool afford(osc_bucket *b, double now, double cost)
{
    b->level += b->rate * (now - b->last);
    b->level = b->level > b->size ? b->size : b->level;
    b->last = now;
    if (b->level < cost)
        return false;
    b->level -= cost;
    return true;
}

// --- the host's side: states out

static osc_state *begin(himc_osc *osc, int kind, double time)
{
    osc_record *r = himc_osc_ring_slot(&osc->records);
    if (!r)
        return NULL;
    r->kind = RECORD_STATE;
    r->state.kind = kind;
    r->state.time = time;
    r->state.wall = time + osc->host.offset;
    return &r->state;
}

static void end(himc_osc *osc)
{
    himc_osc_ring_push(&osc->records);
}

static void put(float out[3], himc_vec3 v)
{
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

static void put_name(char out[HIMC_NAME_SIZE], himc_drum *drum)
{
    const char *name = himc_drum_name(drum);
    memcpy(out, name, strnlen(name, HIMC_NAME_SIZE - 1) + 1);
}

// true if one of `hz` a second is due; then sets the time of the next. More than two periods ahead
// means that time has begun again, with `reset`
static bool due(double *next, int hz, double t)
{
    if (hz <= 0 || (t < *next && *next - t < 2.0 / hz))
        return false;
    *next = fmax(*next + 1.0 / hz, t + 0.5 / hz);
    return true;
}

// with `reset` the time of the samples begins again, and the wall clock goes on
static void begin_again(osc_host *h)
{
    h->offset += h->time;
    h->time = 0;
}

static void put_pose(osc_pose *pose, const himc_tick *tick)
{
    for (int i = 0; i < HIMC_SEGMENTS; i++) {
        himc_quat q = tick->body->orientation[i];
        put(pose->origin[i], tick->body->origin[i]);
        put(pose->orientation[i], himc_quat_vector(q));
        pose->orientation[i][3] = (float)q.w;
    }
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        put(pose->target[hand], tick->target[hand]);
        put(pose->tip[hand], tick->body->tip[hand]);
    }
}

void himc_osc_tick(void *object, const himc_tick *tick)
{
    himc_osc *osc = object;
    int hz = atomic_load_explicit(&osc->subscriptions.pose_hz, memory_order_relaxed);
    if (tick->time == 0)
        begin_again(&osc->host);
    if (!due(&osc->host.next_pose, hz, tick->time))
        return;
    osc_state *state = begin(osc, STATE_POSE, tick->time);
    if (!state)
        return;
    put_pose(&state->pose, tick);
    end(osc);
}

void himc_osc_event(himc_osc *osc, const himc_event *event)
{
    osc_host *h = &osc->host;
    bool strike = event->kind == HIMC_EVENT_STRIKE, missed = event->kind == HIMC_EVENT_MISSED;
    if (!strike && !missed && event->kind != HIMC_EVENT_BEAT)
        return;
    h->strikes += strike; // also one that finds the ring full
    double time = strike ? event->strike.time : h->published - h->offset;
    osc_state *state = begin(osc, strike ? STATE_STRIKE : missed ? STATE_MISSED : STATE_BEAT, time);
    if (!state)
        return;
    if (strike)
        state->strike = (osc_strike){event->strike, h->strikes};
    else if (missed)
        state->missed = event->strike;
    else
        state->beat = event->beat;
    end(osc);
}

static void put_head(himc_osc *osc, himc_drum *drum, double time)
{
    himc_membrane *membrane = himc_drum_membrane(drum);
    int modes = himc_membrane_audible(membrane); // the first of them are exact
    osc_state *state = begin(osc, STATE_HEAD, time);
    if (!state)
        return;
    put_name(state->head.name, drum);
    state->head.count = modes < HEAD_MODES ? modes : HEAD_MODES;
    double displacement[HEAD_MODES];
    himc_membrane_upright(membrane, state->head.count, NULL, displacement);
    for (int i = 0; i < state->head.count; i++)
        state->head.amplitude[i] = (float)displacement[i];
    end(osc);
}

// the sum of all drums from sample `first` on
static void mix(himc_performance *performance, uint64_t first, osc_sound *out)
{
    double heard[SOUND_FRAMES];
    himc_drum *drum;
    memset(out->sample, 0, sizeof out->sample);
    out->channels = 1;
    for (int channel = 0; channel < 2; channel++)
        for (int d = 0; (drum = himc_performance_drum(performance, d)); d++) {
            himc_drum_read_channel(drum, channel, first, SOUND_FRAMES, heard);
            for (int i = 0; i < SOUND_FRAMES; i++) {
                out->sample[i][channel] += (float)heard[i];
                out->channels = channel && heard[i] != 0 ? 2 : out->channels;
            }
        }
}

static void put_sound(himc_osc *osc, himc_performance *performance, const himc_performance_stats *s)
{
    uint64_t now = himc_performance_time(performance), *heard = &osc->host.heard;
    bool wanted = atomic_load_explicit(&osc->subscriptions.sounds, memory_order_relaxed) > 0;
    // a pause, or time that was counted from 0 again
    if (!wanted || *heard > now || now - *heard > HIMC_DRUM_RING / 2)
        *heard = now;
    for (; now - *heard >= SOUND_FRAMES; *heard += SOUND_FRAMES) {
        osc_state *state =
            begin(osc, STATE_SOUND, s->seconds - (double)(now - *heard) / s->sample_rate);
        if (!state)
            continue;
        state->sound.first = (uint32_t)*heard;
        state->sound.rate = (int)s->sample_rate;
        mix(performance, *heard, &state->sound);
        end(osc);
    }
}

static void put_drum(himc_osc *osc, himc_drum *drum, double time)
{
    const himc_head_frame *place = himc_drum_head_frame(drum);
    const himc_head *head = himc_membrane_head(himc_drum_membrane(drum));
    osc_state *state = begin(osc, STATE_DRUM, time);
    if (!state)
        return;
    put_name(state->drum.name, drum);
    put(state->drum.place, place->center);
    state->drum.place[3] = (float)place->tilt;
    state->drum.place[4] = (float)place->radius;
    state->drum.hz = sqrt(head->tension / himc_head_tension_for(head, 1));
    end(osc);
}

static void put_status(himc_osc *osc, const himc_performance_stats *stats, double elapsed)
{
    osc_state *state = begin(osc, STATE_STATUS, stats->seconds);
    if (!state)
        return;
    state->status.stats = *stats;
    state->status.strikes = osc->host.strikes;
    state->status.load = elapsed > 0 ? osc->host.busy / elapsed : 0;
    end(osc);
}

void himc_osc_publish(himc_osc *osc, himc_performance *performance, double busy)
{
    osc_host *h = &osc->host;
    himc_performance_stats stats = himc_performance_measure(performance);
    double now = osc->clock.wall(osc->clock.user), t = stats.seconds, apart = now - t - h->offset;
    double follow = fmin(fmax(t - h->time, 0) / OFFSET_TIME, 1);
    h->offset += fabs(apart) > OFFSET_JUMP ? apart : follow * apart;
    h->time = t;
    h->published = t + h->offset;
    h->busy += busy;
    int hz = atomic_load_explicit(&osc->subscriptions.head_hz, memory_order_relaxed);
    bool heads = due(&h->next_head, hz, t);
    put_sound(osc, performance, &stats);
    bool status = now >= h->next_status || h->next_status > now + 2 * STATUS_PERIOD;
    himc_drum *drum;
    for (int i = 0; (drum = himc_performance_drum(performance, i)); i++) {
        if (heads)
            put_head(osc, drum, t);
        if (status || h->revision[i] != himc_drum_revision(drum))
            put_drum(osc, drum, t);
        h->revision[i] = himc_drum_revision(drum);
    }
    if (!status)
        return;
    put_status(osc, &stats, h->status_sent ? now - h->next_status + STATUS_PERIOD : 0);
    h->status_sent = true;
    h->busy = 0;
    h->next_status = now + STATUS_PERIOD;
}

// --- the host's side: commands in

bool himc_osc_command(himc_osc *osc, const himc_command *command, himc_error *error)
{
    osc_record *r = himc_osc_ring_slot(&osc->records);
    if (!r)
        return himc_error_set(error, "too many subscriptions at once: this one is dropped");
    r->kind = RECORD_CHANGE;
    memset(&r->change, 0, sizeof r->change);
    if (!himc_osc_change_from(&r->change, command))
        return himc_error_set(error, "allowed here: subscribe unsubscribe");
    r->change.local = true;
    end(osc);
    return true;
}

// leaves room in the ring for states; the line that ends a long answer is in that room
static void answer(void *object, const char *line)
{
    sender *s = object;
    bool full = s->lines > 0 && himc_osc_ring_room(&s->osc->records) <= RECORDS_OF_STATES;
    osc_record *r = s->cut ? NULL : himc_osc_ring_slot(&s->osc->records);
    s->cut = full || !r;
    if (!r)
        return;
    r->kind = RECORD_LINE;
    r->line.to = *s->address;
    r->line.error = s->error || full;
    r->line.further = s->lines > 0;
    if (full)
        snprintf(r->line.text, sizeof r->line.text, CUT "no more fit into one answer", s->lines);
    else
        snprintf(r->line.text, sizeof r->line.text, "%s", line);
    s->lines++;
    end(s->osc);
}

static void refuse_to(himc_osc *osc, const osc_address *to, const char *error)
{
    himc_osc_add(&osc->counts, COUNT_REFUSED, 1);
    answer(&(sender){.osc = osc, .address = to, .error = true}, error);
}

// the loader has carried out a command, or refused it
static void loaded(void *object, const char *error)
{
    himc_osc *osc = object;
    const osc_host *h = &osc->host;
    himc_error line;
    osc->host.loading = false;
    if (!error)
        return;
    himc_error_set(&line, "%s%s%s", h->loading_drum, h->loading_drum[0] ? ": " : "", error);
    refuse_to(osc, &h->loading_for, line.text);
}

static himc_drum *find_drum(himc_performance *performance, const char *name, himc_error *error)
{
    himc_drum *drum;
    char names[120] = "";
    for (int i = 0; (drum = himc_performance_drum(performance, i)); i++) {
        if (strcmp(himc_drum_name(drum), name) == 0)
            return drum;
        size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, " %s", himc_drum_name(drum));
    }
    himc_error_set(error, "%s: no drum of that name, allowed:%s", name,
                   names[0] ? names : " none, make one with drum");
    return NULL;
}

static bool load(himc_osc *osc, const himc_load_target *to, const osc_order *order,
                 himc_error *error)
{
    osc_host *h = &osc->host;
    bool good = himc_loader_command(h->loader, to, &order->request.command, error);
    h->loading = good && himc_loader_busy(h->loader);
    h->loading_for = order->from;
    snprintf(h->loading_drum, sizeof h->loading_drum, "%s", to->drum ? order->request.drum : "");
    return good;
}

static bool carry_out(himc_osc *osc, himc_performance *performance, const osc_order *order,
                      himc_error *error)
{
    const osc_request *request = &order->request;
    himc_load_target to = {.performance = performance, .done = loaded, .user = osc};
    if (request->receiver != HIMC_PERFORMER) {
        to.drum = find_drum(performance, request->drum, error);
        if (!to.drum)
            return false;
    }
    bool good = osc->host.loader ? load(osc, &to, order, error)
                : to.drum        ? himc_drum_command(to.drum, &request->command, error)
                          : himc_performance_command(performance, &request->command, 0, error);
    return good || (to.drum && himc_error_prefix(error, "%s", request->drum));
}

static void begin_dump(himc_osc *osc, const osc_address *to)
{
    osc_dump *d = &osc->host.dump;
    *d = (osc_dump){.tells = true, .to = *to};
    d->from = (sender){.osc = osc, .address = &d->to};
}

static void dump_on(himc_osc *osc, himc_performance *performance)
{
    osc_dump *d = &osc->host.dump;
    d->tells =
        himc_performance_describe_on(performance, &d->place, answer, &d->from) && !d->from.cut;
}

static void obey(himc_osc *osc, himc_performance *performance, const osc_order *order)
{
    himc_error error = {""};
    const osc_request *request = &order->request;
    sender from = {.osc = osc, .address = &order->from};
    himc_command_id id = request->command.id;
    const himc_drum *drum = NULL;
    if (id == HIMC_COMMAND_DRUM_DUMP || id == HIMC_COMMAND_DRUM_INFO)
        drum = find_drum(performance, request->drum, &error);
    if (id == HIMC_COMMAND_INFO)
        himc_performance_describe(performance, HIMC_DESCRIBE_INFO, answer, &from);
    else if (id == HIMC_COMMAND_DUMP)
        begin_dump(osc, &order->from);
    else if (drum)
        himc_drum_describe(drum,
                           id == HIMC_COMMAND_DRUM_INFO ? HIMC_DESCRIBE_INFO : HIMC_DESCRIBE_STATE,
                           answer, &from);
    else if (!carry_out(osc, performance, order, &error))
        refuse_to(osc, &order->from, error.text);
}

// without a loader a head of 2000 modes takes 25 ms; a sender of such commands one after the other
// must not take the time of the sound, so their time is paid for from a bucket of seconds
void himc_osc_receive(himc_osc *osc, himc_performance *performance, int most)
{
    osc_host *h = &osc->host;
    const osc_order *order = NULL;
    double spent = 0;
    for (int i = 0; h->dump.tells || (i < most && (order = himc_osc_ring_peek(&osc->orders)));) {
        if (h->loading || spent > BLOCK_WORK || !afford(&h->work, monotonic(osc), 0))
            return;
        double start = monotonic(osc);
        if (h->dump.tells)
            dump_on(osc, performance);
        else {
            obey(osc, performance, order);
            himc_osc_ring_pop(&osc->orders);
            i++;
        }
        double took = monotonic(osc) - start;
        h->work.level -= took;
        spent += took;
    }
}

bool himc_osc_line(himc_osc *osc, char line[HIMC_OSC_LINE])
{
    const char *oldest = himc_osc_ring_peek(&osc->lines);
    if (!oldest)
        return false;
    memcpy(line, oldest, HIMC_OSC_LINE);
    himc_osc_ring_pop(&osc->lines);
    return true;
}

himc_osc_counts himc_osc_count(const himc_osc *osc)
{
    const osc_counters *c = &osc->counts;
    return (himc_osc_counts){.packets = himc_osc_read(c, COUNT_PACKETS),
                             .commands = himc_osc_read(c, COUNT_COMMANDS),
                             .malformed = himc_osc_read(c, COUNT_MALFORMED),
                             .foreign = himc_osc_read(c, COUNT_FOREIGN),
                             .refused = himc_osc_read(c, COUNT_REFUSED),
                             .frequent = himc_osc_read(c, COUNT_FREQUENT),
                             .overrun = himc_osc_read(c, COUNT_OVERRUN),
                             .sent = himc_osc_read(c, COUNT_SENT),
                             .unsent = himc_osc_read(c, COUNT_UNSENT),
                             .capped = himc_osc_read(c, COUNT_CAPPED),
                             .lost = osc->records.lost + osc->orders.lost + osc->lines.lost,
                             .subscriptions = osc->subscriptions.count};
}

// --- the network thread

static bool allows(himc_osc *osc, const osc_address *to, size_t bytes)
{
    return himc_osc_allows(&osc->subscriptions, to, (double)bytes, 1, monotonic(osc));
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

// tells the user a refusal of a stranger, each line once
static void tell_refusal(himc_osc *osc, const char *line)
{
    uint32_t hash = 2166136261u; // Fowler, Noll and Vo, FNV-1a
    for (const char *c = line; *c; c++)
        hash = (hash ^ (unsigned char)*c) * 16777619u;
    for (int i = 0; i < osc->refusals; i++)
        if (osc->refusal[i] == hash)
            return;
    if (osc->refusals == REFUSALS)
        return;
    osc->refusal[osc->refusals++] = hash;
    himc_osc_tell(&osc->lines, "refused: %s%s", line,
                  osc->refusals == REFUSALS ? " (further ones are counted alone)" : "");
}

// to its sender, to the user, and to the subscribers of refusals
static void send_refusal(himc_osc *osc, const osc_address *to, const char *line)
{
    const osc_subscription *one = NULL;
    send_line(osc, to, true, line, false);
    tell_refusal(osc, line);
    while ((one = himc_osc_errors_next(&osc->subscriptions, one)))
        if (!himc_osc_address_same(&one->to, to) && afford(&osc->answers, monotonic(osc), 1))
            send_line(osc, &one->to, true, line, false);
}

static void refuse(himc_osc *osc, const osc_address *to, const char *line)
{
    himc_osc_add(&osc->counts, COUNT_REFUSED, 1);
    if (to && afford(&osc->answers, monotonic(osc), 1))
        send_refusal(osc, to, line);
    else if (!to)
        himc_osc_tell(&osc->lines, "%s", line);
}

static void subscribe(himc_osc *osc, const osc_change *change)
{
    himc_error error;
    if (!himc_osc_subscribe(&osc->subscriptions, change, monotonic(osc), &error))
        refuse(osc, change->local ? NULL : &change->from, error.text);
}

static void hand_on(himc_osc *osc, const osc_address *from, const osc_request *request)
{
    osc_order *slot = himc_osc_ring_slot(&osc->orders);
    if (!slot) {
        himc_osc_add(&osc->counts, COUNT_FREQUENT, 1);
        return;
    }
    slot->from = *from;
    himc_osc_request_copy(&slot->request, request);
    himc_osc_ring_push(&osc->orders);
    himc_osc_add(&osc->counts, COUNT_COMMANDS, 1);
}

static void take_request(himc_osc *osc, const osc_address *from, osc_request *request)
{
    himc_error error;
    osc_change change = {.from = *from};
    if (!afford(&osc->points, monotonic(osc), himc_osc_request_cost(request))) {
        himc_osc_add(&osc->counts, COUNT_FREQUENT, 1);
    } else if (request->receiver == HIMC_PERFORMER &&
               himc_osc_change_from(&change, &request->command)) {
        himc_osc_add(&osc->counts, COUNT_COMMANDS, 1);
        subscribe(osc, &change);
    } else if (!himc_osc_request_admit(request, osc->files, &error)) {
        refuse(osc, from, error.text);
    } else {
        hand_on(osc, from, request);
    }
}

static void take_message(void *object, osc_verdict verdict, osc_request *request,
                         const himc_error *error)
{
    sender *s = object;
    switch (verdict) {
    case OSC_REQUEST: take_request(s->osc, s->address, request); break;
    case OSC_MALFORMED: himc_osc_add(&s->osc->counts, COUNT_MALFORMED, 1); break;
    case OSC_FOREIGN: himc_osc_add(&s->osc->counts, COUNT_FOREIGN, 1); break;
    case OSC_WRONG: refuse(s->osc, s->address, error->text); break;
    }
}

// false if none waits
static bool take_packet(himc_osc *osc)
{
    char data[PACKET_SIZE];
    osc_address from;
    long size = himc_osc_network_receive(&osc->network, &from, data, sizeof data);
    if (size < 0)
        return himc_osc_network_discard(&osc->network);
    himc_osc_decode(data, (size_t)size, take_message, &(sender){.osc = osc, .address = &from});
    return true;
}

// true if the share of packets is used up; the others wait in the sockets
static bool take_packets(himc_osc *osc)
{
    for (int i = 0; i < PACKETS_AT_ONCE; i++) {
        if (!afford(&osc->packets, monotonic(osc), 1))
            return true;
        if (take_packet(osc))
            continue;
        osc->packets.level += 1; // none was read
        return false;
    }
    return false;
}

// a refusal, or the first line of an answer; this pays for the line of a cut in addition
static bool send_first(himc_osc *osc, const osc_line *line, bool stranger)
{
    const osc_address *to = &line->to;
    if (!afford(&osc->answers, monotonic(osc), stranger && !line->error ? 2 : 1))
        return false;
    if (line->error)
        send_refusal(osc, to, line->text);
    return line->error ||
           (allows(osc, to, SMALL_PACKET) && send_line(osc, to, false, line->text, false));
}

// each line to a stranger is paid for, so that a short command brings no flood to a forged address
static void send_answer(himc_osc *osc, const osc_line *line)
{
    char text[HIMC_OSC_LINE];
    bool stranger = !himc_osc_trusted(&osc->subscriptions, &line->to), sent;
    if (!line->further) {
        osc->answered = sent = send_first(osc, line, stranger);
        osc->cut = !sent;
        return;
    }
    if (osc->cut)
        return;
    sent = !line->error && (!stranger || afford(&osc->answers, monotonic(osc), 1)) &&
           send_line(osc, &line->to, false, line->text, false);
    osc->answered += sent;
    osc->cut = !sent;
    if (sent)
        return;
    snprintf(text, sizeof text, CUT "expected at most %g lines and 500 kB a second", osc->answered,
             LINES_PER_SECOND);
    send_line(osc, &line->to, true, line->error ? line->text : text, true);
}

static void send_record(himc_osc *osc, const osc_record *r)
{
    himc_osc_counts counts;
    switch (r->kind) {
    case RECORD_STATE:
        counts = himc_osc_count(osc);
        himc_osc_deliver(&osc->subscriptions, &r->state, &counts, monotonic(osc));
        break;
    case RECORD_LINE: send_answer(osc, &r->line); break;
    case RECORD_CHANGE: subscribe(osc, &r->change); break;
    }
}

bool himc_osc_step(himc_osc *osc)
{
    const osc_record *record;
    bool flood = take_packets(osc);
    himc_osc_subscribe_found(&osc->subscriptions, monotonic(osc));
    for (int i = 0; i < RECORDS && (record = himc_osc_ring_peek(&osc->records)); i++) {
        send_record(osc, record);
        himc_osc_ring_pop(&osc->records);
    }
    himc_osc_forget(&osc->subscriptions, monotonic(osc));
    return flood;
}

static void *run(void *object)
{
    himc_osc *osc = object;
    bool flood = false;
    himc_system_give_way();
    while (!atomic_load_explicit(&osc->stop, memory_order_acquire)) {
        if (flood)
            nanosleep(&(struct timespec){0, REST}, NULL);
        else
            himc_osc_network_wait(&osc->network,
                                  osc->subscriptions.count > 0 ? WAIT_SUBSCRIBED : WAIT_IDLE);
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

static bool set_files(himc_osc *osc, const char *folder, himc_error *error)
{
    struct stat about;
    if (!folder)
        return true;
    osc->files = himc_system_real_path(folder);
    if (!osc->files || stat(folder, &about) != 0 || !S_ISDIR(about.st_mode))
        return himc_error_set(error, "files: %.200s is no folder", folder);
    return true;
}

static void fill_buckets(himc_osc *osc)
{
    double now = monotonic(osc);
    osc->packets = (osc_bucket){PACKETS_PER_SECOND, PACKETS_PER_SECOND, PACKETS_PER_SECOND, now};
    osc->points = (osc_bucket){POINTS_AT_ONCE, POINTS_PER_SECOND, POINTS_AT_ONCE, now};
    osc->answers = (osc_bucket){LINES_PER_SECOND, LINES_PER_SECOND, LINES_PER_SECOND, now};
    osc->host.work = (osc_bucket){WORK_AT_ONCE, WORK_SHARE, WORK_AT_ONCE, now};
}

static bool prepare(himc_osc *osc, const himc_osc_config *config, himc_error *error)
{
    osc_subscriptions *s = &osc->subscriptions;
    fill_buckets(osc);
    s->network = &osc->network;
    s->counts = &osc->counts;
    s->lines = &osc->lines;
    if (!himc_osc_ring_init(&osc->records, sizeof(osc_record), RECORDS) ||
        !himc_osc_ring_init(&osc->orders, sizeof(osc_order), COMMANDS_WAITING) ||
        !himc_osc_ring_init(&osc->lines, HIMC_OSC_LINE, LINES))
        return himc_error_set(error, "osc: out of memory");
    osc->host.loader = config->loader;
    if (!set_files(osc, config->files, error) ||
        !himc_osc_network_open(&osc->network, config->bind, config->port, &osc->counts, error) ||
        !himc_osc_allow(s, config->allow, error))
        return false;
    osc->running = !osc->stepped && himc_system_start_thread(&osc->thread, run, osc);
    return osc->running || osc->stepped || himc_error_set(error, "osc: the system gave no thread");
}

static himc_osc *make(const himc_osc_config *config, const osc_clock *clock, bool stepped,
                      himc_error *error)
{
    himc_osc *osc = calloc(1, sizeof *osc);
    if (!osc) {
        himc_error_set(error, "osc: out of memory");
        return NULL;
    }
    osc->network = (osc_network){.in = -1, .out = {-1, -1}};
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
    osc_record *r = himc_osc_ring_slot(&osc->records);
    if (!r)
        return;
    r->kind = RECORD_CHANGE;
    r->change = *change;
    end(osc);
}

// the subscriptions of the old one, and the changes that still wait in its ring, after the end of
// its thread
static void hand_over(himc_osc *old, himc_osc *osc)
{
    const osc_record *r;
    const osc_subscription *one = old->subscriptions.subscription;
    for (int i = 0; i < SUBSCRIPTIONS; i++, one++)
        if (one->used)
            put_change(osc, &(osc_change){.stream = one->stream,
                                          .hz = one->hz,
                                          .granted = true,
                                          .from = one->to,
                                          .expires = one->expires});
    for (; (r = himc_osc_ring_peek(&old->records)); himc_osc_ring_pop(&old->records))
        if (r->kind == RECORD_CHANGE)
            put_change(osc, &r->change);
    osc->host.strikes = old->host.strikes;
}

himc_osc *himc_osc_reopen(himc_osc *old, const himc_osc_config *config, himc_error *error)
{
    if (!old)
        return himc_osc_new(config, error);
    himc_osc *osc = make(config, &old->clock, old->stepped, error);
    if (!osc)
        return NULL;
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
    if (osc->host.loading) // for this
        himc_loader_finish(osc->host.loader);
    himc_osc_subscriptions_free(&osc->subscriptions);
    himc_osc_network_close(&osc->network);
    himc_osc_ring_free(&osc->records);
    himc_osc_ring_free(&osc->orders);
    himc_osc_ring_free(&osc->lines);
    free(osc->files);
    free(osc);
}

int himc_osc_port(const himc_osc *osc)
{
    return osc->network.port;
}
