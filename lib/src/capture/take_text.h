/// take_text.h: lines, words and numbers of text takes, independent of the locale: for
/// the readers and writers.
#ifndef HIMC_TAKE_TEXT_H
#define HIMC_TAKE_TEXT_H

#include "base/format.h"
#include "himc/vec.h"

#include <stdio.h>

/// A part of a text; no 0 at its end. An empty one points somewhere too.
typedef struct himc_span {
    const char *at;
    size_t length;
} himc_span;

/// Position of a reader; `line` is the number of the last line taken, from 1.
typedef struct himc_text {
    const char *at, *end;
    int line;
} himc_text;

himc_text himc_text_open(const char *bytes, size_t size);
/// Takes the next line without its end (LF, CR LF or CR); false at the end of the text.
bool himc_text_line(himc_text *text, himc_span *line);
bool himc_text_filled_line(himc_text *text, himc_span *line);

himc_span himc_span_trim(himc_span span);
/// Takes the first word off `rest`; false if only blanks are left.
bool himc_span_word(himc_span *rest, himc_span *word);
/// Takes the cell up to the next `separator` off `rest`, trimmed. After the last one `rest->at` is
/// NULL, and further cells are empty.
himc_span himc_span_cell(himc_span *rest, char separator);
/// Compares with a word; upper and lower case are equal.
bool himc_span_is(himc_span span, const char *word);
/// The span as a string for a message: cut to 40 characters, '?' for unprintable ones.
const char *himc_span_text(himc_span span, char text[44]);

/// Reads a decimal number, the whole span (himc_format_read).
static inline bool himc_span_number(himc_span span, double *value)
{
    return himc_format_read(span.at, span.length, value);
}
bool himc_span_integer(himc_span span, long low, long high, long *value);

/// Writes a number with a decimal point.
void himc_text_put_number(FILE *file, double value, int digits);
/// Writes x, y, z, each after the separator.
void himc_text_put_vec3(FILE *file, himc_vec3 x, int digits, char separator);

#endif
