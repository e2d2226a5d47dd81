/// test_dead_stroke.c: a mallet that stays on the head after its stroke: one long contact, after
/// which hardly any tone is left; then the stick goes on with the score.
#include "session.h"

#include "drum/drum_state.h"
#include "performance/performance_state.h"

#define RATE 48000

static void keep(void *user, const himc_motion_row *row)
{
    double *height = user;
    *height = row->tip[HIMC_RIGHT].z;
}

static double seconds_of(const himc_performance *p)
{
    return (double)himc_performance_time(p) / RATE;
}

static void play_from(himc_performance *p, const char *head, const char *strokes)
{
    session_do(p, "drum low %s", head);
    session_drum(p, 0, "pickup air 0 0.2 1");
    char line[200];
    snprintf(line, sizeof line, "%s", strokes);
    for (char *s = strtok(line, ";"); s; s = strtok(NULL, ";"))
        session_do(p, "%s", s);
    session_do(p, "play");
}

// level of 0.1 s from half a second after that strike (dB)
static double later(himc_performance *p, const himc_strike *strike)
{
    static double sound[RATE / 10];
    double sum = 0;
    himc_drum *drum = himc_performance_drum(p, 0);
    himc_drum_read(drum, (uint64_t)((strike->time + 0.5) * RATE), RATE / 10, sound, NULL);
    for (int i = 0; i < RATE / 10; i++)
        sum += sound[i] * sound[i];
    return 10 * log10(sum / (RATE / 10) + 1e-30);
}

static void test_a_dead_stroke_is_as_loud_and_half_a_second_later_15_db_softer(void)
{
    static const char *const head[] = {"32", "26", "23"};
    static const char *const stroke[] = {"accent ff", "legato f", "staccato p"};
    for (int k = 0; k < 9; k++) {
        double level[2], force[2];
        for (int dead = 0; dead < 2; dead++) {
            char line[80];
            himc_performance *p = session_new();
            heard h = {0};
            snprintf(line, sizeof line, "stroke 0 right %s normal%s", stroke[k % 3],
                     dead ? " dead" : "");
            play_from(p, head[k / 3], line);
            while (h.strikes == 0 && seconds_of(p) < 3)
                session_play(p, 0.01, &h);
            TEST_ASSERT_EQUAL_INT(1, h.strikes);
            session_play(p, h.strike[0].time + 0.65 - seconds_of(p), &h);
            TEST_ASSERT_EQUAL_INT(1, h.strikes);
            TEST_ASSERT_TRUE(dead ? h.strike[0].duration > 0.1 : h.strike[0].duration < 0.01);
            level[dead] = later(p, &h.strike[0]);
            force[dead] = h.strike[0].force;
            heard_free(&h);
            himc_performance_free(p);
        }
        printf("%s inches %s: %.1f dB, %.1f free\n", head[k / 3], stroke[k % 3], level[1],
               level[0]);
        TEST_ASSERT_TRUE(level[1] < level[0] - 15);
        TEST_ASSERT_DOUBLE_WITHIN(0.02 * force[0], force[0], force[1]);
    }
}

static void test_the_stick_is_lifted_and_plays_on_in_time(void)
{
    double height = 0;
    heard h = {0};
    himc_performance *p = session_new();
    himc_performance_on_motion(p, keep, &height);
    play_from(p, "26",
              "tempo 120;stroke 0 right legato f normal dead;stroke 1 right legato mf;"
              "stroke 2 left legato mf;stroke 3 right tenuto mf dead low");
    session_play(p, 3.5, &h);
    TEST_ASSERT_EQUAL_INT(4, h.strikes);
    for (int i = 0; i < 4; i++)
        TEST_ASSERT_DOUBLE_WITHIN(0.005, h.strike[i].planned_time, h.strike[i].time);
    TEST_ASSERT_TRUE(h.strike[1].duration < 0.01 && h.strike[3].duration > 0.1);
    TEST_ASSERT_TRUE(height > 0.8675 + 0.03);
    heard_free(&h);
    himc_performance_free(p);
}

static void test_its_contact_is_told_to_its_end_and_once_as_a_touch(void)
{
    heard h = {0};
    int touches = 0;
    himc_contact_onset onset;
    himc_performance *p = session_new();
    play_from(p, "26", "tempo 120;stroke 0 right accent ff dead;stroke 4 right legato f");
    session_play(p, 3.5, &h);
    while (himc_drum_contact_next(himc_performance_drum(p, 0), &onset))
        touches++;
    himc_performance_stats stats = himc_performance_measure(p);
    TEST_ASSERT_EQUAL_INT(2, h.strikes);
    TEST_ASSERT_EQUAL_INT(2, touches);
    TEST_ASSERT_TRUE(h.strike[0].duration == stats.longest_contact);
    heard_free(&h);
    himc_performance_free(p);
}

static void test_the_word_is_kept_and_no_drum_has_it_as_its_name(void)
{
    himc_command c;
    himc_text_lines lines = {0};
    TEST_ASSERT_TRUE(himc_command_parse_text(&c, HIMC_PERFORMER,
                                             "stroke 2 left accent f 0.1 0.2 dead low", &error));
    himc_written_stroke(&lines, &c.stroke);
    TEST_ASSERT_EQUAL_STRING("stroke 2 left accent f 0.1 0.2 dead low;\n", lines.bytes);
    free(lines.bytes);
    himc_performance *p = session_new();
    TEST_ASSERT_FALSE(session_try(p, "drum dead"));
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_dead_stroke_is_as_loud_and_half_a_second_later_15_db_softer);
    RUN_TEST(test_the_stick_is_lifted_and_plays_on_in_time);
    RUN_TEST(test_its_contact_is_told_to_its_end_and_once_as_a_touch);
    RUN_TEST(test_the_word_is_kept_and_no_drum_has_it_as_its_name);
    return UNITY_END();
}
