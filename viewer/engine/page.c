/// page.c: writes the page that plays by itself: the performer as WebAssembly and pieces for it.
///
///     page OUT.html ENGINE.wasm [PIECE ...]
#include "base/file.h"
#include "share.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FILES = 64, LARGEST = 64 << 20 };

static int fail(const char *why)
{
    fprintf(stderr, "page: %s\n", why);
    return 1;
}

int main(int count, char **name)
{
    share_file file[FILES];
    himc_error error = {""};
    int files = 0;
    bool good = true;
    if (count < 3 || count - 2 > FILES)
        return fail("expected OUT.html ENGINE.wasm [PIECE ...]");
    for (int i = 2; good && i < count; i++) {
        const char *slash = strrchr(name[i], '/');
        share_file *f = &file[files];
        char *bytes = himc_file_load(name[i], LARGEST, &f->size, &error);
        f->name = slash ? slash + 1 : name[i];
        f->bytes = bytes;
        good = bytes != NULL;
        files += good;
    }
    himc_file_draft out = {0};
    good = good && himc_file_draft_open(&out, name[1], &error) &&
           share_write_files(out.stream, file, files, &error) &&
           himc_file_draft_close(&out, &error) && himc_file_draft_keep(&out, &error);
    himc_file_draft_drop(&out);
    while (files > 0)
        free((void *)file[--files].bytes);
    return good ? 0 : fail(error.text);
}
