// OSC from strangers: packets they cannot make us send, malformed ones, floods.
#include "osc_ear.h"
#include "osc/network.h"
#include "system/ring.h"

#include "allocations.h"

static void test_no_stranger_directs_packets_to_a_third_host(void)
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
    others_hear = true;
    play(0.04);
    TEST_ASSERT_EQUAL_INT(1, himc_osc_count(osc).subscriptions);
}

static void test_no_stranger_removes_subscriptions_of_another_host(void)
{
    himc_command command;
    himc_error error;
    himc_command_parse_text(&command, HIMC_PERFORMER, "subscribe 192.0.2.1 9 vmc", &error);
    TEST_ASSERT_TRUE(himc_osc_command(osc, &command, &error));
    others_hear = true;
    play(0.1);
    say("/himc/unsubscribe", "192.0.2.1 9");
    play(0.1);
    AWAIT(strstr(last_error(), "expected your own address"));
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

// a tempo in bundles in bundles
static void say_nested(int bundles)
{
    static const char tempo[20] = "/himc/tempo\0,f\0\0\x42\xf0\0\0";
    char data[20 * 201];
    size_t size = 0;
    for (int i = bundles; i > 0; i--, size += 20) {
        uint32_t inside = htonl((uint32_t)(20 * i));
        memcpy(data + size, "#bundle\0\0\0\0\0\0\0\0\1", 16);
        memcpy(data + size + 16, &inside, 4);
    }
    memcpy(data + size, tempo, sizeof tempo);
    send_bytes(data, size + sizeof tempo);
    play(0.004);
}

static void test_bundles_are_at_most_four_deep(void)
{
    for (int bundles = 0; bundles <= 4; bundles++)
        say_nested(bundles);
    TEST_ASSERT_EQUAL_INT(5, himc_osc_count(osc).commands);
    TEST_ASSERT_EQUAL_INT(0, himc_osc_count(osc).malformed);
    say_nested(5);
    say_nested(200);
    TEST_ASSERT_EQUAL_INT(5, himc_osc_count(osc).commands);
    TEST_ASSERT_EQUAL_INT(2, himc_osc_count(osc).malformed);
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
    int taken_blocks = 0;
    others_hear = true;
    for (int i = 0; i < 1000; i++) {
        simulated += 0.002;
        himc_performance_process(performance, 96, (double *[HIMC_HANDS]){NULL, NULL});
        watch_allocations();
        himc_osc_receive(osc, performance, 8);
        if (i == 500)
            himc_osc_command(osc, &command, &error);
        while (himc_performance_event(performance, &event))
            himc_osc_event(osc, &event);
        himc_osc_publish(osc, performance, 0);
        himc_osc_line(osc, line);
        taken_blocks += allocations_seen();
        serve();
    }
    TEST_ASSERT_EQUAL_INT(0, taken_blocks);
}

// each look at the clock takes 3 ms, so each command 3 ms: of two seconds a tenth is for 66
// commands, and 16 more are for the 50 ms that may be taken at once
static void test_commands_take_a_tenth_of_the_time_at_most(void)
{
    settle();
    double begun = simulated;
    long before = himc_osc_count(osc).refused;
    while (simulated - begun < 2) {
        say("/membrane/nobody/tune", "110");
        settle();
        clock_step = 0.003;
        himc_osc_receive(osc, performance, 8);
        clock_step = 0;
        simulated += 0.004;
    }
    TEST_ASSERT_INT_WITHIN(3, 66 + 16, himc_osc_count(osc).refused - before);
}

// beyond what it may take at once, a command ends the block: two that take 3 ms each are not
// carried out in one
static void test_a_command_that_takes_long_is_the_last_of_its_block(void)
{
    for (int i = 0; i < 3; i++)
        say("/membrane/nobody/tune", "110");
    settle();
    clock_step = 0.003;
    for (int i = 1; i <= 3; i++) {
        himc_osc_receive(osc, performance, 8);
        TEST_ASSERT_EQUAL_INT(i, himc_osc_count(osc).refused);
    }
    clock_step = 0;
}

// 4000 points at once, then 1000 a second; `tempo` is 4 of them
static void test_commands_beyond_1000_points_a_second_are_counted(void)
{
    for (int i = 0; i < 1100; i++) {
        say("/himc/tempo", "120");
        settle();
        himc_osc_receive(osc, performance, 8);
    }
    TEST_ASSERT_EQUAL_INT(1000, himc_osc_count(osc).commands);
    TEST_ASSERT_EQUAL_INT(100, himc_osc_count(osc).frequent);
    simulated += 0.101;
    for (int i = 0; i < 30; i++)
        say("/himc/tempo", "120");
    settle();
    TEST_ASSERT_EQUAL_INT(1025, himc_osc_count(osc).commands);
    TEST_ASSERT_EQUAL_INT(105, himc_osc_count(osc).frequent);
}

static void test_strangers_get_50_answers_a_second(void)
{
    for (int second = 1; second <= 2; second++) {
        for (int i = 0; i < 60; i++)
            say("/himc/stroke", "2 up accent f");
        settle();
        TEST_ASSERT_EQUAL_INT(50 * second, count("/himc/error"));
        TEST_ASSERT_EQUAL_INT(60 * second, himc_osc_count(osc).refused);
        simulated += 1;
    }
}

// strokes whose dump is longer than an answer
static void load_strokes(int begun, int strokes)
{
    himc_error error;
    himc_stroke stroke = {.drum = "kettle", .dynamic = 0.5};
    for (int i = 0; i < strokes; i++) {
        stroke.beat = begun + i;
        TEST_ASSERT_TRUE_MESSAGE(himc_performance_add_stroke(performance, &stroke, &error),
                                 error.text);
    }
}

// packets that so many dumps bring; the clock stands still
static long ask_for_dumps(int dumps)
{
    long before = himc_osc_count(osc).sent;
    forget();
    for (int i = 0; i < dumps; i++) {
        say("/himc/dump", "");
        settle();
        himc_osc_receive(osc, performance, 8);
        serve();
        settle();
    }
    return himc_osc_count(osc).sent - before;
}

static bool ends_with_a_cut(void)
{
    return heard_count > 0 && last("/himc/error") == &heard[heard_count - 1] &&
           strstr(last_error(), "cut after");
}

// for subscriptions and answers (Makefile): true makes the ear a host elsewhere
static bool elsewhere;
bool __real_himc_osc_address_loopback(const osc_address *a);
bool __wrap_himc_osc_address_loopback(const osc_address *a);

bool __wrap_himc_osc_address_loopback(const osc_address *a)
{
    return !elsewhere && __real_himc_osc_address_loopback(a);
}

static void listen_to_all(const char *allow)
{
    restart(&(himc_osc_config){.bind = "::", .allow = allow});
    elsewhere = true;
}

// its packets come to a socket of both families as from ::ffff:127.0.0.1
static void test_this_machine_is_no_stranger_at_a_socket_of_both_families(void)
{
    restart(&(himc_osc_config){.bind = "::"});
    load_strokes(0, 200);
    TEST_ASSERT_GREATER_THAN(200, ask_for_dumps(1));
    TEST_ASSERT_EQUAL_INT(0, count("/himc/error"));
    char wanted[64];
    snprintf(wanted, sizeof wanted, "127.0.0.1 %d strikes", ear_port);
    say("/himc/subscribe", wanted);
    settle();
    serve();
    TEST_ASSERT_EQUAL_INT(1, himc_osc_count(osc).subscriptions);
    simulated += 1000;
    serve();
    TEST_ASSERT_EQUAL_INT(1, himc_osc_count(osc).subscriptions);
}

// 1024 packets for one of 16 bytes, before
static void test_a_stranger_pays_for_each_line_of_a_dump(void)
{
    listen_to_all(NULL);
    load_strokes(0, 2000);
    for (int second = 0; second < 3; second++) {
        long sent = ask_for_dumps(1);
        TEST_ASSERT_TRUE(ends_with_a_cut());
        sent += ask_for_dumps(31);
        TEST_ASSERT_TRUE_MESSAGE(sent > 40 && sent <= 50, "50 lines a second");
        simulated += 1;
    }
}

static void test_a_long_dump_to_a_friend_ends_with_an_error(void)
{
    long whole = ask_for_dumps(1);
    TEST_ASSERT_EQUAL_INT(0, count("/himc/error"));
    load_strokes(0, 500);
    TEST_ASSERT_EQUAL_INT(whole + 500, ask_for_dumps(1));
    TEST_ASSERT_EQUAL_INT(0, count("/himc/error"));
    load_strokes(500, 20000);
    TEST_ASSERT_GREATER_THAN(whole + 500, ask_for_dumps(1));
    TEST_ASSERT_TRUE(ends_with_a_cut());
    TEST_ASSERT_EQUAL_INT(0, himc_osc_count(osc).lost);
}

// a block of the host has time for a part of it; what comes behind it waits
static void test_a_long_dump_is_told_in_parts(void)
{
    int blocks = 1;
    load_strokes(0, 500);
    long whole = ask_for_dumps(1), before = himc_osc_count(osc).sent;
    clock_step = 6e-5;
    say("/himc/dump", "");
    say("/himc/clear", "");
    settle();
    for (; himc_osc_count(osc).sent < before + whole; blocks++) {
        TEST_ASSERT_LESS_THAN(100, blocks);
        himc_osc_receive(osc, performance, 8);
        serve();
    }
    clock_step = 0;
    TEST_ASSERT_GREATER_THAN(3, blocks);
    himc_osc_receive(osc, performance, 8);
    TEST_ASSERT_LESS_THAN(whole - 499, ask_for_dumps(1)); // it has been cleared, after its dump
}

// also one of --allow gets no more than 500 kB a second, an eighth of a megabyte at once
static void test_dumps_are_within_the_bytes_of_a_host(void)
{
    listen_to_all("127.0.0.1");
    load_strokes(0, 900);
    long whole = ask_for_dumps(1);
    TEST_ASSERT_GREATER_THAN(900, whole);
    for (int i = 0; i < 40 && himc_osc_count(osc).capped == 0; i++) {
        long sent = ask_for_dumps(1);
        TEST_ASSERT_TRUE(sent == whole || ends_with_a_cut());
    }
    TEST_ASSERT_GREATER_THAN(0, himc_osc_count(osc).capped);
    TEST_ASSERT_EQUAL_INT(0, ask_for_dumps(1));
    simulated += 0.25;
    TEST_ASSERT_EQUAL_INT(whole, ask_for_dumps(1));
}

static void test_refusals_are_told_once_and_sent_to_their_subscribers(void)
{
    int port = 0, other = open_ear(&port), lines = 0;
    char line[HIMC_OSC_LINE], atoms[64];
    snprintf(atoms, sizeof atoms, "127.0.0.1 %d errors", port);
    others_hear = true;
    say("/himc/subscribe", atoms);
    for (int i = 0; i < 3; i++) {
        say("/himc/stroke", "2 up accent f"); // the parser refuses
        say("/himc/gain", "finger 3 1");      // the performer does
        play(0.1);
    }
    while (himc_osc_line(osc, line))
        lines += strstr(line, "refused: stroke: HAND: up") ||
                 strstr(line, "refused: gain: JOINT: finger");
    TEST_ASSERT_EQUAL_INT(2, lines);
    TEST_ASSERT_EQUAL_INT(6, count("/himc/error"));
    forget();
    wait_and_hear(other);
    TEST_ASSERT_EQUAL_INT(6, count("/himc/error"));
    TEST_ASSERT_EQUAL_INT(0, count("/himc/body"));
    close(other);
}

// as when the network thread stands still
static void test_a_full_ring_is_counted_and_blocks_no_call(void)
{
    system_ring ring = {0};
    int *slot;
    TEST_ASSERT_TRUE(himc_ring_init(&ring, sizeof(int), 4));
    for (int i = 0; i < 6; i++)
        if ((slot = himc_ring_slot(&ring))) {
            *slot = i;
            himc_ring_push(&ring);
        }
    TEST_ASSERT_EQUAL_INT(2, (int)ring.lost);
    for (int i = 0; i < 4; i++) {
        TEST_ASSERT_EQUAL_INT(i, *(const int *)himc_ring_peek(&ring));
        himc_ring_pop(&ring);
    }
    TEST_ASSERT_NULL(himc_ring_peek(&ring));
    himc_ring_free(&ring);
}

static uint32_t seed;

// valid, malformed and random bytes in turn; a valid one is a tempo
static size_t storm_packet(char data[64], int i)
{
    size_t size = 20;
    if (i % 3 == 0)
        memcpy(data, "/himc/tempo\0,f\0\0\x42\xf0\0\0", 20);
    else
        for (size = 0; size < (i % 3 == 1 ? 20 : seed % 64); size++)
            data[size] = (char)((seed = seed * 1664525 + 1013904223) >> 24);
    if (i % 3 == 1)
        memcpy(data, "/himc/tempo\0,f\0\0", 16);
    return size;
}

static void send_to(int port)
{
    struct sockaddr_in to = {.sin_family = AF_INET,
                             .sin_addr.s_addr = htonl(INADDR_LOOPBACK),
                             .sin_port = htons((uint16_t)port)};
    said += sendto(ear, "", 1, 0, (struct sockaddr *)&to, sizeof to) >= 0;
}

// the system reports the losses of a socket with the next packet that this one takes; then all are
// counted. `port`: of another socket of ours, or 0
static void count_all(int port)
{
    for (int i = 0; taken() < said; i++) {
        TEST_ASSERT_TRUE_MESSAGE(i < 100, "not all is counted");
        simulated += 1;
        say("/himc/stop", "");
        if (port)
            send_to(port);
        for (int k = 0; k < 200 && taken() < said; k++) {
            serve();
            himc_osc_receive(osc, performance, 64);
            rest(1e-4);
        }
    }
    TEST_ASSERT_EQUAL_INT(said, taken());
}

// 100,000 packets a second for two: 8000 at once and 8000 a second are read
static void test_a_storm_is_counted_and_poses_continue(void)
{
    enum { BLOCKS = 500, BURST = 400 };
    char data[64];
    seed = 1;
    subscribe("pose");
    play(0.04);
    himc_osc_counts before = himc_osc_count(osc);
    double begun = simulated;
    for (int block = 0; block < BLOCKS; block++) {
        for (int i = 0; i < BURST; i++) {
            send_bytes(data, storm_packet(data, i));
            // no more than the socket and the ring take, as long as packets are read
            if (i % 100 == 99) {
                serve();
                himc_osc_receive(osc, performance, 64);
            }
        }
        play_block();
        serve();
    }
    himc_osc_counts c = himc_osc_count(osc);
    double seconds = simulated - begun, read = 8000 + 8000 * seconds;
    TEST_ASSERT_INT_WITHIN(0.01 * read, read, c.packets);
    TEST_ASSERT_TRUE(c.frequent > 0 && c.malformed > 0 && c.commands > 0 && c.refused > 0);
    // of the packets read a third is valid, of which the points are the limit
    double obeyed = (4000 + 1000 * seconds) / 4;
    TEST_ASSERT_INT_WITHIN(0.01 * obeyed, obeyed, c.commands - before.commands);
    TEST_ASSERT_TRUE(count("/himc/body") > 20 * 20);
    count_all(0);
    TEST_ASSERT_TRUE(himc_osc_count(osc).overrun > BLOCKS * BURST - 2 * read);
    play(1.2);
    TEST_ASSERT_EQUAL_FLOAT(himc_osc_count(osc).overrun, status("overrun"));
}

static void send_tempi(int count)
{
    char data[64];
    for (int i = 0; i < count; i++)
        send_bytes(data, storm_packet(data, 0));
}

static void test_the_reader_yields_when_it_has_taken_its_share(void)
{
    for (int i = 0; i < 80; i++) {
        send_tempi(100);
        settle();
        himc_osc_receive(osc, performance, 64);
    }
    send_tempi(100);
    for (int i = 0; i < 100; i++)
        TEST_ASSERT_TRUE(himc_osc_step(osc));
    TEST_ASSERT_EQUAL_INT(8000, himc_osc_count(osc).packets);
    simulated += 0.00101;
    for (int i = 0; i < 100; i++)
        TEST_ASSERT_TRUE(himc_osc_step(osc));
    TEST_ASSERT_EQUAL_INT(8008, himc_osc_count(osc).packets);
    simulated += 1;
    settle();
    TEST_ASSERT_FALSE(himc_osc_step(osc));
    TEST_ASSERT_EQUAL_INT(8100, himc_osc_count(osc).packets);
    TEST_ASSERT_EQUAL_INT(0, himc_osc_count(osc).overrun);
}

// the port of our socket for sending: a UDP socket of this process that is not bound to 127.0.0.1
static int sending_port(void)
{
    for (int fd = 3; fd < 64; fd++) {
        struct sockaddr_in at_any;
        socklen_t size = sizeof at_any;
        if (fd != ear && getsockname(fd, (struct sockaddr *)&at_any, &size) == 0 &&
            at_any.sin_family == AF_INET && at_any.sin_addr.s_addr == htonl(INADDR_ANY))
            return ntohs(at_any.sin_port);
    }
    return 0;
}

// the socket for sending is read from the same share, and its losses are counted apart
static void test_packets_to_the_socket_for_sending_are_counted_too(void)
{
    restart(&(himc_osc_config){.allow = "192.0.2.1"});
    say("/himc/subscribe", "192.0.2.1 9 pose");
    others_hear = true;
    play(0.1);
    int port = sending_port();
    TEST_ASSERT_TRUE(port > 0);
    long foreign = himc_osc_count(osc).foreign;
    send_tempi(4000);
    for (int i = 0; i < 4000; i++)
        send_to(port);
    count_all(port);
    TEST_ASSERT_TRUE(himc_osc_count(osc).overrun > 0);
    TEST_ASSERT_TRUE(himc_osc_count(osc).foreign > foreign + 100);
}

static void test_packets_lost_in_the_system_are_counted(void)
{
    send_tempi(3000);
    count_all(0);
    TEST_ASSERT_TRUE(himc_osc_count(osc).overrun > 0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_no_stranger_directs_packets_to_a_third_host);
    RUN_TEST(test_no_stranger_removes_subscriptions_of_another_host);
    RUN_TEST(test_our_own_addresses_are_never_answered);
    RUN_TEST(test_malformed_packets_are_counted);
    RUN_TEST(test_bundles_are_at_most_four_deep);
    RUN_TEST(test_the_audio_side_never_allocates);
    RUN_TEST(test_commands_take_a_tenth_of_the_time_at_most);
    RUN_TEST(test_a_command_that_takes_long_is_the_last_of_its_block);
    RUN_TEST(test_commands_beyond_1000_points_a_second_are_counted);
    RUN_TEST(test_strangers_get_50_answers_a_second);
    RUN_TEST(test_this_machine_is_no_stranger_at_a_socket_of_both_families);
    RUN_TEST(test_a_long_dump_is_told_in_parts);
    RUN_TEST(test_a_long_dump_to_a_friend_ends_with_an_error);
    RUN_TEST(test_refusals_are_told_once_and_sent_to_their_subscribers);
    RUN_TEST(test_a_full_ring_is_counted_and_blocks_no_call);
    RUN_TEST(test_a_storm_is_counted_and_poses_continue);
    RUN_TEST(test_the_reader_yields_when_it_has_taken_its_share);
    RUN_TEST(test_packets_to_the_socket_for_sending_are_counted_too);
    RUN_TEST(test_packets_lost_in_the_system_are_counted);
    // from here on the ear is elsewhere
    RUN_TEST(test_a_stranger_pays_for_each_line_of_a_dump);
    RUN_TEST(test_dumps_are_within_the_bytes_of_a_host);
    return UNITY_END();
}
