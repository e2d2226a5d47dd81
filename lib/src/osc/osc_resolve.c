/// osc_resolve.c: names of hosts, which only the user of this machine may give. A name server may
/// take seconds, so each name has a short-lived thread; at most RESOLVERS at once. Thread and osc
/// share the lookup, and who leaves last frees it, so that nobody ever waits for a name.
#include "osc/osc_state.h"

#include <stdlib.h>
#include <string.h>

typedef struct osc_lookup {
    _Atomic int users; // 2: the thread and the osc
    _Atomic bool done;
    bool found;
    osc_wish wish;
    osc_address to;
} osc_lookup;

static void leave(osc_lookup *lookup)
{
    if (atomic_fetch_sub(&lookup->users, 1) == 1)
        free(lookup);
}

static void *look_up(void *object)
{
    osc_lookup *l = object;
    l->found = himc_osc_address_find(l->wish.host, l->wish.port, &l->to);
    atomic_store(&l->done, true);
    leave(l);
    return NULL;
}

bool himc_osc_resolve(himc_osc *osc, const osc_wish *wish)
{
    osc_resolver *r = osc->resolver;
    while (r < osc->resolver + RESOLVERS && r->used)
        r++;
    osc_lookup *l = r < osc->resolver + RESOLVERS ? calloc(1, sizeof *l) : NULL;
    pthread_t thread;
    if (!l)
        return false;
    l->users = 2;
    l->wish = *wish;
    if (pthread_create(&thread, NULL, look_up, l) != 0) {
        free(l);
        return false;
    }
    pthread_detach(thread);
    *r = (osc_resolver){true, l};
    return true;
}

void himc_osc_resolved(himc_osc *osc)
{
    for (osc_resolver *r = osc->resolver; r < osc->resolver + RESOLVERS; r++) {
        if (!r->used || !atomic_load(&r->lookup->done))
            continue;
        const osc_wish *wish = &r->lookup->wish;
        if (r->lookup->found)
            himc_osc_grant(osc, wish, &r->lookup->to);
        else
            himc_osc_tell(osc, "%s: %.200s: no host of that name",
                          wish->remove ? "unsubscribe" : "subscribe", wish->host);
        leave(r->lookup);
        r->used = false;
    }
}

void himc_osc_resolve_drop(himc_osc *osc)
{
    for (osc_resolver *r = osc->resolver; r < osc->resolver + RESOLVERS; r++)
        if (r->used)
            leave(r->lookup);
}
