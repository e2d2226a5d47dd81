/// recording.h: the scene that the page plays, a file that `himc render --scene` wrote
/// (docs/scene.md).
#ifndef VIEWER_RECORDING_H
#define VIEWER_RECORDING_H

#include "himc/base.h"

#include <stddef.h>

/// The bytes of a scene of `size`, for the caller to free; NULL with one line in `error` if it
/// cannot be read or is none.
char *recording_load(const char *path, size_t *size, himc_error *error);

/// True if the bytes are a scene of a version that this viewer's page reads, whose chunks are whole
/// and unpack to no more than the page takes (docs/scene.md); false with one line in `error`.
/// `name` is that of the file.
bool recording_check(const char *bytes, size_t size, const char *name, himc_error *error);

#endif
