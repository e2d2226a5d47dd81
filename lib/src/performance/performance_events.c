/// performance_events.c: events in a ring of bytes. An event has a strike there if its kind has
/// one, and its text up to the final 0. `reset` leaves the host's waiting events.
#include "performance/performance_events.h"

#include "base/format.h"
#include "base/line.h"

#include <string.h>

static bool has_strike(himc_event_kind kind)
{
    return kind == HIMC_EVENT_STRIKE || kind == HIMC_EVENT_MISSED || kind == HIMC_EVENT_PREPARE;
}

// bytes in the ring
static size_t size_of(const himc_event *event)
{
    size_t strike = has_strike(event->kind) ? 0 : sizeof event->strike;
    return offsetof(himc_event, text) - strike + strlen(event->text) + 1;
}

// copies an event into the ring at byte `at`, or out of it
static void pass(performance_events *e, size_t at, himc_event *event, bool in)
{
    unsigned char *byte = (unsigned char *)event;
    for (size_t i = 0; i < sizeof *event; i++, at++) {
        if (i == offsetof(himc_event, strike) && !has_strike(event->kind))
            i = offsetof(himc_event, text);
        unsigned char *cell = &e->ring[at % sizeof e->ring];
        *(in ? cell : byte + i) = *(in ? byte + i : cell);
        if (i >= offsetof(himc_event, text) && byte[i] == '\0')
            return;
    }
}

void himc_events_add(performance_events *e, const himc_event *event)
{
    himc_event added = *event, oldest;
    size_t size = size_of(event);
    for (; e->count == EVENTS_WAITING || e->used + size > sizeof e->ring; e->lost++)
        himc_events_take(e, &oldest);
    e->last = (e->first + e->used) % sizeof e->ring;
    pass(e, e->last, &added, true);
    e->used += size;
    e->count++;
}

void himc_events_note_as(performance_events *e, note_kind kind, const char *format, ...)
{
    himc_event last = {.kind = HIMC_EVENT_DONE};
    himc_event event = {
        .kind = HIMC_EVENT_NOTE, .minor = kind == NOTE_MINOR, .refused = kind == NOTE_REFUSED};
    va_list args;
    if (e->count > 0)
        pass(e, e->last, &last, false);
    va_start(args, format);
    himc_line_print(event.text, sizeof event.text, format, args);
    va_end(args);
    // a score that plays, and then its host: one cause, one line
    if (last.kind != HIMC_EVENT_NOTE || strcmp(last.text, event.text) != 0)
        himc_events_add(e, &event);
}

void himc_events_missed(performance_events *e, const himc_strike *missed, const char *drum,
                        const char *why)
{
    himc_event event = {.kind = HIMC_EVENT_MISSED, .strike = *missed};
    himc_format(event.strike.drum, sizeof event.strike.drum, "%s", drum);
    himc_format(event.text, sizeof event.text, "%s", why);
    event.strike.planned_x = missed->x;
    event.strike.planned_y = missed->y;
    himc_events_add(e, &event);
}

void himc_events_prepare(performance_events *e, double time, himc_hand hand, const char *drum)
{
    himc_event event = {.kind = HIMC_EVENT_PREPARE, .strike = {.time = time, .hand = hand}};
    himc_format(event.strike.drum, sizeof event.strike.drum, "%s", drum);
    himc_events_add(e, &event);
}

bool himc_events_take(performance_events *e, himc_event *event)
{
    if (e->count == 0)
        return false;
    *event = (himc_event){.kind = HIMC_EVENT_DONE};
    pass(e, e->first, event, false);
    e->first = (e->first + size_of(event)) % sizeof e->ring;
    e->used -= size_of(event);
    e->count--;
    return true;
}
