/// take_frame.c: from the file's unit and axes to the library's: metres, x forward, y left, z up.
///
/// Unit. The user's or the file's unit is checked against the size of people. A BVH never states a
/// unit, but has a skeleton: the longest path along the bones (toe to head, or hand to hand) of an
/// adult player, sticks included, is 1.2 to 3.2 m. The first unit that makes it so is taken, of m,
/// cm, mm and CMU's 1/0.45 inch, which do not overlap, then, for bodies with legs, inches and feet;
/// a skeleton without legs may be 0.3 m long, but then only in m, cm or mm. Marker files do state a
/// unit, not always the right one: points that lie more than 8 m apart within one frame, or stay
/// within 2 cm over the whole take, are read again in the one metric unit that makes the distance
/// 0.2 .. 4 m and leaves them within 100 m of the origin, and a note says so. If no unit does,
/// small sizes are accepted as the file states them, and large ones are refused.
///
/// Axes. With the file's up axis u and its axis f that goes forward (to the right of the screen if
/// the file states it, else x, or y if x is up), the rows of the rotation are f, u x f, u: y up
/// becomes (x, -z, y). A rotation about z then brings the body's left side to +y: by any angle if
/// hips, else shoulders or the like, are named in pairs; by quarter turns if only the tips show it
/// (players do not strike exactly along their room's axes, but their hands are not exactly abreast
/// either). A skeleton's joint frames get a rest rotation of their own, found from the bones in the
/// zero pose, so that the zero pose looks along x in whichever direction the player faced: with A
/// for the points and B for the zero pose, a root's rotation becomes A R B^T, that of other joints
/// B R B^T, and offsets become B o; forward kinematics then gives A times the points.
#include "base/order.h"
#include "capture/take.h"
#include "capture/take_text.h"

#include <stdlib.h>
#include <string.h>

// The unit of length.

#define SAMPLED 200 // chosen: about so many frames, spread over the take, are looked at

static int sample_step(const himc_take *take)
{
    return take->frames / SAMPLED + 1;
}

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
#define METRIC 3       // the first three: m, cm, mm
#define GUESSED 6      // the first six are tried for skeletons with legs ...
#define GUESSED_ARMS 4 // ... and the first four for those without

// sizes of a player; chosen: 1.2 m is a child's height, 3.2 m a tall player's span with sticks (m)
#define LEAST_SKELETON 1.2
#define LEAST_ARMS 0.3 // chosen: one forearm with a stick
#define MOST_SKELETON 3.2
// sizes of markers (m)
#define LEAST_SPREAD 0.2 // chosen: one forearm's markers ...
#define MOST_SPREAD 4.0  // ... to a player and a drum

double himc_take_unit(const char *name)
{
    for (int i = 0; i < UNITS; i++)
        if (himc_span_is((himc_span){name, strlen(name)}, units[i].name))
            return units[i].metres;
    return 0;
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
    return b->high.x >= b->low.x ? himc_vec3_length(himc_vec3_sub(b->high, b->low)) : 0;
}

static int named(const himc_take *take, int point, const char *const *words, char rest[TAKE_NAME])
{
    char plain[TAKE_NAME];
    himc_take_plain_name(take->names[point], plain);
    return himc_take_side(plain, words, rest);
}

static const char *unit_name(double metres, char text[32])
{
    for (int i = 0; i < UNITS; i++)
        if (units[i].metres == metres)
            return units[i].name;
    snprintf(text, 32, "units of %g m", metres);
    return text;
}

