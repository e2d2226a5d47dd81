/// text.h: words and numbers of Pure Data text, for commands and scores.
#ifndef HIMC_TEXT_H
#define HIMC_TEXT_H

#include "himc/command.h"

/// Whether all of `word` is a decimal number (".5", "-3", "1e-3"); "nan", "inf" and "0x1" are
/// words. The point is a point whatever the locale.
bool himc_text_number(const char *word, double *number);

/// What a statement of a text file is, once read.
typedef struct himc_text_statement {
    himc_atom *atom; ///< room for `capacity`; symbols point into `storage`
    int capacity;
    int count;     ///< words there were, also those beyond the capacity
    int line;      ///< of its first word, from 1
    char *storage; ///< room for `size` characters
    size_t size;
    bool overflow; ///< the words did not fit into `storage`
} himc_text_statement;

/// Reads the words up to the next `;` or the end. Advances `text` past it and `line` by the
/// newlines met. False when nothing but white space was left.
bool himc_text_next(const char **text, int *line, himc_text_statement *statement);

/// One word in an error message: control characters become '?', long ones are cut; writes into
/// `out`.
void himc_text_printable(char *out, size_t size, const char *word);

#endif
