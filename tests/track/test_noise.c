/// test_noise.c: noise of a tracker: it is measured, causes no false strikes, and has little effect
/// on the target accelerations.
#include "take_files.h"

#include "plan/planner.h"
#include "track/track.h"
#include "base/noise.h"

#include "take_motions.h"

#define RADIUS 0.0175
#define FRAMES 1500

static const himc_head_frame place = {.center = {0.5, 0, 0.85}, .radius = 0.3};

void setUp(void)
{
    random_state = 7;
    noise = 0;
}

void tearDown(void)
{
}

static himc_vec3 shaken(himc_vec3 x, double size)
{
    return himc_vec3_add(
        x, himc_vec3_make(size * random_normal(), size * random_normal(), size * random_normal()));
}

static himc_vec3 wave(double t)
{
    double p = 2 * HIMC_PI * 1.5 * t;
    return himc_vec3_make(0.5 + 0.03 * sin(p), 0.08, 1.05 + 0.12 * sin(p));
}

static double noise_of(const himc_vec3 *x, int frames)
{
    double size;
    TEST_ASSERT_TRUE(himc_noise(x, frames, &size));
    return size;
}

static void test_noise_is_measured_through_motion_of_any_size_at_any_rate(void)
{
    static himc_vec3 x[FRAMES];
    for (double rate = 100; rate < 1100; rate *= 2)
        for (double size = 0.0002; size < 0.002; size *= 5) {
            for (int i = 0; i < FRAMES; i++)
                x[i] = shaken(wave(i / rate), size);
            TEST_ASSERT_DOUBLE_WITHIN(0.08 * size, size, noise_of(x, FRAMES));
        }
    for (int i = 0; i < FRAMES; i++)
        x[i] = wave(i / 250.0);
    TEST_ASSERT_TRUE(noise_of(x, FRAMES) < 1e-6);
    TEST_ASSERT_EQUAL_DOUBLE(0, noise_of(x, 4));
}

// strikes every 0.5 s, with smooth motion between them
static himc_vec3 drumming(double t)
{
    touch_time = 0.3 + 0.5 * floor(fmax(0, t) / 0.5);
    double u = fmod(t, 0.5), z = 0.85 + RADIUS;
    himc_target hit = {.v = {0, 0, 3}}, up = {.x = {0, 0, 0.3}}, down = {.v = {0, 0, -4}};
    himc_quintic rise = himc_quintic_make(&hit, &up, 0.3),
                 fall = himc_quintic_make(&up, &down, 0.2);
    double over = himc_quintic_at(u < 0.3 ? &rise : &fall, u < 0.3 ? u : u - 0.3).x.z;
    return shaken(himc_vec3_make(0.6 + 0.02 * sin(4 * t), 0.05, z + over), noise);
}

// largest acceleration of the targets further than 30 ms from all contacts (m/s^2)
static double hardest(double size, int *strikes, double *speed)
{
    double most = 0, worst = 0;
    noise = size;
    himc_take *take = read_motion(drumming, 250, FRAMES);
    himc_take_options options = z_up();
    himc_track *track = himc_track_new(take, &options, &place, RADIUS, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(track, error.text);
    *strikes = himc_track_strikes(track, HIMC_RIGHT);
    for (double t = 0.1; t < FRAMES / 250.0 - 0.2; t += 2e-4) {
        double time, x, y, since = fabs(fmod(t + 0.25, 0.5) - 0.25);
        himc_target s = himc_track_target(track, HIMC_RIGHT, t);
        if (since > 0.03)
            most = fmax(most, himc_vec3_length(s.a));
        if (himc_track_current(track, HIMC_RIGHT, t, &time, &x, &y) && time - t < 1e-3 &&
            time - t > 7e-4)
            worst = fmax(worst, fabs(s.v.z / -4 - 1));
    }
    *speed = worst;
    himc_track_free(track);
    himc_take_free(take);
    return most;
}

static void test_a_millimetre_of_noise_makes_no_strikes_and_no_spikes(void)
{
    int strikes;
    double speed, clean = hardest(0, &strikes, &speed);
    TEST_ASSERT_EQUAL_INT(11, strikes);
    TEST_ASSERT_TRUE(speed < 0.02);
    double little = hardest(0.0002, &strikes, &speed);
    TEST_ASSERT_EQUAL_INT(11, strikes);
    TEST_ASSERT_TRUE(speed < 0.06); // the worst of eleven blows: measured .048
    double much = hardest(0.001, &strikes, &speed);
    TEST_ASSERT_EQUAL_INT(11, strikes);
    TEST_ASSERT_TRUE(speed < 0.08); // .061
    // 38, 46 and 174 m/s^2; differences of the frames alone would make 150000 of a millimetre
    TEST_ASSERT_TRUE(little < clean + 20);
    TEST_ASSERT_TRUE(much < clean + 180);
}

// RMS of the target accelerations from a stream of that rate (m/s^2), and of the distance of the
// tip from the path, one period late (m)
static double live(double rate, double size, double *off)
{
    himc_planner_config config = himc_planner_default();
    himc_planner *planner = himc_planner_new(&config, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(planner, error.text);
    double next = 0, sum = 0, away = 0;
    long count = 0;
    for (long n = 0; n < 30000; n++) {
        double t = n * 1e-4;
        himc_planner_advance(planner, t);
        if (t >= next) {
            himc_planner_reach(planner, t, HIMC_LEFT, shaken(wave(t), size));
            next += 1 / rate;
        }
        if (t < 1.5)
            continue;
        himc_target s = himc_planner_target(planner, HIMC_LEFT, t);
        himc_vec3 d = himc_vec3_sub(s.x, wave(t - 1 / rate));
        sum += himc_vec3_dot(s.a, s.a);
        away += himc_vec3_dot(d, d);
        count++;
    }
    himc_planner_free(planner);
    *off = sqrt(away / (double)count);
    return sqrt(sum / (double)count);
}

static void test_live_targets_with_a_millimetre_of_noise_give_small_accelerations(void)
{
    double off; // the path itself has 7.8 m/s^2; unfiltered, noise makes 100 to 160
    TEST_ASSERT_TRUE(live(250, 0, &off) < 9 && off < 0.0005);
    TEST_ASSERT_TRUE(live(1000, 0, &off) < 9 && off < 0.0006);
    TEST_ASSERT_TRUE(live(100, 0.001, &off) < 20 && off < 0.004);
    TEST_ASSERT_TRUE(live(250, 0.001, &off) < 20 && off < 0.003);
    TEST_ASSERT_TRUE(live(1000, 0.001, &off) < 20 && off < 0.002);
    TEST_ASSERT_TRUE(live(250, 0.0002, &off) < 20 && off < 0.0007);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_noise_is_measured_through_motion_of_any_size_at_any_rate);
    RUN_TEST(test_a_millimetre_of_noise_makes_no_strikes_and_no_spikes);
    RUN_TEST(test_live_targets_with_a_millimetre_of_noise_give_small_accelerations);
    return UNITY_END();
}
