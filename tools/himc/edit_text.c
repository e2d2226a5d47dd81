/// edit_text.c: a change replaces the words of one statement that differ, and undo puts the old
/// bytes back, so that the text is as it was, comments and white space included. A statement that
/// was removed leaves an empty place, and one that was added stands at the end: no number ever
/// means another statement. Statements are read as in a score: by text.c and command.c.
#define _POSIX_C_SOURCE 200809L // strndup
#include "edit_text.h"
#include "base/text.h"
#include "cli.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SPACE " \t\r\n\v\f"            // as isspace()
#define BYTE_ORDER_MARK "\xEF\xBB\xBF" // some editors begin a file with it

/// Changes, from the first to the last one that can be made again.
typedef struct change {
    int index;
    char *bytes; ///< owned; of the statement before, or, when taken back, after
} change;

struct edit_text {
    bool marked; ///< a byte order mark stands before the first statement
    char **at;   ///< (count) owned; "" for none
    int count, room;
    change *changes; ///< (made)
    int made, done, changes_room;
    int before; ///< `done` before the call that is not settled yet; else `done`
    bool sets;  ///< that call was edit_text_set; what redo can make again stands after its change
    bool adds;  ///< and it has added its statement
    edit_span changed; ///< by the last call
};

static bool grow(void *array, int count, int *room, size_t size)
{
    void **slot = array, *bigger = *slot;
    if (count == *room)
        bigger = realloc(bigger, size * (size_t)(2 * *room + 64));
    if (!bigger)
        return false;
    *room = count == *room ? 2 * *room + 64 : *room;
    *slot = bigger;
    return true;
}

static bool append(edit_text *t, char *bytes)
{
    if (!bytes || !grow(&t->at, t->count, &t->room, sizeof *t->at)) {
        free(bytes);
        return false;
    }
    t->at[t->count++] = bytes;
    return true;
}

// the `;` of the statement at `text`, or the text's end
static const char *words_end(const char *text)
{
    for (; *text && *text != ';'; text++)
        text += text[0] == '\\' && text[1];
    return text;
}

edit_text *edit_text_new(const char *text, himc_error *error)
{
    edit_text *t = calloc(1, sizeof *t);
    bool good = t;
    if (good && (t->marked = !strncmp(text, BYTE_ORDER_MARK, strlen(BYTE_ORDER_MARK))))
        text += strlen(BYTE_ORDER_MARK);
    for (const char *end; good && *text; text = end) {
        end = words_end(text);
        end += *end == ';';
        good = append(t, strndup(text, (size_t)(end - text)));
    }
    if (good)
        return t;
    himc_error_set(error, "out of memory");
    edit_text_free(t);
    return NULL;
}

void edit_text_free(edit_text *t)
{
    for (int i = 0; t && i < t->count; i++)
        free(t->at[i]);
    for (int i = 0; t && i < t->made; i++)
        free(t->changes[i].bytes);
    if (t) {
        free(t->at);
        free(t->changes);
    }
    free(t);
}

static bool is_empty(const char *bytes)
{
    return !bytes[strspn(bytes, SPACE)];
}

static bool is_closed(const char *bytes)
{
    return *words_end(bytes) == ';';
}

// the command of a statement, `;` or not, and the beat of its `at`, else -1; false if it is none
// for the performer
static bool command_of(const char *bytes, himc_command *out, double *beat, himc_error *error)
{
    himc_atom atoms[HIMC_COMMAND_ATOMS + 4], *first = atoms;
    char storage[HIMC_PATH_SIZE + 256];
    himc_text_statement s = {.atom = atoms,
                             .capacity = HIMC_COMMAND_ATOMS + 4,
                             .storage = storage,
                             .size = sizeof storage};
    int line = 1;
    *beat = -1;
    if (!himc_text_next(&bytes, &line, &s) || s.count == 0)
        return himc_error_set(error, "an empty statement");
    if (s.overflow)
        return himc_error_set(error, "a statement of more than %zu characters", s.size);
    int count = s.count < s.capacity ? s.count : s.capacity;
    if (count > 2 && !strcmp(atoms[0].symbol, "at") && atoms[1].kind == HIMC_ATOM_NUMBER) {
        *beat = atoms[1].number;
        first += 2;
        count -= 2;
    }
    return himc_command_parse(out, HIMC_PERFORMER, first->symbol, first + 1, count - 1, error);
}

