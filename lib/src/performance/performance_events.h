/// performance_events.h: the reports of a performance to its host: a bounded queue of events.
#ifndef HIMC_PERFORMANCE_EVENTS_H
#define HIMC_PERFORMANCE_EVENTS_H

#include "himc/performance.h"

#include <stddef.h>

#define EVENTS_WAITING 1024 // chosen: a minute of a roll with a host that takes none
#define EVENT_BYTES 232     // mean, of one that waits; a missed stroke with the longest reason

typedef struct performance_events {
    unsigned char ring[EVENTS_WAITING * EVENT_BYTES]; ///< oldest first, each as long as its kind
    size_t first, last, used; ///< place of the oldest one, of the latest one; all of them (bytes)
    int count;
    long lost; ///< dropped because the host took none
} performance_events;

/// Adds an event; when the queue is full the oldest one is dropped.
HIMC_RT void himc_events_add(performance_events *events, const himc_event *event);
typedef enum note_kind {
    NOTE_USUAL,
    NOTE_MINOR,  ///< himc_event.minor
    NOTE_REFUSED ///< of a command that could not be carried out
} note_kind;

/// Adds a line for the user, unless it is the same as the one before that still waits.
HIMC_RT void himc_events_note_as(performance_events *events, note_kind kind, const char *format,
                                 ...) __attribute__((format(printf, 3, 4)));
#define himc_events_note(events, ...) himc_events_note_as(events, NOTE_USUAL, __VA_ARGS__)
/// Adds a stroke that is not played, on the drum of that name; its place is where it should have
/// been. `why` in a few words.
HIMC_RT void himc_events_missed(performance_events *events, const himc_strike *missed,
                                const char *drum, const char *why);
/// Adds the beginning of a gesture; `time` of its contact (s).
HIMC_RT void himc_events_prepare(performance_events *events, double time, himc_hand hand,
                                 const char *drum);
/// Takes the oldest event; false if there is none.
HIMC_RT bool himc_events_take(performance_events *events, himc_event *event);

#endif
