/// test_recording.c: a recording, written as a take, plays back to the same strokes.
#include "session.h"
#include "capture/take.h"

#define PIECE                                                                                 \
    "tempo 100; drum kettle; stroke 2 right legato mf; stroke 3 left tenuto f; "              \
    "stroke 4 right accent ff; stroke 5 left vertical-accent mf; stroke 6 right staccato f; " \
    "stroke 7 left legato mf; stroke 8 right legato f;"

#define STROKES 7

static void load(himc_performance *p, const char *text)
{
    char path[] = "/tmp/himc-recording-XXXXXX";
    int file = mkstemp(path);
    TEST_ASSERT_TRUE(file >= 0 && write(file, text, strlen(text)) == (ssize_t)strlen(text));
    close(file);
    bool ok = session_try(p, "score %s", path);
    unlink(path);
    TEST_ASSERT_TRUE_MESSAGE(ok, error.text);
}

static heard record(const char *path, const char *piece)
{
    himc_performance *p = session_new();
    heard h = {0};
    load(p, piece);
    session_do(p, "record %s", path);
    session_do(p, "play");
    session_play(p, 9, &h);
    session_do(p, "record stop");
    himc_performance_free(p);
    return h;
}

static heard play_take(const char *path)
{
    himc_performance *p = session_new();
    heard h = {0};
    session_do(p, "drum kettle");
    session_do(p, "take %s", path);
    session_do(p, "play");
    session_play(p, 11, &h);
    himc_performance_free(p);
    return h;
}

static void expect_same_strokes(const char *suffix, const char *piece)
{
    char path[64];
    snprintf(path, sizeof path, "/tmp/himc-recording-%d.%s", (int)getpid(), suffix);
    heard first = record(path, piece), again = play_take(path);
    unlink(path);
    TEST_ASSERT_EQUAL_INT_MESSAGE(STROKES, first.strikes, suffix);
    TEST_ASSERT_EQUAL_INT_MESSAGE(STROKES, again.strikes, suffix);
    double since = again.strike[0].time - first.strike[0].time, time = 0, level = 0;
    for (int i = 0; i < STROKES; i++) {
        const himc_strike *a = &first.strike[i], *b = &again.strike[i];
        TEST_ASSERT_EQUAL_INT(a->hand, b->hand);
        time = fmax(time, fabs(b->time - a->time - since));
        level = fmax(level, fabs(20 * log10(b->force / a->force)));
        TEST_ASSERT_DOUBLE_WITHIN(0.01, a->x, b->x);
        TEST_ASSERT_DOUBLE_WITHIN(0.01, a->y, b->y);
    }
    printf("%s: within %.2f ms and %.2f dB\n", suffix, 1e3 * time, level);
    TEST_ASSERT_TRUE(time < 0.002);
    TEST_ASSERT_TRUE(level < 1.5);
    heard_free(&first);
    heard_free(&again);
}

static void test_bvh_plays_back_to_the_same_strokes(void)
{
    expect_same_strokes("bvh", PIECE);
}

static void test_c3d_plays_back_to_the_same_strokes(void)
{
    expect_same_strokes("c3d", PIECE);
}

static void test_trc_plays_back_to_the_same_strokes(void)
{
    expect_same_strokes("trc", PIECE);
}

// loud blows dent the head deeper than soft ones, whose lowest points lie high above theirs
static void test_soft_strokes_beside_loud_ones_play_back(void)
{
    expect_same_strokes(
        "c3d", "tempo 67; drum kettle; stroke 1 left legato p; stroke 2 right legato pp; "
               "stroke 3 left vertical-accent ff; stroke 4 right vertical-accent f; "
               "stroke 5 left staccato pp; stroke 6 right legato mp; stroke 7 left tenuto fff;");
}

typedef struct target_steps {
    himc_vec3 x[HIMC_HANDS], v[HIMC_HANDS]; ///< of the targets in the row before
    double time, worst;                     ///< step beside the mean velocity (m)
    double off;                             ///< of a tip from its target (m)
} target_steps;

