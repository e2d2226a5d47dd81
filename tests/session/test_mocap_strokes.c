/// test_mocap_strokes.c: the motion database against measurements of real timpani strokes, and the
/// joints of a player predicted from the regression of the others.
///
/// The captured means and deviations are those of the table in mocap/README.md, which the
/// generator writes: heights and speeds of a point 0.15 m behind the mallet.
#include "mocap_sequences.h"

#include "control/posture_regression.h"

#include <string.h>

static himc_mocap_statistics all[HIMC_NUANCES];

void setUp(void)
{
    if (all[0].count[0])
        return;
    for (int i = 0; i < MOCAP_SEQUENCES; i++) {
        himc_mocap *m = sequence(i);
        himc_mocap_measure(m, &all[sequence_config(i).nuance]);
        himc_mocap_free(m);
    }
}

void tearDown(void)
{
}

static double mean(himc_nuance nuance, himc_mocap_figure figure)
{
    return himc_mocap_mean(&all[nuance], figure);
}

// the mean of each nuance is within `most` captured deviations of the captured mean
static void expect_row(himc_mocap_figure figure, const double captured[HIMC_NUANCES],
                       const double deviation[HIMC_NUANCES], double most)
{
    for (int n = 0; n < HIMC_NUANCES; n++) {
        double off = (mean((himc_nuance)n, figure) - captured[n]) / deviation[n];
        printf(" %s %+.2f", himc_nuance_name((himc_nuance)n), off);
        TEST_ASSERT_TRUE_MESSAGE(fabs(off) < most, himc_nuance_name((himc_nuance)n));
    }
    printf(" deviations\n");
}

static void test_heights_are_within_a_deviation_of_the_captured(void)
{
    static const double captured[] = {0.309, 0.366, 0.323, 0.375, 0.386};
    static const double deviation[] = {0.042, 0.027, 0.044, 0.044, 0.098};
    expect_row(HIMC_MOCAP_HEIGHT, captured, deviation, 1);
}

static void test_downward_speeds_are_within_half_a_deviation_of_the_captured(void)
{
    static const double captured[] = {1.93, 2.25, 2.35, 4.04, 1.41};
    static const double deviation[] = {0.31, 0.54, 0.34, 0.62, 0.28};
    expect_row(HIMC_MOCAP_DOWN, captured, deviation, 0.5);
}

static void test_rebound_speeds_are_within_half_a_deviation_of_the_captured(void)
{
    static const double captured[] = {2.17, 1.48, 2.47, 2.01, 2.58};
    static const double deviation[] = {0.45, 0.48, 0.33, 0.56, 0.51};
    expect_row(HIMC_MOCAP_UP, captured, deviation, 0.5);
}

static void test_impact_speeds_are_within_15_percent_of_the_captured(void)
{
    static const double captured[] = {4.3, 4.2, 4.5, 7.5, 2.8};
    for (int n = 0; n < HIMC_NUANCES; n++)
        TEST_ASSERT_DOUBLE_WITHIN(0.15 * captured[n], captured[n],
                                  mean((himc_nuance)n, HIMC_MOCAP_IMPACT));
}

static void test_strokes_vary_between_half_and_all_of_the_captured(void)
{
    static const double captured[] = {0.042, 0.027, 0.044, 0.044, 0.098};
    for (int n = 0; n < HIMC_NUANCES; n++) {
        double here = himc_mocap_deviation(&all[n], HIMC_MOCAP_HEIGHT);
        TEST_ASSERT_TRUE(here < 1.15 * captured[n] && here > 0.4 * captured[n]);
    }
}

static void test_nuances_are_ordered_as_in_the_captures(void)
{
    for (int n = 0; n < HIMC_NUANCES; n++) {
        if (n != HIMC_VERTICAL_ACCENT) {
            TEST_ASSERT_TRUE(mean(HIMC_VERTICAL_ACCENT, HIMC_MOCAP_IMPACT) >
                             1.4 * mean((himc_nuance)n, HIMC_MOCAP_IMPACT));
        }
        if (n != HIMC_STACCATO) {
            TEST_ASSERT_TRUE(mean(HIMC_STACCATO, HIMC_MOCAP_IMPACT) <
                             0.8 * mean((himc_nuance)n, HIMC_MOCAP_IMPACT));
        }
        if (n != HIMC_TENUTO) {
            TEST_ASSERT_TRUE(mean(HIMC_TENUTO, HIMC_MOCAP_UP) <
                             mean((himc_nuance)n, HIMC_MOCAP_UP));
        }
    }
    TEST_ASSERT_TRUE(mean(HIMC_STACCATO, HIMC_MOCAP_UP) >
                     1.5 * mean(HIMC_STACCATO, HIMC_MOCAP_DOWN));
}

