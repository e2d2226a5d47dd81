/// test_idiophone.c: instruments without a skin: lists of modes, of files and of the library.
#define _DEFAULT_SOURCE // mkdtemp
#include "head/idiophone.h"
#include "head/lists.h"
#include "say_drum.h"

static char folder[] = "/tmp/himc-list-XXXXXX";

static void list_of(const char *lines)
{
    char path[300], text[400];
    snprintf(path, sizeof path, "%s/list.txt", folder);
    FILE *f = fopen(path, "w");
    fputs(lines, f);
    fclose(f);
    snprintf(text, sizeof text, "shape modes %s", path);
    error.text[0] = '\0';
    say(text);
}

static void refuses(const char *lines, const char *reason)
{
    list_of(lines);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, reason), error.text);
    TEST_ASSERT_NULL(strchr(error.text, '\n'));
    TEST_ASSERT_EQUAL_STRING("circle",
                             himc_membrane_config_of(himc_drum_membrane(drum))->shape.kind->name);
}

#define GOOD                                \
    "# two blocks\n"                        \
    "pitch 500\n"                           \
    "mallet 1e8 2 0.02\n"                   \
    "\n"                                    \
    "surface low bar 0.2 0.1 # a comment\n" \
    "place 0 0.06\n"                        \
    "pressure 1e-3\n"                       \
    "mode 500 0.4 0.1 1 0 -1\n"             \
    "mode 1500 0.2 0.2 1\n"                 \
    "surface high bar 0.1 0.1\n"            \
    "place 0.05 -0.06\n"                    \
    "pressure 2e-3\n"                       \
    "mode 800 0.3 0.05 0 1\n"

static void test_a_file_s_modes_are_those_of_the_instrument(void)
{
    static const double hz[] = {500, 800, 1500}, t60[] = {0.4, 0.3, 0.2}, kg[] = {0.1, 0.05, 0.2};
    list_of(GOOD);
    TEST_ASSERT_EQUAL_STRING("", error.text);
    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-6 * hz[i], hz[i], mode(i).frequency);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, log(1000) / t60[i], mode(i).decay);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, kg[i], mode(i).mass);
    }
    TEST_ASSERT_EQUAL_DOUBLE(0, mode(3).frequency);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.2, himc_drum_head_frame(drum)->length);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.22, himc_drum_head_frame(drum)->width);
    TEST_ASSERT_EQUAL_DOUBLE(1e8, himc_drum_mallet(drum, HIMC_LEFT)->stiffness);
    TEST_ASSERT_EQUAL_DOUBLE(0.02, himc_drum_mallet(drum, HIMC_RIGHT)->mass);
}

// shapes are linear between their values; a part moves alone, and between two the nearer one
static void test_each_part_has_its_own_place(void)
{
    list_of(GOOD);
    const himc_membrane_config *config = himc_membrane_config_of(himc_drum_membrane(drum));
    himc_modes *modes = himc_modes_new(&config->shape, HIMC_MODES_AUTO, &error);
    static const struct {
        double x, y, shape[3]; // of 500, 800, 1500 Hz
    } at[] = {{-0.05, 0.06, {0.5, 0, 1}},
              {0.1 - 1e-9, 0.1, {-1, 0, 1}},
              {0.075, -0.1, {0, 0.75, 0}},
              {-0.09, -0.004, {0.9, 0, 1}},
              {0, -0.2, {0}},
              {0.2, 0, {0}}};
    for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
        double shape[3];
        himc_modes_shapes(modes, config->head.radius, at[i].x, at[i].y, shape);
        for (int k = 0; k < 3; k++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, at[i].shape[k], shape[k]);
    }
    himc_modes_free(modes);
}

static void test_tuning_moves_all_modes_by_one_ratio_and_keeps_their_decay(void)
{
    list_of(GOOD);
    done("tune 600");
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 600, mode(0).frequency);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 960, mode(1).frequency);
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 1800, mode(2).frequency);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, log(1000) / 0.4, mode(0).decay);
    done("damp 0.1");
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, log(1000) / 0.4 + 0.1 * HIMC_DAMP, mode(0).decay);
}

