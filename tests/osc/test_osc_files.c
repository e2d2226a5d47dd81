// Files that are named over the network: a score has no more rights than its sender. Each attempt
// to reach a file outside the folder, or to write one, is answered by exactly one line that tells
// nothing.
#include "osc_ear.h"

#include "performance/confine.h"

#include <dlfcn.h>

// in a folder of the test: `share` is given by --files, the rest is outside
#define SECRET "SECRETWORD"
static char root[64], share[80];
static bool swap_armed; // the next file that realpath finds is replaced by a link to the outside

static const char *at(const char *name)
{
    static char path[4][256];
    static int turn;
    turn = (turn + 1) % 4;
    snprintf(path[turn], sizeof path[turn], "%s/%s", root, name);
    return path[turn];
}

static void write_text(const char *name, const char *text)
{
    FILE *f = fopen(at(name), "w");
    TEST_ASSERT_NOT_NULL_MESSAGE(f, name);
    fputs(text, f);
    fclose(f);
}

static void run_here(const char *text)
{
    himc_command command;
    himc_error error;
    TEST_ASSERT_TRUE_MESSAGE(himc_command_parse_text(&command, HIMC_PERFORMER, text, &error) &&
                                 himc_performance_command(performance, &command, 0, &error),
                             error.text);
}

static void shell(const char *command)
{
    char line[1024];
    snprintf(line, sizeof line, "cd %s && %s", root, command);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, system(line), line);
}

// takes, scores and heads outside and inside, and ways from inside to outside
static void make_folder(void)
{
    char record[128];
    snprintf(root, sizeof root, "/tmp/himc-osc-XXXXXX");
    TEST_ASSERT_NOT_NULL(mkdtemp(root));
    snprintf(share, sizeof share, "%s/share", root);
    shell("mkdir share share/sub share/y share/dir.bvh share2y shore shore/y out");
    snprintf(record, sizeof record, "record %s", at("secret.bvh"));
    run_here(record);
    play(0.1);
    run_here("record stop");
    write_text("secret.txt", "stroke 1 left accent f;\n");
    write_text("word.txt", SECRET " 1 2 3;\n");
    write_text("share/head.txt", "tension 3528\ndensity 0.26\nplaces ../word.txt\n");
    write_text("share/good.txt", "stroke 1 left accent f;\n");
    write_text("share/play.txt", "take ok.bvh;\n");
    shell(
        "cp secret.bvh share/ok.bvh; cp secret.bvh share/y; cp secret.txt share/y;"
        "cp secret.* share2y; cp secret.* shore/y; cp secret.* word.txt out; cp word.txt word.bvh;"
        "cd share; ln -s ../secret.bvh link.bvh; ln -s ../secret.txt link.txt;"
        "ln -s link.bvh chain.bvh; ln -s loop.bvh loop.bvh; ln -s ../out linked;"
        "ln -s ok.bvh inside.bvh; ln -s good.txt inside.txt; ln -s ../../word.bvh sub/word.bvh;"
        "ln -s /dev/zero zero.bvh; ln -s /proc/self/environ proc.txt; mkfifo fifo.bvh fifo.txt;"
        "ln -s ../share2y/secret.bvh sibling.bvh; ln -s ../new.bvh new.bvh; ln -s .. up");
}

static void share_folder(void)
{
    make_folder();
    restart(&(himc_osc_config){.files = share});
}

// names like the folder's and not below it are outside
static const char *const takes[] = {"../secret.bvh",
                                    "/ROOT/secret.bvh",
                                    "link.bvh",
                                    "chain.bvh",
                                    "loop.bvh",
                                    "linked/secret.bvh",
                                    "up/secret.bvh",
                                    "up/share/../secret.bvh",
                                    "sub/../../secret.bvh",
                                    "./../secret.bvh",
                                    "../share2y/secret.bvh",
                                    "sibling.bvh",
                                    "../shore/y/secret.bvh",
                                    "sub/word.bvh",
                                    "../word.bvh",
                                    "//ROOT/word.bvh",
                                    "/proc/self/root/ROOT/secret.bvh",
                                    "fifo.bvh",
                                    "dir.bvh",
                                    "zero.bvh",
                                    "ok.bvh/../../secret.bvh",
                                    "ok.bvh/x.bvh",
                                    "missing.bvh",
                                    "../missing.bvh",
                                    "../\x1B[31msecret.bvh",
                                    "../secret\n.bvh",
                                    "LONG/../../secret.bvh"};
