/// test_air.c: the effect of air on a head: the table against the solver and independent figures,
/// the closed forms around it, the kettle, any head.
#include "christian_drum.h"

#include "drum/membrane_config.h"
#include "head/bessel.h"
#include "head/shared.h"
#include "heads.h"

#include <stdio.h>
#include <string.h>

static himc_air_root solved(int m, int n, double a, double tension, double volume)
{
    himc_air_root root[HIMC_AIR_RANKS];
    himc_error error;
    himc_air_problem problem = problem_of(a, tension, volume);
    TEST_ASSERT_TRUE_MESSAGE(himc_air_solve(order_of(m), &problem, n, root, &error), error.text);
    return root[n - 1];
}

static himc_head head_of(double a, double tension)
{
    himc_head head = dry_head();
    head.radius = a;
    head.tension = tension;
    head.density = SIGMA;
    head.decay_constant = 0;
    head.decay_square = 0.3e-6;
    return head;
}

static double bare_pitch(const himc_head *head, int m, int n)
{
    return himc_bessel_zero(m, n) / (2 * HIMC_PI * head->radius) *
           sqrt(head->tension / head->density);
}

static himc_air_load load_at(const himc_head *head, double kettle, int m, int n)
{
    himc_air air = himc_air_around(head, kettle);
    return himc_air_on(&air, m, n, himc_bessel_zero(m, n));
}

static himc_air_load usual_load(const himc_head *head, int m, int n)
{
    return load_at(head, himc_air_kettle(head->radius), m, n);
}

// mode (m, n) as a membrane has it
static himc_mode mode_of(const himc_head *head, int m, int n)
{
    himc_air air = himc_air_around(head, himc_air_kettle(head->radius));
    double zero = himc_bessel_zero(m, n), omega = 2 * HIMC_PI * bare_pitch(head, m, n);
    himc_mode bare = {
        .m = m, .n = n, .zero = zero, .norm = 1, .frequency = bare_pitch(head, m, n), .mass = 0.01};
    bare.stiffness = bare.mass * omega * omega;
    return himc_air_mode(&air, head, &bare);
}

static void test_table_agrees_with_the_independent_solution(void)
{
    himc_head head = head_of(A, 3990);
    for (int i = 0; i < COUNT(PITCH); i++) {
        double f = usual_load(&head, PITCH[i].m, PITCH[i].n).frequency *
                   bare_pitch(&head, PITCH[i].m, PITCH[i].n);
        // (1,2) shares its shape with the kettle's sloshing: one at 311.1 Hz, the other at 351.6;
        // (0,3) a little with the half wave
        bool sloshes = PITCH[i].m == 1 && PITCH[i].n == 2,
             half = PITCH[i].m == 0 && PITCH[i].n == 3;
        TEST_ASSERT_DOUBLE_WITHIN(sloshes ? 60 : half ? 10 : 2, 0, cents(f, PITCH[i].value));
    }
}

static void test_decays_are_in_the_order_of_a_timpano(void)
{
    himc_head head = head_of(A, 3990);
    head.decay_constant = 0.5;
    double d1 = mode_of(&head, 1, 1).decay, d2 = mode_of(&head, 2, 1).decay;
    double d3 = mode_of(&head, 3, 1).decay, d4 = mode_of(&head, 4, 1).decay;
    TEST_ASSERT_TRUE(d1 > d2 && d2 > d3 && d3 < d4);
    printf("T60 of (1..4,1): %.2f %.2f %.2f %.2f s\n", T60 / d1, T60 / d2, T60 / d3, T60 / d4);
    TEST_ASSERT_TRUE(T60 / mode_of(&head, 0, 1).decay < 0.35);
    TEST_ASSERT_TRUE(T60 / mode_of(&head, 0, 2).decay < 0.35);
}

