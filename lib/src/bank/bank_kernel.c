/// bank_kernel.c: the versions of the bank's loops, and which of them this machine can run.
///
/// The same source is compiled once for each vector unit; the machine is asked at run time. Other
/// processors than x86-64 have one version, which each compiler turns into what they have.
#include "bank/bank_kernel.h"

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#define ALL_OF(x)                                                                           \
    {                                                                                       \
        .name = #x, .rotate = rotate_##x, .weigh = weigh_##x, .weigh_more = weigh_more_##x, \
        .stretch = stretch_##x, .turn = turn_##x, .add = add_##x, .push = push_##x,         \
        .dot = dot_##x, .read = read_##x, .read_alike = read_alike_##x, .ahead = ahead_##x, \
        .ahead_alike = ahead_alike_##x, .square = square_##x, .scatter = scatter_##x,       \
    }

#define WIDTH 2
#define TARGET
#define NAMED(x) x##_base
#include "bank/bank_loops.h"

#ifdef __x86_64__

#define WIDTH 4
#define TARGET __attribute__((target("avx2")))
#define NAMED(x) x##_avx2
#include "bank/bank_loops.h"

#define WIDTH 8
#define TARGET __attribute__((target("avx512f")))
#define NAMED(x) x##_avx512
#include "bank/bank_loops.h"

static const himc_bank_kernel versions[] = {ALL_OF(base), ALL_OF(avx2), ALL_OF(avx512)};

const himc_bank_kernel *himc_bank_kernel_version(int index)
{
    __builtin_cpu_init(); // of the processor and the system
    bool supported = index == 0 || (index == 1 && __builtin_cpu_supports("avx2")) ||
                     (index == 2 && __builtin_cpu_supports("avx512f"));
    return supported ? &versions[index] : NULL;
}

#else

static const himc_bank_kernel base = ALL_OF(base);

const himc_bank_kernel *himc_bank_kernel_version(int index)
{
    return index == 0 ? &base : NULL;
}

#endif

const himc_bank_kernel *himc_bank_kernel_fastest(void)
{
    int index = 0;
    while (himc_bank_kernel_version(index + 1))
        index++;
    return himc_bank_kernel_version(index);
}