static void watch_targets(void *user, const himc_motion_row *row)
{
    target_steps *w = user;
    double h = row->time - w->time;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_vec3 v = himc_vec3_add(w->v[hand], row->target_velocity[hand]);
        himc_vec3 foreseen = himc_vec3_madd(w->x[hand], 0.5 * h, v);
        if (w->time > 0)
            w->worst = fmax(w->worst, himc_vec3_length(himc_vec3_sub(row->target[hand], foreseen)));
        w->off = fmax(w->off, himc_vec3_length(himc_vec3_sub(row->tip[hand], row->target[hand])));
        w->x[hand] = row->target[hand];
        w->v[hand] = row->target_velocity[hand];
    }
    w->time = row->time;
}

// nothing stops a stick beside the drum: it is not let go there, but follows the take, strike and
// all
static void test_strikes_beside_the_drum_leave_no_jump(void)
{
    char path[64];
    snprintf(path, sizeof path, "/tmp/himc-recording-two-drums-%d.trc", (int)getpid());
    heard first =
        record(path, "drum low; low place 0.6 0.4 0.85; drum high; high place 0.6 -0.4 0.85;"
                     "stroke 2 right accent ff normal high; stroke 3 left accent ff normal low;"
                     "stroke 4 left accent ff normal low; tempo 120;");
    himc_performance *p = session_new();
    heard again = {0};
    target_steps steps = {.time = 0};
    TEST_ASSERT_EQUAL_INT(3, first.strikes);
    session_do(p, "drum kettle");
    session_do(p, "take %s", path);
    himc_performance_on_motion(p, watch_targets, &steps);
    session_do(p, "play");
    session_play(p, 4, &again);
    printf("%d strikes, %.1f mm, %.1f mm off\n", again.strikes, 1e3 * steps.worst, 1e3 * steps.off);
    TEST_ASSERT_EQUAL_INT(3, himc_performance_measure(p).missed);
    TEST_ASSERT_TRUE(steps.worst < 0.01 && steps.off < 0.01);
    unlink(path);
    heard_free(&first);
    heard_free(&again);
    himc_performance_free(p);
}

// every point of every frame, whatever the format
static void expect_same_points(const himc_take *take, const char *suffix)
{
    char path[64];
    snprintf(path, sizeof path, "/tmp/himc-points-%d.%s", (int)getpid(), suffix);
    TEST_ASSERT_TRUE_MESSAGE(himc_take_save(take, path, &error), error.text);
    himc_take *back = himc_take_load(path, NULL, &error);
    unlink(path);
    TEST_ASSERT_NOT_NULL_MESSAGE(back, error.text);
    TEST_ASSERT_EQUAL_INT(himc_take_frames(take), himc_take_frames(back));
    TEST_ASSERT_EQUAL_INT(himc_take_points(take), himc_take_points(back));
    for (int i = 0; i < himc_take_points(take); i++) {
        int other = himc_take_find(back, himc_take_point_name(take, i));
        TEST_ASSERT_TRUE_MESSAGE(other >= 0, himc_take_point_name(take, i));
        for (int f = 0; f < himc_take_frames(take); f += 7) {
            himc_vec3 d =
                himc_vec3_sub(himc_take_point(take, f, i), himc_take_point(back, f, other));
            TEST_ASSERT_TRUE_MESSAGE(himc_vec3_length(d) < 1e-5, suffix);
        }
    }
    himc_take_free(back);
}

