/// test_pedal.c: who sits works the pedals of his drums with his feet: one foot goes to the pedal
/// that moves, turns with it and comes back, the other one stays on the floor, and strokes land.
#include "session.h"

#include "body/pedal.h"
#include "performance/performance_state.h"

#include <math.h>

#define FRONT "0.7 0 0.85"
#define GLISS "at 3 kettle gliss A3 1"
#define MOVES 1.8 // when beat 3 is, at 100 a minute (s)

/// Of the ticks.
typedef struct seen {
    himc_pedal pedal;
    bool reached;
    long ticks;
    double off;             // heel from the pedal's hinge while that moves, largest (m)
    double lowest, highest; // pitch of the foot meanwhile (rad)
    double way[HIMC_HANDS]; // of the heels from where they began, largest (m)
    double up[HIMC_HANDS];  // of a whole foot over the floor (m)
    double back;            // the pedal's foot from there at the last tick (m)
    double moved, left;     // the pelvis from there, largest and at the last tick (m)
    double share, least;    // of the feet in the weight: sum and smallest
    double jerked;          // change of an ankle's velocity within 4 ms, largest (m/s)
    himc_vec3 begun[HIMC_HANDS], pelvis, ankle[HIMC_HANDS], speed[HIMC_HANDS], mirrored;
} seen;

static himc_vec3 sole_of(const himc_body_state *b, int side, double ahead)
{
    himc_vec3 at = {ahead, 0, -HIMC_ANKLE_HEIGHT};
    himc_vec3 r = himc_mat3_apply(&b->rotation[HIMC_LEFT_FOOT + side], at);
    return himc_vec3_add(b->origin[HIMC_LEFT_FOOT + side], r);
}

static void see_foot(seen *s, const himc_body_state *b, int i)
{
    himc_vec3 heel = sole_of(b, i, -HIMC_SOLE_BEHIND), ankle = b->origin[HIMC_LEFT_FOOT + i];
    himc_vec3 speed = himc_vec3_scale(himc_vec3_sub(ankle, s->ankle[i]), 250);
    if (s->ticks == 0)
        s->begun[i] = heel;
    if (s->ticks > 1)
        s->jerked = fmax(s->jerked, himc_vec3_length(himc_vec3_sub(speed, s->speed[i])));
    s->ankle[i] = ankle;
    s->speed[i] = speed;
    double away = himc_vec3_length(himc_vec3_sub(heel, s->begun[i]));
    s->way[i] = fmax(s->way[i], away);
    s->up[i] = fmax(s->up[i], fmin(heel.z, sole_of(b, i, 0.15).z));
    if (i == (int)s->pedal.foot)
        s->back = away;
}

static void see(void *user, const himc_tick *tick)
{
    seen *s = user;
    const himc_body_state *b = tick->body;
    for (int i = 0; i < HIMC_HANDS; i++)
        see_foot(s, b, i);
    if (s->ticks++ == 0) {
        s->pelvis = b->origin[0];
        s->least = s->lowest = 1;
    }
    s->left = himc_vec3_length(himc_vec3_sub(b->origin[0], s->pelvis));
    s->moved = fmax(s->moved, s->left);
    if (tick->support) {
        double feet = tick->support->foot[0].z + tick->support->foot[1].z;
        double share = feet / fmax(feet + tick->support->seat.z, 1);
        s->share += share;
        s->least = fmin(s->least, share);
    }
    int foot = HIMC_LEFT_FOOT + (int)s->pedal.foot;
    if (tick->time < MOVES + 0.02 || tick->time > MOVES + 1)
        return;
    himc_vec3 heel = sole_of(b, (int)s->pedal.foot, -HIMC_SOLE_BEHIND);
    double pitch = asin(b->rotation[foot].m[2][0]);
    s->off = fmax(s->off, himc_vec3_length(himc_vec3_sub(heel, s->pedal.heel)));
    s->lowest = fmin(s->lowest, pitch);
    s->highest = fmax(s->highest, pitch);
    s->mirrored = heel;
}

// a drum there, and 12 strokes
static himc_performance *player(const char *stance, const char *place)
{
    himc_performance *p = session_new();
    session_do(p, "drum kettle");
    session_do(p, "kettle place %s", place);
    session_do(p, "stance %s", stance);
    session_do(p, "human 0");
    session_strokes(p, 12, "mf");
    return p;
}

