/// edit_journal.c: a journal is the text before all changes, then a line for each change, undo and
/// redo, written when it is made. Whoever makes the same changes to the same text has what was
/// there, with its history.
///
/// A score's journal is `.NAME.himc-edit` in its folder; that of a file without a folder of its own
/// is `NAME-HASH.himc-edit` in $XDG_STATE_HOME/himc. Only the user may read it. It begins with
/// the first change, and one process holds it: POSIX locks are not inherited by the processes that
/// play. A line that was cut short has not been answered, so it is left out.
#define _XOPEN_SOURCE 700 // fcntl locks, realpath
#include "edit_journal.h"
#include "base/file.h"
#include "system/files.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define HEAD "himc edit 1 "
#define LARGEST ((size_t)128 << 20) // of a journal (bytes); chosen: twice a score
#define NAME_PART 100               // of a name in the folder for states (bytes); chosen
#define SCORES 100                  // kept beside a journal; chosen

uint64_t edit_hash(uint64_t sum, const void *bytes, size_t size)
{
    const unsigned char *b = bytes;
    for (size_t i = 0; i < size; i++)
        sum = (sum ^ b[i]) * UINT64_C(0x100000001b3); // FNV-1a
    return sum;
}

static bool hash_file(const char *path, uint64_t *sum, himc_error *error)
{
    char bytes[65536];
    FILE *file = himc_file_read(path, error);
    *sum = UINT64_C(0xcbf29ce484222325);
    for (size_t got; file && (got = fread(bytes, 1, sizeof bytes, file)) > 0;)
        *sum = edit_hash(*sum, bytes, got);
    return file && fclose(file) == 0;
}

#ifdef __wasi__ // a page keeps its files itself (viewer/page/workshop.js), and says who edits

static bool choose_path(edit_journal *j, const char *source, const char *name, bool sent,
                        himc_error *error)
{
    (void)source, (void)sent, (void)error;
    snprintf(j->path, sizeof j->path, "%.*s-%016" PRIx64 ".himc-edit", NAME_PART, name, j->hash);
    return true;
}

static bool open_own(const char *path, bool fresh, FILE **stream, himc_error *error)
{
    int file = himc_system_open(path, O_RDWR | (fresh ? O_CREAT | O_EXCL : 0));
    *stream = file < 0 ? NULL : fdopen(file, "r+b");
    return *stream || errno == (fresh ? EEXIST : ENOENT) ||
           himc_error_set(error, "%.300s: %s", path, strerror(errno));
}

static bool hold(edit_journal *j, bool fresh, himc_error *error)
{
    return open_own(j->path, fresh, &j->stream, error);
}

#else

enum { OURS_ONLY = 0700 };

// makes the folder and those it is in; true if it is there
static bool make_folders(char *path)
{
    for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = 0;
        mkdir(path, OURS_ONLY);
        *slash = '/';
    }
    return mkdir(path, OURS_ONLY) == 0 || errno == EEXIST;
}

static bool path_in_states(edit_journal *j, const char *name, uint64_t key, himc_error *error)
{
    const char *state = getenv("XDG_STATE_HOME"), *home = getenv("HOME");
    char folder[2048];
    if (state && state[0] == '/')
        snprintf(folder, sizeof folder, "%.1900s/himc", state);
    else if (home && home[0] == '/')
        snprintf(folder, sizeof folder, "%.1900s/.local/state/himc", home);
    else
        return himc_error_set(error, "no HOME");
    if (!make_folders(folder))
        return himc_error_set(error, "%.200s: %s", folder, strerror(errno));
    snprintf(j->path, sizeof j->path, "%s/%.*s-%016" PRIx64 ".himc-edit", folder, NAME_PART, name,
             key);
    return true;
}