static void test_bad_lists_are_refused_with_file_and_line(void)
{
#define HEAD "surface a bar 0.2 0.1\npressure 1e-3\n"
    char many[1100] = HEAD "mode 500 1 1";
    refuses("", "list.txt: no surface");
    refuses("sound 1\n", "list.txt:1: sound: unknown, expected pitch mallet surface place");
    refuses("\n# x\npitch\n", "list.txt:3: pitch: HZ missing");
    refuses("pitch x\n", "list.txt:1: pitch: HZ: x, expected a number");
    refuses("pitch inf\n", "list.txt:1: pitch: HZ: inf, expected a number");
    refuses("pitch 0\n", "list.txt:1: pitch: HZ: 0 Hz, expected 1 .. 20000 Hz");
    refuses("pitch 5 6\n", "list.txt:1: pitch: 6 is one word too many");
    refuses("mallet 1e8 2\n", "list.txt:1: mallet: MASS missing");
    refuses("mallet 1e8 9 0.02\n", "list.txt:1: mallet: ALPHA: 9, expected 1 .. 4");
    refuses("surface\n", "list.txt:1: surface: two words missing, expected NAME disc R, or");
    refuses("surface a ball 1\n", "list.txt:1: surface: ball, expected NAME disc R, or NAME bar");
    refuses("surface a bar 0.2\n", "list.txt:1: surface: W missing");
    refuses("surface a disc 5\n", "list.txt:1: surface: R: 5 m, expected 0.05 .. 1 m");
    refuses("surface a bar 0.1 0.1\nsurface a bar 1 1\n", "list.txt:2: surface: a: named twice");
    refuses("surface a bar 0.1 0.1\nsurface b disc 0.1\n", "a disc beside others");
    refuses("surface a disc 0.1\nsurface b bar 0.1 0.1\n", "one more beside a disc");
    refuses("place 0 0\n", "list.txt:1: place: no surface yet");
    refuses("mode 500 1 1 1\n", "list.txt:1: mode: no surface yet");
    refuses("surface a bar 0.1 0.1\nmode 500 1 1 1\n", "list.txt:2: mode: no pressure yet");
    refuses(HEAD, "list.txt: surface a: no mode");
    refuses(HEAD "mode 500 1 1\n", "list.txt:3: mode: W missing");
    refuses(HEAD "mode 500 0 1 1\n", "list.txt:3: mode: T60: 0 s, expected 0.001 .. 1000 s");
    refuses(HEAD "mode 500 1 -1 1\n", "list.txt:3: mode: MASS: -1 kg, expected 1e-06 .. 1000 kg");
    refuses(HEAD "mode 30000 1 1 1\n", "list.txt:3: mode: HZ: 30000 Hz, expected 1 .. 20000 Hz");
    refuses(HEAD "mode 500 1 1 1 y\n", "list.txt:3: mode: W: y, expected a number");
    for (int i = 0; i < 65; i++)
        strcat(many, " 1");
    refuses(many, "list.txt:3: mode: 65 shape values, expected up to 64");
    for (int i = 0; i < 10; i++)
        strcat(many, " 1");
    refuses(many, "list.txt:3: mode: too many words");
    memset(many, 'x', sizeof many - 1);
    refuses(many, "list.txt:1: a line of 1099 characters");
    TEST_ASSERT_FALSE(say("shape modes nowhere.txt"));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, "shape: nowhere.txt"), error.text);
    TEST_ASSERT_FALSE(say("shape listed drums"));
}

static void each_listed(void (*visit)(const char *name))
{
    for (int i = 0; i == 0 || himc_lists[i].name; i++) {
        char text[80];
        snprintf(text, sizeof text, "shape listed %s", himc_lists[i].name);
        tearDown();
        setUp();
        done(text);
        visit(himc_lists[i].name);
    }
}

static void test_the_energy_of_listed_instruments_never_grows(void)
{
    each_listed(check_energy);
}

static void sound_alike(const char *name)
{
    const himc_head_frame *frame = himc_drum_head_frame(drum);
    himc_contact_report blow = check_blows(name, 0.2 * frame->length, 0.2 * frame->width);
    TEST_ASSERT_TRUE_MESSAGE(blow.duration > 1e-4 && blow.duration < 2e-2, name);
}

static void test_equal_blows_on_listed_instruments_are_equal_and_stronger_ones_louder(void)
{
    each_listed(sound_alike);
}

static void come_back(const char *name)
{
    done("tune 900");
    done("decay 3 1e-9");
    check_dump(name, 0);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 900, himc_drum_pitch(drum));
    himc_mallet_head own = *himc_drum_mallet(drum, HIMC_LEFT);
    done("mallet hard");
    TEST_ASSERT_TRUE(himc_drum_mallet(drum, HIMC_LEFT)->stiffness != own.stiffness);
    done("mallet usual");
    TEST_ASSERT_EQUAL_DOUBLE(own.stiffness, himc_drum_mallet(drum, HIMC_LEFT)->stiffness);
    TEST_ASSERT_FALSE(say("skin calf"));
    done("shape circle"); // nothing of it is left
    himc_drum *other = himc_drum_new("thing", 23, RATE, &error);
    for (int i = 0; i < 20; i++)
        TEST_ASSERT_EQUAL_DOUBLE(himc_membrane_mode(himc_drum_membrane(other), i).decay,
                                 mode(i).decay);
    TEST_ASSERT_EQUAL_DOUBLE(himc_drum_mallet(other, HIMC_LEFT)->mass,
                             himc_drum_mallet(drum, HIMC_LEFT)->mass);
    himc_drum_release(other);
}

static void test_a_dump_of_a_listed_instrument_makes_it_again(void)
{
    each_listed(come_back);
}

int main(void)
{
    if (!mkdtemp(folder))
        return 1;
    UNITY_BEGIN();
    RUN_TEST(test_a_file_s_modes_are_those_of_the_instrument);
    RUN_TEST(test_each_part_has_its_own_place);
    RUN_TEST(test_tuning_moves_all_modes_by_one_ratio_and_keeps_their_decay);
    RUN_TEST(test_bad_lists_are_refused_with_file_and_line);
    RUN_TEST(test_the_energy_of_listed_instruments_never_grows);
    RUN_TEST(test_equal_blows_on_listed_instruments_are_equal_and_stronger_ones_louder);
    RUN_TEST(test_a_dump_of_a_listed_instrument_makes_it_again);
    return UNITY_END();
}
