/// info.c: `himc info`: describes a take or a score in a few lines.
#include "capture/take.h"
#include "cli.h"
#include "capture/take.h"

#include "himc/drum.h"
#include "plan/score.h"
#include "himc/mocap.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

static bool json; // with --json lines are pairs of an array, ["name", "text"]
static int told;

// a line "name: text" or "name   text"; one that goes on begins with blanks
static void print_line(void *user, const char *line)
{
    (void)user;
    if (!json) {
        puts(line);
        return;
    }
    char name[64] = "";
    const char *text = line;
    if (*line != ' ') {
        snprintf(name, sizeof name, "%.*s", (int)strcspn(line, ": "), line);
        text += strlen(name);
    }
    text += strspn(text, ": ");
    printf("%s  [", told++ ? ",\n" : "[\n");
    cli_put_json_text(stdout, name);
    printf(", ");
    cli_put_json_text(stdout, text);
    printf("]");
}

static void tell(const char *format, ...) __attribute__((format(printf, 1, 2)));

static void tell(const char *format, ...)
{
    char line[512];
    va_list args;
    va_start(args, format);
    vsnprintf(line, sizeof line, format, args);
    va_end(args);
    print_line(NULL, line);
}

/// "7 legato, 5 tenuto, 2 accent"
static void count_nuances(const himc_score *score, int hand, char *text, size_t size)
{
    size_t used = 0;
    text[0] = '\0';
    for (int nuance = 0; nuance < HIMC_NUANCES; nuance++) {
        int count = 0;
        for (int i = 0; i < score->stroke_count; i++)
            count += score->strokes[i].ornament < HIMC_ROLL_SINGLE &&
                     (int)score->strokes[i].hand == hand && (int)score->strokes[i].nuance == nuance;
        if (count && used < size)
            used += (size_t)snprintf(text + used, size - used, "%s%d %s", used ? ", " : "", count,
                                     himc_nuance_name((himc_nuance)nuance));
    }
}

// "rolls   2 single, 1 press", or nothing
static void tell_ornaments(const himc_score *score, const char *name, const char *const *kinds,
                           int first, int last)
{
    char text[80] = "";
    int all = 0;
    for (int kind = first; kind <= last; kind++) {
        int count = 0;
        for (int i = 0; i < score->stroke_count; i++)
            count += (int)score->strokes[i].ornament == kind;
        if (count)
            sprintf(text + strlen(text), "%s%d %s", all ? ", " : "", count, kinds[kind - first]);
        all += count;
    }
    if (all)
        tell("%-7s %s", name, text);
}

// strokes with their grace notes as one; both hands play a roll
static void print_strokes(const himc_score *score)
{
    static const char *const graces[] = {"flam", "drag", "ruff"}, *const rolls[] = {
                                                                      "single", "double", "press"};
    int count = 0;
    for (int i = 0; i < score->stroke_count; i++)
        count += score->strokes[i].ornament < HIMC_ROLL_SINGLE;
    tell("strokes %d", count);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        char text[160];
        count_nuances(score, hand, text, sizeof text);
        tell("%-7s %s", himc_hand_name((himc_hand)hand), text[0] ? text : "nothing");
    }
    tell_ornaments(score, "grace", graces, HIMC_FLAM, HIMC_RUFF);
    tell_ornaments(score, "rolls", rolls, HIMC_ROLL_SINGLE, HIMC_ROLL_PRESS);
}

/// From the first stroke to the last, or the end of the last roll, in beats and through the tempo
/// changes in seconds.
static void print_length(const himc_score *score)
{
    if (!score->stroke_count)
        return;
    double first = score->strokes[0].beat, last = first;
    for (int i = 0; i < score->stroke_count; i++)
        last = fmax(last, score->strokes[i].beat + (score->strokes[i].ornament >= HIMC_ROLL_SINGLE
                                                        ? score->strokes[i].length
                                                        : 0));
    double seconds = himc_score_seconds(score->tempi, score->tempo_count, last) -
                     himc_score_seconds(score->tempi, score->tempo_count, first);
    tell("beats   %g to %g", first, last);
    tell("length  %.3f s from the first stroke to the last", seconds);
}

static void print_tempo(const himc_score *score)
{
    char text[400] = "";
    for (int i = 0; i < score->tempo_count && strlen(text) < sizeof text - 64; i++) {
        if (i)
            sprintf(text + strlen(text), ", from beat %g ", score->tempi[i].beat);
        sprintf(text + strlen(text), "%g", score->tempi[i].bpm);
    }
    tell("tempo   %s BPM", text);
}

static void print_drum(const himc_command *c, int before, char *text)
{
    const char *comma = before ? ", " : "", *name = c->atom[0].symbol;
    if (c->id == HIMC_COMMAND_INSTRUMENT)
        sprintf(text, "%s%s %.24s", comma, name, c->atom[1].symbol);
    else
        sprintf(text, "%s%s %g inches", comma, name,
                c->count > 1 ? c->atom[1].number : HIMC_INCHES_USUAL);
}

static void print_drums(const himc_score *score)
{
    char text[HIMC_DRUMS * (HIMC_NAME_SIZE + 32)] = "";
    int drums = 0;
    for (int i = 0; i < score->line_count && drums < HIMC_DRUMS; i++)
        if (himc_score_makes_drum(&score->lines[i]))
            print_drum(&score->lines[i].command, drums++, text + strlen(text));
    if (!drums)
        sprintf(text, "%s %g inches (none named)", CLI_DRUM, CLI_INCHES);
    tell("drums   %s", text);
}

