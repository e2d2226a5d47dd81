/// film.c: `himc film`: a film, a still or the moving figure of a scene, by a browser without a
/// window.
///
/// The browser opens the page of `himc share`, which draws frame by frame (viewer/page/film.js) and
/// hands the finished file over in pieces.
#define _POSIX_C_SOURCE 200809L // fdopen
#include "cli.h"

#include <stdlib.h>
#include <string.h>

enum { OUT, SIZE, FPS, CAMERA, FROM, TO, SPEED, AT };

static const cli_option options[] = {
    {"output", 'o', "F.webm", "the film; F.png: a still; F.glb: figure and motion as glTF"},
    {"size", 0, "WxH", "of the picture, 64x64 .. 4096x4096 pixels (1280x720)"},
    {"fps", 0, "N", "pictures a second, 1 .. 120 (30)"},
    {"camera", 0, "NAME", "stage, front, side, top, eye, hands or head (stage)"},
    {"from", 0, "S", "where the film begins (s)"},
    {"to", 0, "S", "where it ends (s)"},
    {"speed", 0, "X", "of what is shown and heard, 0.02 .. 2 (1)"},
    {"at", 0, "S", "the time of a still (s)"},
    {0},
};

/// The arguments.
typedef struct film_job {
    const char *scene, *out, *kind, *camera;
    int width, height, fps;
    double from, to, speed, at;
} film_job;

static bool read_number(const char *name, const char *text, double low, double high, double *out,
                        himc_error *error)
{
    char *end;
    double value = text ? strtod(text, &end) : *out;
    if (text && (end == text || *end || !(value >= low && value <= high)))
        return himc_error_set(error, "--%s %s: expected %g .. %g", name, text, low, high);
    *out = value;
    return true;
}

static bool read_size(const char *text, int *width, int *height, himc_error *error)
{
    int n = 0;
    if (!text)
        return true;
    if (sscanf(text, "%dx%d%n", width, height, &n) == 2 && !text[n] && *width >= 64 &&
        *width <= 4096 && *height >= 64 && *height <= 4096)
        return true;
    return himc_error_set(error, "--size %s: expected 64x64 .. 4096x4096", text);
}

static bool is_word(const char *word, const char *list)
{
    size_t length = strlen(word);
    const char *at = length && !strchr(word, ' ') ? strstr(list, word) : NULL;
    return at && (at == list || at[-1] == ' ') && (at[length] == ' ' || !at[length]);
}

static bool read_job(const cli_arguments *arguments, film_job *out, himc_error *error)
{
    static const char kinds[] = "webm png glb", cameras[] = "stage front side top eye hands head";
    const char *const *value = arguments->value,
                      *dot = value[OUT] ? strrchr(value[OUT], '.') : NULL;
    *out = (film_job){.scene = cli_input(arguments->operand, error),
                      .out = value[OUT],
                      .kind = dot ? dot + 1 : "",
                      .camera = value[CAMERA] ? value[CAMERA] : "stage",
                      .width = 1280,
                      .height = 720,
                      .fps = 30,
                      .to = 1e6,
                      .speed = 1};
    if (!out->scene)
        return false;
    if (!out->out)
        return himc_error_set(error, "no -o F.webm given (himc film --help)");
    if (!is_word(out->kind, kinds))
        return himc_error_set(error, "%s: expected endings are .webm, .png, .glb", out->out);
    if (!is_word(out->camera, cameras))
        return himc_error_set(error, "--camera %s: expected %s", out->camera, cameras);
    if (!cli_apart(out->out, &out->scene, 1, error))
        return false;
    if (!read_size(value[SIZE], &out->width, &out->height, error) ||
        !cli_count("--fps", value[FPS], 1, 120, "", &out->fps, error) ||
        !read_number("from", value[FROM], 0, 1e6, &out->from, error) ||
        !read_number("to", value[TO], 0, 1e6, &out->to, error) ||
        !read_number("speed", value[SPEED], 0.02, 2, &out->speed, error) ||
        !read_number("at", value[AT], 0, 1e6, &out->at, error))
        return false;
    return out->to > out->from ||
           himc_error_set(error, "--to %g: expected more than %g, where it begins", out->to,
                          out->from);
}

#if defined HIMC_SHARE && !defined _WIN32
#include "base/file.h"
#include "browser.h"
#include "recording.h"
#include "share.h"

#include <errno.h>

#define PAGE (BROWSER_HOME + 16) // characters of a file's name
#define PATIENCE 600             // answers, each after half a second, without progress; chosen

// the page, in a file whose name `path` becomes
static bool write_page(const browser *b, const char *scene, size_t size, const char *source,
                       char path[PAGE], himc_error *error)
{
    snprintf(path, PAGE, "%s/page.html", browser_home(b));
    FILE *page = himc_file_write(path, HIMC_FILE_REPLACE, error);
    bool good = page && share_write(page, scene, size, source, error);
    if (page && fclose(page) && good)
        good = himc_error_set(error, "%s: cannot be written: %s", path, strerror(errno));
    return good;
}

