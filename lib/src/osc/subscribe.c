/// subscribe.c: which address gets which state, how often, and who may ask for it.
///
/// Over the network a host may subscribe itself or one of --allow, by numeric address only, so that
/// no stranger can make this machine ask a name server. The user of this machine may subscribe any
/// host. An address where nobody listens is tried once a second and forgotten after a minute, with
/// one line for the user.
///
/// The sender of a UDP packet can be forged, and a firewall may hide that nobody listens. So what
/// is asked for over the network, for a host that is neither this machine nor one of --allow, ends
/// after a minute unless it is asked for again; each host elsewhere gets so many bytes a second and
/// no more, has so many subscriptions, and all of them together leave some to the others.
///
/// A state is encoded once for all its subscribers: in one packet for this machine, and in packets
/// below 1400 bytes for the others, so that none is fragmented on the way.
#include "osc/subscribe.h"
#include "base/format.h"

#include "base/line.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define FORGET_AFTER 60.0   // (s) chosen: long enough to restart a receiver
#define RETRY_PERIOD 1.0    // (s) chosen
#define RENEWED_WITHIN 60.0 // (s) chosen: a receiver that subscribes twice a minute keeps it
#define HOST_BYTES 500e3    // a second; chosen: the largest stream, vmc at 250 Hz, has 468,000
#define HOST_BURST 0.25     // of a second's bytes at once; chosen: poses come in bursts of blocks
#define UNKNOWN_DRUM 110.0  // (Hz) chosen: A2, for vmc
#define OF_A_HOST 32        // subscriptions of a stranger; chosen: four receivers of all streams

void himc_osc_tell(system_ring *lines, const char *format, ...)
{
    char *line = himc_ring_slot(lines);
    if (!line)
        return;
    va_list args;
    va_start(args, format);
    himc_line_print(line, HIMC_OSC_LINE, format, args);
    va_end(args);
    himc_ring_push(lines);
}

// --- changes of the table

bool himc_osc_change_from(osc_change *change, const himc_command *c)
{
    enum { WITH_PORT, VMC }; // the forms of both commands
    if (c->id != HIMC_COMMAND_SUBSCRIBE && c->id != HIMC_COMMAND_UNSUBSCRIBE)
        return false;
    int next = c->form == VMC ? 1 : 2;
    himc_format(change->host, sizeof change->host, "%s", c->atom[0].symbol);
    change->port = c->form == VMC ? HIMC_VMC_PORT : (int)c->atom[1].number;
    change->stream = STREAM_ANY;
    if (next < c->count && c->choice[next] >= 0)
        change->stream = c->form == VMC ? STREAM_VMC : (osc_stream)c->choice[next];
    if (change->stream != STREAM_ANY)
        next++;
    // chosen: 33 Hz, one pose a frame of 30 a second
    change->hz = next < c->count ? c->atom[next].number : 33;
    change->remove = c->id == HIMC_COMMAND_UNSUBSCRIBE;
    return true;
}

static const char *command_of(const osc_change *change)
{
    return himc_command_table(change->remove ? HIMC_COMMAND_UNSUBSCRIBE : HIMC_COMMAND_SUBSCRIBE)
        ->name;
}

static bool refuse(const osc_change *change, himc_error *error, const char *why)
{
    return himc_error_set(error, "%s: %.200s port %d: %s", command_of(change), change->host,
                          change->port, why);
}

// true if the host is one of --allow
static bool is_listed(const osc_subscriptions *s, const osc_address *host)
{
    for (int i = 0; i < s->allowed_count; i++)
        if (himc_osc_address_same_host(host, &s->allowed[i]))
            return true;
    return false;
}

static bool sends_poses(const osc_subscription *one)
{
    return one->stream == STREAM_POSE || one->stream == STREAM_TARGETS || one->stream == STREAM_VMC;
}

// after a change of the table: the highest rates, and the first subscription of each address
static void update(osc_subscriptions *s)
{
    double pose = 0, head = 0;
    int count = 0, sounds = 0;
    for (int i = 0; i < SUBSCRIPTIONS; i++) {
        osc_subscription *one = &s->subscription[i];
        one->first = one->used && one->stream != STREAM_VMC;
        for (int k = 0; k < i && one->first; k++)
            one->first = !(s->subscription[k].first &&
                           himc_osc_address_same(&s->subscription[k].to, &one->to));
        if (!one->used)
            continue;
        count++;
        sounds += one->stream == STREAM_SOUND;
        if (one->stream == STREAM_HEAD)
            head = fmax(head, one->hz);
        else if (sends_poses(one))
            pose = fmax(pose, one->hz);
    }
    atomic_store(&s->pose_hz, (int)ceil(pose));
    atomic_store(&s->head_hz, (int)ceil(head));
    atomic_store(&s->sounds, sounds);
    atomic_store(&s->count, count);
}