static void test_the_accent_is_high_and_narrow_vertical_accent_and_staccato_deep(void)
{
    for (int n = 0; n < HIMC_NUANCES; n++) {
        himc_nuance nuance = (himc_nuance)n;
        if (n == HIMC_ACCENT)
            continue;
        TEST_ASSERT_TRUE(mean(HIMC_ACCENT, HIMC_MOCAP_TIP_HEIGHT) >
                         1.04 * mean(nuance, HIMC_MOCAP_TIP_HEIGHT));
        TEST_ASSERT_TRUE(mean(HIMC_ACCENT, HIMC_MOCAP_DEPTH) < mean(nuance, HIMC_MOCAP_DEPTH));
        if (n == HIMC_VERTICAL_ACCENT || n == HIMC_STACCATO) {
            TEST_ASSERT_TRUE(mean(nuance, HIMC_MOCAP_DEPTH) >
                             1.3 * mean(HIMC_LEGATO, HIMC_MOCAP_DEPTH));
        }
    }
}

// share of a joint's rotation from impact to apex that is done at t
static double turned(const himc_mocap *m, int joint, double t, double touch, double apex)
{
    himc_pose low = himc_mocap_pose(m, touch), high = himc_mocap_pose(m, apex),
              now = himc_mocap_pose(m, t);
    himc_quat back = himc_quat_conj(low.joint[joint]);
    himc_vec3 way = himc_quat_log(himc_quat_mul(back, high.joint[joint]));
    himc_vec3 done = himc_quat_log(himc_quat_mul(back, now.joint[joint]));
    return himc_vec3_dot(way, done) / himc_vec3_dot(way, way);
}

static void test_the_elbow_falls_before_the_stick_does(void)
{
    for (int i = 0; i < MOCAP_SEQUENCES; i++) {
        himc_mocap *m = sequence(i);
        double elbow = 0, grip = 0;
        for (int k = 2; k < himc_mocap_touches(m); k++) {
            himc_mocap_touch touch = himc_mocap_touch_at(m, k);
            double apex = touch.time - 0.5 * (touch.time - himc_mocap_touch_at(m, k - 2).time);
            double half = 0.5 * (apex + touch.time);
            elbow += turned(m, himc_arm_joint(touch.hand, 1), half, touch.time, apex);
            grip += turned(m, himc_arm_joint(touch.hand, 3), half, touch.time, apex);
        }
        TEST_ASSERT_TRUE(elbow < grip);
        himc_mocap_free(m);
    }
}

// a sequence as a take for posture regression; the caller frees its poses
static himc_posture_regression_take postures(const himc_mocap *m)
{
    int frames = himc_mocap_frames(m);
    himc_pose *pose = calloc((size_t)frames, sizeof *pose);
    TEST_ASSERT_NOT_NULL(pose);
    for (int f = 0; f < frames; f++)
        pose[f] = himc_mocap_pose(m, f / HIMC_MOCAP_RATE);
    return (himc_posture_regression_take){.skeleton = himc_mocap_skeleton(m),
                                          .pose = pose,
                                          .frames = frames,
                                          .rate = HIMC_MOCAP_RATE};
}

// adds the squared angles between a sequence's joints and the regression's; returns their count
static int add_errors(const himc_posture_regression *regression, const himc_mocap *m,
                      double sum[HIMC_ARM_JOINTS])
{
    int count = 0;
    for (int f = 0; f < himc_mocap_frames(m); f += 2) {
        himc_vec3 tip[HIMC_REGRESSION_OFFSETS][HIMC_HANDS];
        for (int o = 0; o < HIMC_REGRESSION_OFFSETS; o++) {
            himc_body_state s =
                sequence_state(m, f / HIMC_MOCAP_RATE + o * HIMC_REGRESSION_OFFSET_STEP);
            memcpy(tip[o], s.tip, sizeof tip[o]);
        }
        himc_pose captured = himc_mocap_pose(m, f / HIMC_MOCAP_RATE), guess = captured;
        himc_posture_regression_at(regression, (const himc_vec3(*)[HIMC_HANDS])tip, &guess);
        for (int hand = 0; hand < HIMC_HANDS; hand++, count++)
            for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
                int j = himc_arm_joint((himc_hand)hand, k);
                himc_quat turn = himc_quat_mul(himc_quat_conj(guess.joint[j]), captured.joint[j]);
                himc_vec3 off = himc_quat_log(turn);
                sum[k] += himc_vec3_dot(off, off);
            }
    }
    return count;
}

