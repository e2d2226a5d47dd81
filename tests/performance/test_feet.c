/// test_feet.c: strokes that a foot plays.
#include "osc_ear.h"

#include "performance/performance_state.h"
#include "performance/research.h"

static void load(const char *text)
{
    himc_error error = {.text = ""};
    TEST_ASSERT_TRUE_MESSAGE(himc_performance_load_text(performance, text, "s.txt", &error),
                             error.text);
}

typedef struct heard_stroke {
    double time;
    const char *hand, *drum;
    double velocity, force;
} heard_stroke;

// stroke k of those heard
static heard_stroke stroke(int k)
{
    for (int i = 0; i < heard_count; i++)
        if (strcmp(heard[i].path, "/himc/strike") == 0 && k-- == 0) {
            lo_arg **a = lo_message_get_argv(heard[i].message);
            return (heard_stroke){number(a[0]), word(a[1]), word(a[2]), number(a[5]), number(a[6])};
        }
    TEST_FAIL_MESSAGE("no such stroke");
    return (heard_stroke){0};
}

static void test_a_foot_plays_on_its_beat_beside_the_hands(void)
{
    static const double beat[] = {0, 1, 1.75, 2, 2.5};
    subscribe("strikes");
    load("drum kick 22; kick place .7 -.4 .5; drum s 14; s place .5 .1 .85; tempo 90;"
         "stroke 1 right legato f s; stroke 0 foot legato f kick; stroke 1.75 foot legato p kick;"
         "tempo 45 2; stroke 2 foot legato f kick; stroke 2.5 left legato f s;");
    say("/himc/play", "");
    play(4);
    TEST_ASSERT_EQUAL_STRING("", last_error());
    TEST_ASSERT_EQUAL_INT(5, count("/himc/strike"));
    for (int i = 0; i < 5; i++) {
        bool foot = i != 1 && i != 4;
        double due = fmin(beat[i], 2) / 1.5 + fmax(beat[i] - 2, 0) / .75;
        TEST_ASSERT_EQUAL_STRING(foot ? "foot" : i == 1 ? "right" : "left", stroke(i).hand);
        TEST_ASSERT_EQUAL_STRING(foot ? "kick" : "s", stroke(i).drum);
        TEST_ASSERT_DOUBLE_WITHIN(2e-4, due, stroke(i).time - stroke(0).time);
    }
    TEST_ASSERT_TRUE(stroke(2).force < .6 * stroke(0).force);
    TEST_ASSERT_DOUBLE_WITHIN(.03 * stroke(0).force, stroke(0).force, stroke(3).force);
}

static void test_feet_alone_play_a_loop_and_stop_when_cleared(void)
{
    subscribe("strikes");
    load("drum kick 22; tempo 120; stroke 0 foot legato f kick; stroke 1.5 foot legato f kick;"
         "loop 1;");
    say("/himc/play", "");
    play(2.1); // two rounds of a second, and the first stroke of the third
    TEST_ASSERT_EQUAL_INT(5, count("/himc/strike"));
    for (int i = 1; i < 5; i++)
        TEST_ASSERT_DOUBLE_WITHIN(2e-4, i % 2 ? .75 : .25, stroke(i).time - stroke(i - 1).time);
    say("/himc/clear", "");
    play(2);
    TEST_ASSERT_EQUAL_INT(5, count("/himc/strike"));
}

static void test_a_foot_follows_a_message_and_a_seek(void)
{
    subscribe("strikes");
    load("drum kick 22; tempo 60;");
    say("/himc/hit", "foot legato f kick");
    play(.5);
    TEST_ASSERT_EQUAL_INT(1, count("/himc/strike"));
    say("/himc/stroke", "1 foot legato f kick");
    say("/himc/stroke", "3 foot legato f kick");
    say("/himc/seek", "2");
    say("/himc/play", "");
    play(1.5);
    TEST_ASSERT_EQUAL_INT(2, count("/himc/strike"));
    say("/himc/stroke", "6 foot legato f dead kick");
    play(.1);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(last_error(), "foot: expected plain strokes only"),
                                 last_error());
    say("/himc/stroke", "6 foot legato f 0.9 0 kick");
    play(.1);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(last_error(), "foot: strike: X: 0.9 m"), last_error());
}

