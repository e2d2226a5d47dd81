/// setups.h: the set-ups that the library has.
#ifndef HIMC_SETUPS_H
#define HIMC_SETUPS_H

#include <stdbool.h>

/// A set-up: lines of a score that make instruments and put them at their places.
typedef struct himc_setup {
    const char *name, *text;
} himc_setup;

/// In the order of HIMC_SETUPS (himc/command_rows.h).
extern const himc_setup himc_setups[];
/// A seated player's kit, also for General MIDI, what stands around it for the rest of that, and
/// tubular bells.
extern const char himc_setup_kit[], himc_setup_around[], himc_setup_bells[];

/// Where an instrument stands (m; its tilt, rad), and `made`, the words of `instrument` after its
/// name, borrowed; false if the text does not make it.
bool himc_setup_find(const char *text, const char *name, const char **made, int *length,
                     double place[4]);

#endif
