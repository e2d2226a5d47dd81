/// test_posture_regression.c: weights learned from some players' joints give another player's arms
/// from the tips alone.
#include "control/posture_regression.h"

#include "players.h"
#include "unity.h"

#include <stdio.h>
#include <string.h>

#define DEGREE (HIMC_PI / 180)
#define OFFSETS HIMC_REGRESSION_OFFSETS
#define TERMS HIMC_REGRESSION_TERMS
#define ANGLES HIMC_REGRESSION_ANGLES
#define TRUNK (HIMC_TRUNK - 1)

static player who[PLAYERS];
static himc_posture_regression_take captured[PLAYERS]; // of each player

void setUp(void)
{
}

void tearDown(void)
{
}

static double angle_between(himc_quat a, himc_quat b)
{
    return himc_vec3_length(himc_quat_log(himc_quat_mul(himc_quat_conj(a), b)));
}

static void tips_ahead(const player *p, double t, himc_vec3 tip[OFFSETS][HIMC_HANDS])
{
    for (int o = 0; o < OFFSETS; o++) {
        himc_body_state s;
        himc_pose pose = player_at(p, t + o * HIMC_REGRESSION_OFFSET_STEP);
        himc_pose_to_state(&p->skeleton, &pose, NULL, &s);
        memcpy(tip[o], s.tip, sizeof s.tip);
    }
}

// weights learned from all players but one, fitted to that one
static himc_posture_regression without(int unseen)
{
    himc_posture_regression_take others[PLAYERS];
    himc_posture_regression regression;
    himc_error error = {""};
    int count = 0;
    for (int i = 0; i < PLAYERS; i++)
        if (i != unseen)
            others[count++] = captured[i];
    TEST_ASSERT_TRUE_MESSAGE(himc_posture_regression_learn(&regression, others, count, &error),
                             error.text);
    TEST_ASSERT_TRUE_MESSAGE(
        himc_posture_regression_fit(&regression.player, &captured[unseen], 1, &error), error.text);
    return regression;
}

static void test_joints_of_an_unseen_player_are_within_a_degree(void)
{
    for (int unseen = 0; unseen < PLAYERS; unseen++) {
        himc_posture_regression regression = without(unseen);
        double square[HIMC_ARM_JOINTS] = {0}, low[2] = {9, 9}, high[2] = {-9, -9};
        for (int i = 0; i < captured[unseen].frames; i++) {
            himc_pose pose[2] = {captured[unseen].pose[i], captured[unseen].pose[i]};
            himc_vec3 tip[OFFSETS][HIMC_HANDS];
            tips_ahead(&who[unseen], 1 + i / PLAYER_RATE, tip);
            himc_posture_regression_at(&regression, (const himc_vec3(*)[HIMC_HANDS])tip, &pose[1]);
            for (int hand = 0; hand < HIMC_HANDS; hand++)
                for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
                    int j = himc_arm_joint((himc_hand)hand, k);
                    double off = angle_between(pose[0].joint[j], pose[1].joint[j]);
                    square[k] += off * off / (2 * captured[unseen].frames);
                }
            for (int m = 0; m < 2; m++) {
                himc_body_state s;
                himc_pose_to_state(&who[unseen].skeleton, &pose[m], NULL, &s);
                low[m] = fmin(low[m], s.origin[HIMC_LEFT_FOREARM].z);
                high[m] = fmax(high[m], s.origin[HIMC_LEFT_FOREARM].z);
            }
        }
        for (int k = 0; k < HIMC_ARM_JOINTS; k++)
            TEST_ASSERT_TRUE(sqrt(square[k]) < DEGREE);
        TEST_ASSERT_DOUBLE_WITHIN(0.05, 1, (high[1] - low[1]) / (high[0] - low[0]));
    }
}

static void test_tips_are_exactly_at_their_targets(void)
{
    himc_posture_regression regression = without(1);
    for (int i = 0; i < 500; i++) {
        himc_pose pose = captured[1].pose[i];
        himc_body_state s;
        himc_vec3 tip[OFFSETS][HIMC_HANDS];
        tips_ahead(&who[1], 1 + i / PLAYER_RATE, tip);
        himc_posture_regression_at(&regression, (const himc_vec3(*)[HIMC_HANDS])tip, &pose);
        himc_pose_to_state(&who[1].skeleton, &pose, NULL, &s);
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0,
                                      himc_vec3_length(himc_vec3_sub(s.tip[hand], tip[0][hand])));
    }
}

