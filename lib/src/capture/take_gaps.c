/// take_gaps.c: gaps: positions that a point cannot have had become gaps, and gaps are bridged.
///
/// Spikes: nothing of a player, stick tips included, is faster than 30 m/s. Frames between which a
/// point moves faster, and farther than noise does, cut its trajectory into runs; a run that is too
/// short to be a trajectory belongs to another marker or a reflection, and becomes a gap. If more
/// than 5 % of a point's frames were such runs, the file's unit or rate is rather wrong, and the
/// point stays as it is. Lost markers that were written as 0 0 0 are found by the same jump.
///
/// Bridges: a gap from t0 to t1 is filled, per coordinate, by the cubic Hermite polynomial through
/// both edges with the velocity of the marker there: the end slope of a parabola fitted by least
/// squares to the samples of 20 ms next to the gap, at least 3 (fewer samples: the slope of the
/// chord). A ballistic arc is thus restored exactly; limiters as in PCHIP would flatten the turning
/// points of a stroke. At the ends of a take there is only one edge, and the position is held: no
/// stick moves on a guess.
#include "capture/take.h"

#define FASTEST 30.0   // chosen: four times the mallet of a hard blow (m/s)
#define LEAST_JUMP 0.1 // chosen: noise of a tracker is far smaller (m)

static bool is_far(const himc_take *take, int frame, int point, double far)
{
    return frame >= 0 && frame < take->frames &&
           himc_vec3_length(*himc_take_at(take, frame, point)) > far;
}

void himc_take_drop_zeros(himc_take *take)
{
    double unit = take->file_unit > 0 ? take->file_unit : 0.001; // most marker files are in mm
    double far = fmax(LEAST_JUMP, FASTEST / take->rate) / unit;
    int dropped = 0, first = -1;
    for (int i = 0; i < take->points; i++)
        for (int begin = 0, end; begin < take->frames; begin = end + 1) {
            for (end = begin;
                 end < take->frames && himc_vec3_length(*himc_take_at(take, end, i)) == 0;)
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
            take,
            "gaps: %d positions of exactly 0 0 0 after a jump are read as gaps, the first of %s",
            dropped, take->names[first]);
}

static int next_seen(const himc_take *take, int point, int from)
{
    while (from < take->frames && !himc_vec3_finite(*himc_take_at(take, from, point)))
        from++;
    return from;
}

// finds a point's spikes, and with `drop` makes them gaps; returns the number of frames, `*first`
// is the first of them
static int spikes(himc_take *take, int point, bool drop, int *first)
{
    // chosen: a marker that stays elsewhere for more than 0.1 s was there
    int longest = (int)fmax(1, 0.1 * take->rate), count = 0, last;
    for (int begin = next_seen(take, point, 0), end; begin < take->frames; begin = end) {
        last = begin; // of the run that is seen: it ends where the point jumps
        for (end = begin; (end = next_seen(take, point, end + 1)) < take->frames; last = end) {
            himc_vec3 way =
                himc_vec3_sub(*himc_take_at(take, end, point), *himc_take_at(take, last, point));
            if (himc_vec3_length(way) > fmax(LEAST_JUMP, FASTEST * (end - last) / take->rate))
                break;
        }
        bool alone = begin == next_seen(take, point, 0) && end == take->frames;
        if (alone || last - begin + 1 > longest)
            continue;
        *first = count == 0 ? begin : *first;
        count += last - begin + 1;
        for (int i = begin; drop && i <= last; i++)
            *himc_take_at(take, i, point) = himc_vec3_gap();
    }
    return count;
}

void himc_take_drop_spikes(himc_take *take)
{
    int points = 0, frames = 0, frame = 0;
    const char *name = "";
    for (int i = 0; i < take->points; i++) {
        int first = 0, count = spikes(take, i, false, &first);
        if (count == 0 || count > 0.05 * take->frames)
            continue;
        spikes(take, i, true, &first);
        if (points++ == 0) {
            name = take->names[i];
            frame = take->first_frame + first;
        }
        frames += count;
    }
    if (points)
        himc_take_note(
            take,
            "gaps: %d positions of %d points, reached by jumps faster than %g m/s, are read "
            "as gaps, the first of %s in frame %d",
            frames, points, FASTEST, name, frame);
}

