/// take.c: the data of a take, and read access to it.
///
/// Invariants of a finished take: frames and points >= 1, every coordinate finite or the whole
/// point NaN (a gap), every name at least one printable character, parents before children. Counts
/// in a file are never trusted: readers compare them with the size of the file before they allocate
/// anything, and himc_take_allocate limits the product of frames and points.
///
/// Laboratories give one thing many names: "RTIP", "Daphnee:R_Tip", "StickTipRight",
/// "RightStick_end". Names are therefore compared as plain letters and digits without prefix, and
/// read as a few known words with at most one word for the side among them.
///
/// Noise of a tracker: normal deviates (Box & Muller 1958) of reproducible random numbers, so that
/// a seed gives the same noise on every machine.
#include "capture/take.h"

#include "base/line.h"
#include "base/random.h"
#include "capture/take_text.h"

#include <stdlib.h>
#include <string.h>

himc_take_options himc_take_default(void)
{
    return (himc_take_options){.up = HIMC_UP_AUTO, .longest_gap = 0.2};
}

bool himc_take_allocate(himc_take *take, double rate, int frames, int points, bool skeleton,
                        himc_error *error)
{
    if (!himc_check_range("rate", rate, 20, 10000, "Hz", error) ||
        !himc_check_range("frames", frames, 1, TAKE_MOST_FRAMES, "", error) ||
        !himc_check_range("points", points, 1, TAKE_MOST_POINTS, "", error))
        return himc_error_prefix(error, "%s", take->file);
    if ((int64_t)frames * points > TAKE_MOST_POSITIONS)
        return himc_error_set(error, "%s: %d frames of %d points, expected %d in all", take->file,
                              frames, points, TAKE_MOST_POSITIONS);
    size_t count = (size_t)points, all = count * (size_t)frames;
    take->rate = rate;
    take->frames = frames;
    take->points = points;
    take->names = calloc(count, sizeof *take->names);
    take->x = calloc(all, sizeof *take->x);
    if (skeleton) {
        take->parents = calloc(count, sizeof *take->parents);
        take->offsets = calloc(count, sizeof *take->offsets);
        take->rotations = calloc(all, sizeof *take->rotations);
    }
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        take->tip[hand] = malloc((size_t)frames * sizeof *take->tip[hand]);
    if (take->names && take->x && take->tip[HIMC_LEFT] && take->tip[HIMC_RIGHT] &&
        (!skeleton || (take->parents && take->offsets && take->rotations)))
        return true;
    return himc_error_set(error, "%s: no memory for %d frames of %d points", take->file, frames,
                          points);
}

void himc_take_free(himc_take *take)
{
    if (!take)
        return;
    free(take->names);
    free(take->x);
    free(take->parents);
    free(take->offsets);
    free(take->rotations);
    free(take->events);
    free(take->analog_names);
    free(take->analog);
    free(take->tip[HIMC_LEFT]);
    free(take->tip[HIMC_RIGHT]);
    free(take);
}

void himc_take_set_name(himc_take *take, int point, const char *name, size_t length)
{
    himc_span span = himc_span_trim((himc_span){name, length});
    char *to = take->names[point];
    size_t n = 0;
    for (size_t i = 0; i < span.length && n < TAKE_NAME - 1; i++)
        if (span.at[i] >= ' ' && span.at[i] <= '~')
            to[n++] = span.at[i];
    to[n] = 0;
    if (n == 0)
        snprintf(to, TAKE_NAME, "P%d", point + 1);
}

void himc_take_note(himc_take *take, const char *format, ...)
{
    if (take->note_count >= TAKE_NOTES)
        return;
    va_list args;
    va_start(args, format);
    himc_line_print(take->notes[take->note_count++], sizeof take->notes[0], format, args);
    va_end(args);
}

double himc_take_rate(const himc_take *take)
{
    return take->rate;
}

int himc_take_frames(const himc_take *take)
{
    return take->frames;
}

