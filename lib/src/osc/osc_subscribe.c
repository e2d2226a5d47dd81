/// osc_subscribe.c: who gets what, how often; who may ask for it.
///
/// Over the network a host may subscribe itself, or one of `allow`, and names numbers only, so that
/// no stranger can make this machine ask a name server; the user of this machine may name anybody.
/// An address where nobody listens is tried once a second and forgotten after a minute, with one
/// line each.
#define _POSIX_C_SOURCE 200809L
#include "osc/osc_state.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#define PATIENCE 60.0 // (s)
#define DEFAULT_HZ 33.0

bool himc_osc_wish_from(osc_wish *wish, const himc_command *c)
{
    enum { WITH_PORT, VMC }; // the forms of both commands
    if (c->id != HIMC_COMMAND_SUBSCRIBE && c->id != HIMC_COMMAND_UNSUBSCRIBE)
        return false;
    int next = c->form == VMC ? 1 : 2;
    snprintf(wish->host, sizeof wish->host, "%s", c->atom[0].symbol);
    wish->port = c->form == VMC ? HIMC_VMC_PORT : (int)c->atom[1].number;
    wish->what = OSC_WHATS;
    if (next < c->count && c->choice[next] >= 0)
        wish->what = c->form == VMC ? OSC_VMC : (osc_what)c->choice[next];
    if (wish->what != OSC_WHATS)
        next++;
    wish->hz = next < c->count ? c->atom[next].number : DEFAULT_HZ;
    wish->remove = c->id == HIMC_COMMAND_UNSUBSCRIBE;
    return true;
}

// tells whoever asked
static void refuse(himc_osc *osc, const osc_wish *wish, const char *why)
{
    char line[HIMC_OSC_LINE];
    snprintf(
        line, sizeof line, "%s: %.200s port %d: %s",
        himc_command_table(wish->remove ? HIMC_COMMAND_UNSUBSCRIBE : HIMC_COMMAND_SUBSCRIBE)->name,
        wish->host, wish->port, why);
    osc_counted(osc, COUNT_REFUSED, 1);
    if (wish->local)
        himc_osc_tell(osc, "%s", line);
    else
        himc_osc_answer(osc, &wish->from, true, line);
}

static bool is_allowed(const himc_osc *osc, const osc_wish *wish, const osc_address *to)
{
    bool good = wish->local || himc_osc_address_same_host(to, &wish->from);
    for (int i = 0; i < osc->allowed_count && !good; i++)
        good = himc_osc_address_same_host(to, &osc->allowed[i]);
    return good;
}

void himc_osc_wish(himc_osc *osc, const osc_wish *wish)
{
    osc_address to;
    if (wish->granted) {
        himc_osc_grant(osc, wish, &wish->from);
    } else if (himc_osc_address_parse(wish->host, wish->port, &to)) {
        if (is_allowed(osc, wish, &to))
            himc_osc_grant(osc, wish, &to);
        else
            refuse(osc, wish, "allowed is your own address, or one given by --allow");
    } else if (!wish->local) {
        refuse(osc, wish, "allowed over the network is a numeric address");
    } else if (!himc_osc_resolve(osc, wish)) {
        refuse(osc, wish, "too many names are being looked up");
    }
}

// what the table as a whole asks of the host, and who leads each address
static void take_stock(himc_osc *osc)
{
    double pose = 0, head = 0;
    long count = 0;
    for (int i = 0; i < SUBSCRIBERS; i++) {
        osc_subscriber *s = &osc->subscriber[i];
        s->lead = s->used && s->what != OSC_VMC;
        for (int k = 0; k < i && s->lead; k++)
            s->lead =
                !(osc->subscriber[k].lead && himc_osc_address_same(&osc->subscriber[k].to, &s->to));
        if (!s->used)
            continue;
        count++;
        if (s->what == OSC_HEAD)
            head = fmax(head, s->hz);
        else if (s->what != OSC_STRIKES)
            pose = fmax(pose, s->hz);
    }
    atomic_store(&osc->pose_hz, (int)ceil(pose));
    atomic_store(&osc->head_hz, (int)ceil(head));
    atomic_store(&osc->count[COUNT_SUBSCRIPTIONS], count);
}

