/// score.c: a score's text read in one pass: statements to commands, strokes sorted by beat.
///
/// text.c splits words and command.c checks them; this file adds lines for drums, the tempo map,
/// the order, and the check that a player can play the strokes. The tempo map is piecewise
/// constant: seconds are the sum of 60/bpm times beats, and the inverse takes the same sum
/// backwards. Limits of size refuse a wrong file in one line before memory runs out. Invariant: the
/// whole score is good, or nothing of it is kept.
#include "plan/score.h"

#include "base/argument.h"
#include "base/array.h"
#include "base/file.h"
#include "base/format.h"
#include "base/setups.h"
#include "base/text.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

// chosen: more than a day of drumming, and small enough for any machine's memory
#define SCORE_LINES_MAX 10000
#define MEZZOFORTE (4.0 / 7)
#define RAMP_STEPS 4 // of a ramp of tempo, in a beat; chosen: strokes are rarely between
#define BYTE_ORDER_MARK "\xEF\xBB\xBF" // some editors begin a file with it
#define LONGEST_ROLL 180.0             // (s) chosen: under 3000 strokes at 14 a second

/// A score being read.
typedef struct reader {
    himc_score *score;
    int stroke_room, tempo_room, line_room, change_room, order_room, bar_room;
    himc_score_line now; ///< the current statement
    himc_dynamics dynamics;
    const char *name;   ///< of the file
    const char *folder; ///< of the files that it names; NULL: any
    bool setup;         ///< it is a set-up, which may not name another
    int setup_line;     ///< of the score's only one; 0: it has none yet
    himc_error *error;
} reader;

/// The stroke or change that is added next has its place behind those of the file so far.
static bool add_place(reader *r, int place)
{
    himc_score *score = r->score;
    int count = score->stroke_count + score->change_count;
    if (!himc_array_grow(&score->order, count, &r->order_room, sizeof *score->order, r->error))
        return false;
    score->order[count] = place;
    return true;
}

static bool add_stroke(reader *r)
{
    himc_score *score = r->score;
    if (score->stroke_count == HIMC_SCORE_STROKES)
        return himc_error_set(r->error, "stroke: one too many, expected %d strokes",
                              HIMC_SCORE_STROKES);
    int room = r->stroke_room;
    if (!add_place(r, score->stroke_count) ||
        !himc_array_grow(&score->stroke_lines, score->stroke_count, &room,
                         sizeof *score->stroke_lines, r->error) ||
        !himc_array_grow(&score->strokes, score->stroke_count, &r->stroke_room,
                         sizeof *score->strokes, r->error))
        return false;
    score->stroke_lines[score->stroke_count] = r->now.line;
    score->strokes[score->stroke_count++] = r->now.command.stroke;
    return true;
}

void himc_score_insert_tempo(himc_tempo_change *tempi, int *count, himc_tempo_change change)
{
    int i = *count;
    while (i > 0 && tempi[i - 1].beat > change.beat)
        i--;
    if (i > 0 && tempi[i - 1].beat == change.beat) {
        tempi[i - 1] = change;
        return;
    }
    memmove(tempi + i + 1, tempi + i, (size_t)(*count - i) * sizeof *tempi);
    tempi[i] = change;
    ++*count;
}

himc_tempo_ramp himc_score_read_tempo(const himc_command *c)
{
    bool ramp = c->form == 1;
    int at = ramp ? 3 : 1;
    return (himc_tempo_ramp){.beat = c->count > at ? c->atom[at].number : -1,
                             .from = c->atom[0].number,
                             .to = c->atom[ramp].number,
                             .length = ramp ? c->atom[2].number : 0};
}

int himc_score_ramp_steps(const himc_tempo_ramp *ramp)
{
    return (int)ceil(ramp->length * RAMP_STEPS);
}

double himc_score_ramp_bpm(const himc_tempo_ramp *ramp, int step)
{
    double way = (ramp->to - ramp->from) / himc_score_ramp_steps(ramp);
    double a = ramp->from + way * step, b = a + way;
    return a == b ? a : (b - a) / log(b / a);
}

