/// editor.c: a child process with two pipes. It is the `himc` in this program's folder, else that
/// of the path, and ends with this one. What a page sends becomes a file in our private folder,
/// under a name of our own with one of a few endings; its own name is only shown.
#define _GNU_SOURCE // getrandom, strndup
#include "editor.h"
#include "base/line.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/prctl.h>
#include <sys/random.h>
#include <sys/wait.h>
#include <unistd.h>

#define MOST_DESCRIPTORS 4096 // of this process, closed in the child; chosen
#define MISSING "the program himc is not beside himc-viewer"

static const char *const endings[] = {".txt", ".mid", ".musicxml", ".mxl",
                                      ".xml", ".bvh", ".c3d",      ".trc"};

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

// in the child: becomes himc; comes back if there is none
static void become_himc(char *const *arguments)
{
    char path[PATH_MAX];
    ssize_t length = readlink("/proc/self/exe", path, sizeof path - 8);
    char *slash = length > 0 ? memrchr(path, '/', (size_t)length) : NULL;
    for (int i = 3; i < MOST_DESCRIPTORS; i++)
        close(i);
    signal(SIGPIPE, SIG_DFL);
    signal(SIGCHLD, SIG_DFL);
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (slash) {
        strcpy(slash + 1, "himc");
        execv(path, arguments);
    }
    execvp("himc", arguments);
}

// in the child: becomes `himc edit`, or tells the page why not
static void become(const editor *e)
{
    char *const own[] = {"himc", "edit", (char *)e->piece.source, NULL},
                *const sent[] = {"himc",       "edit",   (char *)e->piece.source,
                                 "--confined", "--name", (char *)e->piece.name,
                                 NULL};
    static const char missing[] = "{\"event\":\"failed\",\"text\":\"" MISSING "\"}";
    uint32_t size = sizeof missing - 1;
    if (e->folder->path[0])
        setenv("TMPDIR", e->folder->path, 1);
    become_himc(e->piece.name[0] ? sent : own);
    if (write(1, "edit", 4) == 4 && write(1, &size, 4) == 4 && write(1, missing, size) > 0)
        _exit(1);
    _exit(127);
}

bool editor_check(const char *source)
{
    int status = 0;
    pid_t process = fork();
    if (process == 0) {
        char *const check[] = {"himc", "edit", (char *)source, "--check", NULL};
        if (freopen("/dev/null", "r", stdin) && freopen("/dev/null", "w", stdout))
            become_himc(check);
        fputs("himc-viewer: " MISSING "\n", stderr);
        _exit(1);
    }
    if (process < 0 || waitpid(process, &status, 0) != process) {
        fprintf(stderr, "himc-viewer: %s\n", strerror(errno));
        return false;
    }
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
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
    if (!folder_make(e->folder, error))
        return false;
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
    e->told = (chunks){.left = 0};
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

ssize_t editor_hear(editor *e, void *bytes, size_t most)
{
    ssize_t got = read(e->from, bytes, most);
    chunks_follow(&e->told, bytes, got > 0 ? (size_t)got : 0);
    return got;
}

static const char *ending_of(const char *name)
{
    const char *dot = strrchr(name, '.');
    for (size_t i = 0; dot && i < sizeof endings / sizeof *endings; i++)
        if (strcasecmp(dot, endings[i]) == 0)
            return endings[i];
    return NULL;
}

// the last part of a path, as a line of text
static void keep_name(editor_piece *e, const char *name)
{
    const char *slash = strrchr(name, '/');
    name = slash ? slash + 1 : name;
    size_t length = strlen(name), most = sizeof e->name - 1;
    // a long one keeps its end; whole characters
    for (name += length > most ? length - most : 0; (*name & 0xc0) == 0x80; name++)
        ;
    snprintf(e->name, sizeof e->name, "%s", name);
    himc_line_clean(e->name);
    if (e->name[0] == '-')
        e->name[0] = '_'; // it would be an option
}

bool editor_keep(editor *e, int place, const char *bytes, size_t size, himc_error *error)
{
    const char *zero = memchr(bytes, 0, size), *ending = zero ? ending_of(bytes) : NULL;
    if (!ending)
        return himc_error_set(error,
                              "%.80s: expected a score (.txt), MIDI (.mid), MusicXML "
                              "(.musicxml .mxl .xml) or a take (.bvh .c3d .trc)",
                              zero ? bytes : "a file without a name");
    if (!folder_make(e->folder, error))
        return false;
    char file[32];
    editor_piece piece = {.place = place};
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++) {
        snprintf(file, sizeof file, "piece.%d%s", piece.place, endings[i]);
        folder_unlink(e->folder, file);
    }
    snprintf(file, sizeof file, "piece.%d%s", piece.place, ending);
    zero++;
    if (!folder_write(e->folder, file, zero, size - (size_t)(zero - bytes), error))
        return false;
    snprintf(piece.source, sizeof piece.source, "%s/%s", e->folder->path, file);
    keep_name(&piece, bytes);
    e->piece = piece;
    return true;
}

int editor_free_place(const editor_pieces *p)
{
    for (int place = 0;; place++) {
        int i = 0;
        while (i < p->count && !(p->piece[i].name[0] && p->piece[i].place == place))
            i++;
        if (i == p->count)
            return place;
    }
}

void editor_add_piece(editor_pieces *p, const editor_piece *piece)
{
    p->count = p->count ? p->at + 1 : 0;
    if (p->count == EDITOR_PIECES)
        memmove(p->piece + 1, p->piece + 2, (size_t)(--p->count - 1) * sizeof *p->piece);
    p->at = p->count++;
    p->piece[p->at] = *piece;
}
