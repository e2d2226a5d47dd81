/// import.c: `himc import`: makes a score, to be read and edited, of a MIDI or MusicXML file.
///
/// What is played and what is not, with the reasons, is printed on stderr; the score's first
/// comments say the same.
#include "base/file.h"
#include "cli.h"
#include "musicxml/import.h"
#include "musicxml/names.h"

#include <stdlib.h>
#include <string.h>

#define MOST_BYTES ((size_t)64 << 20) // of a file; each reader has its own limit
#define USUAL_RANGE 22.0 // of `--curve square` (dB): from ppp to fff of this instrument

enum { OUT, PART, CURVE, SETUP, TRACK, CHANNEL, AS };

static const cli_option options[] = {
    {"output", 'o', "SCORE", "the score; - is the standard output"},
    {"part", 0, "PART", "the player of the first of these of which the file has any"},
    {"curve", 0, "CURVE", "how velocities become dynamics (notation)"},
    {"setup", 0, "NAME|FILE", "drums: a set-up, whose instruments play them"},
    {"track", 0, "N", "only notes of that track or part, from 1"},
    {"channel", 0, "N", "only notes of that channel, 1 .. 16"},
    {"as", 0, "INSTRUMENT", "what notes of MIDI are played on: timpani, marimba, snare drum ..."},
    {0},
};

static bool read_curve(const char *word, double *range, himc_error *error)
{
    const size_t square = strlen("square");
    *range = 0;
    if (!word || !strcmp(word, "notation"))
        return true;
    *range = USUAL_RANGE;
    if (!strcmp(word, "square"))
        return true;
    char *end = NULL;
    if (!strncmp(word, "square:", square + 1))
        *range = strtod(word + square + 1, &end);
    if (!end || end == word + square + 1 || *end)
        return himc_error_set(error, "--curve: \"%s\", expected notation, square, square:DB", word);
    return himc_check_range("--curve square", *range, 1, 80, "dB", error);
}

static bool read_part(const char *word, midi_options *wanted, himc_error *error)
{
    wanted->all = word && strcmp(word, "all") == 0;
    for (int i = 1; i < MIDI_CHOICES && word; i++)
        if (strcmp(word, himc_midi_choice_name((midi_choice)i)) == 0)
            wanted->choice = (midi_choice)i;
    return !word || wanted->all || wanted->choice != MIDI_ANY ||
           himc_error_set(error,
                          "--part: \"%s\", expected timpani drums marimba xylophone vibraphone "
                          "glockenspiel tubular-bell all",
                          word);
}

static bool read_number(const char *option, const char *word, int most, int *number,
                        himc_error *error)
{
    char *end = NULL;
    long n = word ? strtol(word, &end, 10) : 0;
    *number = (int)n;
    return !word || (end != word && !*end && n >= 1 && n <= most) ||
           himc_error_set(error, "%s: \"%s\", expected 1 .. %d", option, word, most);
}

static bool read_as(const char *word, midi_options *wanted, himc_error *error)
{
    int key = 0;
    if (!word)
        return true;
    wanted->as = strcmp(word, "drums") == 0 ? MIDI_DRUMS : himc_music_instrument(word, &key);
    wanted->as_key = wanted->as == MIDI_DRUMS && key > 0 ? key : 0;
    return wanted->as != MIDI_ANY ||
           himc_error_set(error, "--as: \"%s\", expected an instrument that is played here", word);
}

static bool import(const char *path, const char *name, const midi_options *wanted, midi_score *made,
                   himc_error *error)
{
    size_t size;
    char *bytes = himc_file_load(path, MOST_BYTES, &size, error);
    himc_score_maker *make = bytes ? himc_score_maker_of(bytes, size) : NULL;
    make = make ? make : himc_midi_import; // which says that it is none
    bool good = bytes && (make(made, bytes, size, name, wanted, error) ||
                          himc_error_prefix(error, "%s", name));
    free(bytes);
    return good;
}

static bool write_text(const char *path, const char *text, himc_error *error)
{
    cli_file file = {0};
    if (!strcmp(path, "-")) {
        fputs(text, stdout);
        return true;
    }
    if (!cli_file_open(&file, path, error))
        return false;
    fputs(text, file.stream);
    return cli_file_close(&file, error) && cli_file_keep(&file, error);
}

static bool make(const cli_arguments *arguments, midi_score *made, himc_error *error)
{
    const char *path, *out = arguments->value[OUT];
    midi_options wanted = {.setup = arguments->value[SETUP]};
    if (!out)
        return himc_error_set(error, "no -o SCORE given (himc import --help)");
    if (!(path = cli_input(arguments->operand, error)) || !cli_apart(out, &path, 1, error))
        return false;
    const char *dot = strrchr(out, '.');
    if (cli_is_take(out) || (dot && (!strcmp(dot, ".mid") || !strcmp(dot, ".wav"))))
        return himc_error_set(error, "%s: a score is a text, expected a name like score.txt", out);
    return read_part(arguments->value[PART], &wanted, error) &&
           read_curve(arguments->value[CURVE], &wanted.range, error) &&
           read_number("--track", arguments->value[TRACK], 65535, &wanted.track, error) &&
           read_number("--channel", arguments->value[CHANNEL], 16, &wanted.channel, error) &&
           read_as(arguments->value[AS], &wanted, error) &&
           import(path, cli_is_standard(arguments->operand) ? "standard input" : path, &wanted,
                  made, error) &&
           write_text(out, made->text, error);
}

static int run(const cli_arguments *arguments)
{
    himc_error error;
    midi_score made = {0};
    bool good = make(arguments, &made, &error);
    if (good)
        fputs(made.report, stderr);
    himc_midi_score_free(&made);
    return good ? cli_finish(&cli_import) : cli_fail(&cli_import, "%s", error.text);
}

const cli_call cli_import = {
    "import",
    "FILE",
    " -o SCORE",
    "makes a score of the percussion in a MIDI or MusicXML file",
    "Notes of timpani are played on up to four drums, with pedals that move between them;\n"
    "those of the drum channel of General MIDI on a kit and what stands around it; those of\n"
    "keyboards on their bars. One player has two hands and feet: what cannot be played is\n"
    "said on stderr, a line for each reason.\n"
    "render, info and the command `score` read such a file in the same way by themselves.\n"
    "MusicXML: .musicxml and .mxl, score-partwise.\n"
    "\n"
    "PART: timpani (program 48 of General MIDI and tracks of that name), drums (channel 10),\n"
    "marimba, xylophone, vibraphone, glockenspiel, tubular-bell (programs 13, 14, 12, 10, 15);\n"
    "all: those of all players, for one. A part of MusicXML, or a channel of a track, is a player\n"
    "with several instruments, as are tracks whose names begin alike: \"Player 1: Xylophone\".\n"
    "CURVE: `notation`, as notation programs write them, 16 ppp .. 112 ff in equal steps; or\n"
    "`square:DB`, the square law of synthesisers over a range of 1 .. 80 dB; `square` is 22.",
    options,
    run,
};
