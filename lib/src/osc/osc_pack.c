/// osc_pack.c: messages into packets (OSC 1.0): each by liblo, several in a bundle with the time
/// they are of; a packet that would grow beyond its limit is closed and another begun, with the
/// same time.
#define _POSIX_C_SOURCE 200809L
#include "osc/osc_state.h"

#include <lo/lo.h>
#include <math.h>
#include <stdarg.h>
#include <string.h>

// NTP's time: seconds since 1900 above, their fraction below
uint64_t himc_osc_tag(double wall)
{
    double whole = floor(wall);
    return ((uint64_t)whole + 2208988800u) << 32 | (uint64_t)((wall - whole) * 4294967296.0);
}

static void put32(unsigned char *at, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        at[i] = (unsigned char)(value >> (24 - 8 * i));
}

void himc_osc_pack_begin(osc_packets *p, size_t limit, bool bundle, double wall)
{
    p->limit = limit;
    p->bundle = bundle;
    p->count = 0;
    p->tag = himc_osc_tag(wall);
}

static bool open_packet(osc_packets *p)
{
    if (p->count == PACKETS)
        return false;
    p->size[p->count] = 0;
    if (p->bundle) {
        unsigned char *at = p->data[p->count];
        memcpy(at, "#bundle", 8);
        put32(at + 8, (uint32_t)(p->tag >> 32));
        put32(at + 12, (uint32_t)p->tag);
        p->size[p->count] = 16;
    }
    p->count++;
    return true;
}

void himc_osc_pack_message(osc_packets *p, const char *path, void *message)
{
    size_t size = lo_message_length(message, path), frame = p->bundle ? 4 : 0;
    if (size + 20 > p->limit)
        return;
    if (p->count == 0 || !p->bundle || p->size[p->count - 1] + frame + size > p->limit)
        if (!open_packet(p))
            return;
    unsigned char *at = p->data[p->count - 1] + p->size[p->count - 1];
    if (p->bundle)
        put32(at, (uint32_t)size);
    lo_message_serialise(message, path, at + frame, NULL);
    p->size[p->count - 1] += frame + size;
}

void himc_osc_pack(osc_packets *p, const char *path, const char *types, ...)
{
    lo_message message = lo_message_new();
    if (!message)
        return;
    va_list args;
    va_start(args, types);
    for (; *types; types++) {
        if (*types == 's')
            lo_message_add_string(message, va_arg(args, const char *));
        else if (*types == 'i')
            lo_message_add_int32(message, va_arg(args, int));
        else
            lo_message_add_float(message, (float)va_arg(args, double));
    }
    va_end(args);
    himc_osc_pack_message(p, path, message);
    lo_message_free(message);
}
