/// score_file.c: a score from a file: a text of commands, or a MIDI file, told by its first bytes.
#include "base/file.h"
#include "midi/import.h"
#include "midi/score_file.h"
#include "midi/smf.h"
#include "plan/score.h"

#include <stdlib.h>
#include <string.h>

#define SCORE_BYTES_MAX ((size_t)64 << 20)

static himc_score *import(const char *bytes, size_t size, const char *path, himc_error *error)
{
    midi_score made;
    if (size > HIMC_MIDI_BYTES_MAX) {
        himc_error_set(error, "%s: too long, allowed %zu MiB of MIDI", path,
                       HIMC_MIDI_BYTES_MAX >> 20);
        return NULL;
    }
    if (!himc_midi_import(&made, bytes, size, path, NULL, error)) {
        himc_error_prefix(error, "%s", path);
        return NULL;
    }
    himc_score *score = himc_score_parse(made.text, path, error);
    if (score) {
        score->report = made.report;
        score->left_out = made.left_out;
        made.report = NULL;
    }
    himc_midi_score_free(&made);
    return score;
}

himc_score *himc_score_load_in(const char *folder, const char *path, himc_error *error)
{
    size_t size;
    himc_score *score = NULL;
    char *bytes = himc_file_load_in(folder, path, SCORE_BYTES_MAX, &size, error);
    if (bytes && himc_midi_is_file(bytes, size))
        score = import(bytes, size, path, error);
    else if (bytes && memchr(bytes, 0, size))
        himc_error_set(error, "%s: not a text file, and no MIDI file", path);
    else if (bytes)
        score = himc_score_parse(bytes, path, error);
    free(bytes);
    return score;
}

himc_score *himc_score_load(const char *path, himc_error *error)
{
    return himc_score_load_in(NULL, path, error);
}