void himc_score_insert_ramp(himc_tempo_change *tempi, int *count, const himc_tempo_ramp *ramp)
{
    int steps = himc_score_ramp_steps(ramp), kept = 0;
    for (int i = 0; i < *count; i++) // all but what is within
        if (tempi[i].beat <= ramp->beat || tempi[i].beat >= ramp->beat + ramp->length)
            tempi[kept++] = tempi[i];
    *count = kept;
    for (int i = 0; i < steps; i++)
        himc_score_insert_tempo(tempi, count,
                                (himc_tempo_change){ramp->beat + ramp->length * i / steps,
                                                    himc_score_ramp_bpm(ramp, i)});
    himc_score_insert_tempo(tempi, count, (himc_tempo_change){ramp->beat + ramp->length, ramp->to});
}

bool himc_dynamics_add(himc_dynamics *d, const himc_command *c, himc_error *error)
{
    double level[2];
    if (d->count == SCORE_LINES_MAX)
        return himc_error_set(error, "cresc: one too many, expected %d", SCORE_LINES_MAX);
    if (!himc_array_grow(&d->cresc, d->count, &d->room, sizeof *d->cresc, error))
        return false;
    for (int i = 0; i < 2; i++)
        level[i] = c->choice[2 + i] >= 0 ? c->choice[2 + i] / 7.0 : c->atom[2 + i].number;
    d->cresc[d->count++] =
        (struct himc_cresc){c->atom[0].number, c->atom[1].number, level[0], level[1]};
    return true;
}

static double dynamic_at(const himc_dynamics *d, double own, double beat)
{
    double level = MEZZOFORTE, begun = -1;
    for (int i = 0; i < d->count; i++)
        if (d->cresc[i].beat <= beat && d->cresc[i].beat >= begun) {
            begun = d->cresc[i].beat;
            level = d->cresc[i].from + (d->cresc[i].to - d->cresc[i].from) *
                                           fmin((beat - begun) / d->cresc[i].length, 1);
        }
    return own == HIMC_DYNAMIC_FOLLOWS ? level : own;
}

void himc_dynamics_give(const himc_dynamics *d, himc_stroke *stroke)
{
    stroke->dynamic = dynamic_at(d, stroke->dynamic, stroke->beat);
    if (stroke->ornament >= HIMC_ROLL_SINGLE)
        stroke->last_dynamic = dynamic_at(d, stroke->last_dynamic, stroke->beat + stroke->length);
}

static bool add_tempo(reader *r)
{
    himc_score *score = r->score;
    himc_tempo_ramp ramp = himc_score_read_tempo(&r->now.command);
    ramp.beat = fmax(ramp.beat, 0);
    while (r->tempo_room <= score->tempo_count + himc_score_ramp_steps(&ramp))
        if (!himc_array_grow(&score->tempi, r->tempo_room, &r->tempo_room, sizeof *score->tempi,
                             r->error))
            return false;
    himc_score_insert_ramp(score->tempi, &score->tempo_count, &ramp);
    return score->tempo_count <= SCORE_LINES_MAX ||
           himc_error_set(r->error, "tempo: one too many, expected %d", SCORE_LINES_MAX);
}

static void copy_line(himc_score_line *to, const himc_score_line *from)
{
    memcpy(to->drum, from->drum, sizeof to->drum);
    to->line = from->line;
    to->beat = from->beat;
    himc_command_copy(&to->command, &from->command);
}

static double inches_of(const himc_command *drum)
{
    return drum->count > 1 ? drum->atom[1].number : HIMC_INCHES_USUAL;
}

// whether two commands make the same instrument
static bool make_the_same(const himc_command *a, const himc_command *b)
{
    bool same = a->id == b->id && a->count == b->count;
    if (a->id == HIMC_COMMAND_MAKE_DRUM && b->id == a->id)
        return inches_of(a) == inches_of(b);
    for (int i = 1; same && i < a->count; i++)
        same = a->atom[i].kind == b->atom[i].kind && a->atom[i].number == b->atom[i].number &&
               (a->atom[i].kind != HIMC_ATOM_SYMBOL ||
                strcmp(a->atom[i].symbol, b->atom[i].symbol) == 0);
    return same;
}

