/// fuzz_edit.c: a score under edit, and changes of it. The input is a text, a 0, and lines as
/// `himc edit` takes them. The text comes back to the byte; what can be changed is what is played;
/// what is refused or taken back changes nothing, nor what undo and redo can do, which are each
/// other's inverse. And the fences: if a score is said to name no file, playing it opens none; and
/// none is played with a line that writes a file.
#include "tools/himc/edit_text.h"
#include "fuzz.h"
#include "himc/performance.h"
#include "performance/research.h"
#include "plan/score.h"

#include <errno.h>

#define MOST_CHANGES 20
#define LONGEST_PLAYED 4096                    // (bytes) chosen: an input stays quick
enum { PLAYED_FIRST = 64, PLAYED_THEN = 200 }; // all of the first, then one of so many

static int opened;

// in place of those of the library (Makefile): no input reaches the disk
int __wrap_himc_system_open(const char *path, int flags);
int __wrap_himc_system_open_inside(const char *folder, const char *name);

int __wrap_himc_system_open(const char *path, int flags)
{
    (void)path, (void)flags;
    opened++;
    errno = ENOENT;
    return -1;
}

int __wrap_himc_system_open_inside(const char *folder, const char *name)
{
    (void)name;
    return __wrap_himc_system_open(folder, 0);
}

// true if a word of the text could be that of a command with a file, however it is written
static bool speaks_of_files(const char *text)
{
    static const char *const also[] = {"score", "preset", "dump"};
    char *bare = fuzz_text((const uint8_t *)text, strlen(text)), *to = bare;
    bool found = false;
    for (const char *from = bare; *from; from++)
        if (*from != '\\')
            *to++ = *from;
    *to = '\0';
    for (int i = 0; i < HIMC_COMMANDS; i++) {
        const himc_command_row *row = himc_command_table(i);
        found = found || (strstr(row->atoms, "FILE") && strstr(bare, row->name));
    }
    for (size_t i = 0; i < sizeof also / sizeof *also; i++)
        found = found || strstr(bare, also[i]);
    free(bare);
    return found;
}

// as edit_play.c loads it
static void play(const char *text)
{
    static int asked;
    himc_performance_config config = himc_performance_default();
    himc_error error = {""};
    if (++asked > PLAYED_FIRST && asked % PLAYED_THEN)
        return;
    himc_performance *p = himc_performance_new(&config, &error);
    require(p != NULL, error.text);
    himc_performance_make_drums(p, true);
    opened = 0;
    himc_performance_load_text(p, text, "fuzz.txt", &error);
    require(opened == 0, "a score that names no file opens none");
    himc_performance_free(p);
}

static int count(const char *text, const char *part)
{
    int n = 0;
    for (; (text = strstr(text, part)); text++)
        n++;
    return n;
}

// what the page is told of the text and its history; owned by the caller
static char *tell(const edit_text *t)
{
    char *told = NULL;
    size_t size;
    FILE *to = open_memstream(&told, &size);
    require(to != NULL, "memory for what is told");
    edit_text_print(t, to);
    fclose(to);
    return told;
}

// strokes and pushes that are told are those that will be played
static void check_told(const edit_text *t, const himc_score *score)
{
    char *told = tell(t);
    int strokes = 0, pushes = 0;
    for (int i = 0; i < score->stroke_count; i++)
        strokes += score->strokes[i].ornament == HIMC_PLAIN;
    for (int i = 0; i < score->change_count; i++)
        pushes += score->changes[i].command.id == HIMC_COMMAND_PUSH;
    require(count(told, ",\"nuance\":\"") == strokes, "the strokes told are those of the score");
    require(count(told, ",\"push\":\"") == pushes, "the pushes told are those of the score");
    free(told);
}

// what is played is the score without what writes a file; its lines are where they were
static void check_played(const edit_text *t, const himc_score *score)
{
    himc_error error = {""};
    int atom;
    char *text = edit_text_played(t);
    himc_score *played = himc_score_parse(text, "fuzz.txt", NULL, &error);
    require(played != NULL, error.text);
    for (int i = 0; i < played->line_count; i++)
        require(himc_command_file(&played->lines[i].command, &atom) != HIMC_FILE_WRITE,
                "an edit writes no file");
    require(played->stroke_count == score->stroke_count, "all strokes are played");
    for (int i = 0; i < played->stroke_count; i++)
        require(played->stroke_lines[i] == score->stroke_lines[i], "lines keep their numbers");
    himc_score_free(played);
    free(text);
}

// true if the text is a score; `first` also plays it
static bool check_text(const edit_text *t, bool first)
{
    himc_error error = {""};
    int line;
    char *text = edit_text_join(t);
    himc_score *score = himc_score_parse(text, "fuzz.txt", NULL, &error);
    if (score) {
        check_told(t, score);
        check_played(t, score);
    }
    if (score && first && !edit_text_names_file(score, &line) && strlen(text) < LONGEST_PLAYED &&
        speaks_of_files(text))
        play(text);
    himc_score_free(score);
    free(text);
    return score;
}

static void require_text(const edit_text *t, const char *wanted, const char *what)
{
    char *text = edit_text_join(t);
    require(text && strcmp(text, wanted) == 0, what);
    free(text);
}

// A line of the input: number of a statement, its words; other lines are steps in the history.
// After a `b` it is taken back, good or not.
static void change(edit_text *t, const char *line)
{
    himc_error error = {""};
    bool back = line[0] == 'b';
    char *end, *before = edit_text_join(t), *told = tell(t);
    line += back;
    long index = strtol(line, &end, 10);
    bool done = end == line ? (line[0] == 'r' ? edit_text_redo(t) : edit_text_undo(t))
                            : edit_text_set(t, (int)index, end + (*end == ' '), &error);
    if (!done && end != line)
        require_line(&error);
    bool keep = done && !back && check_text(t, false), open = edit_text_is_open(t);
    require(edit_text_settle(t, keep) == open && !edit_text_is_open(t), "all is settled");
    if (!keep) {
        char *now = tell(t);
        require_text(t, before, "what is taken back has changed nothing");
        require(strcmp(now, told) == 0, "what is taken back leaves undo and redo as they were");
        free(now);
    }
    free(told);
    free(before);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    himc_error error = {""};
    char *text = fuzz_text(data, size);
    size_t length = strlen(text);
    edit_text *t = edit_text_new(text, &error);
    require(t != NULL, error.text);
    require_text(t, text, "the text comes back");
    bool good = check_text(t, true);
    char *line = length < size ? text + length + 1 : text + length, *end;
    for (int i = 0; good && i < MOST_CHANGES && *line; i++, line = end + (*end != '\0')) {
        end = line + strcspn(line, "\n");
        bool last = !*end;
        *end = '\0';
        change(t, line);
        if (last)
            break;
        end[0] = '\n';
    }
    int done = edit_text_changes(t);
    char *changed = edit_text_join(t);
    while (edit_text_undo(t))
        ;
    require_text(t, text, "undo gives the text back");
    for (int i = 0; i < done; i++)
        require(edit_text_redo(t), "what was undone can be done again");
    require_text(t, changed, "redo gives the changes back");
    edit_text_free(t);
    free(changed);
    free(text);
    return 0;
}
