/// test_mocap.c: the motions of the database: strokes meet the head, joints move at human speeds,
/// files read back.
#include "mocap_sequences.h"

#include "mocap/parts.h"
#include "capture/take.h"
#include "track/track.h"

#include <string.h>
#include <unistd.h>

#define SAME_POINT 1e-4    // (m)
#define SAME_ROTATION 2e-5 // (rad)
#define MOST_SINK 0.020    // of the mallet into felt and head (m)

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_all_45_sequences_have_both_hands_in_turn(void)
{
    TEST_ASSERT_EQUAL_INT(45, MOCAP_SEQUENCES);
    for (int i = 0; i < MOCAP_SEQUENCES; i++) {
        himc_mocap *m = sequence(i);
        TEST_ASSERT_TRUE(himc_mocap_touches(m) >= 12);
        for (int k = 1; k < himc_mocap_touches(m); k++) {
            himc_mocap_touch a = himc_mocap_touch_at(m, k - 1), b = himc_mocap_touch_at(m, k);
            TEST_ASSERT_TRUE(b.hand != a.hand);
            TEST_ASSERT_TRUE(b.time - a.time > 0.2 && b.time - a.time < 0.5);
        }
        TEST_ASSERT_TRUE(himc_mocap_length(m) <
                         himc_mocap_touch_at(m, himc_mocap_touches(m) - 1).time + 1);
        himc_mocap_free(m);
    }
}

static void test_the_stick_is_level_and_the_mallet_on_the_head_at_each_impact(void)
{
    double away = 0, tilt = 0;
    for (int i = 0; i < MOCAP_SEQUENCES; i++) {
        himc_mocap *m = sequence(i);
        for (int k = 0; k < himc_mocap_touches(m); k++) {
            himc_mocap_touch touch = himc_mocap_touch_at(m, k);
            himc_body_state s = sequence_state(m, touch.time);
            himc_vec3 tip = s.tip[touch.hand], grip = s.origin[himc_stick_segment(touch.hand)];
            double plane = HIMC_MOCAP_HEAD + himc_mocap_skeleton(m)->mallet_radius;
            away = fmax(away, fabs(tip.z - plane));
            away = fmax(away, hypot(tip.x - touch.x.x, tip.y - touch.x.y));
            tilt = fmax(tilt, fabs(tip.z - grip.z) / himc_vec3_length(himc_vec3_sub(tip, grip)));
        }
        himc_mocap_free(m);
    }
    printf("tips within %.2f mm of the aim, sticks within %.1f degrees of level\n", 1e3 * away,
           asin(tilt) * 180 / HIMC_PI);
    TEST_ASSERT_TRUE(away < 0.004);
    TEST_ASSERT_TRUE(asin(tilt) < 5 * HIMC_PI / 180);
}

static void test_strike_places_are_those_of_the_captures(void)
{
    static const double in_front[] = {0.53, 0.40, 0.30};
    for (int i = 0; i < MOCAP_SEQUENCES; i++) {
        himc_mocap_config c = sequence_config(i);
        himc_mocap *m = sequence(i);
        double edge = himc_mocap_drum(m).x - in_front[HIMC_SPOT_CENTER], x = 0, y[2] = {0, 0};
        int count = himc_mocap_touches(m);
        for (int k = 0; k < count; k++) {
            himc_mocap_touch touch = himc_mocap_touch_at(m, k);
            x += touch.x.x / count;
            y[touch.hand] += 2 * touch.x.y / count;
            TEST_ASSERT_TRUE(hypot(touch.x.x - himc_mocap_drum(m).x, touch.x.y) <
                             HIMC_MOCAP_RADIUS);
        }
        TEST_ASSERT_DOUBLE_WITHIN(0.01, in_front[c.spot], x - edge);
        TEST_ASSERT_TRUE(y[HIMC_LEFT] > 0.02 && y[HIMC_RIGHT] < -0.02);
        himc_mocap_free(m);
    }
}

