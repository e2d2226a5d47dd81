/// fuzz_viewer_recording.c: the scene that the viewer plays back. The chunks of what is accepted
/// end where the file ends.
#include "fuzz.h"
#include "recording.h"

static size_t chunk_size(const uint8_t *at)
{
    return at[0] | (size_t)at[1] << 8 | (size_t)at[2] << 16 | (size_t)at[3] << 24;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    himc_error error = {""};
    char *bytes = fuzz_text(data, size); // a copy of exactly that size, for the sanitizers
    if (!recording_check(bytes, size, "fuzz.himc", &error))
        require_line(&error);
    else {
        size_t at = 8;
        while (at + 8 <= size)
            at += 8 + chunk_size(data + at + 4);
        require(at == size, "the chunks fill the file");
    }
    free(bytes);
    return 0;
}
