/// performance_queue.c: commands wait in the order in which they came. In a storm of commands the
/// first one dropped is an error; the rest are counted and reported after the storm.
#include "performance/performance_queue.h"

#include <assert.h>
#include <string.h>

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
    char *text = w->text;
    w->due = due;
    memcpy(w->fields, command, sizeof w->fields);
    for (int i = 0; i < command->count; i++) {
        if (command->atom[i].kind != HIMC_ATOM_SYMBOL)
            continue;
        size_t size = strlen(command->atom[i].symbol) + 1;
        assert(size <= (size_t)(w->text + sizeof w->text - text));
        text = (char *)memcpy(text, command->atom[i].symbol, size) + size;
    }
}

void himc_queue_run(performance_queue *q, int64_t sample, performance_action *act,
                    himc_performance *performance, performance_events *events)
{
    int kept = 0;
    for (int i = 0; i < q->count; i++) {
        himc_error error;
        himc_command command;
        const waiting_command *w = &q->waiting[i];
        q->acting = w->due;
        if (w->due > sample) {
            q->waiting[kept++] = *w;
            continue;
        }
        const char *symbol = command.storage;
        memcpy(&command, w->fields, sizeof w->fields);
        memcpy(command.storage, w->text, sizeof w->text);
        command.folder = NULL;
        for (int k = 0; k < command.count; k++)
            if (command.atom[k].kind == HIMC_ATOM_SYMBOL) {
                command.atom[k].symbol = symbol;
                symbol += strlen(symbol) + 1;
            }
        if (!act(performance, &command, &error))
            himc_events_note_as(events, NOTE_REFUSED, "%s", error.text);
    }
    q->acting = -1;
    q->count = kept;
    if (q->dropped > 0 && kept < WAITING_COMMANDS / 2) {
        himc_events_note(events, "%ld commands dropped: more than %d waited", q->dropped,
                         WAITING_COMMANDS);
        q->dropped = 0;
    }
}
