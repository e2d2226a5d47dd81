/// cli.c: one table of options per call serves the parser, its error lines and --help, so they
/// cannot disagree.
///
/// getopt_long splits the arguments and prints nothing: an error here is one line with the call,
/// the fault and the allowed values. Options have a value, switches none; the last of two equal
/// options counts, as in POSIX tools.
#define _POSIX_C_SOURCE 200809L
#include "cli.h"

#include "base/line.h"
#include "base/text.h"
#include "capture/take.h"
#include "plan/score.h"

#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/// getopt's return value of option i, out of the way of letters and of its own '?' and ':'.
#define OPTION_BASE 1000
#define OPTION_HELP 999
#define OPTION_QUIET 998

static bool quiet; // of the whole program, as its streams are

void cli_say(const char *format, ...)
{
    char line[2048];
    va_list args;
    va_start(args, format);
    vsnprintf(line, sizeof line, format, args);
    va_end(args);
    cli_name_input(line);
    if (!quiet)
        fputs(line, stderr);
}

bool cli_shows_progress(void)
{
    return !quiet && isatty(STDERR_FILENO);
}

void cli_put_json_text(FILE *stream, const char *text)
{
    fputc('"', stream);
    for (size_t bytes; *text; text += bytes ? bytes : 1) {
        bytes = himc_line_character(text);
        if (*text == '"' || *text == '\\')
            fprintf(stream, "\\%c", *text);
        else if ((unsigned char)*text < ' ')
            fprintf(stream, "\\u%04x", *text);
        else if (bytes)
            fwrite(text, 1, bytes, stream);
        else
            fputs("\\ufffd", stream); // not UTF-8
    }
    fputc('"', stream);
}

static void fill_getopt(const cli_option *options, struct option *wide, char *letters)
{
    *letters++ = ':';
    int count = 0;
    for (; options[count].name; count++) {
        wide[count] = (struct option){options[count].name,
                                      options[count].value ? required_argument : no_argument, NULL,
                                      OPTION_BASE + count};
        if (options[count].letter) {
            *letters++ = options[count].letter;
            *letters++ = ':';
        }
    }
    *letters++ = 'h';
    *letters = '\0';
    wide[count++] = (struct option){"quiet", no_argument, NULL, OPTION_QUIET};
    wide[count++] = (struct option){"help", no_argument, NULL, OPTION_HELP};
    wide[count] = (struct option){NULL, 0, NULL, 0};
}

/// "-o --rate --block ... --help"
static void list_options(const cli_option *options, char *text, size_t size)
{
    size_t used = 0;
    text[0] = '\0';
    for (; options->name && used < size; options++) {
        if (options->letter)
            used += (size_t)snprintf(text + used, size - used, "-%c ", options->letter);
        else
            used += (size_t)snprintf(text + used, size - used, "--%s ", options->name);
    }
    if (used < size)
        snprintf(text + used, size - used, "--quiet --help");
}

static int find_letter(const cli_option *options, int letter)
{
    for (int i = 0; options[i].name; i++)
        if (options[i].letter == letter)
            return i;
    return -1;
}

static bool refuse_option(const cli_option *options, const char *word, himc_error *error)
{
    char allowed[512], name[64];
    himc_nearest nearest = {.word = name};
    snprintf(name, sizeof name, "%.*s", (int)strcspn(word + 2, "="), word + 2);
    for (const cli_option *option = options; option->name; option++)
        himc_nearest_try(&nearest, option->name);
    list_options(options, allowed, sizeof allowed);
    if (nearest.name)
        return himc_error_set(error, "unknown option %s, did you mean --%s?", word, nearest.name);
    return himc_error_set(error, "unknown option %s, expected %s", word, allowed);
}

static bool take_value(const cli_option *option, int index, const char *value, cli_arguments *out,
                       himc_error *error)
{
    const char *kind = option->value ? option->value : "";
    out->list = !strncmp(kind, "LIST", 4) && !strcmp(value, "help");
    out->value[index] = value;
    if (strlen(kind) < 3 || strcmp(kind + strlen(kind) - 3, "..."))
        return true;
    if (out->repeats == CLI_REPEATED)
        return himc_error_set(error, "--%s: more than %d", option->name, CLI_REPEATED);
    out->repeated[out->repeats++] = value;
    return true;
}

