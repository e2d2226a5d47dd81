/// test_session.c: a composer's session: on time, in dynamics, in rolls, in loops and queues.
#include "session.h"
#include "plan/planner.h"

static const char *const nuances[] = {"legato", "tenuto", "accent", "vertical-accent", "staccato"};

static himc_performance *with_kettle(void)
{
    himc_performance *p = session_new();
    session_do(p, "drum kettle");
    session_do(p, "tempo 60");
    return p;
}

static void test_random_strokes_land_within_2_ms_and_on_their_spot(void)
{
    unsigned seed = 1;
    double beat = 2;
    himc_performance *p = with_kettle();
    heard h = {0};
    for (int i = 0; i < 40; i++, beat += 0.15 + 0.25 * chance(&seed))
        session_do(p, "stroke %.5f %s %s %.3f", beat, i & 1 ? "right" : "left",
                   nuances[choose(&seed, 5)], chance(&seed));
    session_do(p, "play");
    session_play(p, beat + 0.5, &h);
    TEST_ASSERT_EQUAL_INT(40, h.strikes);
    for (int i = 0; i < h.strikes; i++) {
        TEST_ASSERT_DOUBLE_WITHIN(0.002, h.strike[i].planned_time, h.strike[i].time);
        TEST_ASSERT_DOUBLE_WITHIN(0.005, h.strike[i].planned_x, h.strike[i].x);
        TEST_ASSERT_DOUBLE_WITHIN(0.005, h.strike[i].planned_y, h.strike[i].y);
    }
    heard_free(&h);
    himc_performance_free(p);
}

static void test_eight_dynamics_rise_over_20_dB(void)
{
    static const char *const dynamics[] = {"ppp", "pp", "p", "mp", "mf", "f", "ff", "fff"};
    himc_performance *p = with_kettle();
    heard h = {0};
    for (int i = 0; i < 8; i++)
        session_do(p, "stroke %g right legato %s", 2 + 0.7 * i, dynamics[i]);
    session_do(p, "play");
    session_play(p, 8, &h);
    TEST_ASSERT_EQUAL_INT(8, h.strikes);
    for (int i = 1; i < 8; i++)
        TEST_ASSERT_TRUE_MESSAGE(h.strike[i].force > 1.1 * h.strike[i - 1].force, dynamics[i]);
    TEST_ASSERT_TRUE(20 * log10(h.strike[7].force / h.strike[0].force) >= 20);
    heard_free(&h);
    himc_performance_free(p);
}

// 14 strokes a second from one dynamic to another; the steps in time and level from stroke to
// stroke
static heard roll(double from, double to, double *time, double *level)
{
    enum { COUNT = 42 };
    himc_performance *p = with_kettle();
    heard h = {0};
    for (int i = 0; i < COUNT; i++)
        session_do(p, "stroke %.6f %s legato %.4f", 1.5 + i / 14.0, i & 1 ? "right" : "left",
                   from + (to - from) * i / (COUNT - 1));
    session_do(p, "play");
    session_play(p, 5, &h);
    himc_performance_free(p);
    TEST_ASSERT_EQUAL_INT(COUNT, h.strikes);
    *time = *level = 0;
    for (int i = 3; i < COUNT; i++) {
        *time = fmax(*time, fabs(14 * (h.strike[i].time - h.strike[i - 1].time) - 1));
        *level = fmax(*level, fabs(20 * log10(h.strike[i].force / h.strike[i - 1].force)));
    }
    return h;
}

static void test_roll_of_14_a_second_is_even(void)
{
    static const double dynamics[] = {0, 0.5, 1};
    double time, level;
    for (int i = 0; i < 3; i++) {
        heard h = roll(dynamics[i], dynamics[i], &time, &level);
        TEST_ASSERT_TRUE(time < 0.05);
        TEST_ASSERT_TRUE(level < 1.5);
        heard_free(&h);
    }
}

