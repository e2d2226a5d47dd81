/// list.c: an instrument as a list of modes, from a text file or from those of lists.c.
///
/// One item a line, `#` begins a comment:
///     pitch HZ                 what `tune` is told; the lowest mode's if it is not here
///     mallet K ALPHA MASS      that suits (N/m^alpha, 1, kg)
///     surface NAME disc R      a part that is struck; what follows is its own
///     surface NAME bar L W     L away from the performer (m)
///     place X Y                its centre beside the other parts' (m)
///     pressure P               of the modes that follow, at 1 m per acceleration (Pa s^2/m)
///     mode HZ T60 MASS W ...   shape values W from end to end of a bar, from centre to edge of a
///                              disc, and the mass where the shape is 1
#include "head/idiophone.h"
#include "head/lists.h"

#include "base/file.h"
#include "base/text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LONGEST 1000000 // (bytes) of a file; chosen: all modes with all their values
#define WORDS 72        // of a line ...
#define VALUES 64       // ... of which shape values; chosen: a point each 2 mm of a claves' clave
#define LINE 1000       // (characters)

typedef struct reader {
    himc_idiophone *body;
    double pressure; // of the coming modes; 0: none yet
    char *word[WORDS];
    int words;
    himc_error *error;
} reader;

static bool number(const reader *r, int index, const char *name, double low, double high,
                   const char *unit, double *out)
{
    char *end;
    if (index >= r->words)
        return himc_error_set(r->error, "%s: %s missing", r->word[0], name);
    *out = strtod(r->word[index], &end);
    if (*end || end == r->word[index] || !isfinite(*out))
        return himc_error_set(r->error, "%s: %s: %.40s, expected a number", r->word[0], name,
                              r->word[index]);
    return himc_check_range(name, *out, low, high, unit, r->error) ||
           himc_error_prefix(r->error, "%s", r->word[0]);
}

static bool at_end(const reader *r, int words)
{
    return r->words <= words ||
           himc_error_set(r->error, "%s: %.40s is one word too many", r->word[0], r->word[words]);
}

static bool read_surface(reader *r)
{
    himc_part part = {.name = ""};
    const char *kind = r->words > 2 ? r->word[2] : "";
    bool disc = strcmp(kind, "disc") == 0;
    if (!disc && strcmp(kind, "bar") != 0)
        return himc_error_set(r->error, "surface: %.40s, expected NAME disc R, or NAME bar L W",
                              kind[0] ? kind : "two words missing");
    if (strlen(r->word[1]) >= sizeof part.name)
        return himc_error_set(r->error, "surface: name %.40s, expected up to %zu characters",
                              r->word[1], sizeof part.name - 1);
    for (int i = 0; i < r->body->parts; i++)
        if (strcmp(r->body->part[i].name, r->word[1]) == 0)
            return himc_error_set(r->error, "surface: %s: named twice", r->word[1]);
    snprintf(part.name, sizeof part.name, "%s", r->word[1]);
    if (r->body->parts > 0 && r->body->part[r->body->parts - 1].length == 0)
        return himc_error_set(r->error, "surface: one more beside a disc, expected bars");
    r->pressure = 0;
    if (disc && r->body->parts > 0)
        return himc_error_set(r->error, "surface: a disc beside others, expected it alone");
    if (!disc)
        return number(r, 3, "L", 0.01, 1.4, "m", &part.length) &&
               number(r, 4, "W", 0.01, 1.4, "m", &part.width) && at_end(r, 5) &&
               himc_idiophone_add_part(r->body, &part, r->error);
    if (!number(r, 3, "R", HIMC_RADIUS_MIN, HIMC_RADIUS_MAX, "m", &part.width))
        return false;
    part.width *= 2;
    return at_end(r, 4) && himc_idiophone_add_part(r->body, &part, r->error);
}

static bool read_place(const reader *r)
{
    himc_part *part = &r->body->part[r->body->parts - 1];
    return number(r, 1, "X", -1, 1, "m", &part->x) && number(r, 2, "Y", -1, 1, "m", &part->y) &&
           at_end(r, 3);
}

static bool read_mode(const reader *r)
{
    himc_partial mode = {.pressure = r->pressure};
    double t60, shape[VALUES];
    int points = r->words - 4;
    if (!(r->pressure > 0))
        return himc_error_set(r->error, "mode: no pressure yet, expected `pressure P` before it");
    if (!number(r, 1, "HZ", 1, 20000, "Hz", &mode.frequency) ||
        !number(r, 2, "T60", 0.001, 1000, "s", &t60) ||
        !number(r, 3, "MASS", 1e-6, 1000, "kg", &mode.mass) ||
        !number(r, 4, "W", -1000, 1000, "", &shape[0]))
        return false;
    if (points > VALUES)
        return himc_error_set(r->error, "mode: %d shape values, expected up to %d", points, VALUES);
    for (int i = 0; i < points; i++)
        if (!number(r, 4 + i, "W", -1000, 1000, "", &shape[i]))
            return false;
    mode.loss = log(1000) / t60;
    return himc_idiophone_add_mode(r->body, mode, shape, points, r->error);
}

