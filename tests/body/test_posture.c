/// test_posture.c: the natural posture puts both tips on their targets; it is smooth and symmetric.
#include "body/posture.h"

#include "unity.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LEVEL 0.8675

static himc_skeleton skeleton;
static himc_posture posture;

void setUp(void)
{
    himc_skeleton_config config = himc_skeleton_default();
    himc_skeleton_init(&skeleton, &config, NULL);
    himc_posture_init(&posture, &skeleton, LEVEL);
    srand(5);
}

void tearDown(void)
{
}

static double uniform(double low, double high)
{
    return low + (high - low) * rand() / RAND_MAX;
}

static double distance(himc_vec3 a, himc_vec3 b)
{
    return himc_vec3_length(himc_vec3_sub(a, b));
}

static double place_tips(const himc_vec3 tip[HIMC_HANDS], himc_body_state *s)
{
    himc_pose pose;
    double missing = himc_posture_at(&posture, tip, &pose);
    himc_pose_to_state(&skeleton, &pose, NULL, s);
    return missing;
}

// a random tip position of a timpanist: over drumheads in front, up to 0.6 m above them, a little
// across the middle
static himc_vec3 playing_place(himc_hand hand)
{
    double x = uniform(0.35, 0.75), y = uniform(-0.15, 0.35),
           z = uniform(LEVEL - 0.03, LEVEL + 0.6);
    return himc_vec3_make(x, hand == HIMC_LEFT ? y : -y, z);
}

static void test_tips_are_on_their_targets_over_the_whole_playing_space(void)
{
    himc_body_state s;
    int reached = 0;
    for (int n = 0; n < 20000; n++) {
        himc_vec3 tip[HIMC_HANDS] = {playing_place(HIMC_LEFT), playing_place(HIMC_RIGHT)};
        if (place_tips(tip, &s) > 0)
            continue;
        reached++;
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, distance(tip[hand], s.tip[hand]));
    }
    TEST_ASSERT_TRUE(reached > 18000);
}

static void test_bodies_of_every_height_reach_the_tips(void)
{
    for (double height = 1.2; height <= 2.2; height += 0.05) {
        himc_skeleton_config config = himc_skeleton_default();
        himc_body_state s;
        config.height = height;
        himc_skeleton_init(&skeleton, &config, NULL);
        double level = 0.5 * height;
        himc_posture_init(&posture, &skeleton, level);
        himc_vec3 tip[HIMC_HANDS] = {{0.27 * height, 0.03 * height, level + 0.1},
                                     {0.27 * height, -0.03 * height, level}};
        TEST_ASSERT_EQUAL_DOUBLE(0, place_tips(tip, &s));
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, distance(tip[hand], s.tip[hand]));
    }
}

static void test_arms_have_their_lengths_and_elbows_hang_below_and_outside(void)
{
    himc_body_state s;
    for (int n = 0; n < 1000; n++) {
        himc_vec3 tip[HIMC_HANDS] = {playing_place(HIMC_LEFT), playing_place(HIMC_RIGHT)};
        for (int hand = 0; hand < HIMC_HANDS; hand++) { // below the shoulder there is no outside
            tip[hand].x = fmax(tip[hand].x, 0.45);
            tip[hand].y = fmin(fmax(tip[hand].y, -0.15), 0.15);
        }
        place_tips(tip, &s);
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            himc_vec3 shoulder = s.origin[HIMC_LEFT_UPPER_ARM + hand];
            himc_vec3 elbow = s.origin[HIMC_LEFT_FOREARM + hand];
            himc_vec3 wrist = s.origin[HIMC_LEFT_HAND + hand];
            himc_vec3 u = himc_vec3_unit(himc_vec3_sub(wrist, shoulder));
            himc_vec3 off = himc_vec3_sub(elbow, shoulder);
            off = himc_vec3_madd(off, -himc_vec3_dot(off, u), u);
            TEST_ASSERT_DOUBLE_WITHIN(1e-13, skeleton.segment[HIMC_LEFT_UPPER_ARM].length,
                                      distance(shoulder, elbow));
            TEST_ASSERT_TRUE(off.z < 0);
            TEST_ASSERT_TRUE((hand == HIMC_LEFT ? off.y : -off.y) > 0);
        }
    }
}

