/// test_settings.c: every row of the settings, one by one: a value that is not the default is in
/// the dump and nothing else is changed there, the dump makes it again, `reset` ends it. A new row
/// is tested without a word here.
#include "session.h"

#include "random_commands.h"

#include "base/text.h"

#define TRIALS 5

typedef struct row {
    himc_command_id id;
    const char *name, *usual;
} row;

static const row rows[] = {
#define HIMC_SETTING_ROW(ID, word, when, atoms, kind, field, usual, after, does) \
    {HIMC_COMMAND_##ID, #word, usual},
#include "himc/command_rows.h"
};

#define ROWS ((int)(sizeof rows / sizeof *rows))

static char *state_of(const himc_performance *p)
{
    himc_text_lines lines = {0};
    himc_performance_describe(p, HIMC_DESCRIBE_STATE, himc_text_add, &lines);
    return lines.bytes;
}

// ends `state`
static void compare(char *expected, char *state, const char *name)
{
    TEST_ASSERT_EQUAL_STRING_MESSAGE(expected, state, name);
    free(state);
}

// without the lines of that command
static char *others(const char *state, const char *name)
{
    char *rest = calloc(1, strlen(state) + 1);
    size_t length = strlen(name);
    for (const char *end; (end = strstr(state, ";\n")); state = end + 2)
        if (strncmp(state, name, length) != 0 || state[length] != ' ')
            strncat(rest, state, (size_t)(end - state) + 2);
    return rest;
}

// carries out commands of that row until the state is another than `usual`
static char *change(himc_performance *p, const row *r, const char *usual, random_seed *seed)
{
    for (int i = 0; i < 100; i++) {
        spoken said;
        himc_command c;
        random_command(&said, himc_command_table((int)r->id), seed);
        TEST_ASSERT_TRUE_MESSAGE(
            himc_command_parse(&c, HIMC_PERFORMER, said.name, said.atom, said.count, &error) &&
                himc_performance_command(p, &c, 0, &error),
            error.text);
        char *state = state_of(p);
        if (strcmp(state, usual) != 0)
            return state;
        free(state);
    }
    TEST_FAIL_MESSAGE(r->name);
    return NULL;
}

static void send(himc_performance *p, const char *state)
{
    for (const char *end; (end = strstr(state, ";\n")); state = end + 2)
        session_do(p, "%.*s", (int)(end - state), state);
}

static void check_row(const row *r, random_seed *seed)
{
    himc_performance *p = session_new(), *other = session_new();
    char *usual = state_of(p), *state = change(p, r, usual, seed);
    char *rest = others(usual, r->name);
    compare(rest, others(state, r->name), r->name);
    send(other, state);
    compare(state, state_of(other), r->name);
    session_do(p, "reset");
    compare(usual, state_of(p), r->name);
    if (r->usual[0] != '\0') {
        session_do(other, "%s %s", r->name, r->usual);
        compare(usual, state_of(other), r->name);
    }
    free(usual);
    free(state);
    free(rest);
    himc_performance_free(p);
    himc_performance_free(other);
}

static void test_each_setting_is_dumped_made_again_and_reset(void)
{
    random_seed seed = 7;
    TEST_ASSERT_TRUE(ROWS >= 19);
    for (int i = 0; i < ROWS * TRIALS; i++)
        check_row(&rows[i % ROWS], &seed);
}

static void test_a_dump_of_the_default_changes_nothing(void)
{
    himc_performance *p = session_new();
    char *usual = state_of(p);
    send(p, usual);
    compare(usual, state_of(p), "default");
    free(usual);
    himc_performance_free(p);
}

// refused or not, but for a reason of its own
static void test_each_command_of_the_performer_has_an_action(void)
{
    const himc_command_row *command;
    random_seed seed = 3;
    himc_performance *p = session_new();
    for (int i = 0; (command = himc_command_table(i)); i++) {
        himc_command c;
        spoken said;
        bool own = command->receiver == HIMC_PERFORMER;
        do
            random_command(&said, command, &seed);
        while (
            !himc_command_parse(&c, command->receiver, said.name, said.atom, said.count, &error));
        error.text[0] = '\0';
        himc_performance_command(p, &c, 0, &error);
        TEST_ASSERT_TRUE_MESSAGE(own == !strstr(error.text, "a drum's command"), command->name);
    }
    himc_performance_free(p);
}

int main(void)
{
    static const char *const files[] = {"no-such-folder/file.txt", NULL};
    random_files = files;
    UNITY_BEGIN();
    RUN_TEST(test_each_setting_is_dumped_made_again_and_reset);
    RUN_TEST(test_a_dump_of_the_default_changes_nothing);
    RUN_TEST(test_each_command_of_the_performer_has_an_action);
    return UNITY_END();
}
