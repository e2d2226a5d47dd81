/// test_track_fit.c: the error of a rate beside a strike, and the angular velocity of fitted
/// joints.
#include "take_players.h"

#include "track/track.h"
#include "track/track_fit.h"

#include "unity.h"

#define TRUNK (HIMC_TRUNK - 1)

void setUp(void)
{
}

void tearDown(void)
{
}

// standard deviation of the rate at the end of a parabola through n points, 1 s apart, with noise
// of 1 m: a fit is linear, so unit impulses give the part of each point
static double rate_error(int n)
{
    himc_vec3 x[256];
    double square = 0;
    for (int i = 0; i < n; i++) {
        memset(x, 0, sizeof x);
        x[i].z = 1;
        himc_target s = himc_fit(x, (fit_window){0, n - 1, n - 1, 3, 0}, 1);
        square += s.v.z * s.v.z;
    }
    return sqrt(square);
}

// 192 / n^3 is the limit of the sum above
static void test_fits_beside_a_strike_have_the_frames_for_an_error_of_rate_of_0_03(void)
{
    static const struct {
        double noise, rate;
        int frames; // cbrt(192 (noise rate / 0.03)^2)
    } known[] = {{2e-4, 1000, 20}, {1e-4, 2000, 20}, {5e-4, 1000, 37}, {2e-4, 2000, 32}};
    for (int i = 0; i < 4; i++) {
        double noise = known[i].noise * known[i].rate;
        int n = himc_fit_edge(known[i].noise, known[i].rate);
        TEST_ASSERT_EQUAL_INT(known[i].frames, n);
        TEST_ASSERT_DOUBLE_WITHIN(0.03 * 0.1, 0.03, noise * rate_error(n));
    }
    TEST_ASSERT_EQUAL_INT(6, himc_fit_edge(0, 250));
    TEST_ASSERT_EQUAL_INT(12, himc_fit_edge(0.1, 250)); // 48 ms and no more
}

// the cubic fit about frame k of the rotation vectors from frame k's rotation
static himc_target fitted(const himc_player *player, int k, int rate)
{
    static himc_vec3 turn[1000];
    fit_series series = {player->frames, 6, rate};
    himc_quat back = himc_quat_conj(player->pose[k].joint[TRUNK]);
    for (int i = 0; i < player->frames; i++)
        turn[i] = himc_quat_log(himc_quat_mul(player->pose[i].joint[TRUNK], back));
    return himc_fit(turn, himc_fit_window(k, 0, player->frames - 1, &series), 1.0 / rate);
}

// of a moving rotation vector, by differences
static himc_vec3 angular_velocity(const himc_target *s)
{
    double h = 1e-6;
    himc_quat after = himc_quat_exp(himc_vec3_madd(s->x, h, s->v));
    himc_quat before = himc_quat_exp(himc_vec3_madd(s->x, -h, s->v));
    return himc_vec3_scale(himc_quat_log(himc_quat_mul(after, himc_quat_conj(before))), 0.5 / h);
}

// a fit does not pass through its own frame, so the rotation vector r is not 0 there, and the
// angular velocity is not its rate v but v + r x v / 2 and terms of r^2
static void test_the_rate_of_a_noisy_joint_is_the_angular_velocity_of_its_fit(void)
{
    enum { RATE = 250 };
    himc_error error = {""};
    himc_skeleton skeleton;
    himc_skeleton_config config = himc_skeleton_default();
    himc_head_frame drum = usual_drum;
    double most = 0;
    TEST_ASSERT_TRUE(himc_skeleton_init(&skeleton, &config, &error));
    himc_take *take = beaten_take(&skeleton, RATE, 2, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    himc_player *player = himc_player_new(take, NULL, &config, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(player, error.text);
    TEST_ASSERT_TRUE(himc_player_sit(player, take, NULL, &drum, NULL));
    srand(3);
    for (int i = 0; i < player->frames; i++) {
        himc_quat *q = &player->pose[i].joint[TRUNK];
        himc_vec3 shake = {0.1 * rand() / RAND_MAX, 0.1 * rand() / RAND_MAX,
                           0.1 * rand() / RAND_MAX};
        *q = himc_quat_mul(himc_quat_exp(shake), *q);
    }
    himc_track *track =
        himc_track_new(take, NULL, &drum, player, player->config.mallet_radius, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(track, error.text);
    for (int k = 50; k < 400; k++) {
        himc_posture_motion m;
        himc_target s = fitted(player, k, RATE);
        double r = himc_vec3_length(s.x), v = himc_vec3_length(s.v);
        himc_track_posture(track, &skeleton, (double)k / RATE, NULL, &m);
        himc_vec3 off = himc_vec3_sub(angular_velocity(&s), m.rate[TRUNK]);
        most = fmax(most, himc_vec3_length(himc_vec3_cross(s.x, s.v)) / 2);
        TEST_ASSERT_DOUBLE_WITHIN(r * r * v / 6 + 1e-6, 0, himc_vec3_length(off));
    }
    TEST_ASSERT_TRUE(most > 0.05); // (rad/s)
    himc_track_free(track);
    himc_player_free(player);
    himc_take_free(take);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_fits_beside_a_strike_have_the_frames_for_an_error_of_rate_of_0_03);
    RUN_TEST(test_the_rate_of_a_noisy_joint_is_the_angular_velocity_of_its_fit);
    return UNITY_END();
}