// the grip is 12 mm higher, so that the shaft passes the hoop
static void test_stick_lies_nearly_level_at_impact_and_rises_with_the_tip(void)
{
    himc_body_state s;
    double last = -1;
    for (int i = 0; i <= 50; i++) {
        himc_vec3 tip[HIMC_HANDS] = {{0.5, 0.1, LEVEL + 0.01 * i}, {0.5, -0.1, LEVEL}};
        place_tips(tip, &s);
        double up = s.tip[HIMC_LEFT].z - s.origin[HIMC_LEFT_STICK].z;
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, -0.012, s.tip[HIMC_RIGHT].z - s.origin[HIMC_RIGHT_STICK].z);
        TEST_ASSERT_TRUE(up > last);
        last = up;
    }
}

static void test_joints_follow_the_tip_without_jumps(void)
{
    // along straight lines across the playing space: 1 mm turns no joint by more than 30 mrad
    for (int n = 0; n < 200; n++) {
        himc_vec3 a = playing_place(HIMC_LEFT), b = playing_place(HIMC_LEFT), d;
        himc_vec3 right = playing_place(HIMC_RIGHT);
        himc_pose last, pose;
        d = himc_vec3_sub(b, a);
        int steps = (int)(himc_vec3_length(d) / 1e-3) + 1;
        for (int i = 0; i <= steps; i++) {
            himc_vec3 tip[HIMC_HANDS] = {himc_vec3_madd(a, (double)i / steps, d), right};
            himc_posture_at(&posture, tip, &pose);
            for (int j = 0; i > 0 && j < HIMC_JOINTS; j++) {
                himc_quat moved = himc_quat_mul(himc_quat_conj(last.joint[j]), pose.joint[j]);
                TEST_ASSERT_TRUE(himc_vec3_length(himc_quat_log(moved)) < 0.03);
            }
            last = pose;
        }
    }
}

static himc_target random_motion(himc_hand hand)
{
    himc_target t = {.x = playing_place(hand)};
    t.x.z = fmin(t.x.z, LEVEL + 0.4);
    t.v = himc_vec3_make(uniform(-1, 1), uniform(-1, 1), uniform(-5, 5));
    t.a = himc_vec3_make(uniform(-20, 20), uniform(-20, 20), uniform(-100, 100));
    return t;
}

static himc_target later(const himc_target *t, double h)
{
    himc_target s = *t;
    s.x = himc_vec3_madd(himc_vec3_madd(t->x, h, t->v), 0.5 * h * h, t->a);
    s.v = himc_vec3_madd(t->v, h, t->a);
    return s;
}

// the wrist moves from the front to below its shoulder and a little behind it
static void test_an_elbow_stays_behind_while_its_wrist_goes_under_the_shoulder(void)
{
    double fastest = 0;
    for (double y = 0.05; y < 0.3; y += 0.01)
        for (double x = 0.6; x > 0.33; x -= 0.001) {
            himc_target tip[HIMC_HANDS] = {{{x, y, LEVEL + 0.05}, {-1, 0, 0}, {0, 0, 0}},
                                           {{x, -y, LEVEL + 0.05}, {-1, 0, 0}, {0, 0, 0}}};
            himc_posture_motion motion;
            himc_posture_moving(&posture, tip, &motion);
            for (int k = 0; k < 2; k++)
                fastest =
                    fmax(fastest, himc_vec3_length(motion.rate[himc_arm_joint(HIMC_LEFT, k)]));
        }
    printf("fastest joint at 1 m/s: %.1f rad/s\n", fastest);
    TEST_ASSERT_TRUE(fastest < 7); // 122 if the elbow always hung straight down
}

