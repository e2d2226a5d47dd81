/// test_osc_loader.c: commands over OSC that take long, through a loader: what comes behind waits,
/// and the sender is told an error when it is known.
#include "osc_ear.h"

#include "himc/loader.h"
#include "himc/membrane.h"

#define SCORE "osc-loader.txt"

static himc_loader *loader;

static int modes(void)
{
    return himc_membrane_head(himc_drum_membrane(himc_performance_drum(performance, 0)))->modes;
}

static void start_with_loader(void)
{
    himc_error error;
    FILE *score = fopen("build/" SCORE, "w");
    TEST_ASSERT_NOT_NULL(score);
    fputs("kettle modes 90;\nkettle tension 1;\n", score);
    fclose(score);
    loader = himc_loader_new(&error);
    TEST_ASSERT_NOT_NULL(loader);
    restart(&(himc_osc_config){.port = 0, .files = "build", .loader = loader});
}

static void end_with_loader(void)
{
    restart(&(himc_osc_config){.port = 0});
    himc_loader_free(loader);
}

static void test_errors_and_order_are_kept_behind_a_load(void)
{
    start_with_loader();
    int before = modes();
    say("/himc/score", SCORE);
    say("/membrane/kettle/modes", "30");
    say("/membrane/kettle/modes", "300");
    play(0.1);
    TEST_ASSERT_EQUAL_INT(before, modes());
    himc_loader_finish(loader);
    play(0.1);
    TEST_ASSERT_EQUAL_INT(1, count("/himc/error"));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(last_error(), SCORE ":2: kettle: tension"), last_error());
    TEST_ASSERT_EQUAL_INT(before, modes());
    himc_loader_finish(loader);
    TEST_ASSERT_EQUAL_INT(30, modes());
    play(0.1);
    himc_loader_finish(loader);
    TEST_ASSERT_EQUAL_INT(300, modes());
    end_with_loader();
}

static void test_a_network_that_ends_takes_its_load_with_it(void)
{
    start_with_loader();
    say("/membrane/kettle/modes", "300");
    play(0.1);
    TEST_ASSERT_TRUE(himc_loader_busy(loader));
    himc_osc_free(osc);
    osc = NULL;
    TEST_ASSERT_FALSE(himc_loader_busy(loader));
    end_with_loader();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_errors_and_order_are_kept_behind_a_load);
    RUN_TEST(test_a_network_that_ends_takes_its_load_with_it);
    return UNITY_END();
}
