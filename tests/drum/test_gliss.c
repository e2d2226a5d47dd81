/// test_gliss.c: the pedal moves while the head sounds: evenly in pitch, without noise, to where
/// `tune` would have set it, by message and at a beat.
#include "session.h"

#include "drum/drum_performer.h"
#include "drum/membrane_state.h"

#include <math.h>

#define RATE 48000
#define SECOND RATE
#define LATE (500 * 0.04) // so far a drum is behind its performer or ahead (cents in a second)

static himc_drum *struck_drum(void)
{
    himc_drum *drum = himc_drum_new("low", 26, RATE, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(drum, error.text);
    drum_do(drum, "tune A2");
    TEST_ASSERT_TRUE(himc_drum_strike_at(drum, 0, -0.2, 0, 2, &error));
    himc_drum_advance(drum, SECOND, NULL, NULL, NULL);
    return drum;
}

static void run(himc_drum *drum, double seconds)
{
    himc_drum_advance(drum, (int)lround(seconds * RATE), NULL, NULL, NULL);
}

// of the principal mode as it sounds
static double pitch(himc_drum *drum)
{
    himc_membrane *head = himc_drum_membrane(drum);
    himc_mode mode;
    int i = 0;
    do
        mode = himc_membrane_mode(head, i++);
    while (mode.m != 1 || mode.n != 1);
    return sqrt(mode.frequency * himc_membrane_mode(head, i).frequency); // of both of the pair
}

static double cents(double hz, double of)
{
    return 1200 * log2(hz / of);
}

static void test_a_gliss_is_even_in_pitch_and_ends_where_tune_does(void)
{
    himc_drum *drum = struck_drum(), *tuned = struck_drum();
    double from = pitch(drum);
    drum_do(tuned, "tune D3");
    double way = cents(pitch(tuned), from);
    drum_do(drum, "gliss D3 0.8");
    for (int i = 1; i <= 4; i++) {
        run(drum, 0.2); // 50 of 200 steps
        TEST_ASSERT_DOUBLE_WITHIN(1.01 * way / 200, i * way / 4, cents(pitch(drum), from));
    }
    run(drum, 0.001);
    himc_drum_settings a = himc_drum_settings_of(drum), b = himc_drum_settings_of(tuned);
    TEST_ASSERT_TRUE(himc_membrane_config_equal(&a.head, &b.head));
    himc_drum_settings_free(&a);
    himc_drum_settings_free(&b);
    himc_drum_release(drum);
    himc_drum_release(tuned);
}

static void hear(himc_drum *drum, int block, double *sound, int length)
{
    for (int at = 0, n; at < length; at += n) {
        n = block < length - at ? block : length - at;
        himc_drum_advance(drum, n, NULL, NULL, NULL);
        himc_drum_read(drum, himc_drum_time(drum) - (uint64_t)n, n, sound + at, NULL);
    }
}

static void test_a_gliss_is_the_same_in_blocks_of_any_size(void)
{
    enum { LENGTH = RATE };
    static double sound[3][LENGTH];
    static const int block[] = {1, 64, 5000};
    for (int k = 0; k < 3; k++) {
        himc_drum *drum = struck_drum();
        drum_do(drum, "gliss F2 0.5");
        TEST_ASSERT_TRUE(himc_drum_strike_at(drum, 7777, -0.2, 0.05, 3, &error));
        hear(drum, block[k], sound[k], LENGTH);
        himc_drum_release(drum);
    }
    TEST_ASSERT_EQUAL_MEMORY(sound[0], sound[1], sizeof sound[0]);
    TEST_ASSERT_EQUAL_MEMORY(sound[0], sound[2], sizeof sound[0]);
}

// level (dB) of what is high in a sound: above some kHz, its third differences
static double high_level(const double *sound, int length)
{
    double sum = 0;
    for (int i = 3; i < length; i++) {
        double d = sound[i] - 3 * sound[i - 1] + 3 * sound[i - 2] - sound[i - 3];
        sum += d * d;
    }
    return 10 * log10(sum / length);
}

static void test_the_steps_of_a_gliss_are_not_heard(void)
{
    enum { LENGTH = 2 * RATE };
    static double sound[LENGTH];
    static const char *const moves[] = {"gliss D3 0.8", "gliss E2 0.3", "gliss A3 2"};
    for (int k = 0; k < 3; k++) {
        himc_drum *drum = struck_drum();
        run(drum, 1); // the high modes are over
        drum_do(drum, moves[k]);
        hear(drum, 64, sound, LENGTH);
        TEST_ASSERT_TRUE(high_level(sound, LENGTH) < -110);
        himc_drum_release(drum);
    }
}

static void test_energy_never_grows_in_a_gliss(void)
{
    static const char *const moves[] = {"gliss D3 0.3", "gliss C2 0.3", "gliss C4 0.1"};
    himc_drum *drum = struck_drum();
    himc_membrane *head = himc_drum_membrane(drum);
    double before = himc_membrane_energy(head);
    for (int k = 0; k < 3; k++) {
        drum_do(drum, moves[k]);
        for (int i = 0; i < 300; i++) {
            himc_drum_advance(drum, 50, NULL, NULL, NULL);
            double now = himc_membrane_energy(head);
            TEST_ASSERT_TRUE(now <= before * (1 + 1e-9));
            before = now;
        }
    }
    TEST_ASSERT_TRUE(before > 0);
    himc_drum_release(drum);
}

static void test_what_is_sent_meanwhile_replaces_a_gliss_or_lets_it_go_on(void)
{
    himc_drum *drum = struck_drum();
    double from = pitch(drum);
    drum_do(drum, "gliss D3 0.8");
    run(drum, 0.4);
    drum_do(drum, "damp 0.5"); // the hand leaves the pedal alone
    TEST_ASSERT_EQUAL_DOUBLE(0.5, himc_membrane_head(himc_drum_membrane(drum))->damp);
    run(drum, 0.401);
    TEST_ASSERT_DOUBLE_WITHIN(1, 500, cents(pitch(drum), from));
    TEST_ASSERT_EQUAL_DOUBLE(0.5, himc_membrane_head(himc_drum_membrane(drum))->damp);
    drum_do(drum, "gliss A3 0.8");
    run(drum, 0.4);
    drum_do(drum, "gliss D3 0.2"); // back from half way
    run(drum, 0.201);
    TEST_ASSERT_DOUBLE_WITHIN(1, 500, cents(pitch(drum), from));
    drum_do(drum, "gliss A3 0.8");
    run(drum, 0.1);
    drum_do(drum, "tune A2");
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 0, cents(pitch(drum), from));
    run(drum, 1);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 0, cents(pitch(drum), from));
    himc_drum_release(drum);
}

