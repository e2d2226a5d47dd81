/// packets.c: packets, bundles, messages.
///
/// Bundles are split here (OSC 1.0: "#bundle", a time tag, then size and element in turn) and liblo
/// decodes the messages. Messages act when they arrive; time tags are ignored. Invariant: the time
/// for a packet is at most proportional to its length, whatever it contains.
#include "packets.h"
#include "addresses.h"

#include <lo/lo.h>
#include <string.h>

#define DEEPEST 8 // bundle in a bundle; chosen: well-formed senders nest one or two

static void store_message(scene *s, const char *key, const char *data, size_t size, double now)
{
    int trouble = 0;
    lo_message message = lo_message_deserialise((void *)data, size, &trouble);
    s->count.messages++;
    if (!message) {
        s->count.malformed++;
        return;
    }
    // the data begins with the address; lo_message_deserialise has checked that it ends
    address_dispatch(s, key, data, message, now);
    lo_message_free(message);
}

static void store_element(scene *s, const char *key, const char *data, size_t size, double now,
                          int depth)
{
    if (size < 16 || memcmp(data, "#bundle", 8) != 0) {
        store_message(s, key, data, size, now);
        return;
    }
    for (size_t at = 16; at < size;) {
        uint32_t length = 0;
        if (size - at >= 4)
            length = (uint32_t)(uint8_t)data[at] << 24 | (uint32_t)(uint8_t)data[at + 1] << 16 |
                     (uint32_t)(uint8_t)data[at + 2] << 8 | (uint8_t)data[at + 3];
        at += 4;
        if (length == 0 || length % 4 || at > size || length > size - at || depth == DEEPEST) {
            s->count.malformed++;
            return;
        }
        store_element(s, key, data + at, length, now, depth + 1);
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
    store_element(s, key, packet, size, now, 0);
}
