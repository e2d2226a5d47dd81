/// fuzz_tsv.c: takes from arbitrary bytes as TSV.
#include "take.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    return fuzz_format("fuzz.tsv", data, size);
}