// rates are central differences over 1 ms with an error near 1e-6 of the third derivatives
// the fastest of all joints while the left tip moves by 1 m/s (rad/s)
static double fastest_joint(himc_vec3 x, himc_vec3 v)
{
    himc_target tip[HIMC_HANDS] = {{x, v, {0, 0, 0}}, {{0.55, -0.15, LEVEL}, {0, 0, 0}, {0, 0, 0}}};
    himc_posture_motion m;
    double most = 0;
    himc_posture_moving(&posture, tip, &m);
    for (int j = 0; j < HIMC_JOINTS; j++)
        most = fmax(most, himc_vec3_length(m.rate[j]));
    return most;
}

static void test_no_joint_whips_where_a_hand_passes_the_shoulder_or_turns_aside(void)
{
    double most = 0;
    for (int n = 0; n < 20000; n++) {
        double *value = posture.trunk_posture.value, turn = uniform(0, 2 * HIMC_PI);
        value[HIMC_TRUNK_POSTURE_ASIDE] = uniform(0, 0.6);
        value[HIMC_TRUNK_POSTURE_TURN] = uniform(-0.8, 0.8);
        himc_vec3 x = {uniform(0.3, 0.5), uniform(-0.2, 0.5), uniform(LEVEL, LEVEL + 0.15)};
        most = fmax(most, fastest_joint(x, himc_vec3_make(cos(turn), sin(turn), 0)));
    }
    printf("fastest joint %.1f rad/m\n", most);
    TEST_ASSERT_TRUE(most < 16); // 61 if the forearm always rolled with the hand
}

static void test_rates_move_the_tips_at_the_target_velocity(void)
{
    for (int n = 0; n < 500; n++) {
        himc_target tip[HIMC_HANDS] = {random_motion(HIMC_LEFT), random_motion(HIMC_RIGHT)};
        himc_vec3 x[HIMC_HANDS] = {tip[0].x, tip[1].x};
        himc_posture_motion m;
        himc_pose pose;
        himc_body_state s;
        if (himc_posture_at(&posture, x, &pose) > 0)
            continue;
        himc_posture_moving(&posture, tip, &m);
        TEST_ASSERT_EQUAL_MEMORY(pose.joint, m.joint, sizeof m.joint);
        himc_pose_to_state(&skeleton, &pose, m.rate, &s);
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            TEST_ASSERT_DOUBLE_WITHIN(0.02, 0, distance(tip[hand].v, s.tip_velocity[hand]));
    }
}

static void test_acceleration_is_the_difference_of_the_rate(void)
{
    double h = 1e-3;
    for (int n = 0; n < 200; n++) {
        himc_target tip[HIMC_HANDS] = {random_motion(HIMC_LEFT), random_motion(HIMC_RIGHT)};
        himc_target before[HIMC_HANDS], after[HIMC_HANDS];
        himc_vec3 x[HIMC_HANDS] = {tip[0].x, tip[1].x};
        himc_posture_motion m, m0, m1;
        himc_pose pose;
        if (himc_posture_at(&posture, x, &pose) > 0)
            continue;
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            before[hand] = later(&tip[hand], -h);
            after[hand] = later(&tip[hand], h);
        }
        himc_posture_moving(&posture, tip, &m);
        himc_posture_moving(&posture, before, &m0);
        himc_posture_moving(&posture, after, &m1);
        for (int j = 0; j < HIMC_JOINTS; j++) {
            himc_vec3 a = himc_vec3_scale(himc_vec3_sub(m1.rate[j], m0.rate[j]), 0.5 / h);
            double size = himc_vec3_length(m.acceleration[j]);
            TEST_ASSERT_DOUBLE_WITHIN(1 + 0.01 * size, 0, distance(a, m.acceleration[j]));
        }
    }
}

static void test_a_tip_out_of_reach_is_missed_by_the_returned_distance(void)
{
    himc_body_state s;
    for (int n = 0; n < 1000; n++) {
        himc_vec3 tip[HIMC_HANDS] = {playing_place(HIMC_LEFT), playing_place(HIMC_RIGHT)};
        himc_hand far = (himc_hand)(n % 2), near = (himc_hand)(1 - n % 2);
        tip[near] = himc_vec3_make(0.5, near == HIMC_LEFT ? 0.1 : -0.1, LEVEL + 0.1);
        tip[far].x += 1.5;
        double missing = place_tips(tip, &s);
        TEST_ASSERT_TRUE(missing > 0.3);
        TEST_ASSERT_TRUE(himc_body_state_finite(&s));
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, missing, distance(tip[far], s.tip[far]));
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, distance(tip[near], s.tip[near]));
    }
}