// the bytes of a statement as they are played: of one that would write a file the lines alone
static size_t put_statement(char *out, const char *bytes, bool played)
{
    himc_command c;
    himc_error unused;
    double beat;
    size_t used = 0;
    if (!played || !command_of(bytes, &c, &beat, &unused) || c.id != HIMC_COMMAND_RECORD)
        return (size_t)sprintf(out, "%s", bytes);
    for (; *bytes; bytes++)
        if (*bytes == '\n')
            out[used++] = '\n';
    out[used] = 0;
    return used;
}

static char *join(const edit_text *t, bool played)
{
    const char *mark = t->marked ? BYTE_ORDER_MARK : "";
    size_t size = strlen(mark) + 1;
    for (int i = 0; i < t->count; i++)
        size += strlen(t->at[i]) + 1;
    char *all = malloc(size), *end = all;
    bool open = false; // the last statement has no `;`, as the last of a file may
    if (all)
        end += sprintf(end, "%s", mark);
    for (int i = 0; all && i < t->count; i++) {
        const char *bytes = t->at[i];
        bool empty = is_empty(bytes);
        end += sprintf(end, "%s", open && !empty ? ";" : "");
        end += put_statement(end, bytes, played);
        open = empty ? open : !is_closed(bytes);
    }
    return all;
}

char *edit_text_join(const edit_text *t)
{
    return join(t, false);
}

char *edit_text_played(const edit_text *t)
{
    return join(t, true);
}

static bool is_stroke(const himc_command *c)
{
    return c->id == HIMC_COMMAND_STROKE || c->id == HIMC_COMMAND_ROLL ||
           c->id == HIMC_COMMAND_FLAM || c->id == HIMC_COMMAND_DRAG || c->id == HIMC_COMMAND_RUFF;
}

// strokes, nudges, pushes at a beat
static bool can_change(const himc_command *c, double beat)
{
    return is_stroke(c) || c->id == HIMC_COMMAND_NUDGE || (c->id == HIMC_COMMAND_PUSH && beat >= 0);
}

bool edit_text_names_file(const himc_score *score, int *line)
{
    int atom;
    for (int i = 0; i < score->line_count + score->change_count; i++) {
        const himc_score_line *l =
            i < score->line_count ? &score->lines[i] : &score->changes[i - score->line_count];
        *line = l->line;
        if (himc_command_file(&l->command, &atom) != HIMC_FILE_NONE)
            return true;
    }
    return false;
}

// true if a statement may be changed, or is empty
static bool may_change(const char *bytes, himc_error *error)
{
    himc_command c;
    double beat;
    return is_empty(bytes) ||
           (command_of(bytes, &c, &beat, error) &&
            (can_change(&c, beat) ||
             himc_error_set(error,
                            "expected, in an edit, strokes, ornaments, nudge, at BEAT push")));
}

static const edit_span NOWHERE = {HUGE_VAL, {HUGE_VAL, HUGE_VAL}};

// where a statement begins to act, with its grace notes
static edit_span span_of(const char *bytes)
{
    himc_command c;
    himc_error unused;
    double beat;
    edit_span s = NOWHERE;
    if (!command_of(bytes, &c, &beat, &unused))
        return s;
    s.from = beat;
    if (c.id == HIMC_COMMAND_PUSH)
        return s;
    bool nudge = c.id == HIMC_COMMAND_NUDGE,
         plain = !nudge && c.stroke.ornament == HIMC_PLAIN && c.stroke.early == 0;
    s.from = nudge ? c.atom[1].number - c.atom[2].number : fmax(c.stroke.beat - (plain ? 0 : 1), 0);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        if (!plain || c.stroke.hand >= HIMC_HANDS || (int)c.stroke.hand == hand)
            s.strokes[hand] = s.from;
    return s;
}

static void widen(edit_span *changed, const char *bytes)
{
    edit_span s = span_of(bytes);
    changed->from = fmin(changed->from, s.from);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        changed->strokes[hand] = fmin(changed->strokes[hand], s.strokes[hand]);
}