static void test_no_hand_is_sent_to_a_kick_on_the_floor(void)
{
    static const char line[] = "stroke on kick: no hand reaches it, expected foot";
    himc_error error = {.text = ""};
    subscribe("strikes");
    load("setup kit;");
    TEST_ASSERT_FALSE(
        himc_performance_load_text(performance, "stroke 1 right legato mf kick;", "s.txt", &error));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, line), error.text);
    say("/himc/hit", "left legato mf kick");
    play(.5);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(last_error(), line), last_error());
    TEST_ASSERT_EQUAL_INT(0, count("/himc/strike"));
    say("/himc/hit", "any legato mf kick");
    play(.5);
    TEST_ASSERT_EQUAL_INT(1, count("/himc/strike"));
    TEST_ASSERT_EQUAL_STRING("foot", stroke(0).hand);
}

static void test_hands_play_a_kick_that_is_at_their_height(void)
{
    subscribe("strikes");
    load("instrument high kick 22; high place .75 0 .8; tempo 60; stroke 2 right legato f high;");
    say("/himc/play", "");
    play(3);
    TEST_ASSERT_EQUAL_STRING("", last_error());
    TEST_ASSERT_EQUAL_INT(1, count("/himc/strike"));
    TEST_ASSERT_EQUAL_STRING("right", stroke(0).hand);
}

static void refuses(const char *stroke, const char *reason)
{
    himc_error error = {.text = ""};
    char text[160];
    snprintf(text, sizeof text, "instrument kick kick 22; %s", stroke);
    TEST_ASSERT_FALSE_MESSAGE(himc_performance_load_text(performance, text, "s.txt", &error), text);
    TEST_ASSERT_EQUAL_STRING(reason, error.text);
}

static void test_what_no_foot_plays_is_refused_in_one_line(void)
{
    refuses("stroke 1 foot legato f rim kick;",
            "s.txt:1: foot: rim: the beater meets one place, expected no SPOT");
    refuses("roll 1 1 single f foot kick;",
            "s.txt:1: roll: foot: both hands play it, expected no HAND");
}

static void test_a_foot_s_strokes_are_as_far_apart_as_one_plays_them(void)
{
    himc_event event;
    int strikes = 0, missed = 0;
    load("setup kit; tempo 60; stroke 0 foot legato f kick; stroke 0 foot legato f hats;"
         "stroke 0.02 foot legato f kick; stroke 0.04 foot legato f kick;"
         "stroke 0.12 foot legato f kick; stroke 1 foot legato f kick;");
    himc_performance_send(performance, "play", NULL);
    for (int i = 0; i < 400; i++) {
        himc_performance_process(performance, 480, NULL);
        while (himc_performance_event(performance, &event)) {
            strikes += event.kind == HIMC_EVENT_STRIKE;
            if (event.kind == HIMC_EVENT_MISSED && missed++ > 0)
                TEST_ASSERT_EQUAL_STRING(
                    "0.04 s after the foot's last stroke, expected 0.08 s or more", event.text);
        }
    }
    TEST_ASSERT_EQUAL_INT(4, strikes); // the hats are the other foot's
    TEST_ASSERT_EQUAL_INT(2, missed);
    himc_performance_stats stats = himc_performance_measure(performance);
    TEST_ASSERT_EQUAL_INT(6, stats.strokes);
    TEST_ASSERT_EQUAL_INT(2, stats.missed);
}

