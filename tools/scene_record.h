/// scene_record.h: records what a performance does as a scene.
#ifndef SCENE_RECORD_H
#define SCENE_RECORD_H

#include "himc/performance.h"

#include <stdio.h>

/// A recording under way. Opaque.
typedef struct scene_record scene_record;

/// Begins to record into `stream` (binary, borrowed), with sound of `rate` (Hz) and 1 or 2
/// `channels`. Takes the performance's on_tick; `source` is what it plays, for the reader. NULL with
/// the reason.
scene_record *scene_record_begin(himc_performance *performance, FILE *stream, const char *source,
                                 int rate, int channels, himc_error *error);
/// For himc_performance_on_motion; `record` is a scene_record.
void scene_record_row(void *record, const himc_motion_row *row);
/// An event that was taken from the performance.
void scene_record_event(scene_record *record, const himc_event *event);
/// After each block, with its `n` (1 .. 8192) frames of sound.
void scene_record_block(scene_record *record, const float *frames, int n);
/// Writes the rest, and frees it. False with the reason. NULL is allowed.
bool scene_record_end(scene_record *record, himc_error *error);

#endif
