/// test_contact.c: energy, forces, times and rebounds of sticks on a head.
#include "drum/membrane_state.h"
#include "drum/contact.h"

#include "unity.h"
#include "inner_state.h"
#include "heads.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define RATE 48000.0
#define STICKS 4

static himc_membrane *membrane;
static himc_head head;
static himc_stick stick[STICKS];
static himc_stick *sticks[STICKS] = {&stick[0], &stick[1], &stick[2], &stick[3]};

// Christian et al.'s head; the mass of its air is included by the factor 1/0.66^2
static void christian(int modes)
{
    head = dry_head();
    head.radius = 0.328;
    head.tension = 3990;
    head.density = 0.2653 / (0.66 * 0.66);
    head.modes = modes;
    head.air = false;
    head.uniformity = 1;
    head.glide = 0;
}

static void place(int i, double x, double y, double velocity)
{
    stick[i] = (himc_stick){
        .head = {.stiffness = 1.6e8, .exponent = 2.54, .mass = 0.030, .radius = 0.0175},
        .mass = 0.030,
        .x = x * head.radius,
        .y = y * head.radius,
        .velocity = -velocity};
}

// as in the papers: the head has no patch under the mallet
static void make_point(int i)
{
    stick[i].head.radius = 0;
}

static void place_all(void)
{
    place(0, -0.75, 0, 4);
    place(1, -0.74, 0.05, 3); // beside the first: strongly coupled
    place(2, -0.2, 0.4, 5);
    place(3, -0.75, 0, 2); // at the first one's point
}

static void remake(void)
{
    himc_membrane_free(membrane);
    membrane = himc_membrane_new(&head, RATE, NULL);
    TEST_ASSERT_NOT_NULL(membrane);
}

void setUp(void)
{
    christian(200);
    membrane = NULL;
    remake();
    place_all();
}

void tearDown(void)
{
    himc_membrane_free(membrane);
    membrane = NULL;
}

static double energy(int count)
{
    double sum = himc_membrane_energy(membrane);
    for (int i = 0; i < count; i++)
        sum += himc_contact_energy(&stick[i]);
    return sum;
}

// A strike of `count` sticks of that radius: largest deviation of the energy from its start, and
// largest rise in one step, as fractions of it.
static void blow(int count, double k, double mu, double radius, double *drift, double *rise)
{
    remake();
    place_all();
    for (int i = 0; i < count; i++) {
        stick[i].head.stiffness = k;
        stick[i].head.loss = mu;
        stick[i].head.radius = radius;
    }
    double start = energy(count), before = start, most = 0;
    *drift = *rise = 0;
    for (int n = 0; n < 1500; n++) {
        himc_contact_step(membrane, sticks, count);
        double now = energy(count);
        *drift = fmax(*drift, fabs(now - start) / start);
        *rise = fmax(*rise, (now - before) / start);
        before = now;
        most = fmax(most, stick[0].force);
    }
    TEST_ASSERT_TRUE(most > 1);
}

static void test_contact_without_losses_keeps_energy_for_any_stiffness(void)
{
    double worst = 0;
    head.decay_constant = head.decay_square = 0;
    for (int count = 1; count <= STICKS; count++) {
        for (double k = 1e6; k < 2e12; k *= 100) {
            double drift, rise;
            blow(count, k, 0, 0, &drift, &rise);
            worst = fmax(worst, drift);
        }
    }
    printf("largest drift %.2g of the blow\n", worst);
    TEST_ASSERT_TRUE(worst < 1e-12);
}

static void test_contact_energy_never_grows_in_any_step_with_losses(void)
{
    double worst = 0;
    for (int count = 1; count <= STICKS; count++) {
        for (double k = 1e6; k < 2e12; k *= 100) {
            double drift, rise;
            blow(count, k, 0.2, 0.0175, &drift, &rise);
            worst = fmax(worst, rise);
        }
    }
    printf("largest rise in a step %.2g of the blow\n", worst);
    TEST_ASSERT_TRUE(worst < 1e-13);
}

