/// editor.c: a child process with two pipes. It is the `himc` in this program's folder, else that
/// of the path. What a page sends becomes a file in a folder of our own, under a name of our own
/// with one of a few endings.
#define _GNU_SOURCE // getrandom, strndup
#include "editor.h"
#include "base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/random.h>
#include <sys/wait.h>
#include <unistd.h>

#define MOST_DESCRIPTORS 4096 // of this process, closed in the child; chosen

static const char *const endings[] = {".txt", ".mid", ".bvh", ".c3d", ".trc"};

bool editor_key(char key[EDITOR_KEY + 1], himc_error *error)
{
    unsigned char bytes[EDITOR_KEY / 2];
    if (getrandom(bytes, sizeof bytes, 0) != sizeof bytes)
        return himc_error_set(error, "no random numbers: %s", strerror(errno));
    for (size_t i = 0; i < sizeof bytes; i++)
        snprintf(key + 2 * i, 3, "%02x", bytes[i]);
    return true;
}

bool editor_is_key(const char *key, const char *given)
{
    unsigned differ = strlen(given) != EDITOR_KEY; // which is no secret
    for (size_t i = 0; i < EDITOR_KEY && given[i]; i++)
        differ |= (unsigned char)key[i] ^ (unsigned char)given[i];
    return !differ;
}

// in the child: becomes `himc edit`, or tells the page why not
static void become(const editor *e)
{
    char path[PATH_MAX];
    ssize_t length = readlink("/proc/self/exe", path, sizeof path - 8);
    char *slash = length > 0 ? memrchr(path, '/', (size_t)length) : NULL;
    char *const arguments[] = {"himc", "edit", (char *)e->source,
                               e->confined ? "--confined" : "--quiet", NULL};
    static const char missing[] =
        "{\"event\":\"failed\",\"text\":\"the program himc is not beside himc-viewer\"}";
    uint32_t size = sizeof missing - 1;
    for (int i = 3; i < MOST_DESCRIPTORS; i++)
        close(i);
    signal(SIGPIPE, SIG_DFL);
    signal(SIGCHLD, SIG_DFL);
    if (slash) {
        strcpy(slash + 1, "himc");
        execv(path, arguments);
    }
    execvp("himc", arguments);
    if (write(1, "edit", 4) == 4 && write(1, &size, 4) == 4 && write(1, missing, size) > 0)
        _exit(1);
    _exit(127);
}

void editor_stop(editor *e)
{
    if (e->process > 0) {
        close(e->to); // its end of lines; `from` belongs to the loop
        kill(e->process, SIGTERM);
        waitpid(e->process, NULL, 0);
    }
    e->process = 0;
}

bool editor_start(editor *e, himc_error *error)
{
    int in[2], out[2];
    editor_stop(e);
    if (pipe2(in, O_CLOEXEC) != 0)
        return himc_error_set(error, "%s", strerror(errno));
    if (pipe2(out, O_CLOEXEC) != 0 || (e->process = fork()) < 0) {
        close(in[0]), close(in[1]);
        e->process = 0;
        return himc_error_set(error, "%s", strerror(errno));
    }
    if (e->process == 0) {
        dup2(in[0], 0);
        dup2(out[1], 1);
        become(e);
    }
    close(in[0]), close(out[1]);
    e->to = in[1], e->from = out[0];
    fcntl(e->to, F_SETFL, O_NONBLOCK);
    fcntl(e->from, F_SETFL, O_NONBLOCK);
    return true;
}

bool editor_say(const editor *e, const char *line, size_t size)
{
    char all[EDITOR_LINE + 1];
    if (!e->process || size > EDITOR_LINE || memchr(line, '\n', size) || memchr(line, 0, size))
        return false;
    memcpy(all, line, size);
    all[size] = '\n';
    return write(e->to, all, size + 1) == (ssize_t)size + 1; // so short that it goes whole
}

static const char *ending_of(const char *name)
{
    const char *dot = strrchr(name, '.');
    for (size_t i = 0; dot && i < sizeof endings / sizeof *endings; i++)
        if (strcasecmp(dot, endings[i]) == 0)
            return endings[i];
    return NULL;
}

static bool write_file(const char *path, const char *bytes, size_t size, himc_error *error)
{
    FILE *file = himc_file_write(path, HIMC_FILE_REPLACE, error);
    if (!file)
        return false;
    bool written = fwrite(bytes, 1, size, file) == size, closed = fclose(file) == 0;
    return (written && closed) || himc_error_set(error, "%s: %s", path, strerror(errno));
}

bool editor_keep(editor *e, const char *bytes, size_t size, himc_error *error)
{
    const char *zero = memchr(bytes, 0, size), *ending = zero ? ending_of(bytes) : NULL;
    if (!ending)
        return himc_error_set(error, "allowed are scores (.txt), .mid, .bvh, .c3d, .trc, .himc");
    if (!e->folder[0]) {
        const char *temporary = getenv("TMPDIR");
        snprintf(e->folder, sizeof e->folder, "%s/himc-viewer-XXXXXX",
                 temporary ? temporary : "/tmp");
        if (!mkdtemp(e->folder)) {
            e->folder[0] = 0;
            return himc_error_set(error, "%s", strerror(errno));
        }
    } else if (e->confined)
        unlink(e->source);
    snprintf(e->source, sizeof e->source, "%s/piece%s", e->folder, ending);
    e->confined = true;
    zero++;
    return write_file(e->source, zero, size - (size_t)(zero - bytes), error);
}

void editor_close(editor *e)
{
    editor_stop(e);
    if (e->folder[0]) {
        if (e->confined)
            unlink(e->source);
        rmdir(e->folder);
    }
}