// the remaining distance of a hand to a point that the trunk is turned to (m)
static double turned_to(himc_vec3 tip, himc_hand hand)
{
    himc_posture before = posture;
    himc_vec3 both[HIMC_HANDS] = {tip, tip};
    himc_body_state s;
    posture.trunk_posture = himc_posture_trunk(&posture, both, HIMC_GRIP_GERMAN);
    place_tips(both, &s);
    posture = before;
    return distance(s.tip[hand], tip);
}

static void test_reachable_points_are_reached_and_points_in_reach_are_kept(void)
{
    for (int n = 0; n < 2000; n++) {
        himc_hand hand = (himc_hand)(n % 2);
        himc_vec3 tip = playing_place(hand);
        tip.x += n % 4 < 2 ? 0 : uniform(0, 2);
        tip.z += n % 3 ? 0 : uniform(-0.8, 1);
        himc_vec3 near = himc_posture_reachable(&posture, hand, tip);
        if (turned_to(tip, hand) < 1e-12)
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, distance(tip, near));
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0, turned_to(near, hand));
        TEST_ASSERT_TRUE(near.z >= fmin(tip.z, posture.level)); // above the drums it stays there
    }
}

static void test_reachable_points_are_reached_by_bodies_of_every_height(void)
{
    for (double height = 1.2; height <= 2.2; height += 0.1)
        for (double level = 0.45; level <= 0.55; level += 0.05) {
            himc_skeleton_config config = himc_skeleton_default();
            config.height = height;
            himc_skeleton_init(&skeleton, &config, NULL);
            himc_posture_init(&posture, &skeleton, level * height);
            himc_vec3 far[HIMC_HANDS] = {{2, 1, 0.5}, {2, -1, 2}}, near[HIMC_HANDS];
            for (int hand = 0; hand < HIMC_HANDS; hand++)
                near[hand] = himc_posture_reachable(&posture, (himc_hand)hand, far[hand]);
            for (int hand = 0; hand < HIMC_HANDS; hand++)
                TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0, turned_to(near[hand], (himc_hand)hand));
        }
}

static void test_postures_are_finite_for_every_tip(void)
{
    himc_body_state s, rest;
    himc_pose_to_state(&skeleton, &posture.rest, NULL, &rest);
    for (int n = 0; n < 20000; n++) {
        himc_vec3 tip[HIMC_HANDS];
        double far = n % 2 ? 3 : 1e6;
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            tip[hand] = himc_vec3_make(uniform(-far, far), uniform(-far, far), uniform(-far, far));
        if (n < 4)
            tip[n % 2] = n < 2 ? rest.origin[HIMC_LEFT_UPPER_ARM + n % 2] : himc_vec3_make(0, 0, 0);
        place_tips(tip, &s);
        TEST_ASSERT_TRUE(himc_body_state_finite(&s));
        for (int i = 0; i < HIMC_SEGMENTS; i++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1, himc_quat_dot(s.orientation[i], s.orientation[i]));
    }
}

static void test_left_and_right_mirror_each_other(void)
{
    himc_body_state s, mirrored;
    for (int n = 0; n < 500; n++) {
        himc_vec3 tip[HIMC_HANDS] = {playing_place(HIMC_LEFT), playing_place(HIMC_RIGHT)};
        himc_vec3 swap[HIMC_HANDS] = {tip[1], tip[0]};
        swap[0].y = -swap[0].y;
        swap[1].y = -swap[1].y;
        place_tips(tip, &s);
        place_tips(swap, &mirrored);
        for (int i = HIMC_LEFT_UPPER_ARM; i < HIMC_SEGMENTS; i++) {
            himc_vec3 x = s.origin[i], y = mirrored.origin[i ^ 1];
            y.y = -y.y;
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, distance(x, y));
        }
    }
}

