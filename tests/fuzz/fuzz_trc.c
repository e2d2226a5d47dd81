/// fuzz_trc.c: takes from arbitrary bytes as TRC.
#include "take.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    return fuzz_format("fuzz.trc", data, size);
}
