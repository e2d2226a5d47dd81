/// edit.c: `himc edit`: a piece under edit, for a program that shows it (himc-viewer --edit).
///
/// Lines in at standard input, frames out at standard output, in the form of a scene's chunks:
/// docs/viewer.md has both. The text is changed at once; playing follows, again from shortly before
/// the change, while more lines may come.
#define _POSIX_C_SOURCE 200809L // open_memstream
#include "base/file.h"
#include "base/text.h"
#include "capture/take.h"
#include "cli.h"
#include "edit_journal.h"
#include "edit_play.h"
#include "edit_text.h"
#include "musicxml/import.h"
#include "musicxml/score_file.h"
#include "performance/performance_body.h"
#include "performance/performance_drums.h"
#include "plan/score.h"
#include "scene.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { CONFINED, CHECK, NAME, TAKE };
#define LINE 4096                       // a line of standard input (bytes); chosen
#define TAKEN_BACK "back"               // line of a journal after one that could not be played
#define FILE_NAME 64                    // of a file for the page, with its final 0
#define LARGEST_TEXT ((size_t)64 << 20) // as himc_score_load

static const cli_option options[] = {
    {"confined", 0, NULL, "refuses a score that names other files"},
    {"check", 0, NULL, "only tells whether the source can be edited, and changes nothing"},
    {"name", 0, "NAME", "the name under which a page has sent the source"},
    CLI_TAKE_OPTIONS,
    {0},
};

typedef struct session {
    const char *source;
    const char *name; ///< for people: that of the source, or under which it was sent
    bool confined;    ///< the score may name no file
    himc_take_options take;
    edit_text *text;
    edit_journal journal;
    himc_error restored, unkept; ///< a line about the journal for the page, or ""
    himc_error held;             ///< a line about what is not carried out in an edit, or ""
    edit_play *play, *saver;     ///< `saver` while a take is saved
    char saved[256];             ///< the take's temporary file
    char wanted[FILE_NAME];      ///< and the name under which it is wanted
    char line[LINE];
    size_t used;
    bool cut;      ///< the rest of a line that was too long is to come
    bool played;   ///< once, at least a part
    bool unproved; ///< the text has not been played yet, nor failed; its last change is open
    bool over;     ///< no more lines
} session;

// --- frames out

static void put(const char *kind, const void *bytes, size_t size)
{
    uint32_t length = (uint32_t)size;
    fwrite(kind, 4, 1, stdout);
    fwrite(&length, sizeof length, 1, stdout);
    fwrite(bytes, 1, size, stdout);
}

// the line that an event answers, if any
static void print_answered(const char *line, FILE *to)
{
    if (!line)
        return;
    fputs(",\"line\":", to);
    cli_put_json_text(to, line);
}

// a line of JSON about the edit; `line` is what it answers, or NULL
static void tell(const char *event, const char *text, const char *line)
{
    char *json = NULL;
    size_t size;
    FILE *to = open_memstream(&json, &size);
    if (!to)
        return;
    fprintf(to, "{\"event\":\"%s\",\"text\":", event);
    cli_put_json_text(to, text);
    print_answered(line, to);
    fputc('}', to);
    fclose(to);
    put("edit", json, size);
    free(json);
}

// `begun`: all that was told before is of no value; `line` is what it answers, or NULL
static void tell_text(const session *s, bool begun, const char *line)
{
    char *json = NULL;
    size_t size;
    FILE *to = open_memstream(&json, &size);
    if (!to)
        return;
    fprintf(to, "{\"event\":\"text\",\"begun\":%s,\"take\":%s,\"kept\":%s,\"source\":",
            begun ? "true" : "false", cli_is_take(s->source) ? "true" : "false",
            s->unkept.text[0] ? "false" : "true");
    cli_put_json_text(to, s->name);
    fputc(',', to);
    edit_text_print(s->text, to);
    print_answered(line, to);
    fputc('}', to);
    fclose(to);
    put("edit", json, size);
    free(json);
}

// a source by the name that people know; only once, where its score names it, too
static void name_source(const session *s, himc_error *error)
{
    himc_error said = *error;
    size_t name = strlen(s->name), source = strlen(s->source);
    const char *at = strstr(said.text, s->source), *line = said.text + name;
    if (!strncmp(said.text, s->name, name) && !strncmp(line, ":1: ", 4) &&
        !strncmp(line + 4, s->source, source))
        himc_error_set(error, "%s%s", s->name, line + 4 + source);
    else if (at && s->name != s->source)
        himc_error_set(error, "%.*s%s%s", (int)(at - said.text), said.text, s->name, at + source);
}

