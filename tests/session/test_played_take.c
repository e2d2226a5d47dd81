/// test_played_take.c: a whole player's take, played: by its joints, by its tips, from files as
/// laboratories leave them.
#include "take_players.h"

#include "session.h"

#include "capture/take.h"
#include "himc/membrane.h"

#define SECONDS 2.5
#define FILE_NAME "build/played.bvh"
#define ONE_HAND "build/one-hand.trc"

static himc_skeleton skeleton;

typedef struct watch {
    double start;                 // of the take in the performance's time (s)
    double joint;                 // sum of squares of the joints' error (rad^2)
    double elbow[2], captured[2]; // lowest and highest
    int count;
} watch;

static void save_take(double rate)
{
    himc_skeleton_config config = himc_skeleton_default();
    config.height = 1.82;
    TEST_ASSERT_TRUE(himc_skeleton_init(&skeleton, &config, &error));
    himc_take *take = beaten_take(&skeleton, rate, SECONDS, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    TEST_ASSERT_TRUE_MESSAGE(himc_take_save(take, FILE_NAME, &error), error.text);
    himc_take_free(take);
}

// arms and trunk against the capture, over the middle of the take
static void hear_motion(void *user, const himc_motion_row *row)
{
    watch *w = user;
    double t = row->time - w->start;
    if (t < 0.2 || t > SECONDS - 0.2)
        return;
    himc_pose pose = beaten_pose(&skeleton, t);
    himc_body_state s;
    himc_pose_to_state(&skeleton, &pose, NULL, &s);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        int j = himc_arm_joint(HIMC_RIGHT, k);
        himc_quat back = himc_quat_conj(himc_quat_exp(row->joint[j]));
        himc_vec3 off = himc_quat_log(himc_quat_mul(pose.joint[j], back));
        w->joint += himc_vec3_dot(off, off);
        w->count++;
    }
    double z[2] = {row->elbow[HIMC_RIGHT].z, s.origin[HIMC_RIGHT_FOREARM].z};
    w->elbow[0] = fmin(w->elbow[0], z[0]);
    w->elbow[1] = fmax(w->elbow[1], z[0]);
    w->captured[0] = fmin(w->captured[0], z[1]);
    w->captured[1] = fmax(w->captured[1], z[1]);
}

static himc_performance_stats play_take(const char *mode, watch *w)
{
    himc_performance *p = session_new();
    session_do(p, "mode %s", mode);
    session_do(p, "human 1"); // a take is played as captured
    session_do(p, "take %s", FILE_NAME);
    *w = (watch){.start = 1, .elbow = {9, -9}, .captured = {9, -9}};
    himc_performance_on_motion(p, hear_motion, w);
    session_do(p, "play");
    himc_performance_process(p, (int)((SECONDS + 2) * 48000), NULL);
    himc_performance_stats s = himc_performance_measure(p);
    himc_performance_free(p);
    return s;
}

static double degrees_rms(const watch *w)
{
    return sqrt(w->joint / w->count) * 180 / HIMC_PI;
}

static void test_id_follows_the_captured_joints_and_rebounds_by_physics(void)
{
    watch w;
    save_take(250);
    himc_performance_stats s = play_take("id", &w);
    printf("id: tips %.4f %% of the height, joints %.3f degrees RMS\n", s.tip_rms_percent,
           degrees_rms(&w));
    TEST_ASSERT_EQUAL_INT(10, s.strokes);
    TEST_ASSERT_EQUAL_INT(10, s.played);
    TEST_ASSERT_EQUAL_INT(0, s.recoveries);
    TEST_ASSERT_TRUE(s.tip_rms_percent < 0.05);
    TEST_ASSERT_TRUE(degrees_rms(&w) < 1);
    double ratio = (w.elbow[1] - w.elbow[0]) / (w.captured[1] - w.captured[0]);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 1, ratio);
}

static void test_ik_shows_the_captured_joints(void)
{
    watch w;
    save_take(250);
    himc_performance_stats s = play_take("ik", &w);
    TEST_ASSERT_EQUAL_INT(10, s.played);
    TEST_ASSERT_TRUE(s.tip_rms_percent < 0.05);
    TEST_ASSERT_TRUE(degrees_rms(&w) < 1);
}

static void test_himc_plays_a_take_from_the_tips_alone(void)
{
    watch w;
    save_take(250);
    himc_performance_stats s = play_take("himc", &w);
    TEST_ASSERT_EQUAL_INT(10, s.played);
    TEST_ASSERT_TRUE(s.tip_rms_percent < 0.05);
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 1, s.captured_speed_ratio); // falls without a last snap
}

