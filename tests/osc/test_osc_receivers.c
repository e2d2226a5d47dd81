// Receivers that subscribe, change their subscription, vanish and come back; many of them.
#include "osc_ear.h"

static void test_subscriptions_change_and_end_while_playing(void)
{
    subscribe("targets 100");
    play(0.2);
    forget();
    play(0.5);
    TEST_ASSERT_INT_WITHIN(2, 100, count("/himc/targets"));
    subscribe("targets 10");
    play(0.2);
    forget();
    play(0.5);
    TEST_ASSERT_INT_WITHIN(2, 10, count("/himc/targets"));
    say("/himc/unsubscribe", "");
    char atoms[64];
    snprintf(atoms, sizeof atoms, "127.0.0.1 %d targets", ear_port);
    say("/himc/unsubscribe", atoms);
    play(0.1);
    forget();
    play(0.2);
    TEST_ASSERT_EQUAL_INT(0, count("/himc/targets"));
}

static void test_a_vanished_receiver_is_noted_once_and_found_again(void)
{
    char atoms[64];
    int port = 0, other = open_ear(&port), lines = 0;
    snprintf(atoms, sizeof atoms, "127.0.0.1 %d pose", port);
    say("/himc/subscribe", atoms);
    others_hear = true;
    play(0.2);
    close(other);
    play(0.4);
    AWAIT((lines += lines_of_vanished()) > 0);
    TEST_ASSERT_EQUAL_INT(1, lines);
    play(1.2);
    TEST_ASSERT_EQUAL_INT(0, lines_of_vanished());
    TEST_ASSERT_EQUAL_INT(1, himc_osc_count(osc).subscriptions);
    other = open_ear(&port);
    play(4.8); // tried once a second, and believed after two and a half
    hear(other);
    forget();
    long before = himc_osc_count(osc).sent;
    play(0.5);
    for (before = himc_osc_count(osc).sent - before; before > 0;)
        before -= wait_and_hear(other);
    close(other);
    TEST_ASSERT_INT_WITHIN(20, 20 * 16, count("/himc/body"));
}

// the system refuses to send there at once, as it does without a route
static void subscribe_unreachable(void)
{
    himc_command command;
    himc_error error;
    himc_command_parse_text(&command, HIMC_PERFORMER, "subscribe 255.255.255.255 9 pose", &error);
    TEST_ASSERT_TRUE(himc_osc_command(osc, &command, &error));
}

static void test_an_unreachable_address_gives_one_line_and_delays_no_other(void)
{
    subscribe_unreachable();
    subscribe("pose");
    play(0.2);
    forget();
    play(1);
    TEST_ASSERT_EQUAL_INT(1, lines_of_vanished());
    TEST_ASSERT_INT_WITHIN(20, 20 * 33, count("/himc/body"));
    TEST_ASSERT_TRUE(himc_osc_count(osc).unsent > 0);
}

static void test_an_unreachable_address_is_tried_once_a_second(void)
{
    subscribe_unreachable();
    play(0.2);
    long before = himc_osc_count(osc).unsent;
    play(5);
    // the status and the place of the drum are sent; a pose waits for a second without a failure
    TEST_ASSERT_INT_WITHIN(2, 2 * 5, himc_osc_count(osc).unsent - before);
}

static void test_an_unreachable_address_is_removed_after_a_minute(void)
{
    subscribe_unreachable();
    play(0.02);
    TEST_ASSERT_EQUAL_INT(1, lines_of_vanished());
    for (int second = 0; second < 60; second++) {
        TEST_ASSERT_EQUAL_INT(1, himc_osc_count(osc).subscriptions);
        simulated += 0.98;
        play(0.02);
    }
    simulated += 0.1;
    play(0.02);
    TEST_ASSERT_EQUAL_INT(0, himc_osc_count(osc).subscriptions);
    TEST_ASSERT_EQUAL_INT(0, lines_of_vanished());
}

static void listen_elsewhere_and_play(void)
{
    himc_error error;
    himc_osc *other = himc_osc_reopen(osc, &(himc_osc_config){.port = 0}, &error);
    TEST_ASSERT_NOT_NULL(other);
    osc = other;
    said = heard_packets = 0;
    himc_performance_on_tick(performance, himc_osc_tick, osc);
    forget();
    play(0.5);
}

static void test_subscriptions_outlive_listening_elsewhere(void)
{
    himc_error error;
    subscribe("pose");
    play(0.2);
    listen_elsewhere_and_play();
    TEST_ASSERT_INT_WITHIN(20, 20 * 16, count("/himc/body"));
    himc_osc_config taken = {.port = himc_osc_port(osc)};
    TEST_ASSERT_NULL(himc_osc_reopen(osc, &taken, &error));
    forget();
    play(0.5);
    TEST_ASSERT_INT_WITHIN(20, 20 * 16, count("/himc/body"));
}

// a command of the host that its network has not seen yet goes with the subscriptions
static void test_a_subscription_that_waits_outlives_listening_elsewhere(void)
{
    himc_command command;
    himc_error error;
    char text[64];
    snprintf(text, sizeof text, "subscribe 127.0.0.1 %d targets 50", ear_port);
    TEST_ASSERT_TRUE(himc_command_parse_text(&command, HIMC_PERFORMER, text, &error));
    TEST_ASSERT_TRUE(himc_osc_command(osc, &command, &error));
    listen_elsewhere_and_play();
    TEST_ASSERT_INT_WITHIN(4, 2 * 25, count("/himc/targets"));
}

