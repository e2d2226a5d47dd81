/// test_osc_streams.c: which states a subscriber gets when, and what a packet that is not quite
/// right does: nothing.
#include "osc_ear.h"
#include "osc/subscribe.h"

static void test_the_highest_rate_of_several_subscriptions_is_kept(void)
{
    subscribe("pose 100");
    subscribe("targets 10");
    play(0.1);
    forget();
    play(1);
    TEST_ASSERT_INT_WITHIN(2, 100, count("/himc/body") / HIMC_SEGMENTS);
    TEST_ASSERT_INT_WITHIN(2, 2 * 10, count("/himc/targets"));
}

static void test_poses_of_one_who_sits_say_what_carries_him(void)
{
    subscribe("pose 50");
    play(0.2);
    TEST_ASSERT_EQUAL_INT(0, count("/himc/support"));
    say("/himc/stance", "seated");
    play(1);
    forget();
    play(0.5);
    int poses = count("/himc/body") / HIMC_SEGMENTS;
    TEST_ASSERT_INT_WITHIN(1, poses, count("/himc/support"));
    lo_arg **atom = lo_message_get_argv(last("/himc/support")->message);
    double up = number(atom[2]) + number(atom[5]) + number(atom[8]);
    TEST_ASSERT_DOUBLE_WITHIN(1, 736.4, up);
    TEST_ASSERT_TRUE(number(atom[2]) > number(atom[5]) + number(atom[8]));
    TEST_ASSERT_TRUE(number(atom[9]) > 0 && number(atom[9]) < 0.3); // between seat and feet
    say("/himc/stance", "fixed");
    play(0.1);
    forget();
    play(0.2);
    TEST_ASSERT_EQUAL_INT(0, count("/himc/support"));
}

static void test_poses_continue_after_a_reset(void)
{
    subscribe("pose 50");
    play(2);
    say("/himc/reset", "");
    play(0.02);
    forget();
    play(0.5);
    TEST_ASSERT_INT_WITHIN(2, 25, count("/himc/body") / HIMC_SEGMENTS);
}

static void test_after_a_reset_all_poses_have_the_time_of_the_wall_clock(void)
{
    subscribe("pose 250");
    play(2);
    forget();
    say("/himc/reset", "");
    double begun = EPOCH + simulated;
    play(0.1);
    for (int i = 0; i < heard_count; i++)
        TEST_ASSERT_DOUBLE_WITHIN(0.051, begun + 0.05, wall_of(&heard[i]));
    TEST_ASSERT_TRUE(count("/himc/body") >= 24 * HIMC_SEGMENTS);
}

static void test_a_drum_that_moves_is_sent_at_once_and_else_once_a_second(void)
{
    subscribe("strikes");
    play(1.1);
    forget();
    play(0.5);
    TEST_ASSERT_EQUAL_INT(0, count("/membrane/kettle/place"));
    say("/membrane/kettle/place", "0.9 0.25 0.8");
    play(0.02);
    TEST_ASSERT_EQUAL_INT(1, count("/membrane/kettle/place"));
    TEST_ASSERT_EQUAL_FLOAT(
        0.25f, number(lo_message_get_argv(last("/membrane/kettle/place")->message)[1]));
}

static void test_each_drum_is_sent_by_its_name(void)
{
    himc_error error;
    himc_drum *other = himc_drum_new("other", 29, 48000, &error);
    TEST_ASSERT_TRUE(himc_performance_add_drum(performance, other, &error));
    himc_drum_release(other);
    subscribe("strikes");
    play(1.1);
    TEST_ASSERT_EQUAL_INT(count("/membrane/kettle/place"), count("/membrane/other/place"));
    forget();
    say("/membrane/other/place", "0.9 -0.25 0.8");
    play(0.02);
    TEST_ASSERT_EQUAL_INT(0, count("/membrane/kettle/place"));
    TEST_ASSERT_EQUAL_INT(1, count("/membrane/other/place"));
}

static void test_info_over_osc_is_answered_and_listen_refused(void)
{
    say("/himc/info", "");
    play(0.02);
    TEST_ASSERT_TRUE(count("/himc/info") >= 3);
    TEST_ASSERT_EQUAL_INT(0, count("/himc/error"));
    forget();
    say("/himc/get", "latency");
    play(0.02);
    TEST_ASSERT_EQUAL_INT(1, count("/himc/info"));
    say("/himc/get", "late");
    play(0.02);
    TEST_ASSERT_EQUAL_STRING(
        "get: WHAT: late, expected a setting, tempo, beat, state, drums, loop, "
        "room, listener or mute",
        last_error());
    say("/himc/listen", "9000");
    play(0.02);
    TEST_ASSERT_EQUAL_STRING("listen: not over the network", last_error());
}

