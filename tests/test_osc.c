// OSC over loopback: commands in, subscriptions out, and what a stranger cannot do.
#define _GNU_SOURCE
#include "himc/osc.h"
#include "osc_state.h"

#include <arpa/inet.h>
#include <lo/lo.h>
#include <netinet/in.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unity.h>
#include <unistd.h>

#define SEEN 4096

// allocations of this thread while `watching`; not under a sanitizer, which has its own
static _Thread_local bool watching;
static _Thread_local long taken;
#ifndef __SANITIZE_ADDRESS__
void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);

void *malloc(size_t size)
{
    taken += watching;
    return __libc_malloc(size);
}

void *calloc(size_t n, size_t size)
{
    taken += watching;
    return __libc_calloc(n, size);
}
#endif

// a message as it was received
typedef struct seen {
    char path[64];
    lo_message message;
    size_t packet; // bytes of the packet it came in
} seen;

// liblo's arguments lie at multiples of 4 bytes, whatever its union says
static const char *word(const lo_arg *arg)
{
    return (const char *)arg;
}

static float number(const lo_arg *arg)
{
    float value;
    memcpy(&value, arg, sizeof value);
    return value;
}

static int whole(const lo_arg *arg)
{
    int value;
    memcpy(&value, arg, sizeof value);
    return value;
}

static himc_osc *osc;
static himc_performance *performance;
static int ear, ear_port;
static seen heard[SEEN];
static int heard_count;

static void forget(void)
{
    while (heard_count > 0)
        lo_message_free(heard[--heard_count].message);
}

static int open_ear(int *port)
{
    struct sockaddr_in at = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t size = sizeof at;
    int fd = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0), large = 1 << 20;
    setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &large, sizeof large);
    bind(fd, (struct sockaddr *)&at, sizeof at);
    getsockname(fd, (struct sockaddr *)&at, &size);
    *port = ntohs(at.sin_port);
    return fd;
}

static void hear_element(char *data, size_t size, size_t packet)
{
    if (memcmp(data, "#bundle", 8) != 0) {
        lo_message m = lo_message_deserialise(data, size, NULL);
        TEST_ASSERT_NOT_NULL(m);
        if (heard_count == SEEN)
            forget();
        seen *s = &heard[heard_count++];
        snprintf(s->path, sizeof s->path, "%s", data);
        s->message = m;
        s->packet = packet;
        return;
    }
    for (size_t at = 16; at < size;) {
        uint32_t n;
        memcpy(&n, data + at, 4);
        n = ntohl(n);
        hear_element(data + at + 4, n, packet);
        at += 4 + n;
    }
}

static void hear(int fd)
{
    char data[65536];
    ssize_t size;
    while ((size = recv(fd, data, sizeof data, 0)) >= 0)
        hear_element(data, (size_t)size, (size_t)size);
}

static void rest(double seconds)
{
    nanosleep(&(struct timespec){(time_t)seconds, (long)(1e9 * (seconds - (time_t)seconds))}, NULL);
}

// plays in real time, listening
static void play(double seconds)
{
    himc_event event;
    for (int i = 0; i < seconds * 250; i++) {
        himc_osc_receive(osc, performance, 64);
        himc_performance_process(performance, 192, (double *[HIMC_HANDS]){NULL, NULL});
        while (himc_performance_event(performance, &event))
            himc_osc_event(osc, &event);
        himc_osc_publish(osc, performance, 1e-4);
        rest(0.003);
        hear(ear);
    }
}

static int count(const char *path)
{
    int n = 0;
    for (int i = 0; i < heard_count; i++)
        n += strcmp(heard[i].path, path) == 0;
    return n;
}

static const seen *last(const char *path)
{
    for (int i = heard_count - 1; i >= 0; i--)
        if (strcmp(heard[i].path, path) == 0)
            return &heard[i];
    return NULL;
}

static const char *last_error(void)
{
    const seen *s = last("/himc/error");
    return s ? word(lo_message_get_argv(s->message)[0]) : "";
}

