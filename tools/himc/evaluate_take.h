/// evaluate_take.h: `himc evaluate --take`: the comparison of the controllers on one's own
/// captures.
#ifndef EVALUATE_TAKE_H
#define EVALUATE_TAKE_H

#include "cli.h"

/// Plays each of `count` takes under `ik` and each law of `id` and `himc`, on `jobs` cores, and
/// prints a row for each; `figure` (or NULL) gets the errors as bars, in SVG. `options` has the
/// tips' names: alternatives, separated by commas, for takes that name them differently. False with
/// the reason.
bool evaluate_takes(const char *const *path, int count, const himc_take_options *options, int jobs,
                    bool json, FILE *stream, FILE *figure, himc_error *error);

#endif
