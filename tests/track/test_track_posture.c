/// test_track_posture.c: the joints of a take as targets: as captured, or bent to the tips around
/// the blows that are cut out.
#include "allocations.h"
#include "take_players.h"

#include "track/track.h"

#include "unity.h"

#define DEGREE (HIMC_PI / 180)

static himc_error error;
static himc_take *take;
static himc_track *track;
static himc_player *player;
static himc_skeleton skeleton;

void setUp(void)
{
    error.text[0] = 0;
    take = NULL;
    track = NULL;
    player = NULL;
}

void tearDown(void)
{
    himc_track_free(track);
    himc_player_free(player);
    himc_take_free(take);
}

static double distance(himc_vec3 a, himc_vec3 b)
{
    return himc_vec3_length(himc_vec3_sub(a, b));
}

// a take of 3 s at `rate` with all joints of a player, and its track
static void make_played(double rate)
{
    himc_skeleton_config given = himc_skeleton_default();
    himc_head_frame drum = usual_drum;
    TEST_ASSERT_TRUE(himc_skeleton_init(&skeleton, &given, &error));
    take = beaten_take(&skeleton, rate, 3, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    player = himc_player_new(take, NULL, &given, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(player, error.text);
    TEST_ASSERT_TRUE(himc_player_sit(player, take, NULL, &drum, NULL));
    track = himc_track_new(take, NULL, &drum, player, player->config.mallet_radius, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(track, error.text);
    TEST_ASSERT_TRUE(himc_track_has_posture(track));
}

static himc_posture_motion posture_at(double t)
{
    himc_posture_motion m;
    himc_target tip[HIMC_HANDS];
    memset(&m, 0, sizeof m);
    for (int j = 0; j < HIMC_JOINTS; j++)
        m.joint[j] = himc_quat_identity();
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        tip[hand] = himc_track_target(track, (himc_hand)hand, t);
    himc_track_posture(track, &skeleton, t, tip, &m);
    return m;
}

// largest distances of the tips of the joint targets from the tips' own targets (m, m/s)
static void compare_tips(double t, double off[2])
{
    himc_posture_motion m = posture_at(t);
    himc_body_state s;
    himc_pose pose;
    memcpy(pose.joint, m.joint, sizeof pose.joint);
    himc_pose_to_state(&skeleton, &pose, m.rate, &s);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_target tip = himc_track_target(track, (himc_hand)hand, t);
        off[0] = fmax(off[0], distance(tip.x, s.tip[hand]));
        off[1] = fmax(off[1], distance(tip.v, s.tip_velocity[hand]));
    }
}

static void test_joint_targets_bring_the_tips_to_their_targets_through_every_strike(void)
{
    double off[2] = {0, 0};
    make_played(250);
    for (double t = -0.2; t < 3.3; t += 0.0013)
        compare_tips(t, off);
    TEST_ASSERT_TRUE(off[0] < 1e-9);
    TEST_ASSERT_TRUE(off[1] < 2e-3); // the third order of the differences
}

static void test_after_separation_the_joints_follow_the_measured_stick(void)
{
    double time, x, y, off[2] = {0, 0};
    make_played(250);
    TEST_ASSERT_TRUE(himc_track_current(track, HIMC_RIGHT, 1, &time, &x, &y));
    himc_target measured = himc_track_target(track, HIMC_RIGHT, time);
    measured.v = himc_vec3_make(0.1, 0, 2.9);
    measured.a = himc_vec3_make(0, 0, -40);
    himc_track_source.separated(track, HIMC_RIGHT, time + 0.007, &measured);
    for (double t = time + 0.007; t < time + 0.1; t += 0.0005)
        compare_tips(t, off);
    TEST_ASSERT_TRUE(off[0] < 1e-9);
    TEST_ASSERT_TRUE(off[1] < 5e-3);
}

static himc_posture_motion captured_at(double t)
{
    himc_posture_motion m;
    memset(&m, 0, sizeof m);
    for (int j = 0; j < HIMC_JOINTS; j++)
        m.joint[j] = himc_quat_identity();
    himc_track_posture(track, &skeleton, t, NULL, &m);
    return m;
}

// largest angle between a joint of `motion` and the played one
static double worst_joint(himc_posture_motion motion(double t), double from, double to)
{
    double worst = 0;
    for (double t = from; t < to; t += 0.001) {
        himc_posture_motion m = motion(t);
        himc_pose pose = beaten_pose(&skeleton, t);
        for (int j = 0; j < HIMC_LEFT_UPPER_LEG - 1; j++) {
            himc_quat off = himc_quat_mul(himc_quat_conj(pose.joint[j]), m.joint[j]);
            worst = fmax(worst, himc_vec3_length(himc_quat_log(off)));
        }
    }
    return worst;
}

static void test_between_strikes_the_joints_are_the_captured_ones(void)
{
    static const double rates[] = {100, 250, 2000};
    for (int i = 0; i < 3; i++) {
        make_played(rates[i]);
        // blows are at 0.15, 0.4, 0.65 ...
        TEST_ASSERT_TRUE(worst_joint(posture_at, 1.0, 1.1) < 0.2 * DEGREE);
        TEST_ASSERT_TRUE(worst_joint(captured_at, 1.0, 1.1) < 0.2 * DEGREE);
        tearDown();
        setUp();
    }
}

// as published, no strike is replaced and no arm bent: the rebound is the captured one
static void test_unbent_joints_follow_the_captured_rebound(void)
{
    make_played(250);
    TEST_ASSERT_TRUE(worst_joint(captured_at, 0.5, 2.5) < 1.5 * DEGREE);
    for (double t = 0.5, h = 1e-4; t < 2.5; t += 0.0037) {
        himc_posture_motion a = captured_at(t), b = captured_at(t + h);
        for (int j = 0; j < HIMC_LEFT_UPPER_LEG - 1; j++) // no contact anywhere
            TEST_ASSERT_DOUBLE_WITHIN(
                0.1, 0, distance(b.rate[j], himc_vec3_madd(a.rate[j], h, a.acceleration[j])));
    }
}

static void test_joint_targets_are_smooth_except_at_the_contact(void)
{
    double jump[2] = {0, 0}, h = 1e-4;
    make_played(250);
    himc_posture_motion a = posture_at(0.7);
    for (int i = 1; i < 20000; i++) {
        double t = 0.7 + i * h, time, x, y;
        bool contact = false;
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            contact =
                contact || (himc_track_current(track, (himc_hand)hand, t - h, &time, &x, &y) &&
                            fabs(t - time) < 0.002);
        himc_posture_motion b = posture_at(t);
        for (int j = 0; j < HIMC_LEFT_UPPER_LEG - 1 && !contact; j++) {
            himc_vec3 step = himc_quat_log(himc_quat_mul(b.joint[j], himc_quat_conj(a.joint[j])));
            himc_vec3 mean = himc_vec3_scale(himc_vec3_add(a.rate[j], b.rate[j]), 0.5 * h);
            jump[0] = fmax(jump[0], distance(step, mean));
            jump[1] =
                fmax(jump[1], distance(b.rate[j], himc_vec3_madd(a.rate[j], h, a.acceleration[j])));
        }
        a = b;
    }
    TEST_ASSERT_TRUE(jump[0] < 2e-6);
    TEST_ASSERT_TRUE(jump[1] < 0.02);
}

static void test_joints_approach_from_their_present_state_and_come_to_rest_after_a_stop(void)
{
    make_played(250);
    himc_posture_motion now = posture_at(2), at_first, later;
    himc_target tip[HIMC_HANDS];
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        tip[hand] = himc_track_target(track, (himc_hand)hand, 2);
        himc_track_approach(track, (himc_hand)hand, &tip[hand], 1);
    }
    himc_track_approach_posture(track, &now);
    at_first = posture_at(-1);
    for (int j = 0; j < HIMC_LEFT_UPPER_LEG - 1; j++) {
        himc_quat off = himc_quat_mul(himc_quat_conj(now.joint[j]), at_first.joint[j]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, himc_vec3_length(himc_quat_log(off)));
    }
    himc_track_source.stop(track, 2, tip);
    later = posture_at(2.4);
    for (int j = 0; j < HIMC_LEFT_UPPER_LEG - 1; j++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, himc_vec3_length(later.rate[j]));
}

static void test_postures_allocate_nothing(void)
{
    make_played(250);
    himc_posture_motion m = posture_at(1);
    watch_allocations();
    himc_track_approach_posture(track, &m);
    for (double t = -0.5; t < 3; t += 0.01)
        m = posture_at(t);
    TEST_ASSERT_EQUAL_INT(0, allocations_seen());
}

// a track of tips without a player moves no joint
static void test_joints_that_the_take_does_not_have_stay_as_they_are(void)
{
    himc_posture_motion m;
    himc_posture natural;
    himc_target tip[HIMC_HANDS];
    make_played(250);
    himc_track_free(track);
    track = himc_track_new(take, NULL, &usual_drum, NULL, 0.0175, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(track, error.text);
    TEST_ASSERT_FALSE(himc_track_has_posture(track));
    himc_posture_init(&natural, &skeleton, 0.87);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        tip[hand] = himc_track_target(track, (himc_hand)hand, 1);
    himc_posture_moving(&natural, tip, &m);
    himc_posture_motion before = m;
    for (int bent = 0; bent < 2; bent++) {
        himc_track_posture(track, &skeleton, 1, bent ? tip : NULL, &m);
        for (int j = 0; j < HIMC_JOINTS; j++) {
            himc_quat off = himc_quat_mul(himc_quat_conj(before.joint[j]), m.joint[j]);
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, himc_vec3_length(himc_quat_log(off)));
        }
    }
}

// a captured arm without a stick: its end is not at the tip
static void test_an_arm_without_a_stick_is_bent_from_its_present_state(void)
{
    int shoulder = himc_arm_joint(HIMC_RIGHT, 0), grip = himc_arm_joint(HIMC_RIGHT, 3);
    himc_posture_motion m;
    himc_body_state s;
    himc_pose pose;
    make_played(250);
    himc_track_free(track);
    for (int f = 0; f < player->frames; f++)
        player->pose[f].joint[grip] = himc_quat_exp(himc_vec3_make(0, 1.5, 0));
    for (int shown = 0; shown < 2; shown++) {
        player->known[grip] = shown;
        himc_head_frame drum = usual_drum;
        track = himc_track_new(take, NULL, &drum, player, player->config.mallet_radius, &error);
        TEST_ASSERT_NOT_NULL_MESSAGE(track, error.text);
        m = posture_at(1);
        memcpy(pose.joint, m.joint, sizeof pose.joint);
        himc_quat turned = himc_quat_exp(himc_vec3_make(0, 0.3, 0));
        m.joint[shoulder] = pose.joint[shoulder] = himc_quat_mul(turned, pose.joint[shoulder]);
        himc_pose_to_state(&skeleton, &pose, NULL, &s);
        himc_target tip[HIMC_HANDS] = {{.x = s.tip[HIMC_LEFT]}, {.x = s.tip[HIMC_RIGHT]}};
        himc_track_posture(track, &skeleton, 1, tip, &m);
        double off = fabs(himc_quat_dot(m.joint[shoulder], pose.joint[shoulder]));
        TEST_ASSERT_TRUE(shown ? off < 0.9999 : off > 1 - 1e-9);
        himc_track_posture(track, &skeleton, 1, NULL, &m);
        off = fabs(himc_quat_dot(m.joint[shoulder], player->pose[250].joint[shoulder]));
        TEST_ASSERT_TRUE(off > 0.9999);
        himc_track_free(track);
        track = NULL;
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_joint_targets_bring_the_tips_to_their_targets_through_every_strike);
    RUN_TEST(test_after_separation_the_joints_follow_the_measured_stick);
    RUN_TEST(test_between_strikes_the_joints_are_the_captured_ones);
    RUN_TEST(test_unbent_joints_follow_the_captured_rebound);
    RUN_TEST(test_joint_targets_are_smooth_except_at_the_contact);
    RUN_TEST(test_joints_approach_from_their_present_state_and_come_to_rest_after_a_stop);
    RUN_TEST(test_postures_allocate_nothing);
    RUN_TEST(test_joints_that_the_take_does_not_have_stay_as_they_are);
    RUN_TEST(test_an_arm_without_a_stick_is_bent_from_its_present_state);
    return UNITY_END();
}
