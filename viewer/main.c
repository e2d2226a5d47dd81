/// himc-viewer: OSC in, a page in the browser out.
#define _POSIX_C_SOURCE 200809L
#include "editor.h"
#include "receive.h"
#include "recording.h"
#include "web.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define OSC_PORT 9001
#define HTTP_PORT 8080

static const char help[] =
    "usage: himc-viewer [OPTION...]\n\n"
    "shows the performer in the browser: receives OSC, serves one page and streams to it\n\n"
    "  --osc PORT       receive OSC on this UDP port, 0 .. 65535, 0 any free (9001)\n"
    "  --http PORT      serve the page on this port (8080)\n"
    "  --bind ADDR      on this address (127.0.0.1); 0.0.0.0 lets other machines in\n"
    "  --edit SOURCE    change a score, MIDI, MusicXML or a take on the page, and hear it at once\n"
    "  --play F.himc    play a scene that himc render --scene wrote\n"
    "  --no-browser     only print the address\n"
    "  --help           this text\n";

typedef struct options {
    const char *address, *play, *edit;
    int osc, http;
    bool browser;
} options;

static volatile int stop;

static void on_signal(int number)
{
    (void)number;
    stop = 1;
}

static int fail(const himc_error *error)
{
    fprintf(stderr, "himc-viewer: %s\n", error->text);
    return 1;
}

static bool parse_port(const char *name, const char *text, int *port, himc_error *error)
{
    char *end;
    long value = strtol(text, &end, 10);
    if (!*text || *end || value < 0 || value > 65535)
        return himc_error_set(error, "%s %.40s: expected 0 .. 65535", name, text);
    *port = (int)value;
    return true;
}

// an option with a value; false with a line in `error` if it is not one
static bool parse_option(options *o, const char *name, const char *value, himc_error *error)
{
    bool known = !strcmp(name, "--osc") || !strcmp(name, "--http") || !strcmp(name, "--bind") ||
                 !strcmp(name, "--play") || !strcmp(name, "--edit");
    if (!known)
        return himc_error_set(error, "%.60s: unknown option; himc-viewer --help lists them", name);
    if (!value)
        return himc_error_set(error, "%s: wants a value; himc-viewer --help explains", name);
    if (!strcmp(name, "--osc"))
        return parse_port(name, value, &o->osc, error);
    if (!strcmp(name, "--http"))
        return parse_port(name, value, &o->http, error);
    *(!strcmp(name, "--bind")   ? &o->address
      : !strcmp(name, "--play") ? &o->play
                                : &o->edit) = value;
    return true;
}

static bool parse(options *o, char **argv, himc_error *error)
{
    for (char **arg = argv + 1; *arg; arg++) {
        if (!strcmp(*arg, "--no-browser")) {
            o->browser = false;
            continue;
        }
        if (!parse_option(o, *arg, arg[1], error))
            return false;
        arg++;
    }
    return true;
}

// a browser cannot open 0.0.0.0; what comes after # it keeps to itself
static void print_url(char url[192], const char *address, int port, const char *key)
{
    bool all = !strcmp(address, "0.0.0.0") || !strcmp(address, "::");
    const char *host = all ? "127.0.0.1" : address;
    snprintf(url, 192, strchr(host, ':') ? "http://[%s]:%d/#%s" : "http://%s:%d/#%s", host, port,
             key);
}

// The address holds the key, and arguments can be read by all users: the browser gets a file that
// leads there. It is removed when the page has come, or at the end.
static void open_browser(folder *f, const char *url)
{
    char page[1024], path[300];
    himc_error error;
    int size =
        snprintf(page, sizeof page,
                 "<!doctype html><meta charset=utf-8><meta name=referrer content=no-referrer>"
                 "<meta http-equiv=refresh content=\"0;url=%s\"><a href=\"%s\">himc</a>\n",
                 url, url);
    if (!folder_make(f, &error) || !folder_write(f, WEB_DOOR, page, (size_t)size, &error)) {
        fprintf(stderr, "himc-viewer: no browser is opened: %s\n", error.text);
        return;
    }
    snprintf(path, sizeof path, "%s/" WEB_DOOR, f->path);
    signal(SIGCHLD, SIG_IGN);
    if (fork() == 0) {
        if (!freopen("/dev/null", "w", stderr) || !freopen("/dev/null", "w", stdout))
            _exit(1);
        execlp("xdg-open", "xdg-open", path, (char *)NULL);
        _exit(1);
    }
}

static void handle_signals(void)
{
    struct sigaction act = {.sa_handler = on_signal};
    sigaction(SIGINT, &act, NULL);
    sigaction(SIGTERM, &act, NULL);
    signal(SIGPIPE, SIG_IGN);
}

static bool check_edit(const options *o, himc_error *error)
{
    if (o->play)
        return himc_error_set(error, "--play and --edit: expected one of them");
    return access(o->edit, R_OK) == 0 ||
           himc_error_set(error, "%.200s: %s", o->edit, strerror(errno));
}

static int serve(const options *o, himc_error *error)
{
    static scene s;
    folder f = {.path = ""};
    web_config config = {.address = o->address, .port = o->http};
    char *recording = o->play ? recording_load(o->play, &config.play_size, error) : NULL, url[192],
         key[EDITOR_KEY + 1];
    if ((o->play && !recording) || !editor_key(key, error) || (o->edit && !check_edit(o, error))) {
        free(recording);
        return fail(error);
    }
    if (o->edit && !editor_check(o->edit))
        return 1;
    folder_remove_stale();
    config.edit = o->edit;
    config.folder = &f;
    config.key = key;
    config.play = recording;
    config.play_name = o->play;
    config.osc = receive_open(o->address, o->osc, error);
    web *w = config.osc < 0 ? NULL : web_new(&config, &s, error);
    if (!w) {
        free(recording);
        return fail(error);
    }
    // before the address is printed, so that a signal sent after it ends the program cleanly
    handle_signals();
    print_url(url, o->address, web_port(w), key);
    printf("%s shows what arrives as OSC at %s UDP port %d\n", url, o->address,
           receive_port(config.osc));
    fflush(stdout);
    if (o->browser)
        open_browser(&f, url);
    web_run(w, &stop);
    web_free(w);
    folder_remove(&f);
    free(recording);
    return 0;
}

int main(int argc, char **argv)
{
    options o = {.address = "127.0.0.1", .osc = OSC_PORT, .http = HTTP_PORT, .browser = true};
    himc_error error;
    if (argc == 2 && (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h"))) {
        fputs(help, stdout);
        return 0;
    }
    if (!parse(&o, argv, &error))
        return fail(&error);
    return serve(&o, &error);
}
