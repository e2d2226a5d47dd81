/// test_setups.c: the command `setup`: in a score, from a file, while a score is played.
#include "osc_ear.h"

#include "himc/command_rows.h"

#include "drum/membrane_state.h"
#include "head/idiophone.h"
#include "performance/performance_state.h"
#include "performance/research.h"

#define FILE_NAME "/tmp/himc-setup.txt"
#define NAME(name) name,
static const char *const names[] = {HIMC_SETUPS(NAME) NULL};

static himc_drum *find(const char *name)
{
    himc_drum *drum = NULL;
    for (int i = 0; (drum = himc_performance_drum(performance, i)); i++)
        if (strcmp(himc_drum_name(drum), name) == 0)
            break;
    return drum;
}

static void load(const char *text)
{
    himc_error error = {.text = ""};
    TEST_ASSERT_TRUE_MESSAGE(himc_performance_load_text(performance, text, "s.txt", &error),
                             error.text);
}

static void refuses(const char *text, const char *reason)
{
    himc_error error = {.text = ""};
    TEST_ASSERT_FALSE_MESSAGE(himc_performance_load_text(performance, text, "s.txt", &error), text);
    TEST_ASSERT_EQUAL_STRING(reason, error.text);
}

static void write_file(const char *text)
{
    FILE *file = fopen(FILE_NAME, "w");
    TEST_ASSERT_NOT_NULL(file);
    fputs(text, file);
    fclose(file);
}

// adds a stroke on that part, or on all of it, by the hand on whose side it is
static void add_stroke(int beat, himc_drum *drum, const himc_part *part)
{
    double y = himc_drum_head_frame(drum)->center.y + (part ? part->y : 0);
    char line[80];
    const char *by = drum == find("kick") ? "foot" : y < 0 ? "right" : "left";
    snprintf(line, sizeof line, "%d %s legato f %s %s", beat, by, part ? part->name : "",
             himc_drum_name(drum));
    say("/himc/stroke", line);
}

static void test_a_player_reaches_all_of_each_set_up(void)
{
    for (int i = 0; names[i]; i++) {
        char text[60];
        int beat = 2;
        restart(&(himc_osc_config){.port = 0});
        forget();
        subscribe("strikes");
        snprintf(text, sizeof text, "kettle place -4 4 1; setup %s; tempo 60;", names[i]);
        load(text);
        for (int d = 0; himc_performance_drum(performance, d); d++) {
            himc_drum *drum = himc_performance_drum(performance, d);
            if (drum == find("kettle")) // the one without a set-up, far away
                continue;
            const himc_idiophone *body =
                himc_membrane_config_of(himc_drum_membrane(drum))->shape.body;
            for (int k = 0; k < 4 && body && body->parts > 1; k++)
                add_stroke(beat++, drum, &body->part[k * (body->parts - 1) / 3]);
            if (!body || body->parts == 1)
                add_stroke(beat++, drum, NULL);
        }
        say("/himc/play", "");
        play(beat + 1);
        TEST_ASSERT_EQUAL_STRING_MESSAGE("", last_error(), names[i]);
        TEST_ASSERT_EQUAL_INT_MESSAGE(beat - 2, count("/himc/strike"), names[i]);
    }
}

static void test_a_set_up_comes_while_a_score_is_played_and_takes_nothing_away(void)
{
    subscribe("strikes");
    load("drum low 32; low place .5 .3 .85; tempo 60; stroke 1 left legato f low;"
         "stroke 2 left legato f low; stroke 3 left legato f low;");
    say("/himc/play", "");
    play(1.5);
    say("/himc/setup", "timpani");
    play(3);
    TEST_ASSERT_EQUAL_STRING("", last_error());
    TEST_ASSERT_EQUAL_INT(3, count("/himc/strike"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, .843, himc_drum_head_frame(find("low"))->center.y);
    TEST_ASSERT_NOT_NULL(find("high"));
}

static void test_a_file_is_a_set_up_of_ones_own(void)
{
    write_file("comment my two drums;\ndrum a 23; drum b 29;\nb place .7 .3 .8;\nb tune A2;\n");
    load("setup " FILE_NAME "; stroke 1 left legato f b;");
    TEST_ASSERT_DOUBLE_WITHIN(.01, 110, himc_drum_pitch(find("b")));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, .8, himc_drum_head_frame(find("b"))->center.z);
    write_file("drum c 23;\n\nc tone 110;");
    refuses("tempo 60;\nsetup " FILE_NAME ";", "s.txt:2: setup: " FILE_NAME ":3: c: tone: unknown "
                                               "command, did you mean tune?");
    write_file("drum c 23;\nstroke 1 left legato f;");
    refuses("setup " FILE_NAME ";", "s.txt:1: setup: " FILE_NAME ":2: a stroke, a tempo or `at`, "
                                    "expected instruments");
    refuses("setup kit;\nsetup marimba;", "s.txt:2: setup: a second one, the first is in line 1; "
                                          "expected one, and `instrument` for others");
    write_file("setup timpani;");
    refuses("setup " FILE_NAME ";",
            "s.txt:1: setup: " FILE_NAME ":1: setup: one in another, expected instruments");
    unlink(FILE_NAME);
    refuses("setup " FILE_NAME ";",
            "s.txt:1: setup: " FILE_NAME ": cannot be read: No such file or directory");
    say("/himc/setup", FILE_NAME);
    play(0.05);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(last_error(), "over the network"), last_error());
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_player_reaches_all_of_each_set_up);
    RUN_TEST(test_a_set_up_comes_while_a_score_is_played_and_takes_nothing_away);
    RUN_TEST(test_a_file_is_a_set_up_of_ones_own);
    return UNITY_END();
}