// tuned drums: radius, note (Hz), tension, then ratios to (1,1) of (0,1) (1,1) (2,1) (0,2) (3,1)
// (4,1) (2,2) (5,1) (6,1), computed independently
static const double PLAYED[][12] = {
    {.292, 146.8, 2762, .898, 1, 1.494, 1.664, 1.959, 2.411, 2.685, 2.853, 3.290},
    {.292, 185, 4515, .805, 1, 1.502, 1.667, 1.975, 2.433, 2.696, 2.882, 3.325},
    {.328, 116.5, 2315, .968, 1, 1.501, 1.682, 1.975, 2.435, 2.718, 2.888, 3.334},
    {.328, 146.8, 3762, .855, 1, 1.508, 1.678, 1.987, 2.453, 2.729, 2.911, 3.362},
    {.328, 174.6, 5476, .794, 1, 1.516, 1.683, 2.001, 2.474, 2.726, 2.938, 3.396},
    {.368, 110, 2785, .948, 1, 1.512, 1.693, 1.998, 2.472, 2.758, 2.937, 3.397},
    {.406, 110, 3632, .905, 1, 1.523, 1.704, 2.021, 2.507, 2.796, 2.986, 3.460},
};
static const int PLAYED_MODE[9][2] = {{0, 1}, {1, 1}, {2, 1}, {0, 2}, {3, 1},
                                      {4, 1}, {2, 2}, {5, 1}, {6, 1}};

static void test_tuned_drums_have_the_ratios_of_the_independent_solution(void)
{
    for (int i = 0; i < COUNT(PLAYED); i++) {
        himc_head head = head_of(PLAYED[i][0], PLAYED[i][2]);
        double principal = mode_of(&head, 1, 1).frequency;
        TEST_ASSERT_DOUBLE_WITHIN(1, 0, cents(principal, PLAYED[i][1]));
        for (int k = 0; k < 9; k++) {
            himc_mode mode = mode_of(&head, PLAYED_MODE[k][0], PLAYED_MODE[k][1]);
            double ratio = PLAYED[i][3 + k];
            // (2,2) is near the kettle's second sloshing; (0,1) decays so fast that its frequency
            // depends on how a frequency that is complex is counted, there in part, here in full
            double within = k == 6 ? 0.005 : k == 0 ? 0.003 : 0.0008;
            TEST_ASSERT_DOUBLE_WITHIN(0.0005 + within * ratio, ratio, mode.frequency / principal);
        }
    }
}

// the tension at which (1,1) sounds there
static double tension_for(double a, double hz)
{
    double low = 50, high = 40000;
    for (int i = 0; i < 50; i++) {
        himc_head head = head_of(a, sqrt(low * high));
        *(mode_of(&head, 1, 1).frequency < hz ? &low : &high) = head.tension;
    }
    return sqrt(low * high);
}

// compass of the four drums, as written (Hz)
static const struct {
    double radius, low, high;
} SET[4] = {{.292, 146.8, 220}, {.328, 116.5, 174.6}, {.368, 87.3, 130.8}, {.406, 73.4, 110}};

// But (0,n), which the kettle's spring moves and which decay at once, and n = 4. A pedal is heard
// as one drum.
static void test_ratios_move_less_than_30_cents_from_semitone_to_semitone(void)
{
    for (int i = 0; i < COUNT(SET); i++) {
        double before[HIMC_AIR_ORDERS][4] = {{0}}, most = 0;
        for (double hz = SET[i].low; hz < SET[i].high * 1.001; hz *= pow(2, 1 / 12.0)) {
            himc_head head = head_of(SET[i].radius, tension_for(SET[i].radius, hz));
            for (int m = 1; m < HIMC_AIR_ORDERS; m++)
                for (int n = 1; n <= 3; n++) {
                    double ratio = mode_of(&head, m, n).frequency / hz;
                    if (before[m][n] > 0)
                        most = fmax(most, fabs(cents(ratio, before[m][n])));
                    before[m][n] = ratio;
                }
        }
        printf("%.3f m: ratios move up to %.1f cents a semitone\n", SET[i].radius, most);
        TEST_ASSERT_TRUE(most > 0 && most < 30);
    }
}

