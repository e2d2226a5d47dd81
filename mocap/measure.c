/// measure.c: strokes measured as in a laboratory, and compared with those measured on real ones.
///
/// All figures come from the frames at 250 Hz, as a laboratory would have them: the point 0.15 m
/// behind the mallet, speeds by differences of neighbouring frames. A stroke's height is that of
/// the highest frame since the hand's last impact over that of the impact, its fall is the time
/// between them, its rebound the 0.15 s after it. The mallet's speed at impact is the fastest of
/// its last 20 ms.
#include "parts.h"

#include "himc/body.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define REBOUND 0.15 // chosen: time after the impact that counts as rebound (s)

// the data that a laboratory has of one hand
typedef struct track {
    himc_vec3 *point, *tip;
    double *elevation;
    int frames;
} track;

static void add(himc_mocap_statistics *s, himc_mocap_figure figure, double value)
{
    s->least[figure] = s->count[figure] ? fmin(s->least[figure], value) : value;
    s->most[figure] = s->count[figure] ? fmax(s->most[figure], value) : value;
    s->count[figure]++;
    s->sum[figure] += value;
    s->squares[figure] += value * value;
}

double himc_mocap_mean(const himc_mocap_statistics *s, himc_mocap_figure figure)
{
    return s->count[figure] ? s->sum[figure] / s->count[figure] : NAN;
}

double himc_mocap_deviation(const himc_mocap_statistics *s, himc_mocap_figure figure)
{
    double mean = himc_mocap_mean(s, figure);
    return sqrt(fmax(s->squares[figure] / s->count[figure] - mean * mean, 0));
}

static void capture(const himc_mocap *m, int hand, track *k)
{
    const himc_skeleton *skeleton = himc_mocap_skeleton(m);
    for (int i = 0; i < k->frames; i++) {
        himc_body_state state;
        himc_pose pose = himc_mocap_pose(m, i / HIMC_MOCAP_RATE);
        himc_pose_to_state(skeleton, &pose, NULL, &state);
        himc_vec3 grip = state.origin[himc_stick_segment((himc_hand)hand)];
        himc_vec3 along = himc_vec3_unit(himc_vec3_sub(state.tip[hand], grip));
        k->tip[i] = state.tip[hand];
        k->point[i] = himc_vec3_madd(state.tip[hand], -MOCAP_POINT, along);
        k->elevation[i] = asin(along.z);
    }
}

static double speed(const himc_vec3 *x, int i)
{
    return (x[i + 1].z - x[i].z) * HIMC_MOCAP_RATE;
}

// measures the stroke that ends at frame `end`; the hand's last one ended at `begin`
static void measure_stroke(const track *k, int begin, int end, himc_mocap_statistics *s)
{
    int top = end, later = end + (int)(REBOUND * HIMC_MOCAP_RATE);
    double down = 0, up = 0, impact = 0, high = 0, lo = HUGE_VAL, hi = -HUGE_VAL, sink = -HUGE_VAL;
    for (int i = begin; i <= end; i++) {
        top = k->point[i].z > k->point[top].z ? i : top;
        high = fmax(high, k->tip[i].z);
        lo = fmin(lo, k->tip[i].x);
        hi = fmax(hi, k->tip[i].x);
    }
    for (int i = top; i < end; i++)
        down = fmax(down, -speed(k->point, i));
    for (int i = end - 5; i < end; i++)
        impact = fmax(impact, -speed(k->tip, i));
    for (int i = end; i < later && i + 1 < k->frames; i++)
        up = fmax(up, speed(k->point, i));
    for (int i = end - 3; i <= end + 3; i++)
        sink = fmax(sink, -k->tip[i].z);
    add(s, HIMC_MOCAP_HEIGHT, k->point[top].z - k->point[end].z);
    add(s, HIMC_MOCAP_DOWN, down);
    add(s, HIMC_MOCAP_UP, up);
    add(s, HIMC_MOCAP_IMPACT, impact);
    add(s, HIMC_MOCAP_TIP_HEIGHT, high - k->tip[end].z);
    add(s, HIMC_MOCAP_DEPTH, hi - lo);
    add(s, HIMC_MOCAP_ELEVATION, k->elevation[end]);
    add(s, HIMC_MOCAP_SINK, sink);
}

void himc_mocap_measure(const himc_mocap *m, himc_mocap_statistics *s)
{
    int frames = himc_mocap_frames(m);
    double head = HIMC_MOCAP_HEAD + himc_mocap_skeleton(m)->mallet_radius;
    himc_vec3 *room = calloc((size_t)frames, 2 * sizeof *room + sizeof(double));
    if (!room)
        return;
    track k = {room, room + frames, (double *)(room + 2 * frames), frames};
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        int last = 0;
        capture(m, hand, &k);
        for (int i = 0; i < frames; i++)
            k.tip[i].z -= head;
        for (int i = 0; i < himc_mocap_touches(m); i++) {
            himc_mocap_touch touch = himc_mocap_touch_at(m, i);
            if ((int)touch.hand != hand)
                continue;
            int end = (int)lround(touch.time * HIMC_MOCAP_RATE);
            measure_stroke(&k, last, end, s);
            if (last)
                add(s, HIMC_MOCAP_INTERVAL, (end - last) / HIMC_MOCAP_RATE);
            last = end;
        }
    }
    free(room);
}

