/// mode_list.h: a list of modes as its kind makes it (kind.h); private to head/.
#ifndef HIMC_MODE_LIST_H
#define HIMC_MODE_LIST_H

#include "head/modes.h"
#include "head/statistical.h"
#include "head/uneven.h"

/// One entry of the list, shared by the two modes of a pair.
typedef struct himc_mode_entry {
    int m, n;    ///< see himc_mode
    double z;    ///< radius times wavenumber; of a round head the zero j_mn
    double norm; ///< integral of phi^2 per pi a^2
} himc_mode_entry;

struct himc_modes {
    _Atomic int *users; ///< of the list, which copies share: all but pairs and mixture
    himc_shape shape;
    int count;                ///< modes
    int exact;                ///< of these, in the list of entries; the others are statistical
    int entry_count;          ///< entries they use; set by the kind's `list`, as all that follow
    himc_mode_entry *entries; ///< sorted by z
    int *first;               ///< (entry_count) index of the entry's first mode; NULL without pairs
    int *of;                  ///< (exact) entry of a mode; NULL without pairs
    int top;                  ///< largest order in the table
    int columns;              ///< its grid points
    double *table;            ///< (top + 1, columns, 2) of a round head, else NULL
    himc_statistical *statistical; ///< if any mode is
    himc_uneven_pair *uneven; ///< (uneven_count) entries that an uneven tension couples; or NULL
    int uneven_count;
    // for pairs only
    double uniformity; ///< of the lugs, and `seed`: what `pairs` were made for
    int seed;
    himc_lugs_pair pairs[HIMC_LUGS_ORDERS];
    himc_mixture mixture;                              ///< by a kettle
    himc_lugs_harmonic field[HIMC_LUGS_FIELD / 2 + 1]; ///< of the tension, by k/2
    himc_uneven_block block[2];                        ///< by the parity of the order
};

/// Sorts entries by z, then by m.
void himc_modes_sort(himc_mode_entry *entries, int count);

#endif
