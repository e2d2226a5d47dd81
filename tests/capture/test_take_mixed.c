/// test_take_mixed.c: strikes told from motions in the air, in takes played from pp to ff.
///
/// Set a has blows of 0.8 to 8 m/s and smooth turns in the air, set b blows of 0.5 to 8 m/s and
/// turns as abrupt as blows. Everyday one take for each rate and noise is read, with HIMC_LONG ten.
#include "mixed_takes.h"

#include "session.h"

#define SETS 2
#define RATES 5
#define NOISES 4

static const mixed_config sets[SETS] = {{.seconds = 30,
                                         .slowest = 0.8,
                                         .fastest = 8,
                                         .air = 0.35,
                                         .slow_air = 0.3,
                                         .fast_air = 3,
                                         .low_air = 0.02,
                                         .high_air = 0.15,
                                         .tilt = 0.12},
                                        {.seconds = 30,
                                         .slowest = 0.5,
                                         .fastest = 8,
                                         .air = 0.35,
                                         .abrupt = true,
                                         .slow_air = 0.3,
                                         .fast_air = 1,
                                         .low_air = 0.03,
                                         .high_air = 0.15,
                                         .tilt = 0.12}};
static const double rates[RATES] = {60, 100, 250, 500, 1000};
static const double noises[NOISES] = {0.2e-3, 0.5e-3, 1e-3, 2e-3};

static mixed_truth truth;

static himc_strike_survey survey_of(himc_take *take)
{
    himc_take_tip tips[HIMC_HANDS];
    himc_strike_survey s;
    TEST_ASSERT_TRUE_MESSAGE(himc_take_tips(take, NULL, tips, &error), error.text);
    TEST_ASSERT_TRUE(himc_take_strikes(take, tips, &s));
    return s;
}

// adds a take's figures; the survey's list is freed
static himc_strike_survey read_mixed(const mixed_config *c, mixed_score *score)
{
    himc_take *take = mixed_take(c, &truth);
    himc_strike_survey s = survey_of(take);
    mixed_compare(c, &truth, &s, score);
    free(s.strikes);
    himc_take_free(take);
    return s;
}

static mixed_score read_set(int set, int rate, int noise)
{
    mixed_score score = {0};
    mixed_config c = sets[set];
    c.rate = rates[rate];
    c.noise = noises[noise];
    for (int i = 0; i < (getenv("HIMC_LONG") ? 10 : 1); i++) {
        c.seed = (uint64_t)(1 + 1000 * i + 100 * set + 10 * rate + noise);
        read_mixed(&c, &score);
    }
    return score;
}

static void test_99_of_100_strikes_are_found_in_fine_takes_and_95_in_coarse_ones(void)
{
    mixed_score soft = {0};
    printf("precision / recall (error of speeds) at 0.2, 0.5, 1, 2 mm of noise\n");
    for (int set = 0; set < SETS; set++)
        for (int rate = 0; rate < RATES; rate++) {
            printf("%c %4g Hz", 'a' + set, rates[rate]);
            for (int noise = 0; noise < NOISES; noise++) {
                mixed_score s = read_set(set, rate, noise);
                double least = rates[rate] >= 250 && noises[noise] <= 0.5e-3 ? 0.99 : 0.95;
                printf("  %.3f / %.3f", mixed_precision(&s), mixed_recall(&s));
                printf(" (%2.0f %%)", 100 * mixed_speed_error(&s));
                TEST_ASSERT_TRUE(s.found > 20);
                TEST_ASSERT_TRUE(mixed_precision(&s) >= least);
                TEST_ASSERT_TRUE(mixed_recall(&s) >= least);
                TEST_ASSERT_TRUE(mixed_speed_error(&s) < (least > 0.95 ? 0.15 : 0.3));
                soft.soft += least > 0.95 ? s.soft : 0;
                soft.soft_found += least > 0.95 ? s.soft_found : 0;
            }
            printf("\n");
        }
    printf("%d of %d strikes below a tenth of the loudest speed\n", soft.soft_found, soft.soft);
    TEST_ASSERT_TRUE(soft.soft > 10 && soft.soft_found >= 0.98 * soft.soft);
}

// loud blows, and more sharp motions under 1 m/s between them
static mixed_config loud_blows(double seconds)
{
    mixed_config c = sets[1];
    c.slowest = 7, c.fastest = 10, c.air = 0.57;
    c.low_air = 0.04, c.high_air = 0.08;
    c.seconds = seconds, c.rate = 240, c.noise = 0.3e-3;
    return c;
}

