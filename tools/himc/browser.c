/// browser.c: Chromium's DevTools protocol over --remote-debugging-pipe: it reads requests from
/// descriptor 3 and writes answers to 4, JSON texts that end with a zero byte. An answer has the
/// number of its request; everything else that comes is skipped.
///
/// Its keeper, a process in a session of its own, starts it and waits until this one has closed a
/// pipe, however it ends. Then the browser and its folder go.
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
// chosen:
enum {
    STEP = 20,     // between two looks at a browser that ends (ms)
    FAREWELL = 250 // looks before it is killed, or its folder is left
};

struct browser {
    pid_t keeper;
    int to, from, life; // descriptors
    int count;          // of requests
    char home[BROWSER_HOME], session[128];
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
    char profile[BROWSER_HOME + 32], size[64];
    snprintf(profile, sizeof profile, "--user-data-dir=%s/profile", home);
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

static int remove_one(const char *path, const struct stat *s, int kind, struct FTW *where)
{
    (void)s, (void)kind, (void)where;
    remove(path);
    return 0;
}

// true once the browser has ended
static bool has_ended(pid_t child)
{
    for (int i = 0; i < FAREWELL; i++) {
        if (waitpid(child, NULL, WNOHANG) != 0)
            return true;
        poll(NULL, 0, STEP);
    }
    return false;
}

// in the keeper; does not return
static void keep(const char *name, const browser *b, int alive, int requests, int answers,
                 int width, int height)
{
    static const int signals[] = {SIGINT, SIGTERM, SIGHUP};
    char byte;
    setsid(); // what ends the program at a terminal, or by its group, leaves this one its work
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++)
        signal(signals[i], SIG_DFL);
    pid_t child = fork();
    if (child == 0) {
        setpgid(0, 0);
        close(alive);
        become(name, b->home, requests, answers, width, height);
    }
    close(requests);
    close(answers);
    if (!freopen("/dev/null", "w", stderr) || !freopen("/dev/null", "w", stdout))
        _exit(1);
    while (read(alive, &byte, 1) < 0 && errno == EINTR)
        ;
    if (child > 0 && !has_ended(child)) {
        kill(-child, SIGKILL);
        waitpid(child, NULL, 0);
    }
    // its own processes may still write
    for (int i = 0; i < FAREWELL && access(b->home, F_OK) == 0; i++) {
        nftw(b->home, remove_one, 16, FTW_DEPTH | FTW_PHYS);
        poll(NULL, 0, i ? STEP : 0);
    }
    _exit(0);
}

static bool start(browser *b, int width, int height, himc_error *error)
{
    int pipes[3][2] = {{-1, -1}, {-1, -1}, {-1, -1}};
    const char *name = find(error), *folder = getenv("TMPDIR");
    if (!name)
        return false;
    snprintf(b->home, sizeof b->home, "%.200s/himc-film-XXXXXX",
             folder && folder[0] ? folder : "/tmp");
    if (!mkdtemp(b->home))
        return himc_error_set(error, "no temporary folder: %s", strerror(errno));
    if (pipe(pipes[0]) == 0 && pipe(pipes[1]) == 0 && pipe(pipes[2]) == 0)
        b->keeper = fork();
    else
        b->keeper = -1;
    if (b->keeper == 0) {
        for (int i = 0; i < 3; i++)
            close(pipes[i][i != 1]);
        keep(name, b, pipes[2][0], pipes[0][0], pipes[1][1], width, height);
    }
    int why = errno;
    for (int i = 0; i < 3; i++)
        if (pipes[i][i == 1] >= 0)
            close(pipes[i][i == 1]);
    b->to = pipes[0][1];
    b->from = pipes[1][0];
    b->life = pipes[2][1];
    if (b->keeper > 0)
        return true;
    rmdir(b->home);
    return himc_error_set(error, "%s: %s", name, strerror(why));
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
    b->to = b->from = b->life = -1;
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

const char *browser_home(const browser *b)
{
    return b->home;
}

void browser_close(browser *b)
{
    if (!b)
        return;
    // which ends the browser
    const int open[] = {b->to, b->from, b->life};
    for (int i = 0; i < 3; i++)
        if (open[i] >= 0)
            close(open[i]);
    if (b->keeper > 0)
        waitpid(b->keeper, NULL, 0);
    free(b->text);
    free(b);
}