typedef struct result {
    double force, contact, restitution, impulse;
} result;

static result hit(double velocity)
{
    result r = {0};
    remake();
    place(0, -0.75, 0, velocity);
    make_point(0);
    for (int n = 0; n < 1500; n++) {
        himc_contact_step(membrane, sticks, 1);
        r.force = fmax(r.force, stick[0].force);
        r.contact += stick[0].force > 0 ? 1 / RATE : 0;
        r.impulse += stick[0].force / RATE;
    }
    r.restitution = stick[0].velocity / velocity;
    return r;
}

static void test_contact_forces_times_and_rebounds_agree_with_the_published_model(void)
{
    static const double expected[5][4] = {{0.5, 5.7, 10.2e-3, 0.95},
                                          {1, 12.5, 8.7e-3, 0.92},
                                          {2, 26.5, 7.7e-3, 0.885},
                                          {4, 56.3, 7.0e-3, 0.853},
                                          {8, 122, 6.5e-3, 0.825}};
    christian(260);
    for (int i = 0; i < 5; i++) {
        result r = hit(expected[i][0]);
        printf("%3.1f m/s: %.1f N, %.2f ms, rebound %.3f\n", expected[i][0], r.force,
               r.contact * 1e3, r.restitution);
        TEST_ASSERT_DOUBLE_WITHIN(0.05 * expected[i][1], expected[i][1], r.force);
        TEST_ASSERT_DOUBLE_WITHIN(0.05 * expected[i][2], expected[i][2], r.contact);
        TEST_ASSERT_DOUBLE_WITHIN(0.05 * expected[i][3], expected[i][3], r.restitution);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.030 * expected[i][0] * (1 + r.restitution), r.impulse);
    }
}

// against a rigid wall the collision is known: c_max from energy, and the lossless rebound is
// perfect
static void test_contact_with_a_rigid_head_follows_hertz(void)
{
    place(0, 1.5, 0, 2); // outside the head every shape is 0
    stick[0].head.stiffness = 1e7;
    double most = 0, k = 1e7, alpha = 2.54;
    for (int n = 0; n < 1500; n++) {
        himc_contact_step(membrane, sticks, 1);
        most = fmax(most, stick[0].force);
    }
    double c = pow(0.5 * 0.03 * 4 * (alpha + 1) / k, 1 / (alpha + 1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * k * pow(c, alpha), k * pow(c, alpha), most);
    TEST_ASSERT_DOUBLE_WITHIN(1e-10, 2, stick[0].velocity);
}

// Hunt & Crossley 1975: for small losses the rebound is about 1 - 2 mu v/3 of the impact's
static void test_contact_loss_agrees_with_hunt_and_crossley(void)
{
    place(0, 1.5, 0, 1);
    stick[0].head.loss = 0.03;
    for (int n = 0; n < 1500; n++)
        himc_contact_step(membrane, sticks, 1);
    TEST_ASSERT_DOUBLE_WITHIN(1.5e-3, 1 - 2 * 0.03 / 3, stick[0].velocity);
}

static void test_contact_of_two_equal_points_equals_one_twice_as_heavy_and_stiff(void)
{
    place(0, -0.5, 0.1, 3);
    place(1, -0.5, 0.1, 3);
    make_point(0);
    make_point(1);
    for (int n = 0; n < 200; n++)
        himc_contact_step(membrane, sticks, 2);
    himc_stick first = stick[0];
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, first.height, stick[1].height);
    remake();
    place(0, -0.5, 0.1, 3);
    make_point(0);
    stick[0].mass *= 2;
    stick[0].head.stiffness *= 2;
    for (int n = 0; n < 200; n++)
        himc_contact_step(membrane, sticks, 1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-10, stick[0].height, first.height);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, stick[0].force, 2 * first.force);
}

