/// test_press.c: a tip that is wanted below the head is pressed on it, by a live target, by a
/// stream of targets and by a take: one contact with little force, that comes to rest.
#define _GNU_SOURCE
#include "take_players.h"
#include "session.h"
#include "base/quintic.h"

#define HEAD 0.8675   // height of a tip that touches the usual head (m)
#define ABOVE 0.1     // where a press begins (m)
#define MOVE 0.4      // its duration (s)
#define BEATEN 1.6    // strokes of a take before its press (s)
#define MOST_FORCE 20 // (N)

static const double depths[] = {0.005, 0.010, 0.020, 0.040};

typedef struct watched {
    double height[20000], force[20000];
    int rows;
} watched;

static void keep(void *user, const himc_motion_row *row)
{
    watched *w = user;
    if (w->rows == 20000)
        return;
    w->height[w->rows] = row->tip[HIMC_RIGHT].z;
    w->force[w->rows++] = row->force[HIMC_RIGHT];
}

static himc_performance *with_kettle(watched *w)
{
    himc_performance *p = session_new();
    session_do(p, "drum kettle");
    himc_performance_on_motion(p, keep, w);
    return p;
}

// the last half second is still, and its force steady
static void rests(const watched *w, double depth)
{
    double low = HUGE_VAL, high = -HUGE_VAL, least = HUGE_VAL, most = 0;
    for (int i = w->rows - 125; i < w->rows; i++) {
        low = fmin(low, w->height[i]);
        high = fmax(high, w->height[i]);
        least = fmin(least, w->force[i]);
        most = fmax(most, w->force[i]);
    }
    printf("%2.0f mm deep: at rest to %.1g mm with %.2f to %.2f N\n", 1e3 * depth,
           1e3 * (high - low), least, most);
    TEST_ASSERT_TRUE(high - low < 1e-4);
    TEST_ASSERT_TRUE(least > 0.5 && most < 8.5);
}

static void pressed_once(const heard *h, const watched *w, double depth, int before)
{
    double peak = 0;
    for (int i = before; i < h->strikes; i++)
        peak = fmax(peak, h->strike[i].force);
    printf("%2.0f mm deep: %d contacts, %.1f N, %.2f m/s\n", 1e3 * depth, h->strikes - before, peak,
           h->strikes > before ? h->strike[before].velocity : NAN);
    TEST_ASSERT_EQUAL_INT(1, h->strikes - before);
    TEST_ASSERT_TRUE(peak < MOST_FORCE);
    TEST_ASSERT_TRUE(h->notes <= 1);
    rests(w, depth);
}

static void test_a_target_below_the_head_is_pressed_once(void)
{
    for (int k = 0; k < 4; k++) {
        watched *w = calloc(1, sizeof *w);
        himc_performance *p = with_kettle(w);
        heard h = {0};
        session_do(p, "target right 0.55 -0.12 %g", HEAD + 3 * ABOVE);
        session_play(p, 0.8, &h);
        session_do(p, "target right 0.55 -0.12 %g", HEAD - depths[k]);
        session_play(p, 1.6, &h);
        pressed_once(&h, w, depths[k], 0);
        heard_free(&h);
        himc_performance_free(p);
        free(w);
    }
}

// from above to the depth; `ramp` seconds long
static double pressed_height(double t, double ramp, double depth)
{
    double u = fmin(fmax(t / ramp, 0), 1);
    return ABOVE - (ABOVE + depth) * u * u * u * (10 - 15 * u + 6 * u * u);
}

static void stream_presses(double ramp, int samples, int step)
{
    for (int k = 0; k < 4; k += step) {
        watched *w = calloc(1, sizeof *w);
        himc_performance *p = with_kettle(w);
        heard h = {0};
        for (int i = 0; i < (int)(2.4 * 48000 / samples); i++) {
            double t = i * samples / 48000.0 - 0.6;
            himc_performance_target(
                p, HIMC_RIGHT,
                himc_vec3_make(0.55, -0.12, HEAD + pressed_height(t, ramp, depths[k])));
            session_play(p, samples / 48000.0, &h);
        }
        pressed_once(&h, w, depths[k], 0);
        heard_free(&h);
        himc_performance_free(p);
        free(w);
    }
}

static void test_a_stream_of_targets_that_goes_below_the_head_is_pressed_once(void)
{
    stream_presses(MOVE, 480, 1);
}

static void test_a_stream_that_jumps_below_the_head_is_pressed_once(void)
{
    stream_presses(1e-3, 480, 3);
}

