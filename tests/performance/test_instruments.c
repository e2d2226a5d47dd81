/// test_instruments.c: the command `instrument`, from a score, by hand and over OSC.
#include "osc_ear.h"

#include "inner_state.h"
#include "performance/performance_state.h"

// a score that is loaded from a file of its own; the error line or ""
static const char *load(const char *text)
{
    static himc_error error;
    himc_command command;
    char name[] = "/tmp/himc-score-XXXXXX", line[64];
    int file = mkstemp(name);
    TEST_ASSERT_TRUE(write(file, text, strlen(text)) == (ssize_t)strlen(text));
    close(file);
    snprintf(line, sizeof line, "score %s", name);
    error.text[0] = 0;
    bool good = himc_command_parse_text(&command, HIMC_PERFORMER, line, &error) &&
                himc_performance_command(performance, &command, 0, &error);
    unlink(name);
    return good ? "" : error.text;
}

static void refuses(const char *text, const char *reason)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(load(text), reason), load(text));
}

static himc_drum *find(const char *name)
{
    himc_drum *drum = NULL;
    for (int i = 0; himc_performance_drum(performance, i); i++)
        if (strcmp(himc_drum_name(himc_performance_drum(performance, i)), name) == 0)
            drum = himc_performance_drum(performance, i);
    return drum;
}

static double pitch(const char *name)
{
    return himc_drum_pitch(find(name));
}

static void test_each_stroke_of_a_score_lands_on_its_instrument(void)
{
    static const char *const on[] = {"left", "mid", "right", "left", "right", "mid"};
    char text[600] = "instrument left temple-blocks; instrument mid timpano 26;"
                     "instrument right cowbell 600; tempo 100; ";
    for (int i = 0; i < 6; i++)
        snprintf(text + strlen(text), 60, "stroke %d %s legato %s %s; ", i + 1,
                 i % 2 ? "right" : "left", i < 3 ? "mf" : "ff", on[i]);
    subscribe("strikes");
    TEST_ASSERT_EQUAL_STRING("", load(text));
    say("/himc/play", "");
    play(5);
    int landed = 0;
    for (int i = 0; i < heard_count; i++)
        if (strcmp(heard[i].path, "/himc/strike") == 0)
            TEST_ASSERT_EQUAL_STRING(on[landed++], word(lo_message_get_argv(heard[i].message)[2]));
    TEST_ASSERT_EQUAL_INT(6, landed);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 540, pitch("left"));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 600, pitch("right"));
    himc_drum *bell = find("right");
    TEST_ASSERT_EQUAL_DOUBLE(3e8, himc_drum_mallet(bell, HIMC_LEFT)->stiffness);
    TEST_ASSERT_TRUE(himc_membrane_energy(himc_drum_membrane(bell)) >= 0);
}

static void test_an_instrument_comes_over_osc_and_is_there_once(void)
{
    say("/himc/instrument", "bell tubular-bell D5");
    say("/himc/instrument", "bell claves");
    play(0.05);
    TEST_ASSERT_EQUAL_STRING("", last_error());
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 587.33, pitch("bell"));
    say("/membrane/bell/tune", "C5");
    play(0.05);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 523.25, pitch("bell"));
    say("/himc/instrument", "x modes /tmp/x");
    play(0.05);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(last_error(), "over the network"), last_error());
}

static void test_what_cannot_be_made_is_refused_in_one_line(void)
{
    refuses("instrument a banjo;", "instrument: INSTRUMENT: banjo, expected timpano marimba");
    refuses("instrument a;", "INSTRUMENT missing");
    refuses("instrument a timpano 5;", "inches: 5 in, expected 12 .. 60 in");
    refuses("instrument a claves 5;", "instrument a: tune: 5 Hz, expected");
    refuses("instrument a modes nowhere.txt;", "instrument a: shape: nowhere.txt");
    refuses("instrument a claves; instrument a cowbell;", "instrument: a is a claves since line 1");
    refuses("instrument a claves; drum a;", "drum: a is a claves since line 1");
    refuses("drum a 26; instrument a claves;", "drum: a is made with 26 inches on line 1");
    TEST_ASSERT_EQUAL_STRING("", load("instrument a claves; instrument a claves; a damp 0.1;"));
}

static void test_a_dump_makes_the_instruments_again(void)
{
    say("/himc/instrument", "bell tubular-bell D5");
    play(0.05);
    himc_mode was = himc_membrane_mode(himc_drum_membrane(find("bell")), 3);
    himc_command command;
    himc_error error = {0};
    TEST_ASSERT_TRUE(himc_command_parse_text(&command, HIMC_PERFORMER,
                                             "dump /tmp/himc-instruments.txt", &error) &&
                     himc_performance_command(performance, &command, 0, &error));
    TEST_ASSERT_TRUE(himc_command_parse_text(&command, HIMC_PERFORMER, "reset", &error) &&
                     himc_performance_command(performance, &command, 0, &error));
    TEST_ASSERT_NULL(find("bell"));
    TEST_ASSERT_TRUE(himc_command_parse_text(&command, HIMC_PERFORMER,
                                             "score /tmp/himc-instruments.txt", &error));
    TEST_ASSERT_TRUE_MESSAGE(himc_performance_command(performance, &command, 0, &error),
                             error.text);
    unlink("/tmp/himc-instruments.txt");
    himc_mode now = himc_membrane_mode(himc_drum_membrane(find("bell")), 3);
    TEST_ASSERT_EQUAL_DOUBLE(was.frequency, now.frequency);
    TEST_ASSERT_EQUAL_DOUBLE(was.decay, now.decay);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_each_stroke_of_a_score_lands_on_its_instrument);
    RUN_TEST(test_an_instrument_comes_over_osc_and_is_there_once);
    RUN_TEST(test_what_cannot_be_made_is_refused_in_one_line);
    RUN_TEST(test_a_dump_makes_the_instruments_again);
    return UNITY_END();
}
