/// fit_list.h: an instrument as a list of modes, made of partials.
#ifndef FIT_LIST_H
#define FIT_LIST_H

#include "cli.h"
#include "partials.h"

#define FIT_LIST_HIGHEST 12000.0 ///< (Hz)

typedef struct himc_drum himc_drum;

/// Writes the list (head/list.c says what its lines mean) whose partials are as strong as found;
/// the file is not kept yet.
bool fit_list(const partials_sound *sound, const partials_list *found, const char *path,
              cli_file *file, himc_error *error);
/// The instrument of the list in that file; owned.
himc_drum *fit_list_drum(const cli_file *file, double rate, himc_error *error);

#endif
