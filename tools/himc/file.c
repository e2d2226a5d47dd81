/// file.c: what a call reads and writes. An interrupted run removes its unfinished files.
#define _XOPEN_SOURCE 700
#include "base/file.h"
#include "capture/take.h"
#include "cli.h"
#include "musicxml/import.h"
#include "system/files.h"

#include <errno.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#ifndef SIGHUP // Windows has no terminal that hangs up
#define SIGHUP SIGTERM
#endif

/// The temporary names an interrupt must remove; written before, cleared after the file exists.
#define FILES_OPEN 8
static const char *volatile unfinished[FILES_OPEN];

static void remove_unfinished(int signal_number)
{
    for (int i = 0; i < FILES_OPEN; i++)
        if (unfinished[i])
            unlink(unfinished[i]);
    signal(signal_number, SIG_DFL);
    raise(signal_number);
}

static void remember(const char *temp)
{
    static const int signals[] = {SIGINT, SIGTERM, SIGHUP};
    int free_slot = 0;
    while (free_slot < FILES_OPEN - 1 && unfinished[free_slot])
        free_slot++;
    unfinished[free_slot] = temp;
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++)
        if (signal(signals[i], remove_unfinished) == SIG_IGN)
            signal(signals[i], SIG_IGN); // nohup stays in force
}

static void forget(const char *temp)
{
    for (int i = 0; i < FILES_OPEN; i++)
        if (unfinished[i] == temp)
            unfinished[i] = NULL;
}

bool cli_file_open(cli_file *file, const char *path, himc_error *error)
{
    *file = (cli_file){0};
    if (!path)
        return true;
    if (!path[0])
        return himc_error_set(error, "\"\": no file has an empty name");
    if (cli_is_standard(path)) {
        file->path[0] = '-';
        file->stream = tmpfile();
        return file->stream ||
               himc_error_set(error, "/tmp: cannot be written: %s", strerror(errno));
    }
    if (!himc_file_draft_open(file, path, error))
        return false;
    if (file->temp[0])
        remember(file->temp);
    return true;
}

bool cli_file_close(cli_file *file, himc_error *error)
{
    if (cli_is_standard(file->path))
        return true;
    if (himc_file_draft_close(file, error))
        return true;
    forget(file->temp);
    return false;
}

// all of a nameless file to the standard output
static bool copy_out(cli_file *file, himc_error *error)
{
    char bytes[65536];
    size_t size;
    errno = 0;
    rewind(file->stream);
    while ((size = fread(bytes, 1, sizeof bytes, file->stream)) > 0)
        fwrite(bytes, 1, size, stdout);
    bool good = !ferror(file->stream) && !fflush(stdout) && !ferror(stdout);
    int fault = errno ? errno : EIO;
    cli_file_drop(file);
    return good || himc_error_set(error, "standard output: %s", strerror(fault));
}

bool cli_file_keep(cli_file *file, himc_error *error)
{
    if (cli_is_standard(file->path) && file->stream)
        return copy_out(file, error);
    bool good = himc_file_draft_keep(file, error);
    forget(file->temp);
    return good;
}

void cli_file_drop(cli_file *file)
{
    himc_file_draft_drop(file);
    forget(file->temp);
}

bool cli_draft(cli_file *file, const char *path, void (*write)(const void *, FILE *),
               const void *from, himc_error *error)
{
    if (!path)
        return true;
    if (!cli_file_open(file, path, error))
        return false;
    write(from, file->stream);
    return cli_file_close(file, error);
}

bool cli_write(const char *path, void (*write)(const void *, FILE *), const void *from,
               himc_error *error)
{
    cli_file file = {0};
    bool good = cli_draft(&file, path, write, from, error) && cli_file_keep(&file, error);
    cli_file_drop(&file);
    return good;
}

// the folder that a file is or will be in; returns the file's own name
static const char *folder_of(const char *path, char folder[PATH_MAX])
{
    const char *slash = strrchr(path, '/');
    int length = slash ? (int)(slash - path) + 1 : 0;
    snprintf(folder, PATH_MAX, "%.*s.", length, path);
    return path + length;
}

// of files that are not both there yet
static bool will_be_same(const char *a, const char *b)
{
    char folder[2][PATH_MAX];
    const char *name[2] = {folder_of(a, folder[0]), folder_of(b, folder[1])};
    return !strcmp(name[0], name[1]) && himc_system_same(folder[0], folder[1]);
}

bool cli_same_file(const char *a, const char *b)
{
    struct stat first, second;
    if (!a || !b)
        return false;
    if (!strcmp(a, b))
        return true;
    if (!stat(a, &first) && !stat(b, &second))
        return S_ISREG(first.st_mode) && himc_system_same(a, b);
    char *target[2] = {himc_system_target(a), himc_system_target(b)};
    bool same = target[0] && target[1] && will_be_same(target[0], target[1]);
    free(target[0]);
    free(target[1]);
    return same;
}

bool cli_ending_is(const char *option, const char *name, const char *ending, himc_error *error)
{
    const char *slash = name ? strrchr(name, '/') : NULL;
    const char *dot = name ? strrchr(slash ? slash : name, '.') : NULL;
    return !dot || !strcasecmp(dot, ending) ||
           himc_error_set(error, "%s: %s, expected a name that ends with %s", option, name, ending);
}

bool cli_apart(const char *name, const char *const *files, int count, himc_error *error)
{
    for (int i = 0; i < count; i++)
        if (cli_same_file(name, files[i]))
            return himc_error_set(error, "%s: named twice, expected different files", name);
    return true;
}

bool cli_is_standard(const char *path)
{
    return path && !strcmp(path, "-");
}

int cli_temporary(char *path, size_t size, const char *ending)
{
    int file = himc_system_temporary(path, size, ending);
    if (file >= 0)
        remember(path);
    return file;
}

void cli_temporary_remove(const char *path)
{
    unlink(path);
    forget(path);
}

// where the standard input is kept, until the program ends
static char input[HIMC_PATH_SIZE];

static void remove_input(void)
{
    cli_temporary_remove(input);
}

// by its first bytes; anything else is a score
static const char *suffix_of(const char *bytes, size_t size)
{
    const char *take = himc_take_suffix_of(bytes, size);
    return take ? take : himc_score_maker_of(bytes, size) ? ".mid" : ".txt";
}

void cli_name_input(char *line)
{
    size_t length = strlen(input);
    for (char *at = line; length > 0 && (at = strstr(at, input));) {
        *at++ = '-';
        memmove(at, at + length - 1, strlen(at + length - 1) + 1);
    }
}

const char *cli_input(const char *operand, himc_error *error)
{
    char bytes[65536];
    if (!cli_is_standard(operand))
        return operand;
    size_t size = fread(bytes, 1, sizeof bytes, stdin);
    int descriptor = cli_temporary(input, sizeof input, suffix_of(bytes, size));
    FILE *file = descriptor < 0 ? NULL : fdopen(descriptor, "wb");
    if (!file) {
        himc_error_set(error, "%s: cannot be written: %s", input, strerror(errno));
        return NULL;
    }
    atexit(remove_input);
    for (; size > 0; size = fread(bytes, 1, sizeof bytes, stdin))
        fwrite(bytes, 1, size, file);
    bool bad = ferror(stdin) || ferror(file);
    if (fclose(file) || bad) {
        himc_error_set(error, "standard input: cannot be read to its end");
        return NULL;
    }
    return input;
}
