/// browser.c: Chromium's DevTools protocol over --remote-debugging-pipe: it reads requests from
/// descriptor 3 and writes answers to 4, JSON texts that end with a zero byte. An answer has the
/// number of its request; everything else that comes is skipped.
///
/// Scripts answer with text that needs no escape (words, numbers, base64), so an answer is read
/// without a parser.
#define _XOPEN_SOURCE 700 // mkdtemp, nftw
#define _DARWIN_C_SOURCE  // mkdtemp of macOS
#include "browser.h"

#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define PATIENCE 300000 // (ms) without a word; chosen: a slow machine draws a large frame

struct browser {
    pid_t process;
    int to, from; // descriptors
    int count;    // of requests
    char home[64], session[128];
    char *text; // what came, the answer at its beginning
    size_t size, room;
};

// --- the process

static const char *const names[] = {"chromium", "chromium-browser", "google-chrome",
                                    "chrome",   "brave-browser",    "microsoft-edge"};

static bool is_there(const char *name)
{
    char path[4096];
    const char *list = getenv("PATH");
    if (strchr(name, '/'))
        return access(name, X_OK) == 0;
    for (const char *at = list ? list : ""; *at;) {
        size_t length = strcspn(at, ":");
        snprintf(path, sizeof path, "%.*s/%s", (int)length, at, name);
        if (access(path, X_OK) == 0)
            return true;
        at += length + (at[length] == ':');
    }
    return false;
}

static const char *find(himc_error *error)
{
    const char *wanted = getenv("HIMC_BROWSER");
    if (wanted && is_there(wanted))
        return wanted;
    for (size_t i = 0; !wanted && i < sizeof names / sizeof *names; i++)
        if (is_there(names[i]))
            return names[i];
    himc_error_set(error, "%s%s: no such browser (Debian: chromium; HIMC_BROWSER names another)",
                   wanted ? "HIMC_BROWSER " : "chromium", wanted ? wanted : "");
    return NULL;
}

// in the child; does not return
static void become(const char *name, const char *home, int requests, int answers, int width,
                   int height)
{
    char profile[96], size[64];
    snprintf(profile, sizeof profile, "--user-data-dir=%s", home);
    snprintf(size, sizeof size, "--window-size=%d,%d", width, height);
    // 3 and 4 may be among the descriptors that are moved there
    int a = fcntl(requests, F_DUPFD, 10), b = fcntl(answers, F_DUPFD, 10);
    if (dup2(a, 3) < 0 || dup2(b, 4) < 0 || !freopen("/dev/null", "w", stderr) ||
        !freopen("/dev/null", "w", stdout))
        _exit(127);
    close(a);
    close(b);
    execlp(name, name, "--headless=new", "--remote-debugging-pipe", profile, size, "--mute-audio",
           "--no-first-run", "--hide-scrollbars", "--disable-dev-shm-usage",
           "--enable-unsafe-swiftshader", geteuid() ? "--disable-extensions" : "--no-sandbox",
           "about:blank", (char *)NULL);
    _exit(127);
}

static bool start(browser *b, int width, int height, himc_error *error)
{
    int requests[2], answers[2];
    const char *name = find(error), *folder = getenv("TMPDIR");
    if (!name)
        return false;
    snprintf(b->home, sizeof b->home, "%.40s/himc-film-XXXXXX", folder ? folder : "/tmp");
    if (!mkdtemp(b->home)) {
        b->home[0] = 0;
        return himc_error_set(error, "no temporary folder: %s", strerror(errno));
    }
    if (pipe(requests))
        return himc_error_set(error, "%s", strerror(errno));
    if (pipe(answers)) {
        close(requests[0]);
        close(requests[1]);
        return himc_error_set(error, "%s", strerror(errno));
    }
    b->to = requests[1];
    b->from = answers[0];
    b->process = fork();
    if (b->process == 0) {
        close(b->to);
        close(b->from);
        become(name, b->home, requests[0], answers[1], width, height);
    }
    close(requests[0]);
    close(answers[1]);
    return b->process > 0 || himc_error_set(error, "%s: %s", name, strerror(errno));
}

// --- requests and answers

static bool put(browser *b, const char *text, size_t size, himc_error *error)
{
    for (ssize_t n; size; text += n, size -= (size_t)n) {
        n = write(b->to, text, size);
        if (n < 0)
            return himc_error_set(error, "the browser has ended");
    }
    return true;
}

