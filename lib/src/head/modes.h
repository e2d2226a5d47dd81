/// modes.h: the modes of an ideal membrane in order of frequency, and their shapes.
///
/// Round: mode (m, n) has m nodal diameters and n nodal circles, phi = J_m(j_mn r/a) cos(m th) or
/// sin(m th), th from an axis of its order, and sounds at j_mn/(2 pi a) sqrt(T/sigma) (Morse &
/// Ingard 1968, section 5.2; Fletcher & Rossing 1998, section 3.3). A list depends on its outline,
/// length and lugs alone: radius, tension and density scale all frequencies alike.
#ifndef HIMC_MODES_H
#define HIMC_MODES_H

#include "head/kind.h"
#include "head/lugs.h"
#include "head/statistical.h"
#include "head/uneven.h"

#define HIMC_MIXED 4 ///< modes of order 0 that a kettle mixes, the lowest

/// Shapes of the modes (0, 1) .. (0, HIMC_MIXED) over a kettle: that of (0, n + 1) is the sum over
/// k of part[n][k] times the bare shape of (0, k + 1).
typedef struct himc_mixture {
    double part[HIMC_MIXED][HIMC_MIXED]; ///< 1 in the diagonal
    int index[HIMC_MIXED];               ///< of (0, n + 1) in the list, set by himc_modes_mix_as
    int count; ///< as many of them are in the list; also set there; 0: not mixed
} himc_mixture;

/// One entry of the list, shared by the two modes of a pair.
typedef struct himc_mode_entry {
    int m, n;    ///< see himc_mode
    double z;    ///< radius times wavenumber; of a round head the zero j_mn
    double norm; ///< integral of phi^2 per pi a^2
} himc_mode_entry;

/// Written by head/ alone.
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
    himc_modes *disc; ///< of two heads: the list of each alone, statistical modes too; else NULL
    int *source;      ///< (count) of two heads: place there, those of the lower one behind
    // for pairs only
    double uniformity; ///< of the lugs, and `seed`: what `pairs` were made for
    int seed;
    himc_lugs_pair pairs[HIMC_LUGS_ORDERS];
    himc_mixture mixture;                              ///< by a kettle
    himc_lugs_harmonic field[HIMC_LUGS_FIELD / 2 + 1]; ///< of the tension, by k/2
    himc_uneven_block block[2]; ///< by the parity of the order; empty in an even head
};

/// The tension (N/m) at which the principal mode (1,1) of the bare head sounds at `frequency` (Hz).
double himc_head_tension_for(const himc_head *head, double frequency);

#define HIMC_USUAL_MODES 200 ///< of a head that is not round, if not given; chosen

/// The lowest `count` modes of a head of that outline: 1 .. HIMC_MODES_MAX, of a grid (retained) as
/// many as it has; or HIMC_MODES_AUTO. Modes of a rectangle have m and n half waves along x and y,
/// those of a grid are numbered by n; both have no pairs. NULL with an error out of range or
/// without memory.
himc_modes *himc_modes_new(const himc_shape *shape, int count, himc_error *error);
/// False with the reason if no head of that outline has so many.
bool himc_modes_check(const himc_shape *shape, int count, himc_error *error);
/// Another with the same list, which they share in any threads, and with lugs and mixture of its
/// own. NULL without memory.
himc_modes *himc_modes_copy(const himc_modes *modes, himc_error *error);
void himc_modes_free(himc_modes *modes);

/// Sorts entries by z, then by m; for the `list` of a kind.
void himc_modes_sort(himc_mode_entry *entries, int count);
/// So many modes at the beginning of both lists, of the same outline, are the same.
HIMC_RT int himc_modes_common(const himc_modes *a, const himc_modes *b);
/// How evenly a round head is tensioned, as its fields say (himc/membrane.h); a list begins with an
/// even one.
HIMC_RT void himc_modes_set_lugs(himc_modes *modes, double uniformity, int seed);
/// From now on the list's modes are mixed like that; NULL: not at all, as at first. No orders mix
/// until himc_uneven_find.
HIMC_RT void himc_modes_mix_as(himc_modes *modes, const himc_mixture *mixture);
/// Makes of one number for each bare shape, linear in the shapes, those of the mixed ones.
HIMC_RT void himc_modes_mix(const himc_modes *modes, double *numbers);

/// Mode `index` (0 .. count - 1) of that head, without air.
HIMC_RT himc_mode himc_modes_get(const himc_modes *modes, const himc_head *head, int index);

/// All bare shapes at (x, y) (m) into `shapes` (count), within 1e-8; 0 outside the head.
HIMC_RT void himc_modes_shapes(const himc_modes *modes, double radius, double x, double y,
                               double *shapes);

/// True if every field of `head` is in its range; else an error with the field, the value and the
/// range.
bool himc_head_check(const himc_head *head, himc_error *error);

#define HIMC_LARGEST_DECAY 0.9 ///< per omega; chosen: the mode still oscillates

/// Decay of a mode at `omega` (rad/s), without radiation (1/s): S0 + S1 omega^2 and the damping
/// hand's resistance over the mode's mass, which is `loading` times a bare head's; at most
/// HIMC_LARGEST_DECAY omega.
HIMC_RT double himc_head_decay(const himc_head *head, double omega, double loading);

#endif
