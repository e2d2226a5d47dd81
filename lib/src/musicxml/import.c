/// import.c: MusicXML from bytes to a score; which reader a file is for.
#include "musicxml/import.h"

#include "musicxml/music.h"
#include "musicxml/mxl.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool himc_music_is_file(const void *bytes, size_t size)
{
    static const struct {
        const char *bytes;
        size_t size;
    } begins[] = {{"<", 1}, {"\xEF\xBB\xBF<", 4}, {"\xFF\xFE<\0", 4}, {"\xFE\xFF\0<", 4}};
    const char *at = bytes;
    size_t space = 0;
    while (space < size && space < 64 && strchr(" \t\r\n", at[space]) && at[space])
        space++;
    for (size_t i = 0; i < sizeof begins / sizeof *begins; i++)
        if (size - space >= begins[i].size &&
            memcmp(at + space, begins[i].bytes, begins[i].size) == 0)
            return true;
    return himc_mxl_is_file(bytes, size);
}

// what the reader leaves out, as lines of the report
static bool tell(const music *m, midi_file *file, himc_error *error)
{
    himc_text_lines said = {0};
    bool good = himc_text_reserve(&said, 1);
    for (int i = 0; i < MUSIC_OMISSIONS; i++) {
        const music_omission *o = &m->omitted[i];
        if (o->count > 0)
            himc_text_print(&said, "%d %s (bar%s %s)\n", o->count, o->count == 1 ? o->one : o->many,
                            strchr(o->bars, ' ') ? "s" : "", o->bars);
    }
    if (m->unknown[0])
        himc_text_print(&said, "no such instrument here: %s\n", m->unknown);
    file->said = said.bytes;
    file->omitted = m->omitted[MUSIC_BAD_NOTES].count + m->omitted[MUSIC_GRACES].count;
    return (good && !said.failed) || himc_error_set(error, "out of memory for the report");
}

static bool read_file(midi_file *file, const void *bytes, size_t size, himc_error *error)
{
    music m;
    if (size > MUSIC_BYTES_MAX)
        return himc_error_set(error, "too long, expected %zu MiB of MusicXML",
                              MUSIC_BYTES_MAX >> 20);
    if (!himc_music_read(&m, bytes, size, error))
        return false;
    bool good = himc_music_order(&m, file, error) && himc_music_swing(&m, file, error) &&
                himc_music_tempo(&m, file, error) && himc_music_shape(&m, file, error) &&
                tell(&m, file, error);
    if (good && m.note_count == 0)
        good = himc_error_set(error,
                              "nothing to play: %d bar%s without a note of timpani, drums, "
                              "cymbals or keyboard percussion",
                              m.bar_count, m.bar_count == 1 ? "" : "s");
    himc_music_free(&m);
    return good;
}

bool himc_music_import(midi_score *made, const void *bytes, size_t size, const char *name,
                       const midi_options *options, himc_error *error)
{
    midi_file file = {0};
    char *unpacked = NULL;
    *made = (midi_score){0};
    if (himc_mxl_is_file(bytes, size)) {
        unpacked = himc_mxl_score(bytes, size, MUSIC_BYTES_MAX, &size, error);
        if (!unpacked)
            return false;
    }
    bool good = read_file(&file, unpacked ? unpacked : bytes, size, error);
    free(unpacked);
    if (!good)
        himc_midi_file_free(&file);
    return good && himc_midi_make(made, &file, name, options, error);
}

himc_score_maker *himc_score_maker_of(const void *bytes, size_t size)
{
    return himc_midi_is_file(bytes, size)    ? himc_midi_import
           : himc_music_is_file(bytes, size) ? himc_music_import
                                             : NULL;
}