// the place of the change at `changes[i]` gets its bytes, and that gets those of the place
static void exchange(edit_text *t, int i)
{
    change *c = &t->changes[i];
    char *now = t->at[c->index];
    widen(&t->changed, now);
    widen(&t->changed, c->bytes);
    t->at[c->index] = c->bytes;
    c->bytes = now;
}

// takes changes back, or makes them again, until so many are made
static void go_to(edit_text *t, int done)
{
    t->changed = NOWHERE;
    while (t->done > done)
        exchange(t, --t->done);
    while (t->done < done)
        exchange(t, t->done++);
}

// past the word at `at`
static const char *word_end(const char *at)
{
    return at + strcspn(at, SPACE ";");
}

// past the last word before `end`
static const char *trim(const char *begin, const char *end)
{
    while (end > begin && (end[-1] == ';' || strchr(SPACE, end[-1])))
        end--;
    return end;
}

static const char *word_begin(const char *begin, const char *end)
{
    while (end > begin && end[-1] != ';' && !strchr(SPACE, end[-1]))
        end--;
    return end;
}

static bool same_word(const char *a, const char *a_end, const char *b, const char *b_end)
{
    return a_end > a && a_end - a == b_end - b && !memcmp(a, b, (size_t)(a_end - a));
}

// The statement with other words; those that are the same at its beginning and at its end keep
// their white space.
static char *with_words(const char *old, const char *words)
{
    const char *a = old + strspn(old, SPACE), *b = words + strspn(words, SPACE);
    const char *from = a, *a_end = trim(a, a + strlen(a)), *b_end = trim(b, b + strlen(b));
    const char *rest = a_end, *tail = *a_end ? "" : ";";
    if (b == b_end) // removed
        return strndup(old, (size_t)(a - old));
    for (const char *p = a, *q = b; same_word(p, word_end(p), q, word_end(q));) {
        from = word_end(p);
        b = word_end(q);
        p = from + strspn(from, SPACE);
        q = b + strspn(b, SPACE);
    }
    for (const char *p = a_end, *q = b_end; (p = word_begin(from, p)) >= from &&
                                            (q = word_begin(b, q)) >= b &&
                                            same_word(p, word_end(p), q, word_end(q));) {
        rest = p;
        b_end = q;
        p = trim(from, p);
        q = trim(b, q);
    }
    // where words take the place of others, the white space around them stays as well
    const char *first = from + strspn(from, SPACE), *next = b + strspn(b, SPACE);
    if (trim(first, rest) > first && trim(next, b_end) > next) {
        rest = trim(first, rest);
        b_end = trim(next, b_end);
        from = first;
        b = next;
    }
    size_t size = (size_t)(from - old) + (size_t)(b_end - b) + strlen(rest) + 2;
    char *bytes = malloc(size);
    if (bytes)
        snprintf(bytes, size, "%.*s%.*s%s%s", (int)(from - old), old, (int)(b_end - b), b, rest,
                 tail);
    return bytes;
}

bool edit_text_set(edit_text *t, int index, const char *words, himc_error *error)
{
    bool adds = index == t->count;
    if (index < 0 || index > t->count)
        return himc_error_set(error, "statement %d, expected 0 .. %d", index, t->count);
    if (strpbrk(words, ";\\\r\n"))
        return himc_error_set(error, "one statement at a time");
    if (!may_change(adds ? "" : t->at[index], error) || !may_change(words, error))
        return false;
    const char *old = adds ? "\n" : t->at[index];
    char *bytes = with_words(old, words);
    if (bytes && !strcmp(bytes, old)) {
        free(bytes);
        return true;
    }
    if (!bytes || !grow(&t->changes, t->made, &t->changes_room, sizeof *t->changes) ||
        (adds && !append(t, strdup("")))) {
        free(bytes);
        return himc_error_set(error, "out of memory");
    }
    t->sets = true;
    t->adds = adds;
    memmove(t->changes + t->done + 1, t->changes + t->done,
            (size_t)(t->made++ - t->done) * sizeof *t->changes);
    t->changes[t->done] = (change){index, bytes};
    go_to(t, t->done + 1);
    return true;
}

