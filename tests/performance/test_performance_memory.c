/// test_performance_memory.c: memory of a performance, and commands that wait in little of it.
#include "performance/performance_state.h"
#include "plan/planner_state.h"

#include "allocations.h"
#include "unity.h"

#include <string.h>

// as long as the parser lets them be
#define LONGEST_DRUM "a-drum-of-one-and-thirty-letter"
#define LONGEST_SEGMENT "a-segment-of-three-and-sixty-letters-that-no-body-has-got-at-al"

static himc_error error;

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_a_performance_and_its_planner_take_at_most_800_kilobytes(void)
{
    TEST_ASSERT_LESS_OR_EQUAL(800000, sizeof(himc_performance) + sizeof(himc_planner));
}

static void test_a_new_performance_asks_for_at_most_1_05_megabytes_with_its_body(void)
{
    himc_performance_config config = himc_performance_default();
    watch_allocations();
    himc_performance *p = himc_performance_new(&config, &error);
    size_t bytes = bytes_asked; // an eighth of them by ODE
    allocations_seen();
    TEST_ASSERT_NOT_NULL_MESSAGE(p, error.text);
    himc_performance_free(p);
    TEST_ASSERT_LESS_OR_EQUAL(1050000, bytes);
}

static himc_command sent[2];
static int acted;

// every third is refused: the next one acts all the same
static bool act(himc_performance *performance, const himc_command *command, himc_error *why)
{
    const himc_command *expected = &sent[acted++ % 2];
    (void)performance;
    TEST_ASSERT_EQUAL_INT(expected->id, command->id);
    TEST_ASSERT_EQUAL_INT(expected->count, command->count);
    for (int i = 0; i < command->count; i++) {
        TEST_ASSERT_EQUAL_INT(expected->choice[i], command->choice[i]);
        TEST_ASSERT_EQUAL_DOUBLE(expected->atom[i].number, command->atom[i].number);
        if (expected->atom[i].kind == HIMC_ATOM_SYMBOL)
            TEST_ASSERT_EQUAL_STRING(expected->atom[i].symbol, command->atom[i].symbol);
    }
    if (command->id == HIMC_COMMAND_HIT)
        TEST_ASSERT_EQUAL_MEMORY(&expected->stroke, &command->stroke, sizeof command->stroke);
    return acted % 3 != 0 || himc_error_set(why, "refused %d", acted);
}

static void write_command(int i, const char *line)
{
    TEST_ASSERT_TRUE_MESSAGE(himc_command_parse_text(&sent[i], HIMC_PERFORMER, line, &error),
                             error.text);
}

static void test_256_of_the_longest_commands_wait_and_act_as_they_were_sent(void)
{
    static performance_queue q;
    static performance_events events;
    himc_event event;
    int refused = 0;
    write_command(0, "hit right vertical-accent fff center " LONGEST_DRUM);
    write_command(1, "push " LONGEST_SEGMENT " 1 -2.5 3 0.25 0.5");
    himc_queue_clear(&q);
    for (int i = 0; i < WAITING_COMMANDS; i++) {
        TEST_ASSERT_TRUE(himc_queue_has_room(&q));
        himc_queue_add(&q, &sent[i % 2], 10 + i);
    }
    TEST_ASSERT_FALSE(himc_queue_has_room(&q));
    for (int sample = 0; sample < 10 + WAITING_COMMANDS; sample += 7)
        himc_queue_run(&q, sample, act, NULL, &events);
    himc_queue_run(&q, 10 + WAITING_COMMANDS, act, NULL, &events);
    TEST_ASSERT_EQUAL_INT(WAITING_COMMANDS, acted);
    TEST_ASSERT_EQUAL_INT(0, q.count);
    for (; himc_events_take(&events, &event); refused++)
        TEST_ASSERT_TRUE(event.refused);
    TEST_ASSERT_EQUAL_INT(WAITING_COMMANDS / 3, refused);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_performance_and_its_planner_take_at_most_800_kilobytes);
    RUN_TEST(test_a_new_performance_asks_for_at_most_1_05_megabytes_with_its_body);
    RUN_TEST(test_256_of_the_longest_commands_wait_and_act_as_they_were_sent);
    return UNITY_END();
}
