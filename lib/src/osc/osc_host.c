/// osc_host.c: the side of the audio: everything here only copies into rings or out of them.
///
/// The samples' time t and the wall clock W are joined by an offset W - t, followed slowly (a
/// second or so), because a host computes blocks in bursts and the sound does not; it jumps when
/// the two have parted by 0.1 s (the sound was off).
#define _POSIX_C_SOURCE 200809L
#include "osc/osc_state.h"
#include "himc/membrane.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#define FOLLOW 0.002 // of the distance, each block
#define JUMP 0.1     // (s)
#define SLICE 2e-4   // no further command in this block once they took so long (s)

static osc_record *begin(himc_osc *osc, int kind, double time)
{
    osc_record *r = himc_osc_ring_slot(&osc->records);
    if (!r)
        return NULL;
    r->kind = kind;
    r->time = time;
    r->wall = time + osc->offset;
    return r;
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

// whether one of `hz` a second is due, and then when the next will be
static bool due(double *next, int hz, double t)
{
    // after a `reset` time begins again: what is due far ahead is due now
    if (hz <= 0 || (t < *next && *next - t < 2.0 / hz))
        return false;
    *next = fmax(*next + 1.0 / hz, t + 0.5 / hz);
    return true;
}

void himc_osc_tick(void *object, const himc_tick *tick)
{
    himc_osc *osc = object;
    int hz = atomic_load_explicit(&osc->pose_hz, memory_order_relaxed);
    osc_record *r =
        due(&osc->next_pose, hz, tick->time) ? begin(osc, RECORD_POSE, tick->time) : NULL;
    if (!r)
        return;
    for (int i = 0; i < HIMC_SEGMENTS; i++) {
        himc_quat q = tick->body->orientation[i];
        put(r->pose.origin[i], tick->body->origin[i]);
        put(r->pose.orientation[i], himc_quat_vector(q));
        r->pose.orientation[i][3] = (float)q.w;
    }
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        put(r->pose.target[hand], tick->target[hand]);
        put(r->pose.tip[hand], tick->body->tip[hand]);
    }
    end(osc);
}

void himc_osc_event(himc_osc *osc, const himc_event *event)
{
    bool strike = event->kind == HIMC_EVENT_STRIKE;
    if (!strike && event->kind != HIMC_EVENT_BEAT)
        return;
    osc->strikes += strike; // also one that finds the ring full
    double time = strike ? event->strike.time : osc->last_publish - osc->offset;
    osc_record *r = begin(osc, strike ? RECORD_STRIKE : RECORD_BEAT, time);
    if (!r)
        return;
    if (strike)
        r->strike = (osc_strike){event->strike, osc->strikes};
    else
        r->beat = event->beat;
    end(osc);
}

static void put_head(himc_osc *osc, himc_drum *drum, double time)
{
    himc_membrane *membrane = himc_drum_membrane(drum);
    int modes = himc_membrane_head(membrane)->modes;
    osc_record *r = begin(osc, RECORD_HEAD, time);
    if (!r)
        return;
    memcpy(r->head.name, himc_drum_name(drum),
           strnlen(himc_drum_name(drum), HIMC_NAME_SIZE - 1) + 1);
    r->head.count = modes < HEAD_MODES ? modes : HEAD_MODES;
    for (int i = 0; i < r->head.count; i++) {
        double q, v;
        himc_membrane_state(membrane, i, &q, &v);
        r->head.amplitude[i] = (float)q;
    }
    end(osc);
}

static void put_drum(himc_osc *osc, himc_drum *drum, double time)
{
    const himc_head_frame *place = himc_drum_head_frame(drum);
    const himc_head *head = himc_membrane_head(himc_drum_membrane(drum));
    osc_record *r = begin(osc, RECORD_DRUM, time);
    if (!r)
        return;
    memcpy(r->drum.name, himc_drum_name(drum),
           strnlen(himc_drum_name(drum), HIMC_NAME_SIZE - 1) + 1);
    put(r->drum.place, place->center);
    r->drum.place[3] = (float)place->tilt;
    r->drum.place[4] = (float)place->radius;
    r->drum.hz = sqrt(head->tension / himc_head_tension_for(head, 1));
    end(osc);
}

static void put_state(himc_osc *osc, const himc_performance_stats *stats, double elapsed)
{
    osc_record *r = begin(osc, RECORD_STATE, stats->seconds);
    if (!r)
        return;
    r->state.stats = *stats;
    r->state.strikes = osc->strikes;
    r->state.load = elapsed > 0 ? osc->busy / elapsed : 0;
    end(osc);
}

