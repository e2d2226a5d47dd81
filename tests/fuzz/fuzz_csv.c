/// fuzz_csv.c: takes from arbitrary bytes as CSV.
#include "take.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    return fuzz_format("fuzz.csv", data, size);
}