/// The current statement, in the lines that act at once or at their beats.
static bool add_line(reader *r, bool timed)
{
    himc_score *score = r->score;
    bool makes = himc_score_makes_drum(&r->now);
    // a drum is made once; the same line again is allowed
    for (int i = 0; makes && i < score->line_count; i++) {
        const himc_command *made = &score->lines[i].command;
        if (!himc_score_makes_drum(&score->lines[i]) ||
            strcmp(made->atom[0].symbol, r->now.command.atom[0].symbol) != 0 ||
            make_the_same(made, &r->now.command))
            continue;
        if (made->id == HIMC_COMMAND_INSTRUMENT)
            return himc_error_set(r->error, "%s: %s is a %s since line %d already",
                                  himc_command_table((int)r->now.command.id)->name,
                                  made->atom[0].symbol, made->atom[1].symbol, score->lines[i].line);
        return himc_error_set(r->error, "drum: %s is made with %g inches on line %d already",
                              made->atom[0].symbol, inches_of(made), score->lines[i].line);
    }
    himc_score_line **lines = timed ? &score->changes : &score->lines;
    int *count = timed ? &score->change_count : &score->line_count,
        *room = timed ? &r->change_room : &r->line_room;
    if (score->line_count + score->change_count == SCORE_LINES_MAX)
        return himc_error_set(r->error, "one line too many, expected %d besides strokes",
                              SCORE_LINES_MAX);
    if (timed && !add_place(r, -1 - *count))
        return false;
    if (*count == *room) { // a command points into itself: lines are copied one by one, not moved
        *room = *room ? 2 * *room : 16;
        himc_score_line *bigger = malloc((size_t)*room * sizeof *bigger);
        if (!bigger)
            return himc_error_set(r->error, "out of memory for %d lines", *room);
        for (int i = 0; i < *count; i++)
            copy_line(&bigger[i], &(*lines)[i]);
        free(*lines);
        *lines = bigger;
    }
    copy_line(&(*lines)[(*count)++], &r->now);
    return true;
}

/// True if an earlier line of the score made or addressed a drum of that name.
static bool is_known_drum(const himc_score *score, const char *word)
{
    for (int i = 0; i < score->line_count; i++) {
        const himc_score_line *line = &score->lines[i];
        if (strcmp(line->drum, word) == 0 ||
            (himc_score_makes_drum(line) && strcmp(line->command.atom[0].symbol, word) == 0))
            return true;
    }
    return false;
}

static bool may_stand(const himc_command *c, himc_error *error)
{
    const himc_command_row *row = himc_command_table((int)c->id);
    return !(row->marks & HIMC_NOT_IN_SCORE) ||
           himc_error_set(error, "%s: not allowed in a score%s", row->name,
                          c->id == HIMC_COMMAND_DRUM_GLISS
                              ? ", expected at BEAT DRUM gliss PITCH SECONDS"
                              : "");
}

bool himc_score_read_change(const himc_atom *atom, int count, himc_score_line *out,
                            himc_error *error)
{
    const char *word = atom[1].symbol;
    bool push = himc_command_find(HIMC_PERFORMER, word) != NULL; // no drum has such a name
    snprintf(out->drum, sizeof out->drum, "%s", push ? "" : word);
    out->beat = atom[0].number;
    if (push)
        return himc_command_parse(&out->command, HIMC_PERFORMER, word, atom + 2, count - 2, error);
    if (!himc_command_parse(&out->command, HIMC_DRUM, atom[2].symbol, atom + 3, count - 3, error))
        return himc_error_prefix(error, "%s", word);
    const himc_command_row *row = himc_command_table((int)out->command.id);
    return (row->marks & HIMC_AT_BEAT) ||
           himc_error_set(
               error,
               "at: %s, expected a command that changes a drumhead: tune, gliss, tension, damp, muffle, decay, "
               "glide",
               row->name);
}

