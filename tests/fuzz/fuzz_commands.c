/// fuzz_commands.c: commands to both receivers, as text (a line each) and as atoms. An accepted
/// command has finite numbers, and is accepted again with the same atoms.
#include "fuzz.h"
#include "himc/command.h"

#include <math.h>

#define MOST_LINES 4 // as text; chosen: an input stays quick

static void check_command(const himc_command *command, himc_receiver receiver)
{
    const himc_command_row *row = himc_command_table((int)command->id);
    himc_command again;
    himc_error error = {""};
    int at;
    bool to_drum = receiver == HIMC_PERFORMER && command->drum[0]; // DRUM COMMAND ...
    require(row && row->receiver == (to_drum ? HIMC_DRUM : receiver),
            "a command is one of the receiver's");
    require(command->count >= 0 && command->count <= HIMC_COMMAND_ATOMS, "atoms are counted");
    for (int i = 0; i < command->count; i++)
        require(command->atom[i].kind == HIMC_ATOM_SYMBOL ? command->atom[i].symbol != NULL
                                                          : isfinite(command->atom[i].number),
                "an atom is a word or finite");
    require(himc_command_check(&again, receiver, command, &error), error.text);
    require(again.id == command->id, "found again"); // a note name has become a number
    himc_command_copy(&again, command);
    if (himc_command_file(&again, &at) != HIMC_FILE_NONE)
        require(at >= 0 && at < again.count && again.atom[at].symbol[0], "a file has a name");
}

static void as_text(const char *line)
{
    for (int receiver = HIMC_PERFORMER; receiver <= HIMC_DRUM; receiver++) {
        himc_command command;
        himc_error error = {""};
        if (himc_command_parse_text(&command, (himc_receiver)receiver, line, &error))
            check_command(&command, (himc_receiver)receiver);
        else
            require_line(&error);
    }
}

// a number in which any bits can be: hostile hosts send what they like
static double number_of(const uint8_t *data)
{
    double value;
    memcpy(&value, data, sizeof value);
    return value;
}

// the line's first word with atoms of arbitrary kind: 8 bytes are a number, or select a word
static void as_atoms(const uint8_t *data, size_t size, char *line)
{
    himc_atom atoms[2 * HIMC_COMMAND_ATOMS];
    const char *words[3 * HIMC_COMMAND_ATOMS], *name = strtok(line, " ");
    int count = 0, known = 0;
    for (const char *w = strtok(NULL, " "); w && known < 3 * HIMC_COMMAND_ATOMS;
         w = strtok(NULL, " "))
        words[known++] = w;
    for (; size >= 9 && count < 2 * HIMC_COMMAND_ATOMS; data += 9, size -= 9)
        atoms[count++] = known && data[0] % 2
                             ? (himc_atom){HIMC_ATOM_SYMBOL, 0, words[data[1] % known]}
                             : (himc_atom){HIMC_ATOM_NUMBER, number_of(data + 1), NULL};
    for (int receiver = HIMC_PERFORMER; receiver <= HIMC_DRUM; receiver++) {
        himc_command command;
        himc_error error = {""};
        if (himc_command_parse(&command, (himc_receiver)receiver, name ? name : "", atoms, count,
                               &error))
            check_command(&command, (himc_receiver)receiver);
        else
            require_line(&error);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *text = fuzz_text(data, size), *end, *line = text;
    for (int i = 0; i < MOST_LINES && (end = strchr(line, '\n')); i++, line = end + 1) {
        *end = '\0';
        as_text(line);
    }
    as_text(line);
    as_atoms(data, size, line);
    free(text);
    return 0;
}
