/// test_contact_search.c: how often the felt's law is computed for sticks that touch a head
/// together. The search for their forces must end where rounding leaves them: one that asks for
/// less goes through all its steps, and a block of sound takes milliseconds.
#define himc_felt_force felt_force_of_the_library
#include "drum/felt.c"
#undef himc_felt_force

#include "base/random.h"
#include "heads.h"
#include "unity.h"

#include <stdio.h>

#define STICKS 4
#define BLOWS 120
#define SAMPLES 800
#define MOST 100 // chosen: evaluations a stick and sample; one search may end in rounding after 30
#define MEAN 5   // chosen: Newton's method takes 3.6

static int evaluations;
static uint64_t seed = 1;

double himc_felt_force(const felt *f, double r, double h, double *slope);
double himc_felt_force(const felt *f, double r, double h, double *slope)
{
    evaluations++;
    return felt_force_of_the_library(f, r, h, slope);
}

void setUp(void)
{
}

void tearDown(void)
{
}

// 0 .. 1
static double any(void)
{
    return (double)(himc_random_bits(&seed) >> 11) * 0x1p-53;
}

// soft, hard and stiff heads, with and without losses, a patch and a core, beside each other
static himc_stick any_stick(void)
{
    return (himc_stick){.head = {.stiffness = pow(10, 5 + 4 * any()),
                                 .exponent = 2 + 1.5 * any(),
                                 .loss = any() < 0.5 ? 0 : any(),
                                 .mass = 0.03,
                                 .radius = any() < 0.3 ? 0 : 0.0175,
                                 .relaxation = any() < 0.5 ? 0 : 1e-4,
                                 .core = any() < 0.4 ? 0 : pow(10, 6 + 4 * any())},
                        .mass = 0.01 + 0.1 * any(),
                        .x = -0.2 + 0.1 * any(),
                        .y = 0.1 * any(),
                        .velocity = -10 * any()};
}

static void test_forces_of_several_sticks_are_found_in_a_few_evaluations(void)
{
    double most = 0, sum = 0;
    int samples = 0;
    for (int blow = 0; blow < BLOWS; blow++) {
        himc_head head = dry_head();
        himc_membrane *membrane = himc_membrane_new(&head, 48000, NULL);
        himc_stick stick[STICKS], *sticks[STICKS];
        int count = 2 + blow % (STICKS - 1);
        TEST_ASSERT_NOT_NULL(membrane);
        for (int i = 0; i < count; i++) {
            stick[i] = any_stick();
            sticks[i] = &stick[i];
        }
        for (int n = 0; n < SAMPLES; n++) {
            evaluations = 0;
            himc_contact_step(membrane, sticks, count);
            most = fmax(most, (double)evaluations / count);
            sum += (double)evaluations / count;
            samples += evaluations > 0;
        }
        himc_membrane_free(membrane);
    }
    printf("%d samples with contact: %.2f evaluations a stick, %.0f at most\n", samples,
           sum / samples, most);
    TEST_ASSERT_TRUE(samples > BLOWS * 100);
    TEST_ASSERT_TRUE(sum <= MEAN * samples);
    TEST_ASSERT_TRUE(most <= MOST);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_forces_of_several_sticks_are_found_in_a_few_evaluations);
    return UNITY_END();
}
