/// planner_notes.c: lines for the user, in a ring that does not grow.
///
/// Each kind is said once per play, so that a fast passage does not say the same thing a hundred
/// times; the counts tell the rest at the end. Only a stroke that is given up, or left to the next
/// round of a loop, has a line of its own; of those given up, unless there are many: LINES at once
/// and one more each second. What finds no room is counted in the last line.
///
/// A line names a stroke as it is written, with beat, hand and drum. Grace notes and the strokes of
/// a roll are not written: they are named after the stroke, or the roll, that they belong to. In a
/// loop the round is named, too, from 1 on.
#include "plan/planner_notes.h"
#include "base/format.h"
#include "plan/planner_state.h"

#include "base/line.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define QUIET_TIME 1.0    // chosen: longer than the pauses in a passage, short for a player (s)
#define LONGEST_QUIET 8.0 // chosen: a passage without pauses is told of before it is over (s)
#define LINES 8           // chosen: they can be read at a glance

static void put(planner_notes *notes, bool minor, const char *format, va_list args)
{
    if (notes->count == PLANNER_NOTES) {
        himc_planner_note *last = &notes->line[(notes->first + PLANNER_NOTES - 1) % PLANNER_NOTES];
        himc_format(last->text, sizeof last->text, "%d more notes were lost", ++notes->lost + 1);
        return;
    }
    himc_planner_note *note = &notes->line[(notes->first + notes->count++) % PLANNER_NOTES];
    note->minor = minor;
    himc_line_print(note->text, sizeof note->text, format, args);
}

void himc_planner_say(himc_planner *planner, planner_kind kind, const char *format, ...)
{
    planner_notes *notes = &planner->notes;
    bool first = !notes->said[kind], given_up = kind == PLANNER_GIVEN_UP;
    va_list args;
    if (notes->silent)
        return;
    notes->said[kind] = true;
    if (given_up && notes->spent > LINES - 1) {
        notes->untold++;
        notes->last_untold = notes->told;
        return;
    }
    if (!given_up && !first && kind != PLANNER_NEXT_ROUND)
        return;
    notes->spent += given_up;
    va_start(args, format);
    put(notes, kind >= PLANNER_REASSIGNED, format, args);
    va_end(args);
}

void himc_planner_notes_count(planner_notes *notes, planner_kind kind)
{
    notes->strokes[kind] += !notes->silent;
    notes->given_up += kind == PLANNER_GIVEN_UP && !notes->silent;
}

void himc_planner_notes_miss(planner_notes *notes, const himc_planner_miss *miss)
{
    if (notes->silent)
        return;
    if (notes->misses == PLANNER_MISSES) {
        notes->first_miss = (notes->first_miss + 1) % PLANNER_MISSES;
        notes->misses--;
    }
    notes->miss[(notes->first_miss + notes->misses++) % PLANNER_MISSES] = *miss;
}

void himc_planner_tell_miss(himc_planner *planner, const himc_planner_miss *miss, const char *name)
{
    if (!miss->hit)
        himc_planner_notes_count(&planner->notes, PLANNER_GIVEN_UP);
    himc_planner_notes_miss(&planner->notes, miss);
    himc_planner_say(planner, PLANNER_GIVEN_UP, "%s: given up, %s", name, miss->why);
}

bool himc_planner_miss_next(himc_planner *planner, himc_planner_miss *miss)
{
    planner_notes *notes = &planner->notes;
    if (notes->misses == 0)
        return false;
    *miss = notes->miss[notes->first_miss];
    notes->first_miss = (notes->first_miss + 1) % PLANNER_MISSES;
    notes->misses--;
    return true;
}

void himc_planner_notes_begin(planner_notes *notes)
{
    notes->spent = 0;
    memset(notes->said, 0, sizeof notes->said);
    memset(notes->strokes, 0, sizeof notes->strokes);
}

