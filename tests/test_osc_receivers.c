// Receivers that come, change their wishes, go without a word and come back; many of them.
#include "osc_ear.h"

static int told_gone(void)
{
    char line[HIMC_OSC_LINE];
    int lines = 0;
    while (himc_osc_line(osc, line))
        lines += strstr(line, "forgotten after 60 s") != NULL;
    return lines;
}

static void test_subscriptions_change_and_end_while_playing(void)
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
    say("/himc/unsubscribe", "");
    char atoms[64];
    snprintf(atoms, sizeof atoms, "127.0.0.1 %d targets", ear_port);
    say("/himc/unsubscribe", atoms);
    play(0.1);
    forget();
    play(0.2);
    TEST_ASSERT_EQUAL_INT(0, count("/himc/targets"));
}

static void test_a_receiver_that_vanishes_is_told_once_and_found_again(void)
{
    char atoms[64];
    int port = 0, other = open_ear(&port);
    snprintf(atoms, sizeof atoms, "127.0.0.1 %d pose", port);
    say("/himc/subscribe", atoms);
    play(0.2);
    close(other);
    play(0.4);
    TEST_ASSERT_EQUAL_INT(1, told_gone());
    play(1.2);
    TEST_ASSERT_EQUAL_INT(0, told_gone());
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

static void test_an_address_unreachable_is_one_line_and_stalls_nobody(void)
{
    himc_command command;
    himc_error error;
    // the system refuses to send there at once, as it does without a route
    himc_command_parse_text(&command, HIMC_PERFORMER, "subscribe 255.255.255.255 9 pose", &error);
    TEST_ASSERT_TRUE(himc_osc_command(osc, &command, &error));
    subscribe("pose");
    play(0.2);
    forget();
    play(1);
    TEST_ASSERT_EQUAL_INT(1, told_gone());
    TEST_ASSERT_INT_WITHIN(20 * 5, 20 * 33, count("/himc/body"));
    TEST_ASSERT_TRUE(himc_osc_count(osc).unsent > 0);
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
    himc_osc_config taken = {.port = himc_osc_port(osc)};
    TEST_ASSERT_NULL(himc_osc_reopen(osc, &taken, &error));
    forget();
    play(0.5);
    TEST_ASSERT_INT_WITHIN(20 * 5, 20 * 16, count("/himc/body"));
}

static void test_an_unknown_name_of_a_host_stalls_nobody(void)
{
    himc_command command;
    himc_error error;
    char line[HIMC_OSC_LINE];
    himc_command_parse_text(&command, HIMC_PERFORMER, "subscribe nowhere.invalid 9000 pose",
                            &error);
    TEST_ASSERT_TRUE(himc_osc_command(osc, &command, &error));
    subscribe("pose");
    play(0.5);
    TEST_ASSERT_TRUE(count("/himc/body") > 20 * 8);
    if (himc_osc_line(osc, line)) {
        TEST_ASSERT_NOT_NULL(strstr(line, "nowhere.invalid: no host"));
    }
}

static void test_200_subscriptions_are_served_and_the_257th_refused(void)
{
    int ears[64], port = 0;
    char atoms[64];
    static const char *const what[] = {"pose", "targets", "strikes", "head"};
    for (int i = 0; i < 50; i++) {
        port = 0;
        ears[i] = open_ear(&port);
        for (int k = 0; k < 4; k++) {
            snprintf(atoms, sizeof atoms, "127.0.0.1 %d %s", port, what[k]);
            say("/himc/subscribe", atoms);
        }
    }
    play(0.3);
    TEST_ASSERT_EQUAL_INT(200, himc_osc_count(osc).subscriptions);
    hear(ears[49]);
    TEST_ASSERT_TRUE(count("/himc/body") >= 20 * 3);
    forget();
    for (int i = 50; i < 64; i++) {
        port = 0;
        ears[i] = open_ear(&port);
        for (int k = 0; k < 4; k++) {
            snprintf(atoms, sizeof atoms, "127.0.0.1 %d %s", port, what[k]);
            say("/himc/subscribe", atoms);
        }
    }
    say("/himc/subscribe", "127.0.0.1 9 pose");
    play(0.2);
    TEST_ASSERT_EQUAL_INT(256, himc_osc_count(osc).subscriptions);
    TEST_ASSERT_NOT_NULL(strstr(last_error(), "256 subscriptions"));
    for (int i = 0; i < 64; i++)
        close(ears[i]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_subscriptions_change_and_end_while_playing);
    RUN_TEST(test_a_receiver_that_vanishes_is_told_once_and_found_again);
    RUN_TEST(test_an_address_unreachable_is_one_line_and_stalls_nobody);
    RUN_TEST(test_subscriptions_outlive_listening_elsewhere);
    RUN_TEST(test_an_unknown_name_of_a_host_stalls_nobody);
    RUN_TEST(test_200_subscriptions_are_served_and_the_257th_refused);
    return UNITY_END();
}