/// True if the line is for a drum: its second word is a drum's command, perhaps a misspelt one, or
/// its first is a drum's name, which may also be a drum's command, as kettle.
static bool is_for_drum(const reader *r, const himc_atom *atom)
{
    const himc_command_row *row;
    himc_nearest nearest = {.word = atom[1].symbol};
    for (int i = 0; (row = himc_command_table(i)); i++)
        if (row->receiver == HIMC_DRUM)
            himc_nearest_try(&nearest, row->name);
    return nearest.name || is_known_drum(r->score, atom[0].symbol) ||
           (himc_command_find(HIMC_DRUM, atom[0].symbol) &&
            himc_command_find(HIMC_PERFORMER, atom[1].symbol));
}

static bool read_all(reader *r, const char *text);

// what stands in a set-up, as if it stood here
static bool add_setup(reader *r, const himc_command *setup)
{
    const size_t most = 1 << 20; // (bytes) chosen: more than all instruments with all settings
    bool own = setup->form == 0;
    const himc_setup *of = own ? &himc_setups[setup->choice[0]] : NULL;
    char name[HIMC_PATH_SIZE];
    himc_format(name, sizeof name, "%s", own ? of->name : setup->atom[0].symbol);
    himc_score *score = r->score;
    int line = r->now.line, from = score->line_count, strokes = score->stroke_count,
        changes = score->change_count, tempi = score->tempo_count;
    char *text = own ? NULL : himc_file_load_in(r->folder, name, most, &(size_t){0}, r->error);
    if (!own && !text)
        return himc_error_prefix(r->error, "setup");
    r->setup = true;
    bool good = read_all(r, own ? of->text : text);
    if (good && (score->stroke_count > strokes || score->change_count > changes ||
                 score->tempo_count > tempi))
        good = himc_error_set(r->error, "a stroke, a tempo or `at`, expected instruments");
    if (!good)
        himc_error_prefix(r->error, "setup: %s:%d", name, r->now.line);
    free(text);
    r->setup = false;
    r->now.line = line;
    for (; from < score->line_count; from++)
        score->lines[from].line = line;
    return good;
}

// "comment bars of 3/4 from beat 2", later than those before; any other comment is ignored
static bool read_comment(reader *r, const himc_atom *atom, int count)
{
    static const char *const words[] = {"comment", "bars", "of", "", "from", "beat"};
    himc_score *score = r->score;
    himc_bars b = {0};
    int length = 0;
    for (int i = 0; i < 6; i++)
        if (count != 7 || atom[i].kind != HIMC_ATOM_SYMBOL ||
            (words[i][0] && strcmp(atom[i].symbol, words[i]) != 0))
            return true;
    bool metre = sscanf(atom[3].symbol, "%3d/%2d%n", &b.beats, &b.unit, &length) == 2 &&
                 !atom[3].symbol[length] && b.beats > 0 && b.beats < 256 && b.unit > 0 &&
                 b.unit <= 64 && (b.unit & (b.unit - 1)) == 0;
    b.beat = atom[6].kind == HIMC_ATOM_NUMBER ? atom[6].number : -1;
    if (!metre || b.beat < 0 || b.beat > himc_argument_find("BEAT", NULL)->high ||
        (score->bar_count > 0 && b.beat <= score->bars[score->bar_count - 1].beat))
        return true;
    if (!himc_array_grow(&score->bars, score->bar_count, &r->bar_room, sizeof b, r->error))
        return false;
    score->bars[score->bar_count++] = b;
    return true;
}

