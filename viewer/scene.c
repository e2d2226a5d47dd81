/// scene.c: tables of performers and drums by sender, and the ring of events.
///
/// A sender is an address and port (and a name, if the messages have one), so two performers never
/// mix, and a performer that returns from the same port is the same. In a full table a new sender
/// gets the place of a silent one; while all send, new senders are refused and counted, so a flood
/// from random ports changes nothing.
#include "scene.h"
#include "base/line.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define POSE_TIMEOUT \
    0.005 // (s); chosen: above the delay between two packets, below the 30 ms between poses

static bool absent(double received, double now)
{
    return now - received > SCENE_SILENCE;
}

// the version grows on when a place gets a new owner, so that readers notice it
static scene_performer *place_performer(scene_performer *p, const char *key, double now)
{
    uint64_t version = p->version;
    *p = (scene_performer){.version = version, .received = now};
    snprintf(p->key, sizeof p->key, "%s", key);
    return p;
}

scene_performer *scene_find_performer(scene *s, const char *key, double now)
{
    scene_performer *vacant = NULL;
    for (int i = 0; i < SCENE_PERFORMERS; i++) {
        scene_performer *p = &s->performer[i];
        if (strcmp(p->key, key) == 0) {
            p->received = now;
            return p;
        }
        if ((!p->key[0] || absent(p->received, now)) && (!vacant || p->received < vacant->received))
            vacant = p;
    }
    if (vacant)
        return place_performer(vacant, key, now);
    s->count.refused++;
    return NULL;
}

static scene_drum *place_drum(scene_drum *d, const char *key, const char *name, double now)
{
    uint64_t version = d->version;
    *d = (scene_drum){.version = version, .received = now};
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
            d->received = now;
            return d;
        }
        if ((!d->key[0] || absent(d->received, now)) && (!vacant || d->received < vacant->received))
            vacant = d;
    }
    if (vacant)
        return place_drum(vacant, key, name, now);
    s->count.refused++;
    return NULL;
}

static void complete(scene_performer *p)
{
    memcpy(p->support, p->heard, sizeof p->support);
    memset(p->heard, 0, sizeof p->heard);
    p->pending = 0;
    p->version++;
}

void scene_set_support(scene_performer *p, const float support[SCENE_SUPPORT])
{
    memcpy(p->heard, support, sizeof p->heard);
}

void scene_set_body(scene_performer *p, int segment, const float body[7], scene_time time)
{
    uint32_t bit = UINT32_C(1) << segment;
    // a segment received twice begins the next pose: the last one will get no more parts
    if (p->pending & bit)
        complete(p);
    if (!p->pending)
        p->begun = time.now;
    p->told = time.told;
    memcpy(p->body[segment], body, sizeof p->body[segment]);
    p->known |= bit;
    p->pending |= bit;
}

bool scene_complete_poses(scene *s, double now)
{
    bool any = false;
    for (int i = 0; i < SCENE_PERFORMERS; i++) {
        scene_performer *p = &s->performer[i];
        if (!p->pending ||
            (p->pending != (UINT32_C(1) << SCENE_SEGMENTS) - 1 && now - p->begun < POSE_TIMEOUT))
            continue;
        complete(p);
        any = true;
    }
    return any;
}

bool scene_pose_pending(const scene *s)
{
    for (int i = 0; i < SCENE_PERFORMERS; i++)
        if (s->performer[i].pending)
            return true;
    return false;
}

void scene_word(char *out, size_t size, const char *from)
{
    snprintf(out, size, "%s", from);
    himc_line_clean(out);
    for (; (out += strcspn(out, "\"\\"))[0]; out++)
        *out = '?';
}

void scene_add_event(scene *s, double now, const char *format, ...)
{
    scene_event *e = &s->event[s->events % SCENE_EVENTS];
    va_list args;
    va_start(args, format);
    int length = vsnprintf(e->text, sizeof e->text, format, args);
    va_end(args);
    if (length < 0 || (size_t)length >= sizeof e->text)
        return; // a truncated object is useless
    e->time = now;
    s->events++;
}