static void say_always(planner_notes *notes, bool minor, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

static void say_always(planner_notes *notes, bool minor, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    put(notes, minor, format, args);
    va_end(args);
}

void himc_planner_notes_hit(planner_notes *notes, double t, double late)
{
    if (notes->silent)
        return;
    if (notes->hits_lost + notes->hits_late == 0)
        notes->first_hit = t;
    notes->last_hit = t;
    if (isinf(late)) {
        notes->hits_lost++;
        return;
    }
    notes->hits_late++;
    notes->latest = fmax(notes->latest, late);
}

void himc_planner_notes_tell(planner_notes *notes, double t)
{
    char lost[32] = "", late[48] = "";
    if (notes->hits_lost + notes->hits_late > 0 &&
        t >= fmin(notes->last_hit + QUIET_TIME, notes->first_hit + LONGEST_QUIET)) {
        if (notes->hits_lost > 0)
            himc_format(lost, sizeof lost, " %d given up,", notes->hits_lost);
        if (notes->hits_late > 0)
            himc_format(late, sizeof late, " %d late by up to %.0f ms,", notes->hits_late,
                        1e3 * notes->latest);
        say_always(notes, false, "hit:%s%s no hand had the time", lost, late);
        notes->hits_lost = notes->hits_late = 0;
        notes->latest = 0;
    }
    notes->spent = fmax(notes->spent - (t - notes->told), 0);
    notes->told = t;
    if (notes->untold == 0 || t < notes->last_untold + QUIET_TIME)
        return;
    say_always(notes, false, "%d more given up", notes->untold);
    notes->untold = 0;
}

void himc_planner_notes_sum_up(planner_notes *notes)
{
    int softer = notes->strokes[PLANNER_HURRIED], other = notes->strokes[PLANNER_REASSIGNED],
        given_up = notes->strokes[PLANNER_GIVEN_UP];
    if (softer + other + given_up > 1)
        say_always(notes, given_up == 0,
                   "in all %d strokes softer, %d by the other hand, %d given up", softer, other,
                   given_up);
}

bool himc_planner_note_next(himc_planner *planner, himc_planner_note *note)
{
    planner_notes *notes = &planner->notes;
    if (notes->count == 0)
        return false;
    *note = notes->line[notes->first];
    notes->first = (notes->first + 1) % PLANNER_NOTES;
    if (--notes->count == 0)
        notes->lost = 0;
    return true;
}

int himc_planner_given_up(himc_planner *planner)
{
    int count = planner->notes.given_up;
    planner->notes.given_up = 0;
    return count;
}

const char *himc_grace_name(himc_ornament ornament)
{
    return ornament == HIMC_FLAM ? "flam" : ornament == HIMC_DRAG ? "drag" : "ruff";
}

const char *himc_planner_name(const himc_planner *planner, const timed_stroke *s,
                              char text[HIMC_PLANNER_NAME])
{
    const himc_stroke *stroke = &s->stroke;
    const planner_score *score = &planner->score;
    const char *hand = himc_hand_name(stroke->hand), *drum = stroke->drum, *on = drum[0] ? " " : "";
    bool hit = s->place.number < 0 && !s->reassigned, grace = stroke->early > 0 && stroke->ornament;
    // the written stroke of a grace note is by the other hand; a reassigned one has changed hands
    bool left = s->reassigned == (stroke->hand == HIMC_LEFT);
    size_t size = HIMC_PLANNER_NAME, used;
    if (hit)
        used = himc_format(text, size, "hit %s%s%s", hand, on, drum);
    else if (s->place.roll >= 0)
        used = himc_format(text, size, "stroke %s of the roll at beat %g%s%s", hand,
                           score->roll[s->place.roll].stroke.beat, on, drum);
    else if (stroke->ornament >= HIMC_ROLL_SINGLE)
        used = himc_format(text, size, "roll at beat %g%s%s", stroke->beat, on, drum);
    else if (grace)
        used = himc_format(text, size, "grace note %s of the %s at beat %g %s%s%s", hand,
                           himc_grace_name(stroke->ornament), stroke->beat,
                           himc_hand_name(left ? HIMC_LEFT : HIMC_RIGHT), on, drum);
    else
        used = himc_format(text, size, "stroke at beat %g %s%s%s", stroke->beat, hand, on, drum);
    if (!hit && s->place.round >= 0 && (score->loop || score->rounds > 0))
        himc_format(text + used, size - used, ", round %ld",
                    (long)score->past + s->place.round + 1);
    return text;
}
