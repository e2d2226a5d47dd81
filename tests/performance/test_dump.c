/// test_dump.c: `dump` tells a state as commands: a new drum or performer that carries them out
/// sounds the same, bit by bit.
#include "session.h"

#include "disc_mesh.h"
#include "random_commands.h"

#include "base/text.h"
#include "himc/loader.h"

#include <math.h>

#define RATE 48000.0
#define LENGTH 4800
static char folder[] = "/tmp/himc-dump-XXXXXX", grid[64], score[64];

/// A command that is no setting, or a stroke: a score puts those in the order of beats.
static bool is_no_setting(himc_command_id id)
{
    switch (id) {
    case HIMC_COMMAND_STROKE:
    case HIMC_COMMAND_ROLL:
    case HIMC_COMMAND_FLAM:
    case HIMC_COMMAND_DRAG:
    case HIMC_COMMAND_RUFF:
    case HIMC_COMMAND_NOTE:
    case HIMC_COMMAND_CLOCK:
    case HIMC_COMMAND_DRUM_GLISS:
    case HIMC_COMMAND_GET:
    case HIMC_COMMAND_SCORE:
    case HIMC_COMMAND_TAKE:
    case HIMC_COMMAND_UNITS:
    case HIMC_COMMAND_RECORD:
    case HIMC_COMMAND_DUMP:
    case HIMC_COMMAND_DRUM_DUMP:
    case HIMC_COMMAND_DRUM_INFO:
    case HIMC_COMMAND_PRESET:
    case HIMC_COMMAND_DRUM_PRESET:
    case HIMC_COMMAND_PLAY:
    case HIMC_COMMAND_STOP:
    case HIMC_COMMAND_SEEK:
    case HIMC_COMMAND_TARGET:
    case HIMC_COMMAND_HIT:
    case HIMC_COMMAND_PUSH:
    case HIMC_COMMAND_STRIKE: return true;
    default:
        return himc_command_table((int)id)->when == HIMC_WHEN_HOST ||
               himc_command_table((int)id)->when == HIMC_WHEN_NETWORK;
    }
}

/// A setting at random that the parser accepts.
static void random_setting(himc_command *command, himc_receiver receiver, random_seed *seed)
{
    static const char *const files[] = {grid, NULL};
    spoken said;
    random_files = files;
    for (;;) {
        const himc_command_row *row = himc_command_table(any_of(seed, HIMC_COMMANDS));
        if (row->receiver != receiver || is_no_setting(row->id))
            continue;
        random_command(&said, row, seed);
        if (!himc_command_parse(command, receiver, said.name, said.atom, said.count, &error))
            continue;
        if (command->id == HIMC_COMMAND_GLISS)
            command->atom[1].number = 0; // a pedal on its way is no part of the state
        return;
    }
}

static himc_text_lines lines;

static const char *state_of_drum(const himc_drum *drum)
{
    himc_text_clear(&lines);
    himc_drum_describe(drum, HIMC_DESCRIBE_STATE, himc_text_add, &lines);
    return lines.bytes;
}

static const char *state_of(const himc_performance *p)
{
    himc_text_clear(&lines);
    himc_performance_describe(p, HIMC_DESCRIBE_STATE, himc_text_add, &lines);
    return lines.bytes;
}

static char *copy_of(const char *text)
{
    char *copy = malloc(strlen(text) + 1);
    return strcpy(copy, text);
}

static void send_to_drum(himc_drum *drum, const char *state)
{
    char line[2048];
    himc_command command;
    for (const char *end; (end = strstr(state, ";\n")); state = end + 2) {
        snprintf(line, sizeof line, "%.*s", (int)(end - state), state);
        bool good = himc_command_parse_text(&command, HIMC_DRUM, line, &error) &&
                    himc_drum_command(drum, &command, &error);
        if (!good)
            printf("%s\n", line);
        TEST_ASSERT_TRUE_MESSAGE(good, error.text);
    }
}

static void sound_of(himc_drum *drum, double sound[HIMC_PICKUPS][LENGTH])
{
    himc_drum_advance(drum, LENGTH, NULL, NULL, NULL); // what changed over has changed
    TEST_ASSERT_TRUE(himc_drum_strike_at(drum, 0, 0.01, 0.01, 3, &error));
    himc_drum_advance(drum, LENGTH, NULL, NULL, NULL);
    for (int k = 0; k < HIMC_PICKUPS; k++)
        himc_drum_read_channel(drum, k, himc_drum_time(drum) - LENGTH, LENGTH, sound[k]);
}

