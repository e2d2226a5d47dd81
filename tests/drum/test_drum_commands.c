/// test_drum_commands.c: a drum carries out its commands at any moment, or refuses them in one line
/// and plays on unchanged.
#include "one_drum.h"

#include <stdio.h>

#include <string.h>

// a command put together without the parser
static bool raw(himc_command_id id, double a, double b, double c, int count)
{
    himc_command command = {.id = id, .count = count};
    command.atom[0] = (himc_atom){HIMC_ATOM_NUMBER, a, NULL};
    command.atom[1] = (himc_atom){HIMC_ATOM_NUMBER, b, NULL};
    command.atom[2] = (himc_atom){HIMC_ATOM_NUMBER, c, NULL};
    return himc_drum_command(drum, &command, &error);
}

static double principal(void)
{
    return himc_membrane_mode(himc_drum_membrane(drum), 1).frequency;
}

static void test_drum_tunes_its_principal_mode(void)
{
    static const struct {
        const char *text;
        double hz;
    } cases[] = {{"tune 110", 110},      {"tune A2", 110},       {"tune a3", 220},
                 {"tune f#3", 184.9972}, {"tune Bb2", 116.5409}, {"tune D3", 146.8324}};
    says("uniformity 1"); // the pair is one frequency
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        says(cases[i].text);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, cases[i].hz, principal());
    }
    TEST_ASSERT_FALSE(say("tune H2"));
    TEST_ASSERT_FALSE(say("tune 100000"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 146.8324, principal());
}

static void keep_line(void *text, const char *line)
{
    snprintf(text, 512, "%s", line);
}

static void test_drum_commands_set_their_parameters(void)
{
    himc_membrane *membrane = himc_drum_membrane(drum);
    unsigned revision = himc_drum_revision(drum);
    says("radius 0.33");
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0.33, himc_drum_head_frame(drum)->radius);
    TEST_ASSERT_EQUAL_UINT(revision + 1, himc_drum_revision(drum));
    says("tension 4000");
    says("density 0.3");
    says("modes 2000");
    says("air 0");
    says("decay 1.5");
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, (float)(log(1000) / 1.5),
                              himc_membrane_mode(membrane, 1999).decay);
    says("modes auto");
    TEST_ASSERT_EQUAL_INT(HIMC_MODES_AUTO, himc_membrane_head(membrane)->modes);
    TEST_ASSERT_EQUAL_INT(-1, himc_membrane_mode(membrane, 600).m);
    TEST_ASSERT_TRUE(himc_membrane_mode(membrane, 600).mass > 0);
    TEST_ASSERT_EQUAL_DOUBLE(0, himc_membrane_mode(membrane, 601).mass);
    says("modes 2000");
    says("decay 3 1e-7");
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1e-7, himc_membrane_head(membrane)->decay_square);
    TEST_ASSERT_EQUAL_INT(2000, himc_membrane_head(membrane)->modes);
    says("place 0.8 0.1 0.9 0.2");
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0.2, himc_drum_head_frame(drum)->tilt);
    says("place 0.7 0 0.8");
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0.8, himc_drum_head_frame(drum)->center.z);
    says("mallet wood");
    TEST_ASSERT_EQUAL_DOUBLE(3e8, himc_drum_mallet(drum, HIMC_RIGHT)->stiffness);
    TEST_ASSERT_EQUAL_DOUBLE(1.5, himc_drum_mallet(drum, HIMC_RIGHT)->exponent);
    TEST_ASSERT_EQUAL_DOUBLE(0.008, himc_drum_mallet(drum, HIMC_RIGHT)->radius);
    says("mallet 1e8 2.5 0.025");
    TEST_ASSERT_DOUBLE_WITHIN(10, 1e8, himc_drum_mallet(drum, HIMC_RIGHT)->stiffness);
    TEST_ASSERT_EQUAL_DOUBLE(2.5, himc_drum_mallet(drum, HIMC_RIGHT)->exponent);
    TEST_ASSERT_EQUAL_DOUBLE(0, himc_drum_mallet(drum, HIMC_RIGHT)->loss);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, 0.025, himc_drum_mallet(drum, HIMC_RIGHT)->mass);
    TEST_ASSERT_EQUAL_UINT(revision + 5, himc_drum_revision(drum));
    says("pickup 0.1 0.1");
    int count;
    TEST_ASSERT_EQUAL_INT(HIMC_PICKUP_POINT, himc_membrane_pickups(membrane, &count)->kind);
    says("pickup air 0.5 1.0472 2");
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, HIMC_PI / 3,
                              himc_membrane_pickups(membrane, &count)->elevation);
    char text[512];
    himc_drum_describe(drum, HIMC_DESCRIBE_INFO, keep_line, text);
    TEST_ASSERT_NOT_NULL(strstr(text, "2000 modes"));
}