static void test_contact_converges_with_the_square_of_the_step(void)
{
    static const double rates[] = {24000, 48000, 96000, 384000};
    double v[4];
    for (int i = 0; i < 4; i++) {
        himc_membrane_free(membrane);
        membrane = himc_membrane_new(&head, rates[i], NULL);
        place(0, -0.75, 0, 2);
        for (int n = 0; n < (int)(0.02 * rates[i]); n++)
            himc_contact_step(membrane, sticks, 1);
        v[i] = stick[0].velocity;
    }
    double coarse = fabs(v[0] - v[3]), middle = fabs(v[1] - v[3]), fine = fabs(v[2] - v[3]);
    TEST_ASSERT_TRUE(middle < 1e-4);
    TEST_ASSERT_TRUE(coarse / middle > 2.5 && middle / fine > 2.5);
}

static void test_contact_keeps_its_first_point_until_it_ends(void)
{
    place(0, -0.75, 0, 2);
    double x = stick[0].x;
    for (int n = 0; n < 100; n++) {
        himc_contact_step(membrane, sticks, 1);
        TEST_ASSERT_TRUE(stick[0].touching);
        TEST_ASSERT_EQUAL_DOUBLE(x, stick[0].contact_x);
        stick[0].x += 1e-4;
    }
}

// it is not solved with the stick that strikes, at any place that it passes
static void test_a_stick_that_passes_over_a_blow_changes_no_bit(void)
{
    static double force[2][400], sound[2][400];
    for (int run = 0; run < 2; run++) {
        remake();
        place_all();
        for (int n = 0; n < 400; n++) {
            stick[2].height = 0.006;
            stick[2].velocity = 0;
            stick[2].x += 5e-6;
            himc_contact_step(membrane, (himc_stick *[]){&stick[0], &stick[2]}, 1 + run);
            force[run][n] = stick[0].force;
            sound[run][n] = himc_membrane_sound(membrane, 0);
        }
    }
    TEST_ASSERT_TRUE(force[0][1] > 0);
    TEST_ASSERT_EQUAL_MEMORY(force[0], force[1], sizeof *force);
    TEST_ASSERT_EQUAL_MEMORY(sound[0], sound[1], sizeof *sound);
}

static void test_contact_force_is_that_of_the_first_point_wherever_the_stick_goes(void)
{
    double force[300];
    for (int run = 0; run < 2; run++) {
        remake();
        place(0, -0.75, 0, 2);
        for (int n = 0; n < 300; n++) {
            himc_contact_step(membrane, sticks, 1);
            if (run == 0)
                force[n] = stick[0].force;
            TEST_ASSERT_TRUE(stick[0].touching);
            TEST_ASSERT_EQUAL_DOUBLE(force[n], stick[0].force);
            stick[0].x += run * 1e-4;
        }
    }
}

static void test_contact_keeps_its_force_when_the_head_is_tuned_up_or_down(void)
{
    for (double ratio = 0.5; ratio <= 2; ratio *= 4) {
        christian(200);
        remake();
        place(0, -0.75, 0, 2);
        double before = 0;
        for (int n = 0; n < 100; n++) {
            before = stick[0].force;
            himc_contact_step(membrane, sticks, 1);
        }
        double expected = 2 * stick[0].force - before;
        head.tension *= ratio;
        TEST_ASSERT_TRUE(himc_membrane_set_head(membrane, &head, NULL));
        himc_contact_step(membrane, sticks, 1);
        TEST_ASSERT_TRUE(expected > 10);
        TEST_ASSERT_DOUBLE_WITHIN(0.05 * expected, expected, stick[0].force);
    }
}

