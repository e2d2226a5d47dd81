/// take_frame.c: from the file's axes into the library's: x forward, y left, z up.
///
/// With the file's up axis u and its axis f that goes forward (to the right of the screen if the
/// file says, else x, or y if x is up), the rows of the rotation are f, u x f, u: y up becomes (x,
/// -z, y). A turn about z then brings the body's left side to +y: by any angle if hips, else
/// shoulders or the like, are named in pairs, by quarter turns if only the tips tell (players do
/// not strike exactly along their room's axes, but their hands are not exactly abreast either). A
/// skeleton's joint frames get a rest rotation of their own, found from the bones in the zero pose,
/// so that the zero pose looks along x whichever way the player faced on the day: with A for the
/// points and B for the zero pose, a root turns by A R B^T, other joints by B R B^T, and offsets
/// become B o; forward kinematics then gives A times the points.
#include "capture/take_data.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

#define BLURRED 40.0 // a blow's few milliseconds are less than a third of a frame (Hz)
#define SAMPLED 200  // frames looked at are about so many, spread over the take

static int named(const himc_take *take, int point, const char *const *words, char rest[TAKE_NAME])
{
    char plain[TAKE_NAME];
    himc_take_plain_name(take->names[point], plain);
    return himc_take_side(plain, words, rest);
}