// three strokes at 4 m/s, then the press, held for a second and lifted again
static double taken_height(double t, double depth)
{
    himc_target from = beaten_height(BEATEN, 4), deep = {.x = {0, 0, -depth}};
    double since = t - BEATEN;
    himc_quintic down = himc_quintic_make(&from, &deep, MOVE);
    if (since < 0)
        return beaten_height(t, 4).x.z;
    if (since < MOVE + 1)
        return himc_quintic_at(&down, fmin(since, MOVE)).x.z;
    return pressed_height(2 * MOVE + 1 - since, MOVE, depth);
}

static const char *write_take(double depth)
{
    static char path[] = "/tmp/himc-press-XXXXXX.trc";
    strcpy(path, "/tmp/himc-press-XXXXXX.trc");
    int file = mkstemps(path, 4), frames = 900;
    FILE *out = fdopen(file, "w");
    fprintf(out,
            "PathFileType\t4\t(X/Y/Z)\ta.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\t"
            "Units\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n250\t250\t%d\t1\tmm\t250\t1\t"
            "%d\nFrame#\tTime\tRTIP\t\t\n\t\tX1\tY1\tZ1\n\n",
            frames, frames);
    for (int i = 0; i < frames; i++)
        fprintf(out, "%d\t%.6f\t600\t%.6f\t50\n", i + 1, i / 250.0,
                900 + 1000 * taken_height(i / 250.0, depth));
    fclose(out);
    return path;
}

static void find_capture(void *user, const char *line)
{
    double rms = 0;
    if (sscanf(line, "capture: tips %lf mm RMS off it", &rms) == 1)
        *(double *)user = 1e-3 * rms;
}

// the targets are planned again after a contact, so their error is small however deep the press is
static void shows_in_the_measures(const himc_performance *p, double depth)
{
    himc_performance_stats s = himc_performance_measure(p);
    printf("%2.0f mm deep: %.2f %% off the targets; off the capture %.1f mm, at most %.1f mm, %.1f "
           "%%; %.2f s of contact\n",
           1e3 * depth, s.tip_rms_percent, 1e3 * s.captured_rms, 1e3 * s.captured_most,
           s.captured_most_percent, s.longest_contact);
    TEST_ASSERT_EQUAL_INT(1, s.unplanned_contacts);
    TEST_ASSERT_TRUE(s.longest_contact > 1 && s.longest_contact < 1.5);
    TEST_ASSERT_TRUE(s.captured_most > 0.9 * depth && s.captured_most < depth + 0.02);
    TEST_ASSERT_TRUE(s.captured_rms > 0.4 * depth && s.captured_rms < s.captured_most);
    double told = 0;
    himc_performance_describe(p, HIMC_DESCRIBE_INFO, find_capture, &told);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, s.captured_rms, told);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 100 * s.captured_rms / s.stroke_height, s.captured_rms_percent);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 100 * s.captured_most / s.stroke_height,
                              s.captured_most_percent);
}

static void test_a_take_that_goes_below_the_head_is_pressed_once_in_all_modes(void)
{
    static const char *const modes[] = {"himc", "id", "ik"};
    for (int k = 0; k < 4; k++) {
        double depth = depths[k];
        watched *w = calloc(1, sizeof *w);
        himc_performance *p = with_kettle(w);
        heard h = {0};
        const char *path = write_take(depth);
        session_do(p, "mode %s", modes[k % 3]);
        session_do(p, "take %s", path);
        unlink(path);
        session_do(p, "play");
        session_play(p, 1 + BEATEN + MOVE + 1, &h); // the press lasts
        TEST_ASSERT_EQUAL_INT(3, heard_asked(&h));
        pressed_once(&h, w, depth, 3);
        session_play(p, 1.2, &h); // and is lifted
        TEST_ASSERT_EQUAL_INT(4, h.strikes);
        TEST_ASSERT_EQUAL_INT(1, h.dones);
        shows_in_the_measures(p, depth);
        heard_free(&h);
        himc_performance_free(p);
        free(w);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_target_below_the_head_is_pressed_once);
    RUN_TEST(test_a_stream_of_targets_that_goes_below_the_head_is_pressed_once);
    RUN_TEST(test_a_stream_that_jumps_below_the_head_is_pressed_once);
    RUN_TEST(test_a_take_that_goes_below_the_head_is_pressed_once_in_all_modes);
    return UNITY_END();
}
