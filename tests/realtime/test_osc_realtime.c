// OSC with its network thread, by the wall clock: rates, floods, time that commands may take.
#define OSC_REAL_TIME
#include "osc_ear.h"

static void test_pose_comes_33_times_a_second_with_20_bodies(void)
{
    subscribe("pose");
    play(0.2);
    forget();
    play(1);
    TEST_ASSERT_INT_WITHIN(20 * 5, 20 * 33, count("/himc/body"));
}

static void test_subscriptions_change_while_playing(void)
{
    subscribe("targets 100");
    play(0.2);
    forget();
    play(0.5);
    TEST_ASSERT_INT_WITHIN(30, 100, count("/himc/targets"));
    subscribe("targets 10");
    play(0.2);
    forget();
    play(0.5);
    TEST_ASSERT_INT_WITHIN(6, 10, count("/himc/targets"));
}

static void test_a_vanished_receiver_is_noted_once_and_found_again(void)
{
    char atoms[64];
    int port = 0, other = open_ear(&port);
    snprintf(atoms, sizeof atoms, "127.0.0.1 %d pose", port);
    say("/himc/subscribe", atoms);
    play(0.2);
    close(other);
    play(0.4);
    TEST_ASSERT_EQUAL_INT(1, lines_of_vanished());
    play(1.2);
    TEST_ASSERT_EQUAL_INT(0, lines_of_vanished());
    TEST_ASSERT_EQUAL_INT(1, himc_osc_count(osc).subscriptions);
    other = open_ear(&port);
    play(3.8); // tried once a second, and believed after two and a half
    forget();
    hear(other);
    forget();
    play(0.5);
    hear(other);
    close(other);
    TEST_ASSERT_INT_WITHIN(20 * 5, 20 * 16, count("/himc/body"));
}

static void test_an_unreachable_address_delays_no_other_subscriber(void)
{
    himc_command command;
    himc_error error;
    himc_command_parse_text(&command, HIMC_PERFORMER, "subscribe 255.255.255.255 9 pose", &error);
    TEST_ASSERT_TRUE(himc_osc_command(osc, &command, &error));
    subscribe("pose");
    play(0.2);
    forget();
    play(1);
    TEST_ASSERT_INT_WITHIN(20 * 5, 20 * 33, count("/himc/body"));
}

static void test_an_unknown_host_name_delays_no_other_subscriber(void)
{
    himc_command command;
    himc_error error;
    himc_command_parse_text(&command, HIMC_PERFORMER, "subscribe nowhere.invalid 9000 pose",
                            &error);
    TEST_ASSERT_TRUE(himc_osc_command(osc, &command, &error));
    subscribe("pose");
    play(0.5);
    TEST_ASSERT_TRUE(count("/himc/body") > 20 * 8);
}

static void test_subscriptions_outlive_listening_elsewhere(void)
{
    himc_error error;
    subscribe("pose");
    play(0.2);
    himc_osc *other = himc_osc_reopen(osc, &(himc_osc_config){.port = 0}, &error);
    TEST_ASSERT_NOT_NULL(other);
    osc = other;
    himc_performance_on_tick(performance, himc_osc_tick, osc);
    forget();
    play(0.5);
    TEST_ASSERT_INT_WITHIN(20 * 5, 20 * 16, count("/himc/body"));
}

static void test_the_audio_side_takes_microseconds(void)
{
    himc_event event;
    char line[HIMC_OSC_LINE];
    subscribe("pose 250");
    subscribe("strikes");
    subscribe("head 250");
    subscribe("vmc");
    say("/himc/stroke", "1 left accent f");
    say("/himc/play", "");
    play(0.3);
    double longest = 0;
    int slow = 0;
    for (int i = 0; i < 1000; i++) {
        himc_performance_process(performance, 96, (double *[HIMC_HANDS]){NULL, NULL});
        double begun = system_seconds();
        himc_osc_receive(osc, performance, 8);
        while (himc_performance_event(performance, &event))
            himc_osc_event(osc, &event);
        himc_osc_publish(osc, performance, 0);
        himc_osc_line(osc, line);
        double took = system_seconds() - begun;
        slow += took > 1e-4;
        longest = fmax(longest, took);
    }
    TEST_ASSERT_TRUE_MESSAGE(slow < 100, "a tenth of the calls takes 100 us or more");
    printf("audio side: longest call %.1f us\n", 1e6 * longest);
}

static void test_commands_take_a_tenth_of_the_time_at_most(void)
{
    double begun = system_seconds(), spent = 0, longest = 0, now = begun;
    say("/membrane/kettle/modes", "2000");
    for (int i = 0; now - begun < 1.5; i++) {
        say("/membrane/kettle/tune", i % 2 ? "110" : "120");
        rest(0.002);
        double before = system_seconds();
        himc_osc_receive(osc, performance, 8);
        now = system_seconds();
        spent += now - before;
        longest = fmax(longest, now - before);
    }
    TEST_ASSERT_TRUE(longest > 0.001);
    TEST_ASSERT_TRUE(spent < 0.05 + 0.1 * (now - begun) + longest);
}

// valid, malformed and random bytes as fast as they go, all counted, the pose still coming
static void test_a_storm_is_counted_and_poses_continue(void)
{
    uint32_t seed = 1;
    char data[64];
    double seconds = getenv("HIMC_LONG") ? 60 : 2, begun = system_seconds();
    subscribe("pose");
    while (system_seconds() - begun < seconds) {
        for (int i = 0; i < 400; i++) {
            size_t size = 20;
            if (i % 3 == 0)
                memcpy(data, "/himc/tempo\0,f\0\0\x42\xf0\0\0", 20);
            else
                for (size = 0; size < (i % 3 == 1 ? 20 : seed % 64); size++)
                    data[size] = (char)((seed = seed * 1664525 + 1013904223) >> 24);
            if (i % 3 == 1)
                memcpy(data, "/himc/tempo\0,f\0\0", 16);
            send_bytes(data, size);
        }
        play(0.004);
    }
    play(1.2);
    say("/himc/stop", ""); // the system reports its losses with the next packet
    play(0.1);
    himc_osc_counts c = himc_osc_count(osc);
    TEST_ASSERT_TRUE(c.packets + c.overrun >= said);
    TEST_ASSERT_TRUE(c.frequent > 0 && c.malformed > 0 && c.commands > 0 && c.refused > 0);
    TEST_ASSERT_TRUE(count("/himc/body") > 20 * 20);
    TEST_ASSERT_TRUE(status("frequent") > 0);
    printf("storm: %.0f packets/s sent, %ld taken, %ld lost in the system, %ld too frequent\n",
           (double)said / seconds, c.packets, c.overrun, c.frequent);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_pose_comes_33_times_a_second_with_20_bodies);
    RUN_TEST(test_subscriptions_change_while_playing);
    RUN_TEST(test_a_vanished_receiver_is_noted_once_and_found_again);
    RUN_TEST(test_an_unreachable_address_delays_no_other_subscriber);
    RUN_TEST(test_an_unknown_host_name_delays_no_other_subscriber);
    RUN_TEST(test_subscriptions_outlive_listening_elsewhere);
    RUN_TEST(test_the_audio_side_takes_microseconds);
    RUN_TEST(test_commands_take_a_tenth_of_the_time_at_most);
    RUN_TEST(test_a_storm_is_counted_and_poses_continue);
    return UNITY_END();
}
