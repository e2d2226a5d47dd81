/// confine.h: what a command from the network may do with files.
///
/// The mark of such a command is its `folder`. It goes with every copy, and a score that was read
/// with it gives it to each of its commands, so that a file gives its reader no rights.
#ifndef HIMC_PERFORMANCE_CONFINE_H
#define HIMC_PERFORMANCE_CONFINE_H

#include "himc/command.h"

/// Holds a command to the rights of the network: it writes no file, and reads none unless its row
/// is marked HIMC_IN_FOLDER, and then only in `folder` (a real path; NULL: none). False with one
/// line; else the command may be carried out, and keeps the folder if it names a file.
bool himc_confine_command(himc_command *command, const char *folder, himc_error *error);

#endif
