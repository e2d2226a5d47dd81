/// take_file.c: takes in files: loading and saving, by the suffix of the name.
///
/// A file is read as a whole; the reader of its format fills a take in the file's own unit and
/// axes, and himc_take_settle converts it. Invariant: a file that could not be written completely
/// is removed.
#define _POSIX_C_SOURCE 200809L
#include "base/file.h"
#include "capture/take.h"
#include "capture/take_text.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define MOST_BYTES ((size_t)1 << 30) // chosen: thirty million positions as text

typedef struct format {
    const char *suffix;
    bool (*read)(himc_take *take, const void *bytes, size_t size, himc_error *error);
    bool (*write)(FILE *file, const himc_take *take, himc_error *error);
} format;

static const format formats[] = {{".bvh", himc_bvh_read, himc_bvh_write},
                                 {".c3d", himc_c3d_read, himc_c3d_write},
                                 {".trc", himc_trc_read, himc_trc_write}};

static bool check_options(const himc_take_options *options, himc_error *error)
{
    if (options->unit != 0 && !himc_check_range("unit", options->unit, 1e-6, 10, "m", error))
        return false;
    return himc_check_range("longest gap", options->longest_gap, 0, 10, "s", error);
}

static const format *format_of(const char *path, himc_error *error)
{
    size_t n = strlen(path);
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++) {
        size_t m = strlen(formats[i].suffix);
        if (n >= m && himc_span_is((himc_span){path + n - m, m}, formats[i].suffix))
            return &formats[i];
    }
    himc_error_set(error, "%s: not a take by its suffix, allowed .bvh .c3d .trc", path);
    return NULL;
}

bool himc_take_is_format(const char *path, himc_error *error)
{
    return format_of(path, error) != NULL;
}

// of a long path the end is kept, which distinguishes files
static void set_file(himc_take *take, const char *name)
{
    size_t n = strlen(name), room = sizeof take->file - 4;
    snprintf(take->file, sizeof take->file, "%s%s", n > room ? "..." : "",
             n > room ? name + n - room : name);
}

himc_take *himc_take_read(const void *bytes, size_t size, const char *name,
                          const himc_take_options *options, himc_error *error)
{
    himc_take_options usual = himc_take_default();
    options = options ? options : &usual;
    const format *f = format_of(name, error);
    if (!f || !check_options(options, error))
        return NULL;
    himc_take *take = calloc(1, sizeof *take);
    if (!take) {
        himc_error_set(error, "%s: no memory", name);
        return NULL;
    }
    set_file(take, name);
    if (size == 0)
        himc_error_set(error, "%s: the file is empty", take->file);
    else if (f->read(take, bytes, size, error) && himc_take_settle(take, options, error))
        return take;
    himc_take_free(take);
    return NULL;
}

himc_take *himc_take_load_in(const char *folder, const char *path, const himc_take_options *options,
                             himc_error *error)
{
    if (!himc_take_is_format(path, error))
        return NULL;
    size_t size = 0;
    char *bytes = himc_file_load_in(folder, path, MOST_BYTES, &size, error);
    himc_take *take = bytes ? himc_take_read(bytes, size, path, options, error) : NULL;
    free(bytes);
    return take;
}

himc_take *himc_take_load(const char *path, const himc_take_options *options, himc_error *error)
{
    return himc_take_load_in(NULL, path, options, error);
}

bool himc_take_save(const himc_take *take, const char *path, himc_error *error)
{
    const format *f = format_of(path, error);
    if (!f)
        return false;
    FILE *file = himc_file_write(path, HIMC_FILE_REPLACE, error);
    if (!file)
        return false;
    errno = 0;
    bool good = f->write(file, take, error), lost = ferror(file);
    lost = fclose(file) != 0 || lost;
    if (good && lost)
        himc_error_set(error, "%s: cannot be written: %s", path, strerror(errno ? errno : EIO));
    if (!good || lost)
        remove(path);
    return good && !lost;
}
