/// pages.h: all files that the viewer serves, linked into the program.
#ifndef VIEWER_PAGES_H
#define VIEWER_PAGES_H

#include <stddef.h>

typedef struct page {
    const char *path, *type; ///< "/main.js", "text/javascript"
    const char *begin, *end;
} page;

/// The page of exactly that path, or NULL.
const page *pages_find(const char *path);
/// Page `index` (from 0), or NULL past the last.
const page *pages_at(int index);

#endif