static void test_rates_are_the_differences_of_the_posture(void)
{
    himc_posture_regression regression = without(0);
    himc_posture posture;
    himc_posture_motion m[3];
    double h = 1e-4;
    himc_posture_init(&posture, &who[0].skeleton, PLAYER_LEVEL);
    for (int n = 0; n < 3; n++) {
        himc_target tip[OFFSETS][HIMC_HANDS];
        for (int o = 0; o < OFFSETS; o++)
            for (int hand = 0; hand < HIMC_HANDS; hand++) {
                double t = 0.5 + (n - 1) * h + 0.03 * o, y = hand == HIMC_LEFT ? 0.1 : -0.1;
                himc_target *to = &tip[o][hand];
                to->x = himc_vec3_make(0.45 - 0.05 * sin(12 * t), y, 1.0 + 0.1 * sin(12 * t));
                to->v = himc_vec3_make(-0.6 * cos(12 * t), 0, 1.2 * cos(12 * t));
                to->a = himc_vec3_make(7.2 * sin(12 * t), 0, -14.4 * sin(12 * t));
            }
        himc_posture_moving(&posture, tip[0], &m[n]);
        himc_posture_regression_moving(&regression, (const himc_target(*)[HIMC_HANDS])tip, &m[n]);
    }
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
            int j = himc_arm_joint((himc_hand)hand, k);
            himc_vec3 turned =
                himc_quat_log(himc_quat_mul(m[2].joint[j], himc_quat_conj(m[0].joint[j])));
            himc_vec3 rate = himc_vec3_scale(turned, 0.5 / h);
            himc_vec3 a = himc_vec3_scale(himc_vec3_sub(m[2].rate[j], m[0].rate[j]), 0.5 / h);
            TEST_ASSERT_DOUBLE_WITHIN(2e-3, 0, himc_vec3_length(himc_vec3_sub(rate, m[1].rate[j])));
            TEST_ASSERT_DOUBLE_WITHIN(0.1, 0,
                                      himc_vec3_length(himc_vec3_sub(a, m[1].acceleration[j])));
        }
}

// RMS of an arm's joints against the player's (rad)
static double arms_off(const himc_posture_regression *regression, int n)
{
    double square = 0;
    for (int i = 0; i < captured[n].frames; i++) {
        himc_pose pose = captured[n].pose[i];
        himc_vec3 tip[OFFSETS][HIMC_HANDS];
        tips_ahead(&who[n], 1 + i / PLAYER_RATE, tip);
        himc_posture_regression_at(regression, (const himc_vec3(*)[HIMC_HANDS])tip, &pose);
        for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
            int j = himc_arm_joint(HIMC_RIGHT, k);
            double off = angle_between(pose.joint[j], captured[n].pose[i].joint[j]);
            square += off * off;
        }
    }
    return sqrt(square / (HIMC_ARM_JOINTS * captured[n].frames));
}

static void test_a_take_of_the_player_corrects_the_weights_of_others(void)
{
    himc_error error = {""};
    himc_posture_regression regression = without(2);
    double before = arms_off(&regression, 2);
    TEST_ASSERT_TRUE_MESSAGE(
        himc_posture_regression_correct(&regression, &captured[2], NULL, &error), error.text);
    double after = arms_off(&regression, 2);
    printf("a player's arms: %.2f degrees by others' weights, %.2f corrected\n", before / DEGREE,
           after / DEGREE);
    TEST_ASSERT_TRUE(after < 0.9 * before);
    himc_posture_regression_take none = captured[2];
    himc_posture_regression kept = regression;
    none.frames = 20;
    TEST_ASSERT_FALSE(himc_posture_regression_correct(&regression, &none, NULL, &error));
    TEST_ASSERT_EQUAL_STRING("posture regression: a take of 20 frames, expected 36 or more",
                             error.text);
    TEST_ASSERT_EQUAL_MEMORY(&kept, &regression, sizeof regression);
}

