/// test_read.c: himc_performance_read: what it gives is what the drums have made.
#include "session.h"

#include <math.h>

#define LEAD 30000 // until shortly before the first stroke
#define N 24000

static himc_performance *two_drums(void)
{
    himc_performance *p = session_new();
    session_do(p, "drum kettle 26");
    session_do(p, "drum small 23");
    session_do(p, "small place 0.6 -0.6 0.85");
    session_do(p, "stroke 0 left legato f kettle");
    session_do(p, "stroke 0.2 right legato f small");
    session_do(p, "play");
    himc_performance_process(p, LEAD, NULL);
    return p;
}

static void test_each_channel_is_the_sum_of_the_drums(void)
{
    static float frames[3 * N];
    static double part[2][N];
    double peak = 0;
    himc_performance *p = two_drums();
    session_do(p, "listener usual");
    double told = himc_performance_read(p, frames, 3, N);
    for (int channel = 0; channel < 3; channel++) {
        for (int d = 0; d < 2; d++)
            himc_drum_read_channel(himc_performance_drum(p, d), channel, LEAD, N, part[d]);
        for (int i = 0; i < N; i++) {
            TEST_ASSERT_TRUE(frames[3 * i + channel] == (float)(part[0][i] + part[1][i]));
            peak = fmax(peak, fabs(part[0][i] + part[1][i]));
        }
    }
    TEST_ASSERT_TRUE(peak > 0.001);
    TEST_ASSERT_EQUAL_DOUBLE(peak, told);
    TEST_ASSERT_TRUE(himc_performance_time(p) == LEAD + N);
    himc_performance_free(p);
}

// by two ears, the one channel is the mean of both
static void test_one_channel_is_the_mean_of_the_ears(void)
{
    static float one[N], two[2 * N];
    himc_performance *p = two_drums(), *q = two_drums();
    session_do(p, "listener usual");
    session_do(q, "listener usual");
    himc_performance_read(p, one, 1, N);
    himc_performance_read(q, two, 2, N);
    for (int i = 0; i < N; i++)
        TEST_ASSERT_FLOAT_WITHIN(1e-6, (two[2 * i] + two[2 * i + 1]) / 2, one[i]);
    himc_performance_free(p);
    himc_performance_free(q);
}

static void test_the_length_of_the_blocks_does_not_matter(void)
{
    static float whole[2 * N], parts[2 * N];
    himc_performance *p = two_drums(), *q = two_drums();
    himc_performance_read(p, whole, 2, N);
    for (int at = 0, n = 1; at < N; at += n, n = n % 700 + 13)
        himc_performance_read(q, parts + 2 * at, 2, n < N - at ? n : N - at);
    TEST_ASSERT_EQUAL_MEMORY(whole, parts, sizeof whole);
    himc_performance_free(p);
    himc_performance_free(q);
}

static void test_channels_beyond_the_pickups_are_silent_and_without_channels_it_plays(void)
{
    static float frames[10 * 9600];
    himc_performance *p = two_drums();
    memset(frames, 1, sizeof frames);
    TEST_ASSERT_TRUE(himc_performance_read(p, frames, 10, 9600) > 0.001);
    for (int i = 0; i < 9600; i++)
        TEST_ASSERT_TRUE(frames[10 * i + 8] == 0 && frames[10 * i + 9] == 0);
    TEST_ASSERT_TRUE(himc_performance_read(p, NULL, 0, 9600) == 0);
    TEST_ASSERT_TRUE(himc_performance_time(p) == LEAD + 2 * 9600);
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_each_channel_is_the_sum_of_the_drums);
    RUN_TEST(test_one_channel_is_the_mean_of_the_ears);
    RUN_TEST(test_the_length_of_the_blocks_does_not_matter);
    RUN_TEST(test_channels_beyond_the_pickups_are_silent_and_without_channels_it_plays);
    return UNITY_END();
}