static double status(const char *name)
{
    const seen *s = last("/himc/status");
    for (int i = 0; s && i + 1 < lo_message_get_argc(s->message); i += 2)
        if (strcmp(word(lo_message_get_argv(s->message)[i]), name) == 0)
            return number(lo_message_get_argv(s->message)[i + 1]);
    return -1;
}

// from the ear's own socket to the server
static void send_bytes(const void *data, size_t size)
{
    struct sockaddr_in to = {.sin_family = AF_INET,
                             .sin_addr.s_addr = htonl(INADDR_LOOPBACK),
                             .sin_port = htons((uint16_t)himc_osc_port(osc))};
    sendto(ear, data, size, 0, (struct sockaddr *)&to, sizeof to);
}

// "path types atom ..."
static void say(const char *path, const char *atoms)
{
    char words[512], data[2048], *state, *atom;
    size_t size = sizeof data;
    lo_message m = lo_message_new();
    snprintf(words, sizeof words, "%s", atoms);
    for (atom = strtok_r(words, " ", &state); atom; atom = strtok_r(NULL, " ", &state)) {
        char *end;
        double value = strtod(atom, &end);
        if (*end)
            lo_message_add_string(m, atom);
        else
            lo_message_add_float(m, (float)value);
    }
    lo_message_serialise(m, path, data, &size);
    send_bytes(data, size);
    lo_message_free(m);
}

static void subscribe(const char *what)
{
    char atoms[64];
    snprintf(atoms, sizeof atoms, "127.0.0.1 %d %s", ear_port, what);
    say("/himc/subscribe", atoms);
}

static void start(const himc_osc_config *config)
{
    himc_error error;
    himc_performance_config settings = himc_performance_default();
    performance = himc_performance_new(&settings, &error);
    himc_drum *drum = himc_drum_new("kettle", 23, 48000, &error);
    TEST_ASSERT_TRUE(himc_performance_add_drum(performance, drum, &error));
    himc_drum_release(drum);
    osc = himc_osc_new(config, &error);
    if (!osc)
        TEST_FAIL_MESSAGE(error.text);
    himc_performance_on_tick(performance, himc_osc_tick, osc);
}

void setUp(void)
{
    ear = open_ear(&ear_port);
    start(&(himc_osc_config){.port = 0});
}

void tearDown(void)
{
    himc_osc_free(osc);
    himc_performance_free(performance);
    close(ear);
    forget();
}

static void restart(const himc_osc_config *config)
{
    himc_osc_free(osc);
    himc_performance_free(performance);
    start(config);
}

static void test_pose_comes_33_times_a_second_with_20_bodies(void)
{
    subscribe("pose");
    play(0.2);
    forget();
    play(1);
    TEST_ASSERT_INT_WITHIN(20 * 5, 20 * 33, count("/himc/body"));
    const seen *s = last("/himc/body");
    TEST_ASSERT_EQUAL_STRING("sfffffff", lo_message_get_types(s->message));
    TEST_ASSERT_EQUAL_STRING("right-toes", word(lo_message_get_argv(s->message)[0]));
}

static void test_a_strike_asked_for_over_osc_comes_back_as_strike(void)
{
    subscribe("strikes");
    say("/himc/stroke", "2 right accent f rim");
    say("/himc/tempo", "240");
    say("/himc/play", "");
    play(2.2);
    TEST_ASSERT_EQUAL_INT(1, count("/himc/strike"));
    const seen *s = last("/himc/strike");
    lo_arg **a = lo_message_get_argv(s->message);
    TEST_ASSERT_EQUAL_STRING("fssfffffsiif", lo_message_get_types(s->message));
    TEST_ASSERT_EQUAL_STRING("right", word(a[1]));
    TEST_ASSERT_EQUAL_STRING("kettle", word(a[2]));
    TEST_ASSERT_TRUE(number(a[6]) > 5);
    TEST_ASSERT_EQUAL_STRING("accent", word(a[8]));
    TEST_ASSERT_EQUAL_INT(1, whole(a[9]));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, number(a[0]), (float)whole(a[10]) + number(a[11]));
    TEST_ASSERT_EQUAL_FLOAT(1, status("strikes"));
    TEST_ASSERT_TRUE(count("/himc/beat") >= 2);
    TEST_ASSERT_TRUE(count("/himc/status") >= 1);
}