// the tip by linear interpolation: at 250 Hz a time offset is 7.5 frames
static himc_vec3 interpolated_tip(const himc_posture_regression_take *take, double frame,
                                  himc_hand hand)
{
    const himc_pose *pose = &take->pose[(int)frame];
    himc_vec3 x = himc_posture_regression_tip(take->skeleton, pose, hand);
    himc_vec3 next = himc_posture_regression_tip(take->skeleton, pose + (frame > (int)frame), hand);
    return himc_vec3_madd(x, frame - (int)frame, himc_vec3_sub(next, x));
}

// at the least sum |u - (W + D) phi|^2 + |D|^2 the derivative is zero: sum phi (u - (W + D) phi) =
// D
static void test_a_correction_is_a_ridge_regression_with_a_ridge_of_one(void)
{
    himc_error error = {""};
    himc_posture_regression before = without(1), after = before;
    TEST_ASSERT_TRUE_MESSAGE(himc_posture_regression_correct(&after, &captured[1], NULL, &error),
                             error.text);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        double slope[ANGLES][TERMS] = {{0}}, most = 0;
        himc_quat frame[HIMC_ARM_JOINTS];
        himc_posture_regression_frames(&after.player, (himc_hand)hand, frame);
        for (int i = 0; i < himc_posture_regression_known_frames(&captured[1]); i++) {
            const himc_pose *pose = &captured[1].pose[i];
            himc_vec3 tip[OFFSETS][HIMC_HANDS];
            double phi[TERMS];
            for (int o = 0; o < OFFSETS; o++)
                tip[o][hand] = interpolated_tip(&captured[1], i + o * 7.5, (himc_hand)hand);
            himc_posture_regression_terms(&after.player, (himc_hand)hand, pose->joint[TRUNK],
                                          (const himc_vec3(*)[HIMC_HANDS])tip, phi);
            for (int c = 0; c < ANGLES; c++) {
                int j = himc_arm_joint((himc_hand)hand, c / 3);
                himc_quat mean = himc_quat_conj(after.player.mean.joint[j]);
                himc_vec3 turned = himc_quat_log(himc_quat_mul(mean, pose->joint[j]));
                turned = himc_quat_rotate(frame[c / 3], turned);
                double left = c % 3 == 0 ? turned.x : c % 3 == 1 ? turned.y : turned.z;
                for (int t = 0; t < TERMS; t++)
                    left -= after.weight[hand][c / 3][c % 3][t] * phi[t];
                for (int t = 0; t < TERMS; t++)
                    slope[c][t] += phi[t] * left;
            }
        }
        for (int c = 0; c < ANGLES; c++)
            for (int t = 0; t < TERMS; t++) {
                double d =
                    after.weight[hand][c / 3][c % 3][t] - before.weight[hand][c / 3][c % 3][t];
                most = fmax(most, fabs(d));
                TEST_ASSERT_DOUBLE_WITHIN(1e-9, d, slope[c][t]);
            }
        TEST_ASSERT_TRUE(most > 0.01);
    }
}

// a capture of the right arm alone changes neither the left arm nor the trunk
static void test_an_unseen_arm_stays_unchanged(void)
{
    himc_error error = {""};
    himc_posture_regression regression = without(0);
    himc_posture_regression_take take = captured[0];
    take.unseen_arm[HIMC_LEFT] = take.unseen_trunk = true;
    TEST_ASSERT_TRUE_MESSAGE(himc_posture_regression_correct(&regression, &take, NULL, &error),
                             error.text);
    for (int i = 0; i < captured[0].frames; i += 50) {
        himc_pose given = himc_pose_zero(), pose;
        himc_vec3 tip[OFFSETS][HIMC_HANDS];
        given.joint[TRUNK] = captured[0].pose[i].joint[TRUNK];
        pose = given;
        tips_ahead(&who[0], 1 + i / PLAYER_RATE, tip);
        himc_posture_regression_at(&regression, (const himc_vec3(*)[HIMC_HANDS])tip, &pose);
        for (int j = 0; j < HIMC_JOINTS; j++) {
            bool right = false;
            for (int k = 0; k < HIMC_ARM_JOINTS; k++)
                right = right || j == himc_arm_joint(HIMC_RIGHT, k);
            double turned = angle_between(given.joint[j], pose.joint[j]);
            TEST_ASSERT_TRUE(right ? turned > 1e-3 : turned == 0);
        }
    }
}

