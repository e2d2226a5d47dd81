/// take_units.c: how long is the file's unit? What the user or the file says, checked against the
/// size of people.
///
/// A BVH never says. Its skeleton does: the longest way through the bones (toe to head, or hand to
/// hand) of a grown player, sticks included, is 1.2 to 3.2 m. The first unit that makes it so is
/// taken, of m, cm, mm and CMU's 1/0.45 inch, which do not overlap, then, for bodies with legs,
/// inches and feet; a skeleton without legs may be 0.3 m, but then only in m, cm or mm.
///
/// Marker files do say, not always rightly: points that lie more than 8 m apart within one frame,
/// or stay all in all within 2 cm, are read again in the one metric unit that makes them 0.2 .. 4 m
/// and leaves them within 100 m of the origin, and a note says so. If none does, what is small is
/// taken at the file's word, and what is large is refused.
#include "capture/take_data.h"
#include "capture/take_text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    const char *name;
    double metres;
} units[] = {{"m", 1},
             {"cm", 0.01},
             {"mm", 0.001},
             {"CMU units of 0.056444 m", 0.0254 / 0.45},
             {"inches", 0.0254},
             {"feet", 0.3048},
             {"meters", 1},
             {"centimeters", 0.01},
             {"millimeters", 0.001},
             {"metres", 1},
             {"centimetres", 0.01},
             {"millimetres", 0.001},
             {"meter", 1},
             {"in", 0.0254},
             {"ft", 0.3048},
             {"um", 1e-6}};
#define UNITS ((int)(sizeof units / sizeof units[0]))
#define METRIC 3 // the first three: m, cm, mm
#define GUESSED 6

double himc_take_unit(const char *name)
{
    for (int i = 0; i < UNITS; i++)
        if (himc_span_is((himc_span){name, strlen(name)}, units[i].name))
            return units[i].metres;
    return 0;
}

static double distance(himc_vec3 a, himc_vec3 b)
{
    return himc_vec3_length(himc_vec3_sub(a, b));
}

// the longest way along the bones between any two nodes (file units); -1 without memory
static double skeleton_size(const himc_take *take)
{
    double *deepest = calloc((size_t)take->points, sizeof *deepest), size = 0;
    if (!deepest)
        return -1;
    // children come after parents, so backwards every branch is complete before it joins
    for (int i = take->points - 1; i > 0; i--) {
        int parent = take->parents[i];
        if (parent < 0)
            continue;
        double down = deepest[i] + himc_vec3_length(take->offsets[i]);
        size = fmax(size, deepest[parent] + down);
        deepest[parent] = fmax(deepest[parent], down);
    }
    free(deepest);
    return size;
}

static double guess_unit(double size, double least, double most, int candidates)
{
    for (int i = 0; i < candidates; i++)
        if (size * units[i].metres >= least && size * units[i].metres <= most)
            return units[i].metres;
    return 0;
}

typedef struct box {
    himc_vec3 low, high;
} box;

