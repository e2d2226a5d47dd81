/// take.c: from a file to a take: reads the bytes, lets the format's reader fill a take in the
/// file's own unit and axes, then settles it into the library's frame.
///
/// Invariants of a finished take: frames and points >= 1, every coordinate finite or the whole
/// point NaN (a gap), every name at least one printable character, parents before children. Counts
/// in a file are never trusted: readers compare them with the bytes there are before anything is
/// allocated, and himc_take_allocate caps the product.
#define _POSIX_C_SOURCE 200809L
#include "capture/take_data.h"
#include "capture/take_text.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define MOST_FRAMES 1000000
#define MOST_POINT_FRAMES 30000000
#define MOST_POINTS 65536
#define MOST_BYTES (1L << 30)

himc_take_options himc_take_default(void)
{
    return (himc_take_options){.up = HIMC_UP_AUTO, .longest_gap = 0.2};
}

static bool check_options(const himc_take_options *options, himc_error *error)
{
    if (options->unit != 0 && !himc_check_range("unit", options->unit, 1e-6, 10, "m", error))
        return false;
    return himc_check_range("longest gap", options->longest_gap, 0, 10, "s", error);
}

bool himc_take_allocate(himc_take *take, double rate, int frames, int points, bool skeleton,
                        himc_error *error)
{
    if (!himc_check_range("rate", rate, 20, 10000, "Hz", error) ||
        !himc_check_range("frames", frames, 1, MOST_FRAMES, "", error) ||
        !himc_check_range("points", points, 1, MOST_POINTS, "", error))
        return himc_error_prefix(error, "%s", take->file);
    if ((int64_t)frames * points > MOST_POINT_FRAMES)
        return himc_error_set(error, "%s: %d frames of %d points, allowed %d in all", take->file,
                              frames, points, MOST_POINT_FRAMES);
    size_t count = (size_t)points, all = count * (size_t)frames;
    take->rate = rate;
    take->frames = frames;
    take->points = points;
    take->names = calloc(count, sizeof *take->names);
    take->x = calloc(all, sizeof *take->x);
    if (skeleton) {
        take->parents = calloc(count, sizeof *take->parents);
        take->offsets = calloc(count, sizeof *take->offsets);
        take->rotations = calloc(all, sizeof *take->rotations);
    }
    if (take->names && take->x &&
        (!skeleton || (take->parents && take->offsets && take->rotations)))
        return true;
    return himc_error_set(error, "%s: no memory for %d frames of %d points", take->file, frames,
                          points);
}

void himc_take_free(himc_take *take)
{
    if (!take)
        return;
    free(take->names);
    free(take->x);
    free(take->parents);
    free(take->offsets);
    free(take->rotations);
    free(take->events);
    free(take->tip[HIMC_LEFT]);
    free(take->tip[HIMC_RIGHT]);
    free(take);
}

void himc_take_set_name(himc_take *take, int point, const char *name, size_t length)
{
    himc_span span = himc_span_trim((himc_span){name, length});
    char *to = take->names[point];
    size_t n = 0;
    for (size_t i = 0; i < span.length && n < TAKE_NAME - 1; i++)
        if (span.at[i] >= ' ' && span.at[i] <= '~')
            to[n++] = span.at[i];
    to[n] = 0;
    if (n == 0)
        snprintf(to, TAKE_NAME, "P%d", point + 1);
}

void himc_take_note(himc_take *take, const char *format, ...)
{
    if (take->note_count >= TAKE_NOTES)
        return;
    va_list args;
    va_start(args, format);
    vsnprintf(take->notes[take->note_count++], sizeof take->notes[0], format, args);
    va_end(args);
}

static bool has_suffix(const char *name, const char *suffix)
{
    size_t n = strlen(name), m = strlen(suffix);
    return n >= m && himc_span_is((himc_span){name + n - m, m}, suffix);
}

static bool is_format_known(const char *name, himc_error *error)
{
    if (has_suffix(name, ".bvh") || has_suffix(name, ".c3d") || has_suffix(name, ".trc"))
        return true;
    return himc_error_set(error, "%s: not a take by its name, allowed .bvh .c3d .trc", name);
}

static bool read_format(himc_take *take, const void *bytes, size_t size, const char *name,
                        himc_error *error)
{
    if (size == 0)
        return himc_error_set(error, "%s: the file is empty", take->file);
    if (has_suffix(name, ".bvh"))
        return himc_bvh_read(take, bytes, size, error);
    if (has_suffix(name, ".c3d"))
        return himc_c3d_read(take, bytes, size, error);
    return himc_trc_read(take, bytes, size, error);
}

