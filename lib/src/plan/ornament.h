/// ornament.h: rolls, flams, drags and ruffs as the strokes they are made of.
#ifndef HIMC_ORNAMENT_H
#define HIMC_ORNAMENT_H

#include "plan/planner.h"

/// True if a roll has no more strokes than are allowed; else the reason. `pitch` (Hz) is the drum's.
bool himc_planner_accepts_roll(const himc_planner *planner, const himc_stroke *roll, double pitch,
                               himc_error *error);

/// Adds the strokes that an ornament has besides its stroke: grace notes, or all of a roll; `pitch`
/// (Hz) is the drum's. A stroke too near to another of its hand is left out. Returns how many; -1
/// with the reason if the roll is too long.
int himc_planner_add_ornament(himc_planner *planner, const himc_stroke *stroke, int drum,
                              double pitch, himc_error *error);

#endif