// in a score

#define SCORE "build/gliss.txt"
#define DRUM \
    "drum low 26; low tune A2; tempo 120; stroke 1 right legato f; stroke 8 left legato f; "

static himc_drum *low(himc_performance *p)
{
    return himc_performance_drum(p, 0);
}

static himc_performance *with_score(const char *lines)
{
    char text[500];
    himc_performance *p = session_new();
    snprintf(text, sizeof text, DRUM "%s play;", lines);
    session_score(p, SCORE, text);
    return p;
}

static void test_a_gliss_in_a_score_moves_and_is_told_as_written(void)
{
    himc_performance *p = with_score("at 2 low gliss D3 0.8; at 4 low gliss A2 0.4;");
    double from = pitch(low(p));
    session_play(p, 1.402, NULL); // beat 2 is at 1 s
    TEST_ASSERT_DOUBLE_WITHIN(LATE / 0.8, 250, cents(pitch(low(p)), from));
    session_play(p, 0.5, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(0.5, 500, cents(pitch(low(p)), from));
    session_play(p, 0.302, NULL); // beat 4 is at 2 s
    TEST_ASSERT_DOUBLE_WITHIN(LATE / 0.4, 250, cents(pitch(low(p)), from));
    session_play(p, 0.5, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(0.5, 0, cents(pitch(low(p)), from));
    session_do(p, "dump %s", SCORE);
    himc_performance_free(p);
    char dump[20000] = "";
    FILE *file = fopen(SCORE, "r");
    dump[fread(dump, 1, sizeof dump - 1, file)] = '\0';
    fclose(file);
    TEST_ASSERT_NOT_NULL(strstr(dump, "at 2 low gliss D3 0.8;"));
    TEST_ASSERT_NOT_NULL(strstr(dump, "low tension "));
}

// made ahead or when its beat comes, in the first round or the second
static void test_a_gliss_at_a_beat_sounds_as_the_command_given_then(void)
{
    enum { LENGTH = 3 * RATE, AT = RATE };
    static double written[LENGTH], given[LENGTH];
    double *sound[] = {written, given};
    for (int k = 0; k < 2; k++) {
        himc_performance *p = with_score(k == 0 ? "at 2 low gliss C3 0.5;" : "");
        for (int at = 0; at < LENGTH; at += 480) {
            if (k == 1 && at == AT)
                session_drum(p, 0, "gliss C3 0.5");
            himc_performance_process(p, 480, NULL);
            himc_drum_read(low(p), (uint64_t)at, 480, sound[k] + at, NULL);
        }
        himc_performance_free(p);
    }
    TEST_ASSERT_EQUAL_MEMORY(given, written, sizeof given);
    TEST_ASSERT_TRUE(fabs(given[AT + 1000]) > 1e-4); // it rang
}

static void test_a_gliss_comes_again_in_each_round_of_a_loop(void)
{
    himc_performance *p = with_score("at 2 low gliss D3 0.4; at 6 low tune A2; loop 1;");
    double from = pitch(low(p));
    for (int round = 0; round < 3; round++) {
        session_play(p, 1.202, NULL);
        TEST_ASSERT_DOUBLE_WITHIN(LATE / 0.4, 250, cents(pitch(low(p)), from));
        session_play(p, 1, NULL);
        TEST_ASSERT_DOUBLE_WITHIN(0.5, 500, cents(pitch(low(p)), from));
        session_play(p, 2.298, NULL); // nine beats
    }
    himc_performance_free(p);
}

static void test_seek_finds_a_gliss_where_it_has_arrived(void)
{
    himc_performance *p = with_score("at 2 low gliss D3 0.4;");
    double from = pitch(low(p));
    session_do(p, "seek 4");
    session_play(p, 0.02, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(0.5, 500, cents(pitch(low(p)), from));
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_gliss_is_even_in_pitch_and_ends_where_tune_does);
    RUN_TEST(test_a_gliss_is_the_same_in_blocks_of_any_size);
    RUN_TEST(test_the_steps_of_a_gliss_are_not_heard);
    RUN_TEST(test_energy_never_grows_in_a_gliss);
    RUN_TEST(test_what_is_sent_meanwhile_replaces_a_gliss_or_lets_it_go_on);
    RUN_TEST(test_a_gliss_in_a_score_moves_and_is_told_as_written);
    RUN_TEST(test_a_gliss_at_a_beat_sounds_as_the_command_given_then);
    RUN_TEST(test_a_gliss_comes_again_in_each_round_of_a_loop);
    RUN_TEST(test_seek_finds_a_gliss_where_it_has_arrived);
    return UNITY_END();
}
