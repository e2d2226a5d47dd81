/// take_tips.c: gaps. Trajectories of the stick tips without holes, and lost markers that were
/// written as zeros.
///
/// A gap from t0 to t1 is bridged, per coordinate, by the cubic Hermite polynomial through both
/// edges with the speeds the marker had there, each the end slope of a parabola fitted by least
/// squares to at least 3 and at most 20 ms of samples next to the gap (fewer samples: the slope of
/// the chord). A ballistic arc is thus restored exactly; limiters as in PCHIP would flatten the
/// turning points of a stroke. At the ends of a take there is only one edge, and the position is
/// held: a guess that never moves a stick.
#include "capture/take_data.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static himc_take_gap next_gap(const himc_take *take, int point, int from)
{
    himc_take_gap g = {from, from};
    while (g.begin < take->frames && himc_vec3_finite(*himc_take_at(take, g.begin, point)))
        g.begin++;
    for (g.end = g.begin;
         g.end < take->frames && !himc_vec3_finite(*himc_take_at(take, g.end, point));)
        g.end++;
    return g;
}

// slope at the sample `edge`, from it and its neighbours on the side `step`; false with fewer than
// three
static bool edge_slope(const himc_vec3 *x, int frames, int edge, int step, double rate,
                       himc_vec3 *slope)
{
    int most = (int)fmax(3, floor(0.02 * rate)), n = 0;
    double s[5] = {0, 0, 0, 0, 0};
    himc_vec3 b[3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    for (int i = edge; n < most && i >= 0 && i < frames && himc_vec3_finite(x[i]); i += step, n++) {
        // differences from the edge keep the sums small; u counts frames
        himc_vec3 d = himc_vec3_sub(x[i], x[edge]);
        double u = step * n, p = 1;
        for (int k = 0; k < 5; k++, p *= u)
            s[k] += p;
        for (int k = 0, m = 1; k < 3; k++, m *= step * n)
            b[k] = himc_vec3_madd(b[k], m, d);
    }
    if (n < 3)
        return false;
    // the slope of a + c u + e u^2 at u = 0 by Cramer's rule on the normal equations
    double det = s[0] * (s[2] * s[4] - s[3] * s[3]) - s[1] * (s[1] * s[4] - s[2] * s[3]) +
                 s[2] * (s[1] * s[3] - s[2] * s[2]);
    himc_vec3 c = himc_vec3_scale(b[0], s[2] * s[3] - s[1] * s[4]);
    c = himc_vec3_madd(c, s[0] * s[4] - s[2] * s[2], b[1]);
    c = himc_vec3_madd(c, s[1] * s[2] - s[0] * s[3], b[2]);
    *slope = himc_vec3_scale(c, 1 / det);
    return true;
}

static void bridge(himc_vec3 *x, int frames, himc_take_gap g, double rate)
{
    int a = g.begin - 1, b = g.end;
    double h = b - a;
    himc_vec3 xa = x[a], xb = x[b], chord = himc_vec3_scale(himc_vec3_sub(xb, xa), 1 / h),
              va = chord, vb = chord;
    edge_slope(x, frames, a, -1, rate, &va);
    edge_slope(x, frames, b, 1, rate, &vb);
    for (int i = g.begin; i < g.end; i++) {
        double u = (i - a) / h, w = 1 - u;
        himc_vec3 y = himc_vec3_scale(xa, w * w * (1 + 2 * u));
        y = himc_vec3_madd(y, u * u * (1 + 2 * w), xb);
        y = himc_vec3_madd(y, h * u * w * w, va);
        x[i] = himc_vec3_madd(y, -h * u * u * w, vb);
    }
}

static void fill(himc_vec3 *x, int frames, himc_take_gap g, double rate)
{
    if (g.begin > 0 && g.end < frames) {
        bridge(x, frames, g, rate);
        return;
    }
    for (int i = g.begin; i < g.end; i++)
        x[i] = g.begin > 0 ? x[g.begin - 1] : x[g.end];
}

int himc_take_fill(const himc_take *take, int point, double longest, himc_vec3 *x,
                   himc_take_gap *gap)
{
    int filled = 0;
    for (int i = 0; i < take->frames; i++)
        x[i] = *himc_take_at(take, i, point);
    for (*gap = next_gap(take, point, 0); gap->begin < take->frames;
         *gap = next_gap(take, point, gap->end)) {
        int length = gap->end - gap->begin;
        if (length / take->rate > longest || length == take->frames)
            return -1;
        fill(x, take->frames, *gap, take->rate);
        filled += length;
    }
    return filled;
}

static bool refuse_gap(const himc_take *take, himc_hand hand, int point, himc_take_gap g,
                       double longest, himc_error *error)
{
    bool never = g.end - g.begin == take->frames;
    return himc_error_set(
        error, "%s: %s tip %s is %s in frames %d .. %d (%.3g s), allowed are gaps of %g s",
        take->file, himc_hand_name(hand), take->names[point], never ? "never seen" : "missing",
        take->first_frame + g.begin, take->first_frame + g.end - 1, (g.end - g.begin) / take->rate,
        longest);
}

static bool fill_tip(himc_take *take, himc_hand hand, int point, double longest, himc_take_tip *tip,
                     himc_error *error)
{
    if (!take->tip[hand])
        take->tip[hand] = malloc((size_t)take->frames * sizeof *take->tip[hand]);
    if (!take->tip[hand])
        return himc_error_set(error, "%s: no memory for %d frames", take->file, take->frames);
    himc_take_gap g;
    tip->filled = himc_take_fill(take, point, longest, take->tip[hand], &g);
    if (tip->filled < 0)
        return refuse_gap(take, hand, point, g, longest, error);
    snprintf(tip->name, sizeof tip->name, "%s", take->names[point]);
    tip->x = take->tip[hand];
    tip->point = point;
    tip->present = true;
    return true;
}

// "A, B, C ..." for an error line
static void list_points(const himc_take *take, char *text, size_t size)
{
    size_t used = 0;
    text[0] = 0;
    for (int i = 0; i < take->points; i++) {
        const char *name = take->names[i];
        if (used + strlen(name) + 6 > size) {
            snprintf(text + used, size - used, " ...");
            return;
        }
        used += (size_t)snprintf(text + used, size - used, "%s%s", i ? ", " : "", name);
    }
}

static bool refuse_name(const himc_take *take, himc_hand hand, const char *name, himc_error *error)
{
    char points[96];
    list_points(take, points, sizeof points);
    return himc_error_set(error, "%s: %s tip: no point \"%.40s\", allowed: %s", take->file,
                          himc_hand_name(hand), name, points);
}

bool himc_take_tips(himc_take *take, const himc_take_options *options,
                    himc_take_tip tips[HIMC_HANDS], himc_error *error)
{
    himc_take_options usual = himc_take_default();
    options = options ? options : &usual;
    if (!himc_check_range("longest gap", options->longest_gap, 0, 10, "s", error))
        return false;
    int found = 0;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        const char *name = hand == HIMC_LEFT ? options->left_tip : options->right_tip;
        int point = himc_take_find_tip(take, (himc_hand)hand, options);
        tips[hand] = (himc_take_tip){.present = false};
        if (point < 0 && name)
            return refuse_name(take, (himc_hand)hand, name, error);
        if (point < 0)
            continue;
        if (found && tips[HIMC_LEFT].point == point)
            return himc_error_set(error, "%s: %s is named as both tips, allowed: one for each",
                                  take->file, take->names[point]);
        if (!fill_tip(take, (himc_hand)hand, point, options->longest_gap, &tips[hand], error))
            return false;
        found++;
    }
    if (found)
        return true;
    char points[96];
    list_points(take, points, sizeof points);
    return himc_error_set(
        error,
        "%s: no stick tip (RTIP, STICK_L, RightStick_end, bead, ...), name it with --left-tip "
        "or --right-tip, allowed: %s",
        take->file, points);
}

