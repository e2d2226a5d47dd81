/// chunks.h: follows what `himc edit` tells (docs/viewer.md), chunk by chunk, in whatever pieces it
/// is read.
#ifndef VIEWER_CHUNKS_H
#define VIEWER_CHUNKS_H

#include <stdbool.h>
#include <stddef.h>

#define CHUNKS_EVENT 960 ///< of an event that is kept, with its final 0 (bytes); chosen

/// What has been read. All zero: nothing.
typedef struct chunks {
    unsigned char head[8]; ///< kind and size of the present chunk
    size_t head_size;      ///< bytes of it that have come
    size_t left;           ///< bytes of the present chunk that are to come
    bool keeps;            ///< the present chunk is an event, short enough for `event`
    char event[CHUNKS_EVENT];
    size_t event_size;         ///< bytes of it that have come
    bool sounds;               ///< a part of the piece has been heard (`pcm `)
    char failed[CHUNKS_EVENT]; ///< the last event `failed`, as JSON; "" for none
} chunks;

/// Follows the next bytes.
void chunks_follow(chunks *c, const void *bytes, size_t size);

#endif
