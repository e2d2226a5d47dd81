/// planner_part.h: the list of a hand's strokes: where a beat is in it.
#ifndef HIMC_PLANNER_PART_H
#define HIMC_PLANNER_PART_H

#include "plan/planner_score.h"

/// The first stroke after `beat`, or with `from` the first at it or after it.
HIMC_RT int himc_planner_part_after(const planner_part *part, double beat, bool from);
/// Where a stroke comes in its hand's list: grace notes before the stroke on their beat.
HIMC_RT int himc_planner_part_place(const planner_part *part, const himc_stroke *stroke);

#endif