static void test_drum_made_again_from_its_dump_sounds_the_same_bit_by_bit(void)
{
    static double first[HIMC_PICKUPS][LENGTH], again[HIMC_PICKUPS][LENGTH];
    random_seed seed = 17;
    for (int trial = 0; trial < 40; trial++) {
        himc_drum *drum = himc_drum_new("kettle", 23 + trial % 10, RATE, &error);
        for (int i = 0; i < 12; i++) {
            himc_command command;
            random_setting(&command, HIMC_DRUM, &seed);
            himc_drum_command(drum, &command, NULL);
        }
        char *state = copy_of(state_of_drum(drum));
        himc_drum *other = himc_drum_new("kettle", 23 + trial % 10, RATE, &error);
        send_to_drum(other, state);
        TEST_ASSERT_EQUAL_STRING(state, state_of_drum(other));
        sound_of(drum, first);
        sound_of(other, again);
        TEST_ASSERT_EQUAL_MEMORY(first, again, sizeof first);
        free(state);
        himc_drum_release(drum);
        himc_drum_release(other);
    }
}

static void test_drum_takes_the_dump_of_another_whatever_it_was_before(void)
{
    random_seed seed = 5;
    himc_drum *other = himc_drum_new("kettle", 26, RATE, &error);
    for (int trial = 0; trial < 40; trial++) {
        himc_drum *drum = himc_drum_new("kettle", 26, RATE, &error);
        for (int i = 0; i < 8; i++) {
            himc_command command;
            random_setting(&command, HIMC_DRUM, &seed);
            himc_drum_command(drum, &command, NULL);
        }
        char *state = copy_of(state_of_drum(drum));
        send_to_drum(other, state);
        himc_drum_release(drum);
        free(state);
    }
    himc_drum_release(other);
}

static void save(const char *path, const char *text)
{
    FILE *file = fopen(path, "wb");
    TEST_ASSERT_NOT_NULL(file);
    fputs(text, file);
    fclose(file);
}

static void compare_playing(himc_performance *a, himc_performance *b, int seconds_of_ten)
{
    static double one[LENGTH], two[LENGTH];
    session_do(a, "play");
    session_do(b, "play");
    for (int i = 0; i < seconds_of_ten; i++) {
        himc_performance_process(a, LENGTH, NULL);
        himc_performance_process(b, LENGTH, NULL);
        himc_drum *drum;
        for (int d = 0; (drum = himc_performance_drum(a, d)); d++)
            for (int k = 0; k < 2; k++) {
                himc_drum *other = himc_performance_drum(b, d);
                himc_drum_read_channel(drum, k, (uint64_t)i * LENGTH, LENGTH, one);
                himc_drum_read_channel(other, k, (uint64_t)i * LENGTH, LENGTH, two);
                TEST_ASSERT_EQUAL_MEMORY(one, two, sizeof one);
            }
    }
}

static void test_performance_made_again_from_its_dump_plays_the_same_bit_by_bit(void)
{
    random_seed seed = 3;
    for (int trial = 0; trial < 10; trial++) {
        himc_performance *p = session_new(), *other = session_new();
        for (int i = 0; i < 12; i++) {
            himc_command command;
            random_setting(&command, HIMC_PERFORMER, &seed);
            himc_performance_command(p, &command, 0, NULL);
        }
        session_do(p, "stroke 0 right accent f");
        char *state = copy_of(state_of(p));
        save(score, state);
        session_do(other, "score %s", score);
        TEST_ASSERT_EQUAL_STRING(state, state_of(other));
        compare_playing(p, other, 3);
        free(state);
        himc_performance_free(p);
        himc_performance_free(other);
    }
}

