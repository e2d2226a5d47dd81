/// modes.c: `himc modes`: the frequencies and decays of a drum as a score tunes it before the first
/// stroke.
///
/// The two members of a pair (cosine and sine) are one row if they sound alike, else two. T60 is
/// the time in which a mode falls by 60 dB: ln(1000) over its decay rate.
#include "drum/drum_performer.h"
#include "cli.h"
#include "himc/drum.h"
#include "himc/membrane.h"
#include "himc/loader.h"

#include <math.h>
#include <string.h>

/// Every drum has a sample rate (Hz); the modes do not depend on it.
#define RATE 48000.0

/// Carries out the score's lines for this drum.
static bool tune(himc_drum *drum, const himc_score *score, const char *path, himc_error *error)
{
    himc_drum_set_external_sound(drum, true); // modes are the same whatever sounds
    for (int i = 0; i < score->line_count; i++) {
        const himc_score_line *line = &score->lines[i];
        if (strcmp(line->drum, himc_drum_name(drum)))
            continue;
        if (!himc_drum_command(drum, &line->command, error))
            return himc_error_prefix(error, "%s:%d: %s", path, line->line, line->drum);
    }
    return true;
}

/// The default drum, or the first one of the score.
static himc_drum *open_drum(const char *path, himc_error *error)
{
    if (!path)
        return himc_drum_new(CLI_DRUM, CLI_INCHES, RATE, error);
    himc_score *score = himc_score_load(path, error);
    if (!score)
        return NULL;
    const himc_score_line *line = cli_first_drum(score);
    himc_drum *drum = line ? himc_drum_made(&line->command, RATE, error)
                           : himc_drum_new(CLI_DRUM, CLI_INCHES, RATE, error);
    if (drum && !tune(drum, score, path, error)) {
        himc_drum_release(drum);
        drum = NULL;
    }
    himc_score_free(score);
    return drum;
}

static const cli_option options[] = {{"json", 0, NULL, "rows as one JSON array of objects"}, {0}};
enum { JSON };

static const char *const csv_row = "%s%d,%d,%.6f,%.6f,%.6f\n";
static const char *const json_row = "%s  {\"m\": %d, \"n\": %d, \"frequency_hz\": %.6f, "
                                    "\"ratio\": %.6f, \"t60_s\": %.6f}";

static int run(const cli_arguments *arguments)
{
    himc_error error;
    bool json = arguments->value[JSON];
    const char *path = arguments->operand ? cli_input(arguments->operand, &error) : NULL;
    himc_drum *drum = path || !arguments->operand ? open_drum(path, &error) : NULL;
    if (!drum)
        return cli_fail(&cli_modes, "%s", error.text);
    const himc_membrane *membrane = himc_drum_membrane(drum);
    const himc_head *head = himc_membrane_head(membrane);
    double reference = himc_membrane_principal(membrane, head), frequency = 0;
    const char *before = json ? "[\n" : "";
    if (!json)
        printf("m,n,frequency_hz,ratio,t60_s\n");
    for (int i = 0; himc_membrane_mode(membrane, i).mass > 0; i++) {
        himc_mode mode = himc_membrane_mode(membrane, i);
        bool repeated = mode.sine && mode.frequency == frequency;
        frequency = mode.frequency;
        if (mode.m < 0 || repeated) // statistical ones
            continue;
        printf(json ? json_row : csv_row, before, mode.m, mode.n, mode.frequency,
               mode.frequency / reference, log(1000) / mode.decay);
        before = json ? ",\n" : "";
    }
    if (json)
        printf("\n]\n");
    himc_drum_release(drum);
    return cli_finish(&cli_modes);
}

const cli_call cli_modes = {
    "modes",
    "[SCORE]",
    "",
    "lists the modes of a drum: m,n,frequency_hz,ratio,t60_s",
    "The drum is the first that SCORE makes, tuned as its lines say; without SCORE the default\n"
    "one of 26 inches. One row for each pair of nodal diameters m and circles n, or two where an\n"
    "uneven head splits it; the ratio is to the principal mode (1,1).",
    options,
    run,
};
