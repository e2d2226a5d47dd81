/// motion.h: the motion that the page plays back, a CSV file that `himc render --motion` wrote.
#ifndef VIEWER_MOTION_H
#define VIEWER_MOTION_H

#include "himc/base.h"

#include <stddef.h>

/// The text of a motion of `size` bytes, for the caller to free; NULL with one line in `error` if
/// it cannot be read or is not a motion.
char *motion_load(const char *path, size_t *size, himc_error *error);

/// True if the text is a motion, false with one line in `error`: a line of names, the first time_s,
/// then at least two lines of as many finite numbers, times (s) increasing. `text[size]` is 0;
/// `name` is that of the file.
bool motion_check(const char *text, size_t size, const char *name, himc_error *error);

#endif
