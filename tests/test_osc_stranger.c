// OSC from strangers: what they cannot read, write or make us send, and floods of it.
#include "osc_ear.h"

#include "allocations.h"

static void test_no_file_is_read_over_the_network_unless_allowed(void)
{
    say("/himc/score", "patches/improvisation.txt");
    play(0.1);
    TEST_ASSERT_NOT_NULL(strstr(last_error(), "--files"));
}

static void test_files_outside_the_folder_are_refused_however_they_are_named(void)
{
    char folder[] = "/tmp/himc-osc-XXXXXX", path[128];
    TEST_ASSERT_NOT_NULL(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/good.txt", folder);
    FILE *f = fopen(path, "w");
    fputs("stroke 1 left accent f;\n", f);
    fclose(f);
    snprintf(path, sizeof path, "%s/link.txt", folder);
    TEST_ASSERT_EQUAL_INT(0, symlink("/etc/passwd", path));
    restart(&(himc_osc_config){.files = folder});
    static const char *const bad[] = {
        "/etc/passwd", "../../etc/passwd", "link.txt",   "good.txt/../../x",
        ".",           "/dev/zero",        "missing.txt"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        forget();
        say("/himc/score", bad[i]);
        say("/himc/take", bad[i]);
        play(0.04);
        TEST_ASSERT_EQUAL_INT_MESSAGE(2, count("/himc/error"), bad[i]);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(last_error(), "no such file in the folder"), bad[i]);
    }
    forget();
    rest(0.3); // files are for twice a second
    say("/himc/score", "good.txt");
    play(0.1);
    TEST_ASSERT_EQUAL_STRING("", last_error());
    unlink(path);
    snprintf(path, sizeof path, "%s/good.txt", folder);
    unlink(path);
    rmdir(folder);
}

static void test_nobody_makes_it_send_to_a_third_host(void)
{
    static const char *const bad[] = {"192.0.2.1 9 pose", "example.org 9 pose",
                                      "::1%lo 9 pose",    "255.255.255.255 9 pose",
                                      "224.0.0.1 9 vmc",  "0.0.0.0 9 pose"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        forget();
        say("/himc/subscribe", bad[i]);
        play(0.04);
        TEST_ASSERT_EQUAL_INT_MESSAGE(1, count("/himc/error"), bad[i]);
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, himc_osc_count(osc).subscriptions, bad[i]);
    }
    restart(&(himc_osc_config){.allow = "192.0.2.1"});
    say("/himc/subscribe", bad[0]);
    play(0.04);
    TEST_ASSERT_EQUAL_INT(1, himc_osc_count(osc).subscriptions);
}

static void test_no_file_is_written_or_read_by_other_commands(void)
{
    static const char *const bad[][2] = {{"/himc/record", "/tmp/himc-osc-stranger.bvh"},
                                         {"/himc/record", "himc-osc-stranger.c3d"},
                                         {"/himc/units", "patches/improvisation.txt legato"},
                                         {"/membrane/kettle/shape", "/etc/passwd"}};
    restart(&(himc_osc_config){.files = "."});
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        forget();
        say(bad[i][0], bad[i][1]);
        play(0.04);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(last_error(), "not over the network"), bad[i][1]);
    }
    say("/himc/record", "stop");
    play(0.04);
    TEST_ASSERT_EQUAL_INT(-1, access("/tmp/himc-osc-stranger.bvh", F_OK));
    TEST_ASSERT_EQUAL_INT(-1, access("himc-osc-stranger.c3d", F_OK));
}

static void test_nobody_removes_what_another_host_subscribed(void)
{
    himc_command command;
    himc_error error;
    himc_command_parse_text(&command, HIMC_PERFORMER, "subscribe 192.0.2.1 9 vmc", &error);
    TEST_ASSERT_TRUE(himc_osc_command(osc, &command, &error));
    play(0.1);
    say("/himc/unsubscribe", "192.0.2.1 9");
    play(0.1);
    TEST_ASSERT_NOT_NULL(strstr(last_error(), "allowed is your own address"));
    TEST_ASSERT_EQUAL_INT(1, himc_osc_count(osc).subscriptions);
}

static void test_our_own_addresses_are_never_answered(void)
{
    say("/himc/error", "hello");
    say("/himc/status", "1");
    say("/himc/info", "hello");
    play(0.1);
    TEST_ASSERT_EQUAL_INT(0, heard_count);
    TEST_ASSERT_EQUAL_INT(3, (int)himc_osc_count(osc).foreign);
}

static void test_malformed_packets_are_counted(void)
{
    static const char bundle[24] = "#bundle\0\0\0\0\0\0\0\0\1\x7f\xff\xff\xff";
    send_bytes("/him", 4);
    send_bytes("garbage!", 8);
    send_bytes(bundle, sizeof bundle);
    send_bytes("/himc/play\0\0,b\0\0\xff\xff\xff\xff", 20);
    send_bytes("abc", 3);
    say("/elsewhere", "1");
    play(0.1);
    himc_osc_counts c = himc_osc_count(osc);
    TEST_ASSERT_EQUAL_INT(5, (int)c.malformed);
    TEST_ASSERT_EQUAL_INT(1, (int)c.foreign);
    TEST_ASSERT_EQUAL_INT(0, (int)c.commands);
}