static void count_line(void *user, const char *line)
{
    (void)line;
    ++*(int *)user;
}

static void test_info_says_what_few_modes_lack(void)
{
    static const char *const modes[] = {"modes auto", "modes 50", "modes 2000"};
    for (int i = 0; i < 3; i++) {
        int lines = 0;
        char last[512];
        says(modes[i]);
        himc_drum_describe(drum, HIMC_DESCRIBE_INFO, count_line, &lines);
        himc_drum_describe(drum, HIMC_DESCRIBE_INFO, keep_line, last);
        TEST_ASSERT_EQUAL_INT(i == 1 ? 2 : 1, lines);
        TEST_ASSERT_TRUE((strstr(last, "nothing sounds above") != NULL) == (i == 1));
    }
}

static void test_drum_refuses_impossible_values_and_its_sound_does_not_change(void)
{
    static const char *const bad[] = {"radius 0",
                                      "radius nan",
                                      "radius 1e30",
                                      "tension -1",
                                      "tension 0",
                                      "density 0",
                                      "modes 0",
                                      "modes 2.5",
                                      "modes 1e9",
                                      "modes nan",
                                      "decay -1",
                                      "decay 0",
                                      "decay 1 2 3",
                                      "decay 1e9 1",
                                      "tune 0",
                                      "tune nan",
                                      "tune",
                                      "mallet felt",
                                      "mallet 0 2 0.03",
                                      "mallet 1e8 2.5",
                                      "mallet nan 2 0.03",
                                      "place 1 2",
                                      "place 1e9 0 0",
                                      "pickup air 0 2 1",
                                      "pickup air 0 0 0",
                                      "pickup air 0 0",
                                      "pickup 3 3",
                                      "pickup nan 0",
                                      "pickup water 1 1 1",
                                      "strike 1 0 1",
                                      "strike 0 0 0",
                                      "strike 0 0 -1",
                                      "strike 0 0 nan",
                                      "strike 0 0 1e9",
                                      "bang",
                                      "radius x"};
    static double reference[LENGTH];
    scene(64, reference, seen, sound);
    scene(64, reference, seen, sound); // the same again: the reference is the second
    tearDown();
    setUp();
    says("strike -0.2 0 3");
    advance(LENGTH);
    himc_drum_read(drum, 0, LENGTH, reference, NULL);
    tearDown();
    setUp();
    says("strike -0.2 0 3");
    for (int done = 0, i = 0; done < LENGTH; done += 100, i++) {
        const char *text = bad[i % (int)(sizeof bad / sizeof bad[0])];
        error.text[0] = '\0';
        TEST_ASSERT_FALSE_MESSAGE(say(text), text);
        TEST_ASSERT_TRUE_MESSAGE(strlen(error.text) > 5 && !strchr(error.text, '\n'), text);
        advance(100);
    }
    himc_drum_read(drum, 0, LENGTH, sound, NULL);
    TEST_ASSERT_EQUAL_MEMORY(reference, sound, sizeof sound);
}

