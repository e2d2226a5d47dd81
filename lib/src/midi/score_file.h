/// score_file.h: a score from a file of commands or of MIDI; private.
#ifndef HIMC_MIDI_SCORE_FILE_H
#define HIMC_MIDI_SCORE_FILE_H

#include "himc/score.h"

#define HIMC_MIDI_BYTES_MAX \
    ((size_t)4 << 20) ///< of a MIDI file; chosen: a hundred times a long piece

/// As himc_score_load; with a `folder` (not NULL) only a file inside it (himc_file_load_in).
himc_score *himc_score_load_in(const char *folder, const char *path, himc_error *error);

#endif
