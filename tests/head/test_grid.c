/// test_grid.c: heads that are not round: a rectangle, and masses and springs.
#define _DEFAULT_SOURCE // mkdtemp
#include "himc/membrane.h"
#include "himc/drum.h"

#include "disc_mesh.h"
#include "head/bessel.h"
#include "drum/contact.h"
#include "drum/drum_state.h"
#include "head/modes.h"
#include "heads.h"
#include "inner_state.h"

#define RADIUS 0.3
#define TENSION 3000.0
#define DENSITY 0.26

static char folder[] = "/tmp/himc-grid-XXXXXX";
static himc_error error;
static himc_drum *drum;

void setUp(void)
{
    error.text[0] = '\0';
    drum = himc_drum_new("head", 23, 48000, &error);
}

void tearDown(void)
{
    himc_drum_release(drum);
}

static bool say(const char *text)
{
    himc_command command;
    return himc_command_parse_text(&command, HIMC_DRUM, text, &error) &&
           himc_drum_command(drum, &command, &error);
}

static bool shape_of(const char *name)
{
    char text[400];
    snprintf(text, sizeof text, "shape %s/%s", folder, name);
    return say(text);
}

static void put(const char *name, const char *text)
{
    char path[300];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *f = fopen(path, "w");
    fputs(text, f);
    fclose(f);
}

// largest errors, in cents, of the first 10 and 20 modes against Bessel's
static void compare(const himc_grid *g, double *ten, double *twenty)
{
    himc_modes *round = himc_modes_new(&(himc_shape){.kind = &himc_kind_round}, 20, NULL);
    himc_head head = dry_head();
    *ten = *twenty = 0;
    for (int i = 0; i < 20; i++) {
        double z = himc_modes_get(round, &head, i).zero;
        double cents = fabs(1200 * log2(g->zero[i] / z));
        *ten = i < 10 ? fmax(*ten, cents) : *ten;
        *twenty = fmax(*twenty, cents);
    }
    himc_modes_free(round);
}

// of (0,1), per that for no wave at all: j^2 J_0(k)/(j^2 - k^2)
static void check_transform(himc_grid *g)
{
    himc_shape shape = {.kind = &himc_kind_grid, .grid = g};
    himc_modes *modes = himc_modes_new(&shape, 1, &error);
    double j = himc_bessel_zero(0, 1), k = 1.5, none, even, odd;
    shape.kind->transform(modes, 0, 0, 0, &none, &odd);
    shape.kind->transform(modes, 0, k * cos(1), k * sin(1), &even, &odd);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, j * j * himc_bessel_j(0, k) / (j * j - k * k), even / none);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0, odd / none);
    himc_modes_free(modes);
}

static void load_disc(int rings, double ten_most, double twenty_most)
{
    char path[300];
    double ten, twenty;
    disc_mesh d = disc_mesh_new(rings, RADIUS, TENSION, DENSITY);
    disc_mesh_write(&d, folder, TENSION, DENSITY);
    snprintf(path, sizeof path, "%s/head.txt", folder);
    himc_grid *g = himc_grid_load(path, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(g, error.text);
    TEST_ASSERT_EQUAL_INT(d.inner, g->places);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, RADIUS, g->radius);
    compare(g, &ten, &twenty);
    check_transform(g);
    printf("%d places: first 10 within %.2f cents, first 20 within %.2f\n", d.all, ten, twenty);
    TEST_ASSERT_TRUE(ten < ten_most && twenty < twenty_most);
    himc_grid_release(g);
    disc_mesh_free(&d);
}

static void test_grid_of_a_disc_has_bessels_modes(void)
{
    if (getenv("HIMC_LONG"))
        load_disc(26, 10, 20);
    load_disc(12, 10, 20);
}