static void show_progress(const char *text)
{
    if (cli_shows_progress())
        fprintf(stderr, text ? "\r%5.1f %% " : "\r\033[K", text ? 100 * atof(text) : 0.0);
}

// waits until the page has made the file
static bool wait_for_it(browser *b, himc_error *error)
{
    const char *said;
    char last[32] = "";
    int same = 0;
    do {
        said = browser_run(b, "viewer.exporter.wait(500)", error);
        if (said)
            show_progress(said);
        same = said && !strcmp(said, last) ? same + 1 : 0;
        snprintf(last, sizeof last, "%s", said ? said : "");
    } while (said && strcmp(said, "done") != 0 && strncmp(said, "failed", 6) != 0 &&
             same < PATIENCE);
    show_progress(NULL);
    if (same == PATIENCE)
        return himc_error_set(error, "the page: no progress in %d s", PATIENCE / 2);
    return said && (!strcmp(said, "done") || himc_error_set(error, "the page: %.300s", said + 7));
}

static int digit(char c)
{
    return c >= 'A' && c <= 'Z'   ? c - 'A'
           : c >= 'a' && c <= 'z' ? c - 'a' + 26
           : c >= '0' && c <= '9' ? c - '0' + 52
           : c == '+'             ? 62
                                  : 63;
}

static void write_base64(FILE *out, const char *text)
{
    for (; text[0] && text[1] && text[2] && text[3]; text += 4) {
        int last = text[2] == '=' ? 1 : text[3] == '=' ? 2 : 3;
        int bits =
            digit(text[0]) << 18 | digit(text[1]) << 12 | digit(text[2]) << 6 | digit(text[3]);
        for (int i = 0; i < last; i++)
            fputc(bits >> (16 - 8 * i) & 255, out);
    }
}

static bool take_pieces(browser *b, FILE *out, himc_error *error)
{
    char script[64];
    for (int i = 0;; i++) {
        snprintf(script, sizeof script, "viewer.exporter.piece(%d)", i);
        const char *piece = browser_run(b, script, error);
        if (!piece || !*piece)
            return piece != NULL;
        write_base64(out, piece);
    }
}

static bool film(browser *b, const char *page, const film_job *j, FILE *out, himc_error *error)
{
    char text[512];
    snprintf(text, sizeof text, "file://%s#held", page);
    // until the scene and its sound are there
    const char *said =
        browser_go(b, text, error)
            ? browser_run(b,
                          "new Promise(r => (setTimeout(() => r('failed the scene is not there "
                          "after four minutes'), 240000), setInterval(() => self.viewer && "
                          "(viewer.failed ? r('failed ' + viewer.failed) : viewer.playback && "
                          "viewer.ready && r('yes')), 50)))",
                          error)
            : NULL;
    if (!said || !strncmp(said, "failed", 6))
        return said ? himc_error_set(error, "the page: %.300s", said + 7) : false;
    snprintf(text, sizeof text,
             "viewer.actions.camera('%s'), viewer.stage.quality = 1, viewer.exporter.start('%s', "
             "{fps: %d, from: %.17g, to: %.17g, speed: %.17g, at: %.17g}), 'yes'",
             j->camera, j->kind, j->fps, 1e3 * j->from, 1e3 * j->to, j->speed, 1e3 * j->at);
    return browser_run(b, text, error) && wait_for_it(b, error) && take_pieces(b, out, error);
}

static bool make(const film_job *j, himc_error *error)
{
    char page[PAGE];
    cli_file out = {0};
    browser *b = NULL;
    size_t size;
    char *scene = recording_load(j->scene, &size, error);
    bool good = scene && cli_file_open(&out, j->out, error) &&
                (b = browser_open(j->width, j->height, error)) != NULL &&
                write_page(b, scene, size, j->scene, page, error) &&
                film(b, page, j, out.stream, error) && cli_file_close(&out, error) &&
                cli_file_keep(&out, error);
    browser_close(b);
    cli_file_drop(&out);
    free(scene);
    return good;
}
#else
static bool make(const film_job *j, himc_error *error)
{
    return himc_error_set(error,
                          "%s to %s: this himc was built without three.js (Debian: libjs-three), "
                          "which the page needs",
                          j->scene, j->out);
}
#endif

static int run(const cli_arguments *arguments)
{
    himc_error error;
    film_job wanted;
    return read_job(arguments, &wanted, &error) && make(&wanted, &error)
               ? cli_finish(&cli_film)
               : cli_fail(&cli_film, "%s", error.text);
}

const cli_call cli_film = {
    "film",
    "SCENE",
    " -o F.webm",
    "makes a film with sound of a scene (himc render --scene), a still, or a glTF figure",
    "Needs a browser of the Chromium family (Debian: chromium), which is run without a window;\n"
    "HIMC_BROWSER names another. The film has each picture, however slow the machine is.",
    options,
    run,
};
