/// test_mallets.c: mallets in the performer's hands: a stick is as heavy as its drum's mallet.
#include "session.h"

#include "drum/drum_performer.h"

#define MODE_COUNT 2 // with a simulated body, and without

static const char *const MODES[MODE_COUNT] = {"himc", "ik"};

// one stroke on a drum with that mallet
static himc_strike played(const char *mode, const char *mallet, const char *dynamic)
{
    himc_performance *p = session_new();
    heard h = {0};
    session_do(p, "drum kettle");
    session_do(p, "mode %s", mode);
    session_drum(p, 0, mallet);
    session_do(p, "stroke 1 right accent %s", dynamic);
    session_do(p, "play");
    session_play(p, 1.5, &h);
    TEST_ASSERT_EQUAL_INT(1, h.strikes);
    himc_strike strike = h.strike[0];
    heard_free(&h);
    himc_performance_free(p);
    return strike;
}

// the same blow of a mallet without a hand
static himc_contact_report thrown(const himc_strike *as, const char *mallet)
{
    himc_performance *p = session_new();
    himc_contact_report report;
    session_do(p, "drum kettle");
    session_drum(p, 0, mallet);
    himc_drum *drum = himc_performance_drum(p, 0);
    TEST_ASSERT_TRUE(himc_drum_strike_at(drum, 0, as->x, as->y, as->velocity, &error));
    session_play(p, 0.5, NULL);
    TEST_ASSERT_TRUE(himc_drum_strike_next(drum, &report));
    himc_performance_free(p);
    return report;
}

static void agrees(const char *mode, const char *mallet, const char *dynamic)
{
    himc_strike hand = played(mode, mallet, dynamic);
    himc_contact_report alone = thrown(&hand, mallet);
    printf("%s, %s, %s: %.1f and %.1f N, %.2f and %.2f ms, %.1f and %.1f mN s\n", mode, mallet,
           dynamic, hand.force, alone.force, 1e3 * hand.duration, 1e3 * alone.duration,
           1e3 * hand.impulse, 1e3 * alone.impulse);
    TEST_ASSERT_DOUBLE_WITHIN(0.03 * alone.force, alone.force, hand.force);
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * alone.duration, alone.duration, hand.duration);
    TEST_ASSERT_DOUBLE_WITHIN(0.05 * alone.impulse, alone.impulse, hand.impulse);
}

// the arm moves only its own share of it, so both ends keep together
static void test_a_blow_of_the_hand_is_that_of_its_mallet(void)
{
    for (int i = 0; i < MODE_COUNT; i++) {
        agrees(MODES[i], "mallet soft", "mf");
        agrees(MODES[i], "mallet medium", "ff");
        agrees(MODES[i], "mallet wood", "p");
        agrees(MODES[i], "mallet 1.6e8 2.54 0.05", "mf");
    }
}

// Wagner 2006
static void test_in_the_hand_a_wooden_stick_touches_for_3_to_6_ms(void)
{
    static const char *const dynamics[] = {"ppp", "mf", "fff"};
    for (int i = 0; i < 3; i++) {
        double time = played("himc", "mallet wood", dynamics[i]).duration;
        printf("%s: %.2f ms\n", dynamics[i], 1e3 * time);
        TEST_ASSERT_TRUE(time > 3e-3 && time < 6e-3);
    }
}

static void test_a_stick_is_no_lighter_than_its_shaft(void)
{
    himc_strike light = played("himc", "mallet 1.6e8 2.54 0.001", "mf"),
                shaft = played("himc", "mallet 1.6e8 2.54 0.0068", "mf");
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * shaft.impulse, shaft.impulse, light.impulse);
}

// a stroke of each hand, half a second apart
static void play_both(const char *first, const char *second, double force[2], double duration[2])
{
    himc_performance *p = session_new();
    heard h = {0};
    session_do(p, "drum kettle");
    session_drum(p, 0, first);
    session_drum(p, 0, second);
    session_do(p, "tempo 120");
    session_do(p, "stroke 1 left legato mf");
    session_do(p, "stroke 3 right legato mf");
    session_do(p, "play");
    session_play(p, 2.5, &h);
    TEST_ASSERT_EQUAL_INT(2, h.strikes);
    for (int i = 0; i < 2; i++) {
        force[h.strike[i].hand] = h.strike[i].force;
        duration[h.strike[i].hand] = h.strike[i].duration;
    }
    heard_free(&h);
    himc_performance_free(p);
}

static void test_each_hand_may_have_its_mallet_on_one_drum(void)
{
    double force[2], duration[2], soft[2], soft_time[2], wood[2], wood_time[2];
    play_both("mallet left soft", "mallet right wood", force, duration);
    play_both("mallet soft", "noise 1", soft, soft_time);
    play_both("mallet wood", "noise 1", wood, wood_time);
    TEST_ASSERT_EQUAL_DOUBLE(soft[HIMC_LEFT], force[HIMC_LEFT]); // the first stroke of all
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * wood[HIMC_RIGHT], wood[HIMC_RIGHT], force[HIMC_RIGHT]);
    TEST_ASSERT_DOUBLE_WITHIN(0.05 * wood_time[1], wood_time[1], duration[HIMC_RIGHT]);
    TEST_ASSERT_TRUE(duration[HIMC_LEFT] > 1.05 * duration[HIMC_RIGHT]);
}

static char told[2000];

static void tell(void *user, const char *line)
{
    (void)user;
    strcat(strcat(told, line), ";");
}

static void test_both_mallets_are_told_and_can_be_told_again(void)
{
    himc_drum *drum = himc_drum_new("kettle", 26, 48000, &error);
    static const char *const said[] = {"mallet left 2e7 2.5 0.02", "mallet right hard"};
    himc_command c;
    for (int i = 0; i < 2; i++) {
        TEST_ASSERT_TRUE(himc_command_parse_text(&c, HIMC_DRUM, said[i], &error));
        TEST_ASSERT_TRUE(himc_drum_command(drum, &c, &error));
    }
    himc_drum_describe(drum, HIMC_DESCRIBE_STATE, tell, NULL);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(told, ";mallet left 2e+07 2.5 0.02;mallet right hard;"),
                                 told);
    TEST_ASSERT_TRUE(himc_command_parse_text(&c, HIMC_DRUM, "mallet soft", &error));
    TEST_ASSERT_TRUE(himc_drum_command(drum, &c, &error)); // of both hands
    TEST_ASSERT_EQUAL_MEMORY(himc_drum_mallet(drum, HIMC_LEFT), himc_drum_mallet(drum, HIMC_RIGHT),
                             sizeof(himc_mallet_head));
    himc_drum_release(drum);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_blow_of_the_hand_is_that_of_its_mallet);
    RUN_TEST(test_in_the_hand_a_wooden_stick_touches_for_3_to_6_ms);
    RUN_TEST(test_a_stick_is_no_lighter_than_its_shaft);
    RUN_TEST(test_each_hand_may_have_its_mallet_on_one_drum);
    RUN_TEST(test_both_mallets_are_told_and_can_be_told_again);
    return UNITY_END();
}