static bool settle_skeleton(himc_take *take, double *unit, himc_error *error)
{
    static const char *const words[] = {"foot", "toe", "base", "end",   "ankle", "knee",
                                        "leg",  "up",  "low",  "lower", NULL};
    // the longest path along the bones between any two nodes (file units): children come after
    // parents, so backwards every branch is complete before it joins
    double *deepest = calloc((size_t)take->points, sizeof *deepest), size = 0;
    if (!deepest)
        return himc_error_set(error, "%s: no memory", take->file);
    for (int i = take->points - 1; i > 0; i--) {
        int parent = take->parents[i];
        if (parent < 0)
            continue;
        double down = deepest[i] + himc_vec3_length(take->offsets[i]);
        size = fmax(size, deepest[parent] + down);
        deepest[parent] = fmax(deepest[parent], down);
    }
    free(deepest);
    bool legs = false;
    for (int i = 0; i < take->points && !legs; i++) {
        char rest[TAKE_NAME];
        int side = named(take, i, words, rest);
        legs = side >= 0 && strcmp(rest, "end") != 0 && strcmp(rest, "base") != 0;
    }
    *unit = guess_unit(size, LEAST_SKELETON, MOST_SKELETON, legs ? GUESSED : GUESSED_ARMS);
    if (*unit == 0 && !legs)
        *unit = guess_unit(size, LEAST_ARMS, MOST_SKELETON, METRIC);
    char text[32];
    if (*unit == 0)
        return himc_error_set(
            error,
            "%s: skeleton: the longest path along its bones is %.4g units, in m, cm, mm, "
            "CMU units, inches or feet no player's size, expected %g .. %g m",
            take->file, size, legs ? LEAST_SKELETON : LEAST_ARMS, MOST_SKELETON);
    snprintf(take->units_text, sizeof take->units_text,
             "%s, guessed from the skeleton: %.4g units along its bones", unit_name(*unit, text),
             size);
    return true;
}

static bool settle_markers(himc_take *take, double *unit, himc_error *error)
{
    // diagonals of the box around the points: the median over the frames, and that of the whole
    // take; and the largest coordinate (file units)
    double spread[SAMPLED + 1];
    int count = 0;
    box whole = box_empty();
    for (int frame = 0; frame < take->frames; frame += sample_step(take)) {
        box one = box_empty();
        for (int i = 0; i < take->points; i++)
            box_add(&one, *himc_take_at(take, frame, i));
        box_add(&whole, one.low);
        box_add(&whole, one.high);
        spread[count++] = box_size(&one);
    }
    qsort(spread, (size_t)count, sizeof spread[0], himc_order_doubles);
    double typical = spread[count / 2], all = box_size(&whole);
    double far = fmax(fmax(-whole.low.x, fmax(-whole.low.y, -whole.low.z)),
                      fmax(whole.high.x, fmax(whole.high.y, whole.high.z)));
    double said = take->file_unit, in = said > 0 ? said : 1;
    // chosen: a tip that plays moves by more than 2 cm, players and drums are less than 8 m apart
    bool small = all * said < 0.02 && all > 0 && take->frames > 1;
    bool fits = said > 0 && typical * said <= 8 && !small;
    char text[32], other[32];
    *unit = said;
    if (!fits) {
        // the metric unit that makes the points a player's size, up to 100 m from a room's origin;
        // chosen: a spread below 5 % of the whole is that of one marker
        double size = typical > 0.05 * all ? typical : all;
        *unit = guess_unit(size, LEAST_SPREAD, MOST_SPREAD, METRIC);
        if (*unit == 0) // two tips over one drum are nearer to each other than a forearm is long
            *unit = guess_unit(all, LEAST_SPREAD, MOST_SPREAD, METRIC);
        *unit = far * *unit <= 100 ? *unit : 0;
    }
    // one marker may hardly move: a small size that no other unit explains is accepted
    if (*unit == 0 && said > 0 && small) {
        *unit = said;
        fits = true;
    }
    if (*unit == 0)
        return himc_error_set(error,
                              "%s: the points are %.4g m apart if the unit is %s, no metric unit "
                              "makes that a player's size, expected %g .. %g m",
                              take->file, fmax(typical, small ? all : 0) * in, unit_name(in, text),
                              LEAST_SPREAD, MOST_SPREAD);
    snprintf(take->units_text, sizeof take->units_text, "%s, %s", unit_name(*unit, text),
             fits ? "stated by the file" : "guessed from the distances between points");
    if (said > 0 && !fits)
        himc_take_note(take, "units: read as %s, because in %s the points are %.4g m apart",
                       unit_name(*unit, text), unit_name(said, other), typical * said);
    return true;
}

