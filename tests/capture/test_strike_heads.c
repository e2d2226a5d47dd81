/// test_strike_heads.c: falls on a head that gives way, and beside it.
#include "capture/strike_heads.h"

#include "unity.h"

#define LOUD 8
#define SOFT 4

void setUp(void)
{
}

void tearDown(void)
{
}

// a blow on a level head 0.8 m high that it dents by `depth` (m)
static himc_fall blow(int i, double speed, double depth)
{
    return (himc_fall){.x = himc_vec3_make(0.6 + 0.03 * (i % 3), 0.02 * (i % 4), 0.8 - depth),
                       .speed = speed,
                       .within = 0.006,
                       .depth = depth,
                       .sharp = true};
}

// loud blows dent the head by 30 mm, soft ones by 3: they lie on it where it rests
static void test_soft_blows_are_on_the_head_of_loud_ones(void)
{
    himc_fall falls[LOUD + SOFT];
    himc_strike_head heads[HIMC_STRIKE_HEADS];
    for (int i = 0; i < LOUD; i++)
        falls[i] = blow(i, 5, 0.03);
    TEST_ASSERT_EQUAL_INT(1, himc_strike_heads(falls, LOUD, heads));
    TEST_ASSERT_FALSE(heads[0].at_rest); // nothing asks for it
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.77, himc_strike_head_at(&heads[0], 0.63, 0.03));
    for (int i = LOUD; i < LOUD + SOFT; i++)
        falls[i] = blow(i, 0.6, 0.003);
    TEST_ASSERT_EQUAL_INT(1, himc_strike_heads(falls, LOUD + SOFT, heads));
    TEST_ASSERT_TRUE(heads[0].at_rest);
    TEST_ASSERT_EQUAL_INT(LOUD + SOFT, heads[0].strikes);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.8, himc_strike_head_at(&heads[0], 0.63, 0.03));
}

static void test_turns_in_the_air_are_on_no_head(void)
{
    himc_fall falls[LOUD + SOFT];
    himc_strike_head heads[HIMC_STRIKE_HEADS];
    for (int i = 0; i < LOUD; i++)
        falls[i] = blow(i, 5, 0.03);
    for (int i = LOUD; i < LOUD + SOFT; i++) {
        falls[i] = blow(i, 0.6, 0.003);
        falls[i].x.z += 0.05;
    }
    TEST_ASSERT_EQUAL_INT(1, himc_strike_heads(falls, LOUD + SOFT, heads));
    TEST_ASSERT_EQUAL_INT(LOUD, heads[0].strikes);
    for (int i = LOUD; i < LOUD + SOFT; i++)
        TEST_ASSERT_EQUAL_INT(-1, falls[i].head);
}

// a slow camera makes them as fast as blows, and there are as many of them
static void test_no_head_is_over_another_where_a_hand_strikes_both(void)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++) { // of the blows; else it is a marker's height
        himc_fall falls[2 * LOUD];
        himc_strike_head heads[HIMC_STRIKE_HEADS];
        for (int i = 0; i < 2 * LOUD; i++) {
            falls[i] = blow(i, i % 2 ? 3 : 2.8, 0);
            falls[i].hand = i < LOUD ? (himc_hand)hand : HIMC_LEFT;
            falls[i].x.z += i < LOUD ? 0 : 0.14;
        }
        TEST_ASSERT_EQUAL_INT(1 + hand, himc_strike_heads(falls, 2 * LOUD, heads));
        for (int i = 0; i < 2 * LOUD; i++)
            TEST_ASSERT_EQUAL_INT(hand == 0 && i >= LOUD, falls[i].head < 0);
        for (int i = 0; i < 2 * LOUD; i++) // beside it, it is another drum
            falls[i].x.y += i < LOUD ? 0 : 0.3;
        TEST_ASSERT_EQUAL_INT(2, himc_strike_heads(falls, 2 * LOUD, heads));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_soft_blows_are_on_the_head_of_loud_ones);
    RUN_TEST(test_turns_in_the_air_are_on_no_head);
    RUN_TEST(test_no_head_is_over_another_where_a_hand_strikes_both);
    return UNITY_END();
}
