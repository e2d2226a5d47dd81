/// fuzz_musicxml.c: MusicXML, plain and compressed, from any bytes. What is accepted becomes a
/// score that is read without an error; what is not is refused in one line.
#include "fuzz.h"
#include "musicxml/import.h"
#include "plan/score.h"

const long fuzz_runs = 1500;

static void check_report(const char *report)
{
    int played = 0, notes = 0;
    require(sscanf(report, "%d of %d notes", &played, &notes) == 2, "a report begins with counts");
    require(played > 0 && played <= notes, "no more notes are played than there are");
    for (const char *line = report, *end; (end = strchr(line, '\n')); line = end + 1) {
        char text[256];
        snprintf(text, sizeof text, "%.*s", (int)(end - line), line);
        require(himc_line_is_clean(text), "a report has clean lines");
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    himc_error error = {""};
    midi_score made;
    const midi_options options = {.all = size & 1};
    if (!himc_music_import(&made, data, size, "fuzz.mxl", &options, &error)) {
        require_line(&error);
        require(!made.text && !made.report, "nothing is made of a refused file");
        return 0;
    }
    himc_score *score = himc_score_parse(made.text, "made.txt", NULL, &error);
    require(score != NULL, error.text);
    check_report(made.report);
    himc_score_free(score);
    himc_midi_score_free(&made);
    return 0;
}
