/// test_performance_score.c: lines of a score that act on its strokes: hits, a take, a first beat;
/// and a take with exchanged sides.
#include "take_players.h"

#include "session.h"

#include "capture/take.h"

#define BVH "build/score-take.bvh"
#define TRC "build/score-take.trc"
#define SCORE "build/score-of-it.txt"

static void write_text(const char *text)
{
    FILE *file = fopen(SCORE, "w");
    TEST_ASSERT_NOT_NULL(file);
    fputs(text, file);
    fclose(file);
}

static himc_take *made_take(const char *path)
{
    himc_skeleton skeleton;
    himc_skeleton_config config = himc_skeleton_default();
    TEST_ASSERT_TRUE(himc_skeleton_init(&skeleton, &config, &error));
    himc_take *take = beaten_file(path, &skeleton, 100, 1, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    return take;
}

static void save(himc_take *take, const char *path)
{
    TEST_ASSERT_TRUE_MESSAGE(himc_take_save(take, path, &error), error.text);
    himc_take_free(take);
}

// what a performer with nothing else to do makes of a score
static heard play_score(const char *text, double seconds)
{
    heard h = {0};
    himc_performance *p = session_new();
    write_text(text);
    session_do(p, "score " SCORE);
    session_play(p, seconds, &h);
    himc_performance_free(p);
    return h;
}

static void test_a_hit_in_a_score_is_played_when_it_is_loaded(void)
{
    heard h = play_score("drum kettle; hit right legato mf;", 0.6);
    TEST_ASSERT_EQUAL_INT(1, h.strikes);
    TEST_ASSERT_EQUAL_INT(HIMC_RIGHT, h.strike[0].hand);
    heard_free(&h);
}

static void test_a_score_begins_at_its_seek(void)
{
    static const char *const text[] = {
        "tempo 240; stroke 0 left legato mf; stroke 2 right accent mf;"
        "stroke 3 left tenuto mf; play;",
        "tempo 240; seek 2; stroke 0 left legato mf; stroke 2 right accent mf;"
        "stroke 3 left tenuto mf; play;"};
    for (int i = 0; i < 2; i++) {
        heard h = play_score(text[i], 1.5);
        TEST_ASSERT_EQUAL_INT(i ? 2 : 3, h.strikes);
        TEST_ASSERT_EQUAL_STRING(i ? "accent" : "legato", h.strike[0].nuance);
        heard_free(&h);
    }
}

static void test_a_take_in_a_score_without_strokes_is_played(void)
{
    save(made_take(BVH), BVH);
    heard h = play_score("drum kettle;\ntake " BVH ";\nplay;\n", 2.1);
    TEST_ASSERT_EQUAL_INT(4, h.strikes);
    heard_free(&h);
}

static void test_a_take_in_a_score_with_strokes_is_refused_with_its_line(void)
{
    save(made_take(BVH), BVH);
    himc_performance *p = session_new();
    write_text("drum kettle;\ntake " BVH ";\nstroke 1 left legato mf;\n");
    TEST_ASSERT_FALSE(session_try(p, "score " SCORE));
    TEST_ASSERT_EQUAL_STRING(SCORE ":2: take: a score with strokes cannot play a take", error.text);
    TEST_ASSERT_NULL(himc_performance_drum(p, 0));
    himc_performance_free(p);
}

// what only shows when a score is carried out is told with its line, too
static void test_a_line_that_fails_when_it_is_carried_out_is_named(void)
{
    himc_performance *p = session_new();
    write_text("drum kettle 26;\ngrip french;\nrecord stop;\n");
    TEST_ASSERT_FALSE(session_try(p, "score " SCORE));
    TEST_ASSERT_EQUAL_STRING(SCORE ":3: record: stop: nothing is being recorded, allowed FILE",
                             error.text);
    himc_performance_free(p);
}

// the notes of a command
static const char *notes_of(himc_performance *p, const char *command)
{
    static char text[4000];
    himc_event event;
    text[0] = 0;
    session_do(p, "%s", command);
    while (himc_performance_event(p, &event))
        if (event.kind == HIMC_EVENT_NOTE)
            strcat(strcat(text, event.text), "\n");
    return text;
}

static void test_repairs_of_a_take_are_told_when_it_is_loaded(void)
{
    himc_take *take = made_take(TRC);
    int tip = himc_take_find(take, "LeftStick_end");
    if (tip < 0)
        for (int i = 0; i < himc_take_points(take); i++)
            puts(himc_take_point_name(take, i));
    TEST_ASSERT_TRUE(tip >= 0);
    for (int f = 20; f < 24; f++)
        *himc_take_at(take, f, tip) = himc_vec3_make(NAN, NAN, NAN);
    save(take, TRC);
    himc_performance *p = session_new();
    const char *notes = notes_of(p, "take " TRC);
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(notes, TRC ": LeftStick_end is missing in 4 frames, which are filled"), notes);
    himc_performance_free(p);
}