static bool settle_units(himc_take *take, const himc_take_options *options, himc_error *error)
{
    double unit = options->unit;
    char text[32];
    if (unit > 0)
        snprintf(take->units_text, sizeof take->units_text, "%s, set by the user",
                 unit_name(unit, text));
    else if (!(take->parents ? settle_skeleton(take, &unit, error)
                             : settle_markers(take, &unit, error)))
        return false;
    size_t all = (size_t)take->frames * (size_t)take->points;
    for (size_t i = 0; i < all; i++)
        take->x[i] = himc_vec3_scale(take->x[i], unit);
    for (int i = 0; i < take->points && take->offsets; i++)
        take->offsets[i] = himc_vec3_scale(take->offsets[i], unit);
    return true;
}

// The axes.

static const char *const side_words[] = {
    "shoulder", "sho", "collar", "clavicle", "clav", "acromion", "acr", "upper", "upleg", "leg",
    "thigh",    "hip", "joint",  "asis",     "asi",  "psis",     "psi", "arm",   NULL};
static const char *const hip_words[] = {"hip",  "joint", "upleg", "upperleg", "thigh",
                                        "asis", "asi",   "psis",  "psi",      NULL};
static const char *const high_words[] = {"shoulder", "sho",      "acromion", "acr",
                                         "collar",   "clavicle", "clav",     "head",
                                         "neck",     "c7",       "t1",       NULL};
static const char *const low_words[] = {"hips", "hip",  "joint", "pelvis", "asis", "asi",  "psis",
                                        "psi",  "knee", "ankle", "foot",   "toe",  "heel", NULL};
static const char *const shoulder_words[] = {"shoulder", "sho", "acromion", "acr", "joint", NULL};

#define MOST_PAIRS 16 // chosen: a body has fewer

// mean over the frames of b - a; false if they are never seen together
static bool mean_difference(const himc_take *take, int a, int b, himc_vec3 *mean)
{
    himc_vec3 sum = {0, 0, 0};
    int count = 0;
    for (int frame = 0; frame < take->frames; frame += sample_step(take)) {
        himc_vec3 d = himc_vec3_sub(*himc_take_at(take, frame, b), *himc_take_at(take, frame, a));
        if (!himc_vec3_finite(d))
            continue;
        sum = himc_vec3_add(sum, d);
        count++;
    }
    if (count)
        *mean = himc_vec3_scale(sum, 1.0 / count);
    return count > 0;
}

typedef struct pair {
    int left, right;
} pair;

// left and right points of the same name made of these words, at most `capacity`
static int find_pairs_of(const himc_take *take, const char *const *words, pair *pairs, int capacity)
{
    int count = 0;
    char left[TAKE_NAME], right[TAKE_NAME];
    for (int i = 0; i < take->points && count < capacity; i++) {
        if (named(take, i, words, left) != HIMC_LEFT)
            continue;
        for (int j = 0; j < take->points; j++)
            if (named(take, j, words, right) == HIMC_RIGHT && strcmp(left, right) == 0) {
                pairs[count++] = (pair){i, j};
                break;
            }
    }
    return count;
}

// pairs at the hips, because a player's shoulders turn towards the drum; else any
static int find_pairs(const himc_take *take, pair *pairs, int capacity)
{
    int count = find_pairs_of(take, hip_words, pairs, capacity);
    return count > 0 ? count : find_pairs_of(take, side_words, pairs, capacity);
}

