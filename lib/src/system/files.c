/// files.c: names of files on Linux, macOS and other systems of POSIX, on Windows, and in a page
/// (WASI), where a few files lie in memory under plain names, without folders and links.
///
/// A folder that nothing leads out of: on POSIX a name is resolved with all its links, and the
/// result must lie in the folder. Then it is opened from the folder down, part by part, and no link
/// is followed any more: if one has been put there in between, the file is refused. Windows tells
/// the final path of what has been opened, which must lie in the folder. Invariant: the opened file
/// lies inside.
#define _GNU_SOURCE // O_PATH
#include "system/files.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LINKS_MAX 40 // followed, as Linux does

#ifndef __wasi__
// the part of a real path below the folder, with its first separator; NULL if it is not inside
static const char *below(const char *real, const char *folder, char separator)
{
    size_t length = strlen(folder);
    length -= length > 0 && folder[length - 1] == separator; // the root
    bool inside = strncmp(real, folder, length) == 0 && real[length] == separator;
    return inside ? real + length : NULL;
}
#endif

#ifdef _WIN32
#include <io.h>
#include <windows.h>

// false with errno if it is no UTF-8 or too long
static bool widen(const char *path, wchar_t wide[PATH_MAX])
{
    if (MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, path, -1, wide, PATH_MAX) > 0)
        return true;
    errno = ENOENT;
    return false;
}

int himc_system_open(const char *path, int flags)
{
    wchar_t wide[PATH_MAX];
    return widen(path, wide) ? _wopen(wide, flags, _S_IREAD | _S_IWRITE) : -1;
}

static HANDLE open_handle(const char *path)
{
    wchar_t wide[PATH_MAX];
    if (!widen(path, wide))
        return INVALID_HANDLE_VALUE;
    return CreateFileW(wide, GENERIC_READ, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE,
                       NULL, OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS, NULL); // folders, too
}

static bool final_path(HANDLE file, char path[3 * PATH_MAX])
{
    wchar_t wide[PATH_MAX];
    DWORD length = GetFinalPathNameByHandleW(file, wide, PATH_MAX, FILE_NAME_NORMALIZED);
    return length > 0 && length < PATH_MAX &&
           WideCharToMultiByte(CP_UTF8, 0, wide, -1, path, 3 * PATH_MAX, NULL, NULL) > 0;
}

char *himc_system_real_path(const char *path)
{
    char real[3 * PATH_MAX];
    HANDLE file = open_handle(path);
    bool good = file != INVALID_HANDLE_VALUE && final_path(file, real);
    if (file != INVALID_HANDLE_VALUE)
        CloseHandle(file);
    if (good)
        return strdup(real);
    errno = ENOENT;
    return NULL;
}

char *himc_system_target(const char *path)
{
    char *real = himc_system_real_path(path);
    return real ? real : strdup(path);
}

bool himc_system_rename(const char *from, const char *to)
{
    wchar_t wide[2][PATH_MAX];
    if (widen(from, wide[0]) && widen(to, wide[1]) &&
        MoveFileExW(wide[0], wide[1], MOVEFILE_REPLACE_EXISTING))
        return true;
    errno = EACCES;
    return false;
}

bool himc_system_same(const char *a, const char *b)
{
    char *first = himc_system_real_path(a), *second = himc_system_real_path(b);
    bool same = first && second && strcmp(first, second) == 0;
    free(first);
    free(second);
    return same;
}

int himc_system_temporary(char *path, size_t size, const char *ending)
{
    char folder[MAX_PATH];
    DWORD length = GetTempPathA(sizeof folder, folder);
    int wanted = snprintf(path, size, "%shimc-%lu%s", folder, GetCurrentProcessId(), ending);
    if (length > 0 && length < sizeof folder && wanted < (int)size)
        return himc_system_open(path, O_CREAT | O_EXCL | O_WRONLY | O_BINARY);
    errno = ENAMETOOLONG;
    return -1;
}

void himc_system_binary(void)
{
    _setmode(0, O_BINARY);
    _setmode(1, O_BINARY);
}

