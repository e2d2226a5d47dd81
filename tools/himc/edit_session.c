/// edit_session.c: the text is changed at once; playing follows, again from shortly before the
/// change, while more lines may come. A change that cannot be played is taken back.
#define _POSIX_C_SOURCE 200809L // open_memstream
#include "edit_session.h"
#include "base/file.h"
#include "base/text.h"
#include "cli.h"
#include "musicxml/import.h"
#include "musicxml/score_file.h"
#include "performance/performance_body.h"
#include "performance/performance_drums.h"
#include "plan/score.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TAKEN_BACK "back" // line of a journal after one that could not be played
#define FILE_NAME 64      // of a file for the page, with its final 0

// --- frames out

void edit_session_put(const char *kind, const void *bytes, size_t size)
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

void edit_session_tell(const char *event, const char *text, const char *line)
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
    edit_session_put("edit", json, size);
    free(json);
}

// `begun`: all that was told before is of no value; `line` is what it answers, or NULL
static void tell_text(const edit_session *s, bool begun, const char *line)
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
    edit_session_put("edit", json, size);
    free(json);
}

// only once, where its score names it, too
void edit_session_name(const edit_session *s, himc_error *error)
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
    char *bytes = himc_file_load(source, EDIT_LARGEST, &size, error);
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
static bool has_drums(const edit_session *s, const himc_score *score, himc_error *error)
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
static bool has_segments(const edit_session *s, const himc_score *score, himc_error *error)
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
static himc_score *parse(const edit_session *s, const edit_text *t, himc_error *error)
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

static bool check(const edit_session *s, const edit_text *t, himc_error *error)
{
    himc_score *score = parse(s, t, error);
    bool good = score && has_drums(s, score, error) && has_segments(s, score, error);
    himc_score_free(score);
    return good;
}

// the first file that the score would record is named for the page
static void hold_back(edit_session *s)
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
static bool replay(edit_session *s, bool all, himc_error *error)
{
    char *text = edit_text_played(s->text);
    himc_score *score = parse(s, s->text, error);
    edit_span changed = edit_text_changed(s->text);
    if (score && !has_take(score)) {
        changed.from = himc_score_seconds(score->tempi, score->tempo_count, changed.from);
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            changed.strokes[hand] =
                himc_score_seconds(score->tempi, score->tempo_count, changed.strokes[hand]);
    }
    bool good = text && edit_play_start(s->play, text, all ? EDIT_ALL : changed, NULL, error);
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

static void unkept(edit_session *s, const himc_error *why)
{
    himc_error_set(&s->unkept, "Changes are lost when this page ends, save them: %s", why->text);
}

// The changes of the journal; false if they do not fit. `back` takes the one before it back; the
// last one stays open: the program may have been killed before it was played.
static bool change_again(const edit_session *s, edit_text *t, himc_error *error)
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
static void keep_old(edit_session *s, himc_error *error)
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
static void restore(edit_session *s, const char *text)
{
    himc_error error = {""};
    // a take that was sent stands under another path each time
    bool nameless = s->sent && cli_is_take(s->source);
    if (!edit_journal_open(&s->journal, s->source, s->name, s->sent, nameless ? "" : text,
                           &error)) {
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

void edit_session_put_file(const char *name, const char *bytes, size_t size)
{
    char head[FILE_NAME];
    memset(head, 0, sizeof head);
    snprintf(head, sizeof head, "%s", name);
    char *all = malloc(sizeof head + size);
    if (!all)
        return;
    memcpy(all, head, sizeof head);
    memcpy(all + sizeof head, bytes, size);
    edit_session_put("file", all, sizeof head + size);
    free(all);
}

// the score, in which a take that a page has sent has the name under which it was sent
static void put_score(const edit_session *s, const char *file, const char *text)
{
    himc_state_line own = take_line(s->source), sent = take_line(s->name);
    const char *at = s->name != s->source ? strstr(text, own.text) : NULL;
    char *renamed = at ? malloc(strlen(text) + sent.used + 1) : NULL;
    if (renamed)
        sprintf(renamed, "%.*s%.*s%s", (int)(at - text), text, (int)sent.used, sent.text,
                at + own.used);
    const char *all = renamed ? renamed : text;
    edit_session_put_file(file, all, strlen(all));
    free(renamed);
}

static bool save_score(const edit_session *s)
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
static void greet(edit_session *s)
{
    tell_text(s, true, NULL);
    if (s->unkept.text[0])
        edit_session_tell("unkept", s->unkept.text, NULL);
    if (s->restored.text[0])
        edit_session_tell("restored", s->restored.text, NULL);
    if (s->held.text[0])
        edit_session_tell("held", s->held.text, NULL);
}

static void keep(edit_session *s, const char *line)
{
    himc_error error = {""};
    if (s->unkept.text[0] || edit_journal_add(&s->journal, line, &error))
        return;
    unkept(s, &error);
    edit_session_tell("unkept", s->unkept.text, NULL);
}

bool edit_session_obey(edit_session *s, const char *line, bool *fatal, himc_error *error)
{
    bool hello = !strcmp(line, "hello");
    if (!strcmp(line, "save"))
        return save_score(s);
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
static bool take_back(edit_session *s, const edit_frame *frame, himc_error *error)
{
    himc_error failure;
    // never played: what was made before a kill may be what cannot be played
    bool first = !s->played, last = edit_text_settle(s->text, false),
         all = first && !last && edit_text_revert(s->text), undone = last || all;
    edit_text_settle(s->text, true);
    himc_error_set(&failure, "%.*s", (int)frame->size, (const char *)frame->bytes);
    edit_session_name(s, &failure);
    if (!undone && first)
        return himc_error_set(error, "%s", failure.text);
    s->unproved = false;
    if (undone) {
        keep(s, all ? "revert" : TAKEN_BACK);
        tell_text(s, false, NULL);
    }
    edit_session_tell(undone ? "undone" : "failed", failure.text, NULL);
    if (!undone)
        return true;
    return replay(s, first, error);
}

bool edit_session_hear(edit_session *s, const edit_frame *frame, himc_error *error)
{
    bool sounds = !strcmp(frame->kind, "pcm ");
    s->played |= sounds;
    if (sounds || !strcmp(frame->kind, "over")) {
        edit_text_settle(s->text, true);
        s->unproved = false;
    }
    return strcmp(frame->kind, "fail") != 0 || take_back(s, frame, error);
}

bool edit_session_open(edit_session *s, bool only_check, himc_error *error)
{
    char *text = text_of(s->source, s->name, error);
    s->text = text ? edit_text_new(text, error) : NULL;
    bool good = s->text && check(s, s->text, error);
    if (good && !only_check) {
        hold_back(s);
        restore(s, text);
        s->play = s->text ? edit_play_new(s->name, &s->take, error) : NULL;
        good = s->play != NULL;
    }
    free(text);
    return good;
}

void edit_session_close(edit_session *s)
{
    edit_play_free(s->play);
    edit_journal_close(&s->journal);
    edit_text_free(s->text);
    s->play = NULL;
    s->text = NULL;
}
