/// performance_queue.h: the commands of a performance that wait for their sample.
#ifndef HIMC_PERFORMANCE_QUEUE_H
#define HIMC_PERFORMANCE_QUEUE_H

#include "performance/performance_events.h"

#include <stdint.h>

#define WAITING_COMMANDS 256 // chosen: one every 32 samples of the longest delay
#define WAITING_TEXT 128     // of its symbols (bytes); a drum's or a segment's name and short words

/// A command that acts at a sample; it names no file, so its words are few.
typedef struct waiting_command {
    int64_t due;                                           ///< sample
    unsigned char fields[offsetof(himc_command, storage)]; ///< all but its text
    char text[WAITING_TEXT];                               ///< its symbols, one after the other
} waiting_command;

typedef struct performance_queue {
    waiting_command waiting[WAITING_COMMANDS]; ///< in their order of arrival
    int count;
    int64_t acting; ///< sample for which the command was meant that acts now; -1: none acts
    long dropped;   ///< because the queue was full
} performance_queue;

/// Carries out a command now; false, and nothing changed, with the reason.
typedef bool performance_action(himc_performance *performance, const himc_command *command,
                                himc_error *error);

HIMC_RT void himc_queue_clear(performance_queue *queue);
/// True if one more command may wait. The first one dropped is an error, the rest are counted.
HIMC_RT bool himc_queue_has_room(const performance_queue *queue);
HIMC_RT bool himc_queue_drop(performance_queue *queue, himc_error *error);
HIMC_RT void himc_queue_add(performance_queue *queue, const himc_command *command, int64_t due);
/// Carries out the commands that are due at that sample; refusals become notes.
void himc_queue_run(performance_queue *queue, int64_t sample, performance_action *act,
                    himc_performance *performance, performance_events *events);

#endif
