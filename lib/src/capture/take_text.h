/// take_text.h: lines, words and numbers of text takes, whatever the program's locale; private.
#ifndef HIMC_TAKE_TEXT_H
#define HIMC_TAKE_TEXT_H

#include "himc/base.h"

/// A piece of text that is not terminated.
typedef struct himc_span {
    const char *at;
    size_t length;
} himc_span;

/// Where a reader is; `line` counts from 1 and is the line last taken.
typedef struct himc_text {
    const char *at, *end;
    int line;
} himc_text;

himc_text himc_text_open(const char *bytes, size_t size);
/// Takes the next line without its end (LF, CR LF or CR); false at the end of the text.
bool himc_text_line(himc_text *text, himc_span *line);
/// Takes the next line that is not blank.
bool himc_text_filled_line(himc_text *text, himc_span *line);

himc_span himc_span_trim(himc_span span);
/// Takes the first word (blanks around it dropped) off `rest`; false if only blanks are left.
bool himc_span_word(himc_span *rest, himc_span *word);
/// Takes the cell up to the next `separator` off `rest`, trimmed. Call while `rest->at` is not
/// NULL.
himc_span himc_span_cell(himc_span *rest, char separator);
/// Equal to a word, letters' case aside.
bool himc_span_is(himc_span span, const char *word);
/// The span as a string for a message, cut to 40 characters, unprintable ones as '?'.
const char *himc_span_text(himc_span span, char text[44]);

/// Reads a decimal number with a point (never a comma), the whole span. Beyond double's range:
/// infinity.
bool himc_span_number(himc_span span, double *value);
/// Reads a whole number.
bool himc_span_integer(himc_span span, long low, long high, long *value);

#endif
