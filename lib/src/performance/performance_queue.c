/// performance_queue.c: commands wait in the order in which they came. In a storm of commands the
/// first one dropped is an error; the rest are counted and reported after the storm.
#include "performance/performance_queue.h"

void himc_queue_clear(performance_queue *q)
{
    q->count = 0;
    q->acting = -1;
    q->dropped = 0;
}

bool himc_queue_has_room(const performance_queue *q)
{
    return q->count < WAITING_COMMANDS;
}

bool himc_queue_drop(performance_queue *q, himc_error *error)
{
    return q->dropped++ > 0 ||
           himc_error_set(error, "more than %d commands at once: this one is dropped",
                          WAITING_COMMANDS);
}

void himc_queue_add(performance_queue *q, const himc_command *command, int64_t due)
{
    waiting_command *w = &q->waiting[q->count++];
    w->due = due;
    himc_command_copy(&w->command, command);
}

// a command that is not due moves up
static void keep_waiting(performance_queue *q, int from, int to)
{
    if (from == to)
        return;
    q->waiting[to].due = q->waiting[from].due;
    himc_command_copy(&q->waiting[to].command, &q->waiting[from].command);
}

void himc_queue_run(performance_queue *q, int64_t sample, performance_action *act,
                    himc_performance *performance, performance_events *events)
{
    int kept = 0;
    for (int i = 0; i < q->count; i++) {
        himc_error error;
        q->acting = q->waiting[i].due;
        if (q->waiting[i].due > sample)
            keep_waiting(q, i, kept++);
        else if (!act(performance, &q->waiting[i].command, &error))
            himc_events_refuse(events, "%s", error.text);
    }
    q->acting = -1;
    q->count = kept;
    if (q->dropped > 0 && kept < WAITING_COMMANDS / 2) {
        himc_events_note(events, "%ld commands dropped: more than %d waited", q->dropped,
                         WAITING_COMMANDS);
        q->dropped = 0;
    }
}