// once 28 strikes of 12 blows, and the head 69 mm above them
static void test_sharp_motions_between_loud_blows_are_left_out_and_do_not_lift_the_head(void)
{
    mixed_config c = loud_blows(12);
    for (c.seed = 1; c.seed <= 10; c.seed++) {
        mixed_score score = {0};
        himc_strike_survey s = read_mixed(&c, &score);
        TEST_ASSERT_EQUAL_INT(0, score.invented);
        TEST_ASSERT_EQUAL_INT(0, score.missed);
        TEST_ASSERT_TRUE(s.left_out > 12 && s.lowest > 0.03 && s.fastest < 2);
        double head = himc_strike_head_at(&truth.head, s.head[0].x, s.head[0].y);
        TEST_ASSERT_DOUBLE_WITHIN(0.015, head, s.head[0].z); // a dent
    }
}

static void test_a_take_of_loud_blows_and_small_motions_is_played_as_it_was_struck(void)
{
    mixed_config c = loud_blows(6);
    c.seed = 1;
    himc_take *take = mixed_take(&c, &truth);
    himc_strike_survey survey = survey_of(take);
    TEST_ASSERT_TRUE_MESSAGE(himc_take_save(take, "build/mixed.trc", &error), error.text);
    himc_performance *p = session_new();
    session_do(p, "take build/mixed.trc");
    session_do(p, "play");
    session_play(p, 7.5, NULL);
    himc_performance_stats s = himc_performance_measure(p);
    printf("%d of %d strokes, %d contacts more, %.2f mm RMS off the capture, %.0f N\n", s.played,
           s.strokes, s.unplanned_contacts, 1e3 * s.captured_rms, s.peak_force);
    TEST_ASSERT_TRUE(survey.count >= 3 && survey.left_out > 4);
    TEST_ASSERT_EQUAL_INT(survey.count, s.played);
    TEST_ASSERT_EQUAL_INT(0, s.unplanned_contacts);
    TEST_ASSERT_TRUE(s.captured_rms < 0.004 && s.peak_force < 200); // once 298 N
    himc_performance_free(p);
    free(survey.strikes);
    himc_take_free(take);
}

static void test_two_heads_60_mm_apart_are_found_in_one_take(void)
{
    mixed_config c = sets[0];
    c.rate = 250, c.noise = 0.2e-3, c.lower = 0.06, c.tilt = 0.03, c.air = 0;
    for (c.seed = 1; c.seed <= 5; c.seed++) {
        mixed_score score = {0};
        himc_strike_survey s = read_mixed(&c, &score);
        TEST_ASSERT_EQUAL_INT(2, s.heads);
        TEST_ASSERT_TRUE(mixed_precision(&score) >= 0.98);
        TEST_ASSERT_EQUAL_INT(0, score.missed);
        TEST_ASSERT_DOUBLE_WITHIN(0.015, 0.06, fabs(s.head[0].z - s.head[1].z));
    }
}

static void hear(void *user, const char *line)
{
    if (strncmp(line, "left out: ", 10) == 0)
        snprintf(user, 256, "%s", line);
}

static void test_info_says_in_a_line_what_was_left_out(void)
{
    mixed_config c = sets[1];
    char line[256] = "", want[256];
    c.rate = 250, c.noise = 0.2e-3, c.seed = 1;
    himc_take *take = mixed_take(&c, &truth);
    himc_strike_survey s = survey_of(take);
    himc_take_describe(take, NULL, hear, line);
    snprintf(want, sizeof want,
             "left out: %d motions as sharp as strikes, up to %.2f m/s, that end %.3f .. %.3f m "
             "above the head",
             s.left_out, s.fastest, s.lowest, s.highest);
    TEST_ASSERT_TRUE(s.left_out > 5);
    TEST_ASSERT_EQUAL_STRING(want, line);
    free(s.strikes);
    himc_take_free(take);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_99_of_100_strikes_are_found_in_fine_takes_and_95_in_coarse_ones);
    RUN_TEST(test_sharp_motions_between_loud_blows_are_left_out_and_do_not_lift_the_head);
    RUN_TEST(test_a_take_of_loud_blows_and_small_motions_is_played_as_it_was_struck);
    RUN_TEST(test_two_heads_60_mm_apart_are_found_in_one_take);
    RUN_TEST(test_info_says_in_a_line_what_was_left_out);
    return UNITY_END();
}
