/// bench_peers.h: other programs that do a similar work, measured beside himc.
#ifndef BENCH_PEERS_H
#define BENCH_PEERS_H

#include "himc/base.h"

/// What the scripts measure, by the first word of their lines.
typedef enum bench_peer_row {
    BENCH_STEP,  ///< `step_us`: a step of the same body (us)
    BENCH_CMU,   ///< `cmu_step_us`: a step of a larger body (us)
    BENCH_MODES, ///< `modes_per_core`: modes that one core plays in real time
    BENCH_DRUM, ///< `drum_ms_per_s`: a drum struck four times a second (ms of processor time per s)
    BENCH_PEER_ROWS
} bench_peer_row;

/// Runs each script of tests/bench/peers and prints its figures beside `ours`, with the ratio
/// ours / theirs. A program that is not installed is said on stderr by its script. False with the
/// reason: the folder is not there, or a script failed.
bool bench_print_peers(const double ours[BENCH_PEER_ROWS], himc_error *error);

#endif
