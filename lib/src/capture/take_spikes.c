/// take_spikes.c: places where a point cannot have been.
///
/// Nothing of a player, stick tips included, is faster than 30 m/s. Frames between which a point
/// moves faster, and farther than noise does, cut its trajectory into runs; a run too short to be
/// one of its own is another marker's or a reflection's, and becomes a gap. Where that would be
/// much of a point, it is rather the file's unit or rate that is wrong, which others will say.
#include "capture/take_data.h"

#define FASTEST 30.0      // (m/s)
#define JUMP 0.1          // nearer is no jump at any rate (m)
#define LONGEST_SPIKE 0.1 // (s)
#define MOST_SPIKES 0.05  // of a point's frames

static int next_seen(const himc_take *take, int point, int from)
{
    while (from < take->frames && !himc_vec3_finite(*himc_take_at(take, from, point)))
        from++;
    return from;
}

static bool jumps(const himc_take *take, int point, int from, int to)
{
    himc_vec3 way = himc_vec3_sub(*himc_take_at(take, to, point), *himc_take_at(take, from, point));
    return himc_vec3_length(way) > fmax(JUMP, FASTEST * (to - from) / take->rate);
}

// the end of the run that begins at a frame seen; `*last` its last frame seen
static int run_end(const himc_take *take, int point, int begin, int *last)
{
    int at = begin;
    *last = begin;
    while ((at = next_seen(take, point, at + 1)) < take->frames && !jumps(take, point, *last, at))
        *last = at;
    return at;
}

// finds a point's spikes, or makes them gaps; how many frames, `*first` the first of them
static int spikes(himc_take *take, int point, bool drop, int *first)
{
    int longest = (int)fmax(1, LONGEST_SPIKE * take->rate), count = 0, last;
    for (int begin = next_seen(take, point, 0), end; begin < take->frames; begin = end) {
        end = run_end(take, point, begin, &last);
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
        int first, count = spikes(take, i, false, &first);
        if (count == 0 || count > MOST_SPIKES * take->frames)
            continue;
        spikes(take, i, true, &first);
        if (points++ == 0) {
            name = take->names[i];
            frame = take->first_frame + first;
        }
        frames += count;
    }
    if (points)
        himc_take_note(take,
                       "gaps: %d positions of %d points to which they jump faster than %g m/s, the "
                       "first of %s in frame %d",
                       frames, points, FASTEST, name, frame);
}
