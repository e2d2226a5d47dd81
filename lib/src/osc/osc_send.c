/// osc_send.c: packets out: what the host has left in the ring, to whom it concerns.
///
/// A state is written once for all who get it, in one packet for this machine and in packets below
/// 1400 bytes for the others, so that none is cut in pieces on the way.
#define _POSIX_C_SOURCE 200809L
#include "osc/osc_state.h"
#include "himc/body.h"

#include <lo/lo.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

static void send_packets(himc_osc *osc, const osc_address *to, const osc_packets *p)
{
    for (int i = 0; i < p->count; i++)
        if (!himc_osc_send_to(osc, to, p->data[i], p->size[i]))
            himc_osc_refused(osc, to);
}

static void pack_pose(osc_packets *p, const osc_record *r)
{
    for (int i = 0; i < HIMC_SEGMENTS; i++) {
        const float *x = r->pose.origin[i], *q = r->pose.orientation[i];
        himc_osc_pack(p, "/himc/body", "sfffffff", himc_segment_name(i), x[0], x[1], x[2], q[3],
                      q[0], q[1], q[2]);
    }
}

static void pack_targets(osc_packets *p, const osc_record *r)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        const float *x = r->pose.target[hand];
        himc_osc_pack(p, "/himc/targets", "sfff", himc_hand_name((himc_hand)hand), x[0], x[1],
                      x[2]);
    }
}

static void send_pose(himc_osc *osc, const osc_record *r)
{
    static void (*const pack[])(osc_packets *, const osc_record *) = {pack_pose, himc_osc_vmc_pose};
    double now = himc_osc_clock(CLOCK_MONOTONIC);
    memset(osc->packed, 0, sizeof osc->packed);
    for (osc_subscriber *s = osc->subscriber; s < osc->subscriber + SUBSCRIBERS; s++) {
        if (!s->used || s->what == OSC_STRIKES || s->what == OSC_HEAD || !himc_osc_due(s, now))
            continue;
        if (s->what == OSC_TARGETS) {
            osc_packets p;
            himc_osc_pack_begin(&p, SMALL_PACKET, true, r->wall);
            pack_targets(&p, r);
            send_packets(osc, &s->to, &p);
            continue;
        }
        bool vmc = s->what == OSC_VMC;
        osc_packets *p = &osc->packet[vmc][s->local];
        if (!osc->packed[vmc][s->local]) {
            himc_osc_pack_begin(p, s->local ? LARGE_PACKET : SMALL_PACKET, true, r->wall);
            pack[vmc](p, r);
            osc->packed[vmc][s->local] = true;
        }
        send_packets(osc, &s->to, p);
    }
}

// to each address once that wants anything but vmc
static void send_to_leads(himc_osc *osc, const osc_packets *p)
{
    for (int i = 0; i < SUBSCRIBERS; i++)
        if (osc->subscriber[i].used && osc->subscriber[i].lead)
            send_packets(osc, &osc->subscriber[i].to, p);
}

static double principal(const himc_osc *osc, const char *drum)
{
    for (int i = 0; i < osc->drums; i++)
        if (strcmp(osc->drum[i].name, drum) == 0)
            return osc->drum[i].hz;
    return 110;
}

static void send_strike(himc_osc *osc, const osc_record *r, osc_packets *p)
{
    const himc_strike *s = &r->strike.strike;
    // a float's time is exact to 1 ms for two hours only; whole and fraction are for half a year
    double whole = floor(s->time);
    himc_osc_pack(p, "/himc/strike", "fssfffffsiif", s->time, himc_hand_name(s->hand), s->drum,
                  s->x, s->y, s->velocity, s->force, s->duration, s->nuance, (int)r->strike.number,
                  (int)whole, s->time - whole);
    osc_packets vmc;
    himc_osc_pack_begin(&vmc, SMALL_PACKET, true, r->wall);
    himc_osc_vmc_strike(&vmc, s, principal(osc, s->drum));
    for (int i = 0; i < SUBSCRIBERS; i++)
        if (osc->subscriber[i].used && osc->subscriber[i].what == OSC_STRIKES)
            send_packets(osc, &osc->subscriber[i].to, p);
        else if (osc->subscriber[i].used && osc->subscriber[i].what == OSC_VMC)
            send_packets(osc, &osc->subscriber[i].to, &vmc);
}

