/// lists.h: the instruments that the library has as lists of modes.
#ifndef HIMC_LISTS_H
#define HIMC_LISTS_H

/// A list, as of a file (list.c).
typedef struct himc_listed {
    const char *name, *text;
} himc_listed;

/// In the order of HIMC_LISTS (himc/command_rows.h); 0 at the end.
extern const himc_listed himc_lists[];

#endif