static void test_contact_never_pulls_however_large_its_loss(void)
{
    double last = 1;
    place(0, -0.75, 0, 3);
    stick[0].head.loss = 5;
    for (int n = 0; n < 1500; n++) {
        himc_contact_step(membrane, sticks, 1);
        TEST_ASSERT_TRUE(stick[0].force >= 0);
        last = stick[0].force;
    }
    TEST_ASSERT_EQUAL_DOUBLE(0, last);
}

// the head keeps the shapes of its latest points
static void test_contact_at_two_new_points_is_the_same_after_many_others(void)
{
    himc_stick fresh[2];
    for (int run = 0; run < 2; run++) {
        remake();
        for (int i = 0; run && i < 100; i++)
            himc_membrane_displacement(membrane, 0.002 * i, 0.1);
        place(0, -0.75, 0, 4);
        place(1, 0.5, 0.3, 3);
        for (int n = 0; n < 300; n++)
            himc_contact_step(membrane, sticks, 2);
        if (run == 0)
            memcpy(fresh, stick, sizeof fresh);
        TEST_ASSERT_EQUAL_MEMORY(fresh, stick, sizeof fresh);
    }
}

// the displacement that a one-way stick adds to a head that swings by millimetres, and that the
// forces of its motion would add
static void one_way_response(double *added, double *allowed)
{
    himc_membrane *swing[3] = {membrane, himc_membrane_new(&head, RATE, NULL),
                               himc_membrane_new(&head, RATE, NULL)};
    double x = -0.75 * head.radius;
    *added = *allowed = 0;
    for (int n = 0; n < 2400; n++) {
        double d[3], motion = stick[0].force;
        for (int i = 0; i < 3; i++) {
            if (n < 100)
                himc_membrane_push(swing[i], 0, 0, 300);
            if (i == 1 && n > 0)
                himc_membrane_push(swing[i], x, 0, motion);
            if (i == 0 && n == 100)
                place(0, -0.75, 0, 0.2);
            stick[0].one_way = true;
            himc_contact_step(swing[i], sticks, i == 0 && n >= 100);
            d[i] = himc_membrane_displacement(swing[i], x, 0);
        }
        *added = fmax(*added, fabs(d[0] - d[2]));
        *allowed = fmax(*allowed, fabs(d[1] - d[2]));
    }
    himc_membrane_free(swing[1]);
    himc_membrane_free(swing[2]);
}

static void test_one_way_force_on_a_swinging_head_is_at_most_that_of_the_motion(void)
{
    double added, allowed;
    stick[0].force = 0;
    one_way_response(&added, &allowed);
    printf("one-way stick on a swinging head: %.2g m of %.2g m\n", added, allowed);
    TEST_ASSERT_TRUE(added > 0 &&
                     added < 1.2 * allowed); // a part of them may meet the swing better
}

static void test_one_way_stick_is_not_moved_by_the_head(void)
{
    place(0, -0.75, 0, 3);
    stick[0].one_way = true;
    for (int n = 0; n < 100; n++) {
        himc_membrane_push(membrane, -0.2, 0, 300);
        himc_contact_step(membrane, sticks, 1);
    }
    himc_stick on_moving = stick[0];
    remake();
    place(0, 1.5, 0, 3); // a rigid head: outside
    for (int n = 0; n < 100; n++)
        himc_contact_step(membrane, sticks, 1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, stick[0].height, on_moving.height);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, stick[0].force, on_moving.force);
}

static double one_way_energy(double velocity)
{
    remake();
    place(0, -0.75, 0, velocity);
    stick[0].one_way = true;
    for (int n = 0; n < 1500; n++)
        himc_contact_step(membrane, sticks, 1);
    TEST_ASSERT_FALSE(stick[0].touching);
    TEST_ASSERT_EQUAL_DOUBLE(0, stick[0].force);
    return himc_membrane_energy(membrane);
}