static void test_26_inch_modes_of_the_kettle_are_short_in_any_tuning(void)
{
    double longest[2] = {0, 0};
    for (double hz = SET[1].low; hz < SET[1].high; hz *= 1.01) {
        himc_head head = head_of(A, tension_for(A, hz));
        head.decay_constant = 0.5;
        longest[0] = fmax(longest[0], T60 / mode_of(&head, 1, 2).decay);
        longest[1] = fmax(longest[1], T60 / mode_of(&head, 0, 3).decay);
    }
    printf("T60 at most: (1,2) %.2f, (0,3) %.2f s\n", longest[0], longest[1]);
    TEST_ASSERT_TRUE(longest[0] <= 1.4 && longest[1] <= 1.2);
}

static void test_26_inch_drum_has_the_measured_ratios_within_18_cents(void)
{
    // Rossing, as PITCH
    static const double MEASURED[10] = {127, 150, 227, 252, 298, 314, 366, 401, 418, 434};
    himc_head head = head_of(A, 3990);
    double all = 0, principal = mode_of(&head, 1, 1).frequency / MEASURED[1];
    for (int i = 0; i < COUNT(MEASURED); i++) {
        double hz = mode_of(&head, PITCH[i].m, PITCH[i].n).frequency;
        all += pow(cents(hz / MEASURED[i], principal), 2);
    }
    printf("%.1f cents RMS\n", sqrt(all / 9));
    TEST_ASSERT_TRUE(sqrt(all / 9) <= 18);
}

static void test_entries_of_the_table_agree_with_the_solver(void)
{
    unsigned dice = 20;
    for (int i = 0; i < 8; i++) {
        dice = dice * 1664525u + 1013904223u;
        int drum = (int)(dice >> 16) % HIMC_AIR_DRUMS, m = (int)((dice >> 20) % HIMC_AIR_ORDERS),
            k = (int)((dice >> 12) % HIMC_AIR_NODES);
        double a = himc_air_radius[drum];
        double span = HIMC_AIR_TABLE_HIGH / HIMC_AIR_TABLE_LOW;
        double tension = HIMC_AIR_TABLE_LOW * pow(span, k / (HIMC_AIR_NODES - 1.0));
        himc_air_root root[HIMC_AIR_RANKS];
        himc_air_problem p = problem_of(a, tension, himc_air_kettle(a));
        TEST_ASSERT_TRUE(himc_air_oscillators(order_of(m), &p, HIMC_AIR_RANKS, root, NULL));
        for (int n = 0; n < HIMC_AIR_RANKS; n++) {
            int at = HIMC_AIR_ROW(drum, m, n) + k;
            double ratio =
                log(root[n].x / (order_of(m)->alpha[n] * sqrt(p.tension))) / HIMC_AIR_RATIO_UNIT;
            double decay = log(fmax(root[n].decay, 0) + HIMC_AIR_FLOOR) / HIMC_AIR_DECAY_UNIT;
            TEST_ASSERT_DOUBLE_WITHIN(0.51, himc_air_ratio[at], ratio);
            TEST_ASSERT_DOUBLE_WITHIN(0.6, himc_air_decay[at], decay);
        }
    }
}

static void test_between_nodes_and_drums_the_preferred_modes_are_within_a_cent(void)
{
    static const double RADIUS[] = {0.254, 0.272, 0.2921, 0.31, 0.3302, 0.3875};
    for (int i = 0; i < COUNT(RADIUS); i++)
        for (int m = 1; m <= 5; m += 2) {
            himc_head head = head_of(RADIUS[i], 1300 + 1131 * i);
            himc_air_root root =
                solved(m, 1, head.radius, head.tension, himc_air_kettle(head.radius));
            double f = root.x * HIMC_AIR_SPEED / (2 * HIMC_PI * head.radius);
            himc_air_load load = usual_load(&head, m, 1);
            TEST_ASSERT_DOUBLE_WITHIN(1, 0, cents(load.frequency * bare_pitch(&head, m, 1), f));
            double decay = root.decay * HIMC_AIR_SPEED / head.radius;
            TEST_ASSERT_DOUBLE_WITHIN(0.01 * decay + 1e-4, decay, load.radiation);
        }
}

