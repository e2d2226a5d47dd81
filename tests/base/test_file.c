/// test_file.c: a FIFO, a socket, a device or a folder in a file's place is refused at once, by
/// every reader and writer of the library. What waits is ended by the alarm, and the program fails.
#define _DEFAULT_SOURCE // mkdtemp
#include "unity.h"

#include "base/file.h"
#include "himc/drum.h"
#include "himc/mocap.h"
#include "plan/score.h"
#include "system/files.h"
#include "take_files.h"

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#define PATIENCE 60 // (s) chosen: all of it takes milliseconds

static const char *const kinds[] = {"a FIFO", "a socket", "a device", "a folder"};
enum { FIFO, SOCKET, DEVICE, FOLDER, KINDS };

static char folder[] = "/tmp/himc-file-XXXXXX", path[200];
static himc_error error;

void setUp(void)
{
    error.text[0] = '\0';
    alarm(PATIENCE);
}

void tearDown(void)
{
}

// the path of `name` in the folder
static const char *at(const char *name)
{
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static void put(const char *name, const char *text)
{
    FILE *file = fopen(at(name), "wb");
    fputs(text, file);
    fclose(file);
}

static bool has(const char *name, const char *text)
{
    char *now = read_all(at(name), &(size_t){0});
    bool same = now && strcmp(now, text) == 0;
    free(now);
    return same;
}

// makes something of this kind
static void make(int kind, const char *name)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    int s = socket(AF_UNIX, SOCK_DGRAM, 0);
    remove(at(name));
    memcpy(address.sun_path, path, strlen(path) + 1);
    int done = kind == FIFO     ? mkfifo(path, 0666)
               : kind == SOCKET ? bind(s, (struct sockaddr *)&address, sizeof address)
               : kind == DEVICE ? symlink("/dev/zero", path)
                                : mkdir(path, 0777);
    TEST_ASSERT_EQUAL_INT(0, done);
    close(s);
}

static void read_score(const char *name)
{
    TEST_ASSERT_NULL(himc_score_load(at(name), &error));
}

static void read_take(const char *name)
{
    TEST_ASSERT_NULL(himc_take_load(at(name), NULL, &error));
}

static void read_shape(const char *name)
{
    himc_drum *drum = himc_drum_new("kettle", 23, 48000, &error);
    himc_atom atom = {.kind = HIMC_ATOM_SYMBOL, .symbol = at(name)};
    himc_command command;
    TEST_ASSERT_TRUE(himc_command_parse(&command, HIMC_DRUM, "shape", &atom, 1, &error));
    TEST_ASSERT_FALSE(himc_drum_command(drum, &command, &error));
    himc_drum_release(drum);
}

// the table of a head's file
static void read_table(const char *name)
{
    char text[300];
    snprintf(text, sizeof text, "tension 3000\nmass %s\n", name);
    put("head.txt", text);
    read_shape("head.txt");
    at(name);
}

