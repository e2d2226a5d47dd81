/// fit_list.h: an instrument as a list of modes, made of partials.
#ifndef FIT_LIST_H
#define FIT_LIST_H

#include "partials.h"

#define FIT_LIST_HIGHEST 12000.0 ///< (Hz)

typedef struct himc_drum himc_drum;

/// Writes the list (head/list.c says what its lines mean) whose partials are as strong as found.
bool fit_list(const partials_sound *sound, const partials_list *found, const char *path,
              himc_error *error);
/// The instrument of that list; owned.
himc_drum *fit_list_drum(const char *path, double rate, himc_error *error);

#endif
