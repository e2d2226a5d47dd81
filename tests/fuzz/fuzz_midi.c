/// fuzz_midi.c: MIDI files from arbitrary bytes. What is accepted becomes a score that is read
/// without an error, and each note is a stroke or counted in the report.
#include "fuzz.h"
#include "midi/import.h"
#include "midi/smf.h"
#include "plan/score.h"

const long fuzz_runs = 1500;

static int count_rolls(const himc_score *score)
{
    int rolls = 0;
    for (int i = 0; i < score->stroke_count; i++)
        rolls += score->strokes[i].ornament >= HIMC_ROLL_SINGLE;
    return rolls;
}

static void check_report(const char *report, const himc_score *score)
{
    int played = 0, notes = 0, missing = 0, rolled = 0, rolls = 0, count;
    require(sscanf(report, "%d of %d notes", &played, &notes) == 2, "a report begins with counts");
    for (const char *line = report, *end; (end = strchr(line, '\n')); line = end + 1) {
        char text[256];
        snprintf(text, sizeof text, "%.*s", (int)(end - line), line);
        require(himc_line_is_clean(text), "a report has clean lines");
        bool note = !strstr(text, "tremolo"); // else one of the strokes of a note that has others
        if (note && (strstr(text, "not played") || strstr(text, "one stroke")) &&
            sscanf(text, "%d", &count) == 1)
            missing += count;
        const char *as = strstr(text, "played as ");
        if (as)
            require(sscanf(text, "%d", &rolled) == 1 && sscanf(as, "played as %d", &rolls) == 1,
                    "rolls are counted");
    }
    require(rolls == count_rolls(score), "rolls are as many as the report says");
    require(played == score->stroke_count - rolls + rolled, "and strokes");
    require(played + missing == notes, "each note is played or has a reason");
}

static void check_file(const uint8_t *data, size_t size)
{
    himc_error error = {""};
    midi_file file;
    if (!himc_midi_file_read(&file, data, size, &error))
        return;
    for (int i = 0; i < file.note_count; i++) {
        const midi_note *note = &file.notes[i];
        require(note->channel < 16 && note->key < 128 && note->velocity > 0 && note->velocity < 128,
                "a note is in range");
        require(note->seconds >= 0 && note->off >= note->seconds && note->beat >= 0,
                "a note ends after it has begun");
        require(i == 0 || note->seconds >= file.notes[i - 1].seconds, "notes are sorted");
    }
    himc_midi_file_free(&file);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    himc_error error = {""};
    midi_score made;
    check_file(data, size);
    if (!himc_midi_import(&made, data, size, "fuzz.mid", NULL, &error)) {
        require_line(&error);
        return 0;
    }
    himc_score *score = himc_score_parse(made.text, "made.txt", NULL, &error);
    require(score != NULL, error.text);
    check_report(made.report, score);
    himc_score_free(score);
    himc_midi_score_free(&made);
    return 0;
}
