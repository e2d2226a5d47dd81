/// scene_record.h: records what a performance does as a scene.
#ifndef SCENE_RECORD_H
#define SCENE_RECORD_H

#include "himc/performance.h"

#include <stdio.h>

/// A recording under way. Opaque.
typedef struct scene_record scene_record;

/// What is recorded, and where to; all borrowed.
typedef struct scene_record_config {
    himc_performance *performance;
    FILE *stream;       ///< binary
    const char *source; ///< what it plays, for the reader
    const char *name;   ///< who plays it: "himc"
    int rate, channels; ///< of the sound (Hz; 0 channels: none, 1 or 2)
    bool live;          ///< packed quickly (scene.h)
    bool bare;          ///< only chunks, for a reader that takes them while they are made
    bool captured;      ///< also the take's own joints, if one plays that has any
} scene_record_config;

/// Begins to record. NULL with the reason.
scene_record *scene_record_begin(const scene_record_config *config, himc_error *error);
/// Writes what waits, but no sound.
void scene_record_flush(scene_record *record);
/// For himc_performance_on_tick, which the caller sets; `record` is a scene_record.
void scene_record_tick(void *record, const himc_tick *tick);
/// For himc_performance_on_motion; `record` is a scene_record.
void scene_record_row(void *record, const himc_motion_row *row);
/// An event that was taken from the performance.
void scene_record_event(scene_record *record, const himc_event *event);
/// After each block, with its `n` (1 .. 8192) frames of sound (NULL: none).
void scene_record_block(scene_record *record, const float *frames, int n);
/// Adds a finished scene without sound, from the beginning of `stream`: the same played by others.
void scene_record_more(scene_record *record, FILE *stream);
/// Writes the rest, and frees it. False with the reason. NULL is allowed.
bool scene_record_end(scene_record *record, himc_error *error);

#endif