static void test_roll_makes_a_crescendo_of_10_dB(void)
{
    double time, level;
    heard h = roll(0.05, 0.9, &time, &level);
    TEST_ASSERT_TRUE(time < 0.05);
    TEST_ASSERT_TRUE(level < 1.5);
    TEST_ASSERT_TRUE(h.strike[h.strikes - 1].force > 3 * h.strike[3].force);
    heard_free(&h);
}

static void test_loop_begins_again_on_its_whole_beat_and_ends_when_told(void)
{
    himc_performance *p = with_kettle();
    heard h = {0};
    session_do(p, "tempo 120");
    session_do(p, "stroke 0 left legato mf");
    session_do(p, "stroke 1 right legato mf");
    session_do(p, "stroke 2.5 left accent mf"); // so it is three beats long: 1.5 s
    session_do(p, "loop 1");
    session_do(p, "play");
    session_play(p, 7, &h);
    TEST_ASSERT_TRUE(h.strikes >= 12);
    for (int i = 3; i < h.strikes; i++)
        TEST_ASSERT_DOUBLE_WITHIN(0.002, 1.5, h.strike[i].time - h.strike[i - 3].time);
    TEST_ASSERT_EQUAL_INT(0, h.dones);
    session_do(p, "loop 0");
    int before = h.strikes;
    session_play(p, 5, &h);
    TEST_ASSERT_TRUE(h.strikes - before <= 3);
    TEST_ASSERT_EQUAL_INT(0, h.strikes % 3);
    TEST_ASSERT_EQUAL_INT(1, h.dones);
    heard_free(&h);
    himc_performance_free(p);
}

// wherever in the round the loop is cleared: no beat is missing while its new strokes are prepared,
// and none is reported twice
static void test_beats_go_on_while_a_cleared_loop_prepares_its_new_strokes(void)
{
    for (int trial = 0; trial < 8; trial++) {
        himc_performance *p = with_kettle();
        himc_event event;
        double last = -1;
        int beats = 0;
        session_do(p, "tempo 120");
        session_do(p, "stroke 0 left legato mf");
        session_do(p, "stroke 2 right legato mf");
        session_do(p, "loop 1");
        session_do(p, "play");
        himc_performance_process(p, 96000 + 9000 * trial, NULL);
        session_do(p, "clear");
        himc_performance_process(p, trial % 2 ? 48000 : 0, NULL);
        session_do(p, "stroke 0 left accent f");
        session_do(p, "stroke 1 right accent f");
        himc_performance_process(p, 144000, NULL);
        for (; himc_performance_event(p, &event);) {
            if (event.kind != HIMC_EVENT_BEAT)
                continue;
            if (beats++ > 0)
                TEST_ASSERT_DOUBLE_WITHIN(0.005, 0.5, event.time - last);
            last = event.time;
        }
        TEST_ASSERT_TRUE(last > 4.5 && beats >= 9);
        himc_performance_free(p);
    }
}

// a stroke that can no longer be taken back brings its whole round with it
static void test_loop_that_ends_just_before_a_round_plays_that_round(void)
{
    static const double before[] = {0.2, 0.04};
    for (int i = 0; i < 2; i++) {
        himc_performance *p = with_kettle();
        heard h = {0};
        session_do(p, "tempo 120");
        session_do(p, "stroke 0 left legato mf");
        session_do(p, "stroke 1 right legato mf");
        session_do(p, "loop 1");
        session_do(p, "play");
        while (h.strikes < 1)
            session_play(p, 0.01, &h);
        session_play(p, h.strike[0].time + 1 - before[i] - himc_performance_measure(p).seconds, &h);
        TEST_ASSERT_EQUAL_INT(2, h.strikes);
        session_do(p, "loop 0");
        session_play(p, 4, &h);
        TEST_ASSERT_EQUAL_INT(2 + 2 * i, h.strikes);
        TEST_ASSERT_EQUAL_INT(1, h.dones);
        heard_free(&h);
        himc_performance_free(p);
    }
}

