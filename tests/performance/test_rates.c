/// test_rates.c: ordinary strokes at each end of each rate, by each law and in each mode.
#include "session.h"

#include "himc/body.h"
#include "himc/vec.h"

#define FASTEST_TIP 15.0 // (m/s) far above a stroke of any dynamic, 5 m/s

static double fastest, last_time;
static himc_vec3 last_tip[HIMC_HANDS];

static void keep_speed(void *user, const himc_tick *tick)
{
    (void)user;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_vec3 way = himc_vec3_sub(tick->body->tip[hand], last_tip[hand]);
        if (tick->time > last_time && tick->time > 0)
            fastest = fmax(fastest, himc_vec3_length(way) / (tick->time - last_time));
        last_tip[hand] = tick->body->tip[hand];
    }
    last_time = tick->time;
}

static void play(const char *strength, int physics, int task, const char *how)
{
    static const char *const way[] = {"left legato f", "right legato f", "left accent ff",
                                      "right legato f", "left legato mf"};
    char what[100];
    himc_performance *p = session_new();
    snprintf(what, sizeof what, "strength %s, rate physics %d, rate task %d, %s", strength, physics,
             task, how);
    session_do(p, "rate physics %d", physics);
    session_do(p, "rate task %d", task);
    session_do(p, "%s", how);
    session_do(p, "strength %s", strength);
    session_do(p, "drum kettle");
    session_do(p, "tempo 100");
    for (int i = 0; i < 5; i++)
        session_do(p, "stroke %d %s", i, way[i]);
    fastest = 0;
    last_time = INFINITY;
    himc_performance_on_tick(p, keep_speed, NULL);
    session_do(p, "play");
    session_play(p, 4, NULL);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, himc_performance_measure(p).recoveries, what);
    TEST_ASSERT_TRUE_MESSAGE(fastest > 1 && fastest < FASTEST_TIP, what);
    himc_performance_free(p);
}

// at 50 Hz the posture's own motion was unstable: 2025 recoveries
static void test_ordinary_strokes_at_each_end_of_each_rate(void)
{
    static const char *const how[] = {"law printed", "law feedforward", "law computed-torque",
                                      "mode ik", "mode id"};
    static const int rate[][2] = {{500, 50}, {500, 2000}, {10000, 50}, {527, 50}, {10000, 2000}};
    for (size_t r = 0; r < sizeof rate / sizeof *rate; r++)
        for (size_t h = 0; h < sizeof how / sizeof *how; h++)
            play("off", rate[r][0], rate[r][1], how[h]);
    play("off", 48000, 50, how[2]);
    play("off", 48000, 2000, how[2]);
}

// muscles that resist a stick made it whirl by 3000 rad/s: 128 recoveries
static void test_muscles_at_few_steps_a_second(void)
{
    static const char *const how[] = {"law printed", "law feedforward", "law computed-torque"};
    for (size_t h = 0; h < sizeof how / sizeof *how; h++) {
        play("human", 500, 50, how[h]);
        play("human", 527, 250, how[h]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_ordinary_strokes_at_each_end_of_each_rate);
    RUN_TEST(test_muscles_at_few_steps_a_second);
    return UNITY_END();
}