// a long path keeps its end, which tells files apart
static void set_file(himc_take *take, const char *name)
{
    size_t n = strlen(name), room = sizeof take->file - 4;
    snprintf(take->file, sizeof take->file, "%s%s", n > room ? "..." : "",
             n > room ? name + n - room : name);
}

// names from a file may hold anything, an error is one line of printable characters
static void keep_one_line(himc_error *error)
{
    for (char *c = error ? error->text : NULL; c && *c; c++)
        if ((unsigned char)*c < ' ' || *c == 127)
            *c = '?';
}

himc_take *himc_take_read(const void *bytes, size_t size, const char *name,
                          const himc_take_options *options, himc_error *error)
{
    himc_take_options usual = himc_take_default();
    options = options ? options : &usual;
    if (!is_format_known(name, error) || !check_options(options, error))
        return NULL;
    himc_take *take = calloc(1, sizeof *take);
    if (!take) {
        himc_error_set(error, "%s: no memory", name);
        return NULL;
    }
    set_file(take, name);
    if (read_format(take, bytes, size, name, error) && himc_take_settle(take, options, error))
        return take;
    himc_take_free(take);
    keep_one_line(error);
    return NULL;
}

// the whole file, to be freed; NULL with errno
static void *read_file(const char *path, size_t *size)
{
    struct stat status;
    if (stat(path, &status) != 0)
        return NULL;
    if (!S_ISREG(status.st_mode) || status.st_size > MOST_BYTES) {
        errno = S_ISREG(status.st_mode) ? EFBIG : EINVAL;
        return NULL;
    }
    FILE *file = fopen(path, "rb");
    if (!file)
        return NULL;
    char *bytes = malloc((size_t)status.st_size + 1);
    errno = bytes ? 0 : ENOMEM;
    if (bytes) {
        *size = fread(bytes, 1, (size_t)status.st_size, file);
        if (ferror(file)) {
            free(bytes);
            bytes = NULL;
        }
    }
    int why = errno;
    fclose(file);
    errno = why;
    return bytes;
}

himc_take *himc_take_load(const char *path, const himc_take_options *options, himc_error *error)
{
    if (!is_format_known(path, error))
        return NULL;
    size_t size = 0;
    void *bytes = read_file(path, &size);
    if (!bytes) {
        const char *why = errno == EINVAL  ? "not a file"
                          : errno == EFBIG ? "larger than 1 GiB"
                                           : strerror(errno);
        himc_error_set(error, "%s: cannot be read: %s", path, why);
        return NULL;
    }
    himc_take *take = himc_take_read(bytes, size, path, options, error);
    free(bytes);
    return take;
}

double himc_take_rate(const himc_take *take)
{
    return take->rate;
}

int himc_take_frames(const himc_take *take)
{
    return take->frames;
}

int himc_take_first_frame(const himc_take *take)
{
    return take->first_frame;
}

int himc_take_points(const himc_take *take)
{
    return take->points;
}

const char *himc_take_point_name(const himc_take *take, int point)
{
    return take->names[point];
}

himc_vec3 himc_take_point(const himc_take *take, int frame, int point)
{
    return *himc_take_at(take, frame, point);
}

int himc_take_missing(const himc_take *take, int point)
{
    int count = 0;
    for (int frame = 0; frame < take->frames; frame++)
        count += !himc_vec3_finite(*himc_take_at(take, frame, point));
    return count;
}

int himc_take_events(const himc_take *take)
{
    return take->event_count;
}

const himc_take_event *himc_take_event_at(const himc_take *take, int index)
{
    return &take->events[index];
}

bool himc_take_has_skeleton(const himc_take *take)
{
    return take->parents != NULL;
}

int himc_take_parent(const himc_take *take, int point)
{
    return take->parents ? take->parents[point] : -1;
}

himc_vec3 himc_take_offset(const himc_take *take, int point)
{
    return take->offsets ? take->offsets[point] : himc_vec3_make(0, 0, 0);
}

himc_quat himc_take_rotation(const himc_take *take, int frame, int point)
{
    if (!take->rotations)
        return himc_quat_identity();
    return take->rotations[(size_t)frame * (size_t)take->points + (size_t)point];
}