// plays that for 7 s, with a line of its score, and ends it
static seen play(himc_performance *p, const char *line, heard *h)
{
    seen s = {.reached = false};
    if (*line)
        session_do(p, "%s", line);
    s.reached = himc_pedal_of(&p->motion->body.posture, himc_drums_frame(&p->drums, 0), &s.pedal);
    session_do(p, "play");
    himc_performance_on_tick(p, see, &s);
    session_play(p, 7, h);
    himc_performance_stats stats = himc_performance_measure(p);
    printf(
        "%s: heel %.1f mm off, pitch %.3f .. %.3f; heels' ways %.1f %.1f mm; pelvis %.1f, then "
        "%.1f mm (up %.1f %.1f mm, jerk %.3f); feet %.2f of the weight, at least %.2f; %d of %d strokes\n",
        line, 1e3 * s.off, s.lowest, s.highest, 1e3 * s.way[0], 1e3 * s.way[1], 1e3 * s.moved,
        1e3 * s.left, 1e3 * s.up[0], 1e3 * s.up[1], s.jerked, s.share / (double)s.ticks, s.least,
        stats.played, stats.strokes);
    TEST_ASSERT_EQUAL_INT(12, stats.played);
    TEST_ASSERT_EQUAL_INT(0, stats.recoveries);
    himc_performance_free(p);
    return s;
}

static void test_a_foot_works_the_pedal_that_the_score_moves(void)
{
    static const char *const place[] = {FRONT, "0.832 0.287 0.85", "0.763 -0.439 0.85"};
    static const himc_hand foot[] = {HIMC_RIGHT, HIMC_LEFT, HIMC_RIGHT};
    for (int i = 0; i < 3; i++) {
        seen s = play(player("seated", place[i]), GLISS, NULL);
        int other = foot[i] == HIMC_LEFT ? HIMC_RIGHT : HIMC_LEFT;
        TEST_ASSERT_TRUE(s.reached);
        TEST_ASSERT_EQUAL_INT(foot[i], s.pedal.foot);
        TEST_ASSERT_TRUE(s.off < 0.015);
        TEST_ASSERT_TRUE(s.highest - s.lowest > 0.1); // up in pitch, the toes down
        TEST_ASSERT_TRUE(s.way[foot[i]] > 0.1 && s.back < 0.010);
        // it tips and slides a little as he does
        TEST_ASSERT_TRUE(s.up[other] < 0.006 && s.way[other] < 0.025);
        TEST_ASSERT_TRUE(s.moved < 0.020 && s.left < 0.005);
        TEST_ASSERT_TRUE(s.jerked < 0.1);
    }
}

static void test_without_a_pedal_that_moves_both_feet_stay(void)
{
    static const char *const lines[] = {"", "at 3 kettle damp 1"};
    for (int i = 0; i < 2; i++) {
        seen s = play(player("seated", FRONT), lines[i], NULL);
        TEST_ASSERT_TRUE(s.way[HIMC_LEFT] < 0.003 && s.way[HIMC_RIGHT] < 0.003);
    }
}

static void test_tuning_at_a_beat_is_done_by_foot_too(void)
{
    seen s = play(player("seated", FRONT), "at 3 kettle tune A3", NULL);
    TEST_ASSERT_TRUE(s.way[HIMC_RIGHT] > 0.1 && s.back < 0.010);
}

static void test_a_gliss_without_a_score_is_followed_at_once(void)
{
    himc_performance *p = player("seated", FRONT);
    seen s = {.pedal = {.foot = HIMC_RIGHT}};
    session_play(p, 0.5, NULL);
    session_drum(p, 0, "gliss A3 2");
    himc_performance_on_tick(p, see, &s);
    session_play(p, 1, NULL);
    TEST_ASSERT_TRUE(s.way[HIMC_RIGHT] > 0.1 && s.way[HIMC_LEFT] < 0.035);
    session_play(p, 3, NULL);
    TEST_ASSERT_TRUE(s.back < 0.010);
    himc_performance_free(p);
}

static void test_mirrored_drums_take_mirrored_feet(void)
{
    seen left = play(player("seated", "0.8 0.4 0.85"), GLISS, NULL),
         right = play(player("seated", "0.8 -0.4 0.85"), GLISS, NULL);
    TEST_ASSERT_EQUAL_INT(HIMC_LEFT, left.pedal.foot);
    TEST_ASSERT_EQUAL_INT(HIMC_RIGHT, right.pedal.foot);
    // but for the strokes, which are not mirrored
    TEST_ASSERT_DOUBLE_WITHIN(0.015, left.mirrored.y, -right.mirrored.y);
    TEST_ASSERT_DOUBLE_WITHIN(0.015, left.mirrored.x, right.mirrored.x);
}

