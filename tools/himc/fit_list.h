/// fit_list.h: an instrument as a list of modes, made of partials.
#ifndef FIT_LIST_H
#define FIT_LIST_H

#include "cli.h"
#include "partials.h"

#define FIT_LIST_HIGHEST 12000.0 ///< (Hz)
#define FIT_LIST_STRONG 6.0 ///< (dB) below the strongest a partial is made and told, certain or not
#define FIT_LIST_RADIUS 0.1 ///< (m) of the struck disc, if not known; chosen

/// Writes the list (head/list.c says what its lines mean) whose partials are as strong as found;
/// the file is not kept yet. `tune` (Hz; 0: not known) is what the drum is tuned to and becomes the
/// list's pitch; levels in `found` that the spectrum does not show are lowered. `made` gets the
/// partials that the usual listener hears, without a room, of a stroke mf on it.
bool fit_list(const partials_sound *sound, partials_list *found, double radius, double *tune,
              const char *path, cli_file *file, partials_list *made, himc_error *error);

#endif
