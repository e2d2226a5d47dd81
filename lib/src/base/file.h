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

/// A regular file that appears complete or not at all: it is written beside its final place and
/// renamed in the end, so that a disk that is full costs nobody the old one. Links are followed:
/// the link stays and its file changes. /dev/null is written directly. All zero: none.
typedef struct himc_file_draft {
    FILE *stream;    ///< NULL when closed
    char path[4096]; ///< its final place
    char temp[4096]; ///< where it is written until it is kept; "" when written directly
} himc_file_draft;

/// Opens for writing. False with one line; nothing is left then.
bool himc_file_draft_open(himc_file_draft *draft, const char *path, himc_error *error);

/// Writes all to the disk and closes. False with one line, and dropped, if that fails.
bool himc_file_draft_close(himc_file_draft *draft, himc_error *error);

/// Gives a closed file its name. False with one line, and dropped, if that fails.
bool himc_file_draft_keep(himc_file_draft *draft, himc_error *error);

/// Closes the file and removes it unless it was kept. Safe in any state.
void himc_file_draft_drop(himc_file_draft *draft);

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
