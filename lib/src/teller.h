/// teller.h: facts told line by line to whoever asked.
#ifndef HIMC_TELLER_H
#define HIMC_TELLER_H

#include <stdarg.h>
#include <stdio.h>

typedef struct teller {
    void (*line)(void *, const char *);
    void *user;
} teller;

/// One line, cut at 255 characters.
__attribute__((format(printf, 2, 3))) static inline void himc_tell(const teller *to,
                                                                   const char *format, ...)
{
    char text[256];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    to->line(to->user, text);
}

#endif
