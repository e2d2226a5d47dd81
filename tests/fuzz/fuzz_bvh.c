/// fuzz_bvh.c: takes from arbitrary bytes as BVH.
#include "take.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    return fuzz_format("fuzz.bvh", data, size);
}