static void test_grid_of_a_disc_sounds_as_the_round_head_when_struck(void)
{
    static double sound[2][9600];
    double peak[2] = {0}, force[2];
    const char *lines[] = {"air 0", "modes 60", "decay 3 1e-6"};
    for (int k = 0; k < 2; k++) {
        char text[100];
        tearDown();
        setUp();
        for (int i = 0; i < 3; i++)
            TEST_ASSERT_TRUE_MESSAGE(say(lines[i]), error.text);
        snprintf(text, sizeof text, "radius %g", RADIUS);
        TEST_ASSERT_TRUE(k == 1 ? shape_of("head.txt") : say(text));
        snprintf(text, sizeof text, "tension %g", TENSION);
        TEST_ASSERT_TRUE(say(text) && (k == 1 || say("density 0.26")));
        drum->set.mallet[HIMC_RIGHT].radius = 0; // a place of a grid is a point
        TEST_ASSERT_TRUE(say("strike -0.2 0.03 4"));
        himc_drum_advance(drum, 9600, NULL, NULL, NULL);
        himc_drum_read(drum, 0, 9600, sound[k], NULL);
        himc_contact_report report;
        TEST_ASSERT_TRUE(himc_drum_strike_next(drum, &report));
        force[k] = report.force;
        for (int i = 0; i < 9600; i++)
            peak[k] = fmax(peak[k], fabs(sound[k][i]));
    }
    printf("force %.1f and %.1f N, peak %.3f and %.3f\n", force[0], force[1], peak[0], peak[1]);
    TEST_ASSERT_DOUBLE_WITHIN(0.03 * force[0], force[0], force[1]);
    TEST_ASSERT_DOUBLE_WITHIN(0.1 * peak[0], peak[0], peak[1]);
}

// growth of the energy above its lowest so far when `count` sticks strike, as a fraction of the
// blow
static double growth_of(int count, double k)
{
    himc_membrane *m = himc_drum_membrane(drum);
    himc_stick stick[4], *sticks[4];
    double start = 0, lowest, growth = 0;
    himc_membrane_rest(m);
    for (int i = 0; i < count; i++) {
        stick[i] = (himc_stick){
            .head = {.stiffness = k, .exponent = 2.54, .loss = 0.1, .mass = 0.03, .radius = 0.0175},
            .mass = 0.03,
            .x = -0.15 + 0.02 * i,
            .y = 0.03 * i,
            .velocity = -6 - i};
        sticks[i] = &stick[i];
        start += himc_contact_energy(&stick[i]);
    }
    lowest = start;
    for (int n = 0; n < 600; n++) {
        himc_contact_step(m, sticks, count);
        double now = himc_membrane_energy(m);
        for (int i = 0; i < count; i++)
            now += himc_contact_energy(&stick[i]);
        growth = fmax(growth, (now - lowest) / start);
        lowest = fmin(lowest, now);
    }
    TEST_ASSERT_TRUE(himc_membrane_rise(m) > 0 && lowest < start);
    return growth;
}

static void test_grid_energy_never_grows_with_glide_and_any_sticks(void)
{
    double worst = 0;
    TEST_ASSERT_TRUE_MESSAGE(shape_of("head.txt"), error.text);
    TEST_ASSERT_EQUAL_DOUBLE(1, himc_membrane_head(himc_drum_membrane(drum))->glide);
    for (int count = 1; count <= 4; count++)
        for (double k = 1e6; k < 2e12; k *= 100)
            worst = fmax(worst, growth_of(count, k));
    printf("largest growth %.2g of the blow\n", worst);
    TEST_ASSERT_TRUE(worst < 1e-12);
}

static void refuses(const char *file, const char *text, const char *says)
{
    put(file, text);
    TEST_ASSERT_FALSE_MESSAGE(shape_of("bad.txt"), text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, says), error.text);
    TEST_ASSERT_EQUAL_PTR(&himc_kind_round,
                          himc_membrane_config_of(himc_drum_membrane(drum))->shape.kind);
}

// so many numbers in a row, in one static buffer
static const char *row_of(int count)
{
    static char text[2048];
    for (int i = 0; i < count; i++)
        memcpy(text + 2 * i, "1 ", 3);
    return text;
}

// so many rows of two numbers, in one static buffer
static const char *rows_of(int count)
{
    static char text[20000];
    for (int i = 0; i < count; i++)
        memcpy(text + 4 * i, "1 1\n", 5);
    return text;
}