static void test_the_audio_side_never_allocates(void)
{
    himc_event event;
    himc_command command;
    himc_error error;
    char line[HIMC_OSC_LINE];
    subscribe("pose 250");
    subscribe("strikes");
    subscribe("head 250");
    subscribe("vmc");
    say("/himc/stroke", "1 left accent f");
    say("/himc/play", "");
    play(0.3);
    himc_command_parse_text(&command, HIMC_PERFORMER, "subscribe localhost 9 targets", &error);
    double longest = 0;
    int taken = 0;
    for (int i = 0; i < 1000; i++) {
        himc_performance_process(performance, 96, (double *[HIMC_HANDS]){NULL, NULL});
        watch_allocations();
        double begin = himc_osc_clock(CLOCK_MONOTONIC);
        himc_osc_receive(osc, performance, 8);
        if (i == 500)
            himc_osc_command(osc, &command, &error);
        while (himc_performance_event(performance, &event))
            himc_osc_event(osc, &event);
        himc_osc_publish(osc, performance, 0);
        himc_osc_line(osc, line);
        longest = fmax(longest, himc_osc_clock(CLOCK_MONOTONIC) - begin);
        taken += allocations_seen();
    }
    TEST_ASSERT_EQUAL_INT(0, taken);
    printf("audio side: longest call %.1f us\n", 1e6 * longest);
}

static void test_commands_take_a_tenth_of_the_time_at_most(void)
{
    double begin = himc_osc_clock(CLOCK_MONOTONIC), spent = 0, longest = 0, now = begin;
    say("/membrane/kettle/modes", "2000");
    for (int i = 0; now - begin < 1.5; i++) {
        say("/membrane/kettle/tune", i % 2 ? "110" : "120");
        rest(0.002);
        double before = himc_osc_clock(CLOCK_MONOTONIC);
        himc_osc_receive(osc, performance, 8);
        now = himc_osc_clock(CLOCK_MONOTONIC);
        spent += now - before;
        longest = fmax(longest, now - before);
    }
    TEST_ASSERT_TRUE(longest > 0.001);
    TEST_ASSERT_TRUE(spent < 0.05 + 0.1 * (now - begin) + longest);
}

// the network thread stands still: the rings fill, are counted, and the host goes on
static void test_a_full_ring_is_counted_and_stops_nobody(void)
{
    osc_ring ring = {0};
    int *slot;
    TEST_ASSERT_TRUE(himc_osc_ring_init(&ring, sizeof(int), 4));
    for (int i = 0; i < 6; i++)
        if ((slot = himc_osc_ring_slot(&ring))) {
            *slot = i;
            himc_osc_ring_push(&ring);
        }
    TEST_ASSERT_EQUAL_INT(2, (int)ring.lost);
    for (int i = 0; i < 4; i++) {
        TEST_ASSERT_EQUAL_INT(i, *(const int *)himc_osc_ring_peek(&ring));
        himc_osc_ring_pop(&ring);
    }
    TEST_ASSERT_NULL(himc_osc_ring_peek(&ring));
    free(ring.data);
}

// valid, malformed and random bytes as fast as they go, all counted, the pose still coming
static void test_a_storm_is_counted_and_the_pose_goes_on(void)
{
    uint32_t seed = 1;
    char data[64];
    double seconds = getenv("HIMC_LONG") ? 60 : 2, begin = himc_osc_clock(CLOCK_MONOTONIC), now;
    long sent = 0;
    int other_port = 0, storm = open_ear(&other_port);
    struct sockaddr_in to = {.sin_family = AF_INET,
                             .sin_addr.s_addr = htonl(INADDR_LOOPBACK),
                             .sin_port = htons((uint16_t)himc_osc_port(osc))};
    subscribe("pose");
    while ((now = himc_osc_clock(CLOCK_MONOTONIC)) - begin < seconds) {
        for (int i = 0; i < 400; i++) {
            size_t size = 20;
            if (i % 3 == 0)
                memcpy(data, "/himc/tempo\0,f\0\0\x42\xf0\0\0", 20);
            else
                for (size = 0; size < (i % 3 == 1 ? 20 : seed % 64); size++)
                    data[size] = (char)((seed = seed * 1664525 + 1013904223) >> 24);
            if (i % 3 == 1)
                memcpy(data, "/himc/tempo\0,f\0\0", 16);
            sent += sendto(storm, data, size, 0, (struct sockaddr *)&to, sizeof to) >= 0;
        }
        play(0.004);
    }
    play(1.2);
    say("/himc/stop", ""); // what the system lost is told with the next packet
    play(0.1);
    himc_osc_counts c = himc_osc_count(osc);
    TEST_ASSERT_TRUE(c.packets + c.overrun >= sent);
    TEST_ASSERT_TRUE(c.frequent > 0 && c.malformed > 0 && c.commands > 0 && c.refused > 0);
    TEST_ASSERT_TRUE(count("/himc/body") > 20 * 20);
    TEST_ASSERT_TRUE(status("frequent") > 0);
    printf("storm: %.0f packets/s sent, %ld taken, %ld lost in the system, %ld too frequent\n",
           (double)sent / seconds, c.packets, c.overrun, c.frequent);
    close(storm);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_no_file_is_read_over_the_network_unless_allowed);
    RUN_TEST(test_files_outside_the_folder_are_refused_however_they_are_named);
    RUN_TEST(test_nobody_makes_it_send_to_a_third_host);
    RUN_TEST(test_no_file_is_written_or_read_by_other_commands);
    RUN_TEST(test_nobody_removes_what_another_host_subscribed);
    RUN_TEST(test_our_own_addresses_are_never_answered);
    RUN_TEST(test_malformed_packets_are_counted);
    RUN_TEST(test_the_audio_side_never_allocates);
    RUN_TEST(test_commands_take_a_tenth_of_the_time_at_most);
    RUN_TEST(test_a_full_ring_is_counted_and_stops_nobody);
    RUN_TEST(test_a_storm_is_counted_and_the_pose_goes_on);
    return UNITY_END();
}