static void test_tempo_bends_a_loop_without_losing_a_stroke(void)
{
    himc_performance *p = with_kettle();
    heard h = {0};
    for (int i = 0; i < 4; i++)
        session_do(p, "stroke %d %s legato mf", i, i & 1 ? "right" : "left");
    session_do(p, "loop 1");
    session_do(p, "tempo 100");
    session_do(p, "play");
    session_play(p, 4, &h);
    session_do(p, "tempo 150");
    session_play(p, 4, &h);
    for (int i = 1; i < h.strikes; i++)
        TEST_ASSERT_TRUE(h.strike[i].hand != h.strike[i - 1].hand);
    for (int i = h.strikes - 4; i < h.strikes; i++)
        TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.4, h.strike[i].time - h.strike[i - 1].time);
    heard_free(&h);
    himc_performance_free(p);
}

static bool load_text(himc_performance *p, const char *text)
{
    char path[] = "/tmp/himc-session-XXXXXX";
    int file = mkstemp(path);
    TEST_ASSERT_TRUE(file >= 0 && write(file, text, strlen(text)) == (ssize_t)strlen(text));
    close(file);
    bool ok = session_try(p, "score %s", path);
    unlink(path);
    return ok;
}

static void load(himc_performance *p, const char *text)
{
    TEST_ASSERT_TRUE_MESSAGE(load_text(p, text), error.text);
}

static void test_scores_that_are_queued_follow_each_other_at_their_own_tempi(void)
{
    himc_performance *p = with_kettle();
    heard h = {0};
    load(p,
         "tempo 120; stroke 1 left legato mf; stroke 2 right legato mf; stroke 3 left legato mf;");
    session_do(p, "play");
    session_play(p, 0.5, &h);
    load(p, "tempo 60; stroke 0 right accent f; stroke 1 left accent f;");
    load(p, "tempo 240; stroke 0 left legato p; stroke 2 right legato p;");
    session_play(p, 9, &h);
    static const double times[] = {0.5, 1, 1.5, 2, 3, 4, 4.5};
    TEST_ASSERT_EQUAL_INT(7, h.strikes);
    for (int i = 0; i < 7; i++)
        TEST_ASSERT_DOUBLE_WITHIN(0.002, times[i], h.strike[i].time);
    TEST_ASSERT_EQUAL_INT(1, h.dones);
    heard_free(&h);
    himc_performance_free(p);
}

// what a performance says of itself, drums included
static void keep_line(void *user, const char *line)
{
    strncat(user, line, 4000 - strlen(user));
}

static void test_score_with_an_error_anywhere_changes_nothing(void)
{
    static const char *const faults[][2] = {
        {"gain nose 1 1;", ":5: gain: JOINT: nose, expected waist"},
        {"strength nose 1;", ":5: strength: JOINT: nose, expected waist"},
        {"listen 9000;", ":5: listen: only as a message"},
        {"units /no/such/take.bvh legato;", ":5: units: /no/such/take.bvh"},
        {"take /no/such/take.c3d;", ":5: /no/such/take.c3d"},
        {"kettle shape /no/such/grid.txt;", ":5: kettle: shape: /no/such/grid.txt"},
        {"kettle shape triangle;",
         ":5: kettle: shape: triangle, expected circle, rectangle LENGTH WIDTH, modes FILE, "},
        {"stroke 1 left legato f centr;",
         ":5: centr: no spot (center normal rim crossstick rimshot click shell), not dead, no drum"},
        {"stroke 1 left legato f rim secnd;",
         ":5: secnd: not dead, no drum (kettle second), did you"},
        {"at 1 secnd tune A2;", ":5: secnd: no drum (kettle second), did you mean second?"},
        {"secnd tune A2;", ":5: secnd: no drum (kettle second), did you mean second?"},
        {"record /no/such/folder/x.bvh;", ":5: record: /no/such/folder/x.bvh"},
        {"stroke 1 left legato loud;", ":5: stroke: DYNAMIC: loud"},
        {"kettle modes 0;", ":5: kettle: modes: 0, expected 1 .. 2000"}};
    himc_performance *p = with_kettle();
    char before[4096] = "", after[4096], text[400];
    session_do(p, "stroke 1 left legato mf");
    himc_performance_describe(p, HIMC_DESCRIBE_INFO, keep_line, before);
    for (size_t i = 0; i < sizeof faults / sizeof faults[0]; i++) {
        snprintf(text, sizeof text,
                 "grip french; drum second 29;\nkettle tune 150; player 1.9 90;\n"
                 "stroke 0 left legato mf; stroke 2 left legato mf;\nsecond mallet wood;\n%s\n",
                 faults[i][0]);
        TEST_ASSERT_FALSE_MESSAGE(load_text(p, text), faults[i][0]);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, faults[i][1]), error.text);
        after[0] = 0;
        himc_performance_describe(p, HIMC_DESCRIBE_INFO, keep_line, after);
        TEST_ASSERT_EQUAL_STRING(before, after);
    }
    heard h = {0};
    session_do(p, "play");
    session_play(p, 4, &h);
    TEST_ASSERT_EQUAL_INT(1, h.strikes); // the one stroke there was
    heard_free(&h);
    himc_performance_free(p);
}