himc_take_gap himc_take_next_gap(const himc_take *take, int point, int from)
{
    while (from < take->frames && himc_vec3_finite(*himc_take_at(take, from, point)))
        from++;
    return (himc_take_gap){from, next_seen(take, point, from)};
}

himc_parabola himc_take_parabola(const himc_vec3 *x, int origin, int step, int n)
{
    himc_vec3 zero = {0, 0, 0}, b[3] = {zero, zero, zero};
    double s[5] = {0, 0, 0, 0, 0};
    himc_parabola p = {x[origin], zero, zero, origin};
    if (n < 3) {
        if (n == 2)
            p.b = himc_vec3_scale(himc_vec3_sub(x[origin + step], x[origin]), step);
        return p;
    }
    for (int k = 0; k < n; k++) {
        // differences from the origin keep the sums small
        double u = step * k, power[5] = {1, u, u * u, u * u * u, u * u * u * u};
        himc_vec3 d = himc_vec3_sub(x[origin + step * k], x[origin]);
        for (int j = 0; j < 5; j++)
            s[j] += power[j];
        for (int j = 0; j < 3; j++)
            b[j] = himc_vec3_madd(b[j], power[j], d);
    }
    // Cramer's rule on the normal equations, whose matrix is symmetric
    double m[3][3] = {
        {s[2] * s[4] - s[3] * s[3], s[2] * s[3] - s[1] * s[4], s[1] * s[3] - s[2] * s[2]},
        {s[2] * s[3] - s[1] * s[4], s[0] * s[4] - s[2] * s[2], s[1] * s[2] - s[0] * s[3]},
        {s[1] * s[3] - s[2] * s[2], s[1] * s[2] - s[0] * s[3], s[0] * s[2] - s[1] * s[1]}};
    double det = s[0] * m[0][0] - s[1] * (s[1] * s[4] - s[2] * s[3]) + s[2] * m[0][2];
    himc_vec3 c[3] = {zero, zero, zero};
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            c[i] = himc_vec3_madd(c[i], m[i][j], b[j]);
        c[i] = himc_vec3_make(c[i].x / det, c[i].y / det, c[i].z / det);
    }
    p.a = himc_vec3_add(p.a, c[0]);
    p.b = c[1];
    p.c = c[2];
    return p;
}

// slope at the sample `edge`, from it and its neighbours in the direction `step`; `chord` with
// fewer than three
static himc_vec3 edge_slope(const himc_vec3 *x, int frames, int edge, int step, double rate,
                            himc_vec3 chord)
{
    // chosen: the parabola is short beside a stroke of 0.2 s
    int most = (int)fmax(3, floor(0.02 * rate)), n = 0;
    for (int i = edge; n < most && i >= 0 && i < frames && himc_vec3_finite(x[i]); i += step)
        n++;
    return n < 3 ? chord : himc_take_parabola(x, edge, step, n).b;
}

int himc_take_fill(const himc_take *take, int point, double longest, himc_vec3 *x,
                   himc_take_gap *gap)
{
    int filled = 0, frames = take->frames;
    for (int i = 0; i < frames; i++)
        x[i] = *himc_take_at(take, i, point);
    for (*gap = himc_take_next_gap(take, point, 0); gap->begin < frames;
         *gap = himc_take_next_gap(take, point, gap->end)) {
        int a = gap->begin - 1, b = gap->end, length = b - gap->begin;
        if (length / take->rate > longest || length == frames)
            return -1;
        filled += length;
        if (a < 0 || b == frames) { // held at the take's ends
            for (int i = gap->begin; i < b; i++)
                x[i] = x[a < 0 ? b : a];
            continue;
        }
        double h = b - a;
        himc_vec3 xa = x[a], xb = x[b], chord = himc_vec3_scale(himc_vec3_sub(xb, xa), 1 / h),
                  va = edge_slope(x, frames, a, -1, take->rate, chord),
                  vb = edge_slope(x, frames, b, 1, take->rate, chord);
        for (int i = gap->begin; i < b; i++) {
            double u = (i - a) / h, w = 1 - u;
            himc_vec3 y = himc_vec3_scale(xa, w * w * (1 + 2 * u));
            y = himc_vec3_madd(y, u * u * (1 + 2 * w), xb);
            y = himc_vec3_madd(y, h * u * w * w, va);
            x[i] = himc_vec3_madd(y, -h * u * u * w, vb);
        }
    }
    return filled;
}