// take 1 of the measured set: point 0.12 .. 0.19 m behind the mallet
typedef struct measured {
    himc_mocap_figure figure;
    const char *name;
    double unit;
    double mean[HIMC_NUANCES], deviation[HIMC_NUANCES];
} measured;

static const measured captures[] = {
    {HIMC_MOCAP_HEIGHT,
     "height of the point (mm)",
     1e-3,
     {309, 366, 323, 375, 386},
     {42, 27, 44, 44, 98}},
    {HIMC_MOCAP_DOWN,
     "its speed down (m/s)",
     1,
     {1.93, 2.25, 2.35, 4.04, 1.41},
     {0.31, 0.54, 0.34, 0.62, 0.28}},
    {HIMC_MOCAP_UP,
     "its speed up (m/s)",
     1,
     {2.17, 1.48, 2.47, 2.01, 2.58},
     {0.45, 0.48, 0.33, 0.56, 0.51}},
    {HIMC_MOCAP_IMPACT, "mallet at impact (m/s)", 1, {4.3, 4.2, 4.5, 7.5, 2.8}, {0, 0, 0, 0, 0}},
};

static const struct {
    himc_mocap_figure figure;
    const char *name;
    double unit;
} others[] = {
    {HIMC_MOCAP_TIP_HEIGHT, "height of the mallet (mm)", 1e-3},
    {HIMC_MOCAP_DEPTH, "its depth (mm)", 1e-3},
    {HIMC_MOCAP_ELEVATION, "stick at impact (degrees)", HIMC_PI / 180},
    {HIMC_MOCAP_INTERVAL, "interval of a hand (s)", 1},
    {HIMC_MOCAP_SINK, "mallet below the head (mm)", 1e-3},
};

typedef struct page {
    char *text;
    size_t size, used;
} page;

static void put(page *p, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void put(page *p, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    int n = vsnprintf(p->text + p->used, p->size - p->used, format, list);
    va_end(list);
    p->used += n > 0 ? (size_t)n : 0;
    p->used = p->used < p->size ? p->used : p->size - 1;
}

static void put_value(page *p, double mean, double deviation, double unit)
{
    bool whole = unit == 1e-3 && mean / unit >= 10;
    put(p, whole ? " %.0f" : " %.2f", mean / unit);
    if (deviation > 0)
        put(p, whole ? " ± %.0f" : " ± %.2f", deviation / unit);
    put(p, " |");
}

static void put_table(page *p, const himc_mocap_statistics *all)
{
    put(p, "| |");
    for (int n = 0; n < HIMC_NUANCES; n++)
        put(p, " %s |", himc_nuance_name((himc_nuance)n));
    put(p, "\n|---|---|---|---|---|---|\n");
    for (size_t i = 0; i < sizeof captures / sizeof captures[0]; i++) {
        const measured *c = &captures[i];
        put(p, "| %s, captured |", c->name);
        for (int n = 0; n < HIMC_NUANCES; n++)
            put_value(p, c->mean[n] * c->unit, c->deviation[n] * c->unit, c->unit);
        put(p, "\n| here |");
        for (int n = 0; n < HIMC_NUANCES; n++)
            put_value(p, himc_mocap_mean(&all[n], c->figure),
                      himc_mocap_deviation(&all[n], c->figure), c->unit);
        put(p, "\n");
    }
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        put(p, "| %s, here |", others[i].name);
        for (int n = 0; n < HIMC_NUANCES; n++)
            put_value(p, himc_mocap_mean(&all[n], others[i].figure),
                      himc_mocap_deviation(&all[n], others[i].figure), others[i].unit);
        put(p, "\n");
    }
}

bool himc_mocap_compare(uint64_t seed, char *text, size_t size, himc_error *error)
{
    himc_mocap_statistics all[HIMC_NUANCES] = {0};
    himc_mocap_config c = himc_mocap_default();
    c.seed = seed;
    for (int i = 0; i < HIMC_MOCAP_PLAYERS * HIMC_NUANCES * 3; i++) {
        c.player = i % HIMC_MOCAP_PLAYERS;
        c.spot = (himc_spot)(i / HIMC_MOCAP_PLAYERS % 3);
        c.nuance = (himc_nuance)(i / (3 * HIMC_MOCAP_PLAYERS));
        himc_mocap *m = himc_mocap_new(&c, error);
        if (!m)
            return false;
        himc_mocap_measure(m, &all[c.nuance]);
        himc_mocap_free(m);
    }
    page p = {text, size, 0};
    put_table(&p, all);
    return true;
}