static void test_only_subscriptions_are_the_networks_and_only_as_many_as_have_room(void)
{
    himc_command command;
    himc_error error;
    int taken = 0;
    TEST_ASSERT_TRUE(himc_command_parse_text(&command, HIMC_PERFORMER, "stop", &error));
    TEST_ASSERT_FALSE(himc_osc_command(osc, &command, &error));
    TEST_ASSERT_EQUAL_STRING("expected subscribe or unsubscribe", error.text);
    TEST_ASSERT_TRUE(himc_command_parse_text(&command, HIMC_PERFORMER,
                                             "subscribe 127.0.0.1 9 targets 50", &error));
    while (taken < 100000 && himc_osc_command(osc, &command, &error))
        taken++;
    TEST_ASSERT_EQUAL_STRING("too many subscriptions at once: this one is dropped", error.text);
    others_hear = true;
    play(0.02);
    TEST_ASSERT_EQUAL_INT(1, himc_osc_count(osc).subscriptions);
    TEST_ASSERT_TRUE(himc_osc_command(osc, &command, &error));
}

static void test_bad_settings_are_refused_in_a_line(void)
{
    himc_error error;
    char hosts[600] = "127.0.0.1";
    himc_osc_config config = himc_osc_default();
    config.port = 65536;
    TEST_ASSERT_NULL(himc_osc_reopen(NULL, &config, &error));
    TEST_ASSERT_EQUAL_STRING("port: 65536, expected 0 .. 65535", error.text);
    config.port = 0;
    for (int i = 1; i < 33; i++)
        sprintf(hosts + strlen(hosts), ",127.0.0.%d", 1 + i);
    config.allow = hosts;
    TEST_ASSERT_NULL(himc_osc_new(&config, &error));
    TEST_ASSERT_EQUAL_STRING("allow: 127.0.0.33 is one host too many, expected 32", error.text);
    memset(hosts, 'x', 300);
    hosts[300] = 0;
    TEST_ASSERT_NULL(himc_osc_new(&config, &error));
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, strncmp(error.text, "allow: xxx", 10), error.text);
    TEST_ASSERT_NOT_NULL(strstr(error.text, "x: no host of that name"));
}

static void test_an_unknown_host_name_delays_no_other_subscriber(void)
{
    himc_command command;
    himc_error error;
    char line[HIMC_OSC_LINE];
    himc_command_parse_text(&command, HIMC_PERFORMER, "subscribe nowhere.invalid 9000 pose",
                            &error);
    TEST_ASSERT_TRUE(himc_osc_command(osc, &command, &error));
    subscribe("pose");
    play(0.5);
    TEST_ASSERT_TRUE(count("/himc/body") >= 20 * 15);
    if (himc_osc_line(osc, line)) {
        TEST_ASSERT_NOT_NULL(strstr(line, "nowhere.invalid: no host"));
    }
}

// an ear that subscribes to four streams
static int subscribe_to_all(void)
{
    static const char *const stream[] = {"pose", "targets", "strikes", "head"};
    char atoms[64];
    int port = 0, fd = open_ear(&port);
    for (int k = 0; k < 4; k++) {
        snprintf(atoms, sizeof atoms, "127.0.0.1 %d %s", port, stream[k]);
        say("/himc/subscribe", atoms);
    }
    return fd;
}

static void test_200_subscriptions_are_served_and_the_257th_refused(void)
{
    int ears[64];
    others_hear = true;
    for (int i = 0; i < 50; i++)
        ears[i] = subscribe_to_all();
    settle();
    TEST_ASSERT_EQUAL_INT(200, himc_osc_count(osc).subscriptions);
    play(0.3);
    for (int i = 0; i < 50; i++) {
        forget();
        while (count("/himc/body") < 20 * 9)
            wait_and_hear(ears[i]);
    }
    for (int i = 50; i < 64; i++)
        ears[i] = subscribe_to_all();
    say("/himc/subscribe", "127.0.0.1 9 pose");
    settle();
    TEST_ASSERT_EQUAL_INT(256, himc_osc_count(osc).subscriptions);
    AWAIT(strstr(last_error(), "256 subscriptions"));
    for (int i = 0; i < 64; i++)
        close(ears[i]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_subscriptions_change_and_end_while_playing);
    RUN_TEST(test_a_vanished_receiver_is_noted_once_and_found_again);
    RUN_TEST(test_an_unreachable_address_gives_one_line_and_delays_no_other);
    RUN_TEST(test_an_unreachable_address_is_tried_once_a_second);
    RUN_TEST(test_an_unreachable_address_is_removed_after_a_minute);
    RUN_TEST(test_subscriptions_outlive_listening_elsewhere);
    RUN_TEST(test_a_subscription_that_waits_outlives_listening_elsewhere);
    RUN_TEST(test_only_subscriptions_are_the_networks_and_only_as_many_as_have_room);
    RUN_TEST(test_bad_settings_are_refused_in_a_line);
    RUN_TEST(test_an_unknown_host_name_delays_no_other_subscriber);
    RUN_TEST(test_200_subscriptions_are_served_and_the_257th_refused);
    return UNITY_END();
}
