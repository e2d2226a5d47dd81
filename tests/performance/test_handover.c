/// test_handover.c: the hands go from the take to the planner and back without a jerk, whenever a
/// take is stopped, over, replaced or dropped; and the state after `reset`, `player`, `gain reset`.
#include "take_players.h"

#include "session.h"

#include "performance/performance_state.h"

#define FILE_NAME "build/handover.bvh"
#define SECONDS 2.5

static himc_performance *p;

typedef struct seen {
    bool any;
    himc_vec3 target[HIMC_HANDS];
    double fastest; // of the targets from tick to tick (m/s)
} seen;

static seen eye;

static void see(void *user, const himc_tick *tick)
{
    seen *s = user;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_vec3 way = himc_vec3_sub(tick->target[hand], s->target[hand]);
        if (s->any)
            s->fastest = fmax(s->fastest, 250 * himc_vec3_length(way));
        s->target[hand] = tick->target[hand];
    }
    s->any = true;
}

// a performer who plays a take since `seconds`; the take begins a second after `play`
static void playing(double seconds)
{
    himc_skeleton body;
    himc_skeleton_config config = himc_skeleton_default();
    config.height = 1.82;
    TEST_ASSERT_TRUE(himc_skeleton_init(&body, &config, &error));
    himc_take *take = beaten_take(&body, 250, SECONDS, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    TEST_ASSERT_TRUE_MESSAGE(himc_take_save(take, FILE_NAME, &error), error.text);
    himc_take_free(take);
    eye = (seen){.any = false};
    p = session_new();
    himc_performance_on_tick(p, see, &eye);
    session_do(p, "take " FILE_NAME);
    session_do(p, "play");
    session_play(p, seconds, NULL);
}

// leaves the take by a command; after `reset` the body begins anew, where a new performer's does
static void leave(const char *command)
{
    session_do(p, "%s", command);
    eye.fastest = 0;
    eye.any = strcmp(command, "reset") != 0;
}

static double largest_torque(double seconds)
{
    double most = 0;
    for (long i = 0; i < lround(seconds * 10000); i++) {
        himc_performance_process(p, i % 5 == 0 ? 4 : 5, NULL);
        for (int j = 0; j < HIMC_JOINTS; j++)
            most = fmax(most, himc_vec3_length(p->body->torque[j]));
    }
    return most;
}

static void test_a_stopped_take_is_left_without_a_jerk(void)
{
    static const char *const by[] = {"score patches/improvisation.txt", ("take " FILE_NAME),
                                     "reset"};
    for (int i = 0; i < 3; i++) {
        playing(2.4);
        session_do(p, "stop");
        session_play(p, 2, NULL);
        double before = largest_torque(0.01);
        leave(by[i]);
        TEST_ASSERT_TRUE_MESSAGE(largest_torque(0.3) < 2 * before, by[i]); // was 5000 N m
        TEST_ASSERT_TRUE_MESSAGE(eye.fastest < 1, by[i]);                  // was 100 m/s
        himc_performance_free(p);
    }
}

static void test_a_take_is_left_in_the_middle_of_a_stroke_without_a_jump(void)
{
    static const char *const by[] = {"score patches/improvisation.txt", "reset"};
    for (int i = 0; i < 2; i++) {
        playing(2.3);
        double before = eye.fastest;
        leave(by[i]);
        session_play(p, 0.5, NULL);
        TEST_ASSERT_TRUE_MESSAGE(eye.fastest < before, by[i]);
        himc_performance_free(p);
    }
}

static void test_joint_targets_cross_fade_from_captured_to_natural(void)
{
    playing(2.4);
    session_do(p, "mode id");
    session_play(p, 0.1, NULL);
    session_do(p, "stop");
    session_play(p, 2, NULL);
    double before = largest_torque(0.01);
    himc_vec3 x = eye.target[HIMC_RIGHT]; // where it is
    session_do(p, "target right %.6f %.6f %.6f", x.x, x.y, x.z);
    TEST_ASSERT_TRUE(largest_torque(0.7) < 2 * before);
    himc_performance_free(p);
}

static void test_strikes_after_a_stop_are_not_awaited(void)
{
    playing(2.3);
    int strokes = himc_performance_measure(p).strokes;
    session_do(p, "stop");
    session_play(p, 3, NULL);
    TEST_ASSERT_TRUE(himc_performance_measure(p).strokes <= strokes + 1); // one may be under way
    himc_performance_free(p);
}

static void test_a_take_stopped_before_it_begins_comes_to_rest(void)
{
    playing(0.5);
    session_do(p, "stop");
    session_play(p, 1, NULL);
    eye.fastest = 0;
    session_play(p, 2, NULL);
    TEST_ASSERT_TRUE(eye.fastest < 1e-6);
    TEST_ASSERT_EQUAL_INT(0, himc_performance_measure(p).strokes);
    himc_performance_free(p);
}

static void test_hits_and_targets_move_the_hands_after_a_take(void)
{
    heard h = {0};
    playing(1.5);
    TEST_ASSERT_FALSE(session_try(p, "hit right accent f"));
    TEST_ASSERT_EQUAL_STRING("hit: not possible while a take is playing", error.text);
    session_do(p, "target right 0.5 -0.1 1.2");
    session_do(p, "target right 0.5 -0.1 1.2");
    session_play(p, 0.01, &h);
    TEST_ASSERT_EQUAL_INT(1, h.notes); // not for each of a stream
    TEST_ASSERT_EQUAL_STRING("target right: not possible while a take is playing", h.note);
    session_play(p, SECONDS + 1, NULL);
    h.strikes = 0;
    session_do(p, "hit right accent f");
    session_play(p, 1, &h);
    TEST_ASSERT_EQUAL_INT(1, h.strikes);
    TEST_ASSERT_EQUAL_STRING("accent", h.strike[0].nuance);
    session_do(p, "target right 0.5 -0.1 1.2");
    session_play(p, 1, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 1.2, eye.target[HIMC_RIGHT].z);
    session_do(p, "play"); // and the take has them again
    session_play(p, SECONDS + 2, &h);
    TEST_ASSERT_TRUE(h.strikes > 8);
    heard_free(&h);
    himc_performance_free(p);
}

static void describe(void *user, const char *line)
{
    if (strncmp(line, "stopped", 7) != 0 && strncmp(line, "drum", 4) != 0)
        strncat(strcat(user, "\n"), line, 300);
}

static void test_reset_leaves_a_performer_as_just_made(void)
{
    char fresh[4096] = "", after[4096] = "";
    heard h = {0};
    himc_performance *new = session_new();
    himc_performance_describe(new, HIMC_DESCRIBE_INFO, describe, fresh);
    playing(2.4);
    session_do(p, "tempo 240");
    session_do(p, "limits ellipsoid");
    session_do(p, "gain right-elbow 7 1");
    session_do(p, "reset");
    himc_performance_describe(p, HIMC_DESCRIBE_INFO, describe, after);
    TEST_ASSERT_EQUAL_STRING(fresh, after);
    TEST_ASSERT_EQUAL_MEMORY(new->body->controller.gain, p->body->controller.gain,
                             sizeof p->body->controller.gain);
    TEST_ASSERT_EQUAL_MEMORY(new->motion->body.posture.rest.joint,
                             p->motion->body.posture.rest.joint,
                             sizeof p->motion->body.posture.rest.joint);
    session_do(p, "stroke 2 left legato mf");
    session_do(p, "stroke 4 left legato mf");
    session_do(p, "play");
    session_play(p, 4, &h);
    TEST_ASSERT_EQUAL_INT(2, h.strikes); // none of the take's, though one was under way
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 1.2, h.strike[1].time - h.strike[0].time); // 100 BPM
    heard_free(&h);
    himc_performance_free(p);
    himc_performance_free(new);
}

