/// himc.c: the command line: `himc CALL ...`; each call is a file of its own beside this one.
///
/// Exit status 0, or 1 with one line on stderr that says what was wrong, where, and what is
/// allowed.
#include "cli.h"
#include "himc/himc.h"
#include "system/files.h"

#include <string.h>

static const cli_call *const calls[] = {
    &cli_render,
#ifndef _WIN32 // their workers are forks
    &cli_evaluate, &cli_edit,
#endif
    &cli_info,     &cli_modes, &cli_import, &cli_share,
    &cli_film,     &cli_play,  &cli_serve,  &cli_bench,
};
#define CALLS (sizeof calls / sizeof *calls)

// LICENSE and LIBRARIES.txt, as make has written them
static const char *const licences[] = {
#include "licences.h"
};

static void print_licences(void)
{
    for (size_t i = 0; i < sizeof licences / sizeof *licences; i++)
        puts(licences[i]);
}

static void print_help(void)
{
    printf("himc %s: a virtual timpanist\n\nusage: himc CALL ...\n\n", himc_version());
    for (size_t i = 0; i < CALLS; i++)
        printf("  %-8s %s\n", calls[i]->name, calls[i]->does);
    printf(
        "\nhimc CALL --help says more; himc --version prints the version, --licences the terms of himc\n"
        "and of what it contains. A file - is the standard input or output. Exit status 0, or 1 with\n"
        "one line on standard error that says what was wrong and where.\n");
}

static const cli_call *find_call(const char *name)
{
    for (size_t i = 0; i < CALLS; i++)
        if (!strcmp(calls[i]->name, name))
            return calls[i];
    return NULL;
}

/// "render, info, modes"
static void print_names(FILE *stream)
{
    for (size_t i = 0; i < CALLS; i++)
        fprintf(stream, "%s%s", i ? ", " : "", calls[i]->name);
}

static int refuse(const char *what, const char *name)
{
    himc_error line;
    himc_error_set(&line, "%s%s%s%s", what, name ? " \"" : "", name ? name : "", name ? "\"" : "");
    fprintf(stderr, "himc: %s, allowed: ", line.text);
    print_names(stderr);
    fprintf(stderr, ", --help, --version, --licences\n");
    return 1;
}

static int run_call(const cli_call *call, int argc, char **argv)
{
    cli_arguments arguments;
    himc_error error;
    if (!cli_read(call, argc, argv, &arguments, &error))
        return cli_fail(call, "%s", error.text);
    if (arguments.help) {
        cli_help(call);
        return cli_finish(call);
    }
    return call->run(&arguments);
}

int main(int argc, char **argv)
{
    himc_system_binary();
    if (argc < 2)
        return refuse("no call given", NULL);
    if (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h"))
        print_help();
    else if (!strcmp(argv[1], "--version"))
        printf("himc %s\n", himc_version());
    else if (!strcmp(argv[1], "--licences") || !strcmp(argv[1], "--licenses"))
        print_licences();
    else {
        const cli_call *call = find_call(argv[1]);
        if (!call)
            return refuse(argv[1][0] == '-' ? "unknown option" : "unknown call", argv[1]);
        return run_call(call, argc - 1, argv + 1);
    }
    return fflush(stdout) || ferror(stdout) ? refuse("standard output cannot be written", NULL) : 0;
}