static void test_performance_with_four_drums_and_odd_settings_plays_the_same_from_its_dump(void)
{
    static const char *const said[] = {"drum low 32",
                                       "drum second 29",
                                       "drum kettle 26",
                                       "drum high 23",
                                       "player 1.62 54.3",
                                       "gain frequency 1.37",
                                       "gain right-wrist 31.7 0.93",
                                       "strength human",
                                       "law feedforward",
                                       "grip french",
                                       "human 0.37 11",
                                       "latency 87.3",
                                       "damping 0.0137",
                                       "weights 0.3 1.1 2.7 0.9",
                                       "rate physics 7919",
                                       "rate task 331",
                                       "listener -1.3 0.7 1.4",
                                       "room 2.3 731",
                                       "gain -3.3",
                                       "tempo 97.3",
                                       "stroke 0 right accent f rim low",
                                       "stroke 0.33 left legato 0.37 0.11 -0.07 kettle",
                                       "flam 0.7 left tenuto mf second",
                                       "roll 1 2 press pp ff high",
                                       "loop 1"};
    static const char *const drum_said[4][4] = {
        {"tune A2", "decay 1.7", "mallet soft", "gain -4.1"},
        {"tune 117.3", "density 0.31", "mallet 3e8 2.3 0.021", "noise 0.3 8"},
        {"pickups 2", "radius 0.29", "uniformity 0.31 7", "glide 0.3"},
        {"shape rectangle 0.5 0.37", "tune 151.3", "damp 0.1", "decay 2.7 1e-6"}};
    himc_performance *p = session_new(), *other = session_new();
    for (size_t i = 0; i < sizeof said / sizeof *said; i++)
        session_do(p, "%s", said[i]);
    for (int d = 0; d < 4; d++)
        for (int i = 0; i < 4; i++) {
            himc_command c;
            TEST_ASSERT_TRUE_MESSAGE(
                himc_command_parse_text(&c, HIMC_DRUM, drum_said[d][i], &error) &&
                    himc_drum_command(himc_performance_drum(p, d), &c, &error),
                error.text);
        }
    session_do(p, "dump %s", score);
    session_do(other, "score %s", score);
    char *state = copy_of(state_of(p));
    TEST_ASSERT_EQUAL_STRING(state, state_of(other));
    free(state);
    compare_playing(p, other, 30);
    himc_performance_free(p);
    himc_performance_free(other);
}

static void test_performer_takes_the_dump_of_another_body(void)
{
    himc_performance *p = session_new(), *other = session_new();
    session_do(other, "player 1.62 54.3");
    save(score, state_of(p));
    session_do(other, "score %s", score);
    char *state = copy_of(state_of(p));
    TEST_ASSERT_EQUAL_STRING(state, state_of(other));
    free(state);
    compare_playing(p, other, 2);
    himc_performance_free(p);
    himc_performance_free(other);
}

static void send(himc_performance *p, const char *state)
{
    char line[2048];
    for (const char *end; (end = strstr(state, ";\n")); state = end + 2) {
        snprintf(line, sizeof line, "%.*s", (int)(end - state), state);
        bool good = session_try(p, "%s", line);
        if (!good)
            printf("%s\n", line);
        TEST_ASSERT_TRUE_MESSAGE(good, error.text);
    }
}

// to the drum of that name, which may refuse it
static void session_drum_command(himc_performance *p, const char *name, himc_command *command)
{
    snprintf(command->drum, sizeof command->drum, "%s", name);
    himc_performance_command(p, command, 0, NULL);
}

// what a player of two drums writes: strokes, ornaments, pedals, hands, tempi, in any order
static void write_at_random(himc_performance *p, random_seed *seed)
{
    static const char *const drum[] = {"low", "high"}, *const nuance[] = {"legato", "accent"};
    static const char *const stroke[] = {"stroke", "flam", "drag", "ruff"};
    static const char *const change[] = {"tune A2", "tune D3", "damp 1", "damp 0", "glide 0.5"};
    for (int i = 0; i < 3; i++) // how many grace notes fit depends on it
        session_do(p, "tempo %d %d", 60 + any_of(seed, 90), any_of(seed, 8));
    for (int i = 0; i < 20; i++) {
        const char *name = drum[any_of(seed, 2)];
        switch (any_of(seed, 4)) {
        case 0:
        case 1: session_try(p, "at %g %s %s", 12 * any(seed), name, change[any_of(seed, 5)]); break;
        default: // one that is too near to another is refused, as a pitch that a head has not
            session_try(p, "%s %d %s %s %g %s %s", stroke[any_of(seed, 4)], 1 + any_of(seed, 8),
                        any_of(seed, 2) ? "left" : "right", nuance[any_of(seed, 2)], any(seed),
                        any_of(seed, 2) ? "rim" : "normal", name);
        }
    }
}

