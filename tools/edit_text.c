/// edit_text.c: a change replaces the bytes of one statement, and undo puts the old bytes back, so
/// that the text is as it was, comments and white space included. A statement that was removed
/// leaves an empty place, and one that was added stands at the end: no number ever means another
/// statement.
#define _POSIX_C_SOURCE 200809L // strndup
#include "edit_text.h"
#include "cli.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Changes, from the first to the last one that can be made again.
typedef struct change {
    int index;
    char *bytes; ///< owned; of the statement before, or, when taken back, after
} change;

struct edit_text {
    char **at; ///< (count) owned; "" for none
    int count, room;
    change *changes; ///< (made)
    int made, done, changes_room;
    double from; ///< of the last change
};

static bool grow(void *array, int count, int *room, size_t size)
{
    void **slot = array, *bigger = *slot;
    if (count == *room)
        bigger = realloc(bigger, size * (size_t)(*room = 2 * *room + 64));
    if (bigger)
        *slot = bigger;
    return bigger;
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

// past the `;` of the statement at `text`
static const char *end_of(const char *text)
{
    for (; *text && *text != ';'; text++)
        text += text[0] == '\\' && text[1];
    return text + (*text == ';');
}

edit_text *edit_text_new(const char *text, himc_error *error)
{
    edit_text *t = calloc(1, sizeof *t);
    bool good = t;
    for (const char *end; good && *text; text = end) {
        end = end_of(text);
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

char *edit_text_join(const edit_text *t)
{
    size_t size = 1, used = 0;
    for (int i = 0; i < t->count; i++)
        size += strlen(t->at[i]);
    char *all = malloc(size);
    for (int i = 0; all && i < t->count; i++)
        used += (size_t)sprintf(all + used, "%s", t->at[i]);
    if (all)
        all[used] = 0;
    return all;
}

static size_t space(const char *bytes)
{
    return strspn(bytes, " \t\r\n");
}

// the command of a statement, `;` or not, and the beat of its `at`, else -1; false if it is none
// for the performer
static bool command_of(const char *bytes, himc_command *out, double *beat, himc_error *error)
{
    const char *begin = bytes + space(bytes), *end = end_of(begin);
    int used = 0;
    *beat = -1;
    if (sscanf(begin, "at %lf %n", beat, &used) == 1)
        begin += used;
    size_t length = end > begin ? (size_t)(end - begin) : 0;
    if (length && end[-1] == ';')
        length--;
    char *words = strndup(begin, length);
    bool good = words && himc_command_parse_text(out, HIMC_PERFORMER, words, error);
    free(words);
    return good;
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

bool edit_text_names_file(const edit_text *t)
{
    himc_command c;
    himc_error unused;
    double beat;
    int atom;
    for (int i = 0; i < t->count; i++)
        if (command_of(t->at[i], &c, &beat, &unused) &&
            himc_command_file(&c, &atom) != HIMC_FILE_NONE)
            return true;
    return false;
}

// true if a statement may be changed, or is empty
static bool may_change(const char *bytes, himc_error *error)
{
    himc_command c;
    double beat;
    return !bytes[space(bytes)] ||
           (command_of(bytes, &c, &beat, error) &&
            (can_change(&c, beat) ||
             himc_error_set(error, "allowed in an edit: strokes, ornaments, nudge, at BEAT push")));
}

// where a statement begins to act, with its grace notes
static double acts_from(const char *bytes)
{
    himc_command c;
    himc_error unused;
    double beat;
    if (!command_of(bytes, &c, &beat, &unused))
        return HUGE_VAL;
    return c.id == HIMC_COMMAND_PUSH    ? beat
           : c.id == HIMC_COMMAND_NUDGE ? c.atom[1].number - c.atom[2].number
                                        : fmax(c.stroke.beat - 1, 0);
}

// the place of the change at `changes[i]` gets its bytes, and that gets those of the place
static void exchange(edit_text *t, int i)
{
    change *c = &t->changes[i];
    char *now = t->at[c->index];
    t->from = fmin(acts_from(now), acts_from(c->bytes));
    t->at[c->index] = c->bytes;
    c->bytes = now;
}

static char *with_space(const char *old, const char *words)
{
    size_t before = space(old), size = before + strlen(words) + 2;
    char *bytes = malloc(size);
    if (bytes)
        snprintf(bytes, size, "%.*s%s%s", (int)before, old, words, *words ? ";" : "");
    return bytes;
}

bool edit_text_set(edit_text *t, int index, const char *words, himc_error *error)
{
    bool adds = index == t->count;
    if (index < 0 || index > t->count)
        return himc_error_set(error, "statement %d, allowed 0 .. %d", index, t->count);
    if (strpbrk(words, ";\\\r\n"))
        return himc_error_set(error, "one statement at a time");
    if (!may_change(adds ? "" : t->at[index], error) || !may_change(words, error))
        return false;
    char *bytes = with_space(adds ? "\n" : t->at[index], words);
    if (!bytes || !grow(&t->changes, t->done, &t->changes_room, sizeof *t->changes) ||
        (adds && !append(t, strdup("")))) {
        free(bytes);
        return himc_error_set(error, "out of memory");
    }
    while (t->made > t->done)
        free(t->changes[--t->made].bytes);
    t->changes[t->made++] = (change){index, bytes};
    exchange(t, t->done++);
    return true;
}

bool edit_text_undo(edit_text *t)
{
    if (t->done > 0)
        exchange(t, --t->done);
    else
        return false;
    return true;
}

bool edit_text_redo(edit_text *t)
{
    if (t->done < t->made)
        exchange(t, t->done++);
    else
        return false;
    return true;
}

double edit_text_changed_from(const edit_text *t)
{
    return t->from;
}

static void print_statement(FILE *to, int index, const char *bytes, const himc_command *c)
{
    const himc_stroke *s = &c->stroke;
    const char *words = bytes + space(bytes);
    char *copy = strndup(words, strcspn(words, ";"));
    fprintf(to, "{\"index\":%d,\"words\":", index);
    cli_put_json_text(to, copy ? copy : "");
    free(copy);
    if (c->id == HIMC_COMMAND_STROKE) {
        fprintf(to, ",\"beat\":%.17g,\"hand\":\"%s\",\"nuance\":\"%s\",\"dynamic\":%.17g,\"drum\":",
                s->beat, himc_hand_name(s->hand), himc_nuance_name(s->nuance), s->dynamic);
        cli_put_json_text(to, s->drum);
        if (s->spot == HIMC_SPOT_XY)
            fprintf(to, ",\"x\":%.17g,\"y\":%.17g", s->x, s->y);
    }
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
    fprintf(to, "\"undo\":%d,\"redo\":%d,\"count\":%d,\"statements\":[", t->done, t->made - t->done,
            t->count);
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
