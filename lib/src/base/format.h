/// format.h: numbers and text for the audio thread: bounded time, no lock, no memory, no locale.
#ifndef HIMC_FORMAT_H
#define HIMC_FORMAT_H

#include "himc/base.h"

/// Prints into `out` of `size` bytes (1 or more), its final 0 included; what does not fit is cut
/// off. Returns the length of the text that is there. Conversions: %% %c %s %.Ns %.*s %d %ld %zu %g
/// %u %.Ng %.Nf, without width; N up to 9. Numbers are those of libc in their first 16 digits; %f
/// of 1e9 and more is printed as %g.
HIMC_RT size_t himc_format(char *out, size_t size, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
HIMC_RT size_t himc_format_list(char *out, size_t size, const char *format, va_list args)
    __attribute__((format(printf, 3, 0)));

/// Reads a decimal number with a point (".5", "-3", "1e-3"), all of the `length` bytes; "nan",
/// "inf" and "0x1" are none. Within one unit in the last place; beyond double's range: infinity.
HIMC_RT bool himc_format_read(const char *word, size_t length, double *number);

#endif
