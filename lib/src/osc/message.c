/// message.c: messages of OSC 1.0 (Wright 2002). Numbers are big-endian; texts, type tags and blobs
/// end at a multiple of four bytes, filled up with zeros, a text with at least one.
#include "osc/message.h"

#include <string.h>

// bytes of a text with its zeros
static size_t padded(size_t length)
{
    return (length / 4 + 1) * 4;
}

void himc_osc_put32(unsigned char *at, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        at[i] = (unsigned char)(value >> (24 - 8 * i));
}

uint32_t himc_osc_get32(const char *at)
{
    const unsigned char *b = (const unsigned char *)at;
    return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
}

// --- writing

void himc_osc_message_begin(osc_message *m, const char *path)
{
    m->path = path;
    m->count = 0;
    m->used = 0;
    m->full = false;
}

// room for an atom, zeroed; NULL if there is none
static unsigned char *add(osc_message *m, char type, size_t size)
{
    m->full = m->full || m->count == OSC_MESSAGE_ATOMS || size > sizeof m->atoms - m->used;
    if (m->full)
        return NULL;
    unsigned char *at = memset(m->atoms + m->used, 0, size);
    m->types[m->count++] = type;
    m->used += size;
    return at;
}

void himc_osc_message_text(osc_message *m, const char *text)
{
    size_t length = strlen(text);
    unsigned char *at = add(m, 's', padded(length));
    if (at)
        memcpy(at, text, length);
}

static void add32(osc_message *m, char type, const void *value)
{
    uint32_t bits;
    unsigned char *at = add(m, type, 4);
    memcpy(&bits, value, sizeof bits);
    if (at)
        himc_osc_put32(at, bits);
}

void himc_osc_message_int(osc_message *m, int32_t value)
{
    add32(m, 'i', &value);
}

void himc_osc_message_float(osc_message *m, float value)
{
    add32(m, 'f', &value);
}

void himc_osc_message_bytes(osc_message *m, const unsigned char *bytes, size_t size)
{
    unsigned char *at = add(m, 'b', (size + 7) / 4 * 4);
    if (!at)
        return;
    himc_osc_put32(at, (uint32_t)size);
    memcpy(at + 4, bytes, size);
}

size_t himc_osc_message_size(const osc_message *m)
{
    return m->full ? 0 : padded(strlen(m->path)) + padded((size_t)m->count + 1) + m->used;
}

void himc_osc_message_write(const osc_message *m, unsigned char *out)
{
    size_t path = padded(strlen(m->path)), types = padded((size_t)m->count + 1);
    memset(out, 0, path + types);
    memcpy(out, m->path, strlen(m->path));
    out[path] = ',';
    memcpy(out + path + 1, m->types, (size_t)m->count);
    memcpy(out + path + types, m->atoms, m->used);
}

// --- reading

// `size`, if so many bytes are there, zeros from `used` on; else 0
static size_t filled_up(const char *at, size_t used, size_t size, size_t rest)
{
    if (size > rest)
        return 0;
    for (; used < size; used++)
        if (at[used])
            return 0;
    return size;
}

// bytes of the text that begins here; 0 if it does not end, or is not filled up with zeros
static size_t text_size(const char *at, size_t rest)
{
    const char *end = rest ? memchr(at, '\0', rest) : NULL;
    size_t length = end ? (size_t)(end - at) : 0;
    return end ? filled_up(at, length, padded(length), rest) : 0;
}

// bytes of an atom; false if that type is unknown or the atom ends too late
static bool atom_size(char type, const char *at, size_t rest, size_t *size)
{
    *size = 0;
    if (type == 'b') { // its length, then as many bytes, filled up
        size_t length = rest < 4 ? rest : himc_osc_get32(at);
        if (length < rest)
            *size = filled_up(at, 4 + length, (length + 7) / 4 * 4, rest);
    } else if (type == 's' || type == 'S') {
        *size = text_size(at, rest);
    } else if (strchr("ifmc", type)) {
        *size = 4;
    } else if (strchr("htd", type)) {
        *size = 8;
    } else {
        return strchr("TFNI", type);
    }
    return *size > 0 && *size <= rest;
}

// false if it is neither a number nor a word
static bool read_atom(char type, const char *at, himc_atom *atom)
{
    uint32_t bits = strchr("ifhd", type) ? himc_osc_get32(at) : 0;
    uint64_t wide = strchr("hd", type) ? (uint64_t)bits << 32 | himc_osc_get32(at + 4) : 0;
    float single;
    *atom = (himc_atom){HIMC_ATOM_NUMBER, 0, NULL};
    switch (type) {
    case 'i': atom->number = (int32_t)bits; return true;
    case 'h': atom->number = (double)(int64_t)wide; return true;
    case 'd': memcpy(&atom->number, &wide, sizeof wide); return true;
    case 'f':
        memcpy(&single, &bits, sizeof single);
        atom->number = (double)single;
        return true;
    case 's':
    case 'S': *atom = (himc_atom){HIMC_ATOM_SYMBOL, 0, at}; return true;
    default: return false;
    }
}

bool himc_osc_message_read(const char *data, size_t size, himc_atom *atom, int most, int *count,
                           bool *plain)
{
    size_t at = data[0] == '/' ? text_size(data, size) : 0, length;
    const char *type = data + at;
    if (at == 0 || !(length = text_size(type, size - at)) || *type++ != ',')
        return false;
    at += length;
    *count = 0;
    *plain = true;
    for (; *type; type++, at += length) {
        if (!atom_size(*type, data + at, size - at, &length))
            return false;
        if (*count < most)
            *plain = read_atom(*type, data + at, &atom[(*count)++]) && *plain;
    }
    return at == size;
}