// --- the piece

static char *text_of_music(himc_score_maker *make, const char *bytes, size_t size, const char *name,
                           himc_error *error)
{
    midi_score made = {0};
    char *text = NULL;
    if (make(&made, bytes, size, name, NULL, error))
        text = strdup(made.text);
    else
        himc_error_prefix(error, "%s", name);
    himc_midi_score_free(&made);
    return text;
}

static himc_state_line take_line(const char *file)
{
    himc_state_line line = himc_state_begin("take");
    himc_state_word(&line, file);
    return line;
}

static char *text_of(const char *source, const char *name, himc_error *error)
{
    size_t size;
    if (cli_is_take(source)) {
        himc_state_line line = take_line(source);
        char *text = malloc(line.used + 3);
        if (text)
            sprintf(text, "%.*s;\n", (int)line.used, line.text);
        return text;
    }
    char *bytes = himc_file_load(source, LARGEST_TEXT, &size, error);
    himc_score_maker *make = bytes ? himc_score_maker_of(bytes, size) : NULL;
    if (!bytes || (!make && himc_score_is_text(bytes, size, name, error)))
        return bytes;
    char *text = make ? text_of_music(make, bytes, size, name, error) : NULL;
    free(bytes);
    return text;
}

static bool is_among(const char *const *names, int count, const char *name)
{
    for (int i = 0; i < count; i++)
        if (!strcmp(names[i], name))
            return true;
    return false;
}

// true if the strokes' drums are those that will be there: the score's, or the program's own
static bool has_drums(const session *s, const himc_score *score, himc_error *error)
{
    const char *names[HIMC_DRUMS] = {CLI_DRUM};
    int count = !cli_first_drum(score);
    for (int i = 0; i < score->line_count && count < HIMC_DRUMS; i++) {
        const himc_command *c = &score->lines[i].command;
        if (himc_score_makes_drum(&score->lines[i]) && !is_among(names, count, c->atom[0].symbol))
            names[count++] = c->atom[0].symbol;
    }
    for (int i = 0; i < score->stroke_count; i++) {
        const himc_stroke *stroke = &score->strokes[i];
        if (!stroke->drum[0] || is_among(names, count, stroke->drum))
            continue;
        himc_drums_refuse_of(names, count, stroke->drum, stroke->spot, error);
        return himc_error_prefix(error, "%s:%d", s->name, score->stroke_lines[i]);
    }
    return true;
}

// true if the pushes are on segments that can be pushed
static bool has_segments(const session *s, const himc_score *score, himc_error *error)
{
    planned_push unused;
    himc_stance stance = HIMC_STANCE_FIXED;
    for (int i = 0; i < score->line_count; i++)
        if (score->lines[i].command.id == HIMC_COMMAND_STANCE)
            stance = (himc_stance)score->lines[i].command.choice[0];
    for (int i = 0; i < score->change_count; i++) {
        const himc_score_line *l = &score->changes[i];
        if (!l->drum[0] && !himc_body_read_push(&l->command, stance, &unused, error))
            return himc_error_prefix(error, "%s:%d", s->name, l->line);
    }
    return true;
}

// the score of a text; NULL with the reason, also if it may not name the files that it names
static himc_score *parse(const session *s, const edit_text *t, himc_error *error)
{
    int line;
    char *text = edit_text_join(t);
    himc_score *score = text ? himc_score_parse(text, s->name, NULL, error) : NULL;
    free(text);
    if (!score || !s->confined || !edit_text_names_file(score, &line))
        return score;
    himc_error_set(error,
                   "%s:%d: names other files, which a score from a page may not; open it by "
                   "himc-viewer --edit",
                   s->name, line);
    himc_score_free(score);
    return NULL;
}

static bool check(const session *s, const edit_text *t, himc_error *error)
{
    himc_score *score = parse(s, t, error);
    bool good = score && has_drums(s, score, error) && has_segments(s, score, error);
    himc_score_free(score);
    return good;
}

