/// scene.h: writes a scene, the recording of a performance in one file: events, rows of motion,
/// shapes of drumheads, sound (docs/scene.md).
#ifndef SCENE_H
#define SCENE_H

#include "himc/base.h"

#include <stdio.h>

#define SCENE_VERSION 1 ///< a reader refuses a later one

/// A column of the rows: its name ends with its unit, as in motion.csv, and its values are stored
/// as multiples of `step`.
typedef struct scene_column {
    char name[48];
    double step;
} scene_column;

/// A scene under way. Opaque.
typedef struct scene_writer scene_writer;

/// What a scene is made of; all borrowed until scene_close.
typedef struct scene_config {
    FILE *stream;     ///< binary
    const char *name; ///< of what plays, in letters and digits
    const scene_column *column;
    int columns;
    int rate, channels; ///< of the sound (Hz; 0 channels: none, 1 or 2)
    bool live;          ///< packed little by little and quickly, for a caller who keeps time
    bool bare;          ///< only the chunks after the file's first eight bytes
} scene_config;

/// Begins a scene. NULL with the reason.
scene_writer *scene_open(const scene_config *config, himc_error *error);
/// Writes what waits, but no sound, for a reader that takes the chunks while they are made.
void scene_flush(scene_writer *scene);
/// Adds an event: a JSON object without its braces (printf format). Call scene_text for what came
/// from elsewhere.
void scene_event(scene_writer *scene, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/// Copies a text as it stands between the quotes of a JSON string; cut to `size` bytes. Returns
/// `out`.
char *scene_text(char *out, size_t size, const char *text);
/// Adds a row: the value of each column at `time` (s), later than the last.
void scene_row(scene_writer *scene, double time, const double *value);
#define SCENE_MODES 64 ///< of a head, as many as the viewer draws
/// How a head's first `modes` (1 .. SCENE_MODES) modes move.
typedef struct scene_ring {
    int modes;
    double q[SCENE_MODES]; ///< displacement (m)
    double s[SCENE_MODES]; ///< velocity over angular frequency (m)
} scene_ring;

/// Adds the motion of a head at `time` (s); `drum` is the number that its event "drum" gives.
void scene_head(scene_writer *scene, int drum, double time, const scene_ring *ring);
/// Adds a whole scene without sound, from the beginning of `stream`: the same piece played by
/// others.
void scene_more(scene_writer *scene, FILE *stream);
/// Adds `n` (1 .. 8192) frames of sound, channels interleaved.
void scene_sound(scene_writer *scene, const float *frames, int n);
/// Writes what waits and frees the writer. False with the reason if anything could not be written.
bool scene_close(scene_writer *scene, himc_error *error);

#endif