static const char *const scores[] = {"../secret.txt",
                                     "/ROOT/secret.txt",
                                     "link.txt",
                                     "linked/secret.txt",
                                     "linked/word.txt",
                                     "../word.txt",
                                     "../share2y/secret.txt",
                                     "../shore/y/secret.txt",
                                     "fifo.txt",
                                     "proc.txt",
                                     "/etc/passwd",
                                     "/dev/zero",
                                     ".",
                                     "..",
                                     "up/word.txt",
                                     "good.txt/",
                                     "missing.txt",
                                     "\x1B[2J\n../word.txt"};
// lines of a score that a sender on the network may not give either
static const char *const lines[] = {"units ../secret.bvh legato",
                                    "units link.bvh legato rim",
                                    "units ok.bvh accent",
                                    "units ../word.bvh accent",
                                    "record ../new.bvh",
                                    "record /ROOT/new.bvh",
                                    "record new.bvh",
                                    "record fresh.c3d",
                                    "record link.bvh",
                                    "record stop",
                                    "kettle shape ../word.txt",
                                    "kettle shape /ROOT/word.txt",
                                    "kettle shape /etc/passwd",
                                    "kettle shape head.txt",
                                    "kettle shape fifo.txt",
                                    "drum other; other shape ../word.txt",
                                    "score ../secret.txt",
                                    "score good.txt",
                                    "listen 9",
                                    "subscribe 192.0.2.1 9 pose"};

// ROOT and LONG stand for what is known when the test runs
static void fill_in(char out[1100], const char *name)
{
    char *mark;
    snprintf(out, 1100, "%s", name);
    if ((mark = strstr(out, "ROOT"))) {
        char rest[256];
        snprintf(rest, sizeof rest, "%s", mark + 4);
        sprintf(mark, "%s%s", root + 1, rest);
    }
    if ((mark = strstr(out, "LONG"))) {
        char rest[256];
        snprintf(rest, sizeof rest, "%s", mark + 4);
        memset(mark, 'x', 990);
        strcpy(mark + 990, rest);
    }
}

static void say_word(const char *path, const char *word_said, const char *second)
{
    char data[2048];
    size_t size = sizeof data;
    lo_message m = lo_message_new();
    lo_message_add_string(m, word_said);
    if (second)
        lo_message_add_string(m, second);
    lo_message_serialise(m, path, data, &size);
    send_bytes(data, size);
    lo_message_free(m);
}

// the one line that came back tells nothing
static const char *refusal(const char *what)
{
    const char *line = last_error();
    TEST_ASSERT_EQUAL_INT_MESSAGE(1, heard_count, what);
    TEST_ASSERT_EQUAL_INT_MESSAGE(1, count("/himc/error"), what);
    TEST_ASSERT_NULL_MESSAGE(strstr(line, SECRET), line);
    TEST_ASSERT_NULL_MESSAGE(strstr(line, share), line);
    TEST_ASSERT_NULL_MESSAGE(strstr(line, "root:"), line);
    for (const char *s = line; *s; s++)
        TEST_ASSERT_TRUE_MESSAGE((unsigned char)*s >= ' ', line);
    return line;
}

static int attempts;

// one packet, one line; the points of 250 come back in between
static const char *attempt(const char *path, const char *word_said, const char *second)
{
    long before = himc_osc_count(osc).refused;
    attempts++;
    simulated += 0.3;
    forget();
    say_word(path, word_said, second);
    play(0.004);
    play(0.004);
    const char *line = refusal(word_said);
    TEST_ASSERT_EQUAL_INT_MESSAGE(before + 1, himc_osc_count(osc).refused, word_said);
    return line;
}

static const char *attempt_line(const char *statement)
{
    char text[1200], filled[1100];
    fill_in(filled, statement);
    char *out = text;
    for (const char *s = filled; *s; s++) {
        if (*s == '\n')
            *out++ = '\\';
        *out++ = *s;
    }
    strcpy(out, ";\n");
    write_text("share/attack.txt", text);
    const char *line = attempt("/himc/score", "attack.txt", NULL);
    TEST_ASSERT_EQUAL_STRING_LEN_MESSAGE("attack.txt:", line, 11, line);
    return line;
}

// nothing was made, changed or played
static void check_untouched(void)
{
    static const char *const made[] = {"new.bvh", "share/fresh.c3d"};
    for (size_t i = 0; i < sizeof made / sizeof *made; i++)
        TEST_ASSERT_EQUAL_INT_MESSAGE(-1, access(at(made[i]), F_OK), made[i]);
    shell("cmp -s secret.bvh out/secret.bvh && cmp -s secret.bvh share/ok.bvh");
    TEST_ASSERT_NULL(himc_performance_drum(performance, 1));
    run_here("play");
    play(1);
    TEST_ASSERT_EQUAL_INT(0, himc_performance_measure(performance).strokes);
}

