/// scene.h: what the viewer has heard: performers, drums, and events that happened.
///
/// Performers and drums are latest values: who reads slowly sees the newest pose, never a backlog.
/// Events (strikes, beats, counters) are a ring in which each reader has its own place. All of it
/// is of fixed size, in one thread.
#ifndef VIEWER_SCENE_H
#define VIEWER_SCENE_H

#include "skeleton.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    SCENE_SEGMENTS = SKELETON_SEGMENTS,
    SCENE_HANDS = 2,
    SCENE_PERFORMERS = 16,
    SCENE_DRUMS = 32,
    SCENE_MODES = 64,   ///< modal amplitudes kept of a drum
    SCENE_EVENTS = 256, ///< kept for readers that lag
    SCENE_TEXT = 1400,  ///< longest event (bytes)
    SCENE_KEY = 80,     ///< longest sender with its zero: "ADDRESS:PORT" or "ADDRESS:PORT/NAME"
    SCENE_NAME = 32     ///< longest drum's name with its zero
};

/// A body in the world.
typedef struct scene_performer {
    char key[SCENE_KEY];           ///< who sends it; empty if the place is free
    uint64_t version;              ///< grows when a whole pose is there
    double heard;                  ///< when last (s, wall clock)
    double begun;                  ///< when the first piece of the pending pose came (s)
    uint32_t known, pending;       ///< segments ever heard; heard since the last whole pose
    uint32_t targets;              ///< hands whose target is known
    float body[SCENE_SEGMENTS][7]; ///< x y z (m) qw qx qy qz
    float target[SCENE_HANDS][3];  ///< (m)
} scene_performer;

typedef struct scene_drum {
    char key[SCENE_KEY], name[SCENE_NAME];
    uint64_t version;
    double heard;                 ///< (s, wall clock)
    bool placed;                  ///< whether `place` was heard
    float place[5];               ///< centre x y z (m), tilt (rad), radius (m)
    uint32_t modes;               ///< how many amplitudes
    float amplitude[SCENE_MODES]; ///< (m)
} scene_drum;

typedef struct scene_event {
    double time; ///< (s, wall clock)
    char text[SCENE_TEXT];
} scene_event;

/// What came in, since the start.
typedef struct scene_counts {
    uint64_t packets, messages, bytes;
    uint64_t malformed; ///< not OSC, or an atom of the wrong kind, not finite, out of range
    uint64_t unknown;   ///< an address that the viewer does not know
    uint64_t refused;   ///< a performer or drum too many
} scene_counts;

typedef struct scene {
    scene_performer performer[SCENE_PERFORMERS];
    scene_drum drum[SCENE_DRUMS];
    scene_event event[SCENE_EVENTS];
    uint64_t events; ///< ever; the newest is event[(events - 1) % SCENE_EVENTS]
    scene_counts count;
} scene;

/// Seconds of silence after which a performer or drum has left, and its place may be given to
/// another.
#define SCENE_SILENCE 3.0

/// The performer of that sender, new if need be; NULL if all places are taken (counted).
scene_performer *scene_find_performer(scene *s, const char *key, double now);
/// The drum of that name and sender, the same way.
scene_drum *scene_find_drum(scene *s, const char *key, const char *name, double now);

/// Takes in one segment of a pose.
void scene_set_body(scene_performer *p, int segment, const float body[7], double now);
/// Declares poses whole: those with all segments, and those whose first piece is older than 5 ms (a
/// bundle may be split, and a packet lost). True if one is.
bool scene_settle(scene *s, double now);
/// True while a pose is in pieces.
bool scene_unsettled(const scene *s);

/// Adds an event, a JSON object (printf format).
void scene_say(scene *s, double now, const char *format, ...) __attribute__((format(printf, 3, 4)));

/// What one reader has seen already.
typedef struct scene_reader {
    uint64_t performer[SCENE_PERFORMERS], drum[SCENE_DRUMS], events;
} scene_reader;

/// A reader that has seen no event but those to come.
scene_reader scene_reader_new(const scene *s);
/// Largest result of scene_encode (bytes).
#define SCENE_FRAME_MAX 65536
/// Writes what the reader has not seen into `frame` (SCENE_FRAME_MAX) and returns its bytes, 0 if
/// nothing is new. What does not fit comes with the next call. The layout is in scene_encode.c; the
/// page reads it in stream.js.
size_t scene_encode(const scene *s, scene_reader *reader, double now, uint8_t *frame);

#endif