static void send_head(himc_osc *osc, const osc_head *head, osc_packets *p)
{
    char path[64];
    lo_message message = lo_message_new();
    if (!message)
        return;
    for (int i = 0; i < head->count; i++)
        lo_message_add_float(message, head->amplitude[i]);
    snprintf(path, sizeof path, "/membrane/%s/head", head->name);
    himc_osc_pack_message(p, path, message);
    lo_message_free(message);
    double now = himc_osc_clock(CLOCK_MONOTONIC);
    for (osc_subscriber *s = osc->subscriber; s < osc->subscriber + SUBSCRIBERS; s++) {
        if (!s->used || s->what != OSC_HEAD)
            continue;
        // heads of several drums come together; each is due when the first is
        bool first = head->name[0] && strcmp(osc->drum[0].name, head->name) == 0;
        if (first ? himc_osc_due(s, now) : now + 0.4 / s->hz < s->due)
            send_packets(osc, &s->to, p);
    }
}

static void send_drum(himc_osc *osc, const osc_drum *drum, osc_packets *p)
{
    char path[64];
    int i = 0;
    while (i < osc->drums && strcmp(osc->drum[i].name, drum->name) != 0)
        i++;
    if (i == HIMC_DRUMS)
        return;
    osc->drums += i == osc->drums;
    osc->drum[i] = *drum;
    snprintf(path, sizeof path, "/membrane/%s/place", drum->name);
    himc_osc_pack(p, path, "fffff", drum->place[0], drum->place[1], drum->place[2], drum->place[3],
                  drum->place[4]);
    send_to_leads(osc, p);
}

static void send_state(himc_osc *osc, const osc_state *state, osc_packets *p)
{
    const himc_performance_stats *s = &state->stats;
    himc_osc_counts c = himc_osc_count(osc);
    const struct {
        const char *name;
        double value;
    } pair[] = {{"sound", s->sample_rate},
                {"physics", s->physics_rate},
                {"task", s->task_rate},
                {"load", state->load},
                {"seconds", s->seconds},
                {"strokes", s->strokes},
                {"played", s->played},
                {"strikes", (double)state->strikes},
                {"recoveries", (double)s->recoveries},
                {"limit_hits", (double)s->limit_hits},
                {"packets", (double)c.packets},
                {"commands", (double)c.commands},
                {"malformed", (double)c.malformed},
                {"foreign", (double)c.foreign},
                {"refused", (double)c.refused},
                {"frequent", (double)c.frequent},
                {"overrun", (double)c.overrun},
                {"sent", (double)c.sent},
                {"unsent", (double)c.unsent},
                {"lost", (double)c.lost}};
    lo_message message = lo_message_new();
    if (!message)
        return;
    for (size_t i = 0; i < sizeof pair / sizeof *pair; i++) {
        lo_message_add_string(message, pair[i].name);
        lo_message_add_float(message, (float)pair[i].value);
    }
    himc_osc_pack_message(p, "/himc/status", message);
    lo_message_free(message);
    send_to_leads(osc, p);
}

void himc_osc_send_record(himc_osc *osc, const osc_record *r)
{
    osc_packets p;
    himc_osc_pack_begin(&p, SMALL_PACKET, true, r->wall);
    switch (r->kind) {
    case RECORD_POSE: send_pose(osc, r); break;
    case RECORD_STRIKE: send_strike(osc, r, &p); break;
    case RECORD_BEAT:
        himc_osc_pack(&p, "/himc/beat", "f", r->beat);
        send_to_leads(osc, &p);
        break;
    case RECORD_HEAD: send_head(osc, &r->head, &p); break;
    case RECORD_DRUM: send_drum(osc, &r->drum, &p); break;
    case RECORD_STATE: send_state(osc, &r->state, &p); break;
    case RECORD_ANSWER: himc_osc_answer(osc, &r->answer.to, r->answer.error, r->answer.text); break;
    case RECORD_WISH: himc_osc_wish(osc, &r->wish); break;
    }
}