static void test_head_sends_amplitudes_and_place_of_the_drum(void)
{
    subscribe("head 50");
    play(0.1);
    say("/membrane/kettle/strike", "0.1 0 2");
    play(0.5);
    const seen *s = last("/membrane/kettle/head");
    TEST_ASSERT_NOT_NULL(s);
    TEST_ASSERT_EQUAL_INT(64, lo_message_get_argc(s->message));
    TEST_ASSERT_TRUE(number(lo_message_get_argv(s->message)[0]) != 0);
    TEST_ASSERT_NOT_NULL(last("/membrane/kettle/place"));
}

static void test_a_drum_is_tuned_over_osc(void)
{
    himc_drum *drum = himc_performance_drum(performance, 0);
    say("/membrane/kettle/tune", "110");
    play(0.1);
    const himc_head *head = himc_membrane_head(himc_drum_membrane(drum));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 110, sqrt(head->tension / himc_head_tension_for(head, 1)));
}

static void test_errors_are_answered_with_the_parsers_line(void)
{
    himc_command command;
    himc_error error;
    say("/himc/stroke", "2 up accent f");
    play(0.1);
    himc_command_parse_text(&command, HIMC_PERFORMER, "stroke 2 up accent f", &error);
    TEST_ASSERT_EQUAL_STRING(error.text, last_error());
    say("/membrane/nowhere/tune", "110");
    play(0.1);
    TEST_ASSERT_NOT_NULL(strstr(last_error(), "nowhere: no drum"));
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

static void test_packets_off_loopback_stay_below_1400_bytes(void)
{
    osc_record r = {.kind = RECORD_POSE};
    osc_packets p;
    himc_osc_pack_begin(&p, SMALL_PACKET, true, 0);
    himc_osc_vmc_pose(&p, &r);
    TEST_ASSERT_TRUE(p.count >= 2 && p.count <= PACKETS);
    for (int i = 0; i < p.count; i++)
        TEST_ASSERT_TRUE(p.size[i] <= 1400);
}

static void test_time_tag_is_ntp_time(void)
{
    TEST_ASSERT_EQUAL_UINT64((uint64_t)(1 + 2208988800u) << 32 | 0x80000000u, himc_osc_tag(1.5));
}

// along the bones from the root, as a receiver does, to the left hand
static void test_vmc_bones_lead_to_the_wrist_mirrored(void)
{
    subscribe("vmc");
    play(0.3);
    static const char *const chain[] = {"Hips",         "Spine",        "Chest",   "LeftShoulder",
                                        "LeftUpperArm", "LeftLowerArm", "LeftHand"};
    himc_vec3 x = {0, 0, 0};
    himc_quat q = himc_quat_identity();
    for (int k = 0; k < 7; k++)
        for (int i = heard_count - 1; i >= 0; i--) {
            lo_arg **a = lo_message_get_argv(heard[i].message);
            if (strcmp(heard[i].path, "/VMC/Ext/Bone/Pos") != 0 ||
                strcmp(word(a[0]), chain[k]) != 0)
                continue;
            x = himc_vec3_add(
                x, himc_quat_rotate(q, (himc_vec3){number(a[1]), number(a[2]), number(a[3])}));
            q = himc_quat_mul(q,
                              (himc_quat){number(a[7]), number(a[4]), number(a[5]), number(a[6])});
            break;
        }
    subscribe("pose");
    play(0.1);
    for (int i = heard_count - 1; i >= 0; i--) {
        lo_arg **a = lo_message_get_argv(heard[i].message);
        if (strcmp(heard[i].path, "/himc/body") != 0 || strcmp(word(a[0]), "left-hand") != 0)
            continue;
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, -number(a[2]), x.x);
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, number(a[3]), x.y);
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, number(a[1]), x.z);
        return;
    }
    TEST_FAIL_MESSAGE("no left hand");
}

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

