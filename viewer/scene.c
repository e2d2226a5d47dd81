/// scene.c: tables of performers and drums by sender, and the ring of events.
///
/// A sender is an address and port (and a name, if its messages carry one), so that two performers
/// never mix and one that comes back from the same port is the same. A full table gives the place
/// of one that fell silent to a newcomer; as long as all speak, newcomers are refused and counted:
/// a storm from random ports changes nothing.
#include "scene.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define SPLIT 0.005 // pieces of a pose come within this (s)

static bool left(double heard, double now)
{
    return now - heard > SCENE_SILENCE;
}

// versions go on growing when a place changes hands, so that readers notice
static scene_performer *seat_performer(scene_performer *p, const char *key, double now)
{
    uint64_t version = p->version;
    *p = (scene_performer){.version = version, .heard = now};
    snprintf(p->key, sizeof p->key, "%s", key);
    return p;
}

scene_performer *scene_find_performer(scene *s, const char *key, double now)
{
    scene_performer *vacant = NULL;
    for (int i = 0; i < SCENE_PERFORMERS; i++) {
        scene_performer *p = &s->performer[i];
        if (strcmp(p->key, key) == 0) {
            p->heard = now;
            return p;
        }
        if ((!p->key[0] || left(p->heard, now)) && (!vacant || p->heard < vacant->heard))
            vacant = p;
    }
    if (vacant)
        return seat_performer(vacant, key, now);
    s->count.refused++;
    return NULL;
}

static scene_drum *seat_drum(scene_drum *d, const char *key, const char *name, double now)
{
    uint64_t version = d->version;
    *d = (scene_drum){.version = version, .heard = now};
    snprintf(d->key, sizeof d->key, "%s", key);
    snprintf(d->name, sizeof d->name, "%s", name);
    return d;
}

scene_drum *scene_find_drum(scene *s, const char *key, const char *name, double now)
{
    scene_drum *vacant = NULL;
    for (int i = 0; i < SCENE_DRUMS; i++) {
        scene_drum *d = &s->drum[i];
        if (strcmp(d->key, key) == 0 && strcmp(d->name, name) == 0) {
            d->heard = now;
            return d;
        }
        if ((!d->key[0] || left(d->heard, now)) && (!vacant || d->heard < vacant->heard))
            vacant = d;
    }
    if (vacant)
        return seat_drum(vacant, key, name, now);
    s->count.refused++;
    return NULL;
}

void scene_set_body(scene_performer *p, int segment, const float body[7], double now)
{
    uint32_t bit = UINT32_C(1) << segment;
    // a segment heard twice begins the next pose: the last one is as whole as it will get
    if (p->pending & bit) {
        p->version++;
        p->pending = 0;
    }
    if (!p->pending)
        p->begun = now;
    memcpy(p->body[segment], body, sizeof p->body[segment]);
    p->known |= bit;
    p->pending |= bit;
}

bool scene_settle(scene *s, double now)
{
    bool any = false;
    for (int i = 0; i < SCENE_PERFORMERS; i++) {
        scene_performer *p = &s->performer[i];
        if (!p->pending ||
            (p->pending != (UINT32_C(1) << SCENE_SEGMENTS) - 1 && now - p->begun < SPLIT))
            continue;
        p->pending = 0;
        p->version++;
        any = true;
    }
    return any;
}

bool scene_unsettled(const scene *s)
{
    for (int i = 0; i < SCENE_PERFORMERS; i++)
        if (s->performer[i].pending)
            return true;
    return false;
}

void scene_say(scene *s, double now, const char *format, ...)
{
    scene_event *e = &s->event[s->events % SCENE_EVENTS];
    va_list args;
    va_start(args, format);
    int length = vsnprintf(e->text, sizeof e->text, format, args);
    va_end(args);
    if (length < 0 || (size_t)length >= sizeof e->text)
        return; // half an object is none
    e->time = now;
    s->events++;
}
