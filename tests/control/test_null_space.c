/// test_null_space.c: a posture regression that a performance is given moves the elbows and leaves
/// the tips where they are; taken away again, it has moved nothing.
#include "session.h"

#include "performance/performance_state.h"
#include "performance/research.h"

#define POSES 40
#define SECONDS 1

static himc_posture_regression regression;

// fitted to natural postures with the tips moved up, forward and aside
static void fit_regression(void)
{
    static himc_pose pose[POSES];
    himc_skeleton_config config = himc_skeleton_default();
    himc_skeleton skeleton;
    himc_posture posture;
    TEST_ASSERT_TRUE_MESSAGE(himc_skeleton_init(&skeleton, &config, &error), error.text);
    himc_posture_init(&posture, &skeleton, 0.87);
    for (int i = 0; i < POSES; i++) {
        double x = 0.5 + 0.05 * cos(i), y = 0.15 + 0.03 * sin(2.3 * i), z = 1 + 0.1 * sin(i);
        himc_vec3 tip[HIMC_HANDS] = {himc_vec3_make(x, y, z), himc_vec3_make(x, -y, 2 - z)};
        himc_posture_at(&posture, tip, &pose[i]);
    }
    himc_posture_regression_take take = {
        .skeleton = &skeleton, .pose = pose, .frames = POSES, .rate = 250};
    himc_posture_regression_default(&regression);
    TEST_ASSERT_TRUE_MESSAGE(himc_posture_regression_fit(&regression.player, &take, 1, &error),
                             error.text);
}

typedef struct path {
    himc_vec3 tip[SECONDS * 250][HIMC_HANDS], elbow[SECONDS * 250][HIMC_HANDS];
    int rows; // up to the first contact, after which the rebound is its own
    bool struck;
} path;

static void keep(void *user, const himc_motion_row *row)
{
    path *p = user;
    p->struck = p->struck || row->force[HIMC_LEFT] > 0 || row->force[HIMC_RIGHT] > 0;
    if (p->rows == SECONDS * 250 || p->struck)
        return;
    memcpy(p->tip[p->rows], row->tip, sizeof p->tip[0]);
    memcpy(p->elbow[p->rows++], row->elbow, sizeof p->elbow[0]);
}

// `given` to it before it plays, then `last`; either may be NULL
static void play(path *out, const himc_posture_regression *given,
                 const himc_posture_regression *last)
{
    himc_performance *p = session_new();
    session_do(p, "drum kettle");
    session_do(p, "stroke 1 right legato mf");
    session_do(p, "stroke 1 left accent f");
    himc_performance_set_posture_regression(p, given);
    himc_performance_set_posture_regression(p, last);
    out->rows = 0;
    out->struck = false;
    himc_performance_on_motion(p, keep, out);
    session_do(p, "play");
    session_play(p, SECONDS, NULL);
    himc_performance_free(p);
}

static double apart(himc_vec3 a[][HIMC_HANDS], himc_vec3 b[][HIMC_HANDS], int rows)
{
    double most = 0;
    for (int i = 0; i < rows; i++)
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            most = fmax(most, himc_vec3_length(himc_vec3_sub(a[i][hand], b[i][hand])));
    return most;
}

static void test_a_regression_moves_elbows_and_not_the_tips(void)
{
    static path natural, learned;
    fit_regression();
    play(&natural, NULL, NULL);
    play(&learned, NULL, &regression);
    printf("elbows %.1f mm apart, tips %.3f mm\n",
           1e3 * apart(natural.elbow, learned.elbow, natural.rows),
           1e3 * apart(natural.tip, learned.tip, natural.rows));
    TEST_ASSERT_EQUAL_INT(natural.rows, learned.rows);
    TEST_ASSERT_TRUE(natural.rows > 100);
    TEST_ASSERT_TRUE(apart(natural.elbow, learned.elbow, natural.rows) > 0.005);
    TEST_ASSERT_TRUE(apart(natural.tip, learned.tip, natural.rows) < 0.001);
}

static void test_a_regression_that_is_taken_away_has_moved_nothing(void)
{
    static path natural, without;
    fit_regression();
    play(&natural, NULL, NULL);
    play(&without, &regression, NULL);
    TEST_ASSERT_TRUE(apart(natural.elbow, without.elbow, natural.rows) < 0.001);
    TEST_ASSERT_TRUE(apart(natural.tip, without.tip, natural.rows) < 0.001);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_regression_moves_elbows_and_not_the_tips);
    RUN_TEST(test_a_regression_that_is_taken_away_has_moved_nothing);
    return UNITY_END();
}
