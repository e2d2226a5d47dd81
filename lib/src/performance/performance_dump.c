/// performance_dump.c: the state of a performance as the lines of a score that makes it again.
///
/// Numbers are told in single precision, as commands take them; what a command computes is told by
/// what it was given, the usual values by themselves (himc_argument_usual). So a new performance
/// that loads the lines has the same settings, bit by bit. What is written (strokes, files of takes
/// and units) is told as it was written, not as it is planned. The transport, moving sticks,
/// sounding heads and hits that wait are no part of the state.
#include "performance/performance_state.h"

#include "performance/describe.h"

#include "base/argument.h"
#include "base/file.h"

#include <string.h>

#define LINE_ROOM (2 * HIMC_PATH_SIZE + 2) // of the longest line (bytes)
#define LINES_AT_ONCE 32                   // of a list; chosen: 0.1 ms at most

// what is written

bool himc_written_room(himc_text_lines *lines, const char *command, himc_error *error)
{
    return himc_text_reserve(lines, LINE_ROOM) ||
           himc_error_set(error, "%s: out of memory", command);
}

static void add_dynamic(himc_state_line *line, double dynamic)
{
    const char *const *words = himc_argument_find("DYNAMIC", "cresc")->words;
    for (int k = 0; words[k]; k++)
        if (dynamic == k / 7.0) {
            himc_state_word(line, words[k]);
            return;
        }
    himc_state_numbers(line, 1, &dynamic);
}

void himc_written_stroke(himc_text_lines *lines, const himc_stroke *stroke)
{
    // in the order of himc_ornament
    static const char *const name[] = {"stroke", "flam", "drag", "ruff", "roll", "roll", "roll"};
    himc_state_line line = himc_state_begin(name[stroke->ornament]);
    himc_state_numbers(&line, 1, &stroke->beat);
    if (stroke->ornament >= HIMC_ROLL_SINGLE) {
        himc_state_numbers(&line, 1, &stroke->length);
        himc_state_word(
            &line,
            himc_command_word(HIMC_COMMAND_ROLL, 2, stroke->ornament - HIMC_ROLL_SINGLE).text);
        add_dynamic(&line, stroke->dynamic);
        add_dynamic(&line, stroke->last_dynamic);
    } else {
        himc_state_word(&line, himc_hand_name(stroke->hand));
        himc_state_word(&line, himc_nuance_name(stroke->nuance));
        add_dynamic(&line, stroke->dynamic);
    }
    if (stroke->spot == HIMC_SPOT_XY)
        himc_state_numbers(&line, 2, (double[]){stroke->x, stroke->y});
    else
        himc_state_word(&line, himc_spot_name(stroke->spot));
    if (stroke->bounces == HIMC_DEAD)
        himc_state_word(&line, "dead");
    if (stroke->part[0])
        himc_state_word(&line, stroke->part);
    if (stroke->drum[0])
        himc_state_word(&line, stroke->drum);
    himc_text_add(lines, line.text);
}

static void add_command(himc_state_line *line, const himc_command *c)
{
    char note[HIMC_NOTE_SIZE];
    himc_state_word(line, himc_command_table((int)c->id)->name);
    // a note is told by its name: its frequency is no number in single precision
    bool pitch = c->id == HIMC_COMMAND_TUNE || c->id == HIMC_COMMAND_GLISS;
    bool told = pitch && himc_note_name(c->atom[0].number, note);
    if (told)
        himc_state_word(line, note);
    for (int i = told; i < c->count; i++)
        if (c->atom[i].kind == HIMC_ATOM_SYMBOL)
            himc_state_word(line, c->atom[i].symbol);
        else
            himc_state_numbers(line, 1, &c->atom[i].number);
}

void himc_written_change(himc_text_lines *lines, const himc_score_line *change, double from)
{
    himc_state_line line = himc_state_begin("at");
    himc_state_numbers(&line, 1, (double[]){from + change->beat});
    himc_state_word(&line, change->drum);
    add_command(&line, &change->command);
    himc_text_add(lines, line.text);
}

