/// fuzz.h: shared by the fuzz targets.
///
/// A target is a file fuzz_NAME.c with LLVMFuzzerTestOneInput, which gives arbitrary bytes to one
/// reader and aborts if a promise is broken. Its seeds, and every input that ever failed, are files
/// in corpus/NAME. `make fuzz` links the targets with clang's libFuzzer; `make test` with driver.c,
/// which runs the corpus and a fixed number of mutations of it.
#ifndef HIMC_TESTS_FUZZ_H
#define HIMC_TESTS_FUZZ_H

#include "base/line.h"
#include "himc/base.h"

#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/// Optional: a target's own mutation, for formats that the general one rarely leaves readable.
/// Returns the new size, at most `most`.
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t most, unsigned seed);

/// The general mutation, for targets with one of their own.
size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t most);

/// Optional: mutations in `make test`, for a target that is slower than the others.
extern const long fuzz_runs __attribute__((weak));

static inline void require(bool promise, const char *what)
{
    if (promise)
        return;
    fprintf(stderr, "broken promise: %s\n", what);
    abort();
}

/// What is refused is refused in one line, which names the fault.
static inline void require_line(const himc_error *error)
{
    size_t length = strnlen(error->text, sizeof error->text);
    require(length > 0 && length < sizeof error->text, "an error has a text that ends");
    require(himc_line_is_clean(error->text), "an error is one line without control characters");
}

/// The bytes as a text, to be freed.
static inline char *fuzz_text(const uint8_t *data, size_t size)
{
    char *text = malloc(size + 1);
    require(text != NULL, "memory for an input");
    if (size > 0)
        memcpy(text, data, size);
    text[size] = '\0';
    return text;
}

/// A file of these bytes, for readers that take a path: "/proc/self/fd/NUMBER", in memory. `number`
/// from 100 on.
static inline const char *fuzz_file(int number, const void *data, size_t size)
{
    static char path[40];
    if (fcntl(number, F_GETFD) < 0) {
        int made = memfd_create("input", 0);
        require(made >= 0 && dup2(made, number) == number && close(made) == 0, "a file in memory");
    }
    require(ftruncate(number, 0) == 0 && pwrite(number, data, size, 0) == (ssize_t)size,
            "room for an input");
    snprintf(path, sizeof path, "/proc/self/fd/%d", number);
    return path;
}

#endif
