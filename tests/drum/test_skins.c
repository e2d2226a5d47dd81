/// test_skins.c: a cloth on the head, and a head of calf: both ring shorter at the same pitch.
#include "session.h"

#include "drum/drum_state.h"

#include <math.h>

static himc_drum *drum_of(double inches, const char *pitch)
{
    char tune[20];
    himc_drum *drum = himc_drum_new("low", inches, 48000, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(drum, error.text);
    snprintf(tune, sizeof tune, "tune %s", pitch);
    drum_do(drum, tune);
    return drum;
}

static himc_mode mode_of(himc_drum *drum, int m, int n)
{
    himc_mode mode;
    int i = 0;
    do
        mode = himc_membrane_mode(himc_drum_membrane(drum), i++);
    while (mode.m != m || mode.n != n);
    return mode;
}

static double t60(himc_drum *drum, int m)
{
    return log(1000) / mode_of(drum, m, 1).decay;
}

static void test_a_muffled_drum_is_dry_and_has_its_pitch(void)
{
    static const char *const pitch[] = {"F2", "D3", "A3"};
    static const double inches[] = {32, 26, 23};
    for (int i = 0; i < 3; i++) {
        himc_drum *drum = drum_of(inches[i], pitch[i]);
        double ring[7], hz = mode_of(drum, 1, 1).frequency, noise = drum->noise.amount;
        for (int m = 1; m < 7; m++)
            ring[m] = t60(drum, m);
        drum_do(drum, "muffle 1");
        printf("%s: (1,1) %.2f of %.2f s, (2,1) %.2f s, (6,1) %.2f s\n", pitch[i], t60(drum, 1),
               ring[1], t60(drum, 2), t60(drum, 6));
        TEST_ASSERT_DOUBLE_WITHIN(0.12, 0.3, t60(drum, 1));
        for (int m = 1; m < 7; m++) {
            TEST_ASSERT_TRUE(t60(drum, m) < 0.5 * ring[m]);
            TEST_ASSERT_TRUE(m == 1 || t60(drum, m) < t60(drum, m - 1));
        }
        himc_mode mode = mode_of(drum, 1, 1);
        TEST_ASSERT_EQUAL_DOUBLE(hz, mode.frequency);
        TEST_ASSERT_TRUE(mode.decay < 0.1 * HIMC_PI * hz); // ten periods are heard
        TEST_ASSERT_DOUBLE_WITHIN(3, -10, 20 * log10(drum->noise.amount / noise));
        drum_do(drum, "muffle 0.5");
        TEST_ASSERT_TRUE(t60(drum, 1) > 0.33 && t60(drum, 1) < ring[1]);
        drum_do(drum, "muffle 0");
        TEST_ASSERT_EQUAL_DOUBLE(ring[1], t60(drum, 1));
        TEST_ASSERT_EQUAL_DOUBLE(noise, drum->noise.amount);
        himc_drum_release(drum);
    }
}

static void test_a_cloth_and_a_hand_add_up_and_are_two_things(void)
{
    himc_drum *drum = drum_of(26, "D3");
    double bare = mode_of(drum, 1, 1).decay;
    drum_do(drum, "damp 0.5");
    double hand = mode_of(drum, 1, 1).decay - bare;
    drum_do(drum, "muffle 0.5");
    double both = mode_of(drum, 1, 1).decay - bare;
    drum_do(drum, "damp 0");
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, both - hand, mode_of(drum, 1, 1).decay - bare);
    TEST_ASSERT_EQUAL_DOUBLE(0.5, himc_membrane_head(himc_drum_membrane(drum))->muffle);
    himc_drum_release(drum);
}

