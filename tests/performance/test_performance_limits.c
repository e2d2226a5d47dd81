/// test_performance_limits.c: the commands `limits` and `strength`, and what `info`, rows of motion
/// and figures tell of them.
#include "session.h"

#include "performance/performance_state.h"

static char told[64][512];
static int lines;

static void keep_line(void *user, const char *text)
{
    (void)user;
    if (lines < 64)
        snprintf(told[lines++], sizeof told[0], "%s", text);
}

// the first line of `info` that begins so; "" if there is none
static const char *info(const himc_performance *p, const char *begin)
{
    lines = 0;
    himc_performance_describe(p, HIMC_DESCRIBE_INFO, keep_line, NULL);
    for (int i = 0; i < lines; i++)
        if (strncmp(told[i], begin, strlen(begin)) == 0)
            return told[i];
    return "";
}

static double highest;

static void keep_limit(void *user, const himc_motion_row *row)
{
    (void)user;
    for (int j = 0; j < HIMC_JOINTS; j++)
        highest = fmax(highest, row->limit[j]);
}

// four strokes, hands in turn
static himc_performance *piece(void)
{
    himc_performance *p = session_new();
    session_do(p, "drum kettle");
    session_do(p, "tempo 120");
    for (int i = 0; i < 4; i++)
        session_do(p, "stroke %d %s accent f", i + 1, i % 2 ? "left" : "right");
    himc_performance_on_motion(p, keep_limit, NULL);
    highest = 0;
    return p;
}

static void play(himc_performance *p)
{
    session_do(p, "play");
    session_play(p, 3, NULL);
}

static void test_limits_are_off_until_asked_for_and_after_reset(void)
{
    himc_performance *p = piece();
    TEST_ASSERT_EQUAL_STRING("limits off, hit 0 times, strength off", info(p, "limits"));
    session_do(p, "limits euler");
    session_do(p, "strength human");
    TEST_ASSERT_EQUAL_STRING("limits euler of table 1, hit 0 times, strength human",
                             info(p, "limits"));
    session_do(p, "reset");
    TEST_ASSERT_EQUAL_STRING("limits off, hit 0 times, strength off", info(p, "limits"));
    play(p);
    TEST_ASSERT_EQUAL_DOUBLE(0, highest);
    himc_performance_free(p);
}

static void test_limits_that_are_hit_show_in_info_in_rows_of_motion_and_in_figures(void)
{
    for (int mode = 0; mode < 3; mode++) {
        himc_performance *p = piece();
        session_do(p, "mode %s", mode == 0 ? "himc" : mode == 1 ? "id" : "ik");
        session_do(p, "limits ellipsoid");
        play(p);
        himc_performance_stats s = himc_performance_measure(p);
        TEST_ASSERT_TRUE(s.limit_hits > 1);
        TEST_ASSERT_TRUE(highest > 0.95);
        // the table's shoulder hardly flexes
        TEST_ASSERT_NOT_EQUAL('\0', info(p, "limit left-shoulder: hit ")[0]);
        TEST_ASSERT_EQUAL_INT(0, s.recoveries);
        himc_performance_free(p);
    }
}

static void test_limits_of_a_take_contain_its_motion(void)
{
    char path[] = "/tmp/himc-limits-XXXXXX.bvh";
    int file = mkstemps(path, 4);
    TEST_ASSERT_TRUE(file >= 0);
    close(file);
    himc_performance *p = piece();
    session_do(p, "record %s", path);
    play(p);
    session_do(p, "record stop");
    himc_performance_free(p);
    p = session_new();
    session_do(p, "drum kettle");
    session_do(p, "limits ellipsoid");
    session_do(p, "take %s", path);
    unlink(path);
    TEST_ASSERT_EQUAL_STRING("limits ellipsoid of the take, hit 0 times, strength off",
                             info(p, "limits"));
    session_do(p, "mode id");
    session_do(p, "play");
    session_play(p, 4, NULL);
    himc_performance_stats s = himc_performance_measure(p);
    TEST_ASSERT_EQUAL_INT(0, s.recoveries);
    TEST_ASSERT_TRUE(s.tip_rms < 0.002);
    session_do(p, "clear");
    himc_performance_free(p);
}

