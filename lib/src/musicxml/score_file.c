/// score_file.c: a score from a file of commands, MIDI or MusicXML, told by its first bytes.
#include "base/file.h"
#include "capture/take.h"
#include "musicxml/import.h"
#include "musicxml/score_file.h"
#include "plan/score.h"

#include <stdlib.h>
#include <string.h>

bool himc_score_is_text(const char *bytes, size_t size, const char *name, himc_error *error)
{
    static const struct {
        const char *begin, *is;
    } known[] = {{"Kaydara FBX", "an FBX: import it into Blender and export .bvh"},
                 {":ASF", "an Acclaim skeleton: convert it with its .amc to .bvh"},
                 {"RIFF", "a sound or a film"},
                 {"fLaC", "a sound"},
                 {"OggS", "a sound"},
                 {"ID3", "a sound"},
                 {"%PDF", "a PDF"},
                 {"{", "JSON"},
                 {"version https://git-lfs", "a pointer to Git's large files: run git lfs pull"}};
    const char *kind = NULL, *suffix = himc_take_suffix_of(bytes, size);
    if (suffix)
        return himc_error_set(error,
                              "%s: a take: its name must end with %s; expected a score, MIDI, "
                              "MusicXML or a take",
                              name, suffix);
    for (size_t i = 0; i < sizeof known / sizeof known[0] && !kind; i++)
        if (size >= strlen(known[i].begin) &&
            !memcmp(bytes, known[i].begin, strlen(known[i].begin)))
            kind = known[i].is;
    if (!kind && memchr(bytes, 0, size))
        kind = "not a text file";
    return !kind ||
           himc_error_set(error, "%s: %s; expected a score, MIDI, MusicXML or a take", name, kind);
}

himc_score *himc_score_load_in(const char *folder, const char *path, himc_error *error)
{
    const size_t most = (size_t)64 << 20; // (bytes) as himc/score.h says
    midi_score made = {0};
    size_t size;
    himc_score *score = NULL;
    if (himc_take_is_capture(path)) {
        himc_error_set(error,
                       "%s: a take by its suffix, expected a score, MIDI or MusicXML; a take "
                       "is loaded by take",
                       path);
        return NULL;
    }
    char *bytes = himc_file_load_in(folder, path, most, &size, error);
    himc_score_maker *make = bytes ? himc_score_maker_of(bytes, size) : NULL;
    if (bytes && !make) {
        if (himc_score_is_text(bytes, size, path, error))
            score = himc_score_parse(bytes, path, folder, error);
    } else if (bytes && !make(&made, bytes, size, path, NULL, error)) {
        himc_error_prefix(error, "%s", path);
    } else if (bytes) {
        score = himc_score_parse(made.text, path, folder, error);
    }
    if (score && made.text) {
        free(score->report);
        score->report = made.report;
        score->left_out = made.left_out;
        made.report = NULL;
    }
    himc_midi_score_free(&made);
    free(bytes);
    return score;
}

himc_score *himc_score_load(const char *path, himc_error *error)
{
    return himc_score_load_in(NULL, path, error);
}
