/// line_sink.h: a receiver of text lines, such as the description of a take; private.
#ifndef HIMC_LINE_SINK_H
#define HIMC_LINE_SINK_H

#include "base/line.h"

/// A callback and its argument.
typedef struct himc_line_sink {
    void (*line)(void *user, const char *text); ///< called once for each line, without newline
    void *user;
} himc_line_sink;

/// Sends one line (printf format), cut at 255 characters.
__attribute__((format(printf, 2, 3))) static inline void himc_tell(const himc_line_sink *to,
                                                                   const char *format, ...)
{
    char text[256];
    va_list args;
    va_start(args, format);
    himc_line_print(text, sizeof text, format, args);
    va_end(args);
    to->line(to->user, text);
}

#endif
