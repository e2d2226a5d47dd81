/// decode.c: OSC packets as commands: bundles taken apart (OSC 1.0: "#bundle", time tag, then size
/// and element in turn), commands checked by the one parser, so that the audio thread gets only
/// commands that fit the table.
///
/// The time tag of a bundle is ignored: commands act when they arrive, so that nobody can pile up
/// commands for later. Messages that we send ourselves are not answered, so that two servers never
/// answer each other forever.
#include "osc/decode.h"

#include "osc/message.h"
#include "performance/confine.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>

#define ATOMS (2 * HIMC_COMMAND_ATOMS) // read; more than any command has, and the parser says so

// --- packets

// "/himc/NAME" or "/membrane/DRUM/NAME" ("" is the drum of the first); false if it is neither
static bool read_path(const char *path, char drum[HIMC_NAME_SIZE], const char **name)
{
    drum[0] = '\0';
    if (strncmp(path, "/himc/", 6) == 0) {
        *name = path + 6;
        return !strchr(*name, '/');
    }
    if (strncmp(path, "/membrane/", 10) != 0)
        return false;
    const char *begin = path + 10, *slash = strchr(begin, '/');
    if (!slash || slash == begin || slash - begin >= HIMC_NAME_SIZE)
        return false;
    snprintf(drum, HIMC_NAME_SIZE, "%.*s", (int)(slash - begin), begin);
    *name = slash + 1;
    return !strchr(*name, '/');
}

static bool sent_by_us(himc_receiver receiver, const char *name)
{
    static const char *const sent[] = {"error", "pose",   "body", "targets", "strike",
                                       "beat",  "status", "head", "info",    "support"};
    if (receiver == HIMC_DRUM)
        return strcmp(name, "head") == 0;
    for (size_t i = 0; i < sizeof sent / sizeof *sent; i++)
        if (strcmp(sent[i], name) == 0)
            return true;
    return false;
}

static osc_verdict read_message(const char *data, size_t size, himc_command *command,
                                himc_error *error)
{
    himc_atom atom[ATOMS];
    char drum[HIMC_NAME_SIZE];
    const char *name;
    int count;
    bool plain;
    if (size < 8 || !himc_osc_message_read(data, size, atom, ATOMS, &count, &plain))
        return OSC_MALFORMED;
    if (!read_path(data, drum, &name))
        return OSC_FOREIGN;
    if (!plain)
        return OSC_MALFORMED;
    himc_receiver receiver = drum[0] ? HIMC_DRUM : HIMC_PERFORMER;
    if (himc_command_parse(command, receiver, name, atom, count, error)) {
        if (drum[0]) // else it may be /himc/DRUM COMMAND ...
            memcpy(command->drum, drum, sizeof drum);
        return OSC_REQUEST;
    }
    if (sent_by_us(receiver, name))
        return OSC_FOREIGN;
    if (drum[0])
        himc_error_prefix(error, "%s", drum);
    return OSC_WRONG;
}

static void decode_element(const char *data, size_t size, int depth, osc_sink *sink, void *object)
{
    if (size < 16 || memcmp(data, "#bundle", 8) != 0) {
        himc_command command;
        himc_error error;
        osc_verdict verdict = read_message(data, size, &command, &error);
        sink(object, verdict, &command, &error);
        return;
    }
    const int most = 4; // bundles in bundles; chosen: nobody needs more than one
    for (size_t at = 16; at < size;) {
        uint32_t length = size - at >= 4 ? himc_osc_get32(data + at) : 0;
        at += 4;
        if (length == 0 || length % 4 || at > size || length > size - at || depth == most) {
            sink(object, OSC_MALFORMED, NULL, NULL);
            return;
        }
        decode_element(data + at, length, depth + 1, sink, object);
        at += length;
    }
}

void himc_osc_decode(const char *data, size_t size, osc_sink *sink, void *object)
{
    if (size % 4)
        sink(object, OSC_MALFORMED, NULL, NULL);
    else
        decode_element(data, size, 0, sink, object);
}

// --- the commands that a stranger may give

// chosen by the time they take: `target` comes often and takes microseconds, a head or a body is
// made anew in 1 ms or more, a file is read from the disk
double himc_osc_command_cost(const himc_command *command)
{
    switch (command->id) {
    case HIMC_COMMAND_TARGET: return 1;
    case HIMC_COMMAND_SCORE:
    case HIMC_COMMAND_TAKE: return 250;
    case HIMC_COMMAND_AT:
    case HIMC_COMMAND_MODES:
    case HIMC_COMMAND_PLAYER:
    case HIMC_COMMAND_RESET:
    case HIMC_COMMAND_INFO:
    case HIMC_COMMAND_DRUM_INFO:
    case HIMC_COMMAND_DUMP:
    case HIMC_COMMAND_SUBSCRIBE:
    case HIMC_COMMAND_SETUP:
    case HIMC_COMMAND_INSTRUMENT:
    case HIMC_COMMAND_MAKE_DRUM: return 15;
    default: return 4;
    }
}

bool himc_osc_command_admit(himc_command *command, const char *folder, himc_error *error)
{
    if (command->id == HIMC_COMMAND_LISTEN)
        return himc_error_set(error, "listen: not over the network");
    return himc_confine_command(command, folder, error);
}
