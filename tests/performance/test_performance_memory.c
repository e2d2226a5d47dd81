/// test_performance_memory.c: what a performer takes of memory, and what it keeps in little of it.
#include "performance/performance_state.h"
#include "plan/planner_state.h"

#include "unity.h"

#include <stdio.h>
#include <string.h>

#define COMMANDS 200
#define DELAYS 7

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_a_performer_and_its_planner_take_at_most_800_kilobytes(void)
{
    TEST_ASSERT_LESS_OR_EQUAL(800000, sizeof(himc_performance) + sizeof(himc_planner));
}

// a text of up to 400 characters, another for each number
static void text_of(int number, char text[512])
{
    int length = number * 37 % 400;
    snprintf(text, 512, "%d-", number);
    while ((int)strlen(text) < length)
        strcat(text, "x");
}

static void test_events_of_any_text_come_out_as_they_went_in(void)
{
    static performance_events e;
    himc_event event;
    int taken = 0, added = 0;
    char text[512];
    while (taken < 5000) {
        for (int i = 0; i < 40; i++) {
            event = (himc_event){.kind = HIMC_EVENT_NOTE, .beat = added};
            text_of(added++, event.text);
            himc_events_add(&e, &event);
        }
        for (int i = 0; i < 37 && taken < 5000; i++, taken++) {
            TEST_ASSERT_TRUE(himc_events_take(&e, &event));
            taken += (int)e.lost; // the oldest ones
            e.lost = 0;
            text_of(taken, text);
            TEST_ASSERT_EQUAL_DOUBLE(taken, event.beat);
            TEST_ASSERT_EQUAL_STRING(text, event.text);
        }
    }
}

static int acted[DELAYS]; // the last number of each delay

// `record NUMBER-xxx`: those of one delay come in their order, with their texts
static bool act(himc_performance *performance, const himc_command *command, himc_error *error)
{
    (void)performance;
    (void)error;
    char text[512];
    int number = atoi(command->atom[0].symbol);
    text_of(number, text);
    TEST_ASSERT_EQUAL_STRING(text, command->atom[0].symbol);
    TEST_ASSERT_GREATER_THAN(acted[number % DELAYS], number);
    acted[number % DELAYS] = number;
    return true;
}

static void test_commands_of_any_text_wait_for_their_sample(void)
{
    static performance_queue q;
    static performance_events e;
    himc_error error;
    int added = 0, most = 0;
    himc_queue_clear(&q);
    memset(acted, -1, sizeof acted);
    for (int sample = 0; sample < COMMANDS; sample++) {
        for (; himc_queue_has_room(&q) && added < sample * 40; added++) {
            char line[640] = "record ";
            himc_command command;
            text_of(added, line + strlen(line));
            TEST_ASSERT_TRUE_MESSAGE(
                himc_command_parse_text(&command, HIMC_PERFORMER, line, &error), error.text);
            himc_queue_add(&q, &command, sample + added % DELAYS);
        }
        most = q.used > (size_t)most ? (int)q.used : most;
        himc_queue_run(&q, sample, act, NULL, &e);
    }
    TEST_ASSERT_GREATER_THAN((int)(sizeof q.waiting / 2), most);
    himc_queue_run(&q, COMMANDS + DELAYS, act, NULL, &e);
    TEST_ASSERT_EQUAL_INT(0, (int)q.used);
    for (int i = 0; i < DELAYS; i++)
        TEST_ASSERT_GREATER_THAN(added - DELAYS - 1, acted[i]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_performer_and_its_planner_take_at_most_800_kilobytes);
    RUN_TEST(test_events_of_any_text_come_out_as_they_went_in);
    RUN_TEST(test_commands_of_any_text_wait_for_their_sample);
    return UNITY_END();
}