// a take with an additional swivel of the elbow about the line from shoulder to tip, which does not
// show in the tip
static void swivel(const himc_posture_regression_take *take, himc_pose *pose)
{
    for (int i = 0; i < take->frames; i++) {
        himc_body_state s;
        pose[i] = take->pose[i];
        himc_pose_to_state(take->skeleton, &pose[i], NULL, &s);
        himc_vec3 line = himc_vec3_sub(s.tip[HIMC_LEFT], s.origin[HIMC_LEFT_UPPER_ARM]);
        double angle = 0.05 * sin(2.3 * i / take->rate) / himc_vec3_length(line);
        himc_quat turn = himc_quat_exp(himc_vec3_scale(line, angle));
        himc_quat trunk = pose[i].joint[TRUNK], *q = &pose[i].joint[himc_arm_joint(HIMC_LEFT, 0)];
        turn = himc_quat_mul(himc_quat_conj(trunk), himc_quat_mul(turn, trunk));
        *q = himc_quat_mul(turn, *q);
    }
}

// least squares alone would reduce the amplitude, here by a ninth
static void test_amplitude_of_an_upper_arm_equals_the_captured_one(void)
{
    himc_error error = {""};
    himc_posture_regression regression;
    himc_posture_regression_take take = captured[1];
    himc_pose *pose = malloc((size_t)take.frames * sizeof *pose);
    double square[2] = {0, 0}; // captured, regressed
    swivel(&captured[1], pose);
    take.pose = pose;
    TEST_ASSERT_TRUE_MESSAGE(himc_posture_regression_learn(&regression, &take, 1, &error),
                             error.text);
    int shoulder = himc_arm_joint(HIMC_LEFT, 0);
    himc_quat back = himc_quat_conj(regression.player.mean.joint[shoulder]);
    for (int i = 0; i < take.frames - 15; i++) {
        double term[TERMS];
        himc_vec3 tip[OFFSETS][HIMC_HANDS];
        himc_vec3 turned = himc_quat_log(himc_quat_mul(back, pose[i].joint[shoulder]));
        tips_ahead(&who[1], 1 + i / PLAYER_RATE, tip);
        himc_posture_regression_terms(&regression.player, HIMC_LEFT, pose[i].joint[TRUNK],
                                      (const himc_vec3(*)[HIMC_HANDS])tip, term);
        square[0] += himc_vec3_dot(turned, turned);
        for (int c = 0; c < 3; c++) {
            double u = 0;
            for (int t = 0; t < TERMS; t++)
                u += regression.weight[HIMC_LEFT][0][c][t] * term[t];
            square[1] += u * u;
        }
    }
    free(pose);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 1, sqrt(square[1] / square[0]));
}

// mirrored at the body's plane of symmetry y = 0
static himc_vec3 in_mirror(himc_vec3 x)
{
    return himc_vec3_make(x.x, -x.y, x.z);
}

