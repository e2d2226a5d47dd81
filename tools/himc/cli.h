/// cli.h: shared by the calls of the program: options, failure, files, commands.
#ifndef CLI_H
#define CLI_H

#include "base/file.h"
#include "himc/performance.h"
#include "himc/mocap.h"

#include <stdio.h>

/// One option; the table of these is the parser's and the help's.
typedef struct cli_option {
    const char *name;  ///< "rate" is --rate
    char letter;       ///< 'o' is -o; 0 for none
    const char *value; ///< its argument, "HZ"; NULL for a switch; a command's name stands for the
                       ///< words of that command; "LIST" takes the word help, too; with "..." at
                       ///< its end the option may be repeated
    const char *does;
} cli_option;

#define CLI_OPTIONS 32
#define CLI_REPEATED 64 ///< of the values of the repeated option; chosen

/// The command line: the operands, and the value of each option or NULL, in the order of the
/// table ("" for a switch).
typedef struct cli_arguments {
    const char *operand, *second; ///< second: of a call with two operands
    const char *value[CLI_OPTIONS];
    const char *repeated[CLI_REPEATED]; ///< of the option that may be repeated
    int repeats;
    bool help;
    bool list; ///< an option's LIST is "help"
} cli_arguments;

/// One call of the program: `himc NAME ...`.
typedef struct cli_call {
    const char *name;
    const char *operand;       ///< "SOURCE", "[SCORE]" when it may be left out, "" for none,
                               ///< "SCORE TAKE" for two
    const char *needs;         ///< options that must be given, for the usage line: " -o OUT.wav"
    const char *does;          ///< one line
    const char *more;          ///< further text of --help, or ""
    const cli_option *options; ///< ends with a name of NULL
    int (*run)(const cli_arguments *arguments); ///< the exit status
} cli_call;

extern const cli_call cli_render, cli_evaluate, cli_info, cli_modes, cli_import, cli_share,
    cli_export, cli_fit, cli_film, cli_play, cli_serve, cli_bench, cli_edit, cli_lesson;

/// Reads the arguments after the call's name; false with one line: the fault and the allowed
/// values.
bool cli_read(const cli_call *call, int argc, char **argv, cli_arguments *out, himc_error *error);

/// A line of prose for the user (printf format), on stderr; nothing with --quiet.
void cli_say(const char *format, ...) __attribute__((format(printf, 1, 2)));
/// True if progress may be shown: stderr is a terminal, and no --quiet.
bool cli_shows_progress(void);
/// Prints a text as a JSON string.
void cli_put_json_text(FILE *stream, const char *text);

/// Prints usage and options.
void cli_help(const cli_call *call);

/// One line on stderr, "himc NAME: ..."; returns the exit status 1.
int cli_fail(const cli_call *call, const char *format, ...) __attribute__((format(printf, 2, 3)));

/// Returns 0, or fails if the output did not reach stdout (a full disk).
int cli_finish(const cli_call *call);

/// The whole number after option `name`, which must lie in [low, high]; unchanged if `text` is
/// NULL.
bool cli_count(const char *name, const char *text, int low, int high, const char *unit, int *out,
               himc_error *error);

/// A file that appears under its name complete or not at all; an interrupted run leaves nothing of
/// it. Its path is "" when it is not wanted, "-" for the standard output, which gets all of it in
/// the end, until then kept in a nameless file.
typedef himc_file_draft cli_file;

/// Opens for writing; does nothing if `path` is NULL.
bool cli_file_open(cli_file *file, const char *path, himc_error *error);
/// Writes all to the disk and closes; false, and the temporary file removed, if that fails.
bool cli_file_close(cli_file *file, himc_error *error);
/// Gives a closed file its name.
bool cli_file_keep(cli_file *file, himc_error *error);
/// Closes the file and removes it unless it was kept. Safe in any state, also all zero.
void cli_file_drop(cli_file *file);
/// A whole file, not kept yet: `write` puts `from` into it. Does nothing without a path.
bool cli_draft(cli_file *file, const char *path, void (*write)(const void *from, FILE *out),
               const void *from, himc_error *error);
/// The same, kept.
bool cli_write(const char *path, void (*write)(const void *from, FILE *out), const void *from,
               himc_error *error);
