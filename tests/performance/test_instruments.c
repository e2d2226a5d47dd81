/// test_instruments.c: the command `instrument`, from a score, by hand and over OSC.
#include "osc_ear.h"

#include "inner_state.h"
#include "drum/membrane_state.h"
#include "head/idiophone.h"
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
                 i % 3 == 2 || i == 4 ? "right" : "left", i < 3 ? "mf" : "ff", on[i]);
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

// where strike k landed, of those heard
static void landed(int k, double at[2])
{
    for (int i = 0; i < heard_count; i++)
        if (strcmp(heard[i].path, "/himc/strike") == 0 && k-- == 0)
            for (int j = 0; j < 2; j++)
                at[j] = number(lo_message_get_argv(heard[i].message)[3 + j]);
}

// a pitch in any spelling, a name; and near the middle, at the end, or X Y from the part's centre
static void test_strokes_of_a_score_land_on_the_bars_that_they_name(void)
{
    static const char *const written[] = {"C4", "center E4", "rim Bb4", "c5", "0.01 0.005 G4"};
    static const struct {
        const char *part;
        double along, aside; // of half its length, (m)
    } of[] = {{"C4", -0.1, 0.015},
              {"E4", 0, -0.015},
              {"A#4", -0.7, 0.015},
              {"C5", -0.1, -0.015},
              {"G4", NAN, 0.005}};
    char text[700] = "instrument m marimba C4 C5; tempo 60; ";
    for (int i = 0; i < 5; i++)
        snprintf(text + strlen(text), 60, "stroke %d %s legato mf %s m; ", i + 1,
                 i % 2 ? "right" : "left", written[i]);
    subscribe("strikes");
    TEST_ASSERT_EQUAL_STRING("", load(text));
    say("/himc/play", "");
    play(6);
    TEST_ASSERT_EQUAL_INT(5, count("/himc/strike"));
    const himc_idiophone *body = himc_membrane_config_of(himc_drum_membrane(find("m")))->shape.body;
    for (int i = 0; i < 5; i++) {
        double at[2] = {0};
        const himc_part *part = body->part;
        while (strcmp(part->name, of[i].part) != 0)
            part++;
        landed(i, at);
        double x = isnan(of[i].along) ? 0.01 : 0.5 * part->length * of[i].along;
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.003, part->x + x, at[0], of[i].part);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.003, part->y + of[i].aside, at[1], of[i].part);
    }
}

static void test_strokes_land_on_a_cymbal_where_it_is_struck_or_on_its_bell(void)
{
    static const double out[] = {0.93, 0.1};
    subscribe("strikes");
    TEST_ASSERT_EQUAL_STRING("",
                             load("instrument c crash 18; tempo 60;"
                                  "stroke 1 right legato f c; stroke 2 left legato mf bell c;"));
    say("/himc/play", "");
    play(3);
    TEST_ASSERT_EQUAL_INT(2, count("/himc/strike"));
    for (int i = 0; i < 2; i++) {
        double at[2] = {0};
        landed(i, at);
        TEST_ASSERT_DOUBLE_WITHIN(0.004, -out[i] * 0.2286, at[0]);
        TEST_ASSERT_DOUBLE_WITHIN(0.004, i ? 0.015 : -0.015, at[1]);
    }
    TEST_ASSERT_TRUE(himc_membrane_energy(himc_drum_membrane(find("c"))) > 0.001);
}

static void test_a_roll_on_a_bar_stays_on_it(void)
{
    subscribe("strikes");
    TEST_ASSERT_EQUAL_STRING("", load("instrument m marimba C4 C5; tempo 60;"
                                      "roll 2 1 single mf E4 m; flam 5 right legato f E4 m;"));
    say("/himc/play", "");
    play(6);
    const himc_part *part =
        &himc_membrane_config_of(himc_drum_membrane(find("m")))->shape.body->part[4];
    TEST_ASSERT_TRUE(count("/himc/strike") > 8);
    for (int i = 0; i < count("/himc/strike"); i++) {
        double at[2] = {0};
        landed(i, at);
        TEST_ASSERT_TRUE(fabs(at[1] - part->y) < 0.5 * part->width);
    }
}