static void test_a_dump_sent_back_line_by_line_makes_the_same_performance(void)
{
    random_seed seed = 11;
    for (int trial = 0; trial < (getenv("HIMC_LONG") ? 12 : 5); trial++) {
        himc_performance *p = session_new(), *other = session_new();
        himc_command command;
        for (int i = 0; i < 4; i++) {
            random_setting(&command, HIMC_PERFORMER, &seed);
            himc_performance_command(p, &command, 0, NULL);
        }
        session_do(p, "clear");       // what `at` was among them
        session_do(p, "engine tree"); // ODE's bits also depend on what it did before
        session_do(p, "drum low 29");
        session_do(p, "drum high 23");
        for (int i = 0; i < 6; i++) {
            random_setting(&command, HIMC_DRUM, &seed);
            session_drum_command(p, i % 2 ? "low" : "high", &command);
        }
        session_try(p, "low shape circle"); // a pedal needs a pitch
        session_try(p, "high shape circle");
        session_do(p, "high damp 0.2");
        write_at_random(p, &seed);
        char *state = copy_of(state_of(p));
        send(other, state);
        TEST_ASSERT_EQUAL_STRING(state, state_of(other));
        compare_playing(p, other, 40);
        free(state);
        himc_performance_free(p);
        himc_performance_free(other);
    }
}

// beside what stood there when it was made
static void test_a_drum_without_a_place_is_restored_where_it_stood(void)
{
    himc_performance *p = session_new(), *other = session_new();
    session_do(p, "setup bells");
    session_do(p, "drum low");
    session_do(p, "bells place 2 1 1");
    char *state = copy_of(state_of(p));
    send(other, state);
    TEST_ASSERT_EQUAL_STRING(state, state_of(other));
    const himc_head_frame *was = himc_drum_head_frame(himc_performance_drum(p, 1)),
                          *now = himc_drum_head_frame(himc_performance_drum(other, 1));
    TEST_ASSERT_TRUE(was->center.y < -0.1); // no longer where one would be put
    TEST_ASSERT_EQUAL_MEMORY(&was->center, &now->center, sizeof now->center);
    free(state);
    himc_performance_free(p);
    himc_performance_free(other);
}

static void test_a_state_is_restored_from_text_all_or_nothing(void)
{
    himc_performance *p = session_new(), *other = session_new();
    himc_loader *loader = himc_loader_new(&error);
    session_do(p, "human 0.3 2");
    session_do(p, "stroke 0 right accent f");
    char *state = copy_of(state_of(p));
    himc_load_target performer = {.performance = other};
    TEST_ASSERT_TRUE_MESSAGE(himc_loader_restore(loader, &performer, state, &error), error.text);
    TEST_ASSERT_EQUAL_STRING(state, state_of(other));
    TEST_ASSERT_FALSE(himc_loader_restore(loader, &performer, "human 0.7;\nloop 3;\n", &error));
    TEST_ASSERT_EQUAL_STRING("state:2: loop: SWITCH: 3, expected 0 .. 1, whole", error.text);
    TEST_ASSERT_EQUAL_STRING(state, state_of(other));
    free(state);
    himc_load_target drum = {.drum = himc_performance_drum(other, 0)};
    state = copy_of(state_of_drum(drum.drum));
    TEST_ASSERT_FALSE(himc_loader_restore(loader, &drum, "mallet wood;\nnoise 7;\n", &error));
    TEST_ASSERT_EQUAL_STRING("state:2: noise: AMOUNT: 7, expected 0 .. 1", error.text);
    TEST_ASSERT_EQUAL_STRING(state, state_of_drum(drum.drum));
    TEST_ASSERT_TRUE(himc_loader_restore(loader, &drum, "mallet wood;\nnoise 0.7;\n", &error));
    TEST_ASSERT_NOT_NULL(strstr(state_of_drum(drum.drum), "mallet wood;\nnoise 0.7;\n"));
    free(state);
    himc_loader_free(loader);
    himc_performance_free(p);
    himc_performance_free(other);
}

static void test_what_is_written_keeps_its_order_in_a_restored_state(void)
{
    static const char *const written[] = {"stroke 5 left legato f normal kettle",
                                          "at 4 kettle damp 1",
                                          "stroke 3 right accent p rim kettle",
                                          "at 3 low tune C3",
                                          "at 2 kettle tune D3",
                                          "roll 2.5 1 press f f normal low",
                                          "stroke 1 left legato f normal low",
                                          "at 2 kettle damp 0",
                                          "at 4 kettle damp 0.5"};
    char expected[1000] = "";
    himc_performance *p = session_new(), *other = session_new();
    session_do(p, "drum low 29");
    session_do(p, "drum kettle 26");
    for (size_t i = 0; i < sizeof written / sizeof *written; i++) {
        session_do(p, "%s", written[i]);
        sprintf(expected + strlen(expected), "%s;\n", written[i]);
    }
    char *state = copy_of(state_of(p));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(state, expected), state);
    save(score, state);
    session_do(other, "score %s", score);
    TEST_ASSERT_EQUAL_STRING(state, state_of(other));
    free(state);
    himc_performance_free(p);
    himc_performance_free(other);
}