static void test_grid_refuses_bad_files_with_the_reason(void)
{
    put("p", "0 0\n0.2 0\n0 0.2\n");
    put("m", "1 0\n0 1\n");
    put("k", "2 -1\n-1 2\n");
#define GOOD "tension 1000\ndensity 0.3\nplaces p\nmass m\nstiffness k\n"
    put("bad.txt", GOOD);
    TEST_ASSERT_TRUE_MESSAGE(shape_of("bad.txt"), error.text);
    TEST_ASSERT_TRUE(say("shape circle"));
    refuses("k", "2 -1\n-0.9 2\n", "stiffness: not symmetric: (1, 2) is -1, (2, 1) is -0.9");
    refuses(
        "k", "1 2\n2 1\n",
        "stiffness: negative: its lowest eigenvalue is -1 1/s2, its highest 3, expected from 0");
    refuses("k", "0 0\n0 0\n", "stiffness: 0, expected one that resists bending");
    refuses("k", "1 2\n2\n", "k:2: number 2 of 2 is missing or not a number");
    refuses("k", "1 2\n2 x\n", "k:2: number 2 of 2 is missing or not a number");
    refuses("k", "1 2\n2 1 3\n", "k:2: more than 2");
    refuses("k", "1 2\n", "stiffness: 1 rows of 2");
    refuses("k", "%%MatrixMarket matrix coordinate real symmetric\n99999 99999 1\n1 1 1\n",
            "rows: 99999, expected 1 .. 800");
    refuses("k", "%%MatrixMarket matrix coordinate real symmetric\n801 801 1\n1 1 1\n",
            "k:2: rows: 801, expected 1 .. 800");
    refuses("k", row_of(801), "k:1: columns: 801, expected 1 .. 800");
    put("k", "2 -1\n-1 2\n");
    refuses("p", rows_of(4001), "p:4001: rows: 4001, expected 1 .. 4000");
    put("p", "0 0\n0.2 0\n0 0.2\n");
    refuses("k", "%%MatrixMarket matrix coordinate real general\n2 2 2\n1 1 1\n3 1 1\n",
            "k:4: row or column outside");
    refuses("k", "%%MatrixMarket matrix coordinate complex general\n", "k:1: expected");
    refuses("k", "%%MatrixMarket matrix array real symmetric\n2 1\n1\n1\n",
            "k:2: symmetric, but not square");
    refuses("k", "%%MatrixMarket matrix array real general\n2 2\n1\n1\n1\n",
            "k:5: a value is missing or not a number");
    refuses("k", "", "empty");
    put("k", "2 -1\n-1 2\n");
    refuses("m", "1 2\n2 1\n", "mass: not positive");
    put("m", "1 0\n0 1\n");
    refuses("p", "0 0\n", "mass: 2 rows but 1 places");
    put("p", "0 0\n0.2 0\n0 0.2\n");
    refuses("p", "%%MatrixMarket matrix array real general\n1 3\n0\n0\n0\n",
            "p: rows of 3 numbers, expected 2");
    put("p", "0 0\n0.2 0\n0 0.2\n");
    refuses("bad.txt", GOOD "mass m\n", "bad.txt:6: mass: named twice");
    refuses("bad.txt", "tension 1000\ndensity 0.3\nplaces p\nstiffness k\n", "mass: missing");
    char far_away[1400] = "places ";
    memset(far_away + 7, 'x', 1199);
    refuses("bad.txt", far_away, "bad.txt:1: a file name of more than 1199 characters");
    refuses("bad.txt", "tension 1000\ndensity 0\n", "bad.txt:2: density: 0");
    refuses("bad.txt", "tension 1000\nplaces p\nmass m\nstiffness k\n", "density: missing");
    refuses("bad.txt", "shape round\n", "bad.txt:1: shape: unknown");
    refuses("bad.txt", "places nowhere\n", "nowhere: cannot be read: No such file");
    TEST_ASSERT_FALSE(shape_of("none.txt"));
}

static void test_grid_matrices_in_any_form_are_the_same_head(void)
{
    static const char *const forms[] = {
        "1 0 0\n0 1 0.5\n0 0.5 2\n",
        "%%MatrixMarket matrix array real general\n% by columns\n3 3\n1\n0\n0\n0\n1\n0.5\n0\n0.5\n2\n",
        "%%MatrixMarket matrix array real symmetric\n3 3\n1\n0\n0\n1\n0.5\n2\n",
        "%%MatrixMarket matrix coordinate real general\n3 3 5\n1 1 1\n2 2 1\n3 3 2\n2 3 .5\n3 2 .5\n",
        "%%MatrixMarket matrix coordinate integer symmetric\n3 3 4\n1 1 1\n2 2 1\n3 3 2\n3 2 0.5\n"};
    double zero[3] = {0};
    put("p", "0 0\n0.2 0\n0 0.2\n0.2 0.2\n");
    put("k", "2 -1 0\n-1 2 0\n0 0 2\n");
    put("form.txt", GOOD);
    for (int i = 0; i < 5; i++) {
        char path[300];
        put("m", forms[i]);
        snprintf(path, sizeof path, "%s/form.txt", folder);
        himc_grid *g = himc_grid_load(path, &error);
        TEST_ASSERT_NOT_NULL_MESSAGE(g, error.text);
        for (int k = 0; k < 3; k++) {
            TEST_ASSERT_TRUE(g->zero[k] > 0);
            zero[k] = i == 0 ? g->zero[k] : zero[k];
            TEST_ASSERT_EQUAL_DOUBLE(zero[k], g->zero[k]);
        }
        himc_grid_release(g);
    }
}