static void test_one_way_force_grows_with_velocity_and_stays_finite_for_any_stiffness(void)
{
    double soft = one_way_energy(1), middle = one_way_energy(2), loud = one_way_energy(4);
    TEST_ASSERT_TRUE(soft > 0 && middle > 2 * soft && loud > 2 * middle);
    remake();
    place_all();
    for (int i = 0; i < STICKS; i++) {
        stick[i].one_way = true;
        stick[i].head.stiffness = 1e12;
    }
    for (int n = 0; n < 1500; n++)
        himc_contact_step(membrane, sticks, STICKS);
    TEST_ASSERT_TRUE(isfinite(himc_membrane_energy(membrane)) &&
                     himc_membrane_energy(membrane) < 100);
}

// a one-way stick meets a rigid head at rest: Hertz's force, whatever the exponent
static void test_one_way_motion_force_follows_hertz_with_the_mallets_exponent(void)
{
    static const double exponent[] = {1.5, 2, 2.54, 3}, stiffness[] = {1e5, 1e6, 1e8, 1e9};
    for (int i = 0; i < 4; i++) {
        double k = stiffness[i], alpha = exponent[i], most = 0;
        remake();
        place(0, -0.75, 0, 2);
        stick[0].one_way = true;
        stick[0].head.stiffness = k;
        stick[0].head.exponent = alpha;
        for (int n = 0; n < 1500; n++) {
            himc_contact_step(membrane, sticks, 1);
            most = fmax(most, stick[0].force);
        }
        double c = pow(0.5 * 0.03 * 4 * (alpha + 1) / k, 1 / (alpha + 1));
        TEST_ASSERT_DOUBLE_WITHIN(2e-3 * k * pow(c, alpha), k * pow(c, alpha), most);
    }
}

// k_s = k F_m/100 N (table 2): a head too heavy to move takes sum of F F_m/100 h, F_m the largest F
// so far
static void test_one_way_head_force_scales_with_the_peak_of_the_motion_force(void)
{
    static const double exponent[] = {1.5, 2.54}, stiffness[] = {1e5, 1e7};
    for (int i = 0; i < 2; i++) {
        double peak = 0, impulse = 0, q, v;
        head.modes = 1;
        head.density = 10;
        head.radius = 1;
        head.tension = 100;
        head.decay_constant = head.decay_square = 0;
        remake();
        place(0, 0, 0, 1);
        make_point(0);
        stick[0].one_way = true;
        stick[0].head.stiffness = stiffness[i];
        stick[0].head.exponent = exponent[i];
        for (int n = 0; n < 1500 && (n == 0 || stick[0].touching); n++) {
            himc_contact_step(membrane, sticks, 1);
            peak = fmax(peak, stick[0].force);
            impulse += peak / 100 * stick[0].force / RATE;
        }
        TEST_ASSERT_TRUE(peak > 5 && peak < 50);
        himc_membrane_state(membrane, 0, &q, &v);
        himc_mode mode = himc_membrane_mode(membrane, 0);
        TEST_ASSERT_DOUBLE_WITHIN(0.03 * impulse, impulse, -v * mode.mass);
    }
}

static void test_contact_counts_chatter_as_one_contact(void)
{
    place(0, -0.75, 0, 4);
    stick[0].head.stiffness = 1e10;
    stick[0].acceleration = -9.81;
    int flights = 0, quiet = 0;
    for (int n = 0; n < 9600; n++) {
        himc_contact_step(membrane, sticks, 1);
        quiet = stick[0].force > 0 ? 0 : quiet + 1;
        flights += quiet == 73; // more than 1.5 ms
        TEST_ASSERT_TRUE((int)stick[0].contacts <= flights + 1);
        if (n == 0)
            TEST_ASSERT_EQUAL_DOUBLE(4, stick[0].impact);
    }
    TEST_ASSERT_TRUE(flights > 0 && stick[0].contacts >= 1);
}

