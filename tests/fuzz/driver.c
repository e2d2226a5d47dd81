/// driver.c: runs a fuzz target without libFuzzer, the same way each time:
///     fuzz_NAME [RUNS [SEED [FILE...]]]
/// First every file of the corpus (tests/fuzz/corpus/NAME, or the FILEs), then RUNS mutations of
/// them. An input that fails is left in fuzz_NAME.failed beside the program. Prints Unity's lines.
#include "fuzz.h"

#include <dirent.h>
#include <errno.h>
#include <libgen.h>
#include <signal.h>
#include <time.h>

#define RUNS 3000        // chosen: most targets take less than half a second
#define LONG_RUNS 100    // times as many with HIMC_LONG
#define PATIENCE 60      // (s) for one input; chosen: it takes microseconds, on any machine
#define MOST_BYTES 65536 // of an input
#define MOST_SEEDS 512
#define MUTATIONS 6 // most, of one input

typedef struct input {
    uint8_t *bytes;
    size_t size;
} input;

#pragma weak LLVMFuzzerCustomMutator

static input seeds[MOST_SEEDS], now;
static int seed_count;
static uint64_t state;
static char failed[512];

static uint32_t next(void)
{
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return (uint32_t)(state >> 32);
}

static size_t below(size_t n)
{
    return n ? next() % n : 0;
}

static void keep_failed(int number)
{
    int file = open(failed, O_WRONLY | O_CREAT | O_TRUNC, 0666);
    if (file >= 0 && write(file, now.bytes, now.size) == (ssize_t)now.size)
        close(file);
    signal(number, SIG_DFL);
    raise(number);
}

// in memory of its exact size, so that the address sanitizer sees a byte too far
static void run(const uint8_t *bytes, size_t size)
{
    now = (input){malloc(size ? size : 1), size};
    require(now.bytes != NULL, "memory for an input");
    if (size > 0)
        memcpy(now.bytes, bytes, size);
    alarm(PATIENCE);
    LLVMFuzzerTestOneInput(now.bytes, size);
    alarm(0);
    free(now.bytes);
    now = (input){NULL, 0};
}

static void add_file(const char *path)
{
    FILE *file = fopen(path, "rb");
    require(file && seed_count < MOST_SEEDS, path);
    input *seed = &seeds[seed_count++];
    seed->bytes = malloc(MOST_BYTES);
    seed->size = fread(seed->bytes, 1, MOST_BYTES, file);
    fclose(file);
}

static int visible(const struct dirent *entry)
{
    return entry->d_name[0] != '.';
}

// in the order of their names, the same everywhere
static void add_corpus(const char *name)
{
    char folder[300], path[600];
    struct dirent **entry;
    snprintf(folder, sizeof folder, "tests/fuzz/corpus/%s", name);
    int count = scandir(folder, &entry, visible, alphasort);
    for (int i = 0; i < count; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, entry[i]->d_name);
        add_file(path);
        free(entry[i]);
    }
    if (count >= 0)
        free(entry);
}

// what stands in files where a reader trips
static const char *const pieces[] = {
    "-1",   "0",   "65535", "1e999", "nan",        "99999999999", "\t\t",     "\n", "{",
    "}",    ";",   ",",     "/",     "-0.0",       "1e-320",      "\xff\xff", " ",  "\"",
    "\\\\", "1e9", "0.5",   "\0",    "2147483648", "-2147483649", "1e38",     "#",  "%"};

static size_t insert(uint8_t *data, size_t size, size_t most, const uint8_t *piece, size_t length)
{
    size_t at = below(size + 1);
    if (size + length > most)
        return size;
    memmove(data + at + length, data + at, size - at);
    memcpy(data + at, piece, length);
    return size + length;
}

static size_t overwrite(uint8_t *data, size_t size, const input *other)
{
    size_t length = 1 + below(below(4) ? 8 : 100), at = below(size), from = below(other->size);
    length = length < size - at ? length : size - at;
    length = length < other->size - from ? length : other->size - from;
    memcpy(data + at, other->bytes + from, length);
    return size;
}

// one typical damage: bits, bytes, words, parts lost, doubled or from elsewhere
size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t most)
{
    if (size == 0)
        return insert(data, size, most, (const uint8_t *)"\n", 1);
    size_t at = below(size), length = 1 + below(below(4) ? 8 : 100);
    length = length < size - at ? length : size - at;
    const char *piece = pieces[below(sizeof pieces / sizeof pieces[0])];
    const input *other = seed_count ? &seeds[below((size_t)seed_count)] : &(input){NULL, 0};
    uint8_t copy[100];
    switch (below(8)) {
    case 0: data[at] ^= (uint8_t)(1u << below(8)); return size;
    case 1: data[at] = (uint8_t)(below(3) ? next() : below(2) ? 0 : 255); return size;
    case 2: memset(data + at, (int)below(256), length); return size;
    case 3: memmove(data + at, data + at + length, size - at - length); return size - length;
    case 4: return below(8) ? size : at + 1;
    case 5: memcpy(copy, data + at, length); return insert(data, size, most, copy, length);
    case 6: return insert(data, size, most, (const uint8_t *)piece, *piece ? strlen(piece) : 1);
    default: return other->size ? overwrite(data, size, other) : size;
    }
}

static void run_mutation(void)
{
    static uint8_t data[MOST_BYTES];
    const input *seed = seed_count ? &seeds[below((size_t)seed_count)] : &(input){data, 0};
    size_t size = seed->size;
    memmove(data, seed->bytes, size);
    for (size_t n = 1 + below(MUTATIONS); n > 0; n--)
        size = LLVMFuzzerCustomMutator && below(4)
                   ? LLVMFuzzerCustomMutator(data, size, MOST_BYTES, next())
                   : LLVMFuzzerMutate(data, size, MOST_BYTES);
    run(data, size);
}

static void watch(const char *program)
{
    static const int signals[] = {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGALRM};
    snprintf(failed, sizeof failed, "%s.failed", program);
    for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++)
        signal(signals[i], keep_failed);
}

int main(int count, char **argument)
{
    const char *name = strstr(basename(argument[0]), "fuzz_") + strlen("fuzz_");
    long runs = &fuzz_runs ? fuzz_runs : RUNS;
    runs = count > 1 ? atol(argument[1]) : getenv("HIMC_LONG") ? LONG_RUNS * runs : runs;
    state = count > 2 ? strtoull(argument[2], NULL, 10) * 2 + 1 : 20120815;
    watch(argument[0]);
    for (int i = 3; i < count; i++)
        add_file(argument[i]);
    if (count <= 3)
        add_corpus(name);
    for (int i = 0; i < seed_count; i++)
        run(seeds[i].bytes, seeds[i].size);
    printf("tests/fuzz/fuzz_%s.c:0:%d_inputs_of_the_corpus:PASS\n", name, seed_count);
    clock_t start = clock();
    for (long i = 0; i < runs; i++)
        run_mutation();
    double seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
    printf("tests/fuzz/fuzz_%s.c:0:%ld_mutations_of_them:PASS\n", name, runs);
    printf("%s: %.0f inputs a second of processor time\n", name, (double)runs / (seconds + 1e-6));
    printf("2 Tests 0 Failures 0 Ignored\n");
    for (int i = 0; i < seed_count; i++)
        free(seeds[i].bytes);
    return 0;
}