void himc_osc_publish(himc_osc *osc, himc_performance *performance, double busy)
{
    himc_performance_stats stats = himc_performance_measure(performance);
    double now = himc_osc_clock(CLOCK_REALTIME), t = stats.seconds, parted = now - t - osc->offset;
    osc->offset += fabs(parted) > JUMP ? parted : FOLLOW * parted;
    osc->last_publish = t + osc->offset;
    osc->busy += busy;
    int hz = atomic_load_explicit(&osc->head_hz, memory_order_relaxed);
    bool heads = due(&osc->next_head, hz, t),
         state = now >= osc->next_state || osc->next_state > now + 2;
    himc_drum *drum;
    for (int i = 0; (drum = himc_performance_drum(performance, i)); i++) {
        if (heads)
            put_head(osc, drum, t);
        if (state || osc->revision[i] != himc_drum_revision(drum))
            put_drum(osc, drum, t);
        osc->revision[i] = himc_drum_revision(drum);
    }
    if (!state)
        return;
    put_state(osc, &stats, osc->aligned ? now - osc->next_state + 1 : 0);
    osc->aligned = true;
    osc->busy = 0;
    osc->next_state = now + 1;
}

bool himc_osc_command(himc_osc *osc, const himc_command *command, himc_error *error)
{
    osc_record *r = himc_osc_ring_slot(&osc->records);
    if (!r)
        return himc_error_set(error, "too many subscriptions at once: this one is dropped");
    r->kind = RECORD_WISH;
    memset(&r->wish, 0, sizeof r->wish);
    if (!himc_osc_wish_from(&r->wish, command))
        return himc_error_set(error, "allowed here: subscribe unsubscribe");
    r->wish.local = true;
    end(osc);
    return true;
}

// who asked, for lines of an answer
typedef struct asker {
    himc_osc *osc;
    const osc_address *to;
    bool error;
} asker;

static void answer(void *object, const char *line)
{
    asker *a = object;
    osc_record *r = begin(a->osc, RECORD_ANSWER, 0);
    if (!r)
        return;
    r->answer.to = *a->to;
    r->answer.error = a->error;
    snprintf(r->answer.text, sizeof r->answer.text, "%s", line);
    end(a->osc);
}

static bool carry_out(himc_performance *performance, const osc_order *order, himc_error *error)
{
    himc_drum *drum;
    char names[120] = "";
    if (order->receiver == HIMC_PERFORMER)
        return himc_performance_command(performance, &order->command, 0, error);
    for (int i = 0; (drum = himc_performance_drum(performance, i)); i++) {
        if (strcmp(himc_drum_name(drum), order->drum) == 0)
            return himc_drum_command(drum, &order->command, error) ||
                   himc_error_prefix(error, "%s", order->drum);
        size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, " %s", himc_drum_name(drum));
    }
    return himc_error_set(error, "%s: no drum of that name, allowed:%s", order->drum,
                          names[0] ? names : " none, make one with drum");
}

// commands may take a tenth of the time: a head of 2000 modes takes 25 ms to make anew, and who
// asks for one over and over must not take the sound's; what finds no room to wait is `frequent`
static bool time_left(himc_osc *osc)
{
    return himc_osc_afford(&osc->work, 0);
}

void himc_osc_receive(himc_osc *osc, himc_performance *performance, int most)
{
    const osc_order *order;
    double spent = 0;
    for (int i = 0; i < most && (order = himc_osc_ring_peek(&osc->orders)); i++) {
        if (spent > SLICE || !time_left(osc))
            return;
        double begun = himc_osc_clock(CLOCK_MONOTONIC);
        asker from = {osc, &order->from, false};
        himc_error error = {""};
        if (order->receiver == HIMC_PERFORMER && order->command.id == HIMC_COMMAND_INFO) {
            himc_performance_describe(performance, answer, &from);
        } else if (!carry_out(performance, order, &error)) {
            from.error = true;
            osc_counted(osc, COUNT_REFUSED, 1);
            answer(&from, error.text);
        }
        himc_osc_ring_pop(&osc->orders);
        double took = himc_osc_clock(CLOCK_MONOTONIC) - begun;
        osc->work.level -= took;
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

static long counted(const himc_osc *osc, int which)
{
    return atomic_load_explicit(&osc->count[which], memory_order_relaxed);
}

himc_osc_counts himc_osc_count(const himc_osc *osc)
{
    return (himc_osc_counts){.packets = counted(osc, COUNT_PACKETS),
                             .commands = counted(osc, COUNT_COMMANDS),
                             .malformed = counted(osc, COUNT_MALFORMED),
                             .foreign = counted(osc, COUNT_FOREIGN),
                             .refused = counted(osc, COUNT_REFUSED),
                             .frequent = counted(osc, COUNT_FREQUENT),
                             .overrun = counted(osc, COUNT_OVERRUN),
                             .sent = counted(osc, COUNT_SENT),
                             .unsent = counted(osc, COUNT_UNSENT),
                             .lost = osc->records.lost + osc->orders.lost + osc->lines.lost,
                             .subscriptions = (int)counted(osc, COUNT_SUBSCRIPTIONS)};
}
