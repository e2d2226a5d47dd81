/// test_osc_expiry.c: subscriptions asked for over the network end unless they are renewed, and no
/// host elsewhere gets more than its bytes of a second. Time is simulated; 192.0.2.x is nobody's
/// (RFC 5737), so packets count as sent or as refused by the system.
#include "osc/subscribe.h"

#include "unity.h"

#include <string.h>

#define CAP 500e3   // bytes a second of a host
#define BURST 125e3 // bytes at once

static osc_subscriptions table;
static osc_network network;
static osc_counters counters;
static system_ring lines;
static himc_error error;

void setUp(void)
{
    memset(&table, 0, sizeof table);
    memset(&counters, 0, sizeof counters);
    TEST_ASSERT_TRUE(himc_ring_init(&lines, HIMC_OSC_LINE, 64));
    TEST_ASSERT_TRUE(himc_osc_network_open(&network, NULL, -1, &counters, &error));
    table.network = &network;
    table.counts = &counters;
    table.lines = &lines;
}

void tearDown(void)
{
    himc_osc_network_close(&network);
    himc_ring_free(&lines);
}

// by that host itself, or by the user of this machine
static bool try(const char *host, int port, osc_stream stream, bool user, double now)
{
    osc_change change = {.port = port, .stream = stream, .hz = 33, .local = user};
    strcpy(change.host, host);
    TEST_ASSERT_TRUE(himc_osc_address_parse(host, port, &change.from));
    return himc_osc_subscribe(&table, &change, now, &error);
}

static void subscribe(const char *host, int port, osc_stream stream, bool user, double now)
{
    TEST_ASSERT_TRUE_MESSAGE(try(host, port, stream, user, now), error.text);
}

static int subscribed_at(double now)
{
    himc_osc_forget(&table, now);
    return table.count;
}

static void test_a_strangers_subscription_ends_after_a_minute_unless_renewed(void)
{
    subscribe("192.0.2.1", 9001, STREAM_STRIKES, false, 10);
    subscribe("192.0.2.1", 9001, STREAM_POSE, false, 10);
    TEST_ASSERT_EQUAL_INT(2, subscribed_at(69.9));
    TEST_ASSERT_EQUAL_INT(33, table.pose_hz);
    subscribe("192.0.2.1", 9001, STREAM_STRIKES, false, 69.9);
    TEST_ASSERT_EQUAL_INT(1, subscribed_at(70.1));
    TEST_ASSERT_EQUAL_INT(0, table.pose_hz);
    TEST_ASSERT_EQUAL_INT(1, subscribed_at(129));
    TEST_ASSERT_EQUAL_INT(0, subscribed_at(130));
    TEST_ASSERT_EQUAL_STRING("192.0.2.1:9001: not subscribed again within 60 s, forgotten",
                             himc_ring_peek(&lines));
}

static void test_subscriptions_of_this_machine_of_its_user_and_of_allowed_hosts_stay(void)
{
    TEST_ASSERT_TRUE(himc_osc_allow(&table, "192.0.2.7,192.0.2.8", &error));
    subscribe("127.0.0.1", 9001, STREAM_STRIKES, false, 0);
    subscribe("::1", 9001, STREAM_STRIKES, false, 0);
    subscribe("192.0.2.1", 9001, STREAM_STRIKES, true, 0);
    subscribe("192.0.2.8", 9001, STREAM_STRIKES, false, 0);
    TEST_ASSERT_EQUAL_INT(4, subscribed_at(1e6));
}

static void test_a_subscription_handed_over_keeps_its_end(void)
{
    osc_change change = {.granted = true, .stream = STREAM_POSE, .hz = 33, .expires = 30};
    TEST_ASSERT_TRUE(himc_osc_address_parse("192.0.2.1", 9001, &change.from));
    TEST_ASSERT_TRUE(himc_osc_subscribe(&table, &change, 20, &error));
    TEST_ASSERT_EQUAL_INT(1, subscribed_at(29));
    TEST_ASSERT_EQUAL_INT(0, subscribed_at(31));
}

static long tried(void)
{
    return himc_osc_read(&counters, COUNT_SENT) + himc_osc_read(&counters, COUNT_UNSENT);
}

