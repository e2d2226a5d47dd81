/// test_own_kind.c: a kind of instrument in one file: a free bar (Euler and Bernoulli), which a
/// performer plays, damps and tunes, and which is sent to be drawn.
///
/// phi(u) = cos(lam u)/cos(lam/2) + cosh(lam u)/cosh(lam/2), or sin and sinh, u from -1/2 to 1/2
/// along the bar, cos(lam) cosh(lam) = 1; frequencies as lam^2 (Fletcher & Rossing 1998, section
/// 2.15).
#include "osc_ear.h"

#include "inner_state.h"

#include "drum/drum_performer.h"
#include "drum/membrane_state.h"
#include "head/modes.h"
#include "head/pickup.h"
#include "performance/performance_state.h"

#define LENGTH 0.35 // (m)
#define WIDTH 0.08  // (m)
#define MODES 6
#define POINTS 400 // of an integral along the bar

static double lambda(int n)
{
    double l = (n + 0.5) * HIMC_PI;
    for (int i = 0; i < 8; i++)
        l -= (cos(l) - 1 / cosh(l)) / (tanh(l) / cosh(l) - sin(l));
    return l;
}

static double shape_along(int n, double u)
{
    double l = lambda(n);
    return n % 2 ? cos(l * u) / cos(l / 2) + cosh(l * u) / cosh(l / 2)
                 : sin(l * u) / sin(l / 2) + sinh(l * u) / sinh(l / 2);
}

// sides per radius
static double side(const himc_shape *shape, double length)
{
    return 2 * length / hypot(shape->length, shape->width);
}

static void fit(const himc_shape *shape, himc_head *head)
{
    head->radius = 0.5 * hypot(shape->length, shape->width);
    head->density = 24;
}

// x is along the bar; a performer plays it near the middle, or on a node of its first mode
static void surface(const himc_shape *shape, himc_head_frame *surface)
{
    static const double spots[] = {
        [HIMC_SPOT_CENTER] = 0, [HIMC_SPOT_NORMAL] = 0.1, [HIMC_SPOT_RIM] = 0.538};
    surface->length = side(shape, shape->length) * surface->radius;
    surface->width = side(shape, shape->width) * surface->radius;
    surface->spots = spots;
}

static double principal(const himc_shape *shape)
{
    (void)shape;
    return lambda(1) * lambda(1);
}

static double no_film(const himc_shape *shape)
{
    (void)shape;
    return 0;
}

static bool list(himc_modes *modes, bool automatic)
{
    (void)automatic;
    double area = side(&modes->shape, LENGTH) * side(&modes->shape, WIDTH);
    modes->entries = malloc(sizeof *modes->entries * (size_t)modes->exact);
    for (int i = 0; modes->entries && i < modes->exact; i++)
        modes->entries[i] =
            (himc_mode_entry){0, i + 1, lambda(i + 1) * lambda(i + 1), area / HIMC_PI};
    modes->entry_count = modes->exact;
    return modes->entries;
}

static void shapes(const himc_modes *modes, double radius, double x, double y, double *out)
{
    double u = x / radius / side(&modes->shape, LENGTH);
    bool inside = fabs(u) < 0.5 && fabs(y / radius) < 0.5 * side(&modes->shape, WIDTH);
    for (int i = 0; i < modes->count; i++)
        out[i] = inside ? shape_along(i + 1, u) : 0;
}

static void transform(const himc_modes *modes, int index, double kx, double ky, double *even,
                      double *odd)
{
    double a = side(&modes->shape, LENGTH), b = side(&modes->shape, WIDTH), s = 0.5 * ky * b;
    double across = b * (s != 0 ? sin(s) / s : 1);
    *even = *odd = 0;
    for (int i = 0; i < POINTS; i++) {
        double u = (i + 0.5) / POINTS - 0.5, part = a * across / POINTS * shape_along(index + 1, u);
        *even += part * cos(kx * a * u);
        *odd += part * sin(kx * a * u);
    }
}