static void test_a_calf_head_is_heavier_keeps_its_pitch_and_loses_its_upper_partials(void)
{
    himc_drum *drum = drum_of(26, "D3");
    himc_membrane *head = himc_drum_membrane(drum);
    double plastic[7], pitch = himc_membrane_principal(head, himc_membrane_head(head));
    double tension = himc_membrane_head(head)->tension;
    for (int m = 1; m < 7; m++)
        plastic[m] = t60(drum, m);
    drum_do(drum, "skin plastic");
    TEST_ASSERT_EQUAL_DOUBLE(tension, himc_membrane_head(head)->tension);
    TEST_ASSERT_EQUAL_DOUBLE(plastic[6], t60(drum, 6));
    drum_do(drum, "skin calf");
    TEST_ASSERT_DOUBLE_WITHIN(0.026, 0.375, himc_membrane_head(head)->density);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5 * pitch, pitch,
                              himc_membrane_principal(head, himc_membrane_head(head)));
    for (int m = 1; m < 7; m++)
        printf("(%d,1) %.2f s, %.2f s of plastic\n", m, t60(drum, m), plastic[m]);
    TEST_ASSERT_TRUE(t60(drum, 4) < 0.75 * plastic[4] && t60(drum, 6) < 0.6 * plastic[6]);
    TEST_ASSERT_TRUE(t60(drum, 6) / plastic[6] < t60(drum, 2) / plastic[2]);
    drum_do(drum, "skin plastic");
    TEST_ASSERT_DOUBLE_WITHIN(1e-5 * tension, tension, himc_membrane_head(head)->tension);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4 * plastic[6], plastic[6], t60(drum, 6));
    himc_drum_release(drum);
}

static void test_a_calf_head_rings_shorter_on_every_drum_at_every_pitch(void)
{
    static const struct {
        double inches;
        const char *pitch[3];
    } sets[] = {{32, {"C2", "F2", "A2"}},
                {29, {"F2", "A2", "D3"}},
                {26, {"A2", "D3", "F3"}},
                {23, {"D3", "F3", "A3"}}};
    for (int i = 0; i < 12; i++) {
        himc_drum *drum = drum_of(sets[i / 3].inches, sets[i / 3].pitch[i % 3]);
        double plastic[7];
        for (int m = 1; m < 7; m++)
            plastic[m] = t60(drum, m);
        drum_do(drum, "skin calf");
        printf("%g %s: (1,1) %.2f of %.2f s\n", sets[i / 3].inches, sets[i / 3].pitch[i % 3],
               t60(drum, 1), plastic[1]);
        for (int m = 1; m < 7; m++)
            TEST_ASSERT_TRUE(t60(drum, m) < 0.9 * plastic[m]);
        himc_drum_release(drum);
    }
}

static void test_a_cloth_lies_on_the_head_from_its_beat_on(void)
{
    himc_performance *p = session_new();
    session_score(p, "build/skins.txt",
                  "drum low 26; tempo 120; at 2 low muffle 1; at 4 low damp 1; at 4.5 low damp 0; "
                  "stroke 1 left legato f; stroke 8 left legato f; play;");
    himc_drum *drum = himc_performance_drum(p, 0);
    double noise = drum->noise.amount;
    session_play(p, 0.9, NULL);
    TEST_ASSERT_EQUAL_DOUBLE(0, himc_membrane_head(himc_drum_membrane(drum))->muffle);
    session_play(p, 0.2, NULL);
    TEST_ASSERT_EQUAL_DOUBLE(1, himc_membrane_head(himc_drum_membrane(drum))->muffle);
    TEST_ASSERT_TRUE(drum->noise.amount < 0.5 * noise);
    session_play(p, 1.5, NULL); // the hand has come and gone
    TEST_ASSERT_EQUAL_DOUBLE(1, himc_membrane_head(himc_drum_membrane(drum))->muffle);
    TEST_ASSERT_EQUAL_DOUBLE(0, himc_membrane_head(himc_drum_membrane(drum))->damp);
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_muffled_drum_is_dry_and_has_its_pitch);
    RUN_TEST(test_a_cloth_and_a_hand_add_up_and_are_two_things);
    RUN_TEST(test_a_calf_head_is_heavier_keeps_its_pitch_and_loses_its_upper_partials);
    RUN_TEST(test_a_calf_head_rings_shorter_on_every_drum_at_every_pitch);
    RUN_TEST(test_a_cloth_lies_on_the_head_from_its_beat_on);
    return UNITY_END();
}
