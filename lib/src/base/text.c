/// text.c: Pure Data text: words between white space, `;` ends a statement, `\` quotes a character.
#include "base/text.h"

#include "base/format.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/// One word, backslashes resolved, into the statement's storage; NULL if it does not fit.
static const char *read_word(const char **text, int *line, himc_text_statement *statement,
                             size_t *used)
{
    const char *s = *text;
    size_t start = *used, length = 0;
    for (; *s && *s != ';' && !isspace((unsigned char)*s); s++) {
        if (*s == '\\' && s[1])
            s++;
        *line += *s == '\n';
        if (start + length + 1 < statement->size)
            statement->storage[start + length] = *s;
        length++;
    }
    *text = s;
    if (start + length + 1 > statement->size)
        return NULL;
    statement->storage[start + length] = '\0';
    *used = start + length + 1;
    return statement->storage + start;
}

static void skip_space(const char **text, int *line)
{
    for (; isspace((unsigned char)**text); (*text)++)
        *line += **text == '\n';
}

bool himc_text_check(const char *text, size_t size, const char *name, himc_error *error)
{
    const char *zero = memchr(text, 0, size);
    int line = 1;
    for (const char *at = text; zero && at < zero; at++)
        line += *at == '\n';
    return !zero || himc_error_set(error, "%s:%d: a zero byte, expected text", name, line);
}

bool himc_text_next(const char **text, int *line, himc_text_statement *statement)
{
    size_t used = 0;
    statement->count = 0;
    statement->overflow = false;
    skip_space(text, line);
    statement->line = *line;
    if (!**text)
        return false;
    while (**text && **text != ';') {
        const char *word = read_word(text, line, statement, &used);
        statement->overflow = statement->overflow || !word;
        if (statement->count < statement->capacity) {
            himc_atom *atom = &statement->atom[statement->count];
            *atom = (himc_atom){HIMC_ATOM_SYMBOL, 0, word ? word : ""};
            if (himc_format_read(atom->symbol, strlen(atom->symbol), &atom->number))
                atom->kind = HIMC_ATOM_NUMBER;
        }
        statement->count++;
        skip_space(text, line);
    }
    *text += **text == ';';
    return true;
}

void himc_text_shorten(char *out, size_t size, const char *word)
{
    int length = snprintf(out, size, "%s", word);
    if (length >= 0 && (size_t)length >= size && size > 4)
        snprintf(out + size - 4, 4, "...");
}

#define LONGEST_NAME 40 // that is compared; chosen: longer than a drum's name

static int smaller(int a, int b)
{
    return a < b ? a : b;
}

// Insertions, deletions, replacements and exchanges of neighbours that turn one word into the other
// (optimal string alignment); words of up to LONGEST_NAME letters.
static int edit_distance(const char *a, const char *b)
{
    int rows[3][LONGEST_NAME + 1], *before = rows[0], *above = rows[1], *row = rows[2];
    int n = (int)strlen(b);
    for (int j = 0; j <= n; j++)
        row[j] = j;
    for (int i = 1; a[i - 1]; i++) {
        int *oldest = before;
        before = above;
        above = row;
        row = oldest;
        row[0] = i;
        for (int j = 1; j <= n; j++) {
            int x = tolower((unsigned char)a[i - 1]), y = tolower((unsigned char)b[j - 1]);
            row[j] = smaller(above[j - 1] + (x != y), 1 + smaller(above[j], row[j - 1]));
            if (i > 1 && j > 1 && x == tolower((unsigned char)b[j - 2]) &&
                y == tolower((unsigned char)a[i - 2]))
                row[j] = smaller(row[j], before[j - 2] + 1);
        }
    }
    return row[n];
}

void himc_nearest_try(himc_nearest *nearest, const char *name)
{
    size_t length = strlen(nearest->word), other = strlen(name);
    if (length > LONGEST_NAME || other > LONGEST_NAME)
        return;
    // chosen: in words of up to four letters two errors make another word
    int allowed = length <= 4 && other <= 4 ? 1 : 2;
    int distance = edit_distance(nearest->word, name);
    bool other_word = distance >= smaller((int)length, (int)other);
    if (distance > allowed || other_word || (nearest->name && distance >= nearest->distance))
        return;
    nearest->name = name;
    nearest->distance = distance;
}

himc_state_line himc_state_begin(const char *name)
{
    himc_state_line line;
    line.used = himc_format(line.text, sizeof line.text, "%s", name);
    return line;
}

static void add_byte(himc_state_line *line, char byte)
{
    if (line->used < sizeof line->text - 1)
        line->text[line->used++] = byte;
    line->text[line->used] = '\0';
}

void himc_state_word(himc_state_line *line, const char *word)
{
    add_byte(line, ' ');
    for (; *word; word++) {
        if (strchr(" \t;,\\$", *word))
            add_byte(line, '\\');
        add_byte(line, *word);
    }
}

void himc_state_numbers(himc_state_line *line, int count, const double *numbers)
{
    static const char *const format[] = {"%.6g", "%.7g", "%.8g", "%.9g"};
    for (int i = 0; i < count; i++) {
        char text[32];
        double back = 0;
        float number = (float)numbers[i];
        for (int k = 0; k < 4; k++) {
            himc_format(text, sizeof text, format[k], (double)number);
            if (himc_format_read(text, strlen(text), &back) && (float)back == number)
                break;
        }
        himc_state_word(line, text);
    }
}

void himc_state_end(const himc_state_line *line, const himc_line_sink *to)
{
    to->line(to->user, line->text);
}

void himc_state_tell(const himc_line_sink *to, const char *name, const char *word, int count,
                     const double *numbers)
{
    himc_state_line line = himc_state_begin(name);
    if (word)
        himc_state_word(&line, word);
    himc_state_numbers(&line, count, numbers);
    himc_state_end(&line, to);
}

bool himc_text_reserve(himc_text_lines *text, size_t size)
{
    if (text->size + size + 1 <= text->room)
        return true;
    size_t room = 2 * text->room + size + 1;
    char *more = realloc(text->bytes, room);
    if (!more)
        return false;
    text->bytes = more;
    text->bytes[text->size] = '\0';
    text->room = room;
    return true;
}

void himc_text_clear(himc_text_lines *text)
{
    text->size = 0;
    if (text->bytes)
        text->bytes[0] = '\0';
}

void himc_text_add(void *object, const char *line)
{
    himc_text_lines *text = object;
    size_t length = strlen(line);
    if (!himc_text_reserve(text, length + 2)) {
        text->failed = true;
        return;
    }
    memcpy(text->bytes + text->size, line, length);
    memcpy(text->bytes + text->size + length, ";\n", 3);
    text->size += length + 2;
}

void himc_text_print(himc_text_lines *lines, const char *format, ...)
{
    char text[1001];
    va_list args;
    va_start(args, format);
    size_t length = himc_format_list(text, sizeof text, format, args);
    va_end(args);
    if (!himc_text_reserve(lines, length)) {
        lines->failed = true;
        return;
    }
    memcpy(lines->bytes + lines->size, text, length + 1);
    lines->size += length;
}

void himc_text_list(char *list, size_t size, const char *word)
{
    size_t used = strlen(list), length = strlen(word);
    bool again = used >= length && strcmp(list + used - length, word) == 0 &&
                 (used == length || list[used - length - 1] == ' ');
    const char *space = used > 0 ? " " : "";
    if (!again && used + length + sizeof " ..." < size)
        himc_format(list + used, size - used, "%s%s", space, word);
    else if (!again && (used < 3 || strcmp(list + used - 3, "...") != 0))
        himc_format(list + used, size - used, "%s...", space);
}
