/// share.h: one page to send: scene, scripts and style in a single file that needs no server.
#ifndef VIEWER_SHARE_H
#define VIEWER_SHARE_H

#include "himc/base.h"

#include <stdio.h>

/// Writes the page of the scene `bytes` to `out`; `name` is that of its file. False with the reason
/// if memory is short; what cannot be written shows when `out` is closed.
bool share_write(FILE *out, const char *bytes, size_t size, const char *name, himc_error *error);

#endif
