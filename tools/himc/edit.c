/// edit.c: `himc edit`: a piece under edit, for a program that shows it (himc-viewer --edit).
///
/// Lines in at standard input, frames out at standard output, in the form of a scene's chunks:
/// docs/viewer.md has both.
#define _POSIX_C_SOURCE 200809L
#include "base/file.h"
#include "capture/take.h"
#include "cli.h"
#include "edit_session.h"

#include <errno.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { CONFINED, CHECK, NAME, TAKE };
#define LINE 4096    // a line of standard input (bytes); chosen
#define FILE_NAME 64 // of a file for the page, with its final 0

static const cli_option options[] = {
    {"confined", 0, NULL, "refuses a score that names other files"},
    {"check", 0, NULL, "only tells whether the source can be edited, and changes nothing"},
    {"name", 0, "NAME", "the name under which a page has sent the source"},
    CLI_TAKE_OPTIONS,
    {0},
};

typedef struct session {
    edit_session piece;
    edit_play *saver;       ///< while a take is saved
    char saved[256];        ///< the take's temporary file
    char wanted[FILE_NAME]; ///< and the name under which it is wanted
    char line[LINE];
    size_t used;
    bool cut;  ///< the rest of a line that was too long is to come
    bool over; ///< no more lines
} session;

static void stop_saving(session *s)
{
    edit_play_free(s->saver); // first: it may be writing
    s->saver = NULL;
    if (s->saved[0])
        cli_temporary_remove(s->saved);
    s->saved[0] = 0;
}

static bool save_take(session *s, const char *name, himc_error *error)
{
    const char *dot = strrchr(name, '.');
    if (!dot)
        return himc_error_set(error, "%.40s: expected a suffix", name);
    if (!himc_take_can_save(name, error))
        return false;
    if (s->saver)
        return himc_error_set(error, "a take is being saved");
    int file = cli_temporary(s->saved, sizeof s->saved, dot);
    if (file < 0)
        return himc_error_set(error, "%s", strerror(errno));
    close(file);
    snprintf(s->wanted, sizeof s->wanted, "%s", name);
    char *text = edit_text_played(s->piece.text);
    s->saver = text ? edit_play_new(s->piece.name, &s->piece.take, error) : NULL;
    bool good = s->saver && edit_play_start(s->saver, text, EDIT_ALL, s->saved, error);
    free(text);
    if (!good)
        stop_saving(s);
    return good;
}

static bool pass_frame(session *s, himc_error *error)
{
    edit_frame frame;
    if (!edit_play_next(s->piece.play, &frame, error) ||
        !edit_session_hear(&s->piece, &frame, error))
        return false;
    if (strcmp(frame.kind, "late") && strcmp(frame.kind, "bye!") && strcmp(frame.kind, "fail"))
        edit_session_put(frame.kind, frame.bytes, frame.size);
    return true;
}

// waits until the text has been played or taken back, so that a failure is that of the last line
static bool prove(session *s, himc_error *error)
{
    bool good = true;
    fflush(stdout);
    while (good && s->piece.unproved)
        good = pass_frame(s, error);
    return good;
}

static bool read_lines(session *s, bool *fatal, himc_error *error)
{
    ssize_t got = read(STDIN_FILENO, s->line + s->used, sizeof s->line - s->used);
    char *begin = s->line, *end;
    s->over = got == 0 || (got < 0 && errno != EINTR);
    s->used += got > 0 ? (size_t)got : 0;
    for (; (end = memchr(begin, '\n', s->used - (size_t)(begin - s->line))); begin = end + 1) {
        *end = 0;
        if (s->cut || memchr(begin, 0, (size_t)(end - begin))) {
            if (!s->cut)
                edit_session_tell("refused", "a line with a zero byte", NULL);
            s->cut = false;
            continue;
        }
        *fatal = !prove(s, error);
        bool take = !strncmp(begin, "take ", 5);
        if (*fatal || !(take ? save_take(s, begin + 5, error)
                             : edit_session_obey(&s->piece, begin, fatal, error))) {
            if (*fatal)
                return false;
            edit_session_tell("refused", error->text, begin);
        }
    }
    s->used -= (size_t)(begin - s->line);
    memmove(s->line, begin, s->used);
    if (s->used == sizeof s->line) {
        if (!s->cut)
            edit_session_tell("refused", "a line is too long", NULL);
        s->cut = true;
        s->used = 0;
    }
    return true;
}

// of the take that is being saved
static void take_saved(session *s)
{
    edit_frame frame;
    himc_error error = {""};
    size_t size;
    if (edit_play_next(s->saver, &frame, &error) && strcmp(frame.kind, "over") &&
        strcmp(frame.kind, "fail"))
        return;
    char *bytes = himc_file_load(s->saved, EDIT_LARGEST, &size, &error);
    if (bytes && size)
        edit_session_put_file(s->wanted, bytes, size);
    else
        edit_session_tell("refused", "the take could not be saved", NULL);
    free(bytes);
    stop_saving(s);
}

static bool serve(session *s, himc_error *error)
{
    bool fatal = false;
    while (!s->over && !ferror(stdout)) {
        struct pollfd from[] = {
            {.fd = STDIN_FILENO, .events = POLLIN},
            {.fd = edit_play_descriptor(s->piece.play), .events = POLLIN},
            {.fd = s->saver ? edit_play_descriptor(s->saver) : -1, .events = POLLIN}};
        if (poll(from, 3, edit_play_holds(s->piece.play) ? 0 : -1) < 0 && errno != EINTR)
            return himc_error_set(error, "%s", strerror(errno));
        if (from[0].revents && !read_lines(s, &fatal, error))
            return false;
        if (!from[0].revents && (from[1].revents || edit_play_holds(s->piece.play)) &&
            !pass_frame(s, error))
            return false;
        if (from[2].revents && s->saver)
            take_saved(s);
        fflush(stdout);
    }
    return true;
}

static int run(const cli_arguments *arguments)
{
    himc_error error = {""};
    const char *source = arguments->operand, *sent = arguments->value[NAME];
    bool only_check = arguments->value[CHECK];
    session s = {.piece = {.source = source,
                           .name = sent ? sent : source,
                           .sent = sent,
                           .confined = arguments->value[CONFINED] && !cli_is_take(source)}};
    bool good = !cli_is_standard(source) ||
                himc_error_set(&error, "-: expected a file, lines come from standard input");
    good = good && cli_take_options(source, arguments->value + TAKE, &s.piece.take, &error) &&
           edit_session_open(&s.piece, only_check, &error) && (only_check || serve(&s, &error));
    if (!good) {
        edit_session_name(&s.piece, &error);
        edit_session_tell("failed", error.text, NULL);
        fflush(stdout);
    }
    stop_saving(&s);
    edit_session_close(&s.piece);
    return good ? 0 : cli_fail(&cli_edit, "%s", error.text);
}

const cli_call cli_edit = {
    "edit",
    "SOURCE",
    "",
    "changes a piece while it is shown: for himc-viewer --edit",
    "Lines of standard input change the score or take, frames on standard output tell how it\n"
    "is played then (docs/viewer.md). `hello` plays from the start.",
    options,
    run,
};