static void test_parts_that_are_not_there_are_refused(void)
{
    refuses("instrument m marimba C4 C5; stroke 1 left legato f C6 m;",
            ":1: C6: no part of m, expected C4 .. C5");
    refuses("drum a; stroke 1 left legato f C6 a;", ":1: C6: a has no parts");
    refuses("instrument t temple-blocks; stroke 1 left legato f lowest t;",
            "lowest: no part of t, expected low .. high");
    say("/himc/instrument", "t temple-blocks");
    say("/himc/hit", "left legato f lowest t");
    play(0.05);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(last_error(), "lowest: no part of t"), last_error());
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

// largest force of strike k, of those heard
static double force(int k)
{
    for (int i = 0; i < heard_count; i++)
        if (strcmp(heard[i].path, "/himc/strike") == 0 && k-- == 0)
            return number(lo_message_get_argv(heard[i].message)[6]);
    TEST_FAIL_MESSAGE("no such strike");
    return 0;
}

static void test_sticks_meet_hoop_stick_and_shell_and_then_the_head_again(void)
{
    static const char *const spots[] = {"normal", "crossstick", "rimshot", "click",
                                        "shell",  "normal",     "center"};
    char text[800] = "instrument snare snare; snare place .6 0 .85; human 1 2; tempo 100; ";
    for (int i = 0; i < 14; i++)
        snprintf(text + strlen(text), 60, "stroke %g %s legato f %s snare; ", 2 + 0.5 * i,
                 i % 2 ? "left" : "right", spots[i / 2]);
    subscribe("strikes");
    TEST_ASSERT_EQUAL_STRING("", load(text));
    say("/himc/play", "");
    play(7);
    TEST_ASSERT_EQUAL_STRING("", last_error());
    TEST_ASSERT_EQUAL_INT(14, count("/himc/strike"));
    for (int i = 0; i < 2; i++) {
        TEST_ASSERT_TRUE(force(2 + i) > 5 * force(i)); // wood on steel
        TEST_ASSERT_TRUE(force(6 + i) > 3 * force(i));
        TEST_ASSERT_TRUE(force(8 + i) > 3 * force(i));
        TEST_ASSERT_DOUBLE_WITHIN(0.4 * force(12 + i), force(12 + i), force(4 + i));
        TEST_ASSERT_DOUBLE_WITHIN(0.4 * force(i), force(i), force(10 + i));
    }
    refuses("instrument b bongo; stroke 1 left legato f rimshot b;",
            ":1: rimshot: b has no hoop and shell for a stick, expected a snare, a tom, a timbale");
    refuses("drum d; stroke 1 left legato f click;", "click: the first drum has no hoop and shell");
}

static void test_a_timpano_takes_a_note_and_is_the_drum_for_it(void)
{
    static const char *const notes[] = {"C2", "A2", "D3", "G3"};
    static const double inches[] = {32, 29, 26, 23}, hz[] = {65.41, 110, 146.83, 196};
    for (int i = 0; i < 4; i++) {
        char line[40], name[8];
        snprintf(name, sizeof name, "x%d", i);
        snprintf(line, sizeof line, "%s timpano %s", name, notes[i]);
        say("/himc/instrument", line);
        play(0.05);
        TEST_ASSERT_EQUAL_STRING("", last_error());
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * hz[i], hz[i], pitch(name));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0127 * inches[i],
                                  himc_drum_head_frame(find(name))->radius);
    }
}