// its range as played, in the table; the preferred modes are near 2 : 3 : 4 : 5
static void test_a_piccolo_timpano_of_20_inches_is_tuned_from_f3_to_c4(void)
{
    static const double F3 = 174.614, C4 = 261.626;
    const himc_shape circle = {.kind = &himc_kind_round};
    himc_head head = head_of(0.254, 3000);
    head.air = true;
    for (double hz = F3; hz < 1.01 * C4; hz *= sqrt(C4 / F3)) {
        head.tension = himc_head_tension(&head, &circle, hz);
        TEST_ASSERT_TRUE(head.tension > HIMC_AIR_TABLE_LOW && head.tension < HIMC_AIR_TABLE_HIGH);
        for (int m = 1; m <= 4; m++)
            TEST_ASSERT_DOUBLE_WITHIN(0.05 * (m + 1), 0.5 * (m + 1),
                                      mode_of(&head, m, 1).frequency / hz);
    }
}

static void test_pitch_rises_without_a_step_over_all_tensions(void)
{
    const double step = 1.003;
    for (int m = 0; m <= 12; m++)
        for (int n = 1; n <= 5; n++) {
            double before = 0, decay = 0;
            for (double tension = 150; tension < 49000; tension *= step) {
                himc_head head = head_of(A, tension);
                himc_air_load load = usual_load(&head, m, n);
                double f = load.frequency * bare_pitch(&head, m, n);
                if (before > 0) {
                    TEST_ASSERT_TRUE(f > before * 0.99999);
                    TEST_ASSERT_TRUE(f < before * 1.01);
                    TEST_ASSERT_TRUE(fabs(log((load.radiation + 1e-3) / (decay + 1e-3))) < 0.2);
                }
                before = f;
                decay = load.radiation;
            }
        }
}

// d ln f/d ln T on one side of a tension
static double incline(double tension, double side, int m, int n)
{
    himc_head near = head_of(A, tension * (1 + 1e-6 * side)),
              far = head_of(A, tension * (1 + 1.1e-5 * side));
    return log(usual_load(&far, m, n).frequency / usual_load(&near, m, n).frequency) /
           (1e-5 * side);
}

static void test_table_and_closed_forms_meet_without_a_bend(void)
{
    double bottom = HIMC_AIR_TABLE_LOW / 4, top = HIMC_AIR_TABLE_HIGH * 4;
    double seams[] = {bottom, HIMC_AIR_TABLE_LOW, HIMC_AIR_TABLE_HIGH, top};
    for (int i = 0; i < COUNT(seams); i++)
        for (int m = 0; m < HIMC_AIR_ORDERS; m += 2)
            for (int n = 1; n <= 3; n++)
                TEST_ASSERT_DOUBLE_WITHIN(0.003, incline(seams[i], -1, m, n),
                                          incline(seams[i], 1, m, n));
}

static void test_modes_without_a_table_are_within_12_cents(void)
{
    static const int MODE[][2] = {{7, 1}, {8, 2}, {8, 4}, {10, 1}, {12, 2}, {15, 1}, {5, 4}};
    himc_head head = head_of(A, 3990);
    himc_air air = himc_air_around(&head, V);
    air.weight = 0;
    for (int i = 0; i < COUNT(MODE); i++) {
        int m = MODE[i][0], n = MODE[i][1];
        double f =
            himc_air_on(&air, m, n, himc_bessel_zero(m, n)).frequency * bare_pitch(&head, m, n);
        TEST_ASSERT_DOUBLE_WITHIN(12, 0, cents(f, pitch(christian(m, n))));
    }
}

// a slack head, whose modes (0, n) the closed forms place best
static void test_coupled_modes_without_a_table_are_within_a_quarter_tone(void)
{
    for (int n = 1; n <= HIMC_AIR_RANKS; n++)
        for (double times = 0.5; times <= 1; times *= 2) {
            himc_head head = head_of(A, 1000);
            double kettle = times * himc_air_kettle(A);
            himc_air air = himc_air_around(&head, kettle);
            air.weight = 0;
            double f = himc_air_on(&air, 0, n, himc_bessel_zero(0, n)).frequency;
            TEST_ASSERT_DOUBLE_WITHIN(
                50, 0, cents(f * bare_pitch(&head, 0, n), pitch(solved(0, n, A, 1000, kettle))));
        }
}