bool cli_read(const cli_call *call, int argc, char **argv, cli_arguments *out, himc_error *error)
{
    struct option wide[CLI_OPTIONS + 3];
    char letters[2 * CLI_OPTIONS + 3], allowed[512];
    fill_getopt(call->options, wide, letters);
    list_options(call->options, allowed, sizeof allowed);
    *out = (cli_arguments){0};
    opterr = 0;
    int found;
    while ((found = getopt_long(argc, argv, letters, wide, NULL)) != -1) {
        if (found == OPTION_HELP || found == 'h')
            return out->help = true;
        if (found == OPTION_QUIET) {
            quiet = true;
            continue;
        }
        if (found == ':')
            return himc_error_set(error, "%s needs a value after it (himc %s --help)",
                                  argv[optind - 1], call->name);
        int index = found >= OPTION_BASE ? found - OPTION_BASE : find_letter(call->options, found);
        if (found == '?' && optopt > 0 && optopt < OPTION_QUIET)
            return himc_error_set(error, "unknown option -%c, expected %s", optopt, allowed);
        if (found == '?' || index < 0)
            return refuse_option(call->options, argv[optind - 1], error);
        if (!take_value(&call->options[index], index, optarg ? optarg : "", out, error))
            return false;
        if (out->list)
            return true;
    }
    // further files of an option that takes several, as a shell's *.c3d gives them
    bool several = call->operand[0] != '[' && strstr(call->operand, "...");
    for (; (out->repeats || several) && strstr(call->operand, "...") && argc > optind; optind++) {
        if (out->repeats == CLI_REPEATED)
            return himc_error_set(error, "more than %d files", CLI_REPEATED);
        out->repeated[out->repeats++] = argv[optind];
    }
    if (argc > optind && (!call->operand[0] || strstr(call->operand, "...")))
        return himc_error_set(error, "\"%s\" is one too many (himc %s --help)", argv[optind],
                              call->name);
    const char *second = strchr(call->operand, ' ');
    if (argc - optind > 1 + (second != NULL))
        return himc_error_set(error, "one %s at a time: \"%s\" is one too many", call->operand,
                              argv[optind + 1 + (second != NULL)]);
    out->operand = argv[optind];
    out->second = second && out->operand ? argv[optind + 1] : NULL;
    if (second && out->operand && !out->second)
        return himc_error_set(error, "no%s given (himc %s --help)", second, call->name);
    if (!out->operand && !out->repeats && call->operand[0] && call->operand[0] != '[')
        return himc_error_set(error, "no %s given (himc %s --help)", call->operand, call->name);
    return true;
}

void cli_help(const cli_call *call)
{
    printf("usage: himc %s%s%s%s [OPTION...]\n\n%s\n", call->name, call->operand[0] ? " " : "",
           call->operand, call->needs, call->does);
    if (call->more[0])
        printf("\n%s\n", call->more);
    printf("\n");
    for (const cli_option *option = call->options; option->name; option++) {
        char left[64], letter[8] = "    ";
        if (option->letter)
            snprintf(letter, sizeof letter, "-%c, ", option->letter);
        const himc_command_row *row =
            option->value ? himc_command_find(HIMC_PERFORMER, option->value) : NULL;
        snprintf(left, sizeof left, "%s--%s %s", letter, option->name,
                 row             ? row->atoms
                 : option->value ? option->value
                                 : "");
        printf("  %-24s %s\n", left, option->does);
    }
    printf("  %-24s %s\n", "    --quiet", "no prose and no progress on stderr, errors only");
}

int cli_fail(const cli_call *call, const char *format, ...)
{
    fflush(stdout);
    char line[sizeof((himc_error *)0)->text];
    va_list args;
    va_start(args, format);
    himc_line_print(line, sizeof line, format, args);
    va_end(args);
    cli_name_input(line);
    fprintf(stderr, "himc %s: %s\n", call->name, line);
    return 1;
}

int cli_finish(const cli_call *call)
{
    errno = 0;
    if (fflush(stdout) || ferror(stdout))
        return cli_fail(call, "standard output: %s", errno ? strerror(errno) : "write error");
    return 0;
}

bool cli_count(const char *name, const char *text, int low, int high, const char *unit, int *out,
               himc_error *error)
{
    if (!text)
        return true;
    char *end;
    double value = strtod(text, &end);
    if (end == text || *end || (isfinite(value) && value != floor(value)))
        return himc_error_set(error, "%s: \"%s\" is not a whole number, expected %d .. %d %s", name,
                              text, low, high, unit);
    if (!himc_check_range(name, value, low, high, unit, error))
        return false;
    *out = (int)value;
    return true;
}

const himc_score_line *cli_first_drum(const himc_score *score)
{
    for (int i = 0; i < score->line_count; i++)
        if (himc_score_makes_drum(&score->lines[i]))
            return &score->lines[i];
    return NULL;
}

bool cli_take_options(const char *path, const char *const value[CLI_TAKE_VALUES],
                      himc_take_options *out, himc_error *error)
{
    static const char *const name[] = {"--left-tip", "--right-tip", "--up", "--subject"};
    const char *up = value[2];
    *out = himc_take_default();
    out->left_tip = value[0];
    out->right_tip = value[1];
    out->subject = value[3];
    for (int i = 0; i < CLI_TAKE_VALUES; i++)
        if (value[i] && !cli_is_take(path))
            return himc_error_set(error, "%s: %s is a score, expected a take:" HIMC_TAKE_SUFFIXES,
                                  name[i], path);
    if (!up)
        return true;
    if (strcmp(up, "y") && strcmp(up, "z"))
        return himc_error_set(error, "--up: \"%s\", expected y or z", up);
    out->up = up[0] == 'y' ? HIMC_UP_Y : HIMC_UP_Z;
    return true;
}

bool cli_is_take(const char *path)
{
    return himc_take_is_capture(path);
}

bool cli_tell(himc_performance *performance, const char *text, const char *word, himc_error *error)
{
    himc_command command;
    himc_atom atom = {HIMC_ATOM_SYMBOL, 0, word};
    bool good = word ? himc_command_parse(&command, HIMC_PERFORMER, text, &atom, 1, error)
                     : himc_command_parse_text(&command, HIMC_PERFORMER, text, error);
    return good && himc_performance_command(performance, &command, 0, error);
}

bool cli_add_drum(himc_performance *performance, double rate, himc_error *error)
{
    himc_drum *drum = himc_drum_new(CLI_DRUM, CLI_INCHES, rate, error);
    bool good = drum && himc_performance_add_drum(performance, drum, error);
    himc_drum_release(drum);
    return good;
}

double cli_now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}