static void test_drum_checks_commands_that_no_parser_has_seen(void)
{
    TEST_ASSERT_FALSE(raw(HIMC_COMMAND_RADIUS, 0, 0, 0, 1));
    TEST_ASSERT_EQUAL_STRING("radius: RADIUS: 0, expected 0.05 .. 1 m", error.text);
    TEST_ASSERT_FALSE(say("gliss G9 1"));
    TEST_ASSERT_NOT_NULL(strstr(error.text, "gliss: G9: 12543.9 Hz, expected "));
    TEST_ASSERT_FALSE(raw(HIMC_COMMAND_RADIUS, NAN, 0, 0, 1));
    TEST_ASSERT_FALSE(raw(HIMC_COMMAND_TENSION, INFINITY, 0, 0, 1));
    TEST_ASSERT_FALSE(raw(HIMC_COMMAND_MODES, NAN, 0, 0, 1));
    TEST_ASSERT_FALSE(raw(HIMC_COMMAND_MODES, 1e300, 0, 0, 1));
    TEST_ASSERT_FALSE(raw(HIMC_COMMAND_DECAY, NAN, NAN, 0, 2));
    TEST_ASSERT_FALSE(raw(HIMC_COMMAND_TUNE, NAN, 0, 0, 1));
    TEST_ASSERT_FALSE(raw(HIMC_COMMAND_MALLET, 1e8, NAN, 0.03, 3));
    TEST_ASSERT_FALSE(raw(HIMC_COMMAND_PLACE, NAN, 0, 0, 3));
    TEST_ASSERT_FALSE(raw(HIMC_COMMAND_PICKUP, NAN, 0, 0, 2));
    TEST_ASSERT_FALSE(raw(HIMC_COMMAND_STRIKE, 0, NAN, 1, 3));
    TEST_ASSERT_FALSE(raw(HIMC_COMMAND_STRIKE, 0, 0, 1, 0));
    TEST_ASSERT_FALSE(raw(HIMC_COMMAND_TEMPO, 100, 0, 0, 1));
    TEST_ASSERT_NULL(himc_drum_new("x", 11, RATE, &error));
    TEST_ASSERT_EQUAL_STRING("inches: 11 in, expected 12 .. 60 in", error.text);
    TEST_ASSERT_NULL(himc_drum_new("x", NAN, RATE, &error));
    TEST_ASSERT_NULL(himc_drum_new("x", 23, 0, &error));
    TEST_ASSERT_NULL(himc_drum_new("a name that is much longer than it may be", 23, RATE, &error));
    TEST_ASSERT_FALSE(himc_drum_set_rate(drum, 7999, &error));
    TEST_ASSERT_FALSE(himc_drum_strike_at(drum, -1, 0, 0, 1, &error));
    for (int i = 0; i < 64; i++)
        TEST_ASSERT_TRUE(himc_drum_strike_at(drum, 8000, 0, 0, 1, &error));
    TEST_ASSERT_FALSE(himc_drum_strike_at(drum, 8000, 0, 0, 1, &error));
}

static void test_drum_survives_any_change_in_the_middle_of_a_contact(void)
{
    static const char *const lines[] = {
        "radius 0.1", "tension 50",  "modes 1",         "modes 2000",   "tune 500",
        "radius 1",   "density 10",  "decay 1000 1e-3", "density 0.01", "tension 50000",
        "modes 200",  "mallet wood", "decay 3 3e-7",    "radius 0.29",  "pickup 0 0"};
    for (int i = 0; i < 60; i++) {
        says("strike 0.05 0.05 8");
        advance(100);
        says(lines[i % 15]);
        advance(50);
    }
    himc_drum_read(drum, 0, 9000, sound, seen);
    TEST_ASSERT_TRUE(peak(sound, 9000) > 0.1);
    advance(48000);
    himc_drum_read(drum, 50000, 5000, sound, seen);
    TEST_ASSERT_TRUE(peak(sound, 5000) < 1);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_drum_tunes_its_principal_mode);
    RUN_TEST(test_drum_commands_set_their_parameters);
    RUN_TEST(test_info_says_what_few_modes_lack);
    RUN_TEST(test_drum_refuses_impossible_values_and_its_sound_does_not_change);
    RUN_TEST(test_drum_checks_commands_that_no_parser_has_seen);
    RUN_TEST(test_drum_survives_any_change_in_the_middle_of_a_contact);
    return UNITY_END();
}