static void test_a_grid_keeps_its_shape_when_its_modes_are_prepared_aside(void)
{
    himc_command command;
    TEST_ASSERT_TRUE_MESSAGE(shape_of("head.txt"), error.text);
    TEST_ASSERT_TRUE(himc_command_parse_text(&command, HIMC_DRUM, "modes 7", &error));
    himc_job *job = himc_drum_job(drum, &command, &error);
    TEST_ASSERT_TRUE_MESSAGE(job && himc_job_carry_out(job, &error), error.text);
    TEST_ASSERT_EQUAL_PTR(&himc_kind_grid,
                          himc_membrane_config_of(himc_drum_membrane(drum))->shape.kind);
    TEST_ASSERT_EQUAL_INT(7, himc_membrane_head(himc_drum_membrane(drum))->modes);
}

#define BAR 60 // places

// A bar of `length` (m), rigidity `bending` (N m^2) and mass per length (kg/m), free at both ends
// or on springs (N/m each): K = D' D bending/h^3 with D the second difference, lumped masses.
static void put_bar(double length, double bending, double mass, double spring)
{
    static double k[BAR][BAR];
    static const double d[3] = {1, -2, 1};
    char path[300];
    double h = length / (BAR - 1);
    memset(k, 0, sizeof k);
    for (int at = 0; at + 2 < BAR; at++)
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                k[at + i][at + j] += bending / (h * h * h) * d[i] * d[j];
    static const char *const names[] = {"bar-k", "bar-m", "bar-p"};
    for (int file = 0; file < 3; file++) {
        snprintf(path, sizeof path, "%s/%s", folder, names[file]);
        FILE *f = fopen(path, "w");
        for (int i = 0; i < BAR; i++) {
            double end = i == 0 || i == BAR - 1 ? 0.5 : 1;
            for (int j = 0; j < BAR && file < 2; j++)
                fprintf(f, "%.17g ",
                        file == 0 ? k[i][j] + (i == j ? spring : 0)
                                  : (i == j ? mass * h * end : 0));
            if (file == 2)
                fprintf(f, "%.17g 0", h * i);
            fputc('\n', f);
        }
        fclose(f);
    }
}

// beta length of a free bar's first three bending modes: cos cosh = 1 (Fletcher & Rossing 1998)
static const double bar_root[3] = {4.730041, 7.853205, 10.995608};

// a wooden bar of 18 kg/m^2 and a steel one of 63, 4 cm wide; also on springs so soft that it
// bounces at 2 Hz
static void test_grid_of_a_free_bar_has_its_bending_modes_alone(void)
{
    static const double density[] = {18, 63, 18}, spring[] = {0, 0, 0.06};
    for (int i = 0; i < 3; i++) {
        double length = 0.5, bending = 30, mass = density[i] * 0.04;
        char text[200];
        put_bar(length, bending, mass, spring[i]);
        snprintf(text, sizeof text,
                 "tension 1000\ndensity %g\nplaces bar-p\nmass bar-m\nstiffness bar-k\n",
                 density[i]);
        put("bar.txt", text);
        TEST_ASSERT_TRUE_MESSAGE(shape_of("bar.txt"), error.text);
        himc_membrane *m = himc_drum_membrane(drum);
        int first = himc_membrane_mode(m, 0).frequency < 5 ? 2 : 0;
        TEST_ASSERT_EQUAL_INT(spring[i] > 0 ? 2 : 0, first);
        for (int k = 0; k < 3; k++) {
            double beta = bar_root[k] / length;
            double hz = beta * beta * sqrt(bending / mass) / (2 * HIMC_PI);
            TEST_ASSERT_DOUBLE_WITHIN(0.005 * hz, hz, himc_membrane_mode(m, first + k).frequency);
        }
        TEST_ASSERT_TRUE_MESSAGE(say("strike 0.01 0 2"), error.text);
        himc_drum_advance(drum, 4800, NULL, NULL, NULL);
        double energy = himc_membrane_energy(m);
        TEST_ASSERT_TRUE(energy > 1e-6 && energy < 0.5 * 0.03 * 4);
        TEST_ASSERT_TRUE(say("shape circle"));
    }
}