// a rigid head, and a stick that is driven back onto it some time after it left
static unsigned contacts_with_gap(double gap)
{
    place(0, 1.5, 0, 2); // outside the head every shape is 0
    while (stick[0].velocity < 0 || stick[0].touching)
        himc_contact_step(membrane, sticks, 1);
    stick[0].acceleration = -2 * stick[0].velocity / gap;
    for (int n = 0; n < (int)(2 * gap * RATE); n++)
        himc_contact_step(membrane, sticks, 1);
    return stick[0].contacts;
}

static void test_touches_1_ms_apart_are_one_contact_and_2_ms_apart_two(void)
{
    TEST_ASSERT_EQUAL_INT(1, contacts_with_gap(1e-3));
    TEST_ASSERT_EQUAL_INT(2, contacts_with_gap(2e-3));
}

static void test_contact_clear_never_returns_too_many_samples(void)
{
    place(0, 0, 0, 10);
    stick[0].height = 0.2;
    stick[0].acceleration = -50;
    while (stick[0].height > 0) {
        int clear = himc_contact_clear(membrane, sticks, 1, 64);
        for (int i = 0; i < clear; i++) {
            himc_stick_fly(&stick[0], 1 / RATE);
            TEST_ASSERT_TRUE(stick[0].height > 0);
        }
        if (clear == 0)
            himc_contact_step(membrane, sticks, 1);
    }
    TEST_ASSERT_EQUAL_INT(0, himc_contact_clear(membrane, sticks, 1, 64));
}

static void test_contact_with_a_stick_that_is_not_a_number_does_not_change_the_head(void)
{
    place(0, -0.75, 0, 2);
    stick[0].velocity = NAN;
    place(1, -0.5, 0, 2);
    for (int n = 0; n < 600; n++)
        himc_contact_step(membrane, sticks, 2);
    TEST_ASSERT_TRUE(isfinite(himc_membrane_energy(membrane)));
    TEST_ASSERT_TRUE(isfinite(stick[1].velocity) && stick[1].velocity > 0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_contact_without_losses_keeps_energy_for_any_stiffness);
    RUN_TEST(test_contact_energy_never_grows_in_any_step_with_losses);
    RUN_TEST(test_contact_forces_times_and_rebounds_agree_with_the_published_model);
    RUN_TEST(test_contact_with_a_rigid_head_follows_hertz);
    RUN_TEST(test_contact_loss_agrees_with_hunt_and_crossley);
    RUN_TEST(test_contact_of_two_equal_points_equals_one_twice_as_heavy_and_stiff);
    RUN_TEST(test_contact_converges_with_the_square_of_the_step);
    RUN_TEST(test_contact_keeps_its_first_point_until_it_ends);
    RUN_TEST(test_a_stick_that_passes_over_a_blow_changes_no_bit);
    RUN_TEST(test_contact_force_is_that_of_the_first_point_wherever_the_stick_goes);
    RUN_TEST(test_contact_keeps_its_force_when_the_head_is_tuned_up_or_down);
    RUN_TEST(test_contact_never_pulls_however_large_its_loss);
    RUN_TEST(test_contact_at_two_new_points_is_the_same_after_many_others);
    RUN_TEST(test_one_way_force_on_a_swinging_head_is_at_most_that_of_the_motion);
    RUN_TEST(test_one_way_stick_is_not_moved_by_the_head);
    RUN_TEST(test_one_way_force_grows_with_velocity_and_stays_finite_for_any_stiffness);
    RUN_TEST(test_one_way_motion_force_follows_hertz_with_the_mallets_exponent);
    RUN_TEST(test_one_way_head_force_scales_with_the_peak_of_the_motion_force);
    RUN_TEST(test_contact_counts_chatter_as_one_contact);
    RUN_TEST(test_touches_1_ms_apart_are_one_contact_and_2_ms_apart_two);
    RUN_TEST(test_contact_clear_never_returns_too_many_samples);
    RUN_TEST(test_contact_with_a_stick_that_is_not_a_number_does_not_change_the_head);
    return UNITY_END();
}
