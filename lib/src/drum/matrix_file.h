/// matrix_file.h: a table of numbers from a text or Matrix Market file; a private part of grid.c.
#ifndef HIMC_MATRIX_FILE_H
#define HIMC_MATRIX_FILE_H

#include "himc/base.h"

#include <stdio.h>

typedef struct matrix {
    int rows, columns;
    double *value; ///< (rows, columns), owned
} matrix;

/// Opens a regular file to be read, which ends, unlike a device; NULL with the reason.
FILE *himc_open_regular(const char *path, himc_error *error);

/// Reads the file. With `columns` > 0 rows must have so many numbers. At most HIMC_GRID_PLACES
/// rows. False with "file:line: ..." if anything in it is wrong.
bool himc_matrix_load(matrix *out, const char *path, int columns, himc_error *error);

#endif