// also between the frames
static void test_no_stick_goes_through_the_head(void)
{
    double deepest = 0;
    for (int i = 0; i < MOCAP_SEQUENCES; i++) {
        himc_mocap *m = sequence(i);
        double plane = HIMC_MOCAP_HEAD + himc_mocap_skeleton(m)->mallet_radius;
        for (double t = 0; t < himc_mocap_length(m); t += 0.001) {
            himc_body_state s = sequence_state(m, t);
            for (int hand = 0; hand < HIMC_HANDS; hand++) {
                deepest = fmax(deepest, plane - s.tip[hand].z);
                TEST_ASSERT_TRUE(s.origin[HIMC_LEFT_STICK + hand].z > HIMC_MOCAP_HEAD);
            }
        }
        himc_mocap_free(m);
    }
    printf("mallets at most %.2f mm below their touch\n", 1e3 * deepest);
    TEST_ASSERT_TRUE(deepest < MOST_SINK);
}

// the stick falls until it touches and rises by more than 0.5 m/s 8 ms later
static void test_a_mallet_reverses_within_its_contact(void)
{
    for (int i = 0; i < MOCAP_SEQUENCES; i++) {
        himc_mocap *m = sequence(i);
        for (int k = 0; k < himc_mocap_touches(m); k++) {
            himc_mocap_touch touch = himc_mocap_touch_at(m, k);
            double z[4];
            for (int n = 0; n < 4; n++) {
                double t = touch.time + (n < 2 ? -0.001 : 0.008) + 0.001 * (n % 2);
                z[n] = sequence_state(m, t).tip[touch.hand].z;
            }
            TEST_ASSERT_TRUE(z[1] - z[0] < -0.001 && z[3] - z[2] > 0.0005);
        }
        himc_mocap_free(m);
    }
}

// largest angular speeds over all sequences (rad/s)
static void test_joints_move_at_human_speeds(void)
{
    static const double most[HIMC_ARM_JOINTS] = {8, 15, 15, 45};
    double fastest[HIMC_ARM_JOINTS] = {0}, trunk = 0;
    for (int i = 0; i < MOCAP_SEQUENCES; i++) {
        himc_mocap *m = sequence(i);
        himc_pose last = himc_mocap_pose(m, 0);
        for (int f = 1; f < himc_mocap_frames(m); f++) {
            himc_pose now = himc_mocap_pose(m, f / HIMC_MOCAP_RATE);
            for (int j = 0; j < HIMC_JOINTS; j++) {
                himc_quat turn = himc_quat_mul(himc_quat_conj(last.joint[j]), now.joint[j]);
                double speed = himc_vec3_length(himc_quat_log(turn)) * HIMC_MOCAP_RATE;
                int k = (j - himc_arm_joint(HIMC_LEFT, 0)) / 2;
                bool arm = j >= himc_arm_joint(HIMC_LEFT, 0) && k < HIMC_ARM_JOINTS;
                double *best = arm ? &fastest[k] : &trunk;
                *best = fmax(*best, speed);
            }
            last = now;
        }
        himc_mocap_free(m);
    }
    printf("fastest: shoulder %.1f, elbow %.1f, wrist %.1f, grip %.1f, the rest %.2f rad/s\n",
           fastest[0], fastest[1], fastest[2], fastest[3], trunk);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        TEST_ASSERT_TRUE(fastest[k] < most[k] && fastest[k] > 1);
    TEST_ASSERT_TRUE(trunk < 1);
}

// a stroke with a lift that would end 5 ms after the next fall begins
static void test_strokes_that_overlap_follow_each_other_without_a_jump(void)
{
    mocap_curve curve;
    TEST_ASSERT_TRUE(himc_mocap_curve_init(&curve, 8));
    mocap_share stroke = {0.3, 15, 8, {0.008, 0.014}, 0.2, 0.15, 1};
    himc_mocap_curve_stroke(&curve, &stroke);
    stroke.touch += 0.15 - 0.005 + 0.2;
    himc_mocap_curve_stroke(&curve, &stroke);
    for (int i = 1; i < curve.count; i++)
        TEST_ASSERT_TRUE(curve.knot[i - 1].t <= curve.knot[i].t);
    double last = himc_mocap_curve_at(&curve, 0), largest = 0;
    for (double t = 0; t < 1; t += 1e-5) {
        double now = himc_mocap_curve_at(&curve, t);
        largest = fmax(largest, fabs(now - last));
        last = now;
    }
    himc_mocap_curve_free(&curve);
    TEST_ASSERT_DOUBLE_WITHIN(4e-5, 1.5e-4, largest); // the rate of arrival
}