bool himc_osc_trusted(const osc_subscriptions *s, const osc_address *host)
{
    return himc_osc_address_loopback(host) || is_listed(s, host);
}

// false if strangers have as many as they may
static bool has_room(const osc_subscriptions *s, const osc_change *change, const osc_address *to,
                     himc_error *error)
{
    char host[80], why[160];
    int own = 0, all = 0;
    for (const osc_subscription *one = s->subscription; one < s->subscription + SUBSCRIPTIONS;
         one++)
        if (one->used && one->expires > 0) {
            own += himc_osc_address_same_host(&one->to, to);
            all++;
        }
    // chosen: the user, this machine and --allow keep a quarter of all
    if (own < OF_A_HOST && all < SUBSCRIPTIONS * 3 / 4)
        return true;
    himc_osc_address_print(to, host);
    if (own < OF_A_HOST)
        snprintf(why, sizeof why, "%d subscriptions of other machines already, expected no more",
                 all);
    else
        snprintf(why, sizeof why, "%d subscriptions of %.*s already, expected no more", own,
                 (int)(strrchr(host, ':') - host), host);
    return refuse(change, error, why);
}

static bool make_change(osc_subscriptions *s, const osc_change *change, const osc_address *to,
                        double now, himc_error *error)
{
    osc_subscription *same = NULL, *unused = NULL;
    for (osc_subscription *one = s->subscription; one < s->subscription + SUBSCRIPTIONS; one++) {
        bool all = change->remove && change->stream == STREAM_ANY;
        if (!one->used) {
            unused = unused ? unused : one;
        } else if ((all || one->stream == change->stream) && himc_osc_address_same(&one->to, to)) {
            same = one;
            if (change->remove)
                one->used = false;
        }
    }
    if (change->remove) {
        update(s);
        return same || refuse(change, error, "not subscribed");
    }
    osc_subscription *place = same ? same : unused;
    if (!place)
        return refuse(change, error, "256 subscriptions already, expected no more");
    double expires = 0; // never
    if (change->granted)
        expires = change->expires;
    else if (!change->local && !himc_osc_trusted(s, to))
        expires = now + RENEWED_WITHIN;
    if (!place->used && expires > 0 && !has_room(s, change, to, error))
        return false;
    *place = (osc_subscription){.used = true,
                                .to = *to,
                                .stream = change->stream,
                                .hz = change->hz,
                                .expires = expires,
                                .local = himc_osc_address_loopback(to)};
    update(s);
    return true;
}

bool himc_osc_subscribe(osc_subscriptions *s, const osc_change *change, double now,
                        himc_error *error)
{
    osc_address to;
    if (change->granted)
        return make_change(s, change, &change->from, now, error);
    if (himc_osc_address_parse(change->host, change->port, &to)) {
        bool own = change->local || himc_osc_address_same_host(&to, &change->from);
        if (own || is_listed(s, &to))
            return make_change(s, change, &to, now, error);
        return refuse(change, error, "expected your own address, or one given by --allow");
    }
    if (!change->local)
        return refuse(change, error, "expected a numeric address over the network");
    struct osc_pending *p = s->pending;
    while (p < s->pending + LOOKUPS && p->lookup)
        p++;
    if (p < s->pending + LOOKUPS) {
        p->change = *change;
        p->lookup = himc_osc_lookup_start(change->host, change->port);
        if (p->lookup)
            return true;
    }
    return refuse(change, error, "too many names are being looked up");
}

void himc_osc_subscribe_found(osc_subscriptions *s, double now)
{
    osc_address to;
    himc_error error;
    bool found;
    for (struct osc_pending *p = s->pending; p < s->pending + LOOKUPS; p++) {
        if (!p->lookup || !himc_osc_lookup_done(p->lookup, &found, &to))
            continue;
        himc_osc_lookup_free(p->lookup);
        p->lookup = NULL;
        if (!found) {
            himc_osc_tell(s->lines, "%s: %.200s: no host of that name", command_of(&p->change),
                          p->change.host);
        } else if (!make_change(s, &p->change, &to, now, &error)) {
            himc_osc_add(s->counts, COUNT_REFUSED, 1);
            himc_osc_tell(s->lines, "%s", error.text);
        }
    }
}