// a player with one arm at rest: it gets the mirrored weights of the other arm
static void test_an_arm_at_rest_gets_the_other_arms_weights_mirrored(void)
{
    himc_pose *pose = malloc((size_t)captured[0].frames * sizeof *pose);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_posture_regression regression;
        himc_error error = {""};
        himc_posture_regression_take take = captured[0];
        memcpy(pose, captured[0].pose, (size_t)take.frames * sizeof *pose);
        for (int i = 0; i < take.frames; i++)
            for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
                int j = himc_arm_joint((himc_hand)hand, k);
                pose[i].joint[j] = who[0].low.joint[j];
            }
        take.pose = pose;
        TEST_ASSERT_TRUE_MESSAGE(himc_posture_regression_learn(&regression, &take, 1, &error),
                                 error.text);
        TEST_ASSERT_TRUE_MESSAGE(
            himc_posture_regression_fit(&regression.player, &captured[0], 1, &error), error.text);
        for (int c = 0; c < ANGLES; c++) // turns about y stay in a mirror, the others change sign
            for (int d = 0; d < ANGLES; d++) {
                double own = regression.residual_covariance[hand][c][d];
                double other = regression.residual_covariance[1 - hand][c][d];
                TEST_ASSERT_EQUAL_DOUBLE((c % 3 == 1) != (d % 3 == 1) ? -other : other, own);
            }
        for (int i = 0; i < 250; i += 10) {
            himc_vec3 tip[2][OFFSETS][HIMC_HANDS];
            himc_pose played[2] = {captured[0].pose[i], captured[0].pose[i]};
            tips_ahead(&who[0], 1 + i / PLAYER_RATE, tip[0]);
            for (int o = 0; o < OFFSETS; o++)
                for (int h = 0; h < HIMC_HANDS; h++)
                    tip[1][o][h] = in_mirror(tip[0][o][1 - h]);
            for (int m = 0; m < 2; m++)
                himc_posture_regression_at(&regression, (const himc_vec3(*)[HIMC_HANDS])tip[m],
                                           &played[m]);
            for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
                himc_quat own = played[0].joint[himc_arm_joint((himc_hand)hand, k)];
                himc_quat other = played[1].joint[himc_arm_joint((himc_hand)(1 - hand), k)];
                own = (himc_quat){own.w, -own.x, own.y, -own.z};
                TEST_ASSERT_TRUE(angle_between(own, other) < DEGREE);
            }
        }
    }
    free(pose);
}

static void test_takes_that_determine_nothing_are_refused_with_the_reason(void)
{
    himc_posture_regression regression;
    himc_error error;
    himc_posture_regression_take take = captured[0];
    TEST_ASSERT_FALSE(himc_posture_regression_learn(&regression, &take, 0, &error));
    TEST_ASSERT_EQUAL_STRING("posture regression: no take to learn from, expected 1 or more",
                             error.text);
    take.frames = 30;
    TEST_ASSERT_FALSE(himc_posture_regression_learn(&regression, &take, 1, &error));
    TEST_ASSERT_EQUAL_STRING("posture regression: a take of 30 frames, expected 36 or more",
                             error.text);
    take = captured[0];
    take.rate = 1;
    TEST_ASSERT_FALSE(himc_posture_regression_learn(&regression, &take, 1, &error));
    TEST_ASSERT_EQUAL_STRING("posture regression: rate of a take: 1 Hz, expected 20 .. 10000 Hz",
                             error.text);
    himc_pose still[200];
    for (int i = 0; i < 200; i++)
        still[i] = captured[0].pose[0];
    take = (himc_posture_regression_take){
        .skeleton = &who[0].skeleton, .pose = still, .frames = 200, .rate = PLAYER_RATE};
    TEST_ASSERT_FALSE(himc_posture_regression_learn(&regression, &take, 1, &error));
    TEST_ASSERT_EQUAL_STRING("posture regression: no drumstick tip moves: nothing to learn",
                             error.text);
    still[7].joint[3].x = NAN;
    TEST_ASSERT_FALSE(himc_posture_regression_learn(&regression, &take, 1, &error));
    TEST_ASSERT_EQUAL_STRING("posture regression: frame 7: left-shoulder: not a unit quaternion",
                             error.text);
}

int main(void)
{
    for (int i = 0; i < PLAYERS; i++) {
        who[i] = make_player(i);
        captured[i] = player_take(&who[i], 12);
    }
    UNITY_BEGIN();
    RUN_TEST(test_joints_of_an_unseen_player_are_within_a_degree);
    RUN_TEST(test_tips_are_exactly_at_their_targets);
    RUN_TEST(test_rates_are_the_differences_of_the_posture);
    RUN_TEST(test_a_take_of_the_player_corrects_the_weights_of_others);
    RUN_TEST(test_amplitude_of_an_upper_arm_equals_the_captured_one);
    RUN_TEST(test_a_correction_is_a_ridge_regression_with_a_ridge_of_one);
    RUN_TEST(test_an_unseen_arm_stays_unchanged);
    RUN_TEST(test_an_arm_at_rest_gets_the_other_arms_weights_mirrored);
    RUN_TEST(test_takes_that_determine_nothing_are_refused_with_the_reason);
    for (int i = 0; i < PLAYERS; i++)
        free((void *)(uintptr_t)captured[i].pose);
    return UNITY_END();
}
