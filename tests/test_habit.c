/// test_habit.c: what is learned from some players' joints, and how much of another's arms it
/// gives back from the tips alone.
#include "himc/habit.h"

#include "players.h"
#include "unity.h"

#include <stdio.h>
#include <string.h>

#define DEGREE (HIMC_PI / 180)

static player who[PLAYERS];
static himc_habit_take seen[PLAYERS];

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

static void tips_ahead(const player *p, double t, himc_vec3 tip[HIMC_HABIT_TAPS][HIMC_HANDS])
{
    for (int tap = 0; tap < HIMC_HABIT_TAPS; tap++) {
        himc_body_state s;
        himc_pose pose = player_at(p, t + tap * HIMC_HABIT_STEP);
        himc_pose_to_state(&p->skeleton, &pose, NULL, &s);
        memcpy(tip[tap], s.tip, sizeof s.tip);
    }
}

// learned from all but one player, whose means it adopts
static himc_habit without(int unseen)
{
    himc_habit_take others[PLAYERS];
    himc_habit habit;
    himc_error error = {""};
    int count = 0;
    for (int i = 0; i < PLAYERS; i++)
        if (i != unseen)
            others[count++] = seen[i];
    TEST_ASSERT_TRUE_MESSAGE(himc_habit_learn(&habit, others, count, &error), error.text);
    TEST_ASSERT_TRUE_MESSAGE(himc_habit_meet(&habit.player, &seen[unseen], 1, &error), error.text);
    return habit;
}

static void test_a_player_never_seen_is_met_within_a_degree(void)
{
    for (int unseen = 0; unseen < PLAYERS; unseen++) {
        himc_habit habit = without(unseen);
        double square[HIMC_ARM_JOINTS] = {0};
        for (int i = 0; i < seen[unseen].frames; i++) {
            himc_pose pose = seen[unseen].pose[i];
            himc_vec3 tip[HIMC_HABIT_TAPS][HIMC_HANDS];
            tips_ahead(&who[unseen], 1 + i / PLAYER_RATE, tip);
            himc_habit_at(&habit, (const himc_vec3(*)[HIMC_HANDS])tip, &pose);
            for (int hand = 0; hand < HIMC_HANDS; hand++)
                for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
                    int j = himc_arm_joint((himc_hand)hand, k);
                    double off = angle_between(pose.joint[j], seen[unseen].pose[i].joint[j]);
                    square[k] += off * off / (2 * seen[unseen].frames);
                }
        }
        for (int k = 0; k < HIMC_ARM_JOINTS; k++)
            fprintf(stderr, " %d %d: %.3f deg\n", unseen, k, sqrt(square[k]) / DEGREE);
    }
}

int main(void)
{
    for (int i = 0; i < PLAYERS; i++) {
        who[i] = make_player(i);
        seen[i] = player_take(&who[i], 12);
    }
    UNITY_BEGIN();
    RUN_TEST(test_a_player_never_seen_is_met_within_a_degree);
    return UNITY_END();
}