bool himc_osc_allow(osc_subscriptions *s, const char *hosts, himc_error *error)
{
    while (hosts && *hosts) {
        char host[256];
        size_t n = strcspn(hosts, ",");
        snprintf(host, sizeof host, "%.*s", (int)n, hosts);
        if (s->allowed_count == ALLOWED_HOSTS)
            return himc_error_set(error, "allow: %s is one host too many, expected 32", host);
        osc_address *a = &s->allowed[s->allowed_count++];
        if (n >= sizeof host ||
            (!himc_osc_address_parse(host, 1, a) && !himc_osc_address_find(host, 1, a)))
            return himc_error_set(error, "allow: %s: no host of that name", host);
        hosts += n + (hosts[n] == ',');
    }
    return true;
}

void himc_osc_subscriptions_free(osc_subscriptions *s)
{
    for (struct osc_pending *p = s->pending; p < s->pending + LOOKUPS; p++)
        if (p->lookup)
            himc_osc_lookup_free(p->lookup);
}

// --- addresses where nobody listens

static void mark_unreachable(osc_subscriptions *s, const osc_address *to, double now)
{
    char text[80];
    bool told = false;
    for (osc_subscription *one = s->subscription; one < s->subscription + SUBSCRIPTIONS; one++) {
        if (!one->used || !himc_osc_address_same(&one->to, to))
            continue;
        told = told || one->unreachable_since > 0;
        if (one->unreachable_since <= 0)
            one->unreachable_since = now;
        one->unreachable_last = now;
        one->due = fmax(one->due, now + RETRY_PERIOD);
        if (told)
            continue;
        himc_osc_address_print(to, text);
        himc_osc_tell(s->lines,
                      "%s: unreachable, or nobody listens; tried once a second, forgotten after "
                      "%g s",
                      text, FORGET_AFTER);
        told = true;
    }
}

void himc_osc_forget(osc_subscriptions *s, double now)
{
    osc_address to;
    char text[80];
    bool forgotten = false;
    for (osc_subscription *one = s->subscription; one < s->subscription + SUBSCRIPTIONS; one++) {
        if (!one->used || one->expires <= 0 || now < one->expires)
            continue;
        if (one->first || one->stream == STREAM_VMC) { // one line for each address
            himc_osc_address_print(&one->to, text);
            himc_osc_tell(s->lines, "%s: not subscribed again within %g s, forgotten", text,
                          RENEWED_WITHIN);
        }
        one->used = false;
        forgotten = true;
    }
    // chosen: 64 reports of each socket at a time
    for (int i = 0; i < 64 * OSC_SOCKETS && himc_osc_network_unreachable(s->network, &to); i++)
        mark_unreachable(s, &to, now);
    for (osc_subscription *one = s->subscription; one < s->subscription + SUBSCRIPTIONS; one++) {
        if (!one->used || one->unreachable_since <= 0)
            continue;
        if (now - one->unreachable_since > FORGET_AFTER) {
            one->used = false;
            forgotten = true;
        } else if (now - one->unreachable_last > 2.5 * RETRY_PERIOD) { // chosen
            one->unreachable_since = 0;
        }
    }
    if (forgotten)
        update(s);
}

// --- states out

bool himc_osc_allows(osc_subscriptions *s, const osc_address *to, double bytes, int packets,
                     double now)
{
    osc_allowance *a = NULL, *full = NULL;
    if (himc_osc_address_loopback(to))
        return true;
    for (int i = 0; i < SUBSCRIPTIONS && !a; i++) {
        osc_allowance *one = &s->allowance[i];
        if (himc_osc_address_same_host(&one->host, to))
            a = one;
        else if (!full &&
                 (one->bytes.last == 0 || now - one->bytes.last >= HOST_BURST)) // as a new one
            full = one;
    }
    if (!a && full) {
        a = full;
        *a = (osc_allowance){*to, himc_osc_bucket(HOST_BYTES, HOST_BURST * HOST_BYTES, now)};
    }
    bool allowed = a && himc_osc_afford(&a->bytes, now, bytes);
    himc_osc_add(s->counts, COUNT_CAPPED, allowed ? 0 : packets);
    return allowed;
}

static void send_packets(osc_subscriptions *s, const osc_address *to, const osc_packets *p,
                         double now)
{
    double bytes = 0;
    for (int i = 0; i < p->count; i++)
        bytes += (double)p->size[i];
    if (!himc_osc_allows(s, to, bytes, p->count, now))
        return;
    for (int i = 0; i < p->count; i++)
        if (!himc_osc_network_send(s->network, to, p->data[i], p->size[i]))
            mark_unreachable(s, to, now);
}