static void test_mass_follows_from_stiffness_and_frequency(void)
{
    static const double MASS[6] = {2.282, 1.801, 1.600, 1.484, 1.408, 1.354};
    himc_head head = head_of(A, 3990);
    for (int m = 1; m <= 6; m++) {
        himc_air_load load = usual_load(&head, m, 1);
        TEST_ASSERT_DOUBLE_WITHIN(0.002, MASS[m - 1], load.mass);
        TEST_ASSERT_EQUAL_DOUBLE(1, load.stiffness);
    }
    for (int m = 0; m <= 3; m++) {
        himc_mode mode = mode_of(&head, m, 1);
        double omega = 2 * HIMC_PI * mode.frequency;
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1, mode.stiffness / (mode.mass * omega * omega));
    }
}

static void test_mass_of_the_principal_modes_is_within_a_tenth_of_the_residue(void)
{
    himc_head head = head_of(A, 3990);
    for (int m = 0; m <= 6; m++)
        TEST_ASSERT_DOUBLE_WITHIN(0.1, 1, usual_load(&head, m, 1).mass / christian(m, 1).inertia);
}

static void test_the_kettle_is_a_spring_to_the_lowest_mode_alone(void)
{
    himc_head head = head_of(A, 3990);
    double usual = himc_air_kettle(A);
    himc_air_load wide = load_at(&head, usual, 0, 1), narrow = load_at(&head, usual / 2, 0, 1);
    // rho c^2/V 4 pi a^2/j^2 beside T (j/a)^2
    double zero = himc_bessel_zero(0, 1), stretch = 3990 * zero * zero / (A * A);
    double spring = HIMC_AIR_DENSITY * HIMC_AIR_SPEED * HIMC_AIR_SPEED / usual * 4 * HIMC_PI * A *
                    A / (zero * zero);
    double volume = 0;
    himc_air air = himc_air_around(&head, usual);
    himc_mixture mix = himc_air_mixture(&air);
    for (int k = 0; k < HIMC_MIXED; k++) {
        double j = himc_bessel_zero(0, k + 1);
        volume += mix.part[0][k] * himc_bessel_j(1, j) / j;
    }
    volume /= himc_bessel_j(1, zero) / zero; // the change of volume beside that of the bare shape
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, wide.stretch + spring / stretch * volume * volume,
                              wide.stiffness);
    TEST_ASSERT_TRUE(wide.stretch > 1 &&
                     narrow.stiffness > wide.stiffness + 0.8 * spring / stretch);
    TEST_ASSERT_TRUE(narrow.frequency > 1.2 * wide.frequency);
    double third =
        load_at(&head, usual / 2, 3, 1).frequency / load_at(&head, usual, 3, 1).frequency;
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 1, third);
}

// modes above the highest frequency are nobody's but their drum's
static void test_only_modes_below_the_highest_are_shared(void)
{
    himc_head head = head_of(A, 3990);
    himc_shape circle = {.kind = &himc_kind_round};
    himc_modes *modes = himc_modes_new(&circle, 40, NULL);
    himc_air air = himc_air_around(&head, himc_air_kettle(A));
    himc_shared_mode shared[HIMC_SHARED];
    TEST_ASSERT_EQUAL_INT(HIMC_SHARED, himc_shared_find(&head, modes, &air, 1e4, shared));
    double second = shared[2].omega / (2 * HIMC_PI);
    int below = himc_shared_find(&head, modes, &air, second - 1, shared);
    TEST_ASSERT_TRUE(below > 0 && below < HIMC_SHARED);
    for (int i = 0; i < below; i++)
        TEST_ASSERT_TRUE(shared[i].omega < 2 * HIMC_PI * second);
    himc_modes_free(modes);
}

static void test_other_kettles_keep_the_preferred_modes_within_a_fifth_of_a_semitone(void)
{
    static const double TIMES[] = {0.5, 0.7, 1.4, 2};
    for (int i = 0; i < COUNT(TIMES); i++)
        for (int m = 1; m <= 4; m++) {
            himc_head head = head_of(A, 3990);
            double v = TIMES[i] * himc_air_kettle(A);
            double f = load_at(&head, v, m, 1).frequency * bare_pitch(&head, m, 1);
            TEST_ASSERT_DOUBLE_WITHIN(20, 0, cents(f, pitch(solved(m, 1, A, 3990, v))));
        }
}

