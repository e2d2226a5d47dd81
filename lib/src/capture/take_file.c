/// take_file.c: takes in files: loading and saving, by the suffix of the name.
///
/// A file is read as a whole; the reader of its format fills a take in the file's own unit and
/// axes, and himc_take_settle converts it. Invariant: a file that could not be written completely
/// is removed.
#define _POSIX_C_SOURCE 200809L
#include "base/file.h"
#include "base/array.h"
#include "capture/take.h"
#include "capture/take_text.h"

#include <stdlib.h>
#include <string.h>

#define MOST_BYTES ((size_t)1 << 30) // chosen: thirty million positions as text

typedef struct format {
    const char *suffix, *begins;
    bool (*read)(himc_take *take, const void *bytes, size_t size, himc_error *error);
    bool (*write)(FILE *file, const himc_take *take, himc_error *error);
} format;

#define NOTHING(suffix, begins)
#define READ(suffix, begins) {"." #suffix, begins, himc_##suffix##_read, NULL},
#define BOTH(suffix, begins) {"." #suffix, begins, himc_##suffix##_read, himc_##suffix##_write},
static const format formats[] = {HIMC_TAKE_FORMATS(READ, BOTH)};
#define FORMATS (sizeof formats / sizeof *formats)

// captures that are not read, and the way out
static const struct {
    const char *suffix, *is, *do_this;
} refused[] = {
    {".asf", "an Acclaim skeleton", "convert it with its .amc to .bvh (Blender, amc2bvh)"},
    {".amc", "Acclaim motion", "convert it with its .asf to .bvh (Blender, amc2bvh)"},
    {".fbx", "Autodesk FBX", "import it into Blender and export .bvh"},
    {".glb", "a glTF animation", "import it into Blender and export .bvh"},
    {".gltf", "a glTF animation", "import it into Blender and export .bvh"},
    {".usd", "a USD stage", "import it into Blender and export .bvh"},
    {".mot", "OpenSim motion: joint angles without their model", "export markers as .trc"},
    {".sto", "an OpenSim storage", "export markers as .trc"},
    {".qtm", "a Qualisys measurement", "File > Export > to C3D or to TSV in QTM"},
    {".tak", "a Motive take", "File > Export > C3D, BVH or TRC in Motive"},
    {".mvn", "an Xsens recording", "export .c3d or .bvh in MVN"},
    {".mvnx", "an Xsens recording", "export .c3d or .bvh in MVN"},
    {".x1d", "raw Vicon data", "export .c3d or ASCII (.csv) in Nexus"},
    {".x2d", "raw Vicon data", "export .c3d or ASCII (.csv) in Nexus"},
    {".vsk", "a Vicon skeleton", "export .c3d or ASCII (.csv) in Nexus"},
    {".trb", "a binary Motion Analysis file", "export .trc"},
    {".htr", "Motion Analysis joint angles", "export .trc or .bvh"},
    {".mat", "a MATLAB file", "write a table to .csv: time,NAME_x_m,NAME_y_m,NAME_z_m,..."},
    {".xlsx", "a spreadsheet", "save it as .csv: time,NAME_x_m,NAME_y_m,NAME_z_m,..."},
};
#define REFUSED (sizeof refused / sizeof refused[0])

static bool ends_with(const char *path, const char *suffix)
{
    size_t n = strlen(path), m = strlen(suffix);
    return n >= m && himc_span_is((himc_span){path + n - m, m}, suffix);
}

static const format *find_format(const char *path)
{
    for (size_t i = 0; i < FORMATS; i++)
        if (ends_with(path, formats[i].suffix))
            return &formats[i];
    return NULL;
}

static const format *format_of(const char *path, himc_error *error)
{
    const format *found = find_format(path);
    if (found)
        return found;
    for (size_t i = 0; i < REFUSED; i++)
        if (ends_with(path, refused[i].suffix)) {
            himc_error_set(error, "%s: %s, which is not read: %s", path, refused[i].is,
                           refused[i].do_this);
            return NULL;
        }
    himc_error_set(error, "%s: not a take by its suffix, expected" HIMC_TAKE_SUFFIXES, path);
    return NULL;
}

const char *himc_take_suffix_of(const void *bytes, size_t size)
{
    const unsigned char *byte = bytes;
    for (const format *f = formats; f < formats + FORMATS; f++)
        for (const char *way = f->begins, *end; *way; way = end + (*end == '|')) {
            size_t same = 0;
            end = way + strcspn(way, "|");
            while (way + same < end && same < size &&
                   (way[same] == '\a' ? byte[same] < 8 : byte[same] == (unsigned char)way[same]))
                same++;
            if (way + same == end)
                return f->suffix;
        }
    return NULL;
}

bool himc_take_is_capture(const char *path)
{
    bool known = find_format(path);
    for (size_t i = 0; i < REFUSED; i++)
        known = known || ends_with(path, refused[i].suffix);
    return known;
}

bool himc_take_can_save(const char *path, himc_error *error)
{
    const format *f = find_format(path);
    return (f && f->write) ||
           himc_error_set(error,
                          "%s: a format that is not written, expected" HIMC_TAKE_FORMATS(
                              NOTHING, HIMC_TAKE_SUFFIX),
                          path);
}

#define FILE_ROOM (sizeof((himc_take *)0)->file)

// of a long path the end is kept, which distinguishes files
static void shorten_file(char file[FILE_ROOM], const char *name)
{
    size_t n = strlen(name), room = FILE_ROOM - 4;
    snprintf(file, FILE_ROOM, "%s%s", n > room ? "..." : "", n > room ? name + n - room : name);
}

bool himc_take_name_error(const char *name, himc_error *error)
{
    char file[FILE_ROOM];
    shorten_file(file, name);
    bool named = error && strncmp(error->text, file, strlen(file)) == 0;
    return named ? false : himc_error_prefix(error, "%s", name);
}

himc_take *himc_take_read(const void *bytes, size_t size, const char *name,
                          const himc_take_options *options, himc_error *error)
{
    himc_take_options usual = himc_take_default();
    options = options ? options : &usual;
    const format *f = format_of(name, error);
    if (!f ||
        (options->unit != 0 && !himc_check_range("unit", options->unit, 1e-6, 10, "m", error)) ||
        !himc_check_range("longest gap", options->longest_gap, 0, 10, "s", error))
        return NULL;
    himc_take *take = himc_new(sizeof *take, name, error);
    if (!take)
        return NULL;
    shorten_file(take->file, name);
    if (size == 0)
        himc_error_set(error, "%s: the file is empty", take->file);
    else if (f->read(take, bytes, size, error) &&
             himc_take_choose_subject(take, options->subject, error) &&
             himc_take_settle(take, options, error))
        return take;
    himc_take_free(take);
    return NULL;
}

himc_take *himc_take_load_in(const char *folder, const char *path, const himc_take_options *options,
                             himc_error *error)
{
    if (!format_of(path, error))
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
    if (!himc_take_can_save(path, error))
        return false;
    himc_file_draft draft;
    if (!himc_file_draft_open(&draft, path, error))
        return false;
    if (find_format(path)->write(draft.stream, take, error))
        return himc_file_draft_close(&draft, error) && himc_file_draft_keep(&draft, error);
    himc_file_draft_drop(&draft);
    return false;
}
