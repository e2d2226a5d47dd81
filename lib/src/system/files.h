/// files.h: names of files, as the systems differ: what open() takes, real paths, folders that
/// nothing leads out of. A name is UTF-8.
#ifndef HIMC_SYSTEM_FILES_H
#define HIMC_SYSTEM_FILES_H

#include <fcntl.h>
#include <stdbool.h>
#include <sys/stat.h>

#ifdef _WIN32
// a name of Windows never waits and is never a terminal; bytes are read as they are
#define O_NONBLOCK 0
#define O_NOCTTY 0
#define O_CLOEXEC O_NOINHERIT
#define S_ISSOCK(mode) 0
static inline int fchmod(int descriptor, int mode)
{
    (void)descriptor, (void)mode;
    return 0;
}
#else
#define O_BINARY 0
#endif
#ifdef __wasi__ // files have no permissions there
static inline int fchmod(int descriptor, int mode)
{
    (void)descriptor, (void)mode;
    return 0;
}
#endif

/// As open(): a descriptor, or -1 with errno.
int himc_system_open(const char *path, int flags);

/// The path with all links followed; owned. NULL with errno if nothing is there.
char *himc_system_real_path(const char *path);

/// The file that writing to the path makes or changes: a link to it is followed, also to one that
/// is not there yet; owned. NULL without memory.
char *himc_system_target(const char *path);

/// Opens for reading what `name` stands for in `folder` (a real path), links followed as long as
/// they stay inside. -1 if there is nothing inside.
int himc_system_open_inside(const char *folder, const char *name);

/// Gives `from` the name `to`, whatever has had it. False with errno.
bool himc_system_rename(const char *from, const char *to);

/// Makes a file that nobody else knows, with an ending such as ".mid", in the system's folder for
/// such files, and opens it for writing. Its name is `path`, of at most `size` bytes. -1 with
/// errno.
int himc_system_temporary(char *path, size_t size, const char *ending);

/// Standard input and output give and take bytes as they are. One that is closed refuses them: no
/// file that is opened later gets its number.
void himc_system_binary(void);

/// True if both names stand for one file or folder that exists.
bool himc_system_same(const char *a, const char *b);

#endif
