/// bank_state.h: what a bank is made of; shared by bank.c (what it is) and bank_run.c (how it
/// swings).
#ifndef HIMC_BANK_STATE_H
#define HIMC_BANK_STATE_H

#include "drum/bank.h"

#define LANES 4
#define CHUNK 64 // samples per pass: both sums of a chunk stay in the first cache

// two oscillators at once, which every machine's compiler makes one instruction of, with the same
// result
typedef double pair __attribute__((vector_size(2 * sizeof(double)), may_alias));

// a sum in four lanes, and its total in a fixed order
typedef struct lanes {
    pair a, b;
} lanes;

// coefficients for steps of one length
typedef struct bank_gear {
    double *turn_c, *turn_s, *push_p, *push_s;
} bank_gear;

struct himc_bank {
    int capacity; // a multiple of LANES
    int count;    // oscillators that swing
    int live;     // of these, the first `live` (a multiple of LANES) are not at rest
    int age;      // samples since the last look for quiet ones
    double *memory;
    double *p, *s;                         // state
    double *turn_c, *turn_s;               // C, S, of the present gear
    double *push_p, *push_s;               // what 1 N adds, of the present gear
    bank_gear gears[HIMC_BANK_SUBSTEPS];   // of a sample, and of a part of it
    int parts;                             // of a sample
    double *omega, *decay, *mass, *damped; // w, d, m, w_d
    double *yield;                         // 1/w_d: q per p
    lanes sum[HIMC_BANK_READOUTS][CHUNK];
};

#endif