static bool choose_path(edit_journal *j, const char *source, const char *name, bool sent,
                        himc_error *error)
{
    char *real = realpath(source, NULL), *slash = real ? strrchr(real, '/') : NULL;
    bool good = slash || himc_error_set(error, "%.200s: %s", source, strerror(errno));
    if (good) {
        *slash = 0;
        bool beside = !sent && access(real[0] ? real : "/", W_OK) == 0;
        if (beside)
            snprintf(j->path, sizeof j->path, "%.3700s/.%.255s.himc-edit", real, slash + 1);
        *slash = '/';
        if (!beside)
            good = path_in_states(
                j, sent ? name : slash + 1,
                sent ? j->hash : edit_hash(UINT64_C(0xcbf29ce484222325), real, strlen(real)),
                error);
    }
    free(real);
    return good;
}

// Opens a file of the user's for reading and adding; `fresh` makes it. The folder may be from
// somebody else: no link is followed, and nothing but a file of this user's under this one name is
// taken. True with *stream NULL if there is none, or, if it is to be made, something has the name.
static bool open_own(const char *path, bool fresh, FILE **stream, himc_error *error)
{
    struct stat status;
    mode_t mask = umask(077);
    int file = himc_system_open(path, O_RDWR | O_APPEND | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY |
                                          O_CLOEXEC | (fresh ? O_CREAT | O_EXCL : 0));
    int why = errno;
    umask(mask);
    *stream = NULL;
    if (file < 0 && why == (fresh ? EEXIST : ENOENT))
        return true;
    if (file < 0)
        return himc_error_set(error, "%.300s: %s", path,
                              why == ELOOP ? "a link, expected a file" : strerror(why));
    bool own = fstat(file, &status) == 0 && S_ISREG(status.st_mode) && status.st_uid == geteuid() &&
               status.st_nlink == 1;
    if (own && (*stream = fdopen(file, "a+b"))) {
        rewind(*stream);
        return true;
    }
    close(file);
    return himc_error_set(error, "%.300s: expected a file of this user alone, without other links",
                          path);
}

// opens the journal, which only this process may have open; true without a stream as open_own()
static bool hold(edit_journal *j, bool fresh, himc_error *error)
{
    struct flock lock = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    struct stat status;
    if (!open_own(j->path, fresh, &j->stream, error))
        return false;
    if (!j->stream)
        return true;
    if (fcntl(fileno(j->stream), F_SETLK, &lock) == 0 && fstat(fileno(j->stream), &status) == 0 &&
        status.st_nlink == 1) // the one that held it until now has not removed it
        return true;
    fclose(j->stream);
    j->stream = NULL;
    return himc_error_set(error, "another program edits it");
}

#endif

// true if a journal of this text has been cut short before its first change
static bool has_begun(const edit_journal *j, const char *bytes, size_t size)
{
    char head[80];
    size_t base = strlen(j->base),
           used = (size_t)snprintf(head, sizeof head, HEAD "%016" PRIx64 " %zu\n", j->hash, base);
    return size <= used + base && !memcmp(bytes, head, size < used ? size : used) &&
           (size <= used || !memcmp(bytes + used, j->base, size - used));
}

// reads the journal that was found; false if it is damaged
static bool understand(edit_journal *j, const char *bytes, size_t size)
{
    uint64_t of;
    size_t base = 0;
    int head = 0;
    if (has_begun(j, bytes, size))
        return true;
    if (memchr(bytes, 0, size) || sscanf(bytes, HEAD "%" SCNx64 " %zu%n", &of, &base, &head) != 2 ||
        bytes[head] != '\n' || base > size - (size_t)head - 1)
        return false;
    const char *text = bytes + head + 1, *lines = text + base, *end = strrchr(lines, '\n');
    if (!end)
        return true;
    bool same = of == j->hash && base == strlen(j->base) && !memcmp(text, j->base, base);
    if (ftruncate(fileno(j->stream), end + 1 - bytes) != 0 || fseek(j->stream, 0, SEEK_END) != 0)
        return false;
    j->old = same ? NULL : strndup(text, base);
    j->lines = same || j->old ? strndup(lines, (size_t)(end + 1 - lines)) : NULL;
    return j->lines;
}

