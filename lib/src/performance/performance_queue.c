/// performance_queue.c: commands wait in the order in which they came. In a storm of commands the
/// first one dropped is an error; the rest are counted and reported after the storm.
#include "performance/performance_queue.h"

static waiting_command *waiting_at(performance_queue *q, size_t at)
{
    return (waiting_command *)(q->waiting + at);
}

static size_t size_of(const himc_command *command)
{
    size_t align = _Alignof(waiting_command);
    size_t size = offsetof(waiting_command, command) + himc_command_size(command);
    return (size + align - 1) / align * align;
}

void himc_queue_clear(performance_queue *q)
{
    q->used = 0;
    q->acting = -1;
    q->dropped = 0;
}

bool himc_queue_has_room(const performance_queue *q)
{
    return q->used + sizeof(waiting_command) <= sizeof q->waiting;
}

bool himc_queue_drop(performance_queue *q, himc_error *error)
{
    return q->dropped++ > 0 ||
           himc_error_set(error, "more than %d commands at once: this one is dropped",
                          WAITING_COMMANDS);
}

void himc_queue_add(performance_queue *q, const himc_command *command, int64_t due)
{
    waiting_command *w = waiting_at(q, q->used);
    w->due = due;
    himc_command_copy(&w->command, command);
    q->used += size_of(command);
}

void himc_queue_run(performance_queue *q, int64_t sample, performance_action *act,
                    himc_performance *performance, performance_events *events)
{
    size_t kept = 0, size;
    for (size_t at = 0; at < q->used; at += size) {
        himc_error error;
        waiting_command *w = waiting_at(q, at);
        size = size_of(&w->command);
        q->acting = w->due;
        if (w->due <= sample) {
            if (!act(performance, &w->command, &error))
                himc_events_refuse(events, "%s", error.text);
            continue;
        }
        if (kept < at) { // it moves up, to where only commands are that have acted
            waiting_command up = {.due = w->due};
            himc_command_copy(&up.command, &w->command);
            waiting_at(q, kept)->due = up.due;
            himc_command_copy(&waiting_at(q, kept)->command, &up.command);
        }
        kept += size;
    }
    q->acting = -1;
    q->used = kept;
    if (q->dropped > 0 && kept < sizeof q->waiting / 2) {
        himc_events_note(events, "%ld commands dropped: more than %d waited", q->dropped,
                         WAITING_COMMANDS);
        q->dropped = 0;
    }
}