static void remove_folder(void)
{
    shell("rm -rf share share2y shore out *.bvh *.txt");
    TEST_ASSERT_EQUAL_INT(0, rmdir(root));
}

static void test_no_line_of_a_score_reaches_a_file_outside_the_folder(void)
{
    share_folder();
    for (size_t i = 0; i < sizeof takes / sizeof *takes; i++) {
        char statement[64];
        snprintf(statement, sizeof statement, "take %s", takes[i]);
        const char *line = attempt_line(statement);
        TEST_ASSERT_TRUE_MESSAGE(
            strstr(line, ": no such file in the folder") || strstr(takes[i], "LONG"), line);
    }
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
        attempt_line(lines[i]);
    check_untouched();
    remove_folder();
}

static void test_no_command_reaches_a_file_outside_the_folder(void)
{
    char name[1100];
    share_folder();
    for (size_t i = 0; i < sizeof takes / sizeof *takes; i++) {
        fill_in(name, takes[i]);
        const char *line = attempt("/himc/take", name, NULL);
        TEST_ASSERT_TRUE_MESSAGE(
            strstr(line, ": no such file in the folder") || strstr(takes[i], "LONG"), line);
        attempt("/himc/units", name, "legato");
        attempt("/himc/record", name, NULL);
    }
    for (size_t i = 0; i < sizeof scores / sizeof *scores; i++) {
        fill_in(name, scores[i]);
        const char *line = attempt("/himc/score", name, NULL);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(line, ": no such file in the folder"), line);
        attempt("/membrane/kettle/shape", name, NULL);
    }
    check_untouched();
    remove_folder();
}

static void test_files_in_the_folder_are_read(void)
{
    static const char *const good[] = {"good.txt",        "inside.txt",        "./good.txt",
                                       "sub/../good.txt", "up/share/good.txt", "play.txt"};
    share_folder();
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        simulated += 1;
        say_word("/himc/score", good[i], NULL);
        play(0.02);
        TEST_ASSERT_EQUAL_STRING_MESSAGE("", last_error(), good[i]);
    }
    say_word("/himc/take", "inside.bvh", NULL);
    play(0.02);
    TEST_ASSERT_EQUAL_STRING("", last_error());
    TEST_ASSERT_EQUAL_INT(0, himc_osc_count(osc).refused);
    remove_folder();
}

// an error in a file of the folder is quoted, with the name that was sent
static void test_errors_name_files_as_the_sender_did(void)
{
    share_folder();
    write_text("share/wrong.txt", "tempo 100;\ntempo fast;\n");
    TEST_ASSERT_EQUAL_STRING("wrong.txt:2: tempo: BPM: fast, expected 1 .. 1000 beats per minute",
                             attempt("/himc/score", "wrong.txt", NULL));
    TEST_ASSERT_EQUAL_STRING("attack.txt:1: record x.bvh: no file is written over the network",
                             attempt_line("record x.bvh"));
    TEST_ASSERT_EQUAL_STRING("record stop: no file is written over the network",
                             attempt("/himc/record", "stop", NULL));
    TEST_ASSERT_EQUAL_STRING("dump x.txt: no file is written over the network",
                             attempt("/himc/dump", "x.txt", NULL));
    TEST_ASSERT_EQUAL_STRING("shape x.txt: no file is read by it over the network",
                             attempt("/membrane/kettle/shape", "x.txt", NULL));
    TEST_ASSERT_EQUAL_STRING("x.txt: no such file in the folder given by --files",
                             attempt("/himc/preset", "x", NULL));
    remove_folder();
}

// the user of this machine may do with a score what he likes, also after strangers loaded it
static void test_the_user_of_this_machine_keeps_his_rights(void)
{
    char text[256];
    share_folder();
    snprintf(text, sizeof text, "take %s;\n", at("secret.bvh"));
    write_text("share/attack.txt", text);
    attempt("/himc/score", "attack.txt", NULL);
    snprintf(text, sizeof text, "score %s", at("share/attack.txt"));
    run_here(text);
    remove_folder();
}

static void test_no_stranger_ends_the_recording_of_the_user(void)
{
    char text[256];
    share_folder();
    snprintf(text, sizeof text, "record %s", at("mine.bvh"));
    run_here(text);
    play(0.1);
    attempt("/himc/record", "stop", NULL);
    attempt_line("record stop");
    TEST_ASSERT_EQUAL_INT(-1, access(at("mine.bvh"), F_OK));
    run_here("record stop");
    TEST_ASSERT_EQUAL_INT(0, access(at("mine.bvh"), F_OK));
    remove_folder();
}

