/// ornament.h: rolls, flams, drags and ruffs as the strokes they are made of.
#ifndef HIMC_ORNAMENT_H
#define HIMC_ORNAMENT_H

#include "plan/planner.h"

/// Adds the strokes that an ornament has besides its stroke: grace notes, or all of a roll; `pitch`
/// (Hz) is the drum's. A stroke too near to another of its hand is left out. Returns how many.
int himc_planner_add_ornament(himc_planner *planner, const himc_stroke *stroke, int drum,
                              double pitch);

#endif
