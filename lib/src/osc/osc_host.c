/// osc_host.c: the host's side of a himc_osc: states out, commands in.
///
/// The host (an audio callback, Pd's scheduler) only copies into rings or out of them. The time t
/// of the samples and the wall clock W are joined by an offset W - t. It is followed slowly (a
/// second or so), because a host computes blocks in bursts and the sound is steady; it jumps when
/// the two are 0.1 s apart (the sound was off).
#define _POSIX_C_SOURCE 200809L // strnlen

#include "drum/drum_performer.h"
#include "head/modes.h"
#include "himc/body.h"
#include "himc/membrane.h"
#include "osc/osc_state.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define STATUS_PERIOD 1.0 // (s) chosen: as often as a user reads it

// --- states out

static osc_state *begin(himc_osc *osc, int kind, double time)
{
    osc_record *r = himc_ring_slot(&osc->records);
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
    himc_ring_push(&osc->records);
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

void himc_osc_tick(void *object, const himc_tick *tick)
{
    himc_osc *osc = object;
    int hz = atomic_load_explicit(&osc->subscriptions.pose_hz, memory_order_relaxed);
    if (tick->time == 0) { // with `reset` it begins again, and the wall clock goes on
        osc->host.offset += osc->host.time;
        osc->host.time = 0;
    }
    if (!due(&osc->host.next_pose, hz, tick->time))
        return;
    osc_state *state = begin(osc, STATE_POSE, tick->time);
    if (!state)
        return;
    osc_pose *pose = &state->pose;
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
    pose->sits = tick->support != NULL;
    if (pose->sits) {
        const himc_support_forces *f = tick->support;
        bool presses = isfinite(f->center.z); // one who flies does not: his pelvis
        put(pose->support[0], f->seat);
        put(pose->support[1], f->foot[HIMC_LEFT]);
        put(pose->support[2], f->foot[HIMC_RIGHT]);
        put(pose->support[3], presses ? f->center : tick->body->origin[HIMC_PELVIS]);
    }
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

// the sum of all drums
static void put_sound(himc_osc *osc, himc_performance *performance, const himc_performance_stats *s)
{
    uint64_t now = himc_performance_time(performance), *heard = &osc->host.heard;
    bool wanted = atomic_load_explicit(&osc->subscriptions.sounds, memory_order_relaxed) > 0;
    double sample[SOUND_FRAMES];
    himc_drum *drum;
    // a pause, or time that was counted from 0 again
    if (!wanted || *heard > now || now - *heard > HIMC_DRUM_RING / 2)
        *heard = now;
    for (; now - *heard >= SOUND_FRAMES; *heard += SOUND_FRAMES) {
        osc_state *state =
            begin(osc, STATE_SOUND, s->seconds - (double)(now - *heard) / s->sample_rate);
        if (!state)
            continue;
        osc_sound *out = &state->sound;
        *out = (osc_sound){.first = (uint32_t)*heard, .rate = (int)s->sample_rate, .channels = 1};
        for (int channel = 0; channel < 2; channel++)
            for (int d = 0; (drum = himc_performance_drum(performance, d)); d++) {
                himc_drum_read_channel(drum, channel, *heard, SOUND_FRAMES, sample);
                for (int i = 0; i < SOUND_FRAMES; i++)
                    out->sample[i][channel] += (float)sample[i];
            }
        for (int i = 0; i < SOUND_FRAMES; i++)
            out->channels = out->sample[i][1] != out->sample[i][0] ? 2 : out->channels;
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
    state->drum.place[5] = (float)place->length;
    state->drum.place[6] = (float)place->width;
    state->drum.hz = sqrt(head->tension / himc_head_tension_for(head, 1));
    end(osc);
}

void himc_osc_publish(himc_osc *osc, himc_performance *performance, double busy)
{
    osc_host *h = &osc->host;
    himc_performance_stats stats = himc_performance_measure(performance);
    double now = osc->clock.wall(osc->clock.user), t = stats.seconds, apart = now - t - h->offset;
    // chosen: a time constant of 1 s is longer than the bursts of a host; 0.1 s: the sound was off
    double follow = fmin(fmax(t - h->time, 0), 1);
    h->offset += fabs(apart) > 0.1 ? apart : follow * apart;
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
    double elapsed = h->status_sent ? now - h->next_status + STATUS_PERIOD : 0;
    osc_state *state = begin(osc, STATE_STATUS, t);
    if (state) {
        double load = elapsed > 0 ? h->busy / elapsed : 0;
        state->status = (osc_status){.stats = stats, .load = load, .strikes = h->strikes};
        end(osc);
    }
    h->status_sent = true;
    h->busy = 0;
    h->next_status = now + STATUS_PERIOD;
}

// --- commands in

bool himc_osc_command(himc_osc *osc, const himc_command *command, himc_error *error)
{
    osc_record *r = himc_ring_slot(&osc->records);
    if (!r)
        return himc_error_set(error, "too many subscriptions at once: this one is dropped");
    r->kind = RECORD_CHANGE;
    memset(&r->change, 0, sizeof r->change);
    if (!himc_osc_change_from(&r->change, command))
        return himc_error_set(error, "expected subscribe or unsubscribe");
    r->change.local = true;
    end(osc);
    return true;
}

// leaves room in the ring for 64 states (chosen: poses of 0.25 s); the line that ends a long answer
// is in that room
static void answer(void *object, const char *line)
{
    osc_sender *s = object;
    bool full = s->lines > 0 && himc_ring_room(&s->osc->records) <= 64;
    osc_record *r = s->cut ? NULL : himc_ring_slot(&s->osc->records);
    s->cut = full || !r;
    if (!r)
        return;
    r->kind = RECORD_LINE;
    r->line.to = *s->address;
    r->line.error = s->error || full;
    r->line.further = s->lines > 0;
    if (full)
        snprintf(r->line.text, sizeof r->line.text, OSC_CUT "no more fit into one answer",
                 s->lines);
    else
        snprintf(r->line.text, sizeof r->line.text, "%s", line);
    s->lines++;
    end(s->osc);
}

static void refuse_to(himc_osc *osc, const osc_address *to, const char *error)
{
    himc_osc_add(&osc->counts, COUNT_REFUSED, 1);
    answer(&(osc_sender){.osc = osc, .address = to, .error = true}, error);
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

static void obey(himc_osc *osc, himc_performance *performance, const osc_order *order)
{
    himc_error error = {""};
    osc_sender from = {.osc = osc, .address = &order->from};
    osc_host *h = &osc->host;
    const himc_load_target to = {.performance = performance, .done = loaded, .user = osc};
    const himc_command *command = &order->command;
    himc_command_id id = command->id;
    const himc_runner *runner = (const himc_runner *)(const void *)performance; // its first member
    const himc_drum *drum = NULL;
    if (id == HIMC_COMMAND_DRUM_DUMP || id == HIMC_COMMAND_DRUM_INFO)
        drum = runner->drum(performance, command, &error);
    bool good = true;
    if (id == HIMC_COMMAND_INFO) {
        himc_performance_describe(performance, HIMC_DESCRIBE_INFO, answer, &from);
    } else if (id == HIMC_COMMAND_GET) {
        good = himc_performance_get(performance, command->atom[0].symbol, answer, &from, &error);
    } else if (id == HIMC_COMMAND_DUMP) {
        h->dump = (osc_dump){
            .tells = true, .to = order->from, .from = {.osc = osc, .address = &h->dump.to}};
    } else if (drum) {
        himc_drum_describe(drum,
                           id == HIMC_COMMAND_DRUM_INFO ? HIMC_DESCRIBE_INFO : HIMC_DESCRIBE_STATE,
                           answer, &from);
    } else if (h->loader) {
        good = himc_loader_command(h->loader, &to, command, &error);
        h->loading = good && himc_loader_busy(h->loader);
        h->loading_for = order->from;
        memcpy(h->loading_drum, command->drum, sizeof h->loading_drum);
    } else {
        good = himc_performance_command(performance, command, 0, &error);
    }
    if (!good)
        refuse_to(osc, &order->from, error.text);
}

// without a loader a head of 2000 modes takes 25 ms; a sender of such commands one after the other
// must not take the time of the sound, so their time is paid for from a bucket of seconds
void himc_osc_receive(himc_osc *osc, himc_performance *performance, int most)
{
    osc_host *h = &osc->host;
    osc_dump *dump = &h->dump;
    const osc_order *order = NULL;
    double spent = 0;
    const double block = 2e-4; // no further command in a block once they took so long (s); chosen
    for (int i = 0; dump->tells || (i < most && (order = himc_ring_peek(&osc->orders)));) {
        if (h->loading || spent > block || !himc_osc_afford(&h->work, himc_osc_now(osc), 0))
            return;
        double start = himc_osc_now(osc);
        if (dump->tells) {
            bool more =
                himc_performance_describe_on(performance, &dump->place, answer, &dump->from);
            dump->tells = more && !dump->from.cut;
        } else {
            obey(osc, performance, order);
            himc_ring_pop(&osc->orders);
            i++;
        }
        double took = himc_osc_now(osc) - start;
        h->work.level -= took;
        spent += took;
    }
}

bool himc_osc_line(himc_osc *osc, char line[HIMC_OSC_LINE])
{
    const char *oldest = himc_ring_peek(&osc->lines);
    if (!oldest)
        return false;
    memcpy(line, oldest, HIMC_OSC_LINE);
    himc_ring_pop(&osc->lines);
    return true;
}