static void write_take(const char *name)
{
    himc_take *take = himc_take_load(at("good.trc"), NULL, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    TEST_ASSERT_FALSE(himc_take_save(take, at(name), &error));
    himc_take_free(take);
}

static void write_recording(const char *name)
{
    himc_skeleton skeleton;
    himc_skeleton_config config = himc_skeleton_default();
    TEST_ASSERT_TRUE(himc_skeleton_init(&skeleton, &config, &error));
    TEST_ASSERT_NULL(himc_recording_new(at(name), &skeleton, 250, 1, &error));
}

static void write_again(const char *name)
{
    TEST_ASSERT_NULL(himc_file_write(at(name), HIMC_FILE_REPLACE, &error));
}

static const struct {
    const char *name;
    void (*use)(const char *name);
    bool writes;
} users[] = {
    {"x.txt", read_score, false},     {"x.bvh", read_take, false},  {"x.c3d", read_take, false},
    {"x.trc", read_take, false},      {"x.txt", read_shape, false}, {"x.txt", read_table, false},
    {"x.trc", write_take, true},      {"x.bvh", write_take, true},  {"x.c3d", write_take, true},
    {"x.bvh", write_recording, true}, {"x.csv", write_again, true},
};

static void test_whatever_is_no_file_is_refused_at_once_by_every_reader_and_writer(void)
{
    char expected[300];
    for (size_t u = 0; u < sizeof users / sizeof users[0]; u++)
        for (int kind = 0; kind < KINDS; kind++) {
            make(kind, users[u].name);
            users[u].use(users[u].name);
            snprintf(expected, sizeof expected, "%s: cannot be %s: %s, expected a regular file",
                     path, users[u].writes ? "written" : "read", kinds[kind]);
            const char *said = strstr(error.text, expected);
            TEST_ASSERT_NOT_NULL_MESSAGE(said, error.text);
            TEST_ASSERT_EQUAL_STRING(expected, said);
            TEST_ASSERT_NULL(strchr(error.text, '\n'));
            struct stat status;
            TEST_ASSERT_EQUAL_INT_MESSAGE(0, lstat(path, &status), "it is still there");
            remove(path);
        }
}

static void test_fifo_with_a_reader_gets_nothing(void)
{
    char byte;
    make(FIFO, "heard");
    int ear = open(path, O_RDONLY | O_NONBLOCK);
    TEST_ASSERT_NULL(himc_file_write(path, HIMC_FILE_REPLACE, &error));
    TEST_ASSERT_EQUAL_INT(0, read(ear, &byte, 1));
    close(ear);
    remove(path);
}

static void test_file_is_cut_or_continued_as_asked(void)
{
    char word[8] = "";
    put("old", "old");
    FILE *file = himc_file_write(at("old"), HIMC_FILE_CONTINUE, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(file, error.text);
    TEST_ASSERT_NOT_NULL(fgets(word, sizeof word, file));
    TEST_ASSERT_EQUAL_STRING("old", word);
    rewind(file);
    TEST_ASSERT_TRUE(fputs("er", file) >= 0);
    fclose(file);
    TEST_ASSERT_TRUE_MESSAGE(has("old", "older"), "written at the end, wherever it was read");
    fclose(himc_file_write(at("old"), HIMC_FILE_REPLACE, &error));
    TEST_ASSERT_TRUE(has("old", ""));
}

static void test_null_device_may_be_written(void)
{
    FILE *file = himc_file_write("/dev/null", HIMC_FILE_REPLACE, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(file, error.text);
    TEST_ASSERT_TRUE(fputs("gone", file) >= 0);
    TEST_ASSERT_EQUAL_INT(0, fclose(file));
    TEST_ASSERT_NULL(himc_file_read("/dev/null", &error));
}

static void test_recording_leaves_an_existing_file_as_it_is_and_makes_none(void)
{
    himc_skeleton skeleton;
    himc_skeleton_config config = himc_skeleton_default();
    TEST_ASSERT_TRUE(himc_skeleton_init(&skeleton, &config, &error));
    put("old.bvh", "old");
    himc_recording_free(himc_recording_new(at("old.bvh"), &skeleton, 250, 1, &error));
    TEST_ASSERT_TRUE(has("old.bvh", "old"));
    himc_recording_free(himc_recording_new(at("new.bvh"), &skeleton, 250, 1, &error));
    TEST_ASSERT_FALSE(has("new.bvh", ""));
}

static void test_file_is_loaded_whole_or_refused(void)
{
    size_t size = 0, most = 1 << 20;
    char *text = malloc(most + 2);
    memset(text, 'a', most + 1);
    text[most] = text[most + 1] = '\0';
    put("long", text);
    char *loaded = himc_file_load(at("long"), most, &size, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(loaded, error.text);
    TEST_ASSERT_TRUE(size == most);
    TEST_ASSERT_EQUAL_STRING(text, loaded);
    free(loaded);
    text[most] = 'a';
    put("long", text);
    TEST_ASSERT_NULL(himc_file_load(at("long"), most, &size, &error));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, "long: too long, expected 1 MiB"), error.text);
    free(text);
    // the kernel says 0 bytes of such a file
    loaded = himc_file_load("/proc/self/status", most, &size, &error);
    TEST_ASSERT_TRUE(loaded && size > 100 && strstr(loaded, "Threads:"));
    free(loaded);
}

// a program that was started without a standard input has the descriptor 0 to give
static void test_a_file_may_be_descriptor_0(void)
{
    int input = dup(0);
    for (int write = 0; write < 2; write++) {
        close(0);
        FILE *stream = write ? himc_file_write(at("written"), HIMC_FILE_REPLACE, &error)
                             : himc_file_read("README.md", &error);
        bool good = stream && fileno(stream) == 0;
        if (stream)
            fclose(stream);
        dup2(input, 0);
        TEST_ASSERT_TRUE_MESSAGE(good, error.text);
    }
    // inside a folder, which has the descriptor before its file does
    close(0);
    size_t size;
    char *bytes = himc_file_load_in(folder, "good.trc", 1 << 20, &size, &error);
    dup2(input, 0);
    TEST_ASSERT_NOT_NULL_MESSAGE(bytes, error.text);
    free(bytes);
    // what is refused is closed again: 0 is free
    close(0);
    FILE *none[] = {himc_file_read(folder, &error), himc_file_read("/dev/null", &error)};
    char *beside = himc_file_load_in(folder, ".", 1 << 20, &size, &error);
    int free_one = dup(input);
    dup2(input, 0);
    TEST_ASSERT_TRUE(!none[0] && !none[1] && !beside);
    TEST_ASSERT_EQUAL_INT(0, free_one);
    close(input);
}

// links to links, each with a shorter name than the one before; the last one is absolute
static void test_links_are_followed_to_a_file_that_does_not_exist_yet(void)
{
    char target[200];
    snprintf(target, sizeof target, "%s/new", folder);
    TEST_ASSERT_EQUAL_INT(0, symlink("a-link-with-a-long-name", at("first")));
    TEST_ASSERT_EQUAL_INT(0, symlink("shorter", at("a-link-with-a-long-name")));
    TEST_ASSERT_EQUAL_INT(0, symlink("new", at("shorter")));
    TEST_ASSERT_EQUAL_INT(0, symlink(target, at("whole")));
    for (int whole = 0; whole < 2; whole++) {
        char *end = himc_system_target(at(whole ? "whole" : "first"));
        TEST_ASSERT_EQUAL_STRING(target, end);
        free(end);
    }
}

int main(void)
{
    UNITY_BEGIN();
    TEST_ASSERT_NOT_NULL(mkdtemp(folder));
    put("good.trc", "PathFileType\t4\t(X/Y/Z)\ta.trc\n"
                    "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\n100\t100\t2\t1\tmm\n"
                    "Frame#\tTime\tTIP\t\t\n\t\tX1\tY1\tZ1\n\n"
                    "1\t0.00\t500\t900\t100\n2\t0.01\t500\t850\t100\n");
    RUN_TEST(test_a_file_may_be_descriptor_0);
    RUN_TEST(test_whatever_is_no_file_is_refused_at_once_by_every_reader_and_writer);
    RUN_TEST(test_fifo_with_a_reader_gets_nothing);
    RUN_TEST(test_file_is_cut_or_continued_as_asked);
    RUN_TEST(test_null_device_may_be_written);
    RUN_TEST(test_recording_leaves_an_existing_file_as_it_is_and_makes_none);
    RUN_TEST(test_file_is_loaded_whole_or_refused);
    RUN_TEST(test_links_are_followed_to_a_file_that_does_not_exist_yet);
    return UNITY_END();
}