static void test_a_pedal_out_of_reach_is_left_alone_and_told(void)
{
    static const char *const place[] = {"0.251 0.843 0.85", "0.4 0 0.85", FRONT};
    for (int i = 0; i < 3; i++) {
        heard h = {.strike = NULL};
        seen s = play(player("seated", place[i]), GLISS, &h);
        bool told = strstr(h.all, "the pedal of drum kettle is out of reach of his feet");
        TEST_ASSERT_EQUAL_INT(i < 2, told);
        TEST_ASSERT_EQUAL_INT(i < 2, !s.reached);
        TEST_ASSERT_EQUAL_INT(i < 2, s.way[HIMC_LEFT] < 0.01 && s.way[HIMC_RIGHT] < 0.01);
        free(h.strike);
    }
}

static void test_others_do_not_pedal(void)
{
    seen fixed = play(player("fixed", FRONT), GLISS, NULL);
    TEST_ASSERT_TRUE(fixed.way[HIMC_LEFT] < 1e-9 && fixed.way[HIMC_RIGHT] < 1e-9);
    seen standing = play(player("standing", "0.7 0 1"), GLISS, NULL);
    TEST_ASSERT_TRUE(standing.way[HIMC_LEFT] < 0.02 && standing.way[HIMC_RIGHT] < 0.02);
}

static void test_who_is_pushed_off_his_place_takes_his_foot_back(void)
{
    himc_performance *p = player("seated", FRONT);
    seen s = {.pedal = {.foot = HIMC_RIGHT}};
    session_do(p, "at 2 kettle gliss A3 6");
    session_do(p, "at 5 push pelvis 0 400 0 0.3");
    session_do(p, "play");
    session_play(p, 2.9, NULL);
    TEST_ASSERT_TRUE(p->motion->foot.away);
    himc_performance_on_tick(p, see, &s);
    session_play(p, 0.6, NULL);
    TEST_ASSERT_TRUE(s.moved > 0.025);
    TEST_ASSERT_FALSE(p->motion->foot.away);
    session_play(p, 3, NULL);
    TEST_ASSERT_EQUAL_INT(0, himc_performance_measure(p).recoveries);
    himc_performance_free(p);
}

// times he is put back within 7 s
static long put_back(const char *gliss, const char *more)
{
    himc_performance *p = player("seated", FRONT);
    session_do(p, "%s", gliss);
    session_do(p, "%s", more);
    session_do(p, "play");
    session_play(p, 7, NULL);
    long times = himc_performance_measure(p).recoveries;
    himc_performance_free(p);
    return times;
}

static void test_who_falls_with_a_foot_on_a_pedal_falls_once(void)
{
    TEST_ASSERT_EQUAL_INT(1, put_back("at 3 kettle gliss A3 4", "at 6 push trunk 0 400 0 0.5"));
}

static void test_a_slow_task_rate_pedals_too(void)
{
    TEST_ASSERT_EQUAL_INT(0, put_back(GLISS, "rate task 50"));
}

static void test_a_gliss_under_way_is_taken_up(void)
{
    himc_performance *p = player("seated", FRONT);
    session_do(p, "kettle gliss A3 5");
    session_do(p, "play");
    session_play(p, 1, NULL);
    TEST_ASSERT_TRUE(p->motion->foot.away);
    himc_performance_free(p);
}

static void test_the_size_of_blocks_changes_no_bit(void)
{
    static const int size[] = {480, 37};
    himc_body_state end[2];
    for (int k = 0; k < 2; k++) {
        himc_performance *p = player("seated", FRONT);
        session_do(p, GLISS);
        session_do(p, "play");
        for (int left = 3 * 48000; left > 0; left -= size[k])
            himc_performance_process(p, left < size[k] ? left : size[k], NULL);
        end[k] = p->body->state;
        himc_performance_free(p);
    }
    TEST_ASSERT_EQUAL_MEMORY(&end[0].origin, &end[1].origin, sizeof end[0].origin);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_foot_works_the_pedal_that_the_score_moves);
    RUN_TEST(test_without_a_pedal_that_moves_both_feet_stay);
    RUN_TEST(test_tuning_at_a_beat_is_done_by_foot_too);
    RUN_TEST(test_a_gliss_without_a_score_is_followed_at_once);
    RUN_TEST(test_mirrored_drums_take_mirrored_feet);
    RUN_TEST(test_a_pedal_out_of_reach_is_left_alone_and_told);
    RUN_TEST(test_others_do_not_pedal);
    RUN_TEST(test_who_is_pushed_off_his_place_takes_his_foot_back);
    RUN_TEST(test_who_falls_with_a_foot_on_a_pedal_falls_once);
    RUN_TEST(test_a_slow_task_rate_pedals_too);
    RUN_TEST(test_a_gliss_under_way_is_taken_up);
    RUN_TEST(test_the_size_of_blocks_changes_no_bit);
    return UNITY_END();
}