// a posture regression learned from the other players in a nuance, all spots
static void learn(int unseen, int nuance, himc_posture_regression *regression)
{
    himc_mocap *m[MOCAP_SEQUENCES];
    himc_posture_regression_take take[MOCAP_SEQUENCES];
    int count = 0;
    for (int i = 0; i < MOCAP_SEQUENCES; i++) {
        himc_mocap_config c = sequence_config(i);
        if (c.player == unseen || (int)c.nuance != nuance)
            continue;
        m[count] = sequence(i);
        take[count] = postures(m[count]);
        count++;
    }
    TEST_ASSERT_TRUE_MESSAGE(himc_posture_regression_learn(regression, take, count, &error),
                             error.text);
    for (int i = 0; i < count; i++) {
        free((void *)(uintptr_t)take[i].pose);
        himc_mocap_free(m[i]);
    }
}

static void test_joints_of_an_unseen_player_follow_from_the_tips_within_a_degree(void)
{
    double worst = 0;
    for (int unseen = 0; unseen < HIMC_MOCAP_PLAYERS; unseen++) {
        double sum[HIMC_ARM_JOINTS] = {0};
        int count = 0;
        for (int nuance = 0; nuance < HIMC_NUANCES; nuance++) {
            himc_posture_regression regression;
            learn(unseen, nuance, &regression);
            for (int i = 0; i < MOCAP_SEQUENCES; i++) {
                himc_mocap_config c = sequence_config(i);
                if (c.player != unseen || (int)c.nuance != nuance)
                    continue;
                himc_mocap *m = sequence(i);
                himc_posture_regression_take own = postures(m);
                TEST_ASSERT_TRUE(himc_posture_regression_fit(&regression.player, &own, 1, &error));
                count += add_errors(&regression, m, sum);
                free((void *)(uintptr_t)own.pose);
                himc_mocap_free(m);
            }
        }
        double degrees[HIMC_ARM_JOINTS];
        for (int k = 0; k < HIMC_ARM_JOINTS; k++)
            degrees[k] = sqrt(sum[k] / count) * 180 / HIMC_PI;
        printf("%s: shoulder %.2f, elbow %.2f, wrist %.2f, grip %.2f degrees RMS\n",
               himc_mocap_player_name(unseen), degrees[0], degrees[1], degrees[2], degrees[3]);
        for (int k = 0; k < 3; k++)
            worst = fmax(worst, degrees[k]);
    }
    TEST_ASSERT_TRUE(worst <= 1);
}

static void test_mocap_readme_has_the_measured_table(void)
{
    static char table[8192], readme[32768];
    FILE *file = fopen("mocap/README.md", "r");
    TEST_ASSERT_NOT_NULL(file);
    readme[fread(readme, 1, sizeof readme - 1, file)] = '\0';
    fclose(file);
    TEST_ASSERT_TRUE_MESSAGE(himc_mocap_compare(1, table, sizeof table, &error), error.text);
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(readme, table), "mocap/README.md lacks what `build/bin/generate --measure` prints");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_heights_are_within_a_deviation_of_the_captured);
    RUN_TEST(test_downward_speeds_are_within_half_a_deviation_of_the_captured);
    RUN_TEST(test_rebound_speeds_are_within_half_a_deviation_of_the_captured);
    RUN_TEST(test_impact_speeds_are_within_15_percent_of_the_captured);
    RUN_TEST(test_strokes_vary_between_half_and_all_of_the_captured);
    RUN_TEST(test_nuances_are_ordered_as_in_the_captures);
    RUN_TEST(test_the_accent_is_high_and_narrow_vertical_accent_and_staccato_deep);
    RUN_TEST(test_the_elbow_falls_before_the_stick_does);
    RUN_TEST(test_joints_of_an_unseen_player_follow_from_the_tips_within_a_degree);
    RUN_TEST(test_mocap_readme_has_the_measured_table);
    return UNITY_END();
}
