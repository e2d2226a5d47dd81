/// file.c: opens regular files and nothing else.
///
/// A FIFO waits for its other end, a device may never end, and both can take a file's name at any
/// time. So a name is opened without waiting (O_NONBLOCK, which has no effect on a regular file),
/// and the opened descriptor is asked for its kind, not the name. Invariant: a file is cut only
/// after it is known to be regular.
///
/// A draft is NAME.XXXXXX beside its final place, so that the rename stays on one file system and
/// is atomic.
///
/// A name from the network must stand for a file in a folder (himc_system_open_inside).
#define _POSIX_C_SOURCE 200809L // descriptors
#include "base/file.h"
#include "system/files.h"

#include <errno.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// opens without waiting and looks at what was opened. -1 with one line
static int open_regular(const char *path, int flags, himc_error *error)
{
    const char *fault = flags & O_CREAT ? "cannot be written" : "cannot be read";
    struct stat status, null;
    int file = himc_system_open(path, flags | O_BINARY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    int why = errno;
    bool known = file < 0 ? stat(path, &status) == 0 : fstat(file, &status) == 0;
    // what stands under the name instead of a regular file
    const char *kind = !known || S_ISREG(status.st_mode) ? NULL
                       : S_ISDIR(status.st_mode)         ? "a folder"
                       : S_ISFIFO(status.st_mode)        ? "a FIFO"
                       : S_ISSOCK(status.st_mode)        ? "a socket"
                                                         : "a device";
    bool nowhere = flags & O_CREAT && known && S_ISCHR(status.st_mode) &&
                   stat("/dev/null", &null) == 0 && status.st_rdev == null.st_rdev;
    if (file >= 0 && known && (!kind || nowhere))
        return file;
    if (file >= 0)
        close(file);
    if (kind)
        himc_error_set(error, "%s: %s: %s, expected a regular file", path, fault, kind);
    else
        himc_error_set(error, "%s: %s: %s", path, fault, strerror(why));
    return -1;
}

static FILE *stream_of(const char *path, int file, const char *mode, himc_error *error)
{
    FILE *stream = file < 0 ? NULL : fdopen(file, mode);
    if (!stream && file >= 0) {
        himc_error_set(error, "%s: %s", path, strerror(errno));
        close(file);
    }
    return stream;
}

FILE *himc_file_read(const char *path, himc_error *error)
{
    return stream_of(path, open_regular(path, O_RDONLY, error), "rb", error);
}

static bool cannot_write(const char *path, himc_error *error)
{
    return himc_error_set(error, "%s: cannot be written: %s", path, strerror(errno ? errno : EIO));
}

FILE *himc_file_write(const char *path, himc_file_write_mode mode, himc_error *error)
{
    bool replace = mode == HIMC_FILE_REPLACE;
    int flags = O_CREAT | (replace ? O_WRONLY : O_RDWR | O_APPEND);
    FILE *stream = stream_of(path, open_regular(path, flags, error), replace ? "wb" : "a+b", error);
    // cut last, when all else is there; a device cannot be cut, and has nothing to lose
    if (stream && replace && ftruncate(fileno(stream), 0) != 0 && errno != EINVAL) {
        cannot_write(path, error);
        fclose(stream);
        return NULL;
    }
    if (stream)
        rewind(stream);
    return stream;
}

// a new file, with the permissions of the one that it is to replace; -1 with errno
static int open_beside(himc_file_draft *draft, const struct stat *old)
{
    static atomic_uint made;
    int file = -1;
    // chosen: a hundred tries of a name that nobody has
    for (int tries = 0; file < 0 && tries < 100 && (tries == 0 || errno == EEXIST); tries++) {
        int length = snprintf(draft->temp, sizeof draft->temp, "%s.%06x", draft->path,
                              ((unsigned)getpid() * 0x9e37u + made++) & 0xffffffu);
        errno = ENAMETOOLONG;
        if (length < (int)sizeof draft->temp)
            file =
                himc_system_open(draft->temp, O_CREAT | O_EXCL | O_WRONLY | O_BINARY | O_CLOEXEC);
    }
    if (file < 0)
        draft->temp[0] = '\0';
    else if (old)
        fchmod(file, old->st_mode & 07777);
    return file;
}

bool himc_file_draft_open(himc_file_draft *draft, const char *path, himc_error *error)
{
    *draft = (himc_file_draft){0};
    struct stat old;
    bool exists = stat(path, &old) == 0;
    if (exists && !S_ISREG(old.st_mode)) {
        draft->stream = himc_file_write(path, HIMC_FILE_REPLACE, error);
        snprintf(draft->path, sizeof draft->path, "%s", path);
        return draft->stream != NULL;
    }
    char *real = exists ? himc_system_real_path(path) : himc_system_target(path);
    if (!real)
        return cannot_write(path, error);
    int length = snprintf(draft->path, sizeof draft->path, "%s", real);
    free(real);
    if (length >= (int)sizeof draft->path)
        return himc_error_set(error, "%.64s...: the name is too long, expected %zu bytes", path,
                              sizeof draft->path - 1);
    if (exists && access(draft->path, W_OK) != 0)
        return cannot_write(path, error);
    int file = open_beside(draft, exists ? &old : NULL);
    draft->stream = file < 0 ? NULL : fdopen(file, "wb");
    if (draft->stream)
        return true;
    cannot_write(path, error);
    if (file >= 0)
        close(file);
    himc_file_draft_drop(draft);
    return false;
}

bool himc_file_draft_close(himc_file_draft *draft, himc_error *error)
{
    if (!draft->stream)
        return true;
    errno = 0;
    bool bad = fflush(draft->stream) != 0 || ferror(draft->stream);
    bad |= fclose(draft->stream) != 0;
    draft->stream = NULL;
    if (!bad)
        return true;
    cannot_write(draft->path, error);
    himc_file_draft_drop(draft);
    return false;
}

bool himc_file_draft_keep(himc_file_draft *draft, himc_error *error)
{
    if (!draft->temp[0])
        return true;
    if (!himc_system_rename(draft->temp, draft->path)) {
        cannot_write(draft->path, error);
        himc_file_draft_drop(draft);
        return false;
    }
    draft->temp[0] = '\0';
    return true;
}

void himc_file_draft_drop(himc_file_draft *draft)
{
    if (draft->stream)
        fclose(draft->stream);
    draft->stream = NULL;
    if (draft->temp[0])
        unlink(draft->temp);
    draft->temp[0] = '\0';
}

char *himc_file_load_in(const char *folder, const char *path, size_t most, size_t *size,
                        himc_error *error)
{
    struct stat status;
    int file = folder ? himc_system_open_inside(folder, path) : open_regular(path, O_RDONLY, error);
    if (folder && (file < 0 || fstat(file, &status) != 0 || !S_ISREG(status.st_mode))) {
        if (file >= 0)
            close(file);
        himc_error_set(error, "%.200s: no such file in the folder given by --files", path);
        return NULL;
    }
    FILE *stream = stream_of(path, file, "rb", error);
    if (!stream)
        return NULL;
    bool known = fstat(file, &status) == 0 && status.st_size >= 0;
    // one byte more than the file, to meet its end; that of /proc say 0 and grow here
    size_t room = (known && (size_t)status.st_size < most ? (size_t)status.st_size : most) + 1;
    size_t used = 0, got;
    char *bytes = malloc(room + 1);
    errno = 0;
    while (bytes && used <= most && (got = fread(bytes + used, 1, room - used, stream)) > 0) {
        used += got;
        char *more = used < room ? bytes : realloc(bytes, (room *= 2) + 1);
        if (!more)
            free(bytes);
        bytes = more;
    }
    bool good = bytes && !ferror(stream);
    int why = errno;
    fclose(stream);
    if (good && used <= most) {
        bytes[used] = '\0';
        *size = used;
        return bytes;
    }
    if (good)
        himc_error_set(error, "%s: too long, expected %zu MiB", path, most >> 20);
    else
        himc_error_set(error, "%s: cannot be read: %s", path, strerror(why));
    free(bytes);
    return NULL;
}

char *himc_file_load(const char *path, size_t most, size_t *size, himc_error *error)
{
    return himc_file_load_in(NULL, path, most, size, error);
}

typedef struct write_job {
    himc_job job;
    const char *command; ///< borrowed, static
    char path[HIMC_PATH_SIZE];
    himc_text_lines lines; ///< owned
} write_job;

static bool write_lines(himc_job *job, himc_error *error)
{
    write_job *j = (write_job *)job;
    himc_file_draft draft;
    bool good = himc_file_draft_open(&draft, j->path, error);
    if (good)
        fwrite(j->lines.bytes, 1, j->lines.size, draft.stream);
    good = good && himc_file_draft_close(&draft, error) && himc_file_draft_keep(&draft, error);
    return good || himc_error_prefix(error, "%s", j->command);
}

static himc_job_state lines_written(himc_job *job, himc_error *error)
{
    (void)job, (void)error;
    return HIMC_JOB_DONE;
}

static void free_lines(himc_job *job)
{
    free(((write_job *)job)->lines.bytes);
    free(job);
}

himc_job *himc_file_write_job(const char *command, const char *path, himc_text_lines *lines,
                              himc_error *error)
{
    himc_job functions = {write_lines, lines_written, free_lines};
    write_job *j = NULL;
    size_t length = strlen(path);
    if (lines->failed)
        himc_error_set(error, "%s: out of memory", command);
    // an ending of its own, so that no other file is replaced by mistake
    else if (!himc_line_is_clean(path) || length <= 4 || strcmp(path + length - 4, ".txt") != 0)
        himc_error_set(error, "%s: FILE: %.80s, expected a name that ends with .txt", command,
                       path);
    else
        j = himc_job_new(sizeof *j, command, functions, error);
    if (!j) {
        free(lines->bytes);
        return NULL;
    }
    j->command = command;
    j->lines = *lines;
    snprintf(j->path, sizeof j->path, "%s", path);
    return &j->job;
}
