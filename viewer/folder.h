/// folder.h: the private folder of a running himc-viewer, in that for temporary files.
#ifndef VIEWER_FOLDER_H
#define VIEWER_FOLDER_H

#include "himc/base.h"

/// A folder that only this user may enter. All zero: none.
typedef struct folder {
    char path[256]; ///< "" for none
    int lock;       ///< descriptor that is locked as long as the program runs
} folder;

/// Removes the folders of programs that have ended without doing so (kill -9).
void folder_remove_stale(void);
/// Makes the folder if there is none; false with the reason.
bool folder_make(folder *f, himc_error *error);
/// Writes a file in it, which replaces one of that name; false with the reason.
bool folder_write(const folder *f, const char *name, const char *bytes, size_t size,
                  himc_error *error);
void folder_unlink(const folder *f, const char *name);
/// Removes the folder and the files in it: open.html, piece.*, himc-*.
void folder_remove(folder *f);

#endif