static const himc_kind bar_kind = {.name = "bar",
                                   .usual = MODES,
                                   .fit = fit,
                                   .surface = surface,
                                   .principal = principal,
                                   .film = no_film,
                                   .list = list,
                                   .shapes = shapes,
                                   .far = himc_pickup_of_outline,
                                   .transform = transform};

// a performer with a bar before it; owned by the performance
static himc_drum *add_bar(double hz)
{
    himc_error error = {0};
    himc_drum *model = himc_drum_new("bar", 14, 48000, &error);
    himc_drum_settings s = himc_drum_settings_of(model);
    s.head.shape = (himc_shape){.kind = &bar_kind, .length = LENGTH, .width = WIDTH};
    s.head.head = (himc_head){.modes = MODES, .decay_constant = 2.4};
    s.head.head.uniformity = 1;
    bar_kind.fit(&s.head.shape, &s.head.head);
    s.head.head.tension = himc_head_tension(&s.head.head, &s.head.shape, hz);
    s.usual = s.head.head;
    s.noise = 0; // a bar as it is here radiates little
    s.place.radius = s.head.head.radius;
    surface(&s.head.shape, &s.place);
    himc_drum *bar = himc_drum_new_of(&s, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(bar, error.text);
    TEST_ASSERT_TRUE_MESSAGE(himc_performance_add_drum(performance, bar, &error), error.text);
    himc_drum_settings_free(&s);
    himc_drum_release(model);
    himc_drum_release(bar);
    return bar;
}

static double energy(himc_drum *bar)
{
    return himc_membrane_energy(himc_drum_membrane(bar));
}

// power of the last half second of a bar's sound at a frequency
static double power_at(const himc_drum *bar, double hz)
{
    static double sound[HIMC_DRUM_RING];
    const int n = 4096;
    double even = 0, odd = 0;
    himc_drum_read(bar, himc_drum_time(bar) - (uint64_t)n, n, sound, NULL);
    for (int i = 0; i < n; i++) {
        double window = 1 - cos(2 * HIMC_PI * i / n);
        even += window * sound[i] * cos(2 * HIMC_PI * hz * i / 48000);
        odd += window * sound[i] * sin(2 * HIMC_PI * hz * i / 48000);
    }
    return even * even + odd * odd;
}

static void test_the_bar_has_the_frequencies_of_a_free_bar(void)
{
    const double ratio[] = {1, 2.7565, 5.4039, 8.9330};
    himc_membrane *head = himc_drum_membrane(add_bar(220));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 220, himc_membrane_mode(head, 0).frequency);
    for (int i = 0; i < 4; i++)
        TEST_ASSERT_DOUBLE_WITHIN(5e-4, ratio[i],
                                  himc_membrane_mode(head, i).frequency /
                                      himc_membrane_mode(head, 0).frequency);
    for (int i = 0; i < MODES; i++) // of the same mass, that of the bar: phi has a mean square of 1
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 24 * LENGTH * WIDTH, himc_membrane_mode(head, i).mass);
}

static void test_a_score_plays_the_bar(void)
{
    himc_drum *bar = add_bar(220);
    subscribe("strikes");
    say("/himc/tempo", "120");
    say("/himc/stroke", "1 right legato f normal bar");
    say("/himc/stroke", "2 left accent f normal bar");
    say("/himc/stroke", "3 right legato f -0.1 0 bar");
    say("/himc/play", "");
    play(3);
    TEST_ASSERT_EQUAL_STRING("", last_error());
    TEST_ASSERT_EQUAL_INT(3, count("/himc/strike"));
    for (int i = 0; i < heard_count; i++)
        if (strcmp(heard[i].path, "/himc/strike") == 0)
            TEST_ASSERT_EQUAL_STRING("bar", word(lo_message_get_argv(heard[i].message)[2]));
    double lowest = power_at(bar, 220);
    TEST_ASSERT_TRUE(lowest > 0 && lowest > 1e3 * power_at(bar, 400));
}