static himc_vec3 find_up(himc_take *take, himc_up asked)
{
    if (asked != HIMC_UP_AUTO) {
        snprintf(take->axes_text, sizeof take->axes_text, "set by the user");
        return asked == HIMC_UP_Y ? himc_vec3_make(0, 1, 0) : himc_vec3_make(0, 0, 1);
    }
    if (himc_vec3_length(take->file_up) > 0) {
        snprintf(take->axes_text, sizeof take->axes_text, "stated by the file");
        return take->file_up;
    }
    // the axis along which heads are above hips; chosen: with 0.8 of the distance it is clear
    int high = -1, low = -1;
    char rest[TAKE_NAME];
    himc_vec3 d;
    for (int i = 0; i < take->points; i++) {
        if (high < 0 && named(take, i, high_words, rest) >= 0)
            high = i;
        if (low < 0 && named(take, i, low_words, rest) >= 0)
            low = i;
    }
    if (high >= 0 && low >= 0 && mean_difference(take, low, high, &d)) {
        double clear = 0.8 * himc_vec3_length(d);
        himc_vec3 up = {copysign(fabs(d.x) > clear, d.x), copysign(fabs(d.y) > clear, d.y),
                        copysign(fabs(d.z) > clear, d.z)};
        if (himc_vec3_length(up) == 1) {
            snprintf(take->axes_text, sizeof take->axes_text, "because %.40s is above %.40s",
                     take->names[high], take->names[low]);
            return up;
        }
    }
    snprintf(take->axes_text, sizeof take->axes_text, "as usual in %.4s files", take->format);
    return take->format_up;
}

// the upright axes, rotated about z so that a horizontal direction in them becomes +y
static himc_mat3 rotate_to_left(const himc_mat3 *upright, himc_vec3 d, bool quarters)
{
    double angle = HIMC_PI / 2 - atan2(d.y, d.x);
    if (quarters)
        angle = round(angle / (HIMC_PI / 2)) * (HIMC_PI / 2);
    double c = quarters ? round(cos(angle)) : cos(angle),
           s = quarters ? round(sin(angle)) : sin(angle);
    himc_mat3 rotation = {{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}};
    return himc_mat3_mul(&rotation, upright);
}

// chosen: a shorter vector from right to left has no direction
static bool is_long_enough(himc_vec3 d)
{
    return hypot(d.x, d.y) > 0.03;
}

// the upright axes, rotated so that the body's left side is +y, and how it is known
static himc_mat3 find_axes(const himc_take *take, const himc_take_options *options,
                           const himc_mat3 *upright, const char **heading)
{
    pair pairs[MOST_PAIRS];
    himc_vec3 sum = {0, 0, 0}, first = {0, 0, 0}, left, d = {0, 0, 0};
    double lengths = 0;
    int count = find_pairs(take, pairs, MOST_PAIRS);
    for (int frame = 0; frame < take->frames && count; frame += sample_step(take)) {
        himc_vec3 now = {0, 0, 0};
        for (int i = 0; i < count; i++) {
            d = himc_vec3_sub(*himc_take_at(take, frame, pairs[i].left),
                              *himc_take_at(take, frame, pairs[i].right));
            if (himc_vec3_finite(d))
                now = himc_vec3_add(now, himc_mat3_apply(upright, d));
        }
        first = is_long_enough(first) ? first : now;
        sum = himc_vec3_add(sum, now);
        lengths += hypot(now.x, now.y);
    }
    // the mean over the take, or at its start if the player turns round
    left = hypot(sum.x, sum.y) > 0.5 * lengths ? sum : first; // chosen
    *heading = "rotated so that the body faces along x";
    if (is_long_enough(left))
        return rotate_to_left(upright, left, false);
    // by the sticks: from the right tip to the left one, or a quarter turn from the arm's direction
    int l = himc_take_find_tip(take, HIMC_LEFT, options),
        r = himc_take_find_tip(take, HIMC_RIGHT, options), tip = l >= 0 ? l : r;
    char rest[TAKE_NAME];
    bool both = l >= 0 && r >= 0 && mean_difference(take, r, l, &d), found = both;
    for (int i = 0; i < take->points && tip >= 0 && !found; i++)
        found = named(take, i, shoulder_words, rest) >= 0 && mean_difference(take, i, tip, &d);
    d = himc_mat3_apply(upright, d);
    left = both ? d : himc_vec3_make(-d.y, d.x, 0);
    *heading = both ? "rotated so that the left tip is left of the right one"
                    : "rotated by quarter turns so that the tip is before the shoulder";
    if (found && is_long_enough(left))
        return rotate_to_left(upright, left, true);
    *heading = "heading as in the file";
    return *upright;
}