static bool read_statement(reader *r, const himc_text_statement *s)
{
    int count = s->count < s->capacity ? s->count : s->capacity;
    const himc_atom *atom = s->atom;
    const char *word = count > 0 ? atom[0].symbol : "comment"; // an empty one
    himc_command *c = &r->now.command;
    if (strcmp(word, "comment") == 0)
        return read_comment(r, atom, count);
    if (s->overflow)
        return himc_error_set(r->error,
                              "more than %zu characters without a ;, expected a score, commands "
                              "that each end with one",
                              s->size);
    if (strcmp(word, "at") == 0) { // "at 12 kettle tune 110", "at 12 push ..."
        himc_command at;
        return himc_command_parse(&at, HIMC_PERFORMER, "at", atom + 1, count - 1, r->error) &&
               himc_score_read_change(at.atom, at.count, &r->now, r->error) && add_line(r, true);
    }
    bool two_words = count > 1 && !himc_command_find(HIMC_PERFORMER, word);
    if (two_words && is_for_drum(r, atom)) { // "kettle tune 110"
        if (!himc_argument_accepts(himc_argument_find("NAME", "drum"), &atom[0]))
            return himc_error_set(r->error, "%.40s: not a drum's name", word);
        if (!himc_command_parse(c, HIMC_DRUM, atom[1].symbol, atom + 2, count - 2, r->error) ||
            !may_stand(c, r->error))
            return is_known_drum(r->score, word) ? himc_error_prefix(r->error, "%s", word)
                                                 : himc_command_doubt_drum(word, r->error);
        himc_format(r->now.drum, sizeof r->now.drum, "%s", word);
        return add_line(r, false);
    }
    if (!himc_command_parse(c, HIMC_PERFORMER, word, atom + 1, count - 1, r->error) ||
        !may_stand(c, r->error))
        return false;
    switch (c->id) {
    case HIMC_COMMAND_STROKE:
    case HIMC_COMMAND_ROLL:
    case HIMC_COMMAND_FLAM:
    case HIMC_COMMAND_DRAG:
    case HIMC_COMMAND_RUFF: return add_stroke(r);
    case HIMC_COMMAND_CRESC: return himc_dynamics_add(&r->dynamics, c, r->error);
    case HIMC_COMMAND_TEMPO: return add_tempo(r);
    case HIMC_COMMAND_SETUP:
        if (r->setup)
            return himc_error_set(r->error, "setup: one in another, expected instruments");
        if (r->setup_line > 0)
            return himc_error_set(r->error,
                                  "setup: a second one, the first is in line %d; "
                                  "expected one, and `instrument` for others",
                                  r->setup_line);
        r->setup_line = r->now.line;
        return add_setup(r, c);
    default: return add_line(r, false);
    }
}

// What is wrong with a refused statement is that it has no end, if a line inside it begins with a
// command's or a drum's name. Returns false.
static bool suggest_end(reader *r, const char *begin, const char *end)
{
    char word[HIMC_NAME_SIZE];
    char line[HIMC_PATH_SIZE];
    begin += strspn(begin, " \t\r\n");
    himc_format(line, sizeof line, "%.*s", (int)strcspn(begin, "\r\n"), begin);
    for (const char *at = begin; at < end;) {
        at += strcspn(at, "\n");
        at += strspn(at, " \t\r\n");
        size_t length = strcspn(at, " \t\r\n;");
        if (at >= end || length == 0 || length >= sizeof word)
            continue;
        memcpy(word, at, length);
        word[length] = '\0';
        if (himc_command_find(HIMC_PERFORMER, word) || is_known_drum(r->score, word))
            return himc_error_set(r->error, "%.60s: a ; is missing, before \"%s\"", line, word);
    }
    return false;
}

/// A line of the score's report: the command `at` that line stands inside a comment.
static bool add_report(reader *r, int line, const char *at)
{
    himc_score *score = r->score;
    himc_error said;
    himc_error_set(&said,
                   "%s:%d: \"%.*s\" is left out: no ; ends the comment before it, in line %d",
                   r->name, line, (int)strcspn(at, ";\r\n"), at, r->now.line);
    size_t used = score->report ? strlen(score->report) : 0, room = used + strlen(said.text) + 2;
    char *report = realloc(score->report, room);
    if (!report)
        return himc_error_set(r->error, "out of memory for %zu bytes", room);
    himc_format(report + used, room - used, "%s\n", said.text);
    score->report = report;
    score->left_out++;
    return true;
}

