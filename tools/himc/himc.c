/// himc.c: the command line: `himc CALL ...`; each call is a file of its own beside this one.
///
/// Exit status 0, or 1 with one line on stderr that says what was wrong, where, and what is
/// allowed.
#include "base/argument.h"
#include "base/format.h"
#include "base/text.h"
#include "cli.h"
#include "himc/himc.h"
#include "system/files.h"

#include <ctype.h>
#include <string.h>

static const cli_call *const calls[] = {
    &cli_render,
#ifndef _WIN32 // their workers are forks
    &cli_evaluate, &cli_edit,
#endif
    &cli_info,     &cli_lesson, &cli_modes, &cli_fit,   &cli_import, &cli_export,
    &cli_share,    &cli_film,   &cli_play,  &cli_serve, &cli_bench,
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
        "\nhimc CALL --help says more, himc help commands lists the commands of scores and patches,\n"
        "himc help COMMAND one of them with the allowed values of its atoms,\n"
        "himc --version prints the version, --licences the terms of himc and of what it contains.\n"
        "A file - is the standard input or output. Exit status 0, or 1 with one line on standard\n"
        "error that says what was wrong and where.\n");
}

// what each argument of a command may be, once
static void print_arguments(const himc_command_row *row)
{
    char context[64], text[256], word[64];
    const himc_argument *told[HIMC_COMMAND_ATOMS];
    int count = 0;
    himc_format(context, sizeof context, "%s", row->name);
    for (const char *at = row->atoms; *at; at += strspn(at, " []|")) {
        if (at - row->atoms >= 2 && at[-2] == '|') // another form begins
            himc_format(context, sizeof context, "%s", row->name);
        size_t length = strcspn(at, " []|");
        himc_format(word, sizeof word, "%.*s", (int)length, at);
        at += length;
        const himc_argument *argument = himc_argument_find(word, context);
        if (!argument && islower((unsigned char)word[0]))
            himc_format(context, sizeof context, "%s", word);
        bool again = !argument || count == HIMC_COMMAND_ATOMS;
        for (int i = 0; i < count; i++)
            again = again || told[i] == argument;
        if (again)
            continue;
        told[count++] = argument;
        himc_argument_describe(argument, text, sizeof text);
        printf("      %-9s %s\n", word, text);
    }
}

// a command of the performer, of a drum, or both; false if there is none
static bool print_command(const char *name)
{
    const himc_command_row *row;
    bool found = false;
    for (int i = 0; (row = himc_command_table(i)); i++) {
        if (strcmp(row->name, name) != 0)
            continue;
        printf("%s%s%s%s\n    %s\n", row->receiver == HIMC_DRUM ? "DRUM " : "", row->name,
               row->atoms[0] ? " " : "", row->atoms, row->does);
        print_arguments(row);
        found = true;
    }
    return found;
}

// what is said in Pure Data alone, or comes out of an object there; false if it is none of that
static bool print_message(const char *name)
{
    static const struct {
        const char *name, *atoms, *does;
    } messages[] = {
        {"save", " SWITCH",
         "to [himc~] and [membrane~]: 1 keeps the object's state in the patch, 0 does not"},
        {"strike", " TIME HAND DRUM X Y VELOCITY FORCE DURATION",
         "from [himc~]: a contact has ended (s, m, m/s, N, s); from [membrane~] without HAND and DRUM"},
        {"touch", " TIME X Y VELOCITY PLACE PITCH",
         "from [membrane~]: a blow begins; PLACE per radius from the centre, PITCH in Hz"},
        {"missed", " BEAT HAND DRUM",
         "from [himc~]: a stroke is not played, and a line says why; BEAT -1: a hit"},
        {"beat", " N", "from [himc~]: a whole beat of the score begins"},
        {"done", "", "from [himc~]: all has been played"},
    };
    for (size_t i = 0; i < sizeof messages / sizeof *messages; i++)
        if (strcmp(messages[i].name, name) == 0)
            return printf("%s%s\n    %s\n", name, messages[i].atoms, messages[i].does) > 0;
    return false;
}

// what a score, a patch and a packet may say
static void print_commands(void)
{
    static const char *const to[] = {"to the performer", "to a drum: NAME COMMAND ..."};
    const himc_command_row *row;
    for (int receiver = HIMC_PERFORMER; receiver <= HIMC_DRUM; receiver++) {
        printf("%s%s\n\n", receiver ? "\n" : "", to[receiver]);
        for (int i = 0; (row = himc_command_table(i)); i++)
            if ((int)row->receiver == receiver)
                printf("  %s %s\n      %s\n", row->name, row->atoms, row->does);
    }
}

static const cli_call *find_call(const char *name)
{
    for (size_t i = 0; i < CALLS; i++)
        if (!strcmp(calls[i]->name, name))
            return calls[i];
    return NULL;
}

// `commands`: a command of scores may be meant, too
static int refuse(const char *what, const char *name, bool commands)
{
    const himc_command_row *row;
    static const char *const other[] = {"help",   "version",   "licences",
                                        "--help", "--version", "--licences"};
    himc_error line;
    himc_nearest nearest = {.word = name ? name : ""};
    for (size_t i = 0; i < sizeof other / sizeof *other; i++)
        himc_nearest_try(&nearest, other[i]);
    for (size_t i = 0; i < CALLS; i++)
        himc_nearest_try(&nearest, calls[i]->name);
    for (int i = 0; commands && (row = himc_command_table(i)); i++)
        himc_nearest_try(&nearest, row->name);
    himc_error_set(&line, "%s%s%s%s", what, name ? " \"" : "", name ? name : "", name ? "\"" : "");
    fprintf(stderr, "himc: %s, ", line.text);
    if (nearest.name)
        fprintf(stderr, "did you mean %s?\n", nearest.name);
    else {
        fprintf(stderr, "expected ");
        for (size_t i = 0; i < CALLS; i++)
            fprintf(stderr, "%s, ", calls[i]->name);
        fprintf(stderr, "--help, --version, --licences\n");
    }
    return 1;
}

static int finish(void)
{
    bool bad = fflush(stdout) || ferror(stdout);
    if (bad)
        fputs("himc: standard output cannot be written\n", stderr);
    return bad;
}

/// `himc help`, `himc help CALL`, `himc help commands`, `himc help COMMAND`: all that has the name.
static int help(const char *what)
{
    const cli_call *call = what ? find_call(what) : NULL;
    bool known = call;
    if (call)
        cli_help(call);
    if (call && (himc_command_find(HIMC_PERFORMER, what) || himc_command_find(HIMC_DRUM, what)))
        putchar('\n');
    if (!what)
        print_help();
    else if (!strcmp(what, "commands"))
        print_commands();
    else {
        known |= print_command(what);
        known |= print_message(what);
        if (!known)
            return refuse("no help for", what, true);
    }
    return finish();
}

static bool is_one_of(const char *word, const char *a, const char *b, const char *c)
{
    return !strcmp(word, a) || !strcmp(word, b) || !strcmp(word, c);
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
        return refuse("no call given", NULL, false);
    if (is_one_of(argv[1], "help", "--help", "-h"))
        return help(argc > 2 ? argv[2] : NULL);
    if (is_one_of(argv[1], "version", "--version", "-V")) {
        printf("himc %s\n", himc_version());
        return finish();
    }
    if (is_one_of(argv[1], "licences", "--licences", "--licenses")) {
        print_licences();
        return finish();
    }
    const cli_call *call = find_call(argv[1]);
    if (!call)
        return refuse(argv[1][0] == '-' ? "unknown option" : "unknown call", argv[1], false);
    return run_call(call, argc - 1, argv + 1);
}