static box box_empty(void)
{
    return (box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

static void box_add(box *b, himc_vec3 x)
{
    if (!himc_vec3_finite(x))
        return;
    b->low = himc_vec3_make(fmin(b->low.x, x.x), fmin(b->low.y, x.y), fmin(b->low.z, x.z));
    b->high = himc_vec3_make(fmax(b->high.x, x.x), fmax(b->high.y, x.y), fmax(b->high.z, x.z));
}

static double box_size(const box *b)
{
    return b->high.x >= b->low.x ? distance(b->high, b->low) : 0;
}

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

// file units
typedef struct sizes {
    double typical; // how far points are apart in a typical frame (median)
    double all;     // the box of all frames
    double far;     // the largest coordinate
} sizes;

static sizes marker_sizes(const himc_take *take)
{
    double spread[201];
    int count = 0, step = take->frames / 200 + 1;
    box whole = box_empty();
    for (int frame = 0; frame < take->frames; frame += step) {
        box one = box_empty();
        for (int i = 0; i < take->points; i++) {
            box_add(&one, *himc_take_at(take, frame, i));
            box_add(&whole, *himc_take_at(take, frame, i));
        }
        spread[count++] = box_size(&one);
    }
    qsort(spread, (size_t)count, sizeof spread[0], compare);
    double low = fmax(-whole.low.x, fmax(-whole.low.y, -whole.low.z));
    double high = fmax(whole.high.x, fmax(whole.high.y, whole.high.z));
    return (sizes){spread[count / 2], box_size(&whole), fmax(low, high)};
}

static const char *unit_name(double metres, char text[32])
{
    for (int i = 0; i < UNITS; i++)
        if (units[i].metres == metres)
            return units[i].name;
    snprintf(text, 32, "units of %g m", metres);
    return text;
}

static bool has_legs(const himc_take *take)
{
    static const char *const words[] = {"foot", "toe", "base", "end",   "ankle", "knee",
                                        "leg",  "up",  "low",  "lower", NULL};
    char plain[TAKE_NAME], rest[TAKE_NAME];
    for (int i = 0; i < take->points; i++) {
        himc_take_plain_name(take->names[i], plain);
        int side = himc_take_side(plain, words, rest);
        if (side >= 0 && strcmp(rest, "end") != 0 && strcmp(rest, "base") != 0)
            return true;
    }
    return false;
}

static bool settle_skeleton(himc_take *take, double *unit, himc_error *error)
{
    double size = skeleton_size(take);
    if (size < 0)
        return himc_error_set(error, "%s: no memory", take->file);
    bool legs = has_legs(take);
    *unit = guess_unit(size, 1.2, 3.2, legs ? GUESSED : GUESSED - 2);
    if (*unit == 0 && !legs)
        *unit = guess_unit(size, 0.3, 3.2, METRIC);
    char text[32];
    if (*unit == 0)
        return himc_error_set(
            error,
            "%s: skeleton: %.4g units through its bones is no player's size in m, cm, mm, CMU "
            "units, inches or feet, allowed %s .. 3.2 m",
            take->file, size, legs ? "1.2" : "0.3");
    snprintf(take->units_text, sizeof take->units_text,
             "%s, guessed from %.4g units through the skeleton's bones", unit_name(*unit, text),
             size);
    return true;
}

// the metric unit that makes points lie 0.2 .. 4 m apart and within 100 m of the origin; 0 if none
static double guess_marker_unit(const sizes *s)
{
    double unit = guess_unit(s->typical > 0.05 * s->all ? s->typical : s->all, 0.2, 4, METRIC);
    return s->far * unit <= 100 ? unit : 0;
}

static bool settle_markers(himc_take *take, double *unit, himc_error *error)
{
    sizes s = marker_sizes(take);
    double said = take->file_unit, in = said > 0 ? said : 1;
    bool small = s.all * said < 0.02 && s.all > 0 && take->frames > 1;
    bool fits = said > 0 && s.typical * said <= 8 && !small;
    char text[32], other[32];
    *unit = fits ? said : guess_marker_unit(&s);
    // one marker may hardly move, so what is small but no other unit's is taken at the file's word
    if (*unit == 0 && said > 0 && small) {
        *unit = said;
        fits = true;
    }
    if (*unit == 0)
        return himc_error_set(error,
                              "%s: points lie %.4g m apart in %s and no metric unit makes that "
                              "0.2 .. 4 m: is this a player?",
                              take->file, fmax(s.typical, small ? s.all : 0) * in,
                              unit_name(in, text));
    snprintf(take->units_text, sizeof take->units_text, "%s, %s", unit_name(*unit, text),
             fits ? "as the file says" : "guessed from the distances of the points");
    if (said > 0 && !fits)
        himc_take_note(take, "units: read as %s, for in %s the points lie %.4g m apart",
                       unit_name(*unit, text), unit_name(said, other), s.typical * said);
    return true;
}

static void scale(himc_take *take, double unit)
{
    size_t all = (size_t)take->frames * (size_t)take->points;
    for (size_t i = 0; i < all; i++)
        take->x[i] = himc_vec3_scale(take->x[i], unit);
    for (int i = 0; i < take->points && take->offsets; i++)
        take->offsets[i] = himc_vec3_scale(take->offsets[i], unit);
}

bool himc_take_settle_units(himc_take *take, const himc_take_options *options, himc_error *error)
{
    double unit = options->unit;
    char text[32];
    if (unit > 0)
        snprintf(take->units_text, sizeof take->units_text, "%s, as asked for",
                 unit_name(unit, text));
    else if (!(take->parents ? settle_skeleton(take, &unit, error)
                             : settle_markers(take, &unit, error)))
        return false;
    scale(take, unit);
    return true;
}
