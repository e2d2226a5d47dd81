// OSC over loopback: commands in, poses, strikes and heads out.
#include "osc_ear.h"
#include "himc/body.h"
#include "himc/membrane.h"
#include "osc/encode.h"
#include "system/udp.h"
#include "drum/drum_state.h"
#include "performance/performance_state.h"

#include <fcntl.h>

static void test_pose_comes_33_times_a_second_with_20_bodies(void)
{
    subscribe("pose");
    play(0.2);
    forget();
    play(1);
    TEST_ASSERT_INT_WITHIN(20, 20 * 33, count("/himc/body"));
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
    TEST_ASSERT_INT_WITHIN(1, 2, count("/himc/status"));
}

// each block of 4 ms took 0.1 ms to compute
static void test_load_is_the_share_of_real_time_that_was_computed(void)
{
    subscribe("strikes");
    play(2.1);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 0.025f, status("load"));
}

// the sound began at EPOCH + begun, and the strike's time is counted from there
static void test_the_time_tag_of_a_strike_is_its_time_on_the_wall_clock(void)
{
    double begun = simulated;
    subscribe("strikes");
    say("/himc/stroke", "1 right accent f");
    say("/himc/tempo", "240");
    say("/himc/play", "");
    play(2);
    const seen *s = last("/himc/strike");
    TEST_ASSERT_NOT_NULL(s);
    lo_arg **a = lo_message_get_argv(s->message);
    double time = whole(a[10]) + (double)number(a[11]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, EPOCH + begun + time, wall_of(s));
}

// a performance that has gone on for a day, and for longer than 32 bits of seconds
static void test_time_tags_hold_across_2_to_the_32_and_50_samples(void)
{
    static const double seconds[] = {89478, 23456248059.0}; // to just before 2^32 and 2^50 samples
    for (int i = 0; i < 2; i++) {
        restart(&(himc_osc_config){.port = 0});
        performance->clock.made = performance->clock.played = (int64_t)seconds[i] * 48000;
        performance->clock.step = (int64_t)seconds[i] * 10000;
        performance->drums.slot[0].drum->time = (uint64_t)performance->clock.made;
        double begun = simulated;
        subscribe("strikes");
        say("/himc/hit", "right accent f");
        play(2);
        const seen *s = last("/himc/strike");
        TEST_ASSERT_NOT_NULL(s);
        lo_arg **a = lo_message_get_argv(s->message);
        double time = whole(a[10]) + (double)number(a[11]) - fmod(seconds[i], 2147483648.0);
        TEST_ASSERT_TRUE(time > 0.1 && time < 2);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, EPOCH + begun + time, wall_of(s));
    }
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
    const himc_membrane *membrane = himc_drum_membrane(drum);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 110,
                              himc_membrane_principal(membrane, himc_membrane_head(membrane)));
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

static void test_packets_off_loopback_stay_below_1400_bytes(void)
{
    osc_pose pose = {0};
    osc_packets p;
    himc_osc_encode_begin(&p, SMALL_PACKET, true, 0);
    himc_osc_encode_vmc_pose(&p, &pose, 0);
    TEST_ASSERT_TRUE(p.count >= 2 && p.count <= PACKETS);
    for (int i = 0; i < p.count; i++)
        TEST_ASSERT_TRUE(p.size[i] <= 1400);
}

static void test_a_push_begins_when_it_arrives_and_ends(void)
{
    static const double force[] = {40, 0};
    say("/himc/push", "left-forearm 0 0 40 0.2");
    for (int i = 0; i < 2; i++) {
        play(0.15);
        TEST_ASSERT_EQUAL_DOUBLE(
            force[i],
            himc_body_pushed(performance->body, HIMC_LEFT_FOREARM, step_time(performance)).force.z);
    }
    subscribe("errors");
    say("/himc/push", "nobody 0 0 40 0.2");
    play(0.1);
    TEST_ASSERT_NOT_NULL(strstr(last_error(), "push: SEGMENT: nobody, expected"));
}

static void test_time_tag_is_ntp_time(void)
{
    TEST_ASSERT_EQUAL_UINT64((uint64_t)(1 + 2208988800u) << 32 | 0x80000000u,
                             himc_osc_time_tag(1.5));
}

static void test_a_hit_that_no_hand_plays_is_missed_at_beat_minus_1(void)
{
    subscribe("strikes");
    for (int i = 0; i < 40; i++)
        say("/himc/hit", "left legato f");
    play(2);
    TEST_ASSERT_TRUE(count("/himc/missed") > 0);
    TEST_ASSERT_EQUAL_FLOAT(-1, number(lo_message_get_argv(last("/himc/missed")->message)[0]));
}