// a text of several lines
static void tell_lines(const char *text)
{
    for (size_t length; (length = strcspn(text, "\n")) > 0; text += length + (text[length] != 0))
        tell("%.*s", (int)length, text);
}

static bool describe_score(const char *path, himc_error *error)
{
    himc_score *score = himc_score_load(path, error);
    if (!score)
        return false;
    if (score->report)
        tell_lines(score->report);
    print_strokes(score);
    print_length(score);
    print_tempo(score);
    print_drums(score);
    himc_score_free(score);
    return true;
}

static const cli_option options[] = {
    CLI_TAKE_OPTIONS,
    {"json", 0, NULL,
     "the lines as one JSON array of [name, text]; of a take each strike: s, hand, m/s, m"},
    {"analog", 0, "F.csv",
     "writes the samples of a C3D's analog channels: time_s and each channel"},
    {0}};
enum { JSON = CLI_TAKE_VALUES, ANALOG };

static bool describe_player(himc_take *take, const himc_take_options *take_options,
                            himc_error *error)
{
    himc_skeleton_config given = himc_skeleton_default();
    himc_player *player = himc_player_new(take, take_options, &given, error);
    if (!player) { // the take was read nevertheless
        tell("player: none that can play: %s", error->text);
        return true;
    }
    himc_drum *drum = himc_drum_new(CLI_DRUM, CLI_INCHES, 48000, error);
    if (drum) {
        himc_head_frame place = *himc_drum_head_frame(drum);
        bool seated = himc_player_sit(player, take, take_options, &place, NULL);
        himc_player_describe(player, seated ? &place : NULL, print_line, NULL);
    }
    himc_player_free(player);
    himc_drum_release(drum);
    return drum != NULL;
}

static bool write_analog(const himc_take *take, const char *path, himc_error *error)
{
    cli_file file = {0};
    if (!path)
        return true;
    if (!take->analog)
        return himc_error_set(error, "--analog: %s has no analog channels", take->file);
    if (!cli_file_open(&file, path, error))
        return false;
    fputs("time_s", file.stream);
    for (int channel = 0; channel < take->analog_channels; channel++) {
        char quoted[2 * TAKE_NAME] = "", *to = quoted;
        for (const char *from = take->analog_names[channel]; *from; *to++ = *from++)
            if (*from == '"')
                *to++ = '"';
        fprintf(file.stream, ",\"%s\"", quoted);
    }
    for (int i = 0; i < take->analog_samples; i++) {
        fprintf(file.stream, "\n%.6f", i / take->analog_rate);
        for (int channel = 0; channel < take->analog_channels; channel++)
            fprintf(file.stream, ",%.9g", take->analog[i * take->analog_channels + channel]);
    }
    fputc('\n', file.stream);
    bool good = cli_file_close(&file, error) && cli_file_keep(&file, error);
    cli_file_drop(&file);
    return good;
}

// each strike of a take, with --json: time (s), hand, speed (m/s), place (m)
static bool list_strikes(himc_take *take, const himc_take_options *take_options, himc_error *error)
{
    himc_take_tip tips[HIMC_HANDS];
    himc_strike_survey seen;
    himc_error none;
    if (!json || !himc_take_tips(take, take_options, tips, &none)) // a take may have no tips
        return true;
    if (!himc_take_strikes(take, tips, &seen))
        return himc_error_set(error, "out of memory");
    for (int i = 0; i < seen.count; i++) {
        const himc_take_strike *s = &seen.strikes[i];
        tell("strike %.5f %s %.4f %.4f %.4f %.4f", s->time, himc_hand_name(s->hand), s->velocity,
             s->x.x, s->x.y, s->x.z);
    }
    free(seen.strikes);
    return true;
}

static bool describe_take(const char *path, const himc_take_options *take_options,
                          const char *analog, himc_error *error)
{
    himc_take *take = himc_take_load(path, take_options, error);
    if (!take)
        return false;
    if (!write_analog(take, analog, error)) {
        himc_take_free(take);
        return false;
    }
    himc_take_tip tips[HIMC_HANDS];
    bool named = take_options->left_tip || take_options->right_tip;
    if (named && !himc_take_tips(take, take_options, tips, error)) {
        himc_take_free(take);
        return false;
    }
    himc_take_describe(take, take_options, print_line, NULL);
    bool described =
        describe_player(take, take_options, error) && list_strikes(take, take_options, error);
    himc_take_free(take);
    return described;
}

static int run(const cli_arguments *arguments)
{
    himc_error error;
    const char *path = cli_input(arguments->operand, &error);
    himc_take_options take_options;
    json = arguments->value[JSON] != NULL;
    bool good =
        path && cli_take_options(path, arguments->value, &take_options, &error) &&
        (cli_is_take(path) ? describe_take(path, &take_options, arguments->value[ANALOG], &error)
                           : describe_score(path, &error));
    if (json && good)
        printf("\n]\n");
    return good ? cli_finish(&cli_info) : cli_fail(&cli_info, "%s", error.text);
}

const cli_call cli_info = {
    "info",
    "FILE",
    "",
    "describes a score, MIDI, MusicXML or a take," HIMC_TAKE_SUFFIXES,
    "Of MIDI and MusicXML: what of it can be played, and the score made of it. Of a take:\n"
    "rate, length, points, gaps, the strikes found in it, the player, where drumhead and\n"
    "seat are placed.",
    options,
    run,
};
