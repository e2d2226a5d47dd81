/// test_modes.c: the list of modes, their masses, shapes and decays, and the ranges of a head.
#define _XOPEN_SOURCE 700 // jn
#include "head/modes.h"

#include "unity.h"
#include "exact_shape.h"
#include "heads.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static himc_head head;
static himc_error error;
static const himc_shape circle = {.kind = &himc_kind_round};

void setUp(void)
{
    head = dry_head();
    error.text[0] = '\0';
}

void tearDown(void)
{
}

static himc_mode find(const himc_modes *modes, int m, int n, bool sine)
{
    for (int i = 0; i < modes->count; i++) {
        himc_mode mode = himc_modes_get(modes, &head, i);
        if (mode.m == m && mode.n == n && mode.sine == sine)
            return mode;
    }
    TEST_FAIL_MESSAGE("no such mode");
    return (himc_mode){0};
}

static void ratio_is(const himc_modes *modes, int m, int n, double ratio)
{
    TEST_ASSERT_DOUBLE_WITHIN(
        5e-5, ratio, find(modes, m, n, false).frequency / find(modes, 1, 1, false).frequency);
}

static void test_modes_ratios_to_the_principal_are_the_ideal_membranes(void)
{
    himc_modes *modes = himc_modes_new(&circle, 40, &error);
    ratio_is(modes, 0, 1, 0.6276);
    ratio_is(modes, 2, 1, 1.3403);
    ratio_is(modes, 0, 2, 1.4406);
    ratio_is(modes, 3, 1, 1.6651);
    ratio_is(modes, 1, 2, 1.8309);
    ratio_is(modes, 4, 1, 1.9804);
    ratio_is(modes, 5, 1, 2.2892);
    himc_modes_free(modes);
}

static void mass_fraction_is(const himc_modes *modes, int m, int n, double fraction)
{
    double whole = head.density * HIMC_PI * head.radius * head.radius;
    himc_mode mode = find(modes, m, n, false);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, fraction, mode.mass / whole);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, fraction, mode.norm);
}

static void test_modes_masses_are_the_known_fractions_of_the_heads(void)
{
    himc_modes *modes = himc_modes_new(&circle, 40, &error);
    mass_fraction_is(modes, 0, 1, 0.269514123942);
    mass_fraction_is(modes, 1, 1, 0.0811075654133);
    mass_fraction_is(modes, 2, 1, 0.0576874274087);
    mass_fraction_is(modes, 3, 1, 0.0444834888783);
    mass_fraction_is(modes, 5, 1, 0.030118976392);
    himc_modes_free(modes);
}

static void test_modes_stiffness_is_the_tensions_share(void)
{
    himc_modes *modes = himc_modes_new(&circle, 40, &error);
    himc_mode mode = find(modes, 2, 2, true);
    double a = head.radius,
           expected = head.tension * pow(mode.zero / a, 2) * HIMC_PI * a * a * mode.norm;
    TEST_ASSERT_DOUBLE_WITHIN(1e-12 * expected, expected, mode.stiffness);
    himc_modes_free(modes);
}

static void test_modes_are_in_order_each_once_and_pairs_together(void)
{
    himc_modes *modes = himc_modes_new(&circle, 2000, &error);
    himc_mode before = himc_modes_get(modes, &head, 0);
    TEST_ASSERT_EQUAL_INT(0, before.m);
    for (int i = 1; i < 2000; i++) {
        himc_mode mode = himc_modes_get(modes, &head, i);
        TEST_ASSERT_TRUE(mode.zero >= before.zero);
        bool second = before.m == mode.m && before.n == mode.n && !before.sine;
        bool first = before.m == 0 || before.sine;
        TEST_ASSERT_TRUE(mode.sine ? second : first);
        before = mode;
    }
    himc_modes_free(modes);
}

// the list has every (m, n) with a zero below the last one's, and no other
static void test_modes_list_has_no_hole(void)
{
    himc_modes *modes = himc_modes_new(&circle, 501, &error);
    double last = himc_modes_get(modes, &head, 500).zero;
    int below[60] = {0}, counted = 0;
    for (int i = 0; i < 501; i++) {
        himc_mode mode = himc_modes_get(modes, &head, i);
        if (mode.zero < last && !mode.sine && mode.n > below[mode.m])
            below[mode.m] = mode.n;
    }
    // the C library's jn changes sign once for each zero of its order
    for (int m = 0; m < 60; m++) {
        int changes = 0;
        for (double z = m + 0.01; z + 0.05 < last; z += 0.05)
            changes += (jn(m, z) > 0) != (jn(m, z + 0.05) > 0);
        TEST_ASSERT_INT_WITHIN(1, changes, below[m]);
        counted += below[m];
    }
    TEST_ASSERT_TRUE(counted > 240 && counted <= 251 + 15);
    himc_modes_free(modes);
}