// the next text into b->text; what follows it stays behind it
static bool next(browser *b, himc_error *error)
{
    char *end = b->size ? memchr(b->text, 0, b->size) : NULL;
    if (end) { // the one before goes
        b->size -= (size_t)(end + 1 - b->text);
        memmove(b->text, end + 1, b->size);
    }
    for (size_t seen = 0; !b->size || !memchr(b->text + seen, 0, b->size - seen);) {
        if (b->room - b->size < 65536) {
            char *text = realloc(b->text, 2 * b->room + 131072);
            if (!text)
                return himc_error_set(error, "out of memory");
            b->text = text;
            b->room = 2 * b->room + 131072;
        }
        struct pollfd wait = {.fd = b->from, .events = POLLIN};
        int come = poll(&wait, 1, PATIENCE);
        ssize_t n = come > 0 ? read(b->from, b->text + b->size, b->room - b->size) : 0;
        if (come < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return himc_error_set(error, come ? "the browser has ended" : "the browser is silent");
        seen = b->size;
        b->size += (size_t)n;
    }
    return true;
}

// the text after `name` in the answer, up to its closing quote, which becomes a zero
static const char *field(browser *b, const char *name)
{
    char *at = strstr(b->text, name), *end = at ? strchr(at + strlen(name), '"') : NULL;
    if (!end)
        return NULL;
    // the answer still ends where it did
    *end = 1;
    return at + strlen(name);
}

/// Sends a request, `parameters` JSON without its braces, and waits for its answer.
static bool ask(browser *b, const char *method, const char *parameters, himc_error *error)
{
    char head[256], number[32];
    int n = ++b->count;
    snprintf(head, sizeof head, "{\"id\":%d,\"method\":\"%s\"%s%s%s,\"params\":{", n, method,
             b->session[0] ? ",\"sessionId\":\"" : "", b->session, b->session[0] ? "\"" : "");
    snprintf(number, sizeof number, "{\"id\":%d,", n);
    if (!put(b, head, strlen(head), error) || !put(b, parameters, strlen(parameters), error) ||
        !put(b, "}}", 3, error))
        return false;
    do
        if (!next(b, error))
            return false;
    while (strncmp(b->text, number, strlen(number)) != 0);
    if (strncmp(b->text + strlen(number), "\"error\"", 7) == 0)
        return himc_error_set(error, "the browser: %.200s", b->text);
    return true;
}

static bool attach(browser *b, himc_error *error)
{
    char text[256];
    if (!ask(b, "Target.createTarget", "\"url\":\"about:blank\"", error))
        return false;
    const char *target = field(b, "\"targetId\":\"");
    snprintf(text, sizeof text, "\"flatten\":true,\"targetId\":\"%.*s\"",
             target ? (int)strcspn(target, "\1") : 0, target ? target : "");
    if (!ask(b, "Target.attachToTarget", text, error))
        return false;
    const char *session = field(b, "\"sessionId\":\"");
    snprintf(b->session, sizeof b->session, "%.*s", session ? (int)strcspn(session, "\1") : 0,
             session ? session : "");
    return true;
}

// --- for others

browser *browser_open(int width, int height, himc_error *error)
{
    char text[128];
    browser *b = calloc(1, sizeof *b);
    if (!b) {
        himc_error_set(error, "out of memory");
        return NULL;
    }
    signal(SIGPIPE, SIG_IGN);
    snprintf(text, sizeof text,
             "\"width\":%d,\"height\":%d,\"deviceScaleFactor\":1,\"mobile\":false", width, height);
    if (start(b, width, height, error) && attach(b, error) &&
        ask(b, "Emulation.setDeviceMetricsOverride", text, error))
        return b;
    browser_close(b);
    return NULL;
}

bool browser_go(browser *b, const char *url, himc_error *error)
{
    char text[8192];
    snprintf(text, sizeof text, "\"url\":\"%s\"", url);
    return ask(b, "Page.navigate", text, error);
}

const char *browser_run(browser *b, const char *script, himc_error *error)
{
    char text[4096];
    snprintf(text, sizeof text,
             "\"expression\":\"%s\",\"awaitPromise\":true,\"returnByValue\":true", script);
    if (!ask(b, "Runtime.evaluate", text, error))
        return NULL;
    const char *fault = strstr(b->text, "\"exceptionDetails\"");
    char *value = fault ? NULL : (char *)field(b, "\"value\":\"");
    if (value) {
        value[strcspn(value, "\1")] = 0;
        return value;
    }
    himc_error_set(error, "the page: %.200s", fault ? fault : b->text);
    return NULL;
}

static int remove_one(const char *path, const struct stat *s, int kind, struct FTW *where)
{
    (void)s, (void)kind, (void)where;
    remove(path);
    return 0;
}

void browser_close(browser *b)
{
    if (!b)
        return;
    himc_error error;
    b->session[0] = 0;
    if (b->process > 0) {
        ask(b, "Browser.close", "", &error);
        waitpid(b->process, NULL, 0);
    }
    if (b->to)
        close(b->to);
    if (b->from)
        close(b->from);
    if (b->home[0])
        nftw(b->home, remove_one, 16, FTW_DEPTH | FTW_PHYS);
    free(b->text);
    free(b);
}