static void test_equal_seeds_give_equal_motions_and_others_differ(void)
{
    himc_mocap_config c = sequence_config(7);
    himc_mocap *a = sequence_made(&c), *b = sequence_made(&c);
    c.seed = 2;
    himc_mocap *other = sequence_made(&c);
    double differs = 0;
    for (int f = 0; f < himc_mocap_frames(a); f++) {
        himc_pose x = himc_mocap_pose(a, f / HIMC_MOCAP_RATE),
                  y = himc_mocap_pose(b, f / HIMC_MOCAP_RATE),
                  z = himc_mocap_pose(other, f / HIMC_MOCAP_RATE);
        TEST_ASSERT_EQUAL_MEMORY(&x, &y, sizeof x);
        differs = fmax(differs,
                       fabs(x.joint[HIMC_LEFT_FOREARM - 1].w - z.joint[HIMC_LEFT_FOREARM - 1].w));
    }
    TEST_ASSERT_TRUE(differs > 0.01);
    himc_mocap_free(a);
    himc_mocap_free(b);
    himc_mocap_free(other);
}

static void test_impossible_configs_are_refused_in_a_line(void)
{
    himc_mocap_config c = himc_mocap_default();
    c.player = 3;
    TEST_ASSERT_NULL(himc_mocap_new(&c, &error));
    TEST_ASSERT_EQUAL_STRING("player: 3, expected 0 .. 2", error.text);
    c = himc_mocap_default();
    c.spot = HIMC_SPOT_XY;
    TEST_ASSERT_NULL(himc_mocap_new(&c, &error));
    c = himc_mocap_default();
    c.strokes = 1;
    TEST_ASSERT_NULL(himc_mocap_new(&c, &error));
    TEST_ASSERT_EQUAL_STRING("strokes: 1, expected 2 .. 200", error.text);
}

static himc_take *write_and_read(const himc_mocap *m, const char *suffix)
{
    char path[64];
    snprintf(path, sizeof path, "/tmp/himc-mocap-%d.%s", (int)getpid(), suffix);
    TEST_ASSERT_TRUE_MESSAGE(himc_mocap_write(m, path, &error), error.text);
    himc_take *take = himc_take_load(path, NULL, &error);
    unlink(path);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    TEST_ASSERT_EQUAL_INT(himc_mocap_frames(m), himc_take_frames(take));
    TEST_ASSERT_EQUAL_DOUBLE(HIMC_MOCAP_RATE, himc_take_rate(take));
    return take;
}

// distances of found strikes from the true ones
typedef struct misses {
    double time, floor, height;
} misses;

// the strikes found in a take are the true ones: number, hands, times and places
static void expect_strikes(const himc_mocap *m, himc_take *take, misses *worst)
{
    himc_take_tip tips[HIMC_HANDS];
    int count;
    TEST_ASSERT_TRUE_MESSAGE(himc_take_tips(take, NULL, tips, &error), error.text);
    himc_take_strike *strikes = himc_take_find_strikes(take, tips, &count);
    TEST_ASSERT_EQUAL_INT(himc_mocap_touches(m), count);
    for (int i = 0; i < count; i++) {
        himc_mocap_touch touch = himc_mocap_touch_at(m, i);
        himc_vec3 away = himc_vec3_sub(touch.x, strikes[i].x);
        TEST_ASSERT_EQUAL_INT(touch.hand, strikes[i].hand);
        worst->time = fmax(worst->time, fabs(touch.time - strikes[i].time));
        worst->floor = fmax(worst->floor, hypot(away.x, away.y));
        worst->height = fmax(worst->height, fabs(away.z));
    }
    free(strikes);
}

static void expect_found(const misses *worst)
{
    printf("strikes found within %.1f ms, %.1f mm on the head and %.1f mm in height\n",
           1e3 * worst->time, 1e3 * worst->floor, 1e3 * worst->height);
    // fall and rebound intersect half a contact later than the touch, and deeper
    TEST_ASSERT_TRUE(worst->time < 0.006);
    TEST_ASSERT_TRUE(worst->floor < 0.005);
    TEST_ASSERT_TRUE(worst->height < 0.035);
}

static void test_each_stroke_is_found_in_each_of_the_45_files(void)
{
    misses worst = {0};
    for (int i = 0; i < MOCAP_SEQUENCES; i++) {
        himc_mocap *m = sequence(i);
        himc_take *take = write_and_read(m, "c3d");
        expect_strikes(m, take, &worst);
        himc_take_free(take);
        himc_mocap_free(m);
    }
    expect_found(&worst);
}