/// A comment lasts up to its `;`. Without one it takes the next command with it: that is reported.
/// `begin` .. `end` is the comment with its `;`.
static bool report_swallowed(reader *r, const char *begin, const char *end)
{
    char text[HIMC_PATH_SIZE];
    himc_command command;
    int line = r->now.line;
    begin += strspn(begin, " \t\r\n");
    for (const char *at = begin; at < end;) {
        size_t length = (size_t)(end - at);
        if (at != begin && length < sizeof text) {
            memcpy(text, at, length);
            text[length] = '\0';
            if (himc_command_parse_text(&command, HIMC_PERFORMER, text, NULL))
                return add_report(r, line, at);
        }
        for (at += strcspn(at, "\n"); at < end && isspace((unsigned char)*at); at++)
            line += *at == '\n';
    }
    return true;
}

static bool read_all(reader *r, const char *text)
{
    himc_atom atoms[HIMC_COMMAND_ATOMS + 4];
    char storage[HIMC_PATH_SIZE + 256];
    himc_text_statement s = {.atom = atoms,
                             .capacity = HIMC_COMMAND_ATOMS + 4,
                             .storage = storage,
                             .size = sizeof storage};
    int line = 1;
    if (strncmp(text, BYTE_ORDER_MARK, strlen(BYTE_ORDER_MARK)) == 0)
        text += strlen(BYTE_ORDER_MARK);
    for (const char *begin = text; himc_text_next(&text, &line, &s); begin = text) {
        r->now.line = s.line;
        r->now.drum[0] = '\0';
        r->now.beat = 0;
        const char *word = s.count > 0 ? s.atom[0].symbol : "";
        if (word[0] == '#' || strncmp(word, "//", 2) == 0) // of other languages
            return himc_error_set(r->error, "%.20s: a comment is written comment ...;", word);
        if (!read_statement(r, &s))
            return suggest_end(r, begin, text);
        if (strcmp(word, "comment") == 0 && !report_swallowed(r, begin, text))
            return false;
    }
    return true;
}

/// A stroke or a change with its place in the file.
typedef struct sort_key {
    bool change;
    double beat;
    int at; ///< of score->order
} sort_key;

static int by_beat(const void *a, const void *b)
{
    const sort_key *p = a, *q = b;
    if (p->change != q->change)
        return p->change ? 1 : -1;
    if (p->beat != q->beat)
        return p->beat < q->beat ? -1 : 1;
    return p->at - q->at;
}

/// Strokes and changes may stand in any order; those of one beat stay as they stand.
static bool sort_by_beat(reader *r)
{
    himc_score *score = r->score, old = *score;
    int strokes = old.stroke_count, all = strokes + old.change_count;
    sort_key *key = malloc((size_t)(all + 1) * sizeof *key);
    score->strokes = malloc((size_t)(strokes + 1) * sizeof *score->strokes);
    score->stroke_lines = malloc((size_t)(strokes + 1) * sizeof *score->stroke_lines);
    score->changes = malloc((size_t)(all - strokes + 1) * sizeof *score->changes);
    bool good = key && score->strokes && score->stroke_lines && score->changes;
    for (int at = 0; good && at < all; at++) {
        int i = old.order[at];
        key[at] = (sort_key){i < 0, i < 0 ? old.changes[-1 - i].beat : old.strokes[i].beat, at};
    }
    if (good)
        qsort(key, (size_t)all, sizeof *key, by_beat);
    for (int k = 0; good && k < all; k++) {
        int *order = &score->order[key[k].at], i = *order;
        if (i < 0) {
            copy_line(&score->changes[k - strokes], &old.changes[-1 - i]);
            *order = -1 - (k - strokes);
        } else {
            score->strokes[k] = old.strokes[i];
            himc_dynamics_give(&r->dynamics, &score->strokes[k]);
            score->stroke_lines[k] = old.stroke_lines[i];
            *order = k;
        }
    }
    free(key), free(old.strokes), free(old.stroke_lines), free(old.changes);
    return good || himc_error_set(r->error, "out of memory for %d lines", all);
}

bool himc_score_accepts_roll(const himc_tempo_change *tempi, int count, const himc_stroke *roll,
                             himc_error *error)
{
    double seconds = himc_score_seconds(tempi, count, roll->beat + roll->length) -
                     himc_score_seconds(tempi, count, roll->beat);
    return seconds <= LONGEST_ROLL ||
           himc_error_set(error, "roll: LENGTH: %.4g s at this tempo, expected %g s", seconds,
                          LONGEST_ROLL);
}

