/// take_motions.h: takes of known motions of a stick, through TRC text, for the tests of tips and
/// strikes.
#ifndef HIMC_TESTS_TAKE_MOTIONS_H
#define HIMC_TESTS_TAKE_MOTIONS_H

#include "take_files.h"
#include "unity.h"

static himc_error error;

// a marker's position at time t (s), in metres, z up; NaN for a gap
typedef himc_vec3 motion(double t);

static double touch_time = 0.5, noise;
static uint64_t random_state;

// roughly normal: a sum of uniform numbers
static inline double random_normal(void)
{
    double sum = 0;
    for (int i = 0; i < 12; i++) {
        random_state = random_state * 6364136223846793005u + 1442695040888963407u;
        sum += (double)(random_state >> 40) / 16777216.0;
    }
    return sum - 6;
}

// a TRC (mm, z up by option) of up to two markers; to be freed
static inline char *write_motion(const char *const names[2], motion *const motions[2], double rate,
                                 int frames)
{
    int markers = names[1] ? 2 : 1;
    char *text = malloc(400 + (size_t)frames * 140), *at = text;
    at += sprintf(at, "PathFileType\t4\n");
    at += sprintf(at, "DataRate\tNumFrames\tNumMarkers\tUnits\n%.10g\t%d\t%d\tmm\n", rate, frames,
                  markers);
    at += sprintf(at, "Frame#\tTime\t%s\t\t\t%s\t\t\n\n", names[0], markers > 1 ? names[1] : "");
    for (int f = 0; f < frames; f++) {
        at += sprintf(at, "%d\t%.9f", f + 1, f / rate);
        for (int i = 0; i < markers; i++) {
            himc_vec3 x = himc_vec3_scale(motions[i](f / rate), 1000);
            if (isnan(x.x))
                at += sprintf(at, "\t\t\t");
            else
                at += sprintf(at, "\t%.9f\t%.9f\t%.9f", x.x, x.y, x.z);
        }
        at += sprintf(at, "\n");
    }
    return text;
}

static inline himc_take_options z_up(void)
{
    himc_take_options options = himc_take_default();
    options.up = HIMC_UP_Z;
    return options;
}

static inline himc_take *read_motions(const char *file, const char *const names[2],
                                      motion *const motions[2], double rate, int frames)
{
    himc_take_options options = z_up();
    char *text = write_motion(names, motions, rate, frames);
    himc_take *take = read_text(text, file, &options, &error);
    free(text);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    return take;
}

static inline himc_take *read_motion(motion *one, double rate, int frames)
{
    const char *const names[2] = {"RTIP", NULL};
    motion *const motions[2] = {one, NULL};
    return read_motions("motion.trc", names, motions, rate, frames);
}

// writes at most `capacity` strikes, returns the number of all
static inline int strikes_of(himc_take *take, himc_take_strike *strikes, int capacity)
{
    himc_take_tip tips[HIMC_HANDS];
    int count;
    TEST_ASSERT_TRUE_MESSAGE(himc_take_tips(take, NULL, tips, &error), error.text);
    himc_take_strike *all = himc_take_find_strikes(take, tips, &count);
    TEST_ASSERT_NOT_NULL(all);
    for (int i = 0; i < capacity; i++)
        strikes[i] = i < count ? all[i] : (himc_take_strike){.frame = -1};
    free(all);
    return count;
}

// falls with 30 m/s^2 to 4 m/s at touch_time, leaves at 2.5 m/s; reversed in time it begins at rest
static inline double bounce_height(double t)
{
    double u = t - touch_time;
    if (u > 0)
        return u < 0.25 ? 2.5 * u - 5 * u * u : 0.3125;
    return u > -4.0 / 30 ? -4 * u - 15 * u * u : 0.8 / 3;
}

static inline himc_vec3 bounce(double t)
{
    return himc_vec3_make(0.6 + 0.1 * t, 0.1, 0.8 + bounce_height(t) + noise * random_normal());
}

static inline himc_vec3 stroke_in_the_air(double t)
{
    return himc_vec3_make(0.6, 0.1, 1 + 0.15 * cos(2 * HIMC_PI * 4 * t) + noise * random_normal());
}

// every 0.3 s, and 0.11 s later for the other hand
static inline himc_vec3 right_roll(double t)
{
    touch_time = 0.2 + 0.3 * floor(fmax(0, t) / 0.3);
    himc_vec3 x = bounce(t);
    return himc_vec3_make(0.6, -0.2, x.z);
}

static inline himc_vec3 left_roll(double t)
{
    himc_vec3 x = right_roll(t - 0.11);
    return himc_vec3_make(0.7, 0.3, x.z);
}

static inline himc_take *read_roll(int frames)
{
    const char *const names[2] = {"Anna:R_Stick_Tip", "Anna:L_Stick_Tip"};
    motion *const motions[2] = {right_roll, left_roll};
    return read_motions("roll.trc", names, motions, 250, frames);
}

#endif