// false if what stands there is no journal
static bool find(edit_journal *j, himc_error *error)
{
    size_t size = 0, head = strlen(HEAD);
    if (!hold(j, false, error))
        return false;
    if (!j->stream)
        return true;
    // closing any descriptor of the file would end the lock, so it is read through the stream
    struct stat status;
    char *bytes = NULL;
    if (fstat(fileno(j->stream), &status) == 0 && (size_t)status.st_size <= LARGEST)
        bytes = calloc(1, (size_t)status.st_size + 1);
    if (bytes)
        size = fread(bytes, 1, (size_t)status.st_size, j->stream);
    bool good = bytes && !memcmp(bytes, HEAD, size < head ? size : head);
    j->damaged = good && !understand(j, bytes, size);
    free(bytes);
    if (!good)
        return himc_error_set(error, "%.300s: not a journal", j->path);
    if (!j->lines && !j->damaged)
        edit_journal_forget(j);
    return true;
}

bool edit_journal_open(edit_journal *j, const char *source, const char *name, bool sent,
                       const char *text, himc_error *error)
{
    j->base = strdup(text);
    bool good = j->base && hash_file(source, &j->hash, error) &&
                choose_path(j, source, name, sent, error) && find(j, error);
    if (!good)
        edit_journal_close(j);
    return good;
}

static bool begin(edit_journal *j, himc_error *error)
{
    if (!hold(j, true, error))
        return false;
    if (!j->stream)
        return himc_error_set(error, "another program has edited it");
    size_t size = strlen(j->base);
    fprintf(j->stream, HEAD "%016" PRIx64 " %zu\n", j->hash, size);
    fwrite(j->base, 1, size, j->stream);
    return true;
}

bool edit_journal_add(edit_journal *j, const char *line, himc_error *error)
{
    bool first = !j->stream;
    if (!j->path[0] || (first && !begin(j, error)))
        return false;
    fprintf(j->stream, "%s\n", line);
    if (fflush(j->stream) == 0 && !ferror(j->stream) && fsync(fileno(j->stream)) == 0)
        return true;
    himc_error_set(error, "%.300s: %s", j->path, strerror(errno));
    if (first) // there is nothing in it
        edit_journal_forget(j);
    return false;
}

// all bytes of a stream after those of another one
static bool copy(FILE *from, FILE *to)
{
    char bytes[65536];
    size_t got;
    rewind(from);
    while ((got = fread(bytes, 1, sizeof bytes, from)) > 0)
        if (fwrite(bytes, 1, got, to) != got)
            return false;
    return !ferror(from);
}

bool edit_journal_keep(const edit_journal *j, const char *text, char kept[4096], himc_error *error)
{
    FILE *file = NULL;
    for (int number = 1; number <= SCORES && !file; number++) {
        snprintf(kept, 4096, "%.4070s-%d%s", j->path, number, text ? ".txt" : "");
        if (!open_own(kept, true, &file, error))
            return false;
    }
    if (!file)
        return himc_error_set(error, "%.300s: there are %d others", kept, SCORES);
    bool written = text ? fputs(text, file) >= 0 : copy(j->stream, file);
    written = written && fflush(file) == 0 && fsync(fileno(file)) == 0; // what it was in goes now
    bool closed = fclose(file) == 0;
    return (written && closed) || himc_error_set(error, "%.300s: %s", kept, strerror(errno));
}

void edit_journal_forget(edit_journal *j)
{
    if (j->stream) {
        unlink(j->path); // while it is held
        fclose(j->stream);
    }
    j->stream = NULL;
}

void edit_journal_close(edit_journal *j)
{
    if (j->stream)
        fclose(j->stream);
    free(j->base);
    free(j->lines);
    free(j->old);
    *j = (edit_journal){.path = ""};
}