static void remove_all(himc_osc *osc, const osc_wish *wish, const osc_address *to)
{
    int removed = 0;
    for (osc_subscriber *s = osc->subscriber; s < osc->subscriber + SUBSCRIBERS; s++)
        if (s->used && (wish->what == OSC_WHATS || s->what == wish->what) &&
            himc_osc_address_same(&s->to, to)) {
            s->used = false;
            removed++;
        }
    if (!removed)
        refuse(osc, wish, "not subscribed");
}

void himc_osc_grant(himc_osc *osc, const osc_wish *wish, const osc_address *to)
{
    osc_subscriber *place = NULL;
    if (wish->remove) {
        remove_all(osc, wish, to);
        take_stock(osc);
        return;
    }
    for (osc_subscriber *s = osc->subscriber; s < osc->subscriber + SUBSCRIBERS; s++) {
        if (s->used && s->what == wish->what && himc_osc_address_same(&s->to, to)) {
            place = s;
            break;
        }
        if (!s->used && !place)
            place = s;
    }
    if (!place) {
        refuse(osc, wish, "256 subscriptions already, allowed no more");
        return;
    }
    *place = (osc_subscriber){.used = true,
                              .to = *to,
                              .what = wish->what,
                              .hz = wish->hz,
                              .local = himc_osc_address_loopback(to)};
    take_stock(osc);
}

bool himc_osc_due(osc_subscriber *s, double now)
{
    if (now < s->due)
        return false;
    double period = s->refused_since > 0 ? 1 : 1 / s->hz;
    // half a period of tolerance, so that two clocks of the same rate do not beat
    s->due = fmax(s->due + period, now + 0.5 * period);
    return true;
}

void himc_osc_refused(himc_osc *osc, const osc_address *to)
{
    char text[80];
    bool told = false;
    double now = himc_osc_clock(CLOCK_MONOTONIC);
    for (osc_subscriber *s = osc->subscriber; s < osc->subscriber + SUBSCRIBERS; s++) {
        if (!s->used || !himc_osc_address_same(&s->to, to))
            continue;
        told = told || s->refused_since > 0;
        if (s->refused_since <= 0)
            s->refused_since = now;
        s->refused_last = now;
        s->due = fmax(s->due, now + 1);
        if (told)
            continue;
        himc_osc_address_print(to, text);
        himc_osc_tell(
            osc,
            "%s: not to be reached, or nobody listens; tried once a second, forgotten after %g s",
            text, PATIENCE);
        told = true;
    }
}

// if for 2.5 s no packet has come back, somebody listens again
void himc_osc_forget_gone(himc_osc *osc, double now)
{
    bool any = false;
    for (osc_subscriber *s = osc->subscriber; s < osc->subscriber + SUBSCRIBERS; s++) {
        if (!s->used || s->refused_since <= 0)
            continue;
        if (now - s->refused_since > PATIENCE) {
            s->used = false;
            any = true;
        } else if (now - s->refused_last > 2.5) {
            s->refused_since = 0;
        }
    }
    if (any)
        take_stock(osc);
}

int himc_osc_allowed_hosts(himc_osc *osc, const char *list, himc_error *error)
{
    int count = 0;
    while (list && *list) {
        char host[256];
        size_t n = strcspn(list, ",");
        snprintf(host, sizeof host, "%.*s", (int)n, list);
        if (count == ALLOWED || n >= sizeof host ||
            (!himc_osc_address_parse(host, 1, &osc->allowed[count]) &&
             !himc_osc_address_find(host, 1, &osc->allowed[count]))) {
            himc_error_set(error,
                           count == ALLOWED ? "allow: %s is one host too many, allowed 32"
                                            : "allow: %s: no host of that name",
                           host);
            return -1;
        }
        count++;
        list += n + (list[n] == ',');
    }
    return count;
}