// mean speed at which the take's motion meets the head, over the mean captured one
static double share_of_the_speed(himc_take *take, const himc_head_frame *head)
{
    double played = 0, captured = 0;
    himc_take_options options = himc_take_default();
    himc_track *track = himc_track_new(take, &options, head, NULL, 0.02, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(track, error.text);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        double before = 0, t, x, y;
        for (double now = 0; now < himc_track_length(track); now += 0.002)
            if (himc_track_current(track, hand, now, &t, &x, &y) && t > before) {
                before = t;
                played -= himc_track_target(track, hand, t - 1e-6).v.z;
                captured += himc_track_source.stroke(track, hand, now).speed;
            }
    }
    himc_track_free(track);
    return played / captured;
}

static void test_each_of_the_45_files_is_played_at_the_speed_captured(void)
{
    himc_head_frame head = {.center = {0.5, 0, 0.85}, .radius = 0.3};
    double least = 2, most = 0, sum = 0;
    for (int i = 0; i < MOCAP_SEQUENCES; i++) {
        himc_mocap *m = sequence(i);
        himc_take *take = write_and_read(m, "c3d");
        double share = share_of_the_speed(take, &head);
        least = fmin(least, share);
        most = fmax(most, share);
        sum += share;
        himc_take_free(take);
        himc_mocap_free(m);
    }
    printf("speed %.3f of the captured, %.3f .. %.3f\n", sum / MOCAP_SEQUENCES, least, most);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 1, sum / MOCAP_SEQUENCES);
    TEST_ASSERT_DOUBLE_WITHIN(0.12, 1, least);
    TEST_ASSERT_DOUBLE_WITHIN(0.12, 1, most);
}

static int found(const himc_take *take, const char *name)
{
    int point = himc_take_find(take, name);
    TEST_ASSERT_TRUE_MESSAGE(point >= 0, name);
    return point;
}

static void test_a_bvh_reads_back_rotation_by_rotation(void)
{
    static const char *const name[] = {"Spine", "LeftArm", "RightForeArm", "LeftHand",
                                       "RightStick"};
    static const int segment[] = {HIMC_TRUNK, HIMC_LEFT_UPPER_ARM, HIMC_RIGHT_FOREARM,
                                  HIMC_LEFT_HAND, HIMC_RIGHT_STICK};
    double point = 0, angle = 0;
    misses worst = {0};
    for (int i = 4; i < MOCAP_SEQUENCES; i += 19) {
        himc_mocap *m = sequence(i);
        himc_take *take = write_and_read(m, "bvh");
        expect_strikes(m, take, &worst);
        for (int f = 0; f < himc_take_frames(take); f += 5)
            for (int k = 0; k < 5; k++) {
                himc_body_state s = sequence_state(m, f / HIMC_MOCAP_RATE);
                himc_pose pose = himc_mocap_pose(m, f / HIMC_MOCAP_RATE);
                int p = found(take, name[k]);
                himc_quat q = himc_take_rotation(take, f, p);
                himc_quat turn = himc_quat_mul(himc_quat_conj(q), pose.joint[segment[k] - 1]);
                angle = fmax(angle, himc_vec3_length(himc_quat_log(turn)));
                himc_vec3 away = himc_vec3_sub(himc_take_point(take, f, p), s.origin[segment[k]]);
                point = fmax(point, himc_vec3_length(away));
            }
        himc_take_free(take);
        himc_mocap_free(m);
    }
    printf("BVH: points within %.1g m, rotations within %.1g rad\n", point, angle);
    expect_found(&worst);
    TEST_ASSERT_TRUE(point < SAME_POINT && angle < SAME_ROTATION);
}

#define CHECKED 3

// the true points of frame f
static void checked_points(const himc_mocap *m, int f, himc_vec3 x[CHECKED])
{
    himc_body_state s = sequence_state(m, f / HIMC_MOCAP_RATE);
    himc_vec3 beside = himc_mat3_apply(&s.rotation[HIMC_RIGHT_HAND], (himc_vec3){0, 0.05, 0});
    x[0] = s.tip[HIMC_LEFT];
    x[1] = s.origin[HIMC_LEFT_FOREARM];
    x[2] = himc_vec3_add(s.origin[HIMC_RIGHT_HAND], beside);
}