static void test_any_rate_of_capture_is_played(void)
{
    static const double rates[] = {60, 2000};
    for (int i = 0; i < 2; i++) {
        watch w;
        save_take(rates[i]);
        himc_performance_stats s = play_take("id", &w);
        TEST_ASSERT_EQUAL_INT(10, s.played);
        TEST_ASSERT_EQUAL_INT(0, s.recoveries);
        TEST_ASSERT_TRUE(s.tip_rms_percent < 0.1);
    }
}

static void test_the_performer_gets_the_players_body_and_seat(void)
{
    char line[96];
    himc_performance *p = session_new();
    himc_event event;
    bool said = false;
    save_take(250);
    session_do(p, "take %s", FILE_NAME);
    snprintf(line, sizeof line, "%s: the player's body: ", FILE_NAME);
    while (himc_performance_event(p, &event))
        said = said || (event.kind == HIMC_EVENT_NOTE && strstr(event.text, line) &&
                        strstr(event.text, "1.82 m"));
    TEST_ASSERT_TRUE(said);
    himc_performance_free(p);
}

static void test_a_drum_in_another_place_is_moved_under_the_strikes_and_struck(void)
{
    himc_performance *p = session_new();
    himc_drum *drum = himc_drum_new("kettle", 23, 48000, &error);
    himc_command place;
    save_take(250);
    TEST_ASSERT_TRUE(himc_command_parse_text(&place, HIMC_DRUM, "place 1.4 -0.5 0.9", &error));
    TEST_ASSERT_TRUE(himc_drum_command(drum, &place, &error));
    TEST_ASSERT_TRUE(himc_performance_add_drum(p, drum, &error));
    himc_drum_release(drum);
    session_do(p, "take %s", FILE_NAME);
    session_do(p, "play");
    himc_performance_process(p, (int)((SECONDS + 2) * 48000), NULL);
    himc_performance_stats s = himc_performance_measure(p);
    TEST_ASSERT_EQUAL_INT(10, s.played);
    himc_performance_free(p);
}

static void test_another_take_and_a_score_follow_a_take(void)
{
    himc_performance *p = session_new();
    save_take(250);
    session_do(p, "mode id");
    session_do(p, "take %s", FILE_NAME);
    session_do(p, "play");
    himc_performance_process(p, 72000, NULL);
    session_do(p, "take %s", FILE_NAME); // while it plays
    session_do(p, "play");
    himc_performance_process(p, 96000, NULL);
    session_do(p, "stop");
    himc_performance_process(p, 24000, NULL);
    session_do(p, "score patches/improvisation.txt");
    session_do(p, "play");
    himc_performance_process(p, 96000, NULL);
    himc_performance_stats s = himc_performance_measure(p);
    TEST_ASSERT_EQUAL_INT(0, s.recoveries);
    TEST_ASSERT_EQUAL_INT(7, s.played); // 2 of the first, 4 of the second, 1 of the score
    himc_performance_free(p);
}

static void test_a_take_that_is_refused_changes_nothing(void)
{
    himc_performance *p = session_new();
    save_take(250);
    himc_take_options huge = himc_take_default();
    huge.unit = 0.1; // of centimetres: 18 m
    session_do(p, "take %s", FILE_NAME);
    himc_performance_take_options(p, &huge);
    TEST_ASSERT_FALSE(session_try(p, "take %s", FILE_NAME));
    TEST_ASSERT_EQUAL_STRING(FILE_NAME
                             ": player: left-upper-arm of 2.94 m, expected 0.14 .. 0.45 m:"
                             " is the unit right?",
                             error.text);
    session_do(p, "play");
    himc_performance_process(p, (int)((SECONDS + 2) * 48000), NULL);
    TEST_ASSERT_EQUAL_INT(10, himc_performance_measure(p).played);
    himc_performance_free(p);
}

// plays the take with a head that is damped so long after its first frame; the time at which the
// head is damped (s), and at which the piece is over
static double damped_at(double seconds, double *over)
{
    enum { TICK = 192 };
    char text[200];
    heard h = {0};
    double damped = -1;
    snprintf(text, sizeof text, "drum low 26; take build/played.bvh; at %g low damp 1;", seconds);
    himc_performance *p = session_new();
    session_score(p, "build/damped-take.txt", text);
    session_do(p, "play");
    for (int i = 0; i < 10 * 250 && h.dones == 0; i++) {
        session_play(p, TICK / 48000.0, &h);
        const himc_membrane *head = himc_drum_membrane(himc_performance_drum(p, 0));
        if (damped < 0 && himc_membrane_head(head)->damp > 0)
            damped = (double)himc_performance_time(p) / 48000;
    }
    *over = h.dones == 1 ? (double)himc_performance_time(p) / 48000 : -1;
    heard_free(&h);
    himc_performance_free(p);
    return damped;
}

