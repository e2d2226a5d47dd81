/// mxl.c: compressed MusicXML: an archive of the kind ZIP (APPNOTE.TXT 6.3), read from memory.
///
/// The directory stands at the end of the archive, found by its signature; each entry there gives a
/// name, both sizes and where the entry begins. Stored and deflated entries are read, by zlib, into
/// as many bytes as the directory says, never more. Invariant: nothing outside `bytes` is read.
#include "musicxml/mxl.h"

#include "musicxml/xml.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <zlib.h>

typedef struct archive {
    const uint8_t *bytes;
    size_t size;
} archive;

typedef struct entry {
    const char *name; ///< in the archive, not ended by 0
    size_t name_length, packed, length, at;
    unsigned method;
} entry;

bool himc_mxl_is_file(const void *bytes, size_t size)
{
    return size >= 4 && memcmp(bytes, "PK\3\4", 4) == 0;
}

// little-endian; 0 beyond the end
static size_t number(const archive *a, size_t at, int bytes)
{
    size_t n = 0;
    for (int i = bytes - 1; i >= 0; i--)
        n = n << 8 | (at + (size_t)i < a->size ? a->bytes[at + (size_t)i] : 0);
    return n;
}

// where the directory begins, and how many entries it has; false if there is none
static bool find_directory(const archive *a, size_t *at, size_t *count)
{
    const size_t end = 22, comment = 65535; // bytes of the directory's end, and most behind it
    for (size_t back = end; back <= a->size && back <= end + comment; back++)
        if (memcmp(a->bytes + a->size - back, "PK\5\6", 4) == 0) {
            *count = number(a, a->size - back + 10, 2);
            *at = number(a, a->size - back + 16, 4);
            return true;
        }
    return false;
}

// the entry of the directory at `*at`, which moves on; false if it is damaged
static bool next_entry(const archive *a, size_t *at, entry *e)
{
    const size_t head = 46;
    if (*at > a->size || a->size - *at < head || memcmp(a->bytes + *at, "PK\1\2", 4) != 0)
        return false;
    *e = (entry){(const char *)a->bytes + *at + head,
                 number(a, *at + 28, 2),
                 number(a, *at + 20, 4),
                 number(a, *at + 24, 4),
                 number(a, *at + 42, 4),
                 (unsigned)number(a, *at + 10, 2)};
    if (e->name_length > a->size - *at - head)
        return false;
    *at += head + e->name_length + number(a, *at + 30, 2) + number(a, *at + 32, 2);
    return true;
}

static bool is_named(const entry *e, const char *name)
{
    return e->name_length == strlen(name) && memcmp(e->name, name, e->name_length) == 0;
}

static bool ends_with(const entry *e, const char *ending)
{
    size_t length = strlen(ending);
    return e->name_length >= length &&
           strncasecmp(e->name + e->name_length - length, ending, length) == 0;
}

static bool find(const archive *a, const char *name, entry *e)
{
    size_t at, count;
    if (!find_directory(a, &at, &count))
        return false;
    for (size_t i = 0; i < count && next_entry(a, &at, e); i++) {
        bool score = ends_with(e, ".musicxml") || ends_with(e, ".xml");
        bool inside = e->name_length > 9 && memcmp(e->name, "META-INF/", 9) == 0;
        if (name ? is_named(e, name) : score && !inside)
            return true;
    }
    return false;
}

static char *unpack(const archive *a, const entry *e, size_t most, himc_error *error)
{
    enum { STORED = 0, DEFLATED = 8 };
    const size_t head = 30;
    size_t begin = e->at + head + number(a, e->at + 26, 2) + number(a, e->at + 28, 2);
    bool inside = e->at < a->size && begin <= a->size && e->packed <= a->size - begin;
    bool known = e->method == STORED ? e->packed == e->length : e->method == DEFLATED;
    char *made = NULL;
    if (e->length > most)
        himc_error_set(error, "a score of %zu bytes in the archive, expected up to %zu MiB",
                       e->length, most >> 20);
    else if (!inside || !known)
        himc_error_set(error, "a damaged archive, or one packed in a way that scores are not");
    else if (!(made = malloc(e->length + 1)))
        himc_error_set(error, "out of memory");
    if (!made)
        return NULL;
    z_stream z = {.next_in = (Bytef *)(uintptr_t)(a->bytes + begin),
                  .avail_in = (uInt)e->packed,
                  .next_out = (Bytef *)made,
                  .avail_out = (uInt)e->length};
    bool good = true;
    if (e->method == STORED) {
        memcpy(made, a->bytes + begin, e->length);
    } else {
        good = inflateInit2(&z, -MAX_WBITS) == Z_OK;
        good = good && inflate(&z, Z_FINISH) == Z_STREAM_END && z.total_out == e->length;
        inflateEnd(&z);
    }
    made[e->length] = '\0';
    if (good)
        return made;
    free(made);
    himc_error_set(error, "a damaged archive: its score cannot be unpacked");
    return NULL;
}

char *himc_mxl_score(const void *bytes, size_t size, size_t most, size_t *length, himc_error *error)
{
    archive a = {bytes, size};
    entry e;
    xml_document container = {0};
    const char *name = "";
    if (find(&a, "META-INF/container.xml", &e)) {
        char *text = unpack(&a, &e, most, error);
        bool good = text && himc_xml_read(&container, text, e.length, NULL, error);
        free(text);
        if (!good)
            return NULL;
        name = himc_xml_attribute(
            himc_xml_child(himc_xml_child(container.root, "rootfiles"), "rootfile"), "full-path");
    }
    bool found = (name[0] && find(&a, name, &e)) || find(&a, NULL, &e);
    himc_xml_free(&container);
    *length = found ? e.length : 0;
    if (found)
        return unpack(&a, &e, most, error);
    himc_error_set(error, "an archive without a score: no .musicxml and no .xml in it");
    return NULL;
}
