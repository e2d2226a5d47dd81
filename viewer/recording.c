/// recording.c: the frame of a scene is checked before it is served, so that a wrong file is a line
/// in the terminal. The page (scene.js) checks what is in it.
#include "recording.h"
#include "base/file.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define MOST_BYTES ((size_t)512 << 20) // of a scene; chosen: some hours
enum { MAGIC = 7, VERSION = 1, HEAD = 8 };

static uint32_t number(const char *at)
{
    uint32_t value = 0;
    for (int i = 3; i >= 0; i--)
        value = value << 8 | (unsigned char)at[i];
    return value;
}

bool recording_check(const char *bytes, size_t size, const char *name, himc_error *error)
{
    if (size < HEAD || memcmp(bytes, "himcscn", MAGIC) != 0)
        return himc_error_set(error, "%.180s: not a scene (himc render --scene makes one)", name);
    if (bytes[MAGIC] != VERSION)
        return himc_error_set(error, "%.180s: version %d of scenes, this viewer reads %d", name,
                              (unsigned char)bytes[MAGIC], VERSION);
    size_t at = HEAD, chunks = 0;
    for (; at < size; chunks++) {
        if (size - at < HEAD || number(bytes + at + 4) > size - at - HEAD)
            return himc_error_set(error, "%.180s: cut short at byte %zu of %zu", name, at, size);
        at += HEAD + number(bytes + at + 4);
    }
    return chunks || himc_error_set(error, "%.180s: a scene without anything in it", name);
}

char *recording_load(const char *path, size_t *size, himc_error *error)
{
    char *bytes = himc_file_load(path, MOST_BYTES, size, error);
    if (bytes && recording_check(bytes, *size, path, error))
        return bytes;
    free(bytes);
    return NULL;
}
