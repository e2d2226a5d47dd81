/// scene.h: everything the viewer has received: performers, drums and events.
///
/// Of performers and drums only the latest values are kept: a slow reader gets the newest pose and
/// no backlog. Events (strikes, beats, counters) are a ring, and each reader has its own position
/// in it. All of it has a fixed size and is used by one thread.
#ifndef VIEWER_SCENE_H
#define VIEWER_SCENE_H

#include "skeleton.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    SCENE_SEGMENTS = SKELETON_SEGMENTS,
    SCENE_HANDS = 2,
    SCENE_SUPPORT = 12, ///< forces of seat, left and right foot (N), centre of pressure (m)
    SCENE_PERFORMERS = 16,
    SCENE_DRUMS = 32,
    SCENE_MODES = 64,    ///< modal amplitudes kept of a drum; chosen: as many as the page draws
    SCENE_SOUNDS = 128,  ///< packets kept for slow readers; chosen: 0.6 s of one performer
    SCENE_SAMPLES = 512, ///< most of a packet, of both channels
    SCENE_EVENTS = 256,  ///< kept for slow readers; chosen: 2 s of eight rolls
    SCENE_TEXT = 1400,   ///< longest event (bytes)
    SCENE_KEY = 80,      ///< longest sender with its zero: "ADDRESS:PORT" or "ADDRESS:PORT/NAME"
    SCENE_NAME = 32      ///< longest drum's name with its zero
};

/// Two times of a message (s, wall clock): here, and the sender's in the time tag of its bundle.
/// Without a tag the second is the first.
typedef struct scene_time {
    double now, told;
} scene_time;

/// A body in the world.
typedef struct scene_performer {
    char key[SCENE_KEY];           ///< the sender; empty if the place is free
    uint64_t version;              ///< grows with each complete pose
    double received;               ///< time of the last message (s, wall clock)
    double told;                   ///< the sender's time of the pose (s)
    double begun;                  ///< time of the first part of the pending pose (s)
    uint32_t known, pending;       ///< segments received ever; since the last complete pose (bits)
    uint32_t targets;              ///< hands with a known target (bits)
    float body[SCENE_SEGMENTS][7]; ///< x y z (m) qw qx qy qz
    float target[SCENE_HANDS][3];  ///< (m)
    float support[SCENE_SUPPORT];  ///< of the last complete pose; 0 of one that is not free
    float heard[SCENE_SUPPORT];    ///< that of the pending pose
} scene_performer;

typedef struct scene_drum {
    char key[SCENE_KEY], name[SCENE_NAME];
    uint64_t version;
    double received;              ///< time of the last message (s, wall clock)
    double told;                  ///< the sender's time of the amplitudes (s)
    bool placed;                  ///< `place` has been received
    float place[7];               ///< centre x y z (m), tilt (rad), radius, length, width (m)
    uint32_t modes;               ///< number of amplitudes
    float amplitude[SCENE_MODES]; ///< (m)
} scene_drum;

typedef struct scene_event {
    double time; ///< (s, wall clock)
    char text[SCENE_TEXT];
} scene_event;

/// A packet of sound.
typedef struct scene_sound {
    double told; ///< the sender's time of the first sample (s)
    char key[SCENE_KEY];
    uint32_t first, rate, channels, count; ///< sample; (Hz); of samples in all channels
    int16_t sample[SCENE_SAMPLES];
} scene_sound;

/// Counters since the start.
typedef struct scene_counts {
    uint64_t packets, messages, bytes;
    uint64_t malformed; ///< not OSC, or an atom of the wrong type, not finite or out of range
    uint64_t unknown;   ///< address not in the table
    uint64_t refused;   ///< messages of a performer or drum for which there is no place
} scene_counts;

typedef struct scene {
    scene_performer performer[SCENE_PERFORMERS];
    scene_drum drum[SCENE_DRUMS];
    scene_event event[SCENE_EVENTS];
    uint64_t events; ///< ever; the newest is event[(events - 1) % SCENE_EVENTS]
    scene_sound sound[SCENE_SOUNDS];
    uint64_t sounds; ///< ever; the newest is sound[(sounds - 1) % SCENE_SOUNDS]
    scene_counts count;
} scene;

/// A performer or drum that is silent for so long may lose its place (s). Chosen: longer than the
/// page shows a silent one.
#define SCENE_SILENCE 3.0

/// The performer of that sender, created if there is none; NULL if all places are taken (counted).
scene_performer *scene_find_performer(scene *s, const char *key, double now);
/// The drum of that name and sender, the same way.
scene_drum *scene_find_drum(scene *s, const char *key, const char *name, double now);

/// Stores one segment of a pose.
void scene_set_body(scene_performer *p, int segment, const float body[7], scene_time time);
/// Stores what carries the pending pose.
void scene_set_support(scene_performer *p, const float support[SCENE_SUPPORT]);
/// Marks poses as complete: those with all segments, and those begun more than 5 ms ago (a bundle
/// may be split, and a packet lost). True if there is one.
bool scene_complete_poses(scene *s, double now);
/// True while a pose is incomplete.
bool scene_pose_pending(const scene *s);

/// Copies a word for JSON, cut to `size` (bytes): '?' replaces what is not UTF-8, and characters
/// that JSON would have to escape.
void scene_word(char *out, size_t size, const char *from);
/// Adds an event, a JSON object (printf format).
void scene_add_event(scene *s, double now, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/// Everything one reader has seen: versions of performers and drums, number of events.
typedef struct scene_reader {
    uint64_t performer[SCENE_PERFORMERS], drum[SCENE_DRUMS], events, sounds;
} scene_reader;

/// A reader that gets only the events from now on.
scene_reader scene_reader_new(const scene *s);
/// Largest result of scene_encode (bytes).
#define SCENE_FRAME_MAX 65536
/// Writes the news for the reader into `frame` (SCENE_FRAME_MAX bytes) and returns its length, 0 if
/// there is none. Events that do not fit are left for the next call. The layout is in
/// scene_encode.c; the page reads it in stream.js.
size_t scene_encode(const scene *s, scene_reader *reader, double now, uint8_t *frame);

#endif
