/// recording.c: a scene is checked before it is served or shown, so that a wrong file is a line in
/// the terminal: its frame, and how much its chunks unpack to. The page (scene.js) holds the same
/// budget, and checks what the chunks say: a few bytes may stand for a thousand times as many, and
/// a count for more rows than there is memory.
#include "recording.h"
#include "base/file.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#define MOST_BYTES ((size_t)512 << 20)    // of a scene; chosen: some hours
#define LARGEST ((size_t)64 << 20)        // of an unpacked chunk (bytes), as in scene.js
#define MOST_UNPACKED (UINT64_C(1) << 32) // of all chunks (bytes), as in scene.js
#define MOST_ITEMS 8388608 // rows, frames and values, as in scene.js; chosen: 5 hours
#define FIRST_ROOM 65536   // for an unpacked chunk (bytes)
enum { MAGIC = 7, VERSION = 1, HEAD = 8, ROWS_HEAD = 20, FRAME_HEAD = 16 };

/// What is left while a scene is read, those in it included.
typedef struct reading {
    const char *name;
    const char *begin;
    uint64_t bytes;       // that may still be unpacked
    uint64_t items;       // that may still come
    unsigned char *chunk; // owned; the present one, unpacked
    size_t size, room;    // of `chunk`
    himc_error *error;
} reading;

static uint32_t number(const void *from)
{
    const unsigned char *at = from;
    return at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static bool refuse(const reading *r, const char *at, const char *why)
{
    return himc_error_set(r->error, "%.180s: %s at byte %zu", r->name, why,
                          (size_t)(at - r->begin));
}

static bool too_large(const reading *r, const char *at)
{
    return himc_error_set(r->error,
                          "%.180s: the chunk at byte %zu unpacks to more than %zu MiB, or all to "
                          "more than 4 GiB",
                          r->name, (size_t)(at - r->begin), LARGEST >> 20);
}

// the bytes of the chunk at `at`, unpacked
static bool unpack(reading *r, const char *at, uint32_t packed)
{
    uint64_t most = r->bytes < LARGEST ? r->bytes : LARGEST;
    z_stream z = {.next_in = (Bytef *)(at + HEAD), .avail_in = packed};
    int state = inflateInit(&z);
    bool open = state == Z_OK, memory = open;
    for (r->size = 0; state == Z_OK && r->size <= most;) {
        if (r->size == r->room) {
            size_t room = r->room ? 2 * r->room : FIRST_ROOM;
            unsigned char *more = realloc(r->chunk, room);
            if (!(memory = more))
                break;
            r->chunk = more;
            r->room = room;
        }
        z.next_out = r->chunk + r->size;
        z.avail_out = (uInt)(r->room - r->size);
        state = inflate(&z, Z_NO_FLUSH);
        r->size = r->room - z.avail_out;
    }
    if (open)
        inflateEnd(&z);
    if (!memory)
        return himc_error_set(r->error, "out of memory");
    if (r->size > most)
        return too_large(r, at);
    r->bytes -= r->size;
    return (state == Z_STREAM_END && z.avail_in == 0) || refuse(r, at, "faulty chunk");
}

static bool count(reading *r, uint64_t items)
{
    if (items > r->items)
        return himc_error_set(r->error,
                              "%.180s: more than %d rows, frames of heads and values of events",
                              r->name, MOST_ITEMS);
    r->items -= items;
    return true;
}

// of a list in JSON: each value but the first stands behind one of these
static uint64_t values(const unsigned char *text, size_t size)
{
    uint64_t found = 0;
    bool quoted = false;
    for (size_t i = 0; i < size; i++)
        if (text[i] == '"')
            quoted = !quoted;
        else if (quoted)
            i += text[i] == '\\';
        else
            found += text[i] == ',' || text[i] == '[' || text[i] == '{';
    return found;
}

// all of them have the same number of columns, `*columns` of the first one
static bool check_rows(reading *r, const char *at, uint32_t *columns)
{
    uint64_t rows = r->size < ROWS_HEAD ? 0 : number(r->chunk + 16);
    if (r->size < ROWS_HEAD || !count(r, rows))
        return r->size < ROWS_HEAD ? refuse(r, at, "faulty rows") : false;
    uint64_t rest = r->size - ROWS_HEAD, across = rows ? rest / 4 / rows : *columns;
    *columns = *columns ? *columns : (uint32_t)across;
    return (rest == 4 * rows * across && across == *columns && (across || !rows)) ||
           refuse(r, at, "faulty rows");
}

static bool check_heads(reading *r, const char *at)
{
    uint32_t frames = r->size < 4 ? 0 : number(r->chunk);
    size_t used = 4;
    if (!count(r, frames))
        return false;
    for (uint32_t i = 0; i < frames && used <= r->size; i++) {
        const unsigned char *frame = r->chunk + used;
        used += FRAME_HEAD;
        if (used <= r->size)
            used += 2 * (size_t)(frame[14] | frame[15] << 8);
    }
    return used <= r->size || refuse(r, at, "faulty motion of heads");
}

static bool check_scene(reading *r, const char *bytes, size_t size, bool inner);

static bool check_chunk(reading *r, const char *at, uint32_t size, uint32_t *columns, bool inner)
{
    if (!memcmp(at, "json", 4))
        return unpack(r, at, size) && count(r, values(r->chunk, r->size));
    if (!memcmp(at, "rows", 4))
        return unpack(r, at, size) && check_rows(r, at, columns);
    if (!memcmp(at, "ring", 4))
        return unpack(r, at, size) && check_heads(r, at);
    return inner || memcmp(at, "more", 4) != 0 || check_scene(r, at + HEAD, size, true);
}

static bool check_scene(reading *r, const char *bytes, size_t size, bool inner)
{
    uint32_t columns = 0;
    size_t at = HEAD, chunks = 0;
    if (size < HEAD || memcmp(bytes, "himcscn", MAGIC) != 0)
        return himc_error_set(r->error, "%.180s: not a scene (himc render --scene makes one)",
                              r->name);
    if (bytes[MAGIC] != VERSION)
        return himc_error_set(r->error, "%.180s: version %d of scenes, this viewer reads %d",
                              r->name, (unsigned char)bytes[MAGIC], VERSION);
    for (; at < size; chunks++) {
        if (size - at < HEAD || number(bytes + at + 4) > size - at - HEAD)
            return himc_error_set(r->error, "%.180s: cut short at byte %zu of %zu", r->name,
                                  (size_t)(bytes + at - r->begin),
                                  (size_t)(bytes + size - r->begin));
        uint32_t length = number(bytes + at + 4);
        if (!check_chunk(r, bytes + at, length, &columns, inner))
            return false;
        at += HEAD + length;
    }
    return chunks || himc_error_set(r->error, "%.180s: a scene without anything in it", r->name);
}

bool recording_check(const char *bytes, size_t size, const char *name, himc_error *error)
{
    reading r = {
        .name = name, .begin = bytes, .bytes = MOST_UNPACKED, .items = MOST_ITEMS, .error = error};
    bool good = check_scene(&r, bytes, size, false);
    free(r.chunk);
    return good;
}

char *recording_load(const char *path, size_t *size, himc_error *error)
{
    char *bytes = himc_file_load(path, MOST_BYTES, size, error);
    if (bytes && recording_check(bytes, *size, path, error))
        return bytes;
    free(bytes);
    return NULL;
}