// a palm down has its thumb on the inner side: -y of the left hand, y of the right
static void test_thumbs_point_inwards_in_german_and_up_in_french_grip(void)
{
    himc_body_state s;
    himc_vec3 level[HIMC_HANDS] = {{0.5, 0.05, posture.level}, {0.5, -0.05, posture.level}};
    for (int french = 0; french < 2; french++) {
        posture.trunk_posture.value[HIMC_TRUNK_POSTURE_FRENCH_GRIP] = french;
        place_tips(level, &s);
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            double up = (hand == HIMC_LEFT ? -1 : 1) * s.rotation[HIMC_LEFT_HAND + hand].m[2][1];
            // rolled by 1.25, the fingers 0.12 down
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, french ? sin(1.25) * cos(0.12) : 0, up);
        }
    }
}

static void test_feet_of_a_seated_body_stand_on_the_floor(void)
{
    himc_body_state s;
    himc_pose_to_state(&skeleton, &posture.rest, NULL, &s);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.075, s.origin[HIMC_LEFT_FOOT + hand].z);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1, s.rotation[HIMC_LEFT_LOWER_LEG + hand].m[2][2]);
    }
}

// the longest step that is allowed, and a usual one: the same motion, which ends at its goal and
// never goes past it
static void test_a_trunk_posture_approaches_its_goal_in_steps_of_any_length(void)
{
    himc_trunk_posture usual = {{0}, {0}, {0}}, goal = usual;
    for (int i = 0; i < HIMC_TRUNK_POSTURE_PARTS; i++)
        goal.value[i] = 0.1 * (i + 1);
    himc_trunk_posture longest = usual;
    for (int k = 0; k < 100; k++) {
        longest = himc_trunk_posture_approach(&longest, &goal, 0.02);
        for (int j = 0; j < 5; j++)
            usual = himc_trunk_posture_approach(&usual, &goal, 0.004);
        for (int i = 0; i < HIMC_TRUNK_POSTURE_PARTS; i++) {
            TEST_ASSERT_DOUBLE_WITHIN(0.01 * goal.value[i], usual.value[i], longest.value[i]);
            TEST_ASSERT_TRUE(longest.value[i] >= 0 && longest.value[i] <= 1.0001 * goal.value[i]);
        }
    }
    for (int i = 0; i < HIMC_TRUNK_POSTURE_PARTS; i++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, goal.value[i], longest.value[i]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_tips_are_on_their_targets_over_the_whole_playing_space);
    RUN_TEST(test_bodies_of_every_height_reach_the_tips);
    RUN_TEST(test_arms_have_their_lengths_and_elbows_hang_below_and_outside);
    RUN_TEST(test_stick_lies_nearly_level_at_impact_and_rises_with_the_tip);
    RUN_TEST(test_joints_follow_the_tip_without_jumps);
    RUN_TEST(test_an_elbow_stays_behind_while_its_wrist_goes_under_the_shoulder);
    RUN_TEST(test_no_joint_whips_where_a_hand_passes_the_shoulder_or_turns_aside);
    RUN_TEST(test_rates_move_the_tips_at_the_target_velocity);
    RUN_TEST(test_acceleration_is_the_difference_of_the_rate);
    RUN_TEST(test_a_tip_out_of_reach_is_missed_by_the_returned_distance);
    RUN_TEST(test_reachable_points_are_reached_and_points_in_reach_are_kept);
    RUN_TEST(test_reachable_points_are_reached_by_bodies_of_every_height);
    RUN_TEST(test_postures_are_finite_for_every_tip);
    RUN_TEST(test_left_and_right_mirror_each_other);
    RUN_TEST(test_thumbs_point_inwards_in_german_and_up_in_french_grip);
    RUN_TEST(test_feet_of_a_seated_body_stand_on_the_floor);
    RUN_TEST(test_a_trunk_posture_approaches_its_goal_in_steps_of_any_length);
    return UNITY_END();
}
