/// share.c: `himc share`: a scene and the viewer's page in one file to send.
///
/// The page is linked in where three.js was there when the program was built (HIMC_SHARE).
#include "cli.h"

#include <stdlib.h>
#include <string.h>

enum { OUT };

static const cli_option options[] = {
    {"output", 'o', "PAGE.html", "the page"},
    {0},
};

#ifdef HIMC_SHARE
#include "recording.h"
#include "share.h"

static bool share(const char *source, const char *path, himc_error *error)
{
    cli_file page = {0};
    size_t size;
    char *scene = recording_load(source, &size, error);
    bool good = scene && cli_file_open(&page, path, error) &&
                share_write(page.stream, scene, size, source, error) &&
                cli_file_close(&page, error) && cli_file_keep(&page, error);
    cli_file_drop(&page);
    free(scene);
    return good;
}
#else
static bool share(const char *source, const char *path, himc_error *error)
{
    return himc_error_set(error,
                          "%s to %s: this himc was built without three.js (Debian: "
                          "libjs-three), which the page needs",
                          source, path);
}
#endif

static int run(const cli_arguments *arguments)
{
    himc_error error;
    const char *out = arguments->value[OUT];
    if (!out)
        return cli_fail(&cli_share, "no -o PAGE.html given (himc share --help)");
    const char *scene = cli_input(arguments->operand, &error);
    bool good = scene && cli_ending_is("-o", out, ".html", &error) &&
                cli_apart(out, &scene, 1, &error) && share(scene, out, &error);
    return good ? cli_finish(&cli_share) : cli_fail(&cli_share, "%s", error.text);
}

const cli_call cli_share = {
    "share",
    "SCENE",
    " -o PAGE.html",
    "makes one page of a scene (himc render --scene), with figure, sound and timeline",
    "The page needs no server and no network: any browser opens the file.",
    options,
    run,
};
