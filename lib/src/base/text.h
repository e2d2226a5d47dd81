/// text.h: words and numbers of Pure Data text, for commands and scores.
#ifndef HIMC_TEXT_H
#define HIMC_TEXT_H

#include "himc/command.h"

/// True if the whole `word` is a decimal number (".5", "-3", "1e-3"); "nan", "inf" and "0x1" are
/// words. The decimal point is a point in every locale.
bool himc_text_number(const char *word, double *number);

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

/// Copies a word for an error message into `out`; of a long word only the beginning.
void himc_text_shorten(char *out, size_t size, const char *word);

#endif