// joints that a take hardly moves may move by 0.05 rad, others by a twentieth more than they did
static void test_limits_of_a_take_are_at_least_0_05_wide(void)
{
    enum { FRAMES = 100, ELBOW = HIMC_LEFT_FOREARM - 1 };
    static himc_pose pose[FRAMES];
    himc_player player = {.pose = pose, .frames = FRAMES};
    himc_limits learned, exact;
    for (int i = 0; i < FRAMES; i++)
        for (int j = 0; j < HIMC_JOINTS; j++) {
            double most = j == ELBOW ? 0.5 : 0.002, turn = most * (2.0 * i / (FRAMES - 1) - 1);
            pose[i].joint[j] = himc_quat_exp(himc_vec3_make(0, turn, 0));
        }
    TEST_ASSERT_TRUE_MESSAGE(
        himc_performance_learn_limits(player.pose, player.frames, &learned, &error), error.text);
    TEST_ASSERT_TRUE_MESSAGE(himc_limits_learn(&exact, pose, FRAMES, 0, &error), error.text);
    for (int j = 0; j < HIMC_JOINTS; j++) {
        const himc_limit *l = &learned.joint[j], *e = &exact.joint[j];
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, j == ELBOW ? 1.05 * e->radius.x : 0.05, l->radius.x);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.05, l->radius.z);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, j == ELBOW ? 1.05 * 0.5 : 0.05, l->upper.y);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, j == ELBOW ? -1.05 * 0.5 : -0.05, l->lower.y);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.05, l->upper.x);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, -0.05, l->lower.z);
    }
}

static void test_a_kinematic_joint_at_its_bounds_stops(void)
{
    himc_vec3 rate[HIMC_JOINTS], moves = {1, 2, 3}, stands = {0, 0, 0};
    himc_performance *p = piece();
    session_do(p, "limits ellipsoid");
    int elbow = himc_arm_joint(HIMC_LEFT, 1);
    himc_pose mean, pose;
    for (int j = 0; j < HIMC_JOINTS; j++) {
        mean.joint[j] =
            p->body->limits.joint[j].bound ? p->body->limits.joint[j].mean : himc_quat_identity();
        rate[j] = moves;
    }
    pose = mean;
    pose.joint[elbow] =
        himc_quat_mul(mean.joint[elbow], himc_quat_exp(himc_vec3_make(0.5, 0.6, 0.7)));
    himc_quat near = himc_limit_closest(&p->body->limits, elbow, pose.joint[elbow]);
    himc_body_clamp(p->body, &pose, rate);
    for (int j = 0; j < HIMC_JOINTS; j++) {
        const himc_quat *want = j == elbow ? &near : &mean.joint[j];
        TEST_ASSERT_EQUAL_MEMORY(want, &pose.joint[j], sizeof near);
        TEST_ASSERT_EQUAL_MEMORY(j == elbow ? &stands : &moves, &rate[j], sizeof moves);
    }
    himc_performance_free(p);
}

static void test_too_little_strength_of_a_joint_is_counted(void)
{
    himc_performance *p = piece();
    session_do(p, "strength left-wrist 0.2");
    play(p);
    const char *told_of = info(p, "strength ");
    TEST_ASSERT_EQUAL_INT(0, strncmp(told_of, "strength left-wrist 0.2 N m: too weak in ", 41));
    session_do(p, "strength off");
    TEST_ASSERT_FALSE(session_try(p, "strength left-ear 3"));
    TEST_ASSERT_NOT_NULL(strstr(error.text, "strength: JOINT: left-ear, expected waist neck"));
    himc_performance_free(p);
}

static void test_human_strength_plays_accents_and_grows_with_the_players_mass(void)
{
    himc_performance *p = piece();
    session_do(p, "strength human");
    session_do(p, "player 1.6 50");
    play(p);
    himc_performance_stats s = himc_performance_measure(p);
    TEST_ASSERT_EQUAL_INT(4, s.played);
    himc_performance_free(p);
}

// fingers turn a stick by 40 rad/s then, faster than an elbow
static void test_human_strength_plays_strong_vertical_accents_in_place(void)
{
    himc_performance *p = session_new();
    session_do(p, "strength human");
    session_do(p, "drum kettle");
    session_do(p, "tempo 60");
    for (int i = 0; i < 4; i++)
        session_do(p, "stroke %d %s vertical-accent ff", i + 1, i % 2 ? "left" : "right");
    session_do(p, "play");
    session_play(p, 5.3, NULL);
    TEST_ASSERT_EQUAL_INT(4, himc_performance_measure(p).played);
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_limits_are_off_until_asked_for_and_after_reset);
    RUN_TEST(test_limits_that_are_hit_show_in_info_in_rows_of_motion_and_in_figures);
    RUN_TEST(test_limits_of_a_take_contain_its_motion);
    RUN_TEST(test_limits_of_a_take_are_at_least_0_05_wide);
    RUN_TEST(test_a_kinematic_joint_at_its_bounds_stops);
    RUN_TEST(test_too_little_strength_of_a_joint_is_counted);
    RUN_TEST(test_human_strength_plays_accents_and_grows_with_the_players_mass);
    RUN_TEST(test_human_strength_plays_strong_vertical_accents_in_place);
    return UNITY_END();
}
