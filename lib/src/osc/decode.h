/// decode.h: OSC packets as commands, and the commands that a stranger may give. Bytes in, values
/// out: no socket, no clock.
#ifndef HIMC_OSC_DECODE_H
#define HIMC_OSC_DECODE_H

#include "himc/command.h"

typedef enum osc_verdict {
    OSC_REQUEST,   ///< a command that fits the table
    OSC_MALFORMED, ///< not OSC, or an atom that is neither number nor word
    OSC_FOREIGN,   ///< an address that is none of ours, or one that only we send
    OSC_WRONG      ///< a command with an error
} osc_verdict;

/// One message of a packet. `command` is for OSC_REQUEST, one with the name of a drum is for that;
/// `error` is for OSC_WRONG.
typedef void osc_sink(void *object, osc_verdict verdict, himc_command *command,
                      const himc_error *error);

void himc_osc_decode(const char *data, size_t size, osc_sink *sink, void *object);

/// Points of the 1000 a second that a command costs.
double himc_osc_command_cost(const himc_command *command);

/// True if a stranger may give this command. A file is looked for in `folder` (a real path, or
/// NULL: no file) when the command is carried out.
bool himc_osc_command_admit(himc_command *command, const char *folder, himc_error *error);

#endif