// the first file that the score would record is named for the page
static void hold_back(session *s)
{
    himc_error unused;
    himc_score *score = parse(s, s->text, &unused);
    for (int i = 0; score && i < score->line_count && !s->held.text[0]; i++) {
        const himc_command *c = &score->lines[i].command;
        int file;
        if (himc_command_file(c, &file) == HIMC_FILE_WRITE)
            himc_error_set(&s->held,
                           "%.80s:%d: record %.100s: nothing is recorded in an edit; save it here, "
                           "or with himc render",
                           s->name, score->lines[i].line, c->atom[file].symbol);
    }
    himc_score_free(score);
}

// its beats are then seconds
static bool has_take(const himc_score *score)
{
    for (int i = 0; i < score->line_count; i++)
        if (score->lines[i].command.id == HIMC_COMMAND_TAKE)
            return true;
    return false;
}

// plays the text as it is now; all of it, or from before the last change
static bool replay(session *s, bool all, himc_error *error)
{
    char *text = edit_text_played(s->text);
    himc_score *score = parse(s, s->text, error);
    double from = all ? -1 : edit_text_changed_from(s->text);
    if (from > 0 && score && !has_take(score))
        from = himc_score_seconds(score->tempi, score->tempo_count, from);
    bool good = text && edit_play_start(s->play, text, from, NULL, error);
    s->unproved = good;
    himc_score_free(score);
    free(text);
    return good;
}

// --- lines in

static bool set(edit_text *t, const char *words, himc_error *error)
{
    char *end;
    long index = strtol(words, &end, 10);
    if (end == words || (*end && *end != ' '))
        return himc_error_set(error, "set: no number of a statement");
    return edit_text_set(t, (int)fmax(-1, fmin(index, 1e9)), end + (*end == ' '), error);
}

// obeys a line that changes the text; the change is open then
static bool change(edit_text *t, const char *line, himc_error *error)
{
    if (!strcmp(line, "undo"))
        return edit_text_undo(t) || himc_error_set(error, "nothing to undo");
    if (!strcmp(line, "redo"))
        return edit_text_redo(t) || himc_error_set(error, "nothing to redo");
    if (!strcmp(line, "revert"))
        return edit_text_revert(t) || himc_error_set(error, "nothing to undo");
    if (!strncmp(line, "set ", 4))
        return set(t, line + 4, error);
    return himc_error_set(error, "\"%.40s\": expected hello, set, undo, redo, revert, save, take",
                          line);
}

// --- what was changed before

static void unkept(session *s, const himc_error *why)
{
    himc_error_set(&s->unkept, "Changes are lost when this page ends, save them: %s", why->text);
}

// The changes of the journal; false if they do not fit. `back` takes the one before it back; the
// last one stays open: the program may have been killed before it was played.
static bool change_again(const session *s, edit_text *t, himc_error *error)
{
    bool good = true;
    for (char *line = s->journal.lines, *end; good && (end = strchr(line, '\n')); line = end + 1) {
        *end = 0;
        bool back = !strcmp(line, TAKEN_BACK);
        edit_text_settle(t, !back);
        good = back || change(t, line, error);
        *end = '\n';
    }
    return good && check(s, t, error);
}

// the journal is of another text than the source's, or damaged: what it has led to, or else the
// journal, is kept beside it
static void keep_old(session *s, himc_error *error)
{
    char kept[4096], *text = NULL, *now = edit_text_join(s->text);
    edit_text *t = s->journal.damaged ? NULL : edit_text_new(s->journal.old, error);
    bool known = t && change_again(s, t, error) && (text = edit_text_join(t)) && now;
    if (known && !strcmp(text, now)) // it has been saved over the source
        edit_journal_forget(&s->journal);
    else if (edit_journal_keep(&s->journal, known ? text : NULL, kept, error)) {
        edit_journal_forget(&s->journal);
        himc_error_set(&s->restored,
                       s->journal.damaged
                           ? "%.80s: its changes from before cannot be read, and are kept in %s"
                       : known ? "%.80s has changed since it was edited here: the edited score is "
                                 "kept in %s"
                               : "%.80s: its changes from before do not fit it, and are kept in %s",
                       s->name, kept);
    } else {
        unkept(s, error);
        edit_journal_close(&s->journal);
    }
    edit_text_free(t);
    free(text);
    free(now);
}