static void test_heads_equal_in_dimensionless_measures_sound_equal(void)
{
    himc_head one = head_of(A, 3990), two = one;
    two.radius *= 1.3;
    two.density *= 1.3;
    two.tension *= 1.3;
    himc_air_load a = usual_load(&one, 2, 2), b = usual_load(&two, 2, 2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, a.frequency, b.frequency);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9 * a.radiation, a.radiation, 1.3 * b.radiation);
}

static void test_any_head_in_range_has_finite_slower_damped_modes(void)
{
    unsigned dice = 7;
    for (int i = 0; i < 5000; i++) {
        double u[5];
        for (int k = 0; k < 5; k++) {
            dice = dice * 1664525u + 1013904223u;
            u[k] = (dice >> 8) / 16777216.0;
        }
        himc_head head = {.radius = 0.05 * pow(20, u[0]),
                          .tension = 50 * pow(1000, u[1]),
                          .density = 0.01 * pow(1e5, u[2]),
                          .modes = 1};
        int m = (int)(13 * u[3]), n = 1 + (int)(6 * u[4]);
        himc_air_load load =
            load_at(&head, himc_air_kettle(head.radius) * (0.5 + 1.5 * u[4]), m, n);
        TEST_ASSERT_TRUE(isfinite(load.frequency) && load.frequency > 0);
        TEST_ASSERT_TRUE(isfinite(load.radiation) && load.radiation >= 0);
        TEST_ASSERT_TRUE(isfinite(load.mass) && load.mass > 0);
        TEST_ASSERT_TRUE(m == 0 || (load.frequency < 1 && load.mass > 1));
    }
}

static void test_kettle_out_of_range_is_refused_with_its_range(void)
{
    himc_error error;
    TEST_ASSERT_TRUE(himc_air_check(0.14, A, &error));
    TEST_ASSERT_FALSE(himc_air_check(1.4, A, &error));
    TEST_ASSERT_NOT_NULL(strstr(error.text, "kettle: 1.4 m3, expected 0.0699929 .. 0.279971 m3"));
    TEST_ASSERT_FALSE(himc_air_check(NAN, A, &error));
}

void setUp(void)
{
}

void tearDown(void)
{
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_table_agrees_with_the_independent_solution);
    RUN_TEST(test_decays_are_in_the_order_of_a_timpano);
    RUN_TEST(test_tuned_drums_have_the_ratios_of_the_independent_solution);
    RUN_TEST(test_ratios_move_less_than_30_cents_from_semitone_to_semitone);
    RUN_TEST(test_26_inch_modes_of_the_kettle_are_short_in_any_tuning);
    RUN_TEST(test_26_inch_drum_has_the_measured_ratios_within_18_cents);
    RUN_TEST(test_entries_of_the_table_agree_with_the_solver);
    RUN_TEST(test_between_nodes_and_drums_the_preferred_modes_are_within_a_cent);
    RUN_TEST(test_a_piccolo_timpano_of_20_inches_is_tuned_from_f3_to_c4);
    RUN_TEST(test_pitch_rises_without_a_step_over_all_tensions);
    RUN_TEST(test_table_and_closed_forms_meet_without_a_bend);
    RUN_TEST(test_modes_without_a_table_are_within_12_cents);
    RUN_TEST(test_coupled_modes_without_a_table_are_within_a_quarter_tone);
    RUN_TEST(test_mass_follows_from_stiffness_and_frequency);
    RUN_TEST(test_mass_of_the_principal_modes_is_within_a_tenth_of_the_residue);
    RUN_TEST(test_the_kettle_is_a_spring_to_the_lowest_mode_alone);
    RUN_TEST(test_only_modes_below_the_highest_are_shared);
    RUN_TEST(test_other_kettles_keep_the_preferred_modes_within_a_fifth_of_a_semitone);
    RUN_TEST(test_heads_equal_in_dimensionless_measures_sound_equal);
    RUN_TEST(test_any_head_in_range_has_finite_slower_damped_modes);
    RUN_TEST(test_kettle_out_of_range_is_refused_with_its_range);
    return UNITY_END();
}
