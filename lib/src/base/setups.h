/// setups.h: the set-ups that the library has.
#ifndef HIMC_SETUPS_H
#define HIMC_SETUPS_H

/// A set-up: lines of a score that make instruments and put them at their places.
typedef struct himc_setup {
    const char *name, *text;
} himc_setup;

/// In the order of HIMC_SETUPS (himc/command_rows.h).
extern const himc_setup himc_setups[];

#endif
