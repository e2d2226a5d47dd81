/// file.h: regular files, the only ones that the library and its programs open.
#ifndef HIMC_FILE_H
#define HIMC_FILE_H

#include "base/job.h"
#include "base/text.h"

#include <stdio.h>

/// Opens an existing regular file for reading. NULL with one line if there is none, or if it is
/// something else (a folder, a FIFO, a socket, a device). Never waits. The caller closes it.
FILE *himc_file_read(const char *path, himc_error *error);

/// How a file is opened for writing.
typedef enum himc_file_write_mode {
    HIMC_FILE_REPLACE,  ///< empty, for writing
    HIMC_FILE_CONTINUE, ///< with its contents, to be read from the beginning and written at the end
} himc_file_write_mode;

/// Opens a regular file, made if there is none, or /dev/null. NULL with one line if it cannot be
/// written or is something else, which is then unchanged. Never waits. The caller closes it.
FILE *himc_file_write(const char *path, himc_file_write_mode mode, himc_error *error);

/// The job of writing lines, whose memory it takes over, into a file; `command` begins its error
/// lines. NULL with the reason, also if `lines` have failed.
himc_job *himc_file_write_job(const char *command, const char *path, himc_text_lines *lines,
                              himc_error *error);

/// The whole of a regular file of at most `most` bytes, with a 0 after it. `size` (bytes, without
/// that 0). NULL with one line. The caller frees it.
char *himc_file_load(const char *path, size_t most, size_t *size, himc_error *error);

/// The same, but with a `folder` (a real path, not NULL) only of a file inside it, links followed;
/// if there is none, the line is the same whatever stands there, and tells nothing about the disk.
char *himc_file_load_in(const char *folder, const char *path, size_t most, size_t *size,
                        himc_error *error);

#endif