int himc_take_first_frame(const himc_take *take)
{
    return take->first_frame;
}

int himc_take_points(const himc_take *take)
{
    return take->points;
}

const char *himc_take_point_name(const himc_take *take, int point)
{
    return take->names[point];
}

himc_vec3 himc_take_point(const himc_take *take, int frame, int point)
{
    return *himc_take_at(take, frame, point);
}

int himc_take_missing(const himc_take *take, int point)
{
    int count = 0;
    for (int frame = 0; frame < take->frames; frame++)
        count += !himc_vec3_finite(*himc_take_at(take, frame, point));
    return count;
}

bool himc_take_has_skeleton(const himc_take *take)
{
    return take->parents != NULL;
}

int himc_take_parent(const himc_take *take, int point)
{
    return take->parents ? take->parents[point] : -1;
}

himc_vec3 himc_take_offset(const himc_take *take, int point)
{
    return take->offsets ? take->offsets[point] : himc_vec3_make(0, 0, 0);
}

himc_quat himc_take_rotation(const himc_take *take, int frame, int point)
{
    if (!take->rotations)
        return himc_quat_identity();
    return take->rotations[(size_t)frame * (size_t)take->points + (size_t)point];
}

void himc_take_plain_name(const char *name, char plain[TAKE_NAME])
{
    const char *colon = strrchr(name, ':');
    size_t n = 0;
    for (const char *c = colon ? colon + 1 : name; *c && n < TAKE_NAME - 1; c++) {
        if (*c >= 'A' && *c <= 'Z')
            plain[n++] = (char)(*c - 'A' + 'a');
        else if ((*c >= 'a' && *c <= 'z') || (*c >= '0' && *c <= '9'))
            plain[n++] = *c;
    }
    plain[n] = 0;
}

int himc_take_find(const himc_take *take, const char *name)
{
    for (int i = 0; i < take->points; i++)
        if (strcmp(take->names[i], name) == 0)
            return i;
    char wanted[TAKE_NAME], plain[TAKE_NAME];
    himc_take_plain_name(name, wanted);
    for (int i = 0; i < take->points && wanted[0]; i++) {
        himc_take_plain_name(take->names[i], plain);
        if (strcmp(plain, wanted) == 0)
            return i;
    }
    return -1;
}

static const char *skip_words(const char *at, const char *const *words, char *rest)
{
    for (int i = 0; words[i];) {
        size_t n = strlen(words[i]);
        bool fits = strncmp(at, words[i], n) == 0;
        if (fits) {
            strncat(rest, at, n);
            at += n;
        }
        i = fits ? 0 : i + 1;
    }
    return at;
}

int himc_take_side(const char *plain, const char *const *words, char rest[TAKE_NAME])
{
    static const struct {
        const char *word;
        int hand;
    } sides[] = {{"left", HIMC_LEFT},
                 {"right", HIMC_RIGHT},
                 {"l", HIMC_LEFT},
                 {"r", HIMC_RIGHT},
                 {"", HIMC_HANDS}};
    rest[0] = 0;
    const char *at = skip_words(plain, words, rest);
    size_t before = strlen(rest);
    for (size_t i = 0; i < sizeof sides / sizeof sides[0]; i++) {
        size_t n = strlen(sides[i].word);
        rest[before] = 0;
        if (strncmp(at, sides[i].word, n) == 0 && !*skip_words(at + n, words, rest) && rest[0])
            return sides[i].hand;
    }
    return -1;
}

void himc_take_add_noise(himc_take *take, double deviation, uint64_t seed)
{
    for (size_t i = 0; i < (size_t)take->frames * (size_t)take->points; i++) {
        himc_vec3 *x = &take->x[i];
        x->x += deviation * himc_random_normal(&seed);
        x->y += deviation * himc_random_normal(&seed);
        x->z += deviation * himc_random_normal(&seed);
    }
}
