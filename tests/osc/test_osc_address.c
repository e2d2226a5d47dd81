/// test_osc_address.c: numeric addresses: an IPv4 address in IPv6 clothes is the same host.
#include "osc/network.h"

#include "unity.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static osc_address address(const char *host, int port)
{
    osc_address a;
    TEST_ASSERT_TRUE_MESSAGE(himc_osc_address_parse(host, port, &a), host);
    return a;
}

static void test_an_ipv4_address_mapped_into_ipv6_is_the_ipv4_address(void)
{
    osc_address mapped = address("::ffff:192.0.2.7", 9), plain = address("192.0.2.7", 9),
                raw = {.v6 = true, .port = 9, .host = {[10] = 0xff, 0xff, 192, 0, 2, 7}};
    TEST_ASSERT_FALSE(mapped.v6);
    TEST_ASSERT_TRUE(himc_osc_address_same(&raw, &plain));
    TEST_ASSERT_TRUE(himc_osc_address_same_host(&plain, &raw));
    raw.host[15] = 8;
    TEST_ASSERT_FALSE(himc_osc_address_same_host(&plain, &raw));
    raw.host[0] = 1; // another network with the same last bytes
    raw.host[15] = 7;
    TEST_ASSERT_FALSE(himc_osc_address_same_host(&plain, &raw));
}

static void test_a_host_is_the_same_at_any_port_an_address_is_not(void)
{
    osc_address a = address("192.0.2.7", 9), b = address("192.0.2.7", 10);
    TEST_ASSERT_TRUE(himc_osc_address_same_host(&a, &b));
    TEST_ASSERT_FALSE(himc_osc_address_same(&a, &b));
}

static void test_all_loopback_addresses_are_one_host(void)
{
    static const char *const loopback[] = {"127.0.0.1", "127.9.8.7", "::1", "::ffff:127.0.0.1",
                                           "localhost"};
    static const char *const other[] = {"128.0.0.1", "::2", "126.0.0.1", "fe80::1", "0.0.0.0"};
    osc_address here = address("127.0.0.1", 1);
    for (int i = 0; i < 5; i++) {
        osc_address a = address(loopback[i], 2), b = address(other[i], 2);
        TEST_ASSERT_TRUE_MESSAGE(himc_osc_address_loopback(&a), loopback[i]);
        TEST_ASSERT_TRUE_MESSAGE(himc_osc_address_same_host(&a, &here), loopback[i]);
        TEST_ASSERT_FALSE_MESSAGE(himc_osc_address_loopback(&b), other[i]);
        TEST_ASSERT_FALSE_MESSAGE(himc_osc_address_same_host(&b, &here), other[i]);
    }
}

// as a packet to a socket of both families brings it, not as a name is read
static void test_this_machine_mapped_into_ipv6_is_no_stranger(void)
{
    osc_address here = address("127.0.0.1", 1), six = address("::1", 1),
                raw = {.v6 = true, .port = 9, .host = {[10] = 0xff, 0xff, 127, 0, 0, 1}};
    TEST_ASSERT_TRUE(himc_osc_address_loopback(&raw));
    TEST_ASSERT_TRUE(himc_osc_address_same_host(&raw, &here));
    TEST_ASSERT_TRUE(himc_osc_address_same_host(&six, &raw));
    raw.host[15] = 7, raw.host[13] = 3;
    TEST_ASSERT_TRUE(himc_osc_address_loopback(&raw));
    raw.host[12] = 128;
    TEST_ASSERT_FALSE(himc_osc_address_loopback(&raw));
    raw.host[12] = 127, raw.host[9] = 1; // IPv6, which happens to end so
    TEST_ASSERT_FALSE(himc_osc_address_loopback(&raw));
    TEST_ASSERT_FALSE(himc_osc_address_same_host(&raw, &here));
}

static void test_addresses_are_printed_as_a_user_writes_them(void)
{
    static const char *const text[][2] = {{"192.0.2.7", "192.0.2.7:9"},
                                          {"::ffff:192.0.2.7", "192.0.2.7:9"},
                                          {"2001:db8::1", "[2001:db8::1]:9"}};
    char printed[80];
    for (int i = 0; i < 3; i++) {
        osc_address a = address(text[i][0], 9);
        himc_osc_address_print(&a, printed);
        TEST_ASSERT_EQUAL_STRING(text[i][1], printed);
    }
}

static void test_a_name_is_no_numeric_address(void)
{
    static const char *const bad[] = {"example.org", "", "1.2.3.4.5", "::1::", "300.0.0.1"};
    osc_address a;
    for (int i = 0; i < 5; i++)
        TEST_ASSERT_FALSE_MESSAGE(himc_osc_address_parse(bad[i], 9, &a), bad[i]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_an_ipv4_address_mapped_into_ipv6_is_the_ipv4_address);
    RUN_TEST(test_a_host_is_the_same_at_any_port_an_address_is_not);
    RUN_TEST(test_all_loopback_addresses_are_one_host);
    RUN_TEST(test_this_machine_mapped_into_ipv6_is_no_stranger);
    RUN_TEST(test_addresses_are_printed_as_a_user_writes_them);
    RUN_TEST(test_a_name_is_no_numeric_address);
    return UNITY_END();
}