/// One hand cannot strike twice at once.
static bool check_playable(reader *r)
{
    const himc_score *score = r->score;
    double last[HIMC_HANDS] = {-1, -1};
    double base = 0;
    int tempo = 0;
    for (int i = 0; i < score->stroke_count; i++) {
        const himc_stroke *stroke = &score->strokes[i];
        for (; tempo + 1 < score->tempo_count && score->tempi[tempo + 1].beat <= stroke->beat;
             tempo++)
            base += (score->tempi[tempo + 1].beat - score->tempi[tempo].beat) * 60 /
                    score->tempi[tempo].bpm;
        double seconds =
            base + (stroke->beat - score->tempi[tempo].beat) * 60 / score->tempi[tempo].bpm;
        r->now.line = score->stroke_lines[i];
        if (stroke->ornament >= HIMC_ROLL_SINGLE) {
            // it leaves out what does not fit (ornament.h)
            if (!himc_score_accepts_roll(score->tempi, score->tempo_count, stroke, r->error))
                return false;
            continue;
        }
        if (stroke->hand == HIMC_FOOT)
            continue;
        if (seconds - last[stroke->hand] < HIMC_CLOSEST_STROKES)
            return himc_error_set(
                r->error,
                "stroke: BEAT: %g is %.3g s after the last stroke of the %s hand, expected %g s "
                "or more",
                stroke->beat, seconds - last[stroke->hand], himc_hand_name(stroke->hand),
                HIMC_CLOSEST_STROKES);
        last[stroke->hand] = seconds;
    }
    return true;
}

static himc_score *read_score(reader *r, const char *text, const himc_command *setup)
{
    r->score = calloc(1, sizeof *r->score);
    bool good = r->score && himc_array_grow(&r->score->tempi, 0, &r->tempo_room,
                                            sizeof *r->score->tempi, r->error);
    if (!good) {
        free(r->score);
        himc_error_set(r->error, "%s: out of memory", r->name);
        return NULL;
    }
    r->score->tempi[r->score->tempo_count++] = (himc_tempo_change){0, HIMC_TEMPO};
    good = setup ? add_setup(r, setup)
                 : (read_all(r, text) && sort_by_beat(r) && check_playable(r)) ||
                       himc_error_prefix(r->error, "%s:%d", r->name, r->now.line);
    free(r->dynamics.cresc);
    if (good)
        return r->score;
    himc_score_free(r->score);
    return NULL;
}

himc_score *himc_score_parse(const char *text, const char *name, const char *folder,
                             himc_error *error)
{
    reader r = {.name = name, .folder = folder, .error = error};
    return read_score(&r, text, NULL);
}

himc_score *himc_score_of_setup(const himc_command *setup, himc_error *error)
{
    reader r = {.name = "setup", .folder = setup->folder, .error = error};
    return read_score(&r, NULL, setup);
}

void himc_score_free(himc_score *score)
{
    if (!score)
        return;
    free(score->strokes);
    free(score->stroke_lines);
    free(score->tempi);
    free(score->lines);
    free(score->changes);
    free(score->order);
    free(score->report);
    free(score->bars);
    free(score);
}

double himc_score_seconds(const himc_tempo_change *tempi, int count, double beat)
{
    double seconds = 0, from = 0;
    for (; count > 1 && tempi[1].beat < beat; tempi++, count--) {
        seconds += (tempi[1].beat - from) * 60 / tempi[0].bpm;
        from = tempi[1].beat;
    }
    return seconds + (beat - from) * 60 / tempi[0].bpm;
}

double himc_score_beat(const himc_tempo_change *tempi, int count, double seconds)
{
    double from = 0;
    for (; count > 1; tempi++, count--) {
        double span = (tempi[1].beat - from) * 60 / tempi[0].bpm;
        if (seconds < span)
            break;
        seconds -= span;
        from = tempi[1].beat;
    }
    return from + seconds * tempi[0].bpm / 60;
}
