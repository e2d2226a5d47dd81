/// import.h: a score made of a MusicXML file, plain or compressed.
#ifndef HIMC_MUSICXML_IMPORT_H
#define HIMC_MUSICXML_IMPORT_H

#include "midi/import.h"

/// True of a document of XML, or an archive.
bool himc_music_is_file(const void *bytes, size_t size);

/// As himc_midi_import.
bool himc_music_import(midi_score *made, const void *bytes, size_t size, const char *name,
                       const midi_options *options, himc_error *error);

/// The one that reads the file, of those that make a score; NULL: it is none of theirs.
typedef bool himc_score_maker(midi_score *made, const void *bytes, size_t size, const char *name,
                              const midi_options *options, himc_error *error);
himc_score_maker *himc_score_maker_of(const void *bytes, size_t size);

#endif