static void test_a_head_changes_at_its_time_in_a_take(void)
{
    double over[3], soon, later, last;
    save_take(250);
    soon = damped_at(0.5, &over[0]);
    later = damped_at(1.5, &over[1]);
    last = damped_at(SECONDS + 2, &over[2]); // the piece waits for it
    TEST_ASSERT_TRUE(soon > 0.4);
    TEST_ASSERT_DOUBLE_WITHIN(0.005, soon + 1, later);
    TEST_ASSERT_DOUBLE_WITHIN(0.005, soon + SECONDS + 1.5, last);
    TEST_ASSERT_DOUBLE_WITHIN(0.005, over[0], over[1]);
    TEST_ASSERT_TRUE(over[2] >= last && over[2] < last + 0.5);
}

static int strikes_of(const heard *h, himc_hand hand)
{
    int n = 0;
    for (int i = 0; i < h->strikes; i++)
        n += h->strike[i].hand == hand;
    return n;
}

static void test_a_piece_of_one_hand_waits_for_its_last_change_of_a_head(void)
{
    for (int given = 0; given < 2; given++) {
        himc_performance *p = session_new();
        heard h = {0};
        TEST_ASSERT_TRUE(write_one_hand(ONE_HAND));
        session_score(p, "build/one-hand.txt", "drum low 26; take " ONE_HAND "; at 4 low damp 1;");
        session_do(p, "play");
        session_play(p, 4.5, &h);
        TEST_ASSERT_TRUE(strikes_of(&h, HIMC_RIGHT) > 2);
        if (given) // the take is past, and its hand follows targets
            session_do(p, "target right 0.5 -0.2 1.2");
        session_play(p, 0.4, &h);
        TEST_ASSERT_EQUAL_INT(0, h.dones);
        session_play(p, 0.6, &h);
        const himc_membrane *head = himc_drum_membrane(himc_performance_drum(p, 0));
        TEST_ASSERT_TRUE(himc_membrane_head(head)->damp > 0);
        TEST_ASSERT_EQUAL_INT(1, h.dones);
        heard_free(&h);
        himc_performance_free(p);
    }
}

static void test_stop_ends_the_score_of_the_hand_that_a_take_leaves_free(void)
{
    himc_performance *p = session_new();
    heard h = {0};
    TEST_ASSERT_TRUE(write_one_hand(ONE_HAND));
    session_do(p, "drum low 26");
    session_do(p, "tempo 120");
    for (int beat = 0; beat < 12; beat++)
        session_do(p, "stroke %d left legato f", beat);
    session_do(p, "play");
    session_play(p, 0.5, NULL);
    session_do(p, "take %s", ONE_HAND);
    session_do(p, "play");
    session_play(p, 2, &h);
    TEST_ASSERT_TRUE(strikes_of(&h, HIMC_LEFT) > 2 && strikes_of(&h, HIMC_RIGHT) > 1);
    session_do(p, "stop");
    session_play(p, 0.1, &h);
    heard_free(&h);
    session_play(p, 2, &h);
    TEST_ASSERT_EQUAL_INT(0, h.strikes);
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_id_follows_the_captured_joints_and_rebounds_by_physics);
    RUN_TEST(test_ik_shows_the_captured_joints);
    RUN_TEST(test_himc_plays_a_take_from_the_tips_alone);
    RUN_TEST(test_any_rate_of_capture_is_played);
    RUN_TEST(test_the_performer_gets_the_players_body_and_seat);
    RUN_TEST(test_a_drum_in_another_place_is_moved_under_the_strikes_and_struck);
    RUN_TEST(test_another_take_and_a_score_follow_a_take);
    RUN_TEST(test_a_take_that_is_refused_changes_nothing);
    RUN_TEST(test_a_head_changes_at_its_time_in_a_take);
    RUN_TEST(test_a_piece_of_one_hand_waits_for_its_last_change_of_a_head);
    RUN_TEST(test_stop_ends_the_score_of_the_hand_that_a_take_leaves_free);
    return UNITY_END();
}