static void test_an_idle_hour_saves_up_no_answers(void)
{
    simulated += 3600;
    for (int i = 0; i < 80; i++)
        say("/himc/tempo", "-1");
    play(0.004);
    TEST_ASSERT_EQUAL_INT(50, count("/himc/error"));
    TEST_ASSERT_EQUAL_INT(80, himc_osc_count(osc).refused);
}

static void test_an_address_with_one_part_too_many_is_foreign(void)
{
    say("/membrane/kettle/rim/tension", "5000");
    say("/himc/score/stop", "");
    say("/membrane//tension", "5000");
    play(0.02);
    TEST_ASSERT_EQUAL_INT(3, himc_osc_count(osc).foreign);
    TEST_ASSERT_EQUAL_INT(0, himc_osc_count(osc).commands);
}

// what is missing lies behind it in the buffer, left by the packet before
static void test_a_bundle_cut_off_within_an_element_is_malformed(void)
{
    char data[40] = "#bundle\0\0\0\0\0\0\0\0\1\0\0\0\x14/himc/tempo\0,f\0\0\x42\xf0\0\0";
    send_bytes(data, sizeof data);
    send_bytes(data, 32);
    play(0.02);
    TEST_ASSERT_EQUAL_INT(1, himc_osc_count(osc).commands);
    TEST_ASSERT_EQUAL_INT(1, himc_osc_count(osc).malformed);
}

// the sound of a drum that rings, as the drum itself has it
static void test_the_sound_is_that_of_the_drums_without_a_gap(void)
{
    himc_drum *drum = himc_performance_drum(performance, 0);
    subscribe("sound");
    play(0.1);
    himc_drum_strike_at(drum, 0, 0.1, 0, 3, NULL);
    forget();
    play(0.25);
    TEST_ASSERT_INT_WITHIN(1, 50, count("/himc/sound"));
    int32_t next = 0;
    double loudest = 0;
    for (int i = 0, packets = 0; i < heard_count; i++) {
        if (strcmp(heard[i].path, "/himc/sound") != 0)
            continue;
        lo_arg **atom = lo_message_get_argv(heard[i].message);
        const unsigned char *at = lo_blob_dataptr((lo_blob)atom[3]);
        double sound[240];
        TEST_ASSERT_TRUE(packets++ == 0 || whole(atom[0]) == next);
        TEST_ASSERT_EQUAL_INT(48000, whole(atom[1]));
        TEST_ASSERT_EQUAL_INT(1, whole(atom[2]));
        TEST_ASSERT_EQUAL_INT(480, lo_blob_datasize((lo_blob)atom[3]));
        himc_drum_read(drum, (uint64_t)whole(atom[0]), 240, sound, NULL);
        for (int k = 0; k < 240; k++) {
            int16_t value = (int16_t)(at[2 * k] << 8 | at[2 * k + 1]);
            TEST_ASSERT_DOUBLE_WITHIN(0.6 / 32767, fmax(-1, fmin(1, sound[k])), value / 32767.0);
            loudest = fmax(loudest, fabs(sound[k]));
        }
        next = whole(atom[0]) + 240;
    }
    TEST_ASSERT_TRUE(loudest > 0.01);
    TEST_ASSERT_EQUAL_INT(0, count("/himc/body"));
}

static void test_more_drums_than_there_is_room_for_leave_the_others_as_they_are(void)
{
    static osc_subscriptions s;
    himc_osc_counts counts = {0};
    for (int i = 0; i < HIMC_DRUMS + 8; i++) {
        osc_state state = {.kind = STATE_DRUM};
        snprintf(state.drum.name, sizeof state.drum.name, "drum%d", i);
        himc_osc_deliver(&s, &state, &counts, 1);
        TEST_ASSERT_EQUAL_INT(i < HIMC_DRUMS ? i + 1 : HIMC_DRUMS, s.drums);
    }
    TEST_ASSERT_EQUAL_STRING("drum0", s.drum[0].name);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_more_drums_than_there_is_room_for_leave_the_others_as_they_are);
    RUN_TEST(test_the_highest_rate_of_several_subscriptions_is_kept);
    RUN_TEST(test_poses_of_one_who_sits_say_what_carries_him);
    RUN_TEST(test_poses_continue_after_a_reset);
    RUN_TEST(test_after_a_reset_all_poses_have_the_time_of_the_wall_clock);
    RUN_TEST(test_a_drum_that_moves_is_sent_at_once_and_else_once_a_second);
    RUN_TEST(test_each_drum_is_sent_by_its_name);
    RUN_TEST(test_the_sound_is_that_of_the_drums_without_a_gap);
    RUN_TEST(test_info_over_osc_is_answered_and_listen_refused);
    RUN_TEST(test_an_idle_hour_saves_up_no_answers);
    RUN_TEST(test_an_address_with_one_part_too_many_is_foreign);
    RUN_TEST(test_a_bundle_cut_off_within_an_element_is_malformed);
    return UNITY_END();
}
