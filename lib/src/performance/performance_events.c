/// performance_events.c: events in a ring. `reset` leaves the host's waiting events.
#include "performance/performance_events.h"

#include "base/format.h"
#include "base/line.h"

#include <stdarg.h>
#include <string.h>

static size_t size_of(const himc_event *event)
{
    return EVENT_SIZE + strlen(event->text);
}

// the event that begins at byte `at`
static himc_event event_at(const performance_events *e, size_t at)
{
    himc_event event;
    size_t room = sizeof e->waiting, first = room - at < sizeof event ? room - at : sizeof event;
    memcpy(&event, e->waiting + at, first);
    memcpy((char *)&event + first, e->waiting, sizeof event - first);
    return event;
}

void himc_events_add(performance_events *e, const himc_event *event)
{
    size_t size = size_of(event), room = sizeof e->waiting;
    himc_event oldest;
    while (e->used + size > room && himc_events_take(e, &oldest))
        e->lost++;
    e->last = (e->first + e->used) % room;
    size_t first = room - e->last < size ? room - e->last : size;
    memcpy(e->waiting + e->last, event, first);
    memcpy(e->waiting, (const char *)event + first, size - first);
    e->used += size;
}

static void add_note(performance_events *e, himc_event event, const char *format, va_list args)
    __attribute__((format(printf, 3, 0)));

static void add_note(performance_events *e, himc_event event, const char *format, va_list args)
{
    himc_event last = event_at(e, e->last);
    himc_line_print(event.text, sizeof event.text, format, args);
    // a score that plays, and then its host: one cause, one line
    if (e->used == 0 || last.kind != HIMC_EVENT_NOTE || strcmp(last.text, event.text) != 0)
        himc_events_add(e, &event);
}

void himc_events_note(performance_events *e, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    add_note(e, (himc_event){.kind = HIMC_EVENT_NOTE}, format, args);
    va_end(args);
}

void himc_events_note_as(performance_events *e, bool minor, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    add_note(e, (himc_event){.kind = HIMC_EVENT_NOTE, .minor = minor}, format, args);
    va_end(args);
}

void himc_events_refuse(performance_events *e, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    add_note(e, (himc_event){.kind = HIMC_EVENT_NOTE, .refused = true}, format, args);
    va_end(args);
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

bool himc_events_take(performance_events *e, himc_event *event)
{
    if (e->used == 0)
        return false;
    *event = event_at(e, e->first);
    e->first = (e->first + size_of(event)) % sizeof e->waiting;
    e->used -= size_of(event);
    return true;
}

void himc_events_on_motion(performance_events *e, void (*row)(void *, const himc_motion_row *),
                           void *user)
{
    e->on_motion = row;
    e->motion_user = user;
}

void himc_events_on_tick(performance_events *e, void (*tick)(void *, const himc_tick *), void *user)
{
    e->on_tick = tick;
    e->tick_user = user;
}
