/// packets.c: packets, bundles, messages.
///
/// Bundles are split here (OSC 1.0: "#bundle", a time tag, then size and element in turn) and liblo
/// decodes the messages. Messages act when they arrive; the time tag goes with them, so that the
/// page can put in step what one sender tells of one moment (pose and sound). Invariant: the time
/// for a packet is at most proportional to its length, whatever it contains.
#include "packets.h"
#include "addresses.h"

#include <lo/lo.h>
#include <string.h>

#define DEEPEST 8               // bundle in a bundle; chosen: well-formed senders nest one or two
#define SINCE_1900 2208988800.0 // seconds of time tags at the beginning of 1970 (RFC 868)

static void store_message(scene *s, const char *key, const char *data, size_t size, scene_time time)
{
    int trouble = 0;
    lo_message message = lo_message_deserialise((void *)data, size, &trouble);
    s->count.messages++;
    if (!message) {
        s->count.malformed++;
        return;
    }
    // the data begins with the address; lo_message_deserialise has checked that it ends
    address_dispatch(s, key, data, message, time);
    lo_message_free(message);
}

static uint32_t word(const char *data)
{
    const uint8_t *b = (const uint8_t *)data;
    return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
}

static void store_element(scene *s, const char *key, const char *data, size_t size, scene_time time,
                          int depth)
{
    if (size < 16 || memcmp(data, "#bundle", 8) != 0) {
        store_message(s, key, data, size, time);
        return;
    }
    if (word(data + 8)) // else "immediately", 0x1
        time.told = (double)word(data + 8) - SINCE_1900 + word(data + 12) / 4294967296.0;
    for (size_t at = 16; at < size;) {
        uint32_t length = 0;
        if (size - at >= 4)
            length = word(data + at);
        at += 4;
        if (length == 0 || length % 4 || at > size || length > size - at || depth == DEEPEST) {
            s->count.malformed++;
            return;
        }
        store_element(s, key, data + at, length, time, depth + 1);
        at += length;
    }
}

void packets_store(scene *s, const char *key, const void *packet, size_t size, double now)
{
    s->count.packets++;
    s->count.bytes += size;
    if (size < 8 || size % 4) {
        s->count.malformed++;
        return;
    }
    store_element(s, key, packet, size, (scene_time){now, now}, 0);
}