// along the bones from the root, as a receiver does, to the left hand
static void test_vmc_bones_lead_to_the_wrist_mirrored(void)
{
    subscribe("vmc");
    play(0.3);
    static const char *const chain[] = {"Hips",         "Spine",        "Chest",   "LeftShoulder",
                                        "LeftUpperArm", "LeftLowerArm", "LeftHand"};
    himc_vec3 x = {0, 0, 0}, step[7] = {{0}};
    himc_quat q = himc_quat_identity();
    for (int k = 0; k < 7; k++)
        for (int i = heard_count - 1; i >= 0; i--) {
            lo_arg **a = lo_message_get_argv(heard[i].message);
            if (strcmp(heard[i].path, "/VMC/Ext/Bone/Pos") != 0 ||
                strcmp(word(a[0]), chain[k]) != 0)
                continue;
            step[k] = himc_quat_rotate(q, (himc_vec3){number(a[1]), number(a[2]), number(a[3])});
            x = himc_vec3_add(x, step[k]);
            q = himc_quat_mul(q,
                              (himc_quat){number(a[7]), number(a[4]), number(a[5]), number(a[6])});
            break;
        }
    // the shoulder lies before the arm's joint, on the way to it
    TEST_ASSERT_TRUE(himc_vec3_dot(step[3], step[4]) > 0);
    TEST_ASSERT_TRUE(himc_vec3_length(step[4]) < himc_vec3_length(step[3]));
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

// a program that was started without a standard input has the descriptor 0 to give
static void test_a_socket_may_be_descriptor_0(void)
{
    int input = dup(0);
    close(0);
    int socket = himc_udp_open(AF_INET, 65536);
    TEST_ASSERT_EQUAL_INT(0, socket);
    himc_udp_close(socket);
    dup2(input, 0);
    close(input);
}

// a browser or a player that the program starts does not keep its port
static void test_a_socket_is_not_inherited_by_another_program(void)
{
    int socket = himc_udp_open(AF_INET, 65536);
    TEST_ASSERT_EQUAL_INT(FD_CLOEXEC, fcntl(socket, F_GETFD) & FD_CLOEXEC);
    himc_udp_close(socket);
}

static void test_waiting_ends_with_a_packet_and_not_before_its_time_without(void)
{
    himc_udp_address to = {
        .v4 = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)}};
    socklen_t size = sizeof to.v4;
    int sockets[] = {himc_udp_open(AF_INET, 65536), himc_udp_open(AF_INET, 65536)};
    TEST_ASSERT_TRUE(himc_udp_bind(sockets[0], &to, size) && himc_udp_bind(sockets[1], &to, size));
    double begun = system_seconds();
    himc_udp_wait(sockets, 2, 30);
    TEST_ASSERT_TRUE(system_seconds() - begun > 0.029);
    for (int i = 0; i < 2; i++) {
        TEST_ASSERT_EQUAL_INT(0, getsockname(sockets[i], &to.any, &size));
        TEST_ASSERT_EQUAL_INT(1, himc_udp_send(sockets[1 - i], &to, size, "x", 1));
        begun = system_seconds();
        himc_udp_wait(sockets, 2, 100000);
        TEST_ASSERT_TRUE(system_seconds() - begun < PATIENCE);
        char byte;
        TEST_ASSERT_EQUAL_INT(1, himc_udp_receive(sockets[i], &to, &byte, 1, &(uint32_t){0}));
    }
    himc_udp_close(sockets[0]);
    himc_udp_close(sockets[1]);
}

// the only test with the network thread and the clock of the system
static void test_the_network_thread_serves_a_subscription(void)
{
    himc_error error;
    himc_osc_free(osc);
    osc = himc_osc_new(&(himc_osc_config){.port = 0}, &error);
    TEST_ASSERT_NOT_NULL(osc);
    himc_performance_on_tick(performance, himc_osc_tick, osc);
    subscribe("pose");
    for (double begun = system_seconds(); !last("/himc/body") || !last("/himc/status");) {
        TEST_ASSERT_TRUE(system_seconds() - begun < PATIENCE);
        play_block();
        rest(0.003);
        hear(ear);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_pose_comes_33_times_a_second_with_20_bodies);
    RUN_TEST(test_a_strike_asked_for_over_osc_comes_back_as_strike);
    RUN_TEST(test_load_is_the_share_of_real_time_that_was_computed);
    RUN_TEST(test_the_time_tag_of_a_strike_is_its_time_on_the_wall_clock);
    RUN_TEST(test_time_tags_hold_across_2_to_the_32_and_50_samples);
    RUN_TEST(test_head_sends_amplitudes_and_place_of_the_drum);
    RUN_TEST(test_a_drum_is_tuned_over_osc);
    RUN_TEST(test_errors_are_answered_with_the_parsers_line);
    RUN_TEST(test_packets_off_loopback_stay_below_1400_bytes);
    RUN_TEST(test_a_push_begins_when_it_arrives_and_ends);
    RUN_TEST(test_time_tag_is_ntp_time);
    RUN_TEST(test_a_hit_that_no_hand_plays_is_missed_at_beat_minus_1);
    RUN_TEST(test_vmc_bones_lead_to_the_wrist_mirrored);
    RUN_TEST(test_a_taken_port_gives_one_clear_line);
    RUN_TEST(test_a_socket_may_be_descriptor_0);
    RUN_TEST(test_a_socket_is_not_inherited_by_another_program);
    RUN_TEST(test_waiting_ends_with_a_packet_and_not_before_its_time_without);
    RUN_TEST(test_the_network_thread_serves_a_subscription);
    return UNITY_END();
}