static void test_a_taken_port_gives_one_clear_line(void)
{
    himc_error error;
    himc_osc_config config = {.port = himc_osc_port(osc)};
    TEST_ASSERT_NULL(himc_osc_new(&config, &error));
    TEST_ASSERT_NOT_NULL(strstr(error.text, "taken"));
    config = (himc_osc_config){.bind = "192.0.2.7"};
    TEST_ASSERT_NULL(himc_osc_new(&config, &error));
    TEST_ASSERT_NOT_NULL(strstr(error.text, "192.0.2.7"));
}

static void test_a_receiver_that_vanishes_is_told_once_and_found_again(void)
{
    char line[HIMC_OSC_LINE], atoms[64];
    int port, other = open_ear(&port), lines = 0;
    snprintf(atoms, sizeof atoms, "127.0.0.1 %d pose", port);
    say("/himc/subscribe", atoms);
    play(0.2);
    close(other);
    play(0.4);
    while (himc_osc_line(osc, line))
        lines += strstr(line, "forgotten after 60 s") != NULL;
    TEST_ASSERT_EQUAL_INT(1, lines);
    TEST_ASSERT_EQUAL_INT(1, himc_osc_count(osc).subscriptions);
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
    int ears[64], port;
    char atoms[64];
    static const char *const what[] = {"pose", "targets", "strikes", "head"};
    for (int i = 0; i < 50; i++) {
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
    taken = 0;
    for (int i = 0; i < 1000; i++) {
        himc_performance_process(performance, 96, (double *[HIMC_HANDS]){NULL, NULL});
        watching = true;
        double begin = himc_osc_clock(CLOCK_MONOTONIC);
        himc_osc_receive(osc, performance, 8);
        if (i == 500)
            himc_osc_command(osc, &command, &error);
        while (himc_performance_event(performance, &event))
            himc_osc_event(osc, &event);
        himc_osc_publish(osc, performance, 0);
        himc_osc_line(osc, line);
        longest = fmax(longest, himc_osc_clock(CLOCK_MONOTONIC) - begin);
        watching = false;
    }
    TEST_ASSERT_EQUAL_INT(0, (int)taken);
    printf("audio side: longest call %.1f us\n", 1e6 * longest);
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
    int other_port, storm = open_ear(&other_port);
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
    RUN_TEST(test_pose_comes_33_times_a_second_with_20_bodies);
    RUN_TEST(test_a_strike_asked_for_over_osc_comes_back_as_strike);
    RUN_TEST(test_head_sends_amplitudes_and_place_of_the_drum);
    RUN_TEST(test_a_drum_is_tuned_over_osc);
    RUN_TEST(test_errors_are_answered_with_the_parsers_line);
    RUN_TEST(test_subscriptions_change_and_end_while_playing);
    RUN_TEST(test_packets_off_loopback_stay_below_1400_bytes);
    RUN_TEST(test_time_tag_is_ntp_time);
    RUN_TEST(test_vmc_bones_lead_to_the_wrist_mirrored);
    RUN_TEST(test_no_file_is_read_over_the_network_unless_allowed);
    RUN_TEST(test_files_outside_the_folder_are_refused_however_they_are_named);
    RUN_TEST(test_nobody_makes_it_send_to_a_third_host);
    RUN_TEST(test_a_taken_port_gives_one_clear_line);
    RUN_TEST(test_a_receiver_that_vanishes_is_told_once_and_found_again);
    RUN_TEST(test_an_unknown_name_of_a_host_stalls_nobody);
    RUN_TEST(test_200_subscriptions_are_served_and_the_257th_refused);
    RUN_TEST(test_our_own_addresses_are_never_answered);
    RUN_TEST(test_malformed_packets_are_counted);
    RUN_TEST(test_the_audio_side_never_allocates);
    RUN_TEST(test_a_full_ring_is_counted_and_stops_nobody);
    RUN_TEST(test_a_storm_is_counted_and_the_pose_goes_on);
    return UNITY_END();
}