// one past its side is led onto it, one for its end lands there; a mallet must meet the bar
static void test_strokes_land_on_the_bar_alone(void)
{
    himc_drum *bar = add_bar(220);
    himc_error error = {0};
    subscribe("strikes");
    say("/himc/tempo", "120");
    say("/himc/stroke", "1 right legato f 0 0.1 bar");
    say("/himc/stroke", "2 left legato f rim bar");
    say("/himc/play", "");
    play(3);
    TEST_ASSERT_EQUAL_INT(2, count("/himc/strike"));
    double at[2][2];
    for (int i = 0, k = 0; i < heard_count; i++)
        if (strcmp(heard[i].path, "/himc/strike") == 0) {
            for (int j = 0; j < 2; j++)
                at[k][j] = number(lo_message_get_argv(heard[i].message)[3 + j]);
            k++;
        }
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.97 * 0.5 * WIDTH, at[0][1]);
    TEST_ASSERT_DOUBLE_WITHIN(0.002, -0.538 * himc_drum_head_frame(bar)->radius, at[1][0]);
    TEST_ASSERT_TRUE(
        himc_drum_strike_at(bar, HIMC_STRIKE_NEVER, 0.49 * LENGTH, 0.49 * WIDTH, 1, &error));
    TEST_ASSERT_FALSE(himc_drum_strike_at(bar, HIMC_STRIKE_NEVER, 0, 0.51 * WIDTH, 1, &error));
    TEST_ASSERT_FALSE(himc_drum_strike_at(bar, HIMC_STRIKE_NEVER, 0.51 * LENGTH, 0, 1, &error));
}

// where the first strike that is heard lands, across the head (m)
static double first_across(void)
{
    for (int i = 0; i < heard_count; i++)
        if (strcmp(heard[i].path, "/himc/strike") == 0)
            return number(lo_message_get_argv(heard[i].message)[4]);
    return NAN;
}

// both of one radius, and the performer has planned for the first
static void test_a_head_turned_by_a_quarter_is_struck_inside_its_new_sides(void)
{
    himc_drum *kettle = himc_performance_drum(performance, 0);
    subscribe("strikes");
    say("/membrane/kettle/shape", "rectangle 0.6 0.4");
    play(0.1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.6, himc_drum_head_frame(kettle)->length);
    say("/membrane/kettle/shape", "rectangle 0.4 0.6");
    play(0.1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.4, himc_drum_head_frame(kettle)->length);
    say("/himc/stroke", "1 left legato f 0 0.25");
    say("/himc/play", "");
    play(2);
    TEST_ASSERT_DOUBLE_WITHIN(0.003, 0.25, first_across());
}

static void test_hands_rest_over_the_bar(void)
{
    himc_drum *bar = add_bar(220);
    const himc_head_frame *frame = himc_drum_head_frame(bar);
    say("/himc/stroke", "1 right legato f normal bar");
    say("/himc/stroke", "1 left legato f normal bar");
    say("/himc/play", "");
    play(4);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_vec3 tip = performance->body->state.tip[hand];
        himc_vec3 at = himc_head_frame_from_world(frame, tip);
        TEST_ASSERT_TRUE(himc_head_frame_contains(frame, at.x, at.y) && at.z > 0.02);
    }
}

static void test_a_damped_bar_rings_shorter(void)
{
    double left[2];
    himc_drum *bar = add_bar(220);
    for (int damped = 0; damped < 2; damped++) {
        say("/membrane/bar/damp", damped ? "0.2" : "0");
        say("/membrane/bar/strike", "0.03 0 3");
        play(0.1);
        double before = energy(bar);
        play(0.2);
        left[damped] = energy(bar) / before;
        play(3);
    }
    TEST_ASSERT_EQUAL_STRING("", last_error());
    TEST_ASSERT_DOUBLE_WITHIN(0.05, exp(-2 * 2.4 * 0.2), left[0]);
    TEST_ASSERT_TRUE(left[1] < 0.05 * left[0]);
}