// rotates the points by `a`, and the skeleton's zero pose by what brings its left side, if it has
// one, to the left of the upright frame
static void rotate(himc_take *take, const himc_mat3 *upright, const himc_mat3 *a)
{
    size_t all = (size_t)take->frames * (size_t)take->points;
    for (size_t i = 0; i < all; i++)
        take->x[i] = himc_mat3_apply(a, take->x[i]);
    if (!take->parents)
        return;
    // positions in the zero pose are sums of offsets
    pair pairs[MOST_PAIRS];
    himc_vec3 left = {0, 0, 0};
    int count = find_pairs(take, pairs, MOST_PAIRS);
    for (int i = 0; i < count; i++) {
        for (int j = pairs[i].left; j >= 0; j = take->parents[j])
            left = himc_vec3_add(left, take->offsets[j]);
        for (int j = pairs[i].right; j >= 0; j = take->parents[j])
            left = himc_vec3_sub(left, take->offsets[j]);
    }
    left = himc_mat3_apply(upright, left);
    himc_mat3 b = is_long_enough(left) ? rotate_to_left(upright, left, false) : *a;
    himc_quat qa = himc_quat_from_mat3(*a), qb = himc_quat_from_mat3(b), back = himc_quat_conj(qb);
    for (int i = 0; i < take->points; i++)
        take->offsets[i] = himc_mat3_apply(&b, take->offsets[i]);
    for (size_t i = 0; i < all; i++) {
        bool root = take->parents[i % (size_t)take->points] < 0;
        himc_quat *q = &take->rotations[i];
        *q = himc_quat_mul(himc_quat_mul(root ? qa : qb, *q), back);
    }
}

static int by_name(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

bool himc_take_settle(himc_take *take, const himc_take_options *options, himc_error *error)
{
    if (!take->parents)
        himc_take_drop_zeros(take);
    if (!settle_units(take, options, error))
        return false;
    himc_take_drop_spikes(take);
    const char **name = malloc((size_t)take->points * sizeof *name);
    if (!name)
        return himc_error_set(error, "%s: no memory for %d names", take->file, take->points);
    for (int i = 0; i < take->points; i++)
        name[i] = take->names[i];
    qsort(name, (size_t)take->points, sizeof *name, by_name);
    int twice = 1;
    while (twice < take->points && strcmp(name[twice - 1], name[twice]) != 0)
        twice++;
    if (twice < take->points) // himc_take_find gives the first
        himc_take_note(take, "names: more than one point is called %s, the first is read",
                       name[twice]);
    free(name);
    if (take->rate < 40) // chosen: a contact of some 7 ms is less than a third of a frame
        himc_take_note(take, "rate: at %g Hz strikes are blurred, some may be missed or misplaced",
                       take->rate);
    himc_vec3 up = find_up(take, options->up);
    // x is what is forward: to the screen's right if that is known
    himc_vec3 x = take->file_right;
    if (himc_vec3_length(x) == 0 || himc_vec3_dot(x, up) != 0)
        x = up.x == 0 ? himc_vec3_make(1, 0, 0) : himc_vec3_make(0, 1, 0);
    himc_vec3 y = himc_vec3_cross(up, x);
    himc_mat3 upright = {{{x.x, x.y, x.z}, {y.x, y.y, y.z}, {up.x, up.y, up.z}}};
    const char *heading;
    himc_mat3 a = find_axes(take, options, &upright, &heading);
    rotate(take, &upright, &a);
    char axis = fabs(up.x) > 0.5 ? 'x' : fabs(up.y) > 0.5 ? 'y' : 'z', reason[112];
    snprintf(reason, sizeof reason, "%.111s", take->axes_text);
    snprintf(take->axes_text, sizeof take->axes_text, "%s%c up, %s; %s",
             up.x + up.y + up.z < 0 ? "-" : "", axis, reason, heading);
    return true;
}