static bool read_item(reader *r)
{
    const char *key = r->word[0];
    himc_mallet_head *mallet = &r->body->mallet;
    if (strcmp(key, "pitch") == 0)
        return number(r, 1, "HZ", 1, 20000, "Hz", &r->body->principal) && at_end(r, 2);
    if (strcmp(key, "mallet") == 0)
        return number(r, 1, "K", 1e3, 1e13, "N/m^alpha", &mallet->stiffness) &&
               number(r, 2, "ALPHA", 1, 4, "", &mallet->exponent) &&
               number(r, 3, "MASS", 0.001, 1, "kg", &mallet->mass) && at_end(r, 4);
    if (strcmp(key, "surface") == 0)
        return read_surface(r);
    if (strcmp(key, "place") != 0 && strcmp(key, "pressure") != 0 && strcmp(key, "mode") != 0)
        return himc_error_set(
            r->error, "%.40s: unknown, expected pitch mallet surface place pressure mode", key);
    if (r->body->parts == 0)
        return himc_error_set(r->error, "%s: no surface yet, expected `surface NAME ...` before it",
                              key);
    if (strcmp(key, "place") == 0)
        return read_place(r);
    if (strcmp(key, "pressure") == 0)
        return number(r, 1, "P", 1e-12, 1, "Pa s^2/m", &r->pressure) && at_end(r, 2);
    return read_mode(r);
}

// the words of a line, in its place
static bool cut_words(reader *r, char *line)
{
    line[strcspn(line, "#")] = '\0';
    for (r->words = 0; *(line += strspn(line, " \t\r")); r->words++) {
        if (r->words == WORDS)
            return himc_error_set(r->error, "%.40s: too many words", r->word[0]);
        r->word[r->words] = line;
        line += strcspn(line, " \t\r");
        if (*line)
            *line++ = '\0';
    }
    return true;
}

static bool read_text(reader *r, const char *text, const char *name)
{
    char line[LINE];
    for (int at = 1; *text; at++) {
        size_t length = strcspn(text, "\n");
        bool fits = length < sizeof line;
        snprintf(line, sizeof line, "%.*s", fits ? (int)length : 0, text);
        text += length + (text[length] == '\n');
        if ((!fits && !himc_error_set(r->error, "a line of %zu characters, expected up to %d",
                                      length, LINE - 1)) ||
            !cut_words(r, line) || (r->words > 0 && !read_item(r)))
            return himc_error_prefix(r->error, "%s:%d", name, at);
    }
    for (int i = 0; i < r->body->parts; i++) {
        bool sounds = false;
        for (int k = 0; k < r->body->modes; k++)
            sounds = sounds || r->body->mode[k].part == i;
        if (!sounds)
            return himc_error_set(r->error, "%s: surface %s: no mode", name, r->body->part[i].name);
    }
    return r->body->parts > 0 || himc_error_set(r->error, "%s: no surface", name);
}

// of an instrument whose list names none: rubber; chosen
static const himc_mallet_head usual = {.stiffness = 1e8, .exponent = 2, .mass = 0.03};

static himc_idiophone *read_list(const char *text, const char *name, himc_error *error)
{
    himc_idiophone *body = himc_idiophone_new(name, error);
    reader r = {.body = body, .error = error};
    if (!body)
        return NULL;
    body->mallet = usual;
    if (read_text(&r, text, name)) {
        himc_idiophone_finish(body);
        return body;
    }
    himc_shape_release(&(himc_shape){.body = body});
    return NULL;
}

himc_idiophone *himc_list_load(const char *path, himc_error *error)
{
    size_t size;
    char *text = himc_file_load(path, LONGEST, &size, error);
    himc_idiophone *body = NULL;
    if (text && himc_text_check(text, size, path, error))
        body = read_list(text, path, error);
    free(text);
    return body;
}

static bool read_file(const himc_command *command, himc_shape *shape, himc_error *error)
{
    shape->body = himc_list_load(command->atom[1].symbol, error);
    return shape->body || himc_error_prefix(error, "shape");
}

static bool read_own(const himc_command *command, himc_shape *shape, himc_error *error)
{
    const himc_listed *own = &himc_lists[command->choice[1]];
    shape->body = read_list(own->text, own->name, error);
    return shape->body;
}

const himc_kind himc_kind_list = {.name = "modes", .read = read_file, HIMC_IDIOPHONE_KIND};
const himc_kind himc_kind_listed = {.name = "listed", .read = read_own, HIMC_IDIOPHONE_KIND};
