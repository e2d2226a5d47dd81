/// research.h: functions that the papers' trials and editing need beside the commands; for the
/// tools of this repository, not installed.
#ifndef HIMC_RESEARCH_H
#define HIMC_RESEARCH_H

#include "control/posture_regression.h"
#include "himc/performance.h"

/// Sets the null-space target of mode `himc` to a posture regression (copied); NULL restores the
/// natural posture. The regression's player should be the performer's body.
HIMC_RT void himc_performance_set_posture_regression(himc_performance *performance,
                                                     const himc_posture_regression *regression);

/// Gives the simulated segments `factor` (HIMC_SEGMENTS, 0.2 .. 5; NULL for 1) times the
/// mass and inertia that the controller assumes: the effect of an uncertain body on control. The
/// body is rebuilt at the pose of the targets. False with the reason if a factor is out of range
/// or memory is short.
bool himc_performance_set_weights(himc_performance *performance, const double *factor,
                                  himc_error *error);

/// The body that is simulated, on its stool; borrowed, until the next command.
const himc_skeleton *himc_performance_plant(const himc_performance *performance);

/// Loads a score from its text, like the command `score`; `name` begins errors.
bool himc_performance_load_text(himc_performance *performance, const char *text, const char *name,
                                himc_error *error);

/// The same for a performance that will not play (himc_performance_exchange_strokes), without its
/// listener and its changes of heads at beats.
bool himc_performance_load_unheard(himc_performance *performance, const char *text,
                                   const char *name, himc_error *error);

/// While a score or its take plays: takes the strokes, or the nudges, and the pushes of `other` in
/// place of its own, as if they had been there from the start. `other` has loaded a score that is
/// the same in all other lines, and has not played; it is to be freed. False, and nothing changed,
/// if what has been played, or is being prepared, may rest on a stroke that differs.
bool himc_performance_exchange_strokes(himc_performance *performance, himc_performance *other);
/// A hand's strokes before this time (s of the score, or of its take) can no longer be exchanged;
/// one that gets another beat or place, or a push, may be refused after it, too.
double himc_performance_rests_to(const himc_performance *performance, himc_hand hand);

#endif