void himc_written_units(himc_text_lines *lines, const himc_command *command)
{
    himc_state_line line = himc_state_begin("");
    add_command(&line, command);
    himc_text_add(lines, line.text + 1);
}

// Lists are told from *at on; false once all of it has been. The text may have been written anew.
static bool dump_written(const himc_text_lines *lines, size_t *at, const himc_line_sink *to)
{
    char text[LINE_ROOM];
    const char *line = lines->bytes, *end = line;
    if (!line || *at > lines->size || (*at > 0 && line[*at - 1] != '\n'))
        return false;
    line += *at;
    for (int i = 0; i < LINES_AT_ONCE && (end = strstr(line, ";\n")); i++, line = end + 2) {
        memcpy(text, line, (size_t)(end - line));
        text[end - line] = '\0';
        to->line(to->user, text);
    }
    *at = (size_t)(line - lines->bytes);
    return end && *line;
}

static void tell_push(const planned_push *push, const himc_line_sink *to)
{
    const double how[] = {push->force.x, push->force.y, push->force.z, push->seconds, push->along};
    himc_state_line line = himc_state_begin("at");
    himc_state_numbers(&line, 1, &push->beat);
    himc_state_word(&line, "push");
    himc_state_word(&line, himc_segment_name(push->segment));
    himc_state_numbers(&line, push->along < 0 ? 4 : 5, how);
    himc_state_end(&line, to);
}

static void tell_loop(const himc_planner *planner, const himc_line_sink *to)
{
    double beats[] = {himc_planner_loop_begin(planner), himc_planner_length(planner)},
           on = himc_planner_is_looped(planner);
    bool some = himc_planner_loops_beats(planner);
    himc_state_tell(to, "loop", NULL, some ? 2 : 1, some ? beats : &on);
}

// what is told, in this order
typedef enum dump_part {
    NAMES,
    DRUMS,
    RATES,
    NUDGES,
    SETTINGS,
    UNITS,
    TEMPI,
    LOOP,
    SCORE,
    PUSHES,
    END
} dump_part;

// tells item i of a part, if it has so many; returns their number
static int tell_item(const himc_performance *p, dump_part part, int i, const himc_line_sink *to)
{
    const performance_drums *d = &p->drums;
    const himc_listener *l = &d->listener;
    const himc_drum *drum = i < d->count ? d->slot[i].drum : NULL;
    // no line can be for the silent drum of strokes without a drum's name: that is a command's
    bool named = drum && !himc_command_find(HIMC_PERFORMER, himc_drum_name(drum));
    int count = 0;
    switch (part) {
    case NAMES:
        if (named)
            himc_state_tell(to, "drum", himc_drum_name(drum), 1,
                            (double[]){himc_drum_inches(drum)});
        return d->count;
    case DRUMS:
        // One without a place stands clear of the others as those stood when it was made; but the
        // first where it does in any performance, or where its take moves it.
        if (named)
            himc_performance_tell_drum(drum, i > 0 || himc_drum_is_placed(drum), to);
        return d->count;
    case RATES:
        himc_settings_tell(&p->settings, HIMC_COMMAND_RATE, HIMC_COMMAND_PLAYER, to);
        if (p->written.take[0])
            himc_state_tell(to, "take", p->written.take, 0, NULL);
        return 1;
    case NUDGES:
        if (p->motion->track) {
            const himc_nudge *n = himc_track_nudges(p->motion->track, &count) + i;
            if (i < count)
                himc_state_tell(to, "nudge", himc_hand_name(n->hand), 5,
                                (double[]){n->time, n->span, n->way.x, n->way.y, n->way.z});
        }
        return count;
    case SETTINGS:
        himc_settings_tell(&p->settings, HIMC_COMMAND_PLAYER, HIMC_COMMANDS, to);
        himc_state_tell(to, "listener",
                        !l->on      ? "off"
                        : l->yields ? "usual"
                                    : NULL,
                        l->on && !l->yields ? 4 : 0,
                        (double[]){l->place.x, l->place.y, l->place.z, l->yaw});
        himc_state_tell(to, "room", NULL, 2, (double[]){d->walls.seconds, d->walls.volume});
        himc_state_tell(to, "gain", NULL, 1, (double[]){20 * log10(d->gain)});
        himc_state_tell(to, "mute", NULL, 1, (double[]){d->mute});
        return 1;
    case TEMPI: {
        const himc_tempo_change *tempo = himc_planner_tempi(p->motion->planner, &count) + i;
        if (i < count)
            himc_state_tell(to, "tempo", NULL, tempo->beat > 0 ? 2 : 1,
                            (double[]){tempo->bpm, tempo->beat});
        return count;
    }
    case LOOP: tell_loop(p->motion->planner, to); return 1;
    case PUSHES:
        if (i < p->body->planned_count)
            tell_push(&p->body->planned[i], to);
        return p->body->planned_count;
    default: return 0;
    }
}

