/// Who may use the viewer's page and stream: the headers Host and Origin of a request.
#define _POSIX_C_SOURCE 200809L
#include "access.h"

#include <stdio.h>
#include <unistd.h>
#include <unity.h>

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_numeric_addresses_and_this_machine_are_local(void)
{
    static const char *const local[] = {"127.0.0.1",      "127.0.0.1:8080", "192.168.1.20:1",
                                        "[::1]",          "[::1]:8080",     "[fe80::1]:80",
                                        "localhost:8080", "localhost"};
    for (size_t i = 0; i < sizeof local / sizeof *local; i++)
        TEST_ASSERT_TRUE_MESSAGE(access_host_is_local(local[i]), local[i]);
    char own[256] = "", name[300];
    gethostname(own, sizeof own - 1);
    snprintf(name, sizeof name, "%s.local:8080", own);
    TEST_ASSERT_TRUE_MESSAGE(access_host_is_local(own), own);
    TEST_ASSERT_TRUE_MESSAGE(access_host_is_local(name), name);
}

static void test_other_names_and_malformed_hosts_are_not(void)
{
    static const char *const foreign[] = {"",
                                          ":8080",
                                          "evil.example",
                                          "evil.example:8080",
                                          "localhost.",
                                          "localhost.evil",
                                          "127.0.0.1.evil.example",
                                          "127.0.0.1:80@evil.example",
                                          "0x7f.1",
                                          "127.1",
                                          "[::1",
                                          "[::1].evil.example",
                                          "[::1]8080",
                                          "::1",
                                          "[localhost]",
                                          "[127.0.0.1]",
                                          "127.0.0.1:",
                                          "127.0.0.1:80a",
                                          "127.0.0.1 ",
                                          "[]"};
    for (size_t i = 0; i < sizeof foreign / sizeof *foreign; i++)
        TEST_ASSERT_FALSE_MESSAGE(access_host_is_local(foreign[i]), foreign[i]);
    char own[256] = "", name[300];
    gethostname(own, sizeof own - 1);
    snprintf(name, sizeof name, "%s.evil.example", own);
    TEST_ASSERT_FALSE_MESSAGE(access_host_is_local(name), name);
}

static void test_a_name_longer_than_dns_allows_is_refused(void)
{
    char host[600];
    for (size_t i = 0; i + 1 < sizeof host; i++)
        host[i] = '1';
    host[sizeof host - 1] = 0;
    TEST_ASSERT_FALSE(access_host_is_local(host));
}

static void test_our_page_has_the_origin_of_a_local_host(void)
{
    TEST_ASSERT_TRUE(access_is_our_page("127.0.0.1:8080", "http://127.0.0.1:8080"));
    TEST_ASSERT_TRUE(access_is_our_page("[::1]:8080", "http://[::1]:8080"));
    TEST_ASSERT_FALSE(access_is_our_page("127.0.0.1:8080", "http://127.0.0.1:8081"));
    TEST_ASSERT_FALSE(access_is_our_page("127.0.0.1:8080", "https://127.0.0.1:8080"));
    TEST_ASSERT_FALSE(access_is_our_page("127.0.0.1:8080", "http://127.0.0.1:8080/"));
    TEST_ASSERT_FALSE(access_is_our_page("127.0.0.1:8080", "null"));
    TEST_ASSERT_FALSE(access_is_our_page("evil.example", "http://evil.example"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_numeric_addresses_and_this_machine_are_local);
    RUN_TEST(test_other_names_and_malformed_hosts_are_not);
    RUN_TEST(test_a_name_longer_than_dns_allows_is_refused);
    RUN_TEST(test_our_page_has_the_origin_of_a_local_host);
    return UNITY_END();
}
