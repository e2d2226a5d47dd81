/// take.h: the promises of mocap.h about a take that was read from arbitrary bytes.
#ifndef HIMC_TESTS_FUZZ_TAKE_H
#define HIMC_TESTS_FUZZ_TAKE_H

#include "capture/take.h"
#include "fuzz.h"

#include <math.h>

static inline void hear(void *user, const char *line)
{
    require(strlen(line) < 256, "a line is at most 255 characters");
    require(himc_line_is_clean(line), "a line has no control characters");
    ++*(int *)user;
}

static inline void check_points(const himc_take *take)
{
    for (int frame = 0; frame < himc_take_frames(take); frame++)
        for (int i = 0; i < himc_take_points(take); i++) {
            himc_vec3 p = himc_take_point(take, frame, i);
            bool gap = isnan(p.x) && isnan(p.y) && isnan(p.z);
            require(gap || himc_vec3_finite(p), "a place is finite or a gap");
            himc_quat q = himc_take_rotation(take, frame, i);
            require(fabs(himc_quat_dot(q, q) - 1) < 1e-6, "a rotation is a unit quaternion");
        }
    for (int i = 0; i < himc_take_points(take); i++) {
        const char *name = himc_take_point_name(take, i);
        require(name[0] && strlen(name) < 64, "a point has a name");
        require(himc_take_find(take, name) >= 0, "a point is found by its name");
        require(himc_take_parent(take, i) < (himc_take_has_skeleton(take) ? i : 1),
                "parents come first");
    }
}

static inline void check_tips(himc_take *take, const himc_take_options *options)
{
    himc_take_tip tips[HIMC_HANDS];
    himc_error error = {""};
    if (!himc_take_tips(take, options, tips, &error)) {
        require_line(&error);
        return;
    }
    himc_strike_survey s;
    require(himc_take_strikes(take, tips, &s), "there is memory for the strikes");
    for (int i = 0; i < s.count; i++) {
        require(himc_vec3_finite(s.strikes[i].x) && s.strikes[i].velocity > 0 &&
                    isfinite(s.strikes[i].velocity),
                "a strike is finite and goes down");
        require(s.strikes[i].frame >= 0 && s.strikes[i].frame < himc_take_frames(take),
                "a strike is in the take");
        require(i == 0 || s.strikes[i].time >= s.strikes[i - 1].time, "strikes come in order");
        require(s.strikes[i].head >= 0 && s.strikes[i].head < s.heads, "a strike is on a head");
    }
    for (int i = 0; i < s.heads; i++)
        require(himc_vec3_finite(s.head[i]), "a head is somewhere");
    free(s.strikes);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        for (int i = 0; tips[hand].present && i < himc_take_frames(take); i++)
            require(himc_vec3_finite(tips[hand].x[i]), "a tip has no gaps");
}

/// The last byte, which a reader rarely needs, chooses among the options.
static inline himc_take_options fuzz_options(const uint8_t *data, size_t size)
{
    himc_take_options options = himc_take_default();
    unsigned choice = size > 0 ? data[size - 1] : 0;
    options.up = (himc_up)(choice % 3);
    options.longest_gap = choice & 128 ? 10 : 0.05;
    options.unit = choice & 64 ? 0.01 : 0;
    return options;
}

/// The take in these bytes, NULL if it is refused in one line.
static inline himc_take *fuzz_take(const char *name, const uint8_t *data, size_t size,
                                   const himc_take_options *options)
{
    himc_error error = {""};
    himc_take *take = himc_take_read(data, size, name, options, &error);
    if (!take)
        require_line(&error);
    return take;
}

/// Reads a take and checks all that can be asked of it.
static inline int fuzz_format(const char *name, const uint8_t *data, size_t size)
{
    himc_take_options options = fuzz_options(data, size);
    himc_take *take = fuzz_take(name, data, size, &options);
    if (!take)
        return 0;
    check_points(take);
    // the first point is also named as a tip, so that filling and strikes are always reached
    check_tips(take, &options);
    options.right_tip = himc_take_point_name(take, 0);
    check_tips(take, &options);
    int lines = 0;
    himc_take_describe(take, &options, hear, &lines);
    require(lines > 4, "a take is described");
    himc_take_free(take);
    return 0;
}

#endif
