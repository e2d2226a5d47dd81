/// npz.h: writes NumPy's .npz: a ZIP file of arrays, stored without compression.
#ifndef NPZ_H
#define NPZ_H

#include "himc/base.h"

#include <stdio.h>

#define NPZ_ARRAYS 64    ///< most in a file
#define NPZ_DIMENSIONS 3 ///< most of an array

/// A file under way; all zero but `stream` at first.
typedef struct npz {
    FILE *stream;   ///< borrowed
    uint64_t at;    ///< bytes written
    int count;      ///< arrays
    bool too_large; ///< an array or the file has 4 GiB
    struct {
        char name[48];
        uint32_t crc, size, at;
    } array[NPZ_ARRAYS];
} npz;

/// Adds an array of doubles, or of texts of `width` characters (ASCII, filled with NUL) if `width`
/// is not 0. `shape` has `dimensions` entries, the data are in C order.
void npz_add(npz *file, const char *name, const void *data, int width, const size_t *shape,
             int dimensions);
/// Writes the directory. False with the reason if the file is too large; write errors stay in the
/// stream.
bool npz_end(npz *file, himc_error *error);

#endif