// the reader rotates every take so that the mean body faces along x, this one hardly
static double heading_given(const himc_mocap *m, const himc_take *take, const int point[CHECKED])
{
    himc_vec3 x[CHECKED];
    double sine = 0, cosine = 0;
    for (int f = 0; f < himc_take_frames(take); f++) {
        checked_points(m, f, x);
        for (int k = 0; k < CHECKED; k++) {
            himc_vec3 y = himc_take_point(take, f, point[k]);
            sine += x[k].x * y.y - x[k].y * y.x;
            cosine += x[k].x * y.x + x[k].y * y.y;
        }
    }
    return atan2(sine, cosine);
}

static void test_a_c3d_reads_back_marker_by_marker(void)
{
    himc_mocap *m = sequence(22);
    himc_take *take = write_and_read(m, "c3d");
    const int point[CHECKED] = {found(take, "LeftStick_end"), found(take, "LeftForeArm"),
                                found(take, "RightHand_side")};
    double worst = 0, turn = heading_given(m, take, point);
    himc_quat heading = himc_quat_exp(himc_vec3_make(0, 0, turn));
    for (int f = 0; f < himc_take_frames(take); f += 3) {
        himc_vec3 x[CHECKED];
        checked_points(m, f, x);
        for (int k = 0; k < CHECKED; k++) {
            himc_vec3 y = himc_quat_rotate(heading, x[k]);
            y = himc_vec3_sub(himc_take_point(take, f, point[k]), y);
            worst = fmax(worst, himc_vec3_length(y));
        }
    }
    printf("C3D: markers within %.1g m after a turn of %.1g rad\n", worst, turn);
    TEST_ASSERT_TRUE(worst < 1e-6);
    TEST_ASSERT_TRUE(fabs(turn) < 1e-3);
    himc_take_free(take);
    himc_mocap_free(m);
}

static void test_mocap_pace_scales_time_and_nothing_else(void)
{
    himc_mocap_config c = sequence_config(7);
    himc_mocap *usual = sequence_made(&c);
    c.pace = 2;
    himc_mocap *fast = sequence_made(&c);
    TEST_ASSERT_EQUAL_DOUBLE(himc_mocap_length(usual) / 2, himc_mocap_length(fast));
    for (int i = 0; i < himc_mocap_touches(usual); i++) {
        himc_mocap_touch a = himc_mocap_touch_at(usual, i), b = himc_mocap_touch_at(fast, i);
        TEST_ASSERT_EQUAL_DOUBLE(a.time / 2, b.time);
        TEST_ASSERT_EQUAL_MEMORY(&a.x, &b.x, sizeof a.x);
    }
    for (double t = 0; t < himc_mocap_length(fast); t += 0.01) {
        himc_pose a = himc_mocap_pose(usual, 2 * t), b = himc_mocap_pose(fast, t);
        TEST_ASSERT_EQUAL_MEMORY(&a, &b, sizeof a);
    }
    himc_mocap_free(fast);
    himc_mocap_free(usual);
}

static void test_mocap_pace_out_of_range_is_refused(void)
{
    himc_mocap_config c = himc_mocap_default();
    c.pace = 5;
    TEST_ASSERT_NULL(himc_mocap_new(&c, &error));
    TEST_ASSERT_NOT_NULL(strstr(error.text, "pace"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_all_45_sequences_have_both_hands_in_turn);
    RUN_TEST(test_the_stick_is_level_and_the_mallet_on_the_head_at_each_impact);
    RUN_TEST(test_strike_places_are_those_of_the_captures);
    RUN_TEST(test_no_stick_goes_through_the_head);
    RUN_TEST(test_a_mallet_reverses_within_its_contact);
    RUN_TEST(test_joints_move_at_human_speeds);
    RUN_TEST(test_strokes_that_overlap_follow_each_other_without_a_jump);
    RUN_TEST(test_equal_seeds_give_equal_motions_and_others_differ);
    RUN_TEST(test_impossible_configs_are_refused_in_a_line);
    RUN_TEST(test_each_stroke_is_found_in_each_of_the_45_files);
    RUN_TEST(test_each_of_the_45_files_is_played_at_the_speed_captured);
    RUN_TEST(test_a_bvh_reads_back_rotation_by_rotation);
    RUN_TEST(test_a_c3d_reads_back_marker_by_marker);
    RUN_TEST(test_mocap_pace_scales_time_and_nothing_else);
    RUN_TEST(test_mocap_pace_out_of_range_is_refused);
    return UNITY_END();
}