int himc_system_open_inside(const char *folder, const char *name)
{
    char wanted[PATH_MAX], real[3 * PATH_MAX];
    if (snprintf(wanted, sizeof wanted, "%s\\%s", folder, name) >= (int)sizeof wanted)
        return -1;
    for (char *c = wanted; *c; c++) // the folder's real path takes no other separator
        *c = *c == '/' ? '\\' : *c;
    HANDLE file = open_handle(wanted);
    if (file == INVALID_HANDLE_VALUE)
        return -1;
    if (final_path(file, real) && below(real, folder, '\\'))
        return _open_osfhandle((intptr_t)file, O_RDONLY | O_BINARY);
    CloseHandle(file);
    return -1;
}

#else
#include <unistd.h>

int himc_system_open(const char *path, int flags)
{
    return open(path, flags, 0666);
}

bool himc_system_rename(const char *from, const char *to)
{
    return rename(from, to) == 0;
}

#ifdef __wasi__

char *himc_system_real_path(const char *path)
{
    struct stat about;
    return stat(path, &about) == 0 ? strdup(path) : NULL;
}

char *himc_system_target(const char *path)
{
    return strdup(path);
}

bool himc_system_same(const char *a, const char *b)
{
    return strcmp(a, b) == 0;
}

int himc_system_temporary(char *path, size_t size, const char *ending)
{
    snprintf(path, size, "himc-temporary%s", ending);
    return himc_system_open(path, O_CREAT | O_EXCL | O_WRONLY);
}

void himc_system_binary(void)
{
}

int himc_system_open_inside(const char *folder, const char *name)
{
    (void)folder, (void)name;
    errno = ENOENT;
    return -1;
}

#else

#ifndef O_PATH // Linux's own: a folder on the way needs not be readable
#define O_PATH O_RDONLY
#endif

char *himc_system_real_path(const char *path)
{
    return realpath(path, NULL);
}

char *himc_system_target(const char *path)
{
    char at[PATH_MAX], link[PATH_MAX], next[2 * PATH_MAX];
    ssize_t length = 0;
    snprintf(at, sizeof at, "%s", path);
    for (int links = 0; links < LINKS_MAX; links++) {
        length = readlink(at, link, sizeof link - 1);
        if (length < 0)
            break;
        link[length] = '\0';
        const char *slash = link[0] == '/' ? NULL : strrchr(at, '/');
        snprintf(next, sizeof next, "%.*s%s", slash ? (int)(slash - at) + 1 : 0, at, link);
        if (strlen(next) >= sizeof at)
            break;
        strcpy(at, next);
    }
    return strdup(strlen(path) < sizeof at ? at : path);
}

bool himc_system_same(const char *a, const char *b)
{
    struct stat first, second;
    return stat(a, &first) == 0 && stat(b, &second) == 0 && first.st_dev == second.st_dev &&
           first.st_ino == second.st_ino;
}

int himc_system_temporary(char *path, size_t size, const char *ending)
{
    const char *folder = getenv("TMPDIR");
    snprintf(path, size, "%.200s/himc-XXXXXX%s", folder ? folder : "/tmp", ending);
    return mkstemps(path, (int)strlen(ending));
}

void himc_system_binary(void)
{
    static const int refusing[] = {O_WRONLY, O_RDONLY, O_RDONLY}; // reads, writes, writes
    for (int number = 0; number < 3; number++)
        if (fcntl(number, F_GETFD) < 0 && errno == EBADF)
            (void)!open("/dev/null", refusing[number]);
}

int himc_system_open_inside(const char *folder, const char *name)
{
    char wanted[PATH_MAX], part[NAME_MAX + 1];
    int length = snprintf(wanted, sizeof wanted, "%s/%s", folder, name);
    char *real = (size_t)length < sizeof wanted ? realpath(wanted, NULL) : NULL;
    const char *path = real ? below(real, folder, '/') : NULL;
    int at = path ? open(folder, O_PATH | O_DIRECTORY | O_CLOEXEC) : -1;
    while (at >= 0 && *path) { // "/a/b/c" from the folder down, without following a link
        size_t n = strcspn(++path, "/");
        snprintf(part, sizeof part, "%.*s", (int)n, path);
        path += n;
        int how = *path ? O_PATH | O_DIRECTORY : O_RDONLY | O_NONBLOCK | O_NOCTTY;
        int next = openat(at, part, how | O_NOFOLLOW | O_CLOEXEC);
        close(at);
        at = next;
    }
    free(real);
    return at;
}
#endif
#endif
