/// share.h: one page to send: scene, scripts and style in a single file that needs no server.
#ifndef VIEWER_SHARE_H
#define VIEWER_SHARE_H

#include "himc/base.h"

#include <stdio.h>

/// Writes the page of the scene `bytes` to `out`; `name` is that of its file. False with the reason
/// if memory is short; what cannot be written shows when `out` is closed.
bool share_write(FILE *out, const char *bytes, size_t size, const char *name, himc_error *error);

/// A file in a page.
typedef struct share_file {
    const char *name; ///< without a blank
    const void *bytes;
    size_t size;
} share_file;

/// Writes the page with files in place of a scene: the performer as WebAssembly, the first one, and
/// pieces that it may play. False with the reason.
bool share_write_files(FILE *out, const share_file *file, int count, himc_error *error);

#endif