// mean over frames of b - a; false if they are never seen together
static bool mean_difference(const himc_take *take, int a, int b, himc_vec3 *mean)
{
    himc_vec3 sum = {0, 0, 0};
    int count = 0;
    for (int frame = 0; frame < take->frames; frame += take->frames / SAMPLED + 1) {
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

// left and right of the same thing of these words, at most `capacity`
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

// those of the hips, for a player's shoulders turn towards what is struck; else any
static int find_pairs(const himc_take *take, pair *pairs, int capacity)
{
    int count = find_pairs_of(take, hip_words, pairs, capacity);
    return count > 0 ? count : find_pairs_of(take, side_words, pairs, capacity);
}

// the axis heads lie above hips on, clear or nothing; the points' names go to the reason
static bool up_from_data(himc_take *take, himc_vec3 *up)
{
    int high = -1, low = -1;
    char rest[TAKE_NAME];
    himc_vec3 d;
    for (int i = 0; i < take->points; i++) {
        if (high < 0 && named(take, i, high_words, rest) >= 0)
            high = i;
        if (low < 0 && named(take, i, low_words, rest) >= 0)
            low = i;
    }
    if (high < 0 || low < 0 || !mean_difference(take, low, high, &d))
        return false;
    double clear = 0.8 * himc_vec3_length(d);
    *up = himc_vec3_make(copysign(fabs(d.x) > clear, d.x), copysign(fabs(d.y) > clear, d.y),
                         copysign(fabs(d.z) > clear, d.z));
    if (himc_vec3_length(*up) != 1)
        return false;
    snprintf(take->axes_text, sizeof take->axes_text, "for %.40s is above %.40s", take->names[high],
             take->names[low]);
    return true;
}

static himc_vec3 find_up(himc_take *take, himc_up asked)
{
    himc_vec3 up;
    if (asked != HIMC_UP_AUTO) {
        snprintf(take->axes_text, sizeof take->axes_text, "as asked for");
        return asked == HIMC_UP_Y ? himc_vec3_make(0, 1, 0) : himc_vec3_make(0, 0, 1);
    }
    if (himc_vec3_length(take->file_up) > 0) {
        snprintf(take->axes_text, sizeof take->axes_text, "as the file says");
        return take->file_up;
    }
    if (up_from_data(take, &up))
        return up;
    snprintf(take->axes_text, sizeof take->axes_text, "the habit of %.4s files", take->format);
    return take->habit_up;
}

static himc_mat3 rows_of(himc_vec3 x, himc_vec3 y, himc_vec3 z)
{
    return (himc_mat3){{{x.x, x.y, x.z}, {y.x, y.y, y.z}, {z.x, z.y, z.z}}};
}

static himc_mat3 stand_up(himc_vec3 up, himc_vec3 right)
{
    himc_vec3 forward = right;
    if (himc_vec3_length(right) == 0 || himc_vec3_dot(right, up) != 0)
        forward = up.x == 0 ? himc_vec3_make(1, 0, 0) : himc_vec3_make(0, 1, 0);
    return rows_of(forward, himc_vec3_cross(up, forward), up);
}

// the turn about z that brings a horizontal direction to +y
static himc_mat3 turn_to_left(himc_vec3 d, bool quarters)
{
    double angle = HIMC_PI / 2 - atan2(d.y, d.x);
    if (quarters)
        angle = round(angle / (HIMC_PI / 2)) * (HIMC_PI / 2);
    double c = quarters ? round(cos(angle)) : cos(angle),
           s = quarters ? round(sin(angle)) : sin(angle);
    return (himc_mat3){{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}};
}

static bool is_long_enough(himc_vec3 d)
{
    return hypot(d.x, d.y) > 0.03;
}

// the body's left side in the stood-up frame, over the take, or at its start if the player turns
// round
static bool left_of_body(const himc_take *take, const himc_mat3 *stand, himc_vec3 *left)
{
    pair pairs[16];
    himc_vec3 sum = {0, 0, 0}, first = {0, 0, 0}, d;
    double lengths = 0;
    int count = find_pairs(take, pairs, 16);
    for (int frame = 0; frame < take->frames && count; frame += take->frames / SAMPLED + 1) {
        himc_vec3 now = {0, 0, 0};
        for (int i = 0; i < count; i++) {
            d = himc_vec3_sub(*himc_take_at(take, frame, pairs[i].left),
                              *himc_take_at(take, frame, pairs[i].right));
            if (himc_vec3_finite(d))
                now = himc_vec3_add(now, himc_mat3_apply(stand, d));
        }
        first = is_long_enough(first) ? first : now;
        sum = himc_vec3_add(sum, now);
        lengths += hypot(now.x, now.y);
    }
    *left = hypot(sum.x, sum.y) > 0.5 * lengths ? sum : first;
    return is_long_enough(*left);
}

// the left side as the sticks tell it: from the right tip to the left one, or a quarter turn from
// where the arm points
static bool left_of_tips(const himc_take *take, const himc_take_options *options,
                         const himc_mat3 *stand, himc_vec3 *left, const char **reason)
{
    int l = himc_take_find_tip(take, HIMC_LEFT, options),
        r = himc_take_find_tip(take, HIMC_RIGHT, options);
    char rest[TAKE_NAME];
    himc_vec3 d;
    if (l >= 0 && r >= 0 && mean_difference(take, r, l, &d)) {
        *left = himc_mat3_apply(stand, d);
        *reason = "turned so that the left tip is left of the right one";
        return is_long_enough(*left);
    }
    for (int i = 0; i < take->points && (l >= 0 || r >= 0); i++)
        if (named(take, i, shoulder_words, rest) >= 0 &&
            mean_difference(take, i, l >= 0 ? l : r, &d)) {
            d = himc_mat3_apply(stand, d);
            *left = himc_vec3_make(-d.y, d.x, 0);
            *reason = "turned so that the tip is in front of the shoulder";
            return is_long_enough(*left);
        }
    return false;
}

// the left side in the zero pose: positions are sums of offsets
static bool left_of_rest(const himc_take *take, const himc_mat3 *stand, himc_vec3 *left)
{
    pair pairs[16];
    himc_vec3 sum = {0, 0, 0};
    int count = find_pairs(take, pairs, 16);
    for (int i = 0; i < count; i++) {
        for (int j = pairs[i].left; j >= 0; j = take->parents[j])
            sum = himc_vec3_add(sum, take->offsets[j]);
        for (int j = pairs[i].right; j >= 0; j = take->parents[j])
            sum = himc_vec3_sub(sum, take->offsets[j]);
    }
    *left = himc_mat3_apply(stand, sum);
    return is_long_enough(*left);
}

static void turn_points(himc_take *take, const himc_mat3 *a)
{
    size_t all = (size_t)take->frames * (size_t)take->points;
    for (size_t i = 0; i < all; i++)
        take->x[i] = himc_mat3_apply(a, take->x[i]);
}

static void turn_skeleton(himc_take *take, const himc_mat3 *a, const himc_mat3 *b)
{
    himc_quat qa = himc_quat_from_mat3(*a), qb = himc_quat_from_mat3(*b), back = himc_quat_conj(qb);
    for (int i = 0; i < take->points; i++)
        take->offsets[i] = himc_mat3_apply(b, take->offsets[i]);
    for (int frame = 0; frame < take->frames; frame++) {
        himc_quat *q = take->rotations + (size_t)frame * (size_t)take->points;
        for (int i = 0; i < take->points; i++)
            q[i] = himc_quat_mul(himc_quat_mul(take->parents[i] < 0 ? qa : qb, q[i]), back);
    }
}

static void say_axes(himc_take *take, himc_vec3 up, const char *heading)
{
    char axis = fabs(up.x) > 0.5 ? 'x' : fabs(up.y) > 0.5 ? 'y' : 'z', reason[128];
    snprintf(reason, sizeof reason, "%.127s", take->axes_text);
    snprintf(take->axes_text, sizeof take->axes_text, "%s%c up, %s; %s",
             up.x + up.y + up.z < 0 ? "-" : "", axis, reason, heading);
}

static int by_name(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

// what is asked for by name is the first of that name
static void note_names(himc_take *take)
{
    size_t count = (size_t)take->points;
    const char **name = malloc(count * sizeof *name);
    for (size_t i = 0; name && i < count; i++)
        name[i] = take->names[i];
    if (name)
        qsort(name, count, sizeof *name, by_name);
    for (size_t i = 1; name && i < count; i++)
        if (strcmp(name[i - 1], name[i]) == 0) {
            himc_take_note(take, "names: more than one point is called %s, the first is read",
                           name[i]);
            break;
        }
    free(name);
}

bool himc_take_settle(himc_take *take, const himc_take_options *options, himc_error *error)
{
    if (!take->parents)
        himc_take_drop_zeros(take);
    if (!himc_take_settle_units(take, options, error))
        return false;
    himc_take_drop_spikes(take);
    note_names(take);
    if (take->rate < BLURRED)
        himc_take_note(take, "rate: at %g Hz strikes are blurred, and may be missed or misplaced",
                       take->rate);
    himc_vec3 up = find_up(take, options->up), left, rest_left;
    himc_mat3 stand = stand_up(up, take->file_right), a = stand, b;
    const char *heading = "heading as in the file";
    if (left_of_body(take, &stand, &left)) {
        himc_mat3 turn = turn_to_left(left, false);
        a = himc_mat3_mul(&turn, &stand);
        heading = "turned so that the body looks along x";
    } else if (left_of_tips(take, options, &stand, &left, &heading)) {
        himc_mat3 turn = turn_to_left(left, true);
        a = himc_mat3_mul(&turn, &stand);
    }
    b = a;
    if (take->parents && left_of_rest(take, &stand, &rest_left)) {
        himc_mat3 turn = turn_to_left(rest_left, false);
        b = himc_mat3_mul(&turn, &stand);
    }
    turn_points(take, &a);
    if (take->parents)
        turn_skeleton(take, &a, &b);
    say_axes(take, up, heading);
    return true;
}