static void test_tuning_moves_all_modes_of_the_bar_by_one_ratio(void)
{
    himc_drum *bar = add_bar(220);
    himc_mode before[MODES];
    for (int i = 0; i < MODES; i++)
        before[i] = himc_membrane_mode(himc_drum_membrane(bar), i);
    say("/membrane/bar/tune", "330");
    say("/membrane/bar/strike", "0.03 0 3");
    play(0.3);
    for (int i = 0; i < MODES; i++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-4 * before[i].frequency, 1.5 * before[i].frequency,
                                  himc_membrane_mode(himc_drum_membrane(bar), i).frequency);

    TEST_ASSERT_TRUE(power_at(bar, 330) > 1e3 * power_at(bar, 220));
}

// what is sent of the modes gives the displacement of the bar at its points
static void test_the_bar_is_drawn_from_what_is_sent(void)
{
    himc_drum *bar = add_bar(220);
    himc_membrane *head = himc_drum_membrane(bar);
    subscribe("head 50");
    play(0.1);
    say("/membrane/bar/strike", "0.03 0 3");
    play(0.3);
    for (int known = count("/membrane/bar/head"); count("/membrane/bar/head") == known;)
        play(0.004);
    const lo_arg **place =
        (const lo_arg **)lo_message_get_argv(last("/membrane/bar/place")->message);
    TEST_ASSERT_EQUAL_FLOAT(LENGTH, number(place[5]));
    TEST_ASSERT_EQUAL_FLOAT(WIDTH, number(place[6]));
    const seen *s = last("/membrane/bar/head");
    TEST_ASSERT_EQUAL_INT(MODES, lo_message_get_argc(s->message));
    double shape[MODES], q[MODES];
    himc_membrane_upright(head, MODES, NULL, q);
    for (int i = 0; i < MODES; i++)
        TEST_ASSERT_EQUAL_FLOAT((float)q[i], number(lo_message_get_argv(s->message)[i]));
    const himc_membrane_config *config = himc_membrane_config_of(head);
    himc_modes *modes = himc_modes_new(&config->shape, MODES, NULL);
    double moved = 0;
    for (int k = -9; k <= 9; k++) {
        double x = 0.05 * k * LENGTH, sum = 0;
        himc_modes_shapes(modes, config->head.radius, x, 0.02, shape);
        for (int i = 0; i < MODES; i++)
            sum += q[i] * shape[i];
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, sum, himc_membrane_displacement(head, x, 0.02));
        moved = fmax(moved, fabs(sum));
    }
    TEST_ASSERT_TRUE(moved > 1e-7);
    TEST_ASSERT_EQUAL_DOUBLE(0, himc_membrane_displacement(head, 0, 0.51 * WIDTH));
    himc_modes_free(modes);
}

static void test_the_energy_of_a_bar_that_rings_never_grows(void)
{
    himc_drum *bar = add_bar(220);
    say("/membrane/bar/strike", "0.03 0 3");
    play(0.2);
    for (double last_energy = energy(bar), now; last_energy > 1e-9; last_energy = now) {
        play(0.02);
        now = energy(bar);
        TEST_ASSERT_TRUE(now <= last_energy);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_bar_has_the_frequencies_of_a_free_bar);
    RUN_TEST(test_a_score_plays_the_bar);
    RUN_TEST(test_strokes_land_on_the_bar_alone);
    RUN_TEST(test_a_head_turned_by_a_quarter_is_struck_inside_its_new_sides);
    RUN_TEST(test_hands_rest_over_the_bar);
    RUN_TEST(test_a_damped_bar_rings_shorter);
    RUN_TEST(test_tuning_moves_all_modes_of_the_bar_by_one_ratio);
    RUN_TEST(test_the_bar_is_drawn_from_what_is_sent);
    RUN_TEST(test_the_energy_of_a_bar_that_rings_never_grows);
    return UNITY_END();
}
