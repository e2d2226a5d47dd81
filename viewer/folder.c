/// folder.c: a folder is locked (flock) while its program runs, so that the next one knows which
/// are left over. The name is taken first and locked then: a program that starts in between may
/// remove it, and then another name is tried.
#define _DEFAULT_SOURCE // flock, mkdtemp
#include "folder.h"
#include "base/file.h"
#include "system/files.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#define NAME "himc-viewer-"
#define TRIES 10

static const char *temporary(void)
{
    const char *named = getenv("TMPDIR");
    return named && named[0] ? named : "/tmp";
}

// opens and locks a folder of this user's; -1 if it is none, or its program runs
static int take(const char *path)
{
    struct stat status, now;
    int lock = himc_system_open(path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (lock < 0)
        return -1;
    if (fstat(lock, &status) == 0 && status.st_uid == geteuid() && !(status.st_mode & 077) &&
        flock(lock, LOCK_EX | LOCK_NB) == 0 && stat(path, &now) == 0 &&
        now.st_ino == status.st_ino && now.st_dev == status.st_dev)
        return lock;
    close(lock);
    return -1;
}

// another file stays, and with it the folder: it is somebody's of the same name
static bool is_ours(const char *name)
{
    return !strcmp(name, "open.html") || !strncmp(name, "piece.", 6) || !strncmp(name, "himc-", 5);
}

static void remove_all(const char *path, int lock)
{
    DIR *list = fdopendir(lock);
    for (struct dirent *entry; list && (entry = readdir(list));)
        if (is_ours(entry->d_name))
            unlinkat(lock, entry->d_name, 0);
    rmdir(path);
    if (list)
        closedir(list);
    else
        close(lock);
}

void folder_remove_stale(void)
{
    char path[256];
    DIR *list = opendir(temporary());
    for (struct dirent *entry; list && (entry = readdir(list));) {
        if (strncmp(entry->d_name, NAME, strlen(NAME)) != 0 ||
            snprintf(path, sizeof path, "%s/%s", temporary(), entry->d_name) >= (int)sizeof path)
            continue;
        int lock = take(path);
        if (lock >= 0)
            remove_all(path, lock);
    }
    if (list)
        closedir(list);
}

bool folder_make(folder *f, himc_error *error)
{
    for (int i = 0; i < TRIES && !f->path[0]; i++) {
        snprintf(f->path, sizeof f->path, "%.200s/" NAME "XXXXXX", temporary());
        bool made = mkdtemp(f->path);
        if (!made)
            himc_error_set(error, "%.200s: %s", temporary(), strerror(errno));
        if (!made || (f->lock = take(f->path)) < 0)
            f->path[0] = 0;
        if (!made)
            return false;
    }
    return f->path[0] || himc_error_set(error, "%.200s: no folder can be locked", temporary());
}

static void path_of(const folder *f, const char *name, char path[512])
{
    snprintf(path, 512, "%s/%s", f->path, name);
}

bool folder_write(const folder *f, const char *name, const char *bytes, size_t size,
                  himc_error *error)
{
    char path[512];
    path_of(f, name, path);
    mode_t mask = umask(077);
    FILE *file = himc_file_write(path, HIMC_FILE_REPLACE, error);
    umask(mask);
    if (!file)
        return false;
    bool written = fwrite(bytes, 1, size, file) == size, closed = fclose(file) == 0;
    return (written && closed) || himc_error_set(error, "%.300s: %s", path, strerror(errno));
}

void folder_unlink(const folder *f, const char *name)
{
    char path[512];
    path_of(f, name, path);
    if (f->path[0])
        unlink(path);
}

void folder_remove(folder *f)
{
    if (f->path[0])
        remove_all(f->path, f->lock);
    f->path[0] = 0;
}