static void test_presets_are_what_a_dump_has_written_all_or_nothing(void)
{
    himc_command c;
    himc_performance *p = session_new(), *other = session_new();
    session_do(p, "drum kettle 29");
    session_do(p, "human 0.3 2");
    session_do(p, "dump %s/piece.txt", folder);
    TEST_ASSERT_FALSE(session_try(p, "dump %s/piece", folder));
    TEST_ASSERT_FALSE(session_try(p, "preset %s/piece", folder)); // a name, no path
    TEST_ASSERT_EQUAL_INT(0, chdir(folder));
    session_do(other, "preset piece");
    char *state = copy_of(state_of(p));
    TEST_ASSERT_EQUAL_STRING(state, state_of(other));
    free(state);
    save("pedal.txt", "drum kettle 29;\nstroke 1 left accent f;\nat 2 kettle tune 120.3;\n");
    session_do(p, "score pedal.txt");
    TEST_ASSERT_NOT_NULL(strstr(state_of(p), "\nat 2 kettle tune 120.3;\n"));
    himc_drum *drum = himc_performance_drum(p, 0), *second = himc_performance_drum(other, 0);
    send_to_drum(drum, "tune A2;\nmallet wood;\nnoise 0.3;\nplace 0.6 0.1 0.8 0.1;\ngain -3;\n"
                       "dump timpano.txt;\n");
    send_to_drum(second, "preset timpano;\n");
    state = copy_of(state_of_drum(drum));
    TEST_ASSERT_EQUAL_STRING(state, state_of_drum(second));
    save("bad.txt", "tune 150;\nmallet soft;\nnoise 7;\n");
    TEST_ASSERT_TRUE(himc_command_parse_text(&c, HIMC_DRUM, "preset bad", &error));
    TEST_ASSERT_FALSE(himc_drum_command(second, &c, &error));
    TEST_ASSERT_EQUAL_STRING("preset: bad.txt:3: noise: AMOUNT: 7, expected 0 .. 1", error.text);
    TEST_ASSERT_EQUAL_STRING(state, state_of_drum(second));
    FILE *zero = fopen("zero.txt", "wb"); // what follows the zero would be lost without a word
    fwrite("tune 150;\n\0mallet wood;\n", 1, 24, zero);
    fclose(zero);
    TEST_ASSERT_TRUE(himc_command_parse_text(&c, HIMC_DRUM, "preset zero", &error));
    TEST_ASSERT_FALSE(himc_drum_command(second, &c, &error));
    TEST_ASSERT_EQUAL_STRING("preset: zero.txt:2: a zero byte, expected text", error.text);
    TEST_ASSERT_EQUAL_STRING(state, state_of_drum(second));
    free(state);
    himc_performance_free(p);
    himc_performance_free(other);
}

int main(void)
{
    char all[80];
    disc_mesh disc = disc_mesh_new(4, 0.3, 4000, 0.3);
    if (!mkdtemp(folder))
        return 1;
    disc_mesh_write(&disc, folder, 4000, 0.3);
    disc_mesh_free(&disc);
    snprintf(grid, sizeof grid, "%s/disc.txt", folder);
    snprintf(score, sizeof score, "%s/score.txt", folder);
    UNITY_BEGIN();
    RUN_TEST(test_drum_made_again_from_its_dump_sounds_the_same_bit_by_bit);
    RUN_TEST(test_drum_takes_the_dump_of_another_whatever_it_was_before);
    RUN_TEST(test_performance_made_again_from_its_dump_plays_the_same_bit_by_bit);
    RUN_TEST(test_performance_with_four_drums_and_odd_settings_plays_the_same_from_its_dump);
    RUN_TEST(test_performer_takes_the_dump_of_another_body);
    RUN_TEST(test_a_dump_sent_back_line_by_line_makes_the_same_performance);
    RUN_TEST(test_a_drum_without_a_place_is_restored_where_it_stood);
    RUN_TEST(test_a_state_is_restored_from_text_all_or_nothing);
    RUN_TEST(test_what_is_written_keeps_its_order_in_a_restored_state);
    RUN_TEST(test_presets_are_what_a_dump_has_written_all_or_nothing);
    free(lines.bytes);
    snprintf(all, sizeof all, "rm -rf %s", folder);
    if (system(all) != 0)
        return 1;
    return UNITY_END();
}