// true if the next packet is due; half a period early is early enough, so that two clocks of the
// same rate do not beat
static bool due(osc_subscription *one, double now)
{
    if (now < one->due)
        return false;
    double period = one->unreachable_since > 0 ? RETRY_PERIOD : 1 / one->hz;
    one->due = fmax(one->due + period, now + 0.5 * period);
    return true;
}

static void deliver_pose(osc_subscriptions *s, const osc_state *state, osc_packets *targets,
                         double now)
{
    himc_osc_encode_targets(targets, &state->pose);
    memset(s->encoded, 0, sizeof s->encoded);
    for (osc_subscription *one = s->subscription; one < s->subscription + SUBSCRIPTIONS; one++) {
        if (!one->used || !sends_poses(one) || !due(one, now))
            continue;
        bool vmc = one->stream == STREAM_VMC, *encoded = &s->encoded[vmc][one->local];
        osc_packets *p = one->stream == STREAM_TARGETS ? targets : &s->packets[vmc][one->local];
        if (p != targets && !*encoded) {
            *encoded = true;
            himc_osc_encode_begin(p, one->local ? LARGE_PACKET : SMALL_PACKET, true, state->wall);
            if (vmc)
                himc_osc_encode_vmc_pose(p, &state->pose, state->time);
            else
                himc_osc_encode_pose(p, &state->pose);
        }
        send_packets(s, &one->to, p, now);
    }
}

// to the subscribers of a stream; STREAM_ANY: to each address once that has one but vmc
static void send_stream(osc_subscriptions *s, osc_stream stream, const osc_packets *p, double now)
{
    for (osc_subscription *one = s->subscription; one < s->subscription + SUBSCRIPTIONS; one++)
        if (one->used && (stream == STREAM_ANY ? one->first : one->stream == stream))
            send_packets(s, &one->to, p, now);
}

const osc_subscription *himc_osc_errors_next(const osc_subscriptions *s,
                                             const osc_subscription *one)
{
    for (one = one ? one + 1 : s->subscription; one < s->subscription + SUBSCRIPTIONS; one++)
        if (one->used && one->stream == STREAM_ERRORS)
            return one;
    return NULL;
}

// index of the drum, or their number
static int find_drum(const osc_subscriptions *s, const char *name)
{
    int i = 0;
    while (i < s->drums && strcmp(s->drum[i].name, name) != 0)
        i++;
    return i;
}

static void deliver_head(osc_subscriptions *s, const osc_head *head, osc_packets *p, double now)
{
    himc_osc_encode_head(p, head);
    for (osc_subscription *one = s->subscription; one < s->subscription + SUBSCRIPTIONS; one++) {
        if (!one->used || one->stream != STREAM_HEAD)
            continue;
        // the heads of several drums come together; all are due when the first is, which has just
        // put the next time a period ahead
        bool first = head->name[0] && strcmp(s->drum[0].name, head->name) == 0;
        if (first ? due(one, now) : now + 0.4 / one->hz < one->due)
            send_packets(s, &one->to, p, now);
    }
}

void himc_osc_deliver(osc_subscriptions *s, const osc_state *state, const himc_osc_counts *counts,
                      double now)
{
    osc_packets p, vmc;
    osc_stream to = STREAM_ANY;
    int drum;
    himc_osc_encode_begin(&p, SMALL_PACKET, true, state->wall);
    switch (state->kind) {
    case STATE_POSE: deliver_pose(s, state, &p, now); return;
    case STATE_HEAD: deliver_head(s, &state->head, &p, now); return;
    case STATE_STRIKE:
        to = STREAM_STRIKES;
        himc_osc_encode_strike(&p, &state->strike);
        drum = find_drum(s, state->strike.strike.drum);
        himc_osc_encode_begin(&vmc, SMALL_PACKET, true, state->wall);
        himc_osc_encode_vmc_strike(&vmc, &state->strike.strike,
                                   drum < s->drums ? s->drum[drum].hz : UNKNOWN_DRUM);
        send_stream(s, STREAM_VMC, &vmc, now);
        break;
    case STATE_SOUND:
        to = STREAM_SOUND;
        himc_osc_encode_sound(&p, &state->sound);
        break;
    case STATE_DRUM:
        drum = find_drum(s, state->drum.name);
        if (drum == HIMC_DRUMS)
            return;
        s->drums += drum == s->drums;
        s->drum[drum] = state->drum;
        himc_osc_encode_drum(&p, &state->drum);
        break;
    case STATE_BEAT: himc_osc_encode_beat(&p, state->beat); break;
    case STATE_MISSED: himc_osc_encode_missed(&p, &state->missed); break;
    case STATE_STATUS: himc_osc_encode_status(&p, &state->status, counts); break;
    }
    send_stream(s, to, &p, now);
}
