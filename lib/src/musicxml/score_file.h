/// score_file.h: a score from a file of commands, MIDI or MusicXML, for performance_score.c
/// and the program.
#ifndef HIMC_MUSICXML_SCORE_FILE_H
#define HIMC_MUSICXML_SCORE_FILE_H

#include "himc/score.h"

/// As himc_score_load; with a `folder` (not NULL) only a file inside it (himc_file_load_in).
himc_score *himc_score_load_in(const char *folder, const char *path, himc_error *error);

/// False with one line if the bytes of a file that is no MIDI file are no score either: of another
/// kind, or with a zero, behind which nothing would be read.
bool himc_score_is_text(const char *bytes, size_t size, const char *name, himc_error *error);

#endif