static void test_a_take_of_three_frames_is_refused(void)
{
    himc_performance *p = session_new();
    FILE *file = fopen(TRC, "w");
    fputs("PathFileType\t4\nDataRate\tNumFrames\tNumMarkers\tUnits\n100\t3\t1\tmm\n"
          "Frame#\tTime\tR_Stick_Tip\t\t\n\n"
          "1\t0\t500\t900\t0\n2\t0.01\t500\t910\t0\n3\t0.02\t500\t930\t0\n",
          file);
    fclose(file);
    TEST_ASSERT_FALSE(session_try(p, "take " TRC));
    TEST_ASSERT_EQUAL_STRING(TRC ": 3 frames, allowed 8 or more", error.text);
    himc_performance_free(p);
}

static void test_units_of_a_take_without_strokes_and_too_many_units_are_refused(void)
{
    himc_performance *p = session_new();
    himc_take *take = made_take(TRC);
    save(take, TRC);
    int loaded = 0;
    while (loaded < 300 && session_try(p, "units " TRC " legato"))
        loaded++;
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, " more, allowed 256 in all"), error.text);
    TEST_ASSERT_TRUE(loaded >= 256 / 8 && loaded < 256);
    session_do(p, "units clear");
    take = made_take(TRC);
    for (int f = 1; f < himc_take_frames(take); f++)
        for (int i = 0; i < himc_take_points(take); i++)
            *himc_take_at(take, f, i) = *himc_take_at(take, 0, i);
    save(take, TRC);
    TEST_ASSERT_FALSE(session_try(p, "units " TRC " legato"));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, TRC), error.text);
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(error.text, "0 strokes, allowed: at least one that is a clear fall"), error.text);
    himc_performance_free(p);
}

// markers named as if the player's left were right: so the player looks away from the drum
static void exchange_sides(himc_take *take)
{
    for (int i = 0; i < take->points; i++) {
        char *name = take->names[i], rest[TAKE_NAME];
        bool left = strncmp(name, "Left", 4) == 0, right = strncmp(name, "Right", 5) == 0;
        if (!left && !right)
            continue;
        snprintf(rest, sizeof rest, "%s", name + (left ? 4 : 5));
        snprintf(name, TAKE_NAME, "%s%.50s", left ? "Right" : "Left", rest);
    }
}

static void test_a_take_with_left_and_right_exchanged_is_refused(void)
{
    for (int exchanged = 0; exchanged < 2; exchanged++) {
        himc_take *take = made_take(TRC);
        if (exchanged)
            exchange_sides(take);
        save(take, TRC);
        himc_performance *p = session_new();
        bool played = session_try(p, "take " TRC);
        TEST_ASSERT_EQUAL_MESSAGE(!exchanged, played, error.text);
        TEST_ASSERT_EQUAL_STRING(exchanged ? TRC ": the sticks strike 0.76 m behind the player, "
                                                 "allowed before: are left and right exchanged?"
                                           : "",
                                 error.text);
        himc_performance_free(p);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_hit_in_a_score_is_played_when_it_is_loaded);
    RUN_TEST(test_a_score_begins_at_its_seek);
    RUN_TEST(test_a_take_in_a_score_without_strokes_is_played);
    RUN_TEST(test_a_take_in_a_score_with_strokes_is_refused_with_its_line);
    RUN_TEST(test_a_line_that_fails_when_it_is_carried_out_is_named);
    RUN_TEST(test_repairs_of_a_take_are_told_when_it_is_loaded);
    RUN_TEST(test_a_take_of_three_frames_is_refused);
    RUN_TEST(test_units_of_a_take_without_strokes_and_too_many_units_are_refused);
    RUN_TEST(test_a_take_with_left_and_right_exchanged_is_refused);
    return UNITY_END();
}