static bool is_zero(himc_vec3 x)
{
    return x.x == 0 && x.y == 0 && x.z == 0;
}

static bool is_far(const himc_take *take, int frame, int point, double far)
{
    return frame >= 0 && frame < take->frames &&
           himc_vec3_length(*himc_take_at(take, frame, point)) > far;
}

void himc_take_drop_zeros(himc_take *take)
{
    // a jump is more than 0.1 m at more than 30 m/s; millimetres where the file does not say
    double far = fmax(0.1, 30 / take->rate) / (take->file_unit > 0 ? take->file_unit : 0.001);
    int dropped = 0, first = -1;
    for (int i = 0; i < take->points; i++)
        for (int begin = 0, end; begin < take->frames; begin = end + 1) {
            for (end = begin; end < take->frames && is_zero(*himc_take_at(take, end, i));)
                end++;
            if (end == begin || (!is_far(take, begin - 1, i, far) && !is_far(take, end, i, far)))
                continue;
            for (int frame = begin; frame < end; frame++)
                *himc_take_at(take, frame, i) = himc_vec3_gap();
            first = first < 0 ? i : first;
            dropped += end - begin;
        }
    if (dropped)
        himc_take_note(
            take, "gaps: %d positions of exactly 0 0 0 that a trajectory jumps to, the first of %s",
            dropped, take->names[first]);
}
