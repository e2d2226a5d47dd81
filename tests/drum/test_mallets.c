/// test_mallets.c: mallets in the performer's hands: a stick is as heavy as its drum's mallet.
#include "session.h"

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
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * alone.force, alone.force, hand.force);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * alone.duration, alone.duration, hand.duration);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * alone.impulse, alone.impulse, hand.impulse);
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

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_blow_of_the_hand_is_that_of_its_mallet);
    RUN_TEST(test_in_the_hand_a_wooden_stick_touches_for_3_to_6_ms);
    RUN_TEST(test_a_stick_is_no_lighter_than_its_shaft);
    return UNITY_END();
}