static void test_score_with_too_many_drums_changes_nothing(void)
{
    himc_performance *p = with_kettle();
    char text[1200] = "";
    for (int i = 0; i < HIMC_DRUMS; i++)
        snprintf(text + strlen(text), sizeof text - strlen(text), "drum drum%d;\n", i);
    TEST_ASSERT_FALSE(load_text(p, text));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, "16 drums at most"), error.text);
    TEST_ASSERT_NULL(himc_performance_drum(p, 1));
    text[0] = 0;
    for (int i = 0; i <= HIMC_DRUMS; i++)
        snprintf(text + strlen(text), sizeof text - strlen(text), "drum other%d;\n", i);
    TEST_ASSERT_FALSE(load_text(p, text));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, ":16: drum other15: "), error.text);
    TEST_ASSERT_NULL(himc_performance_drum(p, 1));
    himc_performance_free(p);
}

static void test_play_without_strokes_gives_a_note(void)
{
    himc_performance *p = with_kettle();
    heard h = {0};
    session_do(p, "play");
    session_play(p, 0.1, &h);
    TEST_ASSERT_EQUAL_INT(1, h.notes);
    TEST_ASSERT_EQUAL_STRING("play: nothing to play: no strokes, no take", h.note);
    heard_free(&h);
    himc_performance_free(p);
}

static void test_seek_continues_from_another_beat(void)
{
    himc_performance *p = with_kettle();
    heard h = {0};
    for (int i = 0; i < 12; i++)
        session_do(p, "stroke %d %s legato %g", i, i & 1 ? "right" : "left", i / 20.0);
    session_do(p, "play");
    session_play(p, 1.5, &h);
    session_do(p, "seek 8");
    session_play(p, 8, &h);
    TEST_ASSERT_EQUAL_INT(2 + 4, h.strikes); // a hand that needs time shifts the beats
    heard_free(&h);
    himc_performance_free(p);
}

static double apex_before(const char *nuance, double gap, const char *before)
{
    himc_planner_config config = himc_planner_default();
    himc_planner *planner = himc_planner_new(&config, &error);
    double high = 0;
    const char *strokes[2] = {before, nuance};
    himc_tempo_change tempo = {0, 60};
    himc_planner_set_tempi(planner, &tempo, 1, &error);
    himc_planner_set_drum(planner, 0, &(himc_head_frame){.center = {0.75, 0, 0.85}, .radius = 0.3});
    for (int i = 0; i < 2; i++) {
        himc_command c;
        char text[64];
        snprintf(text, sizeof text, "stroke %g right %s mf", 2 + i * gap, strokes[i]);
        TEST_ASSERT_TRUE_MESSAGE(himc_command_parse_text(&c, HIMC_PERFORMER, text, &error),
                                 error.text);
        TEST_ASSERT_TRUE(himc_planner_add(planner, &c.stroke, 0, &error));
    }
    himc_planner_play(planner, 0);
    for (double t = 0; t < 2 + gap; t += 0.004) {
        himc_planner_advance(planner, t);
        if (t > 2 + 0.55 * gap)
            high = fmax(high, himc_planner_target(planner, HIMC_RIGHT, t).x.z - 0.87);
    }
    himc_planner_free(planner);
    return high;
}