/// True if the name stands for the standard input or output.
bool cli_is_standard(const char *path);
/// Makes a temporary file, open for writing, which an interrupt removes: `path` must stay where it
/// is until cli_temporary_remove(). -1 with errno.
int cli_temporary(char *path, size_t size, const char *ending);
void cli_temporary_remove(const char *path);
/// The operand, or the name of a file with what came from the standard input, with the suffix of
/// its contents; it is removed when the program ends. NULL with the reason.
const char *cli_input(const char *operand, himc_error *error);
/// Replaces that file's name in a line by `-`, as the user has called it.
void cli_name_input(char *line);
/// True if both names are one file, existing or still to be made.
bool cli_same_file(const char *a, const char *b);
/// False with the reason if `name` is one of the `count` files; entries and name may be NULL.
bool cli_apart(const char *name, const char *const *files, int count, himc_error *error);

/// False with the reason if a file that is written has another ending; `name` may be NULL, or have
/// none.
bool cli_ending_is(const char *option, const char *name, const char *ending, himc_error *error);

/// The drum of a score that makes none.
#define CLI_DRUM "kettle"
#define CLI_INCHES HIMC_INCHES_USUAL

/// Gives the performance that drum.
bool cli_add_drum(himc_performance *performance, double rate, himc_error *error);
/// Gives the performance a command: the text, or, if `word` is not NULL, the name `text` with that
/// one word, which may contain spaces.
bool cli_tell(himc_performance *performance, const char *text, const char *word, himc_error *error);
/// A performance at `rate` (Hz) with the score or take `source` (NULL for none) and, if that makes
/// none, the drum. `listener` is a command before it, or NULL. NULL with the reason.
himc_performance *cli_load(const char *source, double rate, const char *listener,
                           himc_error *error);

/// Where a piece is heard if it does not say; chosen: beyond the first drum and a little to the
/// left, 1.7 m from its centre, facing the player. From the side, the node of (1,1), a drum is weak
/// and its noise strong.
#define CLI_LISTENER "listener usual"
#define CLI_BLOCK 8192 ///< most samples at a time; chosen: the longest block of Pd

/// The displacement of drums is not wanted. cli_load does this.
void cli_unwatch(himc_performance *performance);

/// How far a piece played offline is from its end. Zero at first.
typedef struct cli_ending {
    bool done;              ///< the performer has come to rest: set it at HIMC_EVENT_DONE
    uint64_t samples;       ///< played so far
    uint64_t done_at;       ///< sample at which a cell first found it done
    double peak, cell_peak; ///< of the sound so far, of the cell under way: raise it
} cli_ending;

#define CLI_CELL 0.2  ///< the end is tested so often (s), so it depends on no block's size; chosen
#define CLI_TAIL 40.0 ///< no piece lasts longer after it is done (s); chosen: no gong rings longer

/// Called where a cell ends: true if nothing more can be heard. The performer is done, rests, and a
/// whole cell stayed 80 dB below the peak, 60 after 8 s, or CLI_TAIL has passed.
bool cli_is_over(cli_ending *ending, int rate);

/// Time on the monotonic clock (s).
double cli_now(void);

/// The first line of a score that makes a drum, or NULL.
const himc_score_line *cli_first_drum(const himc_score *score);

/// The options of all calls that read a take; their values stand one after the other.
#define CLI_TAKE_OPTIONS                                                                    \
    {"left-tip", 0, "NAME", "a take's point at the left stick's tip (else found by name)"}, \
        {"right-tip", 0, "NAME", "the same, right"},                                        \
        {"up", 0, "z|y", "a take's upward axis (else as the file says)"},                   \
    {                                                                                       \
        "subject", 0, "NAME", "of several players in a take's file"                         \
    }
#define CLI_TAKE_VALUES 4
/// How the take at `path` is to be read, from the values of CLI_TAKE_OPTIONS. False if one is
/// wrong, or given with a score.
bool cli_take_options(const char *path, const char *const value[CLI_TAKE_VALUES],
                      himc_take_options *out, himc_error *error);
/// True if the name ends as a motion capture's does, also as one that himc refuses.
bool cli_is_take(const char *path);

#endif
