/// text.h: words and numbers of Pure Data text, for commands and scores.
#ifndef HIMC_TEXT_H
#define HIMC_TEXT_H

#include "base/line.h"
#include "himc/command.h"

/// False with the line, from 1, of a zero byte, which would end the text before its end.
bool himc_text_check(const char *text, size_t size, const char *name, himc_error *error);

/// One statement of a text file.
typedef struct himc_text_statement {
    himc_atom *atom; ///< room for `capacity`; symbols point into `storage`
    int capacity;
    int count;     ///< of words, also those beyond the capacity
    int line;      ///< of its first word, from 1
    char *storage; ///< room for `size` characters
    size_t size;
    bool overflow; ///< the words did not fit into `storage`
} himc_text_statement;

/// Reads the words up to the next `;` or the end. Advances `text` past it and `line` by the
/// newlines in it. False if only white space is left.
bool himc_text_next(const char **text, int *line, himc_text_statement *statement);

/// A command that is told: its words and numbers, as himc_command_parse_text reads them.
typedef struct himc_state_line {
    char text[2 * HIMC_PATH_SIZE];
    size_t used;
} himc_state_line;

himc_state_line himc_state_begin(const char *name);
/// A word; what has a meaning in Pure Data's text is quoted.
void himc_state_word(himc_state_line *line, const char *word);
/// Numbers, as short as gives the same in single precision.
void himc_state_numbers(himc_state_line *line, int count, const double *numbers);
void himc_state_end(const himc_state_line *line, const himc_line_sink *to);
/// A line of `name`, perhaps a word (or NULL), and numbers.
void himc_state_tell(const himc_line_sink *to, const char *name, const char *word, int count,
                     const double *numbers);

/// Text that grows by lines. Zero at first; `bytes` is owned, NULL without lines or memory.
typedef struct himc_text_lines {
    char *bytes;
    size_t size, room;
    bool failed; ///< there was no memory
} himc_text_lines;

/// Room for `size` bytes more; false without memory.
bool himc_text_reserve(himc_text_lines *lines, size_t size);
/// Forgets the lines; keeps the memory.
void himc_text_clear(himc_text_lines *lines);
/// Adds a line and ";\n"; `lines` is a himc_text_lines.
void himc_text_add(void *lines, const char *line);

/// Adds text as it is (conversions of base/format.h), of up to 1000 characters.
void himc_text_print(himc_text_lines *lines, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/// Adds a word to a list of words, unless it is the last already; of too many, "..." stands for the
/// rest.
void himc_text_list(char *list, size_t size, const char *word);

/// Of many names the one that a misspelt word means. Zero but for `word` at first.
typedef struct himc_nearest {
    const char *word; ///< as written, borrowed
    const char *name; ///< borrowed; NULL while none is near
    int distance;     ///< of that name from the word
} himc_nearest;

/// Compares the word with one more name: an error in a short word, two in a longer one; upper and
/// lower case are the same. Of two equally near names the first counts.
void himc_nearest_try(himc_nearest *nearest, const char *name);

/// Copies a word for an error message into `out`; of a long word only the beginning.
void himc_text_shorten(char *out, size_t size, const char *word);

#endif