static void test_accent_is_prepared_higher_than_legato_in_every_context(void)
{
    static const double gaps[] = {0.25, 0.4, 0.6, 1, 2};
    for (int g = 0; g < 5; g++)
        for (int n = 0; n < 5; n++)
            TEST_ASSERT_TRUE_MESSAGE(apex_before("accent", gaps[g], nuances[n]) >
                                         1.02 * apex_before("legato", gaps[g], nuances[n]),
                                     nuances[n]);
}

// largest jump of the tips' acceleration between task ticks, as a share of its range
static void watch_acceleration(himc_planner *planner, double t, himc_vec3 last[HIMC_HANDS],
                               bool touching, double *jump)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_vec3 a = himc_planner_target(planner, (himc_hand)hand, t).a;
        if (!touching)
            *jump = fmax(*jump, himc_vec3_length(himc_vec3_sub(a, last[hand])));
        last[hand] = a;
    }
}

static void test_acceleration_has_no_jumps_at_any_join_even_when_the_tempo_changes(void)
{
    himc_planner_config config = himc_planner_default();
    himc_planner *planner = himc_planner_new(&config, &error);
    unsigned seed = 4;
    himc_vec3 last[HIMC_HANDS] = {{0, 0, 0}};
    double jump = 0, range = 0, tick = 4e-6;
    for (int i = 0; i < 60; i++) {
        himc_stroke s = {.beat = 2 + 0.5 * i + 0.1 * chance(&seed),
                         .hand = (himc_hand)(i & 1),
                         .nuance = (himc_nuance)choose(&seed, 5),
                         .dynamic = chance(&seed),
                         .spot = HIMC_SPOT_NORMAL};
        TEST_ASSERT_TRUE_MESSAGE(himc_planner_add(planner, &s, 0, &error), error.text);
    }
    himc_planner_play(planner, 0);
    for (long k = 0; k < 4000000; k++) {
        double t = (double)k * tick;
        if (k % 250000 == 0)
            himc_planner_tempo(planner, t, 60 + 100 * chance(&seed));
        if (k % 1000 == 0)
            himc_planner_advance(planner, t);
        watch_acceleration(planner, t, last, k == 0, &jump);
        range = fmax(range, himc_vec3_length(last[HIMC_LEFT]));
    }
    himc_planner_free(planner);
    // steps of 4 us: what is continuous changes little, a jump would stay
    printf("largest change in 4 us: %.3f %% of the range\n", 100 * jump / range);
    TEST_ASSERT_TRUE(jump < 0.01 * range);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_random_strokes_land_within_2_ms_and_on_their_spot);
    RUN_TEST(test_eight_dynamics_rise_over_20_dB);
    RUN_TEST(test_roll_of_14_a_second_is_even);
    RUN_TEST(test_roll_makes_a_crescendo_of_10_dB);
    RUN_TEST(test_loop_begins_again_on_its_whole_beat_and_ends_when_told);
    RUN_TEST(test_beats_go_on_while_a_cleared_loop_prepares_its_new_strokes);
    RUN_TEST(test_loop_that_ends_just_before_a_round_plays_that_round);
    RUN_TEST(test_tempo_bends_a_loop_without_losing_a_stroke);
    RUN_TEST(test_scores_that_are_queued_follow_each_other_at_their_own_tempi);
    RUN_TEST(test_score_with_an_error_anywhere_changes_nothing);
    RUN_TEST(test_score_with_too_many_drums_changes_nothing);
    RUN_TEST(test_play_without_strokes_gives_a_note);
    RUN_TEST(test_seek_continues_from_another_beat);
    RUN_TEST(test_accent_is_prepared_higher_than_legato_in_every_context);
    RUN_TEST(test_acceleration_has_no_jumps_at_any_join_even_when_the_tempo_changes);
    return UNITY_END();
}