static void test_the_way_to_another_pedal_takes_time(void)
{
    himc_event event;
    int strikes = 0, missed = 0;
    load("instrument a kick 22; a place .8 .3 .1 .8; instrument b kick 22; b place .8 -.3 .1 .8;"
         "tempo 60; stroke 0 foot legato f a; stroke .15 foot legato f b;"
         "stroke .5 foot legato f b;");
    himc_performance_send(performance, "play", NULL);
    for (int i = 0; i < 200; i++) {
        himc_performance_process(performance, 480, NULL);
        while (himc_performance_event(performance, &event)) {
            strikes += event.kind == HIMC_EVENT_STRIKE;
            missed += event.kind == HIMC_EVENT_MISSED;
        }
    }
    TEST_ASSERT_EQUAL_INT(2, strikes);
    TEST_ASSERT_EQUAL_INT(1, missed);
}

static void test_the_largest_force_is_also_a_foot_s(void)
{
    subscribe("strikes");
    load("instrument kick kick 22; kick place .8 .1 .1 .8; tempo 60; stroke 3 foot legato f kick;");
    say("/himc/play", "");
    play(5);
    TEST_ASSERT_EQUAL_STRING("", last_error()); // out of the hands' reach is no matter
    TEST_ASSERT_TRUE(stroke(0).force > 20);
    TEST_ASSERT_FLOAT_WITHIN(0.01, stroke(0).force,
                             himc_performance_measure(performance).peak_force);
}

static void test_a_foot_s_strike_has_its_beat(void)
{
    himc_event event;
    double beat = NAN;
    load("instrument kick kick 22; tempo 60; stroke 0 foot legato f kick;"
         "stroke 1.5 foot legato f kick;");
    himc_performance_send(performance, "play", NULL);
    for (int i = 0; i < 300; i++) {
        himc_performance_process(performance, 480, NULL);
        while (himc_performance_event(performance, &event))
            beat = event.kind == HIMC_EVENT_STRIKE ? event.strike.beat : beat;
    }
    TEST_ASSERT_EQUAL_DOUBLE(1.5, beat);
}

#define KIT "setup kit; tempo 60; stroke 4 right legato f snare; "

static himc_performance *kit(const char *strokes)
{
    himc_error error;
    himc_performance_config config = himc_performance_default();
    himc_performance *p = himc_performance_new(&config, &error);
    TEST_ASSERT_TRUE_MESSAGE(himc_performance_load_text(p, strokes, "s.txt", &error), error.text);
    return p;
}

static void test_strokes_that_a_foot_has_played_are_not_exchanged(void)
{
    float out[2 * 480];
    himc_error error;
    himc_command start;
    himc_performance *p = kit(KIT "stroke 0 foot legato f kick; stroke 2 foot legato f kick;"),
                     *other[] = {
                         kit(KIT "stroke 0 foot legato p kick; stroke 2 foot legato f kick;"),
                         kit(KIT "stroke 0 foot legato f kick; stroke 2 foot legato p kick;")};
    TEST_ASSERT_TRUE(himc_command_parse_text(&start, HIMC_PERFORMER, "play", &error) &&
                     himc_performance_command(p, &start, 0, &error));
    for (int k = 0; k < 100; k++)
        himc_performance_read(p, out, 2, 480);
    for (int later = 0; later < 2; later++) {
        TEST_ASSERT_EQUAL(later == 1, himc_performance_exchange_strokes(p, other[later]));
        himc_performance_free(other[later]);
    }
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_strokes_that_a_foot_has_played_are_not_exchanged);
    RUN_TEST(test_a_foot_plays_on_its_beat_beside_the_hands);
    RUN_TEST(test_feet_alone_play_a_loop_and_stop_when_cleared);
    RUN_TEST(test_what_no_foot_plays_is_refused_in_one_line);
    RUN_TEST(test_a_foot_s_strokes_are_as_far_apart_as_one_plays_them);
    RUN_TEST(test_the_way_to_another_pedal_takes_time);
    RUN_TEST(test_the_largest_force_is_also_a_foot_s);
    RUN_TEST(test_a_foot_s_strike_has_its_beat);
    RUN_TEST(test_a_foot_follows_a_message_and_a_seek);
    RUN_TEST(test_no_hand_is_sent_to_a_kick_on_the_floor);
    RUN_TEST(test_hands_play_a_kick_that_is_at_their_height);
    return UNITY_END();
}
