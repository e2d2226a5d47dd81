/// command_table.c: the rows of command_rows.h as a table. Row i is the command with id i.
#include "himc/command.h"

#include <string.h>

static const himc_command_row table[] = {
#define HIMC_COMMAND_ROW(ID, word, receiver, when, marks, atoms, does) \
    {HIMC_COMMAND_##ID, HIMC_##receiver, HIMC_WHEN_##when, marks, #word, atoms, does},
#include "himc/command_rows.h"
};

const himc_command_row *himc_command_table(int index)
{
    return index >= 0 && index < HIMC_COMMANDS ? &table[index] : NULL;
}

const himc_command_row *himc_command_find(himc_receiver receiver, const char *name)
{
    for (int i = 0; i < HIMC_COMMANDS; i++)
        if (table[i].receiver == receiver && strcmp(table[i].name, name) == 0)
            return &table[i];
    return NULL;
}