// sound for `seconds`, which has 200 packets a second of equal size for each subscription
static long sound_for(double seconds, double *bytes)
{
    static const osc_state state = {.kind = STATE_SOUND, .sound = {.rate = 48000, .channels = 2}};
    static const himc_osc_counts none;
    osc_packets p;
    long before = tried();
    himc_osc_encode_begin(&p, SMALL_PACKET, true, 0);
    himc_osc_encode_sound(&p, &state.sound);
    for (int i = 0; i < 200 * seconds; i++)
        himc_osc_deliver(&table, &state, &none, 1 + i / 200.0);
    *bytes = (double)(tried() - before) * (double)p.size[0];
    return tried() - before;
}

static void test_a_host_elsewhere_gets_its_bytes_of_a_second_and_no_more(void)
{
    double bytes;
    for (int i = 0; i < 32; i++)
        subscribe("192.0.2.1", 9001 + i, STREAM_SOUND, false, 0);
    sound_for(4, &bytes);
    TEST_ASSERT_DOUBLE_WITHIN(2000, (4 - 1 / 200.0) * CAP + BURST, bytes);
    TEST_ASSERT_EQUAL_INT(200 * 4 * 32, tried() + himc_osc_read(&counters, COUNT_CAPPED));
}

static void test_another_host_and_this_machine_get_all_of_theirs(void)
{
    double bytes;
    for (int i = 0; i < 32; i++)
        subscribe("192.0.2.1", 9001 + i, STREAM_SOUND, false, 0);
    long one = sound_for(4, &bytes);
    memset(table.allowance, 0, sizeof table.allowance);
    subscribe("192.0.2.3", 9001, STREAM_SOUND, false, 0);
    for (int i = 0; i < 10; i++)
        subscribe("127.0.0.1", 9001 + i, STREAM_SOUND, false, 0);
    TEST_ASSERT_EQUAL_INT(one + 11 * 200 * 4, sound_for(4, &bytes));
}

static void test_a_stranger_has_so_many_subscriptions_and_no_more(void)
{
    int had = 0;
    while (try("192.0.2.1", 9001 + had, STREAM_POSE, false, 0))
        TEST_ASSERT_LESS_THAN(256, ++had);
    TEST_ASSERT_EQUAL_INT(32, had);
    TEST_ASSERT_EQUAL_STRING(
        "subscribe: 192.0.2.1 port 9033: 32 subscriptions of 192.0.2.1 already,"
        " expected no more",
        error.text);
    subscribe("192.0.2.1", 9001, STREAM_POSE, false, 50); // renewed, as are the first two
    subscribe("192.0.2.1", 9002, STREAM_POSE, false, 50);
    subscribe("192.0.2.2", 9001, STREAM_POSE, false, 0);
    TEST_ASSERT_EQUAL_INT(2, subscribed_at(61)); // then there is room again
    subscribe("192.0.2.1", 9033, STREAM_POSE, false, 61);
}

static void test_all_strangers_leave_some_to_the_user_this_machine_and_allowed_hosts(void)
{
    char host[16];
    int had = 0;
    TEST_ASSERT_TRUE(himc_osc_allow(&table, "192.0.2.200", &error));
    for (int i = 0; i < 256; i++) {
        snprintf(host, sizeof host, "192.0.2.%d", 1 + i % 100);
        had += try(host, 9001 + i, STREAM_POSE, false, 0);
    }
    TEST_ASSERT_EQUAL_INT(192, had);
    TEST_ASSERT_NOT_NULL(strstr(error.text, "192 subscriptions of other machines already"));
    for (int i = 0; i < 20; i++) {
        subscribe("192.0.2.200", 9001 + i, STREAM_SOUND, false, 0);
        subscribe("::ffff:127.0.0.1", 9001 + i, STREAM_SOUND, false, 0);
        subscribe("192.0.2.3", 19001 + i, STREAM_SOUND, true, 0); // the user's
    }
    TEST_ASSERT_EQUAL_INT(60, subscribed_at(61));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_strangers_subscription_ends_after_a_minute_unless_renewed);
    RUN_TEST(test_subscriptions_of_this_machine_of_its_user_and_of_allowed_hosts_stay);
    RUN_TEST(test_a_subscription_handed_over_keeps_its_end);
    RUN_TEST(test_a_stranger_has_so_many_subscriptions_and_no_more);
    RUN_TEST(test_all_strangers_leave_some_to_the_user_this_machine_and_allowed_hosts);
    RUN_TEST(test_a_host_elsewhere_gets_its_bytes_of_a_second_and_no_more);
    RUN_TEST(test_another_host_and_this_machine_get_all_of_theirs);
    return UNITY_END();
}