static void test_modes_list_that_ends_within_a_pair_has_the_cosine(void)
{
    himc_modes *modes = himc_modes_new(&circle, 2, &error);
    himc_mode mode = himc_modes_get(modes, &head, 1);
    TEST_ASSERT_EQUAL_INT(1, mode.m);
    TEST_ASSERT_FALSE(mode.sine);
    double shapes[2];
    himc_modes_shapes(modes, head.radius, 0.1, 0.05, shapes);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, exact_shape(modes, &head, 1, 0.1, 0.05), shapes[1]);
    himc_modes_free(modes);
}

static void test_modes_three_three_has_a_node_at_three_quarters(void)
{
    himc_modes *modes = himc_modes_new(&circle, 200, &error);
    for (int i = 0; i < 200; i++) {
        himc_mode mode = himc_modes_get(modes, &head, i);
        double at = fabs(exact_shape(modes, &head, i, -0.75 * head.radius, 0));
        if (mode.m == 3 && mode.n == 3) {
            TEST_ASSERT_TRUE(at < 1e-4);
        } else if (mode.m == 1 && mode.n == 1 && !mode.sine) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.38463, at);
        }
    }
    himc_modes_free(modes);
}

static void test_modes_fast_shapes_agree_with_exact_ones(void)
{
    himc_modes *modes = himc_modes_new(&circle, 2000, &error);
    double *shapes = malloc(2000 * sizeof *shapes);
    for (int k = 0; k < 12; k++) {
        double r = head.radius * (k < 11 ? k / 11.0 : 0.9999), angle = 0.7 * k;
        himc_modes_shapes(modes, head.radius, r * cos(angle), r * sin(angle), shapes);
        for (int i = 0; i < 2000; i += 3)
            TEST_ASSERT_DOUBLE_WITHIN(
                1e-8, exact_shape(modes, &head, i, r * cos(angle), r * sin(angle)), shapes[i]);
    }
    free(shapes);
    himc_modes_free(modes);
}

static void test_modes_shapes_vanish_outside_the_head(void)
{
    himc_modes *modes = himc_modes_new(&circle, 20, &error);
    double shapes[20];
    himc_modes_shapes(modes, head.radius, head.radius * 1.01, 0, shapes);
    for (int i = 0; i < 20; i++)
        TEST_ASSERT_EQUAL_DOUBLE(0, shapes[i]);
    himc_modes_free(modes);
}

static void test_modes_decay_is_the_two_parameter_law_and_always_leaves_an_oscillation(void)
{
    himc_modes *modes = himc_modes_new(&circle, 200, &error);
    himc_mode mode = himc_modes_get(modes, &head, 50);
    double w = 2 * HIMC_PI * mode.frequency;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, head.decay_constant + head.decay_square * w * w, mode.decay);
    head.decay_square = 1e-3;
    mode = himc_modes_get(modes, &head, 199);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.9 * 2 * HIMC_PI * mode.frequency, mode.decay);
    himc_modes_free(modes);
}

static void refused(const char *line)
{
    TEST_ASSERT_FALSE(himc_head_check(&head, &error));
    TEST_ASSERT_EQUAL_STRING(line, error.text);
    head = dry_head();
}

static void test_head_refuses_fields_out_of_range_with_the_range(void)
{
    TEST_ASSERT_TRUE(himc_head_check(&head, &error));
    head.radius = 0;
    refused("radius: 0 m, expected 0.05 .. 1 m");
    head.tension = NAN;
    refused("tension: nan N/m, expected 10 .. 100000 N/m");
    head.density = -1;
    refused("density: -1 kg/m2, expected 0.001 .. 1000 kg/m2");
    head.modes = -1;
    refused("modes: -1, expected 1 .. 4000");
    head.decay_square = INFINITY;
    refused("decay S1: inf s, expected 0 .. 1 s");
    TEST_ASSERT_NULL(himc_modes_new(&circle, 4001, &error));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_modes_ratios_to_the_principal_are_the_ideal_membranes);
    RUN_TEST(test_modes_masses_are_the_known_fractions_of_the_heads);
    RUN_TEST(test_modes_stiffness_is_the_tensions_share);
    RUN_TEST(test_modes_are_in_order_each_once_and_pairs_together);
    RUN_TEST(test_modes_list_has_no_hole);
    RUN_TEST(test_modes_list_that_ends_within_a_pair_has_the_cosine);
    RUN_TEST(test_modes_three_three_has_a_node_at_three_quarters);
    RUN_TEST(test_modes_fast_shapes_agree_with_exact_ones);
    RUN_TEST(test_modes_shapes_vanish_outside_the_head);
    RUN_TEST(test_modes_decay_is_the_two_parameter_law_and_always_leaves_an_oscillation);
    RUN_TEST(test_head_refuses_fields_out_of_range_with_the_range);
    return UNITY_END();
}