// finds the journal of `text`, and makes its changes
static void restore(session *s, const char *text, bool sent)
{
    himc_error error = {""};
    // a take that was sent stands under another path each time
    bool nameless = sent && cli_is_take(s->source);
    if (!edit_journal_open(&s->journal, s->source, s->name, sent, nameless ? "" : text, &error)) {
        unkept(s, &error);
        return;
    }
    if (!s->journal.lines && !s->journal.damaged)
        return;
    if (s->journal.damaged || s->journal.old || !change_again(s, s->text, &error)) {
        if (!s->journal.damaged && !s->journal.old)
            s->journal.old = strdup(text);
        edit_text_free(s->text);
        s->text = edit_text_new(text, &error);
        keep_old(s, &error);
        return;
    }
    int count = edit_text_changes(s->text);
    himc_error_set(&s->restored,
                   "%d change%s from before %s here again. \"file's text\" goes back to "
                   "the file, redo brings %s again",
                   count, count == 1 ? "" : "s", count == 1 ? "is" : "are",
                   count == 1 ? "it" : "them");
    if (count == 0)
        himc_error_set(&s->restored, "The file's text; redo brings the changes from before again");
}

// --- for the page

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
    char *text = edit_text_played(s->text);
    s->saver = text ? edit_play_new(s->name, &s->take, error) : NULL;
    bool good = s->saver && edit_play_start(s->saver, text, -1, s->saved, error);
    free(text);
    if (!good)
        stop_saving(s);
    return good;
}

static void put_file(const char *name, const char *bytes, size_t size)
{
    char head[FILE_NAME];
    memset(head, 0, sizeof head);
    snprintf(head, sizeof head, "%s", name);
    char *all = malloc(sizeof head + size);
    if (!all)
        return;
    memcpy(all, head, sizeof head);
    memcpy(all + sizeof head, bytes, size);
    put("file", all, sizeof head + size);
    free(all);
}

// the score, in which a take that a page has sent has the name under which it was sent
static void put_score(const session *s, const char *file, const char *text)
{
    himc_state_line own = take_line(s->source), sent = take_line(s->name);
    const char *at = s->name != s->source ? strstr(text, own.text) : NULL;
    char *renamed = at ? malloc(strlen(text) + sent.used + 1) : NULL;
    if (renamed)
        sprintf(renamed, "%.*s%.*s%s", (int)(at - text), text, (int)sent.used, sent.text,
                at + own.used);
    const char *all = renamed ? renamed : text;
    put_file(file, all, strlen(all));
    free(renamed);
}

static bool save_score(const session *s)
{
    const char *slash = strrchr(s->name, '/'), *name = slash ? slash + 1 : s->name,
               *dot = strrchr(name, '.');
    char *text = edit_text_join(s->text), file[FILE_NAME];
    int length = dot && dot > name ? (int)(dot - name) : (int)strlen(name);
    for (; length > FILE_NAME - 5 || (length && (name[length] & 0xc0) == 0x80); length--)
        ; // whole characters
    snprintf(file, sizeof file, "%.*s.txt", length, name);
    if (text)
        put_score(s, file, text);
    bool good = text != NULL;
    free(text);
    return good;
}

// tells the page how the piece stands when it comes
static void greet(session *s)
{
    tell_text(s, true, NULL);
    if (s->unkept.text[0])
        tell("unkept", s->unkept.text, NULL);
    if (s->restored.text[0])
        tell("restored", s->restored.text, NULL);
    if (s->held.text[0])
        tell("held", s->held.text, NULL);
}

static void keep(session *s, const char *line)
{
    himc_error error = {""};
    if (s->unkept.text[0] || edit_journal_add(&s->journal, line, &error))
        return;
    unkept(s, &error);
    tell("unkept", s->unkept.text, NULL);
}

// one line; false with the reason, and *fatal if nothing can be played any more
static bool obey(session *s, const char *line, bool *fatal, himc_error *error)
{
    bool hello = !strcmp(line, "hello");
    if (!strcmp(line, "save"))
        return save_score(s);
    if (!strncmp(line, "take ", 5))
        return save_take(s, line + 5, error);
    if (hello)
        greet(s);
    else if (!change(s->text, line, error))
        return false;
    else if (!check(s, s->text, error))
        return edit_text_settle(s->text, false), false;
    else {
        bool changed = edit_text_is_open(s->text);
        if (changed)
            keep(s, line);
        tell_text(s, false, line);
        if (!changed)
            return true;
    }
    *fatal = !replay(s, hello, error);
    return !*fatal;
}

// --- what is played