static himc_take *swinging_body(void)
{
    himc_skeleton_config config = himc_skeleton_default();
    himc_skeleton skeleton;
    himc_body_state state;
    TEST_ASSERT_TRUE(himc_skeleton_init(&skeleton, &config, &error));
    himc_recording *r = himc_recording_new("/tmp/himc-swinging.bvh", &skeleton, 250, 1, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(r, error.text);
    for (int f = 0; f < 250; f++) {
        himc_pose pose = himc_pose_zero();
        for (int j = 0; j < HIMC_JOINTS; j++)
            if (j < 3 || (j >= HIMC_LEFT_UPPER_ARM - 1 && j < HIMC_LEFT_UPPER_LEG - 1))
                pose.joint[j] = himc_quat_exp(himc_vec3_make(
                    0.1 * sin(0.02 * f + j), -0.6 * fabs(sin(0.03 * f + j)), 0.001 * j));
        himc_pose_to_state(&skeleton, &pose, NULL, &state);
        TEST_ASSERT_TRUE(himc_recording_add(r, &state));
    }
    TEST_ASSERT_FALSE(himc_recording_add(r, &state)); // a second is full
    himc_take *take = himc_recording_take(r, &error);
    himc_recording_free(r);
    return take;
}

static void test_any_body_is_read_back_point_by_point(void)
{
    himc_take *take = swinging_body();
    // the heading is found from the body, so this one must look along x on the average
    static const char *const suffixes[] = {"bvh", "c3d", "trc"};
    for (int i = 0; i < 3; i++) {
        char path[64];
        snprintf(path, sizeof path, "/tmp/himc-first-%d.%s", (int)getpid(), suffixes[i]);
        TEST_ASSERT_TRUE_MESSAGE(himc_take_save(take, path, &error), error.text);
        himc_take *settled = himc_take_load(path, NULL, &error);
        unlink(path);
        TEST_ASSERT_NOT_NULL_MESSAGE(settled, error.text);
        expect_same_points(settled, suffixes[i]);
        himc_take_free(settled);
    }
    himc_take_free(take);
}

// so many markers a decimetre apart; the second is missing in the frames from 10 to 19
static himc_take *markers_with_a_gap(int count)
{
    enum { FRAMES = 40 };
    char *text = malloc((size_t)FRAMES * (size_t)count * 40 + 4000), *at = text;
    at += sprintf(at, "PathFileType\t4\nDataRate\tNumFrames\tNumMarkers\tUnits\n100\t%d\t%d\tmm\n",
                  FRAMES, count);
    at += sprintf(at, "Frame#\tTime");
    for (int i = 0; i < count; i++)
        at += sprintf(at, "\tM%d\t\t", i);
    at += sprintf(at, "\n\n");
    for (int f = 0; f < FRAMES; f++) {
        at += sprintf(at, "%d\t%g", f + 1, 0.01 * f);
        for (int i = 0; i < count; i++)
            at += i == 1 && f >= 10 && f < 20
                      ? sprintf(at, "\t\t\t")
                      : sprintf(at, "\t%d\t%d\t%d", 3 * i + 1, 900 + f, 100 + i);
        at += sprintf(at, "\n");
    }
    himc_take *take = himc_take_read(text, strlen(text), "markers.trc", NULL, &error);
    free(text);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    return take;
}

static void test_gaps_of_markers_are_saved_as_gaps(void)
{
    static const char *const suffixes[] = {"trc", "c3d"};
    himc_take *take = markers_with_a_gap(3);
    for (int i = 0; i < 2; i++) {
        char path[64];
        snprintf(path, sizeof path, "/tmp/himc-gaps-%d.%s", (int)getpid(), suffixes[i]);
        TEST_ASSERT_TRUE_MESSAGE(himc_take_save(take, path, &error), error.text);
        himc_take *back = himc_take_load(path, NULL, &error);
        unlink(path);
        TEST_ASSERT_NOT_NULL_MESSAGE(back, error.text);
        for (int f = 0; f < 40; f++)
            for (int k = 0; k < 3; k++) {
                himc_vec3 a = himc_take_point(take, f, k), b = himc_take_point(back, f, k);
                TEST_ASSERT_EQUAL(k != 1 || f < 10 || f >= 20, himc_vec3_finite(a));
                TEST_ASSERT_EQUAL(himc_vec3_finite(a), himc_vec3_finite(b));
                TEST_ASSERT_TRUE(!himc_vec3_finite(a) ||
                                 himc_vec3_length(himc_vec3_sub(a, b)) < 1e-5);
            }
        himc_take_free(back);
    }
    himc_take_free(take);
}

static void test_what_a_format_cannot_hold_is_refused_and_leaves_no_file(void)
{
    himc_take *take = markers_with_a_gap(256);
    TEST_ASSERT_FALSE(himc_take_save(take, "build/unsaved.bvh", &error));
    TEST_ASSERT_EQUAL_STRING(
        "markers.trc: the take has no skeleton to write as .bvh, expected .c3d .trc", error.text);
    TEST_ASSERT_FALSE(himc_take_save(take, "build/unsaved.c3d", &error));
    TEST_ASSERT_EQUAL_STRING("markers.trc: 256 points, expected up to 255 in a .c3d", error.text);
    TEST_ASSERT_FALSE(access("build/unsaved.bvh", F_OK) == 0);
    TEST_ASSERT_FALSE(access("build/unsaved.c3d", F_OK) == 0);
    himc_take_free(take);
}

// of a long path the end is told, which distinguishes files
static void test_a_long_path_keeps_its_end_in_an_error(void)
{
    char path[1000] = "";
    for (int i = 0; i < 90; i++)
        strcat(path, "build/../");
    strcat(path, "lost.trc");
    TEST_ASSERT_NULL(himc_take_read("x", 1, path, NULL, &error));
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, strncmp(error.text, "...", 3), error.text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, "build/../lost.trc:1: "), error.text);
}

