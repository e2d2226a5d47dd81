/// line.h: one line of text for a person, in a terminal, in Pure Data's console or over OSC.
#ifndef HIMC_LINE_H
#define HIMC_LINE_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>

/// Puts '?' for all that could do more than show a character: control characters (C0, DEL, C1),
/// bytes that are not UTF-8, and the characters that end a line or turn its direction.
void himc_line_clean(char *line);

/// True if himc_line_clean leaves the text as it is.
bool himc_line_is_clean(const char *text);

/// Bytes of the character of UTF-8 at `text`, 0 if there is none.
size_t himc_line_character(const char *text);

/// Prints a clean line (conversions of base/format.h) into `out` of `size` bytes, its final 0
/// included; what does not fit is cut off.
void himc_line_print(char *out, size_t size, const char *format, va_list args)
    __attribute__((format(printf, 3, 0)));

/// A callback and its argument.
typedef struct himc_line_sink {
    void (*line)(void *user, const char *text); ///< called once for each line, without newline
    void *user;
} himc_line_sink;

/// Sends one clean line (printf format), cut at 255 characters.
void himc_tell(const himc_line_sink *to, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

#endif
