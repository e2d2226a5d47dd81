/// share.c: the page of viewer/page with everything inside.
///
/// Scripts are packed into one text, each after a line "NAME SIZE", deflated, and written as
/// base64; so are other files, and so is a scene, which is packed already. boot.js unpacks them. It
/// needs modules that import each other by name, so "./NAME.js" becomes "himc/NAME.js" there and an
/// import map says where that is.
#include "share.h"
#include "pages.h"
#include "scene.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { SCRIPTS = 64 }; // more than viewer/page has

/// Files, packed.
typedef struct pack {
    unsigned char *data;
    size_t size;
} pack;

static void put_base64(FILE *out, const unsigned char *from, size_t size)
{
    static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        size_t left = size - i;
        unsigned bits = (unsigned)from[i] << 16 | (left > 1 ? (unsigned)from[i + 1] << 8 : 0) |
                        (left > 2 ? from[i + 2] : 0);
        fputc(digit[bits >> 18], out);
        fputc(digit[bits >> 12 & 63], out);
        fputc(left > 1 ? digit[bits >> 6 & 63] : '=', out);
        fputc(left > 2 ? digit[bits & 63] : '=', out);
    }
}

static size_t length(const page *p)
{
    return (size_t)(p->end - p->begin);
}

static bool is_script(const page *p)
{
    return !strcmp(p->type, "text/javascript") && strcmp(p->path, "/boot.js") != 0;
}

// all files, one after the other; NULL without memory
static char *join(const share_file *file, int count, size_t *size)
{
    size_t room = 1, at = 0;
    for (int i = 0; i < count; i++)
        room += file[i].size + strlen(file[i].name) + 32;
    char *text = malloc(room);
    for (int i = 0; text && i < count; i++) {
        at += (size_t)snprintf(text + at, room - at, "%s %zu\n", file[i].name, file[i].size);
        memcpy(text + at, file[i].bytes, file[i].size);
        at += file[i].size;
    }
    *size = at;
    return text;
}

static bool pack_files(pack *out, const share_file *file, int count)
{
    size_t size;
    char *text = join(file, count, &size);
    uLongf packed = text ? compressBound((uLong)size) : 0;
    out->data = text ? malloc(packed) : NULL;
    bool good = out->data && compress2(out->data, &packed, (const unsigned char *)text, (uLong)size,
                                       Z_BEST_COMPRESSION) == Z_OK;
    out->size = packed;
    free(text);
    return good;
}

static bool pack_scripts(pack *out)
{
    share_file script[SCRIPTS];
    int count = 0;
    for (int i = 0; pages_at(i) && count < SCRIPTS; i++)
        if (is_script(pages_at(i)))
            script[count++] =
                (share_file){pages_at(i)->path + 1, pages_at(i)->begin, length(pages_at(i))};
    return pack_files(out, script, count);
}

static void put_file(FILE *out, const char *path, const char *before, const char *after)
{
    const page *p = pages_find(path);
    fputs(before, out);
    fwrite(p->begin, 1, length(p), out);
    fputs(after, out);
}

static void put_data(FILE *out, const char *id, const char *name, const void *from, size_t size)
{
    fprintf(out, "<script type=\"text/plain\" id=\"%s\" data-name=\"%s\">", id, name);
    put_base64(out, from, size);
    fputs("</script>\n", out);
}

// the page's lines, those that name another file replaced by the file
static void put_page(FILE *out, const pack *scripts, const char *id, const char *name,
                     const pack *what)
{
    const page *index = pages_find("/");
    for (const char *line = index->begin, *end; line < index->end; line = end) {
        end = memchr(line, '\n', (size_t)(index->end - line));
        end = end ? end + 1 : index->end;
        if (!strncmp(line, "<link rel=\"icon\"", 16))
            continue;
        if (!strncmp(line, "<link rel=\"stylesheet\"", 22))
            put_file(out, "/style.css", "<style>\n", "</style>\n");
        else if (!strncmp(line, "<script type=\"module\"", 21)) {
            put_data(out, "himc-scripts", "", scripts->data, scripts->size);
            put_data(out, id, name, what->data, what->size);
            put_file(out, "/boot.js", "<script>\n", "</script>\n");
        } else
            fwrite(line, 1, (size_t)(end - line), out);
    }
}

static bool write_page(FILE *out, const char *id, const char *name, const pack *what,
                       himc_error *error)
{
    pack scripts;
    char title[256];
    const char *slash = strrchr(name, '/');
    scene_word(title, sizeof title, slash ? slash + 1 : name);
    for (char *c = title; (c = strpbrk(c, "<>&\"")); c++)
        *c = '?';
    bool good = what->data && pack_scripts(&scripts);
    if (good) {
        put_page(out, &scripts, id, title, what);
        free(scripts.data);
    }
    return good || himc_error_set(error, "out of memory");
}

bool share_write(FILE *out, const char *bytes, size_t size, const char *name, himc_error *error)
{
    const pack what = {(unsigned char *)bytes, size};
    return write_page(out, "himc-scene", name, &what, error);
}

bool share_write_files(FILE *out, const share_file *file, int count, himc_error *error)
{
    pack files = {0};
    pack_files(&files, file, count);
    bool good = write_page(out, "himc-files", "", &files, error);
    free(files.data);
    return good;
}