// the mark of a command from the network goes with its copies
static void test_a_copy_of_a_command_keeps_its_folder(void)
{
    himc_command command, copy;
    himc_error error;
    TEST_ASSERT_TRUE(himc_command_parse_text(&command, HIMC_PERFORMER, "take a.bvh", &error));
    TEST_ASSERT_NULL(command.folder);
    TEST_ASSERT_TRUE(himc_confine_command(&command, "/some/folder", &error));
    himc_command_copy(&copy, &command);
    memset(&command, 'x', sizeof command);
    TEST_ASSERT_EQUAL_STRING("/some/folder", copy.folder);
    TEST_ASSERT_EQUAL_STRING("a.bvh", copy.atom[0].symbol);
}

static void test_a_folder_and_a_name_too_long_for_a_command_are_refused(void)
{
    himc_command command;
    himc_error error;
    char folder[1000], name[1000] = "take ";
    memset(folder, 'f', sizeof folder - 1);
    folder[sizeof folder - 1] = '\0';
    for (size_t length = 1; length < 990; length++) {
        memset(name + 5, 'n', length);
        name[5 + length] = '\0';
        TEST_ASSERT_TRUE(himc_command_parse_text(&command, HIMC_PERFORMER, name, &error));
        bool fits = length + 1 + sizeof folder <= sizeof command.storage;
        TEST_ASSERT_EQUAL_INT(fits, himc_confine_command(&command, folder, &error));
        TEST_ASSERT_TRUE(fits || strstr(error.text, "expected 279"));
        TEST_ASSERT_EQUAL_STRING(name + 5, command.atom[0].symbol);
    }
}

char *realpath(const char *restrict path, char *restrict out)
{
    char *(*real)(const char *, char *) = NULL;
    *(void **)&real = dlsym(RTLD_NEXT, "realpath");
    char *found = real(path, out);
    if (found && swap_armed) {
        swap_armed = false;
        shell("cd share && rm -rf sub now.bvh && ln -s ../secret.bvh now.bvh && ln -s ../out sub");
    }
    return found;
}

static void test_a_file_swapped_between_look_and_opening_is_refused(void)
{
    static const char *const names[] = {"now.bvh", "sub/secret.bvh"};
    share_folder();
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        shell("cd share && rm -rf sub now.bvh && mkdir sub && cp ok.bvh now.bvh && "
              "cp ok.bvh sub/secret.bvh");
        swap_armed = true;
        attempt("/himc/take", names[i], NULL);
        TEST_ASSERT_FALSE(swap_armed);
    }
    remove_folder();
}

static void test_no_file_is_read_over_the_network_without_a_folder(void)
{
    TEST_ASSERT_NOT_NULL(
        strstr(attempt("/himc/score", "patches/improvisation.txt", NULL), "--files"));
    TEST_ASSERT_NOT_NULL(strstr(attempt("/himc/take", "x.bvh", NULL), "--files"));
    TEST_ASSERT_EQUAL_STRING("x.txt: files are read over the network only with --files",
                             attempt("/himc/preset", "x", NULL));
}

static void test_the_whole_disk_may_be_the_folder(void)
{
    make_folder();
    restart(&(himc_osc_config){.files = "/"});
    say_word("/himc/score", at("secret.txt"), NULL);
    play(0.02);
    TEST_ASSERT_EQUAL_STRING("", last_error());
    attempt("/himc/score", "/", NULL);
    remove_folder();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_no_line_of_a_score_reaches_a_file_outside_the_folder);
    RUN_TEST(test_no_command_reaches_a_file_outside_the_folder);
    RUN_TEST(test_files_in_the_folder_are_read);
    RUN_TEST(test_errors_name_files_as_the_sender_did);
    RUN_TEST(test_the_user_of_this_machine_keeps_his_rights);
    RUN_TEST(test_no_stranger_ends_the_recording_of_the_user);
    RUN_TEST(test_a_copy_of_a_command_keeps_its_folder);
    RUN_TEST(test_a_folder_and_a_name_too_long_for_a_command_are_refused);
    RUN_TEST(test_a_file_swapped_between_look_and_opening_is_refused);
    RUN_TEST(test_no_file_is_read_over_the_network_without_a_folder);
    RUN_TEST(test_the_whole_disk_may_be_the_folder);
    printf("%d attempts, each refused in one line\n", attempts);
    return UNITY_END();
}
