/// test_manual.c: the manual's tables equal the library's.
///
/// With HIMC_WRITE_MANUAL set the test writes them (`make manual`), else it compares.
#define _GNU_SOURCE
#include "base/argument.h"
#include "himc/command.h"

#include "unity.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MANUAL "docs/manual.md"
#define BEGIN "<!-- vocabulary: made by `make manual`, do not edit -->\n"
#define END "<!-- end of the vocabulary -->\n"

static char tables[65536], manual[262144];

void setUp(void)
{
}

void tearDown(void)
{
}

static void say(const char *text)
{
    strncat(tables, text, sizeof tables - strlen(tables) - 1);
}

// `|` ends a cell of a table, so the grammar's is escaped
static void say_grammar(const char *grammar)
{
    for (const char *c = grammar; *c; c++) {
        if (*c == '|')
            say("\\");
        say((char[]){*c, '\0'});
    }
}

static void make_commands(himc_receiver receiver)
{
    say("| command | atoms | does |\n|---|---|---|\n");
    const himc_command_row *row;
    for (int i = 0; (row = himc_command_table(i)); i++) {
        if (row->receiver != receiver)
            continue;
        say("| `");
        say(row->name);
        say("` | ");
        say_grammar(row->atoms[0] ? row->atoms : "–");
        say(" | ");
        say(row->does);
        say(" |\n");
    }
}

// each atom in capitals once for each meaning it has; a name of any letters needs no row
static void make_atoms(void)
{
    char line[680], allowed[512], key[128];
    const himc_command_row *row;
    for (int i = 0; (row = himc_command_table(i)); i++) {
        char grammar[256], *word, *rest = grammar;
        const char *context = row->name;
        snprintf(grammar, sizeof grammar, "%s", row->atoms);
        while ((word = strsep(&rest, " []"))) {
            if (strcmp(word, "|") == 0)
                context = row->name;
            else if (islower((unsigned char)word[0]) && !strchr(word, '|'))
                context = word;
            const himc_argument *a =
                isupper((unsigned char)word[0]) ? himc_argument_find(word, context) : NULL;
            if (!a || a->kind == HIMC_ARGUMENT_TEXT)
                continue;
            snprintf(key, sizeof key, "%s%s%s", a->names, a->contexts ? " of " : "",
                     a->contexts ? a->contexts : "");
            for (char *c = key; (c = strchr(c, '|'));)
                *c = ' ';
            himc_argument_describe(a, allowed, sizeof allowed);
            snprintf(line, sizeof line, "- %s: %s\n", key, allowed);
            if (strstr(tables, line))
                continue;
            say(line);
        }
    }
}

static void make_tables(void)
{
    tables[0] = '\0';
    say("\n### To the performer\n\n");
    make_commands(HIMC_PERFORMER);
    say("\n### To a drum\n\n");
    make_commands(HIMC_DRUM);
    say("\n### Atoms\n\n");
    make_atoms();
    say("\n");
}

static void read_manual(void)
{
    FILE *file = fopen(MANUAL, "r");
    TEST_ASSERT_NOT_NULL_MESSAGE(file, MANUAL);
    manual[fread(manual, 1, sizeof manual - 1, file)] = '\0';
    fclose(file);
}

static void write_manual(const char *begin, const char *end)
{
    FILE *file = fopen(MANUAL, "w");
    TEST_ASSERT_NOT_NULL_MESSAGE(file, MANUAL);
    fprintf(file, "%.*s%s%s", (int)(begin - manual), manual, tables, end);
    fclose(file);
}

static void test_manual_has_the_vocabulary_of_the_library(void)
{
    make_tables();
    read_manual();
    char *begin = strstr(manual, BEGIN), *end = strstr(manual, END);
    TEST_ASSERT_TRUE_MESSAGE(begin && end && begin < end, MANUAL " lacks its two marks");
    begin += strlen(BEGIN);
    if (getenv("HIMC_WRITE_MANUAL"))
        write_manual(begin, end);
    else
        TEST_ASSERT_TRUE_MESSAGE((size_t)(end - begin) == strlen(tables) &&
                                     strncmp(begin, tables, strlen(tables)) == 0,
                                 MANUAL " differs from the library's table: make manual");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_manual_has_the_vocabulary_of_the_library);
    return UNITY_END();
}