static void test_bad_names_and_places_are_refused_in_a_line(void)
{
    himc_performance *p = session_new();
    TEST_ASSERT_FALSE(session_try(p, "record stop"));
    TEST_ASSERT_NOT_NULL(strstr(error.text, "nothing"));
    TEST_ASSERT_FALSE(session_try(p, "record /tmp/a.wav"));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, ".bvh .c3d .trc"), error.text);
    TEST_ASSERT_FALSE(session_try(p, "record /no/such/folder/a.bvh"));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, "/no/such/folder/a.bvh"), error.text);
    session_do(p, "record /tmp/himc-bad.bvh");
    TEST_ASSERT_FALSE(session_try(p, "record /tmp/himc-bad2.bvh"));
    TEST_ASSERT_FALSE(session_try(p, "rate task 500"));
    session_play(p, 0.1, NULL);
    session_do(p, "record stop");
    unlink("/tmp/himc-bad.bvh");
    himc_performance_free(p);
}

static void test_a_recording_stopped_at_once_is_over_without_a_file(void)
{
    himc_performance *p = session_new();
    char path[64];
    snprintf(path, sizeof path, "/tmp/himc-recording-%d-none.bvh", (int)getpid());
    session_do(p, "record %s", path);
    session_do(p, "record stop");
    TEST_ASSERT_EQUAL_INT(-1, access(path, F_OK));
    session_do(p, "rate task 200"); // nothing is being recorded
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_bvh_plays_back_to_the_same_strokes);
    RUN_TEST(test_c3d_plays_back_to_the_same_strokes);
    RUN_TEST(test_trc_plays_back_to_the_same_strokes);
    RUN_TEST(test_soft_strokes_beside_loud_ones_play_back);
    RUN_TEST(test_strikes_beside_the_drum_leave_no_jump);
    RUN_TEST(test_any_body_is_read_back_point_by_point);
    RUN_TEST(test_a_recording_stopped_at_once_is_over_without_a_file);
    RUN_TEST(test_gaps_of_markers_are_saved_as_gaps);
    RUN_TEST(test_what_a_format_cannot_hold_is_refused_and_leaves_no_file);
    RUN_TEST(test_a_long_path_keeps_its_end_in_an_error);
    RUN_TEST(test_bad_names_and_places_are_refused_in_a_line);
    return UNITY_END();
}