static void test_rectangle_has_the_modes_of_a_string_in_both_directions(void)
{
    TEST_ASSERT_TRUE_MESSAGE(say("shape rectangle 0.6 0.4"), error.text);
    himc_membrane *m = himc_drum_membrane(drum);
    const himc_head *head = himc_membrane_head(m);
    double c = sqrt(head->tension / head->density), before = 0;
    for (int i = 0; i < 200; i++) {
        himc_mode mode = himc_membrane_mode(m, i);
        double f = 0.5 * c * hypot(mode.m / 0.6, mode.n / 0.4);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6 * f, f, mode.frequency);
        TEST_ASSERT_TRUE(mode.frequency >= before);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, head->density * 0.06, mode.mass);
        before = mode.frequency;
    }
    TEST_ASSERT_TRUE(say("tune 150"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 150, himc_membrane_mode(m, 0).frequency);
    TEST_ASSERT_FALSE(say("air 1"));
    TEST_ASSERT_EQUAL_STRING("air: 1, expected 0 on a head that is not round", error.text);
    TEST_ASSERT_FALSE(say("shape rectangle"));
    TEST_ASSERT_FALSE(say("shape rectangle 0.6 nan"));
    TEST_ASSERT_TRUE(say("shape circle"));
    TEST_ASSERT_TRUE(himc_membrane_head(m)->air);
}

// the transform against a sum over a fine raster
static void test_rectangle_transform_agrees_with_a_sum_over_a_raster(void)
{
    himc_shape shape = {&himc_kind_rectangle, 0.6, 0.4, NULL, NULL, NULL};
    himc_modes *modes = himc_modes_new(&shape, 30, &error);
    double radius = 0.5 * hypot(0.6, 0.4), kx = 7, ky = -5;
    double even[30] = {0}, odd[30] = {0}, w[30], e, o;
    for (int a = 0; a < 300; a++)
        for (int b = 0; b < 300; b++) {
            double x = 0.6 * ((a + 0.5) / 300 - 0.5), y = 0.4 * ((b + 0.5) / 300 - 0.5);
            himc_modes_shapes(modes, radius, x, y, w);
            for (int i = 0; i < 30; i++) {
                even[i] += w[i] * 0.24 / 90000 * cos(kx * x + ky * y);
                odd[i] += w[i] * 0.24 / 90000 * sin(kx * x + ky * y);
            }
        }
    for (int i = 0; i < 30; i++) {
        shape.kind->transform(modes, i, kx * radius, ky * radius, &e, &o);
        TEST_ASSERT_DOUBLE_WITHIN(2e-5, even[i], e * radius * radius);
        TEST_ASSERT_DOUBLE_WITHIN(2e-5, odd[i], o * radius * radius);
    }
    himc_modes_free(modes);
}

int main(void)
{
    UNITY_BEGIN();
    TEST_ASSERT_NOT_NULL(mkdtemp(folder));
    RUN_TEST(test_grid_of_a_disc_has_bessels_modes);
    RUN_TEST(test_grid_of_a_disc_sounds_as_the_round_head_when_struck);
    RUN_TEST(test_grid_energy_never_grows_with_glide_and_any_sticks);
    RUN_TEST(test_grid_refuses_bad_files_with_the_reason);
    RUN_TEST(test_grid_matrices_in_any_form_are_the_same_head);
    RUN_TEST(test_a_grid_keeps_its_shape_when_its_modes_are_prepared_aside);
    RUN_TEST(test_grid_of_a_free_bar_has_its_bending_modes_alone);
    RUN_TEST(test_rectangle_has_the_modes_of_a_string_in_both_directions);
    RUN_TEST(test_rectangle_transform_agrees_with_a_sum_over_a_raster);
    return UNITY_END();
}