// a change that cannot be played is undone
static bool take_back(session *s, const edit_frame *frame, himc_error *error)
{
    himc_error failure;
    // never played: what was made before a kill may be what cannot be played
    bool first = !s->played, last = edit_text_settle(s->text, false),
         all = first && !last && edit_text_revert(s->text), undone = last || all;
    edit_text_settle(s->text, true);
    himc_error_set(&failure, "%.*s", (int)frame->size, (const char *)frame->bytes);
    name_source(s, &failure);
    if (!undone && first)
        return himc_error_set(error, "%s", failure.text);
    s->unproved = false;
    if (undone) {
        keep(s, all ? "revert" : TAKEN_BACK);
        tell_text(s, false, NULL);
    }
    tell(undone ? "undone" : "failed", failure.text, NULL);
    if (!undone)
        return true;
    return replay(s, first, error);
}

static bool pass_frame(session *s, himc_error *error)
{
    edit_frame frame;
    if (!edit_play_next(s->play, &frame, error))
        return false;
    bool sounds = !strcmp(frame.kind, "pcm ");
    s->played |= sounds;
    if (sounds || !strcmp(frame.kind, "over")) {
        edit_text_settle(s->text, true);
        s->unproved = false;
    }
    if (!strcmp(frame.kind, "fail"))
        return take_back(s, &frame, error);
    if (strcmp(frame.kind, "late") && strcmp(frame.kind, "bye!"))
        put(frame.kind, frame.bytes, frame.size);
    return true;
}

// waits until the text has been played or taken back, so that a failure is that of the last line
static bool prove(session *s, himc_error *error)
{
    bool good = true;
    fflush(stdout);
    while (good && s->unproved)
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
                tell("refused", "a line with a zero byte", NULL);
            s->cut = false;
            continue;
        }
        *fatal = !prove(s, error);
        if (*fatal || !obey(s, begin, fatal, error)) {
            if (*fatal)
                return false;
            tell("refused", error->text, begin);
        }
    }
    s->used -= (size_t)(begin - s->line);
    memmove(s->line, begin, s->used);
    if (s->used == sizeof s->line) {
        if (!s->cut)
            tell("refused", "a line is too long", NULL);
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
    char *bytes = himc_file_load(s->saved, LARGEST_TEXT, &size, &error);
    if (bytes && size)
        put_file(s->wanted, bytes, size);
    else
        tell("refused", "the take could not be saved", NULL);
    free(bytes);
    stop_saving(s);
}

static bool serve(session *s, himc_error *error)
{
    bool fatal = false;
    while (!s->over && !ferror(stdout)) {
        struct pollfd from[] = {
            {.fd = STDIN_FILENO, .events = POLLIN},
            {.fd = edit_play_descriptor(s->play), .events = POLLIN},
            {.fd = s->saver ? edit_play_descriptor(s->saver) : -1, .events = POLLIN}};
        if (poll(from, 3, edit_play_holds(s->play) ? 0 : -1) < 0 && errno != EINTR)
            return himc_error_set(error, "%s", strerror(errno));
        if (from[0].revents && !read_lines(s, &fatal, error))
            return false;
        if (!from[0].revents && (from[1].revents || edit_play_holds(s->play)) &&
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
    const char *sent = arguments->value[NAME];
    session s = {.source = arguments->operand, .name = sent ? sent : arguments->operand};
    bool good = !cli_is_standard(s.source) ||
                himc_error_set(&error, "-: expected a file, lines come from standard input");
    good = good && cli_take_options(s.source, arguments->value + TAKE, &s.take, &error);
    char *text = good ? text_of(s.source, s.name, &error) : NULL;
    s.confined = arguments->value[CONFINED] && !cli_is_take(s.source);
    s.text = text ? edit_text_new(text, &error) : NULL;
    good = s.text && check(&s, s.text, &error);
    bool only = good && arguments->value[CHECK];
    if (good && !only) {
        hold_back(&s);
        restore(&s, text, sent);
    }
    s.play = good && !only && s.text ? edit_play_new(s.name, &s.take, &error) : NULL;
    good = only || (s.play && serve(&s, &error));
    if (!good) {
        name_source(&s, &error);
        tell("failed", error.text, NULL);
        fflush(stdout);
    }
    edit_play_free(s.play);
    stop_saving(&s);
    edit_journal_close(&s.journal);
    edit_text_free(s.text);
    free(text);
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