bool himc_performance_describe_on(const himc_performance *p, himc_describe_place *place,
                                  void (*line)(void *, const char *), void *user)
{
    const himc_line_sink to = {line, user};
    dump_part part = (dump_part)place->part;
    size_t *at = &place->at, end = *at + (part == DRUMS ? 1 : LINES_AT_ONCE);
    bool more = true;
    if (part == UNITS || (part == SCORE && !p->written.take[0]))
        more = dump_written(part == UNITS ? &p->written.units : &p->written.score, at, &to);
    else
        for (; more && *at < end; ++*at)
            more = (int)*at + 1 < tell_item(p, part, (int)*at, &to);
    if (!more)
        *place = (himc_describe_place){part + 1, 0};
    return place->part < END;
}

static void dump(const himc_performance *p, const himc_line_sink *to)
{
    himc_describe_place place = {0};
    while (himc_performance_describe_on(p, &place, to->line, to->user))
        ;
}

// what changes by itself, and the settings
static void tell_values(const himc_performance *p, const himc_line_sink *to)
{
    himc_performance_stats now = himc_performance_measure(p);
    himc_state_line drums = himc_state_begin("drums");
    bool prepares = himc_planner_is_preparing(p->motion->planner, step_time(p));
    himc_state_tell(to, "beat", NULL, 1, &now.beat);
    himc_state_tell(to, "tempo", NULL, 1, &now.bpm);
    himc_state_tell(to, "state",
                    !p->motion->playing ? "stopped"
                    : prepares          ? "preparing"
                                        : "playing",
                    0, NULL);
    for (int i = 0; i < p->drums.count; i++)
        himc_state_word(&drums, himc_drum_name(p->drums.slot[i].drum));
    himc_state_end(&drums, to);
    tell_item(p, RATES, 0, to);
    tell_item(p, SETTINGS, 0, to);
    tell_item(p, LOOP, 0, to);
}

typedef struct asked_value {
    himc_line_sink to;
    const char *what;
    bool found;
} asked_value;

static void answer_value(void *asked, const char *line)
{
    asked_value *a = asked;
    size_t length = strlen(a->what);
    if (strncmp(line, a->what, length) != 0 || (line[length] && line[length] != ' '))
        return;
    a->found = true;
    a->to.line(a->to.user, line);
}

bool himc_performance_get(const himc_performance *p, const char *what,
                          void (*line)(void *, const char *), void *user, himc_error *error)
{
    asked_value asked = {.to = {line, user}, .what = what};
    tell_values(p, &(himc_line_sink){answer_value, &asked});
    return asked.found || himc_error_set(error,
                                         "get: WHAT: %s, expected a setting, tempo, beat, state, "
                                         "drums, loop, room, listener or mute",
                                         what);
}

void himc_performance_describe(const himc_performance *p, himc_description what,
                               void (*line)(void *, const char *), void *user)
{
    himc_line_sink to = {line, user};
    if (what == HIMC_DESCRIBE_STATE)
        dump(p, &to);
    else
        himc_performance_inform(p, to);
}

himc_job *himc_performance_dump_job(himc_performance *p, const himc_command *command,
                                    himc_error *error)
{
    himc_text_lines lines = {0};
    dump(p, &(himc_line_sink){himc_text_add, &lines});
    return himc_file_write_job("dump", command->atom[0].symbol, &lines, error);
}
