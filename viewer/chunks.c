/// chunks.c: a chunk is four letters, its size (u32, little-endian) and so many bytes. What a chunk
/// is depends on its kind alone, never on bytes that stand in it: names of files and texts of
/// errors may hold any letters.
#include "chunks.h"

#include <string.h>

static bool is(const chunks *c, const char *kind)
{
    return memcmp(c->head, kind, 4) == 0;
}

static void begin(chunks *c)
{
    c->left = 0;
    for (int i = 7; i >= 4; i--)
        c->left = c->left << 8 | c->head[i];
    c->event_size = 0;
    c->keeps = is(c, "edit") && c->left < CHUNKS_EVENT;
    c->sounds |= is(c, "pcm ");
}

static void end(chunks *c)
{
    static const char failed[] = "{\"event\":\"failed\"";
    c->event[c->event_size] = 0;
    if (c->keeps && strncmp(c->event, failed, sizeof failed - 1) == 0)
        memcpy(c->failed, c->event, sizeof c->failed);
    c->head_size = 0;
}

static void take(chunks *c, const unsigned char *at, size_t size)
{
    if (c->keeps) {
        memcpy(c->event + c->event_size, at, size);
        c->event_size += size;
    }
    c->left -= size;
}

void chunks_follow(chunks *c, const void *bytes, size_t size)
{
    const unsigned char *at = bytes, *last = at + size;
    while (at < last) {
        if (c->head_size < sizeof c->head) {
            c->head[c->head_size++] = *at++;
            if (c->head_size < sizeof c->head)
                continue;
            begin(c);
        } else {
            size_t part = c->left < (size_t)(last - at) ? c->left : (size_t)(last - at);
            take(c, at, part);
            at += part;
        }
        if (c->left == 0)
            end(c);
    }
}
