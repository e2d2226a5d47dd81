/// confine.c: commands from the network, and the one folder whose files they may read (file.c).
#include "performance/confine.h"

#include <string.h>

bool himc_confine_command(himc_command *c, const char *folder, himc_error *error)
{
    const himc_command_row *row = himc_command_table((int)c->id);
    size_t used = 0, size = folder ? strlen(folder) + 1 : 0;
    int atom = 0;
    for (int i = 0; i < c->count; i++) // the symbols lie one after the other in `storage`
        if (c->atom[i].kind == HIMC_ATOM_SYMBOL)
            used += strlen(c->atom[i].symbol) + 1;
    bool names_file = himc_command_file(c, &atom) != HIMC_FILE_NONE;
    if (c->id == HIMC_COMMAND_RECORD || (names_file && !(row->marks & HIMC_IN_FOLDER)))
        return himc_error_set(error, "%s %.80s: no file is %s over the network", row->name,
                              c->atom[atom].symbol,
                              row->marks & HIMC_WRITES_FILE ? "written" : "read by it");
    if (!names_file)
        return true;
    if (!folder) // the parser has made a score of a preset, so the file alone is named
        return himc_error_set(error, "%.80s: files are read over the network only with --files",
                              c->atom[atom].symbol);
    if (size > sizeof c->storage - used)
        return himc_error_set(error, "%s: a name of %zu characters, expected %zu in that folder",
                              row->name, used - 1, sizeof c->storage - size - 1);
    c->folder = memcpy(c->storage + used, folder, size);
    return true;
}