static void test_what_cannot_be_made_is_refused_in_one_line(void)
{
    refuses("instrument a banjo;", "instrument: INSTRUMENT: banjo, expected timpano marimba");
    refuses("instrument a;", "INSTRUMENT missing");
    refuses("instrument a timpano D3 E3;", "timpano: a second note, expected one");
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
    say("/himc/instrument", "m marimba C4 D4");
    say("/himc/instrument", "s snare 13");
    say("/membrane/s/wires", "120");
    say("/himc/instrument", "c crash 16 0.9");
    say("/himc/stroke", "1 left legato f D4 m");
    play(0.05);
    himc_mode drum = himc_membrane_mode(himc_drum_membrane(find("s")), 5);
    himc_mode plate = himc_membrane_mode(himc_drum_membrane(find("c")), 300);
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
    himc_score *score = himc_score_load("/tmp/himc-instruments.txt", &error);
    TEST_ASSERT_EQUAL_INT(1, score->stroke_count);
    TEST_ASSERT_EQUAL_STRING("D4", score->strokes[0].part);
    himc_score_free(score);
    unlink("/tmp/himc-instruments.txt");
    himc_mode now = himc_membrane_mode(himc_drum_membrane(find("bell")), 3);
    TEST_ASSERT_EQUAL_DOUBLE(plate.frequency,
                             himc_membrane_mode(himc_drum_membrane(find("c")), 300).frequency);
    TEST_ASSERT_EQUAL_DOUBLE(was.frequency, now.frequency);
    TEST_ASSERT_EQUAL_DOUBLE(was.decay, now.decay);
    now = himc_membrane_mode(himc_drum_membrane(find("s")), 5);
    TEST_ASSERT_EQUAL_DOUBLE(drum.frequency, now.frequency);
    TEST_ASSERT_EQUAL_DOUBLE(drum.decay, now.decay);
    TEST_ASSERT_EQUAL_DOUBLE(120, himc_membrane_head(himc_drum_membrane(find("s")))->wires);
    TEST_ASSERT_TRUE(himc_drum_mallet(find("s"), HIMC_LEFT)->mass == 0.008);
}

// a drum with wires, which are taken off at a beat; its sizes and wires are dumped
static void test_a_score_plays_drums_with_shells_and_takes_wires_off(void)
{
    subscribe("strikes");
    TEST_ASSERT_EQUAL_STRING("", load("instrument s snare; instrument t tom 14; tempo 60;"
                                      "stroke 1 right legato f s; stroke 1.5 left legato f t;"
                                      "at 1.8 s wires 0; at 3 s wires 300;"));
    TEST_ASSERT_EQUAL_DOUBLE(250, himc_membrane_head(himc_drum_membrane(find("s")))->wires);
    say("/himc/play", "");
    play(2.2);
    TEST_ASSERT_EQUAL_INT(2, count("/himc/strike"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.1778, himc_drum_head_frame(find("t"))->radius);
    TEST_ASSERT_EQUAL_DOUBLE(0, himc_membrane_head(himc_drum_membrane(find("s")))->wires);
    play(1.2);
    TEST_ASSERT_EQUAL_DOUBLE(300, himc_membrane_head(himc_drum_membrane(find("s")))->wires);
    say("/membrane/s/wires", "120");
    say("/membrane/t/tune", "100");
    play(0.1);
    TEST_ASSERT_EQUAL_STRING("", last_error());
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 100, pitch("t"));
    refuses("instrument z snare 80;", "INCHES: 80");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_each_stroke_of_a_score_lands_on_its_instrument);
    RUN_TEST(test_strokes_of_a_score_land_on_the_bars_that_they_name);
    RUN_TEST(test_strokes_land_on_a_cymbal_where_it_is_struck_or_on_its_bell);
    RUN_TEST(test_a_roll_on_a_bar_stays_on_it);
    RUN_TEST(test_parts_that_are_not_there_are_refused);
    RUN_TEST(test_an_instrument_comes_over_osc_and_is_there_once);
    RUN_TEST(test_sticks_meet_hoop_stick_and_shell_and_then_the_head_again);
    RUN_TEST(test_a_timpano_takes_a_note_and_is_the_drum_for_it);
    RUN_TEST(test_what_cannot_be_made_is_refused_in_one_line);
    RUN_TEST(test_a_dump_makes_the_instruments_again);
    RUN_TEST(test_a_score_plays_drums_with_shells_and_takes_wires_off);
    return UNITY_END();
}