static void test_gain_reset_changes_nothing_in_a_new_performance(void)
{
    p = session_new();
    himc_controller before = p->body->controller;
    session_play(p, 0.5, NULL);
    session_do(p, "target right 0.4 -0.2 1.2");
    session_play(p, 1, NULL);
    session_do(p, "gain reset");
    TEST_ASSERT_EQUAL_MEMORY(before.gain, p->body->controller.gain, sizeof before.gain);
    TEST_ASSERT_EQUAL_MEMORY(before.inertia, p->body->controller.inertia, sizeof before.inertia);
    himc_performance_free(p);
}

static void test_player_before_and_after_a_take_is_the_same_body(void)
{
    himc_performance *new = session_new();
    playing(1.5);
    session_do(p, "player 2.1 120");
    session_do(new, "player 2.1 120");
    session_do(new, "take " FILE_NAME);
    for (int i = 1; i < HIMC_SEGMENTS; i++)
        TEST_ASSERT_EQUAL_DOUBLE(new->body->skeleton.segment[i].length,
                                 p->body->skeleton.segment[i].length);
    TEST_ASSERT_EQUAL_MEMORY(himc_drum_head_frame(himc_performance_drum(new, 0)),
                             himc_drum_head_frame(himc_performance_drum(p, 0)),
                             sizeof(himc_head_frame));
    himc_performance_free(p);
    himc_performance_free(new);
}

// the take's player is measured, its mass follows from `player`: 15 kg here
static void test_player_that_is_refused_leaves_the_drum_under_the_take(void)
{
    playing(1.5);
    himc_head_frame before = *himc_drum_head_frame(himc_performance_drum(p, 0));
    unsigned revision = himc_drum_revision(himc_performance_drum(p, 0));
    TEST_ASSERT_FALSE(session_try(p, "player 2.2 30"));
    TEST_ASSERT_EQUAL_MEMORY(&before, himc_drum_head_frame(himc_performance_drum(p, 0)),
                             sizeof before);
    TEST_ASSERT_EQUAL_UINT(revision, himc_drum_revision(himc_performance_drum(p, 0)));
    himc_performance_free(p);
}

static void test_a_set_up_leaves_the_take(void)
{
    playing(1.5);
    session_do(p, "setup timpani");
    session_play(p, 0.2, NULL);
    TEST_ASSERT_NOT_NULL(p->motion->track);
    TEST_ASSERT_TRUE(p->motion->playing);
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_stopped_take_is_left_without_a_jerk);
    RUN_TEST(test_a_take_is_left_in_the_middle_of_a_stroke_without_a_jump);
    RUN_TEST(test_joint_targets_cross_fade_from_captured_to_natural);
    RUN_TEST(test_strikes_after_a_stop_are_not_awaited);
    RUN_TEST(test_a_take_stopped_before_it_begins_comes_to_rest);
    RUN_TEST(test_hits_and_targets_move_the_hands_after_a_take);
    RUN_TEST(test_reset_leaves_a_performer_as_just_made);
    RUN_TEST(test_gain_reset_changes_nothing_in_a_new_performance);
    RUN_TEST(test_player_before_and_after_a_take_is_the_same_body);
    RUN_TEST(test_player_that_is_refused_leaves_the_drum_under_the_take);
    RUN_TEST(test_a_set_up_leaves_the_take);
    return UNITY_END();
}