bool edit_text_is_open(const edit_text *t)
{
    return t->sets || t->before != t->done;
}

bool edit_text_settle(edit_text *t, bool keep)
{
    bool open = edit_text_is_open(t), sets = t->sets;
    while (sets && keep && t->made > t->done)
        free(t->changes[--t->made].bytes);
    if (open && !keep)
        go_to(t, t->before);
    if (sets && !keep) {
        free(t->changes[t->done].bytes);
        memmove(t->changes + t->done, t->changes + t->done + 1,
                (size_t)(--t->made - t->done) * sizeof *t->changes);
        if (t->adds)
            free(t->at[--t->count]);
    }
    t->sets = false;
    t->before = t->done;
    return open;
}

bool edit_text_undo(edit_text *t)
{
    if (t->done == 0)
        return false;
    go_to(t, t->done - 1);
    return true;
}

bool edit_text_redo(edit_text *t)
{
    if (t->done == t->made)
        return false;
    go_to(t, t->done + 1);
    return true;
}

bool edit_text_revert(edit_text *t)
{
    if (t->done == 0)
        return false;
    go_to(t, 0);
    return true;
}

int edit_text_changes(const edit_text *t)
{
    return t->done;
}

edit_span edit_text_changed(const edit_text *t)
{
    return t->changed;
}

// where the stroke lands (m), or, of a spot with a name, on heads of the radii 0 and 1 m
static void print_spot(FILE *to, const himc_stroke *s)
{
    double x[2], y[2];
    for (int radius = 0; radius < 2; radius++)
        himc_stroke_spot(s, radius, &x[radius], &y[radius]);
    if (s->spot == HIMC_SPOT_XY)
        fprintf(to, ",\"x\":%.9g,\"y\":%.9g", x[0], y[0]);
    else
        fprintf(to, ",\"spot\":[[%.9g,%.9g],[%.9g,%.9g]]", x[0], y[0], x[1], y[1]);
}

static void print_statement(FILE *to, int index, const char *bytes, const himc_command *c)
{
    const himc_stroke *s = &c->stroke;
    const char *words = bytes + strspn(bytes, SPACE);
    char *copy = strndup(words, (size_t)(trim(words, words + strlen(words)) - words));
    fprintf(to, "{\"index\":%d,\"words\":", index);
    cli_put_json_text(to, copy ? copy : "");
    free(copy);
    if (c->id == HIMC_COMMAND_STROKE) {
        fprintf(to, ",\"beat\":%.17g,\"hand\":\"%s\",\"nuance\":\"%s\",\"dynamic\":%.17g,\"drum\":",
                s->beat, himc_hand_name(s->hand), himc_nuance_name(s->nuance), s->dynamic);
        cli_put_json_text(to, s->drum);
        print_spot(to, s);
    } else if (is_stroke(c))
        fprintf(to, ",\"at\":%.17g,\"length\":%.17g", s->beat, s->length);
}

static void print_push(FILE *to, const himc_command *c, double at)
{
    const himc_atom *a = c->atom;
    if (c->id != HIMC_COMMAND_PUSH)
        return;
    fprintf(to, ",\"at\":%.17g,\"push\":\"%s\",\"force\":[%.9g,%.9g,%.9g],\"seconds\":%.9g", at,
            a[0].symbol, a[1].number, a[2].number, a[3].number, a[4].number);
    if (c->count > 5)
        fprintf(to, ",\"along\":%.9g", a[5].number);
}

void edit_text_print(const edit_text *t, FILE *to)
{
    himc_command c;
    himc_error unused;
    double at;
    bool first = true;
    fprintf(to, "\"undo\":%d,\"redo\":%d,\"count\":%d,\"statements\":[", t->done,
            t->sets ? 0 : t->made - t->done, t->count);
    for (int i = 0; i < t->count; i++) {
        if (!command_of(t->at[i], &c, &at, &unused) || !can_change(&c, at))
            continue;
        fputs(first ? "" : ",", to);
        print_statement(to, i, t->at[i], &c);
        print_push(to, &c, at);
        fprintf(to, "}");
        first = false;
    }
    fprintf(to, "]");
}
